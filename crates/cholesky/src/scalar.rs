//! The scalars of factors. What is done with them is compiled here, once each and with this crate's optimisation, however crates that call it are
//! compiled: kernels take a hundred times as long without it.

use crate::factor::{Fill, Singular, factor_panels};
use crate::pattern::Pattern;
use crate::substitution::{divide, divide_transposed, solve};
use crate::subtrees::Threads;
use num_traits::Float;

/// f32 or f64.
pub trait Scalar: Float + Send + Sync + private::Sealed {
    /// Cholesky's method, left-looking: each panel that is marked is filled, gathers what the earlier ones take from it, then is factored as
    /// a dense one.
    ///
    /// # Errors
    /// The first pivot that is not positive and finite.
    fn factor(
        pattern: &Pattern,
        values: &mut [Self],
        marked: &[bool],
        fill: &Fill<'_, Self>,
        threads: Threads,
    ) -> Result<(), Singular>;

    /// Solves in place by the values of a factor.
    fn substitute(pattern: &Pattern, values: &[Self], solution: &mut [Self], threads: Threads);

    /// The first half of it: `L⁻¹` times the right side.
    fn forward(pattern: &Pattern, values: &[Self], solution: &mut [Self]);

    /// The second half.
    fn backward(pattern: &Pattern, values: &[Self], solution: &mut [Self]);
}

mod private {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

macro_rules! scalar {
    ($type:ty) => {
        impl Scalar for $type {
            fn factor(
                pattern: &Pattern,
                values: &mut [Self],
                marked: &[bool],
                fill: &Fill<'_, Self>,
                threads: Threads,
            ) -> Result<(), Singular> {
                factor_panels(pattern, values, marked, fill, threads)
            }

            fn substitute(pattern: &Pattern, values: &[Self], solution: &mut [Self], threads: Threads) {
                solve(pattern, values, solution, threads);
            }

            fn forward(pattern: &Pattern, values: &[Self], solution: &mut [Self]) {
                divide(pattern, values, solution);
            }

            fn backward(pattern: &Pattern, values: &[Self], solution: &mut [Self]) {
                divide_transposed(pattern, values, solution);
            }
        }
    };
}

scalar!(f32);
scalar!(f64);
