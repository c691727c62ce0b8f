//! Pairs of blocks for each cell of the stress table.
//!
//! An aligned pair is drawn on a grid of 2⁻¹⁰ m with whole coincidences. A generic one is turned as a whole by a random rational rotation,
//! and B is shifted by a random part of the search distance, so that nothing ties; its coordinates are fractions that no float holds, like
//! those a modeller's file was rounded from.

use super::axis::{CellKey, PairAlignment, StressAxis, StressLevel};
use num_bigint::BigInt;
use num_rational::BigRational;
use rand_chacha::ChaCha8Rng;
use rockproof_model::number::power_of_two;
use rockproof_model::preset::{self, Preset};
use rockproof_model::{Block, Number, Point, Precision, Vec3};
use rockproof_pairs::families::edge_cross::{crossing_ridges, keel, ridge};
use rockproof_pairs::families::{self, CoordinateStyle, Family, PairSampler};
use rockproof_pairs::generic::Generic;
use rockproof_pairs::shapes::{LatticeSolid, RationalRotation};
use std::sync::OnceLock;

/// The next pair of a cell.
pub(super) fn pair(rng: &mut ChaCha8Rng, cell: CellKey) -> (Block, Block) {
    match cell.axis {
        StressAxis::Offset => {
            let (a, b) = ordinary(rng, cell.form);
            moved_away(&mut PairSampler::with_style(rng, CoordinateStyle::Grid), (&a, &b), cell)
        }
        StressAxis::ScaleDown | StressAxis::ScaleUp => {
            let (a, b) = ordinary(rng, cell.form);
            let factor = cell.level.number();
            let scaled = |block: &Block| stretched(block, [&factor, &factor, &factor]);
            (scaled(&a), scaled(&b))
        }
        StressAxis::Ratio | StressAxis::Sliver | StressAxis::Angle => {
            let pair = match cell.axis {
                StressAxis::Ratio => sizes(rng, &cell.level.number()),
                StressAxis::Sliver => plates(rng, &cell.level.number()),
                _ => angles(rng, cell.level),
            };
            loosened(rng, cell.form, pair)
        }
    }
}

/// A pair of ordinary size near the origin.
fn ordinary(rng: &mut ChaCha8Rng, form: PairAlignment) -> (Block, Block) {
    static ALIGNED: OnceLock<Vec<std::sync::Arc<dyn Family>>> = OnceLock::new();
    static GENERIC: OnceLock<Generic> = OnceLock::new();
    if form == PairAlignment::Generic {
        return GENERIC.get_or_init(Generic::default).generate(rng);
    }
    let named = ["face_stack", "coplanar_slide", "vertex_on_edge", "corner_corner", "edge_cross"];
    let families = ALIGNED.get_or_init(|| families::named(&named).unwrap_or_else(|_| families::all()));
    let on_grid = |block: &Block| block.is_exact_in(Precision::F32);
    loop {
        let family = PairSampler::with_style(rng, CoordinateStyle::Grid).pick(families).clone();
        let (a, b) = family.generate(rng);
        if on_grid(&a) && on_grid(&b) {
            return (a, b);
        }
    }
}

/// Both blocks moved away from the origin along a random diagonal: aligned ones by whole metres, generic ones by millimetres.
fn moved_away(sampler: &mut PairSampler<'_>, (a, b): (&Block, &Block), cell: CellKey) -> (Block, Block) {
    let StressLevel::Power(exponent) = cell.level else { return (a.clone(), b.clone()) };
    let parts: i128 = if cell.form == PairAlignment::Aligned { 1 } else { 1000 };
    let size = largest_side(a).max(largest_side(b));
    let reach = ((10f64.powi(exponent) * size * parts as f64) as i128).max(1);
    let whole = sampler.below(3) as usize;
    let offset: [Number; 3] = std::array::from_fn(|axis| {
        let along = if axis == whole { reach } else { sampler.between(0, reach) };
        fraction(along * sampler.sign(), parts)
    });
    let [x, y, z] = offset;
    let offset = Vec3::new(x, y, z);
    (a.translated(&offset), b.translated(&offset))
}

/// A block on one `ratio` times as large: at its corner, its edge, or on its face. The place where they meet is near the origin.
fn sizes(rng: &mut ChaCha8Rng, ratio: &Number) -> (Block, Block) {
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    let small = sampler.convex(8, 32);
    let small = sampler.cube_turned(&small);
    let large = sampler.cuboid(8, 32);
    let sole = small.furthest([1, 2, -4]);
    let at = [(); 2].map(|()| if sampler.chance(50) { sampler.between(1, 15) } else { 0 });
    let (small, large) = (small.block(0), large.block(0));
    let large = stretched(&large, [ratio, ratio, ratio]);
    let bounds = large.bounds();
    // The corner at the lower x and y of the top face, and inward from there by some sixteenths of a metre.
    let corner = Vec3::new(bounds.min.x.clone(), bounds.min.y.clone(), bounds.max.z.clone());
    let large = large.translated(&corner.map(Number::negated));
    let sole = small.vertices()[sole].map(Number::negated);
    let inward = Vec3::new(fraction(at[0], 16), fraction(at[1], 16), Number::ZERO);
    let small = small.translated(&sole).translated(&inward);
    shuffled(&mut sampler, large, small)
}

