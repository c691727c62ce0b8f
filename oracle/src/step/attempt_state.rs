//! One attempt at a step in one number type: its geometry, and what its solves left.

use super::attempt::{Attempt, Joint};
use super::contact::{ContactGeometry, Sides};
use super::frame;
use super::friction::SlipForce;
use crate::field::Field;
use crate::mass::{self, Moments, difference};
use num_rational::BigRational;
use rockproof_model::simulation::JointProperties;
use rockproof_model::{Number, Point, Vec3};

/// What a solve left: displacements, and each contact's gap and stretch.
pub(crate) struct Iterate<S> {
    /// d of each block; empty for a fixed one.
    pub(crate) d: Vec<Vec<S>>,
    /// h·|N| of each contact.
    pub(crate) gaps: Vec<S>,
    /// The trial stretch of each contact.
    pub(crate) stretches: Vec<Vec3<S>>,
    /// What friction did to each contact that slid in it.
    pub(crate) friction: Vec<Option<SlipForce<S>>>,
}

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
pub(crate) struct AttemptState<'a, S> {
    pub(crate) attempt: &'a Attempt<'a>,
    pub(crate) bits: u32,
    pub(crate) moments: Vec<Moments<S>>,
    pub(crate) contacts: Vec<ContactGeometry<S>>,
    pub(crate) joints: Vec<JointIn<S>>,
    pub(crate) limits: SquaredLimits<S>,
    /// One for each moving block.
    pub(crate) base: Vec<Base<S>>,
    pub(crate) iterates: Vec<Iterate<S>>,
}

impl<'a, S: Field> AttemptState<'a, S> {
    /// The chain before its first solve; `None` where the type cannot tell a volume or a normal from zero.
    pub(crate) fn new(attempt: &'a Attempt<'a>, bits: u32) -> Option<AttemptState<'a, S>> {
        let moments: Vec<Moments<S>> =
            attempt.blocks.iter().map(|block| Moments::of(block, bits)).collect::<Option<_>>()?;
        let mut contacts = Vec::with_capacity(attempt.started.len());
        for started in attempt.started {
            let [i, j] = started.blocks;
            let blocks = [&attempt.blocks[i], &attempt.blocks[j]];
            let sides = Sides::new(blocks, [&moments[i].points, &moments[j].points], bits);
            let centroids = [&moments[i].centroid, &moments[j].centroid];
            contacts.push(ContactGeometry::new(&sides, centroids, &started.contact, started.anchors.as_ref(), bits)?);
        }
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
        let iterates = Vec::new();
        let mut chain = AttemptState { attempt, bits, moments, contacts, joints, limits, base: Vec::new(), iterates };
        chain.assemble_base()?;
        Some(chain)
    }

    pub(crate) fn number(&self, value: &Number) -> S {
        S::of_number(value, self.bits)
    }

    fn fraction(&self, value: &BigRational) -> S {
        S::of_rational(value, self.bits)
    }

    /// A point relative to the centroid of a block.
    pub(crate) fn relative(&self, block: usize, point: &Point) -> Vec3<S> {
        difference(point, &self.attempt.blocks[block].vertices()[0], self.bits).minus(&self.moments[block].centroid)
    }

    /// Everything but contacts (SPEC 5.7).
    fn assemble_base(&mut self) -> Option<()> {
        let attempt = self.attempt;
        let rate = self.fraction(&attempt.rate);
        let damping = &attempt.model.simulation.control.damping;
        let is_damped = !attempt.settling && !damping.is_zero();
        let gravity = attempt.model.simulation.gravity.map(|g| self.number(g));
        let mut base = Vec::new();
        for (block, _) in attempt.moving() {
            let material = attempt.material(block);
            let (moments, state) = (&self.moments[block], &attempt.state.blocks[block]);
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
            for (place, pull) in right.iter_mut().zip(weight.components()) {
                *place = place.plus(pull);
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
            base.push(Base { matrix, right });
        }
        for (k, (block, force)) in attempt.loads.iter().enumerate() {
            if let Some(row) = attempt.rows[*block] {
                let x = self.relative(*block, &attempt.state.load_points[k]);
                frame::add_pull(&mut base[row].right, &x, &force.map(|f| self.fraction(f)));
            }
        }
        for (k, fixed) in attempt.model.simulation.fixed_points.iter().enumerate() {
            if let Some(row) = attempt.rows[fixed.block] {
                let at = &attempt.state.fixed_points[k];
                let x = self.relative(fixed.block, at);
                let stiffness = self.number(&attempt.fixed_stiffness[k]);
                let lines = frame::rows(&x);
                let back = difference::<S>(&fixed.at, at, self.bits).scaled(&stiffness);
                frame::add_pull(&mut base[row].right, &x, &back);
                for (r, line) in base[row].matrix.iter_mut().enumerate() {
                    for (c, entry) in line.iter_mut().enumerate() {
                        *entry = entry.plus(&frame::along(&lines, &lines, r, c).times(&stiffness));
                    }
                }
            }
        }
        self.base = base;
        Some(())
    }

    /// Takes a solution, by moving block, as the last iterate; `friction` acted in it.
    pub(crate) fn take(&mut self, solution: &[S], friction: Vec<Option<SlipForce<S>>>) {
        let mut d = vec![Vec::new(); self.attempt.blocks.len()];
        let mut rest = solution;
        for (block, row) in self.attempt.moving() {
            let (own, others) = rest.split_at(self.base[row].right.len());
            (d[block], rest) = (own.to_vec(), others);
        }
        let (mut gaps, mut stretches) = (Vec::new(), Vec::new());
        for (contact, started) in self.contacts.iter().zip(self.attempt.started) {
            let [i, j] = started.blocks;
            let moved = contact.moved([&d[i], &d[j]]);
            let along = contact.normal.dot(&moved);
            gaps.push(contact.gap.plus(&along));
            stretches.push(contact.stretch.plus(&contact.across(&moved, &along)));
        }
        self.iterates.push(Iterate { d, gaps, stretches, friction });
    }

    /// The anchors that go on from here, before the update moves them: of A and of B, relative to their centroids.
    pub(crate) fn anchors(&self, k: usize) -> [Vec3<S>; 2] {
        let started = &self.attempt.started[k];
        match &started.anchors {
            Some(anchors) => std::array::from_fn(|side| self.relative(started.blocks[side], &anchors[side])),
            None => self.contacts[k].points.clone(),
        }
    }
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
