//! Rounds clip curves to the grids, and carries them to the rounded splat first.
//!
//! 1. *Carried.* The curve's plane is mapped to the plane of the rounded splat by the affine
//!    map that is exact for points at the middle height of the splat; an affine map of a
//!    rational curve is that of its control points. Points at other heights differ by at most
//!    `|k x k'|` times half the range of heights; the quantiser holds this below what
//!    [`Quantizer::clip_rounding`] leaves of the share.
//! 2. *Extended.* The rounded ellipse is larger, so the ends no longer lie on its border. The
//!    same conic is taken over the longer span of its parameter that ends on the new border
//!    (blossoming; Farin, *NURBS*, 2nd ed., section 5.5): nothing moves.
//! 3. *Rounded.* With clip step `c`, the ends move along the border by at most half a border
//!    step, `c / sqrt 2`, and the control point by at most half a diagonal, `c / sqrt 2`. A
//!    point of the curve is a convex combination of the three, so it moves by no more. `rho` has
//!    `|x| + |y|` steps for a control point `(x, y)` clip steps from the chord's middle `M`.
//!    Measured in the direction of `P2 - M`, a change of `rho` moves no point of the curve by
//!    more than `|P2 - M| drho` (in affine coordinates with `P1, P3 = (-1,0), (1,0)` and
//!    `P2 = (0,1)` the conic is `k y² = (1-y)² - x²`, `k = ((1-rho)/rho)²`; then
//!    `dy/drho = (1-rho) y² / (rho³ (1 + (k-1) y))` grows with `y`, and is 1 at the top,
//!    `y = rho`). That is at most `c / 2`. Together: `c (1/sqrt 2 + 1/2)`.

use glam::DVec2;

use super::accept::refused;
use super::bound::Moved;
use super::grid::{CONTROL_LIMIT, rho_steps};
use super::homogeneous::Homogeneous;
use super::quantize::Quantizer;
use super::record::{ClipRecord, Record, chord_frame};
use crate::error::Result;
use crate::model::clip_curve::{Conic, turn};
use crate::model::splat::Splat;

/// `P2` may lie this many times the larger radius from the middle of the chord.
pub const CONTROL_RANGE: f64 = 1024.0;

/// How far the curve's own parameter may be carried on to meet the border: half its span.
const LONGEST_EXTENSION: f64 = 0.5;

/// The first span tried when looking for the border.
const SHORTEST_EXTENSION: f64 = 1e-12;

/// A way to the border may lead inward by this part of the ellipse, which covers rounding.
const INWARD: f64 = 1e-6;

/// Halvings that bring a span of the parameter down to rounding.
const HALVINGS: usize = 60;

impl Quantizer {
    /// By how much rounding may move a curve that was carried exactly, model units.
    #[must_use]
    pub fn clip_rounding(&self) -> f64 {
        self.grids.clip() * (std::f64::consts::FRAC_1_SQRT_2 + 0.5)
    }

    /// Clip curves of a splat that is on the grids already.
    pub(super) fn clips_as_they_are(&self, splat: &Splat, record: &Record) -> Result<Vec<ClipRecord>> {
        let conics = splat.clips.iter().map(|clip| clip.conic(splat.radii));
        self.clips(conics, splat, record)
    }

    /// Clip curves carried to the rounded splat.
    pub(super) fn clips_moved(
        &self,
        from: &Splat,
        moved: &Moved,
        record: &Record,
    ) -> Result<Vec<ClipRecord>> {
        let radii = self.grids.radii(record.sizes);
        let conics = from.clips.iter().map(|clip| {
            let conic = clip.conic(from.radii);
            let carry = |p: DVec2| moved.plane() * p + moved.offset();
            let p2 = if clip.is_straight() { 0.5 * (conic.p1 + conic.p3) } else { conic.p2 };
            extended(
                &Conic { p1: carry(conic.p1), p2: carry(p2), p3: carry(conic.p3), rho: conic.rho },
                radii,
            )
        });
        self.clips(conics, from, record)
    }

    /// Rounds and sorts.
    fn clips(
        &self,
        conics: impl Iterator<Item = Conic>,
        splat: &Splat,
        record: &Record,
    ) -> Result<Vec<ClipRecord>> {
        let mut clips = Vec::new();
        for conic in conics {
            clips.extend(self.clip(&conic, splat, record)?);
        }
        clips.sort_unstable();
        Ok(clips)
    }

