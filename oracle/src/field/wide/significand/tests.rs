use super::*;
use num_traits::Zero;
use proptest::prelude::*;
use proptest::test_runner::RngAlgorithm;

/// Integers of up to 300 bits, many with long runs of equal bits, and the least and largest of each kind.
fn integers() -> impl Strategy<Value = BigInt> {
    let size = prop_oneof![
        any::<u128>(),
        (any::<u128>(), 0u32..128).prop_map(|(value, shift)| value >> shift),
        (any::<u128>(), 0u32..128).prop_map(|(value, shift)| value << shift),
        (0u32..128, 0u32..128).prop_map(|(a, b)| (u128::MAX >> a) & (u128::MAX << b)),
        Just(0),
        Just(1),
        Just(u128::MAX),
    ];
    let more = prop_oneof![Just(0u32), Just(0), Just(0), 1u32..12, 100u32..172, Just(128)];
    (size, any::<bool>(), more, any::<u128>(), any::<bool>()).prop_map(|(size, negative, more, last, is_full)| {
        // As many last bits as there are, random ones or ones alone.
        let last = if is_full { u128::MAX } else { last };
        let size = (BigInt::from(size) << more) + if more == 128 { BigInt::from(last) } else { BigInt::ZERO };
        if negative { -size } else { size }
    })
}

fn value(uncut: Uncut) -> BigInt {
    match uncut {
        Uncut::Double { negative, high, low } => {
            let size = (BigInt::from(high) << WIDTH) + low;
            if negative { -size } else { size }
        }
        Uncut::Quadruple { negative, size } => integer(negative, size.as_le_slice()),
        Uncut::Long(value) => value,
    }
}

fn is_canonical(value: &Significand) -> bool {
    match value {
        Significand::Short { negative, size } => !(*negative && *size == 0),
        Significand::Middle { size, .. } => size.bit_len() > WIDTH as usize,
        Significand::Long(value) => value.bits() > u64::from(2 * WIDTH),
    }
}

proptest! {
    // A generator is made for each part of each case: another kind takes most of the time for that.
    #![proptest_config(ProptestConfig { rng_algorithm: RngAlgorithm::XorShift, ..ProptestConfig::with_cases(20_000) })]

    #[test]
    fn what_is_in_place_is_what_is_on_the_heap(
        a in integers(), b in integers(), up in 0i64..450, side in any::<bool>(), negate in any::<bool>(), cut in 0i64..560
    ) {
        let [one, two] = [&a, &b].map(|value| Significand::from(value.clone()));
        prop_assert!(is_canonical(&one) && is_canonical(&two));
        prop_assert_eq!(one.integer().into_owned(), a.clone());
        prop_assert_eq!((one.bits(), one.is_zero(), one.sign()), (a.bits() as i64, a.is_zero(), ExactRing::sign(&a)));
        prop_assert_eq!(one.negated().integer().into_owned(), -&a);
        prop_assert!(is_canonical(&one.negated()));
        for exponent in [-200, 0, 77] {
            prop_assert_eq!(one.upper_bound(exponent), UpperBound::of_integer(&a, exponent));
        }
        let shifts = if side { [up, 0] } else { [0, up] };
        let sum = || one.sum(shifts[0], &two, shifts[1], negate);
        let [moved, other] = [&a << shifts[0] as usize, &b << shifts[1] as usize];
        let expected = if negate { moved - other } else { moved + other };
        let checks: [(&dyn Fn() -> Uncut, BigInt); 2] = [(&sum, expected), (&|| one.times(&two), &a * &b)];
        for (made, expected) in checks {
            prop_assert_eq!(value(made()), expected.clone());
            prop_assert_eq!(made().bits(), expected.bits() as i64);
            let zeros = expected.trailing_zeros();
            prop_assert_eq!(made().ends_in_ones(cut), zeros.is_some_and(|zeros| (zeros as i64) < cut));
            let shorter = made().without(cut);
            prop_assert!(is_canonical(&shorter));
            prop_assert_eq!(shorter.integer().into_owned(), expected >> cut as usize);
        }
    }
}

#[test]
fn a_zero_may_be_moved_anywhere() {
    let three = Significand::from(BigInt::from(3));
    assert_eq!(value(three.sum(2, &Significand::ZERO, -7, true)), BigInt::from(12));
    assert_eq!(value(Significand::ZERO.sum(-7, &three, 1, true)), BigInt::from(-6));
    let long = Significand::from(BigInt::from(1) << 200);
    assert_eq!(value(Significand::ZERO.sum(-7, &long, 1, false)), BigInt::from(1) << 201);
}

/// Rounding down what is negative may take a bit more than there is room for.
#[test]
fn a_carry_makes_a_longer_integer() {
    let most = |bits: u32| BigInt::from(1) - (BigInt::from(1) << bits);
    for bits in [128, 256] {
        let twice = Significand::from(most(bits)).sum(1, &Significand::short(true, 1), 0, false);
        let found = twice.without(1);
        assert!(is_canonical(&found));
        assert_eq!(matches!(found, Significand::Long(_)), bits == 256);
        let expected: BigInt = BigInt::from(-1) << bits;
        assert_eq!(found.integer().into_owned(), expected);
    }
}
