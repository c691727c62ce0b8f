//! Reflex edges on which another block lies without a contact: SPEC's rules give none there, whatever presses the blocks together.

use crate::overlaps::Overlaps;
use num_rational::BigRational;
use num_traits::Signed;
use rayon::prelude::*;
use rockproof_model::block::Point;
use rockproof_model::decision::{Feature, Side};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Block, Number, Scene, ToleranceSet, Vec3, VertexId};
use rockproof_oracle::{Pair, PreparedBlock};
use serde_json::{Value, json};

/// A reflex edge on which another block lies, or which lies on an edge of another block, without a contact.
///
/// A vertex of a block on the edge p–q of another one could have a contact by v-f, v-e or v-v (SPEC section 4). For v-f it must project strictly inside a face, and the edge bounds both of its faces;
/// v-e needs a convex edge and v-v a convex vertex, and this edge and its ends are neither. Likewise an end of the edge that lies on an edge of the other block: it is no convex vertex, so there is
/// neither v-v nor v-e, and it projects onto the boundary of both faces at that edge. Edges make contacts with one another where both are convex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BareEdge {
    /// The block that has the reflex edge.
    pub block: usize,
    /// The ends of the edge.
    pub edge: [VertexId; 2],
    /// The block that lies on it.
    pub other: usize,
}

impl BareEdge {
    /// What is wrong, without figures.
    pub const TITLE: &str = "a block lies on a reflex edge of another one, where SPEC's rules give no contact";
    /// Why there is none.
    pub const REASON: &str = "a vertex touches a face only strictly inside it, and of edges and vertices only convex ones: what presses the blocks together there is not borne";

    /// Which edge, and what lies on it.
    pub fn sentence(&self, scene: &Scene) -> String {
        let [p, q] = self.edge;
        let [block, other] = [self.block, self.other].map(|block| named(block, scene));
        format!("{other} lies on the reflex edge {p}-{q} of {block}, and SPEC's rules give no contact there")
    }

    /// What mends it.
    pub fn remedy(&self, scene: &Scene) -> String {
        format!("{} split along this edge into convex blocks", named(self.block, scene))
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({ "block": self.block, "edge": self.edge, "other": self.other })
    }
}

fn named(block: usize, scene: &Scene) -> String {
    match scene.own_name(block) {
        Some(name) => format!("block {block} ({})", excerpt(name, EXCERPT_LENGTH)),
        None => format!("block {block}"),
    }
}

/// The reflex edges of a scene on which another block lies without a contact, in the order of pairs; `overlaps` names the neighbouring pairs. Lying on it means within `territory`, as a vertex then counts as on a
/// convex edge. Compared exactly; pairs of convex blocks and pairs of fixed ones are not looked at.
pub fn bare_edges(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps) -> Vec<BareEdge> {
    let may_be_bare = |pair: &&[usize; 2]| {
        pair.iter().any(|&block| !scene.blocks[block].block.is_convex())
            && pair.iter().any(|&block| !scene.blocks[block].body.is_fixed())
    };
    let pairs: Vec<[usize; 2]> = overlaps.neighbours().iter().filter(may_be_bare).copied().collect();
    pairs.into_par_iter().flat_map_iter(|pair| of_pair(scene, set, pair)).collect()
}

fn of_pair(scene: &Scene, set: &ToleranceSet, [a, b]: [usize; 2]) -> Vec<BareEdge> {
    let shapes = [a, b].map(|block| &scene.blocks[block].block);
    let within = set.territory.to_rational();
    let mut at = at_edges(shapes, [a, b], [Side::A, Side::B], &within);
    at.extend(at_edges([shapes[1], shapes[0]], [b, a], [Side::B, Side::A], &within));
    if at.is_empty() {
        return Vec::new();
    }
    let prepared = shapes.map(PreparedBlock::new);
    let contacts = Pair::new(&prepared[0], &prepared[1]).classify(set).contacts;
    let touches = |vertex: &Feature| contacts.iter().any(|contact| contact.key.features().contains(vertex));
    let mut bare: Vec<BareEdge> = at.into_iter().filter(|(_, vertex)| !touches(vertex)).map(|(edge, _)| edge).collect();
    bare.dedup();
    bare
}

/// The reflex edges of the first of two blocks at which vertices of the second lie, and those whose ends lie at edges of the second, each with that vertex.
fn at_edges(
    [owner, second]: [&Block; 2],
    [block, other]: [usize; 2],
    [own_side, side]: [Side; 2],
    within: &BigRational,
) -> Vec<(BareEdge, Feature)> {
    let at = |shape: &'_ Block, vertex: VertexId| shape.vertices()[vertex.index()].clone();
    let mut found = Vec::new();
    for edge in owner.topology().edge_ids().filter(|&edge| !owner.edge_is_convex(edge)) {
        let edge = owner.topology().edge(edge);
        let bare = BareEdge { block, edge: [edge.p, edge.q], other };
        let ends = bare.edge.map(|end| at(owner, end));
        for vertex in second.topology().vertex_ids() {
            if is_within(&at(second, vertex), &ends, within) {
                found.push((bare.clone(), Feature::Vertex(side, vertex)));
            }
        }
        for end in bare.edge {
            let point = at(owner, end);
            let mut edges = second.topology().edges().iter();
            if edges.any(|edge| is_within(&point, &[edge.p, edge.q].map(|end| at(second, end)), within)) {
                found.push((bare.clone(), Feature::Vertex(own_side, end)));
            }
        }
    }
    found
}

/// Whether a point is no further from a stretch than a distance; exactly so far is. In f64 first, by which most points are further off.
fn is_within(point: &Point, [p, q]: &[Point; 2], distance: &BigRational) -> bool {
    let near = |at: &Point| at.components().map(Number::approximate);
    let limit = Number::from_rational(distance.clone()).approximate();
    let (at, ends) = (near(point), [near(p), near(q)]);
    // Roundings of these are a few parts in 2⁵³ of the coordinates.
    let is_apart = |k: usize| {
        let [low, high] = [ends[0][k].min(ends[1][k]), ends[0][k].max(ends[1][k])];
        let slack = limit + 1e-12 * (limit + at[k].abs() + low.abs() + high.abs());
        at[k] < low - slack || at[k] > high + slack
    };
    if (0..3).any(is_apart) {
        return false;
    }
    let [at, p, q]: [Vec3<BigRational>; 3] = [point, p, q].map(|at| at.map(Number::to_rational));
    let (along, from_p) = (q.minus(&p), at.minus(&p));
    let (foot, length_squared) = (along.dot(&from_p), along.norm_squared());
    let limit_squared = distance * distance;
    if !foot.is_positive() {
        from_p.norm_squared() <= limit_squared
    } else if foot >= length_squared {
        at.minus(&q).norm_squared() <= limit_squared
    } else {
        from_p.cross(&along).norm_squared() <= limit_squared * length_squared
    }
}
