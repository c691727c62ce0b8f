//! Steps of a run made by stepper and oracle from the same states.

use super::{Section, SectionPart};
use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, LineStyle};
use crate::lockstep::{LockstepRun, StepPoint};
use crate::table::{Table, TableCell, grouped};
use rockproof_differential::finding::Cause;

pub(super) fn section(runs: &[LockstepRun]) -> Section {
    let mut section = Section::new(
        "lockstep",
        "Does it matter once blocks move?",
        "Runs in which the oracle made every step beside the stepper, from the same state: steps with other contacts, modes or \
         numbers of iterations, and how deep blocks overlap afterwards, calculated exactly.",
    );
    section.parts.push(SectionPart::Table(table(runs), 60));
    section.parts.push(SectionPart::Table(causes(runs), 60));
    section.parts.push(SectionPart::Table(sorts(runs), 24));
    section.parts.push(SectionPart::Table(differing(runs), 24));
    let left: u64 = runs.iter().map(|run| run.more_differing).sum();
    if left > 0 {
        section
            .parts
            .push(SectionPart::Text(format!("{} more steps differ: see lockstep.csv of the runs.", grouped(left))));
    }
    for (number, run) in runs.iter().enumerate() {
        section.parts.push(SectionPart::Chart(penetration(number, run).half()));
        if run.iterations_differ > 0 {
            section.parts.push(SectionPart::Chart(iterations(number, run).half()));
        }
    }
    section
}

fn table(runs: &[LockstepRun]) -> Table {
    let mut table = Table::new(
        "lockstep",
        "Steps by what differs, and the deepest overlaps",
        &[
            "run",
            "engine",
            "steps",
            "contacts_differ",
            "modes_differ",
            "iterations_differ",
            "convergence_differs",
            "undecided",
            "deepest_stepper_m",
            "deepest_oracle_m",
            "penetration_difference_m",
            "displacement_error",
            "failure",
        ],
    );
    for run in runs {
        let steps = [
            run.steps,
            run.contacts_differ,
            run.modes_differ,
            run.iterations_differ,
            run.converged_differ,
            run.undecided,
        ];
        let [stepper, oracle] = run.deepest_m;
        let sizes = [stepper, oracle, run.penetration_difference_m, run.displacement_error];
        let names = [run.name.as_str().into(), run.engine.as_str().into()];
        let row = names.into_iter().chain(steps.map(TableCell::Count)).chain(sizes.map(TableCell::Number));
        table.push(row.chain([run.failure.clone().map_or(TableCell::Empty, TableCell::Text)]).collect());
    }
    table
}

fn causes(runs: &[LockstepRun]) -> Table {
    let mut table = Table::new(
        "lockstep_causes",
        "Differences by cause, and steps by what changed the penetration",
        &[
            "run",
            "engine",
            "tolerance",
            "representation",
            "arithmetic",
            "defect",
            "by_classification",
            "by_iteration",
            "by_arithmetic",
            "no_effect",
        ],
    );
    for run in runs {
        let cause = |cause| run.causes.get(&cause).copied().unwrap_or(0);
        let effect = |name| run.effects.get(name).copied().unwrap_or(0);
        let causes = [Cause::Tolerance, Cause::Representation, Cause::Arithmetic, Cause::Defect].map(cause);
        let effects = ["classification", "iteration", "arithmetic", "none"].map(effect);
        let names = [run.name.as_str().into(), run.engine.as_str().into()];
        table.push(names.into_iter().chain(causes.into_iter().chain(effects).map(TableCell::Count)).collect());
    }
    table
}

fn sorts(runs: &[LockstepRun]) -> Table {
    let mut table = Table::new(
        "lockstep_changes",
        "What differs: by cause, change and the predicate behind it",
        &["run", "engine", "cause", "change", "predicate", "differences", "in_steps"],
    );
    for run in runs {
        for ((cause, change, predicate), sort) in &run.sorts {
            let names = [run.name.as_str(), &run.engine, cause.name(), change].map(TableCell::from);
            let predicate = if predicate.is_empty() { TableCell::Empty } else { TableCell::Text(predicate.clone()) };
            let counts = [sort.differences, sort.steps].map(TableCell::Count);
            table.push(names.into_iter().chain([predicate]).chain(counts).collect());
        }
    }
    table
}

fn differing(runs: &[LockstepRun]) -> Table {
    let mut table = Table::new(
        "lockstep_steps",
        "Steps in which the stepper has other contacts, modes or iterations, and the deepest overlap after them: the stepper's, the \
         oracle's, the stepper's with the oracle's contacts, and with its modes too",
        &[
            "run",
            "engine",
            "step",
            "contacts",
            "modes",
            "iterations_stepper",
            "iterations_oracle",
            "effect",
            "stepper_m",
            "oracle_m",
            "with_contacts_m",
            "with_modes_m",
            "displacement_error",
        ],
    );
    for run in runs {
        for step in &run.differing {
            let counts = step.contacts_modes.into_iter().chain(step.iterations).map(TableCell::Count);
            let effect = if step.effect.is_empty() { TableCell::Empty } else { TableCell::Text(step.effect.clone()) };
            let mut row =
                vec![run.name.as_str().into(), run.engine.as_str().into(), TableCell::Text(step.step.to_string())];
            row.extend(counts.chain([effect]).chain(step.depths_m.map(TableCell::number)));
            row.push(TableCell::number(step.displacement_error));
            table.push(row);
        }
    }
    table
}

fn penetration(number: usize, run: &LockstepRun) -> Chart {
    let curve = |name: &str, depth: fn(&StepPoint) -> Option<f64>, at, line| Curve {
        name: name.to_owned(),
        color: ChartColor::Series(at),
        line: Some(line),
        marker: None,
        points: run.points.iter().map(|p| ChartPoint::new(p.step as f64, depth(p).unwrap_or(f64::NAN))).collect(),
    };
    let curves = vec![
        curve(&run.engine, |p| p.stepper_m, 0, LineStyle::Solid),
        curve("oracle", |p| p.oracle_m, 1, LineStyle::Dotted),
    ];
    let axes = [steps_of(run), ChartAxis::from_zero("deepest overlap, m")];
    let caption = format!("{}: deepest overlap after each step", run.name);
    Chart::new(format!("chart-lockstep-{number}"), caption, 340, axes, ChartContent::Curves(curves, None))
}

fn iterations(number: usize, run: &LockstepRun) -> Chart {
    let curve = Curve {
        name: String::new(),
        color: ChartColor::Series(2),
        line: Some(LineStyle::Steps),
        marker: None,
        points: run.points.iter().map(|p| ChartPoint::new(p.step as f64, p.more_iterations as f64)).collect(),
    };
    let axes = [steps_of(run), ChartAxis::from_zero("iterations more than the oracle")];
    let caption = format!("{}: iterations of the stepper less those of the oracle", run.name);
    Chart::new(format!("chart-iterations-{number}"), caption, 280, axes, ChartContent::Curves(vec![curve], None))
}

/// The axis of a run's steps: from the first to the last, those of settling being negative.
fn steps_of(run: &LockstepRun) -> ChartAxis {
    let steps = || run.points.iter().map(|point| point.step as f64);
    let [first, last] = [steps().fold(f64::INFINITY, f64::min), steps().fold(f64::NEG_INFINITY, f64::max)];
    if first < last { ChartAxis::linear("step", [first, last]) } else { ChartAxis::from_zero("step") }
}
