//! Hand-worked pairs, one group a contact kind, ties included, in f32, f64 and the wide scalar by one harness: all
//! coordinates and tolerances are dyadic, so the ties are exact in each of them.
//!
//! Tolerances unless said otherwise: s = 1/8, r = 1/64, g = 1/16, so = sp = 3/64, ε = 2⁻²⁰, revised.

use crate::pairs::{
    L_OUTLINE, beak, blade, classic, cone, corner_block, cuboid, keel, leaning, long_ridge, n, ridge, shifted_keel,
    show, spike, tetrahedron, tolerances, undercut, upright,
};
use rockproof_model::{Block, ContactKey, FaceId, ToleranceSet, VertexId};
use rockproof_stepper::contact::{ContactRules, SpecRules};
use rockproof_stepper::engine::contacts_with_kept;
use rockproof_stepper::{PreparedBlock, Wide};

/// In each scalar the contacts are these, where nothing is kept.
pub(crate) fn check(name: &str, a: &Block, b: &Block, t: &ToleranceSet, expected: &[&str]) {
    check_with_kept(name, [a, b], t, &[], expected);
}

/// In each scalar the contacts are these in a step that keeps some.
pub(crate) fn check_with_kept(
    name: &str,
    [a, b]: [&Block; 2],
    t: &ToleranceSet,
    kept: &[ContactKey],
    expected: &[&str],
) {
    let found = [
        ("f32", contacts_with_kept::<f32, SpecRules>(a, b, t, kept).unwrap()),
        ("f64", contacts_with_kept::<f64, SpecRules>(a, b, t, kept).unwrap()),
        ("wide", contacts_with_kept::<Wide, SpecRules>(a, b, t, kept).unwrap()),
    ];
    for (precision, contacts) in found {
        assert_eq!(contacts.iter().map(show).collect::<Vec<_>>(), expected, "{name} in {precision}");
    }
}

/// Top face 1 at z = 1; its corners are vertices 4 to 7, its edges 8 (y = 0), 9 (x = 0), 10 (x = 2) and 11 (y = 2).
pub(crate) fn base() -> Block {
    cuboid([0.0; 3], [2.0, 2.0, 1.0])
}

#[test]
fn vertex_face_from_s_apart_to_g_deep() {
    let t = tolerances();
    let above = |z: f64| spike([1.0, 1.0, z], 0.25, 0.5);
    check("half way", &above(1.0625), &base(), &t, &["v-f 0 1 v-f 0 1 +1"]);
    check("s apart, a tie", &above(1.125), &base(), &t, &["v-f 0 1 v-f 0 1 +1"]);
    check("more than s", &above(1.1328125), &base(), &t, &[]);
    check("touching, a tie", &above(1.0), &base(), &t, &["v-f 0 1 v-f 0 1 +0"]);
    check("g deep, a tie", &above(0.9375), &base(), &t, &["v-f 0 1 v-f 0 1 -1"]);
    check("deeper than g", &above(0.9296875), &base(), &t, &[]);
    check("roles exchanged", &base(), &above(1.0625), &t, &["f-v 1 0 f-v 1 0 +1"]);
    check("roles exchanged, touching", &base(), &above(1.0), &t, &["f-v 1 0 f-v 1 0 +0"]);
}

