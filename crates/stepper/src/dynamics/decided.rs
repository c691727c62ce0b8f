//! What a step decides, without the state after it where nothing can go wrong there.

#[cfg(test)]
mod tests;

use crate::contact::PreparedBlock;
use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::BlockVector;
use crate::dynamics::report::{Retry, StepError};
use crate::dynamics::solve::Solve;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use crate::dynamics::unchanged::Unchanged;
use crate::real::Real;
use crate::wide::Wide;
use rockproof_model::Contact;

/// What a step decides besides its modes ([`Dynamics::modes`]).
#[derive(Clone, Debug, PartialEq)]
pub struct DecidedStep {
    /// As in [`crate::dynamics::StepReport`].
    pub converged: bool,
    /// Attempts given up, in order.
    pub retries: Vec<Retry>,
    /// The Δt that was accepted (s).
    pub time_step: f64,
}

/// A rotation or a strain below this, as all nine of a block are: their sum is below 1/4.
const SMALL: f64 = 1.0 / 64.0;
/// How well an unknown must be known, as a share of the block's size (of translations) or of 1.
const KNOWN: f64 = 1.0 / (1u64 << 50) as f64;
/// The least length of an edge as a share of the block's size, and of an area and a volume as shares of its square and cube.
const LEAST: f64 = 1.0 / (1u64 << 40) as f64;

impl<M: StepRules> Dynamics<Wide, M> {
    /// Makes the decisions of the next step with contacts that are given ([`Dynamics::step_prescribed`]), asks all that the step asks, and fails
    /// where it fails. What the state is then is not said.
    ///
    /// # Errors
    /// When the run cannot go on.
    pub fn decide_prescribed(&mut self, contacts: &[([u32; 2], Contact)]) -> Result<DecidedStep, StepError> {
        M::decide_step(self, contacts)
    }
}

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    pub(super) fn make_decisions(&mut self, contacts: &[([u32; 2], Contact)]) -> Result<DecidedStep, StepError> {
        let settling = self.state.settling > 0;
        let number = self.next_number();
        let mut contacts = self.begin_step(self.prescribed_contacts(contacts));
        let accepted = self.attempts(&mut contacts, number, settling)?;
        let decided = DecidedStep {
            converged: accepted.ended.converged,
            retries: accepted.retries.clone(),
            time_step: accepted.time_step.to_f64(),
        };
        let mut moving = (0..self.prepared.len()).filter(|&block| !self.is_fixed(block));
        if moving.all(|block| stays_whole(&self.prepared[block], &accepted.ended.d[block])) {
            // What contacts leave to the next step takes comparisons, and those that stay unsettled count.
            let left = |contact: &StepContact<R>| contact.state_after_step::<M>(|_, point| point);
            contacts.iter().map(left).for_each(drop);
        } else {
            self.accept(&contacts, accepted, number, settling)?;
        }
        self.unchanged = Unchanged::NONE;
        self.neighbours.forget_features();
        Ok(decided)
    }
}

/// Whether a block, moved by these unknowns, surely keeps a positive volume and all its features, so that nothing about it can fail in a scalar of
/// 100 bits and more.
///
/// The map of its points has a linear part I + E, turned in `cayley`, with E of a norm below 1/2 where rotations and strains sum up to less than
/// 1/4. So its volume is multiplied by more than an eighth, its lengths and areas by more than a quarter; and the plane of a face, to which an edge
/// of it is inclined by less than a quarter before, holds a direction across the edge afterwards. Against that the roundings of 2⁻⁹⁶ are nothing
/// where no length, area and volume is below 2⁻⁴⁰ of what the block's size makes of it, nor are the radii of the unknowns.
fn stays_whole<R: Real>(block: &PreparedBlock<R>, d: &BlockVector<R>) -> bool {
    let size = block.extent();
    let is_known = |(k, &x): (usize, &R)| {
        let scale = if k < 3 { size } else { 1.0 };
        (x - R::from_f64(x.to_f64())).abs().surely_below(R::from_f64(KNOWN * scale))
    };
    let is_small = |x: &R| x.abs().surely_below(R::from_f64(SMALL));
    d.iter().enumerate().all(is_known) && d[3..].iter().all(is_small) && block.has_extent_beyond(size, LEAST)
}
