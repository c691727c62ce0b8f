//! Closed forms that one step, and several, must reproduce to the last digit of a fraction: free fall, a damped flight, a
//! block that rests, sticks and slides on a 3-4-5 incline, Hooke's law. And the same steps on a grid, beside the fractions.

use crate::support::shapes::{block, cuboid, exact, number, point};
use crate::support::steps::Scene;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::{Kinematics, Motion};
use rockproof_model::{Block, Number, Sign, Vec3};
use rockproof_oracle::step::{KeptPrecision, Mode};

fn value(n: &Number) -> BigRational {
    n.to_rational()
}

#[test]
fn free_fall_is_half_g_t_squared() {
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "2", "3"]), Motion::Deformable)], "0", ["0", "0", "-10"]);
    scene.bodies[0].velocity = Vec3::new(number("3"), Number::ZERO, number("1/3"));
    let mut state = scene.start();
    for k in 1..=10 {
        state = scene.step(&state, KeptPrecision::Exact).state;
        let t = BigRational::new(k.into(), 100.into());
        let z = exact("1/3") * &t - exact("5") * &t * &t;
        for (moved, at) in state.blocks[0].vertices.iter().zip(scene.blocks[0].vertices()) {
            assert_eq!(value(&moved.x), value(&at.x) + exact("3") * &t);
            assert_eq!(moved.y, at.y);
            assert_eq!(value(&moved.z), value(&at.z) + &z);
        }
        assert_eq!(value(&state.blocks[0].velocity[2]), exact("1/3") - exact("10") * &t);
        assert_eq!(value(&state.time), t);
    }
}

/// A slab below z = 0, and a box of 2 × 2 × 1 that overlaps it by what carries its weight across the slab. Gravity,
/// 10 m/s², is turned by the angle of sine 3/5: 6 along x, 8 down.
fn incline(friction: &str, deepest: &str) -> Scene {
    let slab = cuboid(["-8", "-8", "-1"], ["8", "8", "0"]);
    let at = |z: &str| Number::from_rational(exact(z) - exact(deepest));
    let lifted = |b: Block, low: Number, high: Number| {
        let vertices = b.vertices().iter().enumerate();
        let moved =
            vertices.map(|(k, v)| Vec3::new(v.x.clone(), v.y.clone(), if k < 4 { low.clone() } else { high.clone() }));
        b.with_vertices(moved.collect())
    };
    let box_ = lifted(cuboid(["-1", "-1", "0"], ["1", "1", "1"]), at("0"), at("1"));
    Scene::new(vec![(slab, Motion::Fixed), (box_, Motion::Rigid)], friction, ["6", "0", "-8"])
}

/// Weight across the slab 8000·8 N on four corners of 10⁹ N/m.
const CARRIED: &str = "64000/4000000000";

#[test]
fn a_block_slides_without_friction_with_the_slope_s_share_of_gravity() {
    let scene = incline("0", CARRIED);
    let mut state = scene.start();
    for k in 1..=8 {
        let answer = scene.step(&state, KeptPrecision::Exact);
        assert_eq!(answer.contacts.len(), 4);
        assert!(answer.converged && answer.retries.is_empty() && answer.levels.undecided == 0);
        assert!(answer.modes.last().unwrap().iter().all(|&mode| mode == Mode::Sliding));
        state = answer.state;
        let t = BigRational::new(k.into(), 100.into());
        let moved = exact("3") * &t * &t;
        for (v, at) in state.blocks[1].vertices.iter().zip(scene.blocks[1].vertices()) {
            assert_eq!(value(&v.x), value(&at.x) + &moved, "step {k}");
            assert_eq!((&v.y, &v.z), (&at.y, &at.z), "step {k}");
        }
    }
}

