//! Generic pairs: those of the families, turned and moved until no coincidence is left.

use crate::families::{self, CoordinateStyle, Family, PairSampler};
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind, Number, Vec3};
use std::sync::Arc;

/// Pairs of the families of ordinary size, each block turned by a matrix with random last bits, B moved by random last
/// bits.
///
/// A block on a coarse grid is multiplied by a rotation rounded to as many binary digits as an f64 leaves room for: every
/// coordinate is an f64 with 50 to 53 significant bits, faces stay exactly planar (the map is linear), and the two blocks
/// have no direction in common. **No exact tie by construction**: a decision about both blocks is a polynomial in random
/// bits, zero with a chance of about 2⁻⁵⁰. Two kinds of coincidence stay: what a block decides within itself (parallel faces of
/// a box), and a gap compared with itself, which ties where ε is 0.
#[derive(Clone, Debug)]
pub struct Generic {
    families: Vec<Arc<dyn Family>>,
}

/// The families not used: they are about extreme sizes and places, or their coordinates are not on a coarse grid.
const LEFT_OUT: [&str; 4] = ["far_origin", "unit_scale", "joint_cut", "real"];

/// Binary digits after the point of the grid.
const GRID_DIGITS: i32 = 14;

/// Largest grid coordinate, relative to the pivot.
const GRID_LIMIT: i64 = 1 << 24;

/// Significant bits of the largest sum of three products, in a row of the turned coordinates.
const SUM_DIGITS: u32 = 51;

/// Draws before giving up on the families and taking the pair as it comes.
const TRIES: usize = 1000;

type Units = Vec<[i64; 3]>;

impl Default for Generic {
    fn default() -> Self {
        let mut families = families::all();
        families.retain(|family| !LEFT_OUT.contains(&family.name()));
        Generic { families }
    }
}

impl Family for Generic {
    fn name(&self) -> &'static str {
        "generic"
    }

    fn describe(&self) -> &'static str {
        "Pairs of the other families, turned and moved at random until no tie is left."
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        for _ in 0..TRIES {
            let number = PairSampler::with_style(rng, CoordinateStyle::Grid).below(self.families.len() as u64);
            let (a, b) = self.families[number as usize].generate(rng);
            if let (Some(at_a), Some(at_b)) = (grid_units(&a), grid_units(&b))
                && let Some(turned) =
                    turned(&mut PairSampler::with_style(rng, CoordinateStyle::Grid), (&a, at_a), (&b, at_b))
            {
                return turned;
            }
        }
        self.families[0].generate(rng)
    }
}

/// The coordinates in units of the grid, or `None` where one is not on it.
fn grid_units(block: &Block) -> Option<Units> {
    let unit = |number: &Number| {
        let units = number.as_f64()? * f64::from(1 << GRID_DIGITS);
        (units.abs() < GRID_LIMIT as f64 && units.fract() == 0.0).then_some(units as i64)
    };
    block.vertices().iter().map(|v| Some([unit(&v.x)?, unit(&v.y)?, unit(&v.z)?])).collect()
}

/// Both blocks turned by a common random rotation, B besides by a small one about its vertex nearest to A and moved by up
/// to a sixty-fourth of a metre; `None` where a coordinate would not be an f64.
fn turned(
    sampler: &mut PairSampler<'_>,
    (a, at_a): (&Block, Units),
    (b, at_b): (&Block, Units),
) -> Option<(Block, Block)> {
    let pivot = nearest(&at_b, &at_a)?;
    let relative = |points: Units| points.into_iter().map(|p| [0, 1, 2].map(|k| p[k] - pivot[k])).collect::<Units>();
    let (at_a, at_b) = (relative(at_a), relative(at_b));
    let largest = at_a.iter().chain(&at_b).flatten().map(|c| c.unsigned_abs()).max()?;
    let digits = SUM_DIGITS.checked_sub(u64::BITS - largest.leading_zeros())?;
    let common = rotation(sampler, 1000);
    let lean = *sampler.pick(&[1, 1, 10, 100]);
    let own = product(&common, &rotation(sampler, lean));
    let reach = 1i128 << (GRID_DIGITS as u32 + digits - 6);
    let offset = [0; 3].map(|_: i32| sampler.between(-reach, reach) as i64);
    let unit = (-f64::from(GRID_DIGITS) - f64::from(digits)).exp2();
    Some((
        placed(a, &at_a, &rounded(&common, digits), [0; 3], unit)?,
        placed(b, &at_b, &rounded(&own, digits), offset, unit)?,
    ))
}

