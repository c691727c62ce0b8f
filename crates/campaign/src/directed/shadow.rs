//! The pair as f64 sees it: good enough to choose which features to aim at, never to decide anything.

use crate::families::Kit;
use rockproof_model::decision::Side;
use rockproof_model::number::split_f64;
use rockproof_model::{Block, Precision, number::power_of_two};
use std::rc::Rc;

/// A vector in f64.
pub(crate) type V = [f64; 3];

pub(crate) fn minus(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn plus(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn times(a: V, factor: f64) -> V {
    a.map(|c| c * factor)
}

pub(crate) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: V) -> f64 {
    dot(a, a).sqrt()
}

/// `a / |a|`; zero stays zero.
pub(crate) fn unit(a: V) -> V {
    let l = length(a);
    if l > 0.0 { times(a, 1.0 / l) } else { a }
}

/// One block in f64.
#[derive(Debug)]
struct Half {
    points: Vec<V>,
    normals: Vec<V>,
    centres: Vec<V>,
}

impl Half {
    fn of(block: &Block) -> Half {
        let points: Vec<V> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
        let faces = block.topology().faces();
        let normal = |f: &Vec<u32>| {
            let at = |k: usize| minus(points[f[k] as usize], points[f[0] as usize]);
            unit((1..f.len() - 1).map(|k| cross(at(k), at(k + 1))).fold([0.0; 3], plus))
        };
        let centre =
            |f: &Vec<u32>| times(f.iter().map(|&v| points[v as usize]).fold([0.0; 3], plus), 1.0 / f.len() as f64);
        Half { normals: faces.iter().map(normal).collect(), centres: faces.iter().map(centre).collect(), points }
    }
}

/// Both blocks in f64.
#[derive(Debug)]
pub(crate) struct Shadow<'p> {
    pub(crate) a: &'p Block,
    pub(crate) b: &'p Block,
    halves: Rc<[Half; 2]>,
    magnitude: f64,
    /// How far B has been moved.
    shift: V,
}

/// How many features are drawn for each one chosen.
const DRAWS: usize = 16;

