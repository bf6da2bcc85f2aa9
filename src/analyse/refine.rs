//! Splits long edges, so that pieces are small beside the splats that will cover them.

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{Edge, Edges, Half};
use super::flips::{flip, inside};
use super::surface::NONE;
use super::weld::Welded;

/// Rounds of halving after which refinement stops whatever the lengths: twelve for the longest, and as many
/// for edges that wait.
const ROUNDS: usize = 24;

/// Which edges are to be halved.
pub struct Fineness<'a> {
    /// Whether a side is too long for its triangle.
    pub too_long: &'a (dyn Fn(&Side) -> bool + Sync),
    /// No halving makes more triangles than this.
    pub most: usize,
}

/// A side of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The number of the triangle that its own is a part of.
    pub face: u32,
    /// The way along it, model units.
    pub way: DVec3,
    /// Whether it ends on a feature edge or where the surface does.
    pub at_line: bool,
}

/// A mesh whose edges are short enough.
pub struct Refined {
    /// The mesh.
    pub welded: Welded,
    /// Which of its edges, in the order of [`Edges::of`], are feature edges.
    pub marked: Vec<bool>,
    /// For each triangle the number of the one that it is a part of, ascending.
    pub part_of: Vec<u32>,
}

/// Halves edges that are too long for a triangle beside them until none is left or there would be too
/// many triangles.
///
/// A triangle with one, two or three long edges becomes two, three or four; new vertices lie
/// on the old edges, so the surface stays the same. Inside the faces there were at first, edges are turned
/// where that makes pieces less slender, and those that cross a slender piece wait until its long sides are
/// halved, so that pieces do not pile up across: a cylinder of 256 facets took 1.7 million without that, and
/// takes 136 thousand. `marked` tells which edges, in the order of [`Edges::of`], are feature edges.
#[must_use]
pub fn refine(mut welded: Welded, mut marked: Vec<bool>, fineness: &Fineness<'_>) -> Refined {
    let mut part_of: Vec<u32> = (0..welded.triangles.len() as u32).collect();
    let mut edges = Edges::of(&welded.triangles);
    for _ in 0..ROUNDS {
        let on_line = on_line(&welded, &edges, &marked);
        let long = |edge: &Edge| {
            let [a, b] = welded.places(edge.ends);
            let at_line = edge.ends.iter().any(|&end| on_line[end as usize]);
            let side = |half: &Half| Side { face: part_of[half.face as usize], way: b - a, at_line };
            edges.halves(edge).iter().any(|half| (fineness.too_long)(&side(half)))
        };
        let long: Vec<bool> = edges.edges.par_iter().map(long).collect();
        let long = without_waiting(&welded, &edges, &long, &part_of);
        let split = long.iter().filter(|long| **long).count();
        if split == 0 || welded.triangles.len() + 2 * split > fineness.most {
            break;
        }
        let middles = middles(&mut welded, &edges, &long);
        let parts = of_halves(&edges, &middles, welded.triangles.len())
            .into_iter()
            .map(|sides| 1 + sides.iter().filter(|side| **side != NONE).count());
        part_of =
            part_of.iter().zip(parts).flat_map(|(&whole, parts)| std::iter::repeat_n(whole, parts)).collect();
        let features = halved_features(&edges, &middles, &marked);
        split_all(&mut welded, &edges, &middles);
        edges = flip(&mut welded, &part_of);
        marked = marks(&edges, &features);
    }
    Refined { welded, marked, part_of }
}

/// Of edges that are too long, those that do not wait for another: one inside a face waits where just one
/// other side of a triangle beside it is too long, and that is part of the face's rim, or longer. Once that
/// is halved, an edge to its middle may be short.
fn without_waiting(welded: &Welded, edges: &Edges, long: &[bool], part_of: &[u32]) -> Vec<bool> {
    let numbers: Vec<u32> = (0..edges.edges.len() as u32).collect();
    let sides = of_halves(edges, &numbers, welded.triangles.len());
    let inside = |edge: &Edge| inside(edges, edge, part_of).is_some();
    // From the one that waits longest: no two are alike.
    let rank = |number: u32| {
        let edge = &edges.edges[number as usize];
        (!inside(edge), length(welded, edge), edge.ends)
    };
    let waits = |number: u32, half: &Half| {
        let others = sides[half.face as usize].iter().filter(|&&side| side != number && long[side as usize]);
        let mut others = others.map(|&side| rank(side));
        let only = others.next().filter(|_| others.next().is_none());
        only.is_some_and(|other| rank(number) < other)
    };
    let goes = |(number, edge): (usize, &Edge)| {
        let held = || inside(edge) && edges.halves(edge).iter().any(|half| waits(number as u32, half));
        long[number] && !held()
    };
    edges.edges.par_iter().enumerate().map(goes).collect()
}

