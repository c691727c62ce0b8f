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

/// Whether there is anything of a kind that `--deny` names. Where an engine of those `compared` answered nothing, or an external one less than half, nothing
/// could be found, which must not pass for success either.
pub(crate) fn denied(kinds: &[String], compared: &[&str], progress: &CampaignProgress) -> ExitStatus {
    if kinds.is_empty() {
        return ExitStatus::Passed;
    }
    let mut all_compared = true;
    for engine in compared {
        let answers = progress.agreement.answers(engine);
        let is_external = progress.engines.contains_key(*engine);
        let steps_alone = answers.asked == 0 && !progress.steps.is_empty();
        // Of pairs that make steps alone built-in engines are compared by these.
        if steps_alone && !is_external {
            continue;
        }
        // As a gate asks of external engines. A built-in one may have no answer where rounding makes blocks degenerate.
        if answers.answered == 0 || is_external && answers.are_too_few() {
            all_compared = false;
            let what = match (answers.asked, answers.answered) {
                (0, _) if steps_alone => {
                    "was asked about no pair, since they make steps alone, so nothing was compared".to_owned()
                }
                (0, _) => "was asked about no pair, since none survives rounding, so nothing was compared".to_owned(),
                (asked, 0) => format!("answered none of {asked} pairs, so nothing was compared"),
                _ => format!("{}, less than half, so next to nothing was compared", answers.words()),
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
