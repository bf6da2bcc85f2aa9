//! Makes glTF and GLB files.

use base64::Engine;
use serde_json::{Value, json};

/// A document and its binary buffer.
pub(super) struct File {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl File {
    /// Appends an accessor over new bytes.
    pub fn push(&mut self, bytes: &[u8], accessor: Value) -> usize {
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        let view = views.len();
        views.push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend(bytes);
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        let mut accessor = accessor;
        accessor["bufferView"] = json!(view);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        accessors.len() - 1
    }

    pub fn push_floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let width = kind.strip_prefix("VEC").unwrap().parse::<usize>().unwrap();
        let accessor = json!({"componentType": 5126, "type": kind, "count": values.len() / width});
        self.push(&bytes, accessor)
    }

    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    pub fn to_glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        let mut text = json.to_string().into_bytes();
        while !text.len().is_multiple_of(4) {
            text.push(b' ');
        }
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend(((12 + 8 + text.len() + 8 + self.bin.len()) as u32).to_le_bytes());
        file.extend((text.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(text);
        file.extend((self.bin.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(&self.bin);
        file
    }

    pub fn to_gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bin);
        let uri = format!("data:application/octet-stream;base64,{data}");
        json["buffers"] = json!([{"byteLength": self.bin.len(), "uri": uri}]);
        json.to_string().into_bytes()
    }
}

/// One triangle in the plane z = 0, counter-clockwise seen from +z, with indices 0 1 2.
pub(super) fn triangle() -> File {
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "bufferViews": [], "accessors": [],
        "meshes": [{"primitives": [{"attributes": {}}]}],
    });
    let mut file = File { json, bin: Vec::new() };
    let positions = file.push_floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let indices = file.push(&[0, 1, 2], json!({"componentType": 5121, "type": "SCALAR", "count": 3}));
    file.primitive()["attributes"]["POSITION"] = json!(positions);
    file.primitive()["indices"] = json!(indices);
    file
}

/// The triangle with a texture of two texels, black and white, all vertices at `uv`.
pub(super) fn textured(uv: [f32; 2]) -> File {
    let mut png = std::io::Cursor::new(Vec::new());
    let pixels = image::RgbImage::from_vec(2, 1, vec![0, 0, 0, 255, 255, 255]).unwrap();
    pixels.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let mut file = triangle();
    let coordinates = file.push_floats("VEC2", &[uv, uv, uv].concat());
    file.primitive()["attributes"]["TEXCOORD_0"] = json!(coordinates);
    file.primitive()["material"] = json!(0);
    let holder = file.push(&png.into_inner(), json!({"componentType": 5121, "type": "SCALAR", "count": 1}));
    let view = file.json["accessors"][holder]["bufferView"].clone();
    file.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    file
}