/// Which vertices lie on feature edges or where the surface ends.
fn on_line(welded: &Welded, edges: &Edges, marked: &[bool]) -> Vec<bool> {
    let mut on_line = vec![false; welded.positions.len()];
    edges.cut(marked).flat_map(|edge| edge.ends).for_each(|end| on_line[end as usize] = true);
    on_line
}

/// Splits the triangles at the middles of their edges, given for each edge or [`NONE`]; which edges
/// of the finer mesh are feature edges, given those of the mesh.
pub(super) fn halve(welded: &mut Welded, edges: &Edges, middles: &[u32], marked: &[bool]) -> Vec<bool> {
    let features = halved_features(edges, middles, marked);
    split_all(welded, edges, middles);
    marks(&Edges::of(&welded.triangles), &features)
}

/// Splits the triangles at the middles of their edges, given for each edge or [`NONE`].
fn split_all(welded: &mut Welded, edges: &Edges, middles: &[u32]) {
    let sides = of_halves(edges, middles, welded.triangles.len());
    let sides: Vec<_> = sides.into_iter().map(|side| side.map(|m| (m != NONE).then_some(m))).collect();
    welded.triangles = split_triangles(&welded.triangles, &sides);
}

/// Which edges are among some, sorted.
fn marks(edges: &Edges, features: &[[u32; 2]]) -> Vec<bool> {
    edges.edges.iter().map(|edge| features.binary_search(&edge.ends).is_ok()).collect()
}

/// Appends the middle of an edge's ends, moved by an offset; its index.
pub(super) fn push_middle(welded: &mut Welded, ends: [u32; 2], offset: DVec3) -> u32 {
    let [a, b] = welded.places(ends);
    welded.positions.push((0.5 * (a + b) + offset).as_vec3());
    if !welded.colors.is_empty() {
        let [a, b] = ends.map(|v| welded.colors[v as usize]);
        welded.colors.push([0, 1, 2].map(|c| u8::midpoint(a[c], b[c])));
    }
    welded.positions.len() as u32 - 1
}

/// Appends the middles of long edges; for each edge its middle's index or [`NONE`].
fn middles(welded: &mut Welded, edges: &Edges, long: &[bool]) -> Vec<u32> {
    let middle = |(edge, &long): (&Edge, &bool)| match long {
        true => push_middle(welded, edge.ends, DVec3::ZERO),
        false => NONE,
    };
    edges.edges.iter().zip(long).map(middle).collect()
}

/// The length of an edge.
pub(super) fn length(welded: &Welded, edge: &Edge) -> f64 {
    let [a, b] = edge.ends.map(|v| welded.positions[v as usize]);
    f64::from(a.distance(b))
}

/// The feature edges of the refined mesh, sorted.
fn halved_features(edges: &Edges, middles: &[u32], marked: &[bool]) -> Vec<[u32; 2]> {
    let mut features = Vec::new();
    for ((edge, &middle), _) in edges.edges.iter().zip(middles).zip(marked).filter(|(_, mark)| **mark) {
        let [a, b] = edge.ends;
        if middle == NONE {
            features.push([a, b]);
        } else {
            // A middle's index is greater than every old vertex.
            features.extend([[a, middle], [b, middle]]);
        }
    }
    features.sort_unstable();
    features
}

/// What is given for each edge, for each side of each triangle.
pub(super) fn of_halves(edges: &Edges, given: &[u32], triangles: usize) -> Vec<[u32; 3]> {
    let mut sides = vec![[NONE; 3]; triangles];
    for (edge, &value) in edges.edges.iter().zip(given) {
        for half in edges.halves(edge) {
            sides[half.face as usize][half.corner as usize] = value;
        }
    }
    sides
}

/// Splits triangles by what lies in the middle of their sides, if anything (`side[n]` follows
/// `corners[n]`).
pub(super) fn split_triangles<T: Copy>(triangles: &[[T; 3]], sides: &[[Option<T>; 3]]) -> Vec<[T; 3]> {
    let mut out = Vec::with_capacity(triangles.len() * 2);
    for (&corners, &side) in triangles.iter().zip(sides) {
        push_split(corners, side, &mut out);
    }
    out
}

