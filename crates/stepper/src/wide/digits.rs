//! Arithmetic on the digits of long numbers: 64 bits each, the lowest first, as many as there are.
//!
//! Schoolbook methods, since no number has more than [`MAX_DIGITS`] digits, and most have one or two.

use std::cmp::Ordering;

/// Bits of a digit.
pub(super) const DIGIT: u32 = u64::BITS;
/// Digits that a number has at most.
pub(super) const MAX_DIGITS: usize = 8;
/// Room for what is cut to [`MAX_DIGITS`] digits afterwards: a product, a quotient's dividend, or a sum of numbers that hardly overlap, with its carry.
pub(super) type Long = [u64; 2 * MAX_DIGITS + 2];

/// `one + other + carry`, and the carry.
fn add_digits(one: u64, other: u64, carry: bool) -> (u64, bool) {
    let (sum, first) = one.overflowing_add(other);
    let (sum, second) = sum.overflowing_add(u64::from(carry));
    (sum, first | second)
}

/// `one − other − borrow`, and the borrow.
fn subtract_digits(one: u64, other: u64, borrow: bool) -> (u64, bool) {
    let (difference, first) = one.overflowing_sub(other);
    let (difference, second) = difference.overflowing_sub(u64::from(borrow));
    (difference, first | second)
}

/// A quotient of two digits by one, which fits into one digit if the upper digit is below the divisor; else the largest digit.
fn divide_digits(upper: u64, lower: u64, divisor: u64) -> u64 {
    if upper >= divisor {
        return u64::MAX;
    }
    let dividend = u128::from(upper) << DIGIT | u128::from(lower);
    (dividend / u128::from(divisor)) as u64
}

/// Adds a number that is not longer; what is carried out of the digits is lost.
pub(super) fn add(sum: &mut [u64], other: &[u64]) {
    let (low, high) = sum.split_at_mut(other.len());
    let mut carry = false;
    for (digit, &other) in low.iter_mut().zip(other) {
        (*digit, carry) = add_digits(*digit, other, carry);
    }
    for digit in high {
        if !carry {
            return;
        }
        (*digit, carry) = digit.overflowing_add(1);
    }
}

/// Subtracts a number that is not longer and not larger.
pub(super) fn subtract(difference: &mut [u64], other: &[u64]) {
    let (low, high) = difference.split_at_mut(other.len());
    let mut borrow = false;
    for (digit, &other) in low.iter_mut().zip(other) {
        (*digit, borrow) = subtract_digits(*digit, other, borrow);
    }
    for digit in high {
        if !borrow {
            return;
        }
        (*digit, borrow) = digit.overflowing_sub(1);
    }
}

/// Subtracts `other·factor` from the lowest digits of a number; what it cannot take there, which the next digit owes.
fn subtract_product(number: &mut [u64], other: &[u64], factor: u64) -> u64 {
    let mut owed = 0;
    for (digit, &other) in number.iter_mut().zip(other) {
        let product = u128::from(other) * u128::from(factor) + u128::from(owed);
        let (difference, borrow) = digit.overflowing_sub(product as u64);
        *digit = difference;
        owed = (product >> DIGIT) as u64 + u64::from(borrow);
    }
    owed
}

/// The product, in the lowest digits of what is returned: as many as both have.
pub(super) fn product(one: &[u64], other: &[u64]) -> Long {
    let mut product: Long = [0; 2 * MAX_DIGITS + 2];
    for (place, &factor) in one.iter().enumerate() {
        let mut carry = 0;
        let (low, high) = product[place..].split_at_mut(other.len());
        for (digit, &other) in low.iter_mut().zip(other) {
            let sum = u128::from(other) * u128::from(factor) + u128::from(*digit) + u128::from(carry);
            *digit = sum as u64;
            carry = (sum >> DIGIT) as u64;
        }
        high[0] = carry;
    }
    product
}

/// The upper and the lower half of a product of two digits each.
pub(super) fn short_product(one: u128, other: u128) -> (u128, u128) {
    const LOW: u128 = u64::MAX as u128;
    let ([a, b], [c, d]) = ([one >> DIGIT, one & LOW], [other >> DIGIT, other & LOW]);
    let (low, crossed, also) = (b * d, a * d, b * c);
    let middle = (low >> DIGIT) + (crossed & LOW) + (also & LOW);
    (a * c + (crossed >> DIGIT) + (also >> DIGIT) + (middle >> DIGIT), middle << DIGIT | low & LOW)
}

/// A number as a fraction: its highest digit comes first after the point, and its lowest is not zero.
#[derive(Clone, Copy)]
pub(super) struct Fraction<'d>(pub(super) &'d [u64]);

