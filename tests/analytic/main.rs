//! The fixtures, baked, against the surfaces they stand for.
//!
//! The fit within the bound; every kept place of every splat near the true surface (overshoot past
//! edges and borders); no hole from the 26 directions of the cube, and nothing extra, at any bound; the
//! number of splats falling with the bound as theory says.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr, clippy::float_cmp)]

mod distance;
mod limited;
mod shapes;
mod views;

use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use qsplat::bake::{Edges, Holes, MaxError, Options, Shapes, Silent};
use qsplat::deliver::{Delivery, deliver};
use qsplat::ingest::{self, Input, Limits};
use qsplat::measure::views::SIDE;
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::Conic;
use qsplat::model::mesh::Mesh;
use qsplat::model::splat::Splat;
use rayon::prelude::*;
use views::COARSER;

/// Shares of the diagonal.
const BUDGETS: [f64; 3] = [1e-2, 1e-3, 3e-4];

/// The rim may stray this many bounds.
const RIM: f64 = 2.0;

/// Vertices are within this of their formulas (fixtures/README.md).
const VERTEX: f64 = 2.1e-7;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn mesh(name: &str) -> Mesh {
    match ingest::read(&path(&format!("{name}.ply")), &Limits::default()).unwrap() {
        Input::Mesh(mesh) => mesh,
        Input::Cloud(_) => panic!("{name} is a cloud"),
    }
}

fn bake(name: &str, mesh: &Mesh, share: f64) -> Asset {
    bake_as(name, mesh, Options { max_error: MaxError::Relative(share), ..Options::default() })
}

/// With the feature lines that lie beside the fixture.
fn bake_as(name: &str, mesh: &Mesh, options: Options) -> Asset {
    delivery(name, mesh, options).asset
}

fn delivery(name: &str, mesh: &Mesh, options: Options) -> Delivery {
    let lines = path(&format!("{name}.edges.obj"));
    let edges = match lines.exists() {
        true => Edges::Given(ingest::read_edges(&lines, &Limits::default()).unwrap()),
        false => Edges::Auto,
    };
    let options = Options { edges, ..options };
    deliver(&Input::Mesh(mesh.clone()), &options, &mut Silent).unwrap()
}

/// Places across an ellipse, each way.
const ACROSS: i32 = 20;

/// Points of a splat's kept domain in model units: a grid, the rim, and along its cuts.
fn kept(splat: &Splat) -> Vec<DVec3> {
    let conics: Vec<Conic> = splat.clips.iter().map(|clip| clip.conic(splat.radii)).collect();
    let grid = (-ACROSS..=ACROSS).flat_map(|i| (-ACROSS..=ACROSS).map(move |j| (i, j)));
    let grid = grid.map(|(i, j)| DVec2::new(i.into(), j.into()) / f64::from(ACROSS));
    let rim = (0..128).map(|n| DVec2::from_angle(std::f64::consts::TAU * f64::from(n) / 128.0));
    let inside = grid.chain(rim).filter(|unit| unit.length_squared() <= 1.0 + 1e-12);
    let mut places: Vec<DVec2> = inside
        .map(|unit| unit * splat.radii)
        .filter(|&uv| !conics.iter().any(|conic| conic.cuts(uv)))
        .collect();
    for (own, conic) in conics.iter().enumerate() {
        let cut = |uv: DVec2| conics.iter().enumerate().any(|(n, other)| n != own && other.cuts(uv));
        places.extend(conic.points(64).filter(|&uv| splat.ellipse(uv) <= 1.0 && !cut(uv)));
    }
    places.into_iter().map(|uv| splat.surface_point(uv)).collect()
}

