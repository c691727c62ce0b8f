//! `shrink`: a case made smaller while it shows the same finding, or a state file while its step does.

use crate::exit::{ExitStatus, Outcome, print};
use crate::input::EngineArgs;
use crate::input_file::InputFile;
use crate::output_file::OverwriteArgs;
use crate::progress::counted_while;
use anyhow::Context;
use rockproof_campaign::shrink::Shrinker;
use rockproof_campaign::steps;
use rockproof_campaign::steps::case::STEP_EVALUATIONS;
use rockproof_differential::case_file::{Case, CaseDescription};
use rockproof_differential::lockstep::StepCase;
use rockproof_model::Block;
use rockproof_results::write_atomically;
use std::path::{Path, PathBuf};

/// Make a case smaller
///
/// Fewer vertices, shorter numbers, simpler tolerances, for as long as engine, cause, change and deciding predicate stay.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof shrink reports/campaign-1/cases/v-f-arithmetic-….toml --out small.toml
  rockproof shrink reports/simulate-slope/cases/passage_3-7_step_000012.json --out small.json")]
pub(crate) struct Shrink {
    /// The case of a pair (.toml), or a step (.json); or - for stdin, with either
    #[arg(value_hint = clap::ValueHint::FilePath)]
    case: InputFile,
    /// Where to write the smaller case [default: the case's own file, which it replaces; needed for stdin]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    overwrite: OverwriteArgs,
    /// Pairs to examine at most; a sixth as many steps of a state file
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
        let (text, path) = (self.case.case_text()?, self.case.path());
        if self.case.is_step(&text) {
            return self.shrink_step(&text, out);
        }
        let case = Case::from_toml(&text, path.display().to_string())?;
        let about = &case.about;
        let engines = self.external.engines_of(&case, path)?;
        let file = path.display();
        let panel = engines.panel_of(&case).with_context(|| file.to_string())?;
        let shows = !case.findings(&panel).is_empty();
        panel.check_shortage()?;
        if !shows {
            let CaseDescription { cause, change, engine, predicate, .. } = about;
            let predicate = if predicate.is_empty() { String::new() } else { format!(" ({predicate})") };
            anyhow::bail!("{file}: the pair does not show its finding: {cause} {change} by {engine}{predicate}");
        }
        let before = size(&case);
        let small = counted_while((self.evaluations, "pairs at most"), "shrinking", |examined| {
            Shrinker::new(&panel, self.evaluations).counted(examined).shrink(case)
        });
        panel.check_shortage()?;
        write_atomically(out, small.to_toml()?).with_context(|| out.display().to_string())?;
        print(&format!("before: {before}\nafter:  {}\nwritten to {}\n", size(&small), out.display()))?;
        Ok(ExitStatus::Passed)
    }

    /// The same of a state file.
    fn shrink_step(&self, text: &str, out: &Path) -> Outcome {
        let file = || self.case.path().display().to_string();
        let case = StepCase::parse(text).with_context(file)?;
        let most = self.evaluations / STEP_EVALUATIONS;
        let small =
            counted_while((most, "steps at most"), "shrinking", |made| steps::shrink::shrink(&case, most, made))
                .with_context(file)?;
        write_atomically(out, small.text()?).with_context(|| out.display().to_string())?;
        let [before, after] = [step_size(&case)?, step_size(&small)?];
        print(&format!("before: {before}\nafter:  {after}\nwritten to {}\n", out.display()))?;
        Ok(ExitStatus::Passed)
    }
}

fn step_size(case: &StepCase) -> anyhow::Result<String> {
    let (scene, _) = case.scene()?;
    let shapes = scene.shapes();
    let vertices: usize = shapes.iter().map(|block| block.vertices().len()).sum();
    let faces: usize = shapes.iter().map(|block| block.topology().faces().len()).sum();
    Ok(format!("step {} of {} blocks, {vertices} vertices, {faces} faces", case.step, shapes.len()))
}

fn size(case: &Case) -> String {
    let count = |b: &Block| format!("{} vertices, {} faces", b.vertices().len(), b.topology().faces().len());
    format!("A {}; B {}", count(&case.a), count(&case.b))
}
