//! Joins vertices of equal position, in an order that does not depend on the input's.

use glam::Vec3;
use rayon::prelude::*;

use super::canonical;
use crate::model::mesh::Mesh;

/// A mesh whose vertices are distinct positions in canonical order.
#[derive(Clone, Debug, Default)]
pub struct Welded {
    /// Distinct positions along the Morton curve.
    pub positions: Vec<Vec3>,
    /// Colours, the mean over the vertices joined; or empty.
    pub colors: Vec<[u8; 3]>,
    /// Triangles with the least index first, sorted, none degenerate, none repeated.
    pub triangles: Vec<[u32; 3]>,
}

/// Welds a mesh; degenerate and repeated triangles and unused vertices disappear.
#[must_use]
pub fn weld(mesh: &Mesh) -> Welded {
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
    welded.triangles = canonical_triangles(mesh, &place);
    drop_unused(&mut welded);
    welded
}

fn mean(sum: &[u32; 4]) -> [u8; 3] {
    let count = sum[3].max(1);
    [0, 1, 2].map(|channel| ((sum[channel] + count / 2) / count) as u8)
}

fn canonical_triangles(mesh: &Mesh, place: &[u32]) -> Vec<[u32; 3]> {
    let mut triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .map(|corners| corners.map(|v| place[v as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .map(|[a, b, c]| {
            // Turned so that the least index comes first; the orientation stays.
            if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            }
        })
        .collect();
    triangles.par_sort_unstable();
    triangles.dedup();
    triangles
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
