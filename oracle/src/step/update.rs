//! The state after a step (SPEC 5.12 and 5.13).

use super::answer::GapChange;
use super::attempt::Attempt;
use super::attempt_values::AttemptValues;
use super::frame;
use super::state::{BlockState, ContactMemory, KeptPrecision, Mode, State};
use super::system::StepNumber;
use crate::field::{Field, UpperBound, WideBall, dyadic, nearest_units};
use crate::mass;
use num_traits::Signed;
use rockproof_model::simulation::Kinematics;
use rockproof_model::{Number, Point, Vec3};

/// Significant bits of velocities and stresses where coordinates are kept on a grid.
const RATE_BITS: i64 = 256;

/// Gaps of a state in fractions are answered as multiples of 2 to the power of minus this, in m.
const EXACT_GAP: u32 = 200;

/// The state after the last solve of an attempt; `None` where its values are too wide for the grid.
pub(crate) fn updated<S: StepNumber>(
    attempt: &Attempt<'_>,
    values: &AttemptValues<'_, S>,
    modes: &[Mode],
    keep: KeptPrecision,
) -> Option<State> {
    let last = values.solves.last()?;
    let blocks = 0..attempt.blocks.len();
    let displacements: Vec<&Vec<S>> =
        blocks.clone().map(|block| values.displacement(last, block)).collect::<Option<_>>()?;
    let maps: Vec<Map<'_, S>> =
        blocks.map(|block| Map::new(attempt, block, displacements[block])).collect::<Option<_>>()?;
    let place = |block: usize, x: &Vec3<S>| -> Option<Point> {
        let origin = &attempt.blocks[block].vertices()[0];
        let moved = maps[block].moved(x)?.plus(&values.moments(block)?.centroid);
        let absolute = moved.plus(&origin.map(|c| S::of_number(c, values.bits)));
        point(&absolute, keep)
    };
    let given = |block: usize, at: &Point| -> Option<Point> {
        if attempt.rows[block].is_none() { Some(at.clone()) } else { place(block, &values.relative(block, at)?) }
    };
    let simulation = attempt.model.simulation;
    let mut blocks = Vec::new();
    for (block, old) in attempt.state.blocks.iter().enumerate() {
        let vertices = old.vertices.iter().map(|v| given(block, v)).collect::<Option<_>>()?;
        blocks.push(rates(attempt, values, block, displacements[block], old, vertices, keep)?);
    }
    let mut contacts = Vec::new();
    for (k, started) in attempt.started.iter().enumerate() {
        let anchors = values.anchors(k)?;
        let [a, b] = started.blocks;
        let mut moved = [maps[a].moved(&anchors[0])?, maps[b].moved(&anchors[1])?];
        if modes[k] == Mode::Sliding && !attempt.settling {
            // q becomes p less the stretch that friction needs, in the frame of q's block.
            let stretch = values.remembered_stretch(k)?;
            let between = between_centroids(attempt, values, a, b)?;
            if started.other_side() == 1 {
                moved[1] = moved[0].minus(&stretch).plus(&between);
            } else {
                moved[0] = moved[1].plus(&stretch).minus(&between);
            }
        }
        let to_point = |side: usize| -> Option<Point> {
            let block = started.blocks[side];
            let origin = attempt.blocks[block].vertices()[0].map(|c| S::of_number(c, values.bits));
            point(&moved[side].plus(&values.moments(block)?.centroid).plus(&origin), keep)
        };
        let anchors = [to_point(0)?, to_point(1)?];
        contacts.push(ContactMemory { blocks: started.blocks, contact: started.contact, mode: modes[k], anchors });
    }
    let points = |points: &[Point], blocks: Vec<usize>| -> Option<Vec<Point>> {
        points.iter().zip(blocks).map(|(at, block)| given(block, at)).collect()
    };
    let time = attempt.state.time.to_rational();
    Some(State {
        time: Number::from_rational(if attempt.settling { time } else { time + &attempt.time_step }),
        settling: attempt.state.settling.saturating_sub(1),
        last_time_step: Number::from_rational(attempt.time_step.clone()),
        blocks,
        load_points: points(&attempt.state.load_points, simulation.loads.iter().map(|l| l.block).collect())?,
        fixed_points: points(&attempt.state.fixed_points, simulation.fixed_points.iter().map(|f| f.block).collect())?,
        contacts,
    })
}

