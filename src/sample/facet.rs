//! How far a flat facet lies above and below a quadric, between its corners too.

use glam::{DVec2, DVec3};

use crate::fit::ellipse::crossings;
use crate::fit::pose::above;
use crate::model::clip_curve::turn;

/// Directions at equal angles, between which the height along a rim is followed.
const AROUND: [DVec2; 16] = {
    // Cosines of 22.5°, 45° and 67.5°.
    const A: f64 = 0.923_879_532_511_286_7;
    const B: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const C: f64 = 0.382_683_432_365_089_8;
    let mut around = [DVec2::X; 16];
    [around[1], around[2], around[3]] = [DVec2::new(A, C), DVec2::new(B, B), DVec2::new(C, A)];
    let mut n = 4;
    while n < around.len() {
        around[n] = DVec2::new(-around[n - 4].y, around[n - 4].x);
        n += 1;
    }
    around
};

/// The lowest and the highest that a facet lies over a quadric, along `k`, within an ellipse. 0 counts
/// among them, also where none of it lies there.
///
/// Over a facet the height is `Σ λᵢ dᵢ + Σ λᵢ λⱼ q(pᵢ - pⱼ)`, of the corners' distances `dᵢ`
/// and the quadric's form `q`: extreme at a corner, on an edge where its slope is zero, for
/// an elliptic form at one place inside, or on the ellipse's rim.
#[must_use]
pub fn extremes(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2) -> [f64; 2] {
    let edges = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| along(facet[a], facet[b], curvature, radii));
    let found = both(edges.into_iter().fold([0.0; 2], both), [inside(facet, curvature, radii); 2]);
    if facet.iter().all(|&corner| is_in(corner, radii)) {
        found
    } else {
        both(found, on_rim(facet, curvature, radii))
    }
}

/// Whether a place lies over an ellipse.
fn is_in(place: DVec3, radii: DVec2) -> bool {
    (place.truncate() / radii).length_squared() <= 1.0
}

/// `q`, the height of the quadric over a place.
fn form(curvature: DVec2, uv: DVec2) -> f64 {
    (curvature * uv * uv).element_sum()
}

/// The lower and the higher of two pairs.
fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The extremes on an edge, as far as it lies in the ellipse.
fn along(a: DVec3, b: DVec3, curvature: DVec2, radii: DVec2) -> [f64; 2] {
    let Some((enter, leave)) = crossings(a.truncate(), b.truncate(), radii) else { return [0.0; 2] };
    let (first, last) = (enter.max(0.0), leave.min(1.0));
    if first > last {
        return [0.0; 2];
    }
    let (from, to) = (above(curvature, a), above(curvature, b));
    let bend = form(curvature, (b - a).truncate());
    let at = |t: f64| from + t * (to - from) + t * (1.0 - t) * bend;
    let level = 0.5 + 0.5 * (to - from) / bend;
    // Without a bend the level place is infinite or no number, and lies on no edge.
    let middle = if level > first && level < last { at(level) } else { 0.0 };
    [at(first), at(last), middle].into_iter().fold([0.0; 2], |found, one| both(found, [one; 2]))
}

/// The height at the place inside a facet and an ellipse where it changes in no direction; 0 if there is none.
fn inside(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2) -> f64 {
    let origin = above(curvature, facet[0]);
    let [p, q] = [facet[1] - facet[0], facet[2] - facet[0]];
    let slope = DVec2::new(above(curvature, facet[1]), above(curvature, facet[2])) - origin;
    let (pp, qq) = (form(curvature, p.truncate()), form(curvature, q.truncate()));
    let pq = (curvature * p.truncate() * q.truncate()).element_sum();
    // With s and t along two sides: origin + slope·(s, t) + s pp + t qq - (s p + t q)'s form.
    let determinant = pp * qq - pq * pq;
    let right = 0.5 * (slope + DVec2::new(pp, qq));
    let place = DVec2::new(right.x * qq - right.y * pq, right.y * pp - right.x * pq) / determinant;
    let DVec2 { x: s, y: t } = place;
    let within = place.min_element() > 0.0 && place.element_sum() < 1.0;
    if !(within && is_in(facet[0] + s * p + t * q, radii)) {
        return 0.0;
    }
    origin + slope.dot(place) + s * pp + t * qq - (s * s * pp + 2.0 * s * t * pq + t * t * qq)
}

