//! The springs of contacts that overlap, and what they can give a block when they are released.

use crate::overlaps::Overlaps;
use rayon::prelude::*;
use rockproof_model::{Block, Entrance, Number, Scene, ToleranceSet, VertexId};
use rockproof_oracle::audit::OverlapSeverity;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_simulate::f64_vector::{cross, dot, face_normal, length, minus, plus, point};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::ContactState;

/// The normal spring of a contact that overlaps.
#[derive(Clone, Debug, PartialEq)]
pub struct PressedSpring {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// In N/m.
    pub stiffness: f64,
    /// In m, above 0.
    pub depth: f64,
    /// Unit normal, from the second block to the first.
    pub normal: [f64; 3],
    /// Where it acts (m).
    pub at: [f64; 3],
    /// The whole force on the first block (N): with friction after settling, along the normal before.
    pub force: [f64; 3],
}

impl PressedSpring {
    /// What it stores (J).
    pub fn energy_j(&self) -> f64 {
        self.stiffness * self.depth * self.depth / 2.0
    }

    /// 1 for its first block, −1 for its second, which it pushes the other way.
    pub(crate) fn side(&self, block: usize) -> f64 {
        if self.blocks[0] == block { 1.0 } else { -1.0 }
    }

    /// What it pushes a block of its pair with (N), friction left out.
    pub(crate) fn push(&self, block: usize) -> [f64; 3] {
        self.normal.map(|n| n * self.side(block) * self.stiffness * self.depth)
    }
}

/// The springs of pairs that overlap and are held, as the blocks stand, from the exact contacts; joints have their stiffness. Pairs whose overlap uneven faces
/// excuse are among them: their contacts push as any.
pub(crate) fn at_start(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps) -> Vec<PressedSpring> {
    let held = overlaps.all().filter(|(overlap, severity)| match severity {
        OverlapSeverity::Lost => false,
        OverlapSeverity::Held => true,
        OverlapSeverity::Rounding => overlaps.is_excused_as_uneven(overlap),
    });
    let of_pair = |[a, b]: [usize; 2]| -> Vec<PressedSpring> {
        let shapes = [a, b].map(|block| &scene.blocks[block].block);
        let prepared = shapes.map(PreparedBlock::new);
        let pair = Pair::new(&prepared[0], &prepared[1]);
        let contacts = pair.classify(set).contacts;
        let pressed = contacts.iter().filter(|contact| contact.gap.is_negative());
        let spring = |entrance: &Entrance| {
            let depth = Number::from_rational(pair.gap(entrance).squared).approximate().sqrt();
            let (normal, at) = place(shapes, entrance);
            let stiffness = stiffness(scene, [a, b]);
            let force = normal.map(|n| n * stiffness * depth);
            PressedSpring { blocks: [a, b], stiffness, depth, normal, at, force }
        };
        pressed.map(|contact| spring(&contact.entrance)).collect()
    };
    let held: Vec<[usize; 2]> = held.map(|(overlap, _)| overlap.blocks).collect();
    held.into_par_iter().flat_map_iter(of_pair).collect()
}

/// The same of a state after settling, from the gaps and forces that its last step left.
pub(crate) fn after_settling<R: Real>(scene: &Scene, contacts: &[ContactState<R>]) -> Vec<PressedSpring> {
    let pressed = contacts.iter().filter(|contact| contact.mode.is_closed() && contact.gap.to_f64() < 0.0);
    let spring = |contact: &ContactState<R>| {
        let blocks = contact.blocks.map(|block| block as usize);
        let (normal, at, force) = (point(contact.normal), point(contact.points[0]), point(contact.force));
        PressedSpring { blocks, stiffness: stiffness(scene, blocks), depth: -contact.gap.to_f64(), normal, at, force }
    };
    pressed.map(spring).collect()
}

fn stiffness(scene: &Scene, blocks: [usize; 2]) -> f64 {
    let [one, other] = blocks.map(|block| scene.blocks[block].body.joint);
    let normal = &scene.simulation.joints.between(one, other).normal_stiffness;
    normal.as_ref().map_or(0.0, Number::approximate)
}

