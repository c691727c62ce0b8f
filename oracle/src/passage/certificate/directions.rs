//! The directions that are tried to part two convex parts: f64 chooses among the normals of faces and the cross products of
//! edges, and what is chosen is made exactly when it is asked for.

use super::{ConvexPart, Ends, LatticePoint, PartsAtEnds, float};
use crate::f64_vector::{cross, dot};
use num_bigint::BigInt;
use rockproof_model::VertexId;
use rockproof_model::block::face_normal;
use std::cell::OnceCell;

/// How many of the best directions are tried exactly.
pub(super) const TRIED_DIRECTIONS: usize = 4;

/// A direction and how it was found to do.
pub(super) struct Candidate<'e> {
    ends: &'e PartsAtEnds<'e>,
    source: Source,
    exact: OnceCell<LatticePoint>,
    /// The gap along it, the lesser one of both ends, over its length: an f64 without a bound.
    pub(super) gap: f64,
}

impl Candidate<'_> {
    /// The direction, exactly.
    pub(super) fn n(&self) -> &LatticePoint {
        self.exact.get_or_init(|| self.source.exactly(self.ends))
    }
}

/// The vertices of a part at one end, as f64 has them.
type Points = Vec<[f64; 3]>;

/// What f64 has of a part at both ends, made once for all parts that it is held against.
pub(super) struct NearPart {
    points: [Points; 2],
    /// Directions of the edges.
    edges: [Vec<[f64; 3]>; 2],
    /// Normals of the faces, of any length.
    normals: [Vec<[f64; 3]>; 2],
}

impl NearPart {
    /// A part of A (0) or B (1).
    pub(super) fn new(part: &ConvexPart, side: usize, ends: &Ends) -> NearPart {
        let edge = |end: usize, [p, q]: [VertexId; 2]| {
            if part.is_rough {
                return ends.near_way(end, side, [p, q]);
            }
            let [p, q] = [p, q].map(|v| &ends.places[end][side][v.index()]);
            direction(q.minus(p).components())
        };
        let normal = |end: usize, face: &[VertexId]| {
            if part.is_rough {
                let way = |k: usize| ends.near_way(end, side, [face[0], face[k]]);
                return cross(way(1), way(2));
            }
            direction(face_normal(&ends.places[end][side], face).components())
        };
        NearPart {
            points: [0, 1].map(|end| part.vertices.iter().map(|v| ends.near[end][side][v.index()]).collect()),
            edges: [0, 1].map(|end| part.edges.iter().map(|vertices| edge(end, *vertices)).collect()),
            normals: [0, 1].map(|end| part.faces.iter().map(|face| normal(end, face)).collect()),
        }
    }
}

/// The gap at one end along n and along its opposite, times their length.
fn gaps(n: [f64; 3], end: usize, [a, b]: [&NearPart; 2]) -> [f64; 2] {
    let reach = |points: &Points| {
        points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            let along = dot(n, *p);
            [low.min(along), high.max(along)]
        })
    };
    let ([low_a, high_a], [low_b, high_b]) = (reach(&a.points[end]), reach(&b.points[end]));
    [low_a - high_b, low_b - high_a]
}

impl PartsAtEnds<'_> {
    /// The directions with the largest gaps by f64, the largest first: normals of faces and cross products of edges, as they
    /// are at either end.
    pub(super) fn best_directions(&self, near: [&NearPart; 2]) -> Vec<Candidate<'_>> {
        let mut best: Vec<(f64, Source)> = Vec::new();
        for source in self.sources() {
            let n = source.near(near);
            let length = dot(n, n).sqrt();
            let is_worse = |best: &[(f64, Source)], gap: f64| {
                best.len() == TRIED_DIRECTIONS && gap <= best[TRIED_DIRECTIONS - 1].0
            };
            // The gap at one end bounds the lesser of both.
            let first = gaps(n, 0, near);
            if first.iter().all(|gap| is_worse(&best, gap / length)) {
                continue;
            }
            let second = gaps(n, 1, near);
            for is_reversed in [false, true] {
                let gap = first[usize::from(is_reversed)].min(second[usize::from(is_reversed)]) / length;
                if gap.is_nan() || is_worse(&best, gap) {
                    continue;
                }
                let place = best.partition_point(|(other, _)| *other >= gap);
                best.insert(place, (gap, Source { is_reversed, ..source }));
                best.truncate(TRIED_DIRECTIONS);
            }
        }
        let candidate = |(gap, source)| Candidate { ends: self, source, exact: OnceCell::new(), gap };
        best.into_iter().map(candidate).collect()
    }

    pub(super) fn sources(&self) -> impl Iterator<Item = Source> {
        let [faces_a, faces_b] = self.parts.map(|part| part.faces.len());
        let [edges_a, edges_b] = self.parts.map(|part| part.edges.len());
        let a = (0..faces_a).map(|f| Features::Face(0, f));
        let b = (0..faces_b).map(|f| Features::Face(1, f));
        let edges = (0..edges_a).flat_map(move |i| (0..edges_b).map(move |j| Features::Edges(i, j)));
        a.chain(b).chain(edges).flat_map(|features| [0, 1].map(|end| Source { features, end, is_reversed: false }))
    }
}

/// Where a direction comes from.
#[derive(Clone, Copy)]
pub(super) struct Source {
    pub(super) features: Features,
    /// The end of the interval at which the features are looked at.
    pub(super) end: usize,
    pub(super) is_reversed: bool,
}

#[derive(Clone, Copy)]
pub(super) enum Features {
    /// The normal of a face of A (0) or B (1).
    Face(usize, usize),
    /// The cross product of an edge of each.
    Edges(usize, usize),
}

impl Source {
    pub(super) fn exactly(self, ends: &PartsAtEnds<'_>) -> LatticePoint {
        let n = match self.features {
            Features::Face(side, face) => face_normal(&ends.ends.places[self.end][side], &ends.parts[side].faces[face]),
            Features::Edges(one, two) => ends.edge(self.end, 0, one).cross(&ends.edge(self.end, 1, two)),
        };
        if self.is_reversed { n.negated() } else { n }
    }

    /// The direction in f64, of any length.
    fn near(self, near: [&NearPart; 2]) -> [f64; 3] {
        match self.features {
            Features::Edges(one, two) => cross(near[0].edges[self.end][one], near[1].edges[self.end][two]),
            Features::Face(side, face) => near[side].normals[self.end][face],
        }
    }
}

/// A direction in f64, divided by a power of two so that no product of its components leaves the range of f64.
pub(super) fn direction([x, y, z]: [&BigInt; 3]) -> [f64; 3] {
    let shift = [x, y, z].iter().map(|c| c.bits()).max().unwrap_or(0).saturating_sub(64);
    [x, y, z].map(|c| float(&(c >> shift)))
}
