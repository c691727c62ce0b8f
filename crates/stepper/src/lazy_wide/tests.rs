use super::ball::Ball;
use super::notes::MAX_NOTES;
use super::*;
use crate::wide::count_unsettled;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use proptest::prelude::*;
use rockproof_model::fraction;

/// Neither here nor in sums, products and quotients by `fraction` are binary fractions reduced by the library, which would take most of the time.
fn rational(value: f64) -> BigRational {
    Number::from_f64(value).unwrap().to_rational()
}

/// Numbers whose roundings lose all that they may, and those that underflow.
fn adversarial() -> Vec<f64> {
    let u = f64::EPSILON / 2.0;
    let sizes = [1.0, 1.0 + 2.0 * u, 2.0 - 2.0 * u, 1.0 + 2f64.powi(-26), 3.0, 0.1];
    let exponents = [0, -27, 52, -540, -1022];
    let all = exponents.into_iter().flat_map(|e| sizes.map(|size| size * 2f64.powi(e)));
    all.chain([0.0, 5e-324, f64::MIN_POSITIVE]).flat_map(|x| [x, -x]).collect()
}

/// How close to its radius a ball came, over all that was looked at.
#[derive(Default)]
struct Closest(f64);

impl Closest {
    fn holds(&mut self, ball: Ball, exact: &BigRational) {
        if !ball.is_bounded() {
            return;
        }
        let off = fraction::difference(&rational(ball.middle), exact).abs();
        let radius = rational(ball.radius);
        assert!(off <= radius, "{ball:?} does not hold {exact}");
        if ball.radius > 1e-300 {
            let share = off.numer() * radius.denom() * BigInt::from(1000) / (off.denom() * radius.numer());
            self.0 = self.0.max(i32::try_from(share).unwrap_or(1000).into());
        }
    }
}

#[test]
fn one_operation_is_within_its_radius_and_not_far_within() {
    operations_of_every(5);
}

#[test]
#[ignore = "five seconds; .ci/run runs it"]
fn one_operation_is_within_its_radius_and_not_far_within_at_full_size() {
    operations_of_every(1);
}

/// Every number with every nth of them, and with its opposite, which stands beside it.
fn operations_of_every(nth: usize) {
    let (mut sums, mut products, mut quotients, mut roots) = Default::default();
    let radii = |x: f64| [0.0, x.abs() * 0.25, x.abs() * f64::EPSILON, 1e-300];
    let ball = |middle, radius| Ball { middle, radius };
    let ends = |b: Ball| {
        let (middle, radius) = (rational(b.middle), rational(b.radius));
        [fraction::difference(&middle, &radius), fraction::sum(&middle, &radius)]
    };
    let all: Vec<f64> = adversarial();
    for (i, &x) in all.iter().enumerate() {
        for (j, &y) in all.iter().enumerate().filter(|&(j, _)| j % nth == i % nth || j == i ^ 1) {
            let (one, two) = (ball(x, radii(x)[i % 4]), ball(y, radii(y)[(i / 4 + j) % 4]));
            for p in ends(one) {
                for q in ends(two) {
                    Closest::holds(&mut sums, one + two, &fraction::sum(&p, &q));
                    Closest::holds(&mut products, one * two, &fraction::product(&p, &q));
                    if let Some(quotient) = fraction::quotient(&p, &q) {
                        Closest::holds(&mut quotients, one / two, &quotient);
                    }
                    Closest::holds(&mut sums, one.covering(two), &p);
                    Closest::holds(&mut sums, one.covering(two), &q);
                    Closest::holds(&mut sums, one.magnitude(), &p.abs());
                    if let Some(order) = one.order(two) {
                        assert_eq!(order, p.cmp(&q), "{one:?} and {two:?}");
                    }
                }
            }
        }
        for radius in radii(x) {
            let root = ball(x, radius).root();
            if !root.is_bounded() {
                continue;
            }
            // √p is within the ball where p is between the squares of its ends.
            let [low, high] = ends(root);
            for p in ends(ball(x, radius)) {
                assert!(!p.is_negative());
                assert!((!low.is_positive() || &low * &low <= p) && p <= &high * &high, "{root:?} of {x} ± {radius}");
            }
            Closest::holds(&mut roots, root, &low);
        }
    }
    for (name, Closest(share)) in [("sums", sums), ("products", products), ("quotients", quotients)] {
        assert!(share > 990.0, "the radius of {name} is never used up: {share} thousandths");
    }
}

