//! The WGSL twin against the same oracle, a million points by a graphics adapter.
//!
//! It works in 32 bits and over the unit disc, so a distance here is in the splat's radii. What it
//! is given is rounded to 32 bits before, so there are two questions:
//!
//! - *The test.* On the rounded numbers it must decide as exact arithmetic does, but within the
//!   allowance that the 64-bit test has, in 32-bit roundings.
//! - *The splat.* On places of the disc, the only ones that are ever asked about, it must decide as
//!   the curve before rounding does, but within [`BAND`]. Curves are left to the first question whose
//!   ends are nearer than [`NARROWEST`].
//!
//! Within the bands 32 bits cannot tell: half a rounding of the control points alone moves a curve
//! by as much as a rounding of the coordinates.

use glam::DVec2;
use qsplat::model::clip_curve::Conic;
use rayon::prelude::*;

use crate::device::{Device, Question};
use crate::{POINTS, POINTS_A_CONIC, allowance, cases, drawn, exact, flips};

/// Distance from a splat's curve, in its radii, within which 32 bits may decide otherwise: 9.5e-7.
///
/// Some roundings of a place and of control points about as far from the centre as the rim is. A
/// control point farther away, in a file up to 1024 larger radii, is rounded by more, but the curve
/// within the disc moves no more for it: it heeds `P2` by the share `rho` alone, or along the arms that
/// lead there. On a splat as large as a picture of 512 pixels, seen 100 times as large, this is a
/// fortieth of a pixel.
const BAND: f64 = 8.0 * f32::EPSILON as f64;

/// Distance between a curve's ends, in radii, from which rounding them changes no more than [`BAND`].
///
/// Rounded by half an epsilon each, ends `h` apart turn their chord by `epsilon / h` at most, and a
/// line that only touches the disc, turned so about where it does, cuts a segment of the height
/// `(epsilon / h)² / 2` from it. A curve with nearer ends cuts or leaves no more than a sliver, of the
/// height `h² / 8`, 1e-9 radii, on one side of a chord that 32 bits can turn anywhere.
const NARROWEST: f64 = 9e-5;

const _: () = assert!(NARROWEST * NARROWEST * 2.0 * BAND >= f32::EPSILON as f64 * f32::EPSILON as f64);

/// A curve as a splat has it, and as the shader is given it, both over the unit disc.
struct Curve {
    own: Conic,
    rounded: Conic,
    places: Vec<DVec2>,
}

fn rounded(p: DVec2) -> DVec2 {
    p.as_vec2().as_dvec2()
}

fn curve(index: u64) -> Curve {
    let (own, places) = drawn(index, |random| {
        let (clip, radii) = cases::clip(index, f64::from(f32::EPSILON), random);
        let Conic { p1, p2, p3, rho } = clip.conic(radii);
        Conic { p1: p1 / radii, p2: p2 / radii, p3: p3 / radii, rho }
    });
    let [p1, p2, p3] = [own.p1, own.p2, own.p3].map(rounded);
    let rounded_conic = Conic { p1, p2, p3, rho: f64::from(own.rho as f32) };
    Curve { own, rounded: rounded_conic, places: places.into_iter().map(rounded).collect() }
}

/// A place where the shader decides otherwise.
struct Miss<'a> {
    curve: &'a Curve,
    place: DVec2,
    /// Distance from where it would be right, in what is allowed.
    share: f64,
}

/// The farthest miss must be allowed; all of them are counted.
fn judge(what: &str, asked: usize, misses: &[Miss]) {
    eprintln!("{what}: {asked} points, {} decided otherwise by rounding", misses.len());
    let Some(worst) = misses.iter().max_by(|a, b| a.share.total_cmp(&b.share)) else { return };
    let Miss { curve: Curve { own, .. }, place, share } = worst;
    eprintln!("the farthest is {share:.3} of what is allowed from the curve: {own:?}, {place:?}");
    let far = misses.iter().filter(|miss| miss.share > 1.0 || miss.share.is_nan()).count();
    assert_eq!(far, 0, "{what}: rounding does not explain {far} of {} disagreements", misses.len());
}

/// Pairs of curve and place with the shader's answer.
fn answered<'a>(device: &Device, curves: &'a [Curve]) -> Vec<(&'a Curve, DVec2, bool)> {
    let conics: Vec<Conic> = curves.iter().map(|curve| curve.rounded).collect();
    let pairs = || curves.iter().enumerate().flat_map(|(n, c)| c.places.iter().map(move |&q| (n, c, q)));
    let questions: Vec<Question> = pairs().map(|(n, _, q)| Question::new(q, n)).collect();
    let answers = device.cuts(&conics, &questions);
    pairs().zip(answers).map(|((_, curve, place), said)| (curve, place, said)).collect()
}

#[test]
fn the_shader_decides_a_million_points_as_exact_arithmetic_decides() {
    let Some(device) = Device::open() else { return };
    eprintln!("clip.wgsl on {}", device.name);
    let curves: Vec<Curve> = (0..POINTS / POINTS_A_CONIC).into_par_iter().map(curve).collect();
    let answers = answered(&device, &curves);

    // What is looked for is a step of 32 bits, for which the 64-bit test, held against exact
    // arithmetic beside this, is fine enough.
    let misses: Vec<Miss> = answers
        .par_iter()
        .filter(|(curve, place, said)| *said != exact::cuts(&curve.rounded, *place))
        .map(|&(curve, place, said)| {
            let (conic, allowed) = (&curve.rounded, allowance(&curve.rounded, place, f32::EPSILON.into()));
            Miss { curve, place, share: flips::within(conic, place, allowed, |q| conic.cuts(q) == said) }
        })
        .collect();
    judge("the test", answers.len(), &misses);

    let mut of_discs = answers;
    of_discs.retain(|(_, place, _)| place.length() <= 1.0);
    let inside = of_discs.len();
    of_discs.retain(|(curve, ..)| curve.own.p1.distance(curve.own.p3) >= NARROWEST);
    eprintln!("the splat: LEFT OUT: {} places by curves with nearly one end", inside - of_discs.len());
    let misses: Vec<Miss> = of_discs
        .par_iter()
        .filter(|(curve, place, said)| *said != exact::cuts(&curve.own, *place))
        .map(|&(curve, place, said)| {
            let share = flips::within(&curve.own, place, BAND, |q| curve.own.cuts(q) == said);
            Miss { curve, place, share }
        })
        .collect();
    judge("the splat", of_discs.len(), &misses);
    let worst = misses.iter().map(|miss| miss.share * BAND).fold(0.0, f64::max);
    eprintln!("the splat: off by {worst:.1e} radii at most");
}
