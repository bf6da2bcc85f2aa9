//! The numbers of a sweep as a table: one row a case.

use super::schema::{Case, Model, Outcome, Sweep};
use crate::error::{Error, Result};

/// A column that an input and its case fill, if it has one.
type About = (&'static str, fn(&Model, Option<&Case>) -> String);

/// The columns before an outcome's.
const SETTINGS: [About; 5] = [
    ("model", |model, _| model.name.clone()),
    ("edges", |model, _| model.edges.clone()),
    ("variant", |_, case| case.map_or_else(String::new, |case| case.variant.clone())),
    ("max_error", |_, case| case.map_or_else(String::new, |case| case.max_error.clone())),
    ("effort", |_, case| case.map_or_else(String::new, |case| case.effort.to_string())),
];

/// The columns after an outcome's.
const VERDICT: [About; 2] = [
    ("fronts", |_, case| case.map_or_else(String::new, |case| case.fronts.join(" "))),
    ("failure", |model, case| case.map_or(&model.failure, |case| &case.failure).clone().unwrap_or_default()),
];

/// A column that an outcome fills.
type Column = (&'static str, fn(&Outcome) -> String);

/// The columns of an outcome. Names, units and order are those of `docs/sweep-schema.md`.
const COLUMNS: [Column; 35] = [
    ("bake_seconds", |o| o.bake_seconds.to_string()),
    ("bake_cpu_seconds", |o| o.bake_cpu_seconds.to_string()),
    ("frame_ms", |o| o.frame_ms.to_string()),
    ("decode_seconds", |o| o.measures.cost.decode_seconds.to_string()),
    ("bytes", |o| o.measures.cost.bytes.to_string()),
    ("bytes_per_splat", |o| o.measures.cost.bytes_per_splat.to_string()),
    ("bytes_per_point", |o| o.measures.cost.bytes_per_point.to_string()),
    ("splats", |o| o.measures.cost.splats.to_string()),
    ("flat", |o| o.measures.cost.flat.to_string()),
    ("cylinder", |o| o.measures.cost.cylinder.to_string()),
    ("quadric", |o| o.measures.cost.quadric.to_string()),
    ("clipped", |o| o.measures.cost.clipped.to_string()),
    ("overlap", |o| optional(o.measures.cost.overlap)),
    ("budget", |o| o.measures.budget.to_string()),
    ("fit_rms", |o| o.measures.fit.rms.to_string()),
    ("fit_p99", |o| o.measures.fit.p99.to_string()),
    ("fit_max", |o| o.measures.fit.max.to_string()),
    ("uncovered", |o| o.measures.uncovered.to_string()),
    ("forward_rms", |o| o.measures.forward.rms.to_string()),
    ("forward_max", |o| o.measures.forward.max.to_string()),
    ("backward_rms", |o| o.measures.backward.rms.to_string()),
    ("backward_max", |o| o.measures.backward.max.to_string()),
    ("normal_rms_deg", |o| o.measures.normal.rms_deg.to_string()),
    ("normal_p99_deg", |o| o.measures.normal.p99_deg.to_string()),
    ("edge_rms", |o| optional(o.measures.edge.map(|edge| edge.rms))),
    ("edge_max", |o| optional(o.measures.edge.map(|edge| edge.max))),
    ("holes_missing", |o| o.measures.holes.missing.to_string()),
    ("holes_extra", |o| o.measures.holes.extra.to_string()),
    ("holes_through", |o| o.measures.holes.through.to_string()),
    ("flip_mean", |o| o.measures.image.flip_mean.to_string()),
    ("flip_p99", |o| o.measures.image.flip_p99.to_string()),
    ("psnr", |o| o.measures.image.psnr.to_string()),
    ("ssim", |o| o.measures.image.ssim.to_string()),
    ("normal_flip_mean", |o| o.measures.image.normal_flip_mean.to_string()),
    ("fragments", |o| o.measures.cost.fragments.to_string()),
];

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// The table, with a head, as RFC 4180 has it. What is not known is empty.
///
/// # Errors
/// [`Error::Internal`] if it cannot be written, which nothing in memory causes.
pub fn csv(sweep: &Sweep) -> Result<String> {
    let lost = |error: &dyn std::fmt::Display| Error::Internal(format!("CSV: {error}"));
    let mut table = ::csv::Writer::from_writer(Vec::new());
    let settings = SETTINGS.iter().map(|column| column.0);
    let head = settings.chain(COLUMNS.iter().map(|column| column.0)).chain(VERDICT.map(|column| column.0));
    table.write_record(head).map_err(|error| lost(&error))?;
    for model in &sweep.models {
        for row in rows(model) {
            table.write_record(row).map_err(|error| lost(&error))?;
        }
    }
    let bytes = table.into_inner().map_err(|error| lost(&error))?;
    String::from_utf8(bytes).map_err(|error| lost(&error))
}

/// A row a case; one for an input that could not be read.
fn rows(model: &Model) -> Vec<Vec<String>> {
    let row = |case: Option<&Case>| {
        let about = |columns: &[About]| columns.iter().map(|column| (column.1)(model, case)).collect();
        let mut row: Vec<String> = about(&SETTINGS);
        let outcome = case.and_then(|case| case.outcome.as_ref());
        row.extend(COLUMNS.iter().map(|(_, value)| outcome.map_or_else(String::new, value)));
        row.extend::<Vec<String>>(about(&VERDICT));
        row
    };
    if model.failure.is_some() { vec![row(None)] } else { model.cases.iter().map(|c| row(Some(c))).collect() }
}
