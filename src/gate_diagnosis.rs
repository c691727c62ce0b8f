//! What a gate says of its checks: what is wrong with an external engine where some failed, how little few pairs tell where some passed, and no more of
//! alike rows than anybody reads.

use crate::campaign::diagnosed;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::Campaign;
use rockproof_differential::diagnosis::diagnosis_lines;
use rockproof_gate::{Check, CheckStatus};
use rockproof_model::text::noun;
use rockproof_report::load::Results;
use rockproof_report::verdict::few_pairs_note as note_of_few;
use std::sync::atomic::AtomicBool;

/// Failed checks of a baseline that the terminal shows.
const MAX_OF_BASELINE: usize = 20;

/// Looks for what is wrong with external engines where a check fails, and writes it to the campaign's directory; a line for each thing found.
pub(crate) fn lines(campaign: &Campaign<'_>, journal: &mut Journal, checks: &[Check]) -> anyhow::Result<Vec<String>> {
    if checks.iter().all(|check| check.status != CheckStatus::Fail) {
        return Ok(Vec::new());
    }
    diagnosed(campaign, journal, &AtomicBool::new(false))?;
    let results = Results::read(&[journal.dir().to_owned()])?;
    Ok(results.campaigns.iter().flat_map(|campaign| diagnosis_lines(&campaign.diagnosis)).collect())
}

/// That a campaign of so many pairs tells little, where a limit or the baseline passed; `None` of more pairs.
pub(crate) fn few_pairs_note(pairs: u64, checks: &[Check]) -> Option<String> {
    let is_of_findings = |check: &&Check| ["limit", "baseline"].contains(&check.group);
    let has_passed = checks.iter().filter(is_of_findings).any(|check| check.status == CheckStatus::Pass);
    note_of_few(pairs).filter(|_| has_passed)
}

/// The rows that the terminal shows of some checks: cases that pass in one, and of many failed ones of the baseline none behind the first.
pub(crate) fn rows(checks: &[Check]) -> Vec<Vec<String>> {
    let is_of_baseline = |check: &&Check| check.group == "baseline" && check.status == CheckStatus::Fail;
    let left_out = checks.iter().filter(is_of_baseline).count().saturating_sub(MAX_OF_BASELINE);
    let mut shown = 0;
    let is_shown = |check: &&Check| {
        shown += usize::from(is_of_baseline(check));
        !is_of_baseline(check) || shown <= MAX_OF_BASELINE
    };
    let told = checks.iter().filter(|check| check.group != "corpus" || check.status != CheckStatus::Pass);
    let row = |check: &Check| vec![check.status.name().to_owned(), check.name.clone(), check.message.clone()];
    let mut rows: Vec<Vec<String>> = told.filter(is_shown).map(row).collect();
    let cases = checks.iter().filter(|check| check.group == "corpus" && check.status == CheckStatus::Pass).count();
    if cases > 0 {
        let (pass, found) =
            (CheckStatus::Pass.name().to_owned(), format!("{cases} {} passed", noun(cases, "case", "cases")));
        rows.insert(0, vec![pass, "corpus".to_owned(), found]);
    }
    if left_out > 0 {
        let more = format!("{left_out} more sorts of finding that fail; --format json and --junit have all");
        rows.push(vec![CheckStatus::Fail.name().to_owned(), "baseline".to_owned(), more]);
    }
    rows
}
