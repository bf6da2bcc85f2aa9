//! Colours: 8-bit sRGB from what files hold.

use super::scalar::Scalar;

/// A colour that a file leaves out.
pub(super) const WHITE: [u8; 3] = [255; 3];

/// 255 over the value that stands for full in a channel of this type.
///
/// Floating-point channels run from 0 to 1, 16-bit ones to 65535; wider integers hold the
/// usual 0 to 255.
pub(super) fn scale(scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 | Scalar::F64 => 255.0,
        Scalar::U16 => 1.0 / 257.0,
        Scalar::I8 | Scalar::U8 | Scalar::I16 | Scalar::I32 | Scalar::U32 => 1.0,
    }
}

/// The nearest of 256 levels; what is out of range is clamped, and NaN counts as full.
pub(super) fn level(value: f64) -> u8 {
    if value.is_nan() { u8::MAX } else { (value + 0.5) as u8 }
}

/// Linear light from a stored sRGB level (IEC 61966-2-1).
#[cfg(feature = "gltf")]
pub(super) fn to_linear(level: u8) -> f64 {
    let s = f64::from(level) / 255.0;
    if s <= 0.04045 { s / 12.92 } else { libm::pow((s + 0.055) / 1.055, 2.4) }
}

/// The stored sRGB level of linear light (IEC 61966-2-1).
#[cfg(feature = "gltf")]
pub(super) fn from_linear(light: f64) -> u8 {
    let s = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
    level(255.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_round_clamp_and_survive_nan() {
        let levels = [-1.0, 0.4, 0.5, 254.6, 1e9, f64::NAN].map(level);
        assert_eq!(levels, [0, 0, 1, 255, 255, 255]);
        assert_eq!(level(65535.0 * scale(Scalar::U16)), 255);
        assert_eq!(level(0.5 * scale(Scalar::F32)), 128);
    }

    #[test]
    #[cfg(feature = "gltf")]
    fn srgb_there_and_back() {
        assert!((0..=255).all(|n| from_linear(to_linear(n)) == n));
        assert_eq!((from_linear(f64::NAN), from_linear(2.0), from_linear(-1.0)), (255, 255, 0));
    }
}
