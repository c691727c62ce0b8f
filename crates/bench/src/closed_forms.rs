//! Scenes whose end is known by a closed form, for weighing run time against error.

use crate::accuracy::{AccuracyError, AccuracyRow, ErrorQuantity, MeasuredEngine};
use num_traits::ToPrimitive;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Block, Number, Precision, Preset, Scene, SceneError, ToleranceSet, ToleranceSpec, Vec3};
use rockproof_oracle::step::{KeptPrecision, State, StepModel, exact_step};
use rockproof_stepper::dynamics::{Dynamics, Solve};
use std::path::Path;
use std::time::{Duration, Instant};

/// A scene with a closed form.
#[derive(Clone, Copy, Debug)]
pub struct ClosedFormScene {
    /// Its name: that of its file in `cases/handmade`.
    pub name: &'static str,
    text: &'static str,
    /// How long it runs (s).
    duration: f64,
    /// What its error is of.
    pub of: ErrorQuantity,
    error: fn(&StartAndEnd) -> f64,
}

/// Vertices of the blocks at the beginning of time and at the end (m), and the time between (s).
struct StartAndEnd {
    begin: Vec<Vec<[f64; 3]>>,
    end: Vec<Vec<[f64; 3]>>,
    time: f64,
    /// Volumes over those of the beginning.
    swelling: Vec<f64>,
}

/// The scenes.
pub const SCENES: [ClosedFormScene; 6] = [
    ClosedFormScene {
        name: "free_fall",
        text: include_str!("../cases/free_fall.toml"),
        duration: 0.25,
        of: ErrorQuantity::Displacement,
        // z = −g t²/2 with g = 10 m/s².
        error: |ends| relative(ends.moved(0, 2), -5.0 * ends.time * ends.time),
    },
    ClosedFormScene {
        name: "incline_1_4_settled",
        text: include_str!("../cases/incline_1_4_settled.toml"),
        duration: 0.25,
        of: ErrorQuantity::Displacement,
        // a = g (sin α − cos α tan φ) = 4 m/s² along −x.
        error: |ends| relative(ends.moved(1, 0), -2.0 * ends.time * ends.time),
    },
    ClosedFormScene {
        name: "rest_on_floor",
        text: include_str!("../cases/rest_on_floor.toml"),
        duration: 0.1,
        of: ErrorQuantity::Overlap,
        // W/(4 p_n).
        error: |ends| relative(-ends.lowest(1), 6.5e-5),
    },
    ClosedFormScene {
        name: "stack_of_10",
        text: include_str!("../cases/stack_of_10.toml"),
        duration: 0.1,
        of: ErrorQuantity::Overlap,
        // Ten weights on four contacts of 10⁹ N/m.
        error: |ends| relative(-ends.lowest(1), 6.5e-5),
    },
    ClosedFormScene {
        name: "rotation_cayley",
        text: include_str!("../cases/rotation_cayley.toml"),
        duration: 0.5,
        of: ErrorQuantity::Displacement,
        error: StartAndEnd::turned,
    },
    ClosedFormScene {
        name: "rotation_linear",
        text: include_str!("../cases/rotation_linear.toml"),
        duration: 0.5,
        of: ErrorQuantity::Volume,
        error: |ends| (ends.swelling[0] - 1.0).abs(),
    },
];

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs()
}

impl StartAndEnd {
    /// How far the mean of a block's vertices has moved along an axis.
    fn moved(&self, block: usize, axis: usize) -> f64 {
        let mean = |points: &[[f64; 3]]| points.iter().map(|p| p[axis]).sum::<f64>() / points.len() as f64;
        mean(&self.end[block]) - mean(&self.begin[block])
    }

    fn lowest(&self, block: usize) -> f64 {
        self.end[block].iter().map(|p| p[2]).fold(f64::INFINITY, f64::min)
    }

