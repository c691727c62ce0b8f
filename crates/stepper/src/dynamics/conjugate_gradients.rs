//! Solving a large system in f64 by conjugate gradients: preconditioned by a factor in f32, or without a factor (`two_level.rs`).
//!
//! A factor in f32 takes half the memory and half the time of one in f64. It is a good one as long as the system's condition, blocks scaled alike, is
//! below 10⁷; else there is none, or the iteration does not end, and a factor in f64 takes its place. The matrix is not kept: it is multiplied
//! contact by contact. A factor of the solve before is often good enough for the next one.

use crate::dynamics::pattern::Pattern;
use crate::dynamics::products::Products;
use crate::dynamics::solve::Solve;

/// The iteration ends when the residual, measured by the preconditioner M (rᵀM⁻¹r, a square), has come down to this share of the right side's.
const RESIDUAL_SHARE: f64 = 1e-28;

/// A factor of so many values for each unknown takes more memory, in f32, than all else that a step needs.
const LARGE_FACTOR: usize = 500;

/// A symmetric positive definite matrix that is near the system's, of which the inverse is easy to apply.
pub(super) trait Preconditioner<R> {
    /// Its inverse times a residual; none where it cannot be told. Numbers may overflow.
    fn precondition(&self, residual: &[R]) -> Option<Vec<R>>;
}

/// A factor in f32.
pub(super) struct FactorInF32<'f> {
    pub(super) pattern: &'f Pattern,
    pub(super) values: &'f [f32],
}

impl<R: Solve> Preconditioner<R> for FactorInF32<'_> {
    fn precondition(&self, residual: &[R]) -> Option<Vec<R>> {
        let mut single: Vec<f32> = residual.iter().map(|x| x.to_f64() as f32).collect();
        f32::substitute(self.pattern, self.values, &mut single).ok()?;
        Some(single.into_iter().map(|x| R::from_f64(f64::from(x))).collect())
    }
}

/// When an iteration is given up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// After so many products.
    most: u32,
    /// After so many it can be told how many there will be; none where that is not asked.
    telling: Option<u32>,
}

impl Patience {
    /// Else a factor of the present matrix is no good.
    pub(super) const NEW_FACTOR: Patience = Patience { most: 40, telling: None };
    /// More products would take longer than a new factor.
    pub(super) const OLD_FACTOR: Patience = Patience { most: 8, telling: Some(2) };
    /// Where memory counts, a factor is the last resort.
    pub(super) const WITHOUT_FACTOR: Patience = Patience { most: 5_000, telling: None };

    /// As many products as take about the time of a factor in f32 and its solution, by so many closed contacts. Twice as many where the factor
    /// takes more memory than all else: what is made for a single attempt counts for the peak, and once Δt is short there are fewer products.
    pub(super) fn instead_of_factor(pattern: &Pattern, contacts: usize) -> Patience {
        let products = 45 + pattern.work() / (16_000 * contacts.max(1) as u64);
        let is_large = pattern.values() >= LARGE_FACTOR * pattern.size();
        let (products, telling) = if is_large { (2 * products, 24) } else { (products, 6) };
        Patience { most: u32::try_from(products).unwrap_or(u32::MAX), telling: Some(telling) }
    }

    /// Whether it can suffice where springs are so many times as stiff as inertia. Preconditioned by blocks alone the system's condition is about
    /// this, and each product takes a factor of about exp(−2/√κ) off an error that is to fall by 10¹⁴; a coarse level needs some hundred at most.
    pub(super) fn can_suffice(self, springs_to_inertia: f64) -> bool {
        let (products_per_root, coarse_level) = (16.0, 100);
        self.most >= coarse_level || products_per_root * (1.0 + springs_to_inertia).sqrt() <= f64::from(self.most)
    }
}

/// Conjugate gradients for a system.
pub(super) struct ConjugateGradients<'r, 'p, 's, R> {
    pub(super) products: &'r Products<'p, 's, R>,
    pub(super) preconditioner: &'r dyn Preconditioner<R>,
}

impl<R: Solve> ConjugateGradients<'_, '_, '_, R> {
    /// The solution, if the iteration ends. It begins with a solution `before` if there is one, of an earlier matrix, and ends by the same measure, so it
    /// is as exact.
    pub(super) fn solve(&self, force: &[R], before: Option<&[R]>, patience: Patience) -> Option<Vec<R>> {
        let direction = self.preconditioner.precondition(force)?;
        let measure = dot(force, &direction);
        if !measure.is_finite() || measure.below(R::ZERO) {
            return None;
        }
        let begin = match before {
            None => {
                let solution = vec![R::ZERO; force.len()];
                Iterate { solution, residual: force.to_vec(), direction, left: measure }
            }
            Some(before) => {
                let product = self.products.times(before);
                let residual: Vec<R> = force.iter().zip(&product).map(|(&f, &y)| f - y).collect();
                let direction = self.preconditioner.precondition(&residual)?;
                let left = dot(&residual, &direction);
                Iterate { solution: before.to_vec(), residual, direction, left }
            }
        };
        self.iterate(begin, measure * R::from_f64(RESIDUAL_SHARE), patience)
    }

    fn iterate(&self, begin: Iterate<R>, enough: R, patience: Patience) -> Option<Vec<R>> {
        let Iterate { mut solution, mut residual, mut direction, mut left } = begin;
        let first = left.to_f64();
        for products in 0..=patience.most {
            // Below zero rounding has made of the preconditioner what is none.
            if !left.is_finite() || left.below(R::ZERO) {
                return None;
            }
            if !enough.below(left) {
                return Some(solution);
            }
            if patience.telling.is_some_and(|telling| products >= telling) {
                // As many decades with each product as so far.
                let (done, all) = ((first / left.to_f64()).ln(), (first / enough.to_f64()).ln());
                if f64::from(products) * all > f64::from(patience.most) * done {
                    return None;
                }
            }
            let product = self.products.times(&direction);
            let step = left / dot(&direction, &product);
            for (x, &p) in solution.iter_mut().zip(&direction) {
                *x = *x + step * p;
            }
            // A preconditioner that rounds is not the same linear map each time: the change of the residual enters, not the residual alone.
            for (r, &y) in residual.iter_mut().zip(&product) {
                *r = *r - step * y;
            }
            let next = self.preconditioner.precondition(&residual)?;
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
    /// The residual, measured by the preconditioner.
    left: R,
}

/// Sums that run beside one another in a scalar product: the processor need not wait for one to be finished.
const STRANDS: usize = 8;

fn dot<R: Solve>(a: &[R], b: &[R]) -> R {
    let ((a, rest), (b, other)) = (a.as_chunks::<STRANDS>(), b.as_chunks::<STRANDS>());
    let mut strands = [R::ZERO; STRANDS];
    for (a, b) in a.iter().zip(b) {
        for (strand, (&a, &b)) in strands.iter_mut().zip(a.iter().zip(b)) {
            *strand = *strand + a * b;
        }
    }
    let rest = rest.iter().zip(other).fold(R::ZERO, |sum, (&a, &b)| sum + a * b);
    strands.into_iter().fold(rest, |sum, strand| sum + strand)
}
