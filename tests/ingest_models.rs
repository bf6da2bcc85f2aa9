//! Real and broken files through `ingest`: the counts of sound ones, the messages of the others.
//!
//! The models are not part of the repository. They are looked for in `QSPLAT_MODELS`, by default
//! `../shared/models` beside it; a test that does not find them says so and passes.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::path::PathBuf;

use glam::DVec3;
use qsplat::ingest::{Input, Limits, read, read_edges};
use qsplat::model::cloud::Cloud;

fn models() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let folder = std::env::var_os("QSPLAT_MODELS").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("LEFT OUT: no models at {}; set QSPLAT_MODELS", folder.display());
    None
}

/// Points, and triangles kept and dropped (`None` for a cloud).
type Found = (usize, Option<(usize, usize)>);

fn check(input: &Input) -> (Found, &Cloud) {
    let (cloud, faces) = match input {
        Input::Cloud(cloud) => (cloud, None),
        Input::Mesh(mesh) => {
            let count = mesh.vertices.positions.len() as u32;
            assert!(mesh.triangles.iter().flatten().all(|&v| v < count));
            (&mesh.vertices, Some((mesh.triangles.len(), mesh.dropped)))
        }
    };
    let count = cloud.positions.len();
    assert!(cloud.normals.is_empty() || cloud.normals.len() == count);
    assert!(cloud.colors.is_empty() || cloud.colors.len() == count);
    assert!(cloud.positions.iter().all(|p| p.abs().max_element() <= 1.0), "within the unit cube");
    ((count + cloud.dropped, faces), cloud)
}

/// Diagonal of the bounding box in the file's unit.
fn measure(cloud: &Cloud) -> f64 {
    let points = cloud.positions.iter().map(|p| p.as_dvec3());
    let (min, max) =
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
    (max - min).length() * cloud.frame.scale()
}

