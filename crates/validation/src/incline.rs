//! A block on a 3-4-5 incline: Coulomb friction in motion and at rest, settled and not.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, number, relative, scene};
use rockproof_stepper::dynamics::StepRules;

/// tan φ as in names of scenes and as a number.
const FRICTIONS: [(&str, f64); 3] = [("0", 0.0), ("1_4", 0.25), ("1_2", 0.5)];

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let mut all = Vec::new();
    for start in [Start::Settled, Start::Unsettled] {
        for (name, friction) in FRICTIONS {
            let (state, bound) = match (start, friction == 0.0) {
                (Start::Unsettled, _) => ("not settled", None),
                (_, true) => ("settled", Some(1e-12)),
                (_, false) => ("settled", Some(1e-3)),
            };
            let slide = Slide { friction: name, start, time_step: None };
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

/// How a run on the incline begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Without overlap: the normal force has to build up.
    Unsettled,
    /// After the scene's five static steps.
    Settled,
    /// After as many static steps as leave a millionth of the imbalance, which depends on Δt.
    WellSettled,
}

/// A block that slides for half a second.
#[derive(Clone, Copy, Debug)]
pub struct Slide {
    /// tan φ as in the scene's name: `0`, `1_4` or `1_2`.
    pub friction: &'static str,
    /// How the run begins.
    pub start: Start,
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
    pub fn run<R: CasePrecision, M: StepRules>(&self) -> Result<Slid, CaseFailure> {
        let state = if self.start == Start::Unsettled { "unsettled" } else { "settled" };
        let mut scene = scene(&format!("incline_{}_{state}", self.friction))?;
        if let Some(step) = self.time_step {
            scene.simulation.control.time_step = number(step)?;
        }
        if self.start == Start::WellSettled {
            scene.simulation.control.settle = enough(scene.simulation.control.time_step.approximate(), 1.0);
        }
        let friction = scene.simulation.joints.other.friction.approximate();
        let mut lab = SteppedScene::<R, M>::new(scene)?;
        lab.settle()?;
        let begin = lab.centroid(1)[0];
        let [mut open, mut steps, mut retries] = [0; 3];
        lab.run_watched(|lab| {
            let report = lab.last.as_ref();
            let modes =
                |report: &rockproof_stepper::dynamics::StepReport| report.contacts.iter().any(|kind| kind[0] > 0);
            steps += 1;
            open += usize::from(report.is_some_and(modes));
            retries += report.map_or(0, |report| report.retries.len());
        })?;
        let (pull, time) = (lab.gravity(), lab.time());
        let known = 0.5 * (pull[0].abs() - pull[2].abs() * friction) * time * time;
        Ok(Slid { way: begin - lab.centroid(1)[0], known, open, steps, retries })
    }
}

/// Static steps after which a millionth of the imbalance is left. A static step leaves I/(I + K) of it, I = 2m/Δt² for 2600 kg and
/// K = 4 p_s = 1.6e8 N/m, the softest spring, times `stiffer`.
fn enough(time_step: f64, stiffer: f64) -> u32 {
    let inertia = 2.0 * 2600.0 / (time_step * time_step);
    let left = inertia / (inertia + stiffer * 1.6e8);
    (1e-6f64.ln() / left.ln()).ceil().max(5.0) as u32
}

/// What is lost of friction when contacts begin to slide, tan φ = 1/2, settled to a millionth, Δt = 0.2 ms, in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstSwing {
    /// How many times as stiff as the scene's the joints are.
    pub stiffer: f64,
    /// The impulse of friction that is missing after 20 ms (N s).
    pub missing: f64,
    /// The error of the distance in 0.5 s, positive when the block went too far.
    pub error: f64,
}

impl FirstSwing {
    /// Measures it with joints so many times as stiff.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn measure<M: StepRules>(stiffer: f64) -> Result<FirstSwing, CaseFailure> {
        let time_step = 2e-4;
        let mut scene = scene("incline_1_2_settled")?;
        scene.simulation.control.time_step = number(time_step)?;
        scene.simulation.control.settle = enough(time_step, stiffer);
        let joint = &mut scene.simulation.joints.other;
        let stiffness = joint.normal_stiffness.as_ref().map_or(f64::NAN, |stiffness| stiffness.approximate());
        joint.normal_stiffness = Some(number(stiffer * stiffness)?);
        let friction = joint.friction.approximate();
        let mut lab = SteppedScene::<f64, M>::new(scene)?;
        lab.settle()?;
        let begin = lab.centroid(1)[0];
        let pull = lab.gravity();
        let rate = pull[0].abs() - pull[2].abs() * friction;
        while lab.time() < 0.02 - 1e-9 {
            lab.step()?;
        }
        let missing = lab.mass(1) * (-lab.velocity(1)[0] - rate * lab.time());
        lab.run()?;
        let known = 0.5 * rate * lab.time() * lab.time();
        Ok(FirstSwing { stiffer, missing, error: (begin - lab.centroid(1)[0] - known) / known })
    }
}

impl Measure for Slide {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let Slid { way, known, open, steps, .. } = self.run::<R, M>()?;
        let seen = format!("{way:.6} m for {known:.6} m; a contact open in {open} of {steps} steps");
        Ok(CaseMeasurement::new(relative(way, known), seen))
    }
}

/// A block that rests; drift is counted in static slips of its shear springs.
#[derive(Clone, Copy)]
struct Rest {
    growth: bool,
}

impl Measure for Rest {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open("incline_4_5_settled")?;
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
        Ok(CaseMeasurement::new(if self.growth { late } else { drift }, seen))
    }
}
