//! Where the normals of a whole quadric `w = a u² + b v²` pass through a point.
//!
//! A foot `(u, v)` of the point `p` has `p = x + λ ∇g` with `g = a u² + b v² - w`, so
//! `u = p_u / (1 + 2aλ)`, `v = p_v / (1 + 2bλ)`, `w = p_w + λ`, and `λ` solves the secular
//! equation `F(λ) = a p_u²/(1+2aλ)² + b p_v²/(1+2bλ)² - p_w - λ = 0`. The foot nearest of all is
//! the one where both denominators are positive (Moré 1993, for one quadratic constraint), and
//! there `F` falls.

use glam::{DVec2, DVec3};

use super::roots;

/// A denominator below this is taken for 0: the point lies on the focal set, and the surface
/// itself gives what the division cannot.
const FOCAL: f64 = 1e-8;

/// Feet with a denominator below this are polished.
const STEEP: f64 = 1e-2;

/// Steps of Newton's method that polish a foot.
const POLISH: usize = 4;

/// Places over which the foot nearest of all lies: one, unless the point lies on the focal set,
/// where the feet are a pair or a circle. All that are given are equally near.
pub(super) fn nearest(p: DVec3, curvature: DVec2) -> [DVec2; 4] {
    let flat = p.truncate();
    if curvature == DVec2::ZERO {
        return [flat; 4];
    }
    let lambda = secular_root(p, curvature);
    let places = at(p, curvature, lambda);
    // Near a pole the division magnifies the rounding of the root.
    let steep = (1.0 + 2.0 * lambda * curvature).min_element() < STEEP;
    if steep { places.map(|place| polished(p, curvature, place)) } else { places }
}

/// The root of the secular equation between the poles around 0.
fn secular_root(p: DVec3, curvature: DVec2) -> f64 {
    let (flat, height) = (p.truncate(), p.z);
    let secular = |lambda: f64| {
        // On a plane of symmetry the foot stays in it, also where the pole is.
        let feet = DVec2::select(flat.cmpeq(DVec2::ZERO), flat, flat / (1.0 + 2.0 * lambda * curvature));
        (curvature * feet * feet).element_sum() - height - lambda
    };
    // Between 0 and the value there lies the root, as F falls at least as fast as -λ there.
    let start = secular(0.0);
    let poles = -0.5 / curvature;
    let beyond = |pole: f64| if pole * start > 0.0 { pole.abs() } else { f64::INFINITY };
    let far = start.signum() * start.abs().min(beyond(poles.x)).min(beyond(poles.y));
    let value = secular(far);
    // At a pole the value is infinite or, on the focal set, not a number.
    let same_side = value.is_finite() && value * start > 0.0;
    if start == 0.0 || same_side {
        return far;
    }
    let value = if value.is_finite() { value } else { -start };
    roots::between(secular, (0.0, start), (far, value))
}

/// The places over which the foot with a given `λ` lies.
fn at(p: DVec3, curvature: DVec2, lambda: f64) -> [DVec2; 4] {
    let denominators = 1.0 + 2.0 * lambda * curvature;
    let height = p.z + lambda;
    let soft = p.truncate() / denominators;
    let hard = denominators.abs().cmplt(DVec2::splat(FOCAL));
    let root = |of: f64| libm::sqrt(of.max(0.0));
    match (hard.x, hard.y) {
        (false, false) => [soft; 4],
        (true, false) => {
            let u = root((height - curvature.y * soft.y * soft.y) / curvature.x);
            let [one, other] = [DVec2::new(u, soft.y), DVec2::new(-u, soft.y)];
            if p.x >= 0.0 { [one, other, one, other] } else { [other, one, other, one] }
        }
        (false, true) => {
            let v = root((height - curvature.x * soft.x * soft.x) / curvature.y);
            let [one, other] = [DVec2::new(soft.x, v), DVec2::new(soft.x, -v)];
            if p.y >= 0.0 { [one, other, one, other] } else { [other, one, other, one] }
        }
        (true, true) => {
            let (u, v) = (root(height / curvature.x), root(height / curvature.y));
            [DVec2::X * u, DVec2::Y * v, DVec2::X * -u, DVec2::Y * -v]
        }
    }
}

/// The places of all other feet that may be nearer than `within`; none unless the point lies
/// farther than the lesser radius of curvature from the surface.
pub(super) fn others(p: DVec3, curvature: DVec2, within: f64) -> Vec<DVec2> {
    let greatest = curvature.abs().max_element();
    // A foot's distance is at least |λ|, and the other feet lie beyond the first pole.
    let reach = 2.0 * greatest * within;
    if reach.is_nan() || reach <= 1.0 {
        return Vec::new();
    }
    // In units of the lesser radius of curvature, with s = 2 greatest λ.
    let (c, q) = (curvature / greatest, 2.0 * greatest * p);
    let denominator = |c: f64| [1.0, 2.0 * c, c * c];
    let (a2, b2) = (denominator(c.x), denominator(c.y));
    let mut polynomial = [0.0; 6];
    for n in 0..3 {
        polynomial[n] += 0.5 * (c.x * q.x * q.x * b2[n] + c.y * q.y * q.y * a2[n]);
        for m in 0..3 {
            polynomial[n + m] -= q.z * a2[n] * b2[m];
            polynomial[n + m + 1] -= a2[n] * b2[m];
        }
    }
    // No foot is farther than the point's own height over the surface and its poles.
    let farthest = reach.min(2.0 * (q.length() + 1.0) * (q.length() + 1.0));
    let mut lambdas = roots::polynomial(&polynomial, -farthest, farthest);
    lambdas.extend([-1.0 / c.x, -1.0 / c.y].into_iter().filter(|pole| pole.abs() <= farthest));
    let places = lambdas.into_iter().flat_map(|s| at(p, curvature, s / (2.0 * greatest)));
    places.filter(|place| place.is_finite()).map(|place| polished(p, curvature, place)).collect()
}

/// A place after some steps of Newton's method on the squared distance, as far as they lessen it.
fn polished(p: DVec3, curvature: DVec2, mut place: DVec2) -> DVec2 {
    let offset = |x: DVec2| (curvature * x * x).element_sum() - p.z;
    let squared = |x: DVec2| (x - p.truncate()).length_squared() + offset(x) * offset(x);
    for _ in 0..POLISH {
        let rise = offset(place);
        let slope = 2.0 * curvature * place;
        let gradient = place - p.truncate() + rise * slope;
        let straight = 1.0 + 2.0 * curvature * rise + slope * slope;
        let mixed = slope.x * slope.y;
        let determinant = straight.x * straight.y - mixed * mixed;
        let step = DVec2::new(
            straight.y * gradient.x - mixed * gradient.y,
            straight.x * gradient.y - mixed * gradient.x,
        ) / determinant;
        let next = place - step;
        let better = squared(next) < squared(place);
        if !better {
            break;
        }
        place = next;
    }
    place
}
