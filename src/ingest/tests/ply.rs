//! PLY in its variants.

use glam::{DVec3, Vec3};

use super::super::scalar::Endian;
use super::{cloud, edges, input_positions, mesh, message, read};

/// A tetrahedron's corners, exact in every type.
const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u8; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn number(kind: &str, value: f64, endian: Endian) -> Vec<u8> {
    let mut bytes = match kind {
        "char" => (value as i8).to_le_bytes().to_vec(),
        "uchar" => (value as u8).to_le_bytes().to_vec(),
        "short" => (value as i16).to_le_bytes().to_vec(),
        "ushort" => (value as u16).to_le_bytes().to_vec(),
        "int" => (value as i32).to_le_bytes().to_vec(),
        "uint" => (value as u32).to_le_bytes().to_vec(),
        "float" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if endian == Endian::Big {
        bytes.reverse();
    }
    bytes
}

/// The tetrahedron as a binary file with coordinates, list counts and indices of given types.
pub(super) fn tetrahedron(kinds: [&str; 3], endian: Endian) -> Vec<u8> {
    let [kind, count, item] = kinds;
    let order = if endian == Endian::Little { "little" } else { "big" };
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty uchar pad\nproperty {kind} z\n\
         property {kind} x\nproperty {kind} y\nelement face 4\nproperty short before\n\
         property list {count} {item} vertex_indices\nproperty float after\nend_header\n"
    )
    .into_bytes();
    for [x, y, z] in CORNERS {
        file.push(7);
        file.extend([z, x, y].iter().flat_map(|&value| number(kind, value, endian)));
    }
    for face in FACES {
        file.extend(number("short", -5.0, endian));
        file.extend(number(count, 3.0, endian));
        file.extend(face.iter().flat_map(|&v| number(item, f64::from(v), endian)));
        file.extend(number("float", 0.5, endian));
    }
    file
}

#[test]
fn every_type_order_and_endianness_decodes_to_the_same() {
    let kinds = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"];
    let expected = CORNERS.map(DVec3::from_array);
    for endian in [Endian::Little, Endian::Big] {
        for kind in kinds {
            for count in &kinds[..6] {
                for item in &kinds[..6] {
                    let mesh = mesh("a.ply", &tetrahedron([kind, count, item], endian));
                    assert_eq!(input_positions(&mesh.vertices), expected);
                    assert_eq!(mesh.triangles, FACES.map(|face| face.map(u32::from)));
                }
            }
        }
    }
}

#[test]
fn ascii_is_the_same_as_binary() {
    let text = "ply\nformat ascii 1.0\ncomment made by hand\nelement face 4\n\
        property list uchar int vertex_index\nelement extra 1\nproperty list int float numbers\n\
        element vertex 4\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
        3 0 2 1\n\n3 0 1 3\r\n3 1 2 3\n3 2 0 3\n2 1.5 2.5\n0 0 0\n2 0 0\n0 4 0\n 0 0 1";
    let mesh = mesh("a.ply", text.as_bytes());
    assert_eq!(input_positions(&mesh.vertices), CORNERS.map(DVec3::from_array));
    assert_eq!(mesh.triangles, FACES.map(|face| face.map(u32::from)));
}

#[test]
fn polygons_of_mixed_size_are_fanned() {
    let mut file = tetrahedron(["float", "uchar", "int"], Endian::Little);
    let rows = file.len() - 4 * 19;
    file.truncate(rows);
    for face in [&[0_u8, 1, 2, 3][..], &[3, 2, 1], &[0, 1, 1, 2], &[1, 2, 3]] {
        file.extend([0, 0, face.len() as u8]);
        face.iter().for_each(|&v| file.extend([v, 0, 0, 0]));
        file.extend([0; 4]);
    }
    let mesh = mesh("a.ply", &file);
    let expected = [[0, 1, 2], [0, 2, 3], [3, 2, 1], [0, 1, 2], [1, 2, 3]];
    assert_eq!((mesh.triangles.as_slice(), mesh.dropped), (&expected[..], 1));
}

#[test]
fn vertices_with_lists_of_any_length_are_read() {
    for lengths in [[1, 1, 1], [0, 2, 1]] {
        let mut file =
            b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty list uchar short l\n\
            property float x\nproperty float y\nproperty float z\nend_header\n"
                .to_vec();
        for (n, length) in lengths.into_iter().enumerate() {
            file.push(length);
            (0..length).for_each(|_| file.extend([9, 9]));
            file.extend([n as f32, 0.0, 1.0].iter().flat_map(|value| value.to_le_bytes()));
        }
        let points: Vec<_> = (0..3).map(|n| DVec3::new(f64::from(n), 0.0, 1.0)).collect();
        assert_eq!(input_positions(&cloud("a.ply", &file)), points);
    }
}

#[test]
fn doubles_far_from_the_origin_keep_their_millimetres() {
    // Planted: steps of 1 mm on a 1 m object at 10,000 km, where 32 bits step by 1 m.
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1001\nproperty double x\n\
        property double y\nproperty double z\nend_header\n";
    let points: Vec<DVec3> =
        (0..=1000).map(|n| DVec3::new(1e7 + f64::from(n) * 1e-3, -1e7 - f64::from(n) * 1e-3, 4e6)).collect();
    let mut file = header.as_bytes().to_vec();
    file.extend(points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes));
    let cloud = cloud("a.ply", &file);
    for (found, planted) in input_positions(&cloud).iter().zip(&points) {
        // Half a step of 32 bits at 1, and the spacing of 64 bits at 1e7.
        assert!(found.distance(*planted) < 1e-7, "{found} {planted}");
    }
}

