//! The limits of a contact's mode, each at a value that only it can have decided: εc for closing, εo for opening, ε of Eq. (1) at a tie;
//! how close a contact came to them; blocks as far apart as contacts are recorded; and a step without unknowns.

use crate::support::shapes::{cuboid, exact, number, point};
use crate::support::steps::Scene;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::Motion;
use rockproof_model::{Block, Number};
use rockproof_oracle::step::{KeptPrecision, Mode, ModeMargin, certified_step, enclosed_step, mode_margins};

/// A cube over a fixed slab, weightless and `gap` apart, with this velocity in z.
fn cube(gap: &str, velocity: &str) -> Scene {
    let above = cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&point(["0", "0", gap]));
    let slab = cuboid(["-4", "-4", "-4"], ["4", "4", "0"]);
    let mut scene = Scene::new(vec![(slab, Motion::Fixed), (above, Motion::Rigid)], "0", ["0", "0", "0"]);
    scene.bodies[1].velocity = point(["0", "0", velocity]);
    scene
}

/// The one mode that all four corners have after the step.
fn mode_after(scene: &Scene) -> Mode {
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    let last = answer.modes.last().expect("a solve");
    assert_eq!(last.len(), 4, "{:?}", answer.contacts);
    assert!(last.iter().all(|mode| *mode == last[0]), "{last:?}");
    last[0]
}

#[test]
fn an_open_contact_closes_beyond_its_own_limit() {
    // In a step of 1/100 s it comes 9/1000 deep.
    let mut scene = cube("1/1000", "-1");
    assert_eq!(mode_after(&scene), Mode::Locked);
    (scene.tolerances.close, scene.tolerances.open) = (number("9/1000"), Number::ZERO);
    assert_eq!(mode_after(&scene), Mode::Open, "a tie is not beyond the limit");
    scene.tolerances.close = number("8/1000");
    assert_ne!(mode_after(&scene), Mode::Open);
}

#[test]
fn a_closed_contact_opens_beyond_its_own_limit() {
    // Touching it begins locked, and is pulled apart.
    let mut scene = cube("0", "1/10");
    assert_eq!(mode_after(&scene), Mode::Open);
    (scene.tolerances.open, scene.tolerances.close) = (number("1"), Number::ZERO);
    assert_eq!(mode_after(&scene), Mode::Locked);
}

#[test]
fn a_gap_that_changes_its_sign_alone_keeps_the_mode() {
    // From 1/200 to −1/200: with ε = 1 that is a tie of Eq. (1).
    let mut scene = cube("1/200", "-1");
    assert_ne!(mode_after(&scene), Mode::Open);
    scene.tolerances.equal = number("1");
    assert_eq!(mode_after(&scene), Mode::Open);
    scene.tolerances.equal = number("999/1000");
    assert_ne!(mode_after(&scene), Mode::Open);
}

/// Of a gap of 0 that stays 0 nothing presses: what moves along it slides freely, whatever friction is, and what does not stays locked.
#[test]
fn a_block_that_moves_between_walls_it_touches_is_not_held() {
    for (friction, velocity, expected) in
        [("0", "1", Mode::Sliding), ("1/2", "1", Mode::Sliding), ("0", "0", Mode::Locked)]
    {
        let wall = |low, high| (cuboid(["-4", "-4", low], ["4", "4", high]), Motion::Fixed);
        let block = (cuboid(["0", "0", "0"], ["1", "1", "1"]), Motion::Rigid);
        let mut scene = Scene::new(vec![wall("-4", "0"), block, wall("1", "4")], friction, ["0", "0", "0"]);
        scene.bodies[1].velocity = point([velocity, "0", "0"]);
        let answer = scene.step(&scene.start(), KeptPrecision::Exact);
        assert!(answer.contacts.len() == 8 && answer.converged, "{:?}", answer.contacts);
        assert_eq!(answer.modes.last().expect("a solve"), &[expected; 8], "tan φ {friction}, {velocity} m/s");
        let moved = answer.state.blocks[1].vertices[0].x.to_rational();
        assert_eq!(moved * BigInt::from(100), number(velocity).to_rational(), "nothing holds it");
    }
}

/// The margins of the first corner after the first solve.
fn first_margin(scene: &Scene) -> ModeMargin {
    let shapes: Vec<_> = scene.blocks.iter().collect();
    let (model, start) = (scene.model(&shapes), scene.start());
    let decided = certified_step(&model, &start).expect("a step");
    mode_margins(&model, &start, (&decided).into()).expect("a step")[0][0]
}

fn near(found: Option<f64>, expected: f64) -> bool {
    found.is_some_and(|found| (found - expected).abs() < 1e-12)
}

