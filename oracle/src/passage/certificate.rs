//! The certificate that an interval of time is free.

mod directions;
#[cfg(test)]
mod tests;

use super::motion::MovingPair;
use crate::f64_vector::dot;
use crate::point_in_surface::{triangle_corners, triangles};
use directions::{Candidate, NearPart, direction};
use num_bigint::BigInt;
use num_traits::{Signed, ToPrimitive, Zero};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Vec3, VertexId};
use std::cell::OnceCell;

type LatticePoint = Vec3<BigInt>;

/// Certifies intervals for two moving blocks.
pub(super) struct Certificate<'m, 'b> {
    moving: &'m MovingPair<'b>,
    /// The hull of each block as a part.
    hulls: [ConvexPart; 2],
    /// Each block's convex parts, made when they are first asked for; of a convex block its hull.
    parts: OnceCell<[Vec<ConvexPart>; 2]>,
}

/// A convex part of a block by the numbers of its vertices.
struct ConvexPart {
    vertices: Vec<VertexId>,
    /// Loops whose normals are tried.
    faces: Vec<Vec<VertexId>>,
    /// Pairs of vertices whose cross products with the other part's are tried.
    edges: Vec<[VertexId; 2]>,
    /// Whether directions are compared as f64 has the vertices, as there are many parts, and not as rounded from the exact ones.
    is_rough: bool,
}

/// Both blocks at the start and at the end of an interval.
struct Ends {
    places: [[Vec<LatticePoint>; 2]; 2],
    /// The places as seen from the first of all, rounded.
    near: [[Vec<[f64; 3]>; 2]; 2],
    /// No coordinate of `near` is larger.
    size: f64,
}

/// Two convex parts at both ends of an interval: what a direction has to part.
struct PartsAtEnds<'e> {
    parts: [&'e ConvexPart; 2],
    ends: &'e Ends,
}

impl<'m, 'b> Certificate<'m, 'b> {
    pub(super) fn new(moving: &'m MovingPair<'b>) -> Certificate<'m, 'b> {
        Certificate { moving, hulls: moving.blocks.map(ConvexPart::whole), parts: OnceCell::new() }
    }

    fn parts(&self) -> &[Vec<ConvexPart>; 2] {
        self.parts.get_or_init(|| {
            let start = self.moving.at(&BigInt::zero(), 0);
            [0, 1].map(|side| {
                let block = self.moving.blocks[side];
                if block.is_convex() { vec![ConvexPart::whole(block)] } else { tetrahedra(block, &start[side]) }
            })
        })
    }

    /// Whether an interval of the times `ends / 2^halvings` is certainly free of depths above g.
    pub(super) fn is_free(&self, ends: &[BigInt; 2], halvings: u32) -> bool {
        let ends = Ends::new([0, 1].map(|k| self.moving.at(&ends[k], halvings)));
        let limit = &self.moving.limit << halvings;
        let hulls = PartsAtEnds { parts: self.hulls.each_ref(), ends: &ends };
        let is_within = |n: &LatticePoint| hulls.parts_within(n, &limit);
        // Along the axes first: most pairs that are apart are so by their boxes.
        if axes().iter().any(is_within) {
            return true;
        }
        let near = [0, 1].map(|side| NearPart::new(&self.hulls[side], side, &ends));
        if hulls.best_directions(near.each_ref()).iter().any(|candidate| is_within(candidate.n())) {
            return true;
        }
        if self.moving.blocks.iter().all(|block| block.is_convex()) {
            return false;
        }
        let mut hulls = near.into_iter();
        let near = [0, 1].map(|side| match hulls.next() {
            Some(hull) if self.moving.blocks[side].is_convex() => vec![hull],
            _ => self.parts()[side].iter().map(|part| NearPart::new(part, side, &ends)).collect(),
        });
        [0, 1].into_iter().all(|side| self.cover_stays_shallow(side, &ends, &near, &limit))
    }

