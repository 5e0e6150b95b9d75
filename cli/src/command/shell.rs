//! `tribo completions` and `tribo man`.

use clap::CommandFactory;
use tribo_files::write_atomic;
use tribo_model::FileError;

use crate::arguments::{Arguments, Common, Man};
use crate::failure::BadInput;
use crate::output::print_bytes;

/// Prints the completion script of a shell.
pub fn completions(shell: clap_complete::Shell) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "tribo", &mut script);
    print_bytes(&script);
    Ok(())
}

/// Prints the manual page of one command, or writes those of all.
pub fn man(arguments: &Man, common: &Common) -> anyhow::Result<()> {
    let mut whole = Arguments::command().disable_help_subcommand(true);
    whole.build();
    let Some(directory) = &arguments.out else {
        let page = match &arguments.page {
            None => &whole,
            Some(name) => whole.find_subcommand(name).ok_or_else(|| {
                let names: Vec<&str> = whole.get_subcommands().map(clap::Command::get_name).collect();
                BadInput(format!("no command '{name}'; there are {}", names.join(", ")))
            })?,
        };
        print_bytes(&roff(page.clone())?);
        return Ok(());
    };
    std::fs::create_dir_all(directory).map_err(FileError::io(directory))?;
    let commands: Vec<&clap::Command> = std::iter::once(&whole).chain(whole.get_subcommands()).collect();
    for command in &commands {
        let path = directory.join(clap_mangen::Man::new((*command).clone()).get_filename());
        let page = roff((*command).clone())?;
        write_atomic(&path, |file| file.write_all(&page))?;
    }
    if !common.quiet {
        message!("{} pages written to {}", commands.len(), directory.display());
    }
    Ok(())
}

fn roff(command: clap::Command) -> std::io::Result<Vec<u8>> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    Ok(page)
}
