//! The verdict: a few lines that sum up, and one for each external engine.

#[cfg(test)]
mod tests;

use super::external_findings;
use super::load::{CampaignRun, Results, agreeing_share};
use super::motion_verdict::{cut_line, doubt_lines, lockstep_lines, motion_line};
use super::safe_levels::{SafeLevels, safe_levels};
use super::step_verdict::step_line;
use super::table::{counted, grouped, label, percent};
use rockproof_campaign::stress::PairAlignment;
use rockproof_differential::agreement::{AgreementCounts, ChainSpan};
use rockproof_differential::engine::EngineCounts;
use rockproof_differential::finding::Cause;
use serde::Serialize;
use std::collections::BTreeSet;

/// How a line is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// As it should be.
    Good,
    /// To know.
    Fair,
    /// To act upon.
    Bad,
}

/// A line of the verdict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VerdictLine {
    /// How it is meant.
    pub severity: Severity,
    /// The line.
    pub text: String,
}

fn line(severity: Severity, text: String) -> VerdictLine {
    VerdictLine { severity, text }
}

/// Lines of the verdict, those about external engines and bad ones apart.
const MAX_LINES: usize = 4;

/// The lines. A bad one is never left out.
pub fn verdict(results: &Results) -> Vec<VerdictLine> {
    let mut lines = Vec::new();
    let external = external_findings::lines(&results.campaigns);
    let unfinished = unfinished(&results.campaigns);
    let most = MAX_LINES + external.len() + usize::from(unfinished.is_some());
    if !results.campaigns.is_empty() && counted_pairs(&results.campaigns) == 0 && results.stresses.is_empty() {
        // No engine is to blame where a campaign was interrupted before it knew anything.
        lines.extend(mistakes(&results.campaigns));
    } else if !results.campaigns.is_empty() {
        lines.push(right(&results.campaigns));
        if results.stresses.is_empty() {
            lines.extend(external.clone());
        }
        lines.extend(mistakes(&results.campaigns));
        lines.extend(step_line(&results.campaigns));
        lines.extend(tolerances(&results.campaigns).filter(|_| results.locksteps.is_empty()));
    }
    if !results.stresses.is_empty() {
        // Its pairs make a campaign as well; what it was made for comes first.
        lines.retain(|line| line.severity == Severity::Bad);
        lines.splice(..0, stress(results).into_iter().chain(external));
    }
    lines.splice(..0, unfinished);
    lines.extend(lockstep_lines(&results.locksteps));
    match motion_line(&results.motions) {
        // Blocks that pass through one another come before everything else.
        Some(line) if line.severity == Severity::Bad => lines.insert(0, line),
        motion => lines.extend(motion),
    }
    // Before what the runs came to.
    let place = usize::from(lines.first().is_some_and(|line| line.severity == Severity::Bad));
    lines.splice(place..place, cut_line(&results.motions).into_iter().chain(doubt_lines(&results.motions)));
    if lines.is_empty() {
        lines.extend(times(results));
    }
    while lines.len() > most {
        let Some(last) = lines.iter().rposition(|line| line.severity != Severity::Bad) else { break };
        lines.remove(last);
    }
    lines
}

/// That campaigns were not made to their end, so that what follows may change; `None` where all were, or where nothing is known yet.
fn unfinished(campaigns: &[CampaignRun]) -> Option<VerdictLine> {
    let of = |campaign: &CampaignRun| {
        let all = campaign.run.configuration.get("pairs").and_then(|pairs| pairs.as_u64());
        let all =
            all.filter(|_| campaign.part().is_none()).map_or(String::new(), |all| format!(" of {}", grouped(all)));
        let name = if campaigns.len() > 1 { format!("{}, ", campaign.name) } else { String::new() };
        format!("{name}interrupted after {}{all} pairs", grouped(campaign.run.pairs))
    };
    let are: Vec<String> =
        campaigns.iter().filter(|campaign| campaign.is_interrupted() && campaign.run.pairs > 0).map(of).collect();
    let words = are.join("; ");
    (!are.is_empty())
        .then(|| line(Severity::Fair, format!("Not finished ({words}): the rest is about these pairs alone.")))
}

/// What was measured, where there is nothing else.
fn times(results: &Results) -> Option<VerdictLine> {
    let all: Vec<_> = results.timings.iter().flat_map(|run| &run.measurements).collect();
    let efficient = all.iter().filter(|m| m.efficient).count();
    (!all.is_empty()).then(|| {
        line(
            Severity::Fair,
            format!("{} measurements of run time against error, {efficient} of them efficient.", all.len()),
        )
    })
}

