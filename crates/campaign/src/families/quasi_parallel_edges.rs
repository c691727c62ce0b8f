//! Two ridges that are almost parallel.

use super::edge_cross::{crossing_ridges, keel, ridge};
use super::{Family, PairSampler};
use crate::shapes::RationalRotation;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct QuasiParallelEdges;

impl Family for QuasiParallelEdges {
    fn name(&self) -> &'static str {
        "quasi_parallel_edges"
    }

    fn describe(&self) -> &'static str {
        "a ridge along the keel of another block, turned by nothing, by some degrees around the parallel angle, or by far less"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexEdge, ContactKind::EdgeVertex, ContactKind::EdgeEdge]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::new(rng);
        let below = ridge(&mut sampler);
        let along = keel(&mut sampler);
        // The angle is 2·atan(1/n): 3 degrees are n = 38; the length rule of `revised` bites at some n of hundreds.
        let n = match sampler.below(8) {
            0 | 1 => None,
            2 | 3 => Some(sampler.between(30, 48)),
            4 => Some(sampler.between(3, 30)),
            5 => Some(sampler.between(100, 1000)),
            6 => Some(1 << sampler.between(5, 12)),
            _ => Some(1 << sampler.between(12, 24)),
        };
        let above = match n {
            None => along,
            Some(n) => {
                let sideways = sampler.sign() as i64;
                let quaternion =
                    if sampler.chance(75) { [n as i64, 0, 0, sideways] } else { [n as i64, 0, sideways, 0] };
                sampler.turned_by(&along, RationalRotation::from_quaternion(quaternion))
            }
        };
        let (a, b) = crossing_ridges(&mut sampler, &below, &above);
        sampler.finish(a, b)
    }
}
