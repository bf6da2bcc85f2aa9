//! Facets that stand for a smooth surface: the surface is baked, and the bound holds against it.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use qsplat::bake::{MaxError, Meaning, Options, Silent};
use qsplat::deliver::{Delivery, deliver};
use qsplat::ingest::Input;
use qsplat::measure::fit::{REACH, fit};
use qsplat::model::cloud::Cloud;
use qsplat::model::frame::Frame;
use qsplat::model::mesh::Mesh;

/// A share of the diagonal, below the sagitta of the facets.
const BOUND: f64 = 1e-3;

/// Facets around.
const AROUND: u32 = 24;

/// Triangles over a lattice of quads that closes on itself across, and perhaps along.
fn quads(across: u32, along: u32, closed: bool) -> Vec<[u32; 3]> {
    let rows = if closed { along } else { along - 1 };
    let at = move |row: u32, column: u32| (row % along) * across + column % across;
    (0..rows)
        .flat_map(|row| (0..across).map(move |column| (row, column)))
        .flat_map(|(row, column)| {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect()
}

fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let (low, high) = positions
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let frame = Frame::of_box(low, high);
    let positions: Vec<Vec3> = positions.into_iter().map(|p| frame.to_model(p).as_vec3()).collect();
    Mesh { vertices: Cloud { frame, positions, ..Cloud::default() }, triangles, ..Mesh::default() }
}

/// A closed cylinder of radius 1 and height 2.
fn cylinder() -> Mesh {
    let rim = |z: f64| {
        (0..AROUND).map(move |n| {
            let (sin, cos) = (TAU * f64::from(n) / f64::from(AROUND)).sin_cos();
            DVec3::new(cos, sin, z)
        })
    };
    let positions = rim(-1.0).chain(rim(1.0)).chain([DVec3::NEG_Z, DVec3::Z]).collect();
    let mut triangles = quads(AROUND, 2, false);
    for n in 0..AROUND {
        let next = (n + 1) % AROUND;
        triangles.extend([[2 * AROUND, next, n], [2 * AROUND + 1, AROUND + n, AROUND + next]]);
    }
    mesh(positions, triangles)
}

/// A ring of tubes: radius 1, of the tube 0.4.
fn torus() -> Mesh {
    let place = |n: u32| {
        let (row, column) = (n / 12, n % 12);
        let (sin, cos) = (TAU * f64::from(row) / f64::from(AROUND)).sin_cos();
        let (up, out) = (TAU * f64::from(column) / 12.0).sin_cos();
        let r = 1.0 + 0.4 * out;
        DVec3::new(r * cos, r * sin, 0.4 * up)
    };
    let triangles = quads(12, AROUND, true).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    mesh((0..12 * AROUND).map(place).collect(), triangles)
}

fn bake(mesh: &Mesh, meaning: Meaning) -> Delivery {
    let options = Options { max_error: MaxError::Relative(BOUND), meaning, effort: 3, ..Options::default() };
    deliver(&Input::Mesh(mesh.clone()), &options, &mut Silent).unwrap()
}

/// The greatest distance of places from the splats over them, in bounds.
fn off(made: &Delivery, places: &[DVec3]) -> f64 {
    let asset = &made.asset;
    let places: Vec<Vec3> = places.iter().map(|&p| asset.frame.to_model(p).as_vec3()).collect();
    let found = fit(&places, asset, REACH * asset.max_error);
    assert_eq!(found.uncovered, 0);
    found.accuracy.max / asset.max_error
}

#[test]
fn a_coarse_cylinder_becomes_a_few_splats_of_the_round_one() {
    let mesh = cylinder();
    let facets = bake(&mesh, Meaning::Facets);
    let smooth = bake(&mesh, Meaning::Auto);
    assert!(smooth.baked.stand_in.is_some());
    let (few, many) = (smooth.asset.splats.len(), facets.asset.splats.len());
    assert!(4 * few < many, "{few} of {many}");
    // Places on the round cylinder, between the facets' edges and up to the sharp ones.
    let side = (0..2000).map(|n| {
        let (sin, cos) = (2.4 * f64::from(n)).sin_cos();
        DVec3::new(cos, sin, (f64::from(n) / 1000.0 - 1.0) * 0.999)
    });
    let side: Vec<DVec3> = side.collect();
    assert!(off(&smooth, &side) < 1.1, "{}", off(&smooth, &side));
}

#[test]
fn a_coarse_ring_becomes_a_round_one() {
    let mesh = torus();
    let (facets, smooth) = (bake(&mesh, Meaning::Facets), bake(&mesh, Meaning::Smooth));
    assert!(3 * smooth.bytes.len() < facets.bytes.len(), "{} {}", smooth.bytes.len(), facets.bytes.len());
    let model = smooth.asset.frame;
    for splat in &smooth.asset.splats {
        let p = model.to_input(splat.center);
        let tube = (p.truncate().length() - 1.0).hypot(p.z);
        // Curved triangles over so coarse a tube are off by as much themselves.
        assert!((tube - 0.4).abs() < 0.01, "{p}");
    }
}

#[test]
fn sharp_normals_and_flat_faces_keep_facets_as_they_are() {
    let mesh = cylinder();
    // Each triangle with corners of its own, and its own normal at them: shaded flat.
    let corners: Vec<Vec3> = (0..mesh.triangles.len()).flat_map(|n| mesh.corners(n)).collect();
    let normal = |c: &[Vec3]| (c[1] - c[0]).cross(c[2] - c[0]).normalize();
    let normals = corners.chunks_exact(3).flat_map(|c| [normal(c); 3]).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let vertices = Cloud { positions: corners, normals, ..mesh.vertices.clone() };
    let flat = Mesh { vertices, triangles, ..Mesh::default() };
    let auto = bake(&flat, Meaning::Auto);
    assert!(auto.baked.stand_in.is_none(), "normals that differ from face to face mean facets");
    // Even where it is asked for, nothing bends: only the pieces lie otherwise.
    let [smooth, facets] = [Meaning::Smooth, Meaning::Facets].map(|meaning| bake(&flat, meaning).asset);
    assert!(smooth.splats.len() * 10 > facets.splats.len() * 9);
}

#[test]
fn the_order_of_triangles_changes_nothing() {
    let mesh = torus();
    let mut turned = mesh.clone();
    turned.triangles.reverse();
    turned.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
    assert_eq!(bake(&mesh, Meaning::Smooth).bytes, bake(&turned, Meaning::Smooth).bytes);
}
