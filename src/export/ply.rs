//! One binary PLY of all splats.

use std::io::Write;

use rayon::prelude::*;

use super::tessellate::{self, Patch, REMEDY};
use crate::error::{Error, Result};
use crate::model::asset::Asset;
use crate::model::splat::Splat;
use crate::tolerance::EXPORT_SHARES;

/// Triangles of a whole asset, at most: about a gigabyte of PLY.
pub const TRIANGLE_LIMIT: usize = 50_000_000;

/// Splats tessellated at a time: enough to feed every thread, few enough to keep the memory
/// small beside the result.
const BATCH: usize = 4096;

/// Tessellates every splat to a share of the asset's error budget, in the order of the file.
///
/// # Errors
/// [`Error::Usage`] if the share is not one of [`EXPORT_SHARES`], or the distance so small beside
/// the splats that the triangles would pass [`TRIANGLE_LIMIT`]; and for splats cut by clip
/// partners, whose edges no triangle follows yet.
pub fn patches(asset: &Asset, share: f64) -> Result<Vec<Patch>> {
    let distance = checked(share)? * asset.max_error;
    if asset.splats.iter().any(|splat| !splat.partners.is_empty()) {
        return Err(Error::Usage(
            "triangles follow clip curves, not clip partners; bake with --clips curved to export".into(),
        ));
    }
    let mut patches = Vec::with_capacity(asset.splats.len());
    let mut triangles = 0;
    for batch in asset.splats.chunks(BATCH) {
        let made: Vec<Result<Patch>> =
            batch.par_iter().map(|s| tessellate::tessellate(s, distance)).collect();
        for patch in made {
            let patch = patch?;
            triangles += patch.triangles.len();
            patches.push(patch);
        }
        if triangles > TRIANGLE_LIMIT {
            let what = format!("{triangles} triangles and more pass the export's limit of {TRIANGLE_LIMIT}");
            return Err(Error::Usage(format!("{what}; {REMEDY}")));
        }
    }
    Ok(patches)
}

/// A share of the error budget that can be asked for.
///
/// # Errors
/// [`Error::Usage`] if it is not one of [`EXPORT_SHARES`].
pub fn checked(share: f64) -> Result<f64> {
    let (least, most) = (EXPORT_SHARES.start(), EXPORT_SHARES.end());
    if EXPORT_SHARES.contains(&share) {
        Ok(share)
    } else {
        let what = format!("the triangles cannot keep {share} of the error budget");
        Err(Error::Usage(format!("{what}; give a share from {least} to {most}")))
    }
}

/// Tessellates an asset to a share of its error budget and encodes it as [`write()`] does.
///
/// # Errors
/// As [`patches`].
pub fn encode(asset: &Asset, share: f64) -> Result<Vec<u8>> {
    let patches = patches(asset, share)?;
    let mut bytes = Vec::new();
    write(asset, share, &patches, &mut bytes).map_err(|error| Error::Internal(format!("export: {error}")))?;
    Ok(bytes)
}

/// Writes the patches of an asset, made with this share of the budget, as a little-endian PLY.
///
/// Vertices have `x y z` (double, in the input's coordinates), the quadric's unit normal
/// `nx ny nz` (float) and, if the asset has colours, `red green blue`. Faces have
/// `vertex_indices` and `splat`, the number of the splat in the file. Splats share no vertices.
///
/// # Errors
/// Those of the writer.
pub fn write(asset: &Asset, share: f64, patches: &[Patch], out: &mut dyn Write) -> std::io::Result<()> {
    out.write_all(header(asset, share, patches).as_bytes())?;
    for (splat, patch) in asset.splats.iter().zip(patches) {
        write_vertices(asset, splat, patch, out)?;
    }
    let mut first = 0_u32;
    for (number, patch) in patches.iter().enumerate() {
        for triangle in &patch.triangles {
            out.write_all(&[3])?;
            for corner in triangle {
                out.write_all(&(first + corner).to_le_bytes())?;
            }
            out.write_all(&(number as u32).to_le_bytes())?;
        }
        first += patch.points.len() as u32;
    }
    Ok(())
}

fn header(asset: &Asset, share: f64, patches: &[Patch]) -> String {
    let vertices: usize = patches.iter().map(|patch| patch.points.len()).sum();
    let faces: usize = patches.iter().map(|patch| patch.triangles.len()).sum();
    let budget = asset.max_error * asset.frame.scale();
    let colors =
        if asset.has_colors { "property uchar red\nproperty uchar green\nproperty uchar blue\n" } else { "" };
    format!(
        "ply\nformat binary_little_endian 1.0\n\
         comment qsplat export: triangles within {share} of the error budget {budget:e} of the splats\n\
         element vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\n\
         property float nx\nproperty float ny\nproperty float nz\n{colors}\
         element face {faces}\nproperty list uchar int vertex_indices\nproperty int splat\nend_header\n"
    )
}

fn write_vertices(asset: &Asset, splat: &Splat, patch: &Patch, out: &mut dyn Write) -> std::io::Result<()> {
    for &uv in &patch.points {
        let position = asset.frame.to_input(splat.surface_point(uv));
        for coordinate in position.to_array() {
            out.write_all(&coordinate.to_le_bytes())?;
        }
        for coordinate in splat.normal(uv).as_vec3().to_array() {
            out.write_all(&coordinate.to_le_bytes())?;
        }
        if asset.has_colors {
            out.write_all(&splat.color)?;
        }
    }
    Ok(())
}
