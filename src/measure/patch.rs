//! A splat as a surface: the quadric over its clipped domain.

use glam::{DVec2, DVec3};

use super::area::area;
use super::border::border;
use super::feet;
use super::segment::Segment;
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// A splat, its clip curves and its border, ready for many questions.
#[derive(Clone, Debug)]
pub(super) struct Patch<'a> {
    pub(super) splat: &'a Splat,
    conics: Vec<Conic>,
    /// The border; empty if nothing is left of the splat.
    pub(super) border: Vec<Segment>,
    /// Area in squared model units.
    pub(super) area: f64,
    /// Corners of the box around the patch in splat coordinates.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

/// Factor that keeps a place of the rim inside the domain when it is rounded.
const ON_RIM: f64 = 1.0 - 1e-12;

/// A place of a patch and its distance from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    pub(super) uv: DVec2,
    pub(super) distance: f64,
}

impl<'a> Patch<'a> {
    /// Takes a splat's border apart.
    pub(super) fn new(splat: &'a Splat) -> Self {
        let conics = splat.conics();
        let pieces = border(splat, &conics);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for piece in &pieces {
            let corner = if piece.conic.rho > 0.0 { piece.conic.p2 } else { piece.conic.p1 };
            for corner in [piece.conic.p1, corner, piece.conic.p3] {
                (low, high) = (low.min(corner), high.max(corner));
            }
        }
        (low, high) = (low.max(-splat.radii), high.min(splat.radii));
        let (below, above) = heights(splat, low, high);
        Self {
            splat,
            area: area(splat, &pieces) * left(splat),
            border: pieces.iter().map(|piece| Segment::new(splat, piece)).collect(),
            conics,
            low: low.extend(below),
            high: high.extend(above),
        }
    }

    /// Whether a place lies in the ellipse and is not cut away.
    pub(super) fn covers(&self, uv: DVec2) -> bool {
        self.splat.ellipse(uv) <= 1.0
            && !self.conics.iter().any(|conic| conic.cuts(uv))
            && !self.splat.partners_cut(uv)
    }

    /// Places of the patch about a step from one of its own.
    ///
    /// Steps over the rim end on it: what stands out does so the farthest there.
    pub(super) fn around(&self, uv: DVec2, step: f64) -> impl Iterator<Item = DVec2> {
        let side = [-1.0, 0.0, 1.0];
        let ways = side.into_iter().flat_map(move |x| side.into_iter().map(move |y| DVec2::new(x, y)));
        ways.filter_map(move |way| {
            let to = uv + step * way;
            let beyond = self.splat.ellipse(to).sqrt();
            let to = if beyond > 1.0 { to * (ON_RIM / beyond) } else { to };
            (to != uv && self.covers(to)).then_some(to)
        })
    }

    /// A box around the patch in model units; `None` if nothing is left of it.
    pub(super) fn bounds(&self) -> Option<(DVec3, DVec3)> {
        if self.border.is_empty() {
            return None;
        }
        let axes = self.splat.axes;
        let middle = self.splat.to_model(0.5 * (self.low + self.high));
        let half = 0.5 * (self.high - self.low);
        let across = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        Some((middle - across, middle + across))
    }

    /// The place nearest to a point of model space, if it is nearer than `within`.
    ///
    /// It is a foot of a normal inside the domain or lies on the border.
    pub(super) fn nearest(&self, point: DVec3, within: f64) -> Option<Foot> {
        let p = self.splat.to_local(point);
        let outside = (self.low - p).max(p - self.high).max(DVec3::ZERO);
        if self.border.is_empty() || outside.length() >= within {
            return None;
        }
        let curvature = self.splat.curvature;
        let mut best = Foot { uv: DVec2::ZERO, distance: within };
        for uv in feet::nearest(p, curvature) {
            if self.covers(uv) {
                let foot = self.foot(p, uv);
                return (foot.distance < within).then_some(foot);
            }
        }
        for segment in &self.border {
            if segment.least(p) < best.distance {
                let (uv, distance) = segment.nearest(curvature, p);
                if distance < best.distance && !self.splat.partners_cut(uv) {
                    best = Foot { uv, distance };
                }
            }
        }
        for uv in feet::others(p, curvature, best.distance) {
            let foot = self.foot(p, uv);
            if foot.distance < best.distance && self.covers(uv) {
                best = foot;
            }
        }
        (best.distance < within).then_some(best)
    }

    fn foot(&self, p: DVec3, uv: DVec2) -> Foot {
        Foot { uv, distance: uv.extend(self.splat.height(uv)).distance(p) }
    }
}

/// Places across a splat, each way, that tell how much of it partners leave.
const ACROSS: u32 = 48;

/// About which share of a splat its partners leave: exact where there are none. Their cuts are no
/// curves of the border, which goes on through what they cut away.
fn left(splat: &Splat) -> f64 {
    if splat.partners.is_empty() {
        return 1.0;
    }
    let at = |n: u32| f64::from(2 * n + 1) / f64::from(ACROSS) - 1.0;
    let places = (0..ACROSS).flat_map(|x| (0..ACROSS).map(move |y| DVec2::new(at(x), at(y)) * splat.radii));
    let kept =
        |uv: &DVec2| splat.ellipse(*uv) <= 1.0 && !splat.clips.iter().any(|clip| clip.cuts(*uv, splat.radii));
    let places: Vec<DVec2> = places.filter(kept).collect();
    let shown = places.iter().filter(|&&uv| !splat.partners_cut(uv)).count();
    shown as f64 / places.len().max(1) as f64
}

/// Least and greatest height of the quadric over a box.
fn heights(splat: &Splat, low: DVec2, high: DVec2) -> (f64, f64) {
    let most = low.abs().max(high.abs());
    let least = DVec2::ZERO.clamp(low.min(high), high.max(low)).abs();
    let (near, far) = (splat.curvature * least * least, splat.curvature * most * most);
    (near.min(far).element_sum(), near.max(far).element_sum())
}
