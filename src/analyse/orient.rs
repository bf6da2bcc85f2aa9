//! Signs of normals that agree along the surface (Hoppe et al. 1992, 3.3).
//!
//! A minimum spanning tree of the neighbour graph, with weights `1 - |n·n|`, carries the sign
//! from point to point where the normals turn least. Only the signs along it matter, so the
//! tree is never stored: sets that merge remember each member's sign against its root.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::nearest::{NEAREST, Nearest, listed};

/// Edges of the graph taken from each point, its nearest: enough to hold together what
/// belongs together, few enough to sort fast.
const TAKEN: usize = 8;

/// Ends whose normals agree up to their signs by this cosine (10°) are tied before all others and as
/// they come: no sign is in doubt there, and sorting them would cost more than all the rest.
const SURE: f32 = 0.985;

/// Along the surface the signs of ends whose normals agree less than this, up to them (cosine of 60°), are in more
/// doubt than those over a feature line.
const CLEAR: f32 = 0.5;

/// A component whose normals look outward at its outermost points by less than this, of 1
/// for a closed smooth surface, is a patch: it is turned away from the model's middle.
const OUTERMOST: f64 = 0.3;

/// The directions in which outermost points are looked for: those of a cube's neighbours.
const DIRECTIONS: usize = 26;

/// Sets of points whose signs are tied together.
struct SignedSets {
    parent: Vec<u32>,
    /// Whether a point's normal must be turned to agree with its parent's.
    turned: Vec<bool>,
}

impl SignedSets {
    fn new(len: usize) -> Self {
        Self { parent: (0..len as u32).collect(), turned: vec![false; len] }
    }

    /// The root of a point's set, and whether the point is turned against it.
    fn root(&mut self, point: u32) -> (u32, bool) {
        let (mut root, mut turned) = (point, false);
        while self.parent[root as usize] != root {
            turned ^= self.turned[root as usize];
            root = self.parent[root as usize];
        }
        // Everything on the way now hangs from the root itself.
        let (mut at, mut rest) = (point, turned);
        while self.parent[at as usize] != root && at != root {
            let (next, own) = (self.parent[at as usize], self.turned[at as usize]);
            self.parent[at as usize] = root;
            self.turned[at as usize] = rest;
            rest ^= own;
            at = next;
        }
        (root, turned)
    }

    /// Ties two points together unless they already are.
    fn tie(&mut self, a: u32, b: u32, opposite: bool) {
        let ((a, turned_a), (b, turned_b)) = (self.root(a), self.root(b));
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            self.parent[high as usize] = low;
            self.turned[high as usize] = turned_a ^ turned_b ^ opposite;
        }
    }
}

/// Two points on either side of a feature line, and whether their normals look to opposite sides of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Across {
    /// The points.
    pub points: [u32; 2],
    /// Whether one of the normals must be turned.
    pub opposite: bool,
}

/// Turns normals so that neighbours agree and outermost points look outward.
pub fn orient(positions: &[Vec3], nearest: &Nearest, normals: &mut [Vec3]) {
    orient_sides(positions, nearest, normals, &|_, _| false, &[]);
}

/// As [`orient`] where feature lines part the points: signs are carried on within each sheet, and over a line as
/// most pairs of points beside it tell, however sharply the surface turns there. Whether any normal was turned.
pub fn orient_sides(
    positions: &[Vec3],
    nearest: &Nearest,
    normals: &mut [Vec3],
    parts: &impl Fn(u32, u32) -> bool,
    across: &[Across],
) -> bool {
    let mut sets = tied(nearest, normals, parts, across);
    let (roots, turned): (Vec<u32>, Vec<bool>) = (0..normals.len() as u32).map(|n| sets.root(n)).unzip();
    drop(sets);
    for (normal, _) in normals.iter_mut().zip(&turned).filter(|(_, turned)| **turned) {
        *normal = -*normal;
    }
    let inward = inward(positions, normals, &roots);
    for (normal, _) in normals.iter_mut().zip(&roots).filter(|(_, root)| inward[**root as usize]) {
        *normal = -*normal;
    }
    roots.iter().zip(turned).any(|(root, turned)| turned != inward[*root as usize])
}

