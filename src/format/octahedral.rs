//! Unit normals as whole coordinates on an unfolded octahedron.
//!
//! With `n` steps from the middle of the square to its side, the lattice on each of the eight
//! faces is one of equilateral triangles with edge `sqrt(2)/n` (faces lie in
//! `|x|+|y|+|z| = 1`). The farthest point of such a triangle from its nearest corner is
//! `sqrt(2/3)/n` away, and the faces are at least `1/sqrt(3)` from the origin, so the nearest
//! lattice point by angle is at most `asin(sqrt(2)/n)` from any normal.

use glam::DVec3;

/// The sine of the largest angle to the nearest lattice normal is this over the steps.
#[cfg(test)]
const COVERING: f64 = std::f64::consts::SQRT_2;

/// +1 or -1; +1 at zero.
fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

/// The square's point folded over its inner diamond, in units of steps.
fn fold(x: f64, y: f64, steps: f64) -> (f64, f64) {
    ((steps - y.abs()) * sign(x), (steps - x.abs()) * sign(y))
}

/// The unit normal of a lattice point; `|x|, |y| <= steps`, `0 < steps < 2^50`.
#[must_use]
pub fn decode(lattice: [i64; 2], steps: u64) -> DVec3 {
    let n = steps as f64;
    let (x, y) = (lattice[0] as f64, lattice[1] as f64);
    let z = n - x.abs() - y.abs();
    let (x, y) = if z < 0.0 { fold(x, y, n) } else { (x, y) };
    let length = (x * x + y * y + z * z).sqrt();
    DVec3::new(x / length, y / length, z / length)
}

/// Where a direction meets the unfolded square, in units of steps; the direction need not be
/// of unit length but must not be zero.
fn square(direction: DVec3, steps: u64) -> (f64, f64) {
    let n = steps as f64;
    let sum = direction.x.abs() + direction.y.abs() + direction.z.abs();
    let (x, y) = (direction.x / sum * n, direction.y / sum * n);
    if direction.z < 0.0 { fold(x, y, n) } else { (x, y) }
}

/// The lattice point guessed for a direction: plain rounding, the same in every decoder.
#[must_use]
pub fn guess(direction: DVec3, steps: u64) -> [i64; 2] {
    let (x, y) = square(direction, steps);
    [(x + 0.5).floor() as i64, (y + 0.5).floor() as i64]
}

/// The lattice point whose normal is nearest to a unit direction by angle.
///
/// Points of the square's rim that stand for one normal give one lattice point.
#[must_use]
pub fn encode(normal: DVec3, steps: u64) -> [i64; 2] {
    let (x, y) = square(normal, steps);
    let n = steps as i64;
    let clamp = |value: f64| (value as i64).clamp(-n, n);
    let mut best = ([0, 0], f64::INFINITY);
    for (cx, cy) in
        [(x.floor(), y.floor()), (x.ceil(), y.floor()), (x.floor(), y.ceil()), (x.ceil(), y.ceil())]
    {
        let lattice = on_rim([clamp(cx), clamp(cy)], n);
        let distance = decode(lattice, steps).distance_squared(normal);
        if distance < best.1 {
            best = (lattice, distance);
        }
    }
    best.0
}

/// On the rim of the square, `(n, y)` and `(n, -y)` are one normal: the positive one is used.
fn on_rim([x, y]: [i64; 2], n: i64) -> [i64; 2] {
    let y = if x.abs() == n { y.abs() } else { y };
    let x = if y.abs() == n { x.abs() } else { x };
    [x, y]
}

/// Two unit vectors that make a right-handed frame with a unit normal.
///
/// Duff et al. 2017, "Building an orthonormal basis, revisited".
#[must_use]
pub fn basis(k: DVec3) -> (DVec3, DVec3) {
    let s = sign(k.z);
    let a = -1.0 / (s + k.z);
    let b = k.x * k.y * a;
    let i = DVec3::new(1.0 + s * (k.x * k.x * a), s * b, -(s * k.x));
    let j = DVec3::new(b, s + k.y * k.y * a, -k.y);
    (i, j)
}

/// The axis (0, 1 or 2) a normal leans to most; the first of equals.
#[must_use]
pub fn dominant(k: DVec3) -> usize {
    let (x, y, z) = (k.x.abs(), k.y.abs(), k.z.abs());
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

#[cfg(test)]
#[allow(clippy::print_stdout, clippy::float_cmp)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64)
            .prop_map(|(x, y, z)| DVec3::new(x, y, z))
            .prop_filter("not zero", |v| v.length() > 1e-3)
            .prop_map(DVec3::normalize)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn the_nearest_normal_is_within_the_covering_angle(k in direction(), steps in 1..5000_u64) {
            let near = decode(encode(k, steps), steps);
            prop_assert!(near.cross(k).length() <= COVERING / steps as f64 + 1e-15);
            prop_assert!(near.dot(k) > 0.0);
        }

        #[test]
        fn lattice_normals_come_back(x in -40..=40_i64, y in -40..=40_i64) {
            let k = decode([x, y], 40);
            prop_assert_eq!(encode(k, 40), on_rim([x, y], 40));
            prop_assert!((k.length() - 1.0).abs() < 1e-15);
        }

        #[test]
        fn the_basis_is_orthonormal(k in direction()) {
            let (i, j) = basis(k);
            for error in [i.dot(j), i.dot(k), j.dot(k), i.length() - 1.0, j.length() - 1.0] {
                prop_assert!(error.abs() < 1e-15, "{}", error);
            }
            prop_assert!(i.cross(j).dot(k) > 0.0);
        }
    }

    #[test]
    fn axes_and_octants_are_exact_and_the_covering_bound_is_nearly_met() {
        for k in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
            assert_eq!(decode(encode(k, 7), 7), k);
        }
        let mut worst = 0.0_f64;
        for step in 0..200_000 {
            let t = f64::from(step);
            let k = DVec3::new(libm::sin(t * 1.1), libm::sin(t * 1.7 + 1.0), libm::sin(t * 2.3 + 2.0))
                .normalize();
            worst = worst.max(decode(encode(k, 100), 100).cross(k).length() * 100.0 / COVERING);
        }
        println!("worst angle over the bound {worst}");
        assert!(worst > 0.95 && worst <= 1.0);
    }
}
