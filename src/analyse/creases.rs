//! Finds the feature edges of a mesh by the angle between its faces.
//!
//! The angle alone also finds the bumps of a noisy scan, so what it finds must go on along
//! the surface the way an edge of a thing does: see [`super::chains`].

use glam::DVec3;
use rayon::prelude::*;

use super::chains;
use super::edges::{Edges, crease_cosine, face_normals};
use super::weld::Welded;

/// A crease goes on, from where it is sharp enough by itself, along edges at least this
/// share as sharp: hysteresis, after Canny 1986.
const WEAK_SHARE: f64 = 0.4;

/// Cosine of the least angle at which a crease of this angle (degrees) may go on.
#[must_use]
pub fn weak_cosine(degrees: f64) -> f64 {
    libm::cos((WEAK_SHARE * degrees).to_radians())
}

/// A crease goes on only along edges that bend from it by less than this (cosine of 45°).
const STRAIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Marks the edges whose faces' normals differ by more than an angle in degrees, and those
/// that carry such a crease on, straight and hardly less sharp.
///
/// Edges that do not join two agreeing faces are not marked: they end the surface anyway.
#[must_use]
pub fn creases(welded: &Welded, edges: &Edges, degrees: f64) -> Vec<bool> {
    let normals = face_normals(&welded.positions, &welded.triangles);
    let cosines: Vec<Option<f64>> =
        edges.edges.par_iter().map(|edge| crease_cosine(edges, edge, &normals)).collect();
    let sharper = |degrees: f64| {
        let limit = libm::cos(degrees.to_radians());
        cosines.iter().map(move |cosine| cosine.is_some_and(|cosine| cosine < limit))
    };
    let mut marked: Vec<bool> = sharper(degrees).collect();
    let weak: Vec<bool> = sharper(WEAK_SHARE * degrees).collect();
    carry_on(welded, edges, &weak, &mut marked);
    chains::drop_ragged(&welded.positions, edges, &mut marked);
    marked
}

/// Marks weak edges that carry a marked one straight on beyond its end.
fn carry_on(welded: &Welded, edges: &Edges, weak: &[bool], marked: &mut [bool]) {
    let mut at_vertex: Vec<(u32, u32)> = edges
        .edges
        .iter()
        .enumerate()
        .filter(|&(index, _)| weak[index] || marked[index])
        .flat_map(|(index, edge)| edge.ends.map(|end| (end, index as u32)))
        .collect();
    at_vertex.sort_unstable();
    let around = |vertex: u32| {
        let from = at_vertex.partition_point(|entry| entry.0 < vertex);
        at_vertex[from..].iter().take_while(move |entry| entry.0 == vertex).map(|entry| entry.1)
    };
    let away = |index: u32, vertex: u32| -> DVec3 {
        let [a, b] = edges.edges[index as usize].ends;
        let other = if a == vertex { b } else { a };
        (welded.positions[other as usize] - welded.positions[vertex as usize]).as_dvec3().normalize_or_zero()
    };
    let mut open: Vec<(u32, u32)> = edges
        .edges
        .iter()
        .enumerate()
        .filter(|&(index, _)| marked[index])
        .flat_map(|(index, edge)| edge.ends.map(|end| (index as u32, end)))
        .collect();
    while let Some((edge, vertex)) = open.pop() {
        if around(vertex).filter(|&index| marked[index as usize]).count() > 1 {
            continue;
        }
        let back = away(edge, vertex);
        let onward = around(vertex)
            .filter(|&index| index != edge)
            .map(|index| (away(index, vertex).dot(-back), index))
            .filter(|&(straight, _)| straight > STRAIGHT)
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        if let Some((_, index)) = onward {
            marked[index as usize] = true;
            let [a, b] = edges.edges[index as usize].ends;
            open.push((index, if a == vertex { b } else { a }));
        }
    }
}
