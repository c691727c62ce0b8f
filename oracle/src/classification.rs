//! One classification under way: its signs, and who sees its decisions.

use crate::pair::Pair;
use crate::predicate::Polynomial;
use crate::sign_cascade::{Margins, SignCascade};
use crate::view::FloatView;
use rockproof_model::decision::{Decision, Side};
use rockproof_model::{Contact, ContactKey, Criteria, EdgeId, Sign, ToleranceSet, VertexId};

/// Sees every decision, and may depart from it; [`Unobserved`] compiles to nothing.
pub(crate) trait Observer {
    /// Whether it sees anything at all.
    fn is_active() -> bool
    where
        Self: Sized,
    {
        true
    }

    /// The outcome of the decision that is next, where it is known from the same classification made before: then it is not made again.
    fn known_outcome(&mut self) -> Option<i8> {
        None
    }

    /// A sign that no decision asks for, likewise.
    fn known_sign(&mut self) -> Option<Sign> {
        None
    }

    /// A decision begins; the signs that follow belong to it.
    fn begin(&mut self, decision: &Decision);
    /// A sign was decided for the decision begun last; `margin` works out how close it is to zero: [`crate::Margin::relative`]. Returns what the
    /// classification takes it for: what it is, but for a [`crate::RuleVariant`].
    fn sign(&mut self, sign: Sign, margin: &mut dyn FnMut() -> f64) -> Sign;
    /// The decision has this answer. Returns what it is taken for, likewise.
    fn end(&mut self, decision: &Decision, yes: bool) -> bool;
    /// The decision comes to this sign, likewise.
    fn end_with_sign(&mut self, decision: &Decision, sign: Sign) -> Sign;

    /// Whether it leaves a contact out: none, but for a [`crate::RuleVariant`].
    fn leaves_out(&self, _contact: &Contact) -> bool {
        false
    }

    /// Whether of several entrances that with the smallest gap is chosen: never, but for a [`crate::RuleVariant`].
    fn takes_smallest_gap(&self) -> bool {
        false
    }
}

/// Records nothing.
pub(crate) struct Unobserved;

impl Observer for Unobserved {
    #[inline(always)]
    fn is_active() -> bool {
        false
    }

    fn begin(&mut self, _decision: &Decision) {}

    fn sign(&mut self, sign: Sign, _margin: &mut dyn FnMut() -> f64) -> Sign {
        sign
    }

    fn end(&mut self, _decision: &Decision, yes: bool) -> bool {
        yes
    }

    fn end_with_sign(&mut self, _decision: &Decision, sign: Sign) -> Sign {
        sign
    }
}

/// Whoever sees: the classification is compiled once for all who do.
impl Observer for &mut dyn Observer {
    fn known_outcome(&mut self) -> Option<i8> {
        (**self).known_outcome()
    }

    fn known_sign(&mut self) -> Option<Sign> {
        (**self).known_sign()
    }

    fn begin(&mut self, decision: &Decision) {
        (**self).begin(decision);
    }

    fn sign(&mut self, sign: Sign, margin: &mut dyn FnMut() -> f64) -> Sign {
        (**self).sign(sign, margin)
    }

    fn end(&mut self, decision: &Decision, yes: bool) -> bool {
        (**self).end(decision, yes)
    }

    fn end_with_sign(&mut self, decision: &Decision, sign: Sign) -> Sign {
        (**self).end_with_sign(decision, sign)
    }

    fn leaves_out(&self, contact: &Contact) -> bool {
        (**self).leaves_out(contact)
    }

    fn takes_smallest_gap(&self) -> bool {
        (**self).takes_smallest_gap()
    }
}

/// A classification of a pair under a tolerance set.
pub(crate) struct Classification<'p, 's, O> {
    pub(crate) pair: &'p Pair<'s>,
    pub(crate) tolerances: &'p ToleranceSet,
    pub(crate) classic: bool,
    /// The contacts that the step before left closed.
    pub(crate) kept: &'p [ContactKey],
    pub(crate) observer: O,
    /// What is farther apart is not in one another's territory, slack included; infinite until it is known.
    pub(crate) territory_distance: f64,
    pub(crate) cascade: SignCascade<'p, 's>,
}

impl<'p, 's, O: Observer> Classification<'p, 's, O> {
    // Inlined, so that it is made where it stays: it is large to be copied.
    #[inline(always)]
    pub(crate) fn new(pair: &'p Pair<'s>, tolerances: &'p ToleranceSet, observer: O) -> Self {
        Classification {
            pair,
            tolerances,
            classic: tolerances.criteria == Criteria::Classic,
            kept: &[],
            observer,
            territory_distance: f64::INFINITY,
            cascade: SignCascade::new(pair, tolerances),
        }
    }

