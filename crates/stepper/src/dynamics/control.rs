//! Step control (SPEC 5.10, 5.11): Δt is cut until the iteration converges, and halved until nothing moves too far.

use crate::dynamics::attempt::{IterationResult, OpenCloseIteration};
use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::{BlockVector, displacement};
use crate::dynamics::report::{Retry, RetryReason, StepError};
use crate::dynamics::solve::Solve;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use rockproof_model::simulation::Unconverged;

/// An attempt that was good, or the last one.
pub(super) struct AcceptedAttempt<R> {
    pub(super) time_step: R,
    pub(super) ended: IterationResult<R>,
    pub(super) retries: Vec<Retry>,
}

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// Tries until an attempt is good (SPEC section 5, step control).
    pub(super) fn attempts(
        &mut self,
        contacts: &mut [StepContact<R>],
        number: i64,
        settling: bool,
    ) -> Result<AcceptedAttempt<R>, StepError> {
        let full = self.setup.control.time_step;
        let smallest = M::smallest(full);
        let mut time_step = M::first_time_step(full, self.state.last_time_step);
        let mut retries = Vec::new();
        loop {
            let block_systems = self.block_systems(time_step, settling);
            let known =
                self.unchanged.islands.as_ref().filter(|known| {
                    self.skips.islands && known.settling == settling && known.time_step.is_same(time_step)
                });
            let iteration = OpenCloseIteration {
                block_systems: &block_systems,
                limits: &self.setup.limits,
                settling,
                prescribed: None,
                unchanged: known,
            };
            let mut ended = iteration
                .run::<M>(contacts, &mut self.layouts, &mut self.spare, &mut self.iteration_times)
                .map_err(|unsolved| StepError::Singular { step: number, block: unsolved.block })?;
            self.modes.push(std::mem::take(&mut ended.modes));
            if let Some(block) = ended.d.iter().position(|d| !d.iter().all(|x| x.is_finite())) {
                return Err(StepError::NotFinite { step: number, block });
            }
            let accepts = self.setup.control.unconverged == Unconverged::Accept;
            let at = time_step.to_f64();
            let again = if ended.converged {
                match self.beyond_limits(&ended.d) {
                    None => None,
                    Some((block, why)) => {
                        let half = time_step / R::from_f64(2.0);
                        if half < smallest {
                            return Err(StepError::TooFast { step: number, time_step: at, block, why });
                        }
                        Some((why, half))
                    }
                }
            } else {
                let shorter = M::cut(time_step);
                match (shorter < smallest, accepts) {
                    (false, _) => Some((RetryReason::NotConverged, shorter)),
                    // The last attempt is taken as it is: limits are asked of converged ones.
                    (true, true) => None,
                    (true, false) => {
                        return Err(StepError::NotConverged { step: number, time_step: at, contacts: ended.changing });
                    }
                }
            };
            let Some((why, next)) = again else {
                self.layouts.forget_unused();
                return Ok(AcceptedAttempt { time_step, ended, retries });
            };
            retries.push(Retry { time_step: at, why });
            time_step = next;
        }
    }

    /// The first block that exceeds a limit: first that of displacement, then that of rotation.
    fn beyond_limits(&self, d: &[BlockVector<R>]) -> Option<(usize, RetryReason)> {
        let limits = &self.setup.limits;
        let (far, turned) = (limits.displacement * limits.displacement, limits.rotation * limits.rotation);
        let strays = |(_, squared): &(usize, R)| M::too_far(*squared, far);
        let turns = |d: &BlockVector<R>| M::turned_too_far(d[3] * d[3] + d[4] * d[4] + d[5] * d[5], turned);
        let strayed = self.displacements(d).find(strays).map(|(block, _)| (block, RetryReason::Displacement));
        strayed.or_else(|| {
            let mut moving = d.iter().enumerate().filter(|&(block, _)| !self.is_fixed(block));
            moving.find(|(_, d)| turns(d)).map(|(block, _)| (block, RetryReason::Rotation))
        })
    }

    /// The largest displacement of a vertex, squared (m²), before blocks are moved by it.
    pub(super) fn farthest(&self, d: &[BlockVector<R>]) -> R {
        self.displacements(d).fold(R::ZERO, |farthest, (_, squared)| farthest.larger(squared))
    }

    /// Of every vertex of the moving blocks its block and its displacement, squared (m²).
    fn displacements(&self, d: &[BlockVector<R>]) -> impl Iterator<Item = (usize, R)> {
        let moving = d.iter().enumerate().filter(|&(block, _)| !self.is_fixed(block));
        moving.flat_map(|(block, d)| {
            let centroid = self.moments[block].centroid;
            self.state.blocks[block].vertices.iter().map(move |&vertex| {
                let moved = displacement(vertex - centroid, d);
                (block, moved.dot(moved))
            })
        })
    }
}
