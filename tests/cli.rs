//! The built binary, end to end: results, exit codes, and what goes to which stream.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr, clippy::float_cmp)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use qsplat::format::{self, Limits};
use qsplat::ingest;
use qsplat::measure::{Measures, fit};
use qsplat::render::input::Model;
use qsplat::report::Report;
use tempfile::TempDir;

fn fixture(name: &str) -> String {
    format!("{}/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn qsplat(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_qsplat")).args(arguments).output().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or_else(|| panic!("killed: {output:?}"))
}

/// Runs, expects exit code 0, and returns standard output.
fn ok(arguments: &[&str]) -> String {
    let output = qsplat(arguments);
    assert_eq!(code(&output), 0, "{arguments:?}\n{}", err(&output));
    out(&output)
}

/// Runs, expects exit code 2 and nothing on standard output, and returns standard error.
fn refused(arguments: &[&str]) -> String {
    let output = qsplat(arguments);
    assert_eq!((code(&output), out(&output).as_str()), (2, ""), "{arguments:?}\n{}", err(&output));
    let message = err(&output);
    assert!(!message.contains("internal error"), "{arguments:?}: {message}");
    message
}

/// A capped cylinder with its feature lines, baked once for all tests.
fn baked() -> &'static (TempDir, String) {
    static BAKED: OnceLock<(TempDir, String)> = OnceLock::new();
    BAKED.get_or_init(|| {
        let directory = tempfile::tempdir().unwrap();
        let file = text(&directory.path().join("cylinder.qsplat"));
        let (input, edges) = (fixture("capped-cylinder.ply"), fixture("capped-cylinder.edges.obj"));
        let report = text(&directory.path().join("report.json"));
        ok(&["bake", &input, "--edges", &edges, "-o", &file, "--report", &report]);
        (directory, file)
    })
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

