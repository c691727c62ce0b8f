//! Impacts: contacts act on both blocks alike.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, length, minus, worst};
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let momentum = ("relative to one block's", Some(1e-12));
    vec![
        Impact("head_on_impact").case::<M>("head-on impact: momentum", "the sum stays", momentum),
        Impact("corner_impact").case::<M>("impact of two corners: momentum", "the sum stays", momentum),
        Impact("corner_impact_deformable").case::<M>(
            "the same, deformable: mass follows the present volume",
            "the sum stays",
            ("relative to one block's", None),
        ),
    ]
}

/// Two blocks that meet.
#[derive(Clone, Copy)]
struct Impact(&'static str);

impl Measure for Impact {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(self.0)?;
        let of = |lab: &SteppedScene<R, M>, block: usize| {
            let all = lab.momenta(block);
            [all[0], all[1], all[2]]
        };
        let sum = |lab: &SteppedScene<R, M>| {
            let (one, other) = (of(lab, 0), of(lab, 1));
            std::array::from_fn(|k| one[k] + other[k])
        };
        let (begin, own) = (sum(&lab), of(&lab, 1));
        let (mut error, mut touched, mut energy) = (0.0, 0, [0.0; 2]);
        lab.run_watched(|lab| {
            error = worst([error, length(minus(sum(lab), begin)) / length(own)]);
            touched += usize::from(lab.contacts(0, 1).any(|contact| contact.mode.is_closed()));
            let now = lab.last.as_ref().map_or(0.0, |last| last.kinetic);
            energy = [if energy[0] == 0.0 { now } else { energy[0] }, now];
        })?;
        if touched == 0 || of(&lab, 1) == own {
            return Err(CaseFailure::Unexpected("the blocks do not meet".to_owned()));
        }
        let kept = 100.0 * energy[1] / energy[0];
        Ok(CaseMeasurement::new(
            error,
            format!("in contact for {touched} steps; {kept:.1} % of the kinetic energy left"),
        ))
    }
}
