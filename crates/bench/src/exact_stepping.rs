//! What a step costs exactly: certified, in f64, and with plain rational elimination, from the same states.

use crate::stepping::{SteppingError, wall};
use rockproof_differential::lockstep::state::exact_state_of_f64;
use rockproof_model::simulation::Body;
use rockproof_model::{Block, BlockError, Motion, Number, Precision, Scene, SceneBlock, ToleranceSpec, Vec3};
use rockproof_oracle::step as exact;
use rockproof_stepper::dynamics::Dynamics;
use std::time::Instant;

/// Figures of one scene; times in s, each the median over the steps.
#[derive(Clone, Debug)]
pub struct ExactCost {
    /// The scene.
    pub name: String,
    /// Unknowns of all blocks.
    pub unknowns: usize,
    /// Contacts of the last step.
    pub contacts: usize,
    /// Steps that were timed.
    pub steps: usize,
    /// Solves a step.
    pub iterations: f64,
    /// A step of the stepper in f64, in a run with nothing beside it.
    pub float: f64,
    /// The stepper's state as the oracle's.
    pub conversion: f64,
    /// All decisions of the step from that state, certified.
    pub certified: f64,
    /// The same and the state after it, on a grid of 2⁻⁸⁰ m.
    pub with_state: f64,
    /// Plain rational elimination of the system of one solve; none for larger systems.
    pub plain: Option<f64>,
    /// Who decided.
    pub levels: exact::StepLevelCounts,
}

impl ExactCost {
    /// A certified step over one in f64.
    pub fn over_float(&self) -> f64 {
        self.certified / self.float
    }

    /// A run in lockstep over the run alone.
    pub fn lockstep(&self) -> f64 {
        (self.float + self.conversion + self.certified) / self.float
    }

    /// Plain rational elimination in every solve over a certified step.
    pub fn plain_over_certified(&self) -> Option<f64> {
        self.plain.map(|plain| plain * self.iterations / self.certified)
    }
}

/// The scenes measured: two blocks in several ways, and walls.
///
/// # Errors
/// When a scene cannot be made.
pub fn scenes(bricks: &[u16]) -> Result<Vec<(String, Scene)>, BlockError> {
    let mut scenes = Vec::new();
    for (name, first, second) in [
        ("rigid on fixed", Motion::Fixed, Motion::Rigid),
        ("deformable on fixed", Motion::Fixed, Motion::Deformable),
        ("two deformable", Motion::Deformable, Motion::Deformable),
    ] {
        scenes.push((name.to_owned(), pair(first, second)?));
    }
    for &bricks in bricks {
        scenes.push((format!("wall of {bricks} bricks"), wall(bricks)?));
    }
    Ok(scenes)
}

/// A block that slides and tilts on another, a little turned so that no coordinate is a short number.
fn pair(lower: Motion, upper: Motion) -> Result<Scene, BlockError> {
    let turned = |min: [f64; 3], max: [f64; 3]| {
        let corner = |c: [f64; 3]| c.map(|x| Number::from_f64(x).unwrap_or(Number::ZERO));
        let point = |[x, y, z]: [Number; 3]| Vec3::new(x, y, z);
        let block = Block::cuboid(&point(corner(min)), &point(corner(max)))?;
        let (cosine, sine) = (0.8, 0.6);
        let vertices = block.vertices().iter().map(|v| {
            let [x, y, z] = [&v.x, &v.y, &v.z].map(Number::approximate);
            point(corner([cosine * x - sine * y, sine * x + cosine * y, z]))
        });
        Ok::<Block, BlockError>(block.with_vertices(vertices.collect()))
    };
    let mut scene = Scene::default();
    for (name, min, max, motion) in
        [("lower", [-2.0, -2.0, -1.0], [2.0, 2.0, 0.0], lower), ("upper", [-0.5, -0.3, 0.0], [0.5, 0.4, 0.9], upper)]
    {
        let mut block = SceneBlock::new(name, turned(min, max)?);
        block.body.motion = motion;
        scene.blocks.push(block);
    }
    let velocity = [0.5, 0.1, 0.0].map(|x| Number::from_f64(x).unwrap_or(Number::ZERO));
    let [x, y, z] = velocity;
    scene.blocks[1].body.velocity = Vec3::new(x, y, z);
    Ok(scene)
}