#[test]
fn exact_is_what_was_not_rounded() {
    let all = adversarial();
    let mut exact = 0;
    for &x in &all {
        for &y in &all {
            let (one, two) = (Ball::exact(x), Ball::exact(y));
            let (p, q) = (rational(x), rational(y));
            for (found, value) in [(one + two, &p + &q), (one * two, &p * &q)] {
                if found.is_exact() {
                    assert_eq!(rational(found.middle), value);
                    exact += 1;
                }
            }
            let quotient = one / two;
            if y != 0.0 && quotient.is_exact() {
                assert_eq!(rational(quotient.middle), &p / &q);
                exact += 1;
            }
        }
        let root = Ball::exact(x).root();
        if root.is_exact() {
            assert_eq!(rational(root.middle) * rational(root.middle), rational(x));
        }
    }
    assert!(exact > 500, "{exact}");
    let unbounded = Ball { middle: 1.0, radius: f64::INFINITY };
    for unknown in [
        Ball::exact(-1.0).root(),
        Ball::exact(f64::NAN),
        unbounded * Ball::exact(0.0),
        Ball::exact(1.0) / Ball::exact(0.0),
    ] {
        assert!(!unknown.is_bounded() && !unknown.is_exact(), "{unknown:?}");
    }
}

/// The same operations in any scalar: each works on two of those before it; then all are compared with some.
fn comparisons<R: Real>(leaves: &[f64], program: &[(u8, usize, usize)]) -> Vec<(Option<Ordering>, u64, [bool; 4])> {
    let mut values: Vec<R> = leaves.iter().map(|&leaf| R::from_f64(leaf)).collect();
    values.push(R::from_number(&Number::from_rational(BigRational::new(1.into(), 3.into()))).unwrap());
    for &(operation, i, j) in program {
        let (x, y) = (values[i % values.len()], values[j % values.len()]);
        values.push(match operation {
            0 => x + y,
            1 => x - y,
            2 => x * y,
            3 => x / y,
            4 => x.sqrt(),
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
            let (order, unsettled) = count_unsettled(|| x.partial_cmp(&y));
            answers.push((order, unsettled, [x.below(y), x.surely_below(y), x.is_finite(), x.to_f64() == y.to_f64()]));
        }
    }
    answers
}

proptest! {
    #[test]
    fn what_is_answered_and_whether_it_is_settled_is_what_the_wide_scalar_answers(
        leaves in proptest::collection::vec(
            prop_oneof![(-8i32..8).prop_map(f64::from), -10.0..10.0f64, Just(1.0 + f64::EPSILON), Just(0.1)], 1..6),
        program in proptest::collection::vec((0u8..10, any::<usize>(), any::<usize>()), 1..30),
    ) {
        let lazy_wide = noted(|| comparisons::<LazyWide>(&leaves, &program));
        prop_assert_eq!(lazy_wide, Some(comparisons::<Wide>(&leaves, &program)));
    }
}

/// Neither a chain of operations as long as may be noted is too deep, nor is more noted.
#[test]
fn work_of_any_length_ends() {
    let third = |parts: usize| {
        let third = LazyWide::from_f64(1.0) / LazyWide::from_f64(3.0);
        (0..parts).fold(LazyWide::ZERO, |sum, _| sum + third)
    };
    let compared = |parts: usize| {
        noted(|| count_unsettled(|| third(parts) * LazyWide::from_f64(3.0) == LazyWide::from_f64(parts as f64)))
    };
    assert_eq!(compared(MAX_NOTES - 10), Some((true, 1)), "a tie of rounded values");
    assert_eq!(compared(MAX_NOTES + 10), None);
    assert_eq!(compared(3), Some((true, 1)), "nothing is left of the work before");
    let whole = noted(|| Wide::of_integer(&BigInt::from(7)).partial_cmp(&LazyWide::from_f64(7.0).wide()));
    assert_eq!(whole, Some(Some(Ordering::Equal)));
}

/// What is nearly a tie of f64 is none of 128 bits; what is nearly one of these takes all bits; a tie is one of all.
#[test]
fn all_bits_are_asked_only_where_fewer_leave_a_comparison_open() {
    for (exponent, order, longest) in
        [(-60, Ordering::Greater, false), (-140, Ordering::Greater, true), (-600, Ordering::Equal, true)]
    {
        let compared = noted(|| {
            let third = LazyWide::from_f64(1.0) / LazyWide::from_f64(3.0);
            let more = LazyWide::from_f64(2f64.powi(exponent)) * third;
            let found = count_unsettled(|| (third + more).partial_cmp(&third));
            (found, NOTES.with_borrow(|notes| [notes.short.numbers.is_empty(), notes.long.numbers.is_empty()]))
        });
        let unsettled = u64::from(order.is_eq());
        assert_eq!(compared, Some(((Some(order), unsettled), [false, !longest])), "1/3 + 2^{exponent}/3");
    }
}