#[test]
fn vertex_face_needs_a_cone_that_passes() {
    // Vertex 3 lies `low` beside vertex 0, `dip` below it; the sine is about dip / low. Its own edges rise.
    let dipping = |low: f64, dip: f64| {
        let z = 1.03125;
        tetrahedron([[1.0, 1.0, z], [1.5, 1.0, 1.5], [0.75, 1.5, 1.5], [1.0 - low, 1.0, z - dip]])
    };
    let wide_base = cuboid([-4.0, 0.0, 0.0], [2.0, 2.0, 1.0]);
    let (own, low) = ("v-f 0 1 v-f 0 1 +1", "v-f 3 1 v-f 3 1 -1");
    let t = tolerances();
    check("within the angle and g", &dipping(1.0, 0.0390625), &wide_base, &t, &[own, low]);
    check("within the angle, beyond g", &dipping(2.0, 0.078125), &wide_base, &t, &[low]);
    check("beyond the angle, within g", &dipping(0.25, 0.0390625), &wide_base, &t, &[low]);
    check("beyond both", &dipping(0.5, 0.078125), &wide_base, &t, &[low]);
    check("within the angle, beyond g, classic", &dipping(2.0, 0.078125), &wide_base, &classic(), &[own, low]);
    check("beyond the angle, within g, classic", &dipping(0.25, 0.0390625), &wide_base, &classic(), &[low]);
    // 128, 4095 and 4097 are the sides of a right triangle, and 4097 = 2¹² + 1 divides and multiplies back without
    // rounding: the dip is exactly g = 1/16, at a sine of 0.031.
    check("g, a tie", &dipping(4095.0 / 2048.0, 0.0625), &wide_base, &t, &[own, low]);
    check("hardly more than g", &dipping(4095.0 / 2048.0, 0.0634765625), &wide_base, &t, &[low]);
    // An edge straight down has the sine 1.
    let any_angle = ToleranceSet { overlap_sine: n(1.0), ..tolerances() };
    check("angle and g, ties of both", &dipping(0.0, 0.0625), &wide_base, &any_angle, &[own, low]);
    check("angle, a tie; beyond g", &dipping(0.0, 0.078125), &wide_base, &any_angle, &[low]);
    let strict = ToleranceSet { overlap_sine: n(0.0), ..classic() };
    let level = ["v-f 0 1 v-f 0 1 +1", "v-f 3 1 v-f 3 1 +1"];
    check("a level edge without any angle, a tie", &dipping(0.5, 0.0), &wide_base, &strict, &level);
}

#[test]
fn vertex_edge_and_its_ties() {
    let t = tolerances();
    // Beyond edge 11 and above it. The spike's cone passes the top (gap 1/16), not the side; the planes of its edges and
    // edge 11 have gaps of at most 0.056.
    let beside = spike([1.0, 2.03125, 1.0625], 0.25, 0.5);
    check("apart", &beside, &base(), &t, &["v-e 0 11 v-f 0 1 +1"]);
    check("roles exchanged", &base(), &beside, &t, &["e-v 11 0 f-v 1 0 +1"]);
    check(
        "straight above, s away: ties of region, rim and s",
        &spike([1.0, 2.0, 1.125], 0.25, 0.5),
        &base(),
        &t,
        &["v-e 0 11 v-f 0 1 +1"],
    );
    check("beyond s", &spike([1.0, 2.0, 1.1328125], 0.25, 0.5), &base(), &t, &[]);
    // Inside the rim by 1/64 and on the top's level: in the edge's territory by a tie.
    check("r inside the rim, a tie", &spike([1.0, 1.984375, 1.0], 0.25, 0.5), &base(), &t, &["v-e 0 11 v-f 0 1 +0"]);
    check("more than r inside", &spike([1.0, 1.9765625, 1.0], 0.25, 0.5), &base(), &t, &["v-f 0 1 v-f 0 1 +0"]);
}

