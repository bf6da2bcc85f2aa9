//! How to bake: what the user chooses.

use std::fmt;
use std::str::FromStr;

use crate::analyse::cloud_normals::NormalSource;
use crate::fit::clip::Clips;
use crate::fit::pose::Shapes;
use crate::model::polyline::Polylines;
use crate::tolerance::{DEFAULT_EDGE_ANGLE, DEFAULT_MAX_ERROR};

/// Where the feature lines come from.
#[derive(Clone, Debug, Default)]
pub enum Edges {
    /// Found: on a mesh by dihedral angle and border, in a cloud by the planes on both sides.
    #[default]
    Auto,
    /// No feature lines; a mesh's borders still end its surface.
    None,
    /// Given, in input coordinates.
    Given(Polylines),
}

/// An error budget as the user states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaxError {
    /// Fraction of the bounding box's diagonal.
    Relative(f64),
    /// In the input's units.
    Absolute(f64),
}

impl Default for MaxError {
    fn default() -> Self {
        Self::Relative(DEFAULT_MAX_ERROR)
    }
}

impl fmt::Display for MaxError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            // Percents are read back as they were written: ten digits hide the scaling's rounding.
            Self::Relative(share) => write!(out, "{}%", (share * 1e12).round() / 1e10),
            Self::Absolute(units) => write!(out, "{units}"),
        }
    }
}

impl FromStr for MaxError {
    type Err = String;

    /// A percentage of the diagonal, `0.1%`, or a length in the input's units, `0.002`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (number, relative) = match text.strip_suffix('%') {
            Some(number) => (number, true),
            None => (text, false),
        };
        let value: f64 = number.trim().parse().map_err(|_| {
            "give a percentage of the diagonal, such as 0.1%, or a length in the input's units, such as 0.002"
                .to_owned()
        })?;
        let positive = value > 0.0 && value.is_finite();
        match (positive, relative) {
            (false, _) => Err("the greatest error must be positive and finite".into()),
            (true, true) if value > 100.0 => Err("more than 100% of the diagonal bounds nothing".into()),
            (true, true) => Ok(Self::Relative(value / 100.0)),
            (true, false) => Ok(Self::Absolute(value)),
        }
    }
}

/// What to do with the input's normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normals {
    /// Keep them where they are sound, else estimate.
    #[default]
    Auto,
    /// Keep them; an input without sound normals is an error.
    Keep,
    /// Estimate them from the positions.
    Estimate,
}

impl From<Normals> for NormalSource {
    fn from(normals: Normals) -> Self {
        match normals {
            Normals::Auto => Self::Auto,
            Normals::Keep => Self::Keep,
            Normals::Estimate => Self::Estimate,
        }
    }
}

/// What to do with the input's colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colors {
    /// Keep them if the input has any that differ.
    #[default]
    Auto,
    /// Keep them; an input without colours is an error.
    Keep,
    /// Leave them out.
    Drop,
}

/// What the facets of a mesh stand for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Meaning {
    /// Themselves: the error bound holds against them.
    #[default]
    Facets,
    /// A smooth surface through the vertices, at right angles to their normals: the error bound
    /// holds against that. Normals that the file does not give are those of the faces around.
    Smooth,
    /// A smooth surface where the file's normals, or without them the angles between the facets,
    /// say so; else themselves.
    Auto,
}

/// What becomes of places where pictures of the splats show more or less than the input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Holes {
    /// Holes that pictures 512 pixels wide from the 26 directions of the cube show of a mesh, or of the surface
    /// that a cloud tells of, and what they show beside the outline, are mended as far as splats within the
    /// bound can do without. A bound wider than a pixel of these is narrowed, that of a cloud too unless its
    /// noise is above a sixth of that, and of a slender mesh one wider than two pixels of the views along it. For clouds whose points lie much closer than the pixels or some
    /// pixels apart, and where partners cut, it is narrowed alone.
    #[default]
    Close,
    /// The bound alone rules.
    Leave,
}

/// How to bake.
#[derive(Clone, Debug)]
pub struct Options {
    /// The error bound.
    pub max_error: MaxError,
    /// Where the feature lines come from.
    pub edges: Edges,
    /// Dihedral angle, degrees, from which a mesh edge or a crease of a cloud is a feature edge under
    /// [`Edges::Auto`].
    pub edge_angle: f64,
    /// What a mesh's facets stand for.
    pub meaning: Meaning,
    /// Whether a cloud's points are smoothed where they scatter by more than a sixth of the error bound:
    /// it then holds against the smoothed points. Otherwise a cloud that scatters by more than a third is
    /// refused.
    pub denoise: bool,
    /// 1 (fastest) to 9 (fewest bytes).
    pub effort: u8,
    /// What to do with normals.
    pub normals: Normals,
    /// What to do with colours.
    pub colors: Colors,
    /// What splats may be pieces of; less than all is for comparison, at the same guarantees.
    pub shapes: Shapes,
    /// What splats may be cut by; less than all is for comparison, at the same guarantees.
    pub clips: Clips,
    /// What becomes of holes that pictures of the splats show.
    pub holes: Holes,
    /// Whether to find out how little any cover by the same candidates could cost. It changes nothing
    /// about the splats.
    pub lower_bound: bool,
}

/// Between the fastest bake and the fewest bytes.
pub const DEFAULT_EFFORT: u8 = 5;

impl Default for Options {
    fn default() -> Self {
        Self {
            max_error: MaxError::default(),
            edges: Edges::default(),
            edge_angle: DEFAULT_EDGE_ANGLE,
            meaning: Meaning::default(),
            denoise: false,
            effort: DEFAULT_EFFORT,
            normals: Normals::default(),
            colors: Colors::default(),
            shapes: Shapes::default(),
            clips: Clips::default(),
            holes: Holes::default(),
            lower_bound: false,
        }
    }
}
