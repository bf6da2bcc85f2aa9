//! Small assets whose look is known: what the twins are compared on.

use glam::{DMat3, DVec2, DVec3};
use qsplat::model::asset::{Accuracy, Asset};
use qsplat::model::clip_curve::ClipCurve;
use qsplat::model::frame::Frame;
use qsplat::model::partner::{Cut, Partner};
use qsplat::model::splat::Splat;

/// An asset of these splats over the cube from -1 to 1.
pub fn asset(splats: Vec<Splat>, max_error: f64) -> Asset {
    Asset {
        frame: Frame::default(),
        diagonal: 2.0 * 3.0_f64.sqrt(),
        max_error,
        fit: Accuracy::default(),
        has_colors: false,
        splats,
    }
}

/// A frame with this normal.
pub fn axes(normal: DVec3) -> DMat3 {
    let k = normal.normalize();
    let (i, j) = k.any_orthonormal_pair();
    DMat3::from_cols(i, j, k)
}

/// A splat without clips.
pub fn splat(center: DVec3, axes: DMat3, radii: DVec2, curvature: DVec2) -> Splat {
    Splat { center, axes, radii, curvature, clips: Vec::new(), partners: Vec::new(), color: [255; 3] }
}

/// `count` even directions (a Fibonacci spiral).
pub fn directions(count: usize) -> impl Iterator<Item = DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |n| {
        let y = 1.0 - 2.0 * (n as f64 + 0.5) / count as f64;
        let (sin, cos) = libm::sincos(golden * n as f64);
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * cos, y, r * sin)
    })
}

/// A sphere of curved, coloured splats that overlap.
pub fn sphere(count: usize, radius: f64, curved: bool) -> Asset {
    let r = 2.0 * radius * (2.0 / count as f64).sqrt();
    let curvature = if curved { DVec2::splat(-0.5 / radius) } else { DVec2::ZERO };
    let splats = directions(count)
        .map(|d| Splat {
            color: d.to_array().map(|x| (127.5 + 127.5 * x) as u8),
            ..splat(radius * d, axes(d), DVec2::splat(r), curvature)
        })
        .collect();
    // A sagitta of the fourth order is what the osculating paraboloid misses.
    let error = if curved { r.powi(4) / (8.0 * radius.powi(3)) } else { r * r / (2.0 * radius) };
    Asset { has_colors: true, ..asset(splats, error) }
}

/// An open cylinder about `Y`: splats curved one way, three times as tall as wide.
pub fn cylinder(around: usize, radius: f64, height: f64) -> Asset {
    let step = std::f64::consts::TAU / around as f64;
    let splats = (0..around).flat_map(|n| (-1..=1).map(move |level| (n, level))).map(|(n, level)| {
        let (sin, cos) = libm::sincos(step * n as f64);
        let k = DVec3::new(sin, 0.0, cos);
        let axes = DMat3::from_cols(DVec3::Y.cross(k), DVec3::Y, k);
        let center = radius * k + DVec3::Y * (height / 3.0 * f64::from(level));
        let radii = DVec2::new(1.6 * radius * step, 0.35 * height);
        splat(center, axes, radii, DVec2::new(-0.5 / radius, 0.0))
    });
    asset(splats.collect(), 0.003)
}

/// Three faces of a cube around the corner `(1, 1, 1) * 0.6`, each one large splat cut by a
/// corner (`rho = 1`) so that the edges are sharp.
pub fn corner() -> Asset {
    let faces =
        [(DVec3::X, DVec3::Y, DVec3::Z), (DVec3::Y, DVec3::Z, DVec3::X), (DVec3::Z, DVec3::X, DVec3::Y)];
    let error = 0.002;
    let splats = faces.map(|(i, j, k)| {
        let radii = DVec2::new(1.1, 0.9);
        let center = 0.6 * k;
        // As a bake does: a little beyond the edge, so that no ray slips between two faces.
        let p2 = DVec2::splat(0.6 + 0.25 * error);
        // The legs run from the corner along -v and along -u to the ellipse's border.
        let down = DVec2::new(p2.x, -radii.y * (1.0 - (p2.x / radii.x).powi(2)).sqrt());
        let left = DVec2::new(-radii.x * (1.0 - (p2.y / radii.y).powi(2)).sqrt(), p2.y);
        let clip = ClipCurve { alpha1: angle(down), alpha3: angle(left), p2, rho: 1.0 };
        Splat { clips: vec![clip], ..splat(center, DMat3::from_cols(i, j, k), radii, DVec2::ZERO) }
    });
    asset(splats.to_vec(), error)
}

