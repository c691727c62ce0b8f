//! One harness over every backend of `Rational`: arithmetic, comparison, and rounding of values and roots, ties
//! included.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use proptest::prelude::*;
use rockproof_model::{Number, Sign};
use rockproof_oracle::rational::Rational;

fn exact(text: &str) -> BigRational {
    text.parse().unwrap()
}

fn backend<Q: Rational>(value: &BigRational) -> Q {
    Q::from_fraction(value.numer(), value.denom()).unwrap()
}

fn of_f64<Q: Rational>(value: f64) -> Q {
    Q::from_number(&Number::from_f64(value).unwrap())
}

/// The arithmetic of `Q` is that of the fractions.
fn calculates<Q: Rational>(u: &BigRational, v: &BigRational) {
    let (x, y) = (backend::<Q>(u), backend::<Q>(v));
    // Digit for digit: equal fractions need not be in lowest terms.
    let same = |found: Q, wanted: BigRational| assert_eq!((found.numerator(), found.denominator()), wanted.into_raw());
    same(x.plus(&y), u + v);
    same(x.minus(&y), u - v);
    same(x.times(&y), u * v);
    same(x.squared(), u * u);
    assert_eq!(x.signed_square().to_big_rational(), u * u.abs());
    assert_eq!(x.negated().to_big_rational(), -u);
    assert_eq!(x.magnitude().to_big_rational(), u.abs());
    let quotient = if v.is_zero() { None } else { Some(u / v) };
    assert_eq!(x.over(&y).map(|q| q.to_big_rational()), quotient);
    assert_eq!(x.cmp(&y), u.cmp(v));
    assert_eq!(x == y, u == v);
    assert_eq!(x.sign(), Sign::of_ordering(u.numer().cmp(&BigInt::zero())));
    assert_eq!((x.numerator(), x.denominator()), (u.numer().clone(), u.denom().clone()));
    assert_eq!(Q::from_number(&Number::from_rational(u.clone())), x);
    let unreduced = Q::from_fraction(&(u.numer() * -6), &(u.denom() * -6)).unwrap();
    assert_eq!(unreduced, x);
    assert_eq!(unreduced.denominator(), *u.denom());
}

/// The rounded root is a nearest f64: no neighbour is nearer, and of two equally near it is the even one.
fn rounds_the_root<Q: Rational>(value: &BigRational) {
    let near = backend::<Q>(value).sqrt_rounded().unwrap();
    let exact_of = |f: f64| Number::from_f64(f).unwrap().to_rational();
    let two = BigRational::from_integer(BigInt::from(2));
    if near > 0.0 {
        let half_way_down = (exact_of(near) + exact_of(near.next_down())) / &two;
        let lower = &half_way_down * &half_way_down;
        assert!(
            *value > lower || (*value == lower && near.to_bits().is_multiple_of(2)),
            "{value}: {near} is too large"
        );
    }
    let half_way_up = (exact_of(near) + exact_of(near.next_up())) / &two;
    let upper = &half_way_up * &half_way_up;
    assert!(*value < upper || (*value == upper && near.to_bits().is_multiple_of(2)), "{value}: {near} is too small");
}

fn known_values<Q: Rational>() {
    assert_eq!(Q::from_fraction(&BigInt::one(), &BigInt::zero()), None);
    assert_eq!(backend::<Q>(&exact("1/3")).rounded(), Some(1.0 / 3.0));
    assert_eq!(of_f64::<Q>(-0.0), Q::zero());
    let root = |text: &str| backend::<Q>(&exact(text)).sqrt_rounded();
    assert_eq!(root("0"), Some(0.0));
    assert_eq!(root("9/16"), Some(0.75));
    assert_eq!(root("2"), Some(std::f64::consts::SQRT_2));
    assert_eq!(root("-1"), None);
    // √(2²⁰⁴⁸) is one past the largest f64, √(2²⁰⁴⁶) is not.
    let power = |k: usize| backend::<Q>(&BigRational::from_integer(BigInt::one() << k));
    assert_eq!(power(2048).sqrt_rounded(), None);
    assert_eq!(power(2046).sqrt_rounded(), Some(2f64.powi(1023)));
    // Half way between two f64: to the even one, and away from the tie by any little to the nearer one.
    let little = backend::<Q>(&BigRational::new(BigInt::one(), BigInt::one() << 400usize));
    let half_ulp = of_f64::<Q>(2f64.powi(-53));
    for (below, above) in [(1.0, 1.0f64.next_up()), (1.0f64.next_up(), 1.0f64.next_up().next_up())] {
        let even = if below == 1.0 { below } else { above };
        let tie = of_f64::<Q>(below).plus(&half_ulp).squared();
        assert_eq!(tie.sqrt_rounded(), Some(even));
        assert_eq!(tie.minus(&little).sqrt_rounded(), Some(below));
        assert_eq!(tie.plus(&little).sqrt_rounded(), Some(above));
    }
    // Half the smallest subnormal goes to 0, a little more to the smallest subnormal.
    let tiny = of_f64::<Q>(f64::from_bits(1));
    let half_tiny = tiny.over(&Q::from_integer(2)).unwrap();
    assert_eq!(half_tiny.squared().sqrt_rounded(), Some(0.0));
    assert_eq!(half_tiny.squared().times(&backend(&exact("10001/10000"))).sqrt_rounded(), Some(f64::from_bits(1)));
    assert_eq!(tiny.squared().sqrt_rounded(), Some(f64::from_bits(1)));
    assert_eq!(of_f64::<Q>(f64::MAX).squared().sqrt_rounded(), Some(f64::MAX));
}

/// Fractions of up to 200 bits, small ones and zero among them; every second is a binary one.
fn fraction() -> impl Strategy<Value = BigRational> {
    let integer = |bytes| prop::collection::vec(any::<u8>(), 0..bytes).prop_map(|b| BigInt::from_signed_bytes_le(&b));
    let any = integer(25).prop_map(|d| if d.is_zero() { BigInt::one() } else { d });
    let power = (0..200usize).prop_map(|k| BigInt::one() << k);
    (integer(25usize), prop_oneof![any, power]).prop_map(|(n, d)| BigRational::new(n, d))
}

macro_rules! harness {
    ($name:ident, $backend:ty) => {
        mod $name {
            use super::*;

            #[test]
            fn known() {
                known_values::<$backend>();
            }

            proptest! {
                #[test]
                fn arithmetic(u in fraction(), v in fraction()) {
                    calculates::<$backend>(&u, &v);
                    calculates::<$backend>(&u, &u);
                    calculates::<$backend>(&u, &-&u);
                }

                #[test]
                fn root(u in fraction()) {
                    rounds_the_root::<$backend>(&u.abs());
                }

                #[test]
                fn root_of_a_tie(float in prop::num::f64::POSITIVE | prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL) {
                    prop_assume!(float < 1e308);
                    let exact = |f: f64| Number::from_f64(f).unwrap().to_rational();
                    let half_way = (exact(float) + exact(float.next_up())) / BigInt::from(2);
                    rounds_the_root::<$backend>(&(&half_way * &half_way));
                }
            }
        }
    };
}

harness!(num_rational_backend, BigRational);
#[cfg(feature = "gmp")]
harness!(rug_backend, rug::Rational);