/// The extremes on the rim of an ellipse, where it runs through the inside of a facet.
///
/// Around the whole rim the plane of the facet lies at `tilt·d - sagitta·d²` over the quadric, but for a
/// constant, `d` the place divided by the radii: there are at most four extremes. One between two of the
/// directions around is found by a step of Newton's from about where the slope is zero. Where two lie between the
/// same directions none is found: from the one to the other the height changes by little.
fn on_rim(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2) -> [f64; 2] {
    let flat = facet.map(|corner| corner.truncate());
    let normal = (facet[1] - facet[0]).cross(facet[2] - facet[0]);
    let slope = -normal.truncate() / normal.z;
    if !slope.is_finite() {
        // Seen along its plane it is its edges.
        return [0.0; 2];
    }
    let (tilt, sagitta) = (slope * radii, curvature * radii * radii);
    let bend = 2.0 * (sagitta.x - sagitta.y);
    let rise = |d: DVec2| tilt.dot(d.perp()) + bend * d.x * d.y;
    let turning = |d: DVec2| bend * (d.x * d.x - d.y * d.y) - tilt.dot(d);
    let height = |uv: DVec2| {
        let within = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| turn(flat[a], flat[b], uv) * normal.z >= 0.0);
        let z = facet[0].z + slope.dot(uv - flat[0]);
        if within == [true; 3] { above(curvature, uv.extend(z)) } else { 0.0 }
    };
    let following = AROUND.iter().cycle().skip(1);
    let level = AROUND.iter().zip(following).filter_map(|(&from, &to)| {
        let (a, b) = (rise(from), rise(to));
        let level = (from * b.abs() + to * a.abs()).normalize_or_zero();
        ((a <= 0.0) != (b <= 0.0))
            .then(|| (level - rise(level) / turning(level) * level.perp()).normalize_or(level))
    });
    level.fold([0.0; 2], |found, d| both(found, [height(d * radii); 2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::canonical::mix;
    use crate::model::clip_curve::border_point;

    /// Within `[-1, 1]`.
    fn random(seed: u32, k: u32) -> f64 {
        let bits = mix(u64::from(seed * 16 + k)) >> 11;
        bits as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The extremes over places of a facet inside an ellipse.
    fn brute(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2) -> [f64; 2] {
        const STEPS: u32 = 60;
        let [a, b, c] = facet.map(|corner| corner.truncate());
        let over = |uv: DVec2| {
            let shares = DVec3::new(turn(uv, b, c), turn(a, uv, c), turn(a, b, uv)) / turn(a, b, c);
            let z = shares.dot(DVec3::new(facet[0].z, facet[1].z, facet[2].z));
            (shares.min_element() >= 0.0).then(|| above(curvature, uv.extend(z)))
        };
        let rim = (0..1440).map(|n| border_point(std::f64::consts::TAU * f64::from(n) / 1440.0, radii));
        let mut found = rim.filter_map(over).fold([0.0; 2], |found, one| both(found, [one; 2]));
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let (s, t) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
                let place = facet[0] + s * (facet[1] - facet[0]) + t * (facet[2] - facet[0]);
                if is_in(place, radii) {
                    found = both(found, [above(curvature, place); 2]);
                }
            }
        }
        found
    }

    #[test]
    fn no_place_of_a_facet_is_lower_or_higher() {
        let (mut partial, mut bulging) = (0, 0);
        for seed in 0..4000 {
            let value = |k: u32| random(seed, k);
            let corner = |k: u32| DVec3::new(value(k), value(k + 1), 0.2 * value(k + 2));
            let mut facet = [corner(0), corner(3), corner(6)];
            let mut curvature = DVec2::new(2.0 * value(9), 2.0 * value(10));
            if seed % 2 == 1 {
                // Inscribed in a bowl, facets are farthest inside.
                curvature = curvature.abs();
                facet = facet.map(|p| p.with_z(form(curvature, p.truncate())));
            }
            let radii = DVec2::new(1.0 + 0.6 * value(11), 1.0 + 0.6 * value(12));
            let whole = facet.iter().all(|&corner| is_in(corner, radii));
            let found = extremes(&facet, curvature, radii);
            let brute = brute(&facet, curvature, radii);
            // The places looked at lie apart: a facet may rise a lot between two on the rim.
            let apart = if whole { 2e-3 } else { 0.1 };
            // One step of Newton's ends within this of the extremes of a rim.
            let rounding = if whole { 1e-12 } else { 1e-5 };
            for (found, brute) in [(-found[0], -brute[0]), (found[1], brute[1])] {
                assert!((brute - rounding..=brute + apart).contains(&found), "{found} {brute} {facet:?}");
            }
            partial += u32::from(!whole);
            let level = inside(&facet, curvature, radii);
            bulging += u32::from(whole && level.abs() > 0.0 && found.contains(&level));
        }
        assert!(partial > 500 && bulging > 50, "{partial} {bulging}");
    }

    #[test]
    fn over_a_plane_corners_are_extreme() {
        let facet = [DVec3::new(0.0, 0.0, 0.125), DVec3::new(0.5, 0.0, -0.375), DVec3::new(0.0, 0.5, 0.25)];
        let [low, high] = extremes(&facet, DVec2::ZERO, DVec2::ONE);
        assert!((low + 0.375).abs() < 1e-15 && (high - 0.25).abs() < 1e-15, "{low} {high}");
    }
}
