//! The pair as f64 sees it: good enough to choose which features to aim at, never to decide anything.

use super::remembered::Remembered;
use crate::families::PairSampler;
use rockproof_model::decision::Side;
use rockproof_model::number::split_f64;
use rockproof_model::{Block, EdgeId, FaceId, Precision, VertexId, number::power_of_two};
use std::rc::Rc;

/// A vector in f64.
pub(crate) type F64Vector = [f64; 3];

pub(crate) fn minus(a: F64Vector, b: F64Vector) -> F64Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn plus(a: F64Vector, b: F64Vector) -> F64Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn times(a: F64Vector, factor: f64) -> F64Vector {
    a.map(|c| c * factor)
}

pub(crate) fn dot(a: F64Vector, b: F64Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: F64Vector, b: F64Vector) -> F64Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: F64Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a / |a|`; zero stays zero.
pub(crate) fn unit(a: F64Vector) -> F64Vector {
    let l = length(a);
    if l > 0.0 { times(a, 1.0 / l) } else { a }
}

/// One block in f64.
#[derive(Debug)]
struct F64Block {
    points: Vec<F64Vector>,
    normals: Vec<F64Vector>,
    centres: Vec<F64Vector>,
}

impl F64Block {
    fn of(block: &Block) -> F64Block {
        let points: Vec<F64Vector> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
        let faces = block.topology().faces();
        let normal = |f: &Vec<VertexId>| {
            let at = |k: usize| minus(points[f[k].index()], points[f[0].index()]);
            unit((1..f.len() - 1).map(|k| cross(at(k), at(k + 1))).fold([0.0; 3], plus))
        };
        let centre =
            |f: &Vec<VertexId>| times(f.iter().map(|&v| points[v.index()]).fold([0.0; 3], plus), 1.0 / f.len() as f64);
        F64Block { normals: faces.iter().map(normal).collect(), centres: faces.iter().map(centre).collect(), points }
    }
}

/// Both blocks in f64.
#[derive(Debug)]
pub(crate) struct F64View<'p> {
    pub(crate) a: &'p Block,
    pub(crate) b: &'p Block,
    halves: Rc<[F64Block; 2]>,
    magnitude: f64,
    /// How far B has been moved.
    shift: F64Vector,
    distances: Distances,
}

/// How far apart features are, by their numbers; `None` of what is not to be chosen.
type Known = Remembered<Option<f64>>;

/// What is known of distances; where a feature of either side can be the first, of A's and of B's.
#[derive(Debug)]
struct Distances {
    vertex_vertex: Known,
    vertex_edge: [Known; 2],
    vertex_face: [Known; 2],
    edge_edge: Known,
}

impl Distances {
    /// Nothing yet.
    fn new(a: &Block, b: &Block) -> Distances {
        let vertices = |block: &Block| block.vertices().len();
        let edges = |block: &Block| block.topology().edges().len();
        let faces = |block: &Block| block.topology().faces().len();
        Distances {
            vertex_vertex: Known::new(vertices(a), vertices(b)),
            vertex_edge: [Known::new(vertices(a), edges(b)), Known::new(vertices(b), edges(a))],
            vertex_face: [Known::new(vertices(a), faces(b)), Known::new(vertices(b), faces(a))],
            edge_edge: Known::new(edges(a), edges(b)),
        }
    }
}

/// How many features are drawn for each one chosen.
const DRAWS: usize = 16;

impl<'p> F64View<'p> {
    pub(crate) fn of(a: &'p Block, b: &'p Block) -> F64View<'p> {
        let halves = [F64Block::of(a), F64Block::of(b)];
        let magnitude = halves.iter().flat_map(|h| h.points.iter().flatten()).fold(0.0f64, |m, c| m.max(c.abs()));
        F64View { a, b, halves: Rc::new(halves), magnitude, shift: [0.0; 3], distances: Distances::new(a, b) }
    }

    /// The pair with B moved.
    pub(crate) fn moved(&self, shift: F64Vector) -> F64View<'p> {
        F64View { halves: Rc::clone(&self.halves), shift, distances: Distances::new(self.a, self.b), ..*self }
    }

    fn placed(&self, side: Side, point: F64Vector) -> F64Vector {
        if side == Side::B { plus(point, self.shift) } else { point }
    }

    fn half(&self, side: Side) -> &F64Block {
        &self.halves[side as usize]
    }

    pub(crate) fn block(&self, side: Side) -> &'p Block {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    pub(crate) fn vertex(&self, side: Side, vertex: VertexId) -> F64Vector {
        self.placed(side, self.half(side).points[vertex.index()])
    }

    /// Unit outward normal.
    pub(crate) fn normal(&self, side: Side, face: FaceId) -> F64Vector {
        self.half(side).normals[face.index()]
    }

    pub(crate) fn centre(&self, side: Side, face: FaceId) -> F64Vector {
        self.placed(side, self.half(side).centres[face.index()])
    }

    /// Start and direction of an edge.
    pub(crate) fn edge(&self, side: Side, edge: EdgeId) -> (F64Vector, F64Vector) {
        let e = self.block(side).topology().edge(edge);
        let p = self.vertex(side, e.p);
        (p, minus(self.vertex(side, e.q), p))
    }

    /// The spacing of the precision's numbers at the pair's largest coordinate. Offsets that are multiples of it keep
    /// the coordinates as short as they were.
    pub(crate) fn quantum(&self, precision: Precision) -> f64 {
        quantum(self.magnitude, precision)
    }

    /// `vector` rounded to multiples of the quantum.
    pub(crate) fn on_grid(&self, vector: F64Vector, precision: Precision) -> F64Vector {
        let q = self.quantum(precision);
        vector.map(|c| (c / q).round() * q)
    }

    /// The gap of a vertex and a face of the other block, and how far its foot is outside the face (0 inside).
    pub(crate) fn above_face(&self, side: Side, vertex: VertexId, face: FaceId) -> (f64, f64) {
        let other = side.other();
        let (x, n) = (self.vertex(side, vertex), self.normal(other, face));
        let gap = dot(n, minus(x, self.centre(other, face)));
        let corners = self.block(other).topology().face(face);
        let inside = (0..corners.len()).map(|k| self.inside_side(x, other, face, k)).fold(f64::INFINITY, f64::min);
        (gap, -inside.min(0.0))
    }

    /// How far inside side `k` of a face of `other` a point is.
    pub(crate) fn inside_side(&self, point: F64Vector, other: Side, face: FaceId, k: usize) -> f64 {
        let corners = self.block(other).topology().face(face);
        let p = self.vertex(other, corners[k]);
        let q = self.vertex(other, corners[(k + 1) % corners.len()]);
        dot(minus(point, p), unit(cross(self.normal(other, face), minus(q, p))))
    }

    /// A near vertex of `side` and face of the other block.
    pub(crate) fn vertex_face(&self, sampler: &mut PairSampler<'_>, side: Side) -> (VertexId, FaceId) {
        let vertices = self.block(side).vertices().len() as u64;
        let faces = self.block(side.other()).topology().faces().len() as u64;
        let known = &self.distances.vertex_face[side as usize];
        let draw = |sampler: &mut PairSampler<'_>| Some((sampler.below(vertices) as u32, sampler.below(faces) as u32));
        let nearest = nearest(sampler, known, draw, |v, f| {
            let (gap, outside) = self.above_face(side, VertexId(v), FaceId(f));
            Some(gap.abs() + outside)
        });
        nearest.map_or((VertexId(0), FaceId(0)), |(v, f)| (VertexId(v), FaceId(f)))
    }

    /// Near convex vertices of A and B.
    pub(crate) fn vertex_vertex(&self, sampler: &mut PairSampler<'_>) -> Option<(VertexId, VertexId)> {
        let draw =
            |sampler: &mut PairSampler<'_>| Some((convex_vertex(sampler, self.a)?, convex_vertex(sampler, self.b)?));
        let nearest = nearest(sampler, &self.distances.vertex_vertex, draw, |a, b| {
            Some(length(minus(self.vertex(Side::A, VertexId(a)), self.vertex(Side::B, VertexId(b)))))
        });
        nearest.map(|(a, b)| (VertexId(a), VertexId(b)))
    }

    /// Where along an edge the foot of a vertex of the other block is (0 to 1 inside), and how far away the vertex is.
    pub(crate) fn foot(&self, side: Side, vertex: VertexId, edge: EdgeId) -> (f64, f64) {
        let (p, d) = self.edge(side.other(), edge);
        let x = minus(self.vertex(side, vertex), p);
        let along = dot(x, d) / dot(d, d);
        (along, length(minus(x, times(d, along))))
    }

    /// A near convex vertex of `side` and convex edge of the other block.
    pub(crate) fn vertex_edge(&self, sampler: &mut PairSampler<'_>, side: Side) -> Option<(VertexId, EdgeId)> {
        let other = self.block(side.other());
        let draw = |sampler: &mut PairSampler<'_>| {
            Some((convex_vertex(sampler, self.block(side))?, convex_edge(sampler, other)?))
        };
        let nearest = nearest(sampler, &self.distances.vertex_edge[side as usize], draw, |v, e| {
            let (along, distance) = self.foot(side, VertexId(v), EdgeId(e));
            let (_, d) = self.edge(side.other(), EdgeId(e));
            Some(distance + (-along).max(along - 1.0).max(0.0) * length(d))
        });
        nearest.map(|(v, e)| (VertexId(v), EdgeId(e)))
    }

    /// Where the feet of the common perpendicular are along the edges (0 to 1 inside), and how far apart they are.
    /// `None` for parallel edges.
    pub(crate) fn feet(&self, a: EdgeId, b: EdgeId) -> Option<(f64, f64, f64)> {
        let ((p, d), (q, e)) = (self.edge(Side::A, a), self.edge(Side::B, b));
        let n = cross(d, e);
        let nn = dot(n, n);
        if nn <= 1e-12 * dot(d, d) * dot(e, e) {
            return None;
        }
        let pq = minus(q, p);
        Some((dot(cross(pq, e), n) / nn, dot(cross(pq, d), n) / nn, dot(pq, n).abs() / nn.sqrt()))
    }

    /// Near convex edges that are not parallel.
    pub(crate) fn edge_edge(&self, sampler: &mut PairSampler<'_>) -> Option<(EdgeId, EdgeId)> {
        let draw = |sampler: &mut PairSampler<'_>| Some((convex_edge(sampler, self.a)?, convex_edge(sampler, self.b)?));
        let nearest = nearest(sampler, &self.distances.edge_edge, draw, |a, b| {
            let (a, b) = (EdgeId(a), EdgeId(b));
            let (s, t, apart) = self.feet(a, b)?;
            let beyond = |x: f64| (-x).max(x - 1.0).max(0.0);
            let (_, d) = self.edge(Side::A, a);
            let (_, e) = self.edge(Side::B, b);
            Some(apart + beyond(s) * length(d) + beyond(t) * length(e))
        });
        nearest.map(|(a, b)| (EdgeId(a), EdgeId(b)))
    }
}

/// The nearest of some drawn features, of equally near ones the first, by their numbers.
fn nearest(
    sampler: &mut PairSampler<'_>,
    known: &Known,
    draw: impl Fn(&mut PairSampler<'_>) -> Option<(u32, u32)>,
    distance: impl Fn(u32, u32) -> Option<f64>,
) -> Option<(u32, u32)> {
    let mut best: Option<(f64, (u32, u32))> = None;
    // Hand-counted: this crate is compiled with little optimisation, and a range would cost as much as a draw.
    let mut left = DRAWS;
    while left > 0 {
        left -= 1;
        let Some((one, other)) = draw(sampler) else { continue };
        let Some(d) = known.get(one as usize, other as usize, || distance(one, other)) else { continue };
        if best.as_ref().is_none_or(|(least, _)| d < *least) {
            best = Some((d, (one, other)));
        }
    }
    best.map(|(_, drawn)| drawn)
}

/// The spacing of the precision's numbers at `magnitude`.
pub(crate) fn quantum(magnitude: f64, precision: Precision) -> f64 {
    let (significand, exponent) = split_f64(magnitude);
    let top = exponent + 63 - (significand.unsigned_abs().max(1)).leading_zeros() as i32;
    power_of_two((top + 1 - precision.digits() as i32).clamp(-1000, 1000))
}

fn convex_vertex(sampler: &mut PairSampler<'_>, block: &Block) -> Option<u32> {
    let vertex = sampler.below(block.vertices().len() as u64) as u32;
    block.vertex_is_convex(VertexId(vertex)).then_some(vertex)
}

fn convex_edge(sampler: &mut PairSampler<'_>, block: &Block) -> Option<u32> {
    let edge = sampler.below(block.topology().edges().len() as u64) as u32;
    block.edge_is_convex(EdgeId(edge)).then_some(edge)
}
