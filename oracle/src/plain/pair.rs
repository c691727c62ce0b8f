//! Two blocks, the tolerances between them, and the record of what was decided.

use super::predicate_answer::PredicateAnswer;
use super::rational_block::{RationalBlock, SquaredTolerances};
use super::{ExactContact, TracedDecision};
use crate::rational::Rational;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, Contact, ContactKey, Criteria, Entrance, Sign, ToleranceSet, Vec3, VertexId};
use std::cell::RefCell;
use std::collections::BTreeSet;

/// A pair of blocks under a tolerance set.
pub(super) struct Pair<'a, Q> {
    pub(super) a: RationalBlock<'a, Q>,
    pub(super) b: RationalBlock<'a, Q>,
    pub(super) limits: SquaredTolerances<Q>,
    /// The contacts that the step before left closed.
    kept: BTreeSet<ContactKey>,
    log: RefCell<DecisionLog>,
}

/// A true exit dips by no more than r over this (SPEC section 4).
const TRUE_EXIT_INVERSE: i32 = 10;

/// The decisions taken so far, if anybody asks for them.
pub(super) struct DecisionLog {
    kept: Option<Vec<TracedDecision>>,
    seen: BTreeSet<Decision>,
}

impl DecisionLog {
    /// Keeps nothing.
    pub(super) fn off() -> DecisionLog {
        DecisionLog { kept: None, seen: BTreeSet::new() }
    }

    /// Keeps each decision once.
    pub(super) fn on() -> DecisionLog {
        DecisionLog { kept: Some(Vec::new()), seen: BTreeSet::new() }
    }
}

impl<'a, Q: Rational> Pair<'a, Q> {
    pub(super) fn new(a: &'a Block, b: &'a Block, tolerances: &ToleranceSet, log: DecisionLog) -> Self {
        let exact = |n| Q::from_number(n);
        let search = exact(&tolerances.search);
        let territory = exact(&tolerances.territory);
        let exit = territory.over(&Q::from_integer(TRUE_EXIT_INVERSE)).unwrap_or_else(Q::zero);
        let limits = SquaredTolerances {
            search_squared: search.squared(),
            search,
            territory_squared: territory.squared(),
            penetration_squared: exact(&tolerances.penetration).squared(),
            exit_squared: exit.squared(),
            overlap_squared: exact(&tolerances.overlap_sine).squared(),
            parallel_squared: exact(&tolerances.parallel_sine).squared(),
            equal: exact(&tolerances.equal),
            criteria: tolerances.criteria,
        };
        let (a, b) = (RationalBlock::new(a, &limits), RationalBlock::new(b, &limits));
        Pair { a, b, limits, kept: BTreeSet::new(), log: RefCell::new(log) }
    }

    /// The same pair with contacts kept from the step before.
    pub(super) fn with_kept(self, kept: &[ContactKey]) -> Self {
        Pair { kept: kept.iter().copied().collect(), ..self }
    }

    pub(super) fn is_classic(&self) -> bool {
        self.limits.criteria == Criteria::Classic
    }

    /// A contact is **not too deep** when it is kept, and then nothing is asked, or its plane has `h ≥ −g`.
    /// **A tie says yes.**
    pub(super) fn not_too_deep(
        &self,
        predicate: Predicate,
        features: &[Feature],
        contact: &ContactWithPlane<Q>,
    ) -> bool {
        self.kept.contains(&contact.key) || self.decide(predicate, features, contact.plane.not_too_deep(&self.limits))
    }

    pub(super) fn side(&self, side: Side) -> &RationalBlock<'a, Q> {
        match side {
            Side::A => &self.a,
            Side::B => &self.b,
        }
    }

    pub(super) fn vertex(&self, side: Side, vertex: VertexId) -> &Vec3<Q> {
        &self.side(side).vertices[vertex.index()]
    }

    /// Records a verdict and hands on its answer.
    pub(super) fn decide(&self, predicate: Predicate, features: &[Feature], verdict: PredicateAnswer) -> bool {
        self.record(predicate, features, i8::from(verdict.yes), verdict.tie);
        verdict.yes
    }

    /// Records the sign of the gap of a contact's entrance.
    pub(super) fn record_gap_sign(&self, plane: &EntrancePlane<Q>) {
        let sign = plane.gap_sign();
        self.record(Predicate::GapSign, &plane.entrance.features(), sign.as_i8(), plane.unsided || sign == Sign::Zero);
    }

    fn record(&self, predicate: Predicate, features: &[Feature], outcome: i8, tie: bool) {
        let mut log = self.log.borrow_mut();
        let decision = Decision::about(predicate, features);
        if log.kept.is_some() && log.seen.insert(decision) {
            log.kept.get_or_insert_default().push((decision, outcome, tie));
        }
    }

    /// The decisions recorded.
    pub(super) fn into_trace(self) -> Vec<TracedDecision> {
        self.log.into_inner().kept.unwrap_or_default()
    }
}

/// A plane through which the blocks may enter one another, with the gap along its normal.
#[derive(Clone)]
pub(super) struct EntrancePlane<Q> {
    pub(super) entrance: Entrance,
    /// Points from B to A; not normalised.
    pub(super) normal: Vec3<Q>,
    /// `h·|h|` of the gap h, in m²: its square, with its sign. Zero when the normal is.
    pub(super) gap_signed_square: Q,
    /// Whether the side to which the normal points was an exact tie (σ of two edges).
    pub(super) unsided: bool,
}

impl<Q: Rational> EntrancePlane<Q> {
    /// The sign of the gap.
    pub(super) fn gap_sign(&self) -> Sign {
        self.gap_signed_square.sign()
    }

    /// `h ≤ s`
    pub(super) fn near(&self, limits: &SquaredTolerances<Q>) -> PredicateAnswer {
        PredicateAnswer::at_most(&self.gap_signed_square, &limits.search_squared).tied_if(self.unsided)
    }

    /// `h ≥ −g`
    pub(super) fn not_too_deep(&self, limits: &SquaredTolerances<Q>) -> PredicateAnswer {
        PredicateAnswer::at_least(&self.gap_signed_square, &limits.penetration_squared.negated()).tied_if(self.unsided)
    }
}

/// A contact with the plane of its entrance.
#[derive(Clone)]
pub(super) struct ContactWithPlane<Q> {
    pub(super) key: ContactKey,
    pub(super) plane: EntrancePlane<Q>,
}

impl<Q: Rational> ContactWithPlane<Q> {
    /// What is handed out.
    pub(super) fn published(self) -> ExactContact<Q> {
        let gap = self.plane.gap_sign();
        let contact = Contact { key: self.key, entrance: self.plane.entrance, gap };
        ExactContact { contact, gap_squared: self.plane.gap_signed_square.magnitude() }
    }
}

/// Two of a kind in the order A, B, when `own` lies on `side` and `other` on the opposite one.
pub(super) fn in_order<T>(side: Side, own: T, other: T) -> (T, T) {
    match side {
        Side::A => (own, other),
        Side::B => (other, own),
    }
}
