//! The points of a cloud told apart by the feature lines between them: neighbours, spacings, normals, and
//! the sides on which they lie of lines, given or found.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_creases::{Points, Sought, found};
use super::cloud_ends::carried_on;
use super::cloud_graph::Sites;
use super::cloud_normals::{NormalSource, Normals, normals, parted};
use super::cloud_snap::onto_creases;
use super::distinct::{Distinct, distinct};
use super::line_cut::LineCut;
use super::line_network::Network;
use super::line_ways;
use super::nearest::{Nearest, Search, Spacings, spacing};
use super::orient::orient_sides;
use super::seams::{off_seams, seams};
use crate::error::Result;
use crate::model::cloud::Cloud;
use crate::model::polyline::length;

/// Where the feature lines of a cloud come from.
#[derive(Clone, Copy, Debug)]
pub enum Lines<'a> {
    /// Given, model units; perhaps none.
    Given(&'a [Vec<DVec3>]),
    /// Its creases, so far as they are these.
    Found(Sought),
}

/// Lines that part nothing.
#[derive(Clone, Debug, Default)]
pub struct Cleaned {
    /// Segments as given, counted over all lines, ascending, of lines far from the cloud.
    pub far: Vec<u32>,
    /// Length of the given lines that passed beside the creases they mean and were moved onto them, model units.
    pub moved: f64,
    /// Length of the lines that ran closely beside others and gave way to them, model units.
    pub merged: f64,
    /// Length of the given lines along which the surface is smooth, model units.
    pub smooth: f64,
}

/// A cloud's points, told apart by feature lines.
#[derive(Clone, Debug)]
pub struct Sided {
    /// The points.
    pub points: Distinct,
    /// The nearest others of each, on whichever side.
    pub nearest: Nearest,
    /// Local spacings, model units.
    pub spacing: Vec<f32>,
    /// Unit normals; those estimated are of one side.
    pub normals: Normals,
    /// The feature lines, model units; of those given the ones at which the surface is not smooth, on the creases they
    /// mean.
    pub lines: Vec<Vec<DVec3>>,
    /// The sides, where a line is near the cloud.
    pub cut: Option<LineCut>,
    /// What became of the lines that part nothing.
    pub cleaned: Cleaned,
    noise: f64,
}

impl Sided {
    /// `noise` is the standard deviation of the points from their surface, model units; `None` where they show
    /// none.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] where normals are to be kept and none is sound.
    pub fn of(cloud: &Cloud, source: NormalSource, lines: Lines<'_>, noise: Option<f64>) -> Result<Self> {
        let points = distinct(cloud);
        let search = Search::new(&points.positions)?;
        let nearest = search.nearest();
        let spacing = spacing(&points.positions, &nearest);
        let laid = Spacings { search: &search, positions: &points.positions, spacing: &spacing };
        // Points that show no surface show neither creases nor sheets that cross.
        let shown = noise.map(|noise| Points { laid, nearest: &nearest, noise });
        let normals = normals(&points, &nearest, source, shown.as_ref())?;
        let given = matches!(lines, Lines::Given(_));
        let mut lines = match lines {
            Lines::Given(lines) => lines.to_vec(),
            Lines::Found(sought) => shown.map_or_else(|| Ok(Vec::new()), |points| found(&points, &sought))?,
        };
        let mut network = Network::new(&lines, &laid);
        let mut moved = 0.0;
        if let Some(points) = shown.filter(|_| given && !network.segments.is_empty()) {
            (network, moved) = onto_creases(network, &points)?;
        }
        if moved > 0.0 {
            lines = line_ways::lines(&network);
        }
        let far = std::mem::take(&mut network.far);
        let cleaned = Cleaned { far, moved, merged: network.merged, smooth: 0.0 };
        let noise = noise.unwrap_or_default();
        let mut sided = Self { points, nearest, spacing, normals, lines, cut: None, cleaned, noise };
        if given && !network.segments.is_empty() {
            network = sided.without_seams(network);
        }
        if !network.segments.is_empty() {
            let network = carried_on(network, &search, &sided.sites());
            drop(search);
            sided.part(network);
        }
        Ok(sided)
    }

    /// Leaves out the lines along which the surface is smooth, and their part of a network.
    fn without_seams(&mut self, network: Network) -> Network {
        let seams = seams(&network, &self.sites());
        if seams.is_empty() {
            return network;
        }
        let left = off_seams(&self.lines, &network, &seams);
        self.cleaned.smooth = length(&self.lines) - length(&left);
        self.lines = left;
        network.without(&seams)
    }

