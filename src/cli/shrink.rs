//! `shrink`: a case made smaller while it shows the same finding.

use rockproof::campaign::builtin::{self, ENGINES};
use rockproof::campaign::case_file::Case;
use rockproof::campaign::compare::Change;
use rockproof::campaign::finding::Who;
use rockproof::campaign::shrink::Shrinker;
use rockproof::model::files::write_atomically;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `shrink`.
#[derive(Args, Debug)]
#[command(after_help = "Example:
  rockproof shrink reports/campaign-1/cases/v-f-arithmetic-….toml --out small.toml")]
pub(crate) struct ShrinkArgs {
    /// The case
    case: PathBuf,
    /// Where to write the smaller case [default: the case's own file]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Pairs to examine at most
    #[arg(long, default_value_t = 5000)]
    evaluations: u64,
}

/// Runs the command.
pub(crate) fn run(args: ShrinkArgs) -> Result<ExitCode, CliError> {
    let case = Case::load(&args.case)?;
    let file = args.case.display();
    let who = Who::from_name(&case.about.engine);
    let names = ENGINES.map(str::to_owned);
    let change = Change::from_name(&case.about.change)
        .ok_or_else(|| CliError::Other(format!("{file}: no change \"{}\"", case.about.change)))?;
    let panel = builtin::narrow_panel(&names, &who, change);
    if panel.engines.is_empty() {
        let allowed = format!("any, f32, f64, {}", ENGINES.join(", "));
        return Err(CliError::NotOne { what: "engine", found: case.about.engine, allowed });
    }
    if case.findings(&panel).is_empty() {
        let about = &case.about;
        let what = format!("{} {} by {} ({})", about.cause, about.change, about.engine, about.predicate);
        return Err(CliError::Other(format!("{file}: the pair does not show its finding: {what}")));
    }
    let size = |case: &Case| {
        let count =
            |b: &rockproof::model::Block| format!("{} vertices, {} faces", b.vertices().len(), b.topology().faces().len());
        format!("A {}; B {}", count(&case.a), count(&case.b))
    };
    let before = size(&case);
    let small = Shrinker::new(&panel, args.evaluations).shrink(case);
    let text = small.to_toml().map_err(|e| CliError::Other(e.to_string()))?;
    let out = args.out.unwrap_or(args.case);
    write_atomically(&out, text.as_bytes())
        .map_err(|source| CliError::Read { file: out.display().to_string(), source })?;
    println!("before: {before}\nafter:  {}\nwritten to {}", size(&small), out.display());
    Ok(ExitCode::SUCCESS)
}
