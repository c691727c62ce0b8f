//! Renews the tables and the plots of `docs/validation.md`, and the tables of `docs/step.md`: `cargo run --release -p rockproof-validation`, or some of them by their names.

use anyhow::Context;
use rayon::prelude::*;
use rockproof_model::Motion;
use rockproof_stepper::contact::SpecRules;
use rockproof_validation::convergence::{first_swings, start_up, studies};
use rockproof_validation::energy::{EnergyResult, TIME_STEPS};
use rockproof_validation::iterations::{self, Pour};
use rockproof_validation::wall::{MAX_DRIFT, Wall};
use rockproof_validation::{dominoes, energy, physics_report, plot, report, restitution, table};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The tables, by the names of their marks in the page, and the page.
const TABLES: [(&str, &str); 9] = [
    ("closed forms", "validation.md"),
    ("orders", "validation.md"),
    ("start-up", "validation.md"),
    ("energy", "validation.md"),
    ("restitution", "validation.md"),
    ("dominoes", "validation.md"),
    ("wall", "validation.md"),
    ("iterations", "step.md"),
    ("pours", "step.md"),
];

fn main() -> anyhow::Result<ExitCode> {
    let names = TABLES.map(|(name, _)| name);
    let asked: Vec<String> = std::env::args().skip(1).collect();
    if let Some(unknown) = asked.iter().find(|name| !names.contains(&name.as_str())) {
        anyhow::bail!("no table is called `{unknown}`; there are: {}", names.join(", "));
    }
    let mut missed = 0;
    for (name, page) in TABLES.iter().filter(|(name, _)| asked.is_empty() || asked.iter().any(|one| one == name)) {
        eprintln!("{name} …");
        let (text, misses) = made(name)?;
        print!("{text}");
        missed += misses;
        let page = docs().join(page);
        let before = std::fs::read_to_string(&page).with_context(|| page.display().to_string())?;
        std::fs::write(&page, report::replace(&before, name, &text)?).with_context(|| page.display().to_string())?;
    }
    eprintln!("{missed} cases miss their bound; written to docs/");
    Ok(if missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// A table, and how many of its cases miss their bound.
fn made(name: &str) -> anyhow::Result<(String, usize)> {
    let text = match name {
        "closed forms" => {
            let lines = report::measure(table());
            return Ok((report::markdown(&lines), lines.iter().filter(|line| !line.holds()).count()));
        }
        "orders" => orders()?,
        "start-up" => report::start_up(&start_up()?, &first_swings()?),
        "energy" => physics_report::energy(&energy::measure(tell)?),
        "restitution" => physics_report::restitution(&restitution::table()?),
        "dominoes" => {
            let rows = dominoes::rows();
            let speeds = rows.par_iter().map(|row| Ok((*row, row.speed::<f64, SpecRules>()?)));
            let speeds = speeds.collect::<anyhow::Result<Vec<_>>>()?;
            let misses = speeds.iter().filter(|(row, speed)| row.hinged && !dominoes::is_near(*speed)).count();
            return Ok((physics_report::dominoes(&speeds), misses));
        }
        "iterations" => physics_report::iterations(&iterations::census()?),
        "pours" => {
            let runs: Vec<(Pour, f64)> =
                Pour::ALL.into_iter().flat_map(|pour| TIME_STEPS.map(|time_step| (pour, time_step))).collect();
            let pours = runs.into_par_iter().map(|(pour, time_step)| Ok((pour, pour.measure(time_step)?)));
            physics_report::pours(&pours.collect::<anyhow::Result<Vec<_>>>()?)
        }
        _ => {
            let walls = [Motion::Rigid, Motion::Deformable].map(Wall::of_a_thousand);
            let drifts = walls.iter().map(|wall| Ok((*wall, wall.measure()?)));
            let drifts = drifts.collect::<anyhow::Result<Vec<_>>>()?;
            let misses =
                drifts.iter().filter(|(_, drift)| drift.drift[1].is_nan() || drift.drift[1] > MAX_DRIFT).count();
            return Ok((physics_report::wall(&drifts), misses));
        }
    };
    Ok((text, 0))
}

/// The studies of convergence, and their plots.
fn orders() -> anyhow::Result<String> {
    let images = docs().join("images/validation");
    std::fs::create_dir_all(&images)?;
    let mut measured = Vec::new();
    for study in studies() {
        let curve = study.measure()?;
        let path = images.join(study.name).with_extension("svg");
        std::fs::write(&path, plot::plot(&study, &curve)?).with_context(|| path.display().to_string())?;
        measured.push((study, curve));
    }
    Ok(report::orders(&measured))
}

/// Progress: each run as it ends.
fn tell(result: &EnergyResult) {
    let (run, worst) = (&result.run, &result.worst);
    eprintln!(
        "{}, {}, {} ms, run {}: at most {:.2e}, in all {:.2e}, left {:.2e}",
        run.scene.name(),
        run.motion.name(),
        1e3 * run.time_step,
        run.variant,
        worst.gain,
        result.gained,
        result.left
    );
}
