//! The ladder: the sign of a polynomial at the cheapest level that proves it.

mod enclosed;
mod margins;

pub(crate) use margins::Margins;

use crate::field::{DoubleBall, Field};
use crate::levels::LevelCounts;
use crate::number::{Approx, Ball, Bits, INFLATION, Int128};
use crate::pair::{FromUnits, Int256, Int512, Int1024, Pair};
use crate::predicate::{LARGEST_DEGREE, Polynomial, SLOTS};
use crate::unit_bounds::{UnitBounds, unit_bounds_for};
use crate::view::{BallView, BitsView, BoundView, ExactPair, ExactView, FloatView, LazyScales, Scales};
use num_bigint::BigInt;
use rockproof_model::decision::{Decision, Side};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Contact, ContactKey, Criteria, EdgeId, Sign, ToleranceSet, VertexId};
use std::cell::OnceCell;

/// Sees every decision, and may depart from it; [`Unobserved`] compiles to nothing.
pub(crate) trait Observer {
    /// Whether anything is recorded at all.
    const ACTIVE: bool;
    /// A decision begins; the signs that follow belong to it.
    fn begin(&mut self, decision: &Decision);
    /// A sign was decided for the decision begun last; `margin` works out how close it is to zero: [`crate::Margin::relative`].
    fn sign(&mut self, sign: Sign, margin: &mut dyn FnMut() -> f64);
    /// The decision has this outcome.
    fn end(&mut self, decision: &Decision, outcome: i8);

    /// The outcome of the decision that is next, where it is known from the same classification made before: then it is not made again.
    fn known_outcome(&mut self) -> Option<i8> {
        None
    }

    /// A sign that no decision asks for, likewise.
    fn known_sign(&mut self) -> Option<Sign> {
        None
    }

    /// What the classification takes a sign of the decision under way for: what it is, but for a [`crate::Departure`].
    fn taken(&self, sign: Sign) -> Sign {
        sign
    }

    /// What it takes the answer to a decision for, likewise.
    fn answered(&self, _decision: &Decision, yes: bool) -> bool {
        yes
    }

    /// What it takes the sign that a decision comes to for, likewise.
    fn signed(&self, _decision: &Decision, sign: Sign) -> Sign {
        sign
    }

    /// Whether it leaves a contact out, likewise.
    fn leaves_out(&self, _contact: &Contact) -> bool {
        false
    }
}

/// Records nothing.
pub(crate) struct Unobserved;

impl Observer for Unobserved {
    const ACTIVE: bool = false;
    fn begin(&mut self, _decision: &Decision) {}
    fn sign(&mut self, _sign: Sign, _margin: &mut dyn FnMut() -> f64) {}
    fn end(&mut self, _decision: &Decision, _outcome: i8) {}
}

/// One classification under way: a pair, a tolerance set, and what has been found out about their magnitudes.
pub(crate) struct Classification<'p, 's, O> {
    pub(crate) pair: &'p Pair<'s>,
    pub(crate) tolerances: &'p ToleranceSet,
    pub(crate) classic: bool,
    /// The contacts that the step before left closed.
    pub(crate) kept: &'p [ContactKey],
    pub(crate) observer: O,
    pub(crate) levels: LevelCounts,
    floats: Scales<Approx>,
    unit_bounds: &'static UnitBounds,
    size_powers: [f64; LARGEST_DEGREE + 1],
    balls: OnceCell<Scales<Ball>>,
    careful_stages: OnceCell<Box<CarefulStages<'p>>>,
}

/// What only the levels beyond balls need, and pairs without unit bounds, made when the first sign gets there.
struct CarefulStages<'p> {
    bounds: [f64; SLOTS],
    bound_view: OnceCell<BoundView<'p>>,
    scales: ScalesCache,
}

impl Default for CarefulStages<'_> {
    fn default() -> Self {
        CarefulStages { bounds: [f64::NAN; SLOTS], bound_view: OnceCell::new(), scales: ScalesCache::default() }
    }
}

