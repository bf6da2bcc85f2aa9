//! From a pixel's surface to its colour; twin of `shade.wgsl`.

use glam::{DVec3, Vec3};

use super::constants::{DEPTH_GREY, NORMAL_TIE, TINTS};
use super::eye::Eye;
use super::settings::{Light, Settings, Show};

/// What a pixel's surface is, after blending. Vectors are in view coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Unit normal, turned towards the eye.
    pub normal: DVec3,
    /// Linear colour.
    pub color: Vec3,
    /// The ray, for each unit of view depth.
    pub direction: DVec3,
    /// View depth.
    pub depth: f64,
    /// Index of the nearest splat, triangle or point.
    pub index: u32,
    /// Its colour by kind, see [`super::constants::tint`].
    pub tint: usize,
}

/// Colours surfaces for one picture.
#[derive(Clone, Debug)]
pub struct Shader<'a> {
    eye: &'a Eye,
    show: Show,
    light: Light,
    towards_light: DVec3,
    range: [f64; 2],
}

impl<'a> Shader<'a> {
    /// For a scene within `radius` of the model's origin.
    #[must_use]
    pub fn new(eye: &'a Eye, settings: &Settings, radius: f64) -> Self {
        let light = settings.light;
        let towards_light = DVec3::from(light.direction).normalize();
        Self { eye, show: settings.show, light, towards_light, range: eye.depth_range(radius) }
    }

    /// The sRGB bytes of a surface, opaque.
    #[must_use]
    pub fn rgba(&self, surface: &Surface) -> [u8; 4] {
        let lit = |base: Vec3| self.lit(base, surface).to_array().map(byte_from_linear);
        let [r, g, b] = match self.show {
            Show::Shaded => lit(surface.color),
            Show::Splats => lit(index_color(surface.index)),
            Show::Kinds => lit(DVec3::from(TINTS[surface.tint]).as_vec3()),
            Show::Normals => {
                let normal = self.eye.turn_back(surface.normal);
                (0.5 * normal + 0.5 + NORMAL_TIE).to_array().map(|x| byte(x as f32))
            }
            Show::Depth => [byte(self.grey(surface.depth)); 3],
        };
        [r, g, b, 255]
    }

    /// Lambert's diffuse and Blinn's specular reflection, linear.
    fn lit(&self, base: Vec3, surface: &Surface) -> Vec3 {
        let light = &self.light;
        let cosine = ((surface.normal.dot(self.towards_light) + light.wrap) / (1.0 + light.wrap)).max(0.0);
        let half = (self.towards_light - surface.direction.normalize()).normalize_or_zero();
        let highlight = libm::pow(surface.normal.dot(half).max(0.0), light.shininess);
        base * (light.ambient + light.diffuse * cosine) as f32
            + Vec3::splat((light.specular * highlight) as f32)
    }

    /// The grey of a view depth.
    fn grey(&self, depth: f64) -> f32 {
        let [near, far] = self.range;
        let along = ((depth - near) / (far - near)).clamp(0.0, 1.0);
        (DEPTH_GREY[0] + (DEPTH_GREY[1] - DEPTH_GREY[0]) * along) as f32
    }
}

/// A stable linear colour for an index, by the `pcg` hash (Jarzynski and Olano 2020).
#[must_use]
pub fn index_color(index: u32) -> Vec3 {
    let state = index.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    let hash = (word >> 22) ^ word;
    let channel = |shift: u32| 0.08 + 0.72 * ((hash >> shift & 255) as f32 / 255.0);
    Vec3::new(channel(0), channel(8), channel(16))
}

/// A value in `[0, 1]` as a byte.
fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Linear light to an sRGB byte (IEC 61966-2-1).
#[must_use]
pub fn byte_from_linear(value: f32) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let encoded =
        if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * libm::powf(value, 1.0 / 2.4) - 0.055 };
    byte(encoded)
}

/// An sRGB byte to linear light.
#[must_use]
pub fn linear_from_byte(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back_from_linear_light() {
        for byte in 0..=255 {
            assert_eq!(byte_from_linear(linear_from_byte(byte)), byte);
        }
        // IEC 61966-2-1: the middle grey of 0.5 linear.
        assert_eq!(byte_from_linear(0.5), 188);
        assert_eq!([byte_from_linear(-1.0), byte_from_linear(2.0), byte_from_linear(f32::NAN)], [0, 255, 0]);
    }

    #[test]
    fn neighbouring_indices_get_colours_far_apart() {
        let apart: Vec<f32> = (0..1000).map(|n| index_color(n).distance(index_color(n + 1))).collect();
        assert!(apart.iter().sum::<f32>() / 1000.0 > 0.3);
        assert!(
            (0..1000).all(|n| index_color(n).min_element() >= 0.08 && index_color(n).max_element() <= 0.801)
        );
    }
}
