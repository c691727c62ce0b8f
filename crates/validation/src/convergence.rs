//! How errors shrink with Δt: measured orders, and what start-up costs on an incline.

use crate::case::CasePrecision;
use crate::incline::{FirstSwing, Slide, Start};
use crate::stepped_scene::{CaseFailure, SteppedScene, number, relative, scene};
use crate::toppling::{self, Tipping};
use rayon::prelude::*;
use rockproof_stepper::contact::SpecRules;

/// Error against Δt for one quantity.
pub struct Study {
    /// The name of its plot.
    pub name: &'static str,
    /// What is measured.
    pub title: &'static str,
    /// The closed form.
    pub known: &'static str,
    /// The order in Δt that is expected, where there is one.
    pub order: Option<f64>,
    /// What to say of it.
    pub why: &'static str,
    time_steps: &'static [f64],
    f64: fn(f64) -> Result<f64, CaseFailure>,
    f32: fn(f64) -> Result<f64, CaseFailure>,
}

/// Errors by Δt.
pub struct Curve {
    /// Δt (s) and error in f64 and f32.
    pub points: Vec<(f64, f64, f64)>,
    /// The slope of log error over log Δt in f64, by least squares.
    pub order: f64,
}

impl Study {
    /// Measures all points.
    ///
    /// # Errors
    /// When a run fails.
    pub fn measure(&self) -> Result<Curve, CaseFailure> {
        let point = |&step: &f64| Ok((step, (self.f64)(step)?, (self.f32)(step)?));
        let points = self.time_steps.par_iter().map(point).collect::<Result<Vec<_>, CaseFailure>>()?;
        let order = slope(points.iter().map(|&(step, error, _)| (step.ln(), error.ln())));
        Ok(Curve { points, order })
    }
}

/// The slope of a line through points, by least squares.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = points.clone().count() as f64;
    let (x, y) = points.clone().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / count, y + b / count));
    let (above, below) = points.fold((0.0, 0.0), |(u, v), (a, b)| (u + (a - x) * (b - y), v + (a - x) * (a - x)));
    above / below
}

/// Fine enough that no step is cut by `max_rotation`.
const TURNING: &[f64] = &[0.01, 0.005, 0.002, 0.001, 0.0005];
const COARSE: &[f64] = &[0.02, 0.01, 0.005, 0.002, 0.001];
const SLIDING: &[f64] = &[0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002];

/// All studies.
pub fn studies() -> Vec<Study> {
    vec![
        Study {
            name: "ramp",
            title: "a free block under a force that grows with time: distance in 1 s",
            known: "F₁t³/6m",
            order: Some(1.0),
            why: "The load is that at the end of the step.",
            time_steps: COARSE,
            f64: ramp::<f64>,
            f32: ramp::<f32>,
        },
        Study {
            name: "spring",
            title: "a block dropped onto springs (fixed points): where it is after 0.5 s",
            known: "g/ω² (1 − cos ωt)",
            order: Some(1.0),
            why: "The spring's force is that at the end of the step, too: it damps like a dashpot of k Δt/2.",
            time_steps: COARSE,
            f64: spring::<f64>,
            f32: spring::<f32>,
        },
        Study {
            name: "turn",
            title: "a block that turns freely: its angle after 1 s",
            known: "ωt",
            order: Some(2.0),
            why: "A step turns by 2 atan(ωΔt/2).",
            time_steps: TURNING,
            f64: turn::<f64>,
            f32: turn::<f32>,
        },
        Study {
            name: "tipping",
            title: "a slender block tips over its edge: time from 0.05 to 0.8 rad",
            known: "θ'' = (3g/4R) sin θ",
            order: Some(1.0),
            why: "A step turns the block by the moment that its weight had before it.",
            time_steps: TURNING,
            f64: tipping::<f64>,
            f32: tipping::<f32>,
        },
        Study {
            name: "incline-well-settled",
            title: "incline, tan φ = 1/2, settled to a millionth: distance in 0.5 s",
            known: "½g(sin α − cos α tan φ)t²",
            order: None,
            why: "Large Δt damp the rocking that begins with the slip; small ones converge to it.",
            time_steps: SLIDING,
            f64: well_settled::<f64>,
            f32: well_settled::<f32>,
        },
        Study {
            name: "incline-settled",
            title: "incline, tan φ = 1/2, five settling steps: distance in 0.5 s",
            known: "½g(sin α − cos α tan φ)t²",
            order: None,
            why: "Five static steps leave the more of the imbalance the smaller Δt is.",
            time_steps: SLIDING,
            f64: settled::<f64>,
            f32: settled::<f32>,
        },
        Study {
            name: "incline-unsettled",
            title: "incline, tan φ = 1/2, not settled: distance in 0.5 s",
            known: "½g(sin α − cos α tan φ)t²",
            order: None,
            why: "The block bounces on its springs, and the less it is damped the smaller Δt is.",
            time_steps: SLIDING,
            f64: unsettled::<f64>,
            f32: unsettled::<f32>,
        },
    ]
}

