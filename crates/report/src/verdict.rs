//! The verdict: three lines that sum up, and one for each external engine.

use super::load::{CampaignRun, Results, agreeing_share};
use super::own;
use super::stress_reach::{Reach, reach};
use super::table::{grouped, label, percent, short};
use rockproof_campaign::stress::PairAlignment;
use rockproof_differential::agreement::ChainSpan;
use rockproof_differential::engine::EngineCounts;
use rockproof_differential::finding::Cause;
use rockproof_simulate::AuditTotals;
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

/// The lines. Where there are campaigns and steps, the last is about the steps.
pub fn verdict(results: &Results) -> Vec<VerdictLine> {
    let mut lines = Vec::new();
    let steps = steps(results);
    let external = own::lines(&results.campaigns);
    let most = 3 + external.len();
    if !results.campaigns.is_empty() {
        lines.push(right(&results.campaigns));
        lines.extend(external);
        lines.push(mistakes(&results.campaigns));
        lines.extend(tolerances(&results.campaigns).filter(|_| steps.is_empty()));
    }
    if !results.stresses.is_empty() {
        // Its pairs make a campaign as well; what it was made for comes first.
        lines = stress(results);
        lines.extend(own::lines(&results.campaigns));
    }
    lines.extend(steps);
    // Blocks that pass through one another come before everything else.
    let objections = results.motions.iter().filter(|run| run.audit().is_some_and(AuditTotals::objects));
    let objections = objections.map(|run| line(Severity::Bad, format!("{}: {}.", run.name, run.sentence())));
    lines.splice(..0, objections.take(1));
    if lines.is_empty() {
        lines.extend(results.motions.first().map(|run| {
            let severity = if run.audit().is_some() { Severity::Good } else { Severity::Fair };
            line(severity, format!("{}: {}.", run.name, run.sentence()))
        }));
    }
    if lines.is_empty() {
        lines.extend(times(results));
    }
    lines.truncate(most);
    lines
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
    let of = |engine: &str, form| -> Reach {
        reach(limits().filter(|limit| limit.curve.engine == engine && limit.curve.form == form))
    };
    let mut lines: Vec<VerdictLine> = engines
        .iter()
        .rev()
        .take(2)
        .map(|engine| {
            let Reach { safe, never, untold } = of(engine, PairAlignment::Generic);
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
        let Reach { safe, untold, .. } = of(engine, PairAlignment::Aligned);
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

/// How often engines are right.
fn right(campaigns: &[CampaignRun]) -> VerdictLine {
    let mut severity = Severity::Good;
    let mut words = Vec::new();
    for campaign in campaigns {
        for engine in campaign.engines() {
            let Some(share) = agreeing_share(&campaign.of_engine(&engine)) else { continue };
            if share.value < 1.0 {
                severity = Severity::Fair;
            }
            let again = campaign.run.external_engines.get(&engine).and_then(EngineCounts::recovered_note);
            if again.is_some() {
                severity = Severity::Bad;
            }
            let again = again.map_or(String::new(), |told| format!(", but {told}"));
            let name = if campaigns.len() > 1 { format!("{engine} ({})", campaign.name) } else { engine };
            let [value, low, high] = [share.value, share.low, share.high].map(percent);
            words.push(format!("{name} {value} ({low} to {high}){again}"));
        }
    }
    words.truncate(4);
    if words.is_empty() {
        return line(Severity::Fair, "No answer of any engine could be compared.".to_owned());
    }
    line(severity, format!("Exactly right on hard pairs: {}.", words.join("; ")))
}

/// Whether the code of the built-in engines is mistaken, and what the other findings are due to, those of external engines apart.
fn mistakes(campaigns: &[CampaignRun]) -> VerdictLine {
    let count =
        |cause: Cause| -> u64 { campaigns.iter().map(|c| c.tally.by_cause().get(&cause).copied().unwrap_or(0)).sum() };
    let total: u64 = campaigns.iter().map(|c| c.tally.total).sum();
    if campaigns.iter().all(|campaign| campaign.run.pairs == 0) {
        return line(Severity::Fair, "No pair has been examined to its end, so nothing is known.".to_owned());
    }
    if total == 0 {
        return line(Severity::Good, "No difference was found at all.".to_owned());
    }
    let builtin: BTreeSet<String> = campaigns
        .iter()
        .flat_map(|campaign| {
            let external = own::external(campaign);
            campaign.engines().into_iter().filter(move |engine| !external.contains(engine))
        })
        .collect();
    let outside = campaigns.iter().any(|campaign| !own::external(campaign).is_empty());
    let total = total - count(Cause::Engine);
    let rest: Vec<String> = Cause::ALL
        .into_iter()
        .filter(|cause| !matches!(cause, Cause::Defect | Cause::Engine) && count(*cause) > 0)
        .map(|cause| format!("{cause} {}", percent(count(cause) as f64 / total as f64)))
        .collect();
    let rest = if rest.is_empty() { "nothing".to_owned() } else { rest.join(", ") };
    if builtin.is_empty() {
        let text = format!("Whatever the engine, {} findings are due to: {rest}.", grouped(total));
        return line(Severity::Fair, text);
    }
    // Beside an engine from outside, of which nobody can say so much, it must be clear whose code is meant.
    let of =
        if outside { format!(" of {}", builtin.into_iter().collect::<Vec<_>>().join(", ")) } else { String::new() };
    if total == 0 {
        return line(Severity::Good, format!("No difference was found in the answers{of}."));
    }
    let in_steps: u64 = campaigns.iter().flat_map(|c| &c.steps).map(|(_, counts)| counts.defect).sum();
    match count(Cause::Defect) {
        0 if in_steps > 0 => line(
            Severity::Bad,
            format!("{} differences of the pairs' steps are mistakes in code: look at these first.", grouped(in_steps)),
        ),
        0 => line(
            Severity::Good,
            format!("No mistake in code{of}. What differs ({} findings) is due to: {rest}.", grouped(total)),
        ),
        n => line(
            Severity::Bad,
            format!("{} findings are mistakes in code{of}: look at these first. The others: {rest}.", grouped(n)),
        ),
    }
}

/// Which setting changes most by itself.
fn tolerances(campaigns: &[CampaignRun]) -> Option<VerdictLine> {
    let mut shares: Vec<(f64, String)> = Vec::new();
    for campaign in campaigns {
        for (compared, sums) in campaign.by_setting() {
            if compared.span == ChainSpan::Tolerance && campaign.shows(&compared.tolerances) {
                let name = label(campaigns.len(), &campaign.name, &compared.tolerances);
                shares.extend(agreeing_share(&sums).map(|s| (1.0 - s.value, name)));
            }
        }
    }
    shares.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let ((most, worst), (least, best)) = (shares.first()?, shares.last()?);
    let text = if worst == best {
        format!(
            "The tolerances of \"{worst}\" alone, without any rounding, change the contacts of {} of the pairs.",
            percent(*most)
        )
    } else {
        let least = if *least > 0.0 { format!(", of {} under \"{best}\"", percent(*least)) } else { String::new() };
        format!(
            "Tolerances alone, without any rounding, change the contacts of {} of the pairs under \"{worst}\"{least}.",
            percent(*most)
        )
    };
    Some(line(if *most > 0.0 { Severity::Fair } else { Severity::Good }, text))
}

/// What became of it in motion.
fn steps(results: &Results) -> Vec<VerdictLine> {
    let runs = &results.locksteps;
    let steps: u64 = runs.iter().map(|r| r.steps).sum();
    let contacts: u64 = runs.iter().map(|r| r.contacts_differ).sum();
    let iterations: u64 = runs.iter().map(|r| r.iterations_differ).sum();
    let defects: u64 = runs.iter().filter_map(|r| r.causes.get(&Cause::Defect)).sum();
    let deepest = runs.iter().map(|r| r.penetration_difference_m).fold(0.0, f64::max);
    let mut lines = Vec::new();
    if !runs.is_empty() {
        let severity = if contacts + iterations == 0 { Severity::Good } else { Severity::Fair };
        lines.push(line(
            severity,
            format!(
                "In motion, {} of {} steps have other contacts than the exact ones, {} another number of iterations.",
                grouped(contacts),
                grouped(steps),
                grouped(iterations)
            ),
        ));
        lines.push(line(
            Severity::Fair,
            format!("Overlaps after a step differ from the exact ones by at most {} m.", short(deepest)),
        ));
        lines.push(match defects {
            0 => line(Severity::Good, "No mistake in code was found in the steps.".to_owned()),
            n => line(Severity::Bad, format!("{} differences of the steps are mistakes in code.", grouped(n))),
        });
    }
    lines
}
