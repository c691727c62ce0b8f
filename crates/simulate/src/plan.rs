//! How far a run goes and how often it writes.

use rockproof_stepper::Real;
use rockproof_stepper::dynamics::State;

/// How far a run goes and how often it writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The number of the last step, settling not counted; `None` for no limit.
    pub steps: Option<u64>,
    /// The time at which it ends (s); `None` for no limit. With both, whichever comes first.
    pub time: Option<f64>,
    /// Less than this may be missing from `time` (s): the smallest step, a thousandth of the full one.
    pub smallest_step: f64,
    /// Steps between two checkpoints and two frames, above 0.
    pub every: u64,
    /// Whether every contact of every step is written.
    pub contacts: bool,
}

impl Plan {
    /// Whether nothing is left to do after this state.
    pub fn is_over<R: Real>(&self, state: &State<R>) -> bool {
        let missing = |end: f64| end - state.time.to_f64();
        state.settling == 0
            && (self.steps.is_some_and(|steps| state.step >= steps)
                || self.time.is_some_and(|end| missing(end) < self.smallest_step))
    }

    /// Whether a frame belongs to this state: every [`Plan::every`] steps from 0, which is after settling.
    pub fn has_frame<R: Real>(&self, state: &State<R>) -> bool {
        state.settling == 0 && state.step.is_multiple_of(self.every)
    }

    /// Whether a checkpoint belongs to this state: with every frame, and as often while settling.
    pub fn has_checkpoint<R: Real>(&self, state: &State<R>) -> bool {
        self.has_frame(state) || (state.settling > 0 && u64::from(state.settling).is_multiple_of(self.every))
    }

    /// How much of the run is done, 0 to 1.
    pub fn done<R: Real>(&self, state: &State<R>) -> f64 {
        let of_steps = self.steps.map_or(0.0, |steps| state.step as f64 / steps.max(1) as f64);
        let of_time = self.time.map_or(0.0, |end| state.time.to_f64() / end);
        of_steps.max(of_time).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(step: u64, time: f64, settling: u32) -> State<f64> {
        let nothing = Vec::new;
        State {
            step,
            time,
            settling,
            last_time_step: 0.01,
            blocks: Vec::new(),
            load_points: nothing(),
            fixed_points: nothing(),
            measured_points: nothing(),
            contacts: Vec::new(),
        }
    }

    #[test]
    fn ends_at_steps_or_time_whichever_comes_first() {
        let plan = Plan { steps: Some(50), time: Some(0.5), smallest_step: 1e-5, every: 10, contacts: false };
        // Fifty times 0.01 in f64 is not 0.5; what is missing is far below the smallest step.
        let sum = (0..50).fold(0.0, |t, _| t + 0.01);
        assert!(plan.is_over(&at(3, sum, 0)) && sum != 0.5);
        assert!(!plan.is_over(&at(49, 0.5 - 1e-5, 0)) && plan.is_over(&at(49, 0.5 - 0.9e-5, 0)));
        assert!(plan.is_over(&at(50, 0.1, 0)));
        assert!(!plan.is_over(&at(50, 0.5, 1)), "settling comes first");
        assert!(!Plan { steps: None, time: None, ..plan }.is_over(&at(u64::MAX, 1e300, 0)));
    }

    #[test]
    fn frames_begin_after_settling() {
        let plan = Plan { steps: Some(50), time: None, smallest_step: 0.0, every: 10, contacts: false };
        assert!(plan.has_frame(&at(0, 0.0, 0)) && plan.has_frame(&at(20, 0.0, 0)));
        assert!(!plan.has_frame(&at(0, 0.0, 20)) && !plan.has_frame(&at(7, 0.0, 0)));
        assert!(plan.has_checkpoint(&at(0, 0.0, 20)) && !plan.has_checkpoint(&at(0, 0.0, 21)));
        assert_eq!(
            [plan.done(&at(0, 0.0, 5)), plan.done(&at(25, 9.0, 0)), plan.done(&at(99, 9.0, 0))],
            [0.0, 0.5, 1.0]
        );
    }
}
