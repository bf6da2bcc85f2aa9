//! All measures of one file against its input: the JSON schema `qsplat-measure/1`.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Name and version of the schema. The number grows when a key changes its meaning or goes;
/// new keys may come without.
pub const SCHEMA: &str = "qsplat-measure/1";

/// [`Measures::kind`] of a mesh.
pub const MESH: &str = "mesh";
/// [`Measures::kind`] of a cloud.
pub const CLOUD: &str = "cloud";

/// Everything that is measured of a file against its input. Distances are fractions of the
/// diagonal of the input's bounding box, angles are degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// [`SCHEMA`].
    pub schema: String,
    /// Diagonal of the input's bounding box, input units.
    pub diagonal: f64,
    /// `mesh` or `cloud`: what the input is.
    pub kind: String,
    /// The bound the file states.
    pub budget: f64,
    /// Points of a cloud that belong to no surface: no other measure knows of them.
    #[serde(default)]
    pub outliers: u64,
    /// From each input point along the splat's normal to the quadric of a splat that covers it.
    pub fit: Distances,
    /// Input points, outliers aside, that no splat covers. The bake covers every one.
    pub uncovered: u64,
    /// From samples of the input's surface to the union of the clipped splats.
    pub forward: Distances,
    /// From samples of the clipped splats to the input's surface.
    pub backward: Distances,
    /// Between the splats' normal fields and the input's normals at the same places.
    pub normal: Angles,
    /// Between feature lines and clipped borders, both ways; `None` without feature lines.
    pub edge: Option<Distances>,
    /// Steps of the outline where clip curves end; `None` where clip partners cut.
    #[serde(default)]
    pub steps: Option<Steps>,
    /// Pixels where only one of input and splats is hit.
    pub holes: Holes,
    /// The shaded picture of the splats beside that of the input.
    pub image: Image,
    /// The same, view by view.
    pub views: Vec<ViewMeasures>,
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
    /// A place where it is the largest, input units; `None` where nothing was measured.
    pub at: Option<[f64; 3]>,
}

/// Steps of the outline where the clip curve of one splat ends beside that of the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Steps {
    /// Ends of clip curves that the outline goes through.
    pub ends: u64,
    /// Those at which it steps by more than [`STEP_SHARE`](crate::tolerance::STEP_SHARE) of the bound.
    pub uneven: u64,
    /// The largest step, a fraction of the diagonal.
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
    /// Pixels where both are hit, the splats far behind: a hole in a closed surface shows its far
    /// side. In neither number above.
    pub through: u64,
    /// Views with pixels that are missing or extra.
    pub views: u64,
    /// Pixels compared, over all views.
    pub pixels: u64,
}

/// The shaded picture of the splats beside that of the input: of one view, or means over the views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// Mean FLIP of the shaded pictures, in `[0, 1]`.
    pub flip_mean: f64,
    /// 99th percentile of FLIP over the pixels; of all views the greatest.
    pub flip_p99: f64,
    /// Peak signal to noise ratio, of all views together, dB; capped at 99 where they are equal.
    pub psnr: f64,
    /// Mean structural similarity.
    pub ssim: f64,
    /// Mean FLIP of the normal pictures.
    pub normal_flip_mean: f64,
}

/// One view: the numbers of [`Holes`] and [`Image`] before they are summed up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ViewMeasures {
    /// Where it looks from, such as `right-top-front` for `(1, 1, 1)`.
    pub name: String,
    /// See [`Holes`].
    pub missing: u64,
    /// See [`Holes`].
    pub extra: u64,
    /// See [`Holes`].
    pub through: u64,
    /// See [`Holes`].
    pub pixels: u64,
    /// Of this view alone.
    #[serde(flatten)]
    pub image: Image,
}

