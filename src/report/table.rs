//! A report as a table for people.

use std::fmt::Write as _;

use super::{Choice, EdgeCases, File, LowerBound, Moved, Report, Run, Sparse};

impl Report {
    /// Lines of plain text, ending in a line break.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = Table::default();
        self.summary(&mut text);
        text.chunks(&self.file);
        for thing in &self.optional {
            let reason =
                thing.reason.as_deref().map_or_else(|| "yes".into(), |reason| format!("no: {reason}"));
            text.row(&thing.name.replace('_', " "), reason);
        }
        if let Some(choice) = &self.choice {
            text.choice(choice);
        }
        if let Some(run) = &self.run {
            text.run(run);
        }
        text.0
    }

    fn summary(&self, text: &mut Table) {
        let (file, counts, error, model) = (&self.file, &self.counts, &self.error, &self.model);
        text.row("file", format!("{} (.qsplat version {})", file.path, file.version));
        if let Some(input) = &self.input {
            let triangles =
                if input.triangles > 0 { format!(", {} triangles", input.triangles) } else { String::new() };
            text.row("input", format!("{} ({}, {} points{triangles})", input.path, input.kind, input.points));
            if input.outliers > 0 {
                text.row(
                    "outliers",
                    format!("{} that belong to no surface were left out", points(input.outliers)),
                );
            }
            if let Some(largest) = input.open_places.first() {
                let [x, y, z] = largest.middle;
                let places = match input.open_place_count {
                    1 => "1 border or rim of a hole".into(),
                    count => format!("{count} borders and rims of holes, the longest"),
                };
                text.row(
                    "open",
                    format!("{places} around ({x:.6}, {y:.6}, {z:.6}), {} there", points(largest.points)),
                );
            }
            if let Some(Sparse { points: count, worst: [x, y, z], by }) = &input.sparse {
                text.row(
                    "sparse",
                    format!(
                        "{} between which the surface bends by more than the budget, by {by:.2e} of the \
                         diagonal around ({x:.6}, {y:.6}, {z:.6}): it is known no better there",
                        points(*count)
                    ),
                );
            }
            if input.smooth {
                text.row("surface", "smooth, through the vertices: errors are those against it");
            }
            if let Some(noise) = input.noise {
                text.row("noise", format!("{noise:.2e} of the diagonal (standard deviation)"));
            }
            if let Some(moved) = &input.moved {
                let Moved { rms, max } = moved;
                text.row("smoothed", format!("points moved by rms {rms:.2e}, max {max:.2e} of the diagonal"));
            }
        }
        let per_point = self.density.bytes_per_point.map_or(String::new(), |n| format!(", {n:.2} a point"));
        text.row("bytes", format!("{} ({:.1} a splat{per_point})", file.bytes, self.density.bytes_per_splat));
        text.row("splats", format!("{} ({}, {} clipped)", counts.splats, counts.kinds(), counts.clipped));
        if let Some(overlap) = self.density.overlap {
            text.row("overlap", format!("{overlap:.2} of the input's area"));
        }
        text.row(
            "clip curves",
            format!("{} curved, {} straight", counts.curved_clips, counts.straight_clips),
        );
        let fit = &error.fit;
        text.row(
            "fit",
            format!("rms {:.2e}, p99 {:.2e}, max {:.2e} of the diagonal", fit.rms, fit.p99, fit.max),
        );
        let kept = if error.within_budget { "kept" } else { "NOT kept" };
        text.row("budget", format!("{:.2e} of the diagonal, {kept}", error.budget));
        let [x, y, z] = model.origin;
        text.row(
            "box",
            format!("around ({x:.6}, {y:.6}, {z:.6}), diagonal {:.6} input units", model.diagonal),
        );
    }
}

/// How many points.
pub(super) fn points(count: u64) -> String {
    if count == 1 { "1 point".into() } else { format!("{count} points") }
}

/// Text in two columns.
#[derive(Default)]
pub(super) struct Table(pub(super) String);

impl Table {
    pub(super) fn row(&mut self, name: &str, value: impl AsRef<str>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{name:<14}{}", value.as_ref());
    }

