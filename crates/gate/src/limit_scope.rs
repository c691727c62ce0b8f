//! What limits are about: whether the campaign of a gate can find anything of it, and whom it concerns.

use super::config::{FindingLimit, GateConfig, line_of};
use super::possible_findings;
use super::tally::CampaignTally;
use rockproof_campaign::source::FamilySource;
use rockproof_campaign::steps::{self, StepChange};
use rockproof_differential::agreement::EngineAnswers;
use rockproof_differential::answer_detail::{AnswerDetail, Unsaid};
use rockproof_differential::builtin;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::external::EngineSpec;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::StepCause;
use rockproof_model::Precision;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt, noun};
use rockproof_pairs::passing::PASSAGE;

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
    let builtin = campaign.engines.iter().filter_map(|name| builtin::engine(name));
    let builtin = builtin.map(|engine| (engine.name().to_owned(), engine.precision()));
    let external = campaign.external.iter().map(|spec| (spec.name.clone(), Precision::from(spec.precision)));
    let engines: Vec<(String, Precision)> = builtin.chain(external).collect();
    if let Some(why) = beyond_every_margin(limit, &engines, may_be_of_externals(limit, config)) {
        return Some(why);
    }
    let of = |wanted: Precision| engines.iter().any(|(_, precision)| *precision == wanted);
    let absent = |name: &str| (name == "f32" && !of(Precision::F32)) || (name == "f64" && !of(Precision::F64));
    let engine = limit.engine.as_ref().filter(|name| absent(name))?;
    Some(format!("no engine that is given {engine} takes part"))
}

/// Whether findings about an external engine may be of a limit, as far as its engine and cause tell.
fn may_be_of_externals(limit: &FindingLimit, config: &GateConfig) -> bool {
    let is_named = |name: &str| limit.engine.as_ref().is_none_or(|of| of == name);
    limit.cause.as_ref().is_none_or(|cause| cause == Cause::Engine.name())
        && config.campaign.external.iter().any(|spec| is_named(&spec.name))
}

