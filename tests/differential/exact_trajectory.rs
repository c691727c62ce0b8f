//! Exact trajectories reproduce closed forms as equal fractions: free fall, a block on a 3-4-5 incline at rest and sliding with
//! rational friction, Hooke's law.

use crate::boxes::{cuboid, n, tolerances};
use num_rational::BigRational;
use rockproof_differential::lockstep::Trajectory;
use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::{Material, PointLoad};
use rockproof_model::{Block, Motion, Number, Point, Scene, Vec3};
use rockproof_oracle::step::{ContactMemory, KeptPrecision, Mode};

fn q(text: &str) -> BigRational {
    n(text).to_rational()
}

fn whole(value: i64) -> BigRational {
    BigRational::from_integer(value.into())
}

fn number(value: &BigRational) -> Number {
    Number::from_rational(value.clone())
}

fn v(c: [&str; 3]) -> Vec3<Number> {
    Vec3::new(n(c[0]), n(c[1]), n(c[2]))
}

/// Blocks of 2000 kg/m³, E = 10¹⁰ Pa, ν = 1/4, joints of 10⁹ N/m, steps of 1/100 s.
fn scene(blocks: Vec<SceneBlock>, gravity: [&str; 3], friction: &str) -> Scene {
    let mut scene = Scene { blocks, ..Scene::default() };
    let simulation = &mut scene.simulation;
    simulation.gravity = v(gravity);
    simulation.control.time_step = n("1/100");
    simulation.materials =
        vec![Material { name: "rock".to_owned(), density: n("2000"), young: n("1e10"), poisson: n("1/4") }];
    simulation.joints.other.normal_stiffness = Some(n("1e9"));
    simulation.joints.other.shear_ratio = n("2/5");
    simulation.joints.other.friction = n(friction);
    scene
}

fn load(block: usize, at: Point, force: [Number; 3]) -> PointLoad {
    let [x, y, z] = force;
    PointLoad { block, at, table: vec![(Number::ZERO, Vec3::new(x, y, z))] }
}

fn trajectory(scene: &Scene) -> Trajectory {
    Trajectory::new(scene, &tolerances(), KeptPrecision::Exact)
}

#[test]
fn a_block_falls_half_g_t_squared() {
    let mut block = cuboid("stone", ["0", "0", "0"], ["1", "2", "3"], Motion::Deformable);
    block.body.velocity = v(["3", "0", "1/3"]);
    let mut scene = scene(vec![block], ["0", "0", "-10"], "0");
    let middle =
        rockproof_model::simulation::MeasuredPoint { name: "middle".to_owned(), block: 0, at: v(["1/2", "1", "3/2"]) };
    scene.simulation.measured_points.push(middle);
    let mut trajectory = trajectory(&scene);
    for k in 1..=10 {
        trajectory.step().unwrap();
        let t = whole(k) / whole(100);
        let z = q("1/3") * &t - whole(5) * &t * &t;
        let x = whole(3) * &t;
        let moved = trajectory.state().blocks[0].vertices.iter().zip(scene.blocks[0].block.vertices());
        for (now, then) in moved.chain(trajectory.measured().iter().zip([&v(["1/2", "1", "3/2"])])) {
            let expected = [then.x.to_rational() + &x, then.y.to_rational(), then.z.to_rational() + &z];
            assert_eq!(now.components().map(Number::to_rational), expected, "step {k}");
        }
    }
}

/// What carries the weight across the slab on four corners: 8000·8 N over 4·10⁹ N/m.
const DEEP: &str = "64000/4000000000";

/// A slab below z = 0 and a box of 2 × 2 × 1 on it, in whose plane gravity, 10 m/s², is turned by the angle of sine 3/5. Two
/// loads take the moment of the force `along` that the slab exerts on the box's base, so that the box does not tilt.
fn incline(friction: &str, along: i64) -> Scene {
    let slab = cuboid("slab", ["-8", "-8", "-1"], ["8", "8", "0"], Motion::Fixed);
    let (low, high) = (number(&-q(DEEP)), number(&(whole(1) - q(DEEP))));
    let corner = |x, z: &Number| Vec3::new(n(x), n(x), z.clone());
    let mut block = SceneBlock::new("box", Block::cuboid(&corner("-1", &low), &corner("1", &high)).unwrap());
    block.body.motion = Motion::Rigid;
    let mut scene = scene(vec![slab, block], ["6", "0", "-8"], friction);
    let half = whole(along) / whole(4);
    let at = |x| Vec3::new(n(x), Number::ZERO, number(&(q("1/2") - q(DEEP))));
    let up = |force: BigRational| [Number::ZERO, Number::ZERO, number(&force)];
    scene.simulation.loads = vec![load(1, at("-1"), up(-half.clone())), load(1, at("1"), up(half))];
    scene
}

