//! What a predicate answers: yes or no, and whether that hung on an exact tie.

use crate::rational::Rational;
use rockproof_model::Sign;

/// The answer of a predicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PredicateAnswer {
    /// The answer.
    pub(super) yes: bool,
    /// Whether the deciding value was exactly zero.
    pub(super) tie: bool,
}

impl PredicateAnswer {
    /// `value ≥ 0`: **a tie says yes**.
    pub(super) fn at_least_zero<Q: Rational>(value: &Q) -> PredicateAnswer {
        let sign = value.sign();
        PredicateAnswer { yes: sign != Sign::Negative, tie: sign == Sign::Zero }
    }

    /// `value > 0`: **a tie says no**.
    pub(super) fn above_zero<Q: Rational>(value: &Q) -> PredicateAnswer {
        let sign = value.sign();
        PredicateAnswer { yes: sign == Sign::Positive, tie: sign == Sign::Zero }
    }

    /// `value ≤ limit`: **a tie says yes**.
    pub(super) fn at_most<Q: Rational>(value: &Q, limit: &Q) -> PredicateAnswer {
        Self::at_least_zero(&limit.minus(value))
    }

    /// `value ≥ limit`: **a tie says yes**.
    pub(super) fn at_least<Q: Rational>(value: &Q, limit: &Q) -> PredicateAnswer {
        Self::at_least_zero(&value.minus(limit))
    }

    /// Both: the smaller of the two deciding values decides. `other` is not asked after a clear no.
    pub(super) fn and(self, other: impl FnOnce() -> PredicateAnswer) -> PredicateAnswer {
        if !self.yes && !self.tie {
            return self;
        }
        let other = other();
        if !other.yes && !other.tie {
            return other;
        }
        PredicateAnswer { yes: self.yes && other.yes, tie: self.tie || other.tie }
    }

    /// Either: the larger of the two deciding values decides. `other` is not asked after a clear yes.
    pub(super) fn or(self, other: impl FnOnce() -> PredicateAnswer) -> PredicateAnswer {
        if self.yes && !self.tie {
            return self;
        }
        let other = other();
        if other.yes && !other.tie {
            return other;
        }
        PredicateAnswer { yes: self.yes || other.yes, tie: self.tie || other.tie }
    }

    /// The same answer, a tie also where something it rests on was one.
    pub(super) fn tied_if(self, tie: bool) -> PredicateAnswer {
        PredicateAnswer { tie: self.tie || tie, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    fn verdict(strict: bool, value: i32) -> PredicateAnswer {
        let value = <BigRational as Rational>::from_integer(value);
        if strict { PredicateAnswer::above_zero(&value) } else { PredicateAnswer::at_least_zero(&value) }
    }

    #[test]
    fn combine_as_the_smaller_and_the_larger_value() {
        for (strict_u, strict_v) in [(false, false), (false, true), (true, false), (true, true)] {
            for u in -1..=1 {
                for v in -1..=1 {
                    let both = verdict(strict_u, u).and(|| verdict(strict_v, v));
                    assert_eq!(both.yes, verdict(strict_u, u).yes && verdict(strict_v, v).yes);
                    assert_eq!(both.tie, u.min(v) == 0, "{u} and {v}");
                    let either = verdict(strict_u, u).or(|| verdict(strict_v, v));
                    assert_eq!(either.yes, verdict(strict_u, u).yes || verdict(strict_v, v).yes);
                    assert_eq!(either.tie, u.max(v) == 0, "{u} or {v}");
                }
            }
        }
    }
}
