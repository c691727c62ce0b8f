//! Friction in the exact step against closed forms: a block between a floor and a ceiling, whose eight corners press alike, so that
//! nothing turns it. Slips that end, turn, swing sideways and settle; solves that are counted; Δt that grows; contacts that are kept.

use crate::support::shapes::{cuboid, exact, number, point};
use crate::support::steps::Scene;
use num_rational::BigRational;
use rockproof_model::simulation::{Body, Motion};
use rockproof_model::{EntranceKind, Number, Point, Vec3};
use rockproof_oracle::step::{
    ContactMemory, IterationEnd, KeptPrecision, Mode, RetryReason, State, StepAnswer, StepFailure, certified_step,
    enclosed_step, exact_step, first_system, friction_margins, mode_margins,
};

/// N/m: the shear spring of each corner, half of its normal spring.
const SHEAR: &str = "500000000";
/// kg: 2 × 2 × 1 m of 2000 kg/m³.
const MASS: &str = "8000";

fn value(n: &Number) -> BigRational {
    n.to_rational()
}

fn times(one: &str, other: &str) -> BigRational {
    exact(one) * exact(other)
}

/// A floor, a ceiling, and a block between them that overlaps both by `overlap`; tan φ = 3/5, Δt as given, no weight.
fn clamped(overlap: &str, time_step: &str) -> Scene {
    let ceiling = Number::from_rational(exact("1") - exact(overlap)).to_string();
    let floor = cuboid(["-8", "-8", "-1"], ["8", "8", overlap]);
    let ceiling = cuboid(["-8", "-8", &ceiling], ["8", "8", "2"]);
    let block = cuboid(["-1", "-1", "0"], ["1", "1", "1"]);
    let fixed = |block| (block, Motion::Fixed);
    let mut scene = Scene::new(vec![fixed(floor), fixed(ceiling), (block, Motion::Rigid)], "3/5", ["0", "0", "0"]);
    scene.simulation.control.time_step = number(time_step);
    scene
}

/// The state in which all contacts are closed in this mode with this stretch of the block along x and y, the block moving as told.
fn moving(scene: &Scene, mode: Mode, stretch: [&str; 2], velocity: [&str; 2]) -> State {
    let mut state = scene.start();
    let contacts = scene.step(&state, KeptPrecision::Exact).contacts;
    assert_eq!(contacts.len(), 8, "{contacts:?}");
    let stretch: Point = point([stretch[0], stretch[1], "0"]);
    let memory = |(blocks, contact): ([usize; 2], rockproof_model::Contact)| {
        assert_eq!((contact.entrance.kind(), blocks[1]), (EntranceKind::FaceVertex, 2));
        let corner = &scene.blocks[2].vertices()[contact.key.numbers()[1] as usize];
        let anchor =
            Vec3::new(corner.x.plus(&stretch.x.negated()), corner.y.plus(&stretch.y.negated()), corner.z.clone());
        ContactMemory { blocks, contact, mode, anchors: [anchor, corner.clone()] }
    };
    state.contacts = contacts.into_iter().map(memory).collect();
    state.blocks[2].velocity[0] = number(velocity[0]);
    state.blocks[2].velocity[1] = number(velocity[1]);
    state
}

fn along(state: &State, axis: usize) -> BigRational {
    value(state.blocks[2].vertices[6].components()[axis]) - exact("1")
}

fn all(answer: &StepAnswer, solve: usize, mode: Mode) -> bool {
    answer.modes[solve].iter().all(|found| *found == mode)
}

/// Eight corners overlap by 10⁻⁵ m: each is pressed by 10⁴ N and holds τ = 6000 N, together 6 m/s².
const OVERLAP: &str = "1/100000";
/// τ/p_s.
const HELD: &str = "12/1000000";

