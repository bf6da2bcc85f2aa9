//! The numbers that decide a case, in one place for both twins.
//!
//! The Rust twins use the constants; the WGSL twins get the same values as `const` lines
//! written by [`wgsl`], so that neither can drift from the other.

use crate::model::asset::Asset;
use crate::model::splat::{Kind, Splat};

/// Depth band of the attribute pass, in error bounds along the surface normal.
///
/// Two splats over the same input point lie within one error bound of it each; at their rims
/// twice that is allowed. So a splat may pass 2 + 2 bounds behind another of the same surface.
pub const BAND_ERRORS: f64 = 4.0;

/// Least depth band, as a fraction of the diagonal: above the rounding of the 32-bit twin.
pub const BAND_FLOOR: f64 = 2e-6;

/// A place this near to a clip curve, in error bounds, may lie beyond the line that the curve lies outside
/// of, and gives way: else each side of a convex edge would stand out as a rim over the other. The nearer to
/// the curve, the deeper a place of another splat may lie that is seen instead, so that between the curves of
/// two sides the middle is the edge.
pub const YIELD_ERRORS: f64 = 1.0;

/// Share of the band by which what lies on a clip curve gives way, along the surface: twice as much as two
/// splats may stand apart there.
pub const YIELD_SHARE: f64 = 0.5;

/// What is seen from behind gives way this many times as far from its curves, by all that anything may: a ray
/// that comes out there went in across the line, at what is to be seen.
pub const YIELD_BEHIND: f64 = 2.0;

/// Least sine between ray and normal by which that is divided. The steeper a ray, the deeper below a place
/// beyond the line it meets what lies across, a wall that it runs along. Less would let edges be seen once from
/// nearer than 17 degrees to a wall, too, but show what lies more than four bounds deeper, as through a hole.
pub const SINE_FLOOR: f64 = 0.5;

/// Least cosine between ray and normal by which the band is divided.
///
/// Near a silhouette the band along the ray would grow without bound and reach another
/// surface.
pub const COSINE_FLOOR: f64 = 0.1;

/// Splats blend when their normals differ by less than this angle, degrees.
///
/// Below the default feature angle of 40 degrees, so that nothing blends across an edge, and
/// well above what two splats of one smooth surface differ by.
pub const AGREE_DEGREES: f64 = 30.0;

/// Weight at the rim: not 0, so that a pixel whose only splat is seen at its rim has one.
pub const RIM_WEIGHT: f64 = 1e-3;

/// The screen bound is widened by this many pixels, above the rounding of the 32-bit twin.
pub const BOUND_PAD: f64 = 1.0 / 64.0;

/// Grey of the nearest and the farthest depth that the scene's bounding sphere allows.
pub const DEPTH_GREY: [f64; 2] = [0.95, 0.1];

/// Added to each component of a normal in [0, 1] before it becomes a byte. A component of 0
/// would be 127.5 levels, a tie that the last bit decides; this is a fortieth of a level.
pub const NORMAL_TIE: f64 = 1e-4;

/// Linear colour of a surface without colours.
pub const MATTE: [f64; 3] = [0.40, 0.41, 0.43];

/// Linear colours of [`tint`] under [`super::Show::Kinds`]: flat blue, flat and clipped green,
/// cylinder violet, cylinder and clipped pink, quadric orange, quadric and clipped red.
pub const TINTS: [[f64; 3]; 6] = [
    [0.10, 0.25, 0.75],
    [0.06, 0.50, 0.20],
    [0.33, 0.10, 0.70],
    [0.80, 0.16, 0.50],
    [0.85, 0.40, 0.05],
    [0.70, 0.06, 0.06],
];

/// The place of a splat's colour in [`TINTS`].
#[must_use]
pub fn tint(splat: &Splat) -> usize {
    let kind = match splat.kind() {
        Kind::Flat => 0,
        Kind::Cylinder => 1,
        Kind::Quadric => 2,
    };
    usize::from(splat.is_clipped()) + 2 * kind
}

/// Splats fall into this many classes, each with its own specialised pipeline on the GPU.
pub const CLASSES: usize = 4;

/// The class of a splat: 1 for clipped, plus 2 for a curved one. A cylinder is cast like any
/// other quadric.
#[must_use]
pub fn class(splat: &Splat) -> usize {
    usize::from(splat.is_clipped()) + 2 * usize::from(splat.kind() != Kind::Flat)
}

/// Depth band of an asset along the surface normal, in model units.
#[must_use]
pub fn band(asset: &Asset) -> f64 {
    (BAND_ERRORS * asset.max_error).max(BAND_FLOOR * asset.diagonal)
}

/// How near to a clip curve what a splat shows gives way, in model units.
#[must_use]
pub fn yielding(asset: &Asset) -> f64 {
    YIELD_ERRORS * asset.max_error
}

/// Cosine of [`AGREE_DEGREES`].
#[must_use]
pub fn agree_cosine() -> f64 {
    libm::cos(AGREE_DEGREES.to_radians())
}

/// The constants as WGSL `const` declarations.
#[must_use]
pub fn wgsl() -> String {
    let scalars = [
        ("COSINE_FLOOR", COSINE_FLOOR),
        ("SINE_FLOOR", SINE_FLOOR),
        ("AGREE_COSINE", agree_cosine()),
        ("RIM_WEIGHT", RIM_WEIGHT),
        ("YIELD_SHARE", YIELD_SHARE),
        ("YIELD_BEHIND", YIELD_BEHIND),
        ("BOUND_PAD", BOUND_PAD),
        ("NORMAL_TIE", NORMAL_TIE),
        ("DEPTH_GREY_NEAR", DEPTH_GREY[0]),
        ("DEPTH_GREY_FAR", DEPTH_GREY[1]),
    ];
    let mut text: String =
        scalars.iter().map(|(name, value)| format!("const {name}: f32 = {value:?};\n")).collect();
    let color = |c: &[f64; 3]| format!("vec3<f32>({:?}, {:?}, {:?})", c[0], c[1], c[2]);
    text += &format!("const MATTE = {};\n", color(&MATTE));
    let tints: Vec<String> = TINTS.iter().map(color).collect();
    text += &format!("const TINTS = array<vec3<f32>, {}>({});\n", tints.len(), tints.join(", "));
    text
}