#[test]
fn a_block_slides_with_rational_friction_to_the_last_digit() {
    // tan φ = 1/4: 6 − 8/4 = 4 m/s². A couple of two point loads takes the moment of friction, 16000 N on an arm of
    // half the height (and the overlap), so that the block does not tilt.
    let mut scene = incline("1/4", CARRIED);
    let arm = exact("1/2");
    let force = exact("16000") * &arm / exact("2");
    let load = |x: &str, up: BigRational| rockproof_model::simulation::PointLoad {
        block: 1,
        at: Vec3::new(number(x), Number::ZERO, Number::from_rational(exact("1/2") - exact(CARRIED))),
        table: vec![(Number::ZERO, Vec3::new(Number::ZERO, Number::ZERO, Number::from_rational(up)))],
    };
    // Friction pulls towards −x below the centroid: its moment about y is +(16000 · 1/2).
    scene.simulation.loads = vec![load("-1", -force.clone()), load("1", force)];
    let mut state = scene.start();
    for k in 1..=5 {
        let answer = scene.step(&state, KeptPrecision::Exact);
        assert_eq!(answer.levels.undecided, 0);
        assert!(answer.converged);
        assert!(answer.modes.last().unwrap().iter().all(|&mode| mode == Mode::Sliding), "{:?}", answer.modes);
        state = answer.state;
        let t = BigRational::new(k.into(), 100.into());
        for (v, at) in state.blocks[1].vertices.iter().zip(scene.blocks[1].vertices()) {
            assert_eq!(value(&v.x), value(&at.x) + exact("2") * &t * &t, "step {k}");
            assert_eq!(v.z, at.z, "step {k}");
        }
    }
}

#[test]
fn a_settled_block_rests_where_friction_holds_it() {
    // The moment of the weight unloads the two upper corners to 10 kN of 16; each carries 12 kN of shear. So tan φ must
    // be above 6/5 for all four to lock, although 3/4 would hold the block.
    let mut scene = incline("3/2", CARRIED);
    scene.simulation.control.settle = 60;
    // At rest the block leans: edges at the upper corners dip by the angle of its overlaps.
    scene.tolerances.overlap_sine = number("1/1000");
    let mut state = scene.start();
    let keep = KeptPrecision::Grid { exponent: 256 };
    for _ in 0..60 {
        state = scene.step(&state, keep).state;
    }
    let rest = state.blocks[1].vertices.clone();
    for _ in 0..5 {
        let answer = scene.step(&state, keep);
        assert!(answer.modes.last().unwrap().iter().all(|&mode| mode == Mode::Locked));
        state = answer.state;
    }
    for (v, at) in state.blocks[1].vertices.iter().zip(&rest) {
        for (a, b) in v.components().into_iter().zip(at.components()) {
            assert!((a.approximate() - b.approximate()).abs() < 1e-9);
        }
    }
}

#[test]
fn stretch_under_uniaxial_load_is_hooke_s() {
    // A column 1 × 1 × 2 pulled at both ends' middles with ±F: stress F/A = 10⁶, ε = σ/E, −νσ/E across, once at rest. One
    // static step with a very long Δt leaves the inertia's share, which the closed form contains.
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "2"]), Motion::Deformable)], "0", ["0", "0", "0"]);
    let pull = |z: &str, f: &str| rockproof_model::simulation::PointLoad {
        block: 0,
        at: point(["1/2", "1/2", z]),
        table: vec![(Number::ZERO, point(["0", "0", f]))],
    };
    scene.simulation.loads = vec![pull("0", "-1000000"), pull("2", "1000000")];
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    let stress: Vec<BigRational> = state.blocks[0].stress.iter().map(value).collect();
    // V σ + (2/Δt²) M ε = pull: with the second moments 1/6, 1/6, 2/3 (times ρ) on the three normal strains.
    let (young, poisson) = (exact("10000000000"), exact("1/4"));
    let strain = |a: usize| {
        let others: BigRational = (0..3).filter(|&b| b != a).map(|b| &stress[b] * &poisson).sum();
        (&stress[a] - others) / &young
    };
    let inertia = exact("2") * exact("10000") * exact("2000");
    for (axis, (moment, force)) in [("1/6", "0"), ("1/6", "0"), ("2/3", "2000000")].into_iter().enumerate() {
        assert_eq!(exact("2") * &stress[axis] + &inertia * exact(moment) * strain(axis), exact(force));
    }
    assert!(stress[3..].iter().all(|s| *s == exact("0")));
}

