//! Turns triangles that face the other way than those around them, as exports of many programs leave them.
//!
//! Where two triangles that join at an edge walk it the same way, one of them is inside out: unmended, the edge
//! would pass for a border, and a smooth surface for one that ends at every such edge.

use glam::Vec3;
use rayon::prelude::*;

/// Areas are summed in this share of a square model unit, as whole numbers, so that the order of triangles does not
/// matter; models lie within two units.
const AREA_STEP: f64 = 1.0 / (1_u64 << 40) as f64;

/// Turns triangles until those that join two by two at an edge face alike, as far as their surface has two sides; how
/// many.
///
/// Patches whose triangles face alike stay whole: where some meet that do not, those of the lesser area are turned,
/// and of equal ones those without the first triangle by its corners' places. Around a surface with one side, such as
/// a Moebius strip, some edge keeps triangles that do not. `places` tells which vertices lie at one place, as
/// [`crate::model::places::numbered`] does; each triangle has three.
pub(super) fn face_alike(positions: &[Vec3], places: &[u32], triangles: &mut [[u32; 3]]) -> usize {
    let joints = joints(places, triangles);
    if joints.iter().all(|joint| joint.alike) {
        return 0;
    }
    let mut patches = Patches::of(positions, places, triangles);
    for alike in [true, false] {
        joints.iter().filter(|joint| joint.alike == alike).for_each(|joint| patches.join(joint));
    }
    let mut turned = 0;
    for (face, corners) in (0..).zip(triangles) {
        if patches.is_to_be_turned(face) {
            corners.swap(1, 2);
            turned += 1;
        }
    }
    turned
}

/// Two triangles that join at an edge.
struct Joint {
    faces: [u32; 2],
    /// Whether they face alike: whether they walk the edge in opposite ways.
    alike: bool,
}

/// A triangle's side.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The places of the edge's ends, the lesser first.
    ends: [u32; 2],
    face: u32,
    /// Whether the triangle walks it from the lesser to the greater.
    forward: bool,
    /// The place of the corner opposite.
    opposite: u32,
}

/// The edges at which two triangles join and no more, in the order of their places; but for triangles that are the
/// same twice.
fn joints(places: &[u32], triangles: &[[u32; 3]]) -> Vec<Joint> {
    let side = |face: usize, corner: usize| {
        let [from, to, opposite] = [0, 1, 2].map(|n| places[triangles[face][(corner + n) % 3] as usize]);
        Side { ends: [from.min(to), from.max(to)], face: face as u32, forward: from < to, opposite }
    };
    let sides = (0..triangles.len()).into_par_iter();
    let mut sides: Vec<Side> = sides.flat_map_iter(|face| (0..3).map(move |n| side(face, n))).collect();
    sides.par_sort_unstable();
    let joint = |sides: &[Side]| match sides {
        [a, b] if a.opposite != b.opposite => {
            Some(Joint { faces: [a.face, b.face], alike: a.forward != b.forward })
        }
        _ => None,
    };
    sides.chunk_by(|a, b| a.ends == b.ends).filter_map(joint).collect()
}

/// Sets of triangles that join, and for each triangle whether it faces as the first of its set does (disjoint sets with
/// parities).
struct Patches {
    /// For each triangle one nearer to the first of its set, and whether it faces the other way than that.
    up: Vec<(u32, bool)>,
    /// For the first of a set the areas that face as it does, and the other way.
    areas: Vec<[u128; 2]>,
    /// Of each triangle, by the places of its corners.
    rank: Vec<u32>,
}

impl Patches {
    /// Each triangle by itself.
    fn of(positions: &[Vec3], places: &[u32], triangles: &[[u32; 3]]) -> Self {
        let area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| positions[v as usize].as_dvec3());
            [(0.5 * (b - a).cross(c - a).length() / AREA_STEP) as u128, 0]
        };
        let key = |face: u32| {
            let mut corners = triangles[face as usize].map(|v| places[v as usize]);
            corners.sort_unstable();
            (corners, face)
        };
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        order.par_sort_unstable_by_key(|&face| key(face));
        let mut rank = vec![0; order.len()];
        (0..).zip(&order).for_each(|(n, &face)| rank[face as usize] = n);
        let up = (0..triangles.len() as u32).map(|face| (face, false)).collect();
        Self { up, areas: triangles.iter().map(area).collect(), rank }
    }

    /// The first of a triangle's set, and whether the triangle faces the other way.
    fn first(&mut self, face: u32) -> (u32, bool) {
        let (mut first, mut apart) = (face, false);
        while self.up[first as usize].0 != first {
            let (next, other) = self.up[first as usize];
            (first, apart) = (next, apart != other);
        }
        // Each on the way comes directly below the first.
        let (mut at, mut left) = (face, apart);
        while at != first {
            let (next, other) = std::mem::replace(&mut self.up[at as usize], (first, left));
            (at, left) = (next, left != other);
        }
        (first, apart)
    }

    /// Joins the sets of two triangles so that these face alike, unless they are of one set.
    fn join(&mut self, &Joint { faces, alike }: &Joint) {
        let [(a, a_apart), (b, b_apart)] = faces.map(|face| self.first(face));
        if a == b {
            return;
        }
        let [first, rest] = if self.rank[a as usize] < self.rank[b as usize] { [a, b] } else { [b, a] };
        // As they face now, the first of one set faces the other way than that of the other.
        let apart = a_apart ^ b_apart ^ !alike;
        self.up[rest as usize] = (first, apart);
        let [as_first, other] = self.areas[rest as usize];
        let [alike_area, apart_area] = if apart { [other, as_first] } else { [as_first, other] };
        self.areas[first as usize][0] += alike_area;
        self.areas[first as usize][1] += apart_area;
    }

    /// Whether a triangle faces as the lesser area of its set does.
    fn is_to_be_turned(&mut self, face: u32) -> bool {
        let (first, apart) = self.first(face);
        let [as_first, other] = self.areas[first as usize];
        apart != (other > as_first)
    }
}
