//! `completions` and `man`: what shells and `man` need to know of the command line.

use crate::exit::{Outcome, Verdict, print, print_as_it_is};
use anyhow::Context;
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::PathBuf;

/// Print the completions of a shell
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof completions bash > ~/.local/share/bash-completion/completions/rockproof
  rockproof completions zsh > \"${fpath[1]}/_rockproof\"
  rockproof completions fish > ~/.config/fish/completions/rockproof.fish")]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self) -> Outcome {
        let mut bytes = Vec::new();
        clap_complete::generate(self.shell, &mut crate::Cli::command(), "rockproof", &mut bytes);
        print_as_it_is(std::str::from_utf8(&bytes)?)?;
        Ok(Verdict::Passed)
    }
}

/// Write a manual page for the program and one for each command
#[derive(clap::Args)]
#[command(after_help = "Example:\n  rockproof man ~/.local/share/man/man1 && man rockproof-campaign")]
pub(crate) struct Man {
    /// Directory for them, `man1` of a directory in MANPATH; pages of that name are replaced, other files stay
    dir: PathBuf,
}

impl Man {
    pub(crate) fn run(&self) -> Outcome {
        let place = || self.dir.display().to_string();
        std::fs::create_dir_all(&self.dir).with_context(place)?;
        let command = crate::Cli::command().disable_help_subcommand(true);
        let pages = 1 + command.get_subcommands().count();
        clap_mangen::generate_to(command, &self.dir).with_context(place)?;
        print(&format!("{}: {} manual pages\n", self.dir.display(), pages))?;
        Ok(Verdict::Passed)
    }
}
