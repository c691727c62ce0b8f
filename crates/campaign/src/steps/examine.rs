//! The steps of one pair, under all its tolerance sets and by every engine: what differs, and why.

use super::engine::{ComparedPairStep, StepEngine};
use super::finding::{StepChange, StepFinding};
use super::summary::{StepGroup, StepSummary, half_side};
use rockproof_differential::finding::{Cause, FindingScope};
use rockproof_differential::lockstep::StepCause;
use rockproof_differential::lockstep::penetration::DepthDifference;
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{NamedSet, Subject};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What the steps of some pairs brought.
#[derive(Debug, Default)]
pub struct StepExamination {
    /// The findings, by pair, tolerance set, engine, step and cause.
    pub findings: Vec<StepFinding>,
    /// The counts.
    pub summary: StepSummary,
}

/// Examines some pairs on a thread of their own: the stepper waits for threads inside a step, and a worker that waits would take
/// up other pairs meanwhile, one inside the other.
pub fn examine_all(pairs: &[(&Subject, PairMotion)], engines: &[Box<dyn StepEngine>]) -> StepExamination {
    let work = || {
        let mut all = StepExamination::default();
        for (subject, motion) in pairs {
            examine(subject, motion, engines, &mut all);
        }
        all
    };
    std::thread::scope(|scope| match scope.spawn(work).join() {
        Ok(all) => all,
        Err(panic) => std::panic::resume_unwind(panic),
    })
}

/// Examines one pair.
pub fn examine(subject: &Subject, motion: &PairMotion, engines: &[Box<dyn StepEngine>], all: &mut StepExamination) {
    let half = half_side(subject);
    for set in &subject.sets {
        let first = all.findings.len();
        for engine in engines {
            let place = StepGroup::new(subject, set, engine.name());
            all.summary.add_pair(&place);
            let steps = catch_unwind(AssertUnwindSafe(|| engine.steps(subject, set, motion)));
            match steps {
                Ok(Ok(steps)) => {
                    for made in &steps {
                        let depth = made.depth_difference(subject, engine.precision());
                        all.summary.add_step(&place, made, depth.as_ref().map(StepChange::of_depth), half);
                        findings_of_step(subject, set, &**engine, (made, depth), &mut all.findings);
                    }
                }
                Ok(Err(_)) => all.summary.add_silent(&place),
                Err(panic) => {
                    all.summary.add_silent(&place);
                    let text = panic.downcast_ref::<String>().cloned();
                    let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
                    let mut finding = empty_finding(subject, set, &**engine, Cause::Defect.into(), 1);
                    finding.after = format!("panic: {}", text.unwrap_or_else(|| "no message".to_owned()));
                    all.findings.push(finding);
                }
            }
        }
        merge_shared(&mut all.findings, first, engines);
        for finding in &all.findings[first..] {
            all.summary.add_finding(finding);
        }
    }
}

/// Whether a cause lies in an engine.
fn is_own(cause: StepCause) -> bool {
    matches!(cause, StepCause::Link(Cause::Arithmetic | Cause::Defect | Cause::Engine))
}

/// A finding that says nothing yet.
fn empty_finding(
    subject: &Subject,
    set: &NamedSet,
    engine: &dyn StepEngine,
    cause: StepCause,
    step: i64,
) -> StepFinding {
    let scope = if is_own(cause) {
        FindingScope::Engine(engine.name().into())
    } else {
        FindingScope::Rounded(engine.precision())
    };
    StepFinding {
        index: subject.index,
        family: subject.family.clone(),
        form: subject.form.clone(),
        set: set.name.clone(),
        scope,
        engine: engine.name().into(),
        step,
        cause,
        change: StepChange::Decision(rockproof_differential::lockstep::StepAnswerChange::Stopped),
        contact: None,
        solve: None,
        before: String::new(),
        after: String::new(),
        deciding: None,
        margins: [None; 2],
        penetration: [None; 2],
        effect: "",
    }
}

/// What differs in a step. Differences of contacts in the first step are those of `findings.csv`, and left to it.
fn findings_of_step(
    subject: &Subject,
    set: &NamedSet,
    engine: &dyn StepEngine,
    (made, depth): (&ComparedPairStep, Option<DepthDifference>),
    findings: &mut Vec<StepFinding>,
) {
    let compared = &made.compared;
    let effect = compared.depths.map_or("", |depths| depths.effect().name());
    let new = |cause: StepCause| {
        let mut finding = empty_finding(subject, set, engine, cause, compared.step);
        if is_own(cause) {
            (finding.penetration, finding.effect) = (compared.penetration, effect);
        }
        finding
    };
    for attributed in &compared.differences {
        if compared.step > 1 || !attributed.difference.is_of_contacts() {
            let mut finding = new(attributed.cause.into());
            finding.take_difference(attributed);
            findings.push(finding);
        }
    }
    if let Some(what) = made.drift {
        findings.push(StepFinding { change: StepChange::State(what), ..new(Cause::Defect.into()) });
    }
    for attributed in compared.watched.iter().flat_map(|watched| &watched.attributed) {
        let mut finding = new(attributed.cause);
        finding.change = StepChange::Intrusion(attributed.kind);
        [finding.before, finding.after] = attributed.words().map(str::to_owned);
        findings.push(finding);
    }
    let Some(depth) = depth else { return };
    let mut finding = new(depth.cause.into());
    finding.change = StepChange::of_depth(&depth);
    [finding.before, finding.after] = depth.depth_texts();
    findings.push(finding);
}

/// What tolerances and rounding do is counted once, not once an engine: the same tolerance difference in every precision is
/// about everyone, and so is the same intrusion by the length of the step, or that shorter steps have too; the same difference of rounding is counted
/// once for its precision.
fn merge_shared(findings: &mut Vec<StepFinding>, first: usize, engines: &[Box<dyn StepEngine>]) {
    let alone = engines.windows(2).all(|two| two[0].precision() == two[1].precision());
    let mut kept: Vec<StepFinding> = Vec::new();
    for mut finding in findings.drain(first..) {
        let of_engine = matches!(finding.scope, FindingScope::Engine(_));
        let of_all = !of_engine && finding.cause != Cause::Representation.into();
        if alone && of_all {
            finding.scope = FindingScope::Any;
        }
        let same = |known: &&mut StepFinding| {
            !of_engine
                && (known.cause, known.step, known.change) == (finding.cause, finding.step, finding.change)
                && (known.contact, known.solve) == (finding.contact, finding.solve)
                && (&known.before, &known.after) == (&finding.before, &finding.after)
                && (known.scope == finding.scope || of_all)
        };
        match kept.iter_mut().find(same) {
            Some(known) if known.scope != finding.scope => known.scope = FindingScope::Any,
            Some(_) => {}
            None => kept.push(finding),
        }
    }
    findings.extend(kept);
}
