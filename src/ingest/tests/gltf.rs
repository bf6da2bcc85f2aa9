//! glTF and GLB scenes.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::gltf_file::{File, textured, triangle};
use super::{cloud, input_positions, mesh, message};

fn colors(file: &File) -> Vec<[u8; 3]> {
    mesh("a.glb", &file.to_glb()).vertices.colors
}

#[test]
fn glb_and_data_uri_are_the_same() {
    for (name, bytes) in [("a.glb", triangle().to_glb()), ("a.gltf", triangle().to_gltf())] {
        let mesh = mesh(name, &bytes);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(input_positions(&mesh.vertices), [DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert!(mesh.vertices.colors.is_empty() && mesh.vertices.normals.is_empty());
    }
}

#[test]
fn transforms_reach_positions_normals_and_winding() {
    let mut file = triangle();
    let root = 0.5_f32.sqrt();
    let normals = file.push_floats("VEC3", &[root, root, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    file.primitive()["attributes"]["NORMAL"] = json!(normals);
    // The parent shifts by (10, 0, 0); the child mirrors and stretches x by -2 and turns by 90
    // degrees about z. The second child places the mesh again, unturned.
    file.json["nodes"] = json!([
        {"children": [1, 2], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]},
        {"mesh": 0, "scale": [-2, 1, 1], "rotation": [0, 0, root, root]},
        {"mesh": 0, "translation": [0, 0, 5]},
    ]);
    let mesh = mesh("a.glb", &file.to_glb());
    let expected = [[10, 0, 0], [10, -2, 0], [9, 0, 0], [10, 0, 5], [11, 0, 5], [10, 1, 5]];
    for (found, planted) in input_positions(&mesh.vertices).iter().zip(expected) {
        assert!(found.distance(DVec3::from_array(planted.map(f64::from))) < 1e-6, "{found}");
    }
    assert_eq!(mesh.triangles, [[0, 2, 1], [3, 4, 5]]);
    // Inverse transpose: (1, 1, 0) / sqrt 2 goes to (-1/2, 1, 0), then turns to (-1, -1/2, 0).
    let turned = Vec3::new(-1.0, -0.5, 0.0).normalize();
    assert!(mesh.vertices.normals[0].distance(turned) < 1e-6, "{}", mesh.vertices.normals[0]);
    assert!(mesh.vertices.normals[1].distance(Vec3::Z) < 1e-6);
    assert_eq!(mesh.vertices.normals[2], Vec3::ZERO);
}

#[test]
fn a_mirrored_triangle_still_faces_along_its_normal() {
    let mut file = triangle();
    let normals = file.push_floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    file.primitive()["attributes"]["NORMAL"] = json!(normals);
    for scale in [[1, 1, -3], [-1, 2, 1], [-1, -1, -1], [2, 3, 4]] {
        file.json["nodes"] = json!([{"mesh": 0, "scale": scale}]);
        let mesh = mesh("a.glb", &file.to_glb());
        let [a, b, c] = mesh.corners(0);
        let across = (b - a).cross(c - a).normalize();
        assert!(across.distance(mesh.vertices.normals[0]) < 1e-6, "{scale:?}");
    }
}

#[test]
fn strips_fans_and_points() {
    let mut file = triangle();
    let indices = file.push(&[0, 1, 2, 0, 1], json!({"componentType": 5121, "type": "SCALAR", "count": 5}));
    file.primitive()["indices"] = json!(indices);
    file.primitive()["mode"] = json!(5);
    let strip = mesh("a.glb", &file.to_glb());
    assert_eq!(strip.triangles, [[0, 1, 2], [2, 1, 0], [2, 0, 1]]);
    file.primitive()["mode"] = json!(6);
    let fan = mesh("a.glb", &file.to_glb());
    assert_eq!((fan.triangles, fan.dropped), (vec![[0, 1, 2]], 2));
    file.primitive()["mode"] = json!(0);
    let points = cloud("a.glb", &file.to_glb());
    assert_eq!(input_positions(&points), [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::X]);
    file.primitive()["mode"] = json!(1);
    assert!(message("a.glb", &file.to_glb()).contains("neither triangles nor points"));
    file.primitive()["mode"] = json!(4);
    assert!(message("a.glb", &file.to_glb()).contains("meshes[0].primitives[0].indices: 5 indices"));
}

#[test]
fn base_colors_multiply_as_light() {
    let mut file = triangle();
    file.primitive()["material"] = json!(0);
    file.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1.0, 0.0, 1.0]}}]);
    // Half the light is level 188 in sRGB, a quarter 137.
    assert_eq!(colors(&file), [[188, 255, 0]; 3]);
    let vertex = [255, 128, 255, 255, 128, 0, 255, 255, 0, 255, 255, 255];
    let accessor = json!({"componentType": 5121, "normalized": true, "type": "VEC4", "count": 3});
    let number = file.push(&vertex, accessor);
    file.primitive()["attributes"]["COLOR_0"] = json!(number);
    assert_eq!(colors(&file), [[188, 188, 0], [137, 0, 0], [0, 255, 0]]);
}

#[test]
fn textures_are_sampled_at_the_vertices() {
    // Texel centres lie at 1/4 and 3/4; between them light is mixed, beyond them it repeats.
    for (u, level) in [(0.25, 0), (0.75, 255), (0.5, 188), (1.25, 0), (-0.25, 255), (0.0, 188)] {
        assert_eq!(colors(&textured([u, 0.5])), [[level; 3]; 3], "{u}");
    }
    let mut file = textured([0.25, 0.5]);
    let info = &mut file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"] = json!({"KHR_texture_transform": {"offset": [0.5, 0]}});
    assert_eq!(colors(&file), [[255; 3]; 3]);
    file.json["samplers"] = json!([{"magFilter": 9728}]);
    file.json["textures"][0]["sampler"] = json!(0);
    let info = &mut file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    info["extensions"] = json!({"KHR_texture_transform": {"offset": [0.2, 0]}});
    assert_eq!(colors(&file), [[0; 3]; 3]);
}

