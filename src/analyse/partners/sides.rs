//! Which side of a partner a splat keeps.

use glam::DVec3;

use crate::model::partner::{Cut, Partner};

/// Places nearer to the partner's surface than this many error bounds lie on neither side of it.
const EITHER: f64 = 2.0;

/// So many places of an edge are looked at.
const LOOKED_AT: usize = 8;

/// What a partner cuts away of a splat that shows these places; `None` if they tell nothing.
///
/// The paper asks on which side of the partner's plane the splat's centre lies (equation 16 and
/// Fig. 6). Here every place that the splat shows has a say, and the nearer it is to the edge the
/// more: with the inverse fourth power of its distance. A splat whose only place is its centre
/// is the paper's.
pub(super) fn cut(seen: &Partner, places: &[DVec3], edge: &[DVec3], max_error: f64) -> Option<Cut> {
    let stride = edge.len().div_ceil(LOOKED_AT);
    let least = EITHER * max_error;
    let mut above = 0.0;
    for &place in places {
        let height = seen.sheet.above(place);
        if height.abs() > least {
            let away = edge.iter().step_by(stride).map(|&other| other.distance_squared(place));
            let nearest = away.fold(f64::INFINITY, f64::min).max(least * least);
            above += height.signum() / (nearest * nearest);
        }
    }
    // Above is where the partner sees: that is kept, so the rest is cut.
    match above {
        above if above > 0.0 => Some(Cut::Unseen),
        above if above < 0.0 => Some(Cut::Seen),
        _ => None,
    }
}
