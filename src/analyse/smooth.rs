//! A mesh refined until its facets cannot be told from the curved triangles over it.

use glam::DVec3;
use rayon::prelude::*;

use super::curved::{Patch, patches};
use super::edges::{Edge, Edges, Half};
use super::refine::{halve, length, push_middle, split_triangles};
use super::sides::Sides;
use super::surface::NONE;
use super::weld::Welded;

/// Rounds after which facets are as fine as they get: each divides their distance by four.
const ROUNDS: usize = 12;

/// Where on an edge its distance from the surface is looked at: a curve that bends both ways has
/// none in the middle.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// A corner of a facet: where it lies on a patch.
#[derive(Clone, Copy, Debug)]
struct Corner {
    patch: u32,
    /// Barycentric.
    weights: DVec3,
}

/// How fine the facets are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// How far they may lie from the curved triangles, about, model units.
    pub tolerance: f64,
    /// How long their sides may be, model units: were only those split that bend, the facets of a
    /// cylinder would be as long as it, and slender.
    pub longest: f64,
    /// The most facets.
    pub most: usize,
}

/// Refines a mesh until its facets are fine enough; also which of its edges are feature edges, given
/// those of the mesh.
#[must_use]
pub fn smooth(
    mut welded: Welded,
    mut marked: Vec<bool>,
    sides: &Sides,
    fineness: &Fineness,
) -> (Welded, Vec<bool>) {
    let patches = patches(&welded, &Edges::of(&welded.triangles), sides);
    let mut corners = whole(patches.len());
    for _ in 0..ROUNDS {
        let edges = Edges::of(&welded.triangles);
        let over = Over { patches: &patches, corners: &corners, welded: &welded };
        let coarse = |edge: &Edge| {
            length(&welded, edge) > fineness.longest || over.height(&edges, edge) > fineness.tolerance
        };
        let coarse: Vec<bool> = edges.edges.par_iter().map(coarse).collect();
        let count = coarse.iter().filter(|coarse| **coarse).count();
        if count == 0 || welded.triangles.len() + 2 * count > fineness.most {
            break;
        }
        let offsets: Vec<DVec3> = edges.edges.par_iter().map(|edge| over.offset(&edges, edge, 0.5)).collect();
        let mut middles = vec![NONE; coarse.len()];
        let mut corner_middles = vec![[None; 3]; corners.len()];
        for (index, edge) in edges.edges.iter().enumerate().filter(|&(index, _)| coarse[index]) {
            middles[index] = push_middle(&mut welded, edge.ends, offsets[index]);
            for half in edges.halves(edge) {
                let [a, b] = ends(&corners, half);
                let middle = Corner { patch: a.patch, weights: 0.5 * (a.weights + b.weights) };
                corner_middles[half.face as usize][half.corner as usize] = Some(middle);
            }
        }
        corners = split_triangles(&corners, &corner_middles);
        marked = halve(&mut welded, &edges, &middles, &marked);
    }
    (welded, marked)
}

/// The corners of whole patches, as many as there are.
fn whole(patches: usize) -> Vec<[Corner; 3]> {
    let corners = |patch| [DVec3::X, DVec3::Y, DVec3::Z].map(|weights| Corner { patch, weights });
    (0..patches as u32).map(corners).collect()
}

/// Where half an edge begins and where it ends.
fn ends(corners: &[[Corner; 3]], half: &Half) -> [Corner; 2] {
    [0, 1].map(|step| corners[half.face as usize][(half.corner as usize + step) % 3])
}

/// The greatest distance of a mesh's edges from the curved triangles over it, model units.
pub(super) fn height(welded: &Welded, edges: &Edges, sides: &Sides) -> f64 {
    let patches = patches(welded, edges, sides);
    let over = Over { patches: &patches, corners: &whole(patches.len()), welded };
    edges.edges.iter().map(|edge| over.height(edges, edge)).fold(0.0, f64::max)
}

/// Facets over their patches.
struct Over<'a> {
    patches: &'a [Patch],
    corners: &'a [[Corner; 3]],
    welded: &'a Welded,
}

impl Over<'_> {
    /// From a place on an edge, `t` of the way from its lesser vertex, to the same on the surface.
    fn offset(&self, edges: &Edges, edge: &Edge, t: f64) -> DVec3 {
        // All faces at an edge have one curve there.
        let half = edges.halves(edge)[0];
        let [from, to] = ends(self.corners, &half);
        let [from, to] = if half.forward { [from, to] } else { [to, from] };
        let place = self.patches[from.patch as usize].at(from.weights.lerp(to.weights, t));
        let [a, b] = self.welded.places(edge.ends);
        place - a.lerp(b, t)
    }

    /// The greatest distance of an edge from the surface.
    fn height(&self, edges: &Edges, edge: &Edge) -> f64 {
        PLACES.into_iter().map(|t| self.offset(edges, edge, t).length()).fold(0.0, f64::max)
    }
}
