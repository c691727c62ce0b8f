//! Blocks that touch nothing: weight, inertia, rotation.

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, length, minus, relative, worst};
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let exact = ("relative", Some(1e-12));
    vec![
        Flight("free_fall").case::<M>("free fall, 1 s", "x = ½gt², v = gt", exact),
        Flight("thrown_block").case::<M>("thrown block, 1 s", "x = v₀t + ½gt², v = v₀ + gt", exact),
        Turn { scene: "rotation_cayley", what: Conserved::Volume }.case::<M>("a turn, `cayley`: volume", "kept", exact),
        Turn { scene: "rotation_cayley", what: Conserved::Momentum }.case::<M>(
            "a turn, `cayley`: angular momentum",
            "kept",
            exact,
        ),
        Turn { scene: "rotation_cayley", what: Conserved::Energy }.case::<M>("a turn, `cayley`: energy", "kept", exact),
        Turn { scene: "rotation_linear", what: Conserved::Swelling }.case::<M>(
            "a turn, `linear`: volume",
            "swells by (1 + ω²Δt²)ⁿ",
            ("relative to the swelling", Some(1e-9)),
        ),
        Turn { scene: "rotation_linear", what: Conserved::Energy }.case::<M>(
            "a turn, `linear`: energy",
            "kept",
            ("relative", None),
        ),
        Turn { scene: "rotation_skew", what: Conserved::Momentum }.case::<M>(
            "a turn about no principal axis: angular momentum",
            "kept",
            ("relative", None),
        ),
    ]
}

/// A block under weight alone.
#[derive(Clone, Copy)]
struct Flight(&'static str);

impl Measure for Flight {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(self.0)?;
        let (begin, thrown, pull) = (lab.centroid(0), lab.velocity(0), lab.gravity());
        lab.run()?;
        // The time that passed, which fifty or a hundred roundings of Δt make.
        let time = lab.time();
        let (at, rate) = (lab.centroid(0), lab.velocity(0));
        let way: [f64; 3] = std::array::from_fn(|k| thrown[k] * time + 0.5 * pull[k] * time * time);
        let speed: [f64; 3] = std::array::from_fn(|k| thrown[k] + pull[k] * time);
        let moved = minus(at, begin);
        let error = length(minus(moved, way)) / length(way);
        let of_speed = length(minus([rate[0], rate[1], rate[2]], speed)) / length(speed);
        Ok(CaseMeasurement::new(error.max(of_speed), format!("{:.9} m moved", length(moved))))
    }
}

/// What should be kept by a block that turns freely.
#[derive(Clone, Copy)]
enum Conserved {
    Volume,
    Momentum,
    Energy,
    Swelling,
}

/// A block that turns freely, once.
#[derive(Clone, Copy)]
struct Turn {
    scene: &'static str,
    what: Conserved,
}

impl Measure for Turn {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut lab = SteppedScene::<R, M>::open(self.scene)?;
        let momentum = |lab: &SteppedScene<R, M>| {
            let all = lab.momenta(0);
            [all[3], all[4], all[5]]
        };
        let energy = |lab: &SteppedScene<R, M>| {
            lab.momenta(0).iter().zip(lab.velocity(0)).map(|(p, v)| 0.5 * p * v).sum::<f64>()
        };
        let (volume, spin, work) = (lab.dynamics.volume(0), momentum(&lab), energy(&lab));
        let angle_squared = {
            let rates = lab.velocity(0);
            let step = lab.scene.simulation.control.time_step.approximate();
            (3..6).map(|k| rates[k] * rates[k]).sum::<f64>() * step * step
        };
        let (mut largest, mut steps) = ([0.0f64; 3], 0);
        lab.run_watched(|lab| {
            steps += 1;
            let errors = [
                relative(lab.dynamics.volume(0), volume),
                length(minus(momentum(lab), spin)) / length(spin),
                relative(energy(lab), work),
            ];
            for (largest, error) in largest.iter_mut().zip(errors) {
                *largest = worst([*largest, error]);
            }
        })?;
        let grown = lab.dynamics.volume(0) / volume - 1.0;
        let measured = match self.what {
            Conserved::Volume => CaseMeasurement::new(largest[0], format!("{:.1e} at the end", grown.abs())),
            Conserved::Momentum => CaseMeasurement::new(largest[1], format!("{} steps", steps)),
            Conserved::Energy => CaseMeasurement::new(largest[2], format!("{} steps", steps)),
            Conserved::Swelling => {
                let expected = (1.0 + angle_squared).powi(steps) - 1.0;
                CaseMeasurement::new(relative(grown, expected), format!("{:.4} % larger", 100.0 * grown))
            }
        };
        Ok(measured)
    }
}
