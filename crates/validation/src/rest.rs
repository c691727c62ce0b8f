//! Blocks at rest on one another: forces in contacts carry the weight above.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, relative, worst};
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![
        Floor { penetration: false }.case::<M>(
            "rest on a floor: normal forces",
            "their sum is the weight",
            ("relative", Some(1e-9)),
        ),
        Floor { penetration: true }.case::<M>(
            "rest on a floor: penetration",
            "W/(p·contacts)",
            ("relative", Some(1e-9)),
        ),
        Stack.case::<M>(
            "stack of 10 blocks: forces",
            "each interface bears the weight above",
            ("relative", Some(1e-6)),
        ),
    ]
}

/// A block on a floor.
#[derive(Clone, Copy)]
struct Floor {
    penetration: bool,
}

impl Measure for Floor {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open("rest_on_floor")?;
        lab.run()?;
        let weight = lab.mass(1) * lab.gravity()[2].abs();
        if !self.penetration {
            let force = -lab.force(0, 1)[2];
            return Ok(CaseMeasurement::new(relative(force, weight), format!("{force:.6} N for {weight:.6} N")));
        }
        let count = lab.contacts(0, 1).count();
        let expected = weight / (lab.stiffness(0, 1)[0] * count as f64);
        let gaps = lab.contacts(0, 1).map(|contact| -contact.gap.to_f64());
        let error = worst(gaps.map(|gap| relative(gap, expected)));
        Ok(CaseMeasurement::new(error, format!("{count} contacts, {expected:.6e} m each")))
    }
}

/// Ten blocks on a floor.
#[derive(Clone, Copy)]
struct Stack;

impl Measure for Stack {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open("stack_of_10")?;
        lab.run()?;
        let top = lab.scene.blocks.len() - 1;
        let above = |block: usize| (block..=top).map(|k| lab.mass(k)).sum::<f64>() * lab.gravity()[2].abs();
        let error = |block: usize| relative(-lab.force(block as u32 - 1, block as u32)[2], above(block));
        Ok(CaseMeasurement::new(worst((1..=top).map(error)), format!("{:.3} N at the floor", -lab.force(0, 1)[2])))
    }
}