#[derive(Default)]
struct ScalesCache {
    bits: OnceCell<Scales<Bits>>,
    double: OnceCell<Scales<DoubleBall>>,
    small: OnceCell<Scales<Int128>>,
    int256: OnceCell<Scales<Int256>>,
    int512: OnceCell<Scales<Int512>>,
    int1024: OnceCell<Scales<Int1024>>,
    heap: OnceCell<Scales<BigInt>>,
    margins: OnceCell<Box<margins::MarginScales>>,
}

impl ScalesCache {
    fn exact(&self, pair: &Pair<'_>, tolerances: &ToleranceSet) -> &Scales<BigInt> {
        self.heap.get_or_init(|| Scales::exact(tolerances, &pair.grid().lattice))
    }

    /// The bits that every intermediate value of a polynomial has at most.
    fn bits_of<P: Polynomial>(&self, polynomial: &P, pair: &Pair<'_>, tolerances: &ToleranceSet) -> Bits {
        polynomial.value(&BitsView {
            a: &pair.a.block,
            b: &pair.b.block,
            coordinate: pair.grid().bits,
            scales: LazyScales { made: &self.bits, make: &|| self.exact(pair, tolerances).bits() },
        })
    }
}

impl<'p, 's, O: Observer> Classification<'p, 's, O> {
    pub(crate) fn new(pair: &'p Pair<'s>, tolerances: &'p ToleranceSet, observer: O) -> Self {
        let floats = Scales::approximate(tolerances);
        let (unit_bounds, size_powers) = unit_bounds_for(pair, &floats);
        Classification {
            pair,
            tolerances,
            classic: tolerances.criteria == Criteria::Classic,
            kept: &[],
            observer,
            levels: LevelCounts::default(),
            floats,
            unit_bounds,
            size_powers,
            balls: OnceCell::new(),
            careful_stages: OnceCell::new(),
        }
    }

    /// The same with contacts kept from the step before.
    pub(crate) fn keeping(self, kept: &'p [ContactKey]) -> Self {
        Classification { kept, ..self }
    }

    /// Whether the step before left this contact closed: then it may be deeper than g.
    #[inline(always)]
    pub(crate) fn is_kept(&self, contact: ContactKey) -> bool {
        self.kept.contains(&contact)
    }

    /// Makes one decision: everything `decide` asks the sign of belongs to it.
    #[inline(always)]
    pub(crate) fn decide(&mut self, decision: impl Fn() -> Decision, decide: impl FnOnce(&mut Self) -> bool) -> bool {
        if !O::ACTIVE {
            return decide(self);
        }
        if let Some(outcome) = self.observer.known_outcome() {
            return outcome != 0;
        }
        let decision = decision();
        self.observer.begin(&decision);
        let yes = decide(self);
        let yes = self.observer.answered(&decision, yes);
        self.observer.end(&decision, i8::from(yes));
        yes
    }

    /// The same for a decision with three outcomes.
    #[inline(always)]
    pub(crate) fn decide_sign(
        &mut self,
        decision: impl Fn() -> Decision,
        decide: impl FnOnce(&mut Self) -> Sign,
    ) -> Sign {
        if !O::ACTIVE {
            return decide(self);
        }
        if let Some(outcome) = self.observer.known_outcome() {
            return Sign::of_ordering(outcome.cmp(&0));
        }
        let decision = decision();
        self.observer.begin(&decision);
        let sign = decide(self);
        let sign = self.observer.signed(&decision, sign);
        self.observer.end(&decision, sign.as_i8());
        sign
    }

