//! `tribo completions` and `tribo man`.

use std::io::Write;

use clap::CommandFactory;

use crate::arguments::Arguments;

/// Prints the completion script of a shell.
pub fn completions(shell: clap_complete::Shell) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "tribo", &mut script);
    write_all(&script)
}

/// Prints the manual page.
pub fn man_page() -> anyhow::Result<()> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Arguments::command()).render(&mut page)?;
    write_all(&page)
}

/// Writes to standard output. A reader that has gone (`tribo man | head`) is no error of ours.
fn write_all(bytes: &[u8]) -> anyhow::Result<()> {
    match std::io::stdout().lock().write_all(bytes) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