#[test]
fn the_grid_keeps_within_one_unit_of_the_fractions() {
    let scene = incline("1/4", "1/100000");
    let (mut fine, start) = (scene.start(), scene.start());
    let exactly = scene.step(&start, KeptPrecision::Exact);
    let grid = scene.step(&fine, KeptPrecision::Grid { exponent: 256 });
    assert_eq!((&exactly.modes, exactly.iterations), (&grid.modes, grid.iterations));
    let unit = BigRational::new(1.into(), BigInt::from(1) << 256);
    for (a, b) in exactly.state.blocks[1].vertices.iter().zip(&grid.state.blocks[1].vertices) {
        for (a, b) in a.components().into_iter().zip(b.components()) {
            assert!((value(a) - value(b)).magnitude_below(&unit));
        }
    }
    fine = grid.state;
    assert_eq!(fine.contacts.len(), 4);
    assert!(fine.contacts.iter().all(|c| c.contact.gap == Sign::Negative));
}

trait Below {
    fn magnitude_below(&self, unit: &BigRational) -> bool;
}

impl Below for BigRational {
    fn magnitude_below(&self, unit: &BigRational) -> bool {
        *self <= *unit && -self <= *unit
    }
}

#[test]
fn a_tetrahedron_turns_and_keeps_its_volume_under_cayley() {
    let tetrahedron = block(
        [["0", "0", "0"], ["2", "0", "0"], ["0", "3", "0"], ["0", "0", "1"]].map(point).to_vec(),
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    );
    let mut scene = Scene::new(vec![(tetrahedron, Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.simulation.control.kinematics = Kinematics::Cayley;
    scene.bodies[0].spin = Vec3::new(number("1"), number("2"), number("-1"));
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    let turned = scene.blocks[0].with_vertices(state.blocks[0].vertices.clone());
    assert_ne!(turned, scene.blocks[0]);
    assert_eq!(turned.volume(), scene.blocks[0].volume());
}

#[test]
fn damping_acts_by_the_time_step_of_the_attempt_and_not_while_settling() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Rigid)], "0", ["0", "0", "-10"]);
    scene.bodies[0].velocity = point(["3", "0", "0"]);
    scene.simulation.control.damping = number("20/3");
    // v' = ((1 − x)v + gΔt)/(1 + x), x = cΔt/2 = 1/30; the way is Δt(v + v')/2.
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    let rates = |state: &rockproof_oracle::step::State| [0, 2].map(|k: usize| value(&state.blocks[0].velocity[k]));
    assert_eq!(rates(&state), [exact("87/31"), exact("-3/31")]);
    assert_eq!(value(&state.blocks[0].vertices[0].x), exact("9/310"));
    assert_eq!(value(&state.blocks[0].vertices[0].z), exact("-3/6200"));
    let next = scene.step(&state, KeptPrecision::Exact).state;
    assert_eq!(rates(&next), [exact("87/31") * exact("29/31"), exact("-3/31") * exact("29/31") - exact("3/31")]);
    // 12 m/s are too fast for 1/100 s and for 1/100 s alone: x is 1/60 then.
    scene.bodies[0].velocity = point(["12", "0", "0"]);
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    assert_eq!(answer.time_step, exact("1/200"));
    assert_eq!(rates(&answer.state), [exact("12") * exact("59/61"), exact("-3/61")]);
    // While settling, d = Δt²g/2.
    scene.simulation.control.settle = 1;
    let settled = scene.step(&scene.start(), KeptPrecision::Exact).state;
    assert_eq!(value(&settled.blocks[0].vertices[0].z), exact("-1/2000"));
}

/// The strains are damped as well: (2/Δt² + c/Δt) in the place of 2/Δt².
#[test]
fn damping_takes_strain_rates_too() {
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Deformable)], "0", ["0", "0", "0"]);
    scene.bodies[0].stress[5] = number("1000000");
    scene.simulation.control.damping = number("100");
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    let strain = exact("-1000000") / (exact("30000") * exact("2000") / exact("24") + exact("4000000000"));
    assert_eq!(value(&state.blocks[0].velocity[11]), exact("200") * &strain);
}