impl<'p> Shadow<'p> {
    pub(crate) fn of(a: &'p Block, b: &'p Block) -> Shadow<'p> {
        let halves = [Half::of(a), Half::of(b)];
        let magnitude = halves.iter().flat_map(|h| h.points.iter().flatten()).fold(0.0f64, |m, c| m.max(c.abs()));
        Shadow { a, b, halves: Rc::new(halves), magnitude, shift: [0.0; 3] }
    }

    /// The pair with B moved.
    pub(crate) fn moved(&self, shift: V) -> Shadow<'p> {
        Shadow { halves: Rc::clone(&self.halves), shift, ..*self }
    }

    fn placed(&self, side: Side, point: V) -> V {
        if side == Side::B { plus(point, self.shift) } else { point }
    }

    fn half(&self, side: Side) -> &Half {
        &self.halves[side as usize]
    }

    pub(crate) fn block(&self, side: Side) -> &'p Block {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    pub(crate) fn vertex(&self, side: Side, vertex: u32) -> V {
        self.placed(side, self.half(side).points[vertex as usize])
    }

    /// Unit outward normal.
    pub(crate) fn normal(&self, side: Side, face: u32) -> V {
        self.half(side).normals[face as usize]
    }

    pub(crate) fn centre(&self, side: Side, face: u32) -> V {
        self.placed(side, self.half(side).centres[face as usize])
    }

    /// Start and direction of an edge.
    pub(crate) fn edge(&self, side: Side, edge: u32) -> (V, V) {
        let e = self.block(side).topology().edges()[edge as usize];
        let p = self.vertex(side, e.p);
        (p, minus(self.vertex(side, e.q), p))
    }

    /// The spacing of the precision's numbers at the pair's largest coordinate. Offsets that are multiples of it keep
    /// the coordinates as short as they were.
    pub(crate) fn quantum(&self, precision: Precision) -> f64 {
        quantum(self.magnitude, precision)
    }

    /// `vector` rounded to multiples of the quantum.
    pub(crate) fn on_grid(&self, vector: V, precision: Precision) -> V {
        let q = self.quantum(precision);
        vector.map(|c| (c / q).round() * q)
    }

    /// The gap of a vertex and a face of the other block, and how far its foot is outside the face (0 inside).
    pub(crate) fn above_face(&self, side: Side, vertex: u32, face: u32) -> (f64, f64) {
        let other = side.other();
        let (x, n) = (self.vertex(side, vertex), self.normal(other, face));
        let gap = dot(n, minus(x, self.centre(other, face)));
        let corners = &self.block(other).topology().faces()[face as usize];
        let inside = (0..corners.len()).map(|k| self.inside_side(x, other, face, k)).fold(f64::INFINITY, f64::min);
        (gap, -inside.min(0.0))
    }

    /// How far inside side `k` of a face of `other` a point is.
    pub(crate) fn inside_side(&self, point: V, other: Side, face: u32, k: usize) -> f64 {
        let corners = &self.block(other).topology().faces()[face as usize];
        let p = self.vertex(other, corners[k]);
        let q = self.vertex(other, corners[(k + 1) % corners.len()]);
        dot(minus(point, p), unit(cross(self.normal(other, face), minus(q, p))))
    }

    /// A near vertex of `side` and face of the other block.
    pub(crate) fn vertex_face(&self, kit: &mut Kit<'_>, side: Side) -> (u32, u32) {
        let vertices = self.block(side).vertices().len() as u64;
        let faces = self.block(side.other()).topology().faces().len() as u64;
        self.nearest(
            kit,
            |kit| Some((kit.below(vertices) as u32, kit.below(faces) as u32)),
            |&(v, f)| {
                let (gap, outside) = self.above_face(side, v, f);
                gap.abs() + outside
            },
        )
        .unwrap_or((0, 0))
    }

    /// Near convex vertices of A and B.
    pub(crate) fn vertex_vertex(&self, kit: &mut Kit<'_>) -> Option<(u32, u32)> {
        let draw = |kit: &mut Kit<'_>| Some((convex_vertex(kit, self.a)?, convex_vertex(kit, self.b)?));
        self.nearest(kit, draw, |&(a, b)| length(minus(self.vertex(Side::A, a), self.vertex(Side::B, b))))
    }

    /// Where along an edge the foot of a vertex of the other block is (0 to 1 inside), and how far away the vertex is.
    pub(crate) fn foot(&self, side: Side, vertex: u32, edge: u32) -> (f64, f64) {
        let (p, d) = self.edge(side.other(), edge);
        let x = minus(self.vertex(side, vertex), p);
        let along = dot(x, d) / dot(d, d);
        (along, length(minus(x, times(d, along))))
    }

    /// A near convex vertex of `side` and convex edge of the other block.
    pub(crate) fn vertex_edge(&self, kit: &mut Kit<'_>, side: Side) -> Option<(u32, u32)> {
        let other = self.block(side.other());
        let draw = |kit: &mut Kit<'_>| Some((convex_vertex(kit, self.block(side))?, convex_edge(kit, other)?));
        self.nearest(kit, draw, |&(v, e)| {
            let (along, distance) = self.foot(side, v, e);
            let (_, d) = self.edge(side.other(), e);
            distance + (-along).max(along - 1.0).max(0.0) * length(d)
        })
    }

    /// Where the feet of the common perpendicular are along the edges (0 to 1 inside), and how far apart they are.
    /// `None` for parallel edges.
    pub(crate) fn feet(&self, a: u32, b: u32) -> Option<(f64, f64, f64)> {
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
    pub(crate) fn edge_edge(&self, kit: &mut Kit<'_>) -> Option<(u32, u32)> {
        let draw = |kit: &mut Kit<'_>| {
            let pair = (convex_edge(kit, self.a)?, convex_edge(kit, self.b)?);
            self.feet(pair.0, pair.1).map(|_| pair)
        };
        self.nearest(kit, draw, |&(a, b)| {
            let Some((s, t, apart)) = self.feet(a, b) else { return f64::INFINITY };
            let beyond = |x: f64| (-x).max(x - 1.0).max(0.0);
            let (_, d) = self.edge(Side::A, a);
            let (_, e) = self.edge(Side::B, b);
            apart + beyond(s) * length(d) + beyond(t) * length(e)
        })
    }

    fn nearest<T>(
        &self,
        kit: &mut Kit<'_>,
        draw: impl Fn(&mut Kit<'_>) -> Option<T>,
        distance: impl Fn(&T) -> f64,
    ) -> Option<T> {
        let mut best: Option<(f64, T)> = None;
        for _ in 0..DRAWS {
            let Some(drawn) = draw(kit) else { continue };
            let d = distance(&drawn);
            if best.as_ref().is_none_or(|(least, _)| d < *least) {
                best = Some((d, drawn));
            }
        }
        best.map(|(_, drawn)| drawn)
    }
}

/// The spacing of the precision's numbers at `magnitude`.
pub(crate) fn quantum(magnitude: f64, precision: Precision) -> f64 {
    let (significand, exponent) = split_f64(magnitude);
    let top = exponent + 63 - (significand.unsigned_abs().max(1)).leading_zeros() as i32;
    power_of_two((top + 1 - precision.digits() as i32).clamp(-1000, 1000))
}

fn convex_vertex(kit: &mut Kit<'_>, block: &Block) -> Option<u32> {
    let vertex = kit.below(block.vertices().len() as u64) as u32;
    block.vertex_is_convex(vertex).then_some(vertex)
}

fn convex_edge(kit: &mut Kit<'_>, block: &Block) -> Option<u32> {
    let edge = kit.below(block.topology().edges().len() as u64) as u32;
    block.edge_is_convex(edge).then_some(edge)
}
