//! The chain of SPEC section 6 for one step: exact scene with ideal tolerances, exact scene, rounded scene, stepper.

use crate::campaign::builtin::Exact;
use crate::campaign::compare::{Difference, Features};
use crate::campaign::engine::{Oracle, Trace};
use crate::campaign::explain::{Link, explain};
use crate::campaign::finding::{Cause, Deciding};
use crate::lockstep::answer::{Change, StepDifference};
use crate::model::{Block, ToleranceSet};
use crate::stepper::contact::{Solid, Tolerances, classify_traced};
use crate::stepper::dynamics::StepRules;
use crate::stepper::real::Real;

/// Which links of the chain are compared in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Links {
    /// Only the last: the rounded scene, exactly, against the stepper.
    Arithmetic,
    /// All three: two exact steps more.
    All,
}

/// A difference with its cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Caused {
    /// The link of the chain.
    pub cause: Cause,
    /// The difference.
    pub difference: StepDifference,
    /// The decision behind a difference of contacts, where traces tell.
    pub deciding: Option<Deciding>,
}

/// One side of a link: blocks in their state and the tolerances they are classified with.
#[derive(Clone, Copy)]
pub(super) struct Side<'s> {
    pub(super) blocks: &'s [Block],
    pub(super) tolerances: &'s ToleranceSet,
}

/// Explains the contact differences of a link by the decisions that came out differently. The second side is the oracle's,
/// or, of a link to the stepper, that of the stepper in the scalar R by the rules M.
pub(super) struct Explainer<'s> {
    pub(super) before: Side<'s>,
    pub(super) after: Side<'s>,
    pub(super) roundoff: Option<f64>,
}

impl Explainer<'_> {
    /// The differences with their cause; `stepper` traces a pair of blocks in the stepper, where the link leads to it.
    pub(super) fn caused(&self, found: Vec<StepDifference>, cause: Cause, stepper: Option<Tracer<'_>>) -> Vec<Caused> {
        let mut caused: Vec<Caused> =
            found.into_iter().map(|difference| Caused { cause, difference, deciding: None }).collect();
        let mut done = 0;
        while let Some(first) = caused[done..].iter().position(|c| c.difference.is_of_contacts()) {
            let first = done + first;
            let pair = caused[first].difference.contact.map(|(pair, _)| pair);
            let same = |c: &Caused| c.difference.is_of_contacts() && c.difference.contact.map(|(pair, _)| pair) == pair;
            let end = first + caused[first..].iter().take_while(|c| same(c)).count();
            done = end;
            let differences: Vec<Difference> = caused[first..end]
                .iter()
                .filter_map(
                    |c| if let Change::Contact(difference) = c.difference.change { Some(difference) } else { None },
                )
                .collect();
            let Some(pair) = pair else { continue };
            let deciding = self.explain(pair, &differences, stepper);
            for (caused, deciding) in caused[first..end].iter_mut().zip(deciding) {
                caused.deciding = deciding;
            }
        }
        caused
    }

    fn explain(
        &self,
        pair: [u32; 2],
        differences: &[Difference],
        stepper: Option<Tracer<'_>>,
    ) -> Vec<Option<Deciding>> {
        let of = |side: &Side<'_>| pair.map(|block| side.blocks[block as usize].clone());
        let ([a, b], [a_after, b_after]) = (of(&self.before), of(&self.after));
        let (before, after) = (Exact.prepare(&a, &b), Exact.prepare(&a_after, &b_after));
        let (before, after) = (before.pair(), after.pair());
        let link = Link {
            before: &|| Some(before.trace(self.before.tolerances)),
            after: &|| match stepper {
                Some(stepper) => stepper(&a_after, &b_after),
                None => Some(after.trace(self.after.tolerances)),
            },
            margins: &|decisions| before.margins(self.before.tolerances, decisions),
            roundoff: self.roundoff,
        };
        explain(differences, &link, Features { a: a.topology(), b: b.topology() })
    }
}

/// Traces two blocks.
pub(super) type Tracer<'t> = &'t dyn Fn(&Block, &Block) -> Option<Trace>;

/// The decisions of the stepper about two blocks.
pub(super) fn stepper_trace<R: Real, M: StepRules>(a: &Block, b: &Block, set: &ToleranceSet) -> Option<Trace> {
    let (a, b) = (Solid::<R>::new(a).ok()?, Solid::<R>::new(b).ok()?);
    Some(classify_traced::<R, M>(&a, &b, &Tolerances::new(set).ok()?).1)
}
