//! Four balls side by side: each operation is made of all four at once, without a branch, so that the processor's vector instructions serve it.
//!
//! Every formula is that of the ball by itself where something was rounded. The middle is the same to the last bit; the radius is that of the ball or
//! larger, since a result that happens to be exact is not told from others.

use super::double::{ROUNDING, fast_two_sum, two_product, two_sum};
use super::{DoubleBall, Halve};
use crate::number::{Ball, INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use rockproof_model::{Ring, Vec3};

/// How many are calculated together.
pub(crate) const LANES: usize = 4;

/// Several enclosures of one type, calculated together.
pub(crate) trait Packed: Halve {
    /// One of them.
    type Single: Ring;
    /// These, in this order.
    fn of(singles: [&Self::Single; LANES]) -> Self;
    /// The one at a place.
    fn single(&self, lane: usize) -> Self::Single;
}

/// Vectors of them.
pub(crate) fn packed_vector<P: Packed>(vectors: [&Vec3<P::Single>; LANES]) -> Vec3<P> {
    Vec3::new(P::of(vectors.map(|v| &v.x)), P::of(vectors.map(|v| &v.y)), P::of(vectors.map(|v| &v.z)))
}

/// The vector at a place.
pub(crate) fn single_vector<P: Packed>(vector: &Vec3<P>, lane: usize) -> Vec3<P::Single> {
    vector.map(|component| component.single(lane))
}

/// Balls of f64.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackedBalls {
    middle: [f64; LANES],
    radius: [f64; LANES],
}

impl Packed for PackedBalls {
    type Single = Ball;
    #[inline]
    fn of(singles: [&Ball; LANES]) -> Self {
        PackedBalls { middle: singles.map(|ball| ball.middle), radius: singles.map(|ball| ball.radius) }
    }
    #[inline]
    fn single(&self, lane: usize) -> Ball {
        Ball { middle: self.middle[lane], radius: self.radius[lane] }
    }
}

impl Halve for PackedBalls {
    #[inline]
    fn half(&self) -> Self {
        let mut half = *self;
        for lane in 0..LANES {
            half.middle[lane] = self.middle[lane] / 2.0;
            // Halving loses a bit below the normal numbers, and UNDERFLOW is lost beside a large radius.
            half.radius[lane] = self.radius[lane] / 2.0 * INFLATION + UNDERFLOW;
        }
        half
    }
}

impl Ring for PackedBalls {
    #[inline]
    fn from_i32(value: i32) -> Self {
        PackedBalls { middle: [f64::from(value); LANES], radius: [0.0; LANES] }
    }
    // Not inlined: by itself each operation becomes vector instructions, and what calls it stays short.
    #[inline(never)]
    fn plus(&self, other: &Self) -> Self {
        let mut result = *self;
        for lane in 0..LANES {
            let sum = self.middle[lane] + other.middle[lane];
            let error = self.radius[lane] + other.radius[lane];
            result.middle[lane] = sum;
            result.radius[lane] = (error + sum.abs() * UNIT_ROUNDOFF) * INFLATION;
        }
        result
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    #[inline(never)]
    fn times(&self, other: &Self) -> Self {
        let mut result = *self;
        for lane in 0..LANES {
            let (a, b) = (self.middle[lane], other.middle[lane]);
            let (of_a, of_b) = (self.radius[lane], other.radius[lane]);
            let product = a * b;
            let error = a.abs() * of_b + b.abs() * of_a + of_a * of_b;
            result.middle[lane] = product;
            result.radius[lane] = (error + product.abs() * UNIT_ROUNDOFF) * INFLATION + UNDERFLOW;
        }
        result
    }
    #[inline]
    fn negated(&self) -> Self {
        PackedBalls { middle: self.middle.map(|middle| -middle), radius: self.radius }
    }
}

/// Balls of two f64.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackedDoubleBalls {
    high: [f64; LANES],
    low: [f64; LANES],
    radius: [f64; LANES],
}

