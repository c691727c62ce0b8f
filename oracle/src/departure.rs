//! Classifications that depart from SPEC section 4 in one respect, exactly otherwise: what a code with that mistake would answer.

use crate::pair::Pair;
use crate::sign_ladder::{Classification, Observer};
use rockproof_model::decision::{Decision, Predicate};
use rockproof_model::{Contact, Sign, ToleranceSet};

/// One respect in which a classification departs from SPEC section 4.
#[derive(Clone, Copy)]
pub enum Departure<'d> {
    /// Where a sign that this predicate rests on is exactly zero, it is taken for the given one: `<` for `≤`, or the other way round. Of
    /// [`Predicate::GapSign`] it is the gap's. Every other sign is as it is.
    Tie(Predicate, Sign),
    /// The predicate is given this answer whatever is asked of it.
    Always(Predicate, bool),
    /// Contacts for which this holds are not looked for; what remains goes through test 5.
    LeftOut(&'d dyn Fn(&Contact) -> bool),
}

impl Pair<'_> {
    /// The contacts of [`Pair::classify`] with one departure, sorted likewise.
    ///
    /// What is beyond the reach of `search` is skipped as always, so that a departure about nearness shows at ties alone.
    pub fn classify_departing(&self, tolerances: &ToleranceSet, departure: Departure<'_>) -> Vec<Contact> {
        Classification::new(self, tolerances, Departing { departure, under_way: None }).classify()
    }
}

struct Departing<'d> {
    departure: Departure<'d>,
    /// The predicate of the decision being made.
    under_way: Option<Predicate>,
}

impl Observer for Departing<'_> {
    const ACTIVE: bool = true;

    fn begin(&mut self, decision: &Decision) {
        self.under_way = Some(decision.predicate);
    }

    fn sign(&mut self, _sign: Sign, _margin: &mut dyn FnMut() -> f64) {}

    fn end(&mut self, _decision: &Decision, _outcome: i8) {
        self.under_way = None;
    }

    fn taken(&self, sign: Sign) -> Sign {
        match self.departure {
            // The orientation of an entrance turns the signs that its gap is made of: that one is seen to below.
            Departure::Tie(predicate, taken)
                if sign.is_zero() && self.under_way == Some(predicate) && predicate != Predicate::GapSign =>
            {
                taken
            }
            _ => sign,
        }
    }

    fn answered(&self, decision: &Decision, yes: bool) -> bool {
        match self.departure {
            Departure::Always(predicate, answer) if predicate == decision.predicate => answer,
            _ => yes,
        }
    }

    fn signed(&self, decision: &Decision, sign: Sign) -> Sign {
        match self.departure {
            Departure::Tie(predicate, taken) if sign.is_zero() && predicate == decision.predicate => taken,
            _ => sign,
        }
    }

    fn leaves_out(&self, contact: &Contact) -> bool {
        match self.departure {
            Departure::LeftOut(is_left_out) => is_left_out(contact),
            _ => false,
        }
    }
}
