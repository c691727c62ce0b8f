//! Cohesion and tensile strength in the exact step: areas worked by hand decide, to the last digit, when a contact
//! slides or opens.

use crate::support::shapes::{block, cuboid, exact, number, point};
use crate::support::steps::Scene;
use num_rational::BigRational;
use rockproof_model::simulation::{Motion, PointLoad};
use rockproof_model::{Block, Number, Vec3};
use rockproof_oracle::step::{KeptPrecision, Mode, StepAnswer};

/// Turned about z by the angle of cosine 4/5.
fn turned(block: &Block) -> Block {
    let (c, s) = (number("4/5"), number("3/5"));
    let vertices = block.vertices().iter().map(|v| {
        let x = v.x.times(&c).plus(&v.y.times(&s).negated());
        Vec3::new(x, v.x.times(&s).plus(&v.y.times(&c)), v.z.clone())
    });
    block.with_vertices(vertices.collect())
}

/// A U lying on z = 0, 1 high: two prongs 1 wide on a base 1 deep, 3 by 3 in all.
fn u_block(z: [&str; 2]) -> Block {
    let corners = [["0", "0"], ["3", "0"], ["3", "3"], ["2", "3"], ["2", "1"], ["1", "1"], ["1", "3"], ["0", "3"]];
    let at = |z: &'static str| corners.map(|[x, y]| point([x, y, z]));
    let z = z.map(|z| if z == "0" { "0" } else { "1" });
    let vertices: Vec<_> = at(z[0]).into_iter().chain(at(z[1])).collect();
    let sides: Vec<Vec<u32>> = (0..8u32).map(|k| vec![k, (k + 1) % 8, (k + 1) % 8 + 8, k + 8]).collect();
    let caps = [(0..8u32).rev().collect::<Vec<_>>(), (8..16).collect()];
    let faces: Vec<&[u32]> = caps.iter().chain(&sides).map(Vec::as_slice).collect();
    block(vertices, &faces)
}

fn lying(x: [&str; 2], y: [&str; 2]) -> Block {
    cuboid([x[0], y[0], "0"], [x[1], y[1], "1"])
}

/// Pairs that touch in the plane z = 0, the lower one fixed, and the area they share.
fn pairs() -> Vec<(&'static str, Block, Block, &'static str)> {
    let slab = || cuboid(["-4", "-4", "-1"], ["4", "4", "0"]);
    let small = || cuboid(["0", "0", "-1"], ["1", "1", "0"]);
    vec![
        ("a unit square on a slab", slab(), lying(["0", "1"], ["0", "1"]), "1"),
        ("unit squares shifted by 1/2 and 1/3", small(), lying(["1/2", "3/2"], ["1/3", "4/3"]), "1/3"),
        ("the same turned by 3-4-5", turned(&small()), turned(&lying(["1/2", "3/2"], ["1/3", "4/3"])), "1/3"),
        // The corners cut off are right triangles: see the unit test of the overlap.
        (
            "squares of side 2 at 3-4-5",
            cuboid(["-1", "-1", "-1"], ["1", "1", "0"]),
            turned(&cuboid(["-1", "-1", "0"], ["1", "1", "1"])),
            "10/3",
        ),
        ("a U on a slab", slab(), u_block(["0", "1"]), "7"),
        // Both prongs, 1 deep, less what hangs over.
        ("a bar across a U", cuboid(["-1", "2", "-1"], ["5/2", "5/2", "0"]), u_block(["0", "1"]), "3/4"),
    ]
}

/// The pair without weight, friction or velocity, in contact at z = 0, pulled by `force` in its centroid.
fn scene(lower: Block, upper: Block, force: [BigRational; 3]) -> Scene {
    let centroid = upper.centroid().map(|c| Number::from_rational(c.clone()));
    let mut scene = Scene::new(vec![(lower, Motion::Fixed), (upper, Motion::Rigid)], "0", ["0", "0", "0"]);
    let [x, y, z] = force.map(Number::from_rational);
    scene.simulation.loads =
        vec![PointLoad { block: 1, at: centroid, table: vec![(Number::ZERO, Vec3::new(x, y, z))] }];
    scene.tolerances.overlap_sine = number("1/100");
    scene
}

fn last_modes(answer: &StepAnswer) -> &[Mode] {
    assert_eq!(answer.levels.undecided, 0);
    answer.modes.last().unwrap()
}

