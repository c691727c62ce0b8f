//! Signs of inward directions across edges, told by a shorter polynomial where an edge lies in the plane of a face at it: on blocks whose faces are
//! planar in numbers of many digits, and whose edges are parallel to faces of one another. Integers say what is right.

use super::in_integers::sign_of;
use super::{Dice, without_tolerances};
use crate::levels::LevelCounts;
use crate::pair::Pair;
use crate::predicate::InwardAcross;
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use rockproof_model::decision::Side;
use rockproof_model::{Block, BlockOptions, EdgeId, Number, Vec3};

pub(super) const FACES: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// The parallelepiped that these vectors span from a corner; none where they do not go round to the right.
pub(super) fn parallelepiped(corner: [i64; 3], spans: [[i64; 3]; 3]) -> Option<Block> {
    let vertices = (0..8).map(|k: usize| {
        let at = |axis: usize| {
            let c = corner[axis] + (0..3).map(|s| if k >> s & 1 == 1 { spans[s][axis] } else { 0 }).sum::<i64>();
            Number::from_f64(c as f64).expect("finite")
        };
        Vec3::new(at(0), at(1), at(2))
    });
    let faces = FACES.iter().map(|face| face.to_vec()).collect();
    Block::new(vertices.collect(), faces, &BlockOptions { planarity: Number::ZERO }).ok()
}

/// Holds that the cascade says of all edges of a pair what integers say; adds how it did, and counts zeros.
fn check(a: &Block, b: &Block, about: &str, levels: &mut LevelCounts) -> usize {
    let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let (pair, t) = (Pair::new(&a, &b), without_tolerances());
    let mut run = SignCascade::new(&pair, &t);
    let (mut zeros, mut asked) = (0, 0);
    for edge_a in a.block.topology().edge_ids() {
        for edge_b in b.block.topology().edge_ids() {
            for (side, right) in [(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)] {
                let inward = InwardAcross { edge_a, edge_b, side, right };
                let exact = sign_of(&pair, &t, &inward);
                assert_eq!(run.sign(&inward), exact, "{about}: edges {edge_a} and {edge_b}, {side:?}, right {right}");
                zeros += usize::from(exact.is_zero());
                asked += 1;
            }
        }
    }
    let LevelCounts { float, ball, i128, fixed, heap } = run.levels;
    assert_eq!(float + ball + i128 + fixed.iter().sum::<u64>() + heap, asked, "{about}: each sign is counted once");
    *levels += run.levels;
    zeros
}

#[test]
fn edges_in_planes_of_faces_tell_the_sign_in_fewer_digits() {
    let mut dice = Dice(11);
    let (mut zeros, mut levels, mut pairs) = (0, LevelCounts::default(), 0);
    for round in 0..300 {
        let size = 1i64 << (30 + dice.below(19));
        let any = |dice: &mut Dice| [0; 3].map(|_: i64| dice.below(2 * size as u64) as i64 - size);
        let spans = [any(&mut dice), any(&mut dice), any(&mut dice)];
        // Of B's edges one or two are along A's, along a diagonal of a face of A, or as near to that as may be.
        let sum = |one: [i64; 3], other: [i64; 3]| [0, 1, 2].map(|k| one[k] + other[k]);
        let mut beside = sum(spans[0], spans[1]);
        beside[dice.below(3) as usize] += dice.pick(&[-1, 1]);
        let along = [spans[0], spans[1].map(|c| -c), sum(spans[0], spans[1]), beside, any(&mut dice)];
        let others = [dice.pick(&along), dice.pick(&along), any(&mut dice)];
        let corner = sum(spans[2], any(&mut dice).map(|c| c >> 10));
        if let (Some(a), Some(b)) = (parallelepiped([0; 3], spans), parallelepiped(corner, others)) {
            zeros += check(&a, &b, &format!("round {round}"), &mut levels);
            pairs += 1;
        }
    }
    let unsure: u64 = levels.ball + levels.i128 + levels.fixed.iter().sum::<u64>() + levels.heap;
    assert!(pairs > 5 && zeros > 200 && unsure > zeros as u64 + 20, "{zeros} zeros in {pairs} pairs, {levels:?}");
    // Five factors of some 40 bits each would take 256 bits.
    let wide: u64 = levels.fixed.iter().sum::<u64>() + levels.heap;
    assert!(levels.i128 > 100 && wide < levels.i128 / 10, "{levels:?}");
}

/// Of an edge without length every direction across is zero, though it lies in every plane.
#[test]
fn edges_without_length_tell_nothing() {
    let mut dice = Dice(12);
    let (mut levels, mut zeros, mut pairs) = (LevelCounts::default(), 0, 0);
    while pairs < 10 {
        let any = |dice: &mut Dice| [0; 3].map(|_: i64| dice.below(1 << 41) as i64 - (1 << 40));
        let spans = [any(&mut dice), any(&mut dice), any(&mut dice)];
        let others = [any(&mut dice), any(&mut dice), any(&mut dice)];
        let (Some(a), Some(b)) = (parallelepiped([0; 3], spans), parallelepiped(spans[2], others)) else { continue };
        pairs += 1;
        for (side, edge) in [(Side::A, EdgeId(0)), (Side::B, EdgeId(3))] {
            let block = if side == Side::A { &a } else { &b };
            let ends = *block.topology().edge(edge);
            let mut vertices = block.vertices().to_vec();
            vertices[ends.q.index()] = vertices[ends.p.index()].clone();
            let flat = block.with_vertices(vertices);
            let blocks = if side == Side::A { [&flat, &b] } else { [&a, &flat] };
            zeros += check(blocks[0], blocks[1], &format!("pair {pairs}, {side:?}"), &mut levels);
        }
    }
    assert!(zeros >= 20 * 12 * 4, "{zeros} zeros");
}
