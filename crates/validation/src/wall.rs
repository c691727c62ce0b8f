//! A wall of a thousand bricks at rest: how far it drifts. Too slow for the tests, so the program alone runs it.

use crate::stepped_scene::{CaseFailure, SteppedScene, cuboid, length, minus, relative};
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Motion, Scene};

/// A wall in running bond on a fixed floor: bricks of 2 m × 1 m × 1 m, and halves of them at the ends of every other course.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    /// Whole bricks in a course that has no halves.
    pub bricks: u32,
    /// Courses.
    pub courses: u32,
    /// [`Motion::Rigid`] or [`Motion::Deformable`].
    pub motion: Motion,
    /// Settling steps.
    pub settling: u32,
    /// Steps of time, of 10 ms.
    pub steps: u32,
}

impl Wall {
    /// The wall of the table.
    pub fn of_a_thousand(motion: Motion) -> Wall {
        Wall { bricks: 25, courses: 40, motion, settling: 200, steps: 100 }
    }

    fn scene(&self) -> Result<Scene, CaseFailure> {
        let long = 2 * self.bricks;
        let mut scene = Scene::on_fixed("floor", cuboid([0.0, 0.0, -1.0], [f64::from(long), 1.0, 0.0])?);
        for course in 0..self.courses {
            // Where a brick ends and the next begins.
            let joints = (0..=long).filter(|x| x % 2 == course % 2 || *x == 0 || *x == long).map(f64::from);
            let joints: Vec<f64> = joints.collect();
            for (place, ends) in joints.windows(2).enumerate() {
                let z = f64::from(course);
                let block = cuboid([ends[0], 0.0, z], [ends[1], 1.0, z + 1.0])?;
                let mut block = SceneBlock::new(format!("brick_{course}_{place}"), block);
                block.body.motion = self.motion;
                scene.blocks.push(block);
            }
        }
        scene.simulation.control.settle = self.settling;
        Ok(scene)
    }

    /// Settles it and watches it stand.
    ///
    /// # Errors
    /// When a step cannot be made.
    pub fn measure(&self) -> Result<WallDrift, CaseFailure> {
        let mut stepped = SteppedScene::<f64>::new(self.scene()?)?;
        let moving = 1..stepped.scene.blocks.len();
        let centroids = |stepped: &SteppedScene<f64>| moving.clone().map(|k| stepped.centroid(k)).collect::<Vec<_>>();
        let placed = centroids(&stepped);
        stepped.settle()?;
        let settled = centroids(&stepped);
        let farthest = |from: &[[f64; 3]], to: &[[f64; 3]]| {
            from.iter().zip(to).map(|(one, other)| length(minus(*one, *other))).fold(0.0, f64::max)
        };
        let mut drift = [0.0; 2];
        for step in 1..=self.steps {
            stepped.step()?;
            let now = farthest(&settled, &centroids(&stepped));
            drift[1] = now.max(drift[1]);
            if 2 * step <= self.steps {
                drift[0] = drift[1];
            }
        }
        let weight = moving.clone().map(|k| stepped.mass(k)).sum::<f64>() * -stepped.gravity()[2];
        let borne: f64 = moving.clone().map(|k| -stepped.force(0, k as u32)[2]).sum();
        let speed = moving.clone().map(|k| length([0, 1, 2].map(|axis: usize| stepped.velocity(k)[axis])));
        Ok(WallDrift {
            bricks: moving.len(),
            settled: farthest(&placed, &settled),
            drift,
            speed: speed.fold(0.0, f64::max),
            weight: relative(borne, weight),
        })
    }
}

/// How far a brick of the thousand may drift in a second (m).
pub const MAX_DRIFT: f64 = 2e-5;

/// What a wall at rest did.
pub struct WallDrift {
    /// How many bricks it has, halves too.
    pub bricks: usize,
    /// The farthest that settling moved a centroid (m).
    pub settled: f64,
    /// The farthest that a centroid got from where settling left it (m), in the first half of the steps and in all.
    pub drift: [f64; 2],
    /// The speed of the fastest brick at the end (m/s).
    pub speed: f64,
    /// By how much the forces on the floor differ from the weight, relative.
    pub weight: f64,
}
