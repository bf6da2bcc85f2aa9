//! What is baked: which budgets, efforts and variants.

use std::path::{Path, PathBuf};

use crate::bake::{Clips, DEFAULT_EFFORT, Holes, MaxError, Options, Shapes};
use crate::error::{Error, Result};

/// What a sweep goes through, for each of its inputs.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Error budgets.
    pub max_errors: Vec<MaxError>,
    /// Efforts, each in `1..=9`.
    pub efforts: Vec<u8>,
    /// Where the feature lines come from.
    pub lines: Lines,
    /// Frames drawn for the frame time, which is their median; at least 1.
    pub frames: usize,
    /// Cases at a time; at least 1. Their times can be compared only where they run alone.
    pub jobs: usize,
}

/// Where the feature lines of an input come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Lines {
    /// Found on a mesh by dihedral angle and border.
    #[default]
    Auto,
    /// None.
    None,
    /// `NAME.features.obj`, `NAME.edges.obj` or `NAME.edges.ply` beside an input `NAME.*`; found
    /// where there is none of these.
    Beside,
    /// A file; for a single input.
    File(PathBuf),
}

/// Endings of files of feature lines beside an input.
const LINE_ENDINGS: [&str; 3] = ["features.obj", "edges.obj", "edges.ply"];

impl Lines {
    /// The file of the lines of an input, if they come from one.
    #[must_use]
    pub fn of(&self, input: &Path) -> Option<PathBuf> {
        match self {
            Self::Auto | Self::None => None,
            Self::File(file) => Some(file.clone()),
            Self::Beside => {
                let beside = LINE_ENDINGS.iter().map(|ending| input.with_extension(ending));
                beside.into_iter().find(|path| path.is_file())
            }
        }
    }
}

/// Which splats a bake may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Everything.
    All,
    /// Planes alone: what quadrics buy.
    Flat,
    /// Chords alone: what conics buy.
    Straight,
}

impl Variant {
    /// The name in the report.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Flat => "flat",
            Self::Straight => "straight",
        }
    }
}

/// One bake of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Which splats it may use.
    pub variant: Variant,
    /// Its error budget.
    pub max_error: MaxError,
    /// Its effort.
    pub effort: u8,
}

impl Setting {
    /// The options of the bake, but for the feature lines. The bound alone rules: it is what is swept.
    #[must_use]
    pub fn options(&self) -> Options {
        Options {
            max_error: self.max_error,
            effort: self.effort,
            shapes: if self.variant == Variant::Flat { Shapes::Flat } else { Shapes::All },
            clips: if self.variant == Variant::Straight { Clips::Straight } else { Clips::Curved },
            holes: Holes::Leave,
            ..Options::default()
        }
    }
}

/// More frames than this take longer than any bake.
const MOST_FRAMES: usize = 1000;

/// More cases at a time than this only wait for each other, each with its input's memory.
const MOST_JOBS: usize = 64;

impl Default for Plan {
    /// Four budgets, three efforts, five frames, one case at a time.
    fn default() -> Self {
        Self {
            max_errors: [1e-2, 3e-3, 1e-3, 3e-4].map(MaxError::Relative).into(),
            efforts: vec![1, DEFAULT_EFFORT, 9],
            lines: Lines::default(),
            frames: 5,
            jobs: 1,
        }
    }
}

