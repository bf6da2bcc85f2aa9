//! The tables of the page: settings, and fitted exponents.

use std::fmt::Write as _;

use super::axis::{self, BUDGET, COSTS, Curve, ERRORS, SPLATS, front_name};
use super::schema::{Case, Model, Outcome};
use crate::report::page::escape;

/// A column of the table of settings: head, unit or explanation, value.
type Column = (&'static str, &'static str, fn(&Outcome) -> String);

const COLUMNS: [Column; 15] = [
    ("bake", "s", |o| significant(o.bake_seconds)),
    ("bytes", "", |o| grouped(o.measures.cost.bytes)),
    ("splats", "", |o| grouped(o.measures.cost.splats)),
    ("flat", "", |o| grouped(o.measures.cost.flat)),
    ("cylinder", "", |o| grouped(o.measures.cost.cylinder)),
    ("clipped", "", |o| grouped(o.measures.cost.clipped)),
    ("B/splat", "", |o| format!("{:.1}", o.measures.cost.bytes_per_splat)),
    ("fit max", "budgets", |o| format!("{:.2}", budgets(o, o.measures.fit.max))),
    ("forward max", "budgets", |o| format!("{:.2}", budgets(o, o.measures.forward.max))),
    ("backward max", "budgets", |o| format!("{:.2}", budgets(o, o.measures.backward.max))),
    ("edge max", "budgets", |o| {
        o.measures.edge.map_or_else(|| "–".into(), |edge| format!("{:.2}", budgets(o, edge.max)))
    }),
    ("normal rms", "degrees", |o| format!("{:.2}", o.measures.normal.rms_deg)),
    ("holes", "missing, extra, through", |o| {
        let holes = &o.measures.holes;
        [holes.missing, holes.extra, holes.through].map(grouped).join(", ")
    }),
    ("FLIP", "mean", |o| format!("{:.4}", o.measures.image.flip_mean)),
    ("frame", "ms, CPU", |o| significant(o.frame_ms)),
];

fn budgets(outcome: &Outcome, distance: f64) -> f64 {
    if outcome.measures.budget > 0.0 { distance / outcome.measures.budget } else { 0.0 }
}

/// Three digits that matter.
pub(super) fn significant(value: f64) -> String {
    if value > 0.0 && value.is_finite() {
        let digits = (2 - libm::log10(value).floor() as i32).max(0) as usize;
        format!("{value:.digits$}")
    } else {
        value.to_string()
    }
}

/// Digits in groups of three, apart by narrow spaces that keep a number on one line.
pub(super) fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// The table of settings, a row each.
pub(super) fn settings(model: &Model) -> String {
    let heads: String = COLUMNS
        .iter()
        .map(|(name, unit, _)| format!("<th>{name}<small>{}</small></th>", escape(unit)))
        .collect();
    let rows: String = model.cases.iter().map(row).collect();
    format!(
        "<table class=\"settings\">\n<thead><tr><th>splats</th><th>budget</th><th>effort</th>{heads}\
         <th>Pareto front<small>fit max against</small></th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn row(case: &Case) -> String {
    let setting = format!(
        "<td>{}</td><td>{}</td><td>{}</td>",
        escape(variant_name(&case.variant)),
        escape(&percent(&case.max_error)),
        case.effort
    );
    match (&case.outcome, &case.failure) {
        (Some(outcome), _) => {
            let cells: String =
                COLUMNS.iter().map(|(.., value)| format!("<td>{}</td>", value(outcome))).collect();
            let on: Vec<&str> = [("bake_seconds", "time"), ("bytes", "bytes"), ("frame_ms", "frame")]
                .into_iter()
                .filter(|(cost, _)| on_front(case, &ERRORS[0], cost))
                .map(|(_, word)| word)
                .collect();
            let (class, words) = (if on.is_empty() { "" } else { " class=\"front\"" }, on.join(", "));
            format!("<tr{class}>{setting}{cells}<td>{words}</td></tr>\n")
        }
        (None, failure) => {
            let why = escape(failure.as_deref().unwrap_or("no outcome"));
            let width = COLUMNS.len() + 1;
            format!("<tr class=\"failed\">{setting}<td colspan=\"{width}\">FAILED: {why}</td></tr>\n")
        }
    }
}

fn on_front(case: &Case, error: &axis::Axis, cost: &str) -> bool {
    let cost = COSTS.iter().find(|axis| axis.name == cost);
    cost.is_some_and(|cost| case.fronts.contains(&front_name(error, cost)))
}

/// A variant in words.
pub(super) fn variant_name(variant: &str) -> &str {
    match variant {
        "flat" => "planes only",
        "straight" => "chords only",
        _ => "all",
    }
}

/// A budget with a space before its percent sign.
pub(super) fn percent(budget: &str) -> String {
    budget.replace('%', "\u{202f}%")
}

/// The table of exponents against the budget, beside those expected.
pub(super) fn exponents(model: &Model, curves: &[Curve<'_>]) -> String {
    let costs: Vec<_> = [SPLATS].into_iter().chain(COSTS).collect();
    let mut rows = String::new();
    for curve in curves {
        let cell = |cost: &axis::Axis| {
            let slope = model.slope(curve, &BUDGET, cost);
            slope.map_or_else(|| "<td>–</td>".into(), |slope| format!("<td>{}</td>", signed(slope.slope)))
        };
        let expected = model.slope(curve, &BUDGET, &SPLATS).and_then(|slope| slope.expected);
        // Writing to a string cannot fail.
        let _ = writeln!(
            rows,
            "<tr><td>{}, effort {}</td>{}<td>{}</td></tr>",
            variant_name(curve.variant),
            curve.effort,
            costs.iter().map(cell).collect::<String>(),
            expected.map_or_else(String::new, expectation)
        );
    }
    format!(
        "<table class=\"exponents\">\n<thead><tr><th>curve</th><th>splats</th><th>bake time</th><th>bytes</th>\
         <th>frame time</th><th>splats expected</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}

/// What theory expects of the number of splats.
fn expectation(slope: f64) -> String {
    let [planes, smooth, sphere] = axis::EXPECTED.map(exponent);
    if exponent(slope) == planes {
        planes
    } else {
        format!("{smooth} on a smooth surface, {sphere} on a sphere")
    }
}

/// An expected exponent as a fraction.
fn exponent(slope: f64) -> String {
    let close = |other: f64| (slope - other).abs() < SAME_EXPONENT;
    let known = [(-1.0, "−1"), (-2.0 / 3.0, "−⅔"), (-0.5, "−½")];
    known.iter().find(|(other, _)| close(*other)).map_or_else(|| signed(slope), |known| known.1.into())
}

/// Exponents apart by less than this are one, read from a report where they were rounded.
const SAME_EXPONENT: f64 = 1e-9;

/// Two decimals, with a minus sign that is as wide as a plus.
pub(super) fn signed(value: f64) -> String {
    let text = format!("{value:.2}");
    // A zero has no sign.
    if text == "-0.00" { "0.00".into() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(7), "7");
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(grouped(123), "123");
        for (value, text) in
            [(0.012_345, "0.0123"), (1.5, "1.50"), (12.34, "12.3"), (1234.5, "1234"), (0.0, "0")]
        {
            assert_eq!(significant(value), text);
        }
        assert_eq!(signed(-0.666), "−0.67");
        assert_eq!([signed(-0.004), signed(0.004), signed(-0.005_01)], ["0.00", "0.00", "−0.01"]);
        assert_eq!([-1.0, -2.0 / 3.0, -0.5, -0.4].map(exponent), ["−1", "−⅔", "−½", "−0.40"]);
    }
}
