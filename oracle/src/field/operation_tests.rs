//! Each operation by itself, on enclosures at the edges of what their types hold: the result holds every value that it may have, and is not much
//! wider than it must be. A radius too large gives no wrong answer, so that only a test of its size sees a mistake in it.

use super::{DoubleBall, Field, UpperBound, WideBall};
use crate::number::{Ball, UNIT_ROUNDOFF};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::ring::Ring;
use rockproof_model::{Number, Sign};

fn rational(value: f64) -> BigRational {
    Number::from_f64(value).expect("finite").to_rational()
}

fn power(exponent: i32) -> BigRational {
    let size = BigInt::one() << exponent.unsigned_abs();
    if exponent < 0 { BigRational::new_raw(BigInt::one(), size) } else { size.into() }
}

/// A type of enclosures, with what these tests must know of it.
trait Enclosure: Field + std::fmt::Debug {
    /// Enclosures to try, exact ones and others.
    fn samples() -> Vec<Self>;

    /// More, for what is made of one alone.
    fn alone() -> Vec<Self>;

    /// The radius, exactly; `None` for infinity and NaN.
    fn exact_radius(&self) -> Option<BigRational>;

    /// What the rounding of a result may add to its radius, of a result of this size from operands of which the least is of that size.
    fn rounding(size: &BigRational, least: &BigRational) -> BigRational;

    /// The size beyond which results need not be known.
    fn reach() -> BigRational;

    /// By how much of itself a radius may be too large.
    fn slack() -> BigRational;

    /// What is enclosed: the least, the middle, the greatest.
    fn values(&self) -> [BigRational; 3] {
        let (middle, radius) = (self.middle(), self.exact_radius().expect("a sample is known"));
        [middle.minus(&radius), middle.clone(), middle.plus(&radius)]
    }

    /// Holds a result against the values that it may have.
    fn hold(&self, values: &[BigRational], least: &BigRational, what: &dyn Fn() -> String) {
        let largest = values.iter().map(BigRational::abs).max().expect("some value");
        let Some(radius) = self.exact_radius() else {
            assert!(largest > Self::reach(), "{}: not known", what());
            return;
        };
        let middle = self.middle();
        let needed = values.iter().map(|value| value.minus(&middle).abs()).max().expect("some value");
        assert!(needed <= radius, "{} = {self:?} is left by {}", what(), needed - radius);
        let allowed = needed.plus(&needed.times(&Self::slack())).plus(&Self::rounding(&largest, least));
        assert!(radius <= allowed, "{} = {self:?} is wide by {}", what(), radius / allowed);
        self.hold_views(values, (&largest, least), what);
    }

    /// What else can be asked of a result.
    fn hold_views(
        &self,
        values: &[BigRational],
        (largest, least): (&BigRational, &BigRational),
        what: &dyn Fn() -> String,
    ) {
        let sign = self.certain_sign();
        assert!(values.iter().all(|value| sign.is_none_or(|sign| value.certain_sign() == Some(sign))), "{}", what());
        let radius = self.exact_radius().expect("known");
        if self.middle().abs() > radius.plus(&radius.times(&Self::slack())) {
            assert!(sign.is_some(), "{} = {self:?} has a sign", what());
        }
        let size = self.magnitude_bound().expect("known").to_rational();
        assert!(size >= *largest, "{} = {self:?} is no larger than {size}", what());
        let slack = radius.plus(largest).times(&power(-27)).plus(&Self::rounding(largest, least));
        assert!(
            size <= self.middle().abs().plus(&radius).plus(&slack),
            "{} = {self:?} is not as large as {size}",
            what()
        );
        let (near, off) = self.nearby();
        if near.is_finite() && off.is_finite() {
            let (near, off) = (rational(near), rational(off));
            let needed = values.iter().map(|value| value.minus(&near).abs()).max().expect("some value");
            assert!(needed <= off, "{} = {self:?}: nearby", what());
            let allowed =
                radius.plus(&radius.times(&Self::slack())).plus(&largest.times(&power(-49))).plus(&f64_floor(least));
            assert!(off <= allowed, "{} = {self:?}: nearby is wide", what());
        } else {
            assert!(*largest > power(900), "{} = {self:?}: nothing nearby", what());
        }
    }
}