#[test]
fn vertex_vertex_and_its_ties() {
    let t = tolerances();
    // All three faces and all edge pairs tie at 1/32: v-f comes first, then the lowest face.
    check("corner over corner", &cuboid([2.03125, 2.03125, 1.03125], [3.0; 3]), &base(), &t, &["v-v 0 6 v-f 0 1 +1"]);
    check("roles exchanged", &base(), &cuboid([2.03125, 2.03125, 1.03125], [3.0; 3]), &t, &["v-v 6 0 v-f 6 0 +1"]);
    check("largest gap to +y", &cuboid([2.03125, 2.0625, 1.03125], [3.0; 3]), &base(), &t, &["v-v 0 6 v-f 0 4 +1"]);
    check("touching corners", &cuboid([2.0, 2.0, 1.0], [3.0; 3]), &base(), &t, &["v-v 0 6 v-f 0 1 +0"]);
    let stacked = |z: f64| cuboid([0.0, 0.0, z], [2.0, 2.0, 2.0]);
    let four = |sign: &str| (0..4).map(|v| format!("v-v {v} {} v-f {v} 1 {sign}", v + 4)).collect::<Vec<_>>();
    for (name, z, sign) in [
        ("same outline, apart: ties of every region", 1.0625, "+1"),
        ("same outline, s apart", 1.125, "+1"),
        ("same outline, touching", 1.0, "+0"),
        ("same outline, overlapping within r", 0.9921875, "-1"),
    ] {
        let expected = four(sign);
        let expected: Vec<_> = expected.iter().map(String::as_str).collect();
        check(name, &stacked(z), &base(), &t, &expected);
    }
    // Below the corners and outside their territory no vertex is in the other's region, and all feet are at ends.
    check("same outline, overlapping beyond r", &stacked(0.96875), &base(), &t, &[]);
}

#[test]
fn edges_that_cross() {
    let t = tolerances();
    for (name, z, sign) in [
        ("apart", 1.0625, "+1"),
        ("s apart, a tie", 1.125, "+1"),
        ("touching, a tie", 1.0, "+0"),
        ("g deep, a tie", 0.9375, "-1"),
    ] {
        let expected = format!("e-e 0 0 e-e 0 0 {sign}");
        check(name, &keel(z, 0.5), &ridge(1.0), &t, &[&expected]);
    }
    check("more than s", &keel(1.1328125, 0.5), &ridge(1.0), &t, &[]);
    check("deeper than g", &keel(0.9296875, 0.5), &ridge(1.0), &t, &[]);
    // A right angle has the sine 1, and an edge of length 1/64 across another strays by r.
    let crossing = ["e-e 0 0 e-e 0 0 +1"];
    let right_angle = ToleranceSet { parallel_sine: n(1.0), ..tolerances() };
    let (long, short) = (keel(1.0625, 0.5), keel(1.0625, 0.0078125));
    check("nearly parallel, ties of angle and length", &short, &ridge(1.0), &right_angle, &[]);
    check("within the angle, beyond r", &keel(1.0625, 0.00830078125), &ridge(1.0), &right_angle, &crossing);
    check("within the angle, far beyond r", &long, &ridge(1.0), &right_angle, &crossing);
    check("beyond the angle, within r", &short, &ridge(1.0), &t, &crossing);
    let classic_right_angle = ToleranceSet { parallel_sine: n(1.0), ..classic() };
    check("nearly parallel by angle alone, classic", &long, &ridge(1.0), &classic_right_angle, &[]);
    // The vertex above the ridge makes it v-e; the plane of the two edges (gap 1/16) beats that of a slope (0.044).
    check("a foot at an end, a tie", &shifted_keel(), &ridge(1.0), &t, &["v-e 0 0 e-e 0 0 +1"]);
    // The ends are 0.088 from the ridge.
    let short = keel(1.0625, 0.0625);
    check(
        "classic, ends beyond s",
        &short,
        &ridge(1.0),
        &ToleranceSet { search: n(0.0703125), ..classic() },
        &["e-e 0 0 e-e 0 0 +1"],
    );
    check("classic, ends within s", &short, &ridge(1.0), &classic(), &["v-e 0 0 e-e 0 0 +1", "v-e 1 0 e-e 0 0 +1"]);
}

