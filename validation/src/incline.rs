//! A block on a 3-4-5 incline: Coulomb friction in motion and at rest, settled and not.

use crate::case::{Case, Engine, Measure, Measured};
use crate::lab::{Failure, Lab, number, relative, scene};
use rockproof::stepper::dynamics::StepRules;

/// tan φ as in names of scenes and as a number.
const FRICTIONS: [(&str, f64); 3] = [("0", 0.0), ("1_4", 0.25), ("1_2", 0.5)];

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<Case> {
    let mut all = Vec::new();
    for settled in [true, false] {
        for (name, friction) in FRICTIONS {
            let bound = match (settled, friction == 0.0) {
                (true, true) => Some(1e-12),
                (true, false) => Some(1e-3),
                (false, _) => None,
            };
            let state = if settled { "settled" } else { "not settled" };
            let slide = Slide { friction: name, settled, time_step: None };
            let title = format!("incline, tan φ = {}, {state}, 0.5 s", name.replace('_', "/"));
            all.push(slide.case::<M>(title, "½g(sin α − cos α tan φ)t²", ("relative", bound)));
        }
    }
    let slips = "slips of the springs";
    all.push(Rest { growth: false }.case::<M>(
        "incline, tan φ = 4/5, settled, 0.5 s: drift",
        "rests within mg sin α/Σp_s",
        (slips, Some(1.0)),
    ));
    all.push(Rest { growth: true }.case::<M>(
        "incline, tan φ = 4/5, settled: drift from 1 s to 2 s",
        "does not grow",
        (slips, Some(1e-9)),
    ));
    all
}

/// A block that slides for half a second.
#[derive(Clone, Copy, Debug)]
pub struct Slide {
    /// tan φ as in the scene's name: `0`, `1_4` or `1_2`.
    pub friction: &'static str,
    /// Whether the scene is settled before.
    pub settled: bool,
    /// Δt in s, or the scene's own.
    pub time_step: Option<f64>,
}

/// How a sliding block moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slid {
    /// The distance (m).
    pub way: f64,
    /// What is known of it (m).
    pub known: f64,
    /// Steps in which a contact of the block was open.
    pub open: usize,
    /// All steps.
    pub steps: usize,
    /// Attempts given up.
    pub retries: usize,
}

impl Slide {
    /// Lets it slide.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn run<R: Engine, M: StepRules>(&self) -> Result<Slid, Failure> {
        let state = if self.settled { "settled" } else { "unsettled" };
        let mut scene = scene(&format!("incline_{}_{state}", self.friction))?;
        if let Some(step) = self.time_step {
            scene.simulation.control.time_step = number(step)?;
        }
        let friction = scene.simulation.joints.other.friction.approximate();
        let mut lab = Lab::<R, M>::new(scene)?;
        lab.settle()?;
        let begin = lab.centroid(1)[0];
        let [mut open, mut steps, mut retries] = [0; 3];
        lab.run_watched(|lab| {
            let report = lab.last.as_ref();
            let modes =
                |report: &rockproof::stepper::dynamics::StepReport| report.contacts.iter().any(|kind| kind[0] > 0);
            steps += 1;
            open += usize::from(report.is_some_and(modes));
            retries += report.map_or(0, |report| report.retries.len());
        })?;
        let (pull, time) = (lab.gravity(), lab.time());
        let known = 0.5 * (pull[0].abs() - pull[2].abs() * friction) * time * time;
        Ok(Slid { way: begin - lab.centroid(1)[0], known, open, steps, retries })
    }
}

impl Measure for Slide {
    fn measure<R: Engine, M: StepRules>(&self) -> Result<Measured, Failure> {
        let Slid { way, known, open, steps, .. } = self.run::<R, M>()?;
        let seen = format!("{way:.6} m for {known:.6} m; a contact open in {open} of {steps} steps");
        Ok(Measured::new(relative(way, known), seen))
    }
}

/// A block that rests; drift is counted in static slips of its shear springs.
#[derive(Clone, Copy)]
struct Rest {
    growth: bool,
}

impl Measure for Rest {
    fn measure<R: Engine, M: StepRules>(&self) -> Result<Measured, Failure> {
        let mut lab = Lab::<R, M>::open("incline_4_5_settled")?;
        let placed = lab.centroid(1)[0];
        lab.settle()?;
        let settled = lab.centroid(1)[0];
        lab.run()?;
        let mut half = lab.centroid(1)[0];
        while self.growth && lab.time() < 2.0 - 1e-6 {
            if lab.time() < 1.0 + 1e-6 {
                half = lab.centroid(1)[0];
            }
            lab.step()?;
        }
        let slip = lab.mass(1) * lab.gravity()[0].abs() / (4.0 * lab.stiffness(0, 1)[1]);
        let end = lab.centroid(1)[0];
        let (drift, late) = ((end - settled).abs() / slip, (end - half).abs() / slip);
        let seen = format!("slip {slip:.3e} m; settling moved it by {:.6} slips", (settled - placed).abs() / slip);
        Ok(Measured::new(if self.growth { late } else { drift }, seen))
    }
}