/// A block on a plate, a needle or a flat tetrahedron, `thickness` times as thick as it is long.
fn plates(rng: &mut ChaCha8Rng, thickness: &Number) -> (Block, Block) {
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    let length = sampler.length(16, 48);
    let name = *sampler.pick(&["cuboid", "cuboid", "trapezoid", "hexagon", "tetrahedron", "wedge"]);
    let plate = sampler.shape(name, [length, length, length]);
    let other = sampler.convex(8, 48);
    let (top, sole) = (plate.furthest([1, 2, 4]), other.furthest([1, 2, -4]));
    let one = Number::from_integer(1);
    let plate = stretched(&plate.block(0), [&one, &one, thickness]);
    let other = other.block(0);
    let shift = |from: &Point, to: &Point| {
        let [x, y, z] = [0, 1, 2].map(|k| to.components()[k].plus(&from.components()[k].negated()));
        Vec3::new(x, y, z)
    };
    let other = other.translated(&shift(&other.vertices()[sole], &plate.vertices()[top]));
    shuffled(&mut sampler, plate, other)
}

/// A ridge along the keel of another block, or a block tipped on its edge, off parallel by the angle.
fn angles(rng: &mut ChaCha8Rng, level: StressLevel) -> (Block, Block) {
    let StressLevel::Power(exponent) = level else { return ordinary(rng, PairAlignment::Aligned) };
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    // The quaternion (n, 1) turns by 2·atan(1/n).
    let n = 2 * 10i64.pow(exponent.unsigned_abs().min(9));
    if sampler.chance(50) {
        let (below, along) = (ridge(&mut sampler), keel(&mut sampler));
        let above = sampler.turned_by(&along, RationalRotation::from_quaternion([n, 0, 0, 1]));
        let (a, b) = crossing_ridges(&mut sampler, &below, &above);
        return (a.block(0), b.block(0));
    }
    let (below, upright) = (sampler.cuboid(16, 48), sampler.cuboid(8, 32));
    let above = sampler.turned_by(&upright, RationalRotation::from_quaternion([n, 1, 0, 0]));
    let (below, above) = LatticeSolid::on_one_lattice(&below, &above);
    let shift = [0, 1, 2].map(|axis| match axis {
        2 => below.extent(2).1 - above.extent(2).0,
        _ => below.extent(axis).0 - above.extent(axis).0,
    });
    let above = above.moved(shift);
    shuffled(&mut sampler, below.block(0), above.block(0))
}

/// In a random order.
fn shuffled(sampler: &mut PairSampler<'_>, a: Block, b: Block) -> (Block, Block) {
    if sampler.chance(50) { (a, b) } else { (b, a) }
}

/// The pair as it is, or taken off its ties.
fn loosened(rng: &mut ChaCha8Rng, form: PairAlignment, (a, b): (Block, Block)) -> (Block, Block) {
    if form == PairAlignment::Aligned {
        return (a, b);
    }
    let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
    let turn = loop {
        let quaternion = [(); 4].map(|()| sampler.between(-40, 40) as i64);
        if quaternion[1..].iter().all(|q| *q != 0) {
            break RationalRotation::from_quaternion(quaternion);
        }
    };
    let search = preset::derive(Preset::Auto, &[&a, &b], Precision::F64).map_or(0.0, |set| set.search.approximate());
    let shift = [(); 3].map(|()| {
        let part = sampler.between(-(1 << 20), 1 << 20) as f64 * power_of_two(-21);
        Number::from_f64(part * search).unwrap_or(Number::ZERO)
    });
    let [x, y, z] = shift;
    (turned(&a, &turn), turned(&b.translated(&Vec3::new(x, y, z)), &turn))
}

/// The block turned about the origin, exactly.
fn turned(block: &Block, turn: &RationalRotation) -> Block {
    let entries = turn.matrix.map(|row| row.map(|entry| fraction(entry.into(), turn.norm.into())));
    let image = |p: &Point| {
        let row = |r: &[Number; 3]| r[0].times(&p.x).plus(&r[1].times(&p.y)).plus(&r[2].times(&p.z));
        Vec3::new(row(&entries[0]), row(&entries[1]), row(&entries[2]))
    };
    block.with_vertices(block.vertices().iter().map(image).collect())
}

/// The block stretched along the axes by positive factors.
fn stretched(block: &Block, factors: [&Number; 3]) -> Block {
    let image = |p: &Point| Vec3::new(p.x.times(factors[0]), p.y.times(factors[1]), p.z.times(factors[2]));
    block.with_vertices(block.vertices().iter().map(image).collect())
}

fn fraction(numerator: i128, denominator: i128) -> Number {
    Number::from_rational(BigRational::new(BigInt::from(numerator), BigInt::from(denominator)))
}

/// The longest side of the block's box (m).
fn largest_side(block: &Block) -> f64 {
    let bounds = block.bounds();
    let sides = bounds.max.components().into_iter().zip(bounds.min.components());
    sides.map(|(high, low)| high.approximate() - low.approximate()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::rand_core::SeedableRng;

    /// Every cell must have pairs that touch: else it would test nothing.
    #[test]
    fn the_pairs_of_every_cell_have_contacts() {
        for cell in super::super::axis::cells() {
            let mut rng = ChaCha8Rng::from_seed([7; 32]);
            let touching = (0..24)
                .filter(|_| {
                    let (a, b) = pair(&mut rng, cell);
                    let set = preset::derive(Preset::Auto, &[&a, &b], Precision::F64).expect("auto");
                    let (a, b) = (rockproof_oracle::PreparedBlock::new(&a), rockproof_oracle::PreparedBlock::new(&b));
                    !rockproof_oracle::Pair::new(&a, &b).classify(&set).contacts.is_empty()
                })
                .count();
            assert!(touching >= 6, "{} {}: {touching} of 24", cell.family(), cell.form.name());
        }
    }
}
