//! No deliberate mistake is dead: each changes an answer on one of the pairs constructed here.

use crate::hand_worked::base;
use crate::mistakes;
use crate::pairs::{
    beak, behind_side, beside_edge, blade, block, classic, corner_block, cuboid, keel, long_ridge, n, prism, ridge,
    shifted_keel, spike, tetrahedron, tolerances, turned_cuboid, undercut,
};
use rockproof_model::{Block, Contact, ContactKey, ContactKind, ExpectedContact, ToleranceSet};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::contacts_with_kept;
use rockproof_stepper::{Classifier, Stepper, Wide};
use std::collections::BTreeSet;

type Case = (&'static str, Block, Block, ToleranceSet);

/// Pairs on and beside the boundary of each rule.
fn bank() -> Vec<Case> {
    let t = tolerances;
    let turn = |v: [f64; 3]| [0.8 * v[0] - 0.6 * v[1], 0.6 * v[0] + 0.8 * v[1], v[2]];
    let lying = |x: f64, y: f64, z: f64| {
        turned_cuboid([-1.0; 3], [1.0; 3], move |v| {
            let v = [0.8 * v[0] - 0.6 * v[1], 0.6 * v[0] + 0.8 * v[1], v[2]];
            [v[0] + x, v[1] + y, v[2] + z]
        })
    };
    // Thin blades: an edge along x that opens to +y, one along y that opens to +x.
    let half = 0.03125;
    let blade_x = |z: f64| {
        let (up, down) = (z + half, z - half);
        prism([[-1.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, up], [-1.0, 1.0, up], [1.0, 1.0, down], [-1.0, 1.0, down]])
    };
    let blade_y = |z: f64| {
        let (up, down) = (z + half, z - half);
        prism([[0.0, -1.0, z], [0.0, 1.0, z], [1.0, 1.0, down], [1.0, -1.0, down], [1.0, 1.0, up], [1.0, -1.0, up]])
    };
    let tiny = |low: [f64; 3], side: f64| cuboid(low, [low[0] + side, low[1] + side, low[2] + side]);
    let wide_base = || cuboid([-2.0, 0.0, 0.0], [2.0, 2.0, 1.0]);
    let right_angle = |set: ToleranceSet| ToleranceSet { parallel_sine: n(1.0), ..set };
    let tenth_of_r = beside_edge(0.015625, 0.0078125, [-0.0078125, 4095.0 / 16384.0, 0.0]);
    // Five of these, the hypotenuse of 3-4-5, are r.
    let unit = 0.00390625;
    // The reach of Eq. (1) at a gap of 1/16.
    let ulp = f64::powi(2.0, -24);
    let mut bank = vec![
        ("face s apart", spike([1.0, 1.0, 1.125], 0.5, 0.5), base(), t()),
        ("face s apart, spike below", base(), spike([1.0, 1.0, 1.125], 0.5, 0.5), t()),
        ("face g deep", spike([1.0, 1.0, 0.9375], 0.5, 0.5), base(), t()),
        ("face deeper than g", spike([1.0, 1.0, 0.875], 0.5, 0.5), base(), t()),
        ("face touching", spike([1.0, 1.0, 1.0], 0.5, 0.5), base(), t()),
        ("aligned stack 1/16 apart", cuboid([0.0, 0.0, 1.0625], [2.0, 2.0, 2.0]), base(), t()),
        ("aligned stack, s apart", cuboid([0.0, 0.0, 1.125], [2.0, 2.0, 2.0]), base(), t()),
        ("aligned stack, g deep", cuboid([0.0, 0.0, 0.9375], [2.0, 2.0, 2.0]), base(), t()),
        ("aligned stack, too deep", cuboid([0.0, 0.0, 0.90625], [2.0, 2.0, 2.0]), base(), t()),
        ("aligned stack, r apart", cuboid([0.0, 0.0, 1.015625], [2.0, 2.0, 2.0]), base(), t()),
        ("shifted stack", cuboid([0.5, 0.0, 1.0625], [3.0, 1.0, 2.0]), base(), t()),
        ("shifted stack, overlapping", cuboid([1.0, 1.0, 0.984375], [3.0, 3.0, 2.0]), base(), t()),
        ("shifted stack, touching", cuboid([1.0, 1.0, 1.0], [3.0, 3.0, 2.0]), base(), t()),
        ("edge of a stack r away", cuboid([0.5, 0.015625, 1.0], [1.5, 1.0, 2.0]), base(), t()),
        ("corner over corner", cuboid([2.03125, 2.03125, 1.03125], [3.0, 3.0, 2.0]), base(), t()),
        ("corner in corner", cuboid([1.96875, 1.96875, 0.953125], [3.0, 3.0, 2.0]), base(), t()),
        ("corner deep in corner", cuboid([1.9375, 1.9375, 0.9375], [3.0, 3.0, 2.0]), base(), t()),
        ("corner too deep in corner", cuboid([1.93, 1.93, 0.93], [3.0, 3.0, 2.0]), base(), t()),
        ("corner on corner, 3-4-5", cuboid([2.0, 2.046875, 1.0625], [3.0, 3.0, 2.0]), base(), t()),
        ("spike over edge", spike([1.0, 2.03125, 1.0625], 0.25, 0.5), base(), t()),
        ("spike over edge, s away", spike([1.0, 2.075, 1.1], 0.25, 0.5), base(), t()),
        ("spike beside vertex", spike([1.953125, 2.03125, 1.0625], 0.125, 0.5), base(), t()),
        (
            "vertex beside spike",
            cuboid([0.953125, 1.03125, 1.0625], [3.0, 3.0, 2.0]),
            spike([1.0, 1.0, 1.0], 0.125, -0.5),
            t(),
        ),
        ("spike over edge, classic", spike([1.0, 1.9375, 1.03125], 0.25, 0.5), base(), classic()),
        ("spike over vertex, classic", spike([1.953125, 1.953125, 1.03125], 0.25, 0.5), base(), classic()),
        ("edges cross", keel(1.0625, 0.5), ridge(1.0), t()),
        ("edges cross, s apart", keel(1.125, 0.5), ridge(1.0), t()),
        ("edges cross, g deep", keel(0.9375, 0.5), ridge(1.0), t()),
        ("edges cross, too deep", keel(0.875, 0.5), ridge(1.0), t()),
        ("edges cross, all parallel", keel(1.0625, 0.5), ridge(1.0), right_angle(t())),
        ("blades", blade_x(0.015625), blade_y(0.0), t()),
        ("blades, exchanged", blade_y(0.015625), blade_x(0.0), t()),
        ("tiny block by a vertex", tiny([0.0078125, 0.0078125, 1.00390625], 0.03125), base(), t()),
        ("tiny block by an edge", tiny([0.5, 0.01171875, 1.00390625], 0.03125), base(), t()),
        ("tiny block in a slab", tiny([0.5, 0.5, 0.0078125], 0.03125), cuboid([0.0; 3], [2.0, 2.0, 0.046875]), t()),
        (
            "spike by the edge of a slab",
            spike([1.0, 0.0107421875, 0.0390625], 0.25, 0.5),
            cuboid([0.0; 3], [2.0, 2.0, 0.03125]),
            t(),
        ),
        ("notch", spike_along([1.0078125, 1.0078125, 0.5]), corner_block(), t()),
        ("top of the notch", spike([0.9921875, 0.9921875, 1.0078125], 0.125, 0.5), corner_block(), t()),
        ("edge of a concave block", leaning_spike([3.953125, 0.5, 0.96875]), corner_block(), t()),
        ("edge of a convex block", leaning_spike([1.953125, 1.0, 0.96875]), base(), t()),
        ("turned stack", turned_cuboid([0.0, 0.0, 1.03125], [1.0, 1.0, 2.0], turn), base(), t()),
        ("lying across", lying(1.0, 2.0, 1.984375), base(), t()),
        ("dipping cone", dipping(1.0625, [0.5, 0.25, 0.5]), base(), t()),
        ("cone dips by an angle", dipping(1.03125, [-1.0, 1.0, 0.953125]), wide_base(), t()),
        ("cone dips by a length", dipping(1.03125, [0.8125, 1.0, 0.9375]), base(), t()),
        (
            "level cone, no angle",
            cuboid([0.5, 0.5, 1.03125], [1.5, 1.5, 2.0]),
            base(),
            ToleranceSet { overlap_sine: n(0.0), ..classic() },
        ),
        ("spike s above an edge", spike([1.0, 2.0, 1.125], 0.25, 0.5), base(), t()),
        ("spike at a sliver's vertex", spike([0.0109375, 0.005, 0.00390625], 0.0625, 0.5), sliver(), t()),
        ("short edge crosses", keel(1.0625, 0.005), ridge(1.0), t()),
        ("corner, tie within Eq. (1)", cuboid([2.0625 + ulp / 2.0, 2.03125, 1.0625], [3.0; 3]), base(), t()),
        ("corner, tie on the edge of Eq. (1)", cuboid([2.0625, 2.03125, 1.0625 - ulp], [3.0; 3]), base(), t()),
        ("corner, no tie by Eq. (1)", cuboid([2.0625 + 4.0 * ulp, 2.03125, 1.0625], [3.0; 3]), base(), t()),
        (
            "corner in corner, tie within Eq. (1)",
            cuboid([2.0 - 0.0078125, 1.9921875, 2.0 - 1.0078125 - ulp / 32.0], [3.0; 3]),
            base(),
            t(),
        ),
        ("corner g deep in corner, classic", cuboid([1.9375, 1.9375, 0.9375], [3.0; 3]), base(), classic()),
        ("corner deeper in corner, classic", cuboid([1.9296875, 1.9296875, 0.9296875], [3.0; 3]), base(), classic()),
        ("tiny block fills a slab", tiny([0.5, 0.5, 0.0], 0.03125), cuboid([0.0; 3], [2.0, 2.0, 0.03125]), t()),
        (
            "spike r from a vertex, over an edge",
            spike([2.0 - 3.0 * unit, 2.0, 1.0 + 4.0 * unit], 0.25, 0.5),
            base(),
            ToleranceSet { territory: n(5.0 * unit), ..t() },
        ),
        ("foot at an end", shifted_keel(), ridge(1.0), t()),
        ("short edge crosses, all parallel", keel(1.0625, 0.0078125), ridge(1.0), right_angle(t())),
        ("edges cross, all parallel, classic", keel(1.0625, 0.5), ridge(1.0), right_angle(classic())),
        ("cone dips by g", dipping(1.03125, [1.0 - 4095.0 / 2048.0, 1.0, 0.96875]), wide_base(), t()),
        ("cone dips by more than g, classic", dipping(1.03125, [-1.0, 1.0, 0.953125]), wide_base(), classic()),
        ("blade beyond the angle", blade(0.5, 0.03125), long_ridge(), t()),
        ("blade beyond the angle, exchanged", long_ridge(), blade(0.5, 0.03125), t()),
        ("side dips by more than r/10", beside_edge(0.0078125, 0.00390625, [-0.01171875, 0.5, 0.0]), base(), t()),
        ("the same, classic", beside_edge(0.0078125, 0.00390625, [-0.01171875, 0.5, 0.0]), base(), classic()),
        ("side dips by r/10", tenth_of_r, base(), ToleranceSet { territory: n(0.078125), ..t() }),
        ("a less deep exit that is false", behind_side(), base(), t()),
        ("touching one, overlapping one", beak([3.96875, 0.5, 1.0]), undercut(), t()),
        ("spike in a roof", spike([1.0078125, 1.0, 0.9609375], 0.125, 0.5), roof(), t()),
        ("block in the notch", cuboid([0.96875, 0.984375, 0.25], [3.0, 3.0, 0.75]), corner_block(), t()),
    ];
    // Whichever of the five edges a list begins with: each of them is the one that matters.
    for edge in 0..5 {
        bank.push(("one edge of five dips", tip_of_five([1.0, 1.0, 1.03125], edge, -0.125), base(), t()));
        bank.push(("corner behind one edge of five", tip_of_five([2.03125, 2.03125, 1.03125], edge, 0.5), base(), t()));
    }
    bank
}

/// A block whose vertex 0 points down, with five edges that rise by 1/2 over a horizontal 1/2; but `edge`, which points to −x and −y alike, by
/// `rise`.
fn tip_of_five([x, y, z]: [f64; 3], edge: usize, rise: f64) -> Block {
    let ring = (0..5).map(|number| {
        let turned = 225.0 + 72.0 * (number as f64 - edge as f64);
        let (sine, cosine) = turned.to_radians().sin_cos();
        [x + 0.5 * cosine, y + 0.5 * sine, z + if number == edge { rise } else { 0.5 }]
    });
    let vertices: Vec<[f64; 3]> = [[x, y, z]].into_iter().chain(ring).chain([[x, y, z + 1.0]]).collect();
    let sides = (1..6).flat_map(|at| [[0, at % 5 + 1, at], [6, at, at % 5 + 1]]);
    let faces: Vec<[u32; 3]> = sides.collect();
    block(&vertices, &faces.iter().map(|face| &face[..]).collect::<Vec<_>>())
}

/// A tetrahedron whose edge 0-1 has little width in one of its faces, while its vertices have long edges.
fn sliver() -> Block {
    tetrahedron([[0.0; 3], [2.0, 0.0, 0.0], [-1.0, 1.75, 0.0], [1.0, 0.0, -0.02]])
}

/// A prism with a blunt edge along y on top.
fn roof() -> Block {
    prism([[1.0, 0.5, 1.0], [1.0, 1.5, 1.0], [0.5, 1.5, 0.75], [0.5, 0.5, 0.75], [1.5, 1.5, 0.75], [1.5, 0.5, 0.75]])
}

/// A tetrahedron that points into the notch of the corner block.
fn spike_along([x, y, z]: [f64; 3]) -> Block {
    tetrahedron([
        [x, y, z],
        [x + 0.5, y + 0.25, z + 0.0625],
        [x + 0.25, y + 0.5, z + 0.0625],
        [x + 0.375, y + 0.375, z - 0.125],
    ])
}

/// A tetrahedron whose vertex 0 points to −x and −z at once.
fn leaning_spike([x, y, z]: [f64; 3]) -> Block {
    tetrahedron([[x, y, z], [x + 0.5, y, z + 0.125], [x + 0.125, y + 0.25, z + 0.5], [x + 0.125, y - 0.25, z + 0.5]])
}

/// A tetrahedron with vertex 0 above the base's top and vertex 3 at `low`.
fn dipping(z: f64, low: [f64; 3]) -> Block {
    tetrahedron([[1.0, 1.0, z], [1.5, 1.0, 1.5], [0.75, 1.5, 1.5], low])
}

#[test]
fn every_mistake_changes_an_answer() {
    let right = Stepper::<SpecRules>::new();
    let bank = bank();
    let answers: Vec<_> = bank.iter().map(|(_, a, b, t)| right.f64(a, b, t).unwrap()).collect();
    let mut dead = Vec::new();
    for (name, engine) in mistakes::all() {
        let notices = |((_, a, b, t), expected): &(&Case, &Vec<_>)| engine.f64(a, b, t).unwrap() != **expected;
        // In the wide scalar too, so that it is the rule that differs and not rounding.
        let in_wide =
            |((_, a, b, t), _): &(&Case, &Vec<_>)| engine.wide(a, b, t).unwrap().0 != right.wide(a, b, t).unwrap().0;
        if !bank.iter().zip(&answers).filter(notices).any(|case| in_wide(&case)) {
            dead.push(name);
        }
    }
    assert!(dead.is_empty(), "no pair notices: {dead:?}");
}

/// Deep contacts of the kinds v-f and e-e, with what is kept beside them.
fn steps() -> Vec<(Block, Block, Vec<ContactKey>)> {
    use ContactKind::{EdgeEdge, FaceVertex, VertexFace};
    let deep = || spike([1.0, 1.0, 0.9296875], 0.25, 0.5);
    let key = |kind, a, b| vec![ContactKey::of_kind(kind, [a, b])];
    vec![
        (deep(), base(), key(VertexFace, 0, 1)),
        (deep(), base(), key(FaceVertex, 0, 1)),
        (deep(), base(), key(VertexFace, 0, 0)),
        (deep(), base(), key(VertexFace, 1, 1)),
        (keel(0.921875, 0.5), ridge(1.0), key(EdgeEdge, 0, 0)),
    ]
}

#[test]
fn every_mistake_about_kept_contacts_changes_an_answer() {
    let t = tolerances();
    for (name, engine) in mistakes::in_steps() {
        let notices = steps().iter().any(|(a, b, kept)| {
            engine.contacts_with_kept::<f64>(a, b, &t, kept) != contacts_with_kept::<f64, SpecRules>(a, b, &t, kept)
                && engine.contacts_with_kept::<Wide>(a, b, &t, kept)
                    != contacts_with_kept::<Wide, SpecRules>(a, b, &t, kept)
        });
        assert!(notices, "no pair notices: {name}");
    }
}

/// Contacts that are looked for first, by themselves, depart where they do in the whole answer, whichever rule is wrong.
#[test]
fn what_departs_is_what_departs_from_the_whole_answer() {
    let right = Stepper::<SpecRules>::new();
    let (mut departing, mut as_expected, mut unsettled) = (0, 0, 0);
    for (pair, a, b, t) in &bank() {
        let (exact, near) = (right.wide(a, b, t).unwrap().0, right.f64(a, b, t).unwrap());
        for (name, engine) in mistakes::all() {
            let said = engine.f64(a, b, t).unwrap();
            if said == near {
                continue;
            }
            let find = |answer: &[Contact], key: ContactKey| answer.iter().find(|c| c.key == key).copied();
            let keys: BTreeSet<ContactKey> = exact.iter().chain(&said).map(|contact| contact.key).collect();
            let expected: Vec<ExpectedContact> = keys.into_iter().map(|key| (key, find(&exact, key))).collect();
            let whole = engine.settled(a, b, t).unwrap();
            let departs =
                |(key, contact): &&ExpectedContact| whole.as_ref().is_some_and(|whole| find(whole, *key) != *contact);
            let plain: Vec<ContactKey> = expected.iter().filter(departs).map(|(key, _)| *key).collect();
            assert_eq!(engine.departures(a, b, t, &expected).unwrap(), plain, "{name} on {pair}");
            for one in &expected {
                let alone = engine.departures(a, b, t, std::slice::from_ref(one)).unwrap();
                assert_eq!(alone.is_empty(), !plain.contains(&one.0), "{name} on {pair}: {one:?}");
                match &whole {
                    None => unsettled += 1,
                    Some(_) if alone.is_empty() => as_expected += 1,
                    Some(_) => departing += 1,
                }
            }
        }
    }
    let all = [departing, as_expected, unsettled];
    assert!(all.into_iter().all(|count| count > 100), "{all:?}: departing, as expected, unsettled");
}

#[test]
fn no_mistake_leads_to_a_panic_in_any_precision() {
    let bank = bank();
    for (name, engine) in mistakes::all() {
        for (pair, a, b, t) in &bank {
            assert!(engine.f32(a, b, t).is_ok() && engine.f64(b, a, t).is_ok(), "{name} on {pair}");
        }
    }
}

#[test]
fn mistakes_have_names_of_their_own() {
    let all = || mistakes::all().into_iter().chain(mistakes::in_steps());
    let names: std::collections::BTreeSet<_> = all().map(|(name, _)| name).collect();
    assert_eq!(names.len(), all().count());
    assert!(names.len() >= 24);
}
