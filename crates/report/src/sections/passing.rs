//! Overlaps and passages in runs whose steps were audited.

use super::{Section, SectionPart};
use crate::load::Results;
use crate::motion::MotionRun;
use crate::table::{Table, TableCell};
use rockproof_simulate::audit::PairExtreme;

/// The section; `None` where no run was audited and the section on lockstep has them all.
pub(super) fn section(results: &Results) -> Option<Section> {
    let runs = &results.motions;
    if runs.iter().all(|run| run.audit().is_none()) && results.without_lockstep().next().is_none() {
        return None;
    }
    let mut section = Section::new(
        "audit",
        "Do blocks pass through one another?",
        "Runs of a scene: pairs of blocks that overlap where no contact sees it after a step, and pairs that pass through one \
         another within a step, calculated exactly from the stepper's coordinates.",
    );
    for run in runs {
        let cut = run.cut_short().map_or(String::new(), |cut| format!("{cut}; "));
        section.parts.push(SectionPart::Text(format!("{}: {cut}{}.", run.name, run.sentence())));
    }
    section.parts.push(SectionPart::Table(table(runs), 60));
    if runs.iter().any(|run| !run.intrusions.is_empty()) {
        section.parts.push(SectionPart::Table(causes(runs), 60));
    }
    Some(section)
}

fn table(runs: &[MotionRun]) -> Table {
    let mut table = Table::new(
        "audit",
        "Overlaps and passages; worst pairs by their blocks. Empty where steps were not audited, or passages not looked for",
        &[
            "run",
            "engine",
            "ending",
            "steps",
            "steps_unseen",
            "most_unseen_pairs",
            "worst_unseen",
            "worst_unseen_m",
            "passages",
            "undecided_passages",
            "worst_passage",
            "worst_passage_m",
            "deepest",
            "deepest_m",
            "steps_deep",
            "steps_explained",
            "most_explained_pairs",
            "worst_explained",
            "worst_explained_m",
        ],
    );
    for run in runs {
        let mut row: Vec<TableCell> =
            vec![run.name.as_str().into(), run.engine.as_str().into(), run.ending.as_str().into()];
        row.push(TableCell::Count(run.totals.steps + run.totals.settling));
        match run.audit() {
            None => row.resize_with(table.columns.len(), || TableCell::Empty),
            Some(audit) => {
                row.extend([audit.steps_unseen, audit.most_unseen].map(TableCell::Count));
                row.extend(pair(audit.worst_unseen));
                row.extend(
                    [audit.passages, audit.undecided].map(|count| count.map_or(TableCell::Empty, TableCell::Count)),
                );
                row.extend([audit.worst_passage, audit.deepest].into_iter().flat_map(pair));
                row.extend([audit.steps_deep, audit.steps_explained, audit.most_explained].map(TableCell::Count));
                row.extend(pair(audit.worst_explained));
            }
        }
        table.push(row);
    }
    table
}

/// The worst passages and the worst overlaps that became unseen, with their causes.
fn causes(runs: &[MotionRun]) -> Table {
    let mut table = Table::new(
        "audit_causes",
        "The worst passages of each run and the worst overlaps that became unseen in it, with their causes; overlaps that were unseen when it began have none. rockproof replay shows the cases",
        &["run", "step", "change", "blocks", "depth_m", "cause", "before", "after", "case_blocks", "case"],
    );
    for run in runs {
        for row in &run.intrusions {
            let blocks = row.case_blocks.map_or(TableCell::Empty, |blocks| TableCell::Count(blocks as u64));
            let pair = format!("{}-{}", row.block_a, row.block_b);
            let [step, change] = [row.step.to_string(), row.change.clone()].map(TableCell::Text);
            let [cause, before, after] =
                [&row.cause, &row.before, &row.after].map(|text| TableCell::Text(text.clone()));
            let (depth, case) = (TableCell::Number(row.depth_m), TableCell::Text(row.case.clone()));
            let pair = TableCell::Text(pair);
            table.push(vec![run.name.as_str().into(), step, change, pair, depth, cause, before, after, blocks, case]);
        }
    }
    table
}

fn pair(worst: Option<PairExtreme>) -> [TableCell; 2] {
    match worst {
        None => [TableCell::Empty, TableCell::Empty],
        Some(PairExtreme { blocks: [a, b], depth_m, .. }) => {
            [TableCell::Text(format!("{a}-{b}")), TableCell::Number(depth_m.0)]
        }
    }
}
