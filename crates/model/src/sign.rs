//! The answer of a predicate.

/// The sign of an exactly known quantity. A tie is [`Sign::Zero`], never a small number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Sign {
    /// Below zero. For a gap: the blocks overlap.
    Negative,
    /// Exactly zero. For a gap: the blocks touch.
    Zero,
    /// Above zero. For a gap: the blocks are apart.
    Positive,
}

impl Sign {
    /// −1, 0 or 1, as written in tables and files.
    pub fn as_i8(self) -> i8 {
        match self {
            Sign::Negative => -1,
            Sign::Zero => 0,
            Sign::Positive => 1,
        }
    }

    /// The sign of a signed comparison result.
    pub fn of_ordering(ordering: std::cmp::Ordering) -> Sign {
        match ordering {
            std::cmp::Ordering::Less => Sign::Negative,
            std::cmp::Ordering::Equal => Sign::Zero,
            std::cmp::Ordering::Greater => Sign::Positive,
        }
    }

    /// The sign of the negated quantity.
    #[must_use]
    pub fn reversed(self) -> Sign {
        match self {
            Sign::Negative => Sign::Positive,
            Sign::Zero => Sign::Zero,
            Sign::Positive => Sign::Negative,
        }
    }

    /// The sign of the product of two quantities.
    #[must_use]
    pub fn times(self, other: Sign) -> Sign {
        match self {
            Sign::Negative => other.reversed(),
            Sign::Zero => Sign::Zero,
            Sign::Positive => other,
        }
    }

    /// Above zero; a tie says no.
    pub fn is_positive(self) -> bool {
        self == Sign::Positive
    }

    /// Below zero; a tie says no.
    pub fn is_negative(self) -> bool {
        self == Sign::Negative
    }

    /// Exactly zero.
    pub fn is_zero(self) -> bool {
        self == Sign::Zero
    }

    /// Zero or above; **a tie says yes**.
    pub fn is_at_least_zero(self) -> bool {
        self != Sign::Negative
    }

    /// Zero or below; **a tie says yes**.
    pub fn is_at_most_zero(self) -> bool {
        self != Sign::Positive
    }
}
