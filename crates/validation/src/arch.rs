//! A semicircular arch of voussoirs under its own weight.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, length, minus};
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let crown = "crown's way down in 1 s, over t";
    vec![
        Arch("arch_stands").case::<M>("arch, t/R = 0.12", "stands: thinnest t/R = 0.1075", (crown, Some(1e-3))),
        // Falls: the error is how much of a tenth of the thickness is missing.
        Arch("arch_falls").case::<M>(
            "arch, t/R = 0.09",
            "falls",
            ("a tenth of t less the crown's way, over t", Some(0.0)),
        ),
    ]
}

/// An arch; blocks 0 and 1 are its abutments.
#[derive(Clone, Copy)]
struct Arch(&'static str);

impl Measure for Arch {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(self.0)?;
        let thickness = length(minus(lab.vertex(2, 1), lab.vertex(2, 0)));
        // Two voussoirs meet at the crown.
        let height = |lab: &SteppedScene<R, M>| lab.centroid(11)[2].min(lab.centroid(12)[2]);
        let placed = height(&lab);
        lab.settle()?;
        let settled = height(&lab);
        lab.run()?;
        let sunk = (settled - height(&lab)) / thickness;
        let seen = format!("crown sank by {:.1e} t while settling, {sunk:.1e} t after", (placed - settled) / thickness);
        Ok(CaseMeasurement::new(if self.0 == "arch_falls" { (0.1 - sunk).max(0.0) } else { sunk.abs() }, seen))
    }
}
