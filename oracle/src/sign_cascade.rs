//! The cascade: the sign of a polynomial at the cheapest level that proves it.

mod integer_width;
mod margins;
mod parts;
mod planes;
mod sharp_planes;

pub(crate) use integer_width::bits_within;
pub(crate) use margins::Margins;
pub(crate) use parts::Parts;

use crate::field::{DoubleBall, Field};
use crate::levels::LevelCounts;
use crate::number::{Approx, Ball, Bits, INFLATION, Int128};
use crate::pair::{FromUnits, Int256, Int512, Int1024, Pair};
use crate::predicate::{AsEdgeAlongNormal, Denominator, Polynomial, SIGN_SLOTS};
use crate::unit_bounds::{SizePowers, UnitBounds, unit_bounds_for};
use crate::view::{BallView, BitsView, BoundView, ExactPair, ExactView, FloatView, LazyScales, Scales, View};
use num_bigint::BigInt;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Sign, ToleranceSet};
use std::cell::OnceCell;

/// Signs of polynomials of one pair under one tolerance set, and what has been found out about their magnitudes.
pub(crate) struct SignCascade<'p, 's> {
    pub(crate) pair: &'p Pair<'s>,
    pub(crate) tolerances: &'p ToleranceSet,
    pub(crate) levels: LevelCounts,
    floats: Scales<Approx>,
    unit_bounds: &'static UnitBounds,
    size_powers: SizePowers,
    balls: OnceCell<Scales<Ball>>,
    careful_stages: OnceCell<Box<CarefulStages<'p>>>,
    /// Whether a sign has been decided in integers of 128 bits, so that the pair is there in these.
    in_integers: bool,
}

/// What only signs need that f64 and the bounds of unit size leave open, made when the first of them comes.
struct CarefulStages<'p> {
    bounds: [f64; SIGN_SLOTS],
    bound_view: OnceCell<BoundView<'p>>,
    scales: ScalesCache,
}