    /// Whether every part of one block, moved by a translation of length at most g, is parted from all parts of the other.
    fn cover_stays_shallow(&self, side: usize, ends: &Ends, near: &[Vec<NearPart>; 2], limit: &BigInt) -> bool {
        let with_near = |side: usize| self.parts()[side].iter().zip(&near[side]);
        with_near(side).all(|own| {
            let (against, directions): (Vec<PartsAtEnds<'_>>, Vec<[&NearPart; 2]>) = with_near(1 - side)
                .map(|other| {
                    let [a, b] = if side == 0 { [own, other] } else { [other, own] };
                    (PartsAtEnds { parts: [a.0, b.0], ends }, [a.1, b.1])
                })
                .filter(|(two, _)| !two.are_far(float(limit)))
                .unzip();
            let directions = against.iter().zip(directions).map(|(two, near)| two.best_directions(near));
            let directions: Vec<Vec<Candidate<'_>>> = directions.collect();
            // No translation, then by g along the direction that the part overlapped most asks for, or along the middle of
            // all that are asked for, as in a corner of the other block; and of those as well that seem to be touched and may
            // be overlapped by less than f64 sees.
            let doubt = ends.size * (16.0 * f64::EPSILON);
            let asked =
                |most: f64| directions.iter().filter_map(|best| best.first()).filter(move |best| best.gap < most);
            let worst = || asked(doubt).min_by(|one, two| one.gap.total_cmp(&two.gap)).map(|worst| worst.n().clone());
            let middle = |most: f64| middle_of(asked(most).map(Candidate::n));
            let along = std::iter::once_with(worst).chain([0.0, doubt].into_iter().map(middle)).flatten();
            let along = along.map(|n| at_most_as_long(&n, limit));
            std::iter::once(Vec3::zero()).chain(along).any(|shift| {
                against.iter().zip(&directions).all(|(ends, tried)| {
                    // A's part moves so, or B's the other way.
                    tried.iter().any(|candidate| ends.parts_shifted(candidate.n(), &shift))
                })
            })
        })
    }
}

impl ConvexPart {
    fn whole(block: &Block) -> ConvexPart {
        let topology = block.topology();
        ConvexPart {
            vertices: topology.vertex_ids().collect(),
            faces: topology.faces().to_vec(),
            edges: topology.edges().iter().map(|edge| [edge.p, edge.q]).collect(),
            is_rough: false,
        }
    }

    fn of_points(v: [VertexId; 4]) -> ConvexPart {
        let [o, a, b, c] = v;
        ConvexPart {
            vertices: v.to_vec(),
            faces: vec![vec![o, a, b], vec![o, b, c], vec![o, c, a], vec![a, b, c]],
            edges: vec![[o, a], [o, b], [o, c], [a, b], [b, c], [c, a]],
            is_rough: true,
        }
    }
}

/// Tetrahedra from one vertex to all triangles of the surface. The vertex is the first of those before most triangles'
/// planes the fewest are on its outer side: from one that sees the whole block the tetrahedra fill no more than the block.
fn tetrahedra(block: &Block, places: &[LatticePoint]) -> Vec<ConvexPart> {
    let sides = |v: VertexId| {
        let volumes = triangles(block, places).map(move |[a, b, c]| {
            let from = &places[v.index()];
            ExactRing::sign(&a.minus(from).cross(&b.minus(from)).dot(&c.minus(from)))
        });
        volumes.filter(|sign| sign.is_negative()).count()
    };
    let apex = (0..places.len()).map(VertexId::at).min_by_key(|&v| sides(v)).unwrap_or(VertexId(0));
    triangle_corners(block)
        .filter(|corners| !corners.contains(&apex))
        .map(|[a, b, c]| ConvexPart::of_points([apex, a, b, c]))
        .collect()
}

/// The six directions along the axes.
fn axes() -> [LatticePoint; 6] {
    std::array::from_fn(|k| {
        let along = |axis: i32| BigInt::from(i32::from(k as i32 % 3 == axis) * if k < 3 { 1 } else { -1 });
        Vec3::new(along(0), along(1), along(2))
    })
}

/// A direction between others, rounded; `None` without others.
fn middle_of<'n>(directions: impl Iterator<Item = &'n LatticePoint>) -> Option<LatticePoint> {
    let units = directions.map(|n| {
        let n = direction(n.components());
        let size = dot(n, n).sqrt();
        n.map(|c| c / size)
    });
    let sum = units.reduce(|one, two| [one[0] + two[0], one[1] + two[1], one[2] + two[2]])?;
    let [x, y, z] = sum.map(|c| BigInt::from((c * 2f64.powi(40)) as i64));
    Some(Vec3::new(x, y, z))
}

/// A vector along n, of whole lattice units, no longer than `limit`.
fn at_most_as_long(n: &LatticePoint, limit: &BigInt) -> LatticePoint {
    // n·limit/√(n²), the root rounded up and the quotients towards zero.
    let root = n.norm_squared().sqrt() + 1;
    n.map(|c| c * limit / &root)
}

impl Ends {
    fn new(places: [[Vec<LatticePoint>; 2]; 2]) -> Ends {
        let origin = &places[0][0][0];
        let round = |p: &LatticePoint| {
            let from = p.minus(origin);
            [&from.x, &from.y, &from.z].map(float)
        };
        let near = places.each_ref().map(|sides| sides.each_ref().map(|points| points.iter().map(round).collect()));
        let all = near.iter().flatten().flatten().flatten();
        let size = all.fold(0.0f64, |most, c: &f64| most.max(c.abs()));
        Ends { places, near, size }
    }

