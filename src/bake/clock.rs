//! What a bake tells of its course: its stages as they begin and go on, and the time of each.

use std::time::Instant;

use cpu_time::ProcessTime;

/// Told how the work goes on; all methods may be called from the baking thread only.
pub trait Progress {
    /// A stage begins (`read`, `analyse`, `look`, `scout`, `sample`, `cover`, `bound`, `clip`, `seal`, `partners`,
    /// `encode`, `measure`, `write`).
    fn stage(&mut self, name: &'static str);
    /// The stage now at hand has done `done` of `total` units of its own.
    fn advance(&mut self, done: u64, total: u64);
}

/// Says nothing.
pub struct Silent;

impl Progress for Silent {
    fn stage(&mut self, _: &'static str) {}
    fn advance(&mut self, _: u64, _: u64) {}
}

/// Wall and CPU time of one stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StageTime {
    /// The stage's name.
    pub name: String,
    /// Seconds on the clock.
    pub wall_seconds: f64,
    /// Seconds of processor time over all threads.
    pub cpu_seconds: f64,
}

/// Times stages one after another.
#[derive(Default)]
pub struct Clock {
    running: Option<(&'static str, Instant, Option<ProcessTime>)>,
    done: Vec<StageTime>,
}

impl Clock {
    /// Ends the stage at hand and begins the next.
    pub fn stage(&mut self, progress: &mut dyn Progress, name: &'static str) {
        self.close();
        progress.stage(name);
        self.running = Some((name, Instant::now(), ProcessTime::try_now().ok()));
    }

    fn close(&mut self) {
        if let Some((name, wall, cpu)) = self.running.take() {
            let cpu = cpu.and_then(|start| Some(ProcessTime::try_now().ok()?.duration_since(start)));
            self.done.push(StageTime {
                name: name.into(),
                wall_seconds: wall.elapsed().as_secs_f64(),
                cpu_seconds: cpu.map_or(0.0, |time| time.as_secs_f64()),
            });
        }
    }

    /// Ends the stage at hand; the times of all.
    #[must_use]
    pub fn finish(mut self) -> Vec<StageTime> {
        self.close();
        self.done
    }
}
