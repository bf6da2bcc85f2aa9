//! What the shaders read, byte for byte.

use glam::{DVec3, Vec3};

use super::source::{INDEX_BITS, show_number};
use crate::model::asset::Asset;
use crate::model::splat::Splat;
use crate::render::constants;
use crate::render::eye::Eye;
use crate::render::partner::locals;
use crate::render::settings::Settings;
use crate::render::splat::{linear_color, unit_conic};

/// `Record` of `splat.wgsl`: one splat in 88 bytes, in model units.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SplatRecord {
    center_high: [f32; 3],
    center_low: [f32; 3],
    i: [f32; 3],
    j: [f32; 3],
    shape: [f32; 4],
    color: [f32; 3],
    words: [u32; 3],
}

/// `Conic` of `clip.wgsl`, over the unit disc.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ConicRecord {
    p1: [f32; 2],
    p2: [f32; 2],
    p3: [f32; 2],
    rho: f32,
    pad: f32,
}

/// `Partner` of `partner.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PartnerRecord {
    /// Rows of the map to the partner's coordinates.
    rows: [[f32; 4]; 3],
    curvature: [f32; 2],
    outset: f32,
    /// 1 for the last of its group, else 0.
    last: f32,
}

/// `Eye` of `eye.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct EyeRecord {
    right: [f32; 3],
    unit: f32,
    up: [f32; 3],
    near: f32,
    forward: [f32; 3],
    anchor_depth: f32,
    anchor_high: [f32; 3],
    perspective: u32,
    anchor_low: [f32; 3],
    band: f32,
    middle: [f32; 2],
    depth_range: [f32; 2],
    grey_range: [f32; 2],
    show: u32,
    shininess: f32,
    light: [f32; 3],
    ambient: f32,
    background: [f32; 4],
    diffuse: f32,
    specular: f32,
    wrap: f32,
    yielding: f32,
}

const _: () = assert!(size_of::<SplatRecord>() == 88);
const _: () = assert!(size_of::<ConicRecord>() == 32);
const _: () = assert!(size_of::<PartnerRecord>() == 64);
const _: () = assert!(size_of::<EyeRecord>() == 160);

/// A 64-bit point as the sum of two 32-bit ones.
fn split(point: DVec3) -> [[f32; 3]; 2] {
    let high = point.as_vec3();
    [high.to_array(), (point - high.as_dvec3()).as_vec3().to_array()]
}

/// The record of one splat; its conics are appended to the list.
pub fn splat(splat: &Splat, index: usize, has_colors: bool, conics: &mut Vec<ConicRecord>) -> SplatRecord {
    let first = conics.len() as u32;
    conics.extend(splat.clips.iter().map(|clip| {
        let conic = unit_conic(clip, splat.radii);
        let [p1, p2, p3] = [conic.p1, conic.p2, conic.p3].map(|p| p.as_vec2().to_array());
        ConicRecord { p1, p2, p3, rho: conic.rho as f32, pad: 0.0 }
    }));
    let [center_high, center_low] = split(splat.center);
    let (radii, curvature) = (splat.radii.as_vec2(), splat.curvature.as_vec2());
    let color: Vec3 = linear_color(splat, has_colors);
    SplatRecord {
        center_high,
        center_low,
        i: splat.axes.x_axis.as_vec3().to_array(),
        j: splat.axes.y_axis.as_vec3().to_array(),
        shape: [radii.x, radii.y, curvature.x, curvature.y],
        color: color.to_array(),
        words: [
            index as u32 | (constants::tint(splat) as u32) << INDEX_BITS,
            first,
            splat.clips.len() as u32,
        ],
    }
}

/// The first and the number of a splat's partners, which are appended to the list group by group.
pub fn partners(splat: &Splat, partners: &mut Vec<PartnerRecord>) -> [u32; 2] {
    let first = partners.len();
    for group in splat.partners.iter().map(|group| locals(group, splat)) {
        partners.extend(group.iter().zip(1..).map(|(partner, n)| {
            let [i, j, k] = partner.axes.transpose().to_cols_array_2d().map(DVec3::from);
            let row = |row: DVec3, from: f64| row.extend(from).as_vec4().to_array();
            PartnerRecord {
                rows: [row(i, partner.origin.x), row(j, partner.origin.y), row(k, partner.origin.z)],
                curvature: partner.curvature.as_vec2().to_array(),
                outset: partner.outset as f32,
                last: if n == group.len() { 1.0 } else { 0.0 },
            }
        }));
    }
    [first as u32, (partners.len() - first) as u32]
}

impl EyeRecord {
    /// A camera over an asset whose splats all lie within `radius` of the model's origin; `band` and `yielding`
    /// are those of [`constants`].
    pub fn new(
        eye: &Eye,
        asset_radius: f64,
        radius: f64,
        [band, yielding]: [f64; 2],
        settings: &Settings,
    ) -> Self {
        let anchor_depth = eye.to_view(DVec3::ZERO).z.max(0.0);
        let [anchor_high, anchor_low] = split(eye.position + anchor_depth * eye.forward);
        let relative = |range: [f64; 2]| range.map(|depth| (depth - anchor_depth) as f32);
        let light = &settings.light;
        Self {
            right: eye.right.as_vec3().to_array(),
            unit: eye.samples_per_unit().recip() as f32,
            up: eye.up.as_vec3().to_array(),
            near: (eye.near - anchor_depth) as f32,
            forward: eye.forward.as_vec3().to_array(),
            anchor_depth: anchor_depth as f32,
            anchor_high,
            perspective: u32::from(eye.perspective),
            anchor_low,
            band: band as f32,
            middle: eye.middle().as_vec2().to_array(),
            depth_range: relative(eye.depth_range(radius)),
            grey_range: relative(eye.depth_range(asset_radius)),
            show: show_number(settings.show),
            shininess: light.shininess as f32,
            light: DVec3::from(light.direction).normalize().as_vec3().to_array(),
            ambient: light.ambient as f32,
            background: settings.background.map(|byte| f32::from(byte) / 255.0),
            diffuse: light.diffuse as f32,
            specular: light.specular as f32,
            wrap: light.wrap as f32,
            yielding: yielding as f32,
        }
    }
}

/// Radius of a sphere around the model's origin that holds every splat, and whatever deeper place one that
/// gives way takes.
pub fn reach(asset: &Asset) -> f64 {
    let reach = |splat: &Splat| splat.center.length() + splat.bounding_radius();
    let gives_way = constants::YIELD_SHARE * constants::band(asset) / constants::SINE_FLOOR;
    asset.splats.iter().map(reach).fold(0.5 * asset.diagonal, f64::max) + gives_way
}
