//! Other clip curves for splats, on trial.

use super::clip_curve::ClipCurve;

/// Whoever made some splats, asked whether other clip curves would do.
pub trait Trial {
    /// What follows is about this one of the splats.
    fn turn_to(&mut self, splat: usize);

    /// Whether the splat would do as well if it were cut by these instead. It is not changed.
    fn will_do(&mut self, clips: &[ClipCurve]) -> bool;
}
