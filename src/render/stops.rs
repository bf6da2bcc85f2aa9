//! Whether splats stop rays soon enough: all that looking for faults asks of a picture.
//!
//! A ray is done with the first splat that stops it, whichever that is, and rays that are not asked
//! about cost next to nothing: several times less work than finding what each ray meets first.

use rayon::prelude::*;

use super::eye::Eye;
use super::splat::Caps;
use super::tiles::{Rect, Scene};
use crate::model::asset::Asset;

/// The splats of an asset before an eye.
pub struct Stops<'a> {
    caps: Caps<'a>,
    eye: &'a Eye,
    /// All pixels.
    all: Rect,
    /// Splats with the pixels they may show in, the nearest first: most rays end there.
    order: Vec<(usize, Rect)>,
}

impl<'a> Stops<'a> {
    /// Places splats before an eye.
    #[must_use]
    pub fn new(asset: &Asset, eye: &'a Eye) -> Self {
        let caps = Caps::new(asset, eye);
        let bounds = (0..caps.len()).into_par_iter();
        let bounds = bounds.filter_map(|item| Some((item, Rect::of(&caps.bound(item)?, eye.size))));
        let mut order: Vec<(usize, Rect)> = bounds.collect();
        let depth = |item: usize| eye.to_view(asset.splats[item].center).z;
        order.sort_by(|a, b| depth(a.0).total_cmp(&depth(b.0)));
        Self { caps, eye, all: Rect::whole(eye.size), order }
    }

    /// The pixels that any of the splats may show in, rows from the top.
    #[must_use]
    pub fn touched(&self) -> Vec<bool> {
        let mut touched = vec![false; self.eye.size[0] as usize * self.eye.size[1] as usize];
        for (_, rect) in &self.order {
            rect.samples_in(&self.all, |place, _| touched[place] = true);
        }
        touched
    }

    /// For the ray through the middle of each pixel the view depth at which some splat stops it, if one
    /// does no deeper than the pixel's limit; rows from the top. A limit of minus infinity asks nothing.
    #[must_use]
    pub fn within(&self, limits: &[f64]) -> Vec<Option<f64>> {
        let mut open = limits.to_vec();
        let mut stopped = vec![None; limits.len()];
        for (item, rect) in &self.order {
            rect.samples_in(&self.all, |place, sample| {
                if open[place] == f64::NEG_INFINITY {
                    return;
                }
                let ray = self.eye.ray_through(sample);
                let hit = self.caps.hit(*item, &ray).filter(|hit| hit.depth <= open[place]);
                if let Some(hit) = hit {
                    stopped[place] = Some(hit.depth);
                    open[place] = f64::NEG_INFINITY;
                }
            });
        }
        stopped
    }
}
