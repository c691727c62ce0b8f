//! Iterative refinement with a rigorous bound of what is left.

use super::{BlockSparseSystem, Factor, eliminate, fraction_free};
use crate::field::{DoubleBall, Field, UpperBound, WideBall};
use crate::number::Ball;
use num_rational::BigRational;

/// A number type in which a certified system can be solved.
pub(crate) trait Solvable: Field {
    /// Encloses the solution; `None` where this type cannot.
    fn solve(system: &BlockSparseSystem<Self>, factor: Option<&Factor>, bits: u32) -> Option<Vec<Self>>;
}

impl Solvable for Ball {
    fn solve(system: &BlockSparseSystem<Self>, factor: Option<&Factor>, bits: u32) -> Option<Vec<Self>> {
        refine(&Assembled(system), factor?, None, bits)
    }
}

impl Solvable for WideBall {
    fn solve(system: &BlockSparseSystem<Self>, factor: Option<&Factor>, bits: u32) -> Option<Vec<Self>> {
        match factor {
            Some(factor) => refine(&Assembled(system), factor, None, bits),
            None => eliminate::eliminate(system),
        }
    }
}

impl Solvable for BigRational {
    fn solve(system: &BlockSparseSystem<Self>, _factor: Option<&Factor>, _bits: u32) -> Option<Vec<Self>> {
        fraction_free::solve(&system.dense(), &system.right)
    }
}

/// A system whose residual can be calculated: all that an error bound needs of it.
pub(crate) trait Residual<S> {
    /// The right side `F`: the residual of zero.
    fn right(&self) -> Vec<S>;
    /// `F − K·x`.
    fn residual(&self, x: &[S]) -> Vec<S>;
    /// The residual of `to` from that of `from`, less by K times the change, in cheaper numbers than those of the type: no less an enclosure, but not as
    /// close a one where the change is not small. `None` where no cheaper numbers serve.
    fn after_change(&self, _residual: &[S], _from_to: [&[S]; 2]) -> Option<Vec<S>> {
        None
    }
}

struct Assembled<'s, S>(&'s BlockSparseSystem<S>);

impl<S: Field> Residual<S> for Assembled<'_, S> {
    fn right(&self) -> Vec<S> {
        self.0.right.clone()
    }
    fn residual(&self, x: &[S]) -> Vec<S> {
        self.0.residual(x)
    }
}

/// What f64 knows of a system: a scaling D by powers of two, a proved bound, and a solver that proves nothing.
pub(crate) trait Support {
    /// The exponents of D.
    fn scale(&self) -> &[i32];
    /// Proved: no eigenvalue of `D·K·D` is below this, and it is above zero.
    fn least_eigenvalue(&self) -> f64;
    /// An approximate solution of `(D·K·D)·y = right`. Nothing is claimed about it.
    fn approximate(&self, right: Vec<f64>) -> Vec<f64>;
}

/// A ball whose middle can be corrected and whose radius can be set.
pub(crate) trait Correctable: Field {
    /// The middle of `self + correction · 2^exponent`, cut to the bits of the type: an exact number.
    fn corrected(&self, correction: f64, exponent: i64, bits: u32) -> Self;
    /// The ball with its radius larger by `more`.
    fn widened_by(&self, more: UpperBound) -> Self;
    /// At least the size of the middle.
    fn middle_size(&self) -> Option<UpperBound>;
    /// The middle over `2^exponent`, roughly.
    fn middle_over(&self, exponent: i64) -> f64;
}

impl Correctable for Ball {
    fn corrected(&self, correction: f64, exponent: i64, _bits: u32) -> Self {
        let half = (exponent / 2) as i32;
        let shifted = correction * 2f64.powi(half) * 2f64.powi(exponent as i32 - half);
        Ball { middle: self.middle + shifted, radius: 0.0 }
    }
    fn widened_by(&self, more: UpperBound) -> Self {
        Ball { middle: self.middle, radius: (self.radius + more.to_f64()) * (1.0 + 2.0 * f64::EPSILON) }
    }
    fn middle_size(&self) -> Option<UpperBound> {
        UpperBound::of_f64(self.middle.abs())
    }
    fn middle_over(&self, exponent: i64) -> f64 {
        let half = (exponent / 2) as i32;
        self.middle * 2f64.powi(-half) * 2f64.powi(half - exponent as i32)
    }
}

