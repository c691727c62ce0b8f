//! A few steps of a model, each audited exactly: which blocks pass through one another?

use crate::error::ExamineError;
use crate::pressed_springs::{PressedSpring, after_settling};
use crate::progress::WorkProgress;
use crate::step_audit::AuditedRun;
use rockproof_model::{Precision, Scene, ToleranceSet};
use rockproof_simulate::{AuditScope, AuditTotals, PairDepth, Stepping, Totals};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, Mode, Solve};
use rockproof_tune::{ClusterSupport, hold_lowest};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// What became of the steps.
#[derive(Clone, Debug)]
pub enum Steps {
    /// They were made.
    Made(Box<AuditedSteps>),
    /// They were not, and why.
    Skipped(String),
}

/// Steps and what the audit found.
#[derive(Clone, Debug)]
pub struct AuditedSteps {
    /// Steps made, settling not counted.
    pub made: u64,
    /// Steps asked for.
    pub asked: u64,
    /// What holds the model.
    pub held: ClusterSupport,
    /// Why they ended early, if they did.
    pub stopped: Option<String>,
    /// Steps that were taken though their iteration had not converged.
    pub unconverged: u64,
    /// Steps that count as converged though friction had not settled ([`Totals::unsettled`]).
    pub unsettled: u64,
    /// Whether contacts were closed in any step, or while blocks settled.
    pub touched: bool,
    /// The springs that overlapped where settling ended; empty where nothing settles.
    pub settled: Vec<PressedSpring>,
    /// What the audit found.
    pub totals: AuditTotals,
    /// Pairs that passed through one another within a step, with the greatest depth shown (m).
    pub passages: BTreeMap<[usize; 2], f64>,
    /// Pairs that overlapped after a step where no contact saw it, with the greatest penetration (m).
    pub unseen: BTreeMap<[usize; 2], f64>,
    /// Pairs that overlapped so by no more than springs of other contacts explain, after one step at least, with the greatest such penetration (m).
    pub explained: BTreeMap<[usize; 2], f64>,
}

impl Steps {
    /// The steps, if they were made.
    pub fn made(&self) -> Option<&AuditedSteps> {
        match self {
            Steps::Made(made) => Some(made),
            Steps::Skipped(_) => None,
        }
    }

    /// Whether blocks passed through one another or were about to, or the steps could not be made.
    pub fn find_fault(&self) -> bool {
        self.made().is_some_and(|made| made.stopped.is_some() || made.totals.finds_fault())
    }

    /// Whether friction had not settled in some step, so that blocks moved otherwise than it lets them.
    pub fn lose_friction(&self) -> bool {
        self.made().is_some_and(|made| made.unsettled > 0)
    }

    /// Whether false entrances decide how blocks move ([`FalseEntranceTotals::are_decisive`]).
    ///
    /// [`FalseEntranceTotals::are_decisive`]: rockproof_simulate::FalseEntranceTotals::are_decisive
    pub fn have_decisive_false_entrances(&self) -> bool {
        self.made().is_some_and(|made| made.totals.false_entrances.are_decisive())
    }

    /// Whether blocks overlap deeper than `penetration` after some step: held only by contacts that were closed before, and lost once one opens.
    pub fn end_deep(&self) -> bool {
        self.made().is_some_and(|made| made.totals.steps_deep > 0)
    }
}

/// Makes `steps` steps of a scene after its settling, in a precision; `None` where it was stopped meanwhile. A scene of several blocks that fixes
/// nothing is held at its lowest, or at its largest.
///
/// # Errors
/// When coordinates are not finite. Where the scene cannot be stepped otherwise, that is why the steps ended.
pub(crate) fn make(
    scene: &Scene,
    set: &ToleranceSet,
    precision: Precision,
    steps: u64,
    (seen, stop): (&WorkProgress, &AtomicBool),
) -> Result<Option<AuditedSteps>, ExamineError> {
    let mut scene = scene.clone();
    let nothing_fixed = scene.blocks.iter().all(|block| !block.body.is_fixed());
    let held = match (nothing_fixed, scene.blocks.len()) {
        (false, _) => ClusterSupport::Given,
        (true, 1) => ClusterSupport::Nothing,
        (true, _) => hold_lowest(&mut scene),
    };
    scene.derive_stiffness(set);
    match precision {
        Precision::F32 => make_in::<f32>(&scene, set, (precision, held), steps, (seen, stop)),
        Precision::F64 => make_in::<f64>(&scene, set, (precision, held), steps, (seen, stop)),
    }
}

fn make_in<R: Solve>(
    scene: &Scene,
    set: &ToleranceSet,
    (precision, held): (Precision, ClusterSupport),
    steps: u64,
    (seen, stop): (&WorkProgress, &AtomicBool),
) -> Result<Option<AuditedSteps>, ExamineError> {
    let mut found = AuditedSteps {
        made: 0,
        asked: steps,
        held,
        stopped: None,
        unconverged: 0,
        unsettled: 0,
        touched: false,
        settled: Vec::new(),
        totals: AuditTotals::default(),
        passages: BTreeMap::new(),
        unseen: BTreeMap::new(),
        explained: BTreeMap::new(),
    };
    let dynamics = match Dynamics::<R, SpecRules>::new(scene, set) {
        Ok(dynamics) => dynamics,
        // A block that rounding makes degenerate: the model is wrong, not the command.
        Err(error) => {
            found.stopped = Some(error.to_string());
            return Ok(Some(found));
        }
    };
    let mut run = AuditedRun::new(Box::new(dynamics), scene, set, (precision, AuditScope::OverlapsAndPassages))?;
    while found.made < steps && found.stopped.is_none() {
        if stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        match run.step() {
            Err(error) => found.stopped = Some(error.to_string()),
            Ok(report) => {
                found.touched |=
                    report.contacts.iter().any(|modes| modes[Mode::Sliding as usize..].iter().any(|&count| count > 0));
                if let Some(audit) = run.audit() {
                    found.totals.add(report.step, &audit);
                    deepen(&mut found.passages, audit.passages.as_ref().map_or(&[], |passages| &passages.pairs));
                    deepen(&mut found.unseen, &audit.unseen);
                    deepen(&mut found.explained, &audit.explained);
                }
                found.unconverged += u64::from(report.step > 0 && !report.converged);
                found.unsettled += u64::from(report.step > 0 && Totals::is_unsettled(&report));
                let state = run.state();
                found.made = state.step;
                if report.step <= 0 && state.settling == 0 {
                    found.settled = after_settling(scene, &state.contacts);
                }
                seen.advance();
            }
        }
    }
    Ok(Some(found))
}

fn deepen(known: &mut BTreeMap<[usize; 2], f64>, found: &[PairDepth]) {
    for pair in found {
        let depth = known.entry(pair.blocks).or_default();
        *depth = depth.max(pair.depth_m);
    }
}
