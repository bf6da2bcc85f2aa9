//! Points that belong to no surface.
//!
//! Three kinds count, beside a point much lonelier than the points nearest to it:
//!
//! - points strewn far beyond the cloud's usual spacing that show no surface: their neighbours lie
//!   around them as in a ball, or they are joined only to a few like them;
//! - a point that is joined to no other;
//! - a group that has no more points than each has neighbours, and is near no greater one: whatever
//!   plane or quadric is fitted around one of them is fitted to points of another surface too, so
//!   that no surface of their own can be told. A group with more of them stays, however small its
//!   share of the cloud.

use glam::Vec3;
use rayon::prelude::*;

use super::cloud_graph::{Joined, are_near};
use super::cloud_normals::plane;
use super::nearest::{NEAREST, Nearest, listed};
use super::sets::Sets;
use super::surface::NONE;

/// A point is lonely if its spacing is this many times the median spacing of its nearest.
const LONELY: f32 = 4.0;

/// A component of no more than this share of all points is a handful.
const HANDFUL: f64 = 0.01;

/// Points are far off if their spacing is this many times the cloud's median.
const FAR_OFF: f32 = 5.0;

/// Neighbours whose least variance is more than this share of the middle one lie as in a ball. Around
/// the edge of a cube it is a quarter, around its corner two fifths; of sixteen strewn evenly in
/// space it is more than this four times in five.
const BALL: f64 = 0.4;

/// Groups of no more points than this show no surface of their own: around each of more there may
/// be as many of the same.
const GROUP: u32 = NEAREST as u32;

/// Clouds of fewer points have no usual spacing to compare with.
const FEWEST: usize = 32;

/// Where more than this share of all points would be outliers, none are: they are the cloud.
const MOST: f64 = 0.5;

/// Where points lie, and what is known of how.
#[derive(Clone, Copy, Debug)]
pub struct Strewn<'a> {
    /// Positions, model units.
    pub positions: &'a [Vec3],
    /// The nearest others of each.
    pub nearest: &'a Nearest,
    /// Local spacings, model units.
    pub spacing: &'a [f32],
    /// What each is joined to.
    pub joined: &'a [Joined],
    /// Which are joined to a feature line.
    pub on_line: &'a [bool],
}

/// Which points are outliers; those joined to a feature line are not for being joined to few or
/// none but it.
#[must_use]
pub fn outliers(strewn: &Strewn<'_>) -> Vec<bool> {
    let count = strewn.spacing.len();
    if count < FEWEST {
        return vec![false; count];
    }
    let far_off = FAR_OFF * median(strewn.spacing.to_vec());
    let stray: Vec<bool> = (0..count).into_par_iter().map(|n| strewn.is_stray(n, far_off)).collect();
    let groups = Groups::of(strewn.joined, &stray);
    let held = groups.held(strewn);
    let handful = HANDFUL * count as f64;
    let outlier: Vec<bool> = (0..count)
        .into_par_iter()
        .map(|n| {
            let size = groups.size(n);
            let few = f64::from(size) <= handful && strewn.spacing[n] > far_off;
            let alone = size == 1 && !strewn.on_line[n];
            stray[n] || few || alone || (size <= GROUP && !held[groups.root[n] as usize])
        })
        .collect();
    let found = outlier.iter().filter(|o| **o).count();
    if found as f64 > MOST * count as f64 { vec![false; count] } else { outlier }
}

impl Strewn<'_> {
    /// Whether a point is lonely, or `far_off` in the midst of others that show no surface.
    fn is_stray(&self, n: usize, far_off: f32) -> bool {
        let (spacing, row) = (self.spacing[n], &self.nearest[n]);
        let around = || listed(row).map(|other| self.spacing[other as usize]);
        // Hardly any point is lonely beside even the densest around: most need no median.
        let lonely =
            around().any(|other| spacing > LONELY * other) && spacing > LONELY * median(around().collect());
        lonely || (spacing > far_off && plane(self.positions, n, listed(row)).roundness > BALL)
    }

    /// Whether the surface could go on from one point to another but for its direction.
    fn are_near(&self, a: usize, b: usize) -> bool {
        are_near(self.positions[a].distance(self.positions[b]), [self.spacing[a], self.spacing[b]])
    }
}

/// Points joined to each other, however far round but not by way of strays.
struct Groups {
    /// For each point the least one of its group.
    root: Vec<u32>,
    /// For each such point how many are of the group.
    size: Vec<u32>,
}

impl Groups {
    fn of(joined: &[Joined], stray: &[bool]) -> Self {
        let mut sets = Sets::new(joined.len());
        for (a, joined) in (0_u32..).zip(joined).filter(|&(a, _)| !stray[a as usize]) {
            for &b in joined.sectors.iter().filter(|&&b| b != NONE && !stray[b as usize]) {
                sets.merge(a, b);
            }
        }
        let root: Vec<u32> = (0..joined.len() as u32).map(|n| sets.root(n)).collect();
        let mut size = vec![0; joined.len()];
        for &root in &root {
            size[root as usize] += 1;
        }
        Self { root, size }
    }

