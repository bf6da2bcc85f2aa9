//! Curved triangles: cubic patches over the faces of a mesh, at right angles to its normals.
//!
//! Vlachos, Peters, Boyd and Mitchell 2001, "Curved PN triangles", with two changes. The handles
//! of an edge's curve are as long as those of a circle's arc ask for, so that spheres and
//! cylinders come out round; and along an edge where two sides' normals differ the curve runs
//! where their tangent planes meet, so that both sides end on the same curve.

use glam::DVec3;
use rayon::prelude::*;

use super::edges::{Edge, Edges, Half};
use super::refine::of_halves;
use super::sides::Sides;
use super::weld::Welded;

/// A curve leaves its edge at no more than this angle's cosine (60°): steeper ones are folds that
/// the normals do not describe, and stay straight.
const STEEPEST: f64 = 0.5;

/// Two sides whose normals differ by less than this angle's sine (13°) meet in no direction that
/// could be told.
const PARALLEL: f64 = 0.22;

/// The cubic patch over one face, in Bézier form: the control points of corners, then for each side
/// the two along it, then the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    corners: [DVec3; 3],
    /// `sides[n]` lie between corners `n` and `n + 1`.
    sides: [[DVec3; 2]; 3],
    middle: DVec3,
}

impl Patch {
    /// The place at barycentric coordinates, which add up to 1.
    pub(super) fn at(&self, weights: DVec3) -> DVec3 {
        let w = weights.to_array();
        let mut place = 6.0 * w[0] * w[1] * w[2] * self.middle;
        for n in 0..3 {
            let (a, b) = (w[n], w[(n + 1) % 3]);
            place += a * a * a * self.corners[n]
                + 3.0 * a * a * b * self.sides[n][0]
                + 3.0 * a * b * b * self.sides[n][1];
        }
        place
    }
}

/// The patches over all faces of a mesh.
pub(super) fn patches(welded: &Welded, edges: &Edges, sides: &Sides) -> Vec<Patch> {
    let curves: Vec<[DVec3; 2]> =
        edges.edges.par_iter().map(|edge| curve(welded, sides, edge, edges.halves(edge))).collect();
    let numbers: Vec<u32> = (0..edges.edges.len() as u32).collect();
    let around = of_halves(edges, &numbers, welded.triangles.len());
    welded
        .triangles
        .par_iter()
        .zip(around)
        .map(|(vertices, around)| {
            let corners = welded.places(*vertices);
            let sides = [0, 1, 2].map(|n| {
                let [first, second] = curves[around[n] as usize];
                if vertices[n] < vertices[(n + 1) % 3] { [first, second] } else { [second, first] }
            });
            // Vlachos et al., 3.1: the middle lies half as far again from the flat one as the mean of
            // the curves' points does.
            let mean = sides.as_flattened().iter().sum::<DVec3>() / 6.0;
            let flat = corners.iter().sum::<DVec3>() / 3.0;
            Patch { corners, sides, middle: mean + 0.5 * (mean - flat) }
        })
        .collect()
}

/// The two inner control points of an edge's curve, that at the lesser vertex first.
fn curve(welded: &Welded, sides: &Sides, edge: &Edge, halves: &[Half]) -> [DVec3; 2] {
    let [a, b] = welded.places(edge.ends);
    let normals = |half: &Half| sides.along(half).map(|side| sides.normals[side as usize]);
    let [at_a, at_b] = match halves {
        [one] => normals(one).map(|normal| [normal; 2]),
        [one, other] => {
            let (one, other) = (normals(one), normals(other));
            [[one[0], other[0]], [one[1], other[1]]]
        }
        // Where more faces meet, no one knows how their edge bends.
        _ => return [a + (b - a) / 3.0, b + (a - b) / 3.0],
    };
    [a + handle(b - a, at_a), b + handle(a - b, at_b)]
}

/// From an end of an edge to the control point beside it; `edge` leads to the other end.
fn handle(edge: DVec3, normals: [DVec3; 2]) -> DVec3 {
    let along = edge.normalize_or_zero();
    let crossed = normals[0].cross(normals[1]);
    let tangent = if crossed.length() < PARALLEL {
        let normal = (normals[0] + normals[1]).normalize_or_zero();
        (along - along.dot(normal) * normal).normalize_or_zero()
    } else {
        let line = crossed.normalize();
        if line.dot(along) < 0.0 { -line } else { line }
    };
    let cosine = tangent.dot(along);
    if cosine < STEEPEST {
        return edge / 3.0;
    }
    // An arc that turns by `4 t` has handles of `4/3 tan(t)` radii on a chord of `2 sin(2 t)` radii.
    // That is a third of the chord over `cos²(t)`, here of half the angle between edge and tangent.
    tangent * edge.length() / (1.5 * (1.0 + cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_of_a_circle_comes_out_round() {
        for half in [0.05, 0.2, 0.4, 0.7_f64] {
            let at = |angle: f64| DVec3::new(angle.sin(), angle.cos(), 0.0);
            let (a, b) = (at(-half), at(half));
            let inner = [a + handle(b - a, [a; 2]), b + handle(a - b, [b; 2])];
            for n in 0..=20 {
                let t = f64::from(n) / 20.0;
                let s = 1.0 - t;
                let place =
                    s * s * s * a + 3.0 * s * s * t * inner[0] + 3.0 * s * t * t * inner[1] + t * t * t * b;
                // The best cubic of a quarter circle is off by 2.7e-4, and by the sixth power of the angle.
                let bound = 3e-4 * (half / std::f64::consts::FRAC_PI_4).powi(6) + 1e-12;
                assert!((place.length() - 1.0).abs() < bound, "{half} {t}: {}", place.length());
            }
        }
    }

    #[test]
    fn an_edge_of_two_sides_runs_where_their_planes_meet() {
        // The rim of a cylinder's lid: one side is flat, the other bends.
        let (sin, cos) = 0.3_f64.sin_cos();
        let edge = DVec3::new(0.0, 2.0 * sin, 0.0);
        let wall = DVec3::new(cos, -sin, 0.0);
        let found = handle(edge, [DVec3::Z, wall]);
        assert!(found.dot(DVec3::Z).abs() < 1e-12 && found.dot(wall).abs() < 1e-12, "{found}");
        let alone = handle(edge, [wall; 2]);
        assert!(found.distance(alone) < 1e-12);
    }
}
