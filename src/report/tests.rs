//! The schema against its document, and the reasons against what they say.

#![allow(clippy::unwrap_used, clippy::panic)]

use glam::{DMat3, DVec2, DVec3};

use super::*;
use crate::bake::StageTime;
use crate::measure::documented::assert_documented;
use crate::model::asset;
use crate::model::clip_curve::ClipCurve;
use crate::model::frame::Frame;
use crate::model::splat::Splat;

fn asset_of(curvature: DVec2, clips: Vec<ClipCurve>) -> Asset {
    let radii = DVec2::new(0.5, 0.3);
    let splat = Splat {
        center: DVec3::ZERO,
        axes: DMat3::IDENTITY,
        radii,
        curvature,
        clips,
        partners: Vec::new(),
        color: [255; 3],
    };
    let frame = Frame { origin: DVec3::new(1.0, 2.0, 3.0), exponent: 2 };
    let fit = asset::Accuracy { rms: 1e-4, p99: 2e-4, max: 3e-4 };
    Asset { frame, diagonal: 2.0, max_error: 1e-3, fit, has_colors: false, splats: vec![splat; 4] }
}

fn file() -> File {
    let chunks = vec![Chunk { name: "COLR".into(), coder: "zstd".into(), raw_bytes: 48, coded_bytes: 30 }];
    let fields = vec![Field { name: "norm".into(), bytes: 12.5 }];
    let absent =
        vec![Absent { name: "PART".into(), what: "clip partners".into(), reason: "there are none".into() }];
    File {
        path: "a.qsplat".into(),
        version: 2,
        required_features: 3,
        optional_features: 0,
        bytes: 200,
        head_bytes: 170,
        chunks,
        fields,
        absent,
    }
}

fn origin(edges: &str, colors_left_out: &str, feature_edges: u64) -> Origin {
    let input = Input {
        path: "a.ply".into(),
        kind: "mesh".into(),
        points: 50,
        triangles: 96,
        dropped_points: 1,
        dropped_triangles: 2,
        turned_triangles: 4,
        sewn_vertices: 5,
        outliers: 3,
        open_places: vec![OpenPlace { points: 30, middle: [1.0, 2.0, 3.0], reach: 0.5 }],
        open_place_count: 2,
        sparse: Some(Sparse { points: 7, worst: [1.0, 2.0, 4.0], by: 2e-3 }),
        smooth: false,
        noise: Some(1e-5),
        moved: Some(Moved { rms: 1e-5, max: 5e-5 }),
        normals: false,
        colors: true,
        colors_left_out: Some(colors_left_out.into()),
        feature_edges,
        line_segments: None,
        lines_matched: None,
        lines_smooth: None,
        lines_moved: None,
        lines_merged: None,
        lines_lost: Vec::new(),
    };
    let options = Options {
        max_error: 1e-3,
        max_error_unit: "diagonal".into(),
        edges: edges.into(),
        edge_angle: 40.0,
        surface: "facets".into(),
        denoise: true,
        effort: 5,
        normals: "auto".into(),
        color: "auto".into(),
        shapes: "all".into(),
        clips: "curved".into(),
        holes: "close".into(),
    };
    let stage = |name: &str, wall_seconds| StageTime {
        name: name.into(),
        wall_seconds,
        cpu_seconds: 2.0 * wall_seconds,
    };
    let run = Run::of_stages(vec![stage("read", 0.25), stage("sample", 0.375), stage("read", 0.125)], 2);
    let lower_bound = Some(LowerBound { cost: 120.0, area: 90.5, lagrangian: 110.9, rounds: 300 });
    let edge_cases = EdgeCases {
        several_lines: 6,
        inflections: 7,
        corners: 9,
        curved_arms: 8,
        loops: 1,
        several_curves: 10,
        line_ends: 11,
        meetings: vec![Meeting { lines: 3, places: 12 }, Meeting { lines: 4, places: 1 }],
    };
    let choice = Choice {
        samples: 900,
        candidates: 20,
        redundant: 3,
        merged: 4,
        following: 6,
        sealing: 5,
        withdrawn: 2,
        last_resorts: 1,
        low_rank: 2,
        edge_cases,
        lower_bound,
    };
    Origin { input, options, choice, overlap: Some(1.25), run }
}

