//! One attempt at a step in one number type: its geometry, each part of it made when first asked for, and its solves.

use super::attempt::{Attempt, Joint};
use super::attempt_solve::AttemptSolve;
use super::contact::{ContactGeometry, Sides};
use super::frame;
use crate::field::Field;
use crate::mass::{self, Moments, difference};
use num_rational::BigRational;
use rockproof_model::simulation::JointProperties;
use rockproof_model::{Number, Point, Vec3};
use std::cell::OnceCell;

/// What a moving block brings into the system without contacts.
pub(crate) struct Base<S> {
    /// Its block of K, row by row.
    pub(crate) matrix: Vec<Vec<S>>,
    /// Its part of F.
    pub(crate) right: Vec<S>,
}

/// The joint of a contact.
#[derive(Clone)]
pub(crate) struct JointIn<S> {
    /// p_n.
    pub(crate) normal: S,
    /// p_s.
    pub(crate) shear: S,
    /// tan φ·p_n.
    pub(crate) friction: S,
    /// Cohesion on the contact's area, times |N|.
    pub(crate) cohesive: S,
    /// The gap that its tensile strength can stretch, times |N|.
    pub(crate) tensile: S,
}

/// Tolerances of the iteration, squared.
pub(crate) struct SquaredLimits<S> {
    pub(crate) equal: S,
    pub(crate) open: S,
    pub(crate) close: S,
    pub(crate) displacement: S,
    pub(crate) rotation: S,
}

/// Geometry, base system and solves in the number type S.
pub(crate) struct AttemptValues<'a, S> {
    pub(crate) attempt: &'a Attempt<'a>,
    pub(crate) bits: u32,
    /// Of each block, contact and block, where they were asked for; `None` where this type cannot.
    moments: Vec<OnceCell<Option<Moments<S>>>>,
    contacts: Vec<OnceCell<Option<ContactGeometry<S>>>>,
    base: Vec<OnceCell<Option<Base<S>>>>,
    /// How each block moves where no contact presses it.
    pub(super) alone: Vec<OnceCell<Option<Vec<S>>>>,
    pub(crate) joints: Vec<JointIn<S>>,
    pub(crate) limits: SquaredLimits<S>,
    pub(crate) solves: Vec<AttemptSolve<S>>,
    /// Whether every system of the attempt is proved to be positive definite.
    pub(crate) is_definite: bool,
}

