//! `tribo completions` and `tribo man`.

use std::io::Write;

use clap::CommandFactory;

use crate::arguments::Arguments;

/// Prints the completion script of a shell.
pub fn completions(shell: clap_complete::Shell) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "tribo", &mut script);
    Ok(std::io::stdout().lock().write_all(&script)?)
}

/// Prints the manual page.
pub fn man_page() -> anyhow::Result<()> {
    Ok(clap_mangen::Man::new(Arguments::command()).render(&mut std::io::stdout().lock())?)
}
