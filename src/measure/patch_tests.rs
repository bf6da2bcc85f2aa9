//! Nearest places and areas of patches against dense sampling.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use super::patch::Patch;
use crate::model::clip_curve::ClipCurve;
use crate::model::splat::Splat;

/// A sequence of numbers in `[0, 1)` that looks random (SplitMix64).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.roll()
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.roll() * from.len() as f64) as usize]
    }
}

fn any_splat(dice: &mut Dice) -> Splat {
    let radii = dice.pick(&[DVec2::ONE, DVec2::new(1.0, 1e-3), DVec2::new(0.02, 1.0), DVec2::new(0.7, 0.5)]);
    let bend = dice.pick(&[0.05, 0.3, 1.0, 3.0]) / radii.max_element();
    let [a, b] = [dice.within(-bend, bend), dice.within(-bend, bend)];
    let curvature = dice.pick(&[
        DVec2::new(a, b),
        DVec2::new(a, a),
        DVec2::new(a, 0.0),
        DVec2::new(0.0, b),
        DVec2::ZERO,
        DVec2::new(a, -a),
        DVec2::new(a, b * (radii.x / radii.y).powi(2)),
    ]);
    let clip = |dice: &mut Dice| {
        let rho = dice.pick(&[0.0, 1.0, 0.5, 0.999, 0.02, dice.0 as f64 / u64::MAX as f64]);
        let p2 = radii * DVec2::new(dice.within(-1.5, 1.5), dice.within(-1.5, 1.5));
        ClipCurve { alpha1: dice.within(0.0, TAU), alpha3: dice.within(0.0, TAU), p2, rho }
    };
    let clips = (0..dice.pick(&[0, 0, 1, 1, 2, 3])).map(|_| clip(dice)).collect();
    let axes = DMat3::from_rotation_x(dice.within(0.0, 6.0)) * DMat3::from_rotation_z(dice.within(0.0, 6.0));
    let center = DVec3::new(dice.within(-1.0, 1.0), 0.3, -0.2);
    Splat { center, axes, radii, curvature, clips, partners: Vec::new(), color: [255; 3] }
}

/// Points near the surface, far from it, over its axes, and at its centres of curvature.
fn any_point(dice: &mut Dice, splat: &Splat) -> DVec3 {
    let uv = splat.radii * DVec2::new(dice.within(-1.5, 1.5), dice.within(-1.5, 1.5));
    let size = splat.radii.max_element();
    let focal = |c: f64| if c == 0.0 { 1.0 } else { 0.5 / c };
    let local = match (dice.roll() * 8.0) as usize {
        0 => uv.extend(splat.height(uv)),
        1 => uv.extend(splat.height(uv) + 0.01 * size * dice.within(-1.0, 1.0)),
        2 => uv.extend(size * dice.within(-3.0, 3.0)),
        3 => 50.0 * uv.extend(size * dice.within(-3.0, 3.0)),
        4 => DVec3::new(0.0, uv.y, focal(splat.curvature.x) * dice.within(0.5, 3.0)),
        5 => DVec3::new(uv.x, 0.0, focal(splat.curvature.y) * dice.within(0.5, 3.0)),
        6 => DVec3::Z * focal(dice.pick(&[splat.curvature.x, splat.curvature.y])),
        _ => DVec3::new(1e-9 * uv.x, 1e-9 * uv.y, focal(splat.curvature.x) * dice.within(0.9, 1.5)),
    };
    splat.to_model(local)
}

/// Places of the clipped domain: a grid, the rim, the clip curves.
fn dense(splat: &Splat) -> Vec<DVec2> {
    let side = 120;
    let unit = |n: i32| (f64::from(n) + 0.5) / f64::from(side) * 2.0 - 1.0;
    let mut places: Vec<DVec2> =
        (0..side * side).map(|n| splat.radii * DVec2::new(unit(n % side), unit(n / side))).collect();
    for n in 0..4000 {
        let (sin, cos) = libm::sincos(TAU * f64::from(n) / 4000.0);
        places.push(splat.radii * DVec2::new(cos, sin) * (1.0 - 1e-12));
    }
    let mut on_clips = Vec::new();
    for (n, clip) in splat.clips.iter().enumerate() {
        let conic = clip.conic(splat.radii);
        let others = |uv: DVec2| {
            !splat.clips.iter().enumerate().any(|(m, other)| m != n && other.cuts(uv, splat.radii))
        };
        on_clips.extend(conic.points(2000).filter(|&uv| splat.ellipse(uv) <= 1.0 && others(uv)));
    }
    // Rounding may have the curves' own points on either side.
    let covered = places.into_iter().filter(|&uv| splat.covers(uv));
    covered.chain(on_clips.into_iter().filter(|&uv| near_domain(splat, uv, 1e-9))).collect()
}

