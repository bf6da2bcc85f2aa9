//! glTF 2.0 in one binary file: positions, colours, 16-bit indices.

use std::fmt::Write;

use glam::DVec3;

use super::surface::Surface;

/// A use of the mesh.
pub struct Node {
    /// What viewers call it.
    pub name: &'static str,
    /// Its place in its parent.
    pub translation: [f64; 3],
    /// A unit quaternion `x y z w`.
    pub rotation: [f64; 4],
}

/// One mesh under several nodes, all below a scaled root.
pub struct Scene<'a> {
    /// The mesh, of at most 65535 vertices.
    pub mesh: &'a Surface,
    /// A colour a vertex, linear RGBA.
    pub colors: &'a [[u8; 4]],
    /// Where the mesh shows.
    pub nodes: &'a [Node],
    /// Scale of the root.
    pub scale: f64,
}

/// Chunk types of the container (glTF 2.0, section 4.4.3).
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";

impl Scene<'_> {
    /// The whole file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut json = self.json().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = self.binary();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut bytes = Vec::new();
        bytes.extend(b"glTF");
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
        for (kind, chunk) in [(JSON, json), (BIN, binary)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }

    /// Positions, colours, indices, one after the other.
    fn binary(&self) -> Vec<u8> {
        let positions = self.mesh.positions.iter().flat_map(|p| p.as_vec3().to_array());
        let mut binary: Vec<u8> = positions.flat_map(f32::to_le_bytes).collect();
        binary.extend(self.colors.iter().flatten());
        let indices = self.mesh.triangles.iter().flatten();
        binary.extend(indices.flat_map(|index| (*index as u16).to_le_bytes()));
        binary
    }

    /// The description; written by hand, so that its bytes depend on nothing else.
    fn json(&self) -> String {
        let vertices = self.mesh.positions.len();
        let indices = 3 * self.mesh.triangles.len();
        let positions = &self.mesh.positions;
        let low = positions.iter().copied().reduce(DVec3::min).unwrap_or_default().as_vec3();
        let high = positions.iter().copied().reduce(DVec3::max).unwrap_or_default().as_vec3();
        let (colors_at, indices_at) = (12 * vertices, 16 * vertices);
        let total = (indices_at + 2 * indices).next_multiple_of(4);
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],"#,
            nodes = self.nodes_json()
        ) + r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"indices":2}]}],"#
            + &format!(
                r#""accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3","min":{low},"max":{high}}},{{"bufferView":1,"componentType":5121,"normalized":true,"count":{vertices},"type":"VEC4"}},{{"bufferView":2,"componentType":5123,"count":{indices},"type":"SCALAR"}}],"#
            )
            + &format!(
                r#""bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{colors_at},"target":34962}},{{"buffer":0,"byteOffset":{colors_at},"byteLength":{colors},"target":34962}},{{"buffer":0,"byteOffset":{indices_at},"byteLength":{index_bytes},"target":34963}}],"#,
                colors = 4 * vertices,
                index_bytes = 2 * indices
            )
            + &format!(r#""buffers":[{{"byteLength":{total}}}]}}"#)
    }

    /// The root, then the nodes.
    fn nodes_json(&self) -> String {
        let children: Vec<usize> = (1..=self.nodes.len()).collect();
        let scale = self.scale;
        let mut json =
            format!(r#"{{"name":"root","scale":[{scale},{scale},{scale}],"children":{children:?}}}"#);
        for node in self.nodes {
            let Node { name, translation, rotation } = node;
            // Writing to a string cannot fail.
            let _ = write!(
                json,
                r#",{{"name":"{name}","mesh":0,"translation":{translation:?},"rotation":{rotation:?}}}"#
            );
        }
        json
    }
}