#[test]
fn a_kick_of_two_metres_a_second_ends_after_a_third_of_a_metre_and_turns() {
    let scene = clamped(OVERLAP, "1/96");
    let mut state = moving(&scene, Mode::Sliding, [HELD, "0"], ["2", "0"]);
    for k in 1..=32 {
        let answer = scene.step(&state, KeptPrecision::Exact);
        assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 1), "step {k}");
        assert!(all(&answer, 1, Mode::Sliding));
        state = answer.state;
        let t = BigRational::new(k.into(), 96.into());
        assert_eq!(along(&state, 0), exact("2") * &t - exact("3") * &t * &t, "step {k}");
        assert_eq!(value(&state.blocks[2].velocity[0]), exact("2") - exact("6") * &t);
        // What the dragged anchors remember is the force that slid.
        for contact in &state.contacts {
            let [anchor, corner] = &contact.anchors;
            assert_eq!(value(&corner.x) - value(&anchor.x), exact(HELD));
        }
    }
    assert_eq!(along(&state, 0), exact("1/3"));
    assert_eq!(value(&state.blocks[2].velocity[0]), exact("0"));
    // At rest the force would push back by 6/2 · (1/96)² m, beyond the anchors, with more than friction holds: the slip turned, and
    // locks. Then eight springs that are stretched by τ/p_s meet the inertia 2m/Δt².
    let answer = scene.step(&state, KeptPrecision::Exact);
    assert!(all(&answer, 0, Mode::Sliding) && all(&answer, 1, Mode::Locked) && all(&answer, 2, Mode::Locked));
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 2));
    let springs = exact("8") * exact(SHEAR);
    let inertia = exact("2") * exact(MASS) * times("96", "96");
    let back = &springs * exact(HELD) / (inertia + &springs);
    assert_eq!(along(&answer.state, 0), exact("1/3") - back);
}

#[test]
fn a_slip_that_swings_by_a_right_angle_has_not_turned() {
    // The first solve brings the block back by just its stretch s0 along x and aside along y: s·s0 = 0. A little further and it turned.
    let scene = clamped(OVERLAP, "1/100");
    // v·Δt = −s0 + 6/2·Δt².
    let speed = (exact("3/10000") - exact(HELD)) * exact("100");
    for (less, mode) in [("0", Mode::Sliding), ("1/1000000000", Mode::Locked), ("-1/1000000000", Mode::Sliding)] {
        let speed = (&speed - exact(less)).to_string();
        let state = moving(&scene, Mode::Sliding, [HELD, "0"], [&speed, "1/10"]);
        let answer = scene.step(&state, KeptPrecision::Grid { exponent: 200 });
        assert!(all(&answer, 0, Mode::Sliding) && all(&answer, 1, mode), "{less}: {:?}", answer.modes);
        assert_eq!(answer.levels.undecided, 0);
        let shapes: Vec<_> = scene.blocks.iter().collect();
        let model = scene.model(&shapes);
        let margins = mode_margins(&model, &state, (&answer).into()).expect("a step");
        let turn = margins[0][0].turn.expect("it slid");
        match mode {
            Mode::Locked => assert!(turn < -1e-12, "{turn}"),
            _ => assert!(turn > -1e-25, "{turn}"),
        }
    }
}

#[test]
fn the_margin_of_a_slip_compares_squares_of_forces() {
    // The first solve doubles the stretch that friction holds: 4 against 1, of 4 + 1. v·Δt = |s0| + 6/2·Δt².
    let scene = clamped(OVERLAP, "1/100");
    let speed = (exact("3/10000") + exact(HELD)) * exact("100");
    let state = moving(&scene, Mode::Sliding, [HELD, "0"], [&speed.to_string(), "0"]);
    let shapes: Vec<_> = scene.blocks.iter().collect();
    let model = scene.model(&shapes);
    let decided = certified_step(&model, &state).expect("a step");
    let margins = mode_margins(&model, &state, (&decided).into()).expect("a step");
    assert_eq!(margins[0].len(), 8);
    for margin in &margins[0] {
        assert!(margin.slip.is_some_and(|slip| (slip - 0.6).abs() < 1e-12), "{margin:?}");
    }
}

