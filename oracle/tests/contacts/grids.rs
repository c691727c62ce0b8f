//! The fast path against the plain one with a tip at every point of a grid over and inside concave blocks: level with the edges of a
//! face, on its rim, at its corners, and as deep as several faces whose exits compete.
//!
//! Caught so far: nothing; random pairs seldom come to these places.

use crate::support::shapes::{number, revised, spike, tetrahedron};
use num_rational::BigRational;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{
    Block, BlockOptions, ContactKey, ContactKind, FaceId, Number, Point, ToleranceSet, Vec3, VertexId,
};
use rockproof_oracle::{Pair, PreparedBlock, plain};
use std::collections::BTreeSet;

/// Outlines in half metres, counter-clockwise: an L, a U, a plus, and a notch with slanting sides.
const OUTLINES: [&[[i32; 2]]; 4] = [
    &[[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]],
    &[[0, 0], [6, 0], [6, 4], [4, 4], [4, 2], [2, 2], [2, 4], [0, 4]],
    &[[2, 0], [4, 0], [4, 2], [6, 2], [6, 4], [4, 4], [4, 6], [2, 6], [2, 4], [0, 4], [0, 2], [2, 2]],
    &[[0, 0], [6, 0], [6, 4], [4, 4], [3, 1], [2, 4], [0, 4]],
];

fn halves(steps: i32) -> Number {
    number(&format!("{steps}/2"))
}

/// The prism over an outline of the list, from z = −2 or −1 to z = 0; its top is face 1.
fn prism(shape: usize) -> Block {
    prism_over(OUTLINES[shape], [-4, -2, -4, -2][shape])
}

/// The prism over an outline, from so many half metres below to z = 0; its top is face 1.
fn prism_over(outline: &[[i32; 2]], low: i32) -> Block {
    let n = outline.len() as u32;
    let at = |z: i32| outline.iter().map(move |&[x, y]| Vec3::new(halves(x), halves(y), halves(z)));
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
    let faces = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
    Block::new(at(low).chain(at(0)).collect(), faces, &BlockOptions { planarity: Number::ZERO }).unwrap()
}

/// The axes in another order: the face then has its normal along another axis.
fn turned(block: &Block, turns: usize) -> Block {
    let turn = |v: &Point| {
        let c = v.components();
        Vec3::new(c[turns % 3].clone(), c[(turns + 1) % 3].clone(), c[(turns + 2) % 3].clone())
    };
    block.with_vertices(block.vertices().iter().map(turn).collect())
}

struct Seen {
    pairs: u64,
    kinds: BTreeSet<ContactKind>,
    /// Outcomes of the questions that these pairs are for.
    inside: BTreeSet<i8>,
    exits: BTreeSet<i8>,
}

fn compare(tip: &Block, base: &Block, t: &ToleranceSet, about: &str, seen: &mut Seen) {
    let (a, b) = (PreparedBlock::new(tip), PreparedBlock::new(base));
    let pair = Pair::new(&a, &b);
    let fast = pair.classify(t).contacts;
    let plainly: Vec<_> = plain::classify::<BigRational>(tip, base, t).into_iter().map(|found| found.contact).collect();
    assert_eq!(fast, plainly, "{about}: fast (left), plain (right)");
    seen.pairs += 1;
    seen.kinds.extend(fast.iter().map(|contact| contact.kind()));
    for entry in pair.trace(t) {
        match entry.decision.predicate {
            Predicate::InsideFace => seen.inside.insert(entry.outcome),
            Predicate::ShortestExit => seen.exits.insert(entry.outcome),
            _ => false,
        };
    }
}

/// The tip at every half metre, at the heights in turn; each base turned so many times, beginning with as many turns as its place in the list.
fn walk(height: &[&str], times: usize, t: &ToleranceSet) -> Seen {
    let mut seen = Seen { pairs: 0, kinds: BTreeSet::new(), inside: BTreeSet::new(), exits: BTreeSet::new() };
    for shape in 0..OUTLINES.len() {
        for turns in shape..shape + times {
            let base = turned(&prism(shape), turns);
            for x in 0..=6usize {
                for y in 0..=6usize {
                    let z = height[(x + y + turns) % height.len()];
                    let at =
                        spike(["0", "0", "0"]).translated(&Vec3::new(halves(x as i32), halves(y as i32), number(z)));
                    let about = format!("outline {shape}, turned {turns} times, tip at ({x}, {y})/2, {z}");
                    compare(&turned(&at, turns), &base, t, &about, &mut seen);
                }
            }
        }
    }
    seen
}

#[test]
fn over_a_concave_face_the_paths_agree() {
    walk_over_faces(1);
}

