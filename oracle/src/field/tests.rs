//! Random expressions: every enclosure holds the exact value, and no certain sign is wrong.

use super::{DoubleBall, Field, Halve, UpperBound, WideBall};
use crate::number::Ball;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::{Number, Ring, Sign};

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }
}

/// The same value in five types.
#[derive(Clone)]
struct Quintet {
    exact: BigRational,
    float: Option<Ball>,
    double: Option<DoubleBall>,
    wide: [Option<WideBall>; 2],
}

const BITS: [u32; 2] = [64, 200];

impl Quintet {
    fn leaf(random: &mut Random) -> Quintet {
        let small = |r: &mut Random| BigInt::from(r.next() as i64 - (1 << 30));
        let (mut n, mut d) = (small(random), BigInt::from(1 + random.next()));
        match random.next() % 4 {
            0 => d = BigInt::from(1u64 << (random.next() % 40)),
            1 => n = BigInt::from(random.next() as i64 % 3 - 1),
            _ => {}
        }
        let exact = BigRational::new(n, d);
        let number = Number::from_rational(exact.clone());
        let wide = BITS.map(|bits| Some(WideBall::of_rational(&exact, bits)));
        Quintet {
            float: Some(Ball::of_number(&number, 53)),
            double: Some(DoubleBall::of_number(&number, 106)),
            wide,
            exact,
        }
    }

    fn check(&self) -> usize {
        fn one<S: Field>(exact: &BigRational, ball: Option<&S>) -> usize {
            let Some(ball) = ball else { return 0 };
            if let Some(radius) = ball.radius() {
                assert!((ball.middle() - exact).abs() <= radius.to_rational(), "an enclosure lost {exact}");
            }
            let (near, off) = ball.nearby();
            if near.is_finite() && off.is_finite() {
                let near = Number::from_f64(near).unwrap().to_rational();
                assert!((near - exact).abs() <= Number::from_f64(off).unwrap().to_rational(), "nearby lost {exact}");
            }
            ball.certain_sign().map_or(0, |sign| {
                assert_eq!(Some(sign), exact.certain_sign());
                1
            })
        }
        one(&self.exact, self.float.as_ref())
            + one(&self.exact, self.double.as_ref())
            + self.wide.iter().map(|w| one(&self.exact, w.as_ref())).sum::<usize>()
    }

    fn combined(&self, other: &Quintet, operation: u64) -> Option<Quintet> {
        fn go<S: Field>(a: &S, b: &S, operation: u64) -> Option<S> {
            match operation {
                0 => Some(a.plus(b)),
                1 => Some(a.minus(b)),
                2 => Some(a.times(b)),
                3 => a.over(b),
                4 => Some(a.half()),
                // The root of a square, where the exact value has one too.
                5 => a.squared().root(),
                6 => a.lesser(b),
                // Of sums that may cancel: the enclosure may reach below zero.
                _ => a.minus(b).squared().root_of_square(),
            }
        }
        let wide =
            [0, 1].map(|k| self.wide[k].as_ref().zip(other.wide[k].as_ref()).and_then(|(a, b)| go(a, b, operation)));
        let float = self.float.as_ref().zip(other.float.as_ref()).and_then(|(a, b)| go(a, b, operation));
        let double = self.double.as_ref().zip(other.double.as_ref()).and_then(|(a, b)| go(a, b, operation));
        Some(Quintet { exact: go(&self.exact, &other.exact, operation)?, float, double, wide })
    }
}

#[test]
fn enclosures_hold_the_exact_value() {
    let mut random = Random(7);
    let (mut decided, mut asked) = (0, 0);
    for _ in 0..3_000 {
        let mut values = vec![Quintet::leaf(&mut random), Quintet::leaf(&mut random)];
        for _ in 0..8 {
            let pick = |r: &mut Random, n: usize| r.next() as usize % n;
            let (i, j) = (pick(&mut random, values.len()), pick(&mut random, values.len()));
            let next = match random.next() % 5 {
                0 => Some(Quintet::leaf(&mut random)),
                _ => values[i].combined(&values[j], random.next() % 8),
            };
            if let Some(next) = next.filter(|v| v.exact.numer().bits() + v.exact.denom().bits() < 3_000) {
                decided += next.check();
                asked += 4;
                values.push(next);
            }
        }
    }
    assert!(asked > 30_000 && decided > asked / 2, "{decided} of {asked} signs decided");
}

