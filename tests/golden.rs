//! The fixtures, baked now, against the golden images of the repository.
//!
//! `scripts/bless-goldens` makes the images; this test only reads them. A failure writes a page
//! that shows it, and names the page.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::fs;
use std::path::{Path, PathBuf};

use image::DynamicImage;
use qsplat::bake::{Colors, Edges, MaxError, Normals, Options, Silent};
use qsplat::model::asset::Asset;
use qsplat::render::{Camera, Picture, Settings, cpu};
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;
use qsplat::{deliver, ingest, verify};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// The fixtures that have golden images.
fn names() -> Vec<String> {
    let golden = fixtures().join("golden");
    let entries = fs::read_dir(&golden).unwrap_or_else(|error| panic!("{}: {error}", golden.display()));
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert!(names.len() >= 7, "only {names:?} have golden images; run scripts/bless-goldens");
    names
}

/// As the command line bakes by default, with the feature lines that lie beside the fixture.
fn bake(name: &str) -> Asset {
    let limits = ingest::Limits::default();
    let input = ingest::read(&fixtures().join(format!("{name}.ply")), &limits).unwrap();
    let lines = fixtures().join(format!("{name}.edges.obj"));
    let edges =
        if lines.exists() { Edges::Given(ingest::read_edges(&lines, &limits).unwrap()) } else { Edges::Auto };
    let options = Options {
        max_error: MaxError::default(),
        edges,
        edge_angle: DEFAULT_EDGE_ANGLE,
        effort: 5,
        normals: Normals::Auto,
        colors: Colors::Auto,
        ..Options::default()
    };
    deliver::deliver(&input, &options, &mut Silent).unwrap().asset
}

/// Compares every fixture; `draw` draws on the device of that name.
fn compare(device: &str, draw: &dyn Fn(&Asset, &Camera, &Settings) -> qsplat::Result<Picture>) {
    for name in names() {
        let asset = bake(&name);
        let golden = fixtures().join("golden").join(&name);
        let draw = &mut |camera: &Camera, settings: &Settings| {
            Ok(DynamicImage::from(draw(&asset, camera, settings)?.rgba).to_rgb8())
        };
        let verdict = verify::check(&asset, &golden, None, draw).unwrap();
        if !verdict.passed() {
            let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("golden-{name}-{device}"));
            let page = verify::write_evidence(&verdict, name.as_ref(), &golden, &directory).unwrap();
            panic!("{name} on the {device}: see {}\n{}", page.display(), verdict.text());
        }
    }
}

#[test]
fn the_reference_draws_the_golden_images() {
    compare("cpu", &cpu::render);
}

#[cfg(feature = "gpu")]
#[test]
fn the_gpu_draws_the_golden_images() {
    match qsplat::render::gpu::Gpu::new() {
        Ok(gpu) => compare("gpu", &|asset, camera, settings| gpu.render(asset, camera, settings)),
        Err(fault) => {
            let required = std::env::var_os("QSPLAT_REQUIRE_GPU").is_some();
            assert!(!required, "QSPLAT_REQUIRE_GPU is set: {fault}");
            eprintln!("LEFT OUT: the GPU was not held against the golden images: {fault}");
        }
    }
}
