//! Other clip curves for splats, on trial.

use super::clip_curve::ClipCurve;

/// Whoever made some splats, asked whether other clip curves would do.
pub trait Trial {
    /// What follows is about this one of the splats.
    fn turn_to(&mut self, splat: usize);

    /// By how much the outline of the surface would step, in sum, where these curves of the splat and those of the
    /// splats beside it end, in model units.
    fn steps(&self, clips: &[ClipCurve]) -> f64;

    /// Whether the splat would do as well if it were cut by these instead. It is not changed.
    fn will_do(&mut self, clips: &[ClipCurve]) -> bool;

    /// The splat is cut by these from now on, as those after it are to know.
    fn take(&mut self, clips: Vec<ClipCurve>);
}
