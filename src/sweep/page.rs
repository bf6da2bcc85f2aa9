//! The page of a sweep: one HTML file that holds all it shows.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use plotters::style::RGBColor;

use super::axis::{Axis, BUDGET, COSTS, Curve, ERRORS, EXPECTED, SPLATS, curves, front_name};
use super::bars::{self, Bar};
use super::chart::{self, Guide, Line, Look, Mark, log_log};
use super::pictures::{Album, Shown};
use super::schema::{Case, Model, Outcome, Sweep};
use super::table::{exponents, grouped, percent, settings, signed, significant, variant_name};
use crate::error::Result;
use crate::report::page::escape;

const STYLE: &str = include_str!("page.css");

/// The whole page. Everything that is not a constant of this crate is escaped.
pub(super) fn html(sweep: &Sweep, album: &Album) -> Result<String> {
    let mut html = head(sweep);
    let nothing = Shown::default();
    for (index, model) in sweep.models.iter().enumerate() {
        section(&mut html, index, model, album.models.get(index).unwrap_or(&nothing))?;
    }
    html.push_str("</body>\n</html>\n");
    Ok(html)
}

fn head(sweep: &Sweep) -> String {
    let run = &sweep.run;
    let cases: usize = sweep.models.iter().map(|model| model.cases.len()).sum();
    let failures = match sweep.failures() {
        0 => String::new(),
        count => format!(" <span class=\"bad\">{count} failed.</span>"),
    };
    let together = match run.jobs {
        1 => "Cases ran one at a time, so their times can be compared.".to_owned(),
        jobs => format!(
            "<span class=\"bad\">{jobs} cases ran at a time, so their times cannot be compared.</span>"
        ),
    };
    let models = match sweep.models.len() {
        1 => "one model".to_owned(),
        count => format!("{count} models"),
    };
    let links: String = sweep
        .models
        .iter()
        .enumerate()
        .map(|(n, model)| format!("<li><a href=\"#model-{n}\">{}</a></li>", escape(&model.name)))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>qsplat: error against cost</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>Error against cost</h1>\n\
         <p>{cases} bakes of {models}.{failures} {together}</p>\n\
         <p class=\"facts\">{}, {} threads. Frame times are medians of {} frames of {} × {} pixels on the {}. \
         Distances are fractions of the diagonal of the input’s bounding box.</p>\n\
         <ul class=\"legend\">{links}</ul>\n",
        escape(&sweep.generator),
        run.threads,
        run.frames,
        run.frame_size[0],
        run.frame_size[1],
        escape(&run.frame_device)
    )
}

fn section(html: &mut String, index: usize, model: &Model, shown: &Shown) -> Result<()> {
    let name = escape(&model.name);
    // Writing to a string cannot fail.
    let _ = writeln!(html, "<section id=\"model-{index}\">\n<h2>{name}</h2>");
    if let Some(failure) = &model.failure {
        let _ = writeln!(html, "<p class=\"bad\">FAILED: {}</p>\n</section>", escape(failure));
        return Ok(());
    }
    let triangles =
        if model.triangles > 0 { format!(", {} triangles", grouped(model.triangles)) } else { String::new() };
    let _ = writeln!(
        html,
        "<p class=\"facts\">{}: a {} of {} points{triangles}; feature lines: {}; read in {} s.</p>\n\
         <div class=\"wide\">{}</div>",
        escape(&model.path),
        escape(model.kind.as_deref().unwrap_or("model")),
        grouped(model.points),
        escape(&model.edges),
        significant(model.read_seconds),
        settings(model)
    );
    let curves = curves(&model.cases);
    let _ = writeln!(html, "<h3>Error against cost</h3>\n{}", legend(&curves));
    html.push_str("<div class=\"charts\">\n");
    for error in &ERRORS {
        for cost in &COSTS {
            figure(html, model, &curves, error, cost)?;
        }
    }
    html.push_str("</div>\n");
    scaling(html, model, &curves)?;
    breakdown(html, model)?;
    pictures(html, model, shown);
    html.push_str("</section>\n");
    Ok(())
}

