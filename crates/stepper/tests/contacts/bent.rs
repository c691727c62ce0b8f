//! Blocks with a bent face, whose plane passes above the corners that are low and so out of the block's box. SPEC section 2 means that
//! plane, so contacts with the face may be where the box is far.

use crate::hand_worked::check;
use crate::pairs::{CUBOID_FACES, n, show, tetrahedron, tolerances};
use rockproof_model::{Block, BlockOptions, ToleranceSet, Vec3};
use rockproof_stepper::Wide;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::contacts_in;

/// A cube of 4 m below z = 0 whose top has its corner 7, at (0, 4), half a metre low. Twice the top's area vector is
/// (0, 0, 16) + (−2, 2, 16) and the mean of its corners (2, 2, −1/8): its plane is z = −1/8 + (x − y)/16, an eighth above corner 5 at (4, 0).
pub(crate) fn bent() -> Block {
    let corner = |k: usize| {
        let (x, y) = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)][k % 4];
        let z = if k < 4 { -4.0 } else { 0.0 };
        Vec3::new(n(x), n(y), n(if k == 7 { -0.5 } else { z }))
    };
    let faces = CUBOID_FACES.map(<[u32]>::to_vec).to_vec();
    Block::new((0..8).map(corner).collect(), faces, &BlockOptions { planarity: n(0.25) }).unwrap()
}

/// Two tips that are as far above the plane of the bent top, `height` along z: vertex 0 where the plane is 1/16 above the box, vertex 1
/// where it is 1/16 below the highest corners. All other edges rise.
pub(crate) fn tips(height: f64) -> Block {
    tips_beside_the_corner(0.5, height)
}

/// The same with vertex 0 at x = 4 − `beside`, y = `beside`.
fn tips_beside_the_corner(beside: f64, height: f64) -> Block {
    let [x, y, z] = [4.0 - beside, beside, (1.0 - beside) / 8.0 + height];
    tetrahedron([[x, y, z], [x - 1.0, y + 1.0, z - 0.125], [x - 1.0, y, z + 1.0], [x, y + 1.0, z + 1.0]])
}

/// s and g an eighth of the farthest that the plane is out of the box.
pub(crate) fn short_reach() -> ToleranceSet {
    ToleranceSet { search: n(0.015625), territory: n(0.0), penetration: n(0.015625), ..tolerances() }
}

#[test]
fn vertex_face_where_the_plane_of_a_bent_face_is_out_of_its_box() {
    let t = short_reach();
    // The gap is 32/√1032 = 0.996 of the height along z.
    check("apart", &tips(0.0078125), &bent(), &t, &["v-f 0 1 v-f 0 1 +1", "v-f 1 1 v-f 1 1 +1"]);
    check("overlapping", &tips(-0.0078125), &bent(), &t, &["v-f 0 1 v-f 0 1 -1", "v-f 1 1 v-f 1 1 -1"]);
    check("hardly within s", &tips(0.015625), &bent(), &t, &["v-f 0 1 v-f 0 1 +1", "v-f 1 1 v-f 1 1 +1"]);
    check("more than s", &tips(0.0166015625), &bent(), &t, &[]);
    check("roles exchanged", &bent(), &tips(0.0078125), &t, &["f-v 1 0 f-v 1 0 +1", "f-v 1 1 f-v 1 1 +1"]);
}

/// All coordinates times a power of two.
fn scaled(block: &Block, factor: f64) -> Block {
    let vertices = block.vertices().iter().map(|v| v.map(|c| c.times(&n(factor)))).collect();
    block.with_vertices(vertices)
}

#[test]
fn a_bent_face_is_looked_at_in_proportion_to_the_reach() {
    for factor in [0.125, 1.0 / 1024.0, 1024.0] {
        let [search, penetration] = [n(0.015625 * factor), n(0.015625 * factor)];
        let t = ToleranceSet { search, penetration, ..short_reach() };
        let [tips, bent] = [tips(0.0078125), bent()].map(|block| scaled(&block, factor));
        check(&format!("times {factor}"), &tips, &bent, &t, &["v-f 0 1 v-f 0 1 +1", "v-f 1 1 v-f 1 1 +1"]);
    }
}

#[test]
fn vertex_face_touching_a_bent_face_where_nothing_may_be_apart() {
    // With s = g = 0 no slack in proportion to them is left. Both tips are on the plane, so that only exact arithmetic could tell them apart
    // from it; what floats make of that is not asked here.
    let t = ToleranceSet { search: n(0.0), penetration: n(0.0), ..short_reach() };
    let found = contacts_in::<Wide, SpecRules>(&tips(0.0), &bent(), &t).unwrap();
    assert_eq!(found.iter().map(show).collect::<Vec<_>>(), ["v-f 0 1 v-f 0 1 +0", "v-f 1 1 v-f 1 1 +0"]);
}

#[test]
fn vertex_face_over_the_corner_where_the_plane_is_out_by_the_whole_bulge() {
    // Corner 5 is 4/√1032 = 0.1245 from the plane, and its foot (−1/16, 1/16, 1)/8 from it, nearly. Vertex 0 is a little farther in: z is
    // 31/256 = 0.121 there, 0.97 of the bulge, while s is less than a hundredth of it.
    let apart = 1.0 / 1024.0;
    let t = ToleranceSet { search: n(apart), penetration: n(apart), ..short_reach() };
    let tips = |height: f64| tips_beside_the_corner(1.0 / 32.0, height);
    let found = |sign: &str| [0, 1].map(|v| format!("v-f {v} 1 v-f {v} 1 {sign}"));
    for (name, height, sign) in [("apart", 0.5, "+1"), ("hardly within s", 1.0, "+1"), ("overlapping", -0.5, "-1")] {
        let found = found(sign);
        check(name, &tips(height * apart), &bent(), &t, &found.each_ref().map(String::as_str));
    }
    check("more than s", &tips(1.0625 * apart), &bent(), &t, &[]);
    check("roles exchanged", &bent(), &tips(0.5 * apart), &t, &["f-v 1 0 f-v 1 0 +1", "f-v 1 1 f-v 1 1 +1"]);
}
