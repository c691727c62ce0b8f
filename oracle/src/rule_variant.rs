//! Classifications that depart from SPEC section 4 in one respect, exactly otherwise: what a code with that mistake would answer.

use crate::classification::{Classification, Observer};
use crate::pair::Pair;
use rockproof_model::decision::{Decision, Predicate};
use rockproof_model::{Contact, Sign, ToleranceSet};

/// One respect in which a classification departs from SPEC section 4.
#[derive(Clone, Copy)]
pub enum RuleVariant<'d> {
    /// Where a sign that this predicate rests on is exactly zero, it is taken for the given one: `<` for `≤`, or the other way round. Of
    /// [`Predicate::GapSign`] it is the gap's. Every other sign is as it is.
    Tie(Predicate, Sign),
    /// The predicate is given this answer whatever is asked of it.
    Always(Predicate, bool),
    /// Of several entrances that with the smallest gap is chosen in place of that with the largest; of equal ones the first, without Eq. (1).
    SmallestGap,
    /// Contacts for which this holds are not looked for; what remains goes through test 5.
    LeftOut(&'d dyn Fn(&Contact) -> bool),
}

impl Pair<'_> {
    /// The contacts of [`Pair::classify`] with one variant, sorted likewise.
    ///
    /// What is beyond the reach of `search` is skipped as always, so that a variant about nearness shows at ties alone.
    pub fn classify_with_variant(&self, tolerances: &ToleranceSet, variant: RuleVariant<'_>) -> Vec<Contact> {
        let observer: &mut dyn Observer = &mut VariantObserver { variant, under_way: None };
        Classification::new(self, tolerances, observer).classify()
    }
}

struct VariantObserver<'d> {
    variant: RuleVariant<'d>,
    /// The predicate of the decision being made.
    under_way: Option<Predicate>,
}

impl Observer for VariantObserver<'_> {
    fn begin(&mut self, decision: &Decision) {
        self.under_way = Some(decision.predicate);
    }

    fn sign(&mut self, sign: Sign, _margin: &mut dyn FnMut() -> f64) -> Sign {
        match self.variant {
            // The orientation of an entrance turns the signs that its gap is made of: that one is seen to below.
            RuleVariant::Tie(predicate, taken)
                if sign.is_zero() && self.under_way == Some(predicate) && predicate != Predicate::GapSign =>
            {
                taken
            }
            _ => sign,
        }
    }

    fn end(&mut self, decision: &Decision, yes: bool) -> bool {
        self.under_way = None;
        match self.variant {
            RuleVariant::Always(predicate, answer) if predicate == decision.predicate => answer,
            _ => yes,
        }
    }

    fn end_with_sign(&mut self, decision: &Decision, sign: Sign) -> Sign {
        self.under_way = None;
        match self.variant {
            RuleVariant::Tie(predicate, taken) if sign.is_zero() && predicate == decision.predicate => taken,
            _ => sign,
        }
    }

    fn takes_smallest_gap(&self) -> bool {
        matches!(self.variant, RuleVariant::SmallestGap)
    }

    fn leaves_out(&self, contact: &Contact) -> bool {
        match self.variant {
            RuleVariant::LeftOut(is_left_out) => is_left_out(contact),
            _ => false,
        }
    }
}
