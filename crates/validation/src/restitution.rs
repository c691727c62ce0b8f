//! One contact, struck straight: what comes back by this integrator, as a function of Δt and p.
//!
//! While a contact of stiffness p is closed, a step takes a mass m from the gap h and the way w = vΔt of its velocity to
//! h' = (h + w)/(1 + κ) and w' = ((1 − κ)w − 2κh)/(1 + κ), κ = pΔt²/2m. The matrix of this map has the determinant 1/(1 + κ) and, with
//! ρ = (1 + κ)^(−1/2), the trace 2ρ cos α, cos α = (2 − κ)ρ/2. So after k steps, by Cayley and Hamilton,
//! Aᵏ = ρ^(k−1)·(sin kα/sin α)·A − ρᵏ·(sin (k − 1)α/sin α)·I, for κ > 8 with the hyperbolic functions and a sign for each step.
//! The contact is left after the last k with h ≤ 0; what comes back is w there over w at the start, and depends on the gap at which the step
//! before left the mass. For small Δt it is exp(−(π/4)·Δt·√(p/m)).

use crate::case::{CaseMeasurement, CasePrecision, Measure, ValidationCase};
use crate::stepped_scene::{
    CaseFailure, SteppedScene, cuboid, number, polyhedron, vector, without_open_close_tolerance, worst,
};
use rayon::prelude::*;
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Motion, Scene};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::StepRules;

/// m/s.
const SPEED: f64 = 1.0;
/// Gaps at the start of the step that strikes, as shares of the way of a step. No tie is among them.
const PHASES: [f64; 8] = [0.03, 0.16, 0.28, 0.41, 0.53, 0.66, 0.78, 0.91];
/// Δt of the table (s).
pub const TIME_STEPS: [f64; 5] = [1e-4, 2e-4, 1e-3, 5e-3, 1e-2];
/// p of the table (N/m).
pub const STIFFNESSES: [f64; 4] = [1e7, 1e8, 1e9, 1e10];

/// The cases of this group.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    vec![Impacts.case::<M>(
        "a tip that strikes a floor: restitution, Δt 0.1 to 10 ms, p 1e7 to 1e10 N/m",
        "powers of the step's matrix, see below",
        ("relative to the speed, worst of 160", Some(1e-8)),
    )]
}

/// What comes back by the closed form: `kappa` = pΔt²/2m, `gap` at the start of the step that strikes over the way of a step, in (0, 1).
pub fn known(kappa: f64, gap: f64) -> f64 {
    let (rho, one) = ((1.0 + kappa).sqrt().recip(), 1.0 / (1.0 + kappa));
    let matrix = [[one, one], [-2.0 * kappa * one, (1.0 - kappa) * one]];
    // sin kα/sin α, or for κ > 8, where α = π + iβ, (−1)^(k−1) sinh kβ/sinh β.
    let cosine = 0.5 * (2.0 - kappa) * rho;
    let ratio = |k: i32| match kappa <= 8.0 {
        true => (f64::from(k) * cosine.acos()).sin() / cosine.acos().sin(),
        false => {
            let beta = (-cosine).acosh();
            let size = (f64::from(k) * beta).sinh() / beta.sinh();
            if k % 2 == 0 { -size } else { size }
        }
    };
    let after = |k: i32| {
        let (own, unit) = (rho.powi(k - 1) * ratio(k), rho.powi(k) * ratio(k - 1));
        [0, 1].map(|row: usize| {
            let start = [gap, -1.0];
            own * (matrix[row][0] * start[0] + matrix[row][1] * start[1]) - unit * start[row]
        })
    };
    let mut k = 1;
    while after(k + 1)[0] <= 0.0 {
        k += 1;
    }
    after(k)[1]
}

/// A double pyramid above a floor, its tip below its centroid.
fn scene(time_step: f64, stiffness: f64, phase: f64) -> Result<Scene, CaseFailure> {
    let mut scene = Scene::on_fixed("floor", cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0])?);
    // Two steps before the one in which it strikes.
    let tip = (2.0 + phase) * SPEED * time_step;
    let corners =
        [[0.0, 0.0, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5], [-0.5, 0.0, 0.5], [0.0, -0.5, 0.5], [0.0, 0.0, 1.0]];
    let faces = (0..4u32).flat_map(|k| {
        let (this, next) = (1 + k, 1 + (k + 1) % 4);
        [vec![0, next, this], vec![5, this, next]]
    });
    let block = polyhedron(corners.map(|[x, y, z]| [x, y, z + tip]), faces.collect())?;
    let mut block = SceneBlock::new("tip", block);
    (block.body.motion, block.body.velocity) = (Motion::Rigid, vector([0.0, 0.0, -SPEED])?);
    scene.blocks.push(block);
    scene.tolerances = Some(without_open_close_tolerance()?);
    scene.simulation.gravity = vector([0.0; 3])?;
    scene.simulation.control.time_step = number(time_step)?;
    scene.simulation.joints.other.normal_stiffness = Some(number(stiffness)?);
    Ok(scene)
}

