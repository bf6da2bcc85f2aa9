//! A bake with what is promised of it, in its bounds.

use std::fmt;

use qsplat::bake::{Options, Silent, feature_lines, meant};
use qsplat::deliver::{Delivery, deliver, model};
use qsplat::ingest::Input;
use qsplat::measure::edge::edge;
use qsplat::measure::input_surface::InputSurface;
use qsplat::measure::surface::surface;

/// The rim may stray this many bounds.
const RIM: f64 = 2.0;

/// Greatest distances, in error bounds.
pub struct Measured {
    splats: usize,
    bytes: usize,
    fit: f64,
    forward: f64,
    backward: f64,
    /// `None` where the surface has no feature line.
    edge: Option<f64>,
}

impl Measured {
    /// Whether there was any line to follow.
    pub fn has_edge(&self) -> bool {
        self.edge.is_some()
    }

    /// What breaks a promise.
    pub fn faults(&self) -> Vec<String> {
        let edge = self.edge.map(|edge| ("edge", edge, 1.0));
        let all = [("fit", self.fit, 1.0), ("forward", self.forward, 1.0), ("backward", self.backward, RIM)];
        // A distance that is no number keeps no bound.
        let broken = all.into_iter().chain(edge).filter(|(_, value, limit)| value > limit || value.is_nan());
        broken.map(|(what, value, limit)| format!("{what} is {value:.3} of {limit} bounds")).collect()
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { splats, bytes, fit, forward, backward, edge } = self;
        let edge = edge.map_or("none".to_owned(), |edge| format!("{edge:.3}"));
        write!(
            f,
            "{splats} splats, {bytes} bytes, in bounds fit {fit:.3}, forward {forward:.3}, \
             backward {backward:.3}, edge {edge}"
        )
    }
}

/// Bakes a mesh and measures it, on the file as decoded, against the lines it was baked with.
pub fn measured(input: &Input, options: &Options) -> (Delivery, Measured) {
    let delivery = deliver(input, options, &mut Silent).unwrap();
    let asset = &delivery.asset;
    assert_eq!(asset.frame, input.cloud().frame, "a mesh keeps its frame");
    let meant = meant(input, options, asset.max_error).unwrap();
    let lines =
        feature_lines(&meant.input, &meant.edges, meant.noise, options.edge_angle, asset.max_error).unwrap();
    let edge = lines.and_then(|lines| edge(asset, &lines)).map(|edge| edge.max / asset.max_error);
    let errors = surface(asset, &InputSurface::new(model(&meant.input)).unwrap()).unwrap();
    let measured = Measured {
        splats: asset.splats.len(),
        bytes: delivery.bytes.len(),
        fit: asset.fit.max / asset.max_error,
        forward: errors.forward.max / asset.max_error,
        backward: errors.backward.max / asset.max_error,
        edge,
    };
    (delivery, measured)
}