/// The gap of each contact before the step and in the last solve.
pub(crate) fn gap_changes<S: StepNumber>(values: &AttemptValues<'_, S>, keep: KeptPrecision) -> Option<Vec<GapChange>> {
    let last = values.solves.last()?;
    let of = |k: usize| {
        let (contact, after) = (values.contact(k)?, values.gap(last, k)?);
        let metres = |gap: &S| match keep {
            KeptPrecision::Grid { .. } => kept(&gap.over(&contact.square.root()?)?, keep),
            KeptPrecision::Exact => {
                // |N| need not be a fraction.
                let wide = |value: &S| WideBall::of_rational(&value.middle(), 2 * EXACT_GAP);
                let length = wide(&contact.square).root()?;
                kept(&wide(gap).over(&length)?, KeptPrecision::Grid { exponent: EXACT_GAP })
            }
        };
        Some(GapChange { before: metres(&contact.gap)?, after: metres(after)? })
    };
    (0..values.attempt.started.len()).map(of).collect()
}

/// The centroid of A less that of B.
fn between_centroids<S: StepNumber>(
    attempt: &Attempt<'_>,
    values: &AttemptValues<'_, S>,
    a: usize,
    b: usize,
) -> Option<Vec3<S>> {
    let origin = &attempt.blocks[a].vertices()[0];
    Some(values.relative(b, origin)?.plus(&values.moments(a)?.centroid))
}

fn rates<S: StepNumber>(
    attempt: &Attempt<'_>,
    values: &AttemptValues<'_, S>,
    block: usize,
    d: &[S],
    old: &BlockState,
    vertices: Vec<Point>,
    keep: KeptPrecision,
) -> Option<BlockState> {
    let rate = S::of_rational(&attempt.rate, values.bits);
    let zero = Number::ZERO;
    let (mut velocity, mut stress) = (std::array::from_fn(|_| zero.clone()), old.stress.clone());
    if !attempt.settling {
        let kept = S::of_number(&attempt.model.simulation.control.dynamic, values.bits);
        for (k, value) in d.iter().enumerate() {
            let before = S::of_number(&old.velocity[k], values.bits);
            velocity[k] = significant(&rate.times(value).minus(&before).times(&kept), keep);
        }
    }
    if attempt.state.settling == 1 {
        velocity = super::run::initial_rates(&attempt.model.bodies[block]);
    }
    if d.len() == frame::UNKNOWNS {
        let elastic = mass::elasticity::<S>(attempt.material(block), values.bits)?;
        for (k, value) in stress.iter_mut().enumerate() {
            let more =
                (0..6).fold(S::of_number(value, values.bits), |sum, c| sum.plus(&elastic[k][c].times(&d[6 + c])));
            *value = significant(&more, keep);
        }
    }
    Some(BlockState { vertices, velocity, stress })
}

/// How a block's points move: all relative to the centroid it had.
struct Map<'d, S> {
    d: &'d [S],
    /// `R(I + ε)`, for `cayley`.
    turned: Option<[Vec3<S>; 3]>,
}