/// One chart of error against cost, with the exponents of its curves below it.
fn figure(html: &mut String, model: &Model, curves: &[Curve<'_>], error: &Axis, cost: &Axis) -> Result<()> {
    let front = front_name(error, cost);
    let looks = looks(curves);
    let line = |(curve, look): (&Curve<'_>, &Look)| {
        let on = curve.cases.iter().map(|case| case.fronts.contains(&front));
        let points = curve.pairs(cost, error).into_iter().zip(on).map(|((x, y), on)| (x, y, on)).collect();
        Line { look: *look, points }
    };
    let lines: Vec<Line> = curves.iter().zip(&looks).map(line).collect();
    let Some(svg) = log_log([cost.label, error.label], &lines, &[])? else { return Ok(()) };
    let exponent = |curve: &Curve<'_>| {
        let slope = model.slope(curve, error, cost)?;
        Some(format!("{} {}: {}", variant_name(curve.variant), curve.effort, signed(slope.slope)))
    };
    let fitted: Vec<String> = curves.iter().filter_map(exponent).collect();
    let caption = if fitted.is_empty() {
        String::new()
    } else {
        format!("Fitted exponents of cost in error: {}.", fitted.join("; "))
    };
    let _ = writeln!(html, "<figure>{svg}<figcaption>{caption}</figcaption></figure>");
    Ok(())
}

