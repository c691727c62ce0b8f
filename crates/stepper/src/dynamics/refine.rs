//! Solving a large system in f64 by a factor in f32: conjugate gradients, preconditioned by it.
//!
//! The factor takes half the memory and half the time. It is a good one as long as the system's condition, blocks scaled alike, is below
//! 10⁷; else there is none, or the iteration does not end, and a factor in f64 takes its place. The matrix is not kept: it is multiplied
//! contact by contact.

use crate::dynamics::assembly::System;
use crate::dynamics::layout::IslandLayout;
use crate::dynamics::solve::Solve;

/// The iteration ends when the residual, measured by the factor (rᵀ(LLᵀ)⁻¹r, a square), has come down to this share of the right side's.
const ENOUGH: f64 = 1e-28;

/// After so many products the factor is no good.
const MOST: u32 = 40;

/// The solution by a factor in f32, if the iteration ends.
pub(super) fn refined<R: Solve>(
    system: &System<'_, R>,
    layout: &IslandLayout,
    factor: &[f32],
    force: &[R],
) -> Option<Vec<R>> {
    let precondition = |residual: &[R]| -> Option<Vec<R>> {
        let mut single: Vec<f32> = residual.iter().map(|x| x.to_f64() as f32).collect();
        f32::substitute(&layout.pattern, factor, &mut single).ok()?;
        Some(single.into_iter().map(|x| R::from_f64(f64::from(x))).collect())
    };
    let dot = |a: &[R], b: &[R]| a.iter().zip(b).fold(R::ZERO, |sum, (&a, &b)| sum + a * b);
    let mut solution = vec![R::ZERO; force.len()];
    let mut residual = force.to_vec();
    let mut direction = precondition(&residual)?;
    let mut left = dot(&residual, &direction);
    let enough = left * R::from_f64(ENOUGH);
    for _ in 0..MOST {
        if !left.is_finite() {
            return None;
        }
        if !enough.below(left) {
            return Some(solution);
        }
        let product = system.times(&direction);
        let step = left / dot(&direction, &product);
        for (x, &p) in solution.iter_mut().zip(&direction) {
            *x = *x + step * p;
        }
        // A factor that is rounded is not the same linear map each time: the change of the residual enters, not the residual alone.
        for (r, &y) in residual.iter_mut().zip(&product) {
            *r = *r - step * y;
        }
        let next = precondition(&residual)?;
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