#[test]
fn margins_are_shares_of_the_sizes_of_their_terms() {
    // Open, from 1/1000 to −9/1000 in the first solve: h² = 81, ε²·h0² = 1/4; h + εc = −1 of 1 + 10 + 8.
    let mut scene = cube("1/1000", "-1");
    (scene.tolerances.close, scene.tolerances.equal) = (number("8/1000"), number("1/2"));
    let open = first_margin(&scene);
    assert!(near(open.equal, (81.0 - 0.25) / (81.0 + 0.25)), "{open:?}");
    assert!(near(open.gap, -1.0 / 19.0), "{open:?}");
    // No friction and no stretch: nothing to compare.
    assert_eq!((open.slip, open.turn), (None, None));
    // Locked, from 0: the inertia 2m/Δt² = 4·10⁷ N/m meets four springs of 10⁹ N/m, so that h = 1/1000 / 101. h − εo = −100/101 of
    // 0 + 1/101 + 1.
    let mut scene = cube("0", "1/10");
    scene.tolerances.open = number("1/1000");
    let locked = first_margin(&scene);
    assert!(near(locked.equal, 1.0), "{locked:?}");
    assert!(near(locked.gap, -100.0 / 102.0), "{locked:?}");
    // Without a change of the gap all of it is a tie.
    scene.bodies[1].velocity = point(["0", "0", "0"]);
    let still = first_margin(&scene);
    assert_eq!((still.equal, still.slip), (None, None));
    assert!(near(still.gap, -1.0), "{still:?}");
}

/// How many contacts a scene has.
fn contacts(scene: &Scene) -> usize {
    scene.step(&scene.start(), KeptPrecision::Exact).contacts.len()
}

#[test]
fn blocks_just_as_far_apart_as_contacts_are_recorded_are_neighbours() {
    let mut scene = cube("1/10", "0");
    assert_eq!(contacts(&scene), 4);
    scene.tolerances.search = number("999999999999/10000000000000");
    assert_eq!(contacts(&scene), 0);
    // 3 km up the faces are known to some 10⁻¹³ m: in f64 they are further apart than they are.
    let mut high = cube("1/1000", "0");
    (high.tolerances.search, high.tolerances.territory) = (number("1/1000"), number("1/2000"));
    assert_eq!(contacts(&high), 4);
    let height = point(["0", "0", "21009/7"]);
    high.blocks.iter_mut().for_each(|block| *block = block.translated(&height));
    let [low, top] = ["21009/7", "21009007/7000"].map(|z| number(z).approximate());
    assert!(top - low > 1e-3 + 1e-13);
    assert_eq!(contacts(&high), 4);
    // Further apart than they are large.
    let slab = cuboid(["-1", "-1", "-1"], ["1", "1", "-3/4"]);
    let plate = cuboid(["-1/2", "-1/2", "3/4"], ["1/2", "1/2", "1"]);
    let mut apart = Scene::new(vec![(slab, Motion::Fixed), (plate, Motion::Rigid)], "0", ["0", "0", "0"]);
    apart.tolerances.search = number("3/2");
    assert_eq!(contacts(&apart), 4);
}

#[test]
fn gaps_of_a_step_in_fractions_are_known_to_200_bits() {
    // 4/3 m over a slab whose normal is twice its 64 m² long.
    let mut scene = cube("4/3", "0");
    scene.tolerances.search = number("2");
    let answer = scene.step(&scene.start(), KeptPrecision::Exact);
    assert_eq!(answer.gaps.len(), 4);
    let unit = BigRational::new(1.into(), BigInt::from(1) << 200);
    for gap in answer.gaps.iter().flat_map(|gap| [&gap.before, &gap.after]) {
        let off = gap.to_rational() - exact("4/3");
        assert!(off <= unit && -off <= unit, "{gap}");
    }
}

#[test]
fn a_step_in_which_no_block_moves_leaves_the_state_as_it_is() {
    // A fixed block on a fixed slab, under gravity: no unknown at all, so that there is no smallest eigenvalue to bound either.
    let slab = cuboid(["-4", "-4", "-4"], ["4", "4", "0"]);
    let above = cuboid(["0", "0", "0"], ["1", "1", "1"]);
    let scene = Scene::new(vec![(slab, Motion::Fixed), (above, Motion::Fixed)], "0", ["0", "0", "-10"]);
    let start = scene.start();
    for keep in [KeptPrecision::Exact, KeptPrecision::Grid { exponent: 60 }, KeptPrecision::Grid { exponent: 200 }] {
        let answer = scene.step(&start, keep);
        assert_eq!(answer.state.blocks, start.blocks, "{keep:?}");
        assert!(answer.converged && answer.retries.is_empty(), "{keep:?}");
    }
    let shapes: Vec<&Block> = scene.blocks.iter().collect();
    let displacements = enclosed_step(&scene.model(&shapes), &start).expect("a step").displacements;
    assert!(displacements.expect("nothing to enclose").iter().all(Vec::is_empty));
}
