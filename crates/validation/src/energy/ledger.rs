//! Where the energy of a step comes from.
//!
//! A step solves M(v' − v)/Δt = F with v' = 2d/Δt − v, so the kinetic energy changes by the work dᵀF of the forces at its end
//! (`crates/stepper/tests/steps/energy.rs`). A closed spring takes more work than it stores, gravity's work is what it loses. What can add energy:
//! - springs are *found again* at the start of a step: gaps and stretches are measured in the geometry that has formed, by the contacts that
//!   are classified there. A contact that continues none of the step before brings ½p h0² if it is found overlapping: a *new* one;
//! - friction *lags* by a solve; strain adds up in fixed axes; rotation is finite. What is left of a gain is called the rest.

use super::{EnergyResult, EnergyRun};
use crate::iterations::load_potential;
use crate::stepped_scene::{CaseFailure, SteppedScene};
use rockproof_model::ContactKind;
use rockproof_stepper::Vector;
use rockproof_stepper::dynamics::displacement::{BlockVector, displacement};
use rockproof_stepper::dynamics::{ContactState, State, StepReport, StepRules};

/// A step and what it gained. Shares are of the drop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GainedStep {
    /// Its number; 0 if no step gained anything.
    pub step: i64,
    /// The time after it (s).
    pub time: f64,
    /// Its Δt (s).
    pub time_step: f64,
    /// Whether it had converged.
    pub converged: bool,
    /// What it gained.
    pub gain: f64,
    /// Of that, what contacts brought that continue no other.
    pub new: f64,
    /// What the springs of all others have, found again, less what they had.
    pub found_again: f64,
    /// The contact that brought most, new or found again: its pair and kind, and how deep it is found (m).
    pub contact: Option<([u32; 2], ContactKind, f64)>,
}

/// The energy of a run, from step to step. Loads that do not change with time count as gravity does.
pub struct EnergyLedger {
    first: f64,
    energy: f64,
    springs: f64,
    lowest: f64,
    gained: f64,
    worst: GainedStep,
    steps: [u64; 2],
}

impl EnergyLedger {
    /// Begins with a scene that has made no step.
    pub fn open<M: StepRules>(stepped: &SteppedScene<f64, M>) -> EnergyLedger {
        let moving = (0..stepped.scene.blocks.len()).filter(|&block| !stepped.scene.blocks[block].body.is_fixed());
        let (mut kinetic, mut gravitational) = (0.0, 0.0);
        for block in moving {
            let (rates, at) = (stepped.velocity(block), stepped.centroid(block));
            kinetic += 0.5 * stepped.momenta(block).iter().zip(rates).map(|(m, v)| m * v).sum::<f64>();
            gravitational -= stepped.mass(block) * stepped.gravity().iter().zip(at).map(|(g, x)| g * x).sum::<f64>();
        }
        gravitational += loads(stepped);
        let first = kinetic + gravitational;
        EnergyLedger {
            first,
            energy: first,
            springs: 0.0,
            lowest: gravitational,
            gained: 0.0,
            worst: GainedStep::default(),
            steps: [0; 2],
        }
    }

    /// Makes a step and enters it.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn step<M: StepRules>(&mut self, stepped: &mut SteppedScene<f64, M>) -> Result<(), CaseFailure> {
        let before = Before::new(stepped);
        let report = stepped.step()?.clone();
        let loads = loads(stepped);
        let energy = report.kinetic + report.potential() + loads;
        let gain = energy - self.energy;
        self.lowest = self.lowest.min(report.gravitational + loads);
        self.steps[0] += 1;
        self.steps[1] += u64::from(!report.converged);
        self.gained += gain.max(0.0);
        if gain > self.worst.gain {
            self.worst = before.explained(stepped, &report, gain, self.springs);
        }
        (self.energy, self.springs) = (energy, report.springs);
        Ok(())
    }

    /// The sums, as shares of the drop.
    pub fn close(self, run: EnergyRun) -> EnergyResult {
        let drop = self.first - self.lowest;
        let worst = GainedStep {
            gain: self.worst.gain / drop,
            new: self.worst.new / drop,
            found_again: self.worst.found_again / drop,
            ..self.worst
        };
        let left = (self.energy - self.lowest) / drop;
        EnergyResult { run, drop, gained: self.gained / drop, left, worst, steps: self.steps }
    }
}

/// What the loads of a scene have yet to spend (J).
fn loads<M: StepRules>(stepped: &SteppedScene<f64, M>) -> f64 {
    load_potential(&stepped.scene, &stepped.dynamics.state().load_points)
}

/// What must be remembered of the state before a step.
struct Before {
    state: State<f64>,
    centroids: Vec<Vector<f64>>,
}

impl Before {
    fn new<M: StepRules>(stepped: &SteppedScene<f64, M>) -> Before {
        let state = stepped.dynamics.state().clone();
        let centroids = (0..state.blocks.len()).map(|block| stepped.dynamics.centroid(block)).collect();
        Before { state, centroids }
    }

    /// What a step gained, and which springs brought it; `springs` is what they had before.
    fn explained<M: StepRules>(
        &self,
        stepped: &SteppedScene<f64, M>,
        report: &StepReport,
        gain: f64,
        springs: f64,
    ) -> GainedStep {
        let after = stepped.dynamics.state();
        let blocks = self.state.blocks.iter().zip(&after.blocks);
        // d = Δt(v + v')/2, as v' = 2d/Δt − v.
        let moved: Vec<BlockVector<f64>> = blocks
            .map(|(one, other)| std::array::from_fn(|k| 0.5 * report.time_step * (one.velocity[k] + other.velocity[k])))
            .collect();
        let (mut new, mut again, mut most) = (0.0, 0.0, (0.0, None));
        for contact in after.contacts.iter().filter(|contact| contact.mode.is_closed()) {
            let [a, b] = [0, 1].map(|side| {
                let block = contact.blocks[side] as usize;
                displacement(contact.points[side] - self.centroids[block], &moved[block])
            });
            let gap = contact.gap - contact.normal.dot(a - b);
            let [normal, shear] = stepped.stiffness(contact.blocks[0] as usize, contact.blocks[1] as usize);
            let energy = |gap: f64, stretch: f64| 0.5 * normal * gap * gap + 0.5 * shear * stretch * stretch;
            let brought = match self.continued(contact) {
                None => {
                    let brought = energy(gap.min(0.0), 0.0);
                    new += brought;
                    brought
                }
                Some(old) => {
                    let now = energy(gap, across(old.anchors[0] - old.anchors[1], contact.normal));
                    again += now;
                    now - energy(old.gap, across(old.anchors[0] - old.anchors[1], old.normal))
                }
            };
            if brought > most.0 {
                most = (brought, Some((contact.blocks, contact.contact.kind(), -gap)));
            }
        }
        GainedStep {
            step: report.step,
            time: report.time,
            time_step: report.time_step,
            converged: report.converged,
            gain,
            new,
            found_again: again - springs,
            contact: most.1,
        }
    }

    /// The closed contact of the step before that a contact continues: that of its features, or else of its entrance.
    fn continued(&self, contact: &ContactState<f64>) -> Option<&ContactState<f64>> {
        let pair = || self.state.contacts.iter().filter(|old| old.blocks == contact.blocks && old.mode.is_closed());
        let same = pair().find(|old| old.key() == contact.key());
        same.or_else(|| pair().find(|old| old.entrance() == contact.entrance()))
    }
}

/// The length of what of a vector lies across a unit vector.
fn across(v: Vector<f64>, normal: Vector<f64>) -> f64 {
    (v - normal * normal.dot(v)).length()
}
