//! Splits long edges, so that pieces are small beside the splats that will cover them.

use super::edges::Edges;
use super::weld::Welded;

/// Rounds of halving after which refinement stops whatever the lengths.
const ROUNDS: usize = 12;

/// Halves edges longer than `longest` (model units) until none is left or the mesh would
/// have more than `most` triangles.
///
/// A triangle with one, two or three long edges becomes two, three or four; new vertices lie
/// on the old edges, so the surface stays the same. `marked` tells which edges, in the order
/// of [`Edges::of`], are feature edges; the answer is the same list for the refined mesh.
#[must_use]
pub fn refine(mut welded: Welded, mut marked: Vec<bool>, longest: f64, most: usize) -> (Welded, Vec<bool>) {
    for _ in 0..ROUNDS {
        let edges = Edges::of(&welded.triangles);
        let middles = split_long(&mut welded, &edges, longest);
        let split = middles.iter().filter(|&&m| m != u32::MAX).count();
        if split == 0 || welded.triangles.len() + 2 * split > most {
            break;
        }
        let features = halved_features(&edges, &middles, &marked);
        welded.triangles = split_triangles(&welded.triangles, &edges, &middles);
        let refined = Edges::of(&welded.triangles);
        marked = refined.edges.iter().map(|edge| features.binary_search(&edge.ends).is_ok()).collect();
    }
    (welded, marked)
}

/// Appends the middles of long edges; for each edge its middle's index or `u32::MAX`.
fn split_long(welded: &mut Welded, edges: &Edges, longest: f64) -> Vec<u32> {
    let mut middles = vec![u32::MAX; edges.edges.len()];
    for (middle, edge) in middles.iter_mut().zip(&edges.edges) {
        let [a, b] = edge.ends.map(|v| welded.positions[v as usize]);
        if f64::from(a.distance(b)) > longest {
            *middle = welded.positions.len() as u32;
            welded.positions.push((0.5 * (a.as_dvec3() + b.as_dvec3())).as_vec3());
            if !welded.colors.is_empty() {
                let [a, b] = edge.ends.map(|v| welded.colors[v as usize]);
                welded.colors.push([0, 1, 2].map(|c| u8::midpoint(a[c], b[c])));
            }
        }
    }
    middles
}

/// The feature edges of the refined mesh, sorted.
fn halved_features(edges: &Edges, middles: &[u32], marked: &[bool]) -> Vec<[u32; 2]> {
    let mut features = Vec::new();
    for ((edge, &middle), _) in edges.edges.iter().zip(middles).zip(marked).filter(|(_, mark)| **mark) {
        let [a, b] = edge.ends;
        if middle == u32::MAX {
            features.push([a, b]);
        } else {
            // A middle's index is greater than every old vertex.
            features.extend([[a, middle], [b, middle]]);
        }
    }
    features.sort_unstable();
    features
}

fn split_triangles(triangles: &[[u32; 3]], edges: &Edges, middles: &[u32]) -> Vec<[u32; 3]> {
    let mut sides = vec![[u32::MAX; 3]; triangles.len()];
    for (edge, &middle) in edges.edges.iter().zip(middles) {
        for half in edges.halves(edge) {
            sides[half.face as usize][half.corner as usize] = middle;
        }
    }
    let mut out = Vec::with_capacity(triangles.len() * 2);
    for (&corners, &side) in triangles.iter().zip(&sides) {
        push_split(corners, side, &mut out);
    }
    out
}

/// Splits one triangle by the middles of its sides (`side[n]` follows `corners[n]`).
fn push_split(corners: [u32; 3], side: [u32; 3], out: &mut Vec<[u32; 3]>) {
    let split = side.map(|m| m != u32::MAX);
    // Turned so that one split side, or the one side that is not, comes first.
    let turn = match split {
        [false, false, false] => return out.push(corners),
        [_, false, false] | [false, true, true] | [true, true, true] => 0,
        [false, _, false] | [true, false, true] => 1,
        [false, false, _] | [true, true, false] => 2,
    };
    let at = |n: usize| (n + turn) % 3;
    let [a, b, c] = [corners[at(0)], corners[at(1)], corners[at(2)]];
    let [ab, bc, ca] = [side[at(0)], side[at(1)], side[at(2)]];
    match split.iter().filter(|s| **s).count() {
        1 => out.extend([[a, ab, c], [ab, b, c]]),
        2 => out.extend([[a, b, bc], [a, bc, ca], [ca, bc, c]]),
        _ => out.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]),
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
            let (fine, marked) = refine(start, vec![true, false, false], 0.11, 100_000);
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
}
