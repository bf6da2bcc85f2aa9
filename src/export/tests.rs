//! Planted discs, lenses and bowls, tessellated and measured again.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec2, DVec3};
use proptest::prelude::*;

use super::ply;
use super::tessellate::{Patch, tessellate};
use crate::model::asset::{Accuracy, Asset};
use crate::model::clip_curve::{ClipCurve, turn};
use crate::model::frame::Frame;
use crate::model::splat::Splat;
use crate::tolerance::EXPORT_SHARE;

fn splat(radii: DVec2, curvature: DVec2, clips: Vec<ClipCurve>) -> Splat {
    let axes = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(1.1);
    Splat {
        center: DVec3::new(0.1, -0.2, 0.3),
        axes,
        radii,
        curvature,
        clips,
        partners: Vec::new(),
        color: [9, 8, 7],
    }
}

/// Area in the `(u, v)` plane; panics on a triangle that is turned over.
fn area(patch: &Patch) -> f64 {
    let each = patch.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| patch.points[v as usize]);
        let doubled = turn(a, b, c);
        // Three points of the outline may lie on a line but for their rounding.
        assert!(doubled >= -1e-15, "a triangle is turned over: {doubled}");
        0.5 * doubled
    });
    each.sum()
}

/// Greatest distance along `k` between the quadric and the triangles, sampled.
fn greatest_gap(splat: &Splat, patch: &Patch) -> f64 {
    let mut worst = 0.0_f64;
    for triangle in &patch.triangles {
        let [a, b, c] = triangle.map(|v| patch.points[v as usize]);
        for (i, j) in (0..=6).flat_map(|i| (0..=6 - i).map(move |j| (i, j))) {
            let (s, t) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
            let at = |f: &dyn Fn(DVec2) -> f64| f(a) * (1.0 - s - t) + f(b) * s + f(c) * t;
            let uv = a * (1.0 - s - t) + b * s + c * t;
            worst = worst.max((at(&|p| splat.height(p)) - splat.height(uv)).abs());
        }
    }
    worst
}

#[test]
fn a_whole_ellipse_has_its_area() {
    let patch = tessellate(&splat(DVec2::new(2.0, 0.5), DVec2::ZERO, vec![]), 1e-4).unwrap();
    let expected = PI * 2.0 * 0.5;
    let short = expected - area(&patch);
    // The border has a length below 9, and chords lie inside by at most the tolerance.
    assert!(short > 0.0 && short < 9.0 * 1e-4, "{short}");
}

#[test]
fn a_chord_through_the_centre_leaves_half() {
    for radii in [DVec2::ONE, DVec2::new(3.0, 0.003)] {
        let patch =
            tessellate(&splat(radii, DVec2::ZERO, vec![ClipCurve::chord(0.3, 0.3 + PI)]), 1e-6).unwrap();
        let expected = FRAC_PI_2 * radii.x * radii.y;
        assert!((area(&patch) / expected - 1.0).abs() < 4e-3, "{} of {expected}", area(&patch));
    }
}

#[test]
fn a_lens_between_two_circles_has_its_area() {
    // The unit disc, cut by the quarter circle around (1, 1) from (0, 1)... to (1, 0): the
    // conic with w = cos 45° and P2 = (0, 0) bulges into the disc.
    let w = std::f64::consts::FRAC_1_SQRT_2;
    let clip = ClipCurve { alpha1: 0.0, alpha3: FRAC_PI_2, p2: DVec2::ZERO, rho: w / (1.0 + w) };
    let cut_disc = splat(DVec2::ONE, DVec2::ZERO, vec![clip]);
    // Cut away is the lens of two unit circles at distance sqrt 2: pi/2 - 1.
    let expected = PI - (FRAC_PI_2 - 1.0);
    let found = area(&tessellate(&cut_disc, 1e-6).unwrap());
    assert!((found - expected).abs() < 1e-5, "{found} for {expected}");
    // The other way round the lens is what is left.
    let other = ClipCurve { alpha1: FRAC_PI_2, alpha3: 0.0, ..clip };
    let lens = splat(DVec2::ONE, DVec2::ZERO, vec![other]);
    let found = area(&tessellate(&lens, 1e-6).unwrap());
    assert!((found - (FRAC_PI_2 - 1.0)).abs() < 1e-5, "{found}");
}

#[test]
fn a_corner_is_exact() {
    // rho = 1 from (1,0) over the centre to (0,1): a quarter is gone.
    let corner = ClipCurve { alpha1: 0.0, alpha3: FRAC_PI_2, p2: DVec2::ZERO, rho: 1.0 };
    let found = area(&tessellate(&splat(DVec2::ONE, DVec2::ZERO, vec![corner]), 1e-7).unwrap());
    assert!((found - 0.75 * PI).abs() < 1e-6, "{found}");
}

#[test]
fn triangles_stay_near_the_quadric() {
    for curvature in
        [DVec2::new(0.7, 0.4), DVec2::new(-0.7, 0.7), DVec2::new(0.0, 1.0), DVec2::new(-1.0, 1e-9)]
    {
        for distance in [1e-2, 1e-4] {
            let bowl = splat(DVec2::new(0.9, 0.5), curvature, vec![ClipCurve::chord(0.5, 2.5)]);
            let patch = tessellate(&bowl, distance).unwrap();
            let gap = greatest_gap(&bowl, &patch);
            assert!(gap <= distance, "{curvature} {distance}: {gap}");
            // Not needlessly fine either: halving every edge would give an eighth of it.
            assert!(
                gap > 0.1 * distance,
                "{curvature} {distance}: {gap}, {} triangles",
                patch.triangles.len()
            );
        }
    }
}

