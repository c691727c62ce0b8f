//! What is found by looking at the nearby pairs of features alone is what is found by looking at all, wherever the vertices are within the margin.

use super::*;
use crate::soundness::{Dice, without_tolerances};
use num_rational::BigRational;
use rockproof_model::{BlockOptions, Criteria, EdgeId, Number};

/// The last is concave: an L.
const SHAPES: usize = 3;

/// A block of some four units, with its lowest corner here: a brick, a tetrahedron on a face, or an L.
fn block(shape: usize, at: [f64; 3]) -> Block {
    let outline: &[[i32; 2]] = match shape {
        0 => &[[0, 0], [4, 0], [4, 4], [0, 4]],
        1 => &[[0, 0], [4, 0], [0, 4]],
        _ => &[[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]],
    };
    let n = outline.len() as u32;
    let top: &[[i32; 2]] = if shape == 1 { &[[1, 1]] } else { outline };
    let corners = outline.iter().map(|&[x, y]| [x, y, 0]).chain(top.iter().map(|&[x, y]| [x, y, 4]));
    let number = |c: i32, at: f64| Number::from_f64(f64::from(c) + at).expect("finite");
    let vertices = corners.map(|[x, y, z]| Vec3::new(number(x, at[0]), number(y, at[1]), number(z, at[2])));
    let side = |k: u32| {
        let next = (k + 1) % n;
        if shape == 1 { vec![k, next, n] } else { vec![k, next, n + next, n + k] }
    };
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect()];
    if shape != 1 {
        faces.push((n..2 * n).collect());
    }
    faces.extend((0..n).map(side));
    Block::new(vertices.collect(), faces, &BlockOptions { planarity: Number::ZERO }).expect("a block")
}

/// A set of tolerances, some of them zero.
fn tolerances(dice: &mut Dice) -> ToleranceSet {
    let mut length =
        |choice: &[f64]| Number::from_f64(choice[dice.below(choice.len() as u64) as usize]).expect("finite");
    let (search, territory) = (length(&[0.5, 0.25]), length(&[0.0, 0.125]));
    let penetration = length(&[0.25, 0.5, 0.0]);
    let sine = Number::from_rational(BigRational::new([0, 3, 1][dice.below(3) as usize].into(), 61.into()));
    let criteria = if dice.below(3) == 0 { Criteria::Classic } else { Criteria::Revised };
    let parallel_sine = sine.clone();
    ToleranceSet { search, territory, penetration, overlap_sine: sine, parallel_sine, criteria, ..without_tolerances() }
}

/// The block with each coordinate moved by at most `margin`, often by all of it, and by `common`.
fn moved(dice: &mut Dice, block: &Block, margin: f64, common: [f64; 3]) -> Block {
    let mut near = |c: &Number, common: f64| {
        let share = [-1.0, 1.0, 0.0, 0.0, dice.below(256) as f64 / 256.0][dice.below(5) as usize];
        c.plus(&Number::from_f64(share * margin).expect("finite")).plus(&Number::from_f64(common).expect("finite"))
    };
    let vertices = block.vertices();
    let [x, y, z] = common;
    block.with_vertices(vertices.iter().map(|v| Vec3::new(near(&v.x, x), near(&v.y, y), near(&v.z, z))).collect())
}

/// What came of comparing.
#[derive(Default)]
struct Seen {
    contacts: usize,
    /// Pairs of features looked at.
    nearby: usize,
    /// Motions after which contacts are others than before.
    changed: usize,
    /// Contacts that stay since they are kept.
    kept: usize,
    /// Answers that differ.
    wrong: usize,
}

