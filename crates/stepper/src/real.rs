//! The scalar the stepper calculates in.

use crate::contact::CompiledContacts;
use crate::wide::Wide;
use rockproof_model::{ContactKey, Number, Precision};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
    impl Sealed for crate::wide::Wide {}
    impl Sealed for crate::double::Double {}
    impl Sealed for crate::lazy_wide::LazyWide {}
    impl Sealed for crate::motion_interval::MotionInterval {}
}

/// What contact classification asks of a number: the four operations, a square root, comparisons.
///
/// Sealed: f32, f64, [`Wide`], and what answers as that does. The comparison operators decide; for `Wide` they count what they could not decide.
/// [`Real::below`] is for choices that cannot change an answer.
pub trait Real:
    sealed::Sealed
    + CompiledContacts
    + Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// Zero.
    const ZERO: Self;

    /// Whether it is f32 or f64, which round to nearest and remember nothing.
    const IS_FLOAT: bool = false;

    /// The nearest number to `value`; exact in f64 and `Wide`.
    fn from_f64(value: f64) -> Self;

    /// The nearest number to an exact one (within one unit in the last place for `Wide`, which remembers that it
    /// rounded), or `None` if that overflows.
    fn from_number(number: &Number) -> Option<Self>;

    /// The number it is, exactly (of `Wide` the middle); `None` where it is none.
    fn to_number(self) -> Option<Number>;

    /// The nearest f64 (for `Wide` within one unit in the last place); keeps the sign unless it underflows.
    fn to_f64(self) -> f64;

    /// The square root. NaN below zero.
    #[must_use]
    fn sqrt(self) -> Self;

    /// The magnitude.
    #[must_use]
    fn abs(self) -> Self;

    /// The smaller of two numbers; never counted as a decision.
    #[must_use]
    fn smaller(self, other: Self) -> Self;

    /// The larger of two numbers; never counted as a decision.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// `self < other`, not counted as a decision: for culling with slack and for choosing between equivalent ways.
    fn below(self, other: Self) -> bool;

    /// Whether a length is more than nothing, or what is divided by it; not counted as a decision, except in `Wide` where rounding
    /// may have left nothing of it.
    fn is_positive(self) -> bool {
        Self::ZERO.below(self)
    }

    /// `self < other` for certain, not counted as a decision: of `Wide` both balls, of floats as [`Real::below`].
    fn surely_below(self, other: Self) -> bool;

    /// Whether what is below another cannot be told in all cases, and a choice of the larger must come to the same whichever is taken: else it is
    /// counted as a comparison that is left unsettled ([`Real::surely_below_uncounted`]).
    const DOUBTS_CHOICES: bool = false;

    /// [`Real::surely_below`] where that is counted.
    fn surely_below_uncounted(self, other: Self) -> bool {
        self.surely_below(other)
    }

    /// Counts a choice that depends on which of two numbers is the larger, of which that is not known.
    fn count_doubtful_choice() {}

    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// Whether two numbers are the same bits. `Wide` never says so.
    fn is_same(self, other: Self) -> bool;

    /// Whether what is being worked out is of no use any more, so that it may end early with any answer: see
    /// [`crate::wide::settled`]. Never so for floats.
    #[inline(always)]
    fn is_given_up() -> bool {
        false
    }

    /// Whether this contact is not asked for, since a few are asked alone. Never so for floats.
    #[inline(always)]
    fn leaves_out(_contact: ContactKey) -> bool {
        false
    }

    /// Whether exits are not asked for, likewise.
    #[inline(always)]
    fn leaves_exits_out() -> bool {
        false
    }
}

macro_rules! real_float {
    ($type:ty, $precision:expr, $from_f64:expr) => {
        impl Real for $type {
            const ZERO: Self = 0.0;
            const IS_FLOAT: bool = true;

            #[inline]
            fn from_f64(value: f64) -> Self {
                $from_f64(value)
            }
            #[inline]
            fn from_number(number: &Number) -> Option<Self> {
                number.rounded($precision).map($from_f64)
            }
            fn to_number(self) -> Option<Number> {
                Number::from_f64(f64::from(self)).ok()
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                <$type>::sqrt(self)
            }
            #[inline]
            fn abs(self) -> Self {
                <$type>::abs(self)
            }
            #[inline]
            fn smaller(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            #[inline]
            fn larger(self, other: Self) -> Self {
                if self < other { other } else { self }
            }
            #[inline]
            fn below(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn surely_below(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$type>::is_finite(self)
            }
            #[inline]
            fn is_same(self, other: Self) -> bool {
                self.to_bits() == other.to_bits()
            }
        }
    };
}

real_float!(f32, Precision::F32, |value: f64| value as f32);
real_float!(f64, Precision::F64, |value: f64| value);

impl Real for Wide {
    const ZERO: Self = Wide::EXACT_ZERO;

    fn from_f64(value: f64) -> Self {
        Wide::of_f64(value)
    }
    fn from_number(number: &Number) -> Option<Self> {
        Some(Wide::of_number(number))
    }
    fn to_number(self) -> Option<Number> {
        self.middle()
    }
    fn to_f64(self) -> f64 {
        self.nearest_f64()
    }
    fn sqrt(self) -> Self {
        self.root()
    }
    fn abs(self) -> Self {
        self.magnitude()
    }
    fn smaller(self, other: Self) -> Self {
        -(-self).maximum(-other)
    }
    fn larger(self, other: Self) -> Self {
        self.maximum(other)
    }
    fn below(self, other: Self) -> bool {
        self.middle_below(other)
    }
    fn is_positive(self) -> bool {
        self.middle_is_positive()
    }
    fn surely_below(self, other: Self) -> bool {
        self.surely_below(other)
    }
    fn is_finite(self) -> bool {
        self.is_known()
    }
    fn is_same(self, _: Self) -> bool {
        false
    }
    fn is_given_up() -> bool {
        crate::wide::is_given_up()
    }
}
