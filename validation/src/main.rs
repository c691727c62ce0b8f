//! Renews the table and the plots of `docs/validation.md`: `cargo run --release -p rockproof-validation`.

use anyhow::Context;
use rockproof_validation::{report, table};
use std::path::Path;
use std::process::ExitCode;

fn main() -> anyhow::Result<ExitCode> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let path = docs.join("validation.md");
    let page = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let lines = report::measure(table());
    let text = report::markdown(&lines);
    print!("{text}");
    std::fs::write(&path, report::replace(&page, "closed forms", &text)?)
        .with_context(|| path.display().to_string())?;
    for study in rockproof_validation::convergence::studies() {
        let curve = study.measure()?;
        eprintln!("{} {} {:?}", study.name, curve.order, curve.points);
    }
    for (step, a, b) in rockproof_validation::convergence::start_up()? {
        eprintln!("{step} {a:?} {b:?}");
    }
    let missed = lines.iter().filter(|line| !line.holds()).count();
    eprintln!("{} cases, {missed} of them miss their bound; written to {}", lines.len(), path.display());
    Ok(if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
