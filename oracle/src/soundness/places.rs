//! What f64 says of where a vertex lies in a face, against exact signs.

use super::{Dice, INPUTS, block, without_tolerances};
use crate::classification::{Classification, Unobserved};
use crate::contact::certified_reject::CertainPlace;
use crate::pair::Pair;
use crate::predicate::InwardOf;
use crate::prepared_block::PreparedBlock;
use rockproof_model::decision::Side;
use rockproof_model::{Block, BlockOptions, Number, Vec3};

/// A tetrahedron with its first vertex a rounding away from a point of an edge.
fn tetrahedron_on_edge(dice: &mut Dice, of: &Block) -> Option<Block> {
    let edges = of.topology().edges();
    let edge = edges[dice.below(edges.len() as u64) as usize];
    let [p, q] = [edge.p, edge.q].map(|v| of.vertices()[v.index()].map(|c| c.approximate()));
    let share = dice.below(1 << 20) as f64 / (1 << 20) as f64;
    let at = Vec3::new(p.x + (q.x - p.x) * share, p.y + (q.y - p.y) * share, p.z + (q.z - p.z) * share);
    let moved = |x: f64, y: f64, z: f64| {
        let number = |value: f64| Number::from_f64(value).ok();
        Some(Vec3::new(number(at.x + x)?, number(at.y + y)?, number(at.z + z)?))
    };
    let vertices = vec![moved(0.0, 0.0, 0.0)?, moved(1.0, 0.0, 0.0)?, moved(0.0, 1.0, 0.0)?, moved(0.0, 0.0, 1.0)?];
    let faces = vec![vec![0u32, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
    Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).ok()
}

#[test]
fn a_vertex_is_called_inside_or_outside_a_face_only_where_it_is() {
    let mut dice = Dice(19);
    let mut seen = [0; 3];
    for round in 0..600 {
        let input = INPUTS[round % (INPUTS.len() - 1)];
        let Some(b) = block(&mut dice, input, 0) else { continue };
        let Some(a) = tetrahedron_on_edge(&mut dice, &b) else { continue };
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let (pair, t) = (Pair::new(&a, &b), without_tolerances());
        let mut run = Classification::new(&pair, &t, Unobserved);
        let topology = pair.topology(Side::B);
        for v in a.block().topology().vertex_ids().take(8) {
            for f in topology.face_ids().take(8) {
                let (vertex, face) = ((Side::A, v), (Side::B, f));
                // Twice: the second time the bound for all pairs of the size is known.
                for _ in 0..2 {
                    let place = run.place_in_face(vertex, face);
                    let signs = topology.face_edges(f).iter().map(|&edge| {
                        let right = topology.edge(edge).right == f;
                        run.cascade.sign(&InwardOf { vertex, edge: (Side::B, edge), right })
                    });
                    let signs: Vec<_> = signs.collect();
                    let holds = match place {
                        CertainPlace::Inside => signs.iter().all(|sign| sign.is_positive()),
                        CertainPlace::Outside => signs.iter().any(|sign| sign.is_negative()),
                        CertainPlace::Unknown => true,
                    };
                    assert!(holds, "{place:?} for {signs:?}, {v:?} in {f:?}, round {round}, {input:?}");
                    seen[place as usize] += 1;
                }
            }
        }
    }
    assert!(seen.into_iter().all(|count| count > 100), "{seen:?}");
}