fn push_split<T: Copy>([a, b, c]: [T; 3], side: [Option<T>; 3], out: &mut Vec<[T; 3]>) {
    // Turned so that the one side that is split comes first, or the one that is not.
    match side {
        [None, None, None] => out.push([a, b, c]),
        [Some(ab), None, None] => out.extend([[a, ab, c], [ab, b, c]]),
        [None, Some(bc), Some(ca)] => out.extend([[a, b, bc], [a, bc, ca], [ca, bc, c]]),
        [Some(ab), Some(bc), Some(ca)] => out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]),
        [ab, bc, ca] => push_split([b, c, a], [bc, ca, ab], out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn area(welded: &Welded) -> f64 {
        let corner = |v: u32| welded.positions[v as usize].as_dvec3();
        welded
            .triangles
            .iter()
            .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).z)
            .sum()
    }

    #[test]
    fn refinement_keeps_the_surface_and_its_feature_edges() {
        for corners in [[0.0, 1.0, 0.3, 0.8], [0.1, 2.0, 1.0, 0.2], [0.0, 0.4, 0.2, 1.9]] {
            let positions = vec![
                Vec3::ZERO,
                Vec3::new(corners[1], corners[0], 0.0),
                Vec3::new(corners[2], corners[3], 0.0),
            ];
            let start = Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() };
            let whole = area(&start);
            let too_long = |side: &Side| side.way.length() > 0.11;
            let fineness = Fineness { too_long: &too_long, most: 100_000 };
            let Refined { welded: fine, marked, .. } = refine(start, vec![true, false, false], &fineness);
            assert!((area(&fine) - whole).abs() < 1e-6 * whole);
            assert!(fine.triangles.iter().all(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
            let edges = Edges::of(&fine.triangles);
            let length = |e: &super::super::edges::Edge| {
                let [a, b] = e.ends.map(|v| fine.positions[v as usize]);
                f64::from(a.distance(b))
            };
            assert!(edges.edges.iter().all(|e| length(e) <= 0.11));
            let lines: f64 =
                edges.edges.iter().zip(&marked).filter(|(_, m)| **m).map(|(e, _)| length(e)).sum();
            assert!((lines - f64::from(corners[0].hypot(corners[1]))).abs() < 1e-5);
        }
    }

    #[test]
    fn slender_faces_are_split_along_their_length() {
        // Leaning either way, and at a right angle.
        for lean in [-20.0, 0.0, 0.35, 20.0] {
            let positions = vec![Vec3::ZERO, Vec3::new(200.0, 0.0, 0.0), Vec3::new(lean, 0.7, 0.0)];
            let start = Welded { positions, triangles: vec![[0, 1, 2]], ..Welded::default() };
            let too_long = |side: &Side| side.way.length() > 1.0;
            let fineness = Fineness { too_long: &too_long, most: 1_000_000 };
            let Refined { welded, .. } = refine(start, vec![false; 3], &fineness);
            assert!((area(&welded) - 70.0).abs() < 1e-3);
            let edges = Edges::of(&welded.triangles);
            let longest = edges.edges.iter().map(|edge| length(&welded, edge)).fold(0.0, f64::max);
            assert!(longest <= 1.0, "{longest}");
            // Cut straight across at every 200th of its length it has about 400.
            assert!(welded.triangles.len() < 2000, "{lean}: {}", welded.triangles.len());
        }
    }

    #[test]
    fn sides_beside_lines_can_be_told_from_others() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
        let start = Welded { positions, triangles: vec![[0, 1, 3], [0, 3, 2]], ..Welded::default() };
        let too_long = |side: &Side| side.way.length() > if side.at_line { 0.1 } else { 0.4 };
        let fineness = Fineness { too_long: &too_long, most: 100_000 };
        let welded = refine(start, vec![false; 5], &fineness).welded;
        let on_rim = |at: DVec3| at.x * (1.0 - at.x) * at.y * (1.0 - at.y) == 0.0;
        let (rim, inside): (Vec<_>, Vec<_>) = Edges::of(&welded.triangles)
            .edges
            .iter()
            .map(|edge| welded.places(edge.ends))
            .partition(|ends| ends.iter().any(|&end| on_rim(end)));
        let longest = |sides: &[[DVec3; 2]]| sides.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f64::max);
        assert!(longest(&rim) <= 0.1, "{}", longest(&rim));
        assert!((0.2..=0.4).contains(&longest(&inside)), "{}", longest(&inside));
    }
}
