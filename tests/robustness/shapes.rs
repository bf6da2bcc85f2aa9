//! Meshes that meshes should not be.

use glam::{DVec3, Vec3};
use qsplat::ingest::Input;
use qsplat::model::cloud::Cloud;
use qsplat::model::frame::Frame;
use qsplat::model::mesh::Mesh;

/// A mesh from points in input units.
pub fn mesh(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Input {
    let min = points.iter().copied().reduce(DVec3::min).unwrap();
    let max = points.iter().copied().reduce(DVec3::max).unwrap();
    let frame = Frame::of_box(min, max);
    let positions: Vec<Vec3> = points.iter().map(|&p| frame.to_model(p).as_vec3()).collect();
    Input::Mesh(Mesh {
        vertices: Cloud { frame, positions, ..Cloud::default() },
        triangles,
        ..Mesh::default()
    })
}

fn p(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The corners and faces of a cube of side 1 whose least corner is given.
fn cube_at(least: DVec3, first: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner = |n: u32| least + p(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    ((0..8).map(corner).collect(), faces.map(|face| face.map(|v: u32| v + first)).collect())
}

/// A cube of side 1.
pub fn cube() -> Input {
    let (points, faces) = cube_at(DVec3::ZERO, 0);
    mesh(&points, faces)
}

/// A square from both sides.
pub fn sheet() -> Input {
    let corners = [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 0.0)];
    mesh(&corners, vec![[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]])
}

/// Five half planes around one edge.
fn fan() -> Input {
    let mut points = vec![p(0.0, 0.0, 0.0), p(0.0, 0.0, 1.0)];
    let blades = (0..5).map(|n| {
        let (sin, cos) = libm::sincos(f64::from(n) * 1.2566);
        p(cos, sin, 0.5)
    });
    points.extend(blades);
    mesh(&points, (0..5).map(|n| if n % 2 == 0 { [0, 1, 2 + n] } else { [1, 0, 2 + n] }).collect())
}

/// A strip with half a turn: no orientation agrees with itself.
fn moebius() -> Input {
    let steps = 48_u32;
    let points: Vec<DVec3> = (0..steps)
        .flat_map(|n| {
            let turn = std::f64::consts::TAU * f64::from(n) / f64::from(steps);
            let ((sin, cos), (half_sin, half_cos)) = (libm::sincos(turn), libm::sincos(0.5 * turn));
            [-0.3, 0.3].map(|side| {
                let radius = 1.0 + side * half_cos;
                p(radius * cos, radius * sin, side * half_sin)
            })
        })
        .collect();
    let triangles = (0..steps).flat_map(|n| {
        let (a, b) = (2 * n, 2 * n + 1);
        let (c, d) = if n + 1 < steps { (a + 2, b + 2) } else { (1, 0) };
        [[a, c, b], [b, c, d]]
    });
    mesh(&points, triangles.collect())
}

/// Two cubes that share one corner.
fn touching_cubes() -> Input {
    let (mut points, mut faces) = cube_at(DVec3::ZERO, 0);
    let (more, other) = cube_at(DVec3::ONE, 8);
    points.extend(more);
    faces.extend(other);
    mesh(&points, faces)
}

/// A square plate with one thin spike in its middle.
fn spike() -> Input {
    let side = 20_u32;
    let at = |n: u32| f64::from(n) / f64::from(side) - 0.5;
    let middle = side / 2;
    let height = |x, y| if x == middle && y == middle { 1.0 } else { 0.0 };
    let points: Vec<DVec3> =
        (0..=side).flat_map(|y| (0..=side).map(move |x| p(at(x), at(y), height(x, y)))).collect();
    let cells = (0..side).flat_map(|y| (0..side).map(move |x| y * (side + 1) + x));
    let triangles = cells.flat_map(|a| {
        let (b, c, d) = (a + 1, a + side + 1, a + side + 2);
        [[a, b, d], [a, d, c]]
    });
    mesh(&points, triangles.collect())
}

/// SplitMix64 as a number in `[0, 1)`.
pub fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Triangles that have nothing to do with each other, of a tenth of the box or less.
fn soup(count: u32) -> Input {
    let mut state = 7;
    let mut draw = || p(random(&mut state), random(&mut state), random(&mut state)) - 0.5;
    let points: Vec<DVec3> = (0..count)
        .flat_map(|_| {
            let middle = draw();
            [0; 3].map(|_| middle + 0.1 * draw())
        })
        .collect();
    mesh(&points, (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect())
}

/// Triangles strewn over a place a few bounds wide, and a square.
fn heap(count: u32) -> Input {
    let mut state = 9;
    let mut draw = || p(random(&mut state), random(&mut state), random(&mut state)) - 0.5;
    let mut points = vec![p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 0.0)];
    for _ in 0..count {
        let middle = 0.02 * draw();
        points.extend([0; 3].map(|_| middle + 0.003 * draw()));
    }
    let strewn = (0..count).map(|n| [3 * n + 4, 3 * n + 5, 3 * n + 6]);
    mesh(&points, [[0, 1, 2], [0, 2, 3]].into_iter().chain(strewn).collect())
}

/// A cone from a rim to a tip that all triangles share.
fn cone() -> Input {
    let rim = (0..64).map(|n| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(n) / 64.0);
        p(cos, sin, 0.0)
    });
    let points: Vec<DVec3> = rim.chain([p(0.0, 0.0, 1.0)]).collect();
    mesh(&points, (0..64).map(|n| [n, (n + 1) % 64, 64]).collect())
}

