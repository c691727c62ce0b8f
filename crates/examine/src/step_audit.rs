//! `simulate --audit`: every step audited exactly (SPEC section 7), overlaps after it and passages within it.

use crate::error::ExamineError;
use rayon::prelude::*;
use rockproof_model::{Block, ContactKey, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Audit, Auditor, Overlap, rounding_depth};
use rockproof_oracle::passage::{PassageAnswer, StraightMotion, passage, swept_neighbours};
use rockproof_oracle::penetration::Penetration;
use rockproof_simulate::run::StepAnnotations;
use rockproof_simulate::{PairDepth, StepAudit, Stepping};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{State, StepError, StepReport};
use std::collections::BTreeMap;

/// A run of which every step is audited. The stepper's coordinates are taken as exact; pairs of two fixed blocks are left
/// out, as they never move.
pub struct AuditedRun<R> {
    stepping: Box<dyn Stepping<R>>,
    set: ToleranceSet,
    precision: Precision,
    is_fixed: Vec<bool>,
    /// The blocks where the next step begins.
    before: Vec<Block>,
    last: Option<StepAudit>,
}

impl<R: Real> AuditedRun<R> {
    /// Audits the steps of a run from its present state on.
    ///
    /// # Errors
    /// Where its present state has a coordinate that is not finite.
    pub fn new(
        stepping: Box<dyn Stepping<R>>,
        scene: &Scene,
        set: &ToleranceSet,
        precision: Precision,
    ) -> Result<AuditedRun<R>, ExamineError> {
        let shapes: Vec<Block> = scene.blocks.iter().map(|block| block.block.clone()).collect();
        let before = placed(&shapes, stepping.state()).ok_or(ExamineError::NotFinite)?;
        let is_fixed = scene.blocks.iter().map(|block| block.body.is_fixed()).collect();
        Ok(AuditedRun { stepping, set: set.clone(), precision, is_fixed, before, last: None })
    }

    /// Whether one block of a pair can move.
    fn can_move(&self, pair: &[usize; 2]) -> bool {
        pair.iter().any(|&block| !self.is_fixed[block])
    }

    /// Fills in what blocks overlap after a step. A contact that the step left closed counts at any depth, as it does for
    /// the next step.
    fn audit_overlaps(&self, after: &[Block], state: &State<R>, found: &mut StepAudit) {
        let solids: Vec<PreparedBlock> = after.par_iter().map(PreparedBlock::new).collect();
        let auditor = Auditor::new(&solids, &self.set);
        let mut kept: BTreeMap<[usize; 2], Vec<ContactKey>> = BTreeMap::new();
        for contact in state.contacts.iter().filter(|contact| contact.mode.is_closed()) {
            kept.entry(contact.blocks.map(|block| block as usize)).or_default().push(contact.contact.key);
        }
        let pairs: Vec<[usize; 2]> = auditor.neighbours().into_iter().filter(|pair| self.can_move(pair)).collect();
        let audited = pairs.par_iter().map(|pair| {
            let kept = kept.get(pair).map_or(&[][..], Vec::as_slice);
            auditor.pair_keeping(*pair, kept)
        });
        let audit = Audit::of(audited.collect::<Vec<_>>());
        let rounding = rounding_depth(&after.iter().collect::<Vec<_>>(), self.precision);
        let is_unseen = |overlap: &Overlap| overlap.is_unseen(&rounding);
        let worst = |overlap: &Overlap| pair_depth(overlap.blocks, &overlap.penetration);
        found.unseen_pairs = audit.overlaps.iter().filter(|overlap| is_unseen(overlap)).map(worst).collect();
        found.unseen = found.unseen_pairs.len() as u64;
        found.worst_unseen = audit.deepest_of(is_unseen).map(worst);
        found.deepest = audit.deepest().map(worst);
    }

    /// Fills in which pairs passed through one another. Only pairs whose boxes over the whole step meet are asked about.
    fn audit_passages(&self, after: &[Block], found: &mut StepAudit) {
        let ends = || self.before.iter().zip(after);
        let motions: Vec<StraightMotion> = ends().map(|(before, after)| StraightMotion::new(before, after)).collect();
        let has_moved: Vec<bool> = ends().map(|(before, after)| before.vertices() != after.vertices()).collect();
        let mut pairs = swept_neighbours(&motions);
        pairs.retain(|[a, b]| has_moved[*a] || has_moved[*b]);
        let limit = &self.set.penetration;
        let asked = pairs.par_iter().map(|[a, b]| passage(&motions[*a], &motions[*b], limit).answer);
        for (&pair, answer) in pairs.iter().zip(asked.collect::<Vec<_>>()) {
            match answer {
                PassageAnswer::Passage { depth, .. } => {
                    let passage = pair_depth(pair, &depth);
                    found.passages += 1;
                    found.passage_pairs.push(passage);
                    if found.worst_passage.is_none_or(|worst| passage.depth_m > worst.depth_m) {
                        found.worst_passage = Some(passage);
                    }
                }
                PassageAnswer::Undecided => found.undecided += 1,
                PassageAnswer::NoPassage | PassageAnswer::DeepAtEnd => {}
            }
        }
    }
}

impl<R: Real> Stepping<R> for AuditedRun<R> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        self.last = None;
        let report = self.stepping.step()?;
        let state = self.stepping.state();
        // A step whose numbers are not finite is not made.
        if let Some(after) = placed(&self.before, state) {
            let mut found = StepAudit::default();
            self.audit_overlaps(&after, state, &mut found);
            self.audit_passages(&after, &mut found);
            (self.before, self.last) = (after, Some(found));
        }
        Ok(report)
    }

    fn state(&self) -> &State<R> {
        self.stepping.state()
    }

    fn annotations(&mut self) -> Option<StepAnnotations> {
        self.stepping.annotations()
    }

    fn audit(&mut self) -> Option<StepAudit> {
        self.last.take()
    }
}

/// Blocks where a state has them, its numbers taken as exact; `None` where one is not finite.
fn placed<R: Real>(shapes: &[Block], state: &State<R>) -> Option<Vec<Block>> {
    let number = |value: R| Number::from_f64(value.to_f64()).ok();
    let block = |(shape, now): (&Block, &rockproof_stepper::dynamics::BlockState<R>)| {
        let vertices = now.vertices.iter().map(|v| Some(Vec3::new(number(v.x)?, number(v.y)?, number(v.z)?)));
        Some(shape.with_vertices(vertices.collect::<Option<_>>()?))
    };
    shapes.iter().zip(&state.blocks).map(block).collect()
}

fn pair_depth(blocks: [usize; 2], penetration: &Penetration) -> PairDepth {
    PairDepth { blocks, depth_m: penetration.depth_m().unwrap_or(f64::INFINITY) }
}