#[test]
fn what_cannot_be_compared_is_enclosed_by_both() {
    fn holds<S: Field>(one: S, other: S, values: &[&str]) {
        let least = one.lesser(&other).expect("an enclosure");
        let root = one.root_of_square().expect("an enclosure");
        for value in values {
            let value: BigRational = value.parse().expect("a fraction");
            assert!((least.middle() - &value).abs() <= least.radius().expect("known").to_rational(), "{value}");
            let apart = root.middle() - &value;
            assert!(apart.abs() <= root.radius().expect("known").to_rational(), "the root of {value}²");
        }
    }
    // One is anything from −1/4 to 1/4, the other from −1/8 to 1/8.
    let quarter = UpperBound::power_of_two(-2);
    let eighth = UpperBound::power_of_two(-3);
    let values = ["-1/4", "0", "1/8"];
    holds(Ball::within(quarter).unwrap(), Ball::within(eighth).unwrap(), &values);
    holds(DoubleBall::within(quarter).unwrap(), DoubleBall::within(eighth).unwrap(), &values);
    holds(WideBall::within(quarter).unwrap(), WideBall::within(eighth).unwrap(), &values);
    let fraction = |n: i32, d: i32| BigRational::new(n.into(), d.into());
    assert_eq!(fraction(1, 3).lesser(&fraction(2, 7)), Some(fraction(2, 7)));
    assert_eq!(fraction(4, 9).root_of_square(), Some(fraction(2, 3)));
    assert_eq!(fraction(2, 1).root_of_square(), None);
}

#[test]
fn a_middle_of_few_bits_is_told_from_a_far_smaller_radius() {
    let one = WideBall::exactly(1.into(), 0, 200).widened(UpperBound::power_of_two(-300));
    assert_eq!(one.certain_sign(), Some(Sign::Positive));
    let exact = BigRational::from_integer(1.into());
    for value in [one.over(&one), one.root()] {
        let value = value.expect("not zero");
        assert!((value.middle() - &exact).abs() <= value.radius().expect("known").to_rational());
    }
    let half = WideBall::exactly(1.into(), 0, 200).widened(UpperBound::power_of_two(0));
    assert!(half.certain_sign().is_none() && half.root().is_none() && one.over(&half).is_none(), "it may be zero");
}

/// Every operation on bounds rounds up, and the lower bound of an f64 down: numbers of many digits lose in each.
#[test]
fn a_magnitude_is_never_below_what_it_bounds() {
    let mut random = Random(3);
    for _ in 0..2_000 {
        let mut number = || {
            let digits = BigInt::from(random.next()) * BigInt::from(random.next()) + BigInt::from(1);
            (digits, random.next() as i64 % 200 - 100)
        };
        let ((n, e), (m, f)) = (number(), number());
        let (one, two) = (UpperBound::of_integer(&n, e), UpperBound::of_integer(&m, f));
        let (x, y) = (one.to_rational(), two.to_rational());
        assert!(x >= super::dyadic(n, e) && y >= super::dyadic(m, f));
        assert!(one.plus(two).to_rational() >= &x + &y, "{one:?} + {two:?}");
        assert!(one.times(two).to_rational() >= &x * &y, "{one:?} * {two:?}");
        assert!(one.over(two).unwrap().to_rational() >= &x / &y, "{one:?} / {two:?}");
        let root = one.root().to_rational();
        assert!(&root * &root >= x, "the root of {one:?}");
        for unit in [e - 3, e, e + 20, e + 90] {
            let units = BigRational::from_integer(one.in_units(unit));
            assert!(units * super::dyadic(1.into(), unit) >= x, "{one:?} in units of 2^{unit}");
        }
        let float = Number::from_f64(one.to_f64()).unwrap().to_rational();
        assert!(float >= x, "{one:?} as f64");
        let value = random.next() as f64 * random.next() as f64 + 1.0;
        let exact = Number::from_f64(value).unwrap().to_rational();
        assert!(UpperBound::of_f64(value).unwrap().to_rational() >= exact, "{value}");
        assert!(UpperBound::floor_of_f64(value).unwrap().to_rational() <= exact, "at most {value}");
    }
}

