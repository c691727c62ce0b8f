//! Parts of the exact step that the closed forms of `exact_step` leave out: edges that cross, roles exchanged, fixed
//! points, loads over time, initial stress, inverted blocks, cuts of Δt, irrational friction; and what exchanging, moving, scaling and
//! turning a scene may not change.

// Longer than 400 lines: one closed form after another, each on a scene of its own.

use crate::support::shapes::{Prism, WEDGE, cuboid, exact, number, point, spike};
use crate::support::steps::Scene;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::{FixedPoint, Kinematics, Material, Motion, PointLoad};
use rockproof_model::{Block, ContactKind, Number, Vec3};
use rockproof_oracle::step::{
    CertifiedStep, EnclosedStep, FailedAttempt, IterationEnd, KeptPrecision, Mode, RetryReason, StepFailure, StepModel,
    certified_step, enclosed_step, exact_step,
};

const FINE: KeptPrecision = KeptPrecision::Grid { exponent: 128 };

fn value(n: &Number) -> BigRational {
    n.to_rational()
}

/// How far each vertex of a block moved in a step that must move it along z alone.
fn risen(scene: &Scene, block: usize) -> BigRational {
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    let moved: Vec<BigRational> = state.blocks[block]
        .vertices
        .iter()
        .zip(scene.blocks[block].vertices())
        .map(|(now, before)| {
            assert_eq!((&now.x, &now.y), (&before.x, &before.y));
            value(&now.z) - value(&before.z)
        })
        .collect();
    assert!(moved.iter().all(|z| *z == moved[0]));
    moved[0].clone()
}

/// `(2m/Δt² + k)·d = F` with m in kg, k in N/m, F in N and Δt = 1/100.
fn pushed(mass: &BigRational, stiffness: &str, force: BigRational) -> BigRational {
    force / (exact("20000") * mass + exact(stiffness))
}

#[test]
fn crossing_ridges_press_each_other_apart() {
    // The upper ridge lies along y, its body above it, 1/1000 deep in the lower one, which lies along x.
    let lower = Prism { offset: ["0", "0", "0"], ..WEDGE }.upside_down_along_x();
    let upper_body = Prism { p: ["3", "4"], q: ["-3", "4"], half: "2", offset: ["0", "0", "0"] };
    let along = upper_body.along_x();
    let turned = along.vertices().iter().map(|v| Vec3::new(v.y.negated(), v.x.clone(), v.z.plus(&number("-1/1000"))));
    let upper = along.with_vertices(turned.collect());
    let mass = upper.volume() * exact("2000");
    for (exchanged, blocks) in [
        (false, vec![(lower.clone(), Motion::Fixed), (upper.clone(), Motion::Rigid)]),
        (true, vec![(upper, Motion::Rigid), (lower, Motion::Fixed)]),
    ] {
        let scene = Scene::new(blocks, "0", ["0", "0", "-10"]);
        let answer = scene.step(&scene.start(), KeptPrecision::Exact);
        assert_eq!(answer.contacts.len(), 1, "{:?}", answer.contacts);
        assert_eq!(answer.contacts[0].1.kind(), ContactKind::EdgeEdge);
        let force = exact("1000000") - &mass * exact("10");
        assert_eq!(risen(&scene, usize::from(!exchanged)), pushed(&mass, "1000000000", force));
    }
}

#[test]
fn a_tip_presses_a_slab_whichever_comes_first() {
    let slab = || cuboid(["-4", "-4", "-4"], ["4", "4", "0"]);
    let tip = || spike(["0", "0", "-1/1000"]);
    let mass = tip().volume() * exact("2000");
    let force = exact("1000000") - &mass * exact("10");
    for (kind, block, blocks) in [
        (ContactKind::FaceVertex, 1, vec![(slab(), Motion::Fixed), (tip(), Motion::Rigid)]),
        (ContactKind::VertexFace, 0, vec![(tip(), Motion::Rigid), (slab(), Motion::Fixed)]),
    ] {
        let scene = Scene::new(blocks, "0", ["0", "0", "-10"]);
        assert_eq!(scene.step(&scene.start(), KeptPrecision::Exact).contacts[0].1.kind(), kind);
        assert_eq!(risen(&scene, block), pushed(&mass, "1000000000", force.clone()));
    }
}

