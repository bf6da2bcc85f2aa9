//! Points that belong to no surface.
//!
//! Three kinds count: a point much lonelier than the points nearest to it, a point that is
//! joined to no other, and a few points joined only among themselves at distances far
//! beyond the cloud's usual spacing.

use rayon::prelude::*;

use super::cloud_graph::Joined;
use super::nearest::{Nearest, listed};
use super::surface::NONE;

/// A point is lonely if its spacing is this many times the median spacing of its nearest.
const LONELY: f32 = 4.0;

/// A component of no more than this share of all points is a handful.
const HANDFUL: f64 = 0.01;

/// A handful is far off if its spacing is this many times the cloud's median.
const FAR_OFF: f32 = 5.0;

/// Clouds of fewer points have no usual spacing to compare with.
const FEWEST: usize = 32;

/// Where more than this share of all points would be outliers, none are: they are the cloud.
const MOST: f64 = 0.5;

/// Which points are outliers; those joined to a feature line are not for being joined to
/// nothing else.
#[must_use]
pub fn outliers(nearest: &Nearest, spacing: &[f32], joined: &[Joined], on_line: &[bool]) -> Vec<bool> {
    let count = spacing.len();
    if count < FEWEST {
        return vec![false; count];
    }
    let usual = median(spacing.to_vec());
    let sizes = component_sizes(joined);
    let handful = HANDFUL * count as f64;
    let outlier: Vec<bool> = (0..count)
        .into_par_iter()
        .map(|n| {
            let around = || listed(&nearest[n]).map(|other| spacing[other as usize]);
            let far_off = f64::from(sizes[n]) <= handful && spacing[n] > FAR_OFF * usual;
            // Hardly any point is lonely beside even the densest around: most need no median.
            let lonely = around().any(|other| spacing[n] > LONELY * other)
                && spacing[n] > LONELY * median(around().collect());
            lonely || (sizes[n] == 1 && !on_line[n]) || far_off
        })
        .collect();
    let found = outlier.iter().filter(|o| **o).count();
    if found as f64 > MOST * count as f64 { vec![false; count] } else { outlier }
}

fn median(mut values: Vec<f32>) -> f32 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// For each point how many points it is joined to, itself counted, however far round.
fn component_sizes(joined: &[Joined]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..joined.len() as u32).collect();
    fn root(parent: &mut [u32], mut x: u32) -> u32 {
        while parent[x as usize] != x {
            parent[x as usize] = parent[parent[x as usize] as usize];
            x = parent[x as usize];
        }
        x
    }
    for (a, joined) in joined.iter().enumerate() {
        for &b in joined.sectors.iter().filter(|b| **b != NONE) {
            let (a, b) = (root(&mut parent, a as u32), root(&mut parent, b));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let roots: Vec<u32> = (0..joined.len() as u32).map(|n| root(&mut parent, n)).collect();
    let mut sizes = vec![0; joined.len()];
    for &root in &roots {
        sizes[root as usize] += 1;
    }
    roots.iter().map(|&root| sizes[root as usize]).collect()
}
