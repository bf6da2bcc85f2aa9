//! Feature lines that end inside a cloud's surface, carried on a little beyond, as [`super::line_ends`] does those of
//! a mesh, and why.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_graph::Sites;
use super::line_network::Network;
use super::line_sheets::{beside_lines, sheets_of};
use super::nearest::Search;
use super::segment_grid::SegmentGrid;

/// Lines are carried on by this many steps of a spacing. With 4 fandisk, of 200,000 points, takes 1,900 bytes at a
/// tenth of a percent, with 8 and 16 1,889 and 1,890.
const STEPS: usize = 8;

/// A line ends in the direction in which its last so many segments lead: one alone may slant.
const LEADING: usize = 4;

/// A line that comes within this many spacings of another has met it. Less than a step, or it would meet itself.
const MET: f64 = 0.9;

/// A place farther than this many spacings from all points lies beyond the surface's border.
const OUTSIDE: f64 = 1.5;

/// A surface that turns by more than this (cosine of 30°) from step to step has a crease there.
const FOLDS: f64 = 0.866;

/// The network with the lines that end inside the surface carried on, along [`Network::carried`].
#[must_use]
pub fn carried_on(network: Network, search: &Search, sites: &Sites) -> Network {
    let count = network.segments.len() as u32;
    let ends = (0..count).flat_map(|segment| network.segments[segment as usize].map(|node| (segment, node)));
    let loose: Vec<(u32, u32)> = ends.filter(|&(_, node)| network.at_node.row(node).len() == 1).collect();
    if loose.is_empty() {
        return network;
    }
    let grid = network.grid();
    let walk = Walk { network: &network, grid, search, sites };
    let paths: Vec<Vec<DVec3>> = loose.par_iter().map(|&(segment, node)| walk.path(segment, node)).collect();
    let paths = apart(&paths);
    let tried = network.clone().with_carried(&paths.concat());
    let sheets = sheets_of(&tried, sites, &beside_lines(&tried, sites), |_| true);
    let parts =
        |piece: &&[Vec3; 2]| tried.find(**piece).is_some_and(|segment| sheets[segment as usize].len() == 2);
    let parting = paths.iter().flat_map(|path| path.iter().take_while(parts).copied());
    network.with_carried(&parting.collect::<Vec<_>>())
}

/// Points that tell where the surface is: about three spacings in all directions.
const AROUND: usize = 32;

/// Fewer points than this on one side of a line say nothing of it.
const FEWEST: usize = 4;

/// Nor do points whose distances from the line vary by less than this share of their mean square: those strewn evenly
/// do by a quarter.
const SPREAD: f64 = 0.01;

/// A place on a surface, and the normal and spacing of the points around it.
struct Footing {
    place: DVec3,
    normal: DVec3,
    spacing: f64,
    /// Whether it lies beyond the surface's border.
    outside: bool,
}

/// Lines on their way over a surface.
struct Walk<'a> {
    network: &'a Network,
    grid: SegmentGrid,
    search: &'a Search,
    sites: &'a Sites<'a>,
}