#[test]
fn wedges_need_angle_and_length() {
    let ridge = long_ridge();
    // The lower face at the front edge dips by `half` over `depth`; the back edge 8 always passes.
    for (name, depth, half, t, passes) in [
        ("within the angle and g", 1.0, 0.03125, tolerances(), true),
        ("within the angle, beyond g", 2.0, 0.078125, tolerances(), false),
        ("beyond the angle, within g", 0.5, 0.03125, tolerances(), false),
        ("beyond both", 1.0, 0.078125, tolerances(), false),
        ("within the angle, beyond g, classic", 2.0, 0.078125, classic(), true),
        ("beyond the angle, within g, classic", 0.5, 0.03125, classic(), false),
        ("g, a tie", 4095.0 / 2048.0, 0.0625, tolerances(), true),
        ("hardly more than g", 4095.0 / 2048.0, 0.0634765625, tolerances(), false),
    ] {
        let blade = blade(depth, half);
        let first = usize::from(!passes);
        check(name, &blade, &ridge, &t, &["e-e 0 0 e-e 0 0 +1", "e-e 8 0 e-e 8 0 +1"][first..]);
        check(name, &ridge, &blade, &t, &["e-e 0 0 e-e 0 0 +1", "e-e 0 8 e-e 0 8 +1"][first..]);
    }
}

#[test]
fn classic_territories_have_radius_s() {
    let near_edge = spike([1.0, 1.9375, 1.03125], 0.25, 0.5);
    check("revised", &near_edge, &base(), &tolerances(), &["v-f 0 1 v-f 0 1 +1"]);
    check("classic", &near_edge, &base(), &classic(), &["v-e 0 11 v-f 0 1 +1"]);
    let near_corner = spike([1.9375, 1.9375, 1.03125], 0.25, 0.5);
    check("revised, at a corner", &near_corner, &base(), &tolerances(), &["v-f 0 1 v-f 0 1 +1"]);
    check("classic, at a corner", &near_corner, &base(), &classic(), &["v-v 0 6 v-f 0 1 +1"]);
}

#[test]
fn concave_blocks() {
    let t = tolerances();
    let block = corner_block();
    // Into the notch: both inner faces, and not the reflex edge between them.
    let pointing = |x: f64, y: f64| {
        tetrahedron([
            [x, y, 0.5],
            [x + 0.5, y + 0.25, 0.5625],
            [x + 0.25, y + 0.5, 0.5625],
            [x + 0.375, y + 0.375, 0.375],
        ])
    };
    check(
        "both inner faces",
        &pointing(1.0078125, 1.0078125),
        &block,
        &t,
        &["v-f 0 4 v-f 0 4 +1", "v-f 0 5 v-f 0 5 +1"],
    );
    check(
        "roles exchanged",
        &block,
        &pointing(1.0078125, 1.0078125),
        &t,
        &["f-v 4 0 f-v 4 0 +1", "f-v 5 0 f-v 5 0 +1"],
    );
    // The top is a concave polygon.
    check("over the top", &spike([0.5, 2.0, 1.0625], 0.25, 0.5), &block, &t, &["v-f 0 1 v-f 0 1 +1"]);
    check(
        "over the top, level with its inner corner",
        &spike([0.5, 1.0, 1.0625], 0.25, 0.5),
        &block,
        &t,
        &["v-f 0 1 v-f 0 1 +1"],
    );
    check("over the notch", &spike([2.0, 2.0, 1.0625], 0.25, 0.5), &block, &t, &[]);
    check("over the notch, level with its inner corner", &spike([5.0, 1.0, 1.0625], 0.25, 0.5), &block, &t, &[]);
    check("over the notch, level with the far edge", &spike([2.5, 4.0, 1.0625], 0.25, 0.5), &block, &t, &[]);
    let rim = block.topology().edge_between(VertexId(6), VertexId(11)).unwrap();
    let expected = format!("v-e 0 {rim} v-f 0 1 +1");
    check("over the outer rim", &spike([0.0, 2.0, 1.0625], 0.25, 0.5), &block, &t, &[&expected]);
    check("over the inner corner, on the rim", &spike([1.0, 1.0, 1.0625], 0.25, 0.5), &block, &t, &[]);
    let rim = block.topology().edge_between(VertexId(9), VertexId(10)).unwrap();
    let expected = format!("v-e 0 {rim} v-f 0 1 +1");
    check("over the inner rim", &spike([1.0, 2.0, 1.0625], 0.25, 0.5), &block, &t, &[&expected]);
}

