//! What limits are about: whether the campaign of a gate can find anything of it, and whom it concerns.

use super::config::{FindingLimit, GateConfig, line_of};
use super::possible_findings;
use super::tally::CampaignTally;
use rockproof_campaign::source::FamilySource;
use rockproof_campaign::steps::{self, PASSAGE, StepChange};
use rockproof_differential::agreement::EngineAnswers;
use rockproof_differential::answer_detail::AnswerDetail;
use rockproof_differential::builtin;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::external::EngineSpec;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::StepCause;
use rockproof_model::Precision;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};

/// That the campaign of a gate can find something of each limit, as far as that is known beforehand; `file` is the gate file.
///
/// # Errors
/// The limit that is about nothing in the campaign, with its line, and why.
pub fn check(config: &GateConfig, source: &FamilySource, (file, text): (&str, &str)) -> Result<(), String> {
    for limit in &config.limit {
        if let Some(why) = out_of_reach(limit.get_ref(), config, source) {
            let line = line_of(text, limit.span().start);
            return Err(format!(
                "{file} line {line}: the limit \"{}\" is about nothing in this campaign: {why}",
                excerpt(&limit.get_ref().text(), EXCERPT_LENGTH)
            ));
        }
    }
    Ok(())
}

fn out_of_reach(limit: &FindingLimit, config: &GateConfig, source: &FamilySource) -> Option<String> {
    let campaign = &config.campaign;
    let still = match (campaign.steps_every, campaign.steps) {
        (0, _) => Some("no pair makes steps (campaign.steps_every is 0)"),
        (_, 0) => Some("no pair makes steps (campaign.steps is 0)"),
        _ if steps::engines(campaign.engines.iter().map(String::as_str)).is_empty() => {
            Some("no pair makes steps, which built-in engines alone make, and none takes part")
        }
        _ => None,
    };
    if let Some(still) = still.filter(|_| limit.is_of_steps() || limit.family.as_deref() == Some(PASSAGE)) {
        return Some(still.to_owned());
    }
    let metamorphic =
        limit.change.as_deref().and_then(AnswerChange::from_name).filter(|change| change.is_metamorphic());
    if let (Some(change), 0) = (metamorphic, campaign.metamorphic_every) {
        return Some(format!("no pair is changed to look for \"{change}\" (campaign.metamorphic_every is 0)"));
    }
    if limit.change.as_deref() == Some(AnswerChange::Unstable.name()) && !campaign.ask_twice {
        return Some("no pair is asked about twice (campaign.ask_twice is false)".to_owned());
    }
    let families = source.families();
    if let Some(family) = limit.family.as_ref().filter(|name| !families.contains(&name.as_str())) {
        return Some(format!("family {family} is none of its families, which are {}", families.join(", ")));
    }
    let sets = source.sets();
    if let Some(set) = limit.tolerances.as_ref().filter(|name| !sets.contains(&name.as_str())) {
        return Some(format!("tolerances {set} are none of its sets, which are {}", sets.join(", ")));
    }
    let of = |wanted: Precision| {
        let builtin = campaign.engines.iter().filter_map(|name| builtin::engine(name));
        builtin
            .map(|engine| engine.precision())
            .chain(campaign.external.iter().map(|spec| Precision::from(spec.precision)))
            .any(|precision| precision == wanted)
    };
    let absent = |name: &str| (name == "f32" && !of(Precision::F32)) || (name == "f64" && !of(Precision::F64));
    let engine = limit.engine.as_ref().filter(|name| absent(name))?;
    Some(format!("no engine that is given {engine} takes part"))
}

/// Why nothing in a campaign of these engines can break a limit, as far as its engine, cause and change tell: built-in and external engines share no cause of
/// their own, and what rounding or tolerances do is about no single engine.
pub(crate) fn unbreakable(limit: &FindingLimit, config: &GateConfig) -> Option<String> {
    let cause = limit.cause.as_deref().and_then(Cause::from_name);
    let campaign = &config.campaign;
    let external = |name: &str| campaign.external.iter().any(|spec| spec.name == name);
    let builtin = |name: &str| campaign.engines.iter().any(|engine| engine == name);
    let shared = |name: &str| ["any", "f32", "f64"].contains(&name);
    let change = limit.change.as_deref();
    if limit.is_of_recovered() && campaign.external.is_empty() {
        return Some("only external engines are asked again, and none takes part".to_owned());
    }
    if change.is_some_and(possible_findings::is_of_external_engines) {
        let builtin = limit.engine.as_deref().filter(|name| builtin(name));
        let why = builtin.map(|name| format!("{name} is built in"));
        if let Some(why) = why.or_else(|| campaign.external.is_empty().then(|| "none takes part".to_owned())) {
            return Some(format!("only external engines have this change, and {why}"));
        }
    }
    let of_steps = limit.is_of_steps() || limit.family.as_deref() == Some(PASSAGE);
    if let Some(name) = limit.engine.as_deref().filter(|name| of_steps && external(name)) {
        return Some(format!("built-in engines alone make steps, and {name} is an external engine"));
    }
    if let Some(name) = limit.engine.as_deref().filter(|name| shared(name)) {
        let what = match (cause, change) {
            (Some(Cause::Arithmetic | Cause::Defect | Cause::Engine), _) => Some("cause"),
            (_, Some(change)) if possible_findings::is_of_one_engine(change) => Some("change"),
            _ => None,
        };
        if let Some(what) = what {
            return Some(format!("findings of this {what} are about one engine, by its name, not about {name}"));
        }
    }
    let of_precision = change.is_some_and(possible_findings::is_of_one_precision);
    if let Some(name) = limit.engine.as_deref().filter(|name| of_precision && !["f32", "f64"].contains(name)) {
        return Some(format!("findings of this change are about f32 or f64, not about {name}"));
    }
    match (cause, limit.engine.as_deref()) {
        (Some(Cause::Arithmetic | Cause::Defect), Some(name)) if external(name) => {
            Some(format!("findings about {name}, an external engine, have the cause engine"))
        }
        (Some(Cause::Arithmetic | Cause::Defect), _) if campaign.engines.is_empty() => {
            Some("no built-in engine takes part; findings about external engines have the cause engine".to_owned())
        }
        (Some(Cause::Engine), Some(name)) if builtin(name) => {
            Some(format!("only findings about external engines have this cause, and {name} is built in"))
        }
        (Some(Cause::Engine), _) if campaign.external.is_empty() => {
            Some("only findings about external engines have this cause, and none takes part".to_owned())
        }
        (Some(Cause::Representation), Some("any")) => {
            Some("findings of this cause are about f32 or f64, not about any engine".to_owned())
        }
        (Some(Cause::Tolerance | Cause::Representation), Some(name)) if !shared(name) && !limit.is_of_intrusions() => {
            Some(format!("findings of this cause are about any engine, f32 or f64, not about {name}"))
        }
        _ => None,
    }
}

