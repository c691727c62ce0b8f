//! The limits of a contact's mode, each at a value that only it can have decided: εc for closing, εo for opening, ε of Eq. (1) at a tie. And
//! a step without unknowns.

mod support;

use rockproof_model::simulation::Motion;
use rockproof_model::{Block, Number};
use rockproof_oracle::step::{KeptPrecision, Mode, certified_step};
use support::shapes::{cuboid, number, point};
use support::steps::Scene;

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
    let displacements = certified_step(&scene.model(&shapes), &start).expect("a step").displacements;
    assert!(displacements.expect("nothing to enclose").iter().all(Vec::is_empty));
}
