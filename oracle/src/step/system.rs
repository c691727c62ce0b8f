//! The system of one solve: its residual without a matrix, its matrix where elimination wants one, and its f64 stiffness.

mod free_motion;
mod residual;

use super::approximate::{Approximate, Layout, Square, Stiffness};
use super::attempt_solve::AttemptSolve;
use super::attempt_values::{AttemptValues, Base, JointIn};
use super::contact::ContactGeometry;
use super::frame;
use super::friction::SlipForce;
use super::state::Mode;
use crate::field::{DoubleBall, Field, PackedBalls, PackedDoubleBalls, WideBall};
use crate::number::Ball;
use crate::solve::{BlockSparseSystem, Factor, Support, eliminate, fraction_free_solve, refine};
use num_rational::BigRational;

/// Blocks and their closed contacts in these modes, with what friction does to those that slide.
pub(crate) struct System<'c, 'a, S> {
    values: &'c AttemptValues<'a, S>,
    modes: &'c [Mode],
    friction: &'c [Option<SlipForce<S>>],
    /// What each block brings, in the order of the system.
    base: Vec<&'c Base<S>>,
    /// The place of each block of the attempt in the system.
    places: Vec<Option<usize>>,
    /// Closed contacts with a block of the system.
    closed: Vec<(usize, &'c ContactGeometry<S>)>,
}

impl<'c, 'a, S: Field> System<'c, 'a, S> {
    /// The system of all moving blocks, or of those of an island; `None` where this type cannot calculate its geometry.
    pub(crate) fn of(
        values: &'c AttemptValues<'a, S>,
        modes: &'c [Mode],
        friction: &'c [Option<SlipForce<S>>],
        island: Option<&[usize]>,
    ) -> Option<System<'c, 'a, S>> {
        let mut places = vec![None; values.attempt.blocks.len()];
        let mut base = Vec::new();
        for (block, _) in
            values.attempt.moving().filter(|(block, _)| island.is_none_or(|blocks| blocks.contains(block)))
        {
            places[block] = Some(base.len());
            base.push(values.base(block)?);
        }
        let mut closed = Vec::new();
        for (k, started) in values.attempt.started.iter().enumerate() {
            if modes[k] != Mode::Open && started.blocks.iter().any(|&block| places[block].is_some()) {
                closed.push((k, values.contact(k)?));
            }
        }
        Some(System { values, modes, friction, base, places, closed })
    }

    fn sizes(&self) -> Vec<usize> {
        self.base.iter().map(|base| base.right.len()).collect()
    }
}

/// A number type in which a solve of a step can be enclosed.
pub(crate) trait StepNumber: Field {
    /// Whether islands are solved apart, each when something of it is first asked for.
    const BY_ISLAND: bool = false;

    /// The displacements of the blocks of a system; `None` where this type cannot. `start` is what a cheaper type has found, without radius.
    fn solve(
        system: &System<'_, '_, Self>,
        support: Option<&StepSupport<'_>>,
        start: Option<Vec<Self>>,
    ) -> Option<Vec<Self>>;

    /// `F − K·x`, or F.
    fn residual(system: &System<'_, '_, Self>, x: Option<&[Self]>) -> Vec<Self> {
        system.residual_singly(x)
    }

    /// Keeps how a contact moved in a solve.
    fn keep_motions(values: &AttemptValues<'_, Self>, solve: &AttemptSolve<Self>, k: usize) {
        values.keep_motion(solve, k);
    }
}

macro_rules! refined {
    ($($type:ty, $packed:ty;)*) => {$(
        impl StepNumber for $type {
            fn solve(
                system: &System<'_, '_, Self>,
                support: Option<&StepSupport<'_>>,
                start: Option<Vec<Self>>,
            ) -> Option<Vec<Self>> {
                refine(system, support?, start, system.values.bits)
            }

            fn residual(system: &System<'_, '_, Self>, x: Option<&[Self]>) -> Vec<Self> {
                system.residual_packed::<$packed>(x)
            }

            fn keep_motions(values: &AttemptValues<'_, Self>, solve: &AttemptSolve<Self>, k: usize) {
                values.keep_packed_motions::<$packed>(solve, k);
            }
        }
    )*};
}

refined!(Ball, PackedBalls; DoubleBall, PackedDoubleBalls;);

impl StepNumber for WideBall {
    fn solve(
        system: &System<'_, '_, Self>,
        support: Option<&StepSupport<'_>>,
        start: Option<Vec<Self>>,
    ) -> Option<Vec<Self>> {
        match support {
            Some(support) => refine(system, support, start, system.values.bits),
            None => eliminate(&system.assembled()),
        }
    }
}

impl StepNumber for BigRational {
    const BY_ISLAND: bool = true;

