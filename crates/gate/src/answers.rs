//! Whether external engines answered, and whether anything in a gate is about what they answered.

use super::config::{Baseline, GateConfig};
use super::tally::CampaignTally;
use super::tally_row::TallyRow;
use super::{Check, CheckStatus, limit_scope};
use rockproof_model::text::noun;
use std::collections::{BTreeMap, BTreeSet};

/// A check for each external engine: that it was asked about pairs and answered no less than half of them, and that a limit, the baseline or a case of the corpus, whose engines are
/// given, is about what it answers; `limits` are the checks of [`limits`](super::limits), of which those skipped do not count. `run` names the campaign,
/// `file` the gate file.
pub fn checks(
    config: &GateConfig,
    (file, run): (&str, &str),
    tally: &CampaignTally,
    limits: &[Check],
    corpus: &BTreeSet<String>,
) -> Vec<Check> {
    let known = config.baseline.as_ref().is_some_and(Baseline::is_about_external_engines);
    let check = |spec: &rockproof_differential::external::EngineSpec| {
        let name = &spec.name;
        let answers = tally.answers(name);
        let mut checked = config.limit.iter().zip(limits).filter(|(_, check)| check.status != CheckStatus::Skip);
        let is_limited = checked.any(|(limit, _)| limit_scope::concerns(limit.get_ref(), spec, &answers));
        let silent = answers.are_too_few();
        let (status, message) = if answers.asked == 0 {
            let none = "was asked about no pair of the campaign: none survived rounding, all make steps alone, or there is none";
            match corpus.contains(name) {
                true => (CheckStatus::Skip, format!("{none}; cases of the corpus ask it")),
                false => (CheckStatus::Fail, none.to_owned()),
            }
        } else if silent {
            let (asked, failures) = (answers.asked, failures(tally, name));
            let words = match answers.answered {
                0 => format!("answered none of {asked} {}: {failures}", noun(asked, "pair", "pairs")),
                _ => format!("{}, less than half: {failures}", answers.words()),
            };
            (CheckStatus::Fail, words)
        } else if is_limited || known || corpus.contains(name) {
            (CheckStatus::Pass, answers.words())
        } else {
            let none =
                "no limit checked, no baseline and no case is about what it answers, so whatever it answers would pass";
            let remedy = format!("a limit with engine = \"{name}\" and count, without change and kind, is");
            (CheckStatus::Fail, format!("{}, but {none}; {remedy}", answers.words()))
        };
        let rows = (0..tally.rows.len()).filter(|&at| silent && is_silence(&tally.rows[at], name));
        Check {
            group: "engine",
            name: format!("{run}: engine {name} answers"),
            message,
            status,
            place: (file.to_owned(), 1),
            rows: rows.collect(),
            seconds: 0.0,
            replay: None,
        }
    };
    config.campaign.external.iter().map(check).collect()
}

/// Whether a finding says that the engine did not answer.
fn is_silence(row: &TallyRow, engine: &str) -> bool {
    matches!(row, TallyRow::Pair(row) if row.engine.to_string() == engine && !row.change.is_of_answers())
}

/// What there was instead of answers, most frequent first.
fn failures(tally: &CampaignTally, engine: &str) -> String {
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    for row in tally.rows.iter().filter(|row| is_silence(row, engine)) {
        if let TallyRow::Pair(row) = row {
            *counts.entry(row.change.name()).or_default() += 1;
        }
    }
    let mut counts: Vec<(&str, u64)> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts.iter().map(|(change, count)| format!("{change} {count} times")).collect::<Vec<_>>().join(", ")
}
