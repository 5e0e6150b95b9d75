//! The `tribo` command.

#![warn(clippy::print_stderr, clippy::print_stdout)]

mod processor;

use std::process::ExitCode;

fn main() -> ExitCode {
    if processor::lacks_something() {
        return ExitCode::from(2);
    }
    run()
}

/// Apart, so that nothing of it comes before the question above.
#[inline(never)]
fn run() -> ExitCode {
    ExitCode::from(tribo_cli::run(std::env::args_os().collect()))
}
