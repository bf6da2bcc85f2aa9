//! What is compared: errors against costs.

use super::front::front;
use super::schema::{Case, Model, Outcome, Slope};
use super::slope::log_log_slope;

/// A number of an outcome that a chart has an axis for.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The name in the report.
    pub name: &'static str,
    /// What it is, with its unit, as drawn.
    pub label: &'static str,
    /// Its value, in the unit drawn.
    pub value: fn(&Outcome) -> f64,
}

/// The budget, as the bake was asked to keep it.
pub const BUDGET: Axis = Axis {
    name: "budget",
    label: "error budget, % of the diagonal",
    value: |outcome| 100.0 * outcome.measures.budget,
};

/// The errors that curves are drawn of.
pub const ERRORS: [Axis; 3] = [
    Axis {
        name: "fit_max",
        label: "fit max, % of the diagonal",
        value: |outcome| 100.0 * outcome.measures.fit.max,
    },
    Axis {
        name: "backward_max",
        label: "backward max, % of the diagonal",
        value: |outcome| 100.0 * outcome.measures.backward.max,
    },
    Axis { name: "flip_mean", label: "mean FLIP", value: |outcome| outcome.measures.image.flip_mean },
];

/// The costs that errors are drawn against.
pub const COSTS: [Axis; 3] = [
    Axis { name: "bake_seconds", label: "bake time, s", value: |outcome| outcome.bake_seconds },
    Axis { name: "bytes", label: "file size, kB", value: |outcome| outcome.measures.cost.bytes as f64 / 1e3 },
    Axis { name: "frame_ms", label: "frame time (CPU), ms", value: |outcome| outcome.frame_ms },
];

/// The number of splats, which theory speaks of.
pub const SPLATS: Axis =
    Axis { name: "splats", label: "splats", value: |outcome| outcome.measures.cost.splats as f64 };

/// Exponents of the number of splats against the error: planes, quadrics on a generic smooth
/// surface, quadrics on a sphere.
pub const EXPECTED: [f64; 3] = [-1.0, -2.0 / 3.0, -0.5];

/// Marks the Pareto fronts of a model's cases: every error against every cost.
pub fn mark_fronts(cases: &mut [Case]) {
    for (error, cost) in ERRORS.iter().flat_map(|error| COSTS.iter().map(move |cost| (error, cost))) {
        let pair = |case: &Case| {
            let outcome = case.outcome.as_ref();
            outcome.map_or((f64::NAN, f64::NAN), |outcome| ((cost.value)(outcome), (error.value)(outcome)))
        };
        let pairs: Vec<(f64, f64)> = cases.iter().map(pair).collect();
        for (case, _) in cases.iter_mut().zip(front(&pairs)).filter(|(_, on)| *on) {
            case.fronts.push(front_name(error, cost));
        }
    }
}

/// How a report names the front of an error against a cost.
#[must_use]
pub fn front_name(error: &Axis, cost: &Axis) -> String {
    format!("{}/{}", error.name, cost.name)
}

/// The cases of one variant and effort, which a line joins in a chart.
#[derive(Clone, Debug)]
pub struct Curve<'a> {
    /// `all`, `flat` or `straight`.
    pub variant: &'a str,
    /// 1 to 9.
    pub effort: u8,
    /// Its cases with an outcome, from the largest budget to the smallest.
    pub cases: Vec<&'a Case>,
}

/// The curves of a model in the order of its cases; those without any outcome are left out.
#[must_use]
pub fn curves(cases: &[Case]) -> Vec<Curve<'_>> {
    let mut curves: Vec<Curve<'_>> = Vec::new();
    for case in cases.iter().filter(|case| case.outcome.is_some()) {
        let same = |curve: &&mut Curve<'_>| curve.variant == case.variant && curve.effort == case.effort;
        match curves.iter_mut().find(same) {
            Some(curve) => curve.cases.push(case),
            None => curves.push(Curve { variant: &case.variant, effort: case.effort, cases: vec![case] }),
        }
    }
    for curve in &mut curves {
        let budget = |case: &Case| case.outcome.as_ref().map_or(0.0, |outcome| outcome.measures.budget);
        curve.cases.sort_by(|a, b| budget(b).total_cmp(&budget(a)));
    }
    curves
}

impl Curve<'_> {
    /// The values of two axes over the curve.
    #[must_use]
    pub fn pairs(&self, x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
        let outcomes = self.cases.iter().filter_map(|case| case.outcome.as_ref());
        outcomes.map(|outcome| ((x.value)(outcome), (y.value)(outcome))).collect()
    }

    /// The exponent theory expects of a cost of this curve.
    fn expected(&self, cost: &Axis) -> Option<f64> {
        let counted = [SPLATS.name, "bytes"].contains(&cost.name);
        let shape = if self.variant == "flat" { EXPECTED[0] } else { EXPECTED[1] };
        counted.then_some(shape)
    }
}

/// All fitted exponents of a model's cases.
#[must_use]
pub fn slopes(cases: &[Case]) -> Vec<Slope> {
    let mut slopes = Vec::new();
    for curve in curves(cases) {
        for error in [BUDGET].iter().chain(&ERRORS) {
            for cost in [SPLATS].iter().chain(&COSTS) {
                let slope = log_log_slope(&curve.pairs(error, cost));
                slopes.extend(slope.map(|slope| Slope {
                    variant: curve.variant.into(),
                    effort: curve.effort,
                    error: error.name.into(),
                    cost: cost.name.into(),
                    slope,
                    expected: curve.expected(cost),
                }));
            }
        }
    }
    slopes
}

impl Model {
    /// The fitted exponent of a curve's cost against an error.
    #[must_use]
    pub fn slope(&self, curve: &Curve<'_>, error: &Axis, cost: &Axis) -> Option<&Slope> {
        self.slopes.iter().find(|slope| {
            (slope.variant.as_str(), slope.effort) == (curve.variant, curve.effort)
                && (slope.error.as_str(), slope.cost.as_str()) == (error.name, cost.name)
        })
    }
}