#[test]
fn a_fixed_point_holds_by_its_spring() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "2"]), Motion::Rigid)], "0", ["0", "0", "-10"]);
    scene.simulation.fixed_points =
        vec![FixedPoint { block: 0, at: point(["1/2", "1/2", "1"]), stiffness: Some(number("1000000")) }];
    let mass = exact("4000");
    let first = pushed(&mass, "1000000", exact("-40000"));
    assert_eq!(risen(&scene, 0), first);
    // Without a stiffness of its own it has that of the stiffest joint. The second step: the point pulls back.
    scene.simulation.fixed_points[0].stiffness = None;
    let first = pushed(&mass, "1000000000", exact("-40000"));
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    assert_eq!(value(&state.fixed_points[0].z), exact("1") + &first);
    let velocity = exact("200") * &first;
    assert_eq!(value(&state.blocks[0].velocity[2]), velocity);
    let force = exact("-40000") - exact("1000000000") * &first + exact("200") * &mass * &velocity;
    let second = pushed(&mass, "1000000000", force);
    let state = scene.step(&state, KeptPrecision::Exact).state;
    assert_eq!(value(&state.fixed_points[0].z), exact("1") + first + second);
}

#[test]
fn a_load_is_that_of_the_end_of_the_step() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "2"]), Motion::Rigid)], "0", ["0", "0", "0"]);
    let up = |force: &str| point(["0", "0", force]);
    // Linear from 0 at 1/200 s to 6000 N at 3/200 s, constant after.
    let table = vec![(number("1/200"), up("0")), (number("3/200"), up("6000"))];
    scene.simulation.loads = vec![PointLoad { block: 0, at: point(["1/2", "1/2", "1"]), table }];
    let mass = exact("4000");
    let start = scene.start();
    let first = scene.step(&start, KeptPrecision::Exact).state;
    let moved = |state: &rockproof_oracle::step::State| value(&state.load_points[0].z) - exact("1");
    assert_eq!(moved(&first), pushed(&mass, "0", exact("3000")));
    let velocity = value(&first.blocks[0].velocity[2]);
    let second = scene.step(&first, KeptPrecision::Exact).state;
    let force = exact("6000") + exact("200") * &mass * velocity;
    assert_eq!(moved(&second) - moved(&first), pushed(&mass, "0", force));
    // While settling, time stands at 0.
    scene.simulation.control.settle = 1;
    assert_eq!(moved(&scene.step(&scene.start(), KeptPrecision::Exact).state), exact("0"));
}

#[test]
fn initial_stress_strains_a_free_block() {
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Deformable)], "0", ["0", "0", "0"]);
    scene.bodies[0].stress[5] = number("1000000");
    let state = scene.step(&scene.start(), KeptPrecision::Exact).state;
    // Of γxy: (2/Δt²)·ρ·(1/12 + 1/12)/4 + V·G against −V·τ, G = E/(2(1 + ν)) = 4·10⁹.
    let strain = exact("-1000000") / (exact("20000") * exact("2000") / exact("24") + exact("4000000000"));
    assert_eq!(value(&state.blocks[0].stress[5]), exact("1000000") + exact("4000000000") * &strain);
    assert_eq!(value(&state.blocks[0].velocity[11]), exact("200") * &strain);
    assert!(state.blocks[0].stress[..5].iter().all(|s| *s == Number::ZERO));
}

