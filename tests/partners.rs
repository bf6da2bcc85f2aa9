//! Bakes without feature lines, cut by clip partners: what they must keep and how near their
//! pictures come to the mesh's.
// What was measured is printed, so that a failure, or a curious reader, sees by how much.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use std::path::Path;

use glam::Vec3;
use qsplat::bake::{Clips, Edges, MaxError, Options, Silent};
use qsplat::ingest::{self, Input};
use qsplat::measure::fit;
use qsplat::model::cloud::Cloud;
use qsplat::model::mesh::Mesh;
use qsplat::model::polyline::Polylines;
use qsplat::render::camera::{Camera, Framing, View};
use qsplat::render::input::Style;
use qsplat::render::{cpu, input};
use qsplat::{Error, deliver, format};

/// Share of a picture's pixels at which only one of splats and mesh may show: those along the
/// outline, which an edge cut three quarters of a bound late moves by less than a pixel.
const OUTLINE: f64 = 2e-3;

/// Where edges run along rows of pixels even conics, half a bound outside their lines, move the
/// outline of a plate by more. Partners may move it by this many times as much.
const BESIDE_CONICS: f64 = 1.5;

/// A file states errors in steps of this share of the bound, rounded up.
const ERROR_STEP: f64 = 1.0 / 8192.0;

/// A cube of twelve triangles.
fn cube() -> Input {
    let corner = |n: u32| Vec3::new((n & 1) as f32, (n >> 1 & 1) as f32, (n >> 2 & 1) as f32) - 0.5;
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let vertices = Cloud { positions: (0..8).map(corner).collect(), ..Cloud::default() };
    Input::Mesh(Mesh { vertices, triangles, ..Mesh::default() })
}

fn fixture(name: &str) -> Input {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    ingest::read(&path, &ingest::Limits::default()).unwrap()
}

fn options() -> Options {
    Options { clips: Clips::Partners, ..Options::default() }
}

/// Pixels at which only one of splats and mesh shows, over some views, as a share.
fn outline(asset: &qsplat::model::asset::Asset, input: &Input) -> f64 {
    let size = [300, 300];
    let views = [View::Iso, View::Front, View::Angles { azimuth: 200.0, elevation: -35.0 }];
    let differ = |view: View| {
        let camera = Camera::framing(&asset.frame, asset.diagonal, view, Framing::default(), size);
        let splats = cpu::visibility(asset, &camera, size).unwrap();
        let mesh = input::visibility(deliver::model(input), &camera, size, &Style::default()).unwrap();
        splats.seen.iter().zip(&mesh.seen).filter(|(a, b)| a.is_some() != b.is_some()).count()
    };
    views.map(differ).iter().sum::<usize>() as f64 / (3 * size[0] * size[1]) as f64
}

#[test]
fn a_cube_is_cut_by_its_faces_alone() {
    let input = cube();
    let delivery = deliver::deliver(&input, &options(), &mut Silent).unwrap();
    let asset = &delivery.asset;
    assert!(asset.splats.iter().all(|splat| splat.clips.is_empty() && !splat.partners.is_empty()));
    assert!(asset.splats.iter().flat_map(|splat| &splat.partners).all(|group| group.len() == 1));
    let share = outline(asset, &input);
    println!(
        "cube: {} splats, {} bytes, {share:e} of the pixels differ",
        asset.splats.len(),
        delivery.bytes.len()
    );
    assert!(share < OUTLINE, "{share}");
    // Without the cuts the picture is another.
    let mut whole = asset.clone();
    whole.splats.iter_mut().for_each(|splat| splat.partners.clear());
    assert!(outline(&whole, &input) > 10.0 * OUTLINE);
}

#[test]
fn holes_and_slots_come_out() {
    for name in ["plate.ply", "capped-cylinder.ply"] {
        let input = fixture(name);
        let delivery = deliver::deliver(&input, &options(), &mut Silent).unwrap();
        let asset = &delivery.asset;
        let tally = delivery.baked.partners.unwrap();
        let share = outline(asset, &input);
        println!("{name}: {} bytes, {tally:?}, {share:e} of the pixels differ", delivery.bytes.len());
        let conics = Options { clips: Clips::Curved, ..options() };
        let conics = outline(&deliver::deliver(&input, &conics, &mut Silent).unwrap().asset, &input);
        assert!(share <= BESIDE_CONICS * conics, "{name}: {share} with partners, {conics} with conics");
        // What the file says of its fit counts what is cut away.
        let points = fit::points(deliver::model(&input), &[]);
        let found = fit::fit(&points, asset, fit::REACH * asset.max_error);
        let over = asset.fit.max - found.accuracy.max;
        let steps = 0.0..=ERROR_STEP * asset.max_error;
        assert!(found.uncovered == 0 && steps.contains(&over), "{name}: {found:?}, stated {:?}", asset.fit);
        let back = format::decode(&delivery.bytes, &format::Limits::default()).unwrap();
        assert!(&back == asset && format::encode(&back).unwrap() == delivery.bytes, "{name}");
    }
}

#[test]
fn an_open_border_keeps_its_curves() {
    let delivery = deliver::deliver(&fixture("monkey-saddle.ply"), &options(), &mut Silent).unwrap();
    let tally = delivery.baked.partners.unwrap();
    assert!(tally.pairs == 0 && delivery.asset.counts().clipped > 0, "{tally:?}");
    let curves = Options { clips: Clips::Curved, ..options() };
    let other = deliver::deliver(&fixture("monkey-saddle.ply"), &curves, &mut Silent).unwrap();
    assert!(delivery.asset.counts().clipped > other.asset.counts().clipped / 2);
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let input = fixture("capped-cylinder.ply");
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| deliver::deliver(&input, &options(), &mut Silent).unwrap().bytes)
    };
    assert_eq!(bake(1), bake(3));
}

#[test]
fn given_lines_are_refused_with_a_remedy() {
    let edges = Edges::Given(Polylines::default());
    let max_error = MaxError::Relative(0.01);
    let options = Options { edges, max_error, ..options() };
    match deliver::deliver(&cube(), &options, &mut Silent) {
        Err(Error::Usage(message)) => assert!(message.contains("--clips curved"), "{message}"),
        other => panic!("{:?}", other.map(|delivery| delivery.bytes.len())),
    }
}