#[test]
fn the_result_does_not_depend_on_the_order_of_points() {
    let header = "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\n\
        property double z\nend_header\n";
    let mut rows =
        vec!["0.1 -0.0 7e6", "-0.3 0.0 7000001.25", "nan 0 0", "1e-3 0 7e6", "0.7 -0 7e6", "0 inf 0"];
    let sorted = |rows: &[&str]| {
        let cloud = cloud("a.ply", format!("{header}{}\n", rows.join("\n")).as_bytes());
        assert_eq!(cloud.dropped, 2);
        let mut positions: Vec<_> = cloud.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        positions.sort_unstable();
        (cloud.frame.origin.to_array().map(f64::to_bits), cloud.frame.exponent, positions)
    };
    let first = sorted(&rows);
    for _ in 0..rows.len() {
        rows.rotate_left(1);
        assert_eq!(sorted(&rows), first);
        rows.swap(0, 2);
        assert_eq!(sorted(&rows), first);
    }
}

#[test]
fn normals_and_colors_of_every_kind() {
    let cases = [
        ("uchar", "red green blue", "255 128 0", [255, 128, 0]),
        ("ushort", "r g b", "65535 32896 257", [255, 128, 1]),
        ("float", "diffuse_red diffuse_green diffuse_blue", "1.5 0.5 -1", [255, 128, 0]),
        ("double", "red green blue", "nan 0.25 0", [255, 64, 0]),
    ];
    for (kind, names, values, expected) in cases {
        let colors: String = names.split(' ').map(|name| format!("property {kind} {name}\n")).collect();
        let file = format!(
            "ply\nformat ascii 1.0\nelement vertex 2\n{colors}property float nx\nproperty float ny\n\
             property float nz\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
             {values} 0 0 2 0 0 0\n0 0 0 nan 0 0 1 1 1\n"
        );
        let cloud = cloud("a.ply", file.as_bytes());
        assert_eq!(cloud.colors, [expected, [0; 3]], "{kind}");
        // As they are in the file: not unit, perhaps not finite.
        assert_eq!(cloud.normals[0], Vec3::Z * 2.0);
        assert!(cloud.normals[1].is_nan());
    }
}

#[test]
fn edges_become_polylines() {
    let file = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element edge 3\nproperty int vertex1\nproperty int vertex2\nproperty uchar red\nend_header\n\
        0 0 0\n1 0 0\n2 0 0\n3 0 0\n2 1 5\n0 1 5\n2 3 5\n";
    let lines = edges("a.ply", file.as_bytes()).unwrap().lines;
    assert_eq!(lines, [(0..4).map(|n| DVec3::X * f64::from(n)).collect::<Vec<_>>()]);
    let broken = file.replace("2 3 5", "2 4 5");
    let message = edges("a.ply", broken.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("element `edge`, row 2: vertex index 4 is not in 0..4"), "{message}");
    let broken = file.replace("1 0 0", "1 nan 0");
    let message = edges("a.ply", broken.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("not finite"), "{message}");
    let message =
        edges("a.ply", &tetrahedron(["float", "uchar", "int"], Endian::Big)).unwrap_err().to_string();
    assert!(message.contains("no `edge` element"), "{message}");
}

#[test]
fn faults_are_named_with_place_and_value() {
    let good = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert!(read("a.ply", good.as_bytes()).is_ok());
    let cases = [
        ("format ascii 1.0", "format utf8 1.0", "line 2: `utf8` is no PLY format"),
        ("element vertex 3", "element vertex -3", "line 3: `-3` is no row count"),
        ("element face 1", "element face 99999999999999999", "99999999999999999 rows of at least 2 bytes"),
        ("property float z", "property float x", "line 6: `x` is declared twice"),
        (
            "property float z",
            "property float w",
            "line 3: element `vertex` needs the scalar properties x, y and z",
        ),
        ("list uchar int", "list float int", "line 8: the count of a list must be an integer"),
        ("vertex_indices", "corners", "line 7: element `face` lacks a list property `vertex_indices`"),
        ("end_header", "end_heade", "line 9: `end_heade` is no header record"),
        ("1 0 0", "1 0", "line 11: element `vertex`: property `z` is missing"),
        ("1 0 0", "1 0 0 0", "line 11: element `vertex`: `0` follows the last property"),
        ("3 0 1 2", "3 0 1 1.5", "line 13: element `face`: vertex index 1.5 is not in 0..3"),
        ("3 0 1 2", "2 0 1", "line 13: element `face`: a face has 2 corners"),
        ("3 0 1 2", "-1 0 1 2", "line 13: element `face`: list `vertex_indices`: `-1` is no count"),
        ("3 0 1 2", "3 1 1 2", "none of its 1 triangles"),
        ("0 1 0\n3 0 1 2\n", "          \n", "element `vertex` has 2 of its 3 rows"),
    ];
    for (from, to, fault) in cases {
        let message = message("a.ply", good.replacen(from, to, 1).as_bytes());
        assert!(message.contains(fault), "{message}\nlacks {fault}");
    }
}
