//! An audited `simulate`: why blocks passed through one another or overlap unseen, once the run has ended, and cases to replay it.

use crate::exit::print_note;
use rockproof_differential::lockstep::intrusion_case::MAX_BLOCKS;
use rockproof_examine::IntrusionCases;
use rockproof_model::simulation::step_in_words;
use rockproof_model::{Precision, Scene, ToleranceSet};
use rockproof_simulate::{IntrusionRow, RunError, RunRecord};
use rockproof_stepper::dynamics::Solve;
use serde_json::{Value, json};
use std::fmt::Write;

/// Finds causes and cases of what an audited run kept, and writes them.
pub(crate) fn find_causes<R: Solve>(
    record: &mut RunRecord,
    scene: &Scene,
    set: &ToleranceSet,
    precision: Precision,
) -> Result<(), RunError> {
    let kept = record.progress().intrusions.clone();
    if kept.is_empty() {
        return Ok(());
    }
    print_note(&format!("finding the causes of the worst passages and unseen overlaps, {} in all", kept.len()));
    let IntrusionCases { rows, cases } = IntrusionCases::of::<R>(&kept, scene, set, precision);
    record.write_intrusions(rows, &cases)
}

/// A line for each passage and unseen overlap that was kept, with its causes.
pub(crate) fn write_causes(out: &mut String, rows: &[IntrusionRow]) -> std::fmt::Result {
    for same in rows.chunk_by(|one, other| place(one) == place(other)) {
        let Some(first) = same.first() else { continue };
        let causes: Vec<&str> = same.iter().map(|row| row.cause.as_str()).filter(|cause| !cause.is_empty()).collect();
        let causes = match first.case_blocks {
            _ if !causes.is_empty() => causes.join(", "),
            Some(blocks) if first.case.is_empty() => {
                format!(
                    "unknown: {blocks} blocks show it, no fewer were found, and no more than {MAX_BLOCKS} are stepped exactly"
                )
            }
            _ => "unknown".to_owned(),
        };
        let case = if first.case.is_empty() { String::new() } else { format!("; {}", first.case) };
        let (step, [a, b]) = (step_in_words(first.step), [first.block_a, first.block_b]);
        writeln!(out, "cause            {} {a}–{b}, {step}: {causes}{case}", first.change)?;
    }
    Ok(())
}

/// The same for programs: a value for each cause.
pub(crate) fn causes_json(rows: &[IntrusionRow]) -> Value {
    let text = |text: &String| Some(text.clone()).filter(|text| !text.is_empty());
    let row = |row: &IntrusionRow| {
        json!({
            "step": row.step, "change": row.change, "blocks": [row.block_a, row.block_b], "depth_m": row.depth_m,
            "cause": text(&row.cause), "before": text(&row.before), "after": text(&row.after),
            "case_blocks": row.case_blocks, "case": text(&row.case),
        })
    };
    rows.iter().map(row).collect()
}

/// What a row is about.
fn place(row: &IntrusionRow) -> (i64, &str, usize, usize) {
    (row.step, &row.change, row.block_a, row.block_b)
}