#[test]
fn bake_and_info_say_the_same_of_a_file() {
    let (directory, file) = baked();
    let json = fs::read_to_string(directory.path().join("report.json")).unwrap();
    let bake: Report = serde_json::from_str(&json).unwrap();
    let info: Report = serde_json::from_str(&ok(&["info", file, "--json"])).unwrap();
    assert_eq!((&info.schema, &info.counts, &info.error), (&bake.schema, &bake.counts, &bake.error));
    assert_eq!((&info.file, &info.model), (&bake.file, &bake.model));
    assert!(info.input.is_none() && info.options.is_none() && info.run.is_none());
    assert_eq!(bake.file.bytes, fs::metadata(file).unwrap().len());
    let of_chunks: u64 = bake.file.chunks.iter().map(|chunk| chunk.coded_bytes).sum();
    assert_eq!(bake.file.head_bytes + of_chunks, bake.file.bytes, "every byte is accounted for");
    assert!(bake.error.within_budget && bake.error.fit.max > 0.0 && bake.error.fit.rms <= bake.error.fit.max);
    assert!((bake.error.budget - 1e-3).abs() < 1e-9, "the default is 0.1 % of the diagonal");
    assert!(bake.counts.clipped > 0 && bake.counts.curved_clips > 0, "{:?}", bake.counts);
    let counts = info.counts;
    assert!(counts.cylinder > 0, "the mantle is a cylinder: {counts:?}");
    assert_eq!(counts.flat + counts.cylinder + counts.quadric, counts.splats, "{counts:?}");
    let input = bake.input.unwrap();
    assert_eq!((input.points, input.triangles, input.line_segments), (3462, 6920, Some(194)));
    let names: Vec<String> = bake.run.unwrap().stages.into_iter().map(|stage| stage.name).collect();
    for stage in ["read", "analyse", "sample", "encode", "write"] {
        assert!(names.iter().any(|name| name == stage), "{stage} is not among {names:?}");
    }
    let table = ok(&["info", file]);
    assert!(table.contains("within") || table.contains("kept"));
    let row = format!(
        "{} ({} flat, {} cylinder, {} quadric, {} clipped)",
        counts.splats, counts.flat, counts.cylinder, counts.quadric, counts.clipped
    );
    assert!(table.contains(&row), "{row} is missing in\n{table}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let (directory, file) = baked();
    let (input, edges) = (fixture("capped-cylinder.ply"), fixture("capped-cylinder.edges.obj"));
    for threads in ["1", "2", "3"] {
        let other = text(&directory.path().join(format!("threads-{threads}.qsplat")));
        ok(&["bake", &input, "--edges", &edges, "-o", &other, "--threads", threads]);
        assert!(fs::read(&other).unwrap() == fs::read(file).unwrap(), "{threads} threads change the file");
    }
}

#[test]
fn a_lower_bound_is_told_where_asked_for_and_changes_no_byte() {
    let (directory, file) = baked();
    let read = |name: &str| -> Report {
        serde_json::from_str(&fs::read_to_string(directory.path().join(name)).unwrap()).unwrap()
    };
    assert!(read("report.json").choice.unwrap().lower_bound.is_none());
    let (input, edges) = (fixture("capped-cylinder.ply"), fixture("capped-cylinder.edges.obj"));
    let bounds = ["1", "3"].map(|threads| {
        let name = format!("bounded-{threads}.json");
        let [other, report] = ["bounded.qsplat", &name].map(|name| text(&directory.path().join(name)));
        let table = ok(&[
            "bake",
            &input,
            "--edges",
            &edges,
            "-o",
            &other,
            "--report",
            &report,
            "--lower-bound",
            "--threads",
            threads,
        ]);
        assert!(table.contains("by its candidates (within "), "{table}");
        assert!(fs::read(&other).unwrap() == fs::read(file).unwrap(), "the bound changes the file");
        let report = read(&name);
        assert!(report.run.unwrap().stages.iter().any(|stage| stage.name == "bound"));
        let bound = report.choice.unwrap().lower_bound.unwrap();
        // Nine bytes are the least that a splat costs.
        assert!(bound.cost >= 9.0 * report.counts.splats as f64, "{bound:?}");
        assert!(0.0 < bound.area && bound.area <= bound.lagrangian, "{bound:?}");
        assert!(bound.lagrangian <= bound.cost && bound.lagrangian > 0.5 * bound.cost, "{bound:?}");
        bound
    });
    assert!(bounds[0] == bounds[1], "{bounds:?}");
}

#[test]
fn an_absolute_bound_is_in_input_units() {
    let directory = tempfile::tempdir().unwrap();
    let (file, report) = (text(&directory.path().join("a.qsplat")), text(&directory.path().join("a.json")));
    ok(&[
        "bake",
        &fixture("sphere.ply"),
        "-o",
        &file,
        "--max-error",
        "0.002",
        "--report",
        &report,
        "--quiet",
    ]);
    let report: Report = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
    let bound = report.error.budget * report.model.diagonal;
    assert!((bound - 0.002).abs() < 1e-7, "{bound}");
    assert_eq!(report.options.unwrap().max_error_unit, "input");
}

#[test]
fn a_coarse_bound_is_narrowed_unless_it_alone_rules() {
    let directory = tempfile::tempdir().unwrap();
    let (file, report) = (text(&directory.path().join("a.qsplat")), text(&directory.path().join("a.json")));
    let input = fixture("blob.ply");
    let bake = |more: &[&str]| {
        let common = ["bake", &input, "-o", &file, "--max-error", "1%", "--report", &report];
        let output = qsplat(&[&common, more].concat());
        assert_eq!(code(&output), 0, "{}", err(&output));
        let report: Report = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        (report, err(&output))
    };
    let check = || code(&qsplat(&["measure", &file, "--against", &input, "--check"]));
    let (closed, notes) = bake(&[]);
    assert!(closed.error.budget < 0.002 && notes.contains("--holes leave keeps to it"), "{notes}");
    assert_eq!(check(), 0);
    let (left, notes) = bake(&["--holes", "leave"]);
    assert!((left.error.budget - 0.01).abs() < 1e-9 && notes.is_empty(), "{notes}");
    assert!(left.file.bytes < closed.file.bytes, "{} bytes for {}", left.file.bytes, closed.file.bytes);
    assert_eq!(check(), 1, "it stands out by pixels");
}

#[test]
fn streams_are_kept_apart() {
    let directory = tempfile::tempdir().unwrap();
    let file = text(&directory.path().join("a.qsplat"));
    let bake = |more: &[&str]| {
        let input = fixture("monkey-saddle.ply");
        let output = qsplat(&[&["bake", &input, "-o", &file], more].concat());
        assert_eq!(code(&output), 0, "{}", err(&output));
        (out(&output), err(&output))
    };
    let (result, notes) = bake(&[]);
    assert!(result.contains("splats") && notes.is_empty(), "nothing but the result when piped: {notes}");
    assert_eq!(bake(&["--quiet", "--progress", "json"]), (String::new(), String::new()));
    let (_, lines) = bake(&["--progress", "json"]);
    let stages = lines.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    assert!(stages.filter(|line| line["event"] == "stage").count() >= 5, "{lines}");
    let (result, lines) = bake(&["--progress", "plain"]);
    assert!(lines.lines().any(|line| line.ends_with("sample")) && result.contains("splats"), "{lines}");
}

#[test]
fn wrong_usage_ends_in_2_with_a_reason() {
    let sphere = fixture("sphere.ply");
    let bake = |more: &[&str]| refused(&[&["bake", &sphere, "-o", "never.qsplat"], more].concat());
    for (more, word) in [
        (["--max-error", "0"], "positive"),
        (["--max-error", "-3%"], "positive"),
        (["--max-error", "thin"], "0.1%"),
        (["--max-error", "nan"], "positive"),
        (["--max-error", "200%"], "100%"),
        (["--effort", "10"], "1..=9"),
        (["--normals", "maybe"], "estimate"),
        (["--color", "keep"], "colour"),
        (["--edges", "no-such-file.obj"], "no-such-file.obj"),
        (["--edge-angle", "400"], "180"),
        (["--threads", "0"], "threads"),
        (["--progress", "loud"], "plain"),
    ] {
        let message = bake(&more);
        assert!(message.contains(word), "{more:?}: {message}");
    }
    let lines = fixture("capped-cylinder.edges.obj");
    let message = refused(&["bake", &sphere, "-o", "never.qsplat", "--clip", "partners", "--edges", &lines]);
    assert!(message.contains("leave --edges out"), "{message}");
    assert!(!Path::new("never.qsplat").exists());
    let render = |more: &[&str]| refused(&[&["render", &sphere, "-o", "never.png"], more].concat());
    for (more, word) in [
        (vec!["--size", "0x10"], "16384"),
        (vec!["--size", "99999x99999"], "16384"),
        (vec!["--size", "big"], "1024x768"),
        (vec!["--fov", "180"], "180"),
        (vec!["--ortho", "--fov", "30"], "--fov"),
        (vec!["--view", "above"], "iso"),
        (vec!["--view", "10,95"], "elevation"),
        (vec!["--camera", "none.json"], "none.json"),
        (vec!["--camera", &sphere], "sphere.ply"),
        (vec!["--show", "bones"], "shaded"),
        (vec!["--device", "tpu"], "gpu"),
    ] {
        let message = render(&more);
        assert!(message.contains(word), "{more:?}: {message}");
    }
    refused(&[]);
    refused(&["paint"]);
    refused(&["render", &sphere]);
    assert!(refused(&["info", "no-such.qsplat"]).contains("no-such.qsplat"));
    assert!(refused(&["verify", &sphere, "--golden", "x", "--max-flip", "2"]).contains("between 0 and 1"));
    for help in [vec!["--help"], vec!["bake", "--help"], vec!["--version"]] {
        assert!(ok(&help).contains("qsplat"), "{help:?}");
    }
}

#[test]
fn pictures_of_file_and_input_agree() {
    let (directory, file) = baked();
    let picture = |name: &str, more: &[&str]| {
        let path = directory.path().join(format!("{name}.png"));
        ok(&[&["render", "-o", &text(&path), "--size", "160x120", "--device", "cpu"], more].concat());
        image::open(&path).unwrap().to_rgb8()
    };
    let input = fixture("capped-cylinder.ply");
    let splats = picture("whole", &[file, "--view", "iso"]);
    let mesh = picture("mesh", &[&input, "--view", "iso"]);
    assert_eq!(splats.dimensions(), (160, 120));
    let flip = qsplat::measure::image::flip(&mesh, &splats).unwrap().mean();
    assert!(flip < 0.02, "FLIP {flip} between input and bake");
    let aside = picture("aside", &[file, "--view", "-30,-20", "--ortho"]);
    assert!(aside != splats);
    for show in ["normals", "depth", "splats", "kinds"] {
        assert!(picture(show, &[file, "--view", "iso", "--show", show]) != splats, "{show} shows the same");
    }
    let camera = text(&directory.path().join("camera.json"));
    let json = r#"{"eye":[0,-4,0.5],"target":[0,0,0.5],"up":[0,0,1],"projection":{"perspective":{"fov_degrees":25}}}"#;
    fs::write(&camera, json).unwrap();
    let stored = picture("stored", &[file, "--camera", &camera]);
    assert!(stored.pixels().any(|pixel| pixel.0 != [255; 3]), "the camera sees the model");
    assert!(ok(&["render", "--list-devices"]).contains("CPU reference"));
}

#[test]
fn export_gives_faces_that_name_their_splat() {
    let (directory, file) = baked();
    let path = directory.path().join("out.ply");
    assert_eq!(ok(&["export", file, "-o", &text(&path)]), "");
    let bytes = fs::read(&path).unwrap();
    let header = String::from_utf8_lossy(&bytes[..400]).into_owned();
    assert!(header.contains("property double x") && header.contains("property int splat"), "{header}");
    let limits = qsplat::ingest::Limits::default();
    let qsplat::ingest::Input::Mesh(mesh) = qsplat::ingest::read(&path, &limits).unwrap() else {
        panic!("not a mesh");
    };
    // The area of the cylinder (radius 0.3, height 1, two caps), splats overlapping.
    let scale = mesh.vertices.frame.scale();
    let area: f64 = (0..mesh.triangles.len())
        .map(|t| mesh.corners(t).map(|p| p.as_dvec3() * scale))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum();
    let true_area = 2.0 * std::f64::consts::PI * 0.3 * (1.0 + 0.3);
    assert!(area > 0.99 * true_area && area < 4.0 * true_area, "{area} for {true_area}");
}

#[test]
fn edges_finds_the_lines_of_a_mesh_and_bake_takes_them() {
    let directory = tempfile::tempdir().unwrap();
    let lines = text(&directory.path().join("lines.obj"));
    let (input, truth) = (fixture("part.ply"), fixture("part.edges.obj"));
    let found = ok(&["edges", &input, "-o", &lines, "--against", &truth, "--json"]);
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    for key in ["precision", "recall"] {
        assert!(found[key].as_f64().unwrap() > 0.99, "{found}");
    }
    let documented = include_str!("../docs/edges-schema.md");
    for (key, _) in found.as_object().unwrap() {
        assert!(documented.contains(&format!("| `{key}` |")), "{key} is not documented");
    }
    let read = qsplat::ingest::read_edges(Path::new(&lines), &qsplat::ingest::Limits::default()).unwrap();
    assert_eq!(read.segments() as u64, found["segments"].as_u64().unwrap());
    let bakes = [&lines, "auto"].map(|edges| {
        let file = text(&directory.path().join("part.qsplat"));
        ok(&["bake", &input, "--edges", edges, "-o", &file]);
        fs::read(file).unwrap()
    });
    assert!(bakes[0] == bakes[1], "the lines found are those that a bake finds");
    let half = ok(&["edges", &input, "-o", &lines, "--edge-angle", "179", "--against", &truth]);
    assert!(half.contains("recall        0.0 %"), "{half}");
    let smooth = ok(&["edges", &fixture("torus-cloud.ply"), "-o", &lines]);
    assert!(smooth.contains("lines         0,"), "{smooth}");
}

#[test]
fn lines_beside_their_edges_are_moved_and_lines_that_mean_nothing_are_named() {
    let (directory, file) = baked();
    let exact = fs::read_to_string(fixture("capped-cylinder.edges.obj")).unwrap();
    // A thousandth of the diagonal to the side, and one line more.
    let moved = exact.lines().map(|line| match line.strip_prefix("v ") {
        Some(place) => {
            let mut place: Vec<f64> = place.split(' ').map(|number| number.parse().unwrap()).collect();
            place[0] += 2e-3;
            format!("v {} {} {}\n", place[0], place[1], place[2])
        }
        None => format!("{line}\n"),
    });
    let moved = moved.collect::<String>() + "v 5 5 5\nv 5 5 6\nl -2 -1\n";
    let [edges, other, report] =
        ["moved.obj", "moved.qsplat", "moved.json"].map(|name| text(&directory.path().join(name)));
    fs::write(&edges, moved).unwrap();
    let input = fixture("capped-cylinder.ply");
    let output = qsplat(&["bake", &input, "--edges", &edges, "-o", &other, "--report", &report]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(fs::read(&other).unwrap() == fs::read(file).unwrap(), "as with the lines where they belong");
    let number = exact.lines().filter(|line| line.starts_with('l')).count() + 1;
    assert!(err(&output).contains(&format!("(number {number})")), "{}", err(&output));
    let report: Report = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    let input = report.input.unwrap();
    assert_eq!(input.lines_lost, [number as u64]);
    assert!(input.lines_moved.unwrap() > 0.5, "{:?}", input.lines_moved);
}

#[test]
fn measure_knows_what_was_baked_in_the_place_of_facets() {
    let directory = tempfile::tempdir().unwrap();
    let [input, file] = ["coarse.obj", "coarse.qsplat"].map(|name| text(&directory.path().join(name)));
    // An octahedron: the coarsest of spheres.
    let corners = "v 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\n";
    let normals = corners.replace('v', "vn");
    let faces = [[1, 2, 3], [2, 4, 3], [4, 5, 3], [5, 1, 3], [2, 1, 6], [4, 2, 6], [5, 4, 6], [1, 5, 6]];
    let faces: String = faces.iter().map(|[a, b, c]| format!("f {a}//{a} {b}//{b} {c}//{c}\n")).collect();
    fs::write(&input, format!("{corners}{normals}{faces}")).unwrap();
    let report = text(&directory.path().join("report.json"));
    ok(&["bake", &input, "--surface", "auto", "-o", &file, "--max-error", "0.5%", "--report", &report]);
    let report: Report = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    assert!(report.input.unwrap().smooth);
    let measured = |surface: &str| -> Measures {
        let json = ok(&["measure", &file, "--against", &input, "--surface", surface, "--json"]);
        serde_json::from_str(&json).unwrap()
    };
    let (smooth, facets) = (measured("auto"), measured("facets"));
    assert!(smooth.backward.max <= 2.0 * smooth.budget && smooth.forward.max <= smooth.budget);
    assert!(facets.backward.max > 0.05, "the facets lie far inside: {}", facets.backward.max);
}

#[test]
fn verify_passes_and_finds_one_changed_coefficient() {
    let (directory, file) = baked();
    let golden = text(&directory.path().join("golden"));
    let verify = |file: &str, more: &[&str]| {
        qsplat(&[&["verify", file, "--golden", &golden, "--device", "cpu"], more].concat())
    };
    assert!(err(&verify(file, &[])).contains("--bless"), "nothing to compare with yet");
    ok(&["verify", file, "--golden", &golden, "--bless"]);
    let sound = verify(file, &["--max-flip", "0"]);
    assert_eq!(code(&sound), 0, "{}", out(&sound));
    let mut asset = format::read_file(file.as_ref(), &Limits::default()).unwrap();
    let splat = asset.splats.iter_mut().find(|splat| splat.curvature.length() > 0.0).unwrap();
    splat.curvature *= 1.5;
    let changed = text(&directory.path().join("changed.qsplat"));
    format::write_file(changed.as_ref(), &format::encode(&asset).unwrap()).unwrap();
    let failed = verify(&changed, &[]);
    assert_eq!(code(&failed), 1, "{}", out(&failed));
    assert!(out(&failed).contains("FAILED") && err(&failed).contains("--report"), "{}", err(&failed));
    let page = directory.path().join("page");
    assert_eq!(code(&verify(&changed, &["--report", &text(&page)])), 1);
    let html = fs::read_to_string(page.join("index.html")).unwrap();
    assert!(html.contains("FAILED") && html.contains("iso-heat.png") && page.join("iso-heat.png").exists());
}

/// Runs `measure` on the cylinder of [`baked`].
fn measured(more: &[&str]) -> Output {
    let (_, file) = baked();
    let (input, edges) = (fixture("capped-cylinder.ply"), fixture("capped-cylinder.edges.obj"));
    qsplat(&[&["measure", file, "--against", &input, "--edges", &edges], more].concat())
}

#[test]
fn measure_says_everything_and_passes_its_check() {
    let (directory, file) = baked();
    let page = directory.path().join("measured");
    let output = measured(&["--json", "--check", "--report", &text(&page)]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let value: serde_json::Value = serde_json::from_str(&out(&output)).unwrap();
    for (part, keys) in [
        ("fit", "rms p99 max"),
        ("forward", "rms max"),
        ("backward", "rms p99 max"),
        ("normal", "rms_deg p99_deg"),
        ("edge", "rms max"),
        ("holes", "missing extra views pixels"),
        ("image", "flip_mean flip_p99 psnr ssim normal_flip_mean"),
        ("cost", "bytes splats decode_seconds cpu_frame_ms fragments overlap"),
    ] {
        for key in keys.split(' ') {
            assert!(value[part][key].is_number(), "{part}.{key} in {value}");
        }
    }
    let measures: Measures = serde_json::from_value(value).unwrap();
    assert_eq!((measures.schema.as_str(), measures.kind.as_str()), ("qsplat-measure/1", "mesh"));
    let info: Report = serde_json::from_str(&ok(&["info", file, "--json"])).unwrap();
    let stored = info.error.fit;
    let fits =
        [(measures.fit.rms, stored.rms), (measures.fit.p99, stored.p99), (measures.fit.max, stored.max)];
    for (measured, stored) in fits {
        // The file rounds up to parts of the budget; both are shares of the diagonal.
        let over = 8192.0 * (stored - measured) / info.error.budget;
        assert!(
            (-1e-9..=1.0).contains(&over),
            "{stored} is stored and {measured} measured: {over} parts off"
        );
    }
    assert_eq!(measures.cost.bytes, info.file.bytes);
    let coded: u64 = measures.cost.chunks.iter().map(|chunk| chunk.coded_bytes).sum();
    assert_eq!(measures.cost.head_bytes + coded, measures.cost.bytes, "every byte is accounted for");
    assert_eq!((measures.holes.missing, measures.holes.extra, measures.views.len()), (0, 0, 26));
    assert!(measures.image.flip_mean < 0.03 && measures.image.ssim > 0.9, "{:?}", measures.image);
    let stored = fs::read_to_string(page.join("measures.json")).unwrap();
    assert_eq!(stored, out(&output));
    let html = fs::read_to_string(page.join("index.html")).unwrap();
    assert!(html.contains("passed") && html.contains("right-top-front"), "{html}");
}

#[test]
fn measure_finds_a_splat_that_is_gone() {
    let (directory, file) = baked();
    let mut asset = format::read_file(file.as_ref(), &Limits::default()).unwrap();
    let cloud = ingest::read(fixture("capped-cylinder.ply").as_ref(), &ingest::Limits::default()).unwrap();
    let points = fit::points(Model::Cloud(cloud.cloud()), &[]);
    let without = |n: &usize| {
        let mut asset = asset.clone();
        asset.splats.remove(*n);
        fit::fit(&points, &asset, fit::REACH * asset.max_error).uncovered
    };
    // The one that leaves the most behind.
    let gone = (0..asset.splats.len()).max_by_key(without).unwrap();
    asset.splats.remove(gone);
    let holed = text(&directory.path().join("holed.qsplat"));
    format::write_file(holed.as_ref(), &format::encode(&asset).unwrap()).unwrap();
    let (input, page) = (fixture("capped-cylinder.ply"), directory.path().join("holed"));
    let measure = |more: &[&str]| qsplat(&[&["measure", &holed, "--against", &input], more].concat());
    let told = measure(&[]);
    assert_eq!(code(&told), 0, "only --check judges: {}", err(&told));
    assert!(out(&told).contains("points not covered") && out(&told).contains("holes"), "{}", out(&told));
    let failed = measure(&["--check", "--report", &text(&page)]);
    assert_eq!(code(&failed), 1, "{}", err(&failed));
    assert!(out(&failed).contains("FAILED") && err(&failed).contains("index.html"), "{}", out(&failed));
    let html = fs::read_to_string(page.join("index.html")).unwrap();
    assert!(html.contains("FAILED") && html.contains("-holes.png") && html.contains("splats seen within"));
    let pictures = fs::read_dir(&page)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with("-holes.png"));
    assert!(pictures.count() > 1);
}

/// A sphere of a thousand points and so many strays, as a PLY.
fn strewn(strays: u32) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        1000 + strays
    );
    for n in 0..1000 {
        let z = 1.0 - (2.0 * f64::from(n) + 1.0) / 1000.0;
        let (sin, cos) = (2.399_963 * f64::from(n)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        text += &format!("{} {} {z}\n", across * cos, across * sin);
    }
    for n in 0..strays {
        text += &format!("{} 2 {}\n", 1.5 + 0.01 * f64::from(n), 0.3 * f64::from(n));
    }
    text
}

#[test]
fn outliers_are_a_class_of_their_own_to_bake_and_measure() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| text(&directory.path().join(name));
    let (input, file, report) = (path("strewn.ply"), path("strewn.qsplat"), path("report.json"));
    for strays in [0, 3] {
        fs::write(&input, strewn(strays)).unwrap();
        let bake = qsplat(&["bake", &input, "-o", &file, "--report", &report, "--max-error", "1%"]);
        assert_eq!(code(&bake), 0, "{}", err(&bake));
        let written: Report = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        assert_eq!(written.input.unwrap().outliers, u64::from(strays));
        assert_eq!(err(&bake).contains("3 of 1003 points are outliers"), strays > 0, "{}", err(&bake));
        assert_eq!(out(&bake).contains("outliers      3 points that belong"), strays > 0, "{}", out(&bake));
    }
    let pages = path("pages");
    let table = ok(&["measure", &file, "--against", &input, "--report", &pages]);
    assert!(table.contains("outliers      3 points that belong"), "{table}");
    let json = fs::read_to_string(Path::new(&pages).join("measures.json")).unwrap();
    let measures: Measures = serde_json::from_str(&json).unwrap();
    assert_eq!((measures.outliers, measures.uncovered, measures.cost.input_points), (3, 0, 1003));
    assert!(measures.fit.max <= measures.budget && measures.forward.max <= measures.budget);
}

