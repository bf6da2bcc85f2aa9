//! Holes and pictures of planes whose splats are squares: every answer is known.

#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};

use glam::{DMat3, DVec2, DVec3, Vec3};

use super::{Drawn, Seen, seen};
use crate::measure::measures::ViewMeasures;
use crate::measure::planted::discs;
use crate::measure::views::{SIDE, View, views};
use crate::model::asset::{Accuracy, Asset};
use crate::model::clip_curve::ClipCurve;
use crate::model::cloud::Cloud;
use crate::model::frame::Frame;
use crate::model::mesh::Mesh;
use crate::model::splat::Splat;
use crate::render::input::{Model, Prepared, Style};

/// Squares along each side of a plane, whose side is 1.
const ACROSS: u32 = 4;

/// By how much squares overlap their neighbours, so that no rounding opens a slit.
const OVERLAP: f64 = 1e-7;

/// A plane of side 1 at a height, as two triangles.
pub(in crate::measure) fn plane(height: f32) -> Mesh {
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let positions = corners.map(|[x, y]| Vec3::new(x, y, height)).to_vec();
    let vertices = Cloud { frame: Frame::default(), positions, ..Cloud::default() };
    Mesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// Squares that tile that plane: discs cut along the four sides of the square in them.
pub(in crate::measure) fn squares(height: f32) -> Vec<Splat> {
    let side = 1.0 / f64::from(ACROSS);
    let radius = side / SQRT_2 + OVERLAP;
    let clips: Vec<ClipCurve> = (0..4)
        .map(|n| f64::from(n) * FRAC_PI_2)
        .map(|towards| ClipCurve::chord(towards - FRAC_PI_4, towards + FRAC_PI_4))
        .collect();
    let place = |n: u32| (f64::from(n) + 0.5) * side - 0.5;
    let centers = (0..ACROSS * ACROSS).map(|n| DVec2::new(place(n % ACROSS), place(n / ACROSS)));
    let splat = |center: DVec2| Splat { clips: clips.clone(), ..disc(center.extend(height.into()), radius) };
    centers.map(splat).collect()
}

pub(in crate::measure) fn disc(center: DVec3, radius: f64) -> Splat {
    Splat {
        center,
        axes: DMat3::IDENTITY,
        radii: DVec2::splat(radius),
        curvature: DVec2::ZERO,
        clips: Vec::new(),
        partners: Vec::new(),
        color: [255; 3],
    }
}

pub(in crate::measure) fn asset(splats: Vec<Splat>) -> Asset {
    let (frame, fit) = (Frame::default(), Accuracy::default());
    Asset { frame, diagonal: SQRT_2, max_error: 1e-3, fit, has_colors: false, splats }
}

fn look(splats: Vec<Splat>, model: Model<'_>) -> Seen {
    let input = Prepared::new(model, &Style::default());
    let drawn: Vec<Drawn> = views(model).into_iter().map(|view| Drawn::new(&input, view).unwrap()).collect();
    seen(&asset(splats), &drawn).unwrap()
}

/// Where the views from `+Z` and `-Z` are among the 26.
const FRONT: usize = 2;
const BACK: usize = 3;

/// Side of a pixel, model units.
fn pixel(view: &View) -> f64 {
    view.height / f64::from(SIDE)
}

/// How much of a length squared in the plane a view shows, and the normal's slant to it.
fn slant(view: &View) -> f64 {
    let ahead = DVec3::from(view.camera.target) - DVec3::from(view.camera.eye);
    ahead.normalize().z.abs()
}

/// Pixels of an area of the plane and of its outline in a view. By Jarník's inequality the
/// pixels whose middle is inside differ from the first by less than the second.
fn pixels(view: &View, area: f64, outline: f64) -> (f64, f64) {
    (area * slant(view) / pixel(view).powi(2), outline / pixel(view))
}

/// The views that do not see the plane edge on, with what was found in them.
fn across<'a>(views: &'a [View], seen: &'a Seen) -> Vec<(&'a View, &'a ViewMeasures)> {
    views.iter().zip(&seen.views).filter(|(view, _)| slant(view) > 0.1).collect()
}

#[test]
fn what_is_equal_has_no_hole_and_no_difference() {
    let mesh = plane(0.0);
    let seen = look(squares(0.0), Model::Mesh(&mesh));
    assert_eq!((seen.holes.missing, seen.holes.extra, seen.holes.through, seen.holes.views), (0, 0, 0, 0));
    assert_eq!((seen.image.flip_mean, seen.image.flip_p99, seen.image.normal_flip_mean), (0.0, 0.0, 0.0));
    assert_eq!((seen.image.psnr, seen.views.len()), (99.0, 26));
    assert!((seen.image.ssim - 1.0).abs() < 1e-12, "{}", seen.image.ssim);
    let front = &seen.views[FRONT];
    // The plane fills 95 % of the picture; its silhouette's band is two pixels wide.
    let band = 4.0 * 2.0 * 0.95 * f64::from(SIDE);
    let compared = f64::from(SIDE * SIDE) - band;
    assert!(front.name == "front" && (front.pixels as f64 - compared).abs() < 16.0, "{front:?}");
}