#[test]
fn a_block_without_a_positive_volume_ends_the_run() {
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Deformable)], "0", ["0", "0", "0"]);
    scene.tolerances.max_displacement = number("2");
    // As above: a shear strain γ leaves 1 − γ²/4 of the volume, which is nothing at γ = −2.
    let resistance = exact("20000") * exact("2000") / exact("24") + exact("4000000000");
    for kinematics in [Kinematics::Linear, Kinematics::Cayley] {
        scene.simulation.control.kinematics = kinematics;
        let little = exact("1/1000000000000000000000000");
        for (strain, ended) in [(exact("2"), true), (exact("2") + &little, true), (exact("2") - &little, false)] {
            scene.bodies[0].stress[5] = Number::from_rational(&strain * &resistance);
            let shapes: Vec<&Block> = scene.blocks.iter().collect();
            let model = scene.model(&shapes);
            let exactly = exact_step(&model, &scene.start(), FINE).map(|answer| answer.time_step);
            let expected = if ended { Err(StepFailure::Inverted { block: 0 }) } else { Ok(exact("1/100")) };
            assert_eq!(exactly, expected, "{strain} {kinematics:?}");
            assert_eq!(certified_step(&model, &scene.start()).map(|answer| answer.time_step), expected);
        }
    }
}

#[test]
fn a_rotation_changes_the_volume_of_a_linear_step_alone() {
    // γxy = −2 as above, and r = 5/100 about z: the linear part is ((1, −1 − r), (−1 + r, 1)), its determinant r². Under `cayley` it is
    // a rotation times a strain that leaves nothing.
    let mut scene =
        Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Deformable)], "0", ["0", "0", "0"]);
    scene.tolerances.max_displacement = number("2");
    let resistance = exact("20000") * exact("2000") / exact("24") + exact("4000000000");
    scene.bodies[0].stress[5] = Number::from_rational(exact("2") * resistance);
    scene.bodies[0].spin = point(["0", "0", "5"]);
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    for (kinematics, expected) in
        [(Kinematics::Linear, Ok(exact("1/100"))), (Kinematics::Cayley, Err(StepFailure::Inverted { block: 0 }))]
    {
        let mut simulation = scene.simulation.clone();
        simulation.control.kinematics = kinematics;
        let model = StepModel { simulation: &simulation, ..scene.model(&shapes) };
        assert_eq!(exact_step(&model, &scene.start(), FINE).map(|answer| answer.time_step), expected);
        assert_eq!(certified_step(&model, &scene.start()).map(|answer| answer.time_step), expected);
    }
}

#[test]
fn strains_that_f64_does_not_know_are_not_small() {
    // The bound of what f64 knows is one for all unknowns: next to a block of 10⁴⁰ kg/m³ it knows the strains of a light one badly. γxy = −3
    // leaves 1 − 9/4 of its volume.
    let light = (cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Deformable);
    let heavy = (cuboid(["100", "0", "0"], ["101", "1", "1"]), Motion::Rigid);
    let mut scene = Scene::new(vec![light, heavy], "0", ["0", "0", "0"]);
    scene.tolerances.max_displacement = number("2");
    let dense = format!("1{}", "0".repeat(40));
    let heavier = Material { density: number(&dense), ..scene.simulation.materials[0].clone() };
    scene.simulation.materials.push(heavier);
    scene.bodies[1].material = 1;
    scene.bodies[1].velocity = point(["100/3", "0", "0"]);
    let resistance = exact("20000") * exact("2000") / exact("24") + exact("4000000000");
    scene.bodies[0].stress[5] = Number::from_rational(exact("3") * resistance);
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let model = scene.model(&shapes);
    let ended = Err(StepFailure::Inverted { block: 0 });
    assert_eq!(exact_step(&model, &scene.start(), FINE).map(|answer| answer.time_step), ended);
    assert_eq!(certified_step(&model, &scene.start()).map(|answer| answer.time_step), ended);
}

/// That a certified step of blocks that nothing touches moves each by its velocity and turns it by its spin, known to 10⁻⁹.
fn flies(scene: &Scene) -> CertifiedStep {
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let EnclosedStep { decided, displacements } = enclosed_step(&scene.model(&shapes), &scene.start()).unwrap();
    let displacements = displacements.expect("enclosed");
    let (mut largest, mut widest) = (exact("0"), exact("0"));
    for (body, displacements) in scene.bodies.iter().zip(&displacements) {
        let rates = [&body.velocity, &body.spin].into_iter().flat_map(|v| v.components());
        assert_eq!(displacements.len(), 6);
        for (rate, pair) in rates.zip(displacements) {
            let [middle, radius] = pair.map(|value| BigRational::from_float(value).expect("finite"));
            let moved = value(rate) / exact("100");
            let off = &moved - &middle;
            assert!(off <= radius && -off <= radius, "{pair:?}");
            (largest, widest) = (largest.max(moved), widest.max(radius));
        }
    }
    assert!(widest <= largest / exact("1000000000"));
    decided
}