#[test]
fn measure_refuses_what_does_not_belong_together() {
    let (_, file) = baked();
    let message = refused(&["measure", file, "--against", &fixture("sphere.ply")]);
    assert!(message.contains("belong together") && message.contains("baked from"), "{message}");
    assert!(refused(&["measure", file]).contains("--against"));
    let input = fixture("capped-cylinder.ply");
    assert!(refused(&["measure", &input, "--against", &input]).contains("capped-cylinder.ply"));
    refused(&["measure", file, "--against", &input, "--edges", "/no/such/lines.obj"]);
}

#[test]
fn a_sweep_keeps_its_numbers_and_its_failures() {
    let directory = tempfile::tempdir().unwrap();
    let (sphere, into) = (fixture("sphere.ply"), text(&directory.path().join("made/here")));
    let sweep = |inputs: &[&str], more: &[&str]| {
        let fixed = ["report", "-o", &into, "--efforts", "1", "--frames", "1", "--progress", "json"];
        qsplat(&[&fixed, inputs, more].concat())
    };
    let output = sweep(&[&sphere, "no-such.ply"], &["--max-errors", "2%,0.5%", "--jobs", "2"]);
    assert_eq!(code(&output), 1, "a failed input is a failed check\n{}", err(&output));
    assert!(out(&output).contains("4 bakes, 1 failed"), "{}", out(&output));
    let (jobs, lines) = err(&output)
        .lines()
        .map(str::to_owned)
        .partition::<Vec<_>, _>(|line| line.contains("more than one job"));
    assert_eq!(jobs.len(), 1);
    let ended = lines.iter().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    assert_eq!(ended.filter(|line| line["event"] == "ended").count(), 4);
    let read = |name: &str| fs::read_to_string(Path::new(&into).join(name)).unwrap();
    let report: qsplat::sweep::Sweep = serde_json::from_str(&read("report.json")).unwrap();
    let (sound, lost) = (&report.models[0], &report.models[1]);
    assert!(lost.failure.as_ref().unwrap().contains("no-such.ply") && lost.cases.is_empty());
    let settings: Vec<(&str, &str)> =
        sound.cases.iter().map(|c| (c.variant.as_str(), c.max_error.as_str())).collect();
    assert_eq!(
        settings,
        [("all", "2%"), ("all", "0.5%"), ("flat", "2%"), ("flat", "0.5%")],
        "nothing is cut"
    );
    let costs: Vec<_> =
        sound.cases.iter().map(|c| c.outcome.as_ref().unwrap().measures.cost.clone()).collect();
    assert!(costs[0].splats < costs[1].splats && costs[1].splats < costs[3].splats, "{costs:?}");
    assert_eq!((costs[3].quadric, costs[3].cylinder, costs[3].flat), (0, 0, costs[3].splats));
    for case in &sound.cases {
        let measures = &case.outcome.as_ref().unwrap().measures;
        assert!(measures.fit.max <= measures.budget && measures.image.flip_mean > 0.0, "{measures:?}");
    }
    assert_eq!(read("report.csv").lines().count(), 6, "a head, four cases, a lost input");
    let page = read("report.html");
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http"), "nothing is fetched");
    for (more, word) in [
        (["--max-errors", "1%,thin"], "0.1%"),
        (["--max-errors", "1%,1%"], "twice"),
        (["--jobs", "0"], "jobs"),
        (["--frames", "0"], "frames"),
    ] {
        let output = sweep(&[&sphere], &more);
        assert!(code(&output) == 2 && err(&output).contains(word), "{more:?}: {}", err(&output));
    }
}