/// Times `steps` steps of a scene, each from the state in which the stepper has it.
///
/// # Errors
/// When the stepper cannot make a step.
pub fn exact_stepping(name: &str, scene: &Scene, steps: u32) -> Result<ExactCost, SteppingError> {
    let mut scene = scene.clone();
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64)?;
    scene.derive_stiffness(&set);
    let begin = Dynamics::<f64>::new(&scene, &set)?;
    let shapes = scene.shapes();
    let bodies: Vec<Body> = scene.blocks.iter().map(|block| block.body.clone()).collect();
    let model = exact::StepModel { shapes: &shapes, bodies: &bodies, simulation: &scene.simulation, tolerances: &set };
    let unknowns: usize = bodies.iter().map(|body| body.motion.unknowns()).sum();
    let mut times: [Vec<f64>; 5] = Default::default();
    // The plain run by itself: what is done between its steps would take the caches from it.
    let mut dynamics = begin.clone();
    for _ in 0..steps {
        let (report, float) = timed(|| dynamics.step());
        report?;
        times[0].push(float);
    }
    let (mut levels, mut iterations, mut made) = (exact::StepLevelCounts::default(), 0, 0);
    let (mut dynamics, mut known) = (begin.clone(), exact::KnownNeighbours::default());
    for _ in 0..steps {
        let (state, conversion) = timed(|| exact_state_of_f64(dynamics.state()));
        let state = state?;
        let (certified, seconds) = timed(|| {
            // As lockstep finds them: what is known of blocks is kept from step to step.
            let contacts = exact::known_contacts(&model, &state, &mut known);
            exact::certified_step_with(&model, &state, contacts)
        });
        if let Ok(certified) = certified {
            iterations += certified.modes.len() - 1;
            made += 1;
            add(&mut levels, &certified.levels);
            times[1].push(conversion);
            times[2].push(seconds);
        }
        dynamics.step()?;
    }
    let mut dynamics = begin;
    for _ in 0..steps {
        let state = exact_state_of_f64(dynamics.state())?;
        let keep = exact::KeptPrecision::Grid { exponent: 80 };
        let (answer, seconds) = timed(|| exact::exact_step(&model, &state, keep));
        if answer.is_ok() {
            times[3].push(seconds);
        }
        // Fractions of large systems would take longer than all the rest.
        let wanted = if unknowns <= 12 { 3 } else { usize::from(unknowns <= 24) };
        if times[4].len() < wanted
            && let Some(system) = exact::first_system(&model, &state)
        {
            times[4].push(timed(|| system.plainly()).1);
        }
        dynamics.step()?;
    }
    let [float, conversion, certified, with_state, plain] = times.map(median);
    Ok(ExactCost {
        name: name.to_owned(),
        unknowns,
        contacts: dynamics.state().contacts.len(),
        steps: made,
        iterations: iterations as f64 / made.max(1) as f64,
        float: float.unwrap_or(f64::NAN),
        conversion: conversion.unwrap_or(f64::NAN),
        certified: certified.unwrap_or(f64::NAN),
        with_state: with_state.unwrap_or(f64::NAN),
        plain,
        levels,
    })
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let made = std::hint::black_box(work());
    (made, begun.elapsed().as_secs_f64())
}

fn median(mut times: Vec<f64>) -> Option<f64> {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}

fn add(sum: &mut exact::StepLevelCounts, more: &exact::StepLevelCounts) {
    sum.float += more.float;
    sum.double += more.double;
    sum.wide.iter_mut().zip(more.wide).for_each(|(sum, more)| *sum += more);
    sum.exact += more.exact;
    sum.undecided += more.undecided;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_pair_are_certified_and_timed() {
        let (name, scene) = scenes(&[]).expect("scenes").remove(0);
        let cost = exact_stepping(&name, &scene, 3).expect("steps");
        assert_eq!((cost.unknowns, cost.steps), (6, 3));
        assert!(cost.contacts >= 4 && cost.iterations >= 1.0, "{cost:?}");
        assert!(cost.levels.float > 0 && cost.levels.undecided == 0, "{cost:?}");
        assert!(cost.float > 0.0 && cost.certified > 0.0 && cost.plain.is_some_and(|plain| plain > 0.0), "{cost:?}");
    }
}