#[test]
fn a_spring_of_the_shear_stiffness_holds_across_the_first_slip() {
    // s0 along x, force p_s·s0 = τ; a small velocity along y meets eight springs p_s, as the locked block would. What the turn changes
    // of the force is below a hundredth of what presses, so that one solve settles.
    let scene = clamped(OVERLAP, "1/100");
    let state = moving(&scene, Mode::Sliding, [HELD, "0"], ["1", "1/100000"]);
    let answer = scene.step(&state, KeptPrecision::Grid { exponent: 200 });
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 1), "{:?}", answer.modes);
    let inertia = exact("2") * exact(MASS) * exact("10000");
    let aside = &inertia * exact("1/10000000") / (&inertia + exact("8") * exact(SHEAR));
    let unit = BigRational::new(1.into(), num_bigint::BigInt::from(1) << 199);
    let apart = along(&answer.state, 1) - aside;
    assert!(apart < unit && -apart < unit);
    let ahead = along(&answer.state, 0) - (exact("1/100") - exact("3/10000"));
    assert!(ahead < unit && -ahead < unit);
    // Where the last slip lies along both, 3-4-5, the constant part of the stretch is along it too: nothing acts across.
    let slanted = moving(&scene, Mode::Sliding, ["36/5000000", "48/5000000"], ["3", "4"]);
    let answer = scene.step(&slanted, KeptPrecision::Exact);
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 1));
    let far = exact("5/100") - exact("3/10000");
    assert_eq!(along(&answer.state, 0), &far * exact("3/5"));
    assert_eq!(along(&answer.state, 1), far * exact("4/5"));
}

#[test]
fn the_spring_of_a_later_solve_is_the_force_over_the_slip() {
    // tan φ = 1/2000: τ = 5 N, a two-thousandth of what presses, so that only the stiff spring of the first solve is too much to have
    // settled. That solve leaves s₁ = (4, 3)·L; the second has k = τ/5L along b = (−3, 4)/5.
    let mut scene = clamped(OVERLAP, "1/100");
    scene.simulation.joints.other.friction = number("1/2000");
    let (strength, inertia, springs) = (exact("5"), exact("160000000"), exact("8") * exact(SHEAR));
    let held = &strength / exact(SHEAR);
    let ahead = exact("4/10000");
    let length = (&held + &ahead - exact("8") * &strength / &inertia) / exact("4");
    let aside = exact("3") * &length * (&inertia + springs) / &inertia;
    let speeds = [&ahead, &aside].map(|free| (free * exact("100")).to_string());
    let state = moving(&scene, Mode::Sliding, [&held.to_string(), "0"], [&speeds[0], &speeds[1]]);
    let answer = scene.step(&state, KeptPrecision::Grid { exponent: 200 });
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 2), "{:?}", answer.modes);
    assert!((0..=2).all(|solve| all(&answer, solve, Mode::Sliding)));
    let (three, four) = (exact("3/5"), exact("4/5"));
    let spring = exact("8") * &strength / (exact("5") * &length);
    let on_slip = &four * &ahead + &three * &aside - exact("8") * &strength / &inertia;
    // (2m/Δt² + 8k)·(d·b) = (2m/Δt)·v·b − 8k·s0·b, s0·b = −3/5·|s0|.
    let on_b = (&inertia * (&four * &aside - &three * &ahead) + &spring * &three * &held) / (&inertia + &spring);
    let unit = BigRational::new(1.into(), num_bigint::BigInt::from(1) << 199);
    for (axis, expected) in [(0, &four * &on_slip - &three * &on_b), (1, &three * &on_slip + &four * &on_b)] {
        let apart = along(&answer.state, axis) - expected;
        assert!(apart < unit && -apart < unit, "axis {axis}");
    }
}