#[test]
fn a_missing_splat_is_as_many_pixels_as_its_area() {
    let mesh = plane(0.0);
    let model = Model::Mesh(&mesh);
    let mut splats = squares(0.0);
    splats.remove(5);
    let (views, seen) = (views(model), look(splats, model));
    let side = 1.0 / f64::from(ACROSS);
    for (view, found) in across(&views, &seen) {
        let (area, outline) = pixels(view, side * side, 4.0 * side);
        assert!((found.missing as f64 - area).abs() < outline && area > 4.0 * outline, "{found:?}: {area}");
        assert_eq!((found.extra, found.through), (0, 0), "{}", found.name);
    }
    assert_eq!(seen.holes.views, across(&views, &seen).len() as u64);
    assert_eq!(seen.holes.missing, seen.views.iter().map(|view| view.missing).sum::<u64>());
    assert!(
        seen.image.flip_mean > 0.01 && seen.image.psnr < 40.0 && seen.image.ssim < 1.0,
        "{:?}",
        seen.image
    );
}

#[test]
fn what_sticks_out_is_extra_but_for_the_band() {
    let mesh = plane(0.0);
    let model = Model::Mesh(&mesh);
    let radius = 0.02;
    let mut splats = squares(0.0);
    splats.push(disc(DVec3::new(0.5, 0.1, 0.0), radius));
    let (views, seen) = (views(model), look(splats, model));
    for (view, found) in across(&views, &seen) {
        // Half the disc is outside, and a pixel's width along the side is not compared.
        let (area, outline) = pixels(view, 0.5 * PI * radius * radius, (PI + 4.0) * radius);
        assert!((found.extra as f64 - area).abs() < outline && found.extra > 0, "{found:?}: {area}");
        assert_eq!((found.missing, found.through), (0, 0), "{}", found.name);
    }
    assert_eq!(seen.holes.views, across(&views, &seen).len() as u64);
}

#[test]
fn a_hole_before_another_sheet_is_seen_through() {
    let (mut mesh, back) = (plane(0.1), plane(-0.1));
    mesh.vertices.positions.extend(back.vertices.positions);
    mesh.triangles.extend([[4, 5, 6], [4, 6, 7]]);
    let model = Model::Mesh(&mesh);
    let mut front = squares(0.1);
    front.remove(5);
    let seen = look([front, squares(-0.1)].concat(), model);
    let views = views(model);
    let side = 1.0 / f64::from(ACROSS);
    let (area, outline) = pixels(&views[FRONT], side * side, 4.0 * side);
    assert_eq!((views[FRONT].name.as_str(), seen.views[FRONT].missing, seen.holes.extra), ("front", 0, 0));
    assert!((seen.views[FRONT].through as f64 - area).abs() < outline, "{:?}: {area}", seen.views[FRONT]);
    assert_eq!((views[BACK].name.as_str(), seen.views[BACK].through), ("back", 0));
}

#[test]
fn what_is_unknown_of_a_cloud_is_no_fault_and_its_holes_are() {
    let count = 40_u16;
    let place = |n: u16| f32::from(n) / f32::from(count - 1) - 0.5;
    let positions = (0..count * count).map(|n| Vec3::new(place(n % count), place(n / count), 0.0));
    let normals = vec![Vec3::Z; usize::from(count * count)];
    let cloud = Cloud { positions: positions.collect(), normals, ..Cloud::default() };
    let discs = discs(&cloud);
    let model = Model::Surface(&cloud, &discs);
    let whole = look(squares(0.0), model);
    assert_eq!((whole.holes.missing, whole.holes.extra, whole.holes.through), (0, 0, 0));
    let mut splats = squares(0.0);
    splats.remove(5);
    let seen = look(splats, model);
    let views = views(model);
    let side = 1.0 / f64::from(ACROSS);
    let (area, outline) = pixels(&views[FRONT], side * side, 4.0 * side);
    let found = &seen.views[FRONT];
    assert!((found.missing as f64 - area).abs() < outline && area > 4.0 * outline, "{found:?}: {area}");
}

#[test]
fn any_number_of_threads_sees_the_same() {
    let mesh = plane(0.0);
    let mut splats = squares(0.0);
    splats.truncate(9);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| look(splats.clone(), Model::Mesh(&mesh)))
    };
    assert_eq!(on(1), on(3));
}
