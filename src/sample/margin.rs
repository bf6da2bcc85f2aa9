//! How far inside its domain a point of a cloud must lie.

use glam::DVec2;

/// Corners of the polygon around a point's disc.
const CORNERS: usize = 16;

/// Whether the disc of a radius `margin` around `uv` lies within an ellipse.
///
/// Proof of the margin rule: if every place of a surface has a point within that point's
/// margin, and the point's disc lies within the domain, the place does too. An ellipse with
/// both radii less by the margin would not do: its offset bulges out of the ellipse. The
/// disc lies within the polygon around it, and that within the ellipse if its corners do,
/// since the ellipse is convex.
#[must_use]
pub fn disc_inside(uv: DVec2, margin: f64, radii: DVec2) -> bool {
    let from = (uv / radii).length();
    // A distance of one margin is at most this far where the ellipse is the unit circle.
    let most = margin / radii.min_element();
    if from + most <= 1.0 {
        return true;
    }
    if from > 1.0 || margin > radii.min_element() {
        return false;
    }
    let step = std::f64::consts::TAU / CORNERS as f64;
    let corner = margin / libm::cos(0.5 * step);
    (0..CORNERS).all(|n| {
        let (sin, cos) = libm::sincos(step * n as f64);
        ((uv + corner * DVec2::new(cos, sin)) / radii).length_squared() <= 1.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_said_to_be_inside_are() {
        let mut inside = 0;
        for n in 0..20_000_u32 {
            let value = |k: u32| f64::from((n * 4 + k).wrapping_mul(2_654_435_769) >> 8) / f64::from(1 << 24);
            let radii = DVec2::new(1.0, 0.05 + 0.95 * value(0));
            let uv = DVec2::new(2.0 * value(1) - 1.0, 2.0 * value(2) - 1.0) * radii;
            let margin = 0.5 * value(3) * radii.y;
            if disc_inside(uv, margin, radii) {
                inside += 1;
                for k in 0..90 {
                    let (sin, cos) = libm::sincos(f64::from(k) * 0.0698);
                    assert!(((uv + margin * DVec2::new(cos, sin)) / radii).length() <= 1.0 + 1e-12);
                }
            }
        }
        assert!(inside > 5000, "{inside}");
        assert!(!disc_inside(DVec2::new(0.5, 0.0), 0.48, DVec2::new(1.0, 0.6)));
        assert!(disc_inside(DVec2::ZERO, 0.5, DVec2::new(1.0, 0.52)));
        assert!(disc_inside(DVec2::new(0.999, 0.0), 0.0, DVec2::ONE));
    }
}
