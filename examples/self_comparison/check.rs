//! `check`: the pairs of case files once more.

use crate::{PATHS, Verdict, print};
use rockproof_differential::case_file::Case;
use rockproof_validation::self_comparison::compare::{OtherPaths, compare};
use rockproof_validation::self_comparison::paths::Question;
use std::path::PathBuf;

/// Ask every path about the pairs of case files again, and say who disagrees now
#[derive(clap::Args)]
pub(crate) struct Check {
    /// Case files that `run` wrote, or any of a campaign
    #[arg(required = true, value_name = "CASE")]
    cases: Vec<PathBuf>,
}

impl Check {
    pub(crate) fn run(&self) -> anyhow::Result<Verdict> {
        let mut verdict = Verdict::Agreed;
        for path in &self.cases {
            let case = Case::load(path)?;
            let question = Question { a: &case.a, b: &case.b, tolerances: &case.tolerances };
            let found = compare(PATHS, question, OtherPaths { settled: true, plain: true, gmp: true });
            let mut said = match found.tally.collapsed {
                0 if found.deviations.is_empty() => "all paths agree".to_owned(),
                0 => String::new(),
                _ => "not compared: no pair of blocks for the stepper".to_owned(),
            };
            for deviation in found.deviations {
                verdict = Verdict::Disagreed;
                let more = deviation.note.map_or(String::new(), |note| format!(", {note}"));
                let (path, fast) = (deviation.path.name(), deviation.expected.len());
                let found = deviation.found.map_or("no answer".to_owned(), |found| format!("{} contacts", found.len()));
                said += &format!("{path} DISAGREES: {found}, fast {fast}{more}; ");
            }
            print(&format!("{}: {}\n", path.display(), said.trim_end_matches("; ")))?;
        }
        Ok(verdict)
    }
}
