//! The command line: arguments in, one call, an exit code out.
//!
//! The only place that prints. Results go to standard output, everything else to standard
//! error. Exit codes: 0, 1 (a check failed), 2 (usage, bad input, or an internal error).

mod cli;

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

/// Exit code of a check that failed.
const FAILED: u8 = 1;
/// Exit code of everything that could not be done.
const REFUSED: u8 = 2;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| say(&cli::panic_message(panic))));
    // A panic is a bug of ours, whatever the input: say so, and keep the promised exit code.
    std::panic::catch_unwind(run).unwrap_or(ExitCode::from(REFUSED))
}

fn run() -> ExitCode {
    let arguments = match cli::Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(refusal) => {
            // Help and version come this way too, for standard output and with code 0.
            let _ = refusal.print();
            return if refusal.use_stderr() { ExitCode::from(REFUSED) } else { ExitCode::SUCCESS };
        }
    };
    match arguments.run(&mut std::io::stderr()) {
        Ok(outcome) => {
            let code = if outcome.passed { ExitCode::SUCCESS } else { ExitCode::from(FAILED) };
            if print(&outcome.text) { code } else { ExitCode::from(REFUSED) }
        }
        Err(error) => {
            say(&format!("qsplat: {error}"));
            ExitCode::from(REFUSED)
        }
    }
}

/// Writes a result; whether it arrived, or its reader no longer wanted it.
fn print(text: &str) -> bool {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => true,
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => true,
        Err(error) => {
            say(&format!("qsplat: standard output: {error}"));
            false
        }
    }
}

/// A line on standard error. If even that is closed, nobody is left to tell.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
