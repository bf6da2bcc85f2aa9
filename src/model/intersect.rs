//! Where a ray meets a splat's quadric; twin of the renderer's `intersect.wgsl`.
//!
//! Splat coordinates, with the ray anchored beside the centre: its parameter is 0 at the
//! centre's own view depth and grows by 1 for each unit of view depth. So everything that
//! matters lies within the splat's bounding radius `reach` of 0, and the numbers stay small
//! however far away the eye is.

use glam::{DVec2, DVec3};

/// A ray in splat coordinates, `origin + s * direction`.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay {
    /// The point at the centre's view depth.
    pub origin: DVec3,
    /// Motion for each unit of view depth.
    pub direction: DVec3,
}

impl LocalRay {
    /// The point at a parameter.
    #[must_use]
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + s * self.direction
    }
}

/// No root.
pub const NONE: f64 = f64::INFINITY;

/// The parameter at which the ray crosses the plane `w = 0`, within `reach` of 0, or [`NONE`].
#[must_use]
pub fn plane_root(ray: &LocalRay, reach: f64) -> f64 {
    quotient(-ray.origin.z, ray.direction.z, reach)
}

/// The parameters, ascending, at which the ray meets `w = a u² + b v²`, those within `reach`
/// of 0; [`NONE`] for the others.
///
/// `A s² + B s + C = 0` is solved by `q = -(B + sgn(B) sqrt(B² - 4AC))/2` and the roots `q/A`
/// and `C/q` (Press et al., Numerical Recipes, 5.6), which stay exact as `A` vanishes: a flat
/// splat, or a ray along a ruling.
#[must_use]
pub fn quadric_roots(curvature: DVec2, ray: &LocalRay, reach: f64) -> [f64; 2] {
    let (o, r) = (ray.origin, ray.direction);
    let (across, over) = (curvature * r.truncate(), curvature * o.truncate());
    let a = across.dot(r.truncate());
    let b = 2.0 * across.dot(o.truncate()) - r.z;
    let c = over.dot(o.truncate()) - o.z;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        let q = -0.5 * if b < 0.0 { b - root } else { b + root };
        let (s1, s2) = (quotient(q, a, reach), quotient(c, q, reach));
        if s1 < s2 { [s1, s2] } else { [s2, s1] }
    } else {
        [NONE; 2]
    }
}

/// `numerator / denominator` if its magnitude is at most `reach`, else [`NONE`].
///
/// The guard comes before the division, so that neither an infinity nor a NaN ever arises.
fn quotient(numerator: f64, denominator: f64, reach: f64) -> f64 {
    if denominator != 0.0 && numerator.abs() <= reach * denominator.abs() {
        numerator / denominator
    } else {
        NONE
    }
}

#[cfg(test)]
mod tests {
    // Roots that are not there are compared as the constant they are.
    #![allow(clippy::panic, clippy::float_cmp)]
    use super::*;
    use proptest::prelude::*;

    fn residual(curvature: DVec2, ray: &LocalRay, s: f64) -> f64 {
        let p = ray.at(s);
        let terms = [curvature.x * p.x * p.x, curvature.y * p.y * p.y, -p.z];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        // Moving the point by a rounding of the ray's numbers moves the terms by this much.
        let slope = DVec3::new(2.0 * curvature.x * p.x, 2.0 * curvature.y * p.y, 1.0).abs();
        let reach = (ray.origin.abs() + (s * ray.direction).abs()).dot(slope);
        terms.iter().sum::<f64>().abs() / (size + reach).max(f64::MIN_POSITIVE)
    }

    /// Real roots of integer `A s² + B s + C`, in 128-bit integers.
    fn exact(a: i128, b: i128, c: i128) -> Option<[f64; 2]> {
        let discriminant = b * b - 4 * a * c;
        (discriminant >= 0).then(|| {
            // 2^-40 of a unit in the square root.
            let root = (discriminant << 80).isqrt();
            let q2 = -((b << 40) + if b < 0 { -root } else { root });
            let (s1, s2) = (q2 as f64 / ((2 * a) << 40) as f64, ((2 * c) << 40) as f64 / q2 as f64);
            [s1.min(s2), s1.max(s2)]
        })
    }

