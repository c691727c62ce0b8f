//! The chain of SPEC section 6 for one step: exact scene with ideal tolerances, exact scene, rounded scene, stepper.

use crate::builtin::signed;
use crate::compare::{Difference, Features};
use crate::engine::Trace;
use crate::explain::{ChainLink, explain};
use crate::finding::{Cause, DecidingDecision};
use crate::indexed_trace::IndexedTrace;
use crate::lockstep::answer::{StepAnswerChange, StepDifference};
use crate::lockstep::classified::ClassifiedBlocks;
use crate::lockstep::scene::ExactScene;
use rockproof_model::{Block, ContactKey, ToleranceSet};
use rockproof_oracle::Pair;
use rockproof_oracle::step::{self as exact, DecidedAttempt, ModeMargin};
use rockproof_stepper::contact::{ClassificationRequest, PreparedBlock, Tolerances};
use rockproof_stepper::dynamics::{Mode, StepRules};
use rockproof_stepper::real::Real;
use std::rc::Rc;

/// Which links of the chain are compared in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedLinks {
    /// Only the last: the rounded scene, exactly, against the stepper.
    Arithmetic,
    /// All three: two exact steps more.
    All,
}

/// A difference with its cause.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributedDifference {
    /// The link of the chain.
    pub cause: Cause,
    /// The difference.
    pub difference: StepDifference,
    /// The decision behind a difference of contacts, where traces tell.
    pub deciding: Option<DecidingDecision>,
    /// Of a mode that rounding or arithmetic changed: how far the exact quantity behind it, gap, Mohr–Coulomb or Eq. (1), was from deciding
    /// otherwise at the solve where modes part ([`ModeMargin`]), and the same in roundoffs.
    pub mode_margin: Option<[f64; 2]>,
}

impl AttributedDifference {
    /// A difference of which nothing more is known.
    pub fn new(cause: Cause, difference: StepDifference) -> AttributedDifference {
        AttributedDifference { cause, difference, deciding: None, mode_margin: None }
    }

    /// The margin of what decided it, if there is one.
    pub fn margin(&self) -> Option<f64> {
        self.deciding.and_then(|d| d.margin).or(self.mode_margin.map(|[margin, _]| margin))
    }

    /// The same in roundoffs.
    pub fn margin_ulps(&self) -> Option<f64> {
        self.deciding.and_then(|d| d.margin_ulps).or(self.mode_margin.map(|[_, ulps]| ulps))
    }
}

/// Gives modes their margins: `before` is the exact answer of a link, made of a scene from a state.
pub(super) fn measure_modes(
    attributed: &mut [AttributedDifference],
    before: DecidedAttempt<'_>,
    (scene, state): (&ExactScene, &exact::State),
    roundoff: f64,
) {
    let of_mode = |c: &&mut AttributedDifference| c.difference.change == StepAnswerChange::Mode;
    let mut margins: Option<Vec<Vec<ModeMargin>>> = None;
    for attributed in attributed.iter_mut().filter(of_mode) {
        let difference = &attributed.difference;
        let (Some((pair, contact)), Some(solve)) = (difference.contact, difference.solve) else { continue };
        let margins = margins.get_or_insert_with(|| scene.mode_margins(state, before));
        let pair = pair.map(|block| block as usize);
        let place = before.contacts.iter().position(|(blocks, known)| *blocks == pair && known.key == contact.key);
        let margin = place.and_then(|place| margins.get(solve - 1)?.get(place).copied());
        let opens = [&difference.before, &difference.after].iter().any(|mode| *mode == Mode::Open.name());
        let margin = margin.and_then(|margin| match margin.equal {
            Some(kept) if kept <= 0.0 => Some(kept),
            _ if opens => margin.gap,
            _ => margin.slip,
        });
        attributed.mode_margin = margin.map(|margin| [margin, margin / roundoff]);
    }
}

/// One side of a link: blocks in their state and the tolerances they are classified with.
#[derive(Clone, Copy)]
pub(super) struct LinkSide<'s, 'b> {
    pub(super) blocks: &'s ClassifiedBlocks<'b>,
    pub(super) tolerances: &'s ToleranceSet,
}

