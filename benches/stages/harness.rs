//! How often and on how much is measured.

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput};

/// Points of the inputs.
const POINTS: [usize; 3] = [100_000, 1_000_000, 4_000_000];

/// The greatest input of a stage that takes minutes on the next, unless more is asked for.
const AFFORDABLE: usize = 1_000_000;

/// Runs of each measurement: the harness takes no fewer.
const RUNS: usize = 10;

/// Fast stages are repeated until a measurement has taken about this long; slow ones run once.
const MEASURE: Duration = Duration::from_secs(1);

/// Each measurement begins with one run that is thrown away, more only of the fastest.
const WARM_UP: Duration = Duration::from_millis(100);

/// Criterion with the command line's filter.
pub fn criterion() -> Criterion {
    Criterion::default()
        .sample_size(RUNS)
        .warm_up_time(WARM_UP)
        .measurement_time(MEASURE)
        .configure_from_args()
}

/// Points of the inputs.
pub fn inputs() -> impl Iterator<Item = usize> {
    up_to(POINTS[POINTS.len() - 1])
}

/// Points of the inputs for stages that take minutes on the largest.
pub fn affordable() -> impl Iterator<Item = usize> {
    up_to(AFFORDABLE)
}

/// The inputs up to what `QSPLAT_BENCH_MOST` says, without it up to `most`.
fn up_to(most: usize) -> impl Iterator<Item = usize> {
    let most = std::env::var("QSPLAT_BENCH_MOST").ok().and_then(|most| most.parse().ok()).unwrap_or(most);
    POINTS.into_iter().filter(move |&points| points <= most)
}

/// Whether the command line's filter may mean a stage: it names it, or a part of it, or there
/// is none. This only spares preparing inputs; the harness itself applies the filter.
pub fn asked(stage: &str) -> bool {
    let mut filters = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).peekable();
    filters.peek().is_none() || filters.any(|filter| filter.contains(stage) || stage.contains(&filter))
}

/// The group of a stage, for what is done to so many elements.
pub fn group<'a>(criterion: &'a mut Criterion, stage: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(stage);
    // Runs of equal length: growing ones would take minutes for the same median.
    group.sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(elements as u64));
    group
}

/// Measures a stage and, right after it, its floor.
pub fn beside<S, F>(
    criterion: &mut Criterion,
    stage: &str,
    points: usize,
    mut run: impl FnMut() -> S,
    mut floor: impl FnMut() -> F,
) {
    let mut group = group(criterion, stage, points);
    group.bench_function(BenchmarkId::new("stage", points), |b| b.iter_with_large_drop(|| black_box(run())));
    group.bench_function(BenchmarkId::new("floor", points), |b| {
        b.iter_with_large_drop(|| black_box(floor()));
    });
    group.finish();
}

/// Measures a stage that times itself, in seconds, and, right after it, its floor.
pub fn beside_timed<F>(
    criterion: &mut Criterion,
    stage: &str,
    points: usize,
    mut seconds: impl FnMut() -> f64,
    mut floor: impl FnMut() -> F,
) {
    let mut group = group(criterion, stage, points);
    group.bench_function(BenchmarkId::new("stage", points), |b| {
        b.iter_custom(|runs| Duration::from_secs_f64((0..runs).map(|_| seconds()).sum()));
    });
    group
        .bench_function(BenchmarkId::new("floor", points), |b| b.iter_with_large_drop(|| black_box(floor())));
    group.finish();
}

/// A file of the benchmarks' own, in the build folder.
pub fn scratch(name: &str) -> PathBuf {
    [env!("CARGO_TARGET_TMPDIR"), name].iter().collect()
}