/// What a file costs. Times are medians of at least five.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Bytes of the file.
    pub bytes: u64,
    /// Bytes of header, of what stands before each chunk, and of the checksum; with the chunks' coded bytes
    /// they make all.
    pub head_bytes: u64,
    /// The chunks in the order of the file.
    pub chunks: Vec<Chunk>,
    /// Splats.
    pub splats: u64,
    /// Pieces of a plane.
    pub flat: u64,
    /// Pieces of a parabolic cylinder: exactly one curvature is zero.
    pub cylinder: u64,
    /// Pieces of a quadric with two curvatures.
    pub quadric: u64,
    /// Those with at least one clip curve or clip partner, of any kind.
    pub clipped: u64,
    /// Points of the input, as read.
    pub input_points: u64,
    /// Bytes of the file for each splat.
    pub bytes_per_splat: f64,
    /// Bytes of the file for each input point.
    pub bytes_per_point: f64,
    /// Sum of the clipped splats' areas over the input's surface area; `None` for a cloud.
    pub overlap: Option<f64>,
    /// Seconds to decode the file, the median of five.
    pub decode_seconds: f64,
    /// Bytes of all chunks, decoded, for each of those seconds, in MB (10^6).
    pub decode_megabytes_per_second: f64,
    /// Milliseconds to draw a view on the CPU reference, one sample a pixel, the median over
    /// seven views.
    pub cpu_frame_ms: f64,
    /// Threads that drew them.
    pub threads: u64,
    /// The same on a graphics device; `None` where none was asked for.
    pub gpu: Option<GpuFrame>,
    /// Fragments of one of the views, the mean over the views: rays that met a splat, once for
    /// each splat met.
    pub fragments: f64,
}

/// One chunk of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Chunk {
    /// Its four characters.
    pub name: String,
    /// Bytes decoded.
    pub raw_bytes: u64,
    /// Bytes in the file.
    pub coded_bytes: u64,
}

/// Drawing on a graphics device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GpuFrame {
    /// Name of the adapter.
    pub adapter: String,
    /// Milliseconds from the call until the picture is back in memory, one sample a pixel, the
    /// median over seven views.
    pub frame_ms: f64,
}

/// Bounds that a mesh may lie off the splats' surfaces between its vertices.
pub const FORWARD_BUDGETS: f64 = 2.0;

/// Bounds that the splats' surfaces may stray from the input's: the rim of a splat may lie
/// outside all it covers.
pub const BACKWARD_BUDGETS: f64 = 2.0;

impl Measures {
    /// What breaks a promise, one sentence each; empty where all is kept.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let distances = [
            ("fit max", self.fit, self.budget),
            ("backward max", self.backward, BACKWARD_BUDGETS * self.budget),
        ];
        // Between the points of a cloud its surface is a guess, and its lines are only found.
        let of_mesh = [
            ("forward max", self.forward, FORWARD_BUDGETS * self.budget),
            ("edge max", self.edge.unwrap_or_default(), self.budget),
        ];
        let more = if self.kind == MESH { &of_mesh[..] } else { &[] };
        for &(name, Distances { max, at, .. }, limit) in distances.iter().chain(more) {
            if max.is_nan() || max > limit {
                let place = at.map(|at| format!(", at {}", self.place(at))).unwrap_or_default();
                faults.push(format!("{name} is {max:.3e} of the diagonal, more than {limit:.3e}{place}"));
            }
        }
        for (name, pixels) in [("missing", self.holes.missing), ("extra", self.holes.extra)] {
            if pixels > 0 {
                faults.push(format!("{pixels} pixels are {name}"));
            }
        }
        if self.uncovered > 0 {
            faults.push(format!("{} points of the {} are not covered", self.uncovered, self.kind));
        }
        faults
    }

    /// A place for people, to a millionth of the diagonal.
    #[must_use]
    pub fn place(&self, [x, y, z]: [f64; 3]) -> String {
        let magnitude = if self.diagonal > 0.0 { libm::log10(self.diagonal).floor() } else { 0.0 };
        let decimals = (6.0 - magnitude).clamp(0.0, MOST_DECIMALS) as usize;
        format!("({x:.decimals$}, {y:.decimals$}, {z:.decimals$})")
    }

    /// The measures as indented JSON, ending in a line break.
    ///
    /// # Errors
    /// [`Error::Internal`] if they cannot be written, which no finite numbers cause.
    pub fn json(&self) -> Result<String> {
        let json = serde_json::to_string_pretty(self);
        json.map(|text| text + "\n").map_err(|error| Error::Internal(format!("measures: {error}")))
    }
}

/// Decimals of a place for people are at most these: of smaller models JSON tells every digit.
const MOST_DECIMALS: f64 = 20.0;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
