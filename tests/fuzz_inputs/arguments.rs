//! The command line.

use std::cell::RefCell;
use std::ffi::OsString;

use clap::{CommandFactory, FromArgMatches};
use tribo_campaign::study::Shard;

#[path = "../../cli/src/arguments/mod.rs"]
#[allow(missing_docs, dead_code, reason = "the command line as the binary has it, which has no library")]
mod command_line;

use command_line::{Arguments, Command};

thread_local! {
    /// Built once: that takes longer than to parse.
    static COMMAND: RefCell<clap::Command> = RefCell::new(Arguments::command());
}

/// Arguments, one a line and not always text, are understood, or refused with exit code 2; help and version are no failure.
pub fn check(input: &[u8]) {
    let arguments = input.split(|byte| *byte == b'\n').map(argument);
    let arguments = std::iter::once(OsString::from("tribo")).chain(arguments);
    let matches = COMMAND.with_borrow_mut(|command| command.try_get_matches_from_mut(arguments));
    match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(Arguments { command: Some(Command::Study(study)), .. }) => {
            if let Some(Ok(shard)) = study.shard.map(|text| text.parse::<Shard>()) {
                assert_eq!(shard.to_string().parse::<Shard>().expect("a slice that was written is read"), shard);
            }
        }
        Ok(_) => {}
        Err(refusal) => {
            let code = if refusal.use_stderr() { 2 } else { 0 };
            assert_eq!(refusal.exit_code(), code);
            assert!(!refusal.render().to_string().is_empty());
        }
    }
}

/// Arguments need not be text where the system does not ask for it.
#[cfg(unix)]
fn argument(bytes: &[u8]) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes.to_vec())
}

#[cfg(not(unix))]
fn argument(bytes: &[u8]) -> OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}
