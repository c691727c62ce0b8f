//! What each block brings into the system without contacts (SPEC section 5): inertia, damping, elasticity, weight, loads, fixed points.

use crate::dynamics::displacement::{BlockVector, generalized};
use crate::dynamics::island::{BlockSystem, packed};
use crate::dynamics::solve::Solve;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use crate::vector::Vector;
use rayon::prelude::*;

/// A thread takes so many blocks at a time.
const BLOCKS_AT_ONCE: usize = 128;

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// Every block's system without contacts: inertia, damping, elasticity, stress, weight, loads, fixed points.
    pub(super) fn block_systems(&self, time_step: R, settling: bool) -> Vec<BlockSystem<R>> {
        let two = R::from_f64(2.0);
        let drag = match settling {
            true => R::ZERO,
            false => M::drag(self.setup.control.damping, time_step, self.setup.control.time_step),
        };
        let (once, twice) = (two / time_step, two / (time_step * time_step) + drag);
        let block = |block: usize| {
            let body = &self.setup.bodies[block];
            let unknowns = body.motion.unknowns();
            let mut block_systems = BlockSystem {
                unknowns,
                stiffness: [R::ZERO; 78],
                force: [R::ZERO; 12],
                centroid: self.moments[block].centroid,
            };
            if unknowns == 0 {
                return block_systems;
            }
            let (state, moments) = (&self.state.blocks[block], &self.moments[block]);
            let density = body.elastic.density;
            for (row, inertia) in moments.inertia().iter().enumerate().take(unknowns) {
                let mut momentum = R::ZERO;
                for (column, &value) in inertia.iter().enumerate() {
                    if column <= row {
                        block_systems.stiffness[packed(row, column)] = twice * (density * value);
                    }
                    momentum = momentum + density * value * state.velocity[column];
                }
                block_systems.force[row] = once * momentum;
            }
            for (force, pull) in block_systems.force.iter_mut().zip(self.setup.gravity.components()) {
                *force = *force + density * moments.volume * pull;
            }
            // A rigid block has no strains.
            for i in 0..unknowns - 6 {
                block_systems.force[6 + i] = block_systems.force[6 + i] - moments.volume * state.stress[i];
                for k in 0..=i {
                    let value = &mut block_systems.stiffness[packed(6 + i, 6 + k)];
                    *value = *value + moments.volume * body.elastic.stiffness(i, k);
                }
            }
            block_systems
        };
        let mut all: Vec<BlockSystem<R>> =
            (0..self.prepared.len()).into_par_iter().with_min_len(BLOCKS_AT_ONCE).map(block).collect();
        let time = if settling { self.state.time } else { self.state.time + time_step };
        for (load, &at) in self.setup.loads.iter().zip(&self.state.load_points) {
            let pull = generalized(at - self.moments[load.block].centroid, load.force(time));
            add(&mut all[load.block].force, &pull);
        }
        for (held, &at) in self.setup.held.iter().zip(&self.state.fixed_points) {
            let arm = at - self.moments[held.block].centroid;
            let back = generalized(arm, (held.at - at) * held.stiffness);
            let block_systems = &mut all[held.block];
            add(&mut block_systems.force, &back);
            let (zero, one) = (R::ZERO, R::from_f64(1.0));
            for axis in [Vector::new(one, zero, zero), Vector::new(zero, one, zero), Vector::new(zero, zero, one)] {
                let row = generalized(arm, axis);
                for (k, &r) in row.iter().enumerate() {
                    for (m, &c) in row[..=k].iter().enumerate() {
                        let value = &mut block_systems.stiffness[packed(k, m)];
                        *value = *value + held.stiffness * r * c;
                    }
                }
            }
        }
        all
    }
}

fn add<R: Solve>(total: &mut BlockVector<R>, share: &BlockVector<R>) {
    for (total, &share) in total.iter_mut().zip(share) {
        *total = *total + share;
    }
}