#[test]
fn sparse_and_quantised_accessors() {
    let mut file = triangle();
    let at = file.push(&[2], json!({"componentType": 5121, "type": "SCALAR", "count": 1}));
    let value = file.push_floats("VEC3", &[0.0, 8.0, 0.0]);
    let view = |file: &File, n: usize| file.json["accessors"][n]["bufferView"].clone();
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": view(&file, at), "componentType": 5121},
        "values": {"bufferView": view(&file, value)},
    });
    let sparse = mesh("a.glb", &file.to_glb());
    assert_eq!(input_positions(&sparse.vertices)[2], DVec3::Y * 8.0);

    let mut file = triangle();
    let bytes: Vec<u8> =
        [0_i16, 0, 0, 32767, 0, 0, 0, -32768, 0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let accessor = json!({"componentType": 5122, "normalized": true, "type": "VEC3", "count": 3});
    let number = file.push(&bytes, accessor);
    file.primitive()["attributes"]["POSITION"] = json!(number);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let quantised = mesh("a.glb", &file.to_glb());
    assert_eq!(input_positions(&quantised.vertices), [DVec3::ZERO, DVec3::X, DVec3::NEG_Y]);
}

#[test]
fn faults_are_named_by_place() {
    type Change = fn(&mut Value);
    let cases: &[(Change, &str)] = &[
        (|j| j["asset"]["version"] = json!("1.0"), "asset.version: is glTF \"1.0\""),
        (
            |j| j["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
            "KHR_draco_mesh_compression is required",
        ),
        (|j| j["scene"] = json!(3), "scene: index 3 names nothing"),
        (|j| j["nodes"][0]["mesh"] = json!(7), "nodes[0].mesh: index 7 names nothing"),
        (|j| j["nodes"][0]["children"] = json!([0]), "nodes[0]: is reached twice"),
        (|j| j["nodes"][0]["children"] = json!([9]), "node 9 does not exist"),
        (
            |j| j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(99),
            "POSITION: index 99 names nothing",
        ),
        (|j| j["meshes"][0]["primitives"][0]["mode"] = json!(9), "its mode is unknown"),
        (|j| j["meshes"][0]["primitives"][0]["material"] = json!(4), "material: index 4 names nothing"),
        (
            |j| j["accessors"][0]["count"] = json!(4),
            "accessors[0]: 4 elements need 48 bytes from byte 0 of bufferViews[0]",
        ),
        (|j| j["accessors"][0]["count"] = json!(u64::MAX), "over the limit"),
        (
            |j| {
                j["accessors"][0].as_object_mut().unwrap().remove("bufferView");
                j["accessors"][0]["count"] = json!(200_000_000);
            },
            "accessors[0]: claims 200000000 zeros without a bufferView",
        ),
        (|j| j["accessors"][0]["byteOffset"] = json!(u64::MAX), "accessors[0]"),
        (|j| j["accessors"][0]["type"] = json!("VEC2"), "has the type Vec2, and needs one of [Vec3]"),
        (|j| j["accessors"][0]["componentType"] = json!(1), "type or componentType is unknown"),
        (|j| j["bufferViews"][0]["byteOffset"] = json!(u64::MAX), "bufferViews[0]: bytes"),
        (|j| j["bufferViews"][0]["buffer"] = json!(1), "bufferViews[0]: buffer 1 does not exist"),
        (|j| j["bufferViews"][0]["byteStride"] = json!(8), "byteStride 8 is less than an element's 12 bytes"),
        (|j| j["accessors"][1]["count"] = json!(u64::MAX), "over the limit"),
    ];
    for (change, fault) in cases {
        let mut file = triangle();
        change(&mut file.json);
        let message = message("a.glb", &file.to_glb());
        assert!(message.contains(fault), "{message}\nlacks {fault}");
    }
    let mut file = triangle();
    file.bin[36] = 200;
    assert!(message("a.glb", &file.to_glb()).contains("indices: vertex index 200 is not in 0..3"));
    let mut file = textured([0.0; 2]);
    let start = file.json["bufferViews"][3]["byteOffset"].as_u64().unwrap() as usize;
    file.bin[start] = 0;
    assert!(message("a.glb", &file.to_glb()).contains("images[0]"));
    assert!(message("a.gltf", b"{\"asset\": 1}").contains("JSON line 1 column"));
}

#[test]
fn external_buffers_lie_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = triangle();
    std::fs::write(folder.path().join("a b.bin"), &file.bin).unwrap();
    let path = folder.path().join("a.gltf");
    let read = |uri: &str| {
        let mut json = file.json.clone();
        json["buffers"] = json!([{"byteLength": file.bin.len(), "uri": uri}]);
        std::fs::write(&path, json.to_string()).unwrap();
        super::super::read(&path, &super::Limits::default()).map_err(|error| error.to_string())
    };
    assert!(read("a%20b.bin").is_ok());
    for (uri, fault) in [
        ("c.bin", "the file \"c.bin\" is missing; put it beside"),
        ("/dev/zero", "is no file relative to this one"),
        ("https://example.org/c.bin", "is no file relative to this one"),
        ("data:text/plain,abc", "no sound base64"),
        ("data:x;base64,AAAA", "buffers[0]: claims 40 bytes and has 3"),
    ] {
        let message = read(uri).unwrap_err();
        assert!(message.contains(fault), "{message}");
    }
}
