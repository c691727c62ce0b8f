//! `examine`: is this model safe?

use crate::check::ModelArgs;
use crate::exit::{ExitStatus, Outcome, print_note};
use crate::input::{FormatArgs, precision};
use crate::progress::stages_while;
use crate::stop::on_ctrl_c;
use crate::table::prose;
use crate::terminal::threads;
use rockproof_examine::{FILES, Settings, WorkProgress, examine, worst_cases, write};
use rockproof_model::Precision;
use rockproof_results::{Claim, Directory, Owner, Start, bounded};
use std::path::PathBuf;

/// Is this model safe? Blocks, tolerances, every neighbouring pair, some steps, and a better set in one command
///
/// Reads the blocks as `check` does: sizes, units, rules, overlaps. Then classifies every neighbouring pair exactly and in f32 and f64 and names the cause of each
/// difference; makes some steps and asks exactly after each whether blocks overlap unseen or passed through one another; and searches for a
/// tolerance set that does better, which it then examines in the same way. Ends with a verdict and the next command.
///
/// Writes index.html (the model in 3-D, bad pairs in colour), examine.md, examine.json, blocks.vtu, pairs.csv, tolerances.toml, tolerances.csv, both tables
/// for a paper (pairs.tex, tolerances.tex), and the worst differences as cases to replay. Nothing is written before the end, so an interrupted examination is begun anew.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof examine slope.dda
  rockproof examine cells.txt --planarity 1e-4 --tolerances mine.toml --out reports/mine
  rockproof examine blocks.obj --scale 1/1000            a file in millimetres
  rockproof examine slope.toml --steps 50 --no-tune
  rockproof examine slope.dda --format json > slope.json

Exit status: 0 safe, 1 not safe with the tolerances it was examined with, or not decided, 2 usage or input error, 130 interrupted.")]
pub(crate) struct Examine {
    #[command(flatten)]
    model: ModelArgs,
    /// Precision that the model is to be safe in: f32 or f64
    #[arg(long, default_value = "f64", value_parser = precision)]
    precision: Precision,
    /// Steps to make and audit after settling, whatever the size of the model; 0 for none [default: 5 where the model has at most 2000 blocks]
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
    /// Tolerance sets to try, those given among them
    #[arg(long, value_name = "COUNT", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    candidates: u32,
    /// Look for no other tolerance set
    #[arg(long, conflicts_with = "candidates")]
    no_tune: bool,
    /// Directory of the results [default: reports/examine-MODEL]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Discard the examination in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: FormatArgs,
    /// Worker threads; 0, the default, is one per core; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
}

/// The answer with its lines no wider than a terminal, but for the next command, which is to be copied.
fn shown(verdict: &rockproof_examine::Verdict) -> String {
    let text = verdict.text();
    match text.split_once("\nnext: ") {
        Some((said, next)) => prose(&format!("{said}\n")) + &format!("next: {next}"),
        None => prose(&text),
    }
}

impl Examine {
    pub(crate) fn run(&self) -> Outcome {
        let model = self.model.checked(self.precision)?;
        let dir = self.directory();
        let start = Start::of(false, self.overwrite);
        start.refuse_inputs(&dir, self.model.inputs())?;
        let mut directory = Directory::claim(Claim { dir: &dir, owner: Owner::Examine, start, files: &FILES })?;
        let stop = on_ctrl_c()?;
        let candidates = if self.no_tune { 0 } else { self.candidates };
        let settings = Settings { steps: self.steps, candidates, threads: self.threads };
        let seen = WorkProgress::default();
        let found = match stages_while(&seen, || examine(model, &settings, &seen, &stop)) {
            Ok(Some(found)) => found,
            Ok(None) => {
                directory.give_up();
                print_note("interrupted: nothing is written, and the same command begins anew");
                return Ok(ExitStatus::Interrupted);
            }
            Err(error) => {
                directory.give_up();
                return Err(anyhow::Error::new(error).context(self.model.file.path().display().to_string()));
            }
        };
        found.model.notes.iter().for_each(|note| print_note(note));
        let (cases, naming) = (worst_cases(&found), self.model.naming(&dir, self.out.is_none()));
        let verdict = rockproof_examine::Verdict::of(&found, &cases, &naming);
        let written = write((&found, &naming), &verdict, &cases, &mut directory)?;
        self.format.print(|| shown(&verdict), || written.document)?;
        print_note(&format!("written to {}: {}", dir.display(), written.names.join(", ")));
        Ok(if verdict.is_safe { ExitStatus::Passed } else { ExitStatus::CheckFailed })
    }

    fn directory(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            PathBuf::from(format!("reports/{}", bounded(&format!("examine-{}", self.model.file.stem()))))
        })
    }
}
