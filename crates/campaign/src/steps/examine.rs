//! The steps of one pair, under all its tolerance sets and by every engine: what differs, and why.

use super::engine::{Made, StepEngine};
use super::finding::{StepChange, StepFinding};
use super::summary::{Place, StepSummary, half_side};
use rockproof_differential::finding::{Cause, Who};
use rockproof_differential::lockstep::StepCause;
use rockproof_differential::lockstep::effect::Depths;
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{Subject, SubjectSet};
use rockproof_model::Precision;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What the steps of some pairs brought.
#[derive(Debug, Default)]
pub struct Examined {
    /// The findings, by pair, tolerance set, engine, step and cause.
    pub findings: Vec<StepFinding>,
    /// The counts.
    pub summary: StepSummary,
}

/// Examines some pairs on a thread of their own: the stepper waits for threads inside a step, and a worker that waits would take
/// up other pairs meanwhile, one inside the other.
pub fn examine_all(pairs: &[(&Subject, PairMotion)], engines: &[Box<dyn StepEngine>]) -> Examined {
    let work = || {
        let mut all = Examined::default();
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
pub fn examine(subject: &Subject, motion: &PairMotion, engines: &[Box<dyn StepEngine>], all: &mut Examined) {
    let half = half_side(subject);
    for set in &subject.sets {
        let first = all.findings.len();
        for engine in engines {
            let place = Place::new(subject, set, engine.name());
            all.summary.add_pair(&place);
            let steps = catch_unwind(AssertUnwindSafe(|| engine.steps(subject, set, motion)));
            match steps {
                Ok(Ok(steps)) => {
                    for made in &steps {
                        let deepened = deepened(subject, engine.precision(), made);
                        all.summary.add_step(&place, made, deepened, half);
                        told(subject, set, &**engine, (made, deepened), &mut all.findings);
                    }
                }
                Ok(Err(_)) => all.summary.add_silent(&place),
                Err(panic) => {
                    all.summary.add_silent(&place);
                    let text = panic.downcast_ref::<String>().cloned();
                    let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
                    let mut finding = blank(subject, set, &**engine, Cause::Defect.into(), 1);
                    finding.after = format!("panic: {}", text.unwrap_or_else(|| "no message".to_owned()));
                    all.findings.push(finding);
                }
            }
        }
        shared(&mut all.findings, first, engines);
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
fn blank(subject: &Subject, set: &SubjectSet, engine: &dyn StepEngine, cause: StepCause, step: i64) -> StepFinding {
    let who = if is_own(cause) { Who::Engine(engine.name().into()) } else { Who::Rounded(engine.precision()) };
    StepFinding {
        index: subject.index,
        family: subject.family.clone(),
        form: subject.form.clone(),
        set: set.name.clone(),
        who,
        engine: engine.name().into(),
        step,
        cause,
        change: StepChange::Decision(rockproof_differential::lockstep::Change::Stopped),
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

/// Roundoffs of the largest coordinate that two depths may differ by, and be the same.
const ROUNDOFFS: f64 = 64.0;

/// What differs in a step. Differences of contacts in the first step are those of `findings.csv`, and left to it.
fn told(
    subject: &Subject,
    set: &SubjectSet,
    engine: &dyn StepEngine,
    (made, deepened): (&Made, Option<StepChange>),
    findings: &mut Vec<StepFinding>,
) {
    let compared = &made.compared;
    let effect = compared.depths.map_or("", |depths| depths.effect().name());
    let new = |cause: StepCause| {
        let mut finding = blank(subject, set, engine, cause, compared.step);
        if is_own(cause) {
            (finding.penetration, finding.effect) = (compared.penetration, effect);
        }
        finding
    };
    for caused in &compared.differences {
        if compared.step > 1 || !caused.difference.is_of_contacts() {
            let mut finding = new(caused.cause.into());
            finding.tell(caused);
            findings.push(finding);
        }
    }
    if let Some(what) = made.drift {
        findings.push(StepFinding { change: StepChange::State(what), ..new(Cause::Defect.into()) });
    }
    for caused in compared.watched.iter().flat_map(|watched| &watched.caused) {
        let mut finding = new(caused.cause);
        finding.change = StepChange::Intrusion(caused.kind);
        [finding.before, finding.after] = caused.words().map(str::to_owned);
        findings.push(finding);
    }
    let Some(change) = deepened else { return };
    let defect = made.drift.is_some() || compared.count(Cause::Defect) > 0;
    let mut finding = new(if defect { Cause::Defect } else { Cause::Arithmetic }.into());
    let depth = |side: usize| compared.penetration[side].map_or(String::new(), |depth| format!("{depth:e}"));
    (finding.change, finding.before, finding.after) = (change, depth(1), depth(0));
    findings.push(finding);
}

/// Whether penetrations after a step differ by more than rounding the coordinates explains.
fn deepened(subject: &Subject, precision: Precision, made: &Made) -> Option<StepChange> {
    let [Some(stepper), Some(oracle)] = made.compared.penetration else { return None };
    let blocks = [&subject.a, &subject.b];
    let coordinates = blocks.into_iter().flat_map(|b| b.vertices()).flat_map(|v| v.components());
    let largest = coordinates.map(|c| c.approximate().abs()).fold(0.0, f64::max);
    let rounding = ROUNDOFFS * precision.epsilon() / 2.0 * largest;
    let change = stepper - oracle;
    if change.abs() <= rounding.max(Depths::NOTHING * stepper.max(oracle)) {
        return None;
    }
    Some(if change > 0.0 { StepChange::Deeper } else { StepChange::Shallower })
}

/// What tolerances and rounding do is counted once, not once an engine: the same tolerance difference in every precision is
/// about everyone, and so is the same intrusion by the length of the step, or that shorter steps have too; the same difference of rounding is counted
/// once for its precision.
fn shared(findings: &mut Vec<StepFinding>, first: usize, engines: &[Box<dyn StepEngine>]) {
    let alone = engines.windows(2).all(|two| two[0].precision() == two[1].precision());
    let mut kept: Vec<StepFinding> = Vec::new();
    for mut finding in findings.drain(first..) {
        let of_engine = matches!(finding.who, Who::Engine(_));
        let of_all = !of_engine && finding.cause != Cause::Representation.into();
        if alone && of_all {
            finding.who = Who::Any;
        }
        let same = |known: &&mut StepFinding| {
            !of_engine
                && (known.cause, known.step, known.change) == (finding.cause, finding.step, finding.change)
                && (known.contact, known.solve) == (finding.contact, finding.solve)
                && (&known.before, &known.after) == (&finding.before, &finding.after)
                && (known.who == finding.who || of_all)
        };
        match kept.iter_mut().find(same) {
            Some(known) if known.who != finding.who => known.who = Who::Any,
            Some(_) => {}
            None => kept.push(finding),
        }
    }
    findings.extend(kept);
}