/// The unit normal of an entrance whose gap is negative, from B to A, and where it touches.
fn place([a, b]: [&Block; 2], entrance: &Entrance) -> ([f64; 3], [f64; 3]) {
    let (across, on_a, on_b) = match *entrance {
        Entrance::VertexFace(vertex, face) => {
            let face = b.topology().face(face);
            (face_normal(face, |corner| vertex_of(b, corner)), vertex_of(a, vertex), vertex_of(b, face[0]))
        }
        Entrance::FaceVertex(face, vertex) => {
            let face = a.topology().face(face);
            (face_normal(face, |corner| vertex_of(a, corner)), vertex_of(a, face[0]), vertex_of(b, vertex))
        }
        Entrance::EdgeEdge(edge_a, edge_b) => {
            let ends = |block: &Block, edge| {
                let edge = block.topology().edge(edge);
                [edge.p, edge.q].map(|vertex| vertex_of(block, vertex))
            };
            let ([from_a, to_a], [from_b, to_b]) = (ends(a, edge_a), ends(b, edge_b));
            let across = cross(minus(to_a, from_a), minus(to_b, from_b));
            (across, from_a, from_b)
        }
    };
    // Of the two directions across the plane that along which A is behind B: the gap is negative.
    let turn = if dot(across, minus(on_a, on_b)) > 0.0 { -1.0 } else { 1.0 };
    let length = length(across);
    let normal = across.map(|n| if length > 0.0 { turn * n / length } else { 0.0 });
    let at = match entrance {
        Entrance::FaceVertex(..) => on_b,
        _ => on_a,
    };
    (normal, at)
}

pub(crate) fn vertex_of(block: &Block, vertex: VertexId) -> [f64; 3] {
    block.vertices()[vertex.index()].components().map(Number::approximate)
}

/// The most of what the springs of a block store that they can give to its motion (J), the others held in place; `centroid` in m.
///
/// Springs that push against one another keep what they store. Along a unit direction u their resultant S = Σ p·d·n is resisted by K = Σ p·(n·u)², so for u
/// along S moving gives |S|²/(2K) ≤ Σ p·d²/2, equal where all push alike; likewise turning about the centroid, with the moments. The larger one counts.
pub(crate) fn released(springs: &[&PressedSpring], block: usize, centroid: [f64; 3]) -> f64 {
    let along = |vector: &dyn Fn(&PressedSpring) -> [f64; 3]| {
        let pushes = || springs.iter().map(|spring| (spring, vector(spring)));
        let weighted = || pushes().map(|(spring, arm)| arm.map(|x| x * spring.stiffness * spring.depth));
        let resultant = weighted().fold([0.0; 3], plus);
        let size = length(resultant);
        // What rounding leaves of forces that cancel is none.
        if size <= 1e-9 * weighted().map(length).sum::<f64>() {
            return 0.0;
        }
        let stiffness: f64 =
            pushes().map(|(spring, arm)| spring.stiffness * (dot(arm, resultant) / size).powi(2)).sum();
        size * size / (2.0 * stiffness)
    };
    let normal = |spring: &PressedSpring| spring.normal.map(|n| n * spring.side(block));
    let moving = along(&normal);
    let turning = along(&|spring: &PressedSpring| cross(minus(spring.at, centroid), normal(spring)));
    let stored: f64 = springs.iter().map(|spring| spring.energy_j()).sum();
    moving.max(turning).min(stored)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spring(depth: f64, normal: [f64; 3], at: [f64; 3]) -> PressedSpring {
        let stiffness = 2.0;
        PressedSpring { blocks: [3, 7], stiffness, depth, normal, at, force: normal.map(|n| n * stiffness * depth) }
    }

    #[test]
    fn springs_that_push_alike_give_all_and_those_that_push_apart_nothing() {
        let of = |springs: &[PressedSpring]| released(&springs.iter().collect::<Vec<_>>(), 3, [0.0; 3]);
        let up = [0.0, 0.0, 1.0];
        let floor = [spring(3.0, up, [1.0, 0.0, -1.0]), spring(3.0, up, [-1.0, 0.0, -1.0])];
        assert_eq!(of(&floor), 18.0);
        let [left, right] = [1.0, -1.0].map(|x| spring(3.0, [x, 0.0, 0.0], [-x, 0.0, 0.0]));
        assert_eq!(of(&[left.clone(), right.clone()]), 0.0);
        // One of them 1 m deeper: ends in the middle, 0.5 m off, where both together give 4/2 N/m · 0.25 m².
        let deeper = spring(4.0, [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        assert_eq!(of(&[deeper, right]), 0.5);
        // A couple turns: moments of 2 m · 6 N against 4 N·m, and gives all.
        let couple = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]].map(|n| spring(3.0, n, [-n[0], n[0], 0.0]));
        assert_eq!(of(&couple), 18.0);
    }
}
