//! A block on an incline: whether it rests, slides, topples, or slides and topples.
//!
//! With δ = b/h, breadth along the incline over height: a block with δ ≥ tan α stands, and slides when tan φ < tan α. A slender one
//! slides without toppling when tan φ ≤ δ; else it topples, about a toe that keeps its place when friction can hold it there.
//! That last limit is dynamic: the toe bears what the falling block's acceleration leaves (Sagaseta 1986; Yeung 1991 for DDA).

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{CaseFailure, SteppedScene, cuboid, number, scene, vector};
use rockproof_model::Scene;
use rockproof_stepper::dynamics::StepRules;

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![
        Points { what: PointQuantity::Regime }.case::<M>(
            "inclined block, 12 points of height, breadth, angle, friction",
            "rests, slides, topples, or both",
            ("points wrong", Some(0.0)),
        ),
        Points { what: PointQuantity::Motion }.case::<M>(
            "the same: how far they slide and turn in 0.1 s",
            "½ẍt², ½θ̈t² of the start",
            ("relative, worst point", None),
        ),
    ]
}

/// An inclined block: 2 m high, 1 m deep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inclined {
    /// sin α and cos α, of a triangle of whole sides.
    pub lean: [f64; 2],
    /// δ, breadth over height.
    pub slenderness: f64,
    /// tan φ.
    pub friction: f64,
}

const HEIGHT: f64 = 2.0;
const GRAVITY: f64 = 10.0;

/// 12 points: three in each regime.
pub fn points() -> Vec<Inclined> {
    let [three, five, eight, four] = [[0.6, 0.8], [5.0 / 13.0, 12.0 / 13.0], [8.0 / 17.0, 15.0 / 17.0], [0.8, 0.6]];
    let point = |(lean, slenderness, friction)| Inclined { lean, slenderness, friction };
    [
        (five, 0.5, 0.5),
        (three, 0.9, 0.85),
        (eight, 1.0, 0.6),
        (three, 0.9, 0.5),
        (three, 0.6, 0.4),
        (five, 0.3, 0.2),
        (three, 0.25, 0.5),
        (three, 0.5, 0.7),
        (five, 0.2, 0.5),
        (three, 0.25, 0.3),
        (five, 0.1, 0.14),
        (four, 0.3, 0.4),
    ]
    .map(point)
    .into()
}

impl Inclined {
    /// The accelerations at the start: of the toe down the incline (m/s²) and of the turn about it (rad/s²).
    pub fn accelerations(&self) -> [f64; 2] {
        let Inclined { lean: [sine, cosine], slenderness: delta, friction } = *self;
        let (down, into) = (GRAVITY * sine, GRAVITY * cosine);
        let slides = [(down - friction * into).max(0.0), 0.0];
        if delta * cosine >= sine || friction <= delta {
            return slides;
        }
        // About a toe that stays: I = m(b² + h²)/3.
        let turn = 1.5 * (down - delta * into) / (HEIGHT * (1.0 + delta * delta));
        let normal = into + turn * delta * HEIGHT / 2.0;
        if down - turn * HEIGHT / 2.0 <= friction * normal {
            return [0.0, turn];
        }
        // About a toe that slides, with the friction of its normal force.
        let arm = (friction - delta) * HEIGHT / 2.0;
        let inertia = HEIGHT * HEIGHT * (1.0 + delta * delta) / 12.0;
        let turn = arm * into / (inertia - arm * delta * HEIGHT / 2.0);
        let normal = into + turn * delta * HEIGHT / 2.0;
        [down - friction * normal - turn * HEIGHT / 2.0, turn]
    }

    /// Its scene: the one of the file, with its measures.
    ///
    /// # Errors
    /// When the scene or a number cannot be read.
    pub fn scene(&self) -> Result<Scene, CaseFailure> {
        let mut scene = scene("inclined_slides_and_topples")?;
        let [sine, cosine] = self.lean;
        scene.simulation.gravity = vector([-GRAVITY * sine, 0.0, -GRAVITY * cosine])?;
        scene.simulation.joints.other.friction = number(self.friction)?;
        scene.blocks[1].block = cuboid([0.0; 3], [self.slenderness * HEIGHT, 1.0, HEIGHT])?;
        Ok(scene)
    }

    /// How far its toe slid (m) and how far it turned (rad) in a time (s).
    ///
    /// # Errors
    /// When the scene cannot be run.
    pub fn motion<R: CasePrecision, M: StepRules>(&self, time: f64) -> Result<[f64; 2], CaseFailure> {
        let mut lab = SteppedScene::<R, M>::new(self.scene()?)?;
        lab.settle()?;
        // Vertex 0 is the toe, 4 above it.
        let lean = |lab: &SteppedScene<R, M>| {
            let (toe, above) = (lab.vertex(1, 0), lab.vertex(1, 4));
            (toe[0] - above[0]).atan2(above[2] - toe[2])
        };
        let (toe, angle) = (lab.vertex(1, 0)[0], lean(&lab));
        while lab.time() < time - 1e-6 {
            lab.step()?;
        }
        Ok([toe - lab.vertex(1, 0)[0], lean(&lab) - angle])
    }
}

/// What is asked of the points.
#[derive(Clone, Copy)]
enum PointQuantity {
    Regime,
    Motion,
}

/// All points.
#[derive(Clone, Copy)]
struct Points {
    what: PointQuantity,
}

impl Measure for Points {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let (mut wrong, mut error) = (Vec::new(), 0.0f64);
        let time = 0.1;
        for point in points() {
            let known = point.accelerations().map(|a| 0.5 * a * time * time);
            let found = point.motion::<R, M>(time)?;
            for ((found, known), least) in found.into_iter().zip(known).zip([1e-3, 1e-3]) {
                // Moves as it should, within a half, or stays within the give of its springs.
                let right = if known > 0.0 { found > 0.5 * known } else { found.abs() < least };
                if !right {
                    wrong.push(format!("{point:?}: {found:.2e} for {known:.2e}"));
                }
                if known > 0.0 {
                    error = error.max(((found - known) / known).abs());
                }
            }
        }
        Ok(match self.what {
            PointQuantity::Regime if wrong.is_empty() => {
                CaseMeasurement::new(0.0, "3 rest, 3 slide, 3 topple, 3 do both")
            }
            PointQuantity::Regime => CaseMeasurement::new(wrong.len() as f64, wrong.join("; ")),
            PointQuantity::Motion => CaseMeasurement::new(error, "springs give way first"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_in_every_regime() {
        let all: Vec<[bool; 2]> = points().iter().map(|point| point.accelerations().map(|a| a > 0.0)).collect();
        // At rest, sliding, toppling, both.
        let regimes = [[false, false], [true, false], [false, true], [true, true]];
        for (three, regime) in all.chunks(3).zip(regimes) {
            assert_eq!(three, [regime; 3], "{all:?}");
        }
    }
}