impl Correctable for DoubleBall {
    fn corrected(&self, correction: f64, exponent: i64, _bits: u32) -> Self {
        use rockproof_model::Ring;
        let half = (exponent / 2) as i32;
        let shifted = correction * 2f64.powi(half) * 2f64.powi(exponent as i32 - half);
        let shift = DoubleBall { high: shifted, low: 0.0, radius: 0.0 };
        DoubleBall { radius: 0.0, ..self.plus(&shift) }
    }
    fn widened_by(&self, more: UpperBound) -> Self {
        DoubleBall { radius: (self.radius + more.to_f64()) * (1.0 + 2.0 * f64::EPSILON), ..*self }
    }
    fn middle_size(&self) -> Option<UpperBound> {
        Some(UpperBound::of_f64(self.high.abs())?.plus(UpperBound::of_f64(self.low.abs())?))
    }
    fn middle_over(&self, exponent: i64) -> f64 {
        let half = (exponent / 2) as i32;
        self.high * 2f64.powi(-half) * 2f64.powi(half - exponent as i32)
    }
}

impl Correctable for WideBall {
    fn corrected(&self, correction: f64, exponent: i64, bits: u32) -> Self {
        use rockproof_model::Ring;
        let correction = if correction.is_finite() { correction } else { 0.0 };
        let shift = WideBall::exactly(1.into(), exponent, bits);
        self.plus(&WideBall::of_f64(correction, bits).times(&shift)).without_radius()
    }
    fn widened_by(&self, more: UpperBound) -> Self {
        self.widened(more)
    }
    fn middle_size(&self) -> Option<UpperBound> {
        Some(self.without_radius().size())
    }
    fn middle_over(&self, exponent: i64) -> f64 {
        self.scaled_f64(exponent)
    }
}

/// Residuals that are found one from another may be in doubt by a `2^-DOUBT_SHIFT`th more than the first, which is calculated by itself.
const DOUBT_SHIFT: i64 = 3;

/// What a residual says: the norms of its middles and of its radii, scaled by D.
struct Norms {
    middle: UpperBound,
    radius: UpperBound,
    /// The most that the radius of a residual may be that is found from this one.
    most_radius: UpperBound,
}

fn norms<S: Correctable>(residual: &[S], scale: &[i32]) -> Option<Norms> {
    let norm = |part: &dyn Fn(&S) -> Option<UpperBound>| {
        let mut sum = UpperBound::ZERO;
        for (value, &scale) in residual.iter().zip(scale) {
            let size = part(value)?.shifted(i64::from(scale));
            sum = sum.plus(size.times(size));
        }
        Some(sum.root())
    };
    let radius = norm(&S::radius)?;
    let most_radius = radius.plus(radius.shifted(-DOUBT_SHIFT));
    Some(Norms { middle: norm(&S::middle_size)?, radius, most_radius })
}

/// The residual of a corrected solution, and what it says: from that before the correction where this adds little to its doubt.
fn next_residual<S: Correctable>(
    system: &dyn Residual<S>,
    (x, residual, norm): (&[S], &[S], &Norms),
    better: &[S],
    scale: &[i32],
) -> Option<(Vec<S>, Norms)> {
    let close = system.after_change(residual, [x, better]).and_then(|next| {
        let next_norm = Norms { most_radius: norm.most_radius, ..norms(&next, scale)? };
        (next_norm.radius <= norm.most_radius).then_some((next, next_norm))
    });
    close.or_else(|| {
        let next = system.residual(better);
        let next_norm = norms(&next, scale)?;
        Some((next, next_norm))
    })
}

