//! Solving a very large system in f64 by a factor in f32: conjugate gradients, preconditioned by it.
//!
//! The factor takes half the memory and half the time. It is a good one as long as the system's condition, blocks scaled alike, is below
//! 10⁷; else there is none, or the iteration does not end, and a factor in f64 takes its place. The matrix is not kept: it is multiplied
//! contact by contact. A factor of the solve before is often good enough for the next one.

use crate::dynamics::products::Products;
use crate::dynamics::solve::Solve;

/// The iteration ends when the residual, measured by the factor (rᵀ(LLᵀ)⁻¹r, a square), has come down to this share of the right side's.
const RESIDUAL_SHARE: f64 = 1e-28;

/// After so many products a factor of the present matrix is no good.
const MAX_PRODUCTS: u32 = 40;

/// A factor of an earlier matrix must do with so many, which take less than a new factor.
const MAX_PRODUCTS_OF_OLD_FACTOR: u32 = 8;

/// After so many products it can be told how many there will be.
const TELLING: u32 = 2;

/// Conjugate gradients for a system, preconditioned by a factor in f32.
pub(super) struct CorrectedSystem<'r, 'p, 's, R> {
    pub(super) products: &'r Products<'p, 's, R>,
    pub(super) factor: &'r [f32],
}

impl<R: Solve> CorrectedSystem<'_, '_, '_, R> {
    /// The solution, if the iteration ends. `before` is that of an earlier matrix, whose factor it then is: the iteration begins with it, and
    /// is given up when it will not end soon. It ends by the same measure, so it is as exact.
    pub(super) fn solve(&self, force: &[R], before: Option<&[R]>) -> Option<Vec<R>> {
        let direction = self.precondition(force)?;
        let measure = dot(force, &direction);
        let begin = match before {
            None => {
                let solution = vec![R::ZERO; force.len()];
                Iterate { solution, residual: force.to_vec(), direction, left: measure }
            }
            Some(before) => {
                let product = self.products.times(before);
                let residual: Vec<R> = force.iter().zip(&product).map(|(&f, &y)| f - y).collect();
                let direction = self.precondition(&residual)?;
                let left = dot(&residual, &direction);
                Iterate { solution: before.to_vec(), residual, direction, left }
            }
        };
        let most = if before.is_some() { MAX_PRODUCTS_OF_OLD_FACTOR } else { MAX_PRODUCTS };
        self.iterate(begin, measure * R::from_f64(RESIDUAL_SHARE), most, before.is_some())
    }

    fn precondition(&self, residual: &[R]) -> Option<Vec<R>> {
        let mut single: Vec<f32> = residual.iter().map(|x| x.to_f64() as f32).collect();
        f32::substitute(&self.products.system.layout.pattern, self.factor, &mut single).ok()?;
        Some(single.into_iter().map(|x| R::from_f64(f64::from(x))).collect())
    }

    fn iterate(&self, begin: Iterate<R>, enough: R, most: u32, impatient: bool) -> Option<Vec<R>> {
        let Iterate { mut solution, mut residual, mut direction, mut left } = begin;
        let first = left.to_f64();
        for products in 0..=most {
            if !left.is_finite() {
                return None;
            }
            if !enough.below(left) {
                return Some(solution);
            }
            if impatient && products >= TELLING {
                // As many decades with each product as so far.
                let (done, all) = ((first / left.to_f64()).ln(), (first / enough.to_f64()).ln());
                if f64::from(products) * all > f64::from(most) * done {
                    return None;
                }
            }
            let product = self.products.times(&direction);
            let step = left / dot(&direction, &product);
            for (x, &p) in solution.iter_mut().zip(&direction) {
                *x = *x + step * p;
            }
            // A factor that is rounded is not the same linear map each time: the change of the residual enters, not the residual alone.
            for (r, &y) in residual.iter_mut().zip(&product) {
                *r = *r - step * y;
            }
            let next = self.precondition(&residual)?;
            let against = dot(&next, &product) * step;
            let now = dot(&residual, &next);
            let share = -against / left;
            for (p, &z) in direction.iter_mut().zip(&next) {
                *p = z + share * *p;
            }
            left = now;
        }
        None
    }
}

/// Where an iteration stands.
struct Iterate<R> {
    solution: Vec<R>,
    residual: Vec<R>,
    direction: Vec<R>,
    /// The residual, measured by the factor.
    left: R,
}

fn dot<R: Solve>(a: &[R], b: &[R]) -> R {
    a.iter().zip(b).fold(R::ZERO, |sum, (&a, &b)| sum + a * b)
}
