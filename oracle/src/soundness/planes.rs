//! What is concluded from edges parallel to faces and from planar faces, against integers: on blocks with edges and faces parallel to one another's or
//! nearly so, and on blocks whose faces are bent.

use super::edge_in_plane::parallelepiped;
use super::in_integers::{sign_of, value_of};
use super::{Dice, Input, block, without_tolerances};
use crate::pair::Pair;
use crate::predicate::{AbovePlane, Factor, LargerGap};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use num_bigint::BigInt;
use rockproof_model::decision::Side;
use rockproof_model::{Block, Entrance};

/// What was seen.
#[derive(Debug, Default)]
struct Seen {
    planar: usize,
    bent: usize,
    /// Gaps called equal that are not zero: of a face and two edges, of two faces.
    crossing: usize,
    parallel: usize,
}

impl Seen {
    /// Holds that faces are planar and gaps equal where the cascade says so.
    fn check(&mut self, a: &Block, b: &Block, about: &str) {
        let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
        let (pair, t) = (Pair::new(&a, &b), without_tolerances());
        let mut run = SignCascade::new(&pair, &t);
        for side in [Side::A, Side::B] {
            let topology = pair.topology(side);
            for face in topology.face_ids() {
                let in_plane = |&v| {
                    let above = AbovePlane { vertex: (side, v), face: (side, face) };
                    sign_of(&pair, &t, &above).is_zero()
                };
                let planar = topology.face(face).iter().all(in_plane);
                for time in 1..=2 {
                    assert_eq!(run.is_planar((side, face)), planar, "{about}: {side:?} {face}, time {time}");
                }
                *(if planar { &mut self.planar } else { &mut self.bent }) += 1;
            }
        }
        let (of_a, of_b) = (pair.topology(Side::A), pair.topology(Side::B));
        let mut all: Vec<Entrance> = Vec::new();
        all.extend(of_a.vertex_ids().flat_map(|v| of_b.face_ids().map(move |f| Entrance::VertexFace(v, f))));
        all.extend(of_a.face_ids().flat_map(|f| of_b.vertex_ids().map(move |v| Entrance::FaceVertex(f, v))));
        all.extend(of_a.edge_ids().flat_map(|a| of_b.edge_ids().map(move |b| Entrance::EdgeEdge(a, b))));
        for &first in &all {
            for &second in &all {
                if !run.share_plane(&first, &second) {
                    continue;
                }
                let gaps = LargerGap { first, second, factor: Factor::One };
                let value = value_of(&pair, &t, &gaps);
                assert_eq!(value, BigInt::ZERO, "{about}: {first:?} and {second:?}");
                let gap = match first {
                    Entrance::VertexFace(v, f) => AbovePlane { vertex: (Side::A, v), face: (Side::B, f) },
                    Entrance::FaceVertex(f, v) => AbovePlane { vertex: (Side::B, v), face: (Side::A, f) },
                    Entrance::EdgeEdge(..) => continue,
                };
                if !sign_of(&pair, &t, &gap).is_zero() {
                    let edges = matches!(second, Entrance::EdgeEdge(..));
                    *(if edges { &mut self.crossing } else { &mut self.parallel }) += 1;
                }
            }
        }
    }
}

#[test]
fn faces_are_planar_and_gaps_equal_where_edges_say_so() {
    let (mut dice, mut seen) = (Dice(13), Seen::default());
    for round in 0..120 {
        let size = 1i64 << (2 + dice.below(47));
        let any = |dice: &mut Dice| [0; 3].map(|_: i64| dice.below(2 * size as u64) as i64 - size);
        let spans = [any(&mut dice), any(&mut dice), any(&mut dice)];
        let sum = |one: [i64; 3], other: [i64; 3]| [0, 1, 2].map(|k| one[k] + other[k]);
        let mut beside = sum(spans[0], spans[1]);
        beside[dice.below(3) as usize] += dice.pick(&[-1, 1]);
        let along = [spans[0], spans[1], spans[1].map(|c| -c), spans[2], sum(spans[0], spans[1]), beside];
        let others = [dice.pick(&along), dice.pick(&along), any(&mut dice)];
        let corner = sum(spans[2], any(&mut dice).map(|c| c >> dice.below(12)));
        if let (Some(a), Some(b)) = (parallelepiped([0; 3], spans), parallelepiped(corner, others)) {
            seen.check(&a, &b, &format!("round {round}"));
        }
    }
    assert!(seen.planar > 100 && seen.crossing > 200 && seen.parallel > 20, "{seen:?}");
}

/// Edges that are parallel to a bent face, or in it, say nothing of its plane.
#[test]
fn bent_faces_share_no_plane() {
    let (mut dice, mut seen) = (Dice(14), Seen::default());
    for round in 0..400 {
        let input = dice.pick(&[Input::SmallIntegers, Input::SmallIntegers, Input::NearTies, Input::Fractions]);
        if let (Some(a), Some(b)) = (block(&mut dice, input, 0), block(&mut dice, input, 1))
            && a.topology().edges().len().max(b.topology().edges().len()) <= 12
        {
            seen.check(&a, &b, &format!("round {round}, {input:?}"));
        }
    }
    assert!(seen.planar > 100 && seen.bent > 100 && seen.crossing > 50, "{seen:?}");
}
