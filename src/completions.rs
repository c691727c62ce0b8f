//! `completions` and `man`: what shells and `man` need to know of the command line.

use crate::exit::{ExitStatus, Outcome, print, print_as_it_is};
use crate::output_file::allow_ours;
use anyhow::Context;
use clap::CommandFactory;
use clap_complete::Shell;
use rockproof_results::write_atomically;
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
        Ok(ExitStatus::Passed)
    }
}

/// Write a manual page for the program and one for each command
#[derive(clap::Args)]
#[command(after_help = "Example:\n  rockproof man ~/.local/share/man/man1 && man rockproof-campaign")]
pub(crate) struct Man {
    /// Directory for them, `man1` of a directory in MANPATH; pages of an earlier version are replaced, other files stay
    dir: PathBuf,
}

impl Man {
    pub(crate) fn run(&self) -> Outcome {
        std::fs::create_dir_all(&self.dir).with_context(|| self.dir.display().to_string())?;
        let mut command = crate::Cli::command().disable_help_subcommand(true);
        command.build();
        let mut pages = Vec::new();
        for command in command.get_subcommands().chain([&command]) {
            let page = clap_mangen::Man::new(command.clone());
            let mut text = Vec::new();
            page.render(&mut text)?;
            pages.push((self.dir.join(page.get_filename()), text));
        }
        for (file, _) in &pages {
            allow_ours(file, "manual page of rockproof", |text| text.contains("\n.TH rockproof"))?;
        }
        for (file, text) in &pages {
            write_atomically(file, text).with_context(|| file.display().to_string())?;
        }
        print(&format!("{}: {} manual pages\n", self.dir.display(), pages.len()))?;
        Ok(ExitStatus::Passed)
    }
}