impl Walk<'_> {
    /// The places that a line leads to beyond a node at which it ends, from there.
    fn path(&self, segment: u32, node: u32) -> Vec<DVec3> {
        let end = self.network.nodes[node as usize].as_dvec3();
        let back = self.network.onward(segment, self.network.across(segment, node)).take(LEADING);
        let own: Vec<(u32, u32)> = back.collect();
        let start = own.last().map_or(end, |&(_, node)| self.network.nodes[node as usize].as_dvec3());
        let mut along = (end - start).normalize_or_zero();
        let (mut path, mut here) = (vec![end], end);
        let mut on = self.footing(end, along);
        while let Some(footing) = on.take().filter(|footing| path.len() <= STEPS && !footing.outside) {
            let is_other = |other: u32| !own.iter().any(|&(segment, _)| segment == other);
            if let Some(near) = self.grid.nearest_of(here, MET * footing.spacing, is_other) {
                path.push(self.nearest_node(near.segment, here));
                break;
            }
            along = along.reject_from_normalized(footing.normal).normalize_or_zero();
            let next = self.footing(here + footing.spacing * along, along);
            on = next.filter(|next| next.normal.dot(footing.normal).abs() >= FOLDS);
            if let Some(next) = &on {
                here = next.place;
                path.push(here);
            }
        }
        path
    }

    fn nearest_node(&self, segment: u32, place: DVec3) -> DVec3 {
        let [a, b] = self.network.ends(segment);
        if a.distance_squared(place) <= b.distance_squared(place) { a } else { b }
    }

    /// The surface at a place of a line that leads `along`.
    fn footing(&self, place: DVec3, along: DVec3) -> Option<Footing> {
        let around = self.search.around(place.as_vec3(), AROUND);
        let closest = *around.first()? as usize;
        let at = |point: u32| self.sites.positions[point as usize].as_dvec3();
        let normal_of = |point: u32| self.sites.normals[point as usize].as_dvec3();
        let own = normal_of(closest as u32);
        let normals = around.iter().map(|&point| normal_of(point));
        let sum: DVec3 = normals.map(|normal| normal * normal.dot(own).signum()).sum();
        let normal = sum.normalize_or(own);
        let across = normal.cross(along).normalize_or_zero();
        let ways = around.iter().map(|&point| at(point) - place);
        let profile: Vec<(f64, f64)> = ways.map(|way| (way.dot(across), way.dot(normal))).collect();
        let place = place + height(&profile) * normal;
        let spacing = f64::from(self.sites.spacing[closest]);
        let outside = place.distance(at(closest as u32)) > OUTSIDE * spacing;
        (spacing > 0.0).then_some(Footing { place, normal, spacing, outside })
    }
}

/// Where the lines on both sides of zero through places `(across, height)` meet it, on the mean: the ridge, where
/// there is one.
fn height(profile: &[(f64, f64)]) -> f64 {
    let sides = [1.0, -1.0].map(|side| {
        let places: Vec<(f64, f64)> = profile.iter().filter(|(x, _)| side * x > 0.0).copied().collect();
        meets(&places)
    });
    match sides {
        [Some(a), Some(b)] => 0.5 * (a + b),
        _ => profile.iter().map(|(_, height)| height).sum::<f64>() / profile.len() as f64,
    }
}

/// Where the line of least squares through some places meets zero; `None` of few, and of those at one distance.
fn meets(places: &[(f64, f64)]) -> Option<f64> {
    let count = places.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| places.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|place| place.0), mean(|place| place.1));
    let square = mean(|place| place.0 * place.0);
    let (xx, xy) = (square - x * x, mean(|place| place.0 * place.1) - x * y);
    (places.len() >= FEWEST && xx > SPREAD * square).then(|| y - xy / xx * x)
}

