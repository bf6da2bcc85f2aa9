//! Everything optional in a file: whether it is there and, if not, why.

use serde::{Deserialize, Serialize};

use super::Origin;
use crate::model::asset::{Asset, Counts};

/// One optional thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Optional {
    /// What: `curvature`, `clips`, `curved_clips`, `partners`, `colors`, `tilt`.
    pub name: String,
    /// Whether the file has it.
    pub present: bool,
    /// Why it was left out; `None` if it is there.
    pub reason: Option<String>,
}

/// All optional things, in a fixed order.
///
/// Without the origin the reasons say what the file alone shows.
#[must_use]
pub fn all(asset: &Asset, counts: &Counts, origin: Option<&Origin>) -> Vec<Optional> {
    let thing = |name: &str, present: bool, reason: &str| Optional {
        name: name.into(),
        present,
        reason: (!present).then(|| reason.into()),
    };
    let partnered = asset.splats.iter().any(|splat| !splat.partners.is_empty());
    vec![
        thing("curvature", counts.flat < counts.splats, no_curvature(origin)),
        thing("clips", counts.clipped > 0, no_clips(origin)),
        thing("curved_clips", counts.curved_clips > 0, no_curved_clips(counts, origin)),
        thing("partners", partnered, no_partners(origin)),
        thing("colors", asset.has_colors, no_colors(origin)),
        thing("tilt", false, "the fit turns each normal until the linear terms of its quadric vanish"),
    ]
}

fn no_curvature(origin: Option<&Origin>) -> &'static str {
    match origin {
        Some(origin) if origin.options.shapes == "flat" => "every splat is flat as asked (--shapes flat)",
        _ => "every splat is flat within the error budget",
    }
}

fn no_clips(origin: Option<&Origin>) -> &'static str {
    match origin {
        None => "no splat is cut; the file does not say whether there were feature lines",
        Some(origin) if origin.options.edges == "none" => "feature lines were turned off (--edges none)",
        Some(origin) if origin.input.feature_edges == 0 => "no feature lines were given or found",
        Some(_) => "no feature line crosses a splat",
    }
}

fn no_curved_clips(counts: &Counts, origin: Option<&Origin>) -> &'static str {
    match origin {
        _ if counts.clipped == 0 => "no splat is cut",
        Some(origin) if origin.options.clips == "partners" => {
            "splats are cut by their partners as asked (--clips partners)"
        }
        Some(origin) if origin.options.clips == "straight" => {
            "every cut is straight as asked (--clips straight)"
        }
        _ => "every cut is straight within the error budget",
    }
}

fn no_partners(origin: Option<&Origin>) -> &'static str {
    match origin {
        Some(origin) if origin.options.clips == "partners" => "no splat meets another across an edge",
        _ => "splats are cut by curves where there are edges (--clips curved)",
    }
}

fn no_colors(origin: Option<&Origin>) -> &str {
    match origin {
        None => "the file has none; it does not say whether the input had any",
        Some(origin) => origin.input.colors_left_out.as_deref().unwrap_or("the bake did not say why"),
    }
}