impl Default for CarefulStages<'_> {
    fn default() -> Self {
        CarefulStages { bounds: [f64::NAN; SIGN_SLOTS], bound_view: OnceCell::new(), scales: ScalesCache::default() }
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

impl<'p, 's> SignCascade<'p, 's> {
    #[inline(always)]
    pub(crate) fn new(pair: &'p Pair<'s>, tolerances: &'p ToleranceSet) -> Self {
        let floats = Scales::approximate(tolerances);
        let (unit_bounds, size_powers) = unit_bounds_for(pair, &floats);
        SignCascade {
            pair,
            tolerances,
            levels: LevelCounts::default(),
            floats,
            unit_bounds,
            size_powers,
            balls: OnceCell::new(),
            careful_stages: OnceCell::new(),
            in_integers: false,
        }
    }

    /// How close polynomials are to zero.
    pub(crate) fn margins(&self) -> Margins<'_, 's> {
        Margins { pair: self.pair, tolerances: self.tolerances, scales: self.exact_scales() }
    }

    /// The tolerances as the levels beyond balls need them.
    fn exact_scales(&self) -> &ScalesCache {
        &self.careful_stages.get_or_init(Box::default).scales
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
        self.unit_bounds.get(P::FIRST_SLOT + variant) * self.size_powers.of::<P>()
    }

    /// [`SignCascade::bound_of`], worked out if nobody has.
    #[inline(always)]
    pub(crate) fn known_bound<P: Polynomial>(&self, polynomial: &P) -> f64 {
        let bound = self.bound_of::<P>(polynomial.variant());
        if bound.is_nan() { self.find_unit_bound(polynomial) } else { bound }
    }

    /// The exact sign of a polynomial.
    #[inline(always)]
    pub(crate) fn sign<P: Polynomial>(&mut self, polynomial: &P) -> Sign {
        let value = polynomial.value(&self.float_view()).0;
        self.sign_of_value(polynomial, value)
    }

    /// The exact sign of a polynomial that has this value in f64, calculated as [`Polynomial::value`] does.
    #[inline(always)]
    pub(crate) fn sign_of_value<P: Polynomial>(&mut self, polynomial: &P, value: f64) -> Sign {
        let bound = self.bound_of::<P>(polynomial.variant());
        // As `sign_beyond`, in fewer instructions.
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

    /// Works out the bound that holds for all pairs of unit size, and returns that of this pair.
    #[cold]
    #[inline(never)]
    fn find_unit_bound<P: Polynomial>(&self, polynomial: &P) -> f64 {
        let UnitBounds { longest_loop, coordinate, .. } = *self.unit_bounds;
        let view = BoundView::of_unit_size(self.pair.a, self.pair.b, longest_loop, coordinate);
        let bound = polynomial.value(&view).error * INFLATION;
        self.unit_bounds.set(P::FIRST_SLOT + polynomial.variant(), bound);
        self.bound_of::<P>(polynomial.variant())
    }

    /// Goes on with the values themselves: by a shorter polynomial where there is one, as balls, then exactly.
    #[cold]
    #[inline(never)]
    fn careful_sign<P: Polynomial>(&mut self, polynomial: &P, value: f64) -> Sign {
        let slot = P::FIRST_SLOT + polynomial.variant();
        let (pair, tolerances) = (self.pair, self.tolerances);
        let mut bound = self.known_bound(polynomial);
        if let Some(sign) = sign_beyond(value, bound) {
            self.levels.float += 1;
            return sign;
        }
        // Where no unit bound applies, those of this very pair do. Otherwise a ball is as cheap, and sharper.
        if !self.size_powers.apply() {
            self.careful_stages.get_or_init(Box::default);
            if let Some(careful_stages) = self.careful_stages.get_mut() {
                if careful_stages.bounds[slot].is_nan() {
                    let view = careful_stages.bound_view.get_or_init(|| {
                        BoundView::of(pair.a, pair.b, Scales::<crate::number::Bound>::bounds(tolerances))
                    });
                    let bound = polynomial.value(view).error;
                    careful_stages.bounds[slot] = if bound.is_nan() { f64::INFINITY } else { bound };
                }
                bound = careful_stages.bounds[slot];
                if let Some(sign) = sign_beyond(value, bound) {
                    self.levels.float += 1;
                    return sign;
                }
            }
        }
        if let Some(AsEdgeAlongNormal { edge, face, turn, in_plane }) = polynomial.as_edge_along_normal(pair) {
            if in_plane.is_none_or(|edge| self.lies_in_plane(edge, face)) {
                return self.edge_along_normal(edge, face).times(turn);
            }
            if let Some(sign) = self.on_own_lattices(edge, face, in_plane, Ball { middle: value, radius: bound }) {
                return sign.times(turn);
            }
        }
        if let Some((edge_a, edge_b)) = polynomial.zero_where_parallel(tolerances)
            && self.edges_are_parallel(edge_a, edge_b)
        {
            self.levels.i128 += 1;
            return Sign::Zero;
        }
        let gaps = polynomial.ties_with(tolerances);
        if let Some(gaps) = &gaps
            && self.share_plane(&gaps.first, &gaps.second)
        {
            self.levels.float += 1;
            return Sign::Zero;
        }
        // Once the pair is there in integers these are cheaper than balls, if they need not be longer.
        if P::DENOMINATOR == Denominator::None
            && self.in_integers
            && let Some(bits) = self.bits_of_ball::<P>(Ball { middle: value, radius: bound })
            && bits < Bits(128)
        {
            return self.sign_of_bits(polynomial, bits);
        }
        if let Some(sign) = self.sign_by_parts(polynomial, value) {
            self.levels.ball += 1;
            return sign;
        }
        let balls = BallView {
            floats: self.float_view(),
            scales: LazyScales { made: &self.balls, make: &|| Scales::balls(tolerances) },
        };
        // Where the pair is there in balls of two f64, planes in them tell more, and are known or soon will be.
        let by_planes = P::IN_PLANES && pair.is_in_double();
        let ball = (P::IN_BALLS && !by_planes).then(|| polynomial.value(&balls));
        if let Some(sign) = ball.and_then(Ball::certain_sign) {
            self.levels.ball += 1;
            return sign;
        }
        if let Some(gaps) = gaps
            && self.are_equal(&gaps, &balls)
        {
            self.levels.fixed[0] += 1;
            return Sign::Zero;
        }
        if P::IN_PLANES
            && let Some(sign) = self.sign_by_sharp_planes(polynomial, balls.scales())
        {
            self.levels.ball += 1;
            return sign;
        }
        let enclosed = if P::IN_DOUBLE {
            let ball = self.double_ball(polynomial);
            if let Some(sign) = ball.certain_sign() {
                self.levels.ball += 1;
                return sign;
            }
            self.bits_of_double::<P>(&ball)
        } else {
            ball.and_then(|ball| self.bits_of_ball::<P>(ball))
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
        let bits = self.exact_scales().bits_of(polynomial, self.pair, self.tolerances);
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
            self.in_integers = true;
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
}

/// The sign of a value that is off by at most `bound`, where that is certain: of nothing that is no number.
#[inline(always)]
fn sign_beyond(value: f64, bound: f64) -> Option<Sign> {
    if value > bound {
        Some(Sign::Positive)
    } else if value < -bound {
        Some(Sign::Negative)
    } else {
        None
    }
}

fn integer_sign<P: Polynomial, T: ExactRing + FromUnits>(
    polynomial: &P,
    geometry: &ExactPair<'_, T>,
    scales: LazyScales<'_, T>,
) -> Sign {
    polynomial.value(&ExactView { geometry, scales }).sign()
}