/// The pieces of paths as far as each keeps apart from those before it.
fn apart(paths: &[Vec<DVec3>]) -> Vec<Vec<[Vec3; 2]>> {
    let sides = || paths.iter().zip(0_u32..).flat_map(|(path, n)| path.windows(2).map(move |side| (n, side)));
    let of: Vec<u32> = sides().map(|(n, _)| n).collect();
    let grid = SegmentGrid::new(sides().map(|(_, side)| [side[0], side[1]]).collect());
    let mut laid = vec![false; of.len()];
    let mut pieces = vec![Vec::new(); paths.len()];
    for ((n, side), index) in sides().zip(0_u32..) {
        let goes_on = index == 0 || of[index as usize - 1] != n || laid[index as usize - 1];
        let meets = |other: u32| of[other as usize] < n && laid[other as usize];
        if goes_on && grid.nearest_of(side[1], side[0].distance(side[1]), meets).is_none() {
            laid[index as usize] = true;
            pieces[n as usize].push([side[0].as_vec3() + Vec3::ZERO, side[1].as_vec3() + Vec3::ZERO]);
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::planted::{ROOF_STEP, fall, lay, roof, side_by_side, spaced};

    /// Lines along a roof over `[-1, 1]²`, each from and to places in `(x, y)`, carried on.
    fn carried(degrees: f64, lines: &[[[f64; 2]; 2]]) -> Network {
        let points = roof(degrees, 0.0);
        let (search, nearest, spacing) = lay(&points);
        let normals = vec![Vec3::Z; points.len()];
        let sites = side_by_side(&points, &normals, &nearest, &spacing);
        let place = |[x, y]: [f64; 2]| DVec3::new(x, y, fall(degrees, y));
        let lines: Vec<Vec<DVec3>> = lines.iter().map(|ends| ends.map(place).to_vec()).collect();
        let network = Network::new(&lines, &spaced(&search, &points, &spacing));
        let own = network.clone();
        let on = carried_on(network, &search, &sites);
        assert_eq!(on.segments.len(), own.segments.len() + on.carried.len());
        for ends in &own.segments {
            let segment = on.find(ends.map(|node| own.nodes[node as usize]));
            assert!(
                segment.is_some_and(|segment| !on.is_carried(segment)),
                "a line's own segment is one still"
            );
        }
        on
    }

    /// The least and greatest x of what carries lines on.
    fn reach(network: &Network) -> [f64; 2] {
        let ends = network.carried.iter().flat_map(|&segment| network.ends(segment));
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], end| [low.min(end.x), high.max(end.x)])
    }

    #[test]
    fn a_line_that_ends_is_carried_on_along_the_ridge() {
        for degrees in [0.0, 25.0] {
            let network = carried(degrees, &[[[-1.1, 0.0], [0.0, 0.0]]]);
            let [low, high] = reach(&network);
            assert!(low.abs() < 1e-6 && (0.06..0.25).contains(&high), "{degrees}°: {low} to {high}");
            for end in network.carried.iter().flat_map(|&segment| network.ends(segment)) {
                assert!(
                    end.y.abs() < 0.5 * ROOF_STEP && (end.z - fall(degrees, end.y)).abs() < 0.1 * ROOF_STEP,
                    "{end}"
                );
            }
        }
    }

    #[test]
    fn a_line_is_carried_on_to_the_next_and_no_farther() {
        let wall = [[0.06, -1.1], [0.06, 1.1]];
        let [_, high] = reach(&carried(0.0, &[[[-1.1, 0.0], [0.0, 0.0]], wall]));
        assert!((high - 0.06).abs() < 1e-6, "to {high}");
        let met = carried(0.0, &[[[-1.1, 0.0], [0.06, 0.0]], wall]);
        assert!(met.carried.is_empty(), "{} segments from where lines meet", met.carried.len());
    }

    #[test]
    fn over_a_gap_one_of_two_ends_is_carried_on() {
        let network = carried(0.0, &[[[-1.1, 0.0], [0.0, 0.0]], [[0.07, 0.0], [1.1, 0.0]]]);
        let length: f64 = network.carried.iter().map(|&segment| network.length(segment)).sum();
        assert!((0.069..0.08).contains(&length), "{length}");
        assert_eq!(network.strands().len(), 1);
    }

    #[test]
    fn a_line_that_leads_out_of_the_surface_is_carried_on_by_a_few_steps_at_most() {
        let [_, high] = reach(&carried(0.0, &[[[-1.1, 0.0], [0.95, 0.0]]]));
        assert!((0.99..1.1).contains(&high), "to {high}");
    }

    #[test]
    fn a_profile_is_as_high_as_its_ridge() {
        let roof = |n: i32| (0.1 * f64::from(n), 0.3 - 0.05 * f64::from(n).abs());
        assert!((height(&(-9..10).map(roof).collect::<Vec<_>>()) - 0.3).abs() < 1e-12);
        let few = [(0.1, 1.0), (0.2, 2.0), (-0.1, 3.0)];
        assert!((height(&few) - 2.0).abs() < 1e-12, "where one side is not seen the mean");
        let row = (0..8).map(|n| (1.0 + 1e-9 * f64::from(n), f64::from(n)));
        let rows: Vec<(f64, f64)> = row.flat_map(|(x, y)| [(x, y), (-x, y)]).collect();
        assert!((height(&rows) - 3.5).abs() < 1e-12, "of points at one distance the mean");
    }
}
