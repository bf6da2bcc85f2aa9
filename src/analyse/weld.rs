//! Joins vertices of equal position, in an order that does not depend on the input's.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{back_to_back, canonical};
use crate::model::mesh::Mesh;

/// A mesh whose vertices are distinct positions in canonical order.
#[derive(Clone, Debug, Default)]
pub struct Welded {
    /// Distinct positions along the Morton curve; behind them once more those of sheets that lie back to
    /// back with others.
    pub positions: Vec<Vec3>,
    /// Colours, the mean over the vertices joined; or empty.
    pub colors: Vec<[u8; 3]>,
    /// Triangles with the least index first, sorted but for those sheets, none degenerate, none repeated.
    pub triangles: Vec<[u32; 3]>,
}

impl Welded {
    /// Where some vertices lie: of an edge's ends, of a triangle's corners.
    #[must_use]
    pub fn places<const N: usize>(&self, vertices: [u32; N]) -> [DVec3; N] {
        vertices.map(|v| self.positions[v as usize].as_dvec3())
    }

    /// Takes other triangles over the same vertices, in whatever order: sorted again, those that degenerate or repeat
    /// and vertices no longer used disappear.
    pub fn replace(&mut self, triangles: Vec<[u32; 3]>) {
        let whole = triangles.into_iter().filter(has_three_corners);
        self.triangles = whole.map(|corners| from(least(corners), corners)).collect();
        self.triangles.par_sort_unstable();
        self.triangles.dedup();
        drop_unused(self);
    }

    /// How far a triangle goes on beside the straight line through two vertices, model units.
    #[must_use]
    pub fn height(&self, face: u32, line: [u32; 2]) -> f64 {
        let [from, to] = self.places(line);
        let along = (to - from).normalize_or_zero();
        let corners = self.places(self.triangles[face as usize]).into_iter();
        corners.map(|corner| (corner - from).cross(along).length()).fold(0.0, f64::max)
    }
}

/// Welds a mesh; degenerate and repeated triangles and unused vertices disappear, and sheets that lie back
/// to back are parted.
#[must_use]
pub fn weld(mesh: &Mesh) -> Welded {
    weld_shaded(mesh).0
}

/// As [`weld`], and for each triangle the normals that the file gives its corners: as it gives them,
/// perhaps not unit, perhaps zero. Empty where it gives none.
#[must_use]
pub fn weld_shaded(mesh: &Mesh) -> (Welded, Vec<[Vec3; 3]>) {
    let cloud = &mesh.vertices;
    let mut order: Vec<u32> = (0..cloud.positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| canonical::key(cloud.positions[v as usize]));
    let mut place = vec![0_u32; order.len()];
    let mut welded = Welded::default();
    let mut sums: Vec<[u32; 4]> = Vec::new();
    for &v in &order {
        let position = cloud.positions[v as usize] + Vec3::ZERO;
        if welded.positions.last() != Some(&position) {
            welded.positions.push(position);
            sums.push([0; 4]);
        }
        let at = welded.positions.len() - 1;
        place[v as usize] = at as u32;
        if let Some(color) = cloud.colors.get(v as usize) {
            for channel in 0..3 {
                sums[at][channel] += u32::from(color[channel]);
            }
            sums[at][3] += 1;
        }
    }
    if !cloud.colors.is_empty() {
        welded.colors = sums.iter().map(mean).collect();
    }
    let corners = canonical_triangles(mesh, &place);
    welded.triangles = corners.iter().map(|&(places, _)| places).collect();
    drop_unused(&mut welded);
    back_to_back::part(&mut welded);
    let normals = match cloud.normals.is_empty() {
        true => Vec::new(),
        false => corners.iter().map(|(_, corners)| corners.map(|v| cloud.normals[v as usize])).collect(),
    };
    (welded, normals)
}

fn mean(sum: &[u32; 4]) -> [u8; 3] {
    let count = sum[3].max(1);
    [0, 1, 2].map(|channel| ((sum[channel] + count / 2) / count) as u8)
}

/// The triangles in canonical order, as places and as vertices of the file: of those that become
/// one, the one whose normals come first.
fn canonical_triangles(mesh: &Mesh, place: &[u32]) -> Vec<([u32; 3], [u32; 3])> {
    let mut triangles: Vec<([u32; 3], [u32; 3])> = mesh
        .triangles
        .iter()
        .map(|corners| (corners.map(|v| place[v as usize]), *corners))
        .filter(|(places, _)| has_three_corners(places))
        .map(|(places, corners)| {
            let first = least(places);
            (from(first, places), from(first, corners))
        })
        .collect();
    let normal = |v: u32| mesh.vertices.normals.get(v as usize).map(|n| n.to_array().map(f32::to_bits));
    triangles.par_sort_unstable_by(|one, other| {
        one.0.cmp(&other.0).then_with(|| one.1.map(normal).cmp(&other.1.map(normal)))
    });
    triangles.dedup_by_key(|triangle| triangle.0);
    triangles
}

fn has_three_corners([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Which of three is the least.
fn least([a, b, c]: [u32; 3]) -> usize {
    if a < b && a < c { 0 } else { 1 + usize::from(c < b) }
}

/// A triangle's corners from one of them on; the orientation stays.
fn from(first: usize, corners: [u32; 3]) -> [u32; 3] {
    [0, 1, 2].map(|n| corners[(n + first) % 3])
}

fn drop_unused(welded: &mut Welded) {
    let mut used = vec![false; welded.positions.len()];
    for &v in welded.triangles.as_flattened() {
        used[v as usize] = true;
    }
    let mut index = vec![0_u32; used.len()];
    let mut kept = 0;
    for v in 0..used.len() {
        index[v] = kept;
        if used[v] {
            welded.positions[kept as usize] = welded.positions[v];
            if !welded.colors.is_empty() {
                welded.colors[kept as usize] = welded.colors[v];
            }
            kept += 1;
        }
    }
    welded.positions.truncate(kept as usize);
    welded.colors.truncate(kept as usize);
    for v in welded.triangles.as_flattened_mut() {
        *v = index[*v as usize];
    }
}
