//! What an accepted attempt does to the state (SPEC section 5, update).

use crate::contact::{Collapsed, PreparedBlock};
use crate::dynamics::contact::StepContact;
use crate::dynamics::control::AcceptedAttempt;
use crate::dynamics::engine::Dynamics;
use crate::dynamics::kinematics::AffineMotion;
use crate::dynamics::moments::Moments;
use crate::dynamics::report::{StepError, StepReport};
use crate::dynamics::rules::StepRules;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::{BlockState, State};
use std::ops::Range;

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// Prepares those of some blocks that are not fixed again, one in place of the other: two of each would take twice the memory. Tells
    /// which one collapsed; those before it are replaced.
    fn prepare_moving(&mut self, states: &[BlockState<R>], blocks: Range<usize>) -> Result<(), (usize, Collapsed)> {
        for block in blocks {
            if !self.is_fixed(block) {
                let shape = self.setup.blocks[block].clone();
                self.solids[block] =
                    PreparedBlock::with_points(shape, &states[block].vertices).map_err(|what| (block, what))?;
            }
        }
        Ok(())
    }

    /// Moves everything by an accepted attempt. Of blocks that end not finite or inverted the first is told, and before any that collapsed.
    pub(super) fn accept(
        &mut self,
        contacts: &[StepContact<R>],
        accepted: AcceptedAttempt<R>,
        number: i64,
        settling: bool,
    ) -> Result<StepReport, StepError> {
        let AcceptedAttempt { time_step, ended, retries, farthest } = accepted;
        let motions: Vec<AffineMotion<R>> = (0..self.solids.len())
            .map(|block| {
                AffineMotion::new(self.setup.control.kinematics, self.moments[block].centroid, &ended.d[block])
            })
            .collect();
        let now = &self.state;
        let mut next = State {
            step: now.step,
            time: now.time,
            settling: now.settling,
            last_time_step: time_step,
            blocks: now.blocks.clone(),
            load_points: now.load_points.clone(),
            fixed_points: now.fixed_points.clone(),
            measured_points: now.measured_points.clone(),
            contacts: Vec::new(),
        };
        let dynamic = if settling { R::ZERO } else { self.setup.control.dynamic };
        let twice = R::from_f64(2.0) / time_step;
        let mut moments = self.moments.clone();
        for block in (0..motions.len()).filter(|&block| !self.is_fixed(block)) {
            let (state, d) = (&mut next.blocks[block], &ended.d[block]);
            for vertex in &mut state.vertices {
                *vertex = motions[block].of(*vertex);
            }
            for (rate, &d) in state.velocity.iter_mut().zip(d) {
                *rate = M::rate(dynamic, twice * d, *rate);
            }
            let added = self.setup.bodies[block].elastic.stress(&d[6..]);
            for (stress, added) in state.stress.iter_mut().zip(added) {
                *stress = *stress + added;
            }
            moments[block] = Moments::of(self.setup.blocks[block].topology(), &state.vertices);
            let finite = state.velocity.iter().chain(&state.stress).all(|x| x.is_finite());
            if !(finite && state.vertices.iter().all(|v| v.is_finite()) && moments[block].volume.is_finite()) {
                return Err(StepError::NotFinite { step: number, block });
            }
            if !R::ZERO.below(moments[block].volume) {
                let volume = moments[block].volume.to_f64();
                return Err(StepError::Inverted { step: number, block, volume });
            }
        }
        let load_blocks = self.setup.loads.iter().map(|load| load.block);
        let held_blocks = self.setup.held.iter().map(|held| held.block);
        for (block, point) in load_blocks.zip(&mut next.load_points).chain(held_blocks.zip(&mut next.fixed_points)) {
            *point = motions[block].of(*point);
        }
        for (&block, point) in self.setup.measured.iter().zip(&mut next.measured_points) {
            *point = motions[block].of(*point);
        }
        next.contacts = contacts
            .iter()
            .map(|contact| {
                contact.state_after_step::<M>(
                    |block, point| if self.is_fixed(block) { point } else { motions[block].of(point) },
                )
            })
            .collect();
        if settling {
            next.settling -= 1;
            if next.settling == 0 {
                for (state, body) in next.blocks.iter_mut().zip(&self.setup.bodies) {
                    state.velocity = body.velocity;
                }
            }
        } else {
            next.step += 1;
            next.time = next.time + time_step;
        }
        if let Err((block, what)) = self.prepare_moving(&next.blocks, 0..motions.len()) {
            // What they were before did not collapse.
            let before = std::mem::take(&mut self.state.blocks);
            let restored = self.prepare_moving(&before, 0..block);
            self.state.blocks = before;
            debug_assert!(restored.is_ok(), "a state that was prepared once is prepared again");
            return Err(StepError::Collapsed { step: number, block, what });
        }
        self.state = next;
        self.moments = moments;
        let farthest = farthest.to_f64().sqrt();
        // The map of `cayley` differs from first order by less than this.
        self.neighbours.moved(1.25 * farthest);
        Ok(self.report(contacts, number, time_step.to_f64(), (&ended, retries), farthest))
    }
}
