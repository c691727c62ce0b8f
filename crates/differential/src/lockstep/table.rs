//! Rows of `lockstep.csv` and `differences.csv` (docs/lockstep.md).

use crate::finding::{Cause, DecidingDecision};
use crate::lockstep::explain::AttributedDifference;
use crate::lockstep::run::ComparedStep;

/// Columns of `lockstep.csv`.
pub const STEPS: [&str; 30] = [
    "step",
    "time_s",
    "contacts_stepper",
    "contacts_oracle",
    "contacts_differ",
    "modes_differ",
    "first_mode_difference",
    "iterations_stepper",
    "iterations_oracle",
    "converged_stepper",
    "converged_oracle",
    "retries_stepper",
    "retries_oracle",
    "time_step_stepper_s",
    "time_step_oracle_s",
    "displacement_error",
    "worst_block",
    "penetration_stepper_m",
    "penetration_oracle_m",
    "undecided",
    "tolerance",
    "representation",
    "arithmetic",
    "defect",
    "effect",
    "penetration_contacts_m",
    "penetration_modes_m",
    "failure",
    "velocity_error",
    "anchor_error_m",
];

/// Columns of `differences.csv`.
pub const DIFFERENCES: [&str; 18] = [
    "step",
    "time_s",
    "cause",
    "change",
    "block_a",
    "block_b",
    "kind",
    "feature_a",
    "feature_b",
    "solve",
    "before",
    "after",
    "predicate",
    "features",
    "margin",
    "margin_ulps",
    "unsettled",
    "state",
];

/// The causes that lockstep tells apart, in the order of the chain.
pub const CAUSES: [Cause; 4] = [Cause::Tolerance, Cause::Representation, Cause::Arithmetic, Cause::Defect];

fn number(value: f64) -> String {
    format!("{value:?}")
}

fn cell<T>(value: Option<T>, text: impl Fn(T) -> String) -> String {
    value.map_or(String::new(), text)
}

/// The row of a step.
pub fn step_row(step: &ComparedStep) -> Vec<String> {
    let [stepper, oracle] = [&step.stepper, &step.oracle].map(Option::as_ref);
    let both = |text: &dyn Fn(&crate::lockstep::StepDecisions) -> String| [cell(stepper, text), cell(oracle, text)];
    let own = || step.differences.iter().filter(|c| matches!(c.cause, Cause::Arithmetic | Cause::Defect));
    let mut row = vec![step.step.to_string(), number(step.time)];
    row.extend(both(&|answer| answer.contacts.len().to_string()));
    row.push(own().filter(|c| c.difference.is_of_contacts()).count().to_string());
    let solves: Vec<usize> = own().filter_map(|c| c.difference.solve).collect();
    row.extend([solves.len().to_string(), cell(solves.iter().min(), usize::to_string)]);
    row.extend(both(&|answer| answer.iterations().to_string()));
    row.extend(both(&|answer| answer.converged.to_string()));
    row.extend(both(&crate::lockstep::StepDecisions::retries_text));
    row.extend(both(&|answer| number(answer.time_step)));
    row.push(cell(step.displacement, |(error, _)| number(error)));
    row.push(cell(step.displacement, |(_, block)| block.to_string()));
    row.extend(step.penetration.map(|depth| cell(depth, number)));
    row.push(step.undecided.to_string());
    row.extend(CAUSES.map(|cause| step.count(cause).to_string()));
    row.push(cell(step.depths, |depths| depths.effect().name().to_owned()));
    row.push(cell(step.depths, |depths| number(depths.contacts)));
    row.push(cell(step.depths, |depths| number(depths.modes)));
    row.push(step.failure.clone());
    row.extend([step.velocity, step.anchors].map(|error| cell(error, number)));
    row
}

/// The rows of a step's differences; `state` is the state file's name, if one was written.
pub fn difference_rows(step: &ComparedStep, state: &str) -> Vec<Vec<String>> {
    let row = |attributed: &AttributedDifference| {
        let difference = &attributed.difference;
        let mut row = vec![step.step.to_string(), number(step.time)];
        row.extend([attributed.cause.name(), difference.change.name()].map(str::to_owned));
        let (pair, contact) = difference.contact.unzip();
        row.extend([0, 1].map(|side| cell(pair, |pair: [u32; 2]| pair[side].to_string())));
        row.push(cell(contact, |c| c.kind().name().to_owned()));
        row.extend([0, 1].map(|side| cell(contact, |c| c.key.numbers()[side].to_string())));
        row.push(cell(difference.solve, |solve| solve.to_string()));
        row.extend([difference.before.clone(), difference.after.clone()]);
        let deciding = attributed.deciding.as_ref();
        row.push(cell(deciding, |d| d.decision.predicate.name().to_owned()));
        row.push(cell(deciding, DecidingDecision::features));
        row.push(cell(attributed.margin(), number));
        row.push(cell(attributed.margin_ulps(), number));
        let own = matches!(attributed.cause, Cause::Arithmetic | Cause::Defect);
        row.push(cell(step.unsettled.filter(|_| own), |unsettled| unsettled.to_string()));
        row.push(state.to_owned());
        row
    };
    step.differences.iter().map(row).collect()
}