/// The greatest distance of the mesh's own facets from the true surface, input units.
fn facet_error(mesh: &Mesh, distance: &(dyn Fn(DVec3) -> f64 + Sync)) -> f64 {
    let frame = mesh.vertices.frame;
    let places = (0..mesh.triangles.len()).into_par_iter().flat_map_iter(|n| {
        let [a, b, c] = mesh.corners(n).map(|p| frame.to_input(p.as_dvec3()));
        [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
    });
    places.map(distance).reduce(|| 0.0, f64::max)
}

/// Greatest distance of the splats from a surface, input units.
fn backward(asset: &Asset, distance: &(dyn Fn(DVec3) -> f64 + Sync)) -> f64 {
    let places = asset.splats.par_iter().flat_map_iter(kept);
    places.map(|place| distance(asset.frame.to_input(place))).reduce(|| 0.0, f64::max)
}

/// Bakes a fixture at all budgets; its faults.
fn check(name: &str) -> Vec<String> {
    let mesh = mesh(name);
    let facets = distance::Facets::new(&mesh);
    let truth = shapes::distance(name);
    let own = truth.as_ref().map_or(0.0, |truth| facet_error(&mesh, truth) + VERTEX);
    let mut faults = Vec::new();
    for share in BUDGETS {
        let options = Options { max_error: MaxError::Relative(share), ..Options::default() };
        let asset = bake_as(name, &mesh, options);
        let bound = asset.max_error * asset.frame.scale();
        let fit = asset.fit.max / asset.max_error;
        let from_mesh = backward(&asset, &|p| facets.distance(p, 4.0 * bound)) / bound;
        eprintln!(
            "{name} at {share}: {} splats, fit {fit:.3}, backward {from_mesh:.3} bounds of the mesh",
            asset.splats.len()
        );
        if fit > 1.0 || fit.is_nan() {
            faults.push(format!("{name} at {share}: fit is {fit:.3} bounds"));
        }
        if from_mesh > RIM || from_mesh.is_nan() {
            faults.push(format!("{name} at {share}: splats stray {from_mesh:.3} bounds from the mesh"));
        }
        if let Some(truth) = &truth {
            let stray = backward(&asset, truth);
            eprintln!("    {:.3} bounds of the true surface, facets {:.3}", stray / bound, own / bound);
            if stray > RIM * bound + own || stray.is_nan() {
                faults.push(format!(
                    "{name} at {share}: splats stray {:.3} bounds from the true surface",
                    stray / bound
                ));
            }
        }
        let seen = views::compare(&mesh, &asset, SIDE);
        eprintln!("    {seen}");
        let mut shown = seen.faults();
        if share >= BUDGETS[1] {
            shown.extend(views::compare(&mesh, &asset, COARSER).faults());
        }
        faults.extend(shown.into_iter().map(|fault| format!("{name} at {share}: {fault}")));
    }
    faults
}

fn sound(name: &str) {
    let faults = check(name);
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// Slope of the logarithm of the number of splats against that of the budget, where that alone rules.
///
/// From the coarsest to the next, which alone speaks of the smooth shape: at the finest budget the facets
/// of the mesh are as large an error as the budget, and the mesh is what is baked.
fn slope(name: &str, shapes: Shapes) -> f64 {
    let mesh = mesh(name);
    let log = |share: f64| {
        let max_error = MaxError::Relative(share);
        let options = Options { max_error, shapes, holes: Holes::Leave, ..Options::default() };
        (bake_as(name, &mesh, options).splats.len() as f64).ln()
    };
    let slope = (log(BUDGETS[1]) - log(BUDGETS[0])) / (BUDGETS[1] / BUDGETS[0]).ln();
    eprintln!("{name}: slope {slope:.2}");
    slope
}

fn falls_as(name: &str, expected: f64) {
    let slope = slope(name, Shapes::All);
    assert!((slope - expected).abs() <= 0.25, "{name}: slope {slope:.2}, expected about {expected:.2}");
}

#[test]
fn sphere() {
    sound("sphere");
    falls_as("sphere", -0.5);
}

#[test]
fn torus() {
    sound("torus");
    falls_as("torus", -2.0 / 3.0);
}

#[test]
fn capped_cylinder() {
    sound("capped-cylinder");
}

#[test]
fn plate() {
    sound("plate");
}

#[test]
fn part() {
    sound("part");
}

#[test]
fn monkey_saddle() {
    sound("monkey-saddle");
}

#[test]
fn blob() {
    sound("blob");
}