#[test]
#[ignore = "seven seconds; .ci/run runs it"]
fn over_a_concave_face_however_it_is_turned_the_paths_agree_at_full_size() {
    walk_over_faces(3);
}

fn walk_over_faces(times: usize) {
    let seen = walk(&["1/20", "0", "-1/40"], times, &revised(&[("territory", "0")]));
    assert!(seen.pairs == 4 * times as u64 * 49 && seen.kinds.contains(&ContactKind::VertexFace), "{:?}", seen.kinds);
    assert_eq!(seen.inside, BTreeSet::from([0, 1]));
}

/// Where a point of the grid lies in an outline: 1 inside, 0 on it, −1 outside. An edge is passed by a ray along x where its
/// ends are on different sides of the ray, or its upper end on it.
fn place_in(outline: &[[i32; 2]], [x, y]: [i32; 2]) -> i8 {
    let mut inside = false;
    for (k, &[px, py]) in outline.iter().enumerate() {
        let [qx, qy] = outline[(k + 1) % outline.len()];
        let turn = (qx - px) * (y - py) - (qy - py) * (x - px);
        let [along_x, along_y] = [(px, qx, x), (py, qy, y)].map(|(p, q, at)| (p.min(q)..=p.max(q)).contains(&at));
        if turn == 0 && along_x && along_y {
            return 0;
        }
        inside ^= (py < y) != (qy < y) && (turn > 0) == (qy > py);
    }
    if inside { 1 } else { -1 }
}

/// Where a tip 1/20 over a face is told to be, and how close to the boundary: `None` where nobody asks.
fn place_told(tip: &Block, base: &Block) -> Option<(i8, bool, f64)> {
    let (tip, base) = (PreparedBlock::new(tip), PreparedBlock::new(base));
    let (pair, t) = (Pair::new(&tip, &base), revised(&[("territory", "0")]));
    let features = [Feature::Vertex(Side::A, VertexId(0)), Feature::Face(Side::B, FaceId(1))];
    let asked = Decision::about(Predicate::InsideFace, &features);
    let entry = pair.trace(&t).into_iter().find(|entry| entry.decision == asked)?;
    let margin = pair.margins(&t, &[asked])[0].expect("it is measured");
    assert_eq!(entry.outcome == 1, margin.sign.is_positive());
    Some((margin.sign.as_i8(), entry.tie, margin.relative))
}

/// Level with a corner, or on the line of an edge that ends before it, a tip is no nearer to the boundary than elsewhere; nor where
/// the face is tilted so little that one component of its normal is small.
#[test]
fn inside_ties_on_the_boundary_alone_and_its_margin_is_small_nowhere_else() {
    const SQUARE: [[i32; 2]; 4] = [[0, 0], [4, 0], [4, 4], [0, 4]];
    let outlines: [&[[i32; 2]]; 5] = [OUTLINES[0], OUTLINES[1], OUTLINES[2], OUTLINES[3], &SQUARE];
    let (mut places, mut tilted_places) = ([0; 3], 0);
    for (shape, outline) in outlines.into_iter().enumerate() {
        let base = prism_over(outline, -4);
        let tilt = number("1/1099511627776");
        let raised = |v: &Point| Vec3::new(v.x.clone(), v.y.clone(), v.z.plus(&v.x.times(&tilt)));
        let tilted = base.with_vertices(base.vertices().iter().map(raised).collect());
        for (x, y) in (0..=6).flat_map(|x| (0..=6).map(move |y| (x, y))) {
            let tip = spike(["0", "0", "0"]).translated(&Vec3::new(halves(x), halves(y), number("1/20")));
            let place = place_in(outline, [x, y]);
            for turns in 0..3 {
                let about = format!("outline {shape}, turned {turns} times, tip at ({x}, {y})/2");
                let tip = turned(&tip, turns);
                let Some((told, tie, margin)) = place_told(&tip, &turned(&base, turns)) else {
                    assert_eq!(place, -1, "{about}: not asked");
                    continue;
                };
                assert_eq!((told, tie), (place, place == 0), "{about}");
                // No distance in the grid is small against the blocks: neither is any margin.
                assert!(if tie { margin == 0.0 } else { margin > 1e-3 }, "{about}: {margin}");
                places[(place + 1) as usize] += 1;
                // The foot is moved by 2⁻⁴⁰ of a twentieth along the slope: across a boundary that it was on, and no other.
                let Some((told, tie, margin)) = place_told(&tip, &turned(&tilted, turns)) else { continue };
                if place == 0 {
                    assert!(margin < 1e-9, "{about}, tilted: {margin}");
                } else {
                    assert!(told == place && !tie && margin > 1e-3, "{about}, tilted: {told} {margin}");
                    tilted_places += 1;
                }
            }
        }
    }
    assert!(places.iter().all(|&count| count > 60), "{places:?} outside, on the boundary, inside");
    assert!(tilted_places > 120, "{tilted_places}");
}

