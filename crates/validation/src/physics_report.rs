//! Tables of `docs/validation.md` beside that of the closed forms: energy, restitution, dominoes, the wall; and those of `docs/step.md`.

use crate::dominoes::Row;
use crate::energy::{EnergyLine, EnergyResult, STEP_GOAL, SUM_GOAL};
use crate::iterations::{IterationCensus, Pour};
use crate::report::short;
use crate::restitution::{Restitution, STIFFNESSES, TIME_STEPS};
use crate::wall::{Wall, WallDrift};
use rockproof_model::Motion;
use std::fmt::Write;

/// The energy suites, and how many of their runs miss a goal.
pub fn energy(lines: &[EnergyLine]) -> String {
    let mut out = String::from(
        "| scene | blocks | Δt | gained in one step, at most | in all, on average | left at the end, on average | \
         not converged | the step that gained most |\n| --- | --- | ---: | ---: | ---: | ---: | ---: | --- |\n",
    );
    for line in lines {
        for runs in &line.runs {
            let Some(worst) = runs.iter().max_by(|one, other| one.worst.gain.total_cmp(&other.worst.gain)) else {
                continue;
            };
            let mean = |of: fn(&EnergyResult) -> f64| runs.iter().map(of).sum::<f64>() / runs.len() as f64;
            let [steps, open] = [0, 1].map(|k| runs.iter().map(|run| run.steps[k]).sum::<u64>());
            let (gained, left) = (mean(|run| run.gained), mean(|run| run.left));
            let mark = |missed: bool| if missed { "**missed** " } else { "" };
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "| {} | {} | {} ms | {}{} | {}{} | {} | {open} of {steps} | {} |",
                line.scene.name(),
                line.motion.name(),
                1e3 * worst.run.time_step,
                mark(worst.worst.gain > STEP_GOAL),
                percent(worst.worst.gain),
                mark(gained > SUM_GOAL),
                percent(gained),
                percent(left),
                largest_gain_note(worst),
            );
        }
    }
    let all = || lines.iter().flat_map(|line| line.runs.iter().flatten());
    let count = all().count();
    let missed = all().filter(|run| run.worst.gain > STEP_GOAL).count();
    let mean = all().map(|run| run.gained).sum::<f64>() / count.max(1) as f64;
    let _ = writeln!(
        out,
        "\n{count} runs: {missed} have a step that gains more than {}; all gaining steps of a run gain {} on average (goal: {}).",
        percent(STEP_GOAL),
        percent(mean),
        percent(SUM_GOAL)
    );
    out
}

/// Where the largest gain of a run came from; nothing for a step that gained next to nothing.
fn largest_gain_note(result: &EnergyResult) -> String {
    let worst = &result.worst;
    if worst.gain < 1e-4 {
        return String::new();
    }
    let contact = worst.contact.map_or(String::new(), |([a, b], kind, depth)| {
        format!(", most by {} of blocks {a}, {b}, {:.1} mm deep", kind.name(), 1e3 * depth)
    });
    let unconverged = if worst.converged { "" } else { ", not converged" };
    format!(
        "run {}, step {} at {:.3} s, Δt {} ms{unconverged}: new contacts {}, springs found again {}{contact}",
        result.run.variant,
        worst.step,
        worst.time,
        short(1e3 * worst.time_step),
        percent(worst.new),
        percent(worst.found_again),
    )
}

/// A share in percent, to two digits; nothing below a ten-thousandth of a percent.
fn percent(share: f64) -> String {
    if share.abs() < 1e-6 { "0 %".to_owned() } else { format!("{} %", signed(100.0 * share)) }
}

fn signed(value: f64) -> String {
    if value < 0.0 { format!("−{}", short(-value)) } else { short(value) }
}

