//! One normal for each vertex from the normals of face corners.

use glam::Vec3;

/// No face gives the vertex a normal.
const NO_NORMAL: u32 = u32::MAX;
/// Faces give the vertex different normals.
const CREASE: u32 = u32::MAX - 1;

/// For each vertex that a face names, so far: the index of its normal, or a mark.
#[derive(Default)]
pub(super) struct CornerNormals(Vec<u32>);

impl CornerNormals {
    /// Notes the normal that a corner gives its vertex.
    pub fn note(&mut self, vertex: u32, normal: u32, normals: &[Vec3], vertices: usize) {
        let vertex = vertex as usize;
        if vertex >= vertices {
            // Named before its record, which is rare: its normal is left to the analysis.
            return;
        }
        if self.0.len() <= vertex {
            self.0.resize(vertices, NO_NORMAL);
        }
        let known = self.0[vertex];
        let value = |index: u32| normals.get(index as usize);
        self.0[vertex] = match known {
            NO_NORMAL => normal,
            _ if known == normal => known,
            _ if value(known).is_some() && value(known) == value(normal) => known,
            _ => CREASE,
        };
    }

    /// A normal for each vertex, zero where the corners disagree; none at all where none is left.
    ///
    /// Different normals are not averaged: a sum would depend on the order of the faces.
    pub fn of_vertices(&self, normals: &[Vec3], vertices: usize) -> Vec<Vec3> {
        let find = |&index: &u32| normals.get(index as usize).copied();
        if self.0.iter().all(|index| find(index).is_none()) {
            return Vec::new();
        }
        let mut out: Vec<Vec3> = self.0.iter().map(|index| find(index).unwrap_or(Vec3::ZERO)).collect();
        out.resize(vertices, Vec3::ZERO);
        out
    }
}
