//! The error budget, how it is shared out, and every number that decides a case.
//!
//! The user gives one number, `--max-error`: the largest distance, along the splat's normal,
//! between an input point and a splat that covers it, measured on the file as decoded. Each
//! stage gets a share. Splats are judged against the whole after they are rounded, so what
//! one stage leaves another may use.

/// Share of the budget that the fit may use while a splat grows. What is left takes the
/// rounding to the file's grids, after which the splat is judged against the whole.
pub const FIT_SHARE: f64 = 0.92;

/// Share of the budget that rounding to the file's grids may use, anywhere on a splat.
///
/// Proved per field in `format::quantize`. The bake judges splats after rounding, so there the
/// share is only how coarse the grids may be; it overlaps with that of the fit.
pub const QUANTIZE_SHARE: f64 = 0.6;

/// The same for a splat that is rounded with its clip curves: their bound is proved for small
/// moves. (The bake rounds first and cuts then.)
pub const CLIPPED_QUANTIZE_SHARE: f64 = 0.15;

/// Share of the budget that the fit may use at points on feature lines.
pub const LINE_FIT_SHARE: f64 = 0.3;

/// The same at points on the feature lines of a cloud, of splats that are rounded: as far as curves follow these
/// lines outside them. The lines of a cloud stray from its faces by a fifth of the budget at corners, and rounding may
/// move a large face by a third.
pub const CLOUD_LINE_SHARE: f64 = 0.5;

/// The same where there would be a last resort otherwise: with curves at half a budget outside their lines, which are
/// looked for within nine tenths of one, in space, no more is left for the distance at which splats pass those.
pub const FAR_LINE_SHARE: f64 = 0.75;

/// Clip curves follow their feature line this share of the budget outside it, so that no
/// slit opens between the two surfaces that meet there, each of which may pass the line at a
/// distance. At corners more acute than 74°, and in notches as narrow, they follow it less far outside, so that the
/// tip where two of them meet, rounded, lies within the budget too.
pub const CLIP_OUTSET_SHARE: f64 = 0.5;

/// Share of the budget by which a fitted clip curve may miss the line so moved.
///
/// With the rounding below, a curve lies between 0.1 and 0.9 budgets outside its line.
pub const CLIP_MISS_SHARE: f64 = 0.3;

/// Share of the budget by which rounding may move a clip curve.
pub const CLIP_QUANTIZE_SHARE: f64 = 0.1;

/// A rounded clip curve lies at least this share of the budget outside its line, and at most one whole
/// budget: what outset, miss and rounding leave.
pub const CLIP_LEAST_SHARE: f64 = CLIP_OUTSET_SHARE - CLIP_MISS_SHARE - CLIP_QUANTIZE_SHARE;

/// Where the clip curve of one splat ends beside that of the next along a line, the outline of their side is to step by
/// no more than this share of the budget. Cheapest curves within the budget step by up to nine tenths.
///
/// Files of parts rich in lines are larger for it, the more the less a step may be: that of abc-00000049 by 3.7 % at 0.2,
/// by 7 % at 0.1 and by 11 % at 0.05, that of fandisk by 1.2, 2.6 and 4.3 %.
pub const STEP_SHARE: f64 = 0.2;

/// Share of the budget that a clip partner begins to cut beyond its surface.
///
/// At a feature line both surfaces may miss the line by [`LINE_FIT_SHARE`] of what splats are
/// judged against, one way and the other: two thirds together. Beyond that nothing of the
/// surface is cut. `format-spec.md` states it: a reader must cut at the same place.
pub const PARTNER_OUTSET_SHARE: f64 = 0.75;

/// Tessellations stay within this share of the budget of the surface they stand for, unless
/// another is asked for.
pub const EXPORT_SHARE: f64 = 0.1;

/// Shares of the budget that can be asked for: what strays more than the splats themselves may
/// does not stand for them, and a thousandth is below the rounding to the file's grids.
pub const EXPORT_SHARES: std::ops::RangeInclusive<f64> = 1e-3..=1.0;

/// The coarsest bound at which pictures 512 pixels wide need show neither hole nor excess, as a share of
/// the diagonal of a model that fills them: a pixel, where they show the diagonal at its longest. What
/// stands out by no more lies within the band along a silhouette.
///
/// Splats that may sink farther than they may stand out make files at most 10 % smaller.
pub const COARSEST_CLOSED: f64 = 1.0 / 800.0;

/// Default dihedral angle, degrees, from which a mesh edge is a feature edge.
pub const DEFAULT_EDGE_ANGLE: f64 = 40.0;

/// Default error budget, a fraction of the bounding box's diagonal.
pub const DEFAULT_MAX_ERROR: f64 = 1e-3;