impl Fraction<'_> {
    pub(super) fn order(self, other: Fraction<'_>) -> Ordering {
        let heads = self.0.iter().rev().zip(other.0.iter().rev());
        let unlike = heads.map(|(one, other)| one.cmp(other)).find(|order| order.is_ne());
        unlike.unwrap_or_else(|| self.0.len().cmp(&other.0.len()))
    }

    /// Writes the fraction, shifted down by fewer bits than a digit has, into zeros below the place `end`, as far as they reach; whether anything
    /// was cut off.
    pub(super) fn write(self, into: &mut [u64], end: usize, shift: u32) -> bool {
        let (mut place, mut above) = (end, 0);
        for &digit in self.0.iter().rev() {
            if place == 0 {
                return true;
            }
            place -= 1;
            if shift == 0 {
                into[place] = digit;
            } else {
                into[place] = above | digit >> shift;
                above = digit << (DIGIT - shift);
            }
        }
        if place == 0 {
            return above != 0;
        }
        into[place - 1] = above;
        false
    }
}

/// The quotient of two fractions cut to `count` digits, and whether anything was cut off (D. E. Knuth, The Art of Computer Programming 2, 4.3.1,
/// algorithm D). The divisor has its highest bit set, and is above the dividend shifted down by `shift` bits.
pub(super) fn quotient(dividend: Fraction<'_>, shift: u32, divisor: &[u64], count: usize) -> ([u64; MAX_DIGITS], bool) {
    let (length, mut rest, mut quotient): (_, Long, _) = (divisor.len(), [0; 2 * MAX_DIGITS + 2], [0; MAX_DIGITS]);
    let mut cut = dividend.write(&mut rest, length + count, shift);
    let (highest, second) = (divisor[length - 1], if length > 1 { divisor[length - 2] } else { 0 });
    for place in (0..count).rev() {
        let window = &mut rest[place..=place + length];
        let (upper, lower) = (window[length], window[length - 1]);
        let mut digit = divide_digits(upper, lower, highest);
        if length > 1 {
            // One digit more of either brings it down to what it is, or one above.
            let mut left =
                (u128::from(upper) << DIGIT | u128::from(lower)).wrapping_sub(u128::from(digit) * u128::from(highest));
            while left >> DIGIT == 0
                && u128::from(digit) * u128::from(second) > (left << DIGIT | u128::from(window[length - 2]))
            {
                digit -= 1;
                left += u128::from(highest);
            }
        }
        let (low, high) = window.split_at_mut(length);
        let owed = subtract_product(low, divisor, digit);
        let (top, borrow) = high[0].overflowing_sub(owed);
        high[0] = top;
        if borrow {
            digit -= 1;
            add(window, divisor);
        }
        quotient[place] = digit;
    }
    cut |= rest[..length].iter().any(|&digit| digit != 0);
    (quotient, cut)
}

/// The square root of a fraction shifted down by `shift` bits, which is a quarter at least, cut to `count` digits, and whether anything was cut off
/// (P. Zimmermann, Karatsuba Square Root, INRIA report 3805, 1999; one digit at a time).
pub(super) fn root(square: Fraction<'_>, shift: u32, count: usize) -> ([u64; MAX_DIGITS], bool) {
    let (mut rest, mut root): (Long, _) = ([0; 2 * MAX_DIGITS + 2], [0; MAX_DIGITS]);
    let mut cut = square.write(&mut rest, 2 * count, shift);
    let top = u128::from(rest[2 * count - 1]) << DIGIT | u128::from(rest[2 * count - 2]);
    let first = top.isqrt();
    root[count - 1] = first as u64;
    let left = top - first * first;
    (rest[2 * count - 1], rest[2 * count - 2]) = ((left >> DIGIT) as u64, left as u64);
    for place in (0..count - 1).rev() {
        // With the root s so far and the digit q to come, q·(2·s·2⁶⁴ + q) is to be taken from what is left. That has one digit more than s, of which
        // the highest is at most 1, and two digits to come.
        let known = count - 1 - place;
        let window = &mut rest[2 * place..2 * place + known + 3];
        let (carry, upper, lower) = (window[known + 2], window[known + 1], window[known]);
        let half = [carry << (DIGIT - 1) | upper >> 1, upper << (DIGIT - 1) | lower >> 1];
        let mut digit = divide_digits(half[0], half[1], root[count - 1]);
        let twice = {
            let mut twice: Long = [0; 2 * MAX_DIGITS + 2];
            let mut carried = 0;
            for (double, &digit) in twice[1..].iter_mut().zip(&root[place + 1..count]) {
                *double = digit << 1 | carried;
                carried = digit >> (DIGIT - 1);
            }
            twice[known + 1] = carried;
            twice
        };
        let mut taken = twice;
        taken[0] = digit;
        let owed = subtract_product(window, &taken[..known + 2], digit);
        let (left, mut negative) = window[known + 2].overflowing_sub(owed);
        window[known + 2] = left;
        while negative {
            digit -= 1;
            // (s + 1)² − s² = 2·s + 1
            let mut back = twice;
            back[0] = digit << 1 | 1;
            back[1] |= digit >> (DIGIT - 1);
            let before = window[known + 2];
            add(window, &back[..known + 2]);
            negative = window[known + 2] >= before;
        }
        root[place] = digit;
    }
    cut |= rest[..2 * count].iter().any(|&digit| digit != 0);
    (root, cut)
}
