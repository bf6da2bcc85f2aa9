//! Splats for tests: planted on surfaces whose normal and curvature are known, or adversarial.

use glam::{DMat3, DVec2, DVec3};

use crate::model::asset::{Accuracy, Asset};
use crate::model::clip_curve::ClipCurve;
use crate::model::frame::Frame;
use crate::model::splat::Splat;

/// A small generator with a fixed sequence (Steele et al. 2014, SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0));
            if v.length() > 0.1 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }
}

/// A right-handed frame with the given normal and a random turn.
pub fn frame(k: DVec3, random: &mut Random) -> DMat3 {
    let i = k.cross(random.direction()).normalize();
    DMat3::from_cols(i, k.cross(i), k)
}

/// Level function of a bumpy sphere and its first and second derivatives.
fn bumpy(p: DVec3) -> (f64, DVec3, DMat3) {
    let (f, s) = (DVec3::new(5.0, 4.0, 6.0), 0.03);
    let (q, h) = (p * f, DVec3::new(0.3, 1.1, 2.0));
    let sin = (q + h).to_array().map(libm::sin);
    let cos = (q + h).to_array().map(libm::cos);
    let (sin, cos) = (DVec3::from_array(sin), DVec3::from_array(cos));
    let value = p.length_squared() - 0.5 + s * sin.element_sum();
    let gradient = 2.0 * p + s * f * cos;
    let second = DMat3::from_diagonal(DVec3::splat(2.0) - s * f * f * sin);
    (value, gradient, second)
}

/// A splat of the bumpy sphere in a direction; radii in error budgets of `e`.
pub fn on_bumpy(direction: DVec3, e: f64, radius: f64) -> Splat {
    let mut p = direction * 0.7;
    for _ in 0..20 {
        let (value, gradient, _) = bumpy(p);
        p -= direction * (value / gradient.dot(direction));
    }
    let (_, gradient, second) = bumpy(p);
    let k = gradient.normalize();
    // w = -(t' H t) / (2 |g|) to second order along a tangent t.
    let i0 = k.any_orthonormal_vector();
    let j0 = k.cross(i0);
    let form = |s: DVec3, t: DVec3| -s.dot(second * t) / (2.0 * gradient.length());
    let theta = 0.5 * libm::atan2(2.0 * form(i0, j0), form(i0, i0) - form(j0, j0));
    let (sin, cos) = libm::sincos(theta);
    let (i, j) = (i0 * cos + j0 * sin, j0 * cos - i0 * sin);
    let curvature = DVec2::new(form(i, i), form(j, j));
    let bent = (curvature.abs() + 0.3).recip();
    let shape = (bent / (bent.x * bent.y).sqrt()).powf(0.5);
    Splat {
        center: p,
        axes: DMat3::from_cols(i, j, k),
        radii: shape * radius * e,
        curvature,
        clips: Vec::new(),
        partners: Vec::new(),
        color: [255; 3],
    }
}

/// `count` splats spread over the bumpy sphere, with a little noise.
pub fn bumpy_asset(count: usize, radius: f64, seed: u64) -> Asset {
    let mut random = Random(seed);
    // The disc of `radius` budgets, overlapping twice, covers the sphere's area of about 6.
    let e = (2.0 * 6.0 / (count as f64 * std::f64::consts::PI)).sqrt() / radius;
    let splats = (0..count)
        .map(|n| {
            let z = 1.0 - (2.0 * n as f64 + 1.0) / count as f64;
            let angle = 2.399_963_229_728_653 * n as f64;
            let flat = (1.0 - z * z).sqrt();
            let at = DVec3::new(flat * libm::cos(angle), flat * libm::sin(angle), z);
            let shaken = (at + random.direction() * 0.3 / (count as f64).sqrt()).normalize();
            let mut splat = on_bumpy(shaken, e, radius * random.within(0.6, 1.5));
            splat.center += splat.axes.z_axis * random.within(-0.4, 0.4) * e;
            splat
        })
        .collect();
    asset(splats, e)
}

/// Wraps splats.
pub fn asset(splats: Vec<Splat>, e: f64) -> Asset {
    Asset {
        frame: Frame { origin: DVec3::new(1.5, -2.5, 1e6), exponent: 3 },
        diagonal: 2.5,
        max_error: e,
        fit: Accuracy { rms: 0.2 * e, p99: 0.6 * e, max: 0.9 * e },
        has_colors: false,
        splats,
    }
}

/// A clip curve that crosses the splat from border to border.
pub fn curve(radii: DVec2, random: &mut Random) -> ClipCurve {
    let alpha1 = random.within(0.0, std::f64::consts::TAU);
    let alpha3 = (alpha1 + random.within(0.5, 5.5)).rem_euclid(std::f64::consts::TAU);
    if random.unit() < 0.3 {
        return ClipCurve::chord(alpha1, alpha3);
    }
    let p2 = DVec2::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0)) * radii;
    ClipCurve { alpha1, alpha3, p2, rho: random.within(0.1, 1.0) }
}

#[test]
fn the_planted_splats_lie_on_the_surface() {
    let mut random = Random(1);
    for _ in 0..100 {
        let splat = on_bumpy(random.direction(), 1e-3, 40.0);
        let near = splat.surface_point(splat.radii * 0.1);
        let (value, gradient, _) = bumpy(near);
        assert!((value / gradient.length()).abs() < 3e-7, "{value}");
    }
}
