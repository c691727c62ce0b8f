//! Energy never grows in a frictional, undriven scene beyond the scheme's own bound, over 1,000 steps.
//!
//! Why. A step solves M(v' − v)/Δt = F with v' = 2d/Δt − v and F the forces at its end, so that the kinetic energy changes by
//! ½(v' + v)ᵀM(v' − v) = dᵀF: the work of the end forces along the whole way, exactly. With E = kinetic + gravity + springs (½p h²,
//! ½p_s s²):
//! - gravity: its work is what it loses.
//! - a spring closed before and after, h → h + δ: its work is −p(h + δ)δ, it stores p h δ + ½p δ². Lost: ½p δ² ≥ 0. Shear springs and
//!   fixed points likewise.
//! - a contact that closes from h0 ≥ 0 to h < 0: work −p h(h − h0) < 0, stored ½p h². Lost: at least ½p h². One that opens: what
//!   it stored is lost.
//! - friction τ along ŝ, the stretch s0 → s with |s| ≥ τ/p_s and afterwards τ/p_s: −τŝ·(s − s0) + ½τ²/p_s − ½p_s s0² is largest
//!   at s0 = ŝτ/p_s, and there −τ(|s| − τ/p_s) ≤ 0.
//!
//! So to first order no term gains. Three things are beyond it:
//! - the gap of the next step is measured in the geometry that has formed. A rotation by θ in a step takes points within R by θR
//!   at most θ² R off the first order (`cayley`: ½θ²R + ½θ³R), and tilts a normal by θ along which a point has slid by u: δ = θ(θR + u). A
//!   spring gains at most p(|h|δ + ½δ²).
//! - a contact that is found overlapping (one block, several features) begins with the ½p h0² that its overlap has: h0 is then
//!   the same overlap that another contact lost, or second order, δ.
//! - f is that of the solve before the last. Where the last two solves of a step differ, that is within the losses above; these
//!   scenes need no allowance for it.
//!
//! Summed: a step gains at most Σ p(2|h|δ + 2δ²) over closed contacts, normal and shear springs, and rounding.

use crate::support::{begin, cube, cuboid, floor, n, run, scene, v};
use rockproof::model::Motion;
use rockproof::stepper::dynamics::{Dynamics, Mode, StepReport};

const STEPS: usize = 1000;
const STIFFNESS: f64 = 1e8;

fn total(report: &StepReport) -> f64 {
    report.kinetic + report.potential()
}

#[test]
fn a_sliding_block_loses_energy_until_it_rests() {
    // No rotation to speak of: δ is nil, and so is the bound, but for rounding. (Both motions; deformation stores and gives back energy.)
    for motion in [Motion::Rigid, Motion::Deformable] {
        let mut scene = scene(vec![floor(), cube()]);
        scene.blocks[1].body.motion = motion;
        scene.blocks[1].body.velocity = v("2", "1", "0");
        scene.simulation.joints.other.friction = n("1/2");
        scene.simulation.control.settle = 60;
        let (dynamics, reports) = run::<f64>(&scene, 60 + STEPS);
        let energies: Vec<f64> = reports[60..].iter().map(total).collect();
        let scale = energies[0].abs();
        let mut gained = 0.0f64;
        for pair in energies.windows(2) {
            gained = gained.max(pair[1] - pair[0]);
        }
        println!("{motion:?}: {} J to {} J, at most {gained} J gained in a step", energies[0], energies[STEPS - 1]);
        assert!(gained <= 1e-9 * scale, "{gained} of {scale}");
        // It began with 5000 J and has come to rest.
        assert!(energies[0] - energies[STEPS - 1] > 4900.0);
        assert!(dynamics.state().contacts.iter().all(|c| c.mode == Mode::Locked));
    }
}

/// What a step may gain, by the comment above: δ from the rotation and the displacement of the step.
fn bound(before: &Dynamics<f64>, after: &Dynamics<f64>, report: &StepReport) -> f64 {
    let (mut theta, mut radius) = (0.0f64, 0.0f64);
    for block in 1..before.state().blocks.len() {
        let (one, other) = (&before.state().blocks[block], &after.state().blocks[block]);
        // d = Δt(v + v')/2.
        let turned: f64 =
            (3..6).map(|k| (0.5 * report.time_step * (one.velocity[k] + other.velocity[k])).powi(2)).sum();
        theta = theta.max(turned.sqrt());
        let centre = after.centroid(block);
        radius = other.vertices.iter().fold(radius, |most, &at| most.max((at - centre).length()));
    }
    let delta = theta * (theta * radius + report.max_displacement);
    let closed = after.state().contacts.iter().filter(|c| c.mode.is_closed());
    closed.map(|c| STIFFNESS * 1.4 * (2.0 * c.gap.abs() * delta + 2.0 * delta * delta)).sum()
}

#[test]
fn a_tumbling_stack_gains_no_more_than_the_bound() {
    // Two bricks that turn fall on one another and on a rough floor.
    let mut lower = cuboid("lower", ["0", "0", "1/4"], ["2", "1", "5/4"], Motion::Rigid);
    lower.body.spin = v("1/2", "1", "0");
    lower.body.velocity = v("1/2", "0", "0");
    let mut upper = cuboid("upper", ["1/2", "0", "2"], ["5/2", "1", "3"], Motion::Deformable);
    upper.body.spin = v("0", "-1", "1/4");
    let mut scene = scene(vec![floor(), lower, upper]);
    scene.simulation.control.time_step = n("1/400");
    scene.simulation.materials[0].young = n("1e9");
    let mut dynamics = begin::<f64>(&scene);
    let mut energy = f64::INFINITY;
    let (mut first, mut allowed, mut worst) = (0.0, 0.0, 0.0f64);
    for step in 0..STEPS {
        let before = dynamics.clone();
        let report = dynamics.step().unwrap();
        if step == 0 {
            first = total(&report);
        } else {
            let bound = bound(&before, &dynamics, &report) + 1e-9 * first;
            let gained = total(&report) - energy;
            assert!(gained <= bound, "step {}: {gained} J gained, {bound} J allowed", report.step);
            (allowed, worst) = (allowed + bound, worst.max(gained));
        }
        energy = total(&report);
    }
    println!("{first} J to {energy} J; at most {worst} J gained in a step; {allowed} J allowed in all");
    assert!(energy < first, "{energy} after {first}");
}
