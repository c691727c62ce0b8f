//! Energy of blocks that fall, strike one another and come to rest: no force drives them, so no step should gain any.
//!
//! The energy of a state is that of `steps.csv`: kinetic, of gravity, of strain, of springs. The *drop* is what was there to spend: the energy at
//! the start less the least that gravity had during the run. `ledger` says of a gain where it comes from.

mod ledger;
mod scenes;

pub use ledger::{EnergyLedger, GainedStep};
pub use scenes::DropScene;

use crate::stepped_scene::{CaseFailure, SteppedScene, number};
use rayon::prelude::*;
use rockproof_model::{Motion, Scene};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::StepRules;

/// Steps of the table (s).
pub const TIME_STEPS: [f64; 4] = [2e-4, 1e-3, 5e-3, 1e-2];
/// The most that a step may gain, as a share of the drop.
pub const STEP_GOAL: f64 = 0.01;
/// The most that all gaining steps of a run may gain together, as a share of the drop, on average over the runs.
pub const SUM_GOAL: f64 = 0.005;

/// One run: a scene, how its blocks move, Δt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyRun {
    /// What falls.
    pub scene: DropScene,
    /// Which of the variants of that scene, from 0.
    pub variant: u32,
    /// [`Motion::Rigid`] or [`Motion::Deformable`].
    pub motion: Motion,
    /// Δt (s).
    pub time_step: f64,
}

/// What a run did to the energy. Shares are of the drop.
#[derive(Clone, Debug, PartialEq)]
pub struct EnergyResult {
    /// The run.
    pub run: EnergyRun,
    /// The drop (J).
    pub drop: f64,
    /// What the steps that gained have gained together.
    pub gained: f64,
    /// What is left of the drop at the end: of motion, springs and strain, and of height above the lowest that was reached.
    pub left: f64,
    /// The step that gained most.
    pub worst: GainedStep,
    /// Steps made, and those of them that had not converged at the smallest Δt.
    pub steps: [u64; 2],
}

impl EnergyRun {
    /// Every run of a scene and motion at one Δt.
    pub fn variants(scene: DropScene, motion: Motion, time_step: f64) -> impl Iterator<Item = EnergyRun> {
        (0..scene.variants()).map(move |variant| EnergyRun { scene, variant, motion, time_step })
    }

    /// Its scene.
    ///
    /// # Errors
    /// When a shape is no block.
    pub fn scene(&self) -> Result<Scene, CaseFailure> {
        let mut scene = self.scene.build(self.variant, self.motion)?;
        scene.simulation.control.time_step = number(self.time_step)?;
        Ok(scene)
    }

    /// Runs it by the rules `M`.
    ///
    /// # Errors
    /// When a step cannot be made.
    pub fn measure<M: StepRules>(self) -> Result<EnergyResult, CaseFailure> {
        self.measure_in::<M>(self.scene()?)
    }

    /// Runs a scene made of that of this run, by the rules `M`. Its loads must not change with time.
    ///
    /// # Errors
    /// When a step cannot be made.
    pub fn measure_in<M: StepRules>(self, scene: Scene) -> Result<EnergyResult, CaseFailure> {
        let mut stepped = SteppedScene::<f64, M>::new(scene)?;
        let mut account = EnergyLedger::open(&stepped);
        while stepped.time() < self.scene.duration() - 1e-9 {
            account.step(&mut stepped)?;
        }
        Ok(account.close(self))
    }
}

/// A line of the table: a scene and a motion, its variants put together, at each Δt.
pub struct EnergyLine {
    /// What falls.
    pub scene: DropScene,
    /// How its blocks move.
    pub motion: Motion,
    /// For each Δt the runs of all variants.
    pub runs: Vec<Vec<EnergyResult>>,
}

/// Every run of the table.
///
/// # Errors
/// When one cannot be made.
pub fn measure(tell: impl Fn(&EnergyResult) + Sync) -> Result<Vec<EnergyLine>, CaseFailure> {
    let mut lines = Vec::new();
    for scene in DropScene::ALL {
        for motion in [Motion::Rigid, Motion::Deformable] {
            let mut runs: Vec<EnergyRun> =
                TIME_STEPS.iter().flat_map(|&step| EnergyRun::variants(scene, motion, step)).collect();
            // Those of many steps first, so that no thread is left alone with one.
            runs.sort_by(|one, other| one.time_step.total_cmp(&other.time_step));
            let measured: Vec<EnergyResult> = runs
                .into_par_iter()
                .map(|run| run.measure::<SpecRules>().inspect(&tell))
                .collect::<Result<_, CaseFailure>>()?;
            let at = |step: &f64| measured.iter().filter(|result| result.run.time_step == *step).cloned().collect();
            lines.push(EnergyLine { scene, motion, runs: TIME_STEPS.iter().map(at).collect() });
        }
    }
    Ok(lines)
}
