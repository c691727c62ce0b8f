//! A row of dominoes: how fast it falls, against rigid dominoes that turn about their edges.
//!
//! The reference is calculated here and shares nothing with the stepper: the upper edge of each domino that has fallen slides without friction
//! along the face of the next, so that the lean of the foremost decides all others; between impacts energy is kept, and an impact
//! is plastic: the next domino joins the others, and the momentum that goes with their common motion stays.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, cuboid, number, relative, vector, without_open_close_tolerance};
use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::{FixedPoint, JointPair, JointProperties, Unconverged};
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::StepRules;

/// Thickness of a domino (m).
const THICK: f64 = 0.1;
/// Its width (m).
const WIDE: f64 = 0.5;
/// Its height (m).
const HIGH: f64 = 1.0;
/// From one domino to the next (m).
const PITCH: f64 = 0.4;
/// How many there are.
const COUNT: usize = 14;
/// Between the falls of these two the speed is measured.
const BETWEEN: [usize; 2] = [7, 12];
/// How fast the first one turns at the start (rad/s).
const SPIN: f64 = 1.5;
/// m/s².
const GRAVITY: f64 = 10.0;
/// N/m.
const STIFFNESS: f64 = 1e8;

/// How far the wave of hinged dominoes may be from that of rigid ones, relative.
pub const NEAR: f64 = 0.02;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![Row { hinged: true, time_step: 1e-3 }.case::<M>(
        "a row of dominoes hinged at their edges: speed of the wave",
        "rigid dominoes, plastic impacts, no friction between them",
        ("relative", Some(NEAR)),
    )]
}

/// A row of dominoes.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Whether springs hold the edges about which they turn; else they stand on a floor with tan φ = 1.
    pub hinged: bool,
    /// Δt (s).
    pub time_step: f64,
}

/// The rows of the table: both kinds at Δt from 5 to 0.2 ms.
pub fn rows() -> Vec<Row> {
    let both = |time_step| [true, false].map(|hinged| Row { hinged, time_step });
    [5e-3, 2e-3, 1e-3, 5e-4, 2e-4].into_iter().flat_map(both).collect()
}

impl Row {
    fn scene(&self) -> Result<Scene, CaseFailure> {
        let length = PITCH * COUNT as f64;
        let mut scene = Scene::on_fixed("floor", cuboid([-1.0, -1.0, -0.5], [length + 2.0, 1.0, 0.0])?);
        for k in 0..COUNT {
            let edge = PITCH * k as f64;
            let mut block =
                SceneBlock::new(format!("domino_{k}"), cuboid([edge - THICK, 0.0, 0.0], [edge, WIDE, HIGH])?);
            (block.body.motion, block.body.joint) = (Motion::Rigid, 1);
            if k == 0 {
                block.body.spin = vector([0.0, SPIN, 0.0])?;
                // About the edge at z = 0.
                block.body.velocity = vector([SPIN * HIGH / 2.0, 0.0, SPIN * THICK / 2.0])?;
            }
            scene.blocks.push(block);
            if self.hinged {
                for y in [0.0, WIDE] {
                    let (at, stiffness) = (vector([edge, y, 0.0])?, Some(number(STIFFNESS)?));
                    scene.simulation.fixed_points.push(FixedPoint { block: k + 1, at, stiffness });
                }
            }
        }
        scene.tolerances = Some(without_open_close_tolerance()?);
        scene.simulation.gravity = vector([0.0, 0.0, -GRAVITY])?;
        let control = &mut scene.simulation.control;
        (control.time_step, control.unconverged) = (number(self.time_step)?, Unconverged::Accept);
        let properties = |friction: f64| -> Result<JointProperties, CaseFailure> {
            let normal_stiffness = Some(number(STIFFNESS)?);
            Ok(JointProperties { friction: number(friction)?, normal_stiffness, ..JointProperties::default() })
        };
        let joints = &mut scene.simulation.joints;
        joints.names = vec!["floor".to_owned(), "domino".to_owned()];
        joints.pairs = vec![JointPair { one: 1, other: 1, properties: properties(0.0)? }];
        joints.other = properties(if self.hinged { 0.0 } else { 1.0 })?;
        Ok(scene)
    }

