//! The system of one solve: its residual without a matrix, its matrix where elimination wants one, and its f64 stiffness.

mod float_stiffness;
mod free_motion;
mod residual;
mod rounded;

use super::approximate::Approximate;
use super::attempt_solve::AttemptSolve;
use super::attempt_values::{AttemptValues, Base, JointIn};
use super::cascade::EXACT_UNKNOWNS;
use super::contact::ContactGeometry;
use super::frame;
use super::friction::SlipForce;
use super::islands::Island;
use super::state::Mode;
use crate::field::{DoubleBall, Field, PackedBalls, PackedDoubleBalls, WideBall};
use crate::number::Ball;
use crate::solve::{BlockSparseSystem, Factor, Support, eliminate, fraction_free_solve, refine};
pub(crate) use float_stiffness::stiffness;
use num_rational::BigRational;
pub(crate) use rounded::Corrected;

/// A contact that bears on a system.
struct ClosedContact<'c, S> {
    /// Its place among the contacts of the attempt.
    place: usize,
    mode: Mode,
    geometry: &'c ContactGeometry<S>,
    /// What friction does to it, if it slides.
    slip: Option<&'c SlipForce<S>>,
}

/// Blocks and their closed contacts, with what friction does to those that slide.
pub(crate) struct System<'c, 'a, S> {
    values: &'c AttemptValues<'a, S>,
    /// What each block brings, in the order of the system.
    base: Vec<&'c Base<S>>,
    /// The place of each block of the attempt in the system.
    places: Vec<Option<usize>>,
    /// Closed contacts with a block of the system.
    closed: Vec<ClosedContact<'c, S>>,
}

impl<'c, 'a, S: Field> System<'c, 'a, S> {
    /// The system of all moving blocks, or of those of an island, in these modes. `slip` says what friction does to a contact, if it slides. `None`
    /// where this type cannot tell that, or cannot calculate the geometry.
    pub(crate) fn of(
        values: &'c AttemptValues<'a, S>,
        modes: &[Mode],
        slip: impl Fn(usize) -> Option<Option<&'c SlipForce<S>>>,
        island: Option<&Island>,
    ) -> Option<System<'c, 'a, S>> {
        let attempt = values.attempt;
        let mut system =
            System { values, base: Vec::new(), places: vec![None; attempt.blocks.len()], closed: Vec::new() };
        match island {
            Some(island) => {
                island.blocks.iter().try_for_each(|&block| system.add_block(block))?;
                island.contacts.iter().try_for_each(|&k| system.add_contact(k, modes[k], &slip))?;
            }
            None => {
                attempt.moving().try_for_each(|(block, _)| system.add_block(block))?;
                for (k, &mode) in modes.iter().enumerate().filter(|(_, mode)| **mode != Mode::Open) {
                    if attempt.started[k].blocks.iter().any(|&block| system.places[block].is_some()) {
                        system.add_contact(k, mode, &slip)?;
                    }
                }
            }
        }
        Some(system)
    }

    fn add_block(&mut self, block: usize) -> Option<()> {
        self.places[block] = Some(self.base.len());
        self.base.push(self.values.base(block)?);
        Some(())
    }

    fn add_contact(
        &mut self,
        place: usize,
        mode: Mode,
        slip: impl Fn(usize) -> Option<Option<&'c SlipForce<S>>>,
    ) -> Option<()> {
        let geometry = self.values.contact(place)?;
        self.closed.push(ClosedContact { place, mode, geometry, slip: slip(place)? });
        Some(())
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
            Some(support) => refine(&Corrected::new(system), support, start, system.values.bits),
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
            if system.sizes().into_iter().sum::<usize>() > EXACT_UNKNOWNS {
                return None;
            }
            let system = system.assembled();
            fraction_free_solve(&system.dense(), &system.right)
        })
    }
}

impl<S: StepNumber> AttemptValues<'_, S> {
    /// The system of the next solve with these modes, as a matrix.
    pub(crate) fn assembled(&self, modes: &[Mode]) -> Option<BlockSparseSystem<S>> {
        let friction = self.friction(modes)?;
        Some(System::of(self, modes, |k| Some(friction[k].as_ref()), None)?.assembled())
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
        for &ClosedContact { place: k, mode, geometry: contact, slip } in &self.closed {
            let joint = &values.joints[k];
            let rows = values.attempt.started[k].blocks.map(|block| self.places[block]);
            let pulls = [0, 1].map(|side: usize| frame::generalized(&contact.points[side], &contact.normal));
            let stiffness = joint.normal.times(&contact.over_square);
            let shear = joint.shear.times(&contact.over_square);
            // What acts at no displacement: the springs on h0 and s0, and f.
            let (weight, tangential) = match slip {
                Some(slip) => (stiffness.clone(), slip.at(&contact.stretch)),
                None => (stiffness.minus(&shear), contact.stretch.scaled(&joint.shear)),
            };
            let sideways = slip.filter(|slip| !slip.spring.is_zero());
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
/// block, is one of every K. The spring across a slip has the sign of the strength, so neither friction nor cohesion may be negative.
pub(crate) struct StiffnessBound {
    scale: Vec<i32>,
    least: f64,
}

impl StiffnessBound {
    /// The bound of an attempt's base; `None` where f64 proves none, or a spring may be negative.
    pub(crate) fn new<S: Field>(values: &AttemptValues<'_, S>) -> Option<StiffnessBound> {
        let springs = |joint: &JointIn<S>| {
            let values = [&joint.normal, &joint.shear, &joint.friction, &joint.cohesive];
            values.into_iter().map(Field::certain_sign).all(|sign| sign.is_some_and(|sign| !sign.is_negative()))
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