    /// How far the corner at (1, 2, 3) is from where a turn about z through (1/2, 1) at 1 rad/s puts it, over its path.
    fn turned(&self) -> f64 {
        let corner = self.begin[0].iter().position(|p| *p == [1.0, 2.0, 3.0]).unwrap_or(0);
        let (sin, cos) = self.time.sin_cos();
        let (x, y) = (0.5, 1.0);
        let expected = [0.5 + x * cos - y * sin, 1.0 + x * sin + y * cos];
        let [dx, dy] = [0, 1].map(|k| self.end[0][corner][k] - expected[k]);
        dx.hypot(dy) / (x.hypot(y) * self.time)
    }
}

/// Sets that a scene is run under: its own first.
pub const SETS: [&str; 2] = ["scene", "shi"];

/// Δt over that of the file.
pub const TIME_STEPS: [f64; 3] = [4.0, 1.0, 0.25];

impl ClosedFormScene {
    /// The scene of the file.
    ///
    /// # Errors
    /// When it cannot be read, which a test rules out.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        Scene::parse(self.text, SceneFormat::Toml, Path::new(self.name))
    }

    /// Runs the scene by an engine, under a set of [`SETS`], with Δt so many times that of the file. An exact run that takes longer than
    /// `patience` has no figures.
    ///
    /// # Errors
    /// When the scene or its tolerances cannot be had. A run that stops is a result.
    pub fn run(
        &self,
        engine: MeasuredEngine,
        (set, factor): (&'static str, f64),
        patience: Duration,
    ) -> Result<AccuracyRow, AccuracyError> {
        let mut scene = self.scene()?;
        let control = &mut scene.simulation.control;
        let time_step = control.time_step.approximate() * factor;
        control.time_step = Number::from_f64(time_step).unwrap_or(Number::ZERO);
        let precision = if engine == MeasuredEngine::F32 { Precision::F32 } else { Precision::F64 };
        let spec = match (set, &scene.tolerances) {
            ("shi", _) => ToleranceSpec::from(Preset::Shi),
            (_, own) => own.clone().unwrap_or_default(),
        };
        let tolerances = spec.derive(&scene.shapes(), precision)?;
        scene.derive_stiffness(&tolerances);
        let mut row = AccuracyRow::of_scene(self.name, engine, set, time_step, self.of);
        let ran = match engine {
            MeasuredEngine::F32 => self.float::<f32>(&scene, &tolerances),
            MeasuredEngine::F64 => self.float::<f64>(&scene, &tolerances),
            MeasuredEngine::Certified | MeasuredEngine::Exact => self.exactly(&scene, &tolerances, patience),
        };
        match ran {
            Ok((ends, steps, seconds)) => {
                row.units = steps;
                row.micros = 1e6 * seconds / steps.max(1) as f64;
                row.error = (self.error)(&ends);
            }
            Err(why) => row.note = why,
        }
        Ok(row)
    }

    /// The ends, steps, and seconds of a run in floats; the quickest of three.
    fn float<R: Solve>(&self, scene: &Scene, set: &ToleranceSet) -> Result<(StartAndEnd, u64, f64), String> {
        let mut best: Option<(StartAndEnd, u64, f64)> = None;
        for _ in 0..3 {
            let mut dynamics = Dynamics::<R>::new(scene, set).map_err(|e| e.to_string())?;
            while dynamics.state().settling > 0 {
                dynamics.step().map_err(|e| e.to_string())?;
            }
            let points = |dynamics: &Dynamics<R>| {
                let of_block = |b: &rockproof_stepper::dynamics::BlockState<R>| {
                    b.vertices.iter().map(|v| [v.x.to_f64(), v.y.to_f64(), v.z.to_f64()]).collect()
                };
                dynamics.state().blocks.iter().map(of_block).collect::<Vec<Vec<[f64; 3]>>>()
            };
            let volumes =
                |dynamics: &Dynamics<R>| (0..scene.blocks.len()).map(|b| dynamics.volume(b)).collect::<Vec<_>>();
            let (begin, before) = (points(&dynamics), volumes(&dynamics));
            let begun = Instant::now();
            while dynamics.state().time.to_f64() < self.duration * (1.0 - 1e-6) {
                dynamics.step().map_err(|e| e.to_string())?;
            }
            let seconds = begun.elapsed().as_secs_f64();
            let swelling = volumes(&dynamics).iter().zip(&before).map(|(after, before)| after / before).collect();
            let state = dynamics.state();
            let ends = StartAndEnd { begin, end: points(&dynamics), time: state.time.to_f64(), swelling };
            if best.as_ref().is_none_or(|(_, _, quickest)| seconds < *quickest) {
                best = Some((ends, state.step, seconds));
            }
        }
        best.ok_or_else(|| "no run".to_owned())
    }

    /// The same by the oracle's step, coordinates kept to 2⁻¹⁰⁰ m.
    fn exactly(
        &self,
        scene: &Scene,
        set: &ToleranceSet,
        patience: Duration,
    ) -> Result<(StartAndEnd, u64, f64), String> {
        let shapes = scene.shapes();
        let bodies: Vec<_> = scene.blocks.iter().map(|block| block.body.clone()).collect();
        let model = StepModel { shapes: &shapes, bodies: &bodies, simulation: &scene.simulation, tolerances: set };
        let mut state = State::initial(&model);
        let mut begun = Instant::now();
        let (mut begin, mut steps) = (None, 0u64);
        let points = |state: &State| {
            let of = |p: &Vec3<Number>| [p.x.approximate(), p.y.approximate(), p.z.approximate()];
            state.blocks.iter().map(|b| b.vertices.iter().map(of).collect()).collect::<Vec<Vec<[f64; 3]>>>()
        };
        let volumes = |state: &State| -> Vec<f64> {
            let blocks = shapes.iter().zip(&state.blocks);
            blocks.map(|(shape, b)| volume(&shape.with_vertices(b.vertices.clone()))).collect()
        };
        let mut before = volumes(&state);
        while state.time.approximate() < self.duration * (1.0 - 1e-6) {
            if state.settling == 0 && begin.is_none() {
                (begin, before) = (Some(points(&state)), volumes(&state));
                begun = Instant::now();
            }
            if begun.elapsed() > patience {
                return Err(format!("stopped after {steps} steps: it takes more than {} s", patience.as_secs()));
            }
            let counts = state.settling == 0;
            state = exact_step(&model, &state, KeptPrecision::Grid { exponent: 100 }).map_err(|e| e.to_string())?.state;
            steps += u64::from(counts);
        }
        let seconds = begun.elapsed().as_secs_f64();
        let swelling = volumes(&state).iter().zip(&before).map(|(after, before)| after / before).collect();
        let ends = StartAndEnd {
            begin: begin.unwrap_or_default(),
            end: points(&state),
            time: state.time.approximate(),
            swelling,
        };
        Ok((ends, steps, seconds))
    }
}

fn volume(block: &Block) -> f64 {
    block.volume().to_f64().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: Duration = Duration::from_secs(600);

    #[test]
    fn every_scene_meets_its_closed_form_in_f64() {
        for closed in SCENES {
            let row = closed.run(MeasuredEngine::F64, ("scene", 1.0), LONG).expect("a run");
            let allowed = if closed.name.starts_with("rotation") { 1e-2 } else { 2e-3 };
            assert!(row.note.is_empty() && row.error < allowed && row.units > 0, "{row:?}");
        }
    }

    #[test]
    fn the_exact_step_falls_as_the_parabola_says() {
        let row = SCENES[0].run(MeasuredEngine::Certified, ("scene", 4.0), LONG).expect("a run");
        assert!(row.note.is_empty() && row.error < 1e-15, "{row:?}");
    }
}
