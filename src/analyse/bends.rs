//! How much the faces of a mesh bend into their neighbours.

use super::edges::{Edges, face_normals};
use super::weld::Welded;

/// For each triangle its greatest curvature towards a neighbour, in 1 / model units: the angle between
/// the two over the lesser of their heights over the edge. Nothing bends over marked edges and borders.
#[must_use]
pub fn bends(welded: &Welded, marked: &[bool]) -> Vec<f64> {
    let edges = Edges::of(&welded.triangles);
    let normals = face_normals(&welded.positions, &welded.triangles);
    let mut bends = vec![0.0_f64; welded.triangles.len()];
    for (edge, _) in edges.edges.iter().zip(marked).filter(|(_, mark)| !**mark) {
        let Some((a, b)) = edges.pair(edge) else { continue };
        let [normal, other] = [a, b].map(|half| normals[half.face as usize]);
        let angle = libm::atan2(normal.cross(other).length(), normal.dot(other));
        let height = welded.height(a.face, edge.ends).min(welded.height(b.face, edge.ends));
        // Over a face without area there is no telling.
        let bend = if angle > 0.0 { angle / height } else { 0.0 };
        for half in [a, b] {
            let own = &mut bends[half.face as usize];
            *own = own.max(bend);
        }
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    /// The edge that two squares of two triangles each share.
    const SHARED: [u32; 2] = [2, 3];

    /// A unit square, and one of some width beside it that is turned up by an angle.
    fn bent(width: f64, angle: f64) -> Welded {
        let (sin, cos) = libm::sincos(angle);
        let columns = [DVec3::NEG_X, DVec3::ZERO, width * DVec3::new(cos, 0.0, sin)];
        let positions = columns.iter().flat_map(|&at| [at.as_vec3(), at.as_vec3() + Vec3::Y]).collect();
        let triangles = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        Welded { positions, triangles, ..Welded::default() }
    }

    fn found(welded: &Welded, marked: Option<[u32; 2]>) -> Vec<f64> {
        let edges = Edges::of(&welded.triangles);
        bends(welded, &edges.edges.iter().map(|edge| Some(edge.ends) == marked).collect::<Vec<_>>())
    }

    #[test]
    fn faces_bend_by_the_angle_over_the_lesser_height() {
        for (width, angle, expected) in [(3.0, 0.2, 0.2), (0.25, -0.1, 0.4)] {
            let found = found(&bent(width, angle), None);
            let near = |face: usize, expected: f64| (found[face] - expected).abs() < 1e-6;
            assert!(near(0, expected) && near(1, 0.0) && near(2, 0.0) && near(3, expected), "{found:?}");
        }
    }

    #[test]
    fn nothing_bends_over_lines() {
        assert_eq!(found(&bent(1.0, 0.5), Some(SHARED)), [0.0; 4]);
    }
}