#[test]
fn a_concave_face_may_begin_at_any_of_its_corners() {
    for first in 0..6 {
        let mut turned = L_OUTLINE;
        turned.rotate_left(first);
        let block = upright(&turned);
        assert!(!PreparedBlock::<f64>::new(&block).unwrap().turns_left(FaceId(1)), "corner {first} first");
        let name = format!("over the top, corner {first} first");
        check(&name, &spike([0.5, 2.0, 1.0625], 0.25, 0.5), &block, &tolerances(), &["v-f 0 1 v-f 0 1 +1"]);
        check("over the notch", &spike([2.0, 2.0, 1.0625], 0.25, 0.5), &block, &tolerances(), &[]);
    }
}

#[test]
fn exits_of_overlapping_contacts() {
    let t = tolerances();
    // A vertex below the top and behind the face x = 4 (corner block) or x = 2 (base).
    let block = corner_block();
    check("shortest exit upwards", &leaning(3.953125, 0.5, 0.96875), &block, &t, &["v-f 0 1 v-f 0 1 -1"]);
    check("shortest exit sideways", &leaning(3.96875, 0.5, 0.953125), &block, &t, &["v-f 0 3 v-f 0 3 -1"]);
    check("shortest exit, a tie", &leaning(3.96875, 0.5, 0.96875), &block, &t, &["v-f 0 1 v-f 0 1 -1"]);
    check("one exit", &leaning(1.953125, 1.0, 0.96875), &base(), &t, &["v-f 0 1 v-f 0 1 -1"]);
    let any_angle = ToleranceSet { overlap_sine: n(1.0), ..tolerances() };
    check(
        "a right angle is another exit",
        &leaning(1.953125, 1.0, 0.96875),
        &base(),
        &any_angle,
        &["v-f 0 1 v-f 0 1 -1"],
    );
    assert!(!SpecRules::same_exit(0.0, 1.0, 1.0) && SpecRules::same_exit(0.5, 0.75, 0.75));
    // On the top and behind the slope below it: a face it touches is none it overlaps, so both stay.
    let beak = beak([3.96875, 0.5, 1.0]);
    check("touching one, overlapping one", &beak, &undercut(), &t, &["v-f 0 1 v-f 0 1 +0", "v-f 0 3 v-f 0 3 -1"]);
    // In the notch two faces are overlapped that no convex edge joins: both stay.
    let filling = cuboid([0.96875, 0.984375, 0.25], [3.0, 3.0, 0.75]);
    check(
        "two exits of a concave block",
        &filling,
        &block,
        &t,
        &["v-f 1 4 v-f 1 4 -1", "v-f 3 5 v-f 3 5 -1", "v-f 5 4 v-f 5 4 -1", "v-f 7 5 v-f 7 5 -1"],
    );
    // A rebate 1/128 wide parts the sides at x = 2 and y = 2, so that no edge joins them: 3/64 behind one and 1/32 behind the other a vertex
    // stays in contact with both. Edges cross none: their angle is within the tolerance, whatever it is.
    let edge = 2.0 - 0.0078125;
    let rebated = upright(&[[0.0, 0.0], [2.0, 0.0], [2.0, edge], [edge, edge], [edge, 2.0], [0.0, 2.0]]);
    let tip = cone([1.953125, 1.96875, 0.5], [[0.5, 0.0, 0.25], [0.0, 0.5, 0.25], [0.5, 0.5, 0.375]]);
    let t = ToleranceSet { search: n(0.03125), parallel_sine: n(1.0), ..classic() };
    check("two sides that no edge joins", &tip, &rebated, &t, &["v-f 0 3 v-f 0 3 -1", "v-f 0 6 v-f 0 6 -1"]);
    assert!(SpecRules::joins_exits(true) && !SpecRules::joins_exits(false));
}