#[test]
fn a_block_slides_down_a_3_4_5_incline_with_rational_friction() {
    // 6 − 8·tan φ, tan φ = 1/4 and 1/2: friction of 16 and 32 kN.
    for (friction, along, acceleration) in [("1/4", 16_000, "4"), ("1/2", 32_000, "2")] {
        let scene = incline(friction, along);
        let mut trajectory = trajectory(&scene);
        for k in 1..=6 {
            let answer = trajectory.step().unwrap();
            assert!(answer.converged && answer.levels.undecided == 0);
            assert!(answer.state.contacts.iter().all(|contact| contact.mode == Mode::Sliding));
            let t = whole(k) / whole(100);
            let slid = q(acceleration) * &t * &t / whole(2);
            for (now, then) in trajectory.state().blocks[1].vertices.iter().zip(scene.blocks[1].block.vertices()) {
                assert_eq!(now.x.to_rational(), then.x.to_rational() + &slid, "tan φ = {friction}, step {k}");
                assert_eq!((&now.y, &now.z), (&then.y, &then.z), "tan φ = {friction}, step {k}");
            }
        }
    }
}

#[test]
fn a_block_at_rest_on_a_3_4_5_incline_stays_where_it_is() {
    // tan φ = 1 holds 48 kN of 64. Each corner's shear spring, of 4·10⁸ N/m, is stretched by 12 kN.
    let scene = incline("1", 48_000);
    let mut trajectory = trajectory(&scene);
    let mut state = trajectory.state().clone();
    let contacts = trajectory.clone().step().unwrap().contacts;
    assert_eq!(contacts.len(), 4);
    let stretch = whole(12_000) / whole(400_000_000);
    state.contacts = contacts
        .into_iter()
        .map(|(blocks, contact)| {
            let own = state.blocks[1].vertices[contact.key.numbers()[1] as usize].clone();
            let held = Vec3::new(number(&(own.x.to_rational() - &stretch)), own.y.clone(), Number::ZERO);
            ContactMemory { blocks, contact, mode: Mode::Locked, anchors: [held, own] }
        })
        .collect();
    let rest = state.blocks[1].clone();
    trajectory.restart(state);
    for step in 1..=20 {
        let answer = trajectory.step().unwrap();
        assert!(answer.converged && answer.iterations == 1 && answer.levels.undecided == 0, "step {step}");
        assert!(answer.state.contacts.iter().all(|contact| contact.mode == Mode::Locked), "step {step}");
        assert_eq!(trajectory.state().blocks[1], rest, "step {step}");
    }
}

#[test]
fn a_pressed_column_obeys_hooke() {
    // 1 × 1 × 2, pressed by 1 MN at both ends' middles.
    let column = cuboid("column", ["0", "0", "0"], ["1", "1", "2"], Motion::Deformable);
    let mut pressed = scene(vec![column], ["0", "0", "0"], "0");
    let push = |z, force| load(0, v(["1/2", "1/2", z]), [Number::ZERO, Number::ZERO, n(force)]);
    pressed.simulation.loads = vec![push("0", "1000000"), push("2", "-1000000")];
    // With the stress of the closed form, σz = −F/A, nothing moves.
    let mut balanced = pressed.clone();
    balanced.blocks[0].body.stress[2] = n("-1000000");
    let mut still = trajectory(&balanced);
    let begin = still.state().blocks[0].clone();
    for step in 1..=5 {
        still.step().unwrap();
        assert_eq!(still.state().blocks[0], begin, "step {step}");
    }
    // Without it, one step from rest gives V σ + (2/Δt²) M ε = pull, M's entries for the normal strains ρ/6, ρ/6, 2ρ/3.
    let mut moving = trajectory(&pressed);
    moving.step().unwrap();
    let stress: Vec<BigRational> = moving.state().blocks[0].stress.iter().map(Number::to_rational).collect();
    let (young, poisson) = (whole(10_000_000_000), q("1/4"));
    let inertia = whole(2 * 10_000 * 2000);
    for (axis, (moment, pull)) in [("1/6", 0), ("1/6", 0), ("2/3", -2_000_000)].into_iter().enumerate() {
        let others: BigRational = (0..3).filter(|&other| other != axis).map(|other| &stress[other] * &poisson).sum();
        let strain = (&stress[axis] - others) / &young;
        assert_eq!(whole(2) * &stress[axis] + &inertia * q(moment) * strain, whole(pull), "axis {axis}");
    }
}
