//! How the work goes on, told on standard error.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use qsplat::bake::{Progress, Silent};

/// The ways to tell it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Style {
    /// A bar on a terminal, nothing elsewhere
    #[default]
    Auto,
    /// One line a stage
    Plain,
    /// One JSON object a line
    Json,
    /// Nothing
    None,
}

/// At most ten reports a second within a stage.
const PAUSE: Duration = Duration::from_millis(100);

impl Style {
    /// The teller of this style, writing to `out` except for the bar, which needs the terminal.
    pub(crate) fn teller<'a>(self, quiet: bool, out: &'a mut dyn Write) -> Box<dyn Progress + 'a> {
        match self {
            _ if quiet => Box::new(Silent),
            Self::Auto if std::io::stderr().is_terminal() => Box::new(Bar { bar: ProgressBar::no_length() }),
            Self::Auto | Self::None => Box::new(Silent),
            Self::Plain => Box::new(Plain { out, start: Instant::now() }),
            Self::Json => Box::new(Json { out, start: Instant::now(), stage: "", told: None }),
        }
    }
}

struct Bar {
    bar: ProgressBar,
}

impl Progress for Bar {
    fn stage(&mut self, name: &'static str) {
        self.bar.reset();
        self.bar.unset_length();
        self.set_style("{spinner} {msg:<8} {elapsed}");
        self.bar.set_message(name);
        self.bar.enable_steady_tick(PAUSE);
    }

    fn advance(&mut self, done: u64, total: u64) {
        if self.bar.length() != Some(total) {
            self.bar.set_length(total);
            self.set_style("{spinner} {msg:<8} {elapsed} {wide_bar} {percent}%");
        }
        self.bar.set_position(done);
    }
}

impl Bar {
    fn set_style(&self, template: &str) {
        // A template that does not parse would cost the looks only.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

struct Plain<'a> {
    out: &'a mut dyn Write,
    start: Instant,
}

impl Progress for Plain<'_> {
    fn stage(&mut self, name: &'static str) {
        let _ = writeln!(self.out, "{:8.3} s  {name}", self.start.elapsed().as_secs_f64());
    }

    fn advance(&mut self, _: u64, _: u64) {}
}

struct Json<'a> {
    out: &'a mut dyn Write,
    start: Instant,
    stage: &'static str,
    told: Option<Instant>,
}

impl Progress for Json<'_> {
    fn stage(&mut self, name: &'static str) {
        (self.stage, self.told) = (name, None);
        let seconds = self.start.elapsed().as_secs_f64();
        let line = serde_json::json!({ "event": "stage", "stage": name, "seconds": seconds });
        let _ = writeln!(self.out, "{line}");
    }

    fn advance(&mut self, done: u64, total: u64) {
        let due = done == total || self.told.is_none_or(|told| told.elapsed() >= PAUSE);
        if due {
            self.told = Some(Instant::now());
            let seconds = self.start.elapsed().as_secs_f64();
            let line = serde_json::json!({
                "event": "advance", "stage": self.stage, "done": done, "total": total, "seconds": seconds
            });
            let _ = writeln!(self.out, "{line}");
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn told(style: Style, quiet: bool) -> String {
        let mut out = Vec::new();
        let mut teller = style.teller(quiet, &mut out);
        teller.stage("read");
        teller.advance(0, 10);
        teller.advance(5, 10);
        teller.advance(10, 10);
        teller.stage("sample");
        drop(teller);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn json_is_one_object_a_line() {
        let text = told(Style::Json, false);
        let lines: Vec<serde_json::Value> =
            text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        // Start, the first and the last advance, and the second stage; 5 of 10 came too soon.
        assert_eq!(lines.len(), 4, "{text}");
        assert_eq!((lines[2]["stage"].as_str(), lines[2]["done"].as_u64()), (Some("read"), Some(10)));
        assert_eq!(lines[3]["stage"], "sample");
    }

    #[test]
    fn plain_is_one_line_a_stage_and_quiet_is_nothing() {
        assert_eq!(told(Style::Plain, false).lines().count(), 2);
        assert_eq!(told(Style::Plain, true), "");
        assert_eq!(told(Style::None, false), "");
    }
}
