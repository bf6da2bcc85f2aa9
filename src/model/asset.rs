//! The asset: all that a `.qsplat` file says.

use super::frame::Frame;
use super::splat::{Kind, Splat};

/// A baked model. The bake half makes it, the show half draws it, the file stores it.
#[derive(Clone, Debug, PartialEq)]
pub struct Asset {
    /// Where the model lies in the input's coordinates.
    pub frame: Frame,
    /// Diagonal of the input's bounding box, in model units: the measure of every relative error.
    pub diagonal: f64,
    /// The error bound the bake kept, in model units: every input point lies within it of a
    /// splat that covers it.
    pub max_error: f64,
    /// The error measured on the decoded splats, in model units.
    pub fit: Accuracy,
    /// Whether the splats' colours mean anything.
    pub has_colors: bool,
    /// The splats, in the order of the file.
    pub splats: Vec<Splat>,
}

/// Distances of the input's points, along the splat's normal `k`, to the quadric of a splat
/// that covers them (`fit` of the project's measures), in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// Root mean square.
    pub rms: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

/// How many splats of each kind an asset has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counts {
    /// All of them.
    pub splats: usize,
    /// Pieces of a plane.
    pub flat: usize,
    /// Pieces of a quadric.
    pub quadric: usize,
    /// Those with at least one clip curve or clip partner, flat or quadric.
    pub clipped: usize,
    /// Clip curves of five numbers.
    pub curved_clips: usize,
    /// Clip curves of two numbers.
    pub straight_clips: usize,
}

impl Asset {
    /// Counts the splats by kind.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let mut counts = Counts { splats: self.splats.len(), ..Counts::default() };
        for splat in &self.splats {
            match splat.kind() {
                Kind::Flat => counts.flat += 1,
                Kind::Quadric => counts.quadric += 1,
            }
            let straight = splat.clips.iter().filter(|clip| clip.is_straight()).count();
            counts.clipped += usize::from(splat.is_clipped());
            counts.straight_clips += straight;
            counts.curved_clips += splat.clips.len() - straight;
        }
        counts
    }
}
