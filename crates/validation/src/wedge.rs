//! A wedge on two planes: the limit-equilibrium factor decides whether it slides.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, number, relative, scene};
use rockproof_stepper::dynamics::StepRules;

/// tan φ at which the factor is 1: N1 + N2 = 33/21 W⊥, W∥/W⊥ = 3/4.
const CRITICAL: f64 = 21.0 / 44.0;
/// Acceleration along the line without friction, m/s²: g sin ψ.
const ALONG: f64 = 6.0;
/// Factors to both sides of 1.
const FACTORS: [f64; 4] = [0.9, 0.99, 1.01, 1.1];
/// When the first slip of the springs is over for every factor (s).
const LATE: f64 = 1.5;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![
        LimitEquilibrium.case::<M>(
            "wedge on two planes: factors 0.9, 0.99, 1.01, 1.1",
            "slides below 1, holds above",
            ("largest distance from 1 that goes wrong", Some(0.0099)),
        ),
        AccelerationFactor { factor: 0.99 }.case::<M>(
            "wedge on two planes, 0.99: factor that its acceleration shows",
            "a = g sin ψ (1 − F)",
            ("relative", Some(0.01)),
        ),
        AccelerationFactor { factor: 0.5 }.case::<M>(
            "wedge on two planes, 1/2: factor that its acceleration shows",
            "a = g sin ψ (1 − F)",
            ("relative", Some(0.01)),
        ),
    ]
}

/// The wedge with a factor, settled.
fn stepped_scene<R: CasePrecision, M: StepRules>(factor: f64) -> Result<SteppedScene<R, M>, CaseFailure> {
    let mut scene = scene("wedge")?;
    scene.simulation.joints.other.friction = number(factor * CRITICAL)?;
    let mut lab = SteppedScene::new(scene)?;
    lab.settle()?;
    Ok(lab)
}

/// Steps until a time (s).
fn until<R: CasePrecision, M: StepRules>(lab: &mut SteppedScene<R, M>, time: f64) -> Result<(), CaseFailure> {
    while lab.time() < time - 1e-6 {
        lab.step()?;
    }
    Ok(())
}

/// Whether it slides, to both sides of 1.
///
/// Settling locks every contact, so that shear springs across the line bear part of the weight and normal forces begin too low: the
/// wedge starts with a slip of some centimetres a second whatever the factor. What counts is whether it comes to rest.
#[derive(Clone, Copy)]
struct LimitEquilibrium;

impl Measure for LimitEquilibrium {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let (mut error, mut seen) = (0.0f64, Vec::new());
        for factor in FACTORS {
            let mut lab = stepped_scene::<R, M>(factor)?;
            until(&mut lab, 0.1)?;
            let early = -lab.velocity(2)[0];
            until(&mut lab, LATE)?;
            let late = -lab.velocity(2)[0];
            let right = if factor < 1.0 { late > early } else { late.abs() < 1e-4 };
            if !right {
                error = error.max((factor - 1.0).abs());
            }
            seen.push(format!("{factor}: {early:.1e} to {late:.1e}"));
        }
        Ok(CaseMeasurement::new(error, format!("m/s after 0.1 s and 1.5 s: {}", seen.join(", "))))
    }
}

/// The factor that the acceleration of a moving wedge shows.
#[derive(Clone, Copy)]
struct AccelerationFactor {
    factor: f64,
}

impl Measure for AccelerationFactor {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = stepped_scene::<R, M>(self.factor)?;
        until(&mut lab, 0.25)?;
        let (early, begun) = (-lab.velocity(2)[0], lab.time());
        until(&mut lab, 0.5)?;
        let acceleration = (-lab.velocity(2)[0] - early) / (lab.time() - begun);
        let shown = 1.0 - acceleration / ALONG;
        let known = ALONG * (1.0 - self.factor);
        Ok(CaseMeasurement::new(relative(shown, self.factor), format!("{acceleration:.5} m/s² for {known:.5}")))
    }
}