    fn solve(
        system: &System<'_, '_, Self>,
        _support: Option<&StepSupport<'_>>,
        _start: Option<Vec<Self>>,
    ) -> Option<Vec<Self>> {
        system.free_motion().or_else(|| {
            let system = system.assembled();
            fraction_free_solve(&system.dense(), &system.right)
        })
    }
}

impl<S: StepNumber> AttemptValues<'_, S> {
    /// The system of the next solve with these modes, as a matrix.
    pub(crate) fn assembled(&self, modes: &[Mode]) -> Option<BlockSparseSystem<S>> {
        Some(System::of(self, modes, &self.friction(modes)?, None)?.assembled())
    }
}

impl<S: Field> System<'_, '_, S> {
    /// The system as a matrix and a right side.
    fn assembled(&self) -> BlockSparseSystem<S> {
        let values = self.values;
        let mut system = BlockSparseSystem::zero(&self.sizes());
        for (row, base) in self.base.iter().enumerate() {
            system.add(row, row, |r, c| base.matrix[r][c].clone());
            system.add_right(row, |r| base.right[r].clone());
        }
        for &(k, contact) in &self.closed {
            let (mode, joint) = (self.modes[k], &values.joints[k]);
            let rows = values.attempt.started[k].blocks.map(|block| self.places[block]);
            let pulls = [0, 1].map(|side: usize| frame::generalized(&contact.points[side], &contact.normal));
            let stiffness = joint.normal.times(&contact.over_square);
            let shear = joint.shear.times(&contact.over_square);
            // What acts at no displacement: the springs on h0 and s0, and f.
            let (weight, tangential) = match &self.friction[k] {
                Some(slip) => (stiffness.clone(), slip.at(&contact.stretch)),
                None => (stiffness.minus(&shear), contact.stretch.scaled(&joint.shear)),
            };
            let sideways = self.friction[k].as_ref().filter(|slip| !slip.spring.is_zero());
            let sideways = sideways.map(|slip| {
                (&slip.spring, [0, 1].map(|side: usize| frame::generalized(&contact.points[side], &slip.across)))
            });
            let push = stiffness.times(&contact.gap);
            let lines = [0, 1].map(|side: usize| frame::rows(&contact.points[side]));
            for one in 0..2 {
                let Some(row) = rows[one] else { continue };
                let force = frame::generalized(&contact.points[one], &tangential);
                system.add_right(row, |r| {
                    let sum = pulls[one][r].times(&push).plus(&force[r]);
                    if one == 0 { sum.negated() } else { sum }
                });
                for two in 0..=one {
                    let Some(column) = rows[two] else { continue };
                    system.add(row, column, |r, c| {
                        let mut sum = pulls[one][r].times(&pulls[two][c]).times(&weight);
                        if mode == Mode::Locked {
                            sum = sum.plus(&frame::along(&lines[one], &lines[two], r, c).times(&joint.shear));
                        }
                        if let Some((spring, pulls)) = &sideways {
                            sum = sum.plus(&pulls[one][r].times(&pulls[two][c]).times(spring));
                        }
                        if one == two { sum } else { sum.negated() }
                    });
                }
            }
        }
        system
    }
}

/// What f64 proves of all systems of one attempt: a scaling and a lower bound of the smallest eigenvalue.
///
/// Springs only add to the stiffness (`vᵀKv ≥ vᵀBv`, B the system without contacts), so the bound of B, block by
/// block, is one of every K.
pub(crate) struct StiffnessBound {
    scale: Vec<i32>,
    least: f64,
}