    /// Tells the points apart along a network; estimated normals beside it are estimated again.
    fn part(&mut self, network: Network) {
        let mut cut = LineCut::new(network, &self.sites());
        if self.normals.estimated {
            if self.face(&cut) {
                cut = cut.again(&self.sites());
            }
            let sites = self.sites();
            let mended = |(point, normal): (usize, &Vec3)| cut.mended(&sites, point as u32, *normal);
            self.normals.normals = self.normals.normals.par_iter().enumerate().map(mended).collect();
        }
        self.cut = Some(cut);
    }

    /// Estimates normals again whose neighbours a cut parts, and the signs of all; whether any sign changed.
    fn face(&mut self, cut: &LineCut) -> bool {
        let sites = self.sites();
        let parts = |a, b| cut.parts(&sites, a, b);
        let mut normals = self.normals.normals.clone();
        parted(&self.points, &self.nearest, &parts, &mut normals);
        let across = cut.across(&Sites { normals: &normals, ..sites });
        // Points too near to a line to be of either side have normals of both.
        let on_line = |n| cut.is_on(&sites, n);
        let apart = |a, b| on_line(a) || on_line(b) || parts(a, b);
        let turned = orient_sides(sites.positions, sites.nearest, &mut normals, &apart, &across);
        self.normals.normals = normals;
        turned
    }

    /// The points as the graph sees them.
    #[must_use]
    pub fn sites(&self) -> Sites<'_> {
        Sites {
            positions: &self.points.positions,
            normals: &self.normals.normals,
            spacing: &self.spacing,
            nearest: &self.nearest,
            noise: self.noise,
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::{normal, on_step, random};

    #[test]
    fn normals_beside_a_corner_are_of_one_face() {
        let lines = DVec3::AXES.map(|axis| vec![DVec3::ZERO, 0.5 * axis]);
        let (mut wrong, mut beside) = (0, 0);
        for cloud in 0..20 {
            let places: Vec<(DVec3, DVec3)> = (0..3000).map(|n| on_step(3000 * cloud + n)).collect();
            let positions = places.iter().map(|(at, _)| at.as_vec3()).collect();
            let cloud = Cloud { positions, ..Cloud::default() };
            let sided = Sided::of(&cloud, NormalSource::Auto, Lines::Given(&lines), Some(0.0)).unwrap();
            for ((at, face), &n) in places.iter().zip(&sided.points.place) {
                if at.length() < 2.0 * f64::from(sided.spacing[n as usize]) {
                    beside += 1;
                    let normal = sided.normals.normals[n as usize].as_dvec3();
                    wrong += u32::from(normal.dot(*face).abs() < libm::cos(10_f64.to_radians()));
                }
            }
        }
        assert!(beside > 100 && wrong == 0, "{wrong} of {beside} are of several faces");
    }

    #[test]
    fn signs_go_on_over_folds_sharper_than_any_plane_through_both_sides_tells() {
        // Walls 0.3 high that meet at 60°, above and below by turns; points lie 0.02 apart.
        let (sin, cos) = libm::sincos(30_f64.to_radians());
        let wall = |n: u64, way: f64| {
            let up = n.is_multiple_of(2);
            let z = if up { way } else { 0.3 - way } * cos;
            (
                DVec3::new(0.0, (0.3 * n as f64 + way) * sin, z),
                DVec3::new(0.0, if up { -cos } else { cos }, sin),
            )
        };
        for noise in [0.0, 0.01] {
            let (positions, truth): (Vec<Vec3>, Vec<DVec3>) = (0..8000_u64)
                .map(|n| {
                    let (place, out) = wall(n % 8, 0.15 + 0.15 * random(2 * n));
                    let off = DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2));
                    ((place + 0.5 * random(2 * n + 1) * DVec3::X + noise * off).as_vec3(), out)
                })
                .unzip();
            let cloud = Cloud { positions, ..Cloud::default() };
            let line = |n: u64| [-0.5, 0.5].map(|x| wall(n, 0.0).0.with_x(x)).to_vec();
            let lines: Vec<Vec<DVec3>> = (1..8).map(line).collect();
            let sided = Sided::of(&cloud, NormalSource::Auto, Lines::Given(&lines), Some(noise)).unwrap();
            let outward =
                |(n, &at): (usize, &u32)| sided.normals.normals[at as usize].as_dvec3().dot(truth[n]) > 0.0;
            // Beside the lines a point may be of either wall.
            let clear = |n: usize| (0.25..0.75).contains(&(0.5 + 0.5 * random(2 * n as u64)));
            let clear: Vec<bool> =
                sided.points.place.iter().enumerate().filter(|(n, _)| clear(*n)).map(outward).collect();
            let share = clear.iter().filter(|outward| **outward).count() as f64 / clear.len() as f64;
            assert!(share.max(1.0 - share) > 0.999, "with noise of {noise} {share} look the same way");
        }
    }
}
