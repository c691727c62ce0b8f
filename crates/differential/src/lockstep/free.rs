//! The exact trajectory beside the stepper's, each going on from its own state: how far they part over time.

use crate::lockstep::answer::{StepDecisions, compare};
use crate::lockstep::penetration::penetration;
use crate::lockstep::state::exact_state;
use crate::lockstep::state_errors::largest_distance;
use crate::lockstep::trajectory::Trajectory;
use rockproof_oracle::step as exact;
use rockproof_simulate::record::RunTable;
use rockproof_simulate::run::{Ending, StepAnnotations, Stepping};
use rockproof_stepper::dynamics::{Dynamics, Solve, State, StepError, StepReport, StepRules};

/// Columns of `free.csv`.
pub const COLUMNS: [&str; 11] = [
    "step",
    "time_s",
    "exact_time_s",
    "divergence_m",
    "worst_block",
    "moved_m",
    "contacts_differ",
    "modes_differ",
    "penetration_stepper_m",
    "penetration_exact_m",
    "undecided",
];

/// A stepper and the oracle, side by side but on their own.
#[derive(Debug)]
pub struct FreeStepping<R, M> {
    dynamics: Dynamics<R, M>,
    trajectory: Trajectory,
    begin: exact::State,
    last: Option<StepAnnotations>,
}

impl<R: Solve, M: StepRules> FreeStepping<R, M> {
    /// Both at the beginning of the same scene.
    pub fn new(dynamics: Dynamics<R, M>, trajectory: Trajectory) -> FreeStepping<R, M> {
        let begin = trajectory.state().clone();
        FreeStepping { dynamics, trajectory, begin, last: None }
    }

    fn annotations(&mut self, report: &StepReport) -> StepAnnotations {
        let answer = match self.trajectory.step() {
            Ok(answer) => answer,
            Err(failure) => {
                return StepAnnotations {
                    end: Some(Ending::Unproved(failure.to_string())),
                    ..StepAnnotations::default()
                };
            }
        };
        let state = self.dynamics.state();
        let stepper = StepDecisions::of_stepper(report, self.dynamics.modes(), state);
        let found = compare(&StepDecisions::of_oracle(&answer), &stepper, &self.trajectory.scene().scene().shapes());
        let right = self.trajectory.state();
        let mut row = vec![report.step.to_string(), number(report.time), number(right.time.approximate())];
        match exact_state(state) {
            Err(_) => row.extend([String::new(), String::new()]),
            Ok(own) => {
                let apart = own
                    .blocks
                    .iter()
                    .zip(&right.blocks)
                    .map(|(a, b)| largest_distance(a.vertices.iter().zip(&b.vertices)));
                let worst = apart.enumerate().reduce(|worst, next| if next.1 > worst.1 { next } else { worst });
                row.push(worst.map_or(String::new(), |(_, apart)| number(apart)));
                row.push(worst.map_or(String::new(), |(block, _)| block.to_string()));
            }
        }
        let moved = self
            .begin
            .blocks
            .iter()
            .zip(&right.blocks)
            .map(|(a, b)| largest_distance(a.vertices.iter().zip(&b.vertices)));
        row.push(number(moved.fold(0.0, f64::max)));
        row.push(found.iter().filter(|d| d.is_of_contacts()).count().to_string());
        row.push(found.iter().filter(|d| d.solve.is_some()).count().to_string());
        let depth = |state: &exact::State| penetration(self.trajectory.scene(), state).map_or(String::new(), number);
        row.push(exact_state(state).map_or(String::new(), |own| depth(&own)));
        row.push(depth(right));
        row.push(answer.levels.undecided.to_string());
        StepAnnotations { rows: vec![(RunTable::Free, vec![row])], ..StepAnnotations::default() }
    }
}

fn number(value: f64) -> String {
    format!("{value:?}")
}

impl<R: Solve, M: StepRules> Stepping<R> for FreeStepping<R, M> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        let report = self.dynamics.step()?;
        self.last = Some(self.annotations(&report));
        Ok(report)
    }

    fn state(&self) -> &State<R> {
        self.dynamics.state()
    }

    fn annotations(&mut self) -> Option<StepAnnotations> {
        self.last.take()
    }
}
