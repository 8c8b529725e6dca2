//! Shell completions and manual pages, made from the definitions of the command line.

use std::io;

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use super::cli::Cli;

/// A shell's completion script.
pub fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "trainsafe", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Each manual page with the name of its file: the program's, and one for every command.
pub fn pages() -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let commands: Vec<Command> = program.get_subcommands().cloned().collect();
    std::iter::once(program).chain(commands).map(page).collect()
}

/// When the commands last changed.
const REVISED: &str = "2026-11-25";

fn page(command: Command) -> io::Result<(String, Vec<u8>)> {
    let version = concat!("trainsafe ", env!("CARGO_PKG_VERSION"));
    let man = clap_mangen::Man::new(command).date(REVISED).source(version).manual("trainsafe");
    let mut text = Vec::new();
    man.render(&mut text)?;
    let text = String::from_utf8_lossy(&text).replace(".SH EXTRA\n", ".SH NOTES\n");
    // Two breaks around an empty line are one too many for strict formatters.
    let text = text.replace(".br\n\n.br\n", ".sp\n");
    Ok((man.get_filename(), text.into_bytes()))
}
