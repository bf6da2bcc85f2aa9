//! Turns edges inside flat faces until the pieces of each are as little slender as they can be.

use glam::DVec3;

use super::edges::{Edge, Edges, Half};
use super::weld::Welded;

/// The angles that face an edge from both sides add up to half a turn, and their cotangents to 0, where
/// either way of cutting the four corners is as good. What rounding makes of that is no reason to turn it.
const ALIKE: f64 = 1e-6;

/// Passes after which edges stay as they are: each turns all that do not touch another, and few are left
/// after some.
const MOST_PASSES: usize = 32;

/// Turns edges between two pieces of one face while the circle through the corners of one holds the far
/// corner of the other (Lawson 1977, "Software for C¹ surface interpolation"): at last the pieces are the
/// Delaunay triangulation of the corners that the face has. The surface stays the same.
///
/// `part_of` tells for each triangle the face that it is a piece of; faces are flat. The edges as they are
/// then.
pub(super) fn flip(welded: &mut Welded, part_of: &[u32]) -> Edges {
    let mut edges = Edges::of(&welded.triangles);
    for _ in 0..MOST_PASSES {
        let mut touched = vec![false; welded.triangles.len()];
        for (a, b) in edges.edges.iter().filter_map(|edge| inside(&edges, edge, part_of)) {
            let faces = [a.face, b.face].map(|face| face as usize);
            if faces.iter().any(|&face| touched[face]) {
                continue;
            }
            let Some(turned) = turned(welded, [a, b]) else { continue };
            for (face, corners) in faces.into_iter().zip(turned) {
                welded.triangles[face] = corners;
                touched[face] = true;
            }
        }
        if !touched.contains(&true) {
            break;
        }
        edges = Edges::of(&welded.triangles);
    }
    edges
}

/// The two sides of an edge between two pieces of one face.
pub(super) fn inside(edges: &Edges, edge: &Edge, part_of: &[u32]) -> Option<(Half, Half)> {
    edges.pair(edge).filter(|(a, b)| part_of[a.face as usize] == part_of[b.face as usize])
}

/// The two triangles at an edge, cut the other way, if that is better.
fn turned(welded: &Welded, halves: [Half; 2]) -> Option<[[u32; 3]; 2]> {
    let [[from, to, apex], [_, _, far]] = halves.map(|half| {
        let corners = welded.triangles[half.face as usize];
        [0, 1, 2].map(|n| corners[(half.corner as usize + n) % 3])
    });
    let [p, q, r, s] = welded.places([from, to, apex, far]);
    let cotangents = cotangent(p - r, q - r) + cotangent(p - s, q - s);
    (cotangents < -ALIKE).then_some([[from, far, apex], [far, to, apex]])
}

/// Of the angle between two vectors; not finite where they are parallel.
fn cotangent(a: DVec3, b: DVec3) -> f64 {
    a.dot(b) / a.cross(b).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// The four corners of a slender rectangle, cut into slender pieces around a place on one side.
    fn strip() -> Welded {
        let places = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [4.0, 0.0], [4.0, 0.1], [2.0, 0.1], [0.0, 0.1]];
        let positions = places.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect();
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [0, 4, 5], [0, 5, 6]];
        Welded { positions, triangles, ..Welded::default() }
    }

    fn areas(welded: &Welded) -> Vec<f64> {
        let area = |&triangle: &[u32; 3]| {
            let [a, b, c] = welded.places(triangle);
            0.5 * (b - a).cross(c - a).z
        };
        welded.triangles.iter().map(area).collect()
    }

    #[test]
    fn no_circle_through_the_corners_of_a_piece_holds_another() {
        let mut welded = strip();
        let edges = flip(&mut welded, &[0; 5]);
        let areas = areas(&welded);
        assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 0.4).abs() < 1e-6);
        assert!(edges.find(2, 5).is_some() && edges.find(0, 4).is_none(), "{:?}", welded.triangles);
        for edge in &edges.edges {
            assert!(edges.pair(edge).is_none_or(|(a, b)| turned(&welded, [a, b]).is_none()));
        }
    }

    #[test]
    fn edges_between_faces_stay() {
        let mut welded = strip();
        flip(&mut welded, &[0, 1, 2, 3, 4]);
        assert_eq!(welded.triangles, strip().triangles);
    }
}