#[test]
fn tension_holds_what_its_area_can_hold() {
    for (name, lower, upper, area) in pairs() {
        // A contact opens when h > tension·area/p_n. What h will be is known from a step with tension without end.
        let mut scene = scene(lower, upper, [exact("0"), exact("0"), exact("1000")]);
        let start = scene.start();
        scene.simulation.joints.other.tension = number("1000000000000");
        scene.simulation.joints.other.cohesion = number("1000000000000");
        let free = scene.step(&start, KeptPrecision::Exact);
        assert!(last_modes(&free).iter().all(|&mode| mode == Mode::Locked), "{name}");
        let contacts = free.contacts.len();
        // Anchors begin at the feet, h0 = 0, and move with the blocks: their distance along z is h.
        let rise = free
            .state
            .contacts
            .iter()
            .map(|memory| memory.anchors[1].z.to_rational() - memory.anchors[0].z.to_rational());
        let rise = rise.max().unwrap();
        let stiffness = exact("1000000000");
        let share = exact(area) / BigRational::from_integer(contacts.into());
        let just_enough = &rise * &stiffness / share;
        for (factor, opens) in [("1", false), ("999999/1000000", true), ("1000001/1000000", false)] {
            scene.simulation.joints.other.tension = Number::from_rational(&just_enough * exact(factor));
            let answer = scene.step(&start, KeptPrecision::Exact);
            assert_eq!(
                last_modes(&answer).contains(&Mode::Open),
                opens,
                "{name}: {contacts} contacts, tension × {factor}"
            );
        }
    }
}

#[test]
fn cohesion_holds_what_its_area_can_hold() {
    for (name, lower, upper, area) in pairs() {
        // Locked while p_s·|s| ≤ cohesion·area: |s| is known from a step with cohesion without end. Pulled along x.
        let mut scene = scene(lower, upper, [exact("1000"), exact("0"), exact("0")]);
        scene.simulation.joints.other.tension = number("1000000000000");
        scene.simulation.joints.other.cohesion = number("1000000000000");
        let start = scene.start();
        let free = scene.step(&start, KeptPrecision::Exact);
        assert!(last_modes(&free).iter().all(|&mode| mode == Mode::Locked), "{name}");
        let squares = free.state.contacts.iter().map(|memory| {
            let [p, q] = &memory.anchors;
            let (x, y) = (p.x.to_rational() - q.x.to_rational(), p.y.to_rational() - q.y.to_rational());
            &x * &x + &y * &y
        });
        let square = squares.max().unwrap();
        let share = exact(area) / BigRational::from_integer(free.contacts.len().into());
        let shear = exact("500000000");
        // cohesion² = p_s²·|s|²/share²: between two fractions on either side of its root.
        let wanted = &shear * &shear * &square / (&share * &share);
        let scale = exact("1000000000000");
        let below = BigRational::from_integer((&wanted * &scale * &scale).to_integer().sqrt()) / &scale;
        let above = &below + exact("1") / &scale;
        for (cohesion, slides) in [(below - exact("1") / &scale, true), (above, false)] {
            scene.simulation.joints.other.cohesion = Number::from_rational(cohesion);
            let answer = scene.step(&start, KeptPrecision::Grid { exponent: 256 });
            assert_eq!(answer.modes[1].contains(&Mode::Sliding), slides, "{name}");
        }
    }
}

#[test]
fn a_block_whose_cohesion_holds_exactly_is_locked() {
    // One contact, a tetrahedron's tip on a slab, has faces that do not face each other: no area, so no cohesion.
    let slab = cuboid(["-4", "-4", "-1"], ["4", "4", "0"]);
    let spike = crate::support::shapes::spike(["0", "0", "0"]);
    let mut tip = scene(slab.clone(), spike, [exact("1000"), exact("0"), exact("-1000")]);
    tip.simulation.joints.other.cohesion = number("1000000000000");
    let answer = tip.step(&tip.start(), KeptPrecision::Grid { exponent: 256 });
    assert_eq!(answer.contacts.len(), 1);
    assert_ne!(answer.modes[1][0], Mode::Locked);
    // A cube pushed at its contacts' height moves along x alone: |s| is that of all four, and a fraction.
    let mut cube = scene(slab, lying(["0", "1"], ["0", "1"]), [exact("1000"), exact("0"), exact("0")]);
    cube.simulation.loads[0].at.z = Number::ZERO;
    cube.simulation.joints.other.tension = number("1000000000000");
    cube.simulation.joints.other.cohesion = number("1000000000000");
    let free = cube.step(&cube.start(), KeptPrecision::Exact);
    let stretches: Vec<BigRational> =
        free.state.contacts.iter().map(|m| m.anchors[0].x.to_rational() - m.anchors[1].x.to_rational()).collect();
    let largest = stretches.iter().map(|s| if *s < exact("0") { -s } else { s.clone() }).max().unwrap();
    let tie = largest * exact("500000000") * exact("4");
    for (factor, mode) in [("1", Mode::Locked), ("1048575/1048576", Mode::Sliding)] {
        cube.simulation.joints.other.cohesion = Number::from_rational(&tie * exact(factor));
        let answer = cube.step(&cube.start(), KeptPrecision::Grid { exponent: 256 });
        assert!(answer.modes[1].contains(&mode), "{:?}", answer.modes);
        assert_eq!(answer.modes[1].contains(&Mode::Sliding), mode == Mode::Sliding);
    }
}
