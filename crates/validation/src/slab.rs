//! A slab that is set moving slides v²/2μg, at every Δt. By version 1 of SPEC it stopped after 0.01 m at Δt = 10 ms.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, cuboid, number, relative, vector, worst};
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::StepRules;

/// m/s.
const SPEED: f64 = 2.0;
/// tan φ.
const FRICTION: f64 = 0.6;
/// m/s².
const PULL: f64 = 10.0;
/// Δt of the case (s).
pub const TIME_STEPS: [f64; 6] = [2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2];

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let names = [(Motion::Rigid, "rigid"), (Motion::Deformable, "deformable")];
    let case = |(motion, name)| {
        let title = format!("a {name} slab set moving at 2 m/s, tan φ = 3/5: distance, Δt 0.2 to 10 ms");
        Slab { motion }.case::<M>(title, "v²/2g tan φ", ("relative, worst of 6", Some(1e-3)))
    };
    names.map(case).into()
}

/// A slab of 1 m × 1 m × ¼ m on a fixed floor, settled, then set moving. It is flat, since a cube tips onto its front edge.
#[derive(Clone, Copy, Debug)]
struct Slab {
    motion: Motion,
}

impl Slab {
    fn scene(self, time_step: f64) -> Result<Scene, CaseFailure> {
        let mut scene = Scene::on_fixed("floor", cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0])?);
        let mut slab = SceneBlock::new("slab", cuboid([0.0; 3], [1.0, 1.0, 0.25])?);
        (slab.body.motion, slab.body.velocity) = (self.motion, vector([SPEED, 0.0, 0.0])?);
        scene.blocks.push(slab);
        let simulation = &mut scene.simulation;
        simulation.gravity = vector([0.0, 0.0, -PULL])?;
        (simulation.control.time_step, simulation.control.settle) = (number(time_step)?, 60);
        let joint = &mut simulation.joints.other;
        (joint.friction, joint.normal_stiffness) = (number(FRICTION)?, Some(number(1e8)?));
        Ok(scene)
    }

    /// How far it slides in half a second, in which it comes to rest (m).
    fn slides<R: CasePrecision, M: StepRules>(self, time_step: f64) -> Result<f64, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::new(self.scene(time_step)?)?;
        lab.settle()?;
        let begun = lab.centroid(1)[0];
        while lab.time() < 0.5 {
            lab.step()?;
        }
        Ok(lab.centroid(1)[0] - begun)
    }
}

impl Measure for Slab {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let known = SPEED * SPEED / (2.0 * PULL * FRICTION);
        let ways = TIME_STEPS.map(|step| self.slides::<R, M>(step));
        let ways = ways.into_iter().collect::<Result<Vec<f64>, _>>()?;
        let at = |(step, way): (f64, &f64)| format!("{way:.5} m at {} ms", 1e3 * step);
        let seen: Vec<String> = TIME_STEPS.into_iter().zip(&ways).map(at).collect();
        let error = worst(ways.into_iter().map(|way| relative(way, known)));
        Ok(CaseMeasurement::new(error, seen.join(", ")))
    }
}