impl StiffnessBound {
    /// The bound of an attempt's base; `None` where f64 proves none, or a stiffness may be negative.
    pub(crate) fn new<S: Field>(values: &AttemptValues<'_, S>) -> Option<StiffnessBound> {
        let springs = |joint: &JointIn<S>| {
            let mut signs = [&joint.normal, &joint.shear].into_iter().map(Field::certain_sign);
            signs.all(|sign| sign.is_some_and(|sign| !sign.is_negative()))
        };
        if !values.joints.iter().all(springs) {
            return None;
        }
        let mut bound = StiffnessBound { scale: Vec::new(), least: f64::INFINITY };
        for (block, _) in values.attempt.moving() {
            let base = values.base(block)?;
            let mut system = BlockSparseSystem::zero(&[base.right.len()]);
            system.add(0, 0, |r, c| base.matrix[r][c].clone());
            let factor = Factor::new(&system)?;
            bound.scale.extend_from_slice(factor.scale());
            bound.least = bound.least.min(factor.least_eigenvalue());
        }
        Some(bound)
    }
}

/// What f64 knows of one system.
pub(crate) struct StepSupport<'s> {
    pub(crate) bound: &'s StiffnessBound,
    pub(crate) factor: &'s Approximate,
}

impl Support for StepSupport<'_> {
    fn scale(&self) -> &[i32] {
        &self.bound.scale
    }

    fn least_eigenvalue(&self) -> f64 {
        self.bound.least
    }

    fn approximate(&self, mut right: Vec<f64>) -> Vec<f64> {
        // The factor is that of K, not of D·K·D.
        let unscale = |values: &mut [f64]| {
            for (value, &scale) in values.iter_mut().zip(&self.bound.scale) {
                *value *= 2f64.powi(-scale);
            }
        };
        unscale(&mut right);
        let mut solution = self.factor.solve(right);
        unscale(&mut solution);
        solution
    }
}

/// How well a spring across a slip must be known, as a share of the normal stiffness and of its own direction: a factor of a stiffness
/// that is wrong by more corrects too slowly.
const SPRING_ACCURACY: f64 = 1.0 / 1_048_576.0;

/// The spring across a slip in f64: the stiffness and the vector on which it acts; `None` where the type knows too little of it.
fn float_spring<S: Field>(slip: &SlipForce<S>, normal: f64) -> Option<(f64, [f64; 3])> {
    if slip.spring.is_zero() {
        return Some((0.0, [0.0; 3]));
    }
    let (spring, b) = (slip.spring.nearby(), slip.across.components().map(Field::nearby));
    let square: f64 = b.iter().map(|(middle, _)| middle * middle).sum();
    let turned = b.iter().map(|(_, radius)| radius).fold(0.0, |most: f64, radius| most.max(*radius));
    let known = spring.1 * square <= SPRING_ACCURACY * normal && turned <= SPRING_ACCURACY * square.sqrt();
    known.then_some((spring.0, b.map(|(middle, _)| middle)))
}

