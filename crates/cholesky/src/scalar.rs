//! The scalars of factors. What is done with them is compiled here, once each and with this crate's optimisation, however crates that call it are
//! compiled: kernels take a hundred times as long without it.

use crate::factor::{Fill, Singular, factor_panels};
use crate::pattern::Pattern;
use crate::substitution::{divide, divide_transposed, solve};
use crate::subtrees::Threads;
use num_traits::Float;

/// f32 or f64. The functions are those of the crate with these names.
pub trait Scalar: Float + Send + Sync + private::Sealed {
    #[doc(hidden)]
    fn factor(
        pattern: &Pattern,
        values: &mut [Self],
        marked: &[bool],
        fill: &Fill<'_, Self>,
        threads: Threads,
    ) -> Result<(), Singular>;
    #[doc(hidden)]
    fn substitute(pattern: &Pattern, values: &[Self], solution: &mut [Self], threads: Threads);
    #[doc(hidden)]
    fn forward(pattern: &Pattern, values: &[Self], solution: &mut [Self]);
    #[doc(hidden)]
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

/// Cholesky's method, left-looking: each panel that is marked is filled, gathers what the earlier ones take from it, then is factored as
/// a dense one.
///
/// # Errors
/// The first pivot that is not positive and finite.
pub fn factor<R: Scalar>(
    pattern: &Pattern,
    values: &mut [R],
    marked: &[bool],
    fill: &Fill<'_, R>,
    threads: Threads,
) -> Result<(), Singular> {
    R::factor(pattern, values, marked, fill, threads)
}

/// Solves in place by the values of a factor.
pub fn substitute<R: Scalar>(pattern: &Pattern, values: &[R], solution: &mut [R], threads: Threads) {
    R::substitute(pattern, values, solution, threads);
}

/// The first half of it: `L⁻¹` times the right side.
pub fn forward<R: Scalar>(pattern: &Pattern, values: &[R], solution: &mut [R]) {
    R::forward(pattern, values, solution);
}

/// The second half.
pub fn backward<R: Scalar>(pattern: &Pattern, values: &[R], solution: &mut [R]) {
    R::backward(pattern, values, solution);
}
