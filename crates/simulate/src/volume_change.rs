//! Which blocks have another volume at the end of a run than they began with: strain changes it, and so does turning where
//! `kinematics = "linear"` moves vertices along tangents.

use crate::f64_vector::{Point, point};
use crate::frame::volume_and_centroid;
use rockproof_model::Scene;
use rockproof_model::simulation::Kinematics;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::State;

/// Changes of volume up to this share are not told.
const MIN_SHARE: f64 = 0.01;

/// The blocks of a run whose volume changed by more than one in a hundred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeChange {
    /// How many there are.
    pub blocks: usize,
    /// The block whose volume changed most, the first of several.
    pub worst: usize,
    /// Its volume at the end, as a multiple of that at the beginning.
    pub factor: f64,
    /// Whether blocks that turn grow by the rule that moves their vertices.
    pub is_linear: bool,
}

impl VolumeChange {
    /// What a run that began with one state and is in another has changed; `None` where no volume changed so much.
    pub fn of<R: Real>(scene: &Scene, begin: &State<R>, state: &State<R>) -> Option<VolumeChange> {
        let factors = scene.blocks.iter().zip(begin.blocks.iter().zip(&state.blocks)).map(|(block, (then, now))| {
            let [before, after] = [then, now].map(|state| {
                let points: Vec<Point> = state.vertices.iter().map(|v| point(*v)).collect();
                volume_and_centroid(block.block.topology(), &points).0
            });
            after / before
        });
        let changed: Vec<(usize, f64)> =
            factors.enumerate().filter(|(_, factor)| factor.is_finite() && (factor - 1.0).abs() > MIN_SHARE).collect();
        let most = changed.iter().rev().max_by(|one, other| (one.1 - 1.0).abs().total_cmp(&(other.1 - 1.0).abs()));
        let is_linear = scene.simulation.control.kinematics == Kinematics::Linear;
        most.map(|&(worst, factor)| VolumeChange { blocks: changed.len(), worst, factor, is_linear })
    }

    /// The same in words.
    pub fn sentence(&self) -> String {
        let VolumeChange { blocks, worst, factor, is_linear } = self;
        let others = match blocks {
            1 => String::new(),
            _ => format!("; {blocks} blocks changed by more than 1 %"),
        };
        let why = if *is_linear && *factor > 1.0 {
            "; kinematics \"linear\" makes blocks grow that turn, \"cayley\" does not"
        } else {
            ""
        };
        format!("block {worst} has {factor:.3} times the volume that it began with{others}{why}")
    }
}
