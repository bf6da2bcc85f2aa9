//! All measures of one file against its input: the JSON schema `qsplat-measure/1`.

use serde::{Deserialize, Serialize};

/// Name and version of the schema. The number grows when a key changes its meaning or goes;
/// new keys may come without.
pub const SCHEMA: &str = "qsplat-measure/1";

/// Everything that is measured of a file against its input. Distances are fractions of the
/// diagonal of the input's bounding box, angles are degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// [`SCHEMA`].
    pub schema: String,
    /// Diagonal of the input's bounding box, input units.
    pub diagonal: f64,
    /// The bound the file states.
    pub budget: f64,
    /// From each input point along the splat's normal to the quadric of a splat that covers it.
    pub fit: Distances,
    /// Input points that no splat covers.
    pub uncovered: u64,
    /// From samples of the input's surface to the union of the clipped splats.
    pub forward: Distances,
    /// From samples of the clipped splats to the input's surface.
    pub backward: Distances,
    /// Between the splats' normal fields and the input's normals at the same places.
    pub normal: Angles,
    /// Between feature lines and clipped borders, both ways; `None` without feature lines.
    pub edge: Option<Distances>,
    /// Pixels where only one of input and splats is hit.
    pub holes: Holes,
    /// The shaded picture of the splats beside that of the input.
    pub image: Image,
    /// What the file costs.
    pub cost: Cost,
}

/// A set of distances, fractions of the diagonal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distances {
    /// Root mean square.
    pub rms: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

/// A set of angles, degrees in `[0, 180]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Angles {
    /// Root mean square.
    pub rms_deg: f64,
    /// 99th percentile.
    pub p99_deg: f64,
}

/// Pixels where only one of input and splats is hit, away from the input's silhouette, over
/// the 26 orthographic views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Holes {
    /// Pixels where the input is hit and no splat is.
    pub missing: u64,
    /// Pixels where a splat is hit and the input is not.
    pub extra: u64,
    /// Views that have any.
    pub views: u64,
    /// Pixels compared, over all views.
    pub pixels: u64,
}

/// The shaded picture of the splats beside that of the input, means over the views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Mean FLIP of the shaded pictures, in `[0, 1]`.
    pub flip_mean: f64,
    /// 99th percentile of FLIP over the pixels, the greatest over the views.
    pub flip_p99: f64,
    /// Peak signal to noise ratio of all views together, dB; capped at 99 where they are equal.
    pub psnr: f64,
    /// Mean structural similarity.
    pub ssim: f64,
    /// Mean FLIP of the normal pictures.
    pub normal_flip_mean: f64,
}

/// What a file costs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Bytes of the file.
    pub bytes: u64,
    /// Splats.
    pub splats: u64,
    /// Pieces of a plane.
    pub flat: u64,
    /// Pieces of a quadric.
    pub quadric: u64,
    /// Those with at least one clip curve.
    pub clipped: u64,
    /// Bytes of the file for each splat.
    pub bytes_per_splat: f64,
    /// Bytes of the file for each input point.
    pub bytes_per_point: f64,
    /// Sum of the clipped splats' areas over the input's surface area; `None` for a cloud.
    pub overlap: Option<f64>,
    /// Seconds to decode the file, the median of five.
    pub decode_seconds: f64,
    /// Decoded splat records a second, MB.
    pub decode_megabytes_per_second: f64,
    /// Milliseconds to draw one of the views on the CPU reference, the median over the views.
    pub cpu_frame_ms: f64,
    /// Fragments of one of the views, the mean over the views: rays that met a splat.
    pub fragments: f64,
}
