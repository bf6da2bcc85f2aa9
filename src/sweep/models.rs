//! All cases of one input, some at a time.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::Instant;

use super::Event;
use super::axis::{mark_fronts, slopes};
use super::case::{self, Pictures, Subject, without_outliers};
use super::pictures::Shown;
use super::plan::{Lines, Plan, Setting};
use super::schema::{Case, Model};
use crate::bake::Edges;
use crate::error::Result;
use crate::ingest::{self, Input};

/// Reads an input and runs all its cases.
pub(super) fn sweep(path: &Path, plan: &Plan, watch: &mut dyn FnMut(&Event<'_>)) -> (Model, Shown) {
    let mut model = blank(path, plan);
    let start = Instant::now();
    let read = read(path, plan);
    model.read_seconds = start.elapsed().as_secs_f64();
    let kept = read.as_ref().map_err(ToString::to_string).and_then(|(input, edges)| {
        let kept = without_outliers(input, edges).map_err(|error| error.to_string())?;
        Ok((input, kept, edges))
    });
    let subject = kept.as_ref().map_err(Clone::clone).and_then(|(input, kept, edges)| {
        Subject::new(input, kept, Edges::clone(edges)).map_err(|error| error.to_string())
    });
    let subject = match subject {
        Ok(subject) => subject,
        Err(failure) => {
            model.failure = Some(failure);
            return (model, Shown::default());
        }
    };
    let (kind, triangles) = match subject.input {
        Input::Mesh(mesh) => ("mesh", mesh.triangles.len()),
        Input::Cloud(_) => ("cloud", 0),
    };
    model.kind = Some(kind.into());
    (model.points, model.triangles) = (subject.input.cloud().positions.len() as u64, triangles as u64);
    let mut shown = Shown { input: case::draw_input(&subject).ok(), cases: Vec::new() };
    let mut add = |settings: &[Setting], model: &mut Model| {
        for (case, pictures) in run_all(&subject, settings, plan, &model.name, watch) {
            model.cases.push(case);
            shown.cases.push(pictures);
        }
    };
    add(&plan.settings(), &mut model);
    let cut = |case: &Case| case.outcome.as_ref().is_some_and(|o| o.measures.cost.clipped > 0);
    if model.cases.iter().any(cut) {
        add(&plan.straight(), &mut model);
    }
    mark_fronts(&mut model.cases);
    model.slopes = slopes(&model.cases);
    (model, shown)
}

/// What is known of an input before it is read.
fn blank(path: &Path, plan: &Plan) -> Model {
    let edges = match (&plan.lines, plan.lines.of(path)) {
        (_, Some(file)) => file.display().to_string(),
        (Lines::None, None) => "none".into(),
        (_, None) => "auto".into(),
    };
    Model {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        path: path.display().to_string(),
        edges,
        kind: None,
        points: 0,
        triangles: 0,
        read_seconds: 0.0,
        failure: None,
        cases: Vec::new(),
        slopes: Vec::new(),
    }
}

/// The input and what to cut it along.
fn read(path: &Path, plan: &Plan) -> Result<(Input, Edges)> {
    let limits = ingest::Limits::default();
    let input = ingest::read(path, &limits)?;
    let edges = match (&plan.lines, plan.lines.of(path)) {
        (_, Some(file)) => Edges::Given(ingest::read_edges(&file, &limits)?),
        (Lines::None, None) => Edges::None,
        (_, None) => Edges::Auto,
    };
    Ok((input, edges))
}

/// What a worker tells: a case began, or it ended.
type Told = (usize, Option<(Case, Option<Pictures>)>);

/// Runs cases, `plan.jobs` at a time; the results in the order of the settings.
fn run_all(
    subject: &Subject<'_>,
    settings: &[Setting],
    plan: &Plan,
    name: &str,
    watch: &mut dyn FnMut(&Event<'_>),
) -> Vec<(Case, Option<Pictures>)> {
    let mut results: Vec<Option<(Case, Option<Pictures>)>> = settings.iter().map(|_| None).collect();
    let (next, (send, receive)) = (AtomicUsize::new(0), channel::<Told>());
    std::thread::scope(|scope| {
        for _ in 0..plan.jobs.min(settings.len()) {
            let (next, send) = (&next, send.clone());
            scope.spawn(move || work(subject, settings, plan.frames, next, &send));
        }
        drop(send);
        let mut done = 0;
        for (index, result) in receive {
            let Some((case, pictures)) = result else {
                watch(&Event::Began(name, &words(&settings[index])));
                continue;
            };
            done += 1;
            watch(&Event::Ended { model: name, case: &case, done, total: settings.len() });
            results[index] = Some((case, pictures));
        }
    });
    results.into_iter().flatten().collect()
}

/// Takes one case after another until none is left.
fn work(subject: &Subject<'_>, settings: &[Setting], frames: usize, next: &AtomicUsize, tell: &Sender<Told>) {
    loop {
        let index = next.fetch_add(1, Ordering::Relaxed);
        let Some(setting) = settings.get(index) else { return };
        // Nobody listens any more only if the sweep is being given up.
        let _ = tell.send((index, None));
        if tell.send((index, Some(case::run(subject, setting, frames)))).is_err() {
            return;
        }
    }
}

fn words(setting: &Setting) -> String {
    format!("{}, {}, effort {}", setting.variant.name(), setting.max_error, setting.effort)
}