    /// The speed of the wave (m/s): between the times at which two dominoes lean as far as they do when they strike the next.
    ///
    /// # Errors
    /// When the scene cannot be run, or the row stops.
    pub fn speed<R: CasePrecision, M: StepRules>(&self) -> Result<f64, CaseFailure> {
        let mut stepped = SteppedScene::<R, M>::new(self.scene()?)?;
        let lean = |stepped: &SteppedScene<R, M>, domino: usize| {
            // Vertex 4 is above vertex 0.
            let (low, high) = (stepped.vertex(domino + 1, 0), stepped.vertex(domino + 1, 4));
            (high[0] - low[0]).atan2(high[2] - low[2])
        };
        let mut times = Vec::new();
        for domino in BETWEEN {
            let mut before = [stepped.time(), lean(&stepped, domino)];
            let time = loop {
                if stepped.time() > 5.0 {
                    return Err(CaseFailure::Unexpected(format!("domino {domino} does not fall")));
                }
                stepped.step()?;
                let now = [stepped.time(), lean(&stepped, domino)];
                if now[1] >= striking_lean() {
                    break before[0] + (now[0] - before[0]) * (striking_lean() - before[1]) / (now[1] - before[1]);
                }
                before = now;
            };
            times.push(time);
        }
        Ok((BETWEEN[1] - BETWEEN[0]) as f64 * PITCH / (times[1] - times[0]))
    }
}

/// The lean at which a domino strikes the next one, which stands (rad).
fn striking_lean() -> f64 {
    ((PITCH - THICK) / HIGH).asin()
}

/// The leans of `count` dominoes of which each rests against the next, the foremost first, and how fast each turns when the foremost turns by
/// 1 rad/s. The upper edge of one is on the face of the next: HIGH·sin(θ − θ') = PITCH·cos θ' − THICK.
fn resting(foremost: f64, count: usize) -> Vec<[f64; 2]> {
    let behind = |[lean, rate]: &[f64; 2]| {
        let sine = (PITCH * lean.cos() - THICK) / HIGH;
        let slower = 1.0 - PITCH * lean.sin() / HIGH / (1.0 - sine * sine).sqrt();
        Some([lean + sine.asin(), rate * slower])
    };
    std::iter::successors(Some([foremost, 1.0]), behind).take(count).collect()
}

/// The speed of the wave of rigid dominoes (m/s).
pub fn rigid_speed() -> f64 {
    // Of a domino of 1 kg.
    let inertia = (HIGH * HIGH + THICK * THICK) / 3.0;
    let height = |[lean, _]: &[f64; 2]| 0.5 * (HIGH * lean.cos() + THICK * lean.sin());
    let potential = |all: &[[f64; 2]]| GRAVITY * all.iter().map(height).sum::<f64>();
    let moving = |all: &[[f64; 2]]| inertia * all.iter().map(|[_, rate]| rate * rate).sum::<f64>();
    let (mut rate, mut time, mut times) = (SPIN, 0.0, Vec::new());
    for count in 1..=BETWEEN[1] + 1 {
        let start = resting(0.0, count);
        let energy = 0.5 * moving(&start) * rate * rate + potential(&start);
        let rate_at = |lean: f64| {
            let all = resting(lean, count);
            (2.0 * (energy - potential(&all)) / moving(&all)).sqrt()
        };
        // dt = dθ/θ', by Simpson's rule.
        const PARTS: usize = 2000;
        let width = striking_lean() / PARTS as f64;
        let weight = |k: usize| match k {
            0 | PARTS => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        time += (0..=PARTS).map(|k| weight(k) / rate_at(k as f64 * width)).sum::<f64>() * width / 3.0;
        times.push(time);
        // The next one, at rest, is taken along.
        let before = moving(&resting(striking_lean(), count));
        rate = rate_at(striking_lean()) * before / (before + inertia);
    }
    (BETWEEN[1] - BETWEEN[0]) as f64 * PITCH / (times[BETWEEN[1]] - times[BETWEEN[0]])
}

/// Whether a speed is near that of rigid dominoes; one that is no number is not.
pub fn is_near(speed: f64) -> bool {
    relative(speed, rigid_speed()) <= NEAR
}

impl Measure for Row {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let (found, known) = (self.speed::<R, M>()?, rigid_speed());
        Ok(CaseMeasurement::new(relative(found, known), format!("{found:.3} m/s for {known:.3} m/s")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rates are the derivatives of the leans.
    #[test]
    fn rates_are_those_of_the_leans() {
        let (lean, small) = (0.2, 1e-6);
        let (one, other, rates) = (resting(lean - small, 5), resting(lean + small, 5), resting(lean, 5));
        for ((one, other), [_, rate]) in one.iter().zip(&other).zip(rates) {
            let difference = (other[0] - one[0]) / (2.0 * small);
            assert!((difference - rate).abs() < 1e-8, "{difference} {rate}");
        }
    }
}