impl<'d, S: Field> Map<'d, S> {
    fn new(attempt: &Attempt<'_>, block: usize, d: &'d [S]) -> Option<Map<'d, S>> {
        if attempt.model.simulation.control.kinematics == Kinematics::Linear || attempt.rows[block].is_none() {
            return Some(Map { d, turned: None });
        }
        let one = || S::from_i32(1);
        let strain = |k: usize| d.get(6 + k).cloned().unwrap_or_else(|| S::from_i32(0));
        let shear = |k: usize| strain(k).half();
        let stretched = [
            Vec3::new(one().plus(&strain(0)), shear(5), shear(4)),
            Vec3::new(shear(5), one().plus(&strain(1)), shear(3)),
            Vec3::new(shear(4), shear(3), one().plus(&strain(2))),
        ];
        // R v = v + (w × v + w × (w × v)) · 2/(1 + |w|²), w = r/2: Cayley's rotation without an inverse.
        let w = Vec3::new(d[3].half(), d[4].half(), d[5].half());
        let factor = S::from_i32(2).over(&one().plus(&w.norm_squared()))?;
        let turn = |v: &Vec3<S>| {
            let first = w.cross(v);
            v.plus(&first.plus(&w.cross(&first)).scaled(&factor))
        };
        // Columns of R(I + ε); the stretch is symmetric, so its rows are its columns.
        Some(Map { d, turned: Some(stretched.map(|column| turn(&column))) })
    }

    fn moved(&self, x: &Vec3<S>) -> Option<Vec3<S>> {
        if self.d.is_empty() {
            return Some(x.clone());
        }
        Some(match &self.turned {
            None => x.plus(&frame::displacement(x, self.d)),
            Some([a, b, c]) => Vec3::new(self.d[0].clone(), self.d[1].clone(), self.d[2].clone())
                .plus(&a.scaled(&x.x))
                .plus(&b.scaled(&x.y))
                .plus(&c.scaled(&x.z)),
        })
    }
}

fn point<S: Field>(at: &Vec3<S>, keep: KeptPrecision) -> Option<Point> {
    Some(Vec3::new(kept(&at.x, keep)?, kept(&at.y, keep)?, kept(&at.z, keep)?))
}

/// A coordinate as it is kept; `None` where its enclosure is wider than half a unit of the grid.
fn kept<S: Field>(value: &S, keep: KeptPrecision) -> Option<Number> {
    let KeptPrecision::Grid { exponent } = keep else { return Some(Number::from_rational(value.middle())) };
    let exponent = i64::from(exponent);
    if value.radius()? > UpperBound::power_of_two(-exponent - 1) {
        return None;
    }
    Some(Number::from_rational(dyadic(nearest_units(&value.middle(), exponent), -exponent)))
}

fn significant<S: Field>(value: &S, keep: KeptPrecision) -> Number {
    let middle = value.middle();
    if keep == KeptPrecision::Exact {
        return Number::from_rational(middle);
    }
    let top = middle.numer().abs().bits() as i64 - middle.denom().bits() as i64;
    let shift = RATE_BITS - top;
    Number::from_rational(dyadic(nearest_units(&middle, shift), -shift))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Ball;
    use num_bigint::BigInt;
    use num_rational::BigRational;

    const GRID: KeptPrecision = KeptPrecision::Grid { exponent: 10 };

    #[test]
    fn a_coordinate_known_to_half_a_unit_of_the_grid_is_kept() {
        let half = 2f64.powi(-11);
        let kept_of = |middle: f64, radius: f64| kept(&Ball { middle, radius }, GRID);
        assert_eq!(kept_of(1.0, half), Some(Number::from_integer(1)));
        assert_eq!(kept_of(1.0, half * (1.0 + f64::EPSILON)), None);
        // To the nearest multiple of 2⁻¹⁰.
        let unit = BigRational::new(1.into(), 1024.into());
        assert_eq!(kept_of(2.75 / 1024.0, 0.0).unwrap().to_rational(), &unit * BigInt::from(3));
        assert_eq!(kept_of(-2.25 / 1024.0, 0.0).unwrap().to_rational(), &unit * BigInt::from(-2));
    }

    #[test]
    fn a_rate_keeps_its_significant_bits_whatever_its_size() {
        let third = BigRational::new(1.into(), 3.into());
        for exponent in [-300i64, -1, 0, 1, 300] {
            for sign in [1, -1] {
                let value = &third * dyadic(BigInt::from(sign), exponent);
                let rate = significant(&value, GRID).to_rational();
                assert!((&rate - &value).abs() <= value.abs() * dyadic(BigInt::from(1), -254), "2^{exponent}");
                // No more bits than that: a binary number, rounded.
                assert_ne!(rate, value);
                let odd = rate.numer() >> rate.numer().trailing_zeros().unwrap();
                assert!(odd.bits() <= 257, "2^{exponent}: {} bits", odd.bits());
                assert_eq!(significant(&value, KeptPrecision::Exact).to_rational(), value);
            }
        }
        assert_eq!(significant(&BigRational::from_integer(0.into()), GRID), Number::ZERO);
    }
}
