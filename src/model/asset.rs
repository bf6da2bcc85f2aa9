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
    /// Pieces of a parabolic cylinder: exactly one curvature is zero.
    pub cylinder: usize,
    /// Pieces of a quadric with two curvatures. With flat ones and cylinders they make all.
    pub quadric: usize,
    /// Those with at least one clip curve or clip partner, of any kind.
    pub clipped: usize,
    /// Clip curves of five numbers.
    pub curved_clips: usize,
    /// Clip curves of two numbers.
    pub straight_clips: usize,
}

impl Counts {
    /// The kinds in words, such as `67 flat, 20 cylinder, 42 quadric`.
    #[must_use]
    pub fn kinds(&self) -> String {
        let Self { flat, cylinder, quadric, .. } = self;
        format!("{flat} flat, {cylinder} cylinder, {quadric} quadric")
    }
}

impl Asset {
    /// Counts the splats by kind.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let mut counts = Counts { splats: self.splats.len(), ..Counts::default() };
        for splat in &self.splats {
            match splat.kind() {
                Kind::Flat => counts.flat += 1,
                Kind::Cylinder => counts.cylinder += 1,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::clip_curve::ClipCurve;
    use glam::{DMat3, DVec2, DVec3};

    #[test]
    fn every_splat_counts_as_one_kind() {
        let splat = |a: f64, b: f64, clips: &[ClipCurve]| Splat {
            center: DVec3::ZERO,
            axes: DMat3::IDENTITY,
            radii: DVec2::ONE,
            curvature: DVec2::new(a, b),
            clips: clips.to_vec(),
            partners: Vec::new(),
            color: [255; 3],
        };
        let cut = [ClipCurve::chord(0.0, 1.0)];
        let splats = vec![
            splat(0.0, 0.0, &[]),
            splat(0.5, 0.0, &[]),
            splat(0.0, -0.5, &cut),
            splat(0.1, 0.1, &[]),
            splat(0.1, -0.1, &[]),
            splat(0.2, 0.1, &cut),
        ];
        let frame = Frame { origin: DVec3::ZERO, exponent: 0 };
        let fit = Accuracy::default();
        let counts = Asset { frame, diagonal: 2.0, max_error: 1e-3, fit, has_colors: false, splats }.counts();
        assert_eq!((counts.flat, counts.cylinder, counts.quadric), (1, 2, 3));
        assert_eq!(counts.flat + counts.cylinder + counts.quadric, counts.splats);
        assert_eq!((counts.clipped, counts.straight_clips), (2, 2));
        assert_eq!(counts.kinds(), "1 flat, 2 cylinder, 3 quadric");
    }
}
