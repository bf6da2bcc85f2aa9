//! Meshes and clouds drawn by the CPU.

use glam::{DVec3, Vec3};
use qsplat::model::cloud::Cloud;
use qsplat::model::mesh::Mesh;
use qsplat::render::camera::{Camera, Framing, Projection, View};
use qsplat::render::input::{self, Model, Normals, Style};
use qsplat::render::{Settings, Show};

use crate::scenes;

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh { vertices: Cloud { positions, ..Cloud::default() }, triangles, ..Mesh::default() }
}

/// A unit cube, its eight vertices shared by all faces.
fn cube() -> Mesh {
    let corner = |n: u32| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2 & 1) as f32) - 0.5;
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh((0..8).map(corner).collect(), triangles)
}

/// A sphere of two-triangle cells.
fn ball(steps: u32) -> Mesh {
    let mut positions = Vec::new();
    for row in 0..=steps {
        for column in 0..2 * steps {
            let (up, around) = (f64::from(row) / f64::from(steps), f64::from(column) / f64::from(steps));
            let (sin, cos) = libm::sincos(up * std::f64::consts::PI);
            let (s, c) = libm::sincos(around * std::f64::consts::PI);
            positions.push((0.8 * DVec3::new(sin * s, cos, sin * c)).as_vec3());
        }
    }
    let cells = (0..steps).flat_map(|row| (0..2 * steps).map(move |column| (row, column)));
    let triangles = cells.flat_map(|(row, column)| {
        let at = |row: u32, column: u32| row * 2 * steps + column % (2 * steps);
        let (a, b) = (at(row, column), at(row, column + 1));
        let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
        [[a, c, b], [b, c, d]]
    });
    let keep = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|n| positions[n as usize]);
        a != b && b != c && c != a
    };
    let triangles = triangles.filter(keep).collect();
    mesh(positions.clone(), triangles)
}

fn camera(eye: [f64; 3], projection: Projection) -> Camera {
    Camera { eye, target: [0.0; 3], up: [0.0, 1.0, 0.0], projection, near: None }
}

#[test]
fn a_cube_is_seen_exactly() {
    let mesh = cube();
    let camera = camera([0.0, 0.0, 2.0], Projection::Orthographic { height: 2.0 });
    let seen = input::visibility(Model::Mesh(&mesh), &camera, [64, 64], &Style::default()).unwrap();
    // The face spans the middle half of each side; its two triangles share a diagonal.
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let inside = (16..48).contains(&x) && (16..48).contains(&y);
        let hit = seen.at(x, y);
        assert_eq!(hit.is_some(), inside, "({x}, {y})");
        if let Some(hit) = hit {
            assert!((hit.depth - 1.5).abs() < 1e-12 && Vec3::from(hit.normal).distance(Vec3::Z) < 1e-6);
            assert!([10, 11].contains(&hit.index));
        }
    }
}

#[test]
fn from_inside_a_cube_no_ray_slips_out() {
    let mesh = cube();
    for target in [[1.0, 0.0, 0.0], [0.3, 0.5, 0.2], [-1.0, -1.0, -1.0]] {
        let camera = Camera { target, ..camera([0.0; 3], Projection::Perspective { fov_degrees: 150.0 }) };
        let camera = Camera { near: Some(1e-3), ..camera };
        let seen = input::visibility(Model::Mesh(&mesh), &camera, [101, 101], &Style::default()).unwrap();
        assert!(seen.seen.iter().all(Option::is_some));
    }
}

#[test]
fn smooth_normals_keep_creases_and_round_balls() {
    let settings = Settings { size: [128, 128], show: Show::Normals, ..Settings::default() };
    let view = |mesh: &Mesh, normals| {
        let camera = Camera::framing(&mesh.vertices.frame, 2.0, View::Iso, Framing::default(), settings.size);
        let style = Style { normals, ..Style::default() };
        input::render(Model::Mesh(mesh), &camera, &settings, &style).unwrap().rgba
    };
    let cube = cube();
    assert_eq!(view(&cube, Normals::Given), view(&cube, Normals::Flat));
    assert_ne!(view(&cube, Normals::Crease(91.0)), view(&cube, Normals::Flat));

    let ball = ball(24);
    let camera = camera([0.0, 0.0, 3.0], Projection::Orthographic { height: 2.0 });
    let seen = input::visibility(Model::Mesh(&ball), &camera, [128, 128], &Style::default()).unwrap();
    let mut worst = 0.0_f64;
    for (x, y) in (0..128).flat_map(|y| (0..128).map(move |x| (x, y))) {
        let p = glam::DVec2::new(f64::from(x) - 63.5, 63.5 - f64::from(y)) / 64.0;
        if let (Some(hit), true) = (seen.at(x, y), p.length() < 0.7) {
            let truth = p.extend((0.64 - p.length_squared()).sqrt());
            worst = worst.max(DVec3::from(hit.normal.map(f64::from)).angle_between(truth).to_degrees());
        }
    }
    println!("worst smooth normal {worst:.2} degrees; a facet spans 7.5");
    assert!(worst < 1.5, "{worst}");
}

#[test]
fn an_input_and_its_splats_look_alike() {
    let ball = ball(64);
    let asset = qsplat::model::asset::Asset { has_colors: false, ..scenes::sphere(500, 0.8, true) };
    let settings = Settings { size: [200, 200], ..Settings::default() };
    let camera = Camera::framing(&asset.frame, asset.diagonal, View::Iso, Framing::default(), settings.size);
    let splats = qsplat::render::cpu::render(&asset, &camera, &settings).unwrap().rgba;
    let input = input::render(Model::Mesh(&ball), &camera, &settings, &Style::default()).unwrap().rgba;
    let differ = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| (0..3).any(|n| a[n].abs_diff(b[n]) > 6);
    let count = splats.pixels().zip(input.pixels()).filter(|&pair| differ(pair)).count();
    println!("{count} of 40000 pixels differ");
    assert!(count < 300, "{count}");
}

#[test]
fn a_cloud_of_discs_covers_a_ball() {
    let count = 4000;
    let directions: Vec<DVec3> = scenes::directions(count).collect();
    let positions = directions.iter().map(|d| (0.8 * d).as_vec3()).collect();
    let bare = Cloud { positions, ..Cloud::default() };
    let normals = directions.iter().map(|d| (3.0 * d).as_vec3()).collect();
    let cloud = Cloud { normals, ..bare.clone() };
    let camera = camera([0.0, 0.0, 3.0], Projection::Orthographic { height: 2.0 });
    for cloud in [&bare, &cloud] {
        let seen = input::visibility(Model::Cloud(cloud), &camera, [128, 128], &Style::default()).unwrap();
        for (x, y) in (0..128).flat_map(|y| (0..128).map(move |x| (x, y))) {
            let distance = glam::DVec2::new(f64::from(x) - 63.5, 63.5 - f64::from(y)).length() / 64.0;
            assert!(distance > 0.78 || seen.at(x, y).is_some(), "hole at ({x}, {y})");
            assert!(distance < 0.85 || seen.at(x, y).is_none(), "({x}, {y}) is outside");
        }
    }
}