#[test]
fn a_locked_contact_that_slides_has_the_force_of_its_own_stretch() {
    // At first locked and moving along x with v: s = d, sliding follows. The second solve has f = τ along x, Δf = 0 after it.
    let scene = clamped(OVERLAP, "1/100");
    let state = moving(&scene, Mode::Locked, ["0", "0"], ["1", "0"]);
    let answer = scene.step(&state, KeptPrecision::Exact);
    assert!(all(&answer, 0, Mode::Locked) && all(&answer, 1, Mode::Sliding));
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 2));
    assert_eq!(along(&answer.state, 0), exact("1/100") - exact("3/10000"));
}

#[test]
fn friction_that_changes_by_just_a_hundredth_of_what_presses_has_settled() {
    let scene = clamped(OVERLAP, "1/100");
    // Each corner is pressed by 10⁴ N; the anchors remember τ + 100 N and τ − 100 N.
    for (stretch, solves) in [
        ("122/10000000", 1),
        ("118/10000000", 1),
        ("122000001/10000000000000", 2),
        ("117999999/10000000000000", 2),
        (HELD, 1),
    ] {
        let state = moving(&scene, Mode::Sliding, [stretch, "0"], ["1", "0"]);
        let answer = scene.step(&state, KeptPrecision::Exact);
        assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, solves), "{stretch}");
        assert_eq!(answer.levels.undecided, 0, "{stretch}");
        // The last solve has the force of the anchors in one case, τ in the other.
        let force = if solves == 1 { exact("8") * exact(SHEAR) * exact(stretch) } else { exact("48000") };
        let back = force / exact(MASS) / exact("20000");
        assert_eq!(along(&answer.state, 0), exact("1/100") - back, "{stretch}");
        let margins = friction_margins(&scene.model(&scene.blocks.iter().collect::<Vec<_>>()), &state).expect("a step");
        assert_eq!(margins.len(), solves as usize);
        let first = margins[0].expect("pressed contacts");
        match (stretch, solves) {
            (HELD, _) => assert!(first < -0.999_999),
            (_, 1) => assert!(first.abs() < 1e-15, "a tie: {first}"),
            _ => assert!((1e-8..1e-4).contains(&first), "{first}"),
        }
    }
}

#[test]
fn what_nothing_presses_never_settles_and_ends_with_the_seventh_solve() {
    // Corners a micrometre apart are held by tension and bear cohesion alone: τ = 6000 Pa · 1 m². Where nothing presses, no change of
    // force is small enough.
    let mut scene = clamped("-1/1000000", "1/100");
    scene.simulation.joints.other.cohesion = number("6000");
    scene.simulation.joints.other.tension = number("6000");
    // Straight on, nothing changes.
    let straight = moving(&scene, Mode::Sliding, [HELD, "0"], ["1", "0"]);
    let answer = scene.step(&straight, KeptPrecision::Exact);
    assert_eq!((answer.end, answer.iterations, answer.levels.undecided), (IterationEnd::Settled, 1, 0));
    assert_eq!(along(&answer.state, 0), exact("1/100") - exact("3/10000"));
    // Aside, every solve turns the slip a little more.
    let aside = moving(&scene, Mode::Sliding, [HELD, "0"], ["1", "1/5"]);
    let answer = scene.step(&aside, KeptPrecision::Grid { exponent: 200 });
    assert!((0..=7).all(|solve| all(&answer, solve, Mode::Sliding)));
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Unchanged, 7));
    assert!(answer.converged && answer.retries.is_empty());
    assert_eq!(answer.levels.undecided, 0);
    // A grid finer than 2,048 bits is reached too, after questions that took 128.
    let fine = scene.step(&aside, KeptPrecision::Grid { exponent: 2100 });
    assert!(fine.levels.wide.iter().any(|&settled| settled > 0), "128 bits are asked first: {:?}", fine.levels);
    assert_eq!(fine.modes, answer.modes);
    let unit = BigRational::new(1.into(), num_bigint::BigInt::from(1) << 199);
    for axis in [0, 1] {
        let apart = along(&fine.state, axis) - along(&answer.state, axis);
        assert!(apart < unit && -apart < unit, "axis {axis}");
    }
}