#[test]
fn what_one_operation_may_lose_is_in_its_radius() {
    let rational = |value: f64| Number::from_f64(value).unwrap().to_rational();
    // A divisor that may be anything from 1/2 to 3/2, a dividend from 0 to 2: the quotient may be as much as 4.
    let wide = |middle: f64, radius: f64| Ball { middle, radius };
    let quotient = wide(1.0, 1.0).over(&wide(1.0, 0.5)).unwrap();
    assert!(quotient.middle + quotient.radius >= 4.0 && quotient.middle - quotient.radius <= 0.0, "{quotient:?}");
    // A difference of f64 that rounds.
    let (a, b) = (1.0, f64::EPSILON / 8.0);
    let difference = Ball::of_difference(&Number::from_f64(a).unwrap(), &Number::from_f64(b).unwrap(), 53);
    assert!((rational(difference.middle) - (rational(a) - rational(b))).abs() <= rational(difference.radius));
    // A sign only where the whole ball has it.
    let double = |high: f64, radius: f64| DoubleBall { high, low: 0.0, radius };
    assert_eq!(double(1.0, 0.75).certain_sign(), Some(Sign::Positive));
    assert_eq!(double(1.0, 1.0).certain_sign(), None);
    assert_eq!(double(-1.0, 1.25).certain_sign(), None);
    // A product beyond f64 is not known, nor what is divided by it: 10³⁰⁰ over 10⁴⁰⁰ is above zero.
    let beyond = double(1e200, 0.0).times(&double(1e200, 0.0));
    assert!(beyond.radius().is_none() && beyond.certain_sign().is_none(), "{beyond:?}");
    let quotient = double(1e300, 0.0).over(&beyond);
    assert!(quotient.is_none_or(|quotient| quotient.minus(&double(1e-200, 0.0)).certain_sign().is_none()));
    // Nor one whose low part is beyond f64, and so no number.
    assert!(double(1.5e301, 0.0).times(&double(1.1, 0.0)).radius().is_none());
    for (high, low) in [(1.0, f64::NAN), (f64::INFINITY, 0.0)] {
        assert!(DoubleBall { high, low, radius: 0.0 }.radius().is_none(), "{high} + {low}");
    }
    // Half of the least radius is no f64, and not nothing.
    let half = wide(1.0, 5e-324).half();
    assert!(half.middle == 0.5 && half.radius > 0.0, "{half:?}");
    // An addend far below the other's last bit.
    let one = WideBall::exactly(1.into(), 0, 64);
    let tiny = WideBall::exactly(1.into(), -1_000, 64);
    for sum in [one.plus(&tiny), tiny.plus(&one), one.minus(&tiny)] {
        assert!((sum.middle() - rational(1.0)).abs() + sum.radius().unwrap().to_rational() > BigRational::default());
    }
    // The quotient of an exact number and one with a radius: 3·b over b − 1/2.
    let (a, b) = (12_890_774_745_i64, 4_296_924_915_i64);
    let divisor = WideBall::exactly(b.into(), 0, 64).widened(UpperBound::power_of_two(-1));
    let quotient = WideBall::exactly(a.into(), 0, 64).over(&divisor).unwrap();
    let largest = BigRational::new(BigInt::from(2 * a), BigInt::from(2 * b - 1));
    assert!((quotient.middle() - largest).abs() <= quotient.radius().unwrap().to_rational(), "{quotient:?}");
}

/// Roots of squares are exact, others are off by no more than the last place or two, whatever the last bits of the root are.
#[test]
fn a_root_is_exact_where_the_number_is_a_square_and_only_there() {
    for bits in [64, 128, 200, 256] {
        for n in 2..=60_i32 {
            let root = WideBall::exactly(n.into(), 0, bits).root().unwrap();
            let (middle, radius) = (root.middle(), root.radius().unwrap().to_rational());
            let (most, least) = (&middle + &radius, &middle - &radius);
            let number = BigRational::from_integer(n.into());
            assert!(&most * &most >= number && &least * &least <= number, "√{n} in {bits} bits: {root:?}");
            let square = (2..8).any(|k| k * k == n);
            assert_eq!(radius == BigRational::default(), square, "√{n} in {bits} bits: {root:?}");
            // Roots below 8 have three bits before the point.
            assert!(radius <= super::dyadic(1.into(), 4 - i64::from(bits)), "√{n} in {bits} bits: {root:?}");
        }
    }
    // A number of more bits than asked for, with an odd exponent.
    let root = WideBall::exactly(BigInt::from(3) << 190, 1, 64).root().unwrap();
    let (middle, radius) = (root.middle(), root.radius().unwrap().to_rational());
    let (most, least, number) = (&middle + &radius, middle - &radius, super::dyadic(3.into(), 191));
    assert!(&most * &most >= number && &least * &least <= number, "{root:?}");
}