/// What underflow may cost: some of the least normal f64, more where they were divided by something small.
fn f64_floor(least: &BigRational) -> BigRational {
    rational(f64::MIN_POSITIVE) * rational(8.0) / least.abs().min(BigRational::one())
}

/// Middles and radii that matter to what is made of one alone: a root next to a tie, radii below the normal numbers beside a middle that
/// is not, a large radius beside a middle that loses a bit when it is halved.
const ALONE: [(f64, f64); 4] = [(1.0 + f64::EPSILON, 0.0), (1.0, 2.5e-323), (1.0, 5e-324), (MIN_ODD, 1e-3)];
/// Of which the half is no f64.
const MIN_ODD: f64 = f64::from_bits(f64::MIN_POSITIVE.to_bits() + 1);

/// Parts of enclosures in f64: middles, and for each radii that matter beside it.
fn middles_and_radii() -> Vec<(f64, f64)> {
    let mut found = vec![
        (0.0, 0.0),
        (0.0, 0.25),
        (5e-324, 0.0),
        (1.0, 1.0),
        (1.0, 1e3),
        (3.0 * f64::MIN_POSITIVE, 5e-324),
        (1e-160, 1e-172),
        // A power of two and a square, exact or not.
        (4.0, 0.0),
        (4.0, 0.5),
        // A dividend that is not small enough to be lost, and too small for the low part of a product.
        (1e-283, 0.0),
    ];
    for middle in [-3.0, 0.1, 67_108_865.0, 3.0 * f64::MIN_POSITIVE, -1e-160] {
        let size: f64 = middle.abs();
        found.extend([0.0, size * 1e-17, size.next_down()].map(|radius| (middle, radius)));
    }
    found
}

impl Enclosure for Ball {
    fn samples() -> Vec<Self> {
        middles_and_radii().into_iter().map(|(middle, radius)| Ball { middle, radius }).collect()
    }

    fn alone() -> Vec<Self> {
        ALONE.map(|(middle, radius)| Ball { middle, radius }).to_vec()
    }

    fn exact_radius(&self) -> Option<BigRational> {
        (self.radius.is_finite() && self.middle.is_finite()).then(|| rational(self.radius))
    }

    fn rounding(size: &BigRational, least: &BigRational) -> BigRational {
        size.times(&rational(UNIT_ROUNDOFF)).times(&BigRational::one().plus(&power(-40))).plus(&f64_floor(least))
    }

    fn reach() -> BigRational {
        power(1020)
    }

    fn slack() -> BigRational {
        power(-40)
    }
}

impl Enclosure for DoubleBall {
    fn samples() -> Vec<Self> {
        let mut found = Vec::new();
        for (high, radius) in middles_and_radii() {
            found.push(DoubleBall { high, low: 0.0, radius });
            let low = high * UNIT_ROUNDOFF / 2.0;
            for low in [low, -low / 3.0] {
                if low != 0.0 && radius < high.abs() && high + low == high {
                    found.push(DoubleBall { high, low, radius: radius * 1e-16 });
                }
            }
        }
        found
    }

    fn alone() -> Vec<Self> {
        ALONE.map(|(high, radius)| DoubleBall { high, low: 0.0, radius }).to_vec()
    }

    fn exact_radius(&self) -> Option<BigRational> {
        let known = self.radius.is_finite() && self.high.is_finite() && self.low.is_finite();
        known.then(|| rational(self.radius))
    }

    fn rounding(size: &BigRational, least: &BigRational) -> BigRational {
        // Below 2⁻⁹⁶² products lose their low parts.
        let coarse = *size < power(-900) || *least < power(-900);
        let relative = if coarse { power(-48) } else { power(-100) };
        size.times(&relative).plus(&f64_floor(least))
    }

    fn reach() -> BigRational {
        power(990)
    }