/// Whether some place within a share of the radii is covered; corners of domains may be sharp.
fn near_domain(splat: &Splat, uv: DVec2, share: f64) -> bool {
    splat.covers(uv) || around(splat, uv, share, 4000).any(|near| splat.covers(near))
}

/// Places around one at a share of the radii.
fn around(splat: &Splat, uv: DVec2, share: f64, count: u32) -> impl Iterator<Item = DVec2> {
    (0..count).map(move |n| {
        let (sin, cos) = libm::sincos(TAU * f64::from(n) / f64::from(count));
        uv + share * splat.radii * DVec2::new(cos, sin)
    })
}

#[test]
fn no_sample_is_nearer_than_the_nearest_place() {
    let mut dice = Dice(7);
    let (mut worst, mut least, mut empty) = (0.0_f64, 0.0_f64, 0);
    for _ in 0..300 {
        let splat = any_splat(&mut dice);
        let patch = Patch::new(&splat);
        let places = dense(&splat);
        if patch.border.is_empty() {
            // Not even slivers wider than the rounding allowed for.
            let wide = |uv: DVec2| around(&splat, uv, 1e-8, 16).all(|near| splat.covers(near));
            let left = places.iter().filter(|&&uv| wide(uv)).count();
            assert!(left == 0, "{left} places left of {splat:?}");
            empty += 1;
            continue;
        }
        // A sliver that the samples miss, or no wider than the slack below, proves nothing.
        if places.is_empty() || patch.area < 1e-6 * splat.radii.x * splat.radii.y {
            continue;
        }
        let samples: Vec<DVec3> = places.iter().map(|&uv| splat.surface_point(uv)).collect();
        for _ in 0..20 {
            let point = any_point(&mut dice, &splat);
            let foot = patch.nearest(point, f64::INFINITY).unwrap();
            let brute = samples.iter().map(|x| x.distance(point)).fold(f64::INFINITY, f64::min);
            let distance = splat.surface_point(foot.uv).distance(point);
            assert!((distance - foot.distance).abs() <= 1e-12 * (1.0 + distance));
            assert!(near_domain(&splat, foot.uv, 1e-6), "{foot:?} lies outside {splat:?}");
            let over = (foot.distance - brute) / (brute + 1e-6 * splat.radii.max_element());
            assert!(over < 1e-6, "{over:e}: {foot:?}, sampled {brute} from {point} to {splat:?}");
            worst = worst.max(over);
            least = least.min(over);
            let none = patch.nearest(point, foot.distance * (1.0 - 1e-9));
            assert!(none.is_none() || foot.distance == 0.0);
            assert!(patch.nearest(point, foot.distance * (1.0 + 1e-9) + 1e-15).is_some());
        }
    }
    eprintln!("farther than the nearest sample by {worst:e} at most, nearer by {:e}; {empty} empty", -least);
    assert!(empty < 100);
}

#[test]
fn areas_are_those_of_a_fine_grid() {
    let mut dice = Dice(3);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let splat = any_splat(&mut dice);
        let side = 500;
        let unit = |n: i32| (f64::from(n) + 0.5) / f64::from(side) * 2.0 - 1.0;
        let cell = 4.0 * splat.radii.x * splat.radii.y / f64::from(side * side);
        let grid = (0..side * side).map(|n| splat.radii * DVec2::new(unit(n % side), unit(n / side)));
        let (mut sum, mut whole) = (0.0, 0.0);
        for uv in grid.filter(|&uv| splat.ellipse(uv) <= 1.0) {
            let stretch = (1.0 + (2.0 * splat.curvature * uv).length_squared()).sqrt();
            whole += stretch * cell;
            sum += if splat.covers(uv) { stretch * cell } else { 0.0 };
        }
        let error = (Patch::new(&splat).area - sum).abs() / whole;
        worst = worst.max(error);
        assert!(error < 4e-3, "{error}: {} for {sum} of {splat:?}", Patch::new(&splat).area);
    }
    eprintln!("areas differ from a grid's by {worst:e} of the whole splat at most");
}
