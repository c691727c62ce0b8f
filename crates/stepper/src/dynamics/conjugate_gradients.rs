//! Solving a large system in f64 by conjugate gradients: preconditioned by a factor in f32, or without a factor (`two_level.rs`).
//!
//! A factor in f32 takes half the memory and half the time of one in f64. It is a good one as long as the system's condition, blocks scaled alike, is
//! below 10⁷; else there is none, or the iteration does not end, and a factor in f64 takes its place. The matrix is not kept: it is multiplied
//! contact by contact. A factor of the solve before is often good enough for the next one.

use crate::dynamics::products::Products;
use crate::dynamics::solve::Solve;
use rockproof_cholesky::{Pattern, Scalar};

/// The iteration ends when the residual, measured by the preconditioner M (rᵀM⁻¹r, a square), has come down to this share of the right side's.
const RESIDUAL_SHARE: f64 = 1e-28;

/// A factor of so many values for each unknown takes more memory, in f32, than all else that a step needs.
const LARGE_FACTOR: usize = 500;

/// A symmetric positive definite matrix M that is near the system's, of which the inverse is easy to apply.
pub(super) trait Preconditioner<R> {
    /// Measures a residual r; none where it cannot be told. Numbers may overflow.
    fn measure(&self, residual: &[R]) -> Option<Measured<'_, R>>;
}

/// The measure of a residual r by a preconditioner M.
pub(super) struct Measured<'m, R> {
    /// rᵀM⁻¹r.
    pub(super) square: R,
    /// Calculates M⁻¹r, or the rest of it: the last residual of an iteration is only measured.
    pub(super) direction: Box<dyn FnOnce() -> Vec<R> + 'm>,
}

/// A factor in f32. To measure a residual takes half of the work: L⁻¹r, where M is LLᵀ.
pub(super) struct FactorInF32<'f> {
    pub(super) pattern: &'f Pattern,
    pub(super) values: &'f [f32],
}

impl<R: Solve> Preconditioner<R> for FactorInF32<'_> {
    fn measure(&self, residual: &[R]) -> Option<Measured<'_, R>> {
        let mut single: Vec<f32> = residual.iter().map(|x| x.to_f64() as f32).collect();
        Scalar::forward(self.pattern, self.values, &mut single);
        let square = single.iter().fold(0.0, |sum, &x| sum + f64::from(x) * f64::from(x));
        let direction = Box::new(move || {
            Scalar::backward(self.pattern, self.values, &mut single);
            single.into_iter().map(|x| R::from_f64(f64::from(x))).collect()
        });
        Some(Measured { square: R::from_f64(square), direction })
    }
}

/// Where the springs of so many contacts have changed, a factor of before often suffices.
const FEW_CONTACTS: usize = 4;

/// When an iteration is given up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// After so many products.
    most: u32,
    /// After so many it can be told how many there will be; none where that is not asked.
    telling: Option<u32>,
    /// Not begun where the measure of the first residual, a square, is more times what is enough.
    farthest: f64,
    /// Whether it begins without the solution before where zero is nearer.
    or_from_zero: bool,
}

impl Patience {
    /// Else a factor of the present matrix is no good.
    pub(super) const NEW_FACTOR: Patience =
        Patience { most: 40, telling: None, farthest: f64::INFINITY, or_from_zero: true };
    /// More products would take longer than a new factor. Each takes one to two decades off the measure.
    pub(super) const OLD_FACTOR: Patience = Patience { most: 8, telling: Some(2), farthest: 1e12, or_from_zero: false };
    /// Where memory counts, a factor is the last resort.
    pub(super) const WITHOUT_FACTOR: Patience =
        Patience { most: 5_000, telling: None, farthest: f64::INFINITY, or_from_zero: false };

    /// As [`Patience::OLD_FACTOR`] where springs have changed at so many contacts since the solve before: few of them take few products, from as far off
    /// as the right side itself. From farther off the roundoffs of that size would stay in the solution, unseen by a residual that is carried on.
    pub(super) fn old_factor(news: usize) -> Patience {
        let farthest = if news <= FEW_CONTACTS { 1.0 / RESIDUAL_SHARE } else { Patience::OLD_FACTOR.farthest };
        Patience { farthest, ..Patience::OLD_FACTOR }
    }

