//! The verdict: three lines for a tired engineer.

use super::load::{CampaignRun, Results};
use super::sections::stress::reach;
use super::table::{grouped, percent, short};
use rockproof_campaign::stress::Form;
use rockproof_differential::agreement::Span;
use rockproof_differential::finding::Cause;
use rockproof_simulate::AuditTotals;
use serde::Serialize;
use std::collections::BTreeSet;

/// How a line is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mood {
    /// As it should be.
    Good,
    /// To know.
    Fair,
    /// To act upon.
    Bad,
}

/// A line of the verdict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Line {
    /// How it is meant.
    pub mood: Mood,
    /// The line.
    pub text: String,
}

fn line(mood: Mood, text: String) -> Line {
    Line { mood, text }
}

/// The three lines. Where there are campaigns and steps, the third is about the steps.
pub fn verdict(results: &Results) -> Vec<Line> {
    let mut lines = Vec::new();
    let steps = steps(results);
    if !results.campaigns.is_empty() {
        lines.push(right(&results.campaigns));
        lines.push(mistakes(&results.campaigns));
        lines.extend(tolerances(&results.campaigns).filter(|_| steps.is_empty()));
    }
    if !results.stresses.is_empty() {
        // Its pairs make a campaign as well; what it was made for comes first.
        lines = stress(results);
    }
    lines.extend(steps);
    // Blocks that pass through one another come before everything else.
    let objections = results.motions.iter().filter(|run| run.audit().is_some_and(AuditTotals::objects));
    let objections = objections.map(|run| line(Mood::Bad, format!("{}: {}.", run.name, run.sentence())));
    lines.splice(..0, objections.take(1));
    if lines.is_empty() {
        lines.extend(results.motions.first().map(|run| {
            let mood = if run.audit().is_some() { Mood::Good } else { Mood::Fair };
            line(mood, format!("{}: {}.", run.name, run.sentence()))
        }));
    }
    if lines.is_empty() {
        lines.extend(times(results));
    }
    lines.truncate(3);
    lines
}

/// What was measured, where there is nothing else.
fn times(results: &Results) -> Option<Line> {
    let all: Vec<_> = results.timings.iter().flat_map(|run| &run.measurements).collect();
    let efficient = all.iter().filter(|m| m.efficient).count();
    (!all.is_empty()).then(|| {
        line(
            Mood::Fair,
            format!("{} measurements of run time against error, {efficient} of them efficient.", all.len()),
        )
    })
}