    /// The way from one vertex to another over the size of all.
    fn near_way(&self, end: usize, side: usize, vertices: [VertexId; 2]) -> [f64; 3] {
        let [p, q] = vertices.map(|v| self.near[end][side][v.index()]);
        std::array::from_fn(|k| (q[k] - p[k]) / self.size)
    }
}

impl PartsAtEnds<'_> {
    fn places_of(&self, end: usize, side: usize) -> impl Iterator<Item = &LatticePoint> {
        self.parts[side].vertices.iter().map(move |&v| &self.ends.places[end][side][v.index()])
    }

    fn near_of(&self, end: usize, side: usize) -> impl Iterator<Item = &[f64; 3]> {
        self.parts[side].vertices.iter().map(move |&v| &self.ends.near[end][side][v.index()])
    }

    /// Whether at both ends the parts are certainly further apart along one axis than `limit`, so that a translation by that
    /// does not bring them together. Each coordinate is one rounding off, and so are the limit and the two sums.
    fn are_far(&self, limit: f64) -> bool {
        let most = limit * (1.0 + 4.0 * f64::EPSILON) + self.ends.size * (8.0 * f64::EPSILON);
        (0..3).any(|axis| {
            [(0, 1), (1, 0)].into_iter().any(|(above, below)| {
                (0..2).all(|end| {
                    let along = |side: usize| self.near_of(end, side).map(move |p| p[axis]);
                    let low = along(above).fold(f64::INFINITY, f64::min);
                    let high = along(below).fold(f64::NEG_INFINITY, f64::max);
                    low - high > most
                })
            })
        })
    }

    fn edge(&self, end: usize, side: usize, edge: usize) -> LatticePoint {
        let [p, q] = self.parts[side].edges[edge].map(|v| &self.ends.places[end][side][v.index()]);
        q.minus(p)
    }

    /// The least gap along n at both ends: A's lowest point less B's highest, times |n|.
    fn gap(&self, n: &LatticePoint) -> BigInt {
        let gap = |end: usize| {
            let low = self.places_of(end, 0).map(|p| n.dot(p)).min().unwrap_or_default();
            low - self.places_of(end, 1).map(|p| n.dot(p)).max().unwrap_or_default()
        };
        gap(0).min(gap(1))
    }

    /// The gap along n plus n·shift as f64 has them, and how far off that is at most; NaN where it overflows.
    fn near_gap(&self, n: &LatticePoint, shift: &LatticePoint) -> (f64, f64) {
        let [n, shift] = [n, shift].map(|v| v.components().map(float));
        let along = |p: &[f64; 3]| dot(n, *p);
        let gap = |end: usize| {
            let low = self.near_of(end, 0).map(along).fold(f64::INFINITY, f64::min);
            low - self.near_of(end, 1).map(along).fold(f64::NEG_INFINITY, f64::max)
        };
        // Each number is one rounding off. A product of two is at most three, a sum of three of them five times 2^−53 of
        // 3·largest·size; two such sums and what they are added to make less than 21 times 2^−52 of it.
        let largest = |v: &[f64; 3]| v.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        let error = largest(&n) * (self.ends.size + largest(&shift)) * (32.0 * f64::EPSILON);
        (gap(0).min(gap(1)) + along(&shift), error)
    }

    /// Whether at both ends A's lowest point along n is at most `limit` below B's highest; **exactly the limit says yes**.
    fn parts_within(&self, n: &LatticePoint, limit: &BigInt) -> bool {
        let (near, error) = self.near_gap(n, &Vec3::zero());
        if near > error {
            return true;
        }
        let [x, y, z] = n.components().map(float);
        let most = float(limit) * (x * x + y * y + z * z).sqrt() * (1.0 + 16.0 * f64::EPSILON);
        if (-near - error) * (1.0 - 4.0 * f64::EPSILON) > most {
            return false;
        }
        let square = n.norm_squared();
        let gap = self.gap(n);
        !Zero::is_zero(&square) && (!gap.is_negative() || &gap * &gap <= limit * limit * square)
    }

    /// Whether at both ends A, moved by `shift` relative to B, is not below B along n; **touching says yes**.
    fn parts_shifted(&self, n: &LatticePoint, shift: &LatticePoint) -> bool {
        let (near, error) = self.near_gap(n, shift);
        if near.abs() > error {
            return near > 0.0;
        }
        !Zero::is_zero(&n.norm_squared()) && !(self.gap(n) + n.dot(shift)).is_negative()
    }
}

fn float(value: &BigInt) -> f64 {
    value.to_f64().unwrap_or(f64::INFINITY)
}
