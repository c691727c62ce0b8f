//! Taking a pair off its ties: B perturbed by some steps of f32, so that what tied is a near-tie in f32 and plain in f64.

use super::directed::f64_view::{length, minus, quantum};
use super::families::PairSampler;
use rockproof_model::number::{power_of_two, split_f64};
use rockproof_model::{Block, Number, Point, Precision, Vec3};

/// `block` under `x ↦ x + t + M·(x − x₀)`, x₀ its first vertex, with random t and M that move no vertex by more than
/// some tens of f32 steps at `magnitude` (the pair's largest coordinate, m). Exact and affine: planes stay planes and
/// convexity stays; distances, directions and planes that the block shared with another part.
pub(crate) fn perturbed(sampler: &mut PairSampler<'_>, block: &Block, magnitude: f64) -> Block {
    let step = quantum(magnitude, Precision::F32);
    let origin = &block.vertices()[0];
    let near = |p: &Point| p.components().map(|c| c.approximate());
    let size = block.vertices().iter().map(|p| length(minus(near(p), near(origin)))).fold(0.0, f64::max);
    // Parts of t and M in sixty-fourths of a step, those of M per size of the block; odd, so that none is zero.
    let part = |sampler: &mut PairSampler<'_>, reach: i128| (2 * sampler.between(-reach, reach - 1) + 1) as f64 / 64.0;
    let reach = 1 << sampler.between(5, 9);
    let number = |value: f64| Number::from_f64(value).unwrap_or(Number::ZERO);
    let shift = [(); 3].map(|()| number(part(sampler, reach) * step));
    // Far from the origin a step may be as large as the block: it is not to be turned inside out.
    let share = (step / binary_above(size)).min(power_of_two(-12));
    let matrix = [(); 3].map(|()| [(); 3].map(|()| number(part(sampler, reach) * share)));
    let moved = |p: &Point| {
        let from = [&p.x, &p.y, &p.z].into_iter().zip([&origin.x, &origin.y, &origin.z]);
        let from: Vec<Number> = from.map(|(c, o)| c.plus(&o.negated())).collect();
        let part = |row: usize, c: &Number| {
            let turned = matrix[row].iter().zip(&from).map(|(m, f)| m.times(f));
            turned.fold(c.plus(&shift[row]), |sum, term| sum.plus(&term))
        };
        Vec3::new(part(0, &p.x), part(1, &p.y), part(2, &p.z))
    };
    block.with_vertices(block.vertices().iter().map(moved).collect())
}

/// A power of two at or above `value`, which must be positive; at most twice as large.
fn binary_above(value: f64) -> f64 {
    let (significand, exponent) = split_f64(value);
    power_of_two((exponent + 64 - significand.unsigned_abs().max(1).leading_zeros() as i32).clamp(-1000, 1000))
}
