//! Clouds drawn from known surfaces, and what baked splats cover.

use glam::{DVec2, DVec3, Vec3};
use qsplat::bake::{Edges, MaxError, Normals, Options, Silent};
use qsplat::deliver::{Delivery, deliver};
use qsplat::ingest::Input;
use qsplat::model::cloud::Cloud;
use qsplat::model::frame::Frame;
use qsplat::model::splat::Splat;

/// Numbers in `[0, 1)` that look random and are the same each time (SplitMix64).
pub struct Draw(pub u64);

impl Draw {
    pub fn one(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in `[-1, 1)`.
    pub fn both(&mut self) -> f64 {
        2.0 * self.one() - 1.0
    }

    /// A place on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        let (z, angle) = (self.both(), self.one() * std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * angle.cos(), r * angle.sin(), z)
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for n in (1..items.len()).rev() {
            items.swap(n, (self.one() * (n + 1) as f64) as usize);
        }
    }
}

/// A cloud of places in input units.
pub fn cloud(places: &[DVec3], normals: &[DVec3]) -> Cloud {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &place in places {
        (low, high) = (low.min(place), high.max(place));
    }
    let frame = Frame::of_box(low, high);
    Cloud {
        frame,
        positions: places.iter().map(|&place| frame.to_model(place).as_vec3()).collect(),
        normals: normals.iter().map(|normal| normal.as_vec3()).collect(),
        ..Cloud::default()
    }
}

pub fn options(max_error: MaxError) -> Options {
    Options {
        max_error,
        edges: Edges::Auto,
        edge_angle: 40.0,
        effort: 3,
        normals: Normals::Auto,
        colors: qsplat::bake::Colors::Auto,
        ..Options::default()
    }
}

pub fn bake(cloud: &Cloud, options: &Options) -> Delivery {
    deliver(&Input::Cloud(cloud.clone()), options, &mut Silent).unwrap()
}

/// Whether a splat covers a place (model units) within a distance along its normal.
pub fn covers(splat: &Splat, place: DVec3, within: f64) -> bool {
    let local = splat.to_local(place);
    let uv = local.truncate();
    let inside = splat.ellipse(uv) <= 1.0 && !splat.clips.iter().any(|clip| clip.cuts(uv, splat.radii));
    inside && (local.z - splat.height(uv)).abs() <= within
}

/// Places on a splat's surface that are not cut away, its rim among them.
pub fn surface(splat: &Splat) -> impl Iterator<Item = DVec3> + '_ {
    (0..=12).flat_map(|ring| (0..48).map(move |step| (ring, step))).filter_map(move |(ring, step)| {
        let angle = f64::from(step) * std::f64::consts::TAU / 48.0;
        let uv = f64::from(ring) / 12.0 * splat.radii * DVec2::from_angle(angle);
        let cut = splat.clips.iter().any(|clip| clip.cuts(uv, splat.radii));
        (!cut).then(|| splat.to_model(uv.extend(splat.height(uv))))
    })
}

/// How many of some places (model units) no splat covers within a distance.
pub fn bare(delivery: &Delivery, places: &[Vec3], within: f64) -> usize {
    let splats = &delivery.asset.splats;
    places.iter().filter(|p| !splats.iter().any(|splat| covers(splat, p.as_dvec3(), within))).count()
}
