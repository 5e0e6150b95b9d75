//! The `tribo` command as a call: estimates the wrench at an arm's tool without a force sensor, and tunes the arm's friction compensator.
//!
//! Results go to standard output as tables, or as one JSON document with `--json`; progress and messages go to standard
//! error. Exit code 0: done; 1: a check asked for has failed; 2: bad input; 3: an internal error.

#![warn(clippy::print_stderr, clippy::print_stdout)]

/// A message on standard error, which never fails: see [`output::message`].
macro_rules! message {
    ($($argument:tt)*) => {
        $crate::output::message(format_args!($($argument)*))
    };
}

mod arguments;
mod command;
mod failure;
mod output;
mod progress;
mod terminal;
mod threads;

pub use command::now;

use std::ffi::OsString;

use clap::{CommandFactory, Parser};

use arguments::{Arguments, Command};

/// Exit code of input that cannot be used.
const BAD_INPUT: u8 = 2;

/// Runs the command that `words` spell, the name of the program first, and gives its exit code.
pub fn run(words: Vec<OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(refusal) if refusal.use_stderr() => {
            // Nobody can be told that nobody can be told.
            let _ = refusal.print();
            return BAD_INPUT;
        }
        Err(help) => {
            output::noted(help.print());
            return ended(Ok(()));
        }
    };
    let Some(command) = arguments.command else {
        // Help is what a bare call asks for.
        output::noted(Arguments::command().print_help());
        return ended(Ok(()));
    };
    let common = arguments.common;
    let result = match command {
        Command::Tune(tune) => match &tune.live {
            Some(host) => command::tune_live::run(&tune, host, &common),
            None => command::tune::run(&tune, &common),
        },
        Command::Ask(ask) => command::ask::run(&ask, &common),
        Command::Tell(tell) => command::tell::run(&tell, &common),
        Command::Simulate(simulate) => command::simulate::run(&simulate, &common),
        Command::Investigate(investigate) => command::investigate::run(&investigate, &common),
        Command::Serve(serve) => command::serve::run(&serve, &common),
        Command::Listen(listen) => command::listen::run(&listen, &common),
        Command::Estimate(estimate) => command::estimate::run(&estimate, &common),
        Command::Diagnose(diagnose) => command::diagnose::run(&diagnose, &common),
        Command::Convert(convert) => command::convert::run(&convert, &common),
        Command::Export(export) => command::export::run(&export, &common),
        Command::Dashboard(dashboard) => command::dashboard::run(&dashboard, &common),
        Command::Report(report) => command::report::run(&report, &common),
        Command::Study(study) => command::study::run(&study, &common),
        Command::Bench(bench) => command::bench::run(&bench, &common),
        Command::Reproduce(reproduce) => command::reproduce::run(&reproduce, &common),
        Command::Completions { shell } => command::shell::completions(shell),
        Command::Man(man) => command::shell::man(&man, &common),
    };
    ended(result)
}

/// The exit code of a command, once what it printed has arrived.
fn ended(result: anyhow::Result<()>) -> u8 {
    match result.and_then(|()| Ok(output::printed()?)) {
        Ok(()) => 0,
        Err(error) => {
            message!("tribo: {}", failure::describe(&error));
            failure::exit_code(&error)
        }
    }
}