/// How far each engine is safe without ties, and how it is with them.
fn stress(results: &Results) -> Vec<VerdictLine> {
    let limits = || results.stresses.iter().flat_map(|run| &run.limits);
    let engines: BTreeSet<&str> = limits().map(|limit| &*limit.curve.engine).collect();
    let of = |engine: &str, form| -> SafeLevels {
        safe_levels(limits().filter(|limit| limit.curve.engine == engine && limit.curve.form == form))
    };
    let mut lines: Vec<VerdictLine> = engines
        .iter()
        .rev()
        .take(2)
        .map(|engine| {
            let SafeLevels { safe, never, untold } = of(engine, PairAlignment::Generic);
            let mut words = match (safe.is_empty(), untold.is_empty()) {
                (false, _) => format!("safe {}", safe.join("; ")),
                (true, false) => "no way tried is known to be safe".to_owned(),
                (true, true) => "safe in none of the ways tried".to_owned(),
            };
            if !untold.is_empty() {
                words += &format!("; too few pairs to tell: {}", untold.join("; "));
            }
            if !never.is_empty() && !safe.is_empty() {
                words += "; not in the other ways tried";
            }
            let severity = match (safe.is_empty(), never.is_empty() && untold.is_empty()) {
                (false, true) => Severity::Good,
                (true, _) if untold.is_empty() => Severity::Bad,
                _ => Severity::Fair,
            };
            line(severity, format!("{engine}, no ties: {words}."))
        })
        .collect();
    let nowhere = |engine: &&str| {
        let SafeLevels { safe, untold, .. } = of(engine, PairAlignment::Aligned);
        safe.is_empty() && untold.is_empty()
    };
    let tied: Vec<&str> = engines.iter().copied().filter(nowhere).collect();
    let shares = limits().filter(|limit| limit.curve.form == PairAlignment::Aligned && limit.safe_to.is_none());
    let most = shares.filter_map(|limit| limit.beyond.as_ref()).map(|(_, share)| *share).fold(0.0, f64::max);
    if !tied.is_empty() && most > 0.0 {
        lines.push(line(
            Severity::Fair,
            format!(
                "With ties (faces flush, corners on edges) {} safe nowhere: up to {} of the pairs differ even at the mildest levels.",
                if tied.len() == 1 { format!("{} is", tied[0]) } else { format!("{} are", tied.join(" and ")) },
                percent(most)
            ),
        ));
    }
    lines
}

/// Whether campaigns made steps, and no answer to any of their pairs could be compared.
pub(super) fn makes_steps_alone(campaigns: &[CampaignRun]) -> bool {
    let is_compared = |campaign: &CampaignRun| {
        campaign.engines().iter().any(|engine| agreeing_share(&campaign.of_engine(engine)).is_some())
    };
    !campaigns.iter().any(is_compared) && campaigns.iter().any(|campaign| !campaign.steps.is_empty())
}

/// How often engines are right.
fn right(campaigns: &[CampaignRun]) -> VerdictLine {
    let mut severity = Severity::Good;
    let mut words = Vec::new();
    for campaign in campaigns {
        for engine in campaign.engines() {
            let counts = campaign.of_engine(&engine);
            let Some(share) = agreeing_share(&counts) else { continue };
            // As of one that crashes at every pair, or where rounding makes every block degenerate.
            let silent = if counts.silent == counts.pairs { ", without an answer to any pair" } else { "" };
            let supported = of_supported(campaign, &engine, &counts);
            let detail = campaign.run.external_engines.get(&engine).and_then(|counts| counts.detail.incomplete_note());
            let unsaid = detail.map_or(String::new(), |note| format!(", {note}"));
            if share.value < 1.0 && severity == Severity::Good {
                severity = Severity::Fair;
            }
            let again = campaign.run.external_engines.get(&engine).and_then(EngineCounts::recovered_note);
            if again.is_some() {
                severity = Severity::Bad;
            }
            let again = again.map_or(String::new(), |told| format!(", but {told}"));
            let name = if campaigns.len() > 1 { format!("{engine} ({})", campaign.name) } else { engine };
            let [value, low, high] = [share.value, share.low, share.high].map(percent);
            let of = counted(counts.pairs, "comparison", "comparisons");
            words.push(format!("{name} {value} of {of} ({low} to {high}){silent}{supported}{unsaid}{again}"));
        }
    }
    words.truncate(4);
    if makes_steps_alone(campaigns) {
        return line(Severity::Fair, "No pair was classified: the pairs made steps alone.".to_owned());
    }
    if words.is_empty() {
        return line(Severity::Fair, "No answer of any engine could be compared.".to_owned());
    }
    line(severity, format!("Exactly right on hard pairs: {}.", words.join("; ")))
}

