//! Where two splats cross.
//!
//! The paper intersects the planes of two discs and compares the segments that the line cuts
//! from both (equations 4 to 13). The same is done here for quadrics, along lines over the
//! smaller of the two: where its height over the other changes sign, inside both ellipses, the
//! two cross. For planes these places lie on the paper's line, in the piece that its segments
//! have in common.

use glam::{DVec2, DVec3};

use crate::model::partner::Sheet;
use crate::model::polyline::nearest_on;
use crate::model::splat::Splat;

/// Lines over the smaller splat, in each of two directions.
const LINES: usize = 24;

/// Steps along each line.
const STEPS: usize = 24;

/// Steps around its rim: the ends of an edge lie there.
const AROUND: usize = 96;

/// Halvings of the step in which a sign changes: to a millionth of the radius.
const HALVINGS: usize = 16;

/// Splats meet within this many error bounds of the line between their surfaces: each may miss
/// the line by a third of one, and at the flattest angle that is still a crease (16 degrees) the
/// place where they cross lies up to four times as far off.
pub(super) const BESIDE: f64 = 3.0;

/// Where two splats meet.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    /// Places on both, never none.
    pub(super) places: Vec<DVec3>,
    /// About how far apart neighbouring ones lie at most, model units.
    pub(super) spacing: f64,
}

/// Where two splats meet at an angle whose cosine is below `agree`; `None` where they do not.
pub(super) fn meeting(pair: [&Splat; 2], agree: f64) -> Option<Meeting> {
    if surely_agree(pair, agree) {
        return None;
    }
    let [a, b] = pair;
    let (small, large) = if b.radii.element_product() < a.radii.element_product() { (b, a) } else { (a, b) };
    let sheet = Sheet::of(large);
    let above = |unit: DVec2| sheet.above(small.surface_point(unit * small.radii));
    let mut places = Vec::new();
    let mut walk = |chain: &[DVec2]| {
        let heights: Vec<f64> = chain.iter().map(|&unit| above(unit)).collect();
        for (n, ends) in heights.windows(2).enumerate().filter(|(_, h)| (h[0] < 0.0) != (h[1] < 0.0)) {
            let unit = crossing(chain[n], chain[n + 1], ends[0] < 0.0, &above);
            places.extend(met(small, large, unit * small.radii, agree));
        }
    };
    for n in 0..LINES {
        let across = (2 * n + 1) as f64 / LINES as f64 - 1.0;
        let half = libm::sqrt(1.0 - across * across);
        let along = |step: usize| half * (2.0 * step as f64 / STEPS as f64 - 1.0);
        walk(&(0..=STEPS).map(|step| DVec2::new(along(step), across)).collect::<Vec<_>>());
        walk(&(0..=STEPS).map(|step| DVec2::new(across, along(step))).collect::<Vec<_>>());
    }
    let around = |n: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * n as f64 / AROUND as f64);
        DVec2::new(cos, sin)
    };
    walk(&(0..=AROUND).map(around).collect::<Vec<_>>());
    let spacing = 2.0 * small.radii.max_element() / LINES as f64;
    (!places.is_empty()).then_some(Meeting { places, spacing })
}

/// Whether no two normals of the splats are so far apart: a cheap test that spares the search.
fn surely_agree([a, b]: [&Splat; 2], agree: f64) -> bool {
    let lean = |splat: &Splat| libm::atan((2.0 * splat.curvature * splat.radii).length());
    let between = libm::acos(a.axes.z_axis.dot(b.axes.z_axis).clamp(-1.0, 1.0));
    between + lean(a) + lean(b) < libm::acos(agree)
}

/// Where the height changes its sign between two places, the first of which lies `below`.
fn crossing(mut from: DVec2, mut to: DVec2, below: bool, above: &dyn Fn(DVec2) -> f64) -> DVec2 {
    for _ in 0..HALVINGS {
        let middle = from.midpoint(to);
        if (above(middle) < 0.0) == below {
            from = middle;
        } else {
            to = middle;
        }
    }
    from.midpoint(to)
}

/// A place of the smaller splat, if the larger one is there too and faces another way.
fn met(small: &Splat, large: &Splat, uv: DVec2, agree: f64) -> Option<DVec3> {
    let place = small.surface_point(uv);
    let there = large.to_local(place).truncate();
    let differ = small.normal(uv).dot(large.normal(there)) < agree;
    (differ && large.ellipse(there) <= 1.0).then_some(place)
}

impl Meeting {
    /// The same with only those places that lie beside an end of a surface, if those are known.
    pub(super) fn beside(mut self, ends: Option<&[[DVec3; 2]]>, max_error: f64) -> Option<Self> {
        if let Some(ends) = ends {
            let reach = BESIDE * max_error;
            self.places
                .retain(|&place| ends.iter().any(|&[a, b]| nearest_on(a, b, place).distance(place) <= reach));
        }
        (!self.places.is_empty()).then_some(self)
    }
}
