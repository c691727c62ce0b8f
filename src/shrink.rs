//! `shrink`: a case made smaller while it shows the same finding.

use crate::exit::{Outcome, Verdict, print};
use crate::input::EngineArgs;
use crate::input_file::InputFile;
use crate::output_file::OverwriteArgs;
use anyhow::Context;
use rockproof_campaign::shrink::Shrinker;
use rockproof_differential::case_file::{Case, CaseDescription};
use rockproof_model::Block;
use rockproof_results::write_atomically;
use std::path::PathBuf;

/// Make a case smaller
///
/// Fewer vertices, shorter numbers, simpler tolerances, for as long as engine, cause, change and deciding predicate stay.
#[derive(clap::Args)]
#[command(after_help = "Example:
  rockproof shrink reports/campaign-1/cases/v-f-arithmetic-….toml --out small.toml")]
pub(crate) struct Shrink {
    /// The case; or - for stdin
    #[arg(value_hint = clap::ValueHint::FilePath)]
    case: InputFile,
    /// Where to write the smaller case [default: the case's own file, which it replaces; needed for stdin]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    overwrite: OverwriteArgs,
    /// Pairs to examine at most
    #[arg(long, default_value_t = 5000)]
    evaluations: u64,
    #[command(flatten)]
    external: EngineArgs,
}

impl Shrink {
    pub(crate) fn run(&self) -> Outcome {
        let out = match (&self.out, &self.case) {
            (Some(out), _) | (None, InputFile::Named(out)) => out,
            (None, InputFile::Stdin) => {
                anyhow::bail!("a case on stdin has no file of its own; --out says where to write")
            }
        };
        if let Some(out) = &self.out {
            self.overwrite.allow(out)?;
        }
        let path = self.case.path();
        let case = Case::from_toml(&self.case.text()?, path.display().to_string())?;
        let about = &case.about;
        let engines = self.external.engines_of(&case, path)?;
        let file = path.display();
        let panel = engines.panel_of(&case).with_context(|| file.to_string())?;
        let shows = !case.findings(&panel).is_empty();
        panel.check_shortage()?;
        if !shows {
            let CaseDescription { cause, change, engine, predicate, .. } = about;
            anyhow::bail!("{file}: the pair does not show its finding: {cause} {change} by {engine} ({predicate})");
        }
        let before = size(&case);
        let small = Shrinker::new(&panel, self.evaluations).shrink(case);
        panel.check_shortage()?;
        write_atomically(out, small.to_toml()?).with_context(|| out.display().to_string())?;
        print(&format!("before: {before}\nafter:  {}\nwritten to {}\n", size(&small), out.display()))?;
        Ok(Verdict::Passed)
    }
}

fn size(case: &Case) -> String {
    let count = |b: &Block| format!("{} vertices, {} faces", b.vertices().len(), b.topology().faces().len());
    format!("A {}; B {}", count(&case.a), count(&case.b))
}
