//! Renews the tables and the plots of `docs/validation.md`: `cargo run --release -p rockproof-validation`.

use anyhow::Context;
use rockproof_validation::convergence::{start_up, studies};
use rockproof_validation::{plot, report, table};
use std::path::Path;
use std::process::ExitCode;

fn main() -> anyhow::Result<ExitCode> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let images = docs.join("images/validation");
    std::fs::create_dir_all(&images)?;
    let lines = report::measure(table());
    let cases = report::markdown(&lines);
    print!("{cases}");
    let mut measured = Vec::new();
    for study in studies() {
        let curve = study.measure()?;
        let path = images.join(study.name).with_extension("svg");
        std::fs::write(&path, plot::plot(&study, &curve)?).with_context(|| path.display().to_string())?;
        measured.push((study, curve));
    }
    let path = docs.join("validation.md");
    let mut page = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let orders = report::orders(&measured);
    for (name, text) in [("closed forms", cases), ("orders", orders), ("start-up", report::start_up(&start_up()?))] {
        page = report::replace(&page, name, &text)?;
    }
    std::fs::write(&path, page).with_context(|| path.display().to_string())?;
    let missed = lines.iter().filter(|line| !line.holds()).count();
    eprintln!("{} cases, {missed} of them miss their bound; written to docs/validation.md", lines.len());
    Ok(if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
