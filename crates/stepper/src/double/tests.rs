use super::*;
use crate::wide::{Wide, count_unsettled};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use rockproof_model::{Number, fraction};

/// Neither here nor in sums, products and quotients by `fraction` are binary fractions reduced by the library, which would take most of the time.
fn rational(value: f64) -> BigRational {
    Number::from_f64(value).expect("a number").to_rational()
}

/// Numbers whose roundings lose all that they may, and those that underflow, some with a lower part.
fn adversarial() -> Vec<(f64, f64)> {
    let u = f64::EPSILON / 2.0;
    let sizes = [1.0, 1.0 + 2.0 * u, 2.0 - 2.0 * u, 1.0 + 2f64.powi(-26), 3.0, 0.1];
    let exponents = [0, -27, 52, -430, -540, -1022];
    let all = exponents.into_iter().flat_map(|e| sizes.map(|size| size * 2f64.powi(e)));
    let lower = |(place, x): (usize, f64)| two_sum(x, x * [0.0, u / 3.0, -0.3 * u, u * u, 0.0][place % 5]);
    all.chain([0.0, 5e-324, f64::MIN_POSITIVE]).enumerate().map(lower).flat_map(|(x, y)| [(x, y), (-x, -y)]).collect()
}

fn middle(x: Double) -> BigRational {
    fraction::sum(&rational(x.high), &rational(x.low))
}

fn ends(x: Double) -> [BigRational; 2] {
    let (middle, radius) = (middle(x), rational(x.radius));
    [fraction::difference(&middle, &radius), fraction::sum(&middle, &radius)]
}

/// The ball holds the number, and its upper part is the nearest to its middle.
fn holds(found: Double, exact: &BigRational) {
    if found.is_known() {
        let off = fraction::difference(&middle(found), exact).abs();
        assert!(off <= rational(found.radius), "{found:?} does not hold {exact}");
        assert_eq!(found.high + found.low, found.high, "{found:?}");
    }
}

#[test]
fn one_operation_is_within_its_radius() {
    let all = adversarial();
    for (i, &(x, below)) in all.iter().enumerate() {
        let radii = |x: f64| [0.0, x.abs() * 0.25, x.abs() * 2f64.powi(-100), 1e-300];
        let one = Double { high: x, low: below, radius: radii(x)[i % 4] };
        for (j, &(y, below)) in all.iter().enumerate().filter(|&(j, _)| j % 5 == i % 5 || j == i ^ 1) {
            let two = Double { high: y, low: below, radius: radii(y)[(i / 4 + j) % 4] };
            for p in ends(one) {
                for q in ends(two) {
                    holds(one + two, &fraction::sum(&p, &q));
                    holds(one * two, &fraction::product(&p, &q));
                    if let Some(quotient) = fraction::quotient(&p, &q) {
                        holds(one / two, &quotient);
                    }
                    holds(one.larger(two), (&p).max(&q));
                    if let Some(order) = (one - two).settled_sign() {
                        assert_eq!(order, p.cmp(&q), "{one:?} and {two:?}");
                    }
                }
            }
        }
        for radius in radii(x) {
            let of = Double { radius, ..one };
            let root = of.sqrt();
            if !root.is_known() {
                continue;
            }
            // √p is within the ball where p is between the squares of its ends.
            let [low, high] = ends(root);
            for p in ends(of).into_iter().filter(|p| !p.is_negative()) {
                assert!((!low.is_positive() || &low * &low <= p) && p <= &high * &high, "{root:?} of {of:?}");
            }
        }
    }
}

/// The roundings of both mixed products and of their sum are nearly the largest that they may be, and the product of the lower parts adds to them.
#[test]
fn a_product_that_loses_as_much_as_one_may_is_within_its_radius() {
    let (u, unit) = (f64::EPSILON / 2.0, |digits: u32| f64::from(digits) * f64::EPSILON);
    let number = |above, below| Double { high: 1.0 + unit(above), low: u * (1.0 - unit(below) / 2.0), radius: 0.0 };
    let (one, two) = (number(0x6eb47, 3823), number(0x3f6_c87c, 761_395));
    for (one, two) in [(one, two), (-one, two), (two, one)] {
        let (found, exact) = (one * two, middle(one) * middle(two));
        holds(found, &exact);
        assert!((middle(found) - exact).abs() > rational(0.99 * found.radius), "{found:?}");
    }
}