/// How the number of splats grows as the budget falls, beside what theory expects.
fn scaling(html: &mut String, model: &Model, curves: &[Curve<'_>]) -> Result<()> {
    let looks = looks(curves);
    let line = |(curve, look): (&Curve<'_>, &Look)| Line {
        look: *look,
        points: curve.pairs(&BUDGET, &SPLATS).into_iter().map(|(x, y)| (x, y, false)).collect(),
    };
    let lines: Vec<Line> = curves.iter().zip(&looks).map(line).collect();
    let guides = EXPECTED.map(|slope| Guide { slope });
    let Some(svg) = log_log([BUDGET.label, SPLATS.label], &lines, &guides)? else { return Ok(()) };
    let _ = writeln!(
        html,
        "<h3>Growth as the budget falls</h3>\n<div class=\"growth\">\n<figure>{svg}<figcaption>Dotted: the \
         expected exponents −1 (planes, and triangles), −⅔ (quadrics on a smooth surface) and −½ (quadrics on \
         a sphere), from steep to shallow.</figcaption></figure>\n<div>\n<p class=\"note\">Fitted exponents \
         <i>s</i> of cost ~ budget<sup><i>s</i></sup>:</p>\n{}</div>\n</div>",
        exponents(model, curves)
    );
    Ok(())
}

/// Stage times and bytes by chunk, stacked.
fn breakdown(html: &mut String, model: &Model) -> Result<()> {
    let stages = |o: &Outcome| o.stages.iter().map(|s| (s.name.clone(), s.wall_seconds)).collect();
    let chunks = |o: &Outcome| {
        let head = std::iter::once(("head".to_owned(), o.measures.cost.head_bytes as f64 / 1e3));
        head.chain(o.measures.cost.chunks.iter().map(|c| (c.name.clone(), c.coded_bytes as f64 / 1e3)))
            .collect()
    };
    html.push_str("<h3>Where time and bytes go</h3>\n<div class=\"bars\">\n");
    stack(html, model, "bake time by stage, s", &stages)?;
    stack(html, model, "file size by chunk, kB", &chunks)?;
    html.push_str("</div>\n");
    Ok(())
}

fn stack(
    html: &mut String,
    model: &Model,
    label: &str,
    parts: &dyn Fn(&Outcome) -> Vec<(String, f64)>,
) -> Result<()> {
    let cases: Vec<(&Case, Vec<(String, f64)>)> =
        model.cases.iter().filter_map(|case| Some((case, parts(case.outcome.as_ref()?)))).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in cases.iter().flat_map(|(_, parts)| parts) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let bar = |(case, parts): &(&Case, Vec<(String, f64)>)| {
        let length = |name: &&str| parts.iter().filter(|part| part.0 == *name).map(|part| part.1).sum();
        let name = format!("{}, {}, {}", variant_name(&case.variant), percent(&case.max_error), case.effort);
        Bar { name, parts: names.iter().map(length).collect() }
    };
    let Some(svg) = bars::stacked(label, &cases.iter().map(bar).collect::<Vec<_>>())? else {
        return Ok(());
    };
    let item = |(n, name): (usize, &&str)| {
        let RGBColor(r, g, b) = bars::PALETTE[n % bars::PALETTE.len()];
        format!("<li><i style=\"background:rgb({r},{g},{b})\"></i>{}</li>", escape(name))
    };
    let items: String = names.iter().enumerate().map(item).collect();
    let _ = writeln!(
        html,
        "<figure><ul class=\"legend\">{items}</ul>{svg}<figcaption>Bars: splats, budget, effort.</figcaption>\
         </figure>"
    );
    Ok(())
}

/// Efforts from light to dark.
const BLUES: [RGBColor; 4] =
    [RGBColor(102, 178, 235), RGBColor(25, 118, 200), RGBColor(0, 60, 130), RGBColor(0, 20, 60)];

/// The look of each curve.
fn looks(curves: &[Curve<'_>]) -> Vec<Look> {
    let marks = [Mark::Circle, Mark::Square, Mark::Diamond];
    let mut efforts = 0;
    let mut look = |curve: &Curve<'_>| match curve.variant {
        "flat" => Look { color: RGBColor(213, 94, 0), mark: Mark::Triangle, dashed: true },
        "straight" => Look { color: RGBColor(0, 130, 90), mark: Mark::Cross, dashed: true },
        _ => {
            efforts += 1;
            let n = efforts - 1;
            Look { color: BLUES[n % BLUES.len()], mark: marks[n % marks.len()], dashed: false }
        }
    };
    curves.iter().map(&mut look).collect()
}

/// What the curves are, beside none of the charts so that it covers nothing.
fn legend(curves: &[Curve<'_>]) -> String {
    let item = |(curve, look): (&Curve<'_>, Look)| {
        let RGBColor(r, g, b) = look.color;
        let dashes = if look.dashed { " stroke-dasharray=\"14 8\"" } else { "" };
        format!(
            "<li><svg viewBox=\"-40 -16 80 32\"><line x1=\"-40\" x2=\"40\" y1=\"0\" y2=\"0\" \
             stroke=\"rgb({r},{g},{b})\" stroke-width=\"3\"{dashes}/><polygon points=\"{}\" \
             fill=\"rgb({r},{g},{b})\"/></svg>{}, effort {}</li>",
            chart::outline_points(look.mark),
            variant_name(curve.variant),
            curve.effort
        )
    };
    let items: String = curves.iter().zip(looks(curves)).map(item).collect();
    format!(
        "<ul class=\"legend\">{items}<li><svg viewBox=\"-40 -16 80 32\"><circle r=\"14\" fill=\"none\" \
         stroke=\"#000\" stroke-width=\"3\"/></svg>on the Pareto front: no other setting is as good in both</li></ul>"
    )
}

/// The input, then every case: shaded, and its splats.
fn pictures(html: &mut String, model: &Model, shown: &Shown) {
    html.push_str("<h3>Pictures</h3>\n<div class=\"pictures\">\n");
    let image = |png: &[u8], alt: &str| {
        format!("<img src=\"data:image/png;base64,{}\" alt=\"{alt}\">", STANDARD.encode(png))
    };
    if let Some(input) = &shown.input {
        let _ = writeln!(
            html,
            "<figure><div class=\"pair\">{}</div><figcaption><b>The input</b></figcaption></figure>",
            image(input, "the input")
        );
    }
    for (case, pictures) in model.cases.iter().zip(&shown.cases) {
        let caption =
            format!("{}, {}, effort {}", variant_name(&case.variant), percent(&case.max_error), case.effort);
        let caption = escape(&caption);
        if let (Some([shaded, splats]), Some(outcome)) = (pictures, &case.outcome) {
            let _ = writeln!(
                html,
                "<figure><div class=\"pair\">{}{}</div><figcaption>{caption}: {} splats, {} bytes</figcaption>\
                 </figure>",
                image(shaded, "shaded"),
                image(splats, "each splat in a colour of its own"),
                grouped(outcome.measures.cost.splats),
                grouped(outcome.measures.cost.bytes)
            );
        } else {
            let _ =
                writeln!(html, "<figure><figcaption class=\"bad\">{caption}: FAILED</figcaption></figure>");
        }
    }
    html.push_str("</div>\n");
}
