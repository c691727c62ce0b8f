//! Two blocks under classification: what all four tests share.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::Candidate;
use crate::contact::prepared_block::PreparedBlock;
use crate::contact::tolerances::Tolerances;
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{Contact, ContactKey};
use std::marker::PhantomData;

/// Two blocks, their tolerances, the rules, and who watches.
pub(super) struct Pair<'s, R, M, O> {
    pub(super) a: &'s PreparedBlock<R>,
    pub(super) b: &'s PreparedBlock<R>,
    pub(super) t: &'s Tolerances<R>,
    /// The contacts that the step before left closed: depth alone does not end them.
    pub(super) kept: &'s [ContactKey],
    pub(super) seen: &'s mut O,
    /// Entrance candidates of the contact in work; kept to reuse its memory.
    pub(super) candidates: Vec<Candidate<R>>,
    /// Which of the planes in question are true exits; kept to reuse its memory.
    pub(super) true_exits: Vec<bool>,
    pub(super) hits: Vec<ExitCandidate<R>>,
    pub(super) rules: PhantomData<M>,
}

/// A contact with the numbers that the exit rules need.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExitCandidate<R> {
    pub(super) contact: Contact,
    /// Metres, positive apart.
    pub(super) gap: R,
    /// Unit, from B to A.
    pub(super) normal: Vector<R>,
    /// Whether its entrance is a true exit, where that is known.
    pub(super) exits: Option<bool>,
}

impl<R: Real> ExitCandidate<R> {
    /// The plane of its entrance.
    pub(super) fn plane(&self) -> Candidate<R> {
        Candidate { entrance: self.contact.entrance, gap: self.gap, normal: self.normal, exits: self.exits }
    }
}

impl<'s, R: Real, M: ContactRules, O: Observer> Pair<'s, R, M, O> {
    #[inline(always)]
    pub(super) fn prepared(&self, side: Side) -> &'s PreparedBlock<R> {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    /// Tells the observer, and hands the answer on.
    #[inline(always)]
    pub(super) fn ask(&mut self, predicate: Predicate, features: &[Feature], answer: bool) -> bool {
        self.seen.observe(predicate, features, i8::from(answer));
        answer
    }

    /// Confirms a v-v, v-e or e-v contact by its best entrance, if one passed and is not too deep.
    pub(super) fn confirm(&mut self, contact: ContactKey) {
        let about = contact.features();
        let Some(best) = self.choose_entrance(about) else { return };
        let allowed = M::entrance_depth(best.gap, self.t.penetration) || self.is_kept(contact);
        if self.ask(Predicate::EntranceDepth, &about, allowed) {
            self.record(contact, best);
        }
    }

    /// Whether a contact is kept.
    pub(super) fn is_kept(&self, contact: ContactKey) -> bool {
        M::is_kept(self.kept, contact)
    }

    /// Adds a contact.
    pub(super) fn record(&mut self, key: ContactKey, best: Candidate<R>) {
        let sign = M::gap_sign(best.gap);
        self.seen.observe(Predicate::GapSign, &best.entrance.features(), sign.as_i8());
        let contact = Contact { key, entrance: best.entrance, gap: sign };
        self.hits.push(ExitCandidate { contact, gap: best.gap, normal: best.normal, exits: best.exits });
    }
}
