//! A slender block tips over an edge: against the equation of motion, integrated here.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, cuboid, hexahedron, number, polyhedron, relative, vector};
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::StepRules;

/// Breadth, depth and height of the block (m).
const SIZE: [f64; 3] = [0.4, 1.0, 2.0];
/// m/s².
const GRAVITY: f64 = 10.0;
/// How far its diagonal leans beyond the upright at the start, and where it is timed (rad). Up to there it neither slides by tan φ = 1 nor lifts off.
const LEANS: [f64; 2] = [0.05, 0.8];
/// kg/m³.
const DENSITY: f64 = 2600.0;
/// N/m.
const STIFFNESS: f64 = 1e10;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![Tipping { time_step: 1e-3 }.case::<M>(
        "a slender block tips over its edge: time from 0.05 to 0.8 rad",
        "θ'' = (3g/4R) sin θ, R half the diagonal of its face",
        ("relative", Some(5e-4)),
    )]
}

/// How long a block of half diagonal R (m) takes, from rest at one lean of the diagonal to another (s): θ'' = (3g/4R) sin θ by Runge and
/// Kutta's rule of order four, in steps of 10 µs; the last one is shortened to end at the lean.
pub fn tipping_time(radius: f64, [from, to]: [f64; 2]) -> f64 {
    let pull = |angle: f64| 0.75 * GRAVITY / radius * angle.sin();
    let step = |[angle, rate]: [f64; 2], h: f64| {
        let slope = |[angle, rate]: [f64; 2]| [rate, pull(angle)];
        let ahead = |k: [f64; 2], h: f64| [angle + h * k[0], rate + h * k[1]];
        let a = slope([angle, rate]);
        let b = slope(ahead(a, h / 2.0));
        let c = slope(ahead(b, h / 2.0));
        let d = slope(ahead(c, h));
        [0, 1].map(|k| [angle, rate][k] + h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]))
    };
    let (mut state, mut time, h) = ([from, 0.0], 0.0, 1e-5);
    loop {
        let next = step(state, h);
        if next[0] >= to {
            // The rate hardly changes within one step.
            return time + (to - state[0]) / (0.5 * (state[1] + next[1]));
        }
        (state, time) = (next, time + h);
    }
}

/// The block in a step of its own.
#[derive(Clone, Copy)]
pub struct Tipping {
    /// Δt (s).
    pub time_step: f64,
}

impl Tipping {
    /// The block leans on its lower edge along y, which overlaps the floor as it does at rest.
    fn scene(&self) -> Result<Scene, CaseFailure> {
        let [breadth, depth, height] = SIZE;
        let mut scene = Scene::on_fixed("floor", cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0])?);
        // The diagonal from the edge at x = 0 leans by LEANS[0] towards +x.
        let (sine, cosine) = (LEANS[0] + (breadth / height).atan()).sin_cos();
        let sunk = breadth * depth * height * DENSITY * GRAVITY / (2.0 * STIFFNESS);
        let leaning = |[x, y, z]: [f64; 3]| [x * cosine + z * sine, y, z * cosine - x * sine - sunk];
        let base = |z: f64| [[-breadth, 0.0, z], [0.0, 0.0, z], [0.0, depth, z], [-breadth, depth, z]];
        let points = base(0.0).into_iter().chain(base(height)).map(leaning);
        let mut block = SceneBlock::new("slender", polyhedron(points, hexahedron())?);
        block.body.motion = Motion::Rigid;
        scene.blocks.push(block);
        scene.simulation.gravity = vector([0.0, 0.0, -GRAVITY])?;
        scene.simulation.control.time_step = number(self.time_step)?;
        scene.simulation.materials[0].density = number(DENSITY)?;
        let joint = &mut scene.simulation.joints.other;
        (joint.friction, joint.normal_stiffness) = (number(1.0)?, Some(number(STIFFNESS)?));
        Ok(scene)
    }

    /// When its diagonal passes `LEANS[1]` (s), between two steps by a straight line.
    ///
    /// # Errors
    /// When the scene cannot be run.
    pub fn time<R: CasePrecision, M: StepRules>(&self) -> Result<f64, CaseFailure> {
        let mut stepped = SteppedScene::<R, M>::new(self.scene()?)?;
        // Vertex 1 is on the edge, 7 at the other end of its diagonal but for y.
        let lean = |stepped: &SteppedScene<R, M>| {
            let (low, high) = (stepped.vertex(1, 1), stepped.vertex(1, 7));
            (high[0] - low[0]).atan2(high[2] - low[2])
        };
        let mut before = [0.0, lean(&stepped)];
        while stepped.time() < 5.0 {
            stepped.step()?;
            let now = [stepped.time(), lean(&stepped)];
            if now[1] >= LEANS[1] {
                return Ok(before[0] + (now[0] - before[0]) * (LEANS[1] - before[1]) / (now[1] - before[1]));
            }
            before = now;
        }
        Err(CaseFailure::Unexpected("the block does not tip".to_owned()))
    }
}

/// The time by the equation (s).
pub fn known() -> f64 {
    tipping_time(0.5 * SIZE[0].hypot(SIZE[2]), LEANS)
}

impl Measure for Tipping {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let (found, known) = (self.time::<R, M>()?, known());
        Ok(CaseMeasurement::new(relative(found, known), format!("{found:.6} s for {known:.6} s")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up to small leans the equation is that of an exponential: θ = θ0 cosh(λt).
    #[test]
    fn a_small_lean_grows_as_the_hyperbolic_cosine() {
        let rate = (0.75f64 * GRAVITY).sqrt();
        let known = 10f64.acosh() / rate;
        assert!((tipping_time(1.0, [1e-5, 1e-4]) - known).abs() < 1e-8 * known);
    }
}
