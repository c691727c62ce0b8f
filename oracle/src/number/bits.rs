use rockproof_model::Ring;

/// How many bits an integer can have: stands for every x with |x| < 2^bits.
///
/// Evaluating a predicate on bit counts tells how wide the integers must be that evaluate it exactly, all intermediate
/// results included, since no operation here ever lowers the count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Bits(pub(crate) u32);

impl Ring for Bits {
    fn from_i32(value: i32) -> Self {
        Bits(32 - value.unsigned_abs().leading_zeros())
    }
    fn plus(&self, other: &Self) -> Self {
        Bits(self.0.max(other.0) + 1)
    }
    fn minus(&self, other: &Self) -> Self {
        self.plus(other)
    }
    fn times(&self, other: &Self) -> Self {
        Bits(self.0 + other.0)
    }
    fn negated(&self) -> Self {
        *self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_integers_of_so_many_bits_stay_within_the_count() {
        let largest = |bits: u32| (1i64 << bits) - 1;
        for one in 0..20 {
            for other in 0..20 {
                let (x, y) = (largest(one), largest(other));
                let fits = |value: i64, bits: Bits| value < 1 << bits.0;
                assert!(fits(x + y, Bits(one).plus(&Bits(other))), "{one} + {other}");
                assert!(fits(x + y, Bits(one).minus(&Bits(other))), "{one} - {other}");
                assert!(fits(x * y, Bits(one).times(&Bits(other))), "{one} * {other}");
                assert!(fits(x, Bits::from_i32(x as i32)) && fits(x, Bits::from_i32(-x as i32)));
            }
        }
    }
}
