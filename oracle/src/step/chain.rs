//! The solves of one attempt at a step, in one number type.

use super::attempt::Attempt;
use super::contact::{ContactGeometry, Sides};
use super::frame::{self, UNKNOWNS};
use super::state::Mode;
use crate::field::Field;
use crate::mass::{Moments, difference, over};
use crate::solve::{BlockSystem, Factor, Solvable};
use num_rational::BigRational;
use rockproof_model::{Number, Point, Vec3};

/// What a solve left: displacements, and each contact's gap and stretch.
pub(crate) struct Iterate<S> {
    /// d of each block; empty for a fixed one.
    pub(crate) d: Vec<Vec<S>>,
    /// h·|N| of each contact.
    pub(crate) gaps: Vec<S>,
    /// The trial stretch of each contact.
    pub(crate) stretches: Vec<Vec3<S>>,
}

/// Geometry, base system and solves in the number type S.
pub(crate) struct Chain<'a, S> {
    attempt: &'a Attempt<'a>,
    pub(crate) bits: u32,
    pub(crate) moments: Vec<Moments<S>>,
    pub(crate) contacts: Vec<ContactGeometry<S>>,
    base: BlockSystem<S>,
    pub(crate) iterates: Vec<Iterate<S>>,
}

impl<'a, S: Solvable> Chain<'a, S> {
    /// The chain before its first solve; `None` where the type cannot tell a volume or a normal from zero.
    pub(crate) fn new(attempt: &'a Attempt<'a>, bits: u32) -> Option<Chain<'a, S>> {
        let moments: Vec<Moments<S>> =
            attempt.blocks.iter().map(|block| Moments::of(block, bits)).collect::<Option<_>>()?;
        let mut contacts = Vec::new();
        for started in attempt.started {
            let [i, j] = started.blocks;
            let sides =
                Sides::new([&attempt.blocks[i], &attempt.blocks[j]], [&moments[i].points, &moments[j].points], bits);
            let centroids = [&moments[i].centroid, &moments[j].centroid];
            contacts.push(ContactGeometry::new(&sides, centroids, &started.contact, started.anchors.as_ref(), bits)?);
        }
        let mut chain =
            Chain { attempt, bits, moments, contacts, base: BlockSystem::zero(&attempt.sizes), iterates: Vec::new() };
        chain.assemble_base()?;
        Some(chain)
    }

    fn number(&self, value: &Number) -> S {
        S::of_number(value, self.bits)
    }

    fn fraction(&self, value: &BigRational) -> S {
        S::of_rational(value, self.bits)
    }

    /// A point relative to the centroid of a block.
    pub(crate) fn relative(&self, block: usize, point: &Point) -> Vec3<S> {
        difference(point, &self.attempt.blocks[block].vertices()[0], self.bits).minus(&self.moments[block].centroid)
    }

    /// Everything but contacts (docs/step.md 7).
    fn assemble_base(&mut self) -> Option<()> {
        let attempt = self.attempt;
        let rate = self.fraction(&attempt.rate());
        for (block, row) in attempt.moving() {
            let material = attempt.material(block);
            let (moments, state) = (&self.moments[block], &attempt.state.blocks[block]);
            let volume = moments.volume.clone();
            let density = self.number(&material.density);
            let mass = moments.matrix();
            let inertia = rate.times(&density);
            let stiff = inertia.times(&rate).half();
            let velocity: Vec<S> = state.velocity.iter().map(|v| self.number(v)).collect();
            let gravity = attempt.model.simulation.gravity.map(|g| self.number(g));
            let weight = gravity.scaled(&volume.times(&density));
            let stress: Vec<S> = state.stress.iter().map(|v| self.number(v)).collect();
            let elastic = &attempt.elasticity[block];
            let size = self.base.size(row);
            let mut matrix = vec![vec![S::from_i32(0); size]; size];
            for (r, line) in matrix.iter_mut().enumerate() {
                for (c, entry) in line.iter_mut().enumerate() {
                    *entry = mass[r][c].times(&stiff);
                    if r >= 6 && c >= 6 {
                        *entry = entry.plus(&volume.times(&self.fraction(&elastic[r - 6][c - 6])));
                    }
                }
            }
            self.base.add(row, row, |r, c| matrix[r][c].clone());
            self.base.add_right(row, |r| {
                let terms = (0..size).fold(S::from_i32(0), |sum, c| sum.plus(&mass[r][c].times(&velocity[c])));
                let mut sum = terms.times(&inertia);
                if r < 3 {
                    sum = sum.plus(weight.components()[r]);
                }
                if r >= 6 {
                    sum = sum.minus(&volume.times(&stress[r - 6]));
                }
                sum
            });
        }
        for (k, (block, force)) in attempt.loads.iter().enumerate() {
            if let Some(row) = attempt.rows[*block] {
                let x = self.relative(*block, &attempt.state.load_points[k]);
                let pull = frame::pull(&x, &force.map(|f| self.fraction(f)));
                self.base.add_right(row, |r| pull[r].clone());
            }
        }
        for (k, fixed) in attempt.model.simulation.fixed_points.iter().enumerate() {
            if let Some(row) = attempt.rows[fixed.block] {
                let at = &attempt.state.fixed_points[k];
                let x = self.relative(fixed.block, at);
                let stiffness = self.number(&attempt.fixed_stiffness[k]);
                let lines = unit_pulls(&x);
                let back = frame::pull(&x, &difference::<S>(&fixed.at, at, self.bits).scaled(&stiffness));
                self.base.add(row, row, |r, c| along(&lines, &lines, r, c).times(&stiffness));
                self.base.add_right(row, |r| back[r].clone());
            }
        }
        Some(())
    }

    /// Adds the springs and forces of a contact with this mode (docs/step.md 8).
    fn add_contact(&self, system: &mut BlockSystem<S>, k: usize, mode: Mode) -> Option<()> {
        if mode == Mode::Open {
            return Some(());
        }
        let (contact, started) = (&self.contacts[k], &self.attempt.started[k]);
        let joint = &self.attempt.joints[k];
        let rows = started.blocks.map(|block| self.attempt.rows[block]);
        let stiffness = self.fraction(&joint.normal);
        let shear = self.fraction(&joint.shear);
        let weight = if mode == Mode::Locked { stiffness.minus(&shear) } else { stiffness.clone() };
        let (weight, push) = (weight.over(&contact.square)?, stiffness.over(&contact.square)?.times(&contact.gap));
        // The force of the contact on A, but for what the springs answer to d.
        let tangential = match mode {
            Mode::Locked => contact.stretch.scaled(&shear),
            _ => self.friction(k)?,
        };
        let lines = [unit_pulls(&contact.points[0]), unit_pulls(&contact.points[1])];
        for one in 0..2 {
            let Some(row) = rows[one] else { continue };
            let pull = &contact.pulls[one];
            let force = frame::pull(&contact.points[one], &tangential);
            system.add_right(row, |r| {
                let sum = pull[r].times(&push).plus(&force[r]);
                if one == 0 { sum.negated() } else { sum }
            });
            for two in 0..=one {
                let Some(column) = rows[two] else { continue };
                system.add(row, column, |r, c| {
                    let mut sum = pull[r].times(&contact.pulls[two][c]).times(&weight);
                    if mode == Mode::Locked {
                        sum = sum.plus(&along(&lines[one], &lines[two], r, c).times(&shear));
                    }
                    if one == two { sum } else { sum.negated() }
                });
            }
        }
        Some(())
    }

    /// `τ s/|s|` of the solve before, or `p_s s0` in the first; `None` where the root is none of this type.
    fn friction(&self, k: usize) -> Option<Vec3<S>> {
        let (contact, joint) = (&self.contacts[k], &self.attempt.joints[k]);
        match self.iterates.last() {
            None => Some(contact.stretch.scaled(&self.fraction(&joint.shear))),
            Some(last) => self.friction_after(k, &last.gaps[k], &last.stretches[k], joint),
        }
    }

    fn friction_after(&self, k: usize, gap: &S, s: &Vec3<S>, joint: &super::attempt::Joint) -> Option<Vec3<S>> {
        let (strength, length) = (self.strength(joint, gap)?, s.norm_squared());
        if strength.is_zero() || length.is_zero() {
            return Some(Vec3::zero());
        }
        // τ/|s|, both times |N|.
        let root = length.times(&self.contacts[k].square).root()?;
        Some(s.scaled(&strength.over(&root)?))
    }

    /// τ times |N| at a gap, that times |N| too: `tan φ·p_n·max(0, −h) + c·area`.
    fn strength(&self, joint: &super::attempt::Joint, gap: &S) -> Option<S> {
        let cohesive = self.fraction(&joint.cohesive);
        let friction = self.fraction(&joint.friction);
        if friction.is_zero() || !gap.certain_sign()?.is_negative() {
            return Some(cohesive);
        }
        Some(cohesive.plus(&friction.times(&self.fraction(&joint.normal)).times(&gap.negated())))
    }

    /// The force a sliding contact remembers: `τ s/|s|` of the last solve.
    pub(crate) fn last_friction(&self, k: usize) -> Option<Vec3<S>> {
        self.friction(k)
    }

    /// Solves once more, with these modes; `None` where this type cannot.
    pub(crate) fn advance(&mut self, modes: &[Mode], factor: &mut Option<Option<Factor>>) -> Option<()> {
        let mut system = self.base.clone();
        for (k, &mode) in modes.iter().enumerate() {
            self.add_contact(&mut system, k, mode)?;
        }
        let factor = factor.get_or_insert_with(|| Factor::new(&system));
        let solution = S::solve(&system, factor.as_ref(), self.bits)?;
        let mut d = vec![Vec::new(); self.attempt.blocks.len()];
        for (block, row) in self.attempt.moving() {
            d[block] = solution[system.range(row)].to_vec();
        }
        let (mut gaps, mut stretches) = (Vec::new(), Vec::new());
        for (contact, started) in self.contacts.iter().zip(self.attempt.started) {
            let [i, j] = started.blocks;
            let work =
                |pull: &[S], d: &[S]| pull.iter().zip(d).fold(S::from_i32(0), |sum, (p, d)| sum.plus(&p.times(d)));
            gaps.push(contact.gap.plus(&work(&contact.pulls[0], &d[i])).minus(&work(&contact.pulls[1], &d[j])));
            let moved =
                frame::displacement(&contact.points[0], &d[i]).minus(&frame::displacement(&contact.points[1], &d[j]));
            stretches.push(contact.stretch.plus(&contact.across(&moved)?));
        }
        self.iterates.push(Iterate { d, gaps, stretches });
        Some(())
    }

    /// The mode of a contact after the last solve; `None` where this type cannot tell (docs/step.md 9).
    pub(crate) fn next_mode(&self, k: usize, mode: Mode) -> Option<Mode> {
        let (contact, joint, iterate) = (&self.contacts[k], &self.attempt.joints[k], self.iterates.last()?);
        let tolerances = self.attempt.model.tolerances;
        let gap = &iterate.gaps[k];
        let equal = self.number(&tolerances.equal);
        // Homogeneous in |N|: squares are compared, so no root is taken.
        let square = gap.squared();
        if square.minus(&equal.times(&contact.gap).squared()).certain_sign()?.is_at_most_zero() {
            return Some(mode);
        }
        let closed = match mode {
            Mode::Open => {
                let limit = self.number(&tolerances.close).squared().times(&contact.square);
                gap.certain_sign()?.is_negative() && square.minus(&limit).certain_sign()?.is_positive()
            }
            _ => {
                // h − tension·area/p_n beyond εo, times |N|.
                let stretched = gap.minus(&self.fraction(&joint.tensile));
                let limit = self.number(&tolerances.open).squared().times(&contact.square);
                !(stretched.certain_sign()?.is_positive()
                    && stretched.squared().minus(&limit).certain_sign()?.is_positive())
            }
        };
        if !closed {
            return Some(Mode::Open);
        }
        if self.attempt.settling {
            return Some(Mode::Locked);
        }
        // p_s²|s|² ≤ τ², times |N|².
        let shear = self.fraction(&joint.shear).squared().times(&iterate.stretches[k].norm_squared());
        let excess = shear.times(&contact.square).minus(&self.strength(joint, gap)?.squared());
        Some(if excess.certain_sign()?.is_at_most_zero() { Mode::Locked } else { Mode::Sliding })
    }

    /// Whether a vertex moves beyond u; the block.
    pub(crate) fn too_far(&self) -> Option<Option<usize>> {
        let limit = self.number(&self.attempt.model.tolerances.max_displacement).squared();
        let iterate = self.iterates.last()?;
        for (block, _) in self.attempt.moving() {
            for vertex in self.attempt.blocks[block].vertices() {
                let moved = frame::displacement(&self.relative(block, vertex), &iterate.d[block]);
                if moved.norm_squared().minus(&limit).certain_sign()?.is_positive() {
                    return Some(Some(block));
                }
            }
        }
        Some(None)
    }

    /// Whether a block turns beyond ω; which.
    pub(crate) fn too_turned(&self) -> Option<Option<usize>> {
        let limit = self.number(&self.attempt.model.tolerances.max_rotation).squared();
        let iterate = self.iterates.last()?;
        for (block, _) in self.attempt.moving() {
            let d = &iterate.d[block];
            let turn = Vec3::new(d[3].clone(), d[4].clone(), d[5].clone());
            if turn.norm_squared().minus(&limit).certain_sign()?.is_positive() {
                return Some(Some(block));
            }
        }
        Some(None)
    }

    /// The anchors that go on from here, before the update moves them: of A and of B, relative to their centroids.
    pub(crate) fn anchors(&self, k: usize) -> [Vec3<S>; 2] {
        let started = &self.attempt.started[k];
        match &started.anchors {
            Some(anchors) => std::array::from_fn(|side| self.relative(started.blocks[side], &anchors[side])),
            None => self.contacts[k].points.clone(),
        }
    }

    /// `τ/p_s · s/|s|` of a contact that slid; zero without a shear spring.
    pub(crate) fn remembered_stretch(&self, k: usize) -> Option<Vec3<S>> {
        let shear = self.fraction(&self.attempt.joints[k].shear);
        if shear.is_zero() { Some(Vec3::zero()) } else { over(&self.last_friction(k)?, &shear) }
    }
}

/// The three rows of T(x).
fn unit_pulls<S: Field>(x: &Vec3<S>) -> [Vec<S>; 3] {
    std::array::from_fn(|axis| {
        let unit: [S; 3] = std::array::from_fn(|k| S::from_i32(i32::from(k == axis)));
        let [a, b, c] = unit;
        frame::pull(x, &Vec3::new(a, b, c))
    })
}

/// Entry (r, c) of `T_oneᵀ T_two`.
fn along<S: Field>(one: &[Vec<S>; 3], two: &[Vec<S>; 3], r: usize, c: usize) -> S {
    debug_assert!(r < UNKNOWNS && c < UNKNOWNS, "a block has twelve unknowns");
    (0..3).fold(S::from_i32(0), |sum, axis| {
        if one[axis][r].is_zero() || two[axis][c].is_zero() {
            sum
        } else {
            sum.plus(&one[axis][r].times(&two[axis][c]))
        }
    })
}