    /// The size of a point's group.
    fn size(&self, n: usize) -> u32 {
        self.size[self.root[n] as usize]
    }

    /// By their roots, which of the groups too small to show a surface are part of one: joined to a
    /// feature line, or near a greater group, as a narrow face between two wide ones is.
    fn held(&self, strewn: &Strewn<'_>) -> Vec<bool> {
        let mut held = vec![false; self.root.len()];
        for n in (0..self.root.len()).filter(|&n| self.size(n) <= GROUP) {
            let mut greater = listed(&strewn.nearest[n]).filter(|&other| self.size(other as usize) > GROUP);
            held[self.root[n] as usize] |=
                strewn.on_line[n] || greater.any(|other| strewn.are_near(n, other as usize));
        }
        held
    }
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use glam::DVec3;

    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_discs};
    use crate::analyse::planted::random;
    use crate::model::cloud::Cloud;

    /// What points of a lattice lie apart, nearly.
    const STEP: f64 = 0.02;

    /// Points of a square of so many each way, a little off their lattice, about a place.
    fn sheet(side: u32, middle: DVec3) -> Vec<DVec3> {
        let off = |n: u32| 0.2 * STEP * random(u64::from(n) + 1000 * u64::from(side));
        let at = |n: u32| STEP * (f64::from(n) - 0.5 * f64::from(side - 1));
        (0..side * side)
            .map(|n| middle + DVec3::new(at(n % side) + off(2 * n), at(n / side) + off(2 * n + 1), 0.0))
            .collect()
    }

    fn left_out(places: &[DVec3], normals: &[DVec3]) -> Vec<u32> {
        let cloud = Cloud {
            positions: places.iter().map(|place| place.as_vec3()).collect(),
            normals: normals.iter().map(|normal| normal.as_vec3()).collect(),
            ..Cloud::default()
        };
        cloud_discs(&cloud, NormalSource::Auto, Lines::Given(&[]), None).unwrap().left_out
    }

    #[test]
    fn groups_that_show_no_surface_are_left_out_and_small_islands_stay() {
        let wide = sheet(40, DVec3::ZERO);
        for (side, out) in [(2, true), (3, true), (4, true), (5, false), (6, false)] {
            let island = sheet(side, 0.4 * DVec3::Z);
            let expected = wide.len() as u32..(wide.len() + island.len()) as u32;
            let found = left_out(&[wide.clone(), island].concat(), &[]);
            assert_eq!(found, if out { expected.collect() } else { Vec::new() }, "{side} by {side}");
        }
    }

    #[test]
    fn strays_near_each_other_are_left_out_whatever_their_number() {
        // Twice as many as a handful of a hundredth of the cloud, in a ball beside the sheet.
        let wide = sheet(60, DVec3::ZERO);
        let (first, count) = (wide.len() as u32, wide.len() / 50);
        let place = |n: u64| DVec3::new(random(3 * n), random(3 * n + 1), random(3 * n + 2));
        let strays = (0..).map(place).filter(|p| p.length() < 1.0).take(count);
        let places: Vec<DVec3> = wide.iter().copied().chain(strays.map(|p| 0.5 * p + DVec3::Z)).collect();
        assert_eq!(left_out(&places, &[]), (first..first + count as u32).collect::<Vec<u32>>());
    }

    #[test]
    fn a_narrow_face_between_wide_ones_is_part_of_them() {
        let (low, high) = (sheet(20, DVec3::ZERO), sheet(20, 0.06 * DVec3::Z));
        let edge = 10.5 * STEP;
        // Two rows of six points along the middle of one of the sides, whose normals are those of the file.
        let side = (0..12_u32)
            .map(|n| DVec3::new(edge, STEP * (f64::from(n % 6) - 2.5), STEP * (1.0 + f64::from(n / 6))));
        let normals = [(-DVec3::Z, low.len()), (DVec3::Z, high.len()), (DVec3::X, 12)]
            .map(|(normal, n)| vec![normal; n]);
        let places: Vec<DVec3> = low.into_iter().chain(high).chain(side).collect();
        assert_eq!(left_out(&places, &normals.concat()), Vec::<u32>::new());
    }

    #[test]
    fn most_of_a_cloud_is_never_left_out() {
        let strays: Vec<DVec3> =
            (0..200).map(|n| DVec3::new(random(3 * n), random(3 * n + 1), random(3 * n + 2))).collect();
        assert!(left_out(&strays, &[]).len() <= strays.len() / 2);
    }
}
