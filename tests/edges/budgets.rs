//! Models with lines at three bounds: cuts along the lines and rims near the surface.

use std::path::{Path, PathBuf};

use qsplat::bake::{Edges, Holes, MaxError, Options};
use qsplat::ingest::{Limits, read, read_edges};
use qsplat::tolerance::COARSEST_CLOSED;

use super::measured::measured;

/// Shares of the diagonal.
const BOUNDS: [f64; 3] = [3e-3, 1e-3, 3e-4];

/// Bakes a model at some bounds; its faults. `lines` are those given, or none for those found: the
/// bumpy cube has none, and only its rims are judged.
fn check(path: &Path, lines: Option<&Path>, bounds: &[f64]) -> Vec<String> {
    let input = read(path, &Limits::default()).unwrap();
    let mut faults = Vec::new();
    for &bound in bounds {
        let given = lines.map(|lines| Edges::Given(read_edges(lines, &Limits::default()).unwrap()));
        // A bound wider than a pixel would be narrowed to one otherwise, and the coarsest not be tried.
        let holes = if bound > COARSEST_CLOSED { Holes::Leave } else { Holes::Close };
        let max_error = MaxError::Relative(bound);
        let options = Options { max_error, edges: given.unwrap_or_default(), holes, ..Options::default() };
        let (_, found) = measured(&input, &options);
        let name = format!("{} at {} %", path.file_stem().unwrap().display(), 100.0 * bound);
        eprintln!("{name}: {found}");
        if !found.has_edge() {
            eprintln!("    it has no line to follow");
        }
        faults.extend(found.faults().into_iter().map(|fault| format!("{name}: {fault}")));
    }
    faults
}

fn kept(faults: &[String]) {
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

fn fixture(name: &str) {
    let path =
        |end: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(format!("{name}.{end}"));
    let lines = path("edges.obj");
    assert!(lines.exists(), "{name} has lines");
    kept(&check(&path("ply"), Some(&lines), &BOUNDS));
}

/// A model of the user's folder; where it is missing, that is said.
fn external(file: &str, lines: Option<&str>, bounds: &[f64]) {
    let folder = std::env::var_os("QSPLAT_MODELS").map(PathBuf::from);
    let there = folder.map(|folder| [Some(file), lines].map(|name| name.map(|name| folder.join(name))));
    match there {
        Some([Some(path), lines]) if path.exists() => {
            for bound in BOUNDS.iter().filter(|bound| !bounds.contains(bound)) {
                eprintln!("LEFT OUT: {file} at {} %", 100.0 * bound);
            }
            kept(&check(&path, lines.as_deref(), bounds));
        }
        _ => eprintln!("LEFT OUT: {file} (QSPLAT_MODELS names no folder that holds it)"),
    }
}

#[test]
fn capped_cylinder() {
    fixture("capped-cylinder");
}

#[test]
fn part() {
    fixture("part");
}

#[test]
fn plate() {
    fixture("plate");
}

#[test]
fn monkey_saddle() {
    fixture("monkey-saddle");
}

#[test]
fn fandisk() {
    external("fandisk.obj", None, &BOUNDS);
}

#[test]
fn teapot() {
    external("teapot.obj", None, &BOUNDS[..2]);
}

#[test]
fn suzanne() {
    external("suzanne.obj", None, &BOUNDS[1..2]);
}

#[test]
fn bumpy_cube() {
    external("bumpy-cube.obj", None, &BOUNDS);
}

#[test]
fn abc_part_with_its_lines() {
    external("abc-00000049.obj", Some("abc-00000049.features.obj"), &BOUNDS[..2]);
}