/// Numbers of all sizes, drawn from their bits, with a lower part and a radius of any share.
fn drawn() -> impl Strategy<Value = Double> {
    let size = prop_oneof![
        4 => -60i32..60,
        1 => prop_oneof![-540i32..-440, 440i32..520],
        1 => prop_oneof![-1074i32..-960, 960i32..1024],
    ];
    let share = prop_oneof![Just(0.0), (-120i32..-50).prop_map(|e| 2f64.powi(e)), Just(0.3), Just(2f64.powi(-700))];
    let lower = prop_oneof![Just(0.0), -1.0..1.0f64, Just(1.0), Just(2f64.powi(-60)), Just(-2f64.powi(-500))];
    (0u64..1 << 52, size, any::<bool>(), lower, share).prop_map(|(digits, size, is_negative, lower, share)| {
        let digits = (1.0 + digits as f64 * f64::EPSILON) * 2f64.powi(size / 2) * 2f64.powi(size - size / 2);
        let high = if is_negative { -digits } else { digits };
        let (high, low) = two_sum(high, high * (f64::EPSILON / 2.0) * lower);
        Double { high, low, radius: high.abs() * share }
    })
}

/// Another number, or nearly the same with either sign, so that sums and differences cancel.
fn two_drawn() -> impl Strategy<Value = (Double, Double)> {
    (drawn(), drawn(), 0u8..5, -110i32..-45).prop_map(|(one, other, nearly, exponent)| {
        let moved = one * Double::from_f64(1.0) + one * Double::from_f64(2f64.powi(exponent));
        match nearly {
            0 if moved.is_known() => (one, moved),
            1 if moved.is_known() => (one, -moved),
            2 => (one, Double { radius: one.radius * 0.5, ..one }),
            _ => (one, other),
        }
    })
}

/// Whether √p lies in the ball.
fn holds_root(root: Double, p: &BigRational) -> bool {
    let [low, high] = ends(root);
    (!low.is_positive() || &low * &low <= *p) && &high * &high <= high.abs() * &high && *p <= &high * &high
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn operations_on_drawn_numbers_are_within_their_radii((one, two) in two_drawn(), (left, right) in (-1.0..=1.0f64, -1.0..=1.0f64)) {
        prop_assume!(one.is_known() && two.is_known());
        let within = |x: Double, share: f64| middle(x) + rational(x.radius) * rational(share);
        for (left, right) in [(left, right), (-1.0, 1.0), (1.0, 1.0), (left.signum(), right.signum())] {
            let (p, q) = (within(one, left), within(two, right));
            holds(one + two, &(&p + &q));
            holds(one - two, &(&p - &q));
            holds(one * two, &(&p * &q));
            if !q.is_zero() {
                holds(one / two, &(&p / &q));
            }
            holds(one.larger(two), (&p).max(&q));
            holds(one.smaller(two), (&p).min(&q));
            holds(one.abs(), &p.abs());
            if let Some(order) = (one - two).settled_sign() {
                prop_assert_eq!(order, p.cmp(&q));
            }
            let root = one.sqrt();
            if root.is_known() && !p.is_negative() {
                prop_assert!(holds_root(root, &p), "{:?} of {:?}", root, one);
            }
        }
        let grown = (one - two).settled_sign().is_none().then(|| one.larger(two));
        let all = [one + two, one * two, one / two, one.sqrt()].into_iter().chain(grown);
        for found in all.filter(|found| found.is_known()) {
            let least = found.high.abs() * LEAST_SHARE;
            let is_short = found.is_exact() && (found.low == 0.0 || found.low.abs() >= least);
            prop_assert!(is_short || found.radius >= least, "{found:?}");
        }
    }

    #[test]
    fn rationals_are_read_within_their_radii(above in any::<i128>(), below in 1..u64::MAX, exponent in -900i32..900) {
        let power = BigRational::from_integer(num_bigint::BigInt::from(1) << exponent.unsigned_abs());
        let power = if exponent < 0 { power.recip() } else { power };
        let exact = BigRational::new(above.into(), below.into()) * power;
        let read = Double::from_number(&Number::from_rational(exact.clone())).expect("a number");
        holds(read, &exact);
        prop_assert!(read.radius <= read.high.abs() * 2f64.powi(-104) + UNDERFLOW);
    }
}