/// A scene with another Δt, at its beginning.
fn stepped_scene<R: CasePrecision>(name: &str, time_step: f64) -> Result<SteppedScene<R, SpecRules>, CaseFailure> {
    let mut scene = scene(name)?;
    scene.simulation.control.time_step = number(time_step)?;
    SteppedScene::new(scene)
}

fn ramp<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    let mut lab = stepped_scene::<R>("ramp_load", time_step)?;
    let begin = lab.centroid(0)[0];
    lab.run()?;
    let time = lab.time();
    // 7800 N a second on 2600 kg.
    Ok(relative(lab.centroid(0)[0] - begin, 3.0 * time * time * time / 6.0))
}

fn spring<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    let mut lab = stepped_scene::<R>("spring", time_step)?;
    let begin = lab.centroid(0)[2];
    lab.run()?;
    // Eight springs of 32500 N/m on 2600 kg: ω = 10/s.
    let (pull, omega) = (lab.gravity()[2], 10.0);
    let known = pull / (omega * omega) * (1.0 - (omega * lab.time()).cos());
    Ok(relative(lab.centroid(0)[2] - begin, known))
}

fn turn<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    let mut lab = stepped_scene::<R>("rotation_cayley", time_step)?;
    let angle = |lab: &SteppedScene<R, SpecRules>| {
        let (a, b) = (lab.vertex(0, 0), lab.vertex(0, 1));
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    let begin = angle(&lab);
    while lab.time() < 1.0 - 1e-6 {
        lab.step()?;
    }
    Ok(relative(angle(&lab) - begin, lab.velocity(0)[5] * lab.time()))
}

fn tipping<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    Ok(relative(Tipping { time_step }.time::<R, SpecRules>()?, toppling::known()))
}

fn sliding<R: CasePrecision>(start: Start, time_step: f64) -> Result<f64, CaseFailure> {
    let slid = Slide { friction: "1_2", start, time_step: Some(time_step) }.run::<R, SpecRules>()?;
    Ok(relative(slid.way, slid.known))
}

fn well_settled<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    sliding::<R>(Start::WellSettled, time_step)
}

fn settled<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    sliding::<R>(Start::Settled, time_step)
}

fn unsettled<R: CasePrecision>(time_step: f64) -> Result<f64, CaseFailure> {
    sliding::<R>(Start::Unsettled, time_step)
}

/// What start-up costs at one Δt.
pub struct StartUp {
    /// Δt (s).
    pub time_step: f64,
    /// For each [`Start`]: the error, positive when the block went too far, and the share of steps with an open contact.
    pub errors: [(f64, f64); 3],
}

/// Sliding distances on the incline, tan φ = 1/2, by Δt and start, in f64.
///
/// # Errors
/// When a run fails.
pub fn start_up() -> Result<Vec<StartUp>, CaseFailure> {
    let one = |start: Start, step: f64| -> Result<(f64, f64), CaseFailure> {
        let slid = Slide { friction: "1_2", start, time_step: Some(step) }.run::<f64, SpecRules>()?;
        Ok(((slid.way - slid.known) / slid.known, slid.open as f64 / slid.steps as f64))
    };
    let all = |&time_step: &f64| {
        let starts = [Start::Unsettled, Start::Settled, Start::WellSettled];
        let errors = starts.map(|start| one(start, time_step));
        let [a, b, c] = errors;
        Ok(StartUp { time_step, errors: [a?, b?, c?] })
    };
    SLIDING.par_iter().map(all).collect()
}

/// What the first swing costs with the joints of the scene and with stiffer ones.
///
/// # Errors
/// When a run fails.
pub fn first_swings() -> Result<Vec<FirstSwing>, CaseFailure> {
    [1.0, 10.0, 100.0].par_iter().map(|&stiffer| FirstSwing::measure::<SpecRules>(stiffer)).collect()
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn finds_the_slope_of_a_line() {
        let points = [(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)];
        assert!((slope(points.into_iter()) - 2.0).abs() < 1e-12);
    }
}