/// Encloses the solution: corrects it until the residual is as small as its own doubt, then adds the bound
/// `‖D·r‖ / λ` to every unknown. It begins with numbers without radius that are thought to be near the solution, or with zeros.
pub(crate) fn refine<S: Correctable>(
    system: &dyn Residual<S>,
    support: &dyn Support,
    start: Option<Vec<S>>,
    bits: u32,
) -> Option<Vec<S>> {
    let scale = support.scale();
    if scale.is_empty() {
        // Nothing to solve: no eigenvalue either, whose bound would be infinite.
        return Some(Vec::new());
    }
    let with_norm = |x: Vec<S>, residual: Vec<S>| {
        let norm = norms(&residual, scale)?;
        Some((x, residual, norm))
    };
    let begun = start.and_then(|x| {
        let residual = system.residual(&x);
        with_norm(x, residual)
    });
    let zeros = || with_norm(vec![S::from_i32(0); scale.len()], system.right());
    let (mut x, mut residual, mut norm) = begun.or_else(zeros)?;
    let most_passes = 3 + bits / 8;
    for _ in 0..most_passes {
        if norm.middle <= norm.radius {
            break;
        }
        let Some(top) = norm.middle.top() else { break };
        let right = residual.iter().zip(scale).map(|(r, &s)| r.middle_over(top - i64::from(s))).collect();
        let better: Vec<S> = support
            .approximate(right)
            .into_iter()
            .zip(&x)
            .zip(scale)
            .map(|((correction, x), &s)| x.corrected(correction, top + i64::from(s), bits))
            .collect();
        let Some((next, next_norm)) = next_residual(system, (&x, &residual, &norm), &better, scale) else { break };
        let helped = next_norm.middle.plus(next_norm.radius) < norm.middle.plus(norm.radius);
        // A pass that does not halve the residual will not do better the next time.
        let slow = next_norm.middle.shifted(1) > norm.middle;
        if helped {
            (x, residual, norm) = (better, next, next_norm);
        }
        if slow || !helped {
            break;
        }
    }
    let least = UpperBound::floor_of_f64(support.least_eigenvalue())?;
    let bound = norm.middle.plus(norm.radius).over(least)?;
    Some(x.iter().zip(scale).map(|(x, &s)| x.widened_by(bound.shifted(i64::from(s)))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::Signed;
    use rockproof_model::Ring;
    use std::cell::Cell;

    /// The radius after the widening holds the old one and what was added, and little more.
    fn widens<S: Correctable>(ball: &S, more: i64) {
        let more = UpperBound::power_of_two(more);
        let before = ball.radius().unwrap().to_rational() + more.to_rational();
        let widened = ball.widened_by(more);
        let after = widened.radius().unwrap().to_rational();
        assert!(after >= before, "{after} for {before}");
        let most = &before + &before / num_bigint::BigInt::from(1 << 20);
        assert!(after <= most, "{after} for {before}");
        assert_eq!(widened.middle(), ball.middle());
    }

    /// `3·x = 1` in 128 bits, and what its solution asks for.
    struct Third {
        /// The doubt that a residual found from the one before gets.
        more: UpperBound,
        whole: Cell<u32>,
        close: Cell<u32>,
    }

    impl Residual<WideBall> for Third {
        fn right(&self) -> Vec<WideBall> {
            vec![WideBall::of_f64(1.0, 128).widened(UpperBound::power_of_two(-124))]
        }
        fn residual(&self, x: &[WideBall]) -> Vec<WideBall> {
            self.whole.set(self.whole.get() + 1);
            vec![self.right()[0].minus(&x[0].times(&WideBall::from_i32(3)))]
        }
        fn after_change(&self, residual: &[WideBall], [from, to]: [&[WideBall]; 2]) -> Option<Vec<WideBall>> {
            self.close.set(self.close.get() + 1);
            let change = to[0].minus(&from[0]).times(&WideBall::from_i32(3));
            Some(vec![residual[0].minus(&change).widened(self.more)])
        }
    }

    impl Support for Third {
        fn scale(&self) -> &[i32] {
            &[0]
        }
        fn least_eigenvalue(&self) -> f64 {
            3.0
        }
        fn approximate(&self, right: Vec<f64>) -> Vec<f64> {
            // Not quite, so that it takes some passes.
            vec![right[0] * (1.0 / 3.0 + 1e-6)]
        }
    }

    #[test]
    fn a_residual_is_found_from_the_one_before_where_that_adds_little_doubt() {
        for more in [-124, -126, -127, -200] {
            let third = Third { more: UpperBound::power_of_two(more), whole: Cell::new(0), close: Cell::new(0) };
            let start = Some(vec![WideBall::of_f64(0.3, 128)]);
            let x = refine(&third, &third, start, 128).expect("a solution");
            let passes = third.close.get();
            assert!(passes > 3, "{passes} passes with 2^{more}");
            let by_itself = match more {
                -200 => 0,
                // An eighth of the doubt is added once, and not once more.
                -127 => passes / 2,
                _ => passes,
            };
            assert_eq!(third.whole.get(), 1 + by_itself, "2^{more}, {passes} passes");
            let off = (x[0].middle() - BigRational::new(1.into(), 3.into())).abs();
            let radius = x[0].radius().expect("a radius").to_rational();
            assert!(
                off <= radius && radius < BigRational::new(1.into(), num_bigint::BigInt::from(1) << 122),
                "{radius}"
            );
        }
    }

    #[test]
    fn a_ball_that_is_widened_has_the_sum_of_both_radii() {
        for radius in [0.0, 2f64.powi(-80), 1.0] {
            for more in [-140, -81, -80, -79, -60, 3] {
                widens(&Ball { middle: 1.0, radius }, more);
                widens(&DoubleBall { high: 1.0, low: 2f64.powi(-60), radius }, more);
                let exactly = WideBall::exactly(1.into(), 0, 128);
                let wide = UpperBound::of_f64(radius).unwrap();
                widens(&if wide.is_zero() { exactly } else { exactly.widened(wide) }, more);
            }
        }
    }
}