impl Packed for PackedDoubleBalls {
    type Single = DoubleBall;
    #[inline]
    fn of(singles: [&DoubleBall; LANES]) -> Self {
        PackedDoubleBalls {
            high: singles.map(|ball| ball.high),
            low: singles.map(|ball| ball.low),
            radius: singles.map(|ball| ball.radius),
        }
    }
    #[inline]
    fn single(&self, lane: usize) -> DoubleBall {
        DoubleBall { high: self.high[lane], low: self.low[lane], radius: self.radius[lane] }
    }
}

impl Halve for PackedDoubleBalls {
    #[inline]
    fn half(&self) -> Self {
        let mut half = *self;
        for lane in 0..LANES {
            half.high[lane] = self.high[lane] / 2.0;
            half.low[lane] = self.low[lane] / 2.0;
            half.radius[lane] = self.radius[lane] / 2.0 * INFLATION + UNDERFLOW;
        }
        half
    }
}

impl Ring for PackedDoubleBalls {
    #[inline]
    fn from_i32(value: i32) -> Self {
        PackedDoubleBalls { high: [f64::from(value); LANES], low: [0.0; LANES], radius: [0.0; LANES] }
    }
    #[inline(never)]
    fn plus(&self, other: &Self) -> Self {
        let mut result = *self;
        for lane in 0..LANES {
            let (high, rest) = two_sum(self.high[lane], other.high[lane]);
            let (lows, lost) = two_sum(self.low[lane], other.low[lane]);
            let (high, low) = fast_two_sum(high, rest + lows);
            let (high, low) = fast_two_sum(high, lost + low);
            let error = self.radius[lane] + other.radius[lane];
            result.high[lane] = high;
            result.low[lane] = low;
            result.radius[lane] = (error + high.abs() * ROUNDING) * INFLATION;
        }
        result
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    #[inline(never)]
    fn times(&self, other: &Self) -> Self {
        let mut result = *self;
        for lane in 0..LANES {
            let (a, b) = (self.high[lane], other.high[lane]);
            let (of_a, of_b) = (self.radius[lane], other.radius[lane]);
            let (product, rest) = two_product(a, b);
            let (high, low) = fast_two_sum(product, rest + (a * other.low[lane] + self.low[lane] * b));
            let error = (a.abs() * of_b + b.abs() * of_a + of_a * of_b) * (1.0 + 4.0 * f64::EPSILON);
            result.high[lane] = high;
            result.low[lane] = low;
            result.radius[lane] = (error + high.abs() * ROUNDING) * INFLATION + UNDERFLOW;
        }
        result
    }
    #[inline]
    fn negated(&self) -> Self {
        PackedDoubleBalls { high: self.high.map(|part| -part), low: self.low.map(|part| -part), radius: self.radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::Signed;
    use rockproof_model::{Number, fraction};

    /// Middles and radii from the least to large ones, exact or not, that meet in sums and products that round, cancel or are exact.
    fn parts() -> Vec<(f64, f64)> {
        let middles = [0.0, 1.0, -3.0, 0.1, -1.0 / 3.0, 1.0 + f64::EPSILON, 67_108_865.0, 1e-160, -1e150, 3.0e-308];
        let of = |middle: f64| [0.0, middle.abs() * 1e-17, middle.abs() * 0.3, 5e-324, 1e-3].map(|r| (middle, r));
        middles.into_iter().flat_map(of).collect()
    }

    fn doubles() -> Vec<DoubleBall> {
        let low = |high: f64| [0.0, high * f64::EPSILON * 0.25, high * -1e-19].map(|low| (high, low));
        let of = |(middle, radius)| low(middle).map(|(high, low)| DoubleBall { high, low, radius });
        parts().into_iter().flat_map(of).collect()
    }

    /// Neither here nor in sums, differences and products by `fraction` are binary fractions reduced by the library, which would take most of the time.
    fn rational(value: f64) -> BigRational {
        Number::from_f64(value).expect("finite").to_rational()
    }

    /// A type to try: the radius of one, and what one rounding is of a result, as a power of two.
    struct Tried<S> {
        radius: fn(&S) -> f64,
        rounding: u32,
    }

    impl<S: Field + std::fmt::Debug> Tried<S> {
        fn ends(&self, ball: &S) -> [BigRational; 2] {
            let (middle, radius) = (ball.middle(), rational((self.radius)(ball)));
            [fraction::difference(&middle, &radius), fraction::sum(&middle, &radius)]
        }

        /// Holds a packed result against the single one and against the exact values at the ends of the operands.
        fn hold(&self, packed: S, single: S, values: &[BigRational]) {
            let [radius, own] = [&packed, &single].map(|ball| rational((self.radius)(ball)));
            assert_eq!(packed.middle(), single.middle(), "{packed:?} {single:?}");
            assert!(radius >= own, "{packed:?} {single:?}");
            let middle = packed.middle();
            for value in values {
                assert!(fraction::difference(value, &middle).abs() <= radius, "{packed:?} leaves out {value}");
            }
            // No wider than rounding makes it.
            let rounding = (&middle / (BigInt::from(1) << self.rounding)).abs();
            let most = &own + &own / BigInt::from(1 << 20) + rounding + rational(4.0 * UNDERFLOW);
            assert!(radius <= most, "{packed:?} is wide for {single:?}");
        }

        fn hold_operations<P: Packed<Single = S>>(&self, samples: &[S]) {
            for (place, a) in samples.iter().enumerate() {
                let lane = place % LANES;
                for chunk in samples.chunks(LANES) {
                    let others: [&S; LANES] = std::array::from_fn(|lane| &chunk[lane.min(chunk.len() - 1)]);
                    let [one, other] = [P::of([a; LANES]), P::of(others)];
                    let (sum, difference, product) = (one.plus(&other), one.minus(&other), one.times(&other));
                    for (lane, b) in others.into_iter().enumerate() {
                        let (x, y) = (self.ends(a), self.ends(b));
                        let values = |of: &dyn Fn(&BigRational, &BigRational) -> BigRational| -> Vec<BigRational> {
                            x.iter().flat_map(|x| y.iter().map(|y| of(x, y))).collect()
                        };
                        self.hold(sum.single(lane), a.plus(b), &values(&fraction::sum));
                        self.hold(difference.single(lane), a.minus(b), &values(&fraction::difference));
                        self.hold(product.single(lane), a.times(b), &values(&fraction::product));
                    }
                }
                let two = BigInt::from(2);
                let (half, opposite) = (P::of([a; LANES]).half(), P::of([a; LANES]).negated());
                self.hold(half.single(lane), a.half(), &self.ends(a).map(|x| x / &two));
                self.hold(opposite.single(lane), a.negated(), &self.ends(a).map(|x| -x));
            }
            let five = P::from_i32(-5);
            (0..LANES).for_each(|lane| self.hold(five.single(lane), S::from_i32(-5), &[rational(-5.0)]));
        }
    }

    #[test]
    fn packed_balls_have_the_middles_of_single_ones_and_hold_every_value() {
        // Seven has no divisor in common with the numbers of middles, radii and low parts, so each of these stays.
        hold_operations_of_every(7);
    }

    #[test]
    #[ignore = "ten seconds; .ci/run runs it"]
    fn packed_balls_have_the_middles_of_single_ones_and_hold_every_value_at_full_size() {
        hold_operations_of_every(1);
    }

    fn hold_operations_of_every(nth: usize) {
        let singles: Vec<Ball> = parts().into_iter().map(|(middle, radius)| Ball { middle, radius }).collect();
        Tried { radius: |ball: &Ball| ball.radius, rounding: 52 }.hold_operations::<PackedBalls>(&singles);
        Tried { radius: |ball: &DoubleBall| ball.radius, rounding: 100 }
            .hold_operations::<PackedDoubleBalls>(&doubles().into_iter().step_by(nth).collect::<Vec<_>>());
    }

    #[test]
    fn what_leaves_f64_is_not_known() {
        let large = Ball { middle: f64::MAX, radius: 0.0 };
        let packed = PackedBalls::of([&large; LANES]);
        assert!(packed.plus(&packed).single(1).certain_sign().is_none());
        assert!(packed.times(&packed).single(2).certain_sign().is_none());
        let large = DoubleBall::exactly(f64::MAX, 0.0);
        let packed = PackedDoubleBalls::of([&large; LANES]);
        assert!(packed.plus(&packed).single(1).certain_sign().is_none());
        assert!(packed.times(&packed).single(2).certain_sign().is_none());
    }
}
