//! The limits of a contact's mode, each at a value that only it can have decided: εc for closing, εo for opening, ε of Eq. (1) at a tie.

mod support;

use rockproof_model::Number;
use rockproof_model::simulation::Motion;
use rockproof_oracle::step::{KeptPrecision, Mode};
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
