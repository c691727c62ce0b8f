//! What a step proves about its system before it solves it: the bound that turns a residual into an enclosure holds for the block that
//! needs it most, and none is claimed where a spring pulls.

use crate::support::shapes::{cuboid, exact, number, spike};
use crate::support::steps::Scene;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::simulation::Motion;
use rockproof_model::{Number, Vec3};
use rockproof_oracle::step::{EnclosedStep, KeptPrecision, enclosed_step, first_system};

/// What the first solve of a scene encloses holds the exact solution; `moving` are its blocks that are not fixed. Whether it encloses
/// anything.
fn encloses(scene: &Scene, moving: &[usize]) -> bool {
    let shapes: Vec<_> = scene.blocks.iter().collect();
    let (model, state) = (scene.model(&shapes), scene.start());
    let plain = first_system(&model, &state).expect("a system").plainly().expect("definite");
    let EnclosedStep { decided, displacements } = enclosed_step(&model, &state).expect("a step");
    assert_eq!((decided.iterations, decided.retries.len()), (1, 0));
    let Some(displacements) = displacements else { return false };
    let enclosed: Vec<[f64; 2]> = moving.iter().flat_map(|&block| displacements[block].clone()).collect();
    assert_eq!(enclosed.len(), plain.len());
    for (unknown, (x, [middle, radius])) in plain.iter().zip(enclosed).enumerate() {
        let [middle, radius] = [middle, radius].map(|x| BigRational::from_float(x).expect("finite"));
        assert!((x - middle).abs() <= radius, "unknown {unknown}");
    }
    true
}

/// A rod 1000 times as long as thick along (1, 1, 1): by far the least of its inertia is in what it does across itself, of which the
/// diagonal of its matrix shows nothing.
#[test]
fn a_slanted_rod_beside_a_cube_is_enclosed() {
    let cube = cuboid(["0", "0", "0"], ["1", "1", "1"]);
    let slanted = cube.vertices().iter().map(|v| {
        let along = v.x.times(&number("1000"));
        Vec3::new(along.plus(&number("100")), along.plus(&v.y), along.plus(&v.z))
    });
    let rod = cube.with_vertices(slanted.collect());
    for order in [[0, 1], [1, 0]] {
        let blocks = [(cube.clone(), Motion::Rigid), (rod.clone(), Motion::Deformable)];
        let mut scene = Scene::new(order.map(|k: usize| blocks[k].clone()).to_vec(), "0", ["0", "0", "-10"]);
        scene.simulation.materials[0].young = number("1");
        for (stress, value) in scene.bodies[order[1]].stress.iter_mut().zip(["1/3", "-1/7", "5/11", "1", "-2/3"]) {
            *stress = number(value);
        }
        assert!(encloses(&scene, &[0, 1]));
    }
}

/// A tip 10⁻¹¹ m in a slab whose spring pulls it in, all but as strongly as its inertia holds it: of 2m/Δt² − p_n 1 N/m is left.
#[test]
fn no_bound_is_claimed_where_a_spring_pulls() {
    let slab = cuboid(["-4", "-4", "-4"], ["4", "4", "0"]);
    let tip = spike(["0", "0", "-1/100000000000"]);
    let held = exact("20000") * tip.volume() * exact("2000");
    let spring = exact("1") - &held;
    let mut scene = Scene::new(vec![(slab, Motion::Fixed), (tip, Motion::Rigid)], "0", ["0", "0", "0"]);
    let joint = &mut scene.simulation.joints.other;
    joint.normal_stiffness = Some(Number::from_rational(spring.clone()));
    joint.shear_ratio = number("0");
    encloses(&scene, &[1]);
    // Kept to a grid, it moves as far as the exact system says.
    let grid = 80;
    let state = scene.step(&scene.start(), KeptPrecision::Grid { exponent: grid }).state;
    let risen = state.blocks[1].vertices[0].z.to_rational() - scene.blocks[1].vertices()[0].z.to_rational();
    let expected = spring * exact("1/100000000000");
    assert!((risen - expected).abs() <= BigRational::new(2.into(), BigInt::from(1) << grid));
}