    /// Rounds one curve; `None` when nothing is left of what it cuts.
    fn clip(&self, conic: &Conic, splat: &Splat, record: &Record) -> Result<Option<ClipRecord>> {
        let count = self.grids.border_steps(record.sizes[0]);
        let radii = self.grids.radii(record.sizes);
        let turn = |p: DVec2| eccentric_turn(p, radii);
        let step = |p: DVec2| (turn(p) * count as f64).round() as u64 % count;
        let (start, end) = (step(conic.p1), step(conic.p3));
        let mut sweep = (end + count - start) % count;
        if sweep == 0 {
            // Ends that round to one: either next to nothing or next to all is cut.
            if (turn(conic.p3) - turn(conic.p1)).rem_euclid(1.0) < 0.5 {
                return Ok(None);
            }
            sweep = count - 1;
        }
        let straight = ClipRecord { rho: 0, start, sweep, control: [0; 2] };
        if conic.rho == 0.0 {
            return Ok(Some(straight));
        }
        let [p1, p3] = self.grids.ends(&straight, record.sizes);
        let arm = conic.p2 - 0.5 * (p1 + p3);
        let [along, across] = chord_frame(p1, p3);
        let steps = (DVec2::new(arm.dot(along), arm.dot(across)) / self.grids.clip()).round();
        let in_range =
            arm.length() <= CONTROL_RANGE * radii.x && steps.abs().max_element() < CONTROL_LIMIT as f64;
        if !in_range {
            return Err(refused(
                splat,
                "has a clip curve whose P2 is farther than 1024 radii from its chord; use the chord",
            ));
        }
        let control = [steps.x as i64, steps.y as i64];
        let rho = (conic.rho * rho_steps(control) as f64).round() as u64;
        Ok(Some(if rho == 0 { straight } else { ClipRecord { rho, start, sweep, control } }))
    }
}

/// The eccentric angle of a point near the border, as a part of a turn in `[0, 1)`.
fn eccentric_turn(point: DVec2, radii: DVec2) -> f64 {
    let unit = point / radii;
    (libm::atan2(unit.y, unit.x) / std::f64::consts::TAU).rem_euclid(1.0)
}

/// The same conic over the span that ends on an ellipse's border near its present ends.
///
/// Where the conic turns back inside before it meets the border, its end goes on along the
/// tangent instead, and `rho` is chosen so that the curve keeps its end tangents and its
/// shoulder. A bake that fits its curves on splats that are rounded already never needs this.
fn extended(conic: &Conic, radii: DVec2) -> Conic {
    if conic.rho <= 0.0 || conic.rho >= 1.0 {
        let (to1, to3) = if conic.rho <= 0.0 { (conic.p3, conic.p1) } else { (conic.p2, conic.p2) };
        let (p1, p3) = (along(to1, conic.p1, radii), along(to3, conic.p3, radii));
        return Conic { p1, p3, ..*conic };
    }
    let hom = Homogeneous::new(conic);
    let (t1, t3) = (hom.border(0.0, radii), hom.border(1.0, radii));
    let mut longer = hom.span(t1.unwrap_or(0.0), t3.unwrap_or(1.0)).unwrap_or(*conic);
    let shoulder = longer.point(0.5);
    if t1.is_none() {
        longer.p1 = along(longer.p2, longer.p1, radii);
    }
    if t3.is_none() {
        longer.p3 = along(longer.p2, longer.p3, radii);
    }
    if t1.is_none() || t3.is_none() {
        longer.rho = rho_through(&longer, shoulder).unwrap_or(longer.rho);
    }
    longer
}

/// The shape for which a conic with these control points passes a point of their triangle.
fn rho_through(conic: &Conic, point: DVec2) -> Option<f64> {
    let area = turn(conic.p1, conic.p2, conic.p3);
    let l1 = turn(point, conic.p2, conic.p3) / area;
    let l2 = turn(conic.p1, point, conic.p3) / area;
    let l3 = turn(conic.p1, conic.p2, point) / area;
    let weight = l2 / (2.0 * (l1 * l3).sqrt());
    (weight > 0.0 && weight.is_finite()).then(|| weight / (1.0 + weight))
}

/// From an end of a curve, on (or back) along the line from `inner` to the border.
fn along(inner: DVec2, end: DVec2, radii: DVec2) -> DVec2 {
    let (p, d) = (end / radii, (end - inner) / radii);
    let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - 1.0);
    let root = (b * b - a * c).max(0.0).sqrt();
    // The root that is nearer to the end, where a = 0 means that the end is all there is.
    let t = if b >= 0.0 { -c / (b + root) } else { (root - b) / a };
    if t.is_finite() { end + t * (end - inner) } else { end }
}

impl Homogeneous {
    /// Whether a point is outside the ellipse; beyond the conic's infinity counts as outside.
    fn outside(&self, t: f64, radii: DVec2) -> bool {
        self.reach(t, radii) > 1.0
    }

    /// The parameter nearest to an end at which the conic crosses the border, if the way there
    /// leads nowhere farther inside than that end.
    fn border(&self, end: f64, radii: DVec2) -> Option<f64> {
        let start = self.outside(end, radii);
        let outward = if end > 0.5 { 1.0 } else { -1.0 };
        let least = self.reach(end, radii).min(1.0) * (1.0 - INWARD);
        let mut span = SHORTEST_EXTENSION;
        while span <= LONGEST_EXTENSION {
            for direction in [outward, -outward] {
                if self.outside(end + direction * span, radii) != start {
                    return Some(self.crossing(end, direction * span, radii));
                }
            }
            if !start && self.reach(end + outward * span, radii) < least {
                return None;
            }
            span *= 1.25;
        }
        None
    }

    /// Halves a span whose two ends lie on different sides of the border.
    fn crossing(&self, end: f64, span: f64, radii: DVec2) -> f64 {
        let start = self.outside(end, radii);
        let (mut low, mut high) = (0.0, span);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.outside(end + middle, radii) == start {
                low = middle;
            } else {
                high = middle;
            }
        }
        end + low
    }
}