#[test]
fn what_cuts_everything_leaves_nothing() {
    let both = vec![ClipCurve::chord(0.0, PI), ClipCurve::chord(PI, 0.0)];
    let patch = tessellate(&splat(DVec2::ONE, DVec2::ONE, both), 1e-3).unwrap();
    assert!(area(&patch) < 1e-9);
}

#[test]
fn nonsense_is_refused() {
    assert!(tessellate(&splat(DVec2::ONE, DVec2::ZERO, vec![]), 0.0).is_err());
    assert!(tessellate(&splat(DVec2::ONE, DVec2::ZERO, vec![]), f64::NAN).is_err());
    let steep = splat(DVec2::ONE, DVec2::new(1.0, 1.0), vec![]);
    let message = tessellate(&steep, 1e-12).unwrap_err().to_string();
    assert!(message.contains("--max-error"), "{message}");
}

#[test]
fn the_ply_says_what_was_tessellated() {
    let frame = Frame { origin: DVec3::new(1e7, -2e6, 30.0), exponent: 3 };
    let splats = vec![
        splat(DVec2::new(0.5, 0.3), DVec2::ZERO, vec![]),
        splat(DVec2::new(0.4, 0.2), DVec2::new(0.5, -0.2), vec![ClipCurve::chord(0.0, 2.0)]),
    ];
    let accuracy = Accuracy::default();
    let asset = Asset { frame, diagonal: 1.0, max_error: 1e-3, fit: accuracy, has_colors: true, splats };
    let share = 0.02;
    let patches = ply::patches(&asset, share).unwrap();
    let mut bytes = Vec::new();
    ply::write(&asset, share, &patches, &mut bytes).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(header.contains("within 0.02 of the error budget 8e-3 "), "{header}");
    let (vertices, faces): (usize, usize) =
        patches.iter().fold((0, 0), |(v, f), p| (v + p.points.len(), f + p.triangles.len()));
    assert!(header.contains(&format!("element vertex {vertices}\n")), "{header}");
    assert!(header.contains(&format!("element face {faces}\n")), "{header}");
    let (vertex_bytes, face_bytes) = (3 * 8 + 3 * 4 + 3, 1 + 3 * 4 + 4);
    assert_eq!(bytes.len(), end + vertices * vertex_bytes + faces * face_bytes);
    // The first vertex, in the input's coordinates.
    let x = f64::from_le_bytes(bytes[end..end + 8].try_into().unwrap());
    let expected = frame.to_input(asset.splats[0].surface_point(patches[0].points[0]));
    assert_eq!(x.to_bits(), expected.x.to_bits());
    // The last face belongs to the last splat.
    let last = bytes.len() - 4;
    assert_eq!(bytes[last..], 1_u32.to_le_bytes());
}

#[test]
fn the_share_of_the_budget_is_kept_and_has_a_range() {
    let bowl = splat(DVec2::new(0.9, 0.5), DVec2::new(0.7, 0.4), vec![ClipCurve::chord(0.5, 2.5)]);
    let (frame, fit) = (Frame::default(), Accuracy::default());
    let asset = Asset { frame, diagonal: 1.0, max_error: 1e-2, fit, has_colors: false, splats: vec![bowl] };
    for share in [1.0, EXPORT_SHARE, 0.01, 1e-3] {
        let patches = ply::patches(&asset, share).unwrap();
        let gap = greatest_gap(&asset.splats[0], &patches[0]) / asset.max_error;
        assert!(gap <= share && gap > 0.1 * share, "{share}: {gap}");
    }
    for share in [0.0, 9e-4, 1.001, -0.1, f64::NAN, f64::INFINITY] {
        let message = ply::patches(&asset, share).unwrap_err().to_string();
        assert!(message.contains("from 0.001 to 1"), "{message}");
    }
}

fn any_clip() -> impl Strategy<Value = ClipCurve> {
    let shape = prop_oneof![Just(0.0), Just(1.0), 0.0..1.0, 0.99..1.0];
    ((0.0..TAU), (0.0..TAU), (-2.0..2.0), (-2.0..2.0), shape)
        .prop_map(|(alpha1, alpha3, x, y, rho)| ClipCurve { alpha1, alpha3, p2: DVec2::new(x, y), rho })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Any union of cuts: the triangles cover what `Splat::covers` says, by area and by height.
    #[test]
    fn any_cuts_keep_their_area(
        clips in prop::collection::vec(any_clip(), 0..4),
        (r_u, thin) in ((0.2..1.0), (0.05..1.0)),
        (a, b) in ((-0.5..0.5), (-0.5..0.5)),
    ) {
        let cut = splat(DVec2::new(r_u, r_u * thin), DVec2::new(a, b), clips);
        let patch = tessellate(&cut, 1e-4).unwrap();
        let side = 400;
        let covered = (0..side * side).filter(|n| {
            let unit = DVec2::new(f64::from(n % side) + 0.5, f64::from(n / side) + 0.5) / f64::from(side);
            cut.covers((2.0 * unit - 1.0) * cut.radii)
        });
        let box_area = 4.0 * cut.radii.x * cut.radii.y;
        let share = covered.count() as f64 / f64::from(side * side);
        // The grid's own error: border length times half a cell.
        prop_assert!((area(&patch) / box_area - share).abs() < 0.012, "{} against {share}", area(&patch) / box_area);
        prop_assert!(greatest_gap(&cut, &patch) <= 1e-4);
    }
}