/// The point nearest to the box of the others.
fn nearest(points: &Units, others: &Units) -> Option<[i64; 3]> {
    let low = [0, 1, 2].map(|k| others.iter().map(|p| p[k]).min().unwrap_or(0));
    let high = [0, 1, 2].map(|k| others.iter().map(|p| p[k]).max().unwrap_or(0));
    let outside = |p: &[i64; 3]| (0..3).map(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0)).sum::<i64>();
    points.iter().copied().min_by_key(outside)
}

type Matrix = [[f64; 3]; 3];

/// The rotation of a random quaternion whose vector part is at most `lean` thousandths of its scalar part along each axis.
/// Four operations only, so that it is the same on every machine.
fn rotation(sampler: &mut PairSampler<'_>, lean: i128) -> Matrix {
    const ONE: i128 = 1 << 50;
    let most = ONE / 1000 * lean;
    let [b, c, d] = [0; 3].map(|_: i32| sampler.between(1, most) as f64 * sampler.sign() as f64 / ONE as f64);
    let norm = 1.0 + b * b + c * c + d * d;
    [
        [1.0 + b * b - c * c - d * d, 2.0 * (b * c - d), 2.0 * (b * d + c)],
        [2.0 * (b * c + d), 1.0 - b * b + c * c - d * d, 2.0 * (c * d - b)],
        [2.0 * (b * d - c), 2.0 * (c * d + b), 1.0 - b * b - c * c + d * d],
    ]
    .map(|row| row.map(|entry| entry / norm))
}

fn product(one: &Matrix, other: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| one[i][k] * other[k][j]).sum()))
}

fn rounded(matrix: &Matrix, digits: u32) -> [[i64; 3]; 3] {
    let scale = f64::from(digits).exp2();
    matrix.map(|row| row.map(|entry| (entry * scale).round_ties_even() as i64))
}

fn placed(block: &Block, points: &Units, matrix: &[[i64; 3]; 3], offset: [i64; 3], unit: f64) -> Option<Block> {
    let coordinate = |p: &[i64; 3], axis: usize| {
        let units = (0..3).map(|k| matrix[axis][k] * p[k]).sum::<i64>() + offset[axis];
        if units.unsigned_abs() > 1 << 53 {
            return None;
        }
        Number::from_f64(units as f64 * unit).ok()
    };
    let vertices = points
        .iter()
        .map(|p| Some(Vec3::new(coordinate(p, 0)?, coordinate(p, 1)?, coordinate(p, 2)?)))
        .collect::<Option<Vec<_>>>()?;
    Some(block.with_vertices(vertices))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::rand_core::SeedableRng;
    use rockproof_model::{BlockOptions, Precision};

    #[test]
    fn blocks_are_blocks_held_by_f64_with_their_last_bits_in_use() {
        let mut rng = ChaCha8Rng::from_seed([7; 32]);
        let generic = Generic::default();
        for _ in 0..40 {
            let (a, b) = generic.generate(&mut rng);
            for block in [&a, &b] {
                let faces = block.topology().faces().to_vec();
                let options = BlockOptions { planarity: Number::ZERO };
                let checked = Block::new(block.vertices().to_vec(), faces, &options).expect("an exactly planar block");
                assert_eq!(checked.is_convex(), block.is_convex());
                assert!(block.is_exact_in(Precision::F64) && !block.is_exact_in(Precision::F32));
            }
        }
    }
}