#[test]
fn beside_the_rims_of_a_concave_face_the_paths_agree() {
    // λ·w of an edge is 1/4 or 1/2 by the sides, and up to 3/4 by the top: the tip is 1/2 from many.
    let seen = walk(&["1/20", "0"], 1, &revised(&[("territory", "1/2"), ("search", "3/4")]));
    assert!(
        seen.kinds.contains(&ContactKind::VertexEdge) && seen.kinds.contains(&ContactKind::VertexFace),
        "{:?}",
        seen.kinds
    );
}

#[test]
fn across_rims_the_paths_agree() {
    // A sloping edge, 1/10 a metre: across a rim it makes the top dip by as much, so by more at its far corners than at its near ones.
    let keel = tetrahedron([["-1", "0", "-1/10"], ["1", "0", "1/10"], ["0", "1", "2"], ["0", "-1", "2"]]);
    let mut seen = Seen { pairs: 0, kinds: BTreeSet::new(), inside: BTreeSet::new(), exits: BTreeSet::new() };
    for shape in 0..OUTLINES.len() {
        for place in 0..28 {
            let (x, y) = (place % 7, place / 7);
            let at = Vec3::new(halves(x), number(&format!("{}/4", 1 + 4 * y)), number("1/100"));
            for g in ["1/20", "3/20", "1/4"] {
                let t = revised(&[("territory", "0"), ("penetration", g), ("overlap_sine", "1/5")]);
                let about = format!("outline {shape}, keel at ({x}/2, {}/4), g = {g}", 1 + 4 * y);
                compare(&keel.translated(&at), &prism(shape), &t, &about, &mut seen);
            }
        }
    }
    assert!(seen.kinds.contains(&ContactKind::EdgeEdge), "{:?}", seen.kinds);
}

#[test]
fn inside_a_concave_block_the_paths_agree() {
    // Nothing is too deep and every plane passes, so that all faces around the tip compete.
    let all = [("territory", "0"), ("penetration", "9"), ("overlap_sine", "1")];
    let seen = walk(&["-1", "-1/2", "-2", "-7/4"], 1, &revised(&all));
    assert_eq!(seen.exits, BTreeSet::from([0, 1]));
}

#[test]
fn over_a_bent_face_the_paths_agree() {
    // One corner of the top is 2/5 low: the plane of the face passes 1/10 above the corner opposite, and above the block's box.
    let corners =
        [[0, 0, -20], [20, 0, -20], [20, 20, -20], [0, 20, -20], [0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, -2]];
    let fifths = |c: i32| number(&format!("{c}/5"));
    let vertices = corners.map(|corner: [i32; 3]| {
        let [x, y, z] = corner.map(fifths);
        Vec3::new(x, y, z)
    });
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from);
    let base =
        Block::new(vertices.to_vec(), faces.to_vec(), &BlockOptions { planarity: Number::from_integer(1) }).unwrap();
    // Two tips that slope as the plane does: one may be above the box by more than s, while the other is within it.
    let tips = tetrahedron([["0", "0", "0"], ["-1/2", "1/2", "-1/20"], ["-1", "-1", "2"], ["1", "1", "2"]]);
    let t = revised(&[("search", "1/100"), ("territory", "0"), ("penetration", "1/100"), ("overlap_sine", "1/5")]);
    let mut seen = Seen { pairs: 0, kinds: BTreeSet::new(), inside: BTreeSet::new(), exits: BTreeSet::new() };
    let mut above = 0;
    for place in 2..8 {
        // Along the diagonal from the low corner to the one opposite, where the plane is highest.
        for z in -12..=16 {
            let at = Vec3::new(halves(place), halves(8 - place), number(&format!("{z}/200")));
            let tips = tips.translated(&at);
            compare(&tips, &base, &t, &format!("tips at ({place}, {})/2, {z}/200", 8 - place), &mut seen);
            let contacts = Pair::new(&PreparedBlock::new(&tips), &PreparedBlock::new(&base)).classify(&t).contacts;
            above +=
                usize::from(z > 2 && contacts.iter().any(|c| matches!(c.key, ContactKey::VertexFace(VertexId(0), _))));
        }
    }
    assert!(seen.kinds.contains(&ContactKind::VertexFace) && above > 0, "{:?}, {above} above the box", seen.kinds);
}
