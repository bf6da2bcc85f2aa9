//! OFF in its variants.

use glam::{DVec3, Vec3};

use super::{cloud, input_positions, mesh, message};

#[test]
fn headers_counts_comments_and_face_colors() {
    for head in ["OFF\n4 2 0", "OFF 4 2 0", "# c\n\nOFF # c\n4 2 5 # c", "4 2 0"] {
        let file = format!("{head}\n0 0 0\n1 0 0\n1 1 0 # c\n\n0 1 0\n4 0 1 2 3 255 0 0\n3 3 1 0\n");
        let mesh = mesh("a.off", file.as_bytes());
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 1, 0]]);
        assert_eq!(input_positions(&mesh.vertices)[2], DVec3::new(1.0, 1.0, 0.0));
    }
}

#[test]
fn colors_normals_and_texture_coordinates() {
    let whole = cloud("a.off", b"COFF\n2 0 0\n0 0 0 255 128 0 255\n1 0 0 1 1 1 255\n");
    assert_eq!(whole.colors, [[255, 128, 0], [1; 3]]);
    // One fraction in the file makes all its colours run from 0 to 1.
    let fractions = cloud("a.off", b"COFF\n2 0 0\n0 0 0 1 0.5 0\n1 0 0 1 1 1\n");
    assert_eq!(fractions.colors, [[255, 128, 0], [255; 3]]);
    let all = cloud("a.off", b"STCNOFF\n1 0 0\n0 0 0 0 0 1 10 20 30 0.5 0.5\n");
    assert_eq!((all.normals[0], all.colors[0]), (Vec3::Z, [10, 20, 30]));
}

#[test]
fn faults_are_named_with_line_and_value() {
    let good = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for (from, to, fault) in [
        ("OFF", "4OFF", "line 1: `4OFF` is an OFF variant that is not read"),
        ("OFF", "OFF BINARY", "variant that is not read"),
        ("OFF", "COFF", "line 3: a vertex has 3 numbers, which does not fit"),
        ("3 1 0\n", "3 -1 0\n", "line 2: `3 -1 0` is no line of counts"),
        ("3 1 0\n", "9 1 0\n", "9 vertices and 1 faces need at least 56 bytes"),
        ("3 1 0\n", "3 2 0\n", "has 1 of its 2 faces"),
        ("1 0 0", "1 0 q", "line 4: `q` is no number"),
        ("3 0 1 2", "3 0 1 3", "line 6: vertex index 3 is not in 0..3"),
        ("3 0 1 2", "4 0 1 2", "line 6: a face has 3 of its 4 corners"),
        ("3 0 1 2", "x 0 1 2", "line 6: `x` is no number of corners"),
    ] {
        let message = message("a.off", good.replacen(from, to, 1).as_bytes());
        assert!(message.contains(fault), "{message}\nlacks {fault}");
    }
}
