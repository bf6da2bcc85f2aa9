//! Degenerate meshes through the whole line: a result within the budget or a clear error.
//!
//! Never a panic, a hang or an internal error. Each result is checked apart from the program's own
//! measure: the splats against the triangles (overshoot) and the triangles against the splats
//! (holes).

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

mod check;
mod shapes;

use std::sync::mpsc;
use std::time::Duration;

use qsplat::bake::{Edges, Holes, MaxError, Options, Silent};
use qsplat::deliver::{Delivery, deliver};
use qsplat::error::Error;
use qsplat::ingest::Input;

/// No case may take longer than this, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn options(effort: u8, edges: Edges) -> Options {
    Options {
        max_error: MaxError::Relative(5e-3),
        edges,
        edge_angle: 40.0,
        effort,
        // The middle one also mends what shows from the side, at the finer bound that this takes.
        holes: if effort == 5 { Holes::Close } else { Holes::Leave },
        normals: qsplat::bake::Normals::Auto,
        colors: qsplat::bake::Colors::Auto,
        ..Options::default()
    }
}

/// Runs the line on a thread of its own; `Err` names what went wrong.
fn run(input: &Input, options: &Options) -> Result<Result<Delivery, Error>, String> {
    let (send, receive) = mpsc::channel();
    let (input, options) = (input.clone(), options.clone());
    let worker = std::thread::spawn(move || send.send(deliver(&input, &options, &mut Silent)).unwrap());
    match receive.recv_timeout(PATIENCE) {
        Ok(result) => Ok(result),
        Err(mpsc::RecvTimeoutError::Timeout) => Err(format!("hangs for {PATIENCE:?}")),
        Err(mpsc::RecvTimeoutError::Disconnected) => {
            let cause = worker.join().unwrap_err();
            let text = cause.downcast_ref::<String>().cloned();
            Err(format!("panics: {}", text.unwrap_or_else(|| format!("{:?}", cause.downcast_ref::<&str>()))))
        }
    }
}

/// Runs a case at three efforts, with and without feature edges; the faults.
fn try_case(name: &str, input: &Input) -> Vec<String> {
    let mut faults = Vec::new();
    for (label, edges, efforts) in [("auto", Edges::Auto, [1, 5, 9].as_slice()), ("none", Edges::None, &[1])]
    {
        for &effort in efforts {
            let place = format!("{name}, edges {label}, effort {effort}");
            match run(input, &options(effort, edges.clone())) {
                Err(fault) => faults.push(format!("{place}: {fault}")),
                Ok(Err(Error::Internal(what))) => faults.push(format!("{place}: internal error: {what}")),
                Ok(Err(error)) => {
                    eprintln!("{place}: refused: {error}");
                    if error.to_string().len() < 20 {
                        faults.push(format!("{place}: says too little: {error}"));
                    }
                }
                Ok(Ok(delivery)) => {
                    let found = check::check(input, &delivery.asset);
                    eprintln!("{place}: {} splats, {found}", delivery.asset.splats.len());
                    faults.extend(found.faults().into_iter().map(|fault| format!("{place}: {fault}")));
                }
            }
        }
    }
    faults
}

#[test]
fn degenerate_meshes_end_in_a_result_or_a_clear_error() {
    let mut faults = Vec::new();
    for (name, input) in shapes::all() {
        faults.extend(try_case(name, &input));
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn a_sheet_that_is_seen_from_both_sides_takes_as_much_as_two() {
    let Delivery { asset, .. } = run(&shapes::sheet(), &options(1, Edges::Auto)).unwrap().unwrap();
    assert_eq!(asset.splats.len(), 2);
}

#[test]
fn a_barrel_with_narrow_cracks_takes_about_as_much_as_a_whole_one() {
    let bytes = |crack: f64| {
        let delivery = run(&shapes::barrel(crack), &options(5, Edges::Auto)).unwrap().unwrap();
        assert_eq!(delivery.baked.features.sewn.vertices > 0, crack > 0.0);
        delivery.bytes.len()
    };
    let (whole, cracked) = (bytes(0.0), bytes(1e-4));
    assert!(10 * cracked < 12 * whole, "{cracked} bytes for {whole}");
}

#[test]
fn budgets_out_of_range_are_refused_and_huge_ones_are_kept() {
    let input = shapes::cube();
    for share in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9] {
        let wrong = Options { max_error: MaxError::Relative(share), ..options(5, Edges::Auto) };
        let result = run(&input, &wrong).unwrap();
        assert!(matches!(result, Err(Error::Usage(_))), "{share}: {:?}", result.err());
    }
    for effort in [0, 10, 255] {
        let result = run(&input, &options(effort, Edges::Auto)).unwrap();
        assert!(matches!(result, Err(Error::Usage(_))), "effort {effort}");
    }
    // A bound larger than the model makes every splat right; it must still end.
    for share in [0.1, 1.0, 10.0] {
        let wide = Options { max_error: MaxError::Relative(share), ..options(9, Edges::Auto) };
        match run(&input, &wide) {
            Ok(Ok(delivery)) => assert!(delivery.asset.fit.max <= delivery.asset.max_error),
            Ok(Err(Error::Internal(what))) => panic!("{share}: internal error: {what}"),
            Ok(Err(error)) => eprintln!("share {share}: refused: {error}"),
            Err(fault) => panic!("{share}: {fault}"),
        }
    }
}