    /// As many products as take about the time of a factor in f32 and its solution, by so many closed contacts. Twice as many where the factor
    /// takes more memory than all else: what is made for a single attempt counts for the peak, and once Δt is short there are fewer products.
    pub(super) fn instead_of_factor(pattern: &Pattern, contacts: usize) -> Patience {
        let products = 45 + pattern.work() / (16_000 * contacts.max(1) as u64);
        let is_large = pattern.values() >= LARGE_FACTOR * pattern.size();
        let (products, telling) = if is_large { (2 * products, 24) } else { (products, 6) };
        let most = u32::try_from(products).unwrap_or(u32::MAX);
        Patience { most, telling: Some(telling), ..Patience::WITHOUT_FACTOR }
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
    /// The solution, if the iteration ends. It begins with a solution `before` if there is one, of an earlier matrix, and ends by the same measure: as exact
    /// where `before` is no farther off than zero.
    pub(super) fn solve(&self, force: &[R], before: Option<&[R]>, patience: Patience) -> Option<Vec<R>> {
        let whole = self.preconditioner.measure(force)?;
        if !whole.square.is_finite() || whole.square.below(R::ZERO) {
            return None;
        }
        let enough = whole.square * R::from_f64(RESIDUAL_SHARE);
        if let Some(before) = before {
            let product = self.products.times(before);
            let residual: Vec<R> = force.iter().zip(&product).map(|(&f, &y)| f - y).collect();
            let measured = self.preconditioner.measure(&residual)?;
            // A number that is none is not below.
            if !patience.or_from_zero || measured.square.below(whole.square) {
                if measured.square.to_f64() > patience.farthest * enough.to_f64() {
                    return None;
                }
                // It holds a vector that is not needed any more.
                drop(whole);
                return self.iterate(Iterate { solution: before.to_vec(), residual, measured }, enough, patience);
            }
        }
        let solution = vec![R::ZERO; force.len()];
        self.iterate(Iterate { solution, residual: force.to_vec(), measured: whole }, enough, patience)
    }

    fn iterate(&self, begin: Iterate<'_, R>, enough: R, patience: Patience) -> Option<Vec<R>> {
        let Iterate { mut solution, mut residual, mut measured } = begin;
        let first = measured.square.to_f64();
        let mut last: Option<LastProduct<R>> = None;
        for products in 0..=patience.most {
            // Below zero rounding has made of the preconditioner what is none.
            let usable = |square: R| square.is_finite() && !square.below(R::ZERO);
            if !usable(measured.square) {
                return None;
            }
            if !enough.below(measured.square) {
                return Some(solution);
            }
            if patience.telling.is_some_and(|telling| products >= telling) {
                // As many decades with each product as so far.
                let (done, all) = ((first / measured.square.to_f64()).ln(), (first / enough.to_f64()).ln());
                if f64::from(products) * all > f64::from(patience.most) * done {
                    return None;
                }
            }
            let mut direction = (measured.direction)();
            let left = dot(&residual, &direction);
            if !usable(left) {
                return None;
            }
            if let Some(LastProduct { direction: before, product, step, left }) = last.take() {
                // A preconditioner that rounds is not the same linear map each time: the change of the residual enters, not the residual alone.
                let against = dot(&direction, &product) * step;
                let share = -against / left;
                for (z, &p) in direction.iter_mut().zip(&before) {
                    *z = *z + share * p;
                }
            }
            let product = self.products.times(&direction);
            let step = left / dot(&direction, &product);
            for (x, &p) in solution.iter_mut().zip(&direction) {
                *x = *x + step * p;
            }
            for (r, &y) in residual.iter_mut().zip(&product) {
                *r = *r - step * y;
            }
            measured = self.preconditioner.measure(&residual)?;
            last = Some(LastProduct { direction, product, step, left });
        }
        None
    }
}

/// Where an iteration begins.
struct Iterate<'m, R> {
    solution: Vec<R>,
    residual: Vec<R>,
    measured: Measured<'m, R>,
}

/// A direction, the matrix times it, and how far the solution went along it.
struct LastProduct<R> {
    direction: Vec<R>,
    product: Vec<R>,
    step: R,
    /// rᵀM⁻¹r of the residual before.
    left: R,
}

/// Sums that run beside one another in a scalar product: the processor need not wait for one to be finished.
const STRANDS: usize = 8;

pub(super) fn dot<R: Solve>(a: &[R], b: &[R]) -> R {
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