/// The spanning forest's ties: where no sign is in doubt, along the surface, over lines, and by what is left.
fn tied(
    nearest: &Nearest,
    normals: &[Vec3],
    parts: &impl Fn(u32, u32) -> bool,
    across: &[Across],
) -> SignedSets {
    let mut sets = SignedSets::new(normals.len());
    let tie = |sets: &mut SignedSets, a: u32, b: u32| {
        sets.tie(a, b, normals[a as usize].dot(normals[b as usize]) < 0.0);
    };
    let tie_sure = |sets: &mut SignedSets, apart: &dyn Fn(u32, u32) -> bool| {
        for a in 0..normals.len() as u32 {
            for b in taken(nearest, a) {
                let sure = normals[a as usize].dot(normals[b as usize]).abs() >= SURE;
                if sure && !apart(a, b) {
                    tie(sets, a, b);
                }
            }
        }
    };
    tie_sure(&mut sets, parts);
    let in_doubt = in_doubt(nearest, normals);
    if !across.is_empty() {
        let clear = in_doubt.partition_point(|edge| f32::from_bits(edge.0) < 1.0 - CLEAR);
        let along = in_doubt[..clear].iter().filter(|edge| !parts(edge.1, edge.2));
        along.for_each(|&(_, a, b)| tie(&mut sets, a, b));
        tie_across(&mut sets, across);
        // What lies on the lines follows what it lies beside.
        tie_sure(&mut sets, &|_, _| false);
    }
    in_doubt.iter().for_each(|&(_, a, b)| tie(&mut sets, a, b));
    sets
}

/// Ties sets over lines as most pairs tell, those first that most more tell of than do not.
fn tie_across(sets: &mut SignedSets, across: &[Across]) {
    let mut votes: Vec<([u32; 2], i64)> = Vec::with_capacity(across.len());
    for Across { points, opposite } in across {
        let [(a, turned_a), (b, turned_b)] = points.map(|point| sets.root(point));
        if a != b {
            votes.push(([a.min(b), a.max(b)], if turned_a ^ turned_b ^ opposite { -1 } else { 1 }));
        }
    }
    votes.sort_unstable();
    let all = votes
        .chunk_by(|a, b| a.0 == b.0)
        .map(|same| (same[0].0, same.iter().map(|vote| vote.1).sum::<i64>()));
    let mut all: Vec<([u32; 2], i64)> = all.collect();
    all.sort_unstable_by_key(|&(pair, vote)| (std::cmp::Reverse(vote.abs()), pair));
    for ([a, b], vote) in all {
        sets.tie(a, b, vote < 0);
    }
}

/// The weights and ends of the edges that are not sure, ascending.
fn in_doubt(nearest: &Nearest, normals: &[Vec3]) -> Vec<(u32, u32, u32)> {
    let points = (0..normals.len() as u32).into_par_iter();
    let edges = points.flat_map_iter(|a| {
        taken(nearest, a).filter_map(move |b| {
            let cosine = normals[a as usize].dot(normals[b as usize]).abs();
            // Positive floats sort like their bits.
            (cosine < SURE && !is_taken_twice(nearest, a, b)).then_some(((1.0 - cosine).to_bits(), a, b))
        })
    });
    let mut edges: Vec<(u32, u32, u32)> = edges.collect();
    edges.par_sort_unstable();
    edges
}

/// The others that a point makes edges of the graph with.
fn taken(nearest: &Nearest, point: u32) -> impl Iterator<Item = u32> + Clone + '_ {
    listed(&nearest[point as usize][..TAKEN.min(NEAREST)])
}

/// Whether an edge from `a` is one from `b` too, and `b` comes first.
fn is_taken_twice(nearest: &Nearest, a: u32, b: u32) -> bool {
    b < a && taken(nearest, b).any(|c| c == a)
}