/// Explains the contact differences of a link by the decisions that came out differently. The second side is the oracle's,
/// or, of a link to the stepper, that of the stepper in the scalar R by the rules M.
pub(super) struct Explainer<'s, 'b> {
    pub(super) before: LinkSide<'s, 'b>,
    pub(super) after: LinkSide<'s, 'b>,
    pub(super) roundoff: Option<f64>,
    /// The state before the step, whose closed contacts are kept.
    pub(super) state: &'s exact::State,
}

impl Explainer<'_, '_> {
    /// The differences with their cause; `stepper` traces a pair of blocks in the stepper, where the link leads to it.
    pub(super) fn attribute(
        &self,
        found: Vec<StepDifference>,
        cause: Cause,
        stepper: Option<Tracer<'_>>,
    ) -> Vec<AttributedDifference> {
        let mut attributed: Vec<AttributedDifference> =
            found.into_iter().map(|difference| AttributedDifference::new(cause, difference)).collect();
        let mut done = 0;
        while let Some(first) = attributed[done..].iter().position(|c| c.difference.is_of_contacts()) {
            let first = done + first;
            let pair = attributed[first].difference.contact.map(|(pair, _)| pair);
            let same = |c: &AttributedDifference| {
                c.difference.is_of_contacts() && c.difference.contact.map(|(pair, _)| pair) == pair
            };
            let end = first + attributed[first..].iter().take_while(|c| same(c)).count();
            done = end;
            let differences: Vec<Difference> = attributed[first..end]
                .iter()
                .filter_map(|c| {
                    if let StepAnswerChange::Contact(difference) = c.difference.change {
                        Some(difference)
                    } else {
                        None
                    }
                })
                .collect();
            let Some(pair) = pair else { continue };
            let deciding = self.explain(pair, &differences, stepper);
            for (attributed, deciding) in attributed[first..end].iter_mut().zip(deciding) {
                attributed.deciding = deciding;
            }
        }
        attributed
    }

    fn explain(
        &self,
        pair: [u32; 2],
        differences: &[Difference],
        stepper: Option<Tracer<'_>>,
    ) -> Vec<Option<DecidingDecision>> {
        let [a, b] = pair.map(|block| self.before.blocks.block(block));
        let kept = self.state.kept_contacts(pair.map(|block| block as usize));
        let before = self.before.blocks.pair(pair);
        let trace_after = || {
            if let Some(stepper) = stepper {
                let [a, b] = pair.map(|block| self.after.blocks.block(block));
                return stepper(a, b, &kept).map(IndexedTrace::of);
            }
            Some(trace(&self.after.blocks.pair(pair), self.after.tolerances, &kept))
        };
        let link = ChainLink {
            before: &|| Some(Rc::new(trace(&before, self.before.tolerances, &kept))),
            after: &|| trace_after().map(Rc::new),
            margins: &|decisions| {
                let margins = before.margins_with_kept(self.before.tolerances, &kept, decisions);
                margins.into_iter().map(|margin| margin.map(signed)).collect()
            },
            roundoff: self.roundoff,
        };
        explain(differences, &link, Features { a: a.topology(), b: b.topology() })
    }
}

/// The decisions of the oracle about a pair.
fn trace(pair: &Pair<'_>, tolerances: &ToleranceSet, kept: &[ContactKey]) -> IndexedTrace {
    let (decisions, index) = pair.outcomes_with_kept(tolerances, kept);
    IndexedTrace::with_index(decisions, index)
}

/// Traces two blocks, of whose contacts some are kept.
pub(super) type Tracer<'t> = &'t dyn Fn(&Block, &Block, &[ContactKey]) -> Option<Trace>;

/// The decisions of the stepper about two blocks.
pub(super) fn stepper_trace<R: Real, M: StepRules>(
    [a, b]: [&Block; 2],
    set: &ToleranceSet,
    kept: &[ContactKey],
) -> Option<Trace> {
    let (a, b, tolerances) =
        (PreparedBlock::<R>::new(a).ok()?, PreparedBlock::<R>::new(b).ok()?, Tolerances::new(set).ok()?);
    Some(ClassificationRequest { a: &a, b: &b, tolerances: &tolerances, kept, among: None }.traced::<M>().1)
}