/// How far each engine is safe without ties, and how it is with them.
fn stress(results: &Results) -> Vec<Line> {
    let limits = || results.stresses.iter().flat_map(|run| &run.limits);
    let engines: BTreeSet<&str> = limits().map(|limit| &*limit.curve.engine).collect();
    let of = |engine: &str, form| -> [Vec<String>; 2] {
        reach(limits().filter(|limit| limit.curve.engine == engine && limit.curve.form == form))
    };
    let mut lines: Vec<Line> = engines
        .iter()
        .rev()
        .take(2)
        .map(|engine| match of(engine, Form::Generic) {
            [safe, never] if never.is_empty() => {
                line(Mood::Good, format!("{engine}, no ties: safe {}.", safe.join("; ")))
            }
            [safe, _] if safe.is_empty() => {
                line(Mood::Bad, format!("{engine}, no ties: safe in none of the ways tried."))
            }
            [safe, _] => {
                line(Mood::Fair, format!("{engine}, no ties: safe {}; not in the other ways tried.", safe.join("; ")))
            }
        })
        .collect();
    let tied: Vec<&str> = engines.iter().copied().filter(|engine| of(engine, Form::Aligned)[0].is_empty()).collect();
    let shares = limits().filter(|limit| limit.curve.form == Form::Aligned && limit.safe_to.is_none());
    let most = shares.filter_map(|limit| limit.beyond.as_ref()).map(|(_, share)| *share).fold(0.0, f64::max);
    if !tied.is_empty() && most > 0.0 {
        lines.push(line(
            Mood::Fair,
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
fn right(campaigns: &[CampaignRun]) -> Line {
    let mut mood = Mood::Good;
    let mut words = Vec::new();
    for campaign in campaigns {
        for engine in campaign.engines() {
            let Some(share) = campaign.of_engine(&engine).agreement() else { continue };
            if share.value < 1.0 {
                mood = Mood::Fair;
            }
            let name = if campaigns.len() > 1 { format!("{engine} ({})", campaign.name) } else { engine };
            words.push(format!("{name} {} ({} to {})", percent(share.value), percent(share.low), percent(share.high)));
        }
    }
    words.truncate(4);
    line(mood, format!("Exactly right on hard pairs: {}.", words.join("; ")))
}

/// Whether code is mistaken, and what the rest is.
fn mistakes(campaigns: &[CampaignRun]) -> Line {
    let count =
        |cause: Cause| -> u64 { campaigns.iter().map(|c| c.tally.by_cause().get(&cause).copied().unwrap_or(0)).sum() };
    let total: u64 = campaigns.iter().map(|c| c.tally.total).sum();
    if total == 0 {
        return line(Mood::Good, "No difference was found at all.".to_owned());
    }
    let share = |cause: Cause| percent(count(cause) as f64 / total as f64);
    let rest: Vec<String> = Cause::ALL
        .into_iter()
        .filter(|cause| *cause != Cause::Defect && count(*cause) > 0)
        .map(|cause| format!("{cause} {}", share(cause)))
        .collect();
    let rest = rest.join(", ");
    let in_steps: u64 = campaigns.iter().flat_map(|c| &c.steps).map(|(_, counts)| counts.defect).sum();
    match count(Cause::Defect) {
        0 if in_steps > 0 => line(
            Mood::Bad,
            format!("{} differences of the pairs' steps are mistakes in code: look at these first.", grouped(in_steps)),
        ),
        0 => line(
            Mood::Good,
            format!("No mistake in code. What differs ({} findings) is due to: {rest}.", grouped(total)),
        ),
        n => line(
            Mood::Bad,
            format!("{} findings are mistakes in code: look at these first. The others: {rest}.", grouped(n)),
        ),
    }
}

/// Which setting changes most by itself.
fn tolerances(campaigns: &[CampaignRun]) -> Option<Line> {
    let mut shares: Vec<(f64, String)> = Vec::new();
    for campaign in campaigns {
        for (compared, sums) in campaign.by_setting() {
            if compared.span == Span::Tolerance && !compared.tolerances.ends_with("(ladders)") {
                let name = super::sections::label(campaigns.len(), &campaign.name, &compared.tolerances);
                shares.extend(sums.agreement().map(|s| (1.0 - s.value, name)));
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
        format!(
            "Tolerances alone, without any rounding, change the contacts of {} of the pairs under \"{worst}\", of {} under \"{best}\".",
            percent(*most),
            percent(*least)
        )
    };
    Some(line(if *most > 0.0 { Mood::Fair } else { Mood::Good }, text))
}

/// What became of it in motion.
fn steps(results: &Results) -> Vec<Line> {
    let runs = &results.locksteps;
    let steps: u64 = runs.iter().map(|r| r.steps).sum();
    let contacts: u64 = runs.iter().map(|r| r.contacts_differ).sum();
    let iterations: u64 = runs.iter().map(|r| r.iterations_differ).sum();
    let defects: u64 = runs.iter().filter_map(|r| r.causes.get(&Cause::Defect)).sum();
    let deepest = runs.iter().map(|r| r.penetration_difference_m).fold(0.0, f64::max);
    let mut lines = Vec::new();
    if !runs.is_empty() {
        let mood = if contacts + iterations == 0 { Mood::Good } else { Mood::Fair };
        lines.push(line(
            mood,
            format!(
                "In motion, {} of {} steps have other contacts than the exact ones, {} another number of iterations.",
                grouped(contacts),
                grouped(steps),
                grouped(iterations)
            ),
        ));
        lines.push(line(
            Mood::Fair,
            format!("Overlaps after a step differ from the exact ones by at most {} m.", short(deepest)),
        ));
        lines.push(match defects {
            0 => line(Mood::Good, "No mistake in code was found in the steps.".to_owned()),
            n => line(Mood::Bad, format!("{} differences of the steps are mistakes in code.", grouped(n))),
        });
    }
    lines
}
