//! Triangles that face the other way than their neighbours.

use std::f64::consts::{PI, TAU};

use super::mesh;
use crate::model::mesh::Mesh;

type Place = [f64; 3];
type Soup = Vec<[Place; 3]>;

/// Two triangles for each cell of a grid that is bent to some surface.
fn bent(cells: [usize; 2], place: impl Fn(f64, f64) -> Place) -> Soup {
    let [columns, rows] = cells;
    let at = |i: usize, j: usize| place(i as f64 / columns as f64, j as f64 / rows as f64);
    let cell = |n: usize| {
        let (i, j) = (n % columns, n / columns);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..columns * rows).flat_map(cell).collect()
}

fn sheet() -> Soup {
    bent([6, 5], |u, v| [u, v, 0.2 * u * v])
}

/// As an OBJ in which no two triangles share a vertex.
fn read(soup: &Soup) -> Mesh {
    let vertices: String =
        soup.as_flattened().iter().map(|[x, y, z]| format!("v {x:.6} {y:.6} {z:.6}\n")).collect();
    let faces: String =
        (0..soup.len()).map(|n| format!("f {} {} {}\n", 3 * n + 1, 3 * n + 2, 3 * n + 3)).collect();
    mesh("soup.obj", (vertices + &faces).as_bytes())
}

fn turned(soup: &Soup, is_turned: impl Fn(usize) -> bool) -> Soup {
    let side = |(n, &[a, b, c]): (usize, &[Place; 3])| if is_turned(n) { [a, c, b] } else { [a, b, c] };
    soup.iter().enumerate().map(side).collect()
}

/// The corners of all triangles in model units.
fn corners(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    (0..mesh.triangles.len()).map(|n| mesh.corners(n).map(|corner| corner.to_array())).collect()
}

/// The same, each from its least corner on.
fn walks(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    let from_least = |mut walk: [[f32; 3]; 3]| {
        let least = (0..3).min_by(|&a, &b| walk[a].partial_cmp(&walk[b]).unwrap()).unwrap();
        walk.rotate_left(least);
        walk
    };
    corners(mesh).into_iter().map(from_least).collect()
}

#[test]
fn those_turned_come_back_whichever_they_are() {
    let right = read(&sheet());
    assert_eq!(right.turned, 0);
    for seed in 1..6 {
        let some = turned(&sheet(), |n| (n * n + seed * n) % 7 < 3 && n % 3 > 0);
        let found = read(&some);
        assert!(found.turned > 5, "{}", found.turned);
        assert_eq!(walks(&found), walks(&right));
    }
}

#[test]
fn the_greater_area_prevails_and_of_equal_ones_the_same_in_any_order() {
    let most = read(&turned(&sheet(), |n| n >= 8));
    assert_eq!((most.turned, walks(&most)), (8, walks(&read(&turned(&sheet(), |_| true)))));
    // The two triangles of a square, and the same in the other order.
    let mut square = turned(&bent([1, 1], |u, v| [u, v, 0.0]), |n| n == 0);
    let one = read(&square);
    square.reverse();
    let mut other = walks(&read(&square));
    other.reverse();
    assert_eq!((one.turned, walks(&one)), (1, other));
}

#[test]
fn where_there_is_nothing_to_agree_on_all_stay() {
    let moebius = bent([24, 3], |u, v| {
        let (wide, (turn, half)) = (0.4 * v - 0.2, (u * TAU, u * PI));
        let from_axis = 1.0 + wide * libm::cos(half);
        [from_axis * libm::cos(turn), from_axis * libm::sin(turn), wide * libm::sin(half)]
    });
    // The same triangle twice, and three at an edge.
    let twice: Soup = vec![[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 2];
    let fin = |height: f64| [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, height]];
    for soup in [moebius, twice, vec![fin(0.0), fin(1.0), fin(-1.0)]] {
        let found = read(&soup);
        assert_eq!((found.turned, found.triangles.len()), (0, soup.len()));
    }
}

#[test]
fn triangles_with_two_corners_at_one_place_are_left_out() {
    let mut soup = sheet();
    soup.push([[0.0; 3], [0.0; 3], [1.0, 1.0, 1.0]]);
    let found = read(&soup);
    assert_eq!((found.dropped, corners(&found).len()), (1, sheet().len()));
}