#[test]
fn a_thin_rod_askew_is_enclosed() {
    // Edges of 5 m along (4, 3, 0), of 5·2⁻¹⁴ m along (−3, 4, 0) and z. About its own axis it resists some 10⁻⁸ of what it does across.
    let thin = number("1/16384");
    let rod = cuboid(["0", "0", "0"], ["1", "1", "1"]);
    let along = |v: &rockproof_model::Point| {
        let (y, z) = (v.y.times(&thin), v.z.times(&thin));
        let times = |c: &Number, factor: &str| c.times(&number(factor));
        Vec3::new(times(&v.x, "4").plus(&times(&y, "-3")), times(&v.x, "3").plus(&times(&y, "4")), times(&z, "5"))
    };
    let rod = rod.with_vertices(rod.vertices().iter().map(along).collect());
    let mut scene = Scene::new(vec![(rod, Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.bodies[0].velocity = point(["1/3", "1/7", "1/11"]);
    scene.bodies[0].spin = point(["1/3", "1/7", "1/11"]);
    flies(&scene);
}

#[test]
fn a_step_of_more_unknowns_than_are_factored_whole_is_settled_in_f64() {
    let cube = |k: i32| cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&point([&(10 * k).to_string(), "0", "0"]));
    let mut scene = Scene::new((0..13).map(|k| (cube(k), Motion::Rigid)).collect(), "0", ["0", "0", "0"]);
    scene.bodies.iter_mut().for_each(|body| body.velocity = point(["1/3", "0", "0"]));
    let levels = flies(&scene).levels;
    assert!(levels.float > 0, "{levels:?}");
    assert_eq!((levels.wide, levels.exact, levels.undecided), ([0; 4], 0, 0), "{levels:?}");
}

#[test]
fn a_fast_block_is_halved_until_it_keeps_the_limit() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.bodies[0].velocity = point(["40", "0", "0"]);
    // 40 m/s: 4/10 of a metre, 2/10, and 1/10, which is the limit and allowed.
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    let retry = |time_step: &str, reason| FailedAttempt {
        time_step: exact(time_step),
        reason,
        solves: 1,
        end: IterationEnd::Settled,
    };
    assert_eq!(answer.retries, [retry("1/100", RetryReason::Displacement), retry("1/200", RetryReason::Displacement)]);
    assert_eq!(answer.time_step, exact("1/400"));
    assert_eq!(value(&answer.state.blocks[0].vertices[0].x), exact("1/10"));
    assert_eq!(value(&answer.state.time), exact("1/400"));
    scene.bodies[0].velocity = point(["0", "0", "0"]);
    scene.bodies[0].spin = point(["0", "0", "16"]);
    scene.tolerances.max_displacement = number("1");
    // 16 rad/s: 16/100, and 8/100 below the limit of 1/10.
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    assert_eq!(answer.retries, [retry("1/100", RetryReason::Rotation)]);
    scene.tolerances.max_rotation = number("1/1000000");
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let model: StepModel<'_> = scene.model(&shapes);
    assert_eq!(
        exact_step(&model, &scene.start(), KeptPrecision::Exact).unwrap_err(),
        StepFailure::TooFast { block: 0, limit: RetryReason::Rotation }
    );
    assert!(certified_step(&model, &scene.start()).is_err());
}

/// A box that slides over a slab in the direction (1, 1), where |s| is no fraction; it overlaps by what carries it.
fn diagonal(kinematics: Kinematics) -> Scene {
    let slab = cuboid(["-8", "-8", "-1"], ["8", "8", "0"]);
    let low = exact("-64000/4000000000");
    let raised = |b: Block| {
        let move_ = |v: &rockproof_model::Point| {
            Vec3::new(v.x.clone(), v.y.clone(), v.z.plus(&Number::from_rational(low.clone())))
        };
        b.with_vertices(b.vertices().iter().map(move_).collect())
    };
    let top = raised(cuboid(["-1", "-1", "0"], ["1", "1", "1"]));
    let mut scene = Scene::new(vec![(slab, Motion::Fixed), (top, Motion::Rigid)], "1/4", ["0", "0", "-8"]);
    scene.bodies[1].velocity = point(["1", "1", "0"]);
    scene.simulation.control.kinematics = kinematics;
    scene
}

#[test]
fn irrational_friction_is_enclosed() {
    for kinematics in [Kinematics::Linear, Kinematics::Cayley] {
        let scene = diagonal(kinematics);
        let shapes: Vec<&Block> = scene.blocks.iter().collect();
        let model = scene.model(&shapes);
        let failure = exact_step(&model, &scene.start(), KeptPrecision::Exact).unwrap_err();
        assert_eq!(failure, StepFailure::NotKept { keep: KeptPrecision::Exact });
        let told = failure.to_string();
        assert!(told.contains("cannot be had as fractions: ") && told.contains("without --fractions"), "{told}");
        let mut kept = [60u32, 90, 200, 600].map(|exponent| (exponent, scene.start()));
        let mut modes = Vec::new();
        for step in 0..3 {
            for (exponent, state) in &mut kept {
                let answer = scene.step(state, KeptPrecision::Grid { exponent: *exponent });
                assert_eq!(answer.levels.undecided, 0);
                assert!(answer.modes.last().unwrap().contains(&Mode::Sliding));
                modes.push((step, answer.modes));
                *state = answer.state;
            }
        }
        assert!(modes.chunk_by(|a, b| a.0 == b.0).all(|same| same.iter().all(|m| m == &same[0])));
        // The coarser grids follow the finest.
        let (_, finest) = &kept[3];
        for (exponent, state) in &kept[..3] {
            let allowed = BigRational::new(1.into(), BigInt::from(1) << (exponent - 16));
            for (a, b) in state.blocks[1].vertices.iter().zip(&finest.blocks[1].vertices) {
                for (a, b) in a.components().into_iter().zip(b.components()) {
                    let apart = value(a) - value(b);
                    assert!(apart <= allowed && -apart <= allowed, "2^-{exponent}");
                }
            }
        }
        // Both directions are alike.
        for v in &finest.blocks[1].vertices[..1] {
            assert!((v.x.approximate() - v.y.approximate()).abs() < 1e-100f64.max(f64::EPSILON));
        }
    }
}

#[test]
fn a_slip_askew_without_friction_is_a_fraction() {
    let mut scene = diagonal(Kinematics::Linear);
    scene.simulation.joints.other.friction = Number::ZERO;
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    assert!(answer.modes.last().unwrap().iter().all(|mode| *mode == Mode::Sliding), "{:?}", answer.modes);
    for (now, before) in answer.state.blocks[1].vertices.iter().zip(scene.blocks[1].vertices()) {
        let pairs = now.components().into_iter().zip(before.components());
        let moved: Vec<BigRational> = pairs.map(|(now, before)| value(now) - value(before)).collect();
        assert_eq!(moved, ["1/100", "1/100", "0"].map(exact));
    }
}

#[test]
fn a_certified_step_decides_what_the_exact_step_does() {
    let scene = diagonal(Kinematics::Cayley);
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let model = scene.model(&shapes);
    let mut state = scene.start();
    for _ in 0..3 {
        let certified = certified_step(&model, &state).unwrap();
        let enclosed = enclosed_step(&model, &state).unwrap();
        let answer = exact_step(&model, &state, FINE).unwrap();
        assert_eq!((&enclosed.decided.modes, enclosed.decided.levels), (&certified.modes, certified.levels));
        assert_eq!((&certified.modes, &certified.contacts), (&answer.modes, &answer.contacts));
        assert_eq!(
            (certified.converged, &certified.retries, certified.levels),
            (answer.converged, &answer.retries, answer.levels)
        );
        // The block is rigid: its centroid moves by the first three unknowns.
        let displacements = enclosed.displacements.unwrap();
        assert!(displacements[0].is_empty());
        let mean = |s: &rockproof_oracle::step::State, axis: usize| -> BigRational {
            let all = s.blocks[1].vertices.iter().map(|v| value(v.components()[axis]));
            all.sum::<BigRational>() / exact("8")
        };
        for (axis, [middle, radius]) in displacements[1][..3].iter().enumerate() {
            let off = mean(&answer.state, axis) - mean(&state, axis) - BigRational::from_float(*middle).unwrap();
            let radius = BigRational::from_float(*radius).unwrap() + BigRational::new(1.into(), BigInt::from(1) << 100);
            assert!(off <= radius && -off <= radius, "axis {axis}");
            assert!(radius < exact("1/100000000000"));
        }
        state = answer.state;
    }
}

/// A slab, a box thrown on it, and a wedge on the box: friction, several kinds of contact, both motions.
fn heap() -> Scene {
    let slab = cuboid(["-8", "-8", "-1"], ["8", "8", "0"]);
    let box_ = cuboid(["-1", "-1", "-1/100000"], ["1", "1", "1"]);
    let tip = spike(["1/4", "1/8", "99999/100000"]);
    let blocks = vec![(slab, Motion::Fixed), (box_, Motion::Deformable), (tip, Motion::Rigid)];
    let mut scene = Scene::new(blocks, "1/2", ["1", "2", "-8"]);
    // Corners of a box that tips a little are still found.
    scene.tolerances.overlap_sine = number("1/20");
    scene.bodies[1].velocity = point(["1", "0", "-1/8"]);
    scene.bodies[2].velocity = point(["0", "1/2", "-1/4"]);
    scene.bodies[2].spin = point(["1/4", "1/8", "1/2"]);
    scene
}

/// The blocks of a contact, and its modes after each solve.
type History = ([usize; 2], Vec<Mode>);

/// The contacts of each step; the order of blocks does not count.
fn history(scene: &Scene, order: &[usize], steps: usize) -> (Vec<Vec<History>>, rockproof_oracle::step::State) {
    let mut state = scene.start();
    let mut all = Vec::new();
    for _ in 0..steps {
        let answer = scene.step(&state, FINE);
        assert_eq!(answer.levels.undecided, 0);
        let mut modes: Vec<History> = answer
            .contacts
            .iter()
            .enumerate()
            .map(|(k, (blocks, _))| {
                let mut blocks = blocks.map(|b| order[b]);
                blocks.sort_unstable();
                (blocks, answer.modes.iter().map(|modes| modes[k]).collect())
            })
            .collect();
        modes.sort();
        all.push(modes);
        state = answer.state;
    }
    (all, state)
}

fn near(a: &Number, b: &BigRational) -> bool {
    let allowed = BigRational::new(1.into(), BigInt::from(1) << 100);
    let apart = value(a) - b;
    apart <= allowed && -apart <= allowed
}

#[test]
fn exchanging_blocks_changes_nothing() {
    let scene = heap();
    let (modes, state) = history(&scene, &[0, 1, 2], 4);
    assert!(modes.iter().flatten().count() > 12);
    let mut exchanged = scene.clone();
    exchanged.blocks.reverse();
    exchanged.bodies.reverse();
    let (same, other) = history(&exchanged, &[2, 1, 0], 4);
    assert_eq!(modes, same);
    for (a, b) in state.blocks.iter().zip(other.blocks.iter().rev()) {
        for (a, b) in a.vertices.iter().zip(&b.vertices) {
            assert!(a.components().into_iter().zip(b.components()).all(|(a, b)| near(a, &value(b))));
        }
    }
}

#[test]
fn moving_scaling_and_turning_a_scene_changes_nothing() {
    let scene = heap();
    let (modes, state) = history(&scene, &[0, 1, 2], 3);
    // Moved by thirds and sevenths, far away.
    let offset = point(["100000/3", "-20000/7", "1/3"]);
    let mut moved = scene.clone();
    moved.blocks.iter_mut().for_each(|b| *b = b.translated(&offset));
    let (same, other) = history(&moved, &[0, 1, 2], 3);
    assert_eq!(modes, same);
    for (a, b) in state.blocks.iter().zip(&other.blocks) {
        for (a, b) in a.vertices.iter().zip(&b.vertices) {
            let shifted = a.components().into_iter().zip(offset.components()).map(|(a, o)| value(a) + value(o));
            assert!(b.components().into_iter().zip(shifted).all(|(b, a)| near(b, &a)));
        }
    }
    // Lengths times 4: masses times 64, accelerations and velocities times 4, stiffnesses times 64, stresses times 16.
    let mut scaled = scene.clone();
    let four = number("4");
    let times = |v: &Vec3<Number>| v.map(|c| c.times(&four));
    scaled.blocks.iter_mut().for_each(|b| *b = b.with_vertices(b.vertices().iter().map(times).collect()));
    scaled.bodies.iter_mut().for_each(|body| body.velocity = times(&body.velocity));
    scaled.simulation.gravity = times(&scaled.simulation.gravity);
    let joint = &mut scaled.simulation.joints.other;
    joint.normal_stiffness = joint.normal_stiffness.as_ref().map(|k| k.times(&number("64")));
    let young = &mut scaled.simulation.materials[0].young;
    *young = young.times(&number("16"));
    for (name, place) in scaled.tolerances.numbers_mut() {
        if !name.contains("sine") && name != "equal" && name != "max_rotation" {
            *place = place.times(&four);
        }
    }
    let (same, other) = history(&scaled, &[0, 1, 2], 3);
    assert_eq!(modes, same);
    for (a, b) in state.blocks.iter().zip(&other.blocks) {
        for (a, b) in a.vertices.iter().zip(&b.vertices) {
            let larger = a.components().map(|a| value(a) * exact("4"));
            assert!(b.components().into_iter().zip(larger).all(|(b, a)| near(b, &a)));
        }
    }
    // x becomes y, y becomes z, z becomes x.
    let turn = |v: &Vec3<Number>| Vec3::new(v.z.clone(), v.x.clone(), v.y.clone());
    let mut turned = scene.clone();
    turned.blocks.iter_mut().for_each(|b| *b = b.with_vertices(b.vertices().iter().map(turn).collect()));
    for body in &mut turned.bodies {
        (body.velocity, body.spin) = (turn(&body.velocity), turn(&body.spin));
    }
    turned.simulation.gravity = turn(&turned.simulation.gravity);
    let (same, other) = history(&turned, &[0, 1, 2], 3);
    assert_eq!(modes, same);
    for (a, b) in state.blocks.iter().zip(&other.blocks) {
        for (a, b) in a.vertices.iter().zip(&b.vertices) {
            let a = turn(a);
            assert!(a.components().into_iter().zip(b.components()).all(|(a, b)| near(a, &value(b))));
        }
    }
}

#[test]
fn a_body_too_thin_for_f64_does_not_send_the_others_to_wider_types() {
    // The plate is 2⁻⁷⁰ thick and stands askew on all axes but y, by 3-4-5, in thirds: f64 cannot tell its volume from zero, so balls of f64
    // calculate nothing. Those of two f64 can; bound and factor are theirs.
    let height = "1/1180591620717411303424";
    let (cosine, sine) = (number("4/5"), number("3/5"));
    let turned = |block: Block| {
        let vertices = block.vertices().iter().map(|v| {
            let x = v.x.times(&cosine).plus(&v.z.times(&sine).negated());
            Vec3::new(x, v.y.clone(), v.x.times(&sine).plus(&v.z.times(&cosine)))
        });
        block.with_vertices(vertices.collect())
    };
    let plate = turned(cuboid(["-4/3", "-4/3", "0"], ["4/3", "4/3", height]));
    let upper = turned(cuboid(["-1/3", "-1/3", height], ["1/3", "1/3", "1"]));
    let scene = Scene::new(vec![(plate, Motion::Fixed), (upper, Motion::Rigid)], "1/2", ["0", "0", "-10"]);
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let certified = certified_step(&scene.model(&shapes), &scene.start()).unwrap();
    let levels = certified.levels;
    assert!(levels.float == 0 && levels.double > 0, "{levels:?}");
    assert_eq!((levels.wide, levels.undecided), ([0; 4], 0), "{levels:?}");
}