    fn slack() -> BigRational {
        power(-40)
    }
}

impl Enclosure for WideBall {
    fn samples() -> Vec<Self> {
        let mut found = vec![WideBall::exactly(BigInt::zero(), 0, 64)];
        let long: BigInt = (BigInt::one() << 199) + 12_345;
        let parts = [(BigInt::one(), 0, 64), (3.into(), -700, 200), (long.clone(), -190, 200), (-long, 900, 64)];
        for (significand, exponent, bits) in parts {
            let exact = WideBall::exactly(significand, exponent, bits);
            let top = exact.top().expect("not zero");
            found.extend([300, 30, 1, -9].map(|below| exact.widened(UpperBound::power_of_two(top - below))));
            found.push(exact);
        }
        found
    }

    fn alone() -> Vec<Self> {
        Vec::new()
    }

    fn exact_radius(&self) -> Option<BigRational> {
        Field::radius(self).map(UpperBound::to_rational)
    }

    fn rounding(size: &BigRational, _least: &BigRational) -> BigRational {
        size.times(&power(-62))
    }

    fn reach() -> BigRational {
        power(1_000_000)
    }

    fn slack() -> BigRational {
        // A middle is cut 24 bits below the first of its radius.
        power(-20)
    }
}

/// The size of an operand's middle; of zero, one.
fn size_of(operand: &impl Enclosure) -> BigRational {
    let middle = operand.middle().abs();
    if middle == BigRational::zero() { BigRational::one() } else { middle }
}

/// The results of the ends of both: a sum, a product, a quotient and the lesser of two have their extremes there.
fn of_the_ends(
    one: &[BigRational; 3],
    other: &[BigRational; 3],
    with: fn(&BigRational, &BigRational) -> BigRational,
) -> Vec<BigRational> {
    fn ends([least, _, most]: &[BigRational; 3]) -> impl Iterator<Item = &BigRational> {
        std::iter::once(least).chain((least != most).then_some(most))
    }
    ends(one).flat_map(|x| ends(other).map(move |y| with(x, y))).collect()
}

/// Sums, differences, products, quotients and the lesser of two.
fn hold_pairs<S: Enclosure>() {
    let samples = S::samples();
    for a in &samples {
        for b in &samples {
            let (x, y) = (a.values(), b.values());
            let told = |sign: &str| format!("{a:?} {sign} {b:?}");
            let least = &size_of(a).min(size_of(b));
            a.plus(b).hold(&of_the_ends(&x, &y, Ring::plus), least, &|| told("+"));
            a.minus(b).hold(&of_the_ends(&x, &y, Ring::minus), least, &|| told("-"));
            a.times(b).hold(&of_the_ends(&x, &y, Ring::times), least, &|| told("*"));
            let apart = y[0].is_positive() || y[2].is_negative();
            match a.over(b) {
                Some(quotient) => {
                    assert!(apart, "{} may be anything", told("/"));
                    let values = of_the_ends(&x, &y, |x, y| x / y);
                    if values.iter().all(|value| value.abs() < S::reach()) {
                        quotient.hold(&values, least, &|| told("/"));
                    }
                }
                None => {
                    let near = std::cmp::min(y[0].abs(), y[2].abs());
                    assert!(!apart || near < y[1].abs() * power(-28), "{} is known", told("/"));
                }
            }
            let lesser = a.lesser(b).expect("an enclosure");
            if let Some(radius) = lesser.exact_radius() {
                let values = of_the_ends(&x, &y, |x, y| std::cmp::min(x, y).clone());
                let needed = values.iter().map(|value| value.minus(&lesser.middle()).abs()).max().expect("some");
                assert!(needed <= radius, "{}: {lesser:?}", told("or"));
            }
        }
    }
}