/// How often an engine is right of the pairs that it supports, where it says of some that it does not: these count as not right in the share of all.
fn of_supported(campaign: &CampaignRun, engine: &str, counts: &AgreementCounts) -> String {
    let unsupported = campaign.tally.own.get(engine).map_or(0, |own| own.unsupported);
    match counts.pairs.checked_sub(unsupported) {
        Some(supported) if unsupported > 0 && supported > 0 => {
            let share = percent(counts.agreeing as f64 / supported as f64);
            format!(", {share} of the {} that it supports", counted(supported, "comparison", "comparisons"))
        }
        _ => String::new(),
    }
}

/// So many pairs without a mistake must there be before that is called well: a mistake that shows in one pair of a hundred shows in one of these with
/// 95 % (1 − 0.99³⁰⁰).
pub(super) const MIN_PAIRS: u64 = 300;

/// What is said of fewer.
pub(super) fn few_pairs() -> String {
    format!("So few pairs tell little: {MIN_PAIRS} show a mistake of one pair in a hundred with 95 %.")
}

/// What a gate says of so few; `None` of none or of more.
pub fn few_pairs_note(pairs: u64) -> Option<String> {
    (1..MIN_PAIRS).contains(&pairs).then(|| format!("{} examined. {}", counted(pairs, "pair", "pairs"), few_pairs()))
}

/// How many pairs campaigns examined, in words, and which part of how many that is.
fn pairs_in_words(campaigns: &[CampaignRun]) -> String {
    let pairs = counted_pairs(campaigns);
    let part = match campaigns {
        [one] => one.part().map_or(String::new(), |part| format!(" ({part})")),
        _ => String::new(),
    };
    format!("{}{part}", counted(pairs, "pair", "pairs"))
}

fn counted_pairs(campaigns: &[CampaignRun]) -> u64 {
    campaigns.iter().map(|campaign| campaign.run.pairs).sum()
}

/// A line that no mistake was found: well only where there were pairs enough.
fn none_found(campaigns: &[CampaignRun], text: &str) -> VerdictLine {
    if counted_pairs(campaigns) >= MIN_PAIRS {
        return line(Severity::Good, text.to_owned());
    }
    line(Severity::Fair, format!("{text} {}", few_pairs()))
}

