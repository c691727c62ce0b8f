//! What the verdict says of the steps of campaigns: passages, unseen overlaps, and what else differs from the exact steps.

use super::load::CampaignRun;
use super::step_tally::{StepCauses, StepTally, WorstStep};
use super::table::{counted, grouped};
use super::verdict::{Severity, VerdictLine};
use rockproof_campaign::steps::summary::StepCounts;
use std::collections::BTreeMap;

/// One line on the steps of campaigns: passages and unseen overlaps in the engines' steps, by cause and with the worst one, then what else
/// differs. Bad where one of the findings is a mistake in code, fair where there is any finding, or steps that were not watched; good where
/// all were and agree. `None` without a campaign, or where no pair has been examined.
pub fn step_line(campaigns: &[CampaignRun]) -> Option<VerdictLine> {
    if campaigns.iter().all(|campaign| campaign.run.pairs == 0) {
        return None;
    }
    let mut counts = StepCounts::default();
    campaigns.iter().flat_map(|campaign| &campaign.steps).for_each(|(_, of)| counts.add(of));
    let (mut intrusions, mut others) = (StepCauses::default(), StepCauses::default());
    let mut changes: BTreeMap<&str, u64> = BTreeMap::new();
    for StepTally { intrusions: some, others: rest, changes: by_change, .. } in campaigns.iter().map(|c| &c.step_tally)
    {
        intrusions.add_all(some);
        others.add_all(rest);
        by_change.iter().for_each(|(change, count)| *changes.entry(change).or_default() += count);
    }
    let found = intrusions.total() + others.total();
    let severity = match campaigns.iter().map(|campaign| campaign.step_tally.defects()).sum::<u64>() {
        0 if found == 0 && counts.watched > 0 && unwatched(&counts) + counts.passages_undecided == 0 => Severity::Good,
        0 => Severity::Fair,
        _ => Severity::Bad,
    };
    let mut text = watched(&counts, &intrusions);
    if intrusions.total() > 0 {
        // The steps of each engine that makes one alike count above; what engines share is one finding.
        let findings = counted(intrusions.total(), "finding", "findings");
        text += &format!(
            " ({findings}, one where engines share it, by cause: {}{})",
            by_cause(&intrusions),
            worst(campaigns)
        );
    }
    if counts.watched > 0 && unwatched(&counts) > 0 {
        text += &format!("; {} could not be watched", counted(unwatched(&counts), "other step", "other steps"));
    }
    if counts.passages_undecided > 0 && counts.watched > 0 {
        text += &format!("; passages stay undecided in {}", counted(counts.passages_undecided, "step", "steps"));
    }
    if others.total() > 0 {
        let most = changes.into_iter().max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(a.0)));
        let mostly = most.map_or(String::new(), |(change, _)| format!(", mostly {change}"));
        let findings = counted(others.total(), "other finding", "other findings");
        text += &format!("; {findings} in steps ({}{mostly})", by_cause(&others));
    }
    Some(VerdictLine { severity, text: format!("{text}.") })
}

/// Steps that one side or both cannot make, and those of pairs that rounding makes degenerate.
fn unwatched(counts: &StepCounts) -> u64 {
    (counts.steps + counts.silent).saturating_sub(counts.watched)
}

/// What was watched, and what was seen in it.
fn watched(counts: &StepCounts, intrusions: &StepCauses) -> String {
    if counts.steps + counts.silent == 0 {
        return "No step was made, so nothing is known of passages and unseen overlaps".to_owned();
    }
    if counts.watched == 0 {
        let tried = counted(unwatched(counts), "step", "steps");
        return format!("None of {tried} could be watched, so nothing is known of passages and unseen overlaps");
    }
    let steps = counted(counts.watched, "watched step", "watched steps");
    match [counts.passages_stepper, counts.unseen_stepper] {
        [0, 0] if intrusions.total() == 0 => format!("No passage and no unseen overlap in {steps}"),
        [0, 0] => format!("Passages or unseen overlaps in exact steps alone, none in an engine's, of {steps}"),
        [passages, unseen] => {
            let passages = counted(passages, "passage", "passages");
            format!("{passages} and {} in {steps}", counted(unseen, "unseen overlap", "unseen overlaps"))
        }
    }
}

fn by_cause(causes: &StepCauses) -> String {
    causes.counts().map(|(cause, count)| format!("{cause} {}", grouped(count))).collect::<Vec<_>>().join(", ")
}

/// The worst passage or unseen overlap: its case, or its pair where there is none.
fn worst(campaigns: &[CampaignRun]) -> String {
    let of = |campaign: &CampaignRun, worst: &WorstStep| {
        let WorstStep { index, family, tolerances, change, case, .. } = worst;
        let at = if case.is_empty() {
            format!("{change} of pair {index} of {family} under {tolerances}, without a case")
        } else if campaigns.len() > 1 {
            format!("case {case} of {}", campaign.name)
        } else {
            format!("case {case}")
        };
        format!("; worst: {at}")
    };
    let all = campaigns.iter().filter_map(|campaign| Some((campaign, campaign.step_tally.worst_intrusion.as_ref()?)));
    all.min_by(|(_, one), (_, other)| one.rank(other)).map_or(String::new(), |(campaign, worst)| of(campaign, worst))
}