/// That a limit is on what is further from a tie than anything is: margins are shares, of the terms of a value or of the largest coordinate. What is no
/// answer, and what is never rounding, counts however far that is.
fn beyond_every_margin(limit: &FindingLimit, engines: &[(String, Precision)], is_of_externals: bool) -> Option<String> {
    // Two blocks are apart by no more than the diagonal of a cube, twice the largest coordinate wide.
    const LARGEST_MARGIN: f64 = 4.0;
    let beyond = limit.beyond_ulps?;
    let counts_anyway = |change: AnswerChange| match change {
        AnswerChange::Scale => is_of_externals,
        _ => !change.is_of_answers() || change.is_never_rounding(),
    };
    if limit.change.as_deref().and_then(AnswerChange::from_name).is_some_and(counts_anyway) {
        return None;
    }
    let is_concerned = |name: &str, precision: Precision| {
        limit.engine.as_ref().is_none_or(|of| of == name || of == "any" || *of == precision.to_string())
    };
    let concerned = engines.iter().filter(|(name, precision)| is_concerned(name, *precision));
    let (_, finest) = concerned.min_by(|(_, one), (_, other)| one.epsilon().total_cmp(&other.epsilon()))?;
    let most = LARGEST_MARGIN / (finest.epsilon() / 2.0);
    (beyond >= most).then(|| format!("in {finest} nothing is 2^{} roundoffs from a tie", most.log2()))
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

/// The external engines that a limit is about, with how much each said, and what the limit is on of which an answer may say nothing.
fn told<'t>(
    limit: &FindingLimit,
    config: &'t GateConfig,
    tally: &CampaignTally,
) -> Option<(Unsaid, Vec<(&'t str, AnswerDetail)>)> {
    let what = may_be_unsaid(limit.change.as_deref().and_then(AnswerChange::from_name)?)?;
    let is_of_externals = limit.cause.as_ref().is_none_or(|cause| cause == Cause::Engine.name());
    let externals = config.campaign.external.iter().map(|spec| spec.name.as_str());
    let concerned =
        externals.filter(|name| is_of_externals && limit.engine.as_ref().is_none_or(|engine| engine == name));
    Some((what, concerned.map(|name| (name, tally.answers(name).detail)).collect()))
}

/// For how many contacts or states what a limit is on was given, where not for all: what is not given is not compared. And how far gaps and normals
/// may be off, where that is not the usual accuracy.
pub(crate) fn given_note(limit: &FindingLimit, config: &GateConfig, tally: &CampaignTally) -> Option<String> {
    let (what, engines) = told(limit, config, tally)?;
    let is_one = engines.len() == 1 && limit.engine.is_some();
    let note = |(name, detail): &(&str, AnswerDetail)| {
        let note = detail.note_of(what)?;
        Some(if is_one { note } else { format!("{name}: {note}") })
    };
    let mut notes: Vec<String> = engines.iter().filter_map(note).collect();
    let narrowed = if [&limit.family, &limit.tolerances, &limit.kind].iter().any(|of| of.is_some()) {
        ", of all pairs"
    } else {
        ""
    };
    if let Some(last) = notes.last_mut() {
        *last += narrowed;
    }
    if what != Unsaid::Entrances {
        let specs = config.campaign.external.iter();
        let unusual =
            specs.filter(|spec| !spec.has_usual_accuracy() && engines.iter().any(|(name, _)| *name == spec.name));
        notes.extend(unusual.map(|spec| format!("accuracy of {} {}", spec.name, spec.accuracy)));
    }
    (!notes.is_empty()).then(|| notes.join(", "))
}

/// Why a limit on what an answer may leave unsaid, as entrances, was not looked at: it is about external engines alone, and none of them gave it for
/// as many contacts or states as say anything.
pub(crate) fn unsaid(limit: &FindingLimit, config: &GateConfig, tally: &CampaignTally) -> Option<String> {
    let (what, engines) = told(limit, config, tally)?;
    // How blocks lie external engines alone say.
    let is_of_any = limit.engine.is_none() && limit.cause.is_none() && what == Unsaid::Entrances;
    let of_builtin = is_of_any && !config.campaign.engines.is_empty();
    if engines.is_empty() || of_builtin || engines.iter().any(|(_, detail)| detail.is_given_enough(what)) {
        return None;
    }
    let none: Vec<&str> =
        engines.iter().filter(|(_, detail)| detail.counts_of(what)[0] == 0).map(|(name, _)| *name).collect();
    let little = engines.iter().filter(|(name, _)| !none.contains(name));
    let sum = engines
        .iter()
        .filter(|(name, _)| none.contains(name))
        .fold(AnswerDetail::default(), |sum, (_, one)| sum.plus(*one));
    let mut sentences = Vec::new();
    if !none.is_empty() {
        sentences.push(nothing_given(what, &none.join(" and "), sum.counts_of(what)[1]));
    }
    sentences.extend(little.map(|(name, detail)| {
        let enough = match what {
            Unsaid::Entrances => "half of them",
            Unsaid::Gaps => {
                "half of those apart, or overlapping, and a tenth of all (of blocks that touch a gap says nothing)"
            }
            Unsaid::Normals => "half of those apart, or overlapping, and a tenth of all",
        };
        format!("{name}: {}, and a limit needs {enough}: what is not given is not compared", detail.full_note_of(what))
    }));
    Some(sentences.join("; "))
}

/// Why a limit on contacts, or on how blocks lie, was not looked at: it is about external engines alone, and none of them says such a thing but seldom.
pub(crate) fn seldom(limit: &FindingLimit, config: &GateConfig, tally: &CampaignTally) -> Option<String> {
    let subject = Subject::of(limit)?;
    let is_engine = limit.cause.as_deref() == Some(Cause::Engine.name());
    let is_of_externals = limit.engine.is_some() || is_engine || subject == Subject::States;
    let named = config.campaign.external.iter().map(|spec| spec.name.as_str());
    let engines: Vec<&str> = named.filter(|name| limit.engine.as_ref().is_none_or(|engine| engine == name)).collect();
    let told = |name: &&str| {
        let answers = tally.answers(name);
        let what = match subject {
            Subject::Contacts => "named contacts",
            Subject::States => "said how blocks lie",
        };
        let (of, pairs) = (subject.of_answers(&answers), answers.answered);
        format!("{name} {what} for {of} of {pairs} {}, and a limit on that needs a tenth", noun(pairs, "pair", "pairs"))
    };
    let is_enough = |name: &&str| subject.is_enough(&tally.answers(name));
    let is_skipped = is_of_externals && !engines.is_empty() && !engines.iter().any(is_enough);
    is_skipped.then(|| engines.iter().map(told).collect::<Vec<_>>().join("; "))
}

/// What answers may be about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Subject {
    Contacts,
    States,
}