    proptest! {
        #[test]
        fn agrees_with_integer_arithmetic(
            a in -7_i64..8, b in -7_i64..8,
            o in proptest::array::uniform3(-15_i64..16), r in proptest::array::uniform3(-15_i64..16),
        ) {
            let vector = |v: [i64; 3]| DVec3::from(v.map(|x| x as f64));
            let ray = LocalRay { origin: vector(o), direction: vector(r) };
            let found = quadric_roots(DVec2::new(a as f64, b as f64), &ray, 1e9);
            let big_a = i128::from(a * r[0] * r[0] + b * r[1] * r[1]);
            let big_b = i128::from(2 * (a * r[0] * o[0] + b * r[1] * o[1]) - r[2]);
            let big_c = i128::from(a * o[0] * o[0] + b * o[1] * o[1] - o[2]);
            if big_a == 0 {
                if big_b == 0 {
                    prop_assert_eq!(found, [NONE; 2]);
                } else {
                    let root = -(big_c as f64) / big_b as f64;
                    prop_assert!((found[0] - root).abs() <= 1e-14 * root.abs() && found[1] == NONE, "{:?}", found);
                }
            } else if let Some(roots) = exact(big_a, big_b, big_c) {
                // When B and C both vanish, 0 is a double root that is found once.
                let roots = if big_b == 0 && big_c == 0 { [0.0, NONE] } else { roots };
                for (found, root) in found.iter().zip(roots) {
                    prop_assert!(found == &root || (found - root).abs() <= 1e-9 * root.abs().max(1e-3), "{} {}", found, root);
                }
            } else {
                prop_assert_eq!(found, [NONE; 2]);
            }
        }

        #[test]
        fn finds_a_planted_hit(
            curvature in proptest::array::uniform2(-3.0..3.0), at in proptest::array::uniform2(-1.0..1.0),
            direction in proptest::array::uniform3(-1.0..1.0), s in -1.0..1.0,
            flatness in 0_u32..60, slant in 0_u32..40,
        ) {
            // Down to almost flat, and to almost within the tangent plane.
            let (curvature, at) = (DVec2::from(curvature) * 0.5_f64.powi(flatness as i32), DVec2::from(at));
            let point = at.extend((curvature * at).dot(at));
            let normal = (-2.0 * curvature * at).extend(1.0).normalize();
            let tangent = DVec3::from(direction).reject_from_normalized(normal);
            prop_assume!(tangent.length() > 0.01);
            let direction = tangent + 0.5_f64.powi(slant as i32) * normal;
            let ray = LocalRay { origin: point - s * direction, direction };
            let found = quadric_roots(curvature, &ray, 4.0);
            prop_assert!(found[0] <= found[1]);
            for s in found.into_iter().filter(|&s| s < NONE) {
                prop_assert!(residual(curvature, &ray, s) < 1e-14, "{}", residual(curvature, &ray, s));
            }
            // A root is lost or found by a rounding of the discriminant, whose size is that of
            // `rise` squared; well above that, its error grows with the inverse of `rise`.
            let rise = (-2.0 * curvature * at).extend(1.0).dot(direction).abs();
            if rise * rise > 1e-11 {
                let slack = 1e-14 * (1.0 + curvature.abs().max_element()) / rise;
                let planted: f64 = s;
                let miss = (found[0] - planted).abs().min((found[1] - planted).abs());
                prop_assert!(miss < slack + 1e-13, "miss {} slack {}", miss, slack);
            }
        }
    }

    #[test]
    fn a_tangent_ray_has_one_double_root_or_none() {
        // z = x² + y² from the side at height h: roots ±sqrt(h), merging at h = 0.
        for h in [0.0, 1e-300, 1e-20, 1e-12, 1e-6] {
            let ray = LocalRay { origin: DVec3::new(0.0, 0.0, h), direction: DVec3::X };
            let [first, second] = quadric_roots(DVec2::ONE, &ray, 1.0);
            if h > 0.0 {
                assert!(
                    (first + h.sqrt()).abs() <= 1e-15 * h.sqrt()
                        && (second - h.sqrt()).abs() <= 1e-15 * h.sqrt()
                );
            } else {
                assert!(first.abs() < f64::MIN_POSITIVE && second == NONE, "{first}");
            }
        }
        let below = LocalRay { origin: DVec3::new(0.0, 0.0, -1e-12), direction: DVec3::X };
        assert_eq!(quadric_roots(DVec2::ONE, &below, 1.0), [NONE; 2]);
    }

    #[test]
    fn a_ray_along_a_ruling_meets_it_nowhere_or_once() {
        // z = x² - y² holds the line x = y, z = 0.
        let saddle = DVec2::new(1.0, -1.0);
        let along = LocalRay { origin: DVec3::ZERO, direction: DVec3::new(1.0, 1.0, 0.0) };
        assert_eq!(quadric_roots(saddle, &along, 2.0), [NONE; 2]);
        let across = LocalRay { origin: DVec3::new(0.5, 0.0, 0.0), direction: DVec3::new(1.0, 1.0, 0.0) };
        let [first, second] = quadric_roots(saddle, &across, 2.0);
        assert!((first + 0.25).abs() < 1e-15 && second == NONE);
    }

    #[test]
    fn a_vanishing_curvature_is_a_plane() {
        let ray = LocalRay { origin: DVec3::new(0.3, -0.2, 0.1), direction: DVec3::new(0.4, 0.1, -1.0) };
        let plane = plane_root(&ray, 1.0);
        for curvature in [0.0, 1e-300, 1e-100, 1e-30, 1e-17] {
            let [first, second] = quadric_roots(DVec2::splat(curvature), &ray, 1.0);
            assert!((first - plane).abs() < 1e-16 && second == NONE, "{curvature}: {first}");
        }
    }
}
