//! Every result against `num_integer` and `num_rational`, digit for digit, on numbers that lead to every way through the algorithms.

use super::*;
use num_integer::Integer;

/// SplitMix64: the tests must not depend on a library's stream.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    /// A number of at most so many binary digits; short, sparse and full ones, powers of two and what is beside them.
    fn number(&mut self, bits: u64) -> BigUint {
        let length = 1 + self.below(bits);
        let digits = (0..length.div_ceil(32)).map(|_| self.next() as u32).collect();
        let full = BigUint::new(digits) >> (length.next_multiple_of(32) - length);
        let power = BigUint::one() << (length - 1);
        match self.below(6) {
            0 => power,
            1 => power + 1u32,
            2 => (power << 1u32) - 1u32,
            3 => full << self.below(bits),
            _ => full,
        }
    }

    fn signed(&mut self, bits: u64) -> BigInt {
        let number = BigInt::from(self.number(bits));
        if self.below(2) == 0 { -number } else { number }
    }

    /// A fraction; often zero, a whole number, a binary fraction, or over one of the denominators.
    fn fraction(&mut self, bits: u64, denominators: &[BigInt]) -> BigRational {
        let below = match self.below(5) {
            0 => BigInt::one(),
            1 => BigInt::one() << self.below(bits),
            2 => BigInt::from(self.number(bits)) + 1,
            _ => denominators[self.below(denominators.len() as u64) as usize].clone(),
        };
        let above = if self.below(12) == 0 { BigInt::zero() } else { self.signed(bits) };
        BigRational::new(above, below)
    }
}

fn expect_divisor(a: &BigUint, b: &BigUint) {
    let found = greatest_common_divisor(a, b);
    assert_eq!(found, a.gcd(b), "{a} and {b}");
    assert_eq!(found, greatest_common_divisor(b, a), "{a} and {b} exchanged");
}

#[test]
fn divisors_are_those_of_the_library() {
    let mut random = Random(1);
    for round in 0..4_000 {
        let bits = [40, 64, 130, 300, 1_500][round % 5];
        let (a, b, common) = (random.number(bits), random.number(bits), random.number(bits));
        expect_divisor(&a, &b);
        expect_divisor(&(&a * &common), &(&b * &common));
        expect_divisor(&a, &(&a * &b));
        expect_divisor(&(&a * &b + 1u32), &a);
    }
}

#[test]
fn divisors_of_zero_and_of_equal_numbers() {
    let [zero, one, long] = [BigUint::zero(), BigUint::one(), (BigUint::one() << 400u32) + 3u32];
    for a in [&zero, &one, &long] {
        for b in [&zero, &one, &long] {
            expect_divisor(a, b);
        }
    }
}

/// Quotients of neighbours in the series of Fibonacci are all one, the most steps that numbers of a length can take; those of the other series are all
/// as large as its factor, up to where the leading digits decide no step.
#[test]
fn divisors_of_neighbours_in_series_are_one() {
    for factor in [1u64, 2, 3, 1 << 20, (1 << 31) - 1, 1 << 31, 1 << 40, u64::MAX] {
        let (mut a, mut b) = (BigUint::one(), BigUint::zero());
        while a.bits() < 1_000 {
            (a, b) = (&a * factor + &b, a);
            assert!(greatest_common_divisor(&a, &b).is_one(), "factor {factor}: {a} and {b}");
            expect_divisor(&(&a * 21u32), &(&b * 35u32));
        }
    }
}

/// The steps of leading digits are those of Euclid's algorithm: what they make is smaller than b, and next to it in the series of remainders.
#[test]
fn leading_digits_make_steps_of_euclids_algorithm() {
    let mut random = Random(2);
    let (mut made, mut none) = (0, 0);
    for round in 0..2_000 {
        let bits = 65 + random.below(700);
        let mut a = random.number(bits) + (BigUint::one() << 64u32);
        let mut b = random.number(bits) + (BigUint::one() << 64u32);
        if a < b {
            mem::swap(&mut a, &mut b);
        }
        let Some(steps) = leading_steps(&a, &b) else {
            none += 1;
            continue;
        };
        made += 1;
        let determinant = i128::from(steps.p) * i128::from(steps.s) - i128::from(steps.q) * i128::from(steps.r);
        assert!(determinant.abs() == 1, "round {round}");
        let applied = steps.applied(&a, &b);
        let (mut x, mut y) = (a.clone(), b.clone());
        while (&x, &y) != (&applied.0, &applied.1) {
            assert!(!y.is_zero(), "round {round}: {applied:?} are no remainders of {a} and {b}");
            (x, y) = (y.clone(), x % y);
        }
    }
    assert!(made > 300 && none > 300, "{made} and {none}");
}

#[test]
fn sums_products_and_quotients_are_those_of_the_library() {
    let mut random = Random(3);
    for round in 0..3_000 {
        let bits = [20, 64, 200, 700][round % 4];
        let shared: BigInt = BigInt::from(random.number(bits)) + 1;
        let denominators =
            [shared.clone(), &shared * 6, &shared * (BigInt::from(random.number(bits)) + 1), shared << 7];
        let (a, b) = (random.fraction(bits, &denominators), random.fraction(bits, &denominators));
        let raw = |value: BigRational| value.into_raw();
        assert_eq!(raw(sum(&a, &b)), raw(&a + &b), "{a} + {b}");
        assert_eq!(raw(difference(&a, &b)), raw(&a - &b), "{a} − {b}");
        assert_eq!(raw(difference(&a, &a)), raw(BigRational::zero()), "{a} − {a}");
        assert_eq!(raw(product(&a, &b)), raw(&a * &b), "{a} · {b}");
        assert_eq!(quotient(&a, &b).map(raw), (!b.is_zero()).then(|| raw(&a / &b)), "{a} / {b}");
        let (above, below): (BigInt, BigInt) = (random.signed(bits), random.signed(bits) * 2 + 1);
        assert_eq!(raw(lowest(above.clone(), below.clone())), raw(BigRational::new(above.clone(), below.clone())));
        let multiple = common_multiple(&above.abs(), &below.abs());
        assert_eq!(multiple, above.lcm(&below), "{above} and {below}");
    }
}

#[test]
#[should_panic(expected = "a denominator is zero")]
fn nothing_is_over_zero() {
    lowest(BigInt::one(), BigInt::zero());
}
