//! PLY, binary little-endian, 32-bit floats.

use glam::DVec3;

use super::surface::Surface;

/// A mesh; `colors` is empty or holds one sRGB colour a vertex.
pub fn mesh(surface: &Surface, colors: &[[u8; 3]]) -> Vec<u8> {
    let color_lines = if colors.is_empty() { "" } else { COLOR_PROPERTIES };
    let faces = surface.triangles.len();
    let mut bytes = header(surface.positions.len(), color_lines);
    bytes.extend(format!("element face {faces}\nproperty list uchar int vertex_indices\n").bytes());
    bytes.extend(b"end_header\n");
    for (n, position) in surface.positions.iter().enumerate() {
        push_vector(&mut bytes, *position);
        bytes.extend(colors.get(n).into_iter().flatten());
    }
    for triangle in &surface.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
    }
    bytes
}

/// A cloud; `normals` is empty or holds one unit vector a point.
pub fn cloud(points: &[DVec3], normals: &[DVec3]) -> Vec<u8> {
    let normal_lines = if normals.is_empty() { "" } else { NORMAL_PROPERTIES };
    let mut bytes = header(points.len(), normal_lines);
    bytes.extend(b"end_header\n");
    for (n, point) in points.iter().enumerate() {
        push_vector(&mut bytes, *point);
        if let Some(normal) = normals.get(n) {
            push_vector(&mut bytes, *normal);
        }
    }
    bytes
}

const COLOR_PROPERTIES: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
const NORMAL_PROPERTIES: &str = "property float nx\nproperty float ny\nproperty float nz\n";

/// The header up to the vertices' properties.
fn header(vertices: usize, more: &str) -> Vec<u8> {
    format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n\
         property float x\nproperty float y\nproperty float z\n{more}"
    )
    .into_bytes()
}

fn push_vector(bytes: &mut Vec<u8>, vector: DVec3) {
    bytes.extend(vector.as_vec3().to_array().into_iter().flat_map(f32::to_le_bytes));
}