/// Whether the code of the built-in engines is mistaken, in contacts or in steps, and what the other findings about contacts are due to, those of
/// external engines apart; `None` where no contact could be compared and no mistake was found.
fn mistakes(campaigns: &[CampaignRun]) -> Option<VerdictLine> {
    let count =
        |cause: Cause| -> u64 { campaigns.iter().map(|c| c.tally.by_cause().get(&cause).copied().unwrap_or(0)).sum() };
    let total: u64 = campaigns.iter().map(|c| c.tally.total).sum();
    if campaigns.iter().all(|campaign| campaign.run.pairs == 0) {
        return Some(line(Severity::Fair, "No pair has been examined to its end, so nothing is known.".to_owned()));
    }
    // The counts hold contacts of the first step too, the findings what is no step at all, as a panic.
    let in_steps = |c: &CampaignRun| {
        let counted: u64 = c.steps.iter().map(|(_, counts)| counts.defect).sum();
        counted.max(c.step_tally.defects())
    };
    let in_steps: u64 = campaigns.iter().map(in_steps).sum();
    let mut builtin: BTreeSet<String> = BTreeSet::new();
    let mut silent = false;
    for campaign in campaigns {
        let external = external_findings::external(campaign);
        for engine in campaign.engines().into_iter().filter(|engine| !external.contains(engine)) {
            let counts = campaign.of_engine(&engine);
            if counts.silent < counts.pairs {
                builtin.insert(engine);
            } else {
                silent = true;
            }
        }
    }
    let outside = campaigns.iter().any(|campaign| !external_findings::external(campaign).is_empty());
    let is_alone = total == 0;
    let total = total - count(Cause::Engine);
    let rest: Vec<String> = Cause::ALL
        .into_iter()
        .filter(|cause| !matches!(cause, Cause::Defect | Cause::Engine) && count(*cause) > 0)
        .map(|cause| format!("{cause} {}", percent(count(cause) as f64 / total as f64)))
        .collect();
    let rest = if rest.is_empty() { "nothing".to_owned() } else { rest.join(", ") };
    let findings = |n| counted(n, "finding", "findings");
    // Beside an engine from outside, or one without an answer, of which nobody can say so much, it must be clear whose code is meant.
    let of = if (outside || silent) && !builtin.is_empty() {
        format!(" of {}", builtin.iter().cloned().collect::<Vec<_>>().join(", "))
    } else {
        String::new()
    };
    if count(Cause::Defect) > 0 {
        let (are, these) = if count(Cause::Defect) == 1 { ("is a mistake", "this") } else { ("are mistakes", "these") };
        let found = findings(count(Cause::Defect));
        return Some(line(
            Severity::Bad,
            format!("{found} {are} in code{of}: look at {these} first. The others: {rest}."),
        ));
    }
    if in_steps > 0 {
        let (are, these) = if in_steps == 1 { ("is a mistake", "this") } else { ("are mistakes", "these") };
        let found = counted(in_steps, "difference", "differences");
        let text = format!("{found} of the pairs' steps {are} in code: look at {these} first.");
        return Some(line(Severity::Bad, text));
    }
    if campaigns.iter().all(|campaign| campaign.agreement.is_empty()) && total == 0 {
        return None;
    }
    if builtin.is_empty() && silent {
        let differing =
            if total == 0 { String::new() } else { format!(" What differs ({}) is due to: {rest}.", findings(total)) };
        let text = format!("No built-in engine answered, so nothing is known of their code.{differing}");
        return Some(line(Severity::Fair, text));
    }
    if is_alone {
        let text = if campaigns.iter().all(|campaign| campaign.step_tally.total() == 0) {
            "No difference was found at all"
        } else {
            "No difference of contacts was found"
        };
        return Some(none_found(campaigns, &format!("{text} in {}.", pairs_in_words(campaigns))));
    }
    if builtin.is_empty() {
        let text = match total {
            0 => "No finding is due to tolerances or to rounding the input.".to_owned(),
            1 => format!("Whatever the engine, 1 finding is due to: {rest}."),
            n => format!("Whatever the engine, {} are due to: {rest}.", findings(n)),
        };
        return Some(line(Severity::Fair, text));
    }
    if total == 0 {
        let text = format!("No difference was found in the answers{of} for {}.", pairs_in_words(campaigns));
        return Some(none_found(campaigns, &text));
    }
    let text = format!(
        "No mistake in code{of} was found in {}. What differs ({}) is due to: {rest}.",
        pairs_in_words(campaigns),
        findings(total)
    );
    Some(none_found(campaigns, &text))
}

/// So few pairs are counted; of more the share is told.
const FEW: u64 = 20;

/// How many pairs changed, of so many.
fn changed_pairs(counts: &AgreementCounts, share: f64) -> String {
    match counts.pairs {
        n if n < FEW => format!("{} of {}", n - counts.agreeing, counted(n, "pair", "pairs")),
        _ => format!("{} of the pairs", percent(share)),
    }
}

/// Which setting changes most by itself.
fn tolerances(campaigns: &[CampaignRun]) -> Option<VerdictLine> {
    let mut shares: Vec<(f64, String, String)> = Vec::new();
    for campaign in campaigns {
        for (compared, sums) in campaign.by_setting() {
            if compared.span == ChainSpan::Tolerance && campaign.shows(&compared.tolerances) {
                let name = label(campaigns.len(), &campaign.name, &compared.tolerances);
                let changed = agreeing_share(&sums).map(|share| 1.0 - share.value);
                shares.extend(changed.map(|changed| (changed, name, changed_pairs(&sums, changed))));
            }
        }
    }
    shares.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let ((most, worst, pairs), (least, best, fewest)) = (shares.first()?, shares.last()?);
    let text = if worst == best {
        format!("The tolerances of \"{worst}\" alone, without any rounding, change the contacts of {pairs}.")
    } else {
        let least = match fewest.strip_suffix(" of the pairs") {
            _ if *least <= 0.0 => String::new(),
            Some(share) => format!(", of {share} under \"{best}\""),
            None => format!(", of {fewest} under \"{best}\""),
        };
        format!("Tolerances alone, without any rounding, change the contacts of {pairs} under \"{worst}\"{least}.")
    };
    Some(line(if *most > 0.0 { Severity::Fair } else { Severity::Good }, text))
}