    /// The exact sign of a polynomial.
    #[inline(always)]
    pub(crate) fn sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        if O::ACTIVE
            && let Some(sign) = self.observer.known_sign()
        {
            return sign;
        }
        let sign = self.quick_sign(polynomial);
        if !O::ACTIVE {
            return sign;
        }
        // Of a zero the margin is known.
        self.observed(sign, |margins| if sign.is_zero() { 0.0 } else { margins.of(polynomial).1 })
    }

    /// The same for a sign that the observer does not see, since by itself it says nothing about the decision.
    #[inline(always)]
    pub(crate) fn unobserved_sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        self.quick_sign(polynomial)
    }

    /// What a sign that the decision under way rests on is taken for, once the observer has seen it and may have asked for
    /// its margin: 0 where it is zero, at most 1.
    pub(crate) fn observed(&mut self, sign: Sign, margin: impl Fn(&Margins<'_, '_>) -> f64) -> Sign {
        let (pair, tolerances) = (self.pair, self.tolerances);
        let careful_stages = &self.careful_stages;
        self.observer.sign(sign, &mut || {
            let scales = &careful_stages.get_or_init(Box::default).scales;
            margin(&Margins { pair, tolerances, scales })
        });
        self.observer.taken(sign)
    }

    /// How close polynomials are to zero.
    #[cfg(test)]
    pub(crate) fn margins(&self) -> Margins<'_, 's> {
        let scales = &self.careful_stages.get_or_init(Box::default).scales;
        Margins { pair: self.pair, tolerances: self.tolerances, scales }
    }

    /// The pair in f64.
    #[inline(always)]
    pub(crate) fn float_view(&self) -> FloatView<'_> {
        FloatView { a: self.pair.a, b: self.pair.b, scales: &self.floats }
    }

    /// What the values of this variant of a polynomial are off by at most in f64; NaN until somebody has worked it out, so
    /// that no comparison with it holds.
    #[inline(always)]
    pub(crate) fn bound_of<P: Polynomial>(&self, variant: usize) -> f64 {
        self.unit_bounds.get(P::FIRST_SLOT + variant) * self.size_powers[P::DEGREE]
    }

    #[inline(always)]
    fn quick_sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        let value = polynomial.value(&self.float_view()).0;
        let bound = self.bound_of::<P>(polynomial.variant());
        if value > bound {
            self.levels.float += 1;
            Sign::Positive
        } else if value < -bound {
            self.levels.float += 1;
            Sign::Negative
        } else {
            self.careful_sign(polynomial, value)
        }
    }

    /// Goes on with the values themselves, as balls, then exactly.
    #[cold]
    #[inline(never)]
    fn careful_sign<P: Polynomial>(&mut self, polynomial: &P, value: f64) -> Sign {
        let slot = P::FIRST_SLOT + polynomial.variant();
        let (pair, tolerances) = (self.pair, self.tolerances);
        if self.unit_bounds.get(slot).is_nan() {
            let UnitBounds { longest_loop, coordinate, .. } = *self.unit_bounds;
            let view = BoundView::of_unit_size(pair.a, pair.b, longest_loop, coordinate);
            let bound = polynomial.value(&view).error * INFLATION;
            self.unit_bounds.set(slot, bound);
            if value.abs() > bound * self.size_powers[P::DEGREE] {
                self.levels.float += 1;
                return if value > 0.0 { Sign::Positive } else { Sign::Negative };
            }
        }
        // Where no unit bound applies, those of this very pair do. Otherwise a ball is as cheap, and sharper.
        if self.size_powers[0] > 1.0 {
            self.careful_stages.get_or_init(Box::default);
            if let Some(careful_stages) = self.careful_stages.get_mut() {
                if careful_stages.bounds[slot].is_nan() {
                    let view = careful_stages.bound_view.get_or_init(|| {
                        BoundView::of(pair.a, pair.b, Scales::<crate::number::Bound>::bounds(tolerances))
                    });
                    let bound = polynomial.value(view).error;
                    careful_stages.bounds[slot] = if bound.is_nan() { f64::INFINITY } else { bound };
                }
                if value.abs() > careful_stages.bounds[slot] {
                    self.levels.float += 1;
                    return if value > 0.0 { Sign::Positive } else { Sign::Negative };
                }
            }
        }
        let balls = BallView {
            floats: self.float_view(),
            scales: LazyScales { made: &self.balls, make: &|| Scales::balls(tolerances) },
        };
        let ball = polynomial.value(&balls);
        if let Some(sign) = ball.certain_sign() {
            self.levels.ball += 1;
            return sign;
        }
        if let Some(gaps) = polynomial.ties_with(tolerances)
            && self.are_equal(&gaps, &balls)
        {
            self.levels.fixed[0] += 1;
            return Sign::Zero;
        }
        let enclosed = if P::IN_DOUBLE {
            let ball = self.double_ball(polynomial);
            if let Some(sign) = ball.certain_sign() {
                self.levels.ball += 1;
                return sign;
            }
            self.bits_of_double::<P>(&ball)
        } else {
            self.bits_of_ball::<P>(ball)
        };
        match enclosed {
            // An integer below 1.
            Some(Bits(0)) => {
                self.levels.ball += 1;
                Sign::Zero
            }
            Some(bits) => self.sign_of_bits(polynomial, bits),
            None => self.exact_sign(polynomial),
        }
    }

    /// The sign in integers of the least width that holds every intermediate value.
    pub(crate) fn exact_sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        let cache = &self.careful_stages.get_or_init(Box::default).scales;
        let bits = cache.bits_of(polynomial, self.pair, self.tolerances);
        self.sign_of_bits(polynomial, bits)
    }

    /// The sign in integers of the least width that holds a value of at most so many bits. They are calculated modulo a power of two,
    /// which sums and products of integers allow: what does not fit on the way does no harm.
    fn sign_of_bits<P: Polynomial>(&mut self, polynomial: &P, bits: Bits) -> Sign {
        let (pair, tolerances) = (self.pair, self.tolerances);
        let cache = &self.careful_stages.get_or_init(Box::default).scales;
        let exact = || cache.exact(pair, tolerances);
        if bits.0 < 128 {
            self.levels.i128 += 1;
            let scales = LazyScales { made: &cache.small, make: &|| exact().converted() };
            return integer_sign(polynomial, pair.small(), scales);
        }
        match bits.0 {
            ..256 => {
                self.levels.fixed[0] += 1;
                let scales = LazyScales { made: &cache.int256, make: &|| exact().converted() };
                integer_sign(polynomial, pair.int256(), scales)
            }
            256..512 => {
                self.levels.fixed[1] += 1;
                let scales = LazyScales { made: &cache.int512, make: &|| exact().converted() };
                integer_sign(polynomial, pair.int512(), scales)
            }
            512..1024 => {
                self.levels.fixed[2] += 1;
                let scales = LazyScales { made: &cache.int1024, make: &|| exact().converted() };
                integer_sign(polynomial, pair.int1024(), scales)
            }
            _ => {
                self.levels.heap += 1;
                let scales =
                    LazyScales { made: &cache.heap, make: &|| Scales::exact(tolerances, &pair.grid().lattice) };
                integer_sign(polynomial, pair.heap(), scales)
            }
        }
    }

    /// Whether a feature is convex, as decided when the block was loaded.
    pub(crate) fn vertex_is_convex(&self, side: Side, vertex: VertexId) -> bool {
        self.pair.solid(side).block.vertex_is_convex(vertex)
    }

    pub(crate) fn edge_is_convex(&self, side: Side, edge: EdgeId) -> bool {
        self.pair.solid(side).block.edge_is_convex(edge)
    }
}

fn integer_sign<P: Polynomial, T: ExactRing + FromUnits>(
    polynomial: &P,
    geometry: &ExactPair<'_, T>,
    scales: LazyScales<'_, T>,
) -> Sign {
    polynomial.value(&ExactView { geometry, scales }).sign()
}