/// Two f64 hold 1 + 2⁻⁶⁰⁰ exactly, 512 bits do not: so it counts as rounded, and what is closer to it than 512 bits tell stays unsettled.
#[test]
fn digits_further_apart_than_in_512_bits_are_not_exact() {
    fn found<R: Real>(exponent: i32) -> ((Option<Ordering>, bool), u64) {
        let (one, small) = (R::from_f64(1.0), R::from_f64(2f64.powi(exponent)));
        count_unsettled(|| ((one + small - one).partial_cmp(&small), one < one + small))
    }
    assert_eq!(found::<Double>(-300), ((Some(Ordering::Equal), true), 0));
    assert_eq!(found::<Double>(-300), found::<Wide>(-300));
    assert_eq!(found::<Double>(-600), ((Some(Ordering::Equal), false), 2));
    assert_eq!(found::<Double>(-600), found::<Wide>(-600));
}

#[test]
fn the_nearest_f64_is_that_of_the_wide_scalar() {
    // Midway between two f64 but for less than 2⁻⁶⁴, on either side, and not so near.
    for (high, below) in [(1.0, 0.0), (1.0 + f64::EPSILON, 0.0), (1.5, 1e-12), (-1.0, -1e-12), (1.25, 1e-3)] {
        for sign in [1.0, -1.0] {
            let half = f64::EPSILON / 2.0 * sign;
            for low in [half, half * (1.0 - below), half * (1.0 - 2f64.powi(-20)), half * 0.9] {
                let (high, low) = two_sum(high, low);
                let in_wide = Wide::of_f64(high) + Wide::of_f64(low);
                let found = Double { high, low, radius: 0.0 }.to_f64();
                assert_eq!(found, in_wide.nearest_f64(), "{high:e} + {low:e}");
            }
        }
    }
}

#[test]
fn exact_is_what_was_not_rounded_and_roundings_are_those_of_two_f64() {
    let [one, three, seven] = [1.0, 3.0, 7.0].map(Double::from_f64);
    let third = one / three;
    let (close, exact) = (2f64.powi(-103), |x: Double, value: f64| x.is_exact() && x.high == value && x.low == 0.0);
    assert!(third.radius > 0.0 && third.radius < close && (third * seven).radius < 8.0 * close);
    assert!(exact(three * seven, 21.0) && exact(three * seven / seven, 3.0) && exact((seven * seven).sqrt(), 7.0));
    assert!(exact(Double::ZERO * third, 0.0) && exact(Double::ZERO / third, 0.0) && exact(Double::ZERO.sqrt(), 0.0));
    let root = seven.sqrt();
    assert!(root.radius > 0.0 && root.radius < 8.0 * close);
    holds(root * root, &rational(7.0));
    let tiny = Double::from_f64(2f64.powi(-70));
    assert!((seven + tiny).is_exact() && exact(seven + tiny - seven, 2f64.powi(-70)));
    let number = Number::from_rational(BigRational::new(1.into(), 3.into()));
    let read = Double::from_number(&number).expect("a number");
    holds(read, &BigRational::new(1.into(), 3.into()));
    assert!(read.radius < close && read.to_number().is_some_and(|middle| middle.to_rational() == self::middle(read)));
}