/// A cube, and a triangle with two corners at one place.
fn cube_and_a_line() -> Input {
    let (mut points, mut faces) = cube_at(DVec3::ZERO, 0);
    points.extend([p(0.5, 0.5, 2.0), p(0.0, 0.0, 1.5), p(0.0, 0.0, 1.5)]);
    faces.push([8, 9, 10]);
    mesh(&points, faces)
}

/// A barrel of patches whose borders lie apart by up to some four times a share of its radius.
pub fn barrel(crack: f64) -> Input {
    let (around, up) = (24_u32, 12_u32);
    let mut state = 11;
    let mut points = Vec::new();
    let mut faces = Vec::new();
    // Patches of four cells a side.
    for (patch_i, patch_j) in (0..around / 4).flat_map(|i| (0..up / 4).map(move |j| (i, j))) {
        let first = points.len() as u32;
        for (i, j) in (0..=4).flat_map(|i| (0..=4).map(move |j| (i, j))) {
            let turn = std::f64::consts::TAU * f64::from((4 * patch_i + i) % around) / f64::from(around);
            let rise = std::f64::consts::PI * (0.2 + 0.6 * f64::from(4 * patch_j + j) / f64::from(up));
            let ((sin, cos), (wide, high)) = (libm::sincos(turn), libm::sincos(rise));
            let mut aside = || 2.0 * crack * (random(&mut state) - 0.5);
            points.push(p(wide * cos + aside(), wide * sin + aside(), high + aside()));
        }
        for a in (0..4).flat_map(|i| (0..4).map(move |j| first + 5 * i + j)) {
            let (b, c, d) = (a + 5, a + 6, a + 1);
            faces.extend([[a, c, b], [a, d, c]]);
        }
    }
    mesh(&points, faces)
}

/// All cases, named.
pub fn all() -> Vec<(&'static str, Input)> {
    let square = [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 0.0)];
    let line: Vec<DVec3> = (0..6).map(|n| p(f64::from(n), 0.0, 0.0)).collect();
    let bent = [p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(0.5, 1e-9, 0.0), p(0.5, 1.0, 0.5)];
    vec![
        ("one triangle", mesh(&square[..3], vec![[0, 1, 2]])),
        ("two coplanar triangles", mesh(&square, vec![[0, 1, 2], [0, 2, 3]])),
        ("a needle", mesh(&[p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(0.5, 1e-6, 0.0)], vec![[0, 1, 2]])),
        ("a wide needle", mesh(&[p(0.0, 0.0, 0.0), p(1.0, 0.0, 0.0), p(0.5, 2e-3, 0.0)], vec![[0, 1, 2]])),
        ("faces without area", mesh(&line, vec![[0, 1, 2], [1, 3, 5], [2, 3, 4]])),
        ("a sliver beside a face", mesh(&bent, vec![[0, 1, 2], [1, 0, 3]])),
        ("one face from both sides", mesh(&square[..3], vec![[0, 1, 2], [0, 2, 1]])),
        ("a square from both sides", sheet()),
        ("one face twice", mesh(&square[..3], vec![[0, 1, 2], [1, 2, 0]])),
        ("five faces on one edge", fan()),
        ("a Moebius strip", moebius()),
        ("two cubes that share a corner", touching_cubes()),
        ("a spike", spike()),
        ("a cone", cone()),
        ("a cube", cube()),
        ("a cube and a line", cube_and_a_line()),
        ("a barrel with cracks as wide as the bound", barrel(5e-3)),
        ("a barrel with cracks that may be closed", barrel(1e-4)),
        ("1000 random triangles", soup(1000)),
        ("2500 triangles in a heap", heap(2500)),
    ]
}