#[test]
fn the_next_step_begins_with_three_halves_of_the_last() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.bodies[0].velocity = point(["40", "0", "0"]);
    // 40 m/s and a limit of 1/10 m: 1/100 s is halved to 1/400 s.
    let first = scene.step(&scene.start(), KeptPrecision::Exact);
    assert_eq!((first.time_step, first.retries.len()), (exact("1/400"), 2));
    assert_eq!(value(&first.state.last_time_step), exact("1/400"));
    // 3/800 s is too long and halved; 9/3200 s too.
    let second = scene.step(&first.state, KeptPrecision::Exact);
    assert_eq!((second.time_step, second.retries.len()), (exact("3/1600"), 1));
    assert_eq!(second.retries[0].time_step, exact("3/800"));
    // Without the limit it grows to the full Δt and no further.
    scene.tolerances.max_displacement = number("1");
    let mut state = second.state;
    for expected in ["9/3200", "27/6400", "81/12800", "243/25600", "1/100", "1/100"] {
        let answer = scene.step(&state, KeptPrecision::Exact);
        assert_eq!(answer.time_step, exact(expected));
        assert!(answer.retries.is_empty());
        state = answer.state;
    }
}

#[test]
fn a_time_step_of_just_a_thousandth_is_tried() {
    let mut scene = Scene::new(vec![(cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.bodies[0].velocity = point(["10000", "0", "0"]);
    // 10 km/s and a limit of 1/10 m: 3/2 of 1/75000 s is 1/5 m, half of it just 1/10 m and a thousandth of 1/100 s.
    let mut state = scene.start();
    state.last_time_step = number("1/75000");
    let answer = scene.step(&state, KeptPrecision::Exact);
    assert_eq!((answer.time_step, answer.retries.len()), (exact("1/100000"), 1));
    assert_eq!(answer.retries[0].time_step, exact("1/50000"));
    // A little less is not.
    state.last_time_step = number("1/75001");
    scene.bodies[0].velocity = point(["10001", "0", "0"]);
    let shapes: Vec<_> = scene.blocks.iter().collect();
    let failure = exact_step(&scene.model(&shapes), &state, KeptPrecision::Exact).unwrap_err();
    assert_eq!(failure, StepFailure::TooFast { block: 0, limit: RetryReason::Displacement });
}

/// The scene with so many free rigid cubes more, 100 m apart: six unknowns each, and nothing that touches.
fn with_cubes(mut scene: Scene, count: usize) -> Scene {
    for k in 1..=count {
        let offset = point([&(100 * k).to_string(), "0", "0"]);
        scene.blocks.push(cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&offset));
        scene.bodies.push(Body { motion: Motion::Rigid, ..Body::default() });
    }
    scene
}

#[test]
fn a_tie_of_a_large_step_is_asked_of_fractions() {
    // As among few blocks: a change of just a hundredth of what presses.
    let scene = with_cubes(clamped(OVERLAP, "1/100"), 16);
    let state = moving(&scene, Mode::Sliding, ["122/10000000", "0"], ["1", "0"]);
    let answer = scene.step(&state, KeptPrecision::Exact);
    assert_eq!((answer.end, answer.iterations), (IterationEnd::Settled, 1));
    assert!(answer.levels.exact > 0 && answer.levels.undecided == 0, "{:?}", answer.levels);
}

#[test]
fn up_to_96_unknowns_are_asked_to_1024_bits_and_more_to_256() {
    // Nothing presses, so that a slip has settled only where it does not turn at all; each solve squares how far it turns, and soon
    // that is below what 256 bits can see.
    let mut scene = clamped("-1/1000000", "1/100");
    scene.simulation.joints.other.cohesion = number("6000");
    scene.simulation.joints.other.tension = number("6000");
    let levels = |cubes: usize| {
        let scene = with_cubes(scene.clone(), cubes);
        let state = moving(&scene, Mode::Sliding, [HELD, "0"], ["1", "1/1000"]);
        scene.step(&state, KeptPrecision::Grid { exponent: 200 }).levels
    };
    let few = levels(15);
    assert!(few.undecided == 0 && few.wide[2] + few.wide[3] > 0, "{few:?}");
    let many = levels(16);
    assert_eq!((many.undecided, many.wide[2], many.wide[3]), (1, 0, 0), "{many:?}");
}

#[test]
fn what_the_step_before_left_closed_is_kept_however_deep() {
    // 1/10 m is twice the depth at which contacts are recorded.
    let shallow = clamped(OVERLAP, "1/100");
    let mut state = moving(&shallow, Mode::Locked, ["0", "0"], ["0", "0"]);
    let deep = clamped("1/10", "1/100");
    for (block, moved) in state.blocks.iter_mut().zip(&deep.blocks) {
        block.vertices = moved.vertices().to_vec();
    }
    assert_eq!(deep.step(&state, KeptPrecision::Exact).contacts.len(), 8);
    state.contacts.iter_mut().for_each(|contact| contact.mode = Mode::Open);
    assert!(deep.step(&state, KeptPrecision::Exact).contacts.is_empty());
    state.contacts[3].mode = Mode::Sliding;
    let kept = deep.step(&state, KeptPrecision::Grid { exponent: 100 }).contacts;
    assert_eq!(kept.iter().map(|(_, c)| c.key).collect::<Vec<_>>(), [state.contacts[3].contact.key]);
}

#[test]
fn elimination_in_plain_fractions_gives_the_same_solve() {
    // Slipping askew, and turning: the springs across the slips are part of the matrix.
    let scene = clamped(OVERLAP, "1/100");
    let mut state = moving(&scene, Mode::Sliding, [HELD, "1/1000000"], ["1", "100001/1200000"]);
    state.blocks[2].velocity[5] = number("1/1000000");
    let shapes: Vec<_> = scene.blocks.iter().collect();
    let model = scene.model(&shapes);
    let system = first_system(&model, &state).expect("a system");
    let plain = system.plainly().expect("a solution");
    assert_eq!(plain, system.exact().expect("a solution"));
    // By hand: eight corners (±1, ±1) at half a metre above and below the centroid. Along b = (−s0y, s0x)/|s0| each has the spring p_s,
    // pulled by T = (b, x × b); s0·b = 0. The forces p_s·s0 cancel in their moments.
    let (x, y) = (exact(HELD), exact("1/1000000"));
    let square = &x * &x + &y * &y;
    let (inertia, springs) = (exact("160000000"), exact("8") * exact(SHEAR));
    let rest = |axis: usize, sum: BigRational| &inertia * &plain[axis] + sum;
    let b = [-y.clone() / &square, x.clone() / &square];
    let across = &plain[0] * (-&y) + &plain[1] * &x;
    for (axis, (velocity, stretch)) in [("1", &x), ("100001/1200000", &y)].into_iter().enumerate() {
        let right = exact("2") * exact("100") * exact(MASS) * exact(velocity) - &springs * stretch;
        assert_eq!(rest(axis, &springs * &b[axis] * &across), right, "axis {axis}");
    }
    // About z each corner's arm to b is x·b_y − y·b_x; over all corners the squares add up to 8·(b_x² + b_y²) = 8.
    let turn = (exact("20000") * exact(MASS) * exact("2/3") + &springs) * &plain[5];
    assert_eq!(turn, exact("200") * exact(MASS) * exact("2/3") * exact("1/1000000"));
    // A step of that solve encloses it.
    let step = enclosed_step(&model, &state).expect("a step");
    assert_eq!(step.decided.iterations, 1);
    let enclosed = &step.displacements.expect("enclosed")[2];
    for (unknown, [middle, radius]) in plain.iter().zip(enclosed) {
        let [middle, radius] = [middle, radius].map(|x| BigRational::from_float(*x).expect("finite"));
        assert!(unknown - &middle <= radius && &middle - unknown <= radius);
    }
}