/// Why a limit on what an answer may leave unsaid, as entrances, was not looked at: it is about external engines alone, and none of them gave any.
pub(crate) fn unsaid(limit: &FindingLimit, config: &GateConfig, tally: &CampaignTally) -> Option<String> {
    let change = limit.change.as_deref().and_then(AnswerChange::from_name)?;
    let externals = config.campaign.external.iter().map(|spec| spec.name.as_str());
    // How blocks lie external engines alone say.
    let of_externals = limit.cause.as_deref() == Some(Cause::Engine.name()) || change.is_of_states();
    let concerned: Vec<&str> = match limit.engine.as_deref() {
        Some(engine) => externals.filter(|name| *name == engine).collect(),
        None if of_externals => externals.collect(),
        None => Vec::new(),
    };
    let details = concerned.iter().map(|name| tally.answers(name).detail);
    let detail = details.fold(AnswerDetail::default(), AnswerDetail::plus);
    if concerned.is_empty() || given(change, detail)? > 0 {
        return None;
    }
    let names = concerned.join(" and ");
    if change.is_of_states() {
        let what = change.name();
        return Some(match detail.states().answers {
            0 => format!("{names} answered no state, so no {what}"),
            1 => format!("{names} gave no {what} for its state: what is not given is not compared"),
            states => format!("{names} gave no {what} for any of {states} states: what is not given is not compared"),
        });
    }
    Some(match detail.contacts {
        0 => format!("{names} named no contact, so no entrance and no sign of a gap"),
        1 => format!(
            "{names} gave neither entrance nor sign of the gap for its contact: what is not given is not compared"
        ),
        contacts => format!(
            "{names} gave neither entrance nor sign of the gap for any of {contacts} contacts: what is not given is not compared"
        ),
    })
}

/// How often an engine gave what a limit on this change is about; `None` where no answer can leave that unsaid.
fn given(change: AnswerChange, detail: AnswerDetail) -> Option<u64> {
    match change {
        AnswerChange::Entrance | AnswerChange::GapSign => Some(detail.entrances),
        AnswerChange::Gap => Some(detail.states().gaps),
        AnswerChange::Normal => Some(detail.states().normals),
        _ => None,
    }
}

/// Whether a limit can be broken by what an external engine answers, of which `answers` are known. One on crashes, say, cannot: whatever the engine answers,
/// it answers. Nor can one on missing contacts where the engine names none, or one on gaps where it gives none.
pub(crate) fn concerns(limit: &FindingLimit, engine: &EngineSpec, answers: &EngineAnswers) -> bool {
    let change = limit.change.as_deref().and_then(AnswerChange::from_name);
    let of_contacts = limit.kind.is_some() || change.is_some_and(AnswerChange::is_of_contacts);
    let of_states = change.is_some_and(AnswerChange::is_of_states);
    limit.engine.as_ref().is_none_or(|name| *name == engine.name)
        && limit.cause.as_ref().is_none_or(|cause| cause == Cause::Engine.name())
        && change.is_none_or(AnswerChange::is_of_answers)
        && (!of_contacts || answers.with_contacts > 0)
        && change.and_then(|change| given(change, answers.detail)).is_none_or(|times| times > 0)
        && (!of_states || answers.with_contacts < answers.answered)
        && !limit.is_of_recovered()
        && !limit.is_of_steps()
        && limit.family.as_deref() != Some(PASSAGE)
}

impl FindingLimit {
    /// Whether it is about what only steps have.
    pub fn is_of_steps(&self) -> bool {
        let named = |name: &Option<String>, names: &[&str]| name.as_deref().is_some_and(|name| names.contains(&name));
        named(&self.change, &StepChange::NAMES) || named(&self.cause, &StepCause::NAMES)
    }
}
