use rockproof_model::Ring;

/// A plain f64 whose error somebody else accounts for.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Approx(pub(crate) f64);

/// The smaller of two f64, one instruction: a second one that is no number is passed over, as [`f64::min`] does.
#[inline(always)]
pub(crate) fn smaller(first: f64, second: f64) -> f64 {
    if second < first { second } else { first }
}

/// The larger of two f64, likewise.
#[inline(always)]
pub(crate) fn larger(first: f64, second: f64) -> f64 {
    if second > first { second } else { first }
}

impl Ring for Approx {
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        Approx(f64::from(value))
    }
    #[inline(always)]
    fn plus(&self, other: &Self) -> Self {
        Approx(self.0 + other.0)
    }
    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        Approx(self.0 - other.0)
    }
    #[inline(always)]
    fn times(&self, other: &Self) -> Self {
        Approx(self.0 * other.0)
    }
    #[inline(always)]
    fn negated(&self) -> Self {
        Approx(-self.0)
    }
}