/// The f64 stiffness of contacts in these modes, in the next solve of an attempt; `None` where it knows too little of the springs across
/// the slips.
pub(crate) fn stiffness<'l, S: StepNumber>(
    values: &AttemptValues<'_, S>,
    modes: &[Mode],
    layout: &'l Layout,
) -> Option<Stiffness<'l>> {
    let friction = values.friction(modes)?;
    let near = |value: &S| value.nearby().0;
    // First what this type may know too little of.
    let spring = |(slip, joint): (&Option<SlipForce<S>>, &JointIn<S>)| match slip {
        Some(slip) => float_spring(slip, near(&joint.normal)),
        None => Some((0.0, [0.0; 3])),
    };
    let springs = friction.iter().zip(&values.joints).map(spring).collect::<Option<Vec<_>>>()?;
    let diagonal = values.attempt.moving().map(|(block, _)| {
        let mut square: Square = [[0.0; 12]; 12];
        for (line, row) in square.iter_mut().zip(&values.base(block)?.matrix) {
            for (place, entry) in line.iter_mut().zip(row) {
                *place = near(entry);
            }
        }
        Some(square)
    });
    let mut stiffness = Stiffness::new(layout, diagonal.collect::<Option<_>>()?);
    for (k, &mode) in modes.iter().enumerate().filter(|(_, mode)| **mode != Mode::Open) {
        let (contact, joint) = (values.contact(k)?, &values.joints[k]);
        let rows = values.attempt.started[k].blocks.map(|block| values.attempt.rows[block]);
        let n = contact.normal.map(near);
        let n = [n.x, n.y, n.z].map(|c| c / near(&contact.square).sqrt());
        let (normal, shear) = (near(&joint.normal), if mode == Mode::Locked { near(&joint.shear) } else { 0.0 });
        // The force of a displacement of A against B: shear across n, what is more along it, and the spring across the slip.
        let (spring, b) = springs[k];
        let bent: [[f64; 3]; 3] = std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                (normal - shear) * n[r] * n[c] + if r == c { shear } else { 0.0 } + spring * b[r] * b[c]
            })
        });
        let lines = [0, 1].map(|side: usize| frame::float_rows(&contact.points[side].map(near)));
        for one in 0..2 {
            let Some(row) = rows[one] else { continue };
            let forced: [[f64; 12]; 3] = std::array::from_fn(|r| {
                std::array::from_fn(|c| (0..3).fold(0.0, |sum, axis| sum + bent[r][axis] * lines[one][axis][c]))
            });
            add(&mut stiffness.diagonal[row], &lines[one], &forced, 1.0);
            let Some(other) = rows[1 - one] else { continue };
            // The later block's rows and this one's columns.
            if other > row
                && let Some(square) = stiffness.coupling(row, other)
            {
                add(square, &lines[1 - one], &forced, -1.0);
            }
        }
    }
    Some(stiffness)
}

/// Adds `sign · rowsᵀ·columns`.
fn add(square: &mut Square, rows: &[[f64; 12]; 3], columns: &[[f64; 12]; 3], sign: f64) {
    for axis in 0..3 {
        for (line, &factor) in square.iter_mut().zip(&rows[axis]) {
            if factor != 0.0 {
                for (place, &value) in line.iter_mut().zip(&columns[axis]) {
                    *place += sign * factor * value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

    /// |b|² = 25·2⁻²⁰.
    const ACROSS: [f64; 3] = [3.0 / 1024.0, 4.0 / 1024.0, 0.0];

    /// A spring of k/|b|² for k = 10⁹ N/m, both with a radius that is so large a share of them.
    fn spring(of_spring: f64, of_across: f64) -> SlipForce<Ball> {
        let size = 1e9 / (25.0 * 2f64.powi(-20));
        let across = ACROSS.map(|middle| Ball { middle, radius: of_across * 5.0 / 1024.0 });
        let [x, y, z] = across;
        SlipForce {
            last: Vec3::zero(),
            secant: Ball { middle: 1.0, radius: 0.0 },
            across: Vec3::new(x, y, z),
            spring: Ball { middle: size, radius: of_spring * size },
        }
    }

    #[test]
    fn a_spring_across_a_slip_is_used_where_it_is_known_to_a_millionth() {
        let (well, badly) = (2f64.powi(-21), 2f64.powi(-19));
        for (of_spring, of_across, known) in [
            (0.0, 0.0, true),
            (well, 0.0, true),
            (badly, 0.0, false),
            (0.0, well, true),
            (0.0, badly, false),
            (well, well, true),
            (badly, badly, false),
        ] {
            let slip = spring(of_spring, of_across);
            let expected = known.then_some((slip.spring.middle, ACROSS));
            assert_eq!(float_spring(&slip, 1e9), expected, "{of_spring} {of_across}");
        }
        let none = SlipForce { spring: Ball { middle: 0.0, radius: 0.0 }, ..spring(0.0, badly) };
        assert_eq!(float_spring(&none, 1e9), Some((0.0, [0.0; 3])));
    }
}