/// Halves, roots and opposites.
fn hold_singles<S: Enclosure>() {
    for a in S::samples().iter().chain(&S::alone()) {
        let x = a.values();
        let half = BigRational::new(1.into(), 2.into());
        a.half().hold(&x.clone().map(|x| x * &half), &size_of(a), &|| format!("half of {a:?}"));
        a.negated().hold(&x.clone().map(|x| -x), &size_of(a), &|| format!("less {a:?}"));
        a.hold(&x, &size_of(a), &|| format!("{a:?}"));
        let positive = x[0].is_positive();
        let Some(root) = a.root() else {
            let near = x[0] < &x[1] * power(-28);
            assert!(!positive || near, "{a:?} has a root");
            continue;
        };
        assert!(positive || (x[0] == x[2] && x[1] == BigRational::zero()), "{a:?} may have no root");
        let (middle, radius) = (root.middle(), root.exact_radius().expect("known"));
        let (least, most) = (&middle - &radius, &middle + &radius);
        assert!(&most * &most >= x[2], "the root of {a:?}: {root:?}");
        assert!(!least.is_positive() || &least * &least <= x[0], "the root of {a:?}: {root:?}");
        if middle.is_positive() {
            let spread = (&x[2] - &x[1]) / &middle;
            let allowed = spread * (BigRational::one() + S::slack()) + S::rounding(&middle, &x[1]);
            assert!(radius <= allowed, "the root of {a:?} is wide by {}", radius / allowed);
        }
        let again = a.root_of_square().expect("a root").exact_radius().expect("known");
        assert_eq!(again, radius, "the root of {a:?}, known to be a square");
    }
}

/// Fractions and differences of them, of any size.
fn hold_conversions<S: Enclosure>() {
    let ten = BigRational::from_integer(10.into());
    let third = BigRational::new(1.into(), 3.into());
    let sizes = [BigRational::one(), ten.pow(20), ten.pow(-20), ten.pow(-290), ten.pow(290)];
    let mut numbers =
        vec![BigRational::zero(), rational(0.1), rational(1e300), rational(5e-324), power(-40) + power(40)];
    numbers.extend(sizes.iter().flat_map(|size| [size * &third, -size.clone()]));
    // Numbers, and differences of two, that f64 or two f64 round by all that they may, and some below what f64 holds.
    let one = BigRational::one;
    numbers.extend([one() + power(-53), power(-53), power(53), BigRational::from_integer((-3).into())]);
    numbers.extend([one() - power(-53), -power(-52), one() + power(-60) + power(-113)]);
    numbers.extend([&third / ten.pow(400), -&third / ten.pow(400)]);
    for value in &numbers {
        let number = Number::from_rational(value.clone());
        let values = [value.clone()];
        let size = BigRational::one();
        for bits in [53, 106, 300] {
            S::of_rational(value, bits).hold(&values, &size, &|| format!("{value} in {bits} bits"));
            S::of_number(&number, bits).hold(&values, &size, &|| format!("{value} in {bits} bits"));
            for other in &numbers {
                let apart = [value - other];
                let with = Number::from_rational(other.clone());
                S::of_difference(&number, &with, bits)
                    .hold(&apart, &size, &|| format!("{value} - {other} in {bits} bits"));
            }
        }
    }
    let beyond = S::of_rational(&ten.pow(400), 64);
    let off = (beyond.middle() - ten.pow(400)).abs();
    assert!(beyond.exact_radius().is_none_or(|radius| off <= radius));
    assert!(beyond.radius().is_none_or(|radius| off <= radius.to_rational()));
    assert!(beyond.magnitude_bound().is_none_or(|size| ten.pow(400) <= size.to_rational()));
    assert_ne!(beyond.certain_sign(), Some(Sign::Negative));
}

#[test]
fn f64_balls_hold_what_they_must_and_little_more() {
    hold_pairs::<Ball>();
    hold_singles::<Ball>();
    hold_conversions::<Ball>();
}

#[test]
fn double_balls_hold_what_they_must_and_little_more() {
    hold_pairs::<DoubleBall>();
    hold_singles::<DoubleBall>();
    hold_conversions::<DoubleBall>();
}

#[test]
fn wide_balls_hold_what_they_must_and_little_more() {
    hold_pairs::<WideBall>();
    hold_singles::<WideBall>();
    hold_conversions::<WideBall>();
}
