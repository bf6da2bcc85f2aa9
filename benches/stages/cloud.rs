//! The generated input: a head-like surface of varied curvature, scanned evenly.

use glam::{DVec3, Vec3};
use qsplat::analyse::canonical::mix;
use qsplat::analyse::cloud_normals::{NormalSource, normals};
use qsplat::analyse::distinct::{Distinct, distinct};
use qsplat::analyse::nearest::{Nearest, Search};
use qsplat::model::cloud::Cloud;
use qsplat::{Error, Result};
use rayon::prelude::*;

use crate::harness::scratch;
use crate::head;

/// Seed of the places.
const SEED: u64 = 0x5bd1_e995;

/// How far a place strays from its even one, in spacings: enough that no lattice shows.
const STRAY: f64 = 0.3;

/// The golden angle, radians.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// So many points on the head, the same on every machine, neither normals nor colours.
///
/// Directions follow the golden spiral, each moved at random by up to [`STRAY`] spacings.
pub fn cloud(points: usize) -> Cloud {
    let spacing = (4.0 * std::f64::consts::PI / points as f64).sqrt();
    let positions = (0..points)
        .into_par_iter()
        .map(|n| {
            let z = 1.0 - (2.0 * n as f64 + 1.0) / points as f64;
            let (sin, cos) = libm::sincos(GOLDEN_ANGLE * n as f64);
            let even = DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
            head::point((even + STRAY * spacing * random(n as u64)).normalize()).as_vec3()
        })
        .collect();
    Cloud { positions, ..Cloud::default() }
}

/// A seeded vector in `[-1, 1]³`.
fn random(n: u64) -> DVec3 {
    let value = |axis: u64| (mix(SEED ^ (3 * n + axis)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    DVec3::new(value(0), value(1), value(2))
}

/// The cloud with neighbours and normals, as the stages after those see it.
pub struct Analysed {
    /// The points in canonical order.
    pub points: Distinct,
    /// Their neighbours.
    pub nearest: Nearest,
    /// Their normals.
    pub normals: Vec<Vec3>,
}

/// Sorts the cloud and finds neighbours and normals.
pub fn analysed(points: usize) -> Result<Analysed> {
    let points = distinct(&cloud(points));
    let nearest = Search::new(&points.positions)?.nearest();
    let normals = normals(&points, &nearest, NormalSource::Estimate, None)?.normals;
    Ok(Analysed { points, nearest, normals })
}

/// Writes the cloud as a binary PLY to the build folder; where it is.
pub fn file(points: usize) -> Result<std::path::PathBuf> {
    let path = scratch(&format!("head-{points}.ply"));
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {points}\n\
         property float x\nproperty float y\nproperty float z\nend_header\n"
    )
    .into_bytes();
    for position in cloud(points).positions {
        bytes.extend(position.to_array().into_iter().flat_map(f32::to_le_bytes));
    }
    std::fs::write(&path, bytes).map_err(Error::io(&path))?;
    Ok(path)
}