/// For each root, whether its set's normals look inward.
fn inward(positions: &[Vec3], normals: &[Vec3], roots: &[u32]) -> Vec<bool> {
    let mut sets: Vec<u32> = roots.to_vec();
    sets.sort_unstable();
    sets.dedup();
    let set_of = |root: u32| sets.partition_point(|&other| other < root);
    let mut outermost = vec![[(f32::NEG_INFINITY, 0_u32); DIRECTIONS]; sets.len()];
    let middle = positions.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / positions.len().max(1) as f64;
    let mut away = vec![0.0; sets.len()];
    let directions: Vec<Vec3> = directions().collect();
    let mut last = (u32::MAX, 0);
    for (point, &root) in roots.iter().enumerate() {
        if root != last.0 {
            last = (root, set_of(root));
        }
        let set = last.1;
        away[set] += normals[point].as_dvec3().dot(positions[point].as_dvec3() - middle);
        for (best, direction) in outermost[set].iter_mut().zip(&directions) {
            let reach = positions[point].dot(*direction);
            if reach > best.0 {
                *best = (reach, point as u32);
            }
        }
    }
    let mut inward = vec![false; roots.len()];
    for (set, &root) in sets.iter().enumerate() {
        let look =
            |(best, direction): (&(f32, u32), &Vec3)| f64::from(normals[best.1 as usize].dot(*direction));
        let vote = outermost[set].iter().zip(&directions).map(look).sum::<f64>() / DIRECTIONS as f64;
        inward[root as usize] = if vote.abs() > OUTERMOST { vote < 0.0 } else { away[set] < 0.0 };
    }
    inward
}

fn directions() -> impl Iterator<Item = Vec3> {
    (0..27)
        .filter(|&n| n != 13)
        .map(|n| Vec3::new((n % 3) as f32 - 1.0, (n / 3 % 3) as f32 - 1.0, (n / 9) as f32 - 1.0).normalize())
}

/// Share of the neighbouring pairs whose normals do not look opposite ways.
#[must_use]
pub fn agreement(nearest: &Nearest, normals: &[Vec3]) -> f64 {
    let (pairs, opposite) = nearest
        .par_iter()
        .enumerate()
        .map(|(a, row)| {
            let around = || listed(&row[..TAKEN]);
            let opposite = around().filter(|&b| normals[a].dot(normals[b as usize]) < OPPOSITE).count();
            (around().count(), opposite)
        })
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    1.0 - opposite as f64 / pairs.max(1) as f64
}

/// Normals that make a smaller cosine than this (120°) look opposite ways.
const OPPOSITE: f32 = -0.5;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::canonical::mix;
    use crate::analyse::nearest::Search;

    /// Two spheres, one within the other, and a saddle-shaped patch beside them.
    fn scene() -> (Vec<Vec3>, Vec<Vec3>) {
        let unit = |n: u64| {
            let value = |m: u64| (mix(m) >> 11) as f64 / (1_u64 << 53) as f64;
            let (z, (sin, cos)) =
                (2.0 * value(2 * n) - 1.0, libm::sincos(value(2 * n + 1) * std::f64::consts::TAU));
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cos, r * sin, z).as_vec3()
        };
        let mut points = Vec::new();
        let mut normals = Vec::new();
        for (radius, count) in [(0.2, 1500), (0.4, 4000)] {
            points.extend((0..count).map(|n| radius * unit(n)));
            normals.extend((0..count).map(unit));
        }
        for n in 0..1600 {
            let (x, y) = ((n % 40) as f32 / 40.0 - 0.5, (n / 40) as f32 / 40.0 - 0.5);
            points.push(Vec3::new(x, y, 0.9 + 0.3 * (x * x - y * y)));
            normals.push(Vec3::new(-0.6 * x, 0.6 * y, 1.0).normalize());
        }
        (points, normals)
    }

    #[test]
    fn signs_drawn_at_random_are_found_again() {
        let (points, truth) = scene();
        let nearest = Search::new(&points).unwrap().nearest();
        let mut normals: Vec<Vec3> =
            truth.iter().enumerate().map(|(n, t)| if mix(n as u64) & 1 == 0 { *t } else { -*t }).collect();
        assert!(agreement(&nearest, &truth) > 0.99 && agreement(&nearest, &normals) < 0.7);
        orient(&points, &nearest, &mut normals);
        assert_eq!(normals, truth);
    }
}