impl Subject {
    /// What the findings of a limit are about; `None` of any.
    fn of(limit: &FindingLimit) -> Option<Subject> {
        let change = limit.change.as_deref().and_then(AnswerChange::from_name);
        if change.is_some_and(AnswerChange::is_of_states) {
            return Some(Subject::States);
        }
        let is_of_contacts =
            change.is_some_and(AnswerChange::is_of_contacts) || (limit.kind.is_some() && !limit.is_of_steps());
        is_of_contacts.then_some(Subject::Contacts)
    }

    /// Pairs of which an engine said so.
    fn of_answers(self, answers: &EngineAnswers) -> u64 {
        match self {
            Subject::Contacts => answers.with_contacts,
            Subject::States => answers.answered.saturating_sub(answers.with_contacts),
        }
    }

    /// Whether an engine says such things often enough for a limit on them to say anything.
    fn is_enough(self, answers: &EngineAnswers) -> bool {
        let of = self.of_answers(answers);
        of > 0 && of >= answers.answered.div_ceil(10)
    }
}

/// That engines gave nothing of something, of so many contacts or states.
fn nothing_given(what: Unsaid, names: &str, of: u64) -> String {
    let what = match what {
        Unsaid::Entrances => {
            return match of {
                0 => format!("{names} named no contact, so no entrance and no sign of a gap"),
                1 => format!(
                    "{names} gave neither entrance nor sign of the gap for its contact: what is not given is not compared"
                ),
                contacts => format!(
                    "{names} gave neither entrance nor sign of the gap for any of {contacts} contacts: what is not given is not compared"
                ),
            };
        }
        Unsaid::Gaps => AnswerChange::Gap.name(),
        Unsaid::Normals => AnswerChange::Normal.name(),
    };
    match of {
        0 => format!("{names} said of no two convex blocks how they lie, so no {what}"),
        1 => format!("{names} gave no {what} for its state: what is not given is not compared"),
        states => format!("{names} gave no {what} for any of {states} states: what is not given is not compared"),
    }
}

/// What a limit on this change is on; `None` where no answer can leave that unsaid.
fn may_be_unsaid(change: AnswerChange) -> Option<Unsaid> {
    match change {
        AnswerChange::Entrance | AnswerChange::GapSign => Some(Unsaid::Entrances),
        AnswerChange::Gap => Some(Unsaid::Gaps),
        AnswerChange::Normal => Some(Unsaid::Normals),
        _ => None,
    }
}

/// Whether a limit can be broken by what an external engine answers, of which `answers` are known. One on crashes, say, cannot: whatever the engine answers,
/// it answers. Nor can one on missing contacts where the engine names none, or one on gaps where it gives too few.
pub(crate) fn concerns(limit: &FindingLimit, engine: &EngineSpec, answers: &EngineAnswers) -> bool {
    let change = limit.change.as_deref().and_then(AnswerChange::from_name);
    limit.engine.as_ref().is_none_or(|name| *name == engine.name)
        && limit.cause.as_ref().is_none_or(|cause| cause == Cause::Engine.name())
        && change.is_none_or(AnswerChange::is_of_answers)
        && Subject::of(limit).is_none_or(|subject| subject.is_enough(answers))
        && change.and_then(may_be_unsaid).is_none_or(|what| answers.detail.is_given_enough(what))
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