#[test]
fn what_fits_stays_exact_and_what_is_cut_loses_its_last_places_only() {
    let two_to = |exponent: i64| super::dyadic(1.into(), exponent);
    let big = |exponent: u32| BigInt::from(1) << exponent;
    let exactly = WideBall::exactly;
    let one = || WideBall::from_i32(1);
    let three = WideBall::from_i32(3);
    // Results of as many bits as there are, or of zeros after that.
    let exact = [
        (exactly(big(63) + 1, 0, 64).times(&one()), two_to(63) + two_to(0)),
        (exactly(big(63) - 1, 0, 64).plus(&exactly(big(63) + 3, 0, 64)), two_to(64) + two_to(1)),
        (exactly(1.into(), 300, 128).plus(&exactly(1.into(), 250, 128)), two_to(300) + two_to(250)),
        (exactly(1.into(), 250, 128).plus(&exactly(1.into(), 300, 128)), two_to(300) + two_to(250)),
        (exactly(1.into(), 900, 64).plus(&exactly(1.into(), 850, 64)), two_to(900) + two_to(850)),
        (exactly(9.into(), 0, 200).root().unwrap(), two_to(1) + two_to(0)),
    ];
    for (ball, value) in exact {
        assert!(ball.middle() == value && ball.spread().is_zero(), "{ball:?} is {value}");
    }
    // 81 bits, the last of which is set, cut to 64.
    let cut = exactly(big(80) + 1, 0, 64).times(&one());
    assert!(cut.middle() == two_to(80) && cut.spread().to_rational() == two_to(17), "{cut:?}");
    // A sum of 326 bits, cut to 256.
    let cut = exactly(1.into(), 0, 256).plus(&exactly(big(255) + 1, -325, 256));
    assert!(cut.spread().to_rational() <= two_to(-250), "{cut:?}");
    assert!((cut.middle() - two_to(0) - two_to(-70) - two_to(-325)).abs() <= cut.spread().to_rational(), "{cut:?}");
    // A third to 200 bits, of ones to which something of so many bits has been added, zero or far below.
    let ones = [
        exactly(1.into(), 0, 64).with_bits(200),
        one().plus(&exactly(0.into(), 0, 200)),
        exactly(0.into(), 0, 200).plus(&one()),
        one().plus(&exactly(1.into(), -1_000, 200)),
    ];
    let third = BigRational::new(1.into(), 3.into());
    for one in ones {
        let quotient = one.over(&three).unwrap();
        let radius = quotient.spread().to_rational();
        assert!((quotient.middle() - &third).abs() <= radius && radius <= two_to(-197), "{one:?} / 3 = {quotient:?}");
    }
}

#[test]
fn bounds_of_few_bits_are_exact_and_in_order() {
    let of = |value: u32| UpperBound::of_integer(&value.into(), 0);
    for a in 0..40 {
        for b in 0..40 {
            assert_eq!(of(a).cmp(&of(b)), a.cmp(&b), "{a} and {b}");
        }
    }
    // 32 bits are kept as they are, the last of them set, whatever zeros follow.
    let mut random = Random(5);
    for _ in 0..200 {
        let digits = BigInt::from(random.next() | 1 << 31 | 1);
        for zeros in [0, 5, 40] {
            let value = BigRational::from_integer(&digits << zeros);
            assert_eq!(UpperBound::of_integer(&(&digits << zeros), 0).to_rational(), value);
        }
    }
    // What is no finite number, or below zero, has no bound.
    for value in [f64::INFINITY, f64::NAN, -1.0] {
        assert!(UpperBound::of_f64(value).is_none() && UpperBound::floor_of_f64(value).is_none(), "{value}");
    }
    assert!(UpperBound::floor_of_f64(0.0).is_none() && UpperBound::of_f64(0.0).is_some_and(UpperBound::is_zero));
}

#[test]
fn nearest_units_are_those_of_a_rounded_quotient() {
    let mut random = Random(8);
    let mut halves = 0;
    for trial in 0..4_000 {
        // Over powers of two, halves among them, and over anything.
        let twos = random.next() % 90;
        let odd = if trial % 3 == 0 { 1 + 2 * (random.next() % 20) } else { 1 };
        let numerator = BigInt::from(random.next() as i64 - (1 << 30)) << (random.next() % 70) as usize;
        let value = BigRational::new(numerator + random.next() % 2, BigInt::from(odd) << twos as usize);
        let exponent = twos as i64 - [0, 1, 1, 2, 40, -3, -60][random.next() as usize % 7];
        let scaled = &value * super::dyadic(BigInt::from(1), exponent);
        halves += usize::from(scaled.denom() == &BigInt::from(2));
        assert_eq!(super::nearest_units(&value, exponent), scaled.round().to_integer(), "{value} · 2^{exponent}");
    }
    assert!(halves > 100, "{halves}");
}

#[test]
fn the_middle_of_two_f64_is_their_sum() {
    let rational = |value: f64| BigRational::from_float(value).unwrap_or_default();
    let highs = [0.0, 1.0, -3.0, 0.1, 1e300, -5e-324, 2f64.powi(-1022), f64::INFINITY, f64::NAN];
    for high in highs {
        for low in [0.0, -0.0, high * 2f64.powi(-53), -high * 2f64.powi(-60), 5e-324, f64::NAN] {
            let middle = DoubleBall { high, low, radius: 0.0 }.middle();
            assert_eq!(middle, rational(high) + rational(low), "{high:e} + {low:e}");
            // In lowest terms, as every fraction is.
            assert_eq!(BigRational::new(middle.numer().clone(), middle.denom().clone()), middle);
        }
    }
}
