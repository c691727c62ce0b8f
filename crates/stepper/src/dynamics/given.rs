//! A step that is told its contacts, or its modes, instead of finding them out: to see what a wrong one does.

use crate::dynamics::attempt::Iteration;
use crate::dynamics::contact::Active;
use crate::dynamics::control::Accepted;
use crate::dynamics::displacement::displacement;
use crate::dynamics::engine::Dynamics;
use crate::dynamics::report::Stopped;
use crate::dynamics::rules::StepRules;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::Mode;
use rockproof_model::Contact;

/// What a step is told.
#[derive(Clone, Copy, Debug)]
pub struct Given<'g> {
    /// The contacts with their blocks, by pair and in SPEC order. They begin and go on as if classification had found them.
    pub contacts: &'g [([u32; 2], Contact)],
    /// The attempt that is accepted, for these contacts; `None` to iterate as ever.
    pub attempt: Option<GivenAttempt<'g>>,
}

/// An attempt whose modes are known beforehand.
#[derive(Clone, Copy, Debug)]
pub struct GivenAttempt<'g> {
    /// Δt in s.
    pub time_step: f64,
    /// The modes of all contacts in each solve, and at last those after the last solve: one more than solves.
    pub modes: &'g [Vec<Mode>],
}

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// As [`Dynamics::step`], with contacts or modes that are given. Given modes are not judged and nothing is retried.
    ///
    /// # Errors
    /// When the run cannot go on.
    pub fn step_given(&mut self, given: &Given<'_>) -> Result<crate::dynamics::StepReport, Stopped> {
        M::step_dynamics(self, Some(given))
    }

    /// The contacts that are given, with what they remember.
    pub(super) fn given_contacts(&self, given: &[([u32; 2], Contact)]) -> Vec<Active<R>> {
        let of_pair = |same: &[([u32; 2], Contact)]| {
            let contacts: Vec<Contact> = same.iter().map(|(_, contact)| *contact).collect();
            same.first().map_or(Vec::new(), |(pair, _)| self.of_pair(*pair, &contacts))
        };
        given.chunk_by(|one, other| one.0 == other.0).flat_map(of_pair).collect()
    }

    /// The attempt that is given.
    pub(super) fn given_attempt(
        &mut self,
        contacts: &mut [Active<R>],
        given: &GivenAttempt<'_>,
        number: i64,
        settling: bool,
    ) -> Result<Accepted<R>, Stopped> {
        let time_step = R::from_f64(given.time_step);
        let alone = self.alone(time_step, settling);
        let iteration = Iteration { alone: &alone, limits: &self.setup.limits, settling, given: Some(given.modes) };
        let ended = iteration
            .run::<M>(contacts, &mut self.layouts, &mut self.spare, &mut self.spent)
            .map_err(|unsolved| Stopped::Singular { step: number, block: unsolved.block })?;
        self.modes.push(ended.modes.clone());
        let mut farthest = R::ZERO;
        for (block, d) in ended.d.iter().enumerate().filter(|&(block, _)| !self.is_fixed(block)) {
            if !d.iter().all(|x| x.is_finite()) {
                return Err(Stopped::NotFinite { step: number, block });
            }
            for &vertex in &self.state.blocks[block].vertices {
                let moved = displacement(vertex - self.moments[block].centroid, d);
                farthest = farthest.larger(moved.dot(moved));
            }
        }
        Ok(Accepted { time_step, ended, retries: Vec::new(), farthest })
    }
}