#[test]
fn what_is_not_known_settles_nothing() {
    let large = Double::from_f64(f64::MAX);
    let one = Double::from_f64(1.0);
    let unknown = [
        (-one).sqrt(),
        one / Double::ZERO,
        Double::from_f64(f64::NAN),
        large * large,
        large * one,
        large + large - large,
        (-one).sqrt() * Double::ZERO,
        (-one).sqrt().larger(one),
    ];
    for (place, x) in unknown.into_iter().enumerate() {
        assert!(!x.is_finite() && x.to_f64().is_nan() && x.to_number().is_none(), "{place}: {x:?}");
        let asked = count_unsettled(|| (x.partial_cmp(&one), x.below(one), one.surely_below(x), x == x));
        assert_eq!(asked, ((None, false, false, false), 4), "{place}: {x:?}");
    }
}

/// What comparisons say of two numbers, and how many of these are left unsettled.
type Compared = ((Option<Ordering>, [bool; 3]), u64);

/// The same operations in any scalar: each works on two of those before it; then all are compared with some.
fn comparisons<R: Real>(leaves: &[f64], program: &[(u8, usize, usize)]) -> Vec<Compared> {
    let mut values: Vec<R> = leaves.iter().map(|&leaf| R::from_f64(leaf)).collect();
    values.push(R::from_number(&Number::from_rational(BigRational::new(1.into(), 3.into()))).expect("a number"));
    for &(operation, i, j) in program {
        let (x, y) = (values[i % values.len()], values[j % values.len()]);
        values.push(match operation {
            0 => x + y,
            1 => x - y,
            2 => x * y,
            3 => x / y,
            4 => x.abs().sqrt(),
            5 => x.abs(),
            6 => x.larger(y),
            7 => x.smaller(y),
            8 => -x,
            _ => (x * x + y * y).sqrt(),
        });
    }
    let mut answers = Vec::new();
    for &x in &values {
        for y in [values[0], values[values.len() / 2], x * values[0] / values[0], R::ZERO] {
            answers.push(count_unsettled(|| (x.partial_cmp(&y), [x.below(y), x.surely_below(y), x.is_positive()])));
        }
    }
    answers
}

proptest! {
    #[test]
    fn what_is_settled_is_what_the_wide_scalar_answers(
        leaves in proptest::collection::vec(
            prop_oneof![
                4 => (-8i32..8).prop_map(f64::from),
                4 => -10.0..10.0f64,
                2 => prop_oneof![Just(1.0 + f64::EPSILON), Just(0.1)],
                1 => prop_oneof![Just(2f64.powi(-300)), Just(2f64.powi(-600)), Just(1e-290), Just(1e200), Just(5e-324)],
            ],
            1..6,
        ),
        program in proptest::collection::vec((0u8..10, any::<usize>(), any::<usize>()), 1..30),
    ) {
        let in_wide = comparisons::<Wide>(&leaves, &program);
        for (found, in_wide) in comparisons::<Double>(&leaves, &program).into_iter().zip(in_wide) {
            if found.1 == 0 {
                prop_assert_eq!(found, in_wide);
            }
        }
    }
}

/// Nearly a tie of f64 is none of two f64; nearly one of these, and a tie of rounded numbers, is counted.
#[test]
fn what_is_closer_than_two_f64_tell_is_counted() {
    for (exponent, order, unsettled) in [(-60, Ordering::Greater, 0), (-140, Ordering::Equal, 1)] {
        let third = Double::from_f64(1.0) / Double::from_f64(3.0);
        let more = Double::from_f64(2f64.powi(exponent)) * third;
        let found = count_unsettled(|| (third + more).partial_cmp(&third));
        assert_eq!(found, (Some(order), unsettled), "1/3 + 2^{exponent}/3");
    }
    let tie = count_unsettled(|| Double::from_f64(0.5) == Double::from_f64(0.25) + Double::from_f64(0.25));
    assert_eq!(tie, (true, 0), "a tie of exact numbers");
}