fn full() -> Report {
    Report::new(&asset_of(DVec2::ZERO, vec![]), file(), Some(origin("auto", "dropped as asked", 0)))
}

#[test]
fn every_key_is_documented_and_nothing_else() {
    assert_documented(full(), &[], include_str!("../../docs/report-schema.md"), SCHEMA);
}

#[test]
fn a_report_survives_its_json() {
    let report = full();
    let back: Report = serde_json::from_str(&report.json().unwrap()).unwrap();
    assert_eq!(back, report);
}

#[test]
fn what_a_file_cannot_know_is_null() {
    let value = serde_json::to_value(Report::new(&asset_of(DVec2::ONE, vec![]), file(), None)).unwrap();
    for key in ["input", "options", "choice", "run"] {
        assert!(value[key].is_null(), "{key}");
    }
    for key in ["bytes_per_point", "overlap"] {
        assert!(value["density"][key].is_null(), "{key}");
    }
}

#[test]
fn numbers_are_fractions_of_the_diagonal() {
    let report = full();
    assert!((report.error.fit.max - 1.5e-4).abs() < 1e-18 && (report.error.budget - 5e-4).abs() < 1e-18);
    assert!(report.error.within_budget);
    assert!((report.model.diagonal - 8.0).abs() < 1e-12, "input units");
    assert!((report.density.bytes_per_splat - 50.0).abs() < 1e-12);
    assert_eq!(report.density.bytes_per_point, Some(4.0));
    let run = report.run.unwrap();
    assert_eq!((run.stages.len(), run.stages[0].name.as_str()), (2, "read"), "stages of one name are one");
    assert!((run.stages[0].wall_seconds - 0.375).abs() < 1e-12);
    assert!((run.wall_seconds - 0.75).abs() < 1e-12 && (run.cpu_seconds - 1.5).abs() < 1e-12);
}

#[test]
fn what_is_left_out_says_why() {
    let reason = |report: &Report, name: &str| {
        let thing = report.optional.iter().find(|thing| thing.name == name).unwrap();
        assert_eq!(thing.present, thing.reason.is_none(), "{name}");
        thing.reason.clone().unwrap_or_default()
    };
    let report = full();
    assert!(reason(&report, "curvature").contains("flat"));
    assert!(reason(&report, "clips").contains("no feature lines"));
    assert!(reason(&report, "colors").contains("as asked"));
    let off = Report::new(
        &asset_of(DVec2::ONE, vec![]),
        file(),
        Some(origin("none", "the input is of one colour", 0)),
    );
    assert!(reason(&off, "clips").contains("--edges none"));
    assert!(reason(&off, "colors").contains("one colour"));
    assert_eq!(reason(&off, "curvature"), "");
    let straight = Report::new(&asset_of(DVec2::ONE, vec![ClipCurve::chord(0.0, 1.0)]), file(), None);
    assert_eq!(reason(&straight, "clips"), "");
    assert!(reason(&straight, "curved_clips").contains("straight"));
}

#[test]
fn the_table_names_what_matters() {
    let table = full().table();
    for part in [
        "a.qsplat",
        "a.ply",
        "4 (4 flat, 0 cylinder, 0 quadric, 0 clipped)",
        "max 1.50e-4",
        "COLR",
        "norm 12",
        "sample",
        "kept",
        "outliers      3 points that belong to no surface were left out",
        "open          2 borders and rims of holes, the longest around (1.000000, 2.000000, 3.000000), 30 points there",
        "overlap       1.25 of the input's area",
    ] {
        assert!(table.contains(part), "{part} is missing in\n{table}");
    }
}

#[test]
fn the_table_tells_how_far_the_cover_is_from_the_best_only_where_that_is_known() {
    let told = "cover         cost 120, at least 110 by its candidates (within 8.3 %; 90 by area)\n";
    let mut report = full();
    assert!(report.table().contains(told), "{}", report.table());
    report.choice.as_mut().unwrap().lower_bound = None;
    assert!(!report.table().contains("by its candidates"), "{}", report.table());
}