/// What comes back of a speed, by p and Δt.
pub fn restitution(all: &[Restitution]) -> String {
    let mut out = String::from("| p |");
    TIME_STEPS.iter().for_each(|step| out.push_str(&format!(" Δt {} ms |", 1e3 * step)));
    out.push_str("\n| ---: |");
    TIME_STEPS.iter().for_each(|_| out.push_str(" ---: |"));
    out.push('\n');
    for stiffness in STIFFNESSES {
        let _ = write!(out, "| {stiffness:.0e} N/m |");
        for one in all.iter().filter(|one| one.stiffness == stiffness) {
            let [least, mean, most] = one.back;
            let _ = write!(out, " {least:.3} {mean:.3} {most:.3} |");
        }
        out.push('\n');
    }
    out
}

/// Speeds of the wave of dominoes by Δt (m/s).
pub fn dominoes(rows: &[(Row, f64)]) -> String {
    let mut out = String::from("| Δt | hinged at their edges | on a floor, tan φ = 1 |\n| ---: | ---: | ---: |\n");
    for (row, speed) in rows.iter().filter(|(row, _)| row.hinged) {
        let free = rows.iter().find(|(other, _)| !other.hinged && other.time_step == row.time_step);
        let free = free.map_or(String::new(), |(_, speed)| format!("{speed:.3}"));
        let _ = writeln!(out, "| {} ms | {speed:.3} | {free} |", 1e3 * row.time_step);
    }
    let _ = writeln!(out, "| rigid, plastic impacts | {:.3} | |", crate::dominoes::rigid_speed());
    out
}

/// The wall at rest.
pub fn wall(all: &[(Wall, WallDrift)]) -> String {
    let mut out = String::from(
        "| bricks | settling moves them by | drift in 0.5 s | in 1 s | fastest brick at the end | forces on the floor against the weight |\n\
         | --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for (wall, drift) in all {
        let motion = if wall.motion == Motion::Rigid { "rigid" } else { "deformable" };
        let _ = writeln!(
            out,
            "| {} {motion} | {} m | {} m | {} m | {} m/s | {} |",
            drift.bricks,
            short(drift.settled),
            short(drift.drift[0]),
            short(drift.drift[1]),
            short(drift.speed),
            short(drift.weight)
        );
    }
    out
}

/// How iterations end and how deep contacts are kept, with a line for all.
pub fn iterations(all: &[(String, IterationCensus)]) -> String {
    let mut out = String::from(
        "| runs | steps | attempts | solves a step | end with the seventh unchanged solve | cuts | halvings | not converged | \
         contacts kept beyond g | deepest kept, over g |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    let total = all.iter().fold(IterationCensus::default(), |sum, (_, census)| sum.and(*census));
    let total = ("**all**".to_owned(), total);
    for (name, census) in all.iter().chain([&total]) {
        let _ = writeln!(
            out,
            "| {} {name} | {} | {} | {:.2} | {} | {} | {} | {} | {} | {} |",
            census.runs,
            census.steps,
            census.attempts,
            census.solves as f64 / census.steps.max(1) as f64,
            census.sevenths,
            census.cuts,
            census.halvings,
            census.unconverged,
            census.beyond,
            short(census.deepest),
        );
    }
    out
}

/// The pour of rigid bricks as it is, with cohesion and with a load, by Δt.
pub fn pours(all: &[(Pour, EnergyResult)]) -> String {
    let mut out = String::from(
        "| ten bricks poured | Δt | gained in one step, at most | in all | left at the end | not converged | the step that gained most |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | --- |\n",
    );
    for (pour, result) in all {
        let _ = writeln!(
            out,
            "| {} | {} ms | {}{} | {} | {} | {} of {} | {} |",
            pour.name(),
            1e3 * result.run.time_step,
            if result.worst.gain > STEP_GOAL { "**missed** " } else { "" },
            percent(result.worst.gain),
            percent(result.gained),
            percent(result.left),
            result.steps[1],
            result.steps[0],
            largest_gain_note(result),
        );
    }
    out
}
