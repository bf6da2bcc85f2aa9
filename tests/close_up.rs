//! Feature edges a hundred times enlarged: one smooth curve each, unless one looks nearly along a surface.

#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;
use std::path::Path;

use glam::DVec3;
use qsplat::bake::{Edges, Options, Silent};
use qsplat::deliver::deliver;
use qsplat::ingest;
use qsplat::model::asset::Asset;
use qsplat::render::camera::{Camera, Projection};
use qsplat::render::cpu;

/// Pixels along a side.
const SIDE: u32 = 192;

/// What a picture of the whole would have to be enlarged by to show as much.
const ENLARGED: f64 = 100.0;

/// Radius and height of the rim that is looked at.
const RIM: [f64; 2] = [0.3, 0.5];

/// How far the eye leans out over the wall, as a slope: from 17 degrees off the one to 18 degrees off the other.
const LEANS: [f64; 5] = [0.3, 0.5, 1.0, 2.0, 3.0];

/// Places around the rim.
const AROUND: u32 = 24;

fn cylinder() -> Asset {
    let fixture = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    let limits = ingest::Limits::default();
    let lines = ingest::read_edges(&fixture("capped-cylinder.edges.obj"), &limits).unwrap();
    let input = ingest::read(&fixture("capped-cylinder.ply"), &limits).unwrap();
    let options = Options { edges: Edges::Given(lines), ..Options::default() };
    deliver(&input, &options, &mut Silent).unwrap().asset
}

/// For each column of a close-up of the rim, whether its pixels show the lid, from the top.
fn lids(asset: &Asset, around: f64, lean: f64) -> Vec<Vec<bool>> {
    let (sin, cos) = around.sin_cos();
    let target = DVec3::new(RIM[0] * cos, RIM[0] * sin, RIM[1]);
    let eye = target + 3.0 * DVec3::new(lean * cos, lean * sin, 1.0).normalize();
    let height = asset.diagonal * asset.frame.scale() / ENLARGED;
    let projection = Projection::Orthographic { height };
    let (eye, target, up) = (eye.to_array(), target.to_array(), DVec3::Z.to_array());
    let camera = Camera { eye, target, up, projection, near: None };
    let seen = cpu::survey(asset, &camera, [SIDE; 2]).unwrap().visibility.seen;
    let is_lid = |x: u32, y: u32| seen[(y * SIDE + x) as usize].unwrap().normal[2] > 0.5;
    (0..SIDE).map(|x| (0..SIDE).map(|y| is_lid(x, y)).collect()).collect()
}

#[test]
fn an_edge_is_one_smooth_curve_a_hundred_times_enlarged() {
    let asset = cylinder();
    for (n, lean) in (0..AROUND).flat_map(|n| LEANS.map(|lean| (n, lean))) {
        let columns = lids(&asset, TAU * (f64::from(n) + 0.37) / f64::from(AROUND), lean);
        let end = |column: &Vec<bool>| column.iter().position(|lid| !lid).unwrap_or(column.len());
        let ends: Vec<usize> = columns.iter().map(end).collect();
        for (column, &end) in columns.iter().zip(&ends) {
            assert!(column[end..].iter().all(|lid| !lid), "{n}, {lean}: the lid shows again below the edge");
        }
        let step = ends.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max().unwrap();
        assert!(step <= 1, "{n}, {lean}: a step of {step} pixels");
        assert!(ends.iter().all(|end| (1..SIDE as usize).contains(end)), "{n}, {lean}: no edge to be seen");
    }
}