    /// The same with contacts kept from the step before.
    #[inline(always)]
    pub(crate) fn with_kept(mut self, kept: &'p [ContactKey]) -> Self {
        self.kept = kept;
        self
    }

    /// Whether the step before left this contact closed: then it may be deeper than g.
    #[inline(always)]
    pub(crate) fn is_kept(&self, contact: ContactKey) -> bool {
        self.kept.contains(&contact)
    }

    /// Makes one decision: everything `decide` asks the sign of belongs to it.
    #[inline(always)]
    pub(crate) fn decide(&mut self, decision: impl Fn() -> Decision, decide: impl FnOnce(&mut Self) -> bool) -> bool {
        if !O::is_active() {
            return decide(self);
        }
        if let Some(outcome) = self.observer.known_outcome() {
            return outcome != 0;
        }
        let decision = decision();
        self.observer.begin(&decision);
        let yes = decide(self);
        self.observer.end(&decision, yes)
    }

    /// The same for a decision with three outcomes.
    #[inline(always)]
    pub(crate) fn decide_sign(
        &mut self,
        decision: impl Fn() -> Decision,
        decide: impl FnOnce(&mut Self) -> Sign,
    ) -> Sign {
        if !O::is_active() {
            return decide(self);
        }
        if let Some(outcome) = self.observer.known_outcome() {
            return Sign::of_ordering(outcome.cmp(&0));
        }
        let decision = decision();
        self.observer.begin(&decision);
        let sign = decide(self);
        self.observer.end_with_sign(&decision, sign)
    }

    /// The exact sign of a polynomial.
    #[inline(always)]
    pub(crate) fn sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        let value = polynomial.value(&self.float_view()).0;
        self.sign_of_value(polynomial, value)
    }

    /// The same of a polynomial that has this value in f64, calculated as [`Polynomial::value`] does.
    #[inline(always)]
    pub(crate) fn sign_of_value<P: Polynomial>(&mut self, polynomial: &P, value: f64) -> Sign {
        if !O::is_active() {
            return self.cascade.sign_of_value(polynomial, value);
        }
        if let Some(sign) = self.observer.known_sign() {
            return sign;
        }
        let sign = self.cascade.sign_of_value(polynomial, value);
        // Of a zero the margin is known.
        self.observed(sign, |margins| if sign.is_zero() { 0.0 } else { margins.of(polynomial).1 })
    }

    /// The same for a sign that the observer does not see, since by itself it says nothing about the decision.
    #[inline(always)]
    pub(crate) fn unobserved_sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        self.cascade.sign(polynomial)
    }

    /// What a sign that the decision under way rests on is taken for, once the observer has seen it and may have asked for
    /// its margin: 0 where it is zero, at most 1.
    pub(crate) fn observed(&mut self, sign: Sign, margin: impl Fn(&Margins<'_, '_>) -> f64) -> Sign {
        let cascade = &self.cascade;
        self.observer.sign(sign, &mut || margin(&cascade.margins()))
    }

    /// Whether f64 leaves the sign of a polynomial open that has this value in f64.
    #[inline(always)]
    pub(crate) fn is_open<P: Polynomial>(&self, polynomial: &P, value: f64) -> bool {
        value.abs() <= self.bound_of::<P>(polynomial.variant())
    }

    /// Whether f64 proves a polynomial to be positive.
    #[inline(always)]
    pub(crate) fn surely_positive<P: Polynomial>(&self, polynomial: &P) -> bool {
        polynomial.value(&self.float_view()).0 > self.cascade.known_bound(polynomial)
    }

    /// The pair in f64.
    #[inline(always)]
    pub(crate) fn float_view(&self) -> FloatView<'_> {
        self.cascade.float_view()
    }

    /// [`SignCascade::bound_of`]
    #[inline(always)]
    pub(crate) fn bound_of<P: Polynomial>(&self, variant: usize) -> f64 {
        self.cascade.bound_of::<P>(variant)
    }

    /// Whether a feature is convex, as decided when the block was loaded.
    pub(crate) fn vertex_is_convex(&self, side: Side, vertex: VertexId) -> bool {
        self.pair.prepared(side).block.vertex_is_convex(vertex)
    }

    pub(crate) fn edge_is_convex(&self, side: Side, edge: EdgeId) -> bool {
        self.pair.prepared(side).block.edge_is_convex(edge)
    }
}
