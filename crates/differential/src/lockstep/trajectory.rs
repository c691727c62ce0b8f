//! Exact trajectories: the oracle steps by itself, for as long as asked.

use crate::lockstep::scene::ExactScene;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::PointLoad;
use rockproof_model::{Number, Point, Scene, ToleranceSet, Vec3};
use rockproof_oracle::step::{KeptPrecision, State, StepAnswer, StepFailure};

/// The oracle alone, step by step.
#[derive(Clone, Debug)]
pub struct Trajectory {
    scene: ExactScene,
    keep: KeptPrecision,
    state: State,
    /// Loads that the scene has; those after them are the measured points.
    loads: usize,
    step: u64,
}

impl Trajectory {
    /// The scene at its beginning. Its joints have stiffnesses ([`rockproof_model::simulation::derive_stiffness`]).
    pub fn new(scene: &Scene, set: &ToleranceSet, keep: KeptPrecision) -> Trajectory {
        let mut scene = scene.clone();
        let loads = scene.simulation.loads.len();
        // A measured point is the point of a load without force: it moves with its block and does nothing.
        let still = || vec![(Number::ZERO, Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO))];
        let measured = scene.simulation.measured_points.iter();
        let points =
            measured.map(|p| PointLoad { block: p.block, at: p.at.clone(), table: still() }).collect::<Vec<_>>();
        scene.simulation.loads.extend(points);
        let scene = ExactScene::new(&scene, set);
        let state = scene.begin();
        Trajectory { scene, keep, state, loads, step: 0 }
    }

    /// How coordinates are kept.
    pub fn keep(&self) -> KeptPrecision {
        self.keep
    }

    /// The scene.
    pub fn scene(&self) -> &ExactScene {
        &self.scene
    }

    /// The state after the last step.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes on from another state of the same scene, which has a load point for each load and then for each measured point.
    pub fn restart(&mut self, state: State) {
        self.state = state;
    }

    /// Steps done, settling not counted.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// The number of the next step: from 1, settling steps before have the numbers −n + 1 to 0.
    pub fn next_number(&self) -> i64 {
        if self.state.settling > 0 { 1 - i64::from(self.state.settling) } else { self.step as i64 + 1 }
    }

    /// Where the measured points are (m), in the order of the scene.
    pub fn measured(&self) -> &[Point] {
        self.state.load_points.get(self.loads..).unwrap_or(&[])
    }

    /// One step; settling steps come first. When it cannot be made the state stays.
    ///
    /// # Errors
    /// Why not.
    pub fn step(&mut self) -> Result<StepAnswer, StepFailure> {
        let settling = self.state.settling > 0;
        let answer = self.scene.step(&self.state, self.keep)?;
        self.state = answer.state.clone();
        self.step += u64::from(!settling);
        Ok(answer)
    }
}

/// The grid of `2^−256` of the model's size, or the next finer power of two: the default of exact trajectories.
pub fn default_grid(scene: &Scene) -> KeptPrecision {
    let exponent = 256 - i64::from(size_exponent(scene));
    KeptPrecision::Grid { exponent: exponent.clamp(0, i64::from(u32::MAX)) as u32 }
}

/// The largest power of two, as its exponent, that is at most the largest side of the box around all blocks; 0 for none.
fn size_exponent(scene: &Scene) -> i32 {
    let sides = (0..3).filter_map(|axis| {
        let ends =
            scene.blocks.iter().flat_map(|block| block.block.vertices().iter().map(move |v| v.components()[axis]));
        let (low, high) = ends.fold((None, None), |(low, high): (Option<&Number>, Option<&Number>), x| {
            (Some(low.map_or(x, |low| low.min(x))), Some(high.map_or(x, |high| high.max(x))))
        });
        Some(high?.to_rational() - low?.to_rational())
    });
    sides.max().map_or(0, |size| floor_log2(&size))
}

/// The exponent of the largest power of two that is at most a positive fraction; 0 for others.
fn floor_log2(value: &BigRational) -> i32 {
    if *value <= BigRational::from_integer(BigInt::from(0)) {
        return 0;
    }
    let guess = value.numer().bits() as i32 - value.denom().bits() as i32;
    let shifted = |exponent: i32| BigInt::from(1) << exponent.unsigned_abs() as usize;
    let power = if guess < 0 { BigRational::new(1.into(), shifted(guess)) } else { shifted(guess).into() };
    if power <= *value { guess } else { guess - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_of_fractions() {
        let log = |n: i64, d: i64| floor_log2(&BigRational::new(n.into(), d.into()));
        assert_eq!([log(1, 1), log(16, 1), log(17, 1), log(15, 1)], [0, 4, 4, 3]);
        assert_eq!([log(1, 3), log(1, 4), log(3, 4), log(4, 3), log(-1, 1), log(0, 1)], [-2, -2, -1, 0, 0, 0]);
    }
}