impl<'a, S: Field> AttemptValues<'a, S> {
    /// The values before the first solve, of which nothing is calculated yet but joints and limits.
    pub(crate) fn new(attempt: &'a Attempt<'a>, bits: u32) -> AttemptValues<'a, S> {
        let number = |value: &Number| S::of_number(value, bits);
        let tolerances = attempt.model.tolerances;
        let limits = SquaredLimits {
            equal: number(&tolerances.equal).squared(),
            open: number(&tolerances.open).squared(),
            close: number(&tolerances.close).squared(),
            displacement: number(&tolerances.max_displacement).squared(),
            rotation: number(&tolerances.max_rotation).squared(),
        };
        let joints = joints(attempt.joints, bits);
        AttemptValues {
            attempt,
            bits,
            moments: empty_cells(attempt.blocks.len()),
            contacts: empty_cells(attempt.started.len()),
            base: empty_cells(attempt.blocks.len()),
            alone: empty_cells(attempt.blocks.len()),
            joints,
            limits,
            solves: Vec::new(),
            is_definite: false,
        }
    }

    /// Calculates all geometry; `None` where the type cannot tell a volume or a normal from zero.
    pub(crate) fn complete(self) -> Option<AttemptValues<'a, S>> {
        (0..self.moments.len()).try_for_each(|block| self.moments(block).map(|_| ()))?;
        (0..self.contacts.len()).try_for_each(|k| self.contact(k).map(|_| ()))?;
        self.attempt.moving().try_for_each(|(block, _)| self.base(block).map(|_| ()))?;
        Some(self)
    }

    /// The moments of a block.
    pub(crate) fn moments(&self, block: usize) -> Option<&Moments<S>> {
        self.moments[block].get_or_init(|| Moments::of(&self.attempt.blocks[block], self.bits)).as_ref()
    }

    /// The geometry of a contact.
    pub(crate) fn contact(&self, k: usize) -> Option<&ContactGeometry<S>> {
        let make = || {
            let started = &self.attempt.started[k];
            let [i, j] = started.blocks;
            let blocks = [&self.attempt.blocks[i], &self.attempt.blocks[j]];
            let [own, other] = [self.moments(i)?, self.moments(j)?];
            let sides = Sides::new(blocks, [&own.points, &other.points], self.bits);
            let centroids = [&own.centroid, &other.centroid];
            ContactGeometry::new(&sides, centroids, &started.contact, started.anchors.as_ref(), self.bits)
        };
        self.contacts[k].get_or_init(make).as_ref()
    }

    /// What a moving block brings into the system without contacts.
    pub(crate) fn base(&self, block: usize) -> Option<&Base<S>> {
        self.base[block].get_or_init(|| self.assembled_base(block)).as_ref()
    }

    pub(crate) fn number(&self, value: &Number) -> S {
        S::of_number(value, self.bits)
    }

    fn fraction(&self, value: &BigRational) -> S {
        S::of_rational(value, self.bits)
    }

    /// A point relative to the centroid of a block.
    pub(crate) fn relative(&self, block: usize, point: &Point) -> Option<Vec3<S>> {
        let corner = &self.attempt.blocks[block].vertices()[0];
        Some(difference(point, corner, self.bits).minus(&self.moments(block)?.centroid))
    }

    /// Everything of a block but its contacts (SPEC 5.7).
    fn assembled_base(&self, block: usize) -> Option<Base<S>> {
        let attempt = self.attempt;
        let rate = self.fraction(&attempt.rate);
        let damping = &attempt.model.simulation.control.damping;
        let is_damped = !attempt.settling && !damping.is_zero();
        let gravity = attempt.model.simulation.gravity.map(|g| self.number(g));
        let material = attempt.material(block);
        let (moments, state) = (self.moments(block)?, &attempt.state.blocks[block]);
        let (volume, density) = (&moments.volume, self.number(&material.density));
        let size = attempt.model.bodies[block].motion.unknowns();
        let mut matrix = moments.matrix();
        matrix.truncate(size);
        let inertia = rate.times(&density);
        // ρ(2/Δt² + c/Δt) = ½ρ(2/Δt)(2/Δt + c).
        let damped = if is_damped { rate.plus(&self.number(damping)) } else { rate.clone() };
        let stiff = inertia.times(&damped).half();
        let velocity: Vec<S> = state.velocity[..size].iter().map(|v| self.number(v)).collect();
        let weight = gravity.scaled(&volume.times(&density));
        let mut right: Vec<S> = matrix
            .iter()
            .map(|row| row.iter().zip(&velocity).fold(S::from_i32(0), |sum, (m, v)| sum.plus(&m.times(v))))
            .map(|momentum| momentum.times(&inertia))
            .collect();
        for (place, force) in right.iter_mut().zip(weight.components()) {
            *place = place.plus(force);
        }
        for row in &mut matrix {
            row.truncate(size);
            for entry in row.iter_mut().filter(|entry| !entry.is_zero()) {
                *entry = entry.times(&stiff);
            }
        }
        if size == frame::UNKNOWNS {
            let elastic = mass::elasticity::<S>(material, self.bits)?;
            for r in 0..6 {
                for c in 0..6 {
                    let entry = &mut matrix[6 + r][6 + c];
                    *entry = entry.plus(&volume.times(&elastic[r][c]));
                }
                right[6 + r] = right[6 + r].minus(&volume.times(&self.number(&state.stress[r])));
            }
        }
        for (k, (_, force)) in attempt.loads.iter().enumerate().filter(|(_, load)| load.0 == block) {
            let x = self.relative(block, &attempt.state.load_points[k])?;
            frame::add_pull(&mut right, &x, &force.map(|f| self.fraction(f)));
        }
        let fixed_points = attempt.model.simulation.fixed_points.iter().enumerate();
        for (k, fixed) in fixed_points.filter(|(_, fixed)| fixed.block == block) {
            let at = &attempt.state.fixed_points[k];
            let x = self.relative(block, at)?;
            let stiffness = self.number(&attempt.fixed_stiffness[k]);
            let lines = frame::rows(&x);
            let back = difference::<S>(&fixed.at, at, self.bits).scaled(&stiffness);
            frame::add_pull(&mut right, &x, &back);
            for (r, line) in matrix.iter_mut().enumerate() {
                for (c, entry) in line.iter_mut().enumerate() {
                    *entry = entry.plus(&frame::along(&lines, &lines, r, c).times(&stiffness));
                }
            }
        }
        Some(Base { matrix, right })
    }

    /// The anchors that go on from here, before the update moves them: of A and of B, relative to their centroids.
    pub(crate) fn anchors(&self, k: usize) -> Option<[Vec3<S>; 2]> {
        let started = &self.attempt.started[k];
        match &started.anchors {
            Some([own, other]) => {
                Some([self.relative(started.blocks[0], own)?, self.relative(started.blocks[1], other)?])
            }
            None => Some(self.contact(k)?.points.clone()),
        }
    }
}

/// Room for so many parts that are made when first asked for.
pub(super) fn empty_cells<T>(count: usize) -> Vec<OnceCell<T>> {
    std::iter::repeat_with(OnceCell::new).take(count).collect()
}

/// The joints in one number type; those of one pair of blocks, which stand together, are worked out once.
fn joints<S: Field>(joints: &[Joint<'_>], bits: u32) -> Vec<JointIn<S>> {
    let mut made: Vec<JointIn<S>> = Vec::with_capacity(joints.len());
    let mut last: Option<&JointProperties> = None;
    for joint in joints {
        let number = |value: &Number| S::of_number(value, bits);
        let area = |value: &Option<BigRational>| match value {
            Some(value) => S::of_rational(value, bits),
            None => S::from_i32(0),
        };
        let (cohesive, tensile) = (area(&joint.cohesive), area(&joint.tensile));
        let next = match (made.last(), last) {
            (Some(before), Some(known)) if std::ptr::eq(known, joint.properties) => {
                JointIn { cohesive, tensile, ..before.clone() }
            }
            _ => {
                let normal = number(joint.normal);
                JointIn {
                    shear: normal.times(&number(&joint.properties.shear_ratio)),
                    friction: normal.times(&number(&joint.properties.friction)),
                    normal,
                    cohesive,
                    tensile,
                }
            }
        };
        made.push(next);
        last = Some(joint.properties);
    }
    made
}
