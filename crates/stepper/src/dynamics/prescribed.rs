//! A step whose contacts, or modes, are prescribed instead of found: to see what a wrong one does.

use crate::dynamics::attempt::OpenCloseIteration;
use crate::dynamics::contact::StepContact;
use crate::dynamics::control::AcceptedAttempt;
use crate::dynamics::report::StepError;
use crate::dynamics::solve::Solve;
use crate::dynamics::state::Mode;
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use rockproof_model::Contact;

/// What is prescribed.
#[derive(Clone, Copy, Debug)]
pub struct PrescribedStep<'g> {
    /// The contacts with their blocks, by pair and in SPEC order. They begin and go on as if classification had found them.
    pub contacts: &'g [([u32; 2], Contact)],
    /// The attempt that is accepted, for these contacts; `None` to iterate as ever.
    pub attempt: Option<PrescribedAttempt<'g>>,
}

/// An attempt whose modes are known beforehand.
#[derive(Clone, Copy, Debug)]
pub struct PrescribedAttempt<'g> {
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
    pub fn step_prescribed(
        &mut self,
        prescribed: &PrescribedStep<'_>,
    ) -> Result<crate::dynamics::StepReport, StepError> {
        M::step_dynamics(self, Some(prescribed))
    }

    /// The contacts that are given, with what they remember.
    pub(super) fn prescribed_contacts(&self, prescribed: &[([u32; 2], Contact)]) -> Vec<StepContact<R>> {
        let of_pair = |same: &[([u32; 2], Contact)]| {
            let contacts: Vec<Contact> = same.iter().map(|(_, contact)| *contact).collect();
            same.first().map_or(Vec::new(), |(pair, _)| self.of_pair(*pair, &contacts))
        };
        prescribed.chunk_by(|one, other| one.0 == other.0).flat_map(of_pair).collect()
    }

    /// The attempt that is given.
    pub(super) fn prescribed_attempt(
        &mut self,
        contacts: &mut [StepContact<R>],
        prescribed: &PrescribedAttempt<'_>,
        number: i64,
        settling: bool,
    ) -> Result<AcceptedAttempt<R>, StepError> {
        let time_step = R::from_f64(prescribed.time_step);
        let block_systems = self.block_systems(time_step, settling);
        let iteration = OpenCloseIteration {
            block_systems: &block_systems,
            limits: &self.setup.limits,
            settling,
            prescribed: Some(prescribed.modes),
            unchanged: None,
        };
        let mut ended = iteration
            .run::<M>(contacts, &mut self.layouts, &mut self.spare, &mut self.iteration_times)
            .map_err(|unsolved| StepError::Singular { step: number, block: unsolved.block })?;
        self.modes.push(std::mem::take(&mut ended.modes));
        let unknown = |&block: &usize| !self.is_fixed(block) && !ended.d[block].iter().all(|x| x.is_finite());
        if let Some(block) = (0..ended.d.len()).find(unknown) {
            return Err(StepError::NotFinite { step: number, block });
        }
        Ok(AcceptedAttempt { time_step, ended, retries: Vec::new() })
    }
}
