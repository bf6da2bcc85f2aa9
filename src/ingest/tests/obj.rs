//! OBJ in its variants.

use glam::{DVec3, Vec3};

use super::{cloud, edges, input_positions, mesh, message};

#[test]
fn polygons_indices_and_joined_lines() {
    let file = "# a pyramid \\\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0 # corner\nv 0 2 0\nvt 0 0\nvn 0 0 1\n\
        g caf\u{e9}#1\nf 1/1/1 2/1 3//1 \\\n 4\nv 1 1 4\nf -1 -4 -5\nf 6 5 1\nv 1 1 -4\nunknown 1 2 3\n";
    let mesh = mesh("a.obj", file.as_bytes());
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 1, 0], [5, 4, 0]]);
    let expected = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 4], [1, 1, -4]];
    assert_eq!(input_positions(&mesh.vertices), expected.map(|p| DVec3::from_array(p.map(f64::from))));
}

#[test]
fn corner_normals_stay_where_they_agree() {
    let file = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 0 1 0\nvn 0 0 2\n\
        f 1//1 2//1 3//1\nf 1//2 2//3 4\n";
    let mesh = mesh("a.obj", file.as_bytes());
    // Vertex 1 has two that differ, 2 the same twice under two numbers, 4 none.
    assert_eq!(mesh.vertices.normals, [Vec3::ZERO, Vec3::Z * 2.0, Vec3::Z * 2.0, Vec3::ZERO]);
    let creases = file.replace("2//1 3//1", "2//2 3").replace("2//3 4", "2 4").replace("1//1", "1");
    assert_eq!(super::mesh("a.obj", creases.as_bytes()).vertices.normals.len(), 4);
    let none = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nf 1//1 2 3\nf 1//2 3 2\n";
    assert!(super::mesh("a.obj", none.as_bytes()).vertices.normals.is_empty());
}

#[test]
fn colors_of_some_vertices_leave_the_others_white() {
    let cloud = cloud("a.obj", b"v 0 0 0\nv 1 0 0 1 0.5 0\nv 2 0 0\nv 3 0 0 0 0 nan 1\n");
    assert_eq!(cloud.colors, [[255; 3], [255, 128, 0], [255; 3], [0, 0, 255]]);
}

#[test]
fn polylines_keep_their_points() {
    let file = "v 0 0 0\nv 1 0 0\nv 0 0.1 0\nl 1 2/1 -1\nvt 0\nl 3 3\n";
    let lines = edges("a.obj", file.as_bytes()).unwrap().lines;
    let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y * 0.1];
    assert_eq!(lines, [vec![a, b, c], vec![c, c]]);
    for (bad, fault) in [
        ("v 0 0 0\nl 1\n", "line 2: a polyline has 1 points"),
        ("v 0 0 0\nl 1 2\n", "line 2: vertex index 2 names none of the 1 records"),
        ("v 0 0 0\nv nan 0 0\nl 1 2\n", "line 3: the polyline has a point at"),
    ] {
        let message = edges("a.obj", bad.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(fault), "{message}");
    }
}

#[test]
fn the_first_line_at_fault_is_named() {
    let good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2 3\nf 1 2 x\n";
    for (from, to, fault) in [
        ("f 1/1/1 2 3", "f 1/1/1 2 4", "line 6: vertex index 4 names none of the 3 records"),
        ("f 1/1/1 2 3", "f 1/2/1 2 3", "line 6: texture index 2 names none of the 1 records"),
        ("f 1/1/1 2 3", "f 1/1/-2 2 3", "line 6: normal index -2 names none of the 1 records"),
        ("f 1/1/1 2 3", "f 0 2 3", "line 6: vertex index 0 names none of the 3 records"),
        ("f 1/1/1 2 3", "f 1 2", "line 6: a face has 2 corners"),
        ("f 1/1/1 2 3", "f 1/1/1/1 2 3", "line 6: `1/1/1/1` has more than 3 indices"),
        ("f 1/1/1 2 3", "f", "line 6: a face has 0 corners"),
        ("v 1 0 0", "v 1 0", "line 2: a vertex has 2 numbers"),
        ("v 1 0 0", "v 1,5 0 0", "line 2: `1,5` is no number"),
        ("vn 0 0 1", "vn 0 0", "line 4: a normal has 2 numbers"),
        ("f 1 2 x", "f 1 2 y", "line 7: `y` is no index"),
    ] {
        let message = message("a.obj", good.replacen(from, to, 1).as_bytes());
        assert!(message.contains(fault), "{message}\nlacks {fault}");
    }
}
