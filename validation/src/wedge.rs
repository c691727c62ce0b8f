//! A wedge on two planes: the limit-equilibrium factor decides whether it slides.

use crate::case::{Case, Engine, Measure, Measured};
use crate::lab::{Failure, Lab, number, relative, scene};
use rockproof::stepper::dynamics::StepRules;

/// tan φ at which the factor is 1: N1 + N2 = 33/21 W⊥, W∥/W⊥ = 3/4.
const CRITICAL: f64 = 21.0 / 44.0;
/// Acceleration along the line without friction, m/s²: g sin ψ.
const ALONG: f64 = 6.0;
/// Factors to both sides of 1.
const FACTORS: [f64; 8] = [0.9, 0.99, 0.995, 0.999, 1.001, 1.005, 1.01, 1.1];

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<Case> {
    vec![
        Limit.case::<M>(
            "wedge on two planes: factors 0.9 to 1.1",
            "slides below 1, holds above",
            ("largest distance from 1 that goes wrong", Some(0.0099)),
        ),
        Speed.case::<M>(
            "wedge on two planes, factor 1/2: distance in 0.5 s",
            "½g sin ψ (1 − F) t²",
            ("relative", Some(1e-3)),
        ),
    ]
}

/// The wedge with a factor, settled.
fn lab<R: Engine, M: StepRules>(factor: f64) -> Result<Lab<R, M>, Failure> {
    let mut scene = scene("wedge")?;
    scene.simulation.joints.other.friction = number(factor * CRITICAL)?;
    let mut lab = Lab::new(scene)?;
    lab.settle()?;
    Ok(lab)
}

/// Whether it slides, to both sides of 1.
#[derive(Clone, Copy)]
struct Limit;

impl Measure for Limit {
    fn measure<R: Engine, M: StepRules>(&self) -> Result<Measured, Failure> {
        let (mut error, mut seen) = (0.0f64, Vec::new());
        for factor in FACTORS {
            let mut lab = lab::<R, M>(factor)?;
            lab.run()?;
            let slow = lab.time() * ALONG * (1.0 - factor).abs();
            let speed = -lab.velocity(2)[0];
            // Half of the speed that limit equilibrium gives tells sliding from rest.
            if (speed > 0.5 * slow) != (factor < 1.0) {
                error = error.max((factor - 1.0).abs());
            }
            seen.push(format!("{factor}: {speed:.1e}"));
        }
        Ok(Measured::new(error, format!("m/s after 0.5 s: {}", seen.join(", "))))
    }
}

/// How far it slides.
#[derive(Clone, Copy)]
struct Speed;

impl Measure for Speed {
    fn measure<R: Engine, M: StepRules>(&self) -> Result<Measured, Failure> {
        let mut lab = lab::<R, M>(0.5)?;
        let begin = lab.centroid(2)[0];
        lab.run()?;
        let (way, time) = (begin - lab.centroid(2)[0], lab.time());
        let known = 0.25 * ALONG * time * time;
        Ok(Measured::new(relative(way, known), format!("{way:.6} m for {known:.6} m")))
    }
}