    fn chunks(&mut self, file: &File) {
        self.row("head", format!("{:<10} {:>10} bytes", "", file.head_bytes));
        for (number, chunk) in file.chunks.iter().enumerate() {
            let name = if number == 0 { "chunks" } else { "" };
            self.row(
                name,
                format!(
                    "{:<10} {:>10} bytes, {:>10} decoded",
                    chunk.name, chunk.coded_bytes, chunk.raw_bytes
                ),
            );
        }
        let fields: Vec<String> =
            file.fields.iter().map(|field| format!("{} {:.0}", field.name, field.bytes)).collect();
        if !fields.is_empty() {
            self.row("of SPLT", format!("{} bytes", fields.join(", ")));
        }
    }

    fn choice(&mut self, choice: &Choice) {
        let Choice { samples, candidates, redundant, merged, last_resorts, low_rank, .. } = choice;
        self.row(
            "chosen from",
            format!("{candidates} candidates over {samples} samples, {redundant} redundant, {merged} merged"),
        );
        if choice.following > 0 {
            self.row("added", format!("{} splats along lines that no other is cut along", choice.following));
        }
        if choice.sealing > 0 {
            self.row("added", format!("{} splats that close holes seen from the side", choice.sealing));
        }
        if choice.withdrawn > 0 {
            self.row("replaced", format!("{} splats that showed beside the outline", choice.withdrawn));
        }
        self.row(
            "fell back",
            format!("{low_rank} fits of lower order, {last_resorts} pieces with a splat of their own"),
        );
        self.edge_cases(&choice.edge_cases);
        if let Some(bound) = &choice.lower_bound {
            self.lower_bound(bound);
        }
    }

    /// Only what there is.
    fn edge_cases(&mut self, cases: &EdgeCases) {
        let EdgeCases { several_lines, inflections, corners, curved_arms, loops, several_curves, .. } = cases;
        let counts = [
            (several_curves, "cut by several curves"),
            (several_lines, "with several lines"),
            (corners, "with corners"),
            (curved_arms, "of these with curved arms"),
            (inflections, "with inflections"),
            (loops, "with loops"),
        ];
        let list = |counts: Vec<String>| (!counts.is_empty()).then(|| counts.join(", "));
        let there = |(count, what): (&u64, &str)| (*count > 0).then(|| format!("{count} {what}"));
        if let Some(splats) = list(counts.into_iter().filter_map(there).collect()) {
            self.row("edge cases", format!("splats: {splats}"));
        }
        let ends = there((&cases.line_ends, "where a line ends"));
        let meetings = cases.meetings.iter().map(|at| format!("{} where {} lines meet", at.places, at.lines));
        if let Some(places) = list(ends.into_iter().chain(meetings).collect()) {
            self.row("", format!("places: {places}"));
        }
    }

    fn lower_bound(&mut self, bound: &LowerBound) {
        let LowerBound { cost, area, lagrangian, .. } = bound;
        // Rounded to the side on which what is said stays true.
        let (area, least) = (area.floor(), lagrangian.floor());
        let within = (1e3 * bound.excess()).ceil() / 10.0;
        self.row(
            "cover",
            format!(
                "cost {cost:.0}, at least {least:.0} by its candidates (within {within:.1} %; {area:.0} by area)"
            ),
        );
    }

    fn run(&mut self, run: &Run) {
        for (number, stage) in run.stages.iter().enumerate() {
            let name = if number == 0 { "stages" } else { "" };
            self.row(
                name,
                format!(
                    "{:<10} {:>8.3} s, {:>8.3} s processor",
                    stage.name, stage.wall_seconds, stage.cpu_seconds
                ),
            );
        }
        let memory = run
            .peak_bytes
            .map_or(String::new(), |bytes| format!(", {:.0} MiB at most", bytes as f64 / f64::from(1 << 20)));
        self.row(
            "in all",
            format!(
                "{:.3} s, {:.3} s processor on {} threads{memory}",
                run.wall_seconds, run.cpu_seconds, run.threads
            ),
        );
    }
}
