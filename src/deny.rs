//! `--deny`: findings, and campaigns that compared nothing, that are no success.

use crate::exit::{ExitStatus, print_note};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::CampaignProgress;
use rockproof_campaign::steps::StepChange;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::StepCause;
use rockproof_gate::config::RECOVERED;

/// The engines of a campaign.
pub(crate) fn engine_names(config: &CampaignConfig) -> impl Iterator<Item = &str> {
    let external = config.external.iter().map(|spec| spec.name.as_str());
    config.engines.iter().map(String::as_str).chain(external)
}

/// Whether there is anything of a kind that `--deny` names, or an engine of those that must have been compared answered nothing, or an external one less than half: where nothing was compared
/// nothing can be found, which must not pass a check.
pub(crate) fn denied(kinds: &[String], compared: &[&str], progress: &CampaignProgress) -> ExitStatus {
    if kinds.is_empty() {
        return ExitStatus::Passed;
    }
    let mut all_compared = true;
    for engine in compared {
        let [asked, answered] = progress.agreement.asked_and_answered(engine);
        // Pairs that make steps alone are compared by these.
        if asked == 0 && !progress.steps.is_empty() {
            continue;
        }
        // As a gate asks of external engines. A built-in one may have no answer where rounding makes blocks degenerate.
        let is_external = progress.engines.contains_key(*engine);
        if answered == 0 || is_external && answered < asked - answered {
            all_compared = false;
            let what = match (asked, answered) {
                (0, _) => "was asked about no pair, since none survives rounding, so nothing was compared".to_owned(),
                (_, 0) => format!("answered none of {asked} pairs, so nothing was compared"),
                _ => format!("answered {answered} of {asked} pairs, less than half, so next to nothing was compared"),
            };
            print_note(&format!("denied: {engine} {what}"));
        }
    }
    let (summary, steps) = (&progress.summary, &progress.steps);
    let found = |kind: &&String| match kind.as_str() {
        "any" => summary.total() + steps.total() > 0,
        RECOVERED => progress.engines.values().any(|counts| counts.recovered > 0),
        kind => summary.count_of(kind) + steps.count_of(kind) > 0,
    };
    let found: Vec<&String> = kinds.iter().filter(found).collect();
    for kind in &found {
        let what = if *kind == RECOVERED { "failures that were" } else { "findings of kind" };
        print_note(&format!("denied: there are {what} {kind}"));
    }
    let names = |kind: &str| kinds.iter().any(|named| named == kind);
    let of_builtin = [Cause::Defect, Cause::Arithmetic].map(Cause::name).into_iter().filter(|cause| names(cause));
    if !progress.engines.is_empty() && !names("any") && !names(Cause::Engine.name()) {
        let engines = progress.engines.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        for cause in of_builtin {
            print_note(&format!(
                "--deny {cause} does not concern {engines}: findings about external engines have the cause engine (--deny engine)"
            ));
        }
    }
    if found.is_empty() && all_compared { ExitStatus::Passed } else { ExitStatus::CheckFailed }
}

pub(crate) fn check_deny(kinds: &[String]) -> anyhow::Result<()> {
    let known = |kind: &str| {
        ["any", RECOVERED].contains(&kind) || StepCause::from_name(kind).is_some() || StepChange::is_known(kind)
    };
    if let Some(kind) = kinds.iter().find(|kind| !known(kind)) {
        let causes = Cause::ALL.map(Cause::name).into_iter().chain(StepCause::NAMES);
        let names = causes.chain(AnswerChange::ALL.map(AnswerChange::name)).chain(StepChange::NAMES);
        let allowed = ["any", RECOVERED].into_iter().chain(names).collect::<Vec<_>>().join(", ");
        anyhow::bail!("--deny {kind}: no such kind; known are {allowed}");
    }
    Ok(())
}
