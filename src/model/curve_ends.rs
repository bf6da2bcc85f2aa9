//! Where clip curves end beside those of the next splats.
//!
//! Each of two curves along one line keeps the bound, one a little farther out than the other. Where the one farther
//! out ends, the outline of the surface steps back to the other: enlarged, a feature edge would not be one curve
//! there. No step is where a curve ends inside another splat, which is where the two have crossed before.

use glam::{DVec2, DVec3};

use super::clip_curve::Conic;
use super::splat::Splat;

/// Error bounds that two splats of one sheet may lie apart over a place.
pub const APART: f64 = 2.0;

/// The normals of two splats of one sheet differ by less than this cosine tells, 45°.
const ONE_WAY: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// An end of a clip curve, on its splat's rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// On the splat's surface.
    pub place: DVec3,
    /// That of the surface there.
    pub normal: DVec3,
}

/// The ends of a splat's curves, less those that another of them cuts away: there the outline goes over to that.
pub fn ends<'a>(splat: &'a Splat, conics: &'a [Conic]) -> impl Iterator<Item = End> + 'a {
    let is_cut = |own: usize, uv: DVec2| {
        conics.iter().enumerate().any(|(other, conic)| other != own && conic.cuts(uv))
    };
    let ends = conics.iter().enumerate().flat_map(|(own, conic)| [(own, conic.p1), (own, conic.p3)]);
    let left = ends.filter(move |&(own, uv)| !is_cut(own, uv));
    left.map(|(_, uv)| End { place: splat.surface_point(uv), normal: splat.normal(uv) })
}

/// Where the end of another splat's curve lies over a splat, in its plane; `None` where it does not, or where the two
/// are of different sheets.
#[must_use]
pub fn over(splat: &Splat, end: &End, max_error: f64) -> Option<DVec2> {
    let local = splat.to_local(end.place);
    let uv = local.truncate();
    let is_over = splat.ellipse(uv) <= 1.0
        && (local.z - splat.height(uv)).abs() <= APART * max_error
        && splat.normal(uv).dot(end.normal) > ONE_WAY;
    is_over.then_some(uv)
}

/// By how much the outline steps back at an end of one splat's curve to the outermost of the curves of others, each
/// given with its own; `None` where none of them is there.
pub fn step<'a>(
    end: &End,
    others: impl Iterator<Item = (&'a Splat, &'a [Conic])>,
    max_error: f64,
) -> Option<f64> {
    let steps = others.filter_map(|(splat, conics)| Some(beyond(conics, over(splat, end, max_error)?)));
    steps.min_by(f64::total_cmp)
}

/// How far a place lies beyond curves, by which the outline would step back there; 0 for one that none cuts away.
#[must_use]
pub fn beyond(conics: &[Conic], uv: DVec2) -> f64 {
    let cutting = conics.iter().filter(|conic| conic.cuts(uv));
    cutting.map(|conic| conic.distance(uv, DVec2::ONE)).fold(0.0, f64::max)
}
