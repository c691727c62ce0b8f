//! Cohesion and tensile strength on the area in which two faces overlap.

use crate::support::{cube, cuboid, floor, load, n, near, run, scene, v};
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::Mode;

/// A block of 2000 kg on a smooth floor, glued by `cohesion`, pushed at the height of the floor from the first step on.
fn glued(cohesion: &str, push: &str) -> Scene {
    let mut scene = scene(vec![floor(), cube()]);
    let joint = &mut scene.simulation.joints.other;
    (joint.friction, joint.cohesion) = (n("0"), n(cohesion));
    scene.simulation.control.settle = 60;
    let table = [("0", v("0", "0", "0")), ("1/100", v(push, "0", "0"))];
    scene.simulation.loads.push(load(1, v("1/2", "1/2", "0"), &table));
    scene
}

#[test]
fn cohesion_holds_what_is_less_than_its_strength() {
    // 4000 Pa on 1 m² hold 3000 N; the four shear springs of 4e7 N/m give way by 3000/1.6e8 m, and at most twice that when pushed at once.
    let (dynamics, _) = run::<f64>(&glued("4000", "3000"), 160);
    assert!(dynamics.state().contacts.iter().all(|c| c.mode == Mode::Locked));
    let moved = dynamics.state().load_points[0].x - 0.5;
    assert!(moved > 0.0 && moved < 2.0 * 3000.0 / 1.6e8, "{moved}");
}

#[test]
fn beyond_its_strength_cohesion_is_a_constant_force() {
    // 6000 N against 4000 Pa on 1 m²: (6000 - 4000)/2000 = 1 m/s².
    let (dynamics, _) = run::<f64>(&glued("4000", "6000"), 60 + 50);
    let contacts = &dynamics.state().contacts;
    assert!(contacts.len() == 4 && contacts.iter().all(|c| c.mode == Mode::Sliding), "{contacts:?}");
    let against: f64 = contacts.iter().map(|c| c.force.x).sum();
    near(against.abs(), 4000.0, 1e-9);
    near(dynamics.centroid(1).x - 0.5, 0.5 * 0.5 * 0.5, 1e-3);
}

/// A block of 20 kN under a fixed ceiling of this side, glued by `tension`, after settling.
fn hung(side: (&str, &str), tension: &str) -> (usize, f64) {
    let (from, to) = side;
    let ceiling = cuboid("ceiling", [from, from, "1"], [to, to, "2"], Motion::Fixed);
    let mut scene = scene(vec![ceiling, cube()]);
    scene.simulation.joints.other.tension = n(tension);
    scene.simulation.control.settle = 200;
    let (dynamics, _) = run::<f64>(&scene, 220);
    let closed = dynamics.state().contacts.iter().filter(|c| c.mode.is_closed());
    (closed.count(), 0.5 - dynamics.centroid(1).z)
}

#[test]
fn tensile_strength_bears_on_the_area_that_overlaps() {
    // 20 kN on 1 m² are 20 kPa, on a ceiling of 1/2 m × 1/2 m 80 kPa. Four springs of 1e8 N/m stretch by 5e-5 m.
    for (side, holds, fails) in [(("0", "1"), "21000", "19000"), (("1/4", "3/4"), "81000", "79000")] {
        let (closed, sunk) = hung(side, holds);
        assert_eq!(closed, 4, "{side:?}");
        near(sunk, 20000.0 / 4e8, 1e-9);
        let (closed, sunk) = hung(side, fails);
        // Twenty steps of free fall at least.
        assert!(closed == 0 && sunk > 0.5 * 10.0 * 0.04, "{closed} {sunk}");
    }
}

#[test]
fn without_strength_nothing_is_held() {
    assert_eq!(hung(("0", "1"), "0").0, 0);
}