/// What comes back, found and known.
fn restitution<R: CasePrecision, M: StepRules>(
    time_step: f64,
    stiffness: f64,
    phase: f64,
) -> Result<[f64; 2], CaseFailure> {
    let mut stepped = SteppedScene::<R, M>::new(scene(time_step, stiffness, phase)?)?;
    let mass = stepped.mass(1);
    let mut touched = false;
    for _ in 0..10_000 {
        stepped.step()?;
        let closed = stepped.contacts(0, 1).any(|contact| contact.mode.is_closed());
        touched |= closed;
        if touched && !closed {
            let kappa = 0.5 * stiffness * time_step * time_step / mass;
            return Ok([stepped.velocity(1)[2] / SPEED, known(kappa, phase)]);
        }
    }
    Err(CaseFailure::Unexpected("the tip never leaves the floor".to_owned()))
}

/// All of the table at once.
#[derive(Clone, Copy)]
struct Impacts;

impl Measure for Impacts {
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure> {
        let mut errors = Vec::new();
        for (time_step, stiffness) in combinations() {
            for phase in PHASES {
                let [found, known] = restitution::<R, M>(time_step, stiffness, phase)?;
                errors.push((found - known).abs());
            }
        }
        let seen = format!("{} impacts", errors.len());
        Ok(CaseMeasurement::new(worst(errors), seen))
    }
}

fn combinations() -> impl Iterator<Item = (f64, f64)> {
    STIFFNESSES.into_iter().flat_map(|stiffness| TIME_STEPS.map(|time_step| (time_step, stiffness)))
}

/// One field of the table.
pub struct Restitution {
    /// p (N/m).
    pub stiffness: f64,
    /// Δt (s).
    pub time_step: f64,
    /// Least, mean and most that comes back, over the gaps from which a step may strike.
    pub back: [f64; 3],
}

/// The table, measured in f64.
///
/// # Errors
/// When a scene cannot be run.
pub fn table() -> Result<Vec<Restitution>, CaseFailure> {
    let one = |(time_step, stiffness)| {
        let back =
            PHASES.map(|phase| restitution::<f64, SpecRules>(time_step, stiffness, phase).map(|[found, _]| found));
        let back = back.into_iter().collect::<Result<Vec<f64>, CaseFailure>>()?;
        let least = back.iter().copied().fold(f64::INFINITY, f64::min);
        let most = back.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = back.iter().sum::<f64>() / back.len() as f64;
        Ok(Restitution { stiffness, time_step, back: [least, mean, most] })
    };
    combinations().collect::<Vec<_>>().into_par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::known;

    /// The matrix of the step, applied again and again.
    #[test]
    fn powers_are_those_of_the_matrix() {
        for kappa in [1e-4, 0.01, 0.5, 2.0, 7.9, 8.1, 100.0, 1e4] {
            for gap in [0.05, 0.3, 0.7, 0.95] {
                let (mut h, mut w) = (gap, -1.0);
                loop {
                    let next = [(h + w) / (1.0 + kappa), ((1.0 - kappa) * w - 2.0 * kappa * h) / (1.0 + kappa)];
                    if next[0] > 0.0 {
                        break;
                    }
                    [h, w] = next;
                }
                assert!((known(kappa, gap) - w).abs() < 1e-9, "{kappa} {gap}: {} for {w}", known(kappa, gap));
            }
        }
    }

    #[test]
    fn small_steps_lose_a_quarter_of_pi_times_the_step() {
        let kappa: f64 = 1e-5;
        let lost = 1.0 - known(kappa, 0.5);
        let expected = std::f64::consts::FRAC_PI_4 * (2.0 * kappa).sqrt();
        assert!((lost / expected - 1.0).abs() < 0.02, "{lost} {expected}");
    }
}