/// The same corner with the other faces as partners, which unite; a fourth splat, a bowl over the
/// corner, keeps what two of them leave together.
pub fn partnered() -> Asset {
    let corner = corner();
    let error = corner.max_error;
    let faces: Vec<Splat> =
        corner.splats.iter().map(|face| Splat { clips: Vec::new(), ..face.clone() }).collect();
    let partner = |n: usize, cut| Partner::new(n as u32, &faces[n], cut, error);
    let mut splats = faces.clone();
    for (n, splat) in splats.iter_mut().enumerate() {
        let others = [(n + 1) % 3, (n + 2) % 3];
        splat.partners = others.map(|other| vec![partner(other, Cut::Seen)]).to_vec();
    }
    let bowl = splat(DVec3::splat(0.5), axes(DVec3::ONE), DVec2::new(0.5, 0.4), DVec2::new(0.4, -0.3));
    let groups = vec![vec![partner(0, Cut::Unseen), partner(1, Cut::Unseen)], vec![partner(2, Cut::Seen)]];
    splats.push(Splat { partners: groups, clips: vec![ClipCurve::chord(4.2, 4.9)], ..bowl });
    asset(splats, error)
}

/// One bowl with these shapes of clip: chord, parabola, corner, and all at once.
pub fn clipped(rho: f64, several: bool) -> Asset {
    let mut clips = vec![ClipCurve { alpha1: 5.6, alpha3: 0.9, p2: DVec2::new(0.1, 0.05), rho }];
    if several {
        clips.push(ClipCurve { alpha1: 1.8, alpha3: 3.6, p2: DVec2::new(-0.2, 0.3), rho: 0.5 });
        clips.push(ClipCurve::chord(4.2, 4.9));
    }
    let bowl =
        splat(DVec3::ZERO, axes(DVec3::new(0.2, 0.3, 1.0)), DVec2::new(0.9, 0.7), DVec2::new(0.5, -0.4));
    asset(vec![Splat { clips, ..bowl }], 0.002)
}

/// One bowl of which the arc cut away is three quarters of its border.
pub fn wide_arc(rho: f64) -> Asset {
    let mut asset = clipped(rho, false);
    for clip in asset.splats.iter_mut().flat_map(|splat| &mut splat.clips) {
        std::mem::swap(&mut clip.alpha1, &mut clip.alpha3);
    }
    asset
}

/// Radii of a needle, a thousand times as long as wide.
const NEEDLE: DVec2 = DVec2::new(0.5, 0.0005);

/// Needles, flat and curved, every way.
pub fn needles() -> Asset {
    let splats = directions(500).enumerate().map(|(n, d)| {
        let curvature = if n % 2 == 0 { DVec2::ZERO } else { DVec2::new(0.3, 0.0) };
        splat(0.5 * d, axes(d), NEEDLE, curvature)
    });
    asset(splats.collect(), 0.0005)
}

/// The same needles, each without a good third of its length, by curves of every shape.
pub fn clipped_needles() -> Asset {
    let across = |u: f64, side: f64| angle(DVec2::new(u, side * NEEDLE.y));
    let mut asset = needles();
    for (n, splat) in asset.splats.iter_mut().enumerate() {
        let rho = [0.0, 0.3, 0.5, 0.9, 1.0][n % 5];
        let p2 = DVec2::new(0.1, 0.4 * NEEDLE.y);
        splat.clips = vec![ClipCurve { alpha1: across(0.2, -1.0), alpha3: across(0.15, 1.0), p2, rho }];
    }
    asset
}

/// One needle in the plane `z = 0`, along `X`, with a clip curve through its middle.
pub fn clipped_needle(rho: f64) -> Asset {
    let (p1, p3) = (DVec2::new(2.0, -2.0) * NEEDLE.y, DVec2::new(1.0, 2.0) * NEEDLE.y);
    let clip = ClipCurve { alpha1: angle(p1), alpha3: angle(p3), p2: DVec2::new(-1.5, 0.2) * NEEDLE.y, rho };
    let needle = splat(DVec3::ZERO, DMat3::IDENTITY, NEEDLE, DVec2::new(0.3, 0.0));
    asset(vec![Splat { clips: vec![clip], ..needle }], 0.0005)
}

/// Central angle in `[0, 2π)`.
fn angle(p: DVec2) -> f64 {
    libm::atan2(p.y, p.x).rem_euclid(std::f64::consts::TAU)
}

/// Everything at once: all four classes, in colour.
pub fn all_kinds() -> Asset {
    let parts = [sphere(120, 0.5, true), corner(), clipped(0.6, true), needles(), cylinder(12, 0.9, 0.4)];
    let splats: Vec<Splat> = parts.into_iter().flat_map(|part| part.splats).collect();
    Asset { has_colors: true, ..asset(splats, 0.002) }
}
