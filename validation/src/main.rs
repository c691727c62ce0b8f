//! Renews the table and the plots of `docs/validation.md`: `cargo run --release -p rockproof-validation`.

use anyhow::Context;
use rockproof::stepper::contact::Spec;
use rockproof_validation::{cases, table};
use std::path::Path;
use std::process::ExitCode;

fn main() -> anyhow::Result<ExitCode> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let path = docs.join("validation.md");
    let page = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let lines = table::measure(cases::<Spec>());
    let text = table::markdown(&lines);
    print!("{text}");
    std::fs::write(&path, table::replace(&page, "closed forms", &text)?).with_context(|| path.display().to_string())?;
    let missed = lines.iter().filter(|line| !line.holds()).count();
    eprintln!("{} cases, {missed} of them miss their bound; written to {}", lines.len(), path.display());
    Ok(if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
