//! How far a flat facet lies above and below a quadric, between its corners too.

use glam::{DVec2, DVec3};

use crate::fit::ellipse::crossings;
use crate::fit::pose::above;

/// The lowest and the highest that a facet lies over a quadric, along `k`, as far as its edges and its
/// inside show within an ellipse. 0 counts among them, also where none of it lies there.
///
/// Over a facet the height is `Σ λᵢ dᵢ + Σ λᵢ λⱼ q(pᵢ - pⱼ)`, of the corners' distances `dᵢ`
/// and the quadric's form `q`: extreme at a corner, on an edge where its slope is zero, or, for
/// an elliptic form, at one place inside. Of a facet that the ellipse's rim passes through, the
/// edges are looked at as far as they lie in the ellipse.
#[must_use]
pub fn extremes(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2) -> [f64; 2] {
    let edges = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| along(facet[a], facet[b], curvature, radii));
    let whole = facet.iter().all(|corner| (corner.truncate() / radii).length_squared() <= 1.0);
    let within = if whole { inside(facet, curvature) } else { 0.0 };
    edges.into_iter().fold([within.min(0.0), within.max(0.0)], both)
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

/// The height at the place inside a facet where it changes in no direction; 0 if there is none.
fn inside(facet: &[DVec3; 3], curvature: DVec2) -> f64 {
    let origin = above(curvature, facet[0]);
    let [p, q] = [facet[1] - facet[0], facet[2] - facet[0]];
    let slope = DVec2::new(above(curvature, facet[1]), above(curvature, facet[2])) - origin;
    let (pp, qq) = (form(curvature, p.truncate()), form(curvature, q.truncate()));
    let pq = (curvature * p.truncate() * q.truncate()).element_sum();
    // With s and t along two sides: origin + slope·(s, t) + s pp + t qq - (s p + t q)'s form.
    let determinant = pp * qq - pq * pq;
    let right = 0.5 * (slope + DVec2::new(pp, qq));
    let place = DVec2::new(right.x * qq - right.y * pq, right.y * pp - right.x * pq) / determinant;
    if !(place.min_element() > 0.0 && place.element_sum() < 1.0) {
        return 0.0;
    }
    let DVec2 { x: s, y: t } = place;
    origin + slope.dot(place) + s * pp + t * qq - (s * s * pp + 2.0 * s * t * pq + t * t * qq)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::canonical::mix;

    /// Within `[-1, 1]`.
    fn random(seed: u32, k: u32) -> f64 {
        let bits = mix(u64::from(seed * 16 + k)) >> 11;
        bits as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The extremes over places of a facet inside an ellipse, `edges` alone or all.
    fn brute(facet: &[DVec3; 3], curvature: DVec2, radii: DVec2, edges: bool) -> [f64; 2] {
        const STEPS: u32 = 60;
        let mut found = [0.0; 2];
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                if edges && i > 0 && j > 0 && i + j < STEPS {
                    continue;
                }
                let (s, t) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
                let place = facet[0] + s * (facet[1] - facet[0]) + t * (facet[2] - facet[0]);
                if (place.truncate() / radii).length_squared() <= 1.0 {
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
            let whole = facet.iter().all(|p| (p.truncate() / radii).length_squared() <= 1.0);
            let found = extremes(&facet, curvature, radii);
            let brute = brute(&facet, curvature, radii, !whole);
            // The places looked at lie a sixtieth apart; those on the rim itself are between them.
            let apart = if whole { 2e-3 } else { 0.2 };
            for (found, brute) in [(-found[0], -brute[0]), (found[1], brute[1])] {
                assert!((brute - 1e-12..=brute + apart).contains(&found), "{found} {brute} {facet:?}");
            }
            partial += u32::from(!whole);
            let level = inside(&facet, curvature);
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
