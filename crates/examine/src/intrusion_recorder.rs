//! Of an audited run the worst passages and unseen overlaps, with the state before each, and their cases and causes once it has ended.

use crate::step_audit::is_unseen;
use rockproof_differential::lockstep::intrusion_case::{FoundIntrusion, NoCase, intrusion_case};
use rockproof_differential::lockstep::{Intrusion, StepCase};
use rockproof_model::{Block, Precision, Scene, ToleranceSet};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_simulate::exact_float::ExactFloat;
use rockproof_simulate::run::StepAnnotations;
use rockproof_simulate::{AuditScope, IntrusionRow, PairDepth, StepAudit, Stepping, WorstIntrusion, WorstIntrusions};
use rockproof_stepper::dynamics::{Solve, State, StepError, StepReport};

/// An audited run that keeps the worst of what it finds, each with the state before its step: passages, and overlaps in the step after which no contact
/// sees them first.
pub struct IntrusionRecorder<R> {
    stepping: Box<dyn Stepping<R>>,
    shapes: Vec<Block>,
    is_fixed: Vec<bool>,
    set: ToleranceSet,
    precision: Precision,
    scope: AuditScope,
    kept: WorstIntrusions,
    /// The pairs that no contact saw after the last step; `None` before the first.
    unseen: Option<Vec<PairDepth>>,
    /// Whether the last step changed what is kept.
    is_changed: bool,
    audit: Option<StepAudit>,
}

impl<R: Solve> IntrusionRecorder<R> {
    /// The same run; `kept` are those of the run that it goes on with.
    pub fn new(
        stepping: Box<dyn Stepping<R>>,
        scene: &Scene,
        set: &ToleranceSet,
        (precision, scope): (Precision, AuditScope),
        kept: &[WorstIntrusion],
    ) -> IntrusionRecorder<R> {
        let shapes = scene.blocks.iter().map(|block| block.block.clone()).collect();
        let kept = WorstIntrusions::new(kept.to_vec());
        IntrusionRecorder {
            stepping,
            shapes,
            is_fixed: scene.fixed(),
            set: set.clone(),
            precision,
            scope,
            kept,
            unseen: None,
            is_changed: false,
            audit: None,
        }
    }

    fn keep(&mut self, step: i64, audit: &StepAudit, before: &State<R>) {
        let passages = audit.passages.iter().flat_map(|found| &found.pairs).map(|pair| (Intrusion::Passage, *pair));
        let unseen = audit.unseen.iter().map(|pair| (Intrusion::Unseen, *pair));
        for (kind, pair) in passages.chain(unseen) {
            let is_new = || kind == Intrusion::Passage || !self.was_unseen(before, pair);
            if self.kept.wants(kind.name(), pair) && is_new() {
                let PairDepth { blocks, depth_m } = pair;
                let (change, depth_m, state) = (kind.name().to_owned(), ExactFloat(depth_m), SavedState::of(before));
                self.kept.keep(WorstIntrusion { change, blocks, depth_m, step, state });
                self.is_changed = true;
            }
        }
    }
}

impl<R: Solve> IntrusionRecorder<R> {
    /// Whether no contact saw the overlap of a pair before the step either.
    fn was_unseen(&self, before: &State<R>, pair: PairDepth) -> bool {
        let about = (&self.set, self.precision, self.scope);
        let asked = || is_unseen((&self.shapes, &self.is_fixed), about, before, pair.blocks);
        self.unseen.as_ref().map_or_else(asked, |unseen| unseen.iter().any(|one| one.blocks == pair.blocks))
    }
}

impl<R: Solve> Stepping<R> for IntrusionRecorder<R> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        let before = self.stepping.state().clone();
        self.is_changed = false;
        let report = self.stepping.step()?;
        self.audit = self.stepping.audit();
        if let Some(audit) = self.audit.take() {
            self.keep(report.step, &audit, &before);
            self.unseen = Some(audit.unseen.clone());
            self.audit = Some(audit);
        }
        Ok(report)
    }

    fn state(&self) -> &State<R> {
        self.stepping.state()
    }

    fn annotations(&mut self) -> Option<StepAnnotations> {
        let beside = self.stepping.annotations();
        if !self.is_changed {
            return beside;
        }
        let intrusions = Some(self.kept.all().to_vec());
        Some(StepAnnotations { intrusions, ..beside.unwrap_or_default() })
    }

    fn audit(&mut self) -> Option<StepAudit> {
        self.audit.take()
    }
}

/// The cases of what a run kept, by name within its directory, and the rows of `intrusions.csv`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IntrusionCases {
    /// A row for each cause, or one without cause.
    pub rows: Vec<IntrusionRow>,
    /// The cases.
    pub cases: Vec<(String, Vec<u8>)>,
}

impl IntrusionCases {
    /// Finds cases and causes of what a run in the scalar R kept.
    pub fn of<R: Solve>(
        kept: &[WorstIntrusion],
        scene: &Scene,
        set: &ToleranceSet,
        precision: Precision,
    ) -> IntrusionCases {
        let mut all = IntrusionCases::default();
        for one in kept {
            let Some(kind) = Intrusion::ALL.into_iter().find(|kind| kind.name() == one.change) else { continue };
            let found = FoundIntrusion { kind, blocks: one.blocks, depth_m: one.depth_m.0 };
            let state = one.state.state::<R>().ok();
            let made = state.map(|state| intrusion_case(scene, set, precision, &state, found));
            let [block_a, block_b] = one.blocks;
            let empty = IntrusionRow {
                step: one.step,
                change: one.change.clone(),
                block_a,
                block_b,
                depth_m: one.depth_m.0,
                cause: String::new(),
                before: String::new(),
                after: String::new(),
                case_blocks: match made {
                    Some(Err(NoCase::TooMany(blocks))) => Some(blocks),
                    _ => None,
                },
                case: String::new(),
            };
            let text = made.and_then(|made| made.ok()).and_then(|made| Some((made.case.text().ok()?, made)));
            let Some((text, made)) = text else {
                all.rows.push(empty);
                continue;
            };
            let name = format!("cases/{}_{block_a}-{block_b}_{}", one.change, StepCase::name_of(one.step));
            let found = IntrusionRow { case_blocks: Some(made.blocks), case: name.clone(), ..empty };
            all.cases.push((name, text));
            let row = |one: &rockproof_differential::lockstep::intrusion::CausedIntrusion| {
                let [before, after] = one.words().map(str::to_owned);
                IntrusionRow { cause: one.cause.to_string(), before, after, ..found.clone() }
            };
            match &made.causes[..] {
                [] => all.rows.push(found),
                causes => all.rows.extend(causes.iter().map(row)),
            }
        }
        all
    }
}