/// Moves pairs within `margin` whose nearby pairs were found for `found_for`.
fn compare(margin: f64, found_for: f64) -> Seen {
    let (mut dice, mut seen) = (Dice(9), Seen::default());
    for _ in 0..150 {
        let shapes = [0, 1].map(|_| dice.below(SHAPES as u64) as usize);
        // On a face, over an edge, over a corner, beside; apart, touching, or in one another. Multiples of 1/8: many ties.
        let place = |dice: &mut Dice| [0.0, 1.0, 4.0, 4.0, -4.0, 2.125, 3.875][dice.below(7) as usize];
        let height = 4.0 + [0.0, 0.125, -0.125, -0.25, 0.25][dice.below(5) as usize];
        let at = [place(&mut dice), place(&mut dice), height];
        let blocks = [block(shapes[0], [0.0; 3]), block(shapes[1], at)];
        let tolerances = tolerances(&mut dice);
        let prepared = blocks.each_ref().map(PreparedBlock::new);
        let pair = Pair::new(&prepared[0], &prepared[1]);
        let mut nearby = pair.nearby_features(&tolerances, found_for).expect("a margin");
        nearby.margin = margin;
        seen.nearby += nearby.len();
        let before = pair.classify(&tolerances).contacts;
        for turn in 0..6 {
            let common = if turn < 3 { [0.0; 3] } else { [1024.0, -3.5, 0.25] };
            // Half of the margin each, since A's first vertex moves too.
            let now = blocks.each_ref().map(|block| moved(&mut dice, block, margin * 0.49, common));
            let prepared = now.each_ref().map(PreparedBlock::new);
            let pair = Pair::new(&prepared[0], &prepared[1]);
            assert!(covers(&nearby, &pair, &tolerances), "moved by half of the margin");
            let all = pair.classify(&tolerances).contacts;
            let deep = ContactKey::EdgeEdge(EdgeId(dice.below(6) as u32), EdgeId(dice.below(6) as u32));
            let vertex = VertexId(dice.below(4) as u32);
            let face = FaceId(dice.below(4) as u32);
            let kept: Vec<ContactKey> = before.iter().map(|contact| contact.key).collect();
            let kept =
                [kept, vec![deep, ContactKey::VertexFace(vertex, face), ContactKey::FaceVertex(face, vertex)]].concat();
            for kept in [&[], &kept[..]] {
                let expected = pair.classify_with_kept(&tolerances, kept).contacts;
                let found = pair.classify_nearby(&tolerances, &nearby, kept).contacts;
                seen.wrong += usize::from(found != expected);
                seen.kept += expected.len() - all.len().min(expected.len());
            }
            seen.contacts += all.len();
            let keys = |of: &[Contact]| of.iter().map(|contact| contact.key).collect::<Vec<_>>();
            seen.changed += usize::from(keys(&all) != keys(&before));
        }
    }
    seen
}

fn covers(nearby: &NearbyFeatures, pair: &Pair<'_>, tolerances: &ToleranceSet) -> bool {
    nearby.cover(&Classification::new(pair, tolerances, Unobserved))
}

#[test]
fn nearby_pairs_give_the_contacts_of_all() {
    for margin in [1.0 / 64.0, 1.0 / 8.0] {
        let Seen { contacts, nearby, changed, kept, wrong } = compare(margin, margin);
        assert_eq!(wrong, 0, "margin {margin}");
        assert!(contacts > 500 && changed > 50 && kept > 0, "{contacts} contacts, {changed} changed, {kept} kept");
        assert!(nearby < 150 * 80, "{nearby} of some 400 pairs of features each are looked at");
    }
}

/// Pairs found for a smaller margin than that within which blocks move are not enough, and this notices.
#[test]
fn a_margin_that_is_too_small_is_noticed() {
    assert!(compare(1.0 / 8.0, 1.0 / 1024.0).wrong > 20);
}

/// Beyond the margin, of other blocks and under other tolerances all pairs are looked at.
#[test]
fn who_is_not_near_is_not_covered() {
    let mut dice = Dice(3);
    let tolerances = ToleranceSet { search: Number::from_f64(0.25).expect("finite"), ..without_tolerances() };
    let blocks = [block(0, [0.0; 3]), block(0, [1.0, 1.0, 4.0])];
    let prepared = blocks.each_ref().map(PreparedBlock::new);
    let pair = Pair::new(&prepared[0], &prepared[1]);
    let margin = 1.0 / 64.0;
    let nearby = pair.nearby_features(&tolerances, margin).expect("a margin");
    assert!(covers(&nearby, &pair, &tolerances) && !nearby.is_empty());
    let wider = ToleranceSet { search: Number::from_integer(1), ..tolerances.clone() };
    assert!(!covers(&nearby, &pair, &wider));
    let turned = Pair::new(&prepared[1], &prepared[0]);
    assert!(!covers(&nearby, &turned, &tolerances));
    let far = PreparedBlock::new(&block(0, [1.0, 1.0, 4.0 + 2.0 * margin]));
    let apart = Pair::new(&prepared[0], &far);
    assert!(!covers(&nearby, &apart, &tolerances));
    assert_eq!(apart.classify_nearby(&tolerances, &nearby, &[]).contacts, apart.classify(&tolerances).contacts);
    let other = PreparedBlock::new(&block(2, [1.0, 1.0, 4.0]));
    assert!(!covers(&nearby, &Pair::new(&prepared[0], &other), &tolerances));
    // One vertex alone, by the least that is too much.
    let [a, mut b] = blocks.clone();
    let mut vertices = b.vertices().to_vec();
    vertices[5].y = vertices[5].y.plus(&Number::from_f64(margin * (1.0 + 1e-9)).expect("finite"));
    b = b.with_vertices(vertices);
    let prepared = [&a, &b].map(PreparedBlock::new);
    assert!(!covers(&nearby, &Pair::new(&prepared[0], &prepared[1]), &tolerances));
    // Together, as far as may be.
    let common = [1e6, 1e6, -1e6];
    let prepared = blocks.each_ref().map(|block| PreparedBlock::new(&moved(&mut dice, block, 0.0, common)));
    assert!(covers(&nearby, &Pair::new(&prepared[0], &prepared[1]), &tolerances));
    for margin in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(pair.nearby_features(&tolerances, margin).is_none());
    }
}
