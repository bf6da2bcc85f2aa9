//! Planted gaps between lines and borders come back.
#![allow(clippy::unwrap_used)]

use glam::DVec2;

use super::super::planted::{asset, flat};
use super::*;
use crate::model::clip_curve::ClipCurve;
use crate::model::splat::Splat;

/// A disc around the origin, cut along `y = at`: what lies below is gone.
fn cut(at: f64) -> Splat {
    let angle = at.asin();
    flat(DVec3::ZERO, DVec2::ONE, vec![ClipCurve::chord(std::f64::consts::PI - angle, angle)])
}

/// The same, and what lies above `y = high` is gone too.
fn strip(low: f64, high: f64) -> Splat {
    let angle = high.asin();
    let mut splat = cut(low);
    splat.clips.push(ClipCurve::chord(angle, std::f64::consts::PI - angle));
    splat
}

fn line(y: f64, half: f64) -> Vec<DVec3> {
    vec![DVec3::new(-half, y, 0.0), DVec3::new(0.1, y, 0.0), DVec3::new(half, y, 0.0)]
}

#[test]
fn a_shifted_border_is_off_by_its_shift() {
    for shift in [0.0_f64, 0.0015] {
        let half = (1.0 - shift * shift).sqrt();
        let found = edge(&asset(vec![cut(shift)]), &[line(0.0, half)]).unwrap();
        assert!((found.rms - shift).abs() < 1e-12 && (found.max - shift).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn an_edge_without_a_cut_and_a_cut_without_an_edge_are_seen() {
    let both = [line(0.0, 1.0), line(0.7, 0.5)];
    let found = edge(&asset(vec![cut(0.0)]), &both).unwrap();
    assert!((found.max - 0.7).abs() < 1e-9, "{found:?}");
    // The longer side has 2 + 1, the borders 2.
    assert!((found.rms - (0.49_f64 / 5.0).sqrt()).abs() < 1e-4, "{found:?}");
    let found = edge(&asset(vec![strip(0.0, 0.6)]), &both[..1]).unwrap();
    assert!((found.max - 0.6).abs() < 1e-9, "{found:?}");
}

#[test]
fn splats_that_touch_no_line_do_not_count() {
    let found = edge(&asset(vec![cut(0.0), cut(-0.6)]), &[line(0.0, 1.0)]).unwrap();
    assert!(found.max < 1e-9, "{found:?}");
}

#[test]
fn without_borders_edges_are_a_diagonal_off_and_without_lines_there_is_nothing() {
    let whole = asset(vec![flat(DVec3::ZERO, DVec2::ONE, vec![])]);
    let found = edge(&whole, &[line(0.0, 1.0)]).unwrap();
    assert!((found.rms - whole.diagonal).abs() < 1e-12);
    assert_eq!(edge(&asset(vec![cut(0.0)]), &[]), None);
    assert_eq!(edge(&asset(vec![cut(0.0)]), &[vec![DVec3::ONE, DVec3::ONE], vec![DVec3::X]]), None);
}

#[test]
fn only_what_is_left_of_a_border_counts() {
    // The second curve cuts the right half away, and with it that half of the first.
    let half = std::f64::consts::FRAC_PI_2;
    let mut splat = cut(0.0);
    splat.clips.push(ClipCurve::chord(3.0 * half, half));
    let lines = [vec![DVec3::NEG_X, DVec3::ZERO, DVec3::Y]];
    let found = edge(&asset(vec![splat]), &lines).unwrap();
    assert!(found.max < 1e-9, "{found:?}");
}

#[test]
fn a_border_inside_another_splat_bounds_nothing() {
    let over = flat(DVec3::new(0.0, 0.6, 0.0), DVec2::new(2.0, 0.3), vec![]);
    let lifted = Splat { center: over.center + 0.2 * DVec3::Z, ..over.clone() };
    let off = |splats| edge(&asset(splats), &[line(0.0, 1.0)]).unwrap().max;
    assert!((off(vec![strip(0.0, 0.6)]) - 0.6).abs() < 1e-9);
    assert!(off(vec![strip(0.0, 0.6), over]) < 1e-9);
    assert!((off(vec![strip(0.0, 0.6), lifted]) - 0.6).abs() < 1e-9, "another sheet");
    let [barely, beside] =
        [0.8995, 0.9005].map(|y| flat(DVec3::new(0.0, y, 0.0), DVec2::new(90.0, 0.3), vec![]));
    assert!(off(vec![strip(0.0, 0.6), barely]) < 1e-9, "far from every line");
    assert!((off(vec![strip(0.0, 0.6), beside]) - 0.6).abs() < 1e-9);
}

#[test]
fn beside_a_line_a_border_barely_inside_another_splat_counts() {
    let rms = |splats| edge(&asset(splats), &[line(0.0, 1.0)]).unwrap().rms;
    let over = |y: f64| flat(DVec3::new(0.0, y, 0.0), DVec2::new(90.0, 0.3), vec![]);
    let alone = rms(vec![cut(-5e-4)]);
    assert!((alone - 5e-4).abs() < 1e-6, "{alone}");
    assert!((rms(vec![cut(-5e-4), over(-0.2999)]) - alone).abs() < 1e-6, "by less than the margin");
}