#[test]
fn sound_models_load_with_their_counts() {
    let Some(folder) = models() else { return };
    let files: &[(&str, usize, Option<usize>, f64)] = &[
        ("fandisk.obj", 6_475, Some(12_946), 7.616),
        ("stanford-bunny.obj", 35_947, Some(69_451), 0.2502),
        ("fertility.off", 4_494, Some(9_000), 256.7),
        ("fertility-smooth.ply", 71_994, Some(144_000), 256.1),
        ("igea.ply", 134_345, Some(268_686), 0.1564),
        ("teapot.obj", 3_644, Some(6_320), 8.205),
        ("suzanne.obj", 507, Some(968), 3.775),
        ("bumpy-cube.obj", 19_970, Some(39_936), 15.04),
        ("armadillo.ply", 49_990, Some(99_976), 228.8),
        ("xyzrgb-dragon.ply", 50_002, Some(100_000), 258.7),
        ("dragon-dense.ply", 400_000, Some(800_000), 0.2717),
        ("dragon-scans.ply", 469_193, None, 0.3352),
        ("abc-00000049.obj", 11_677, Some(23_350), 61.04),
        ("formats/cube-vertex-colors.obj", 8, Some(12), 1.732),
        ("formats/float-color.ply", 3, Some(1), 282.8),
        ("formats/igea-tristrips.ply", 134_345, Some(268_686), 0.1564),
        ("formats/suzanne-big-endian.ply", 507, Some(968), 3.775),
        #[cfg(feature = "gltf")]
        ("cesium-milk-truck.glb", 3_564, Some(3_624), 6.178),
        #[cfg(feature = "gltf")]
        ("formats/cube-vertex-colors.glb", 54, Some(48), 3.464),
        #[cfg(feature = "gltf")]
        ("formats/nested-nodes.glb", 72, Some(36), 3.672),
    ];
    for &(name, points, faces, diagonal) in files {
        let input = read(&folder.join(name), &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
        let ((found, triangles), cloud) = check(&input);
        let all = triangles.map(|(kept, dropped)| kept + dropped);
        assert_eq!((found, all), (points, faces), "{name}");
        assert_eq!(cloud.dropped, 0, "{name}");
        // The list gives four digits.
        assert!((measure(cloud) / diagonal - 1.0).abs() < 5e-4, "{name}: {} {diagonal}", measure(cloud));
    }
}

#[test]
fn attributes_of_models_are_read() {
    let Some(folder) = models() else { return };
    let vertices = |name: &str| match read(&folder.join(name), &Limits::default()).unwrap() {
        Input::Mesh(mesh) => mesh.vertices,
        Input::Cloud(cloud) => cloud,
    };
    for name in ["suzanne.obj", "xyzrgb-dragon.ply", "fertility-smooth.ply"] {
        let unit = vertices(name).normals.iter().filter(|n| (n.length() - 1.0).abs() < 1e-3).count();
        assert!(unit + 1 >= vertices(name).positions.len(), "{name}: {unit}");
    }
    // 14,893 corner normals on 11,677 vertices: the smooth vertices keep theirs.
    let creased = vertices("abc-00000049.obj").normals;
    let kept = creased.iter().filter(|n| n.length() > 0.5).count();
    assert!(kept > 5_000 && kept < creased.len(), "{kept}");
    assert_eq!(vertices("formats/float-color.ply").colors, [[0, 0, 255]; 3]);
    assert_eq!(vertices("formats/cube-vertex-colors.obj").colors.len(), 8);
    #[cfg(feature = "gltf")]
    {
        let truck = vertices("cesium-milk-truck.glb").colors;
        let distinct: std::collections::BTreeSet<_> = truck.iter().collect();
        assert!(distinct.len() > 10, "a texture and several materials: {} colours", distinct.len());
        assert!(vertices("formats/cube-vertex-colors.glb").colors.iter().all(|&c| c == [255, 0, 255]));
    }
}

#[test]
fn feature_lines_load_with_their_counts() {
    let Some(folder) = models() else { return };
    let path = folder.join("abc-00000049.features.obj");
    let lines = read_edges(&path, &Limits::default()).unwrap();
    assert_eq!(lines.lines.len(), 196);
    let message = read(&path, &Limits::default()).unwrap_err().to_string();
    assert!(message.contains("polylines and no faces"), "{message}");
    let message = read_edges(&folder.join("fandisk.obj"), &Limits::default()).unwrap_err().to_string();
    assert!(message.contains("no `l` record"), "{message}");
}

#[test]
fn the_tristrips_are_the_triangles_of_the_expanded_file() {
    let Some(folder) = models() else { return };
    let corners = |name: &str| {
        let Input::Mesh(mesh) = read(&folder.join(name), &Limits::default()).unwrap() else {
            panic!("{name} has faces");
        };
        let corners = |n| mesh.corners(n).map(|p| p.to_array().map(f32::to_bits));
        (0..mesh.triangles.len()).map(corners).collect::<Vec<_>>()
    };
    assert_eq!(corners("formats/igea-tristrips.ply"), corners("igea.ply"));
}

/// Files that are odd or have a fault that harms nothing: points, and triangles kept and dropped.
const HARMLESS: &[(&str, Found)] = &[
    ("odd-ply-mixed-lists.ply", (5, None)),
    ("odd-ply-zero-faces.ply", (1024, None)),
    ("odd-ply-crlf-header.ply", (8, Some((12, 0)))),
    ("odd-ply-trailing-bytes.ply", (8, Some((12, 0)))),
    ("odd-ply-single-point.ply", (1, None)),
    ("odd-ply-identical-points.ply", (200, None)),
    ("odd-ply-collinear-points.ply", (200, None)),
    ("odd-ply-huge-outliers.ply", (300, None)),
    ("odd-obj-negative-indices.obj", (8, Some((12, 0)))),
    ("odd-obj-non-manifold.obj", (10, Some((12, 0)))),
    ("odd-obj-degenerate-faces.obj", (6, Some((3, 1)))),
    ("odd-obj-utf16be.obj", (8, Some((12, 0)))),
    // Two of eight points are not finite; eight of twelve triangles use them.
    ("ply-nan-ascii.ply", (8, Some((4, 8)))),
    ("ply-inf-points.ply", (16, None)),
    ("obj-nan-color.obj", (8, Some((12, 0)))),
    #[cfg(feature = "gltf")]
    ("glb-bad-normals.glb", (24, Some((12, 0)))),
];

#[test]
fn odd_and_harmless_files_load() {
    let Some(folder) = models() else { return };
    for &(name, expected) in HARMLESS {
        let input = read(&folder.join("malformed").join(name), &Limits::default());
        let input = input.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(check(&input).0, expected, "{name}");
    }
}

/// The others, with a piece of the message that names the fault.
const FAULTY: &[(&str, &str)] = &[
    ("empty.ply", "is empty"),
    ("empty.obj", "is empty"),
    ("ply-is-a-png.ply", "is a PNG image"),
    ("ply-no-end-header.ply", "no `end_header` line"),
    ("ply-unknown-type.ply", "line 6: `float128` is no property type"),
    ("ply-fuzz-crash.ply", "line 7: `\\0\\0\\0` is no property type"),
    ("ply-truncated-vertices.ply", "element `vertex`, byte 170: 8 rows of at least 12 bytes need 96"),
    ("ply-truncated-faces.ply", "element `face`, row 7 of 12, byte "),
    ("ply-vertex-count-too-big.ply", "element `vertex`, byte 179: 2000000000 rows"),
    ("ply-negative-list-count.ply", "list `vertex_indices` has the count -1"),
    ("ply-face-index-out-of-range.ply", "element `face`: vertex index 8 is not in 0..8"),
    ("ply-text-in-numbers.ply", "property `y`: `abc` is no number"),
    ("obj-malformed.obj", "line 23: vertex index 12 names none of the 8 records"),
    ("obj-index-out-of-range.obj", "line 11: vertex index 9 names none of the 8 records"),
    ("obj-not-enough-indices.obj", "line 9: a face has 2 corners"),
    ("obj-inf-nan.obj", "none of its 3 points has three finite coordinates"),
    ("off-invalid.off", "line 2: `3 4` is no line of counts"),
    ("off-huge-counts.off", "353535235358 vertices and 6 faces need at least"),
    ("stl-count-mismatch.stl", "is an STL mesh, which qsplat does not read; convert it"),
    ("stl-ascii-truncated.stl", "is an STL mesh"),
    ("pcd-truncated-binary.pcd", "is a PCD point cloud"),
    ("pcd-compressed-size-too-big.pcd", "is a PCD point cloud"),
    ("pcd-lzf-bad-reference.pcd", "is a PCD point cloud"),
    ("pcd-width-height-mismatch.pcd", "is a PCD point cloud"),
    ("pcd-missing-z-field.pcd", "is a PCD point cloud"),
    ("las-truncated.las", "is a LAS or LAZ point cloud"),
    ("las-point-count-too-big.las", "is a LAS or LAZ point cloud"),
    ("e57-corrupt-crc.e57", "is an E57 point cloud"),
    ("xyz-uneven-columns.xyz", "is an XYZ text cloud"),
    ("odd-stl-binary-solid-header.stl", "is an STL mesh"),
    ("odd-stl-empty-solid.stl", "is an STL mesh"),
    #[cfg(feature = "gltf")]
    ("glb-truncated.glb", "byte 8: the GLB claims 712 bytes and has 652"),
    #[cfg(feature = "gltf")]
    ("glb-accessor-out-of-bounds.glb", "accessors[0]"),
    #[cfg(feature = "gltf")]
    ("glb-infinite-positions.glb", "finite"),
    #[cfg(feature = "gltf")]
    ("gltf-missing-bin/BoxTextured.gltf", "BoxTextured0.bin"),
    #[cfg(feature = "gltf")]
    ("gltf-index-out-of-range/IndexOutOfRange.gltf", "vertex index 255 is not in 0..24"),
    #[cfg(feature = "gltf")]
    ("gltf-recursive-nodes.gltf", "nodes[0]"),
];

#[test]
fn faulty_files_are_refused_by_what_is_wrong() {
    let Some(folder) = models() else { return };
    let mut wrong = Vec::new();
    for &(name, fault) in FAULTY {
        let path = folder.join("malformed").join(name);
        match read(&path, &Limits::default()) {
            Err(error) if error.to_string().contains(fault) => {}
            Err(error) => wrong.push(format!("{error}\n    lacks: {fault}")),
            Ok(_) => wrong.push(format!("{name} was accepted")),
        }
        assert!(read_edges(&path, &Limits::default()).is_err(), "{name} has no feature lines");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every file of the folder is spoken of above.
#[test]
fn no_malformed_file_is_forgotten() {
    let Some(folder) = models() else { return };
    for entry in std::fs::read_dir(folder.join("malformed")).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let known = HARMLESS.iter().map(|row| row.0).chain(FAULTY.iter().map(|row| row.0));
        let mentioned = known.clone().any(|known| known == name || known.starts_with(&format!("{name}/")));
        let is_gltf = name.starts_with("gl");
        assert!(mentioned || (is_gltf && !cfg!(feature = "gltf")), "{name} is not tested");
    }
}

#[test]
fn other_formats_are_named() {
    let Some(folder) = models() else { return };
    let files = [
        ("csite1-red1-utm.pcd", "PCD"),
        ("topography.laz", "LAZ"),
        ("formats/autzen.las", "LAS"),
        ("formats/box.3mf", "3MF"),
        ("formats/points-cloudcompare.xyz", "XYZ"),
        ("formats/sphere-with-hole.stl", "STL"),
        ("formats/tiny-cartesian-float-rgb.e57", "E57"),
        ("formats/topography-ascii.pcd", "PCD"),
    ];
    for (name, format) in files {
        let message = read(&folder.join(name), &Limits::default()).unwrap_err().to_string();
        assert!(message.contains(format) && message.contains("convert it to PLY"), "{message}");
    }
}