impl Plan {
    /// The cases that every input has: all efforts with everything, then planes alone.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let all = self.efforts.iter().flat_map(|&effort| self.at(Variant::All, effort));
        all.chain(self.at(Variant::Flat, self.middle_effort())).collect()
    }

    /// The cases of an input whose splats are cut: chords alone.
    #[must_use]
    pub fn straight(&self) -> Vec<Setting> {
        self.at(Variant::Straight, self.middle_effort()).collect()
    }

    fn at(&self, variant: Variant, effort: u8) -> impl Iterator<Item = Setting> + '_ {
        self.max_errors.iter().map(move |&max_error| Setting { variant, max_error, effort })
    }

    /// The effort of the variants that are for comparison.
    #[must_use]
    pub fn middle_effort(&self) -> u8 {
        let mut sorted = self.efforts.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len() / 2).copied().unwrap_or(DEFAULT_EFFORT)
    }

    /// Refuses a plan that cannot be carried out for so many inputs.
    ///
    /// # Errors
    /// [`Error::Usage`] with the offending value.
    pub fn check(&self, inputs: usize) -> Result<()> {
        let fault = |what: String| Err(Error::Usage(what));
        let twice = |n: usize| self.max_errors[..n].contains(&self.max_errors[n]);
        if self.max_errors.is_empty() || self.efforts.is_empty() {
            return fault("a sweep needs at least one error budget and one effort".into());
        }
        if let Some(n) = (0..self.max_errors.len()).find(|&n| twice(n)) {
            return fault(format!("the error budget {} is given twice", self.max_errors[n]));
        }
        if let Some(effort) = self.efforts.iter().find(|effort| !(1..=9).contains(*effort)) {
            return fault(format!("effort {effort} is not within 1 to 9"));
        }
        if let Some(n) = (0..self.efforts.len()).find(|&n| self.efforts[..n].contains(&self.efforts[n])) {
            return fault(format!("effort {} is given twice", self.efforts[n]));
        }
        if !(1..=MOST_FRAMES).contains(&self.frames) {
            return fault(format!("{} frames are not within 1 to {MOST_FRAMES}", self.frames));
        }
        if !(1..=MOST_JOBS).contains(&self.jobs) {
            return fault(format!("{} jobs are not within 1 to {MOST_JOBS}", self.jobs));
        }
        if matches!(self.lines, Lines::File(_)) && inputs != 1 {
            return fault(format!(
                "one file of feature lines cannot belong to {inputs} inputs; give one input, or take \
                 the lines that lie beside each with `beside`"
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_cases_come_in_one_order() {
        let plan = Plan {
            max_errors: vec![MaxError::Relative(1e-2), MaxError::Absolute(0.5)],
            efforts: vec![9, 1, 4],
            ..Plan::default()
        };
        let names = |settings: Vec<Setting>| {
            let name = |s: &Setting| format!("{} {} {}", s.variant.name(), s.max_error, s.effort);
            settings.iter().map(name).collect::<Vec<_>>()
        };
        let expected = ["all 1% 9", "all 0.5 9", "all 1% 1", "all 0.5 1", "all 1% 4", "all 0.5 4"];
        assert_eq!(names(plan.settings()), [&expected[..], &["flat 1% 4", "flat 0.5 4"]].concat());
        assert_eq!(names(plan.straight()), ["straight 1% 4", "straight 0.5 4"]);
        assert_eq!(plan.straight()[0].options().clips, Clips::Straight);
        assert_eq!(plan.settings()[6].options().shapes, Shapes::Flat);
    }

    #[test]
    fn plans_that_cannot_be_are_refused() {
        assert!(Plan::default().check(3).is_ok());
        let max_error = MaxError::Relative(1e-2);
        for (plan, word) in [
            (Plan { max_errors: vec![], ..Plan::default() }, "at least one"),
            (Plan { max_errors: vec![max_error; 2], ..Plan::default() }, "1% is given twice"),
            (Plan { efforts: vec![0], ..Plan::default() }, "effort 0"),
            (Plan { efforts: vec![3, 3], ..Plan::default() }, "effort 3 is given twice"),
            (Plan { frames: 0, ..Plan::default() }, "frames"),
            (Plan { jobs: 1000, ..Plan::default() }, "jobs"),
            (Plan { lines: Lines::File("a.obj".into()), ..Plan::default() }, "beside"),
        ] {
            let message = plan.check(3).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }

    #[test]
    fn lines_beside_an_input_are_found() {
        let directory = tempfile::tempdir().unwrap();
        let input = directory.path().join("part.1.ply");
        assert_eq!(Lines::Beside.of(&input), None);
        let lines = directory.path().join("part.1.edges.obj");
        std::fs::write(&lines, "").unwrap();
        assert_eq!(Lines::Beside.of(&input), Some(lines));
        assert_eq!(Lines::Auto.of(&input), None);
    }
}
