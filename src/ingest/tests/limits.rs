//! Limits, frames and formats.

use std::path::Path;

use super::super::source::Source;
use super::super::{Limits, decode, read as read_path};
use super::{cloud, message};
use crate::error::Error;

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\n";

fn refused(limits: &Limits, bytes: &[u8]) -> String {
    match decode(&Source::of_bytes(Path::new("a.obj"), bytes.to_vec(), limits)) {
        Err(error @ Error::Limits { .. }) => error.to_string(),
        other => panic!("not refused by a limit: {other:?}"),
    }
}

#[test]
fn each_limit_holds_and_is_named() {
    let limits = Limits { points: 3, ..Limits::default() };
    assert!(refused(&limits, TRIANGLE).contains("holds 4 points, over the limit of 3"));
    let limits = Limits { triangles: 1, ..Limits::default() };
    assert!(refused(&limits, TRIANGLE).contains("holds 2 triangles, over the limit of 1"));
    let ply = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\n\
        end_header\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n";
    assert!(refused(&Limits { points: 3, ..Limits::default() }, ply).contains("holds 4 points"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, TRIANGLE).unwrap();
    let limits = Limits { file_bytes: 10, ..Limits::default() };
    let message = read_path(&path, &limits).unwrap_err().to_string();
    assert!(message.contains("has 42 bytes or more, over the limit of 10"), "{message}");
    assert!(read_path(&path, &Limits { file_bytes: 42, ..limits }).is_ok());
    assert!(matches!(read_path(folder.path(), &Limits::default()), Err(Error::Io { .. })));
}

#[test]
fn every_size_and_place_fits_the_frame() {
    for size in [1e-300, 1e-12, 1.0, 1e12, 1e299] {
        for place in [0.0, 0.3, -1e7] {
            let [a, b] = [place * size, place * size + size];
            let text = format!("v {a:e} 0 0\nv {b:e} {size:e} 0\n");
            let cloud = cloud("a.obj", text.as_bytes());
            let reach = cloud.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
            assert!((0.25..=1.0).contains(&reach), "{size} {place} {reach}");
        }
    }
    for text in ["v 1.7e308 0 0\nv -1.7e308 0 0\n", "v 0 0 0\nv 1e-310 0 0\n"] {
        assert!(message("a.obj", text.as_bytes()).contains("the bounding box reaches from"));
    }
}

#[test]
fn formats_are_told_by_content_before_extension() {
    assert_eq!(
        cloud(
            "a.stl",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\n\
        property int z\nend_header\n1 2 3\n"
        )
        .positions
        .len(),
        1
    );
    assert_eq!(cloud("no_extension", b"# hello\nv 1 2 3\n").positions.len(), 1);
    assert_eq!(cloud("a.txt", b"OFF\n1 0 0\n1 2 3\n").positions.len(), 1);
    for (name, bytes, what) in [
        ("a.ply", &b"1 2 3\n4 5 6\n"[..], "is an XYZ text cloud"),
        ("a.ply", b"\x89PNG\r\n\x1a\n", "is a PNG image"),
        ("a.stl", b"abc", "is an STL mesh"),
        ("a.xyz", b"hello world", "is an XYZ text cloud"),
        ("a.bin", b"\0\0\0\0", "is of no known format"),
        ("a.ply", b"\0\0\0\0", "begins with"),
        ("a.obj", b"\n\n", "holds no point"),
        ("a.obj", b"", "is empty"),
    ] {
        let message = message(name, bytes);
        assert!(message.contains(what), "{message}");
    }
    let glb = message("a.glb", b"glTF\x02\0\0\0");
    assert!(glb.contains(if cfg!(feature = "gltf") { "12 bytes" } else { "`gltf` feature" }), "{glb}");
}