#[test]
fn the_gpu_passes_the_goldens_of_the_reference() {
    let required = std::env::var_os("QSPLAT_REQUIRE_GPU").is_some();
    let devices = ok(&["render", "--list-devices"]);
    if devices.lines().count() < 2 {
        assert!(!required, "QSPLAT_REQUIRE_GPU is set, and there is no graphics adapter");
        eprintln!("LEFT OUT: no graphics adapter here, so CPU and GPU were not compared");
        return;
    }
    let (directory, file) = baked();
    let golden = text(&directory.path().join("golden-gpu"));
    ok(&["verify", file, "--golden", &golden, "--bless"]);
    let verdict = qsplat(&["verify", file, "--golden", &golden, "--device", "gpu"]);
    assert_eq!(code(&verdict), 0, "{}{}", out(&verdict), err(&verdict));
}

#[test]
fn broken_files_end_in_2_and_name_the_fault() {
    let (directory, file) = baked();
    let whole = fs::read(file).unwrap();
    let broken = directory.path().join("broken.qsplat");
    for cut in [0, 1, 7, 8, 60, whole.len() / 2, whole.len() - 1] {
        fs::write(&broken, &whole[..cut]).unwrap();
        assert!(refused(&["info", &text(&broken)]).contains("broken.qsplat"), "cut at {cut}");
    }
    let target = directory.path().join("kept.qsplat");
    fs::write(&target, b"as it was").unwrap();
    let nonsense = directory.path().join("nonsense.ply");
    fs::write(&nonsense, b"ply\nformat ascii 1.0\nelement vertex 3\nend_header\n").unwrap();
    assert!(refused(&["bake", &text(&nonsense), "-o", &text(&target)]).contains("nonsense.ply"));
    assert_eq!(fs::read(&target).unwrap(), b"as it was", "a failed bake leaves its target alone");
    refused(&["bake", &fixture("sphere.ply"), "-o", "/no/such/directory/a.qsplat"]);
}

#[test]
fn malformed_models_are_refused_or_harmless() {
    let models = std::env::var_os("QSPLAT_MODELS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models"), PathBuf::from);
    let Ok(entries) = fs::read_dir(models.join("malformed")) else {
        eprintln!("LEFT OUT: no malformed models at {}; set QSPLAT_MODELS", models.display());
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let target = text(&directory.path().join("a.qsplat"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let output = qsplat(&["bake", &text(&path), "-o", &target, "--quiet"]);
        let message = err(&output);
        assert!([0, 2].contains(&code(&output)), "{}: {message}", path.display());
        assert!(!message.contains("internal error"), "{}: {message}", path.display());
        assert_eq!(code(&output) == 2, !message.is_empty(), "{}: {message}", path.display());
    }
}

#[test]
fn a_closed_pipe_is_no_panic() {
    let (_, file) = baked();
    let mut child = Command::new(env!("CARGO_BIN_EXE_qsplat"))
        .args(["info", file, "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
}
