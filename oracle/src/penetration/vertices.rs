//! The deepest point of one block inside the other: what overlap means where a block is not convex.
//!
//! The inside of a block is that of its faces' triangles from the first vertex of each loop, as its volume is. A
//! point's depth is its distance from the other's surface, the least over the faces (where its foot on the plane is
//! inside the polygon), the edges (where its foot is inside) and the vertices. The points looked at are the first sort of these of which some are
//! inside; the third only where the interiors meet:
//!
//! 1. the vertices of either block;
//! 2. the middles of edges between crossings: where an edge passes through faces of the other block it is cut, and the
//!    middle of each part is looked at. A crossing itself is on both surfaces and so no depth; the stretch of the edge
//!    between two crossings is what is inside, and its middle, a rational point, stands for it;
//! 3. the same of the diagonals by which faces of four vertices and more are cut into triangles, as far as these are on the face: faces bent by
//!    rounding are passed through by nothing else where both blocks have all their vertices.
//!
//! Blocks overlap without these where their surfaces coincide, as those of two equal blocks do; and where surfaces nearly coincide, these are next to
//! the surface, however deep the blocks overlap. So where they are [`SHALLOW`] or none, the deepest is looked for among them and
//!
//! 4. the middles of convex cells in both blocks (`common_cells`). Where neither these nor the points before are inside, and all faces are planar,
//! 5. the middles of the common parts of the blocks' convex cells, cut exactly ([`crate::convex_cells`]). Where faces are bent, the depth is then 0: the blocks
//!    overlap in slivers between bent faces, or in a part too narrow for the cells of 4 (`common_cells::NARROW`).
//!
//! Of 4 and 5 the depth is the lesser of the distances from both surfaces, as the point is a corner of neither. Of all but the vertices the depth is
//! that of points inside, at most that of the deepest ones.
//!
//! f64 answers first wherever it proves the answer (`near`); what is left is exact.

mod common_cells;
mod lattice_point;
mod lattice_surface;
mod near;

use super::{LatticePair, Penetration};
use crate::Gap;
use crate::convex_cells::{ConvexCell, cells};
use crate::interiors::surfaces_meet;
use crate::separation::{SeparablePoints, separate};
use lattice_point::{Fraction, NearestPoint};
use lattice_surface::LatticeSurface;
use near::View;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::{Block, Sign, Vec3, VertexId};

/// A depth of the largest coordinate over this or less may be all that vertices show of a deep overlap, where surfaces nearly coincide: by rounding, by
/// the unevenness of faces, or since one block was moved a little against another like it. It is far more than `penetration` and unevenness are.
const SHALLOW: u64 = 1 << 4;

/// The deepest point of either block; `None` where a block has no face with an area.
pub(super) fn deepest_point(pair: &LatticePair<'_>) -> Option<Penetration> {
    let view = View::of([&pair.points[0], &pair.points[1]]);
    let surfaces = [LatticeSurface::new(pair, &view, 0)?, LatticeSurface::new(pair, &view, 1)?];
    let best = deepest_vertex(&surfaces).or_else(|| {
        deepest_of(&surfaces, |side| {
            middles_between_crossings(&surfaces[side], &surfaces[1 - side], edges(pair.blocks[side]))
        })
    });
    let best = match best {
        Some(best) if !surfaces.iter().any(|surface| best.nearest.is_within(&surface.bounds, SHALLOW)) => Some(best),
        None if !interiors_meet(pair) => None,
        best => {
            let on_diagonals = |side: usize| middles_on_diagonals(&surfaces[side], &surfaces[1 - side]);
            let best = best.or_else(|| deepest_of(&surfaces, on_diagonals));
            let middles = common_cells::middles(pair.blocks);
            let middles = middles.into_iter().filter_map(|middle| Some(Fraction::of(&pair.in_units(middle)?)));
            deepest_common(&surfaces, best, middles).or_else(|| {
                let is_planar = surfaces.iter().all(LatticeSurface::has_planar_faces);
                if is_planar { deepest_common(&surfaces, None, exact_middles(pair)) } else { None }
            })
        }
    };
    let Some(DeepPoint { nearest, is_of_a }) = best else {
        return Some(Penetration::none());
    };
    // A's point moves to the surface; where it is B's, A moves the other way.
    let way = if is_of_a { nearest.way } else { nearest.way.negated() };
    let squared = pair.square_metres(nearest.numerator, nearest.denominator);
    let direction = way.map(|c| BigRational::from_integer(c.clone()));
    Some(Penetration { gap: Gap { sign: Sign::Negative, squared }, direction })
}

/// A point inside the other block, by its nearest point on the other's surface.
struct DeepPoint {
    nearest: NearestPoint,
    is_of_a: bool,
}

fn deepest_vertex(surfaces: &[LatticeSurface<'_>; 2]) -> Option<DeepPoint> {
    deepest_of(surfaces, |side| surfaces[side].points.iter().map(|p| Fraction::whole(p.clone())).collect())
}

/// The deepest of some points of each block, the first of several equally deep.
fn deepest_of(surfaces: &[LatticeSurface<'_>; 2], points: impl Fn(usize) -> Vec<Fraction>) -> Option<DeepPoint> {
    let mut best: Option<DeepPoint> = None;
    for side in 0..2 {
        let other = &surfaces[1 - side];
        for point in points(side) {
            if let Some(nearest) = other.depth(point, best.as_ref().map(|best| &best.nearest)) {
                best = Some(DeepPoint { nearest, is_of_a: side == 0 });
            }
        }
    }
    best
}

/// Whether the interiors of two blocks meet.
fn interiors_meet(pair: &LatticePair<'_>) -> bool {
    let [a, b] = pair.blocks.map(|block| SeparablePoints::new(block.vertices().to_vec()));
    !separate(a.set(), b.set()).is_separated && surfaces_meet(pair.blocks[0], pair.blocks[1])
}

/// The ends of a block's edges.
fn edges(block: &Block) -> Vec<[VertexId; 2]> {
    block.topology().edges().iter().map(|edge| [edge.p, edge.q]).collect()
}

/// The middles between crossings of the diagonals by which a block's faces are cut into triangles, where they are on the face: of a face that is not
/// convex diagonals leave it, and are no part of the block there.
fn middles_on_diagonals(of: &LatticeSurface<'_>, other: &LatticeSurface<'_>) -> Vec<Fraction> {
    let on_face = |(number, corners): (usize, &Vec<VertexId>)| {
        let diagonals = (2..corners.len() - 1).map(|k| [corners[0], corners[k]]).collect();
        let middles = middles_between_crossings(of, other, diagonals).into_iter();
        middles.filter(|middle| of.is_over_face(middle, number)).collect::<Vec<_>>()
    };
    of.block.topology().faces().iter().enumerate().flat_map(on_face).collect()
}

/// The middles of what two of the blocks' convex cells share.
fn exact_middles(pair: &LatticePair<'_>) -> impl Iterator<Item = Fraction> {
    let [ones, twos] = pair.blocks.map(cells);
    let (units, metres) = pair.scale.clone();
    let shared = move |one: ConvexCell| twos.iter().filter_map(|two| one.common(two)).collect::<Vec<_>>();
    let parts = ones.into_iter().flat_map(shared);
    parts.map(move |common| Fraction::of(&common.middle().map(|c| c * &units / &metres)))
}

/// The deepest of a point and of some points that are corners of neither block: the first of several equally deep.
fn deepest_common(
    surfaces: &[LatticeSurface<'_>; 2],
    mut best: Option<DeepPoint>,
    points: impl Iterator<Item = Fraction>,
) -> Option<DeepPoint> {
    for point in points {
        let deepest = best.as_ref().map(|best| &best.nearest);
        // Deep in B as a point of A, and the other way round.
        let Some(as_a) = surfaces[1].depth(point.clone(), deepest) else { continue };
        let Some(as_b) = surfaces[0].depth(point, deepest) else { continue };
        let is_of_a = as_a.cmp_square(&as_b).is_le();
        best = Some(DeepPoint { nearest: if is_of_a { as_a } else { as_b }, is_of_a });
    }
    best
}

/// The middles of the parts into which the other's triangles cut each of some edges or diagonals, where they cut it at all.
fn middles_between_crossings(
    of: &LatticeSurface<'_>,
    other: &LatticeSurface<'_>,
    edges: Vec<[VertexId; 2]>,
) -> Vec<Fraction> {
    let surface: Vec<_> = other.near.triangles().collect();
    let mut middles = Vec::new();
    for edge in edges {
        let [p, q] = edge.map(|v| &of.points[v.index()]);
        let d = q.minus(p);
        let may_meet = |triangle: &usize| other.near.may_be_crossed(&of.near, edge, *triangle);
        let meeting = (0..surface.len()).filter(may_meet);
        let mut places: Vec<BigRational> = meeting
            .filter_map(|triangle| crossing(p, &d, surface[triangle].map(|v| &other.points[v.index()])))
            .collect();
        if places.is_empty() {
            continue;
        }
        places.extend([BigRational::zero(), BigRational::one()]);
        places.sort();
        places.dedup();
        let middle = |two: &[BigRational]| (&two[0] + &two[1]) / BigInt::from(2);
        middles.extend(places.windows(2).map(|two| Fraction::between(p, &d, &middle(two))));
    }
    middles
}

/// Where `p + t·d` meets a triangle whose plane it passes through, its boundary included, for t from 0 to 1.
fn crossing(p: &Vec3<BigInt>, d: &Vec3<BigInt>, corners: [&Vec3<BigInt>; 3]) -> Option<BigRational> {
    let [a, b, c] = corners.map(|v| v.minus(p));
    let n = b.minus(&a).cross(&c.minus(&a));
    let towards = n.dot(d);
    if Zero::is_zero(&towards) {
        return None;
    }
    let sides = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| p.cross(q).dot(d));
    let is_outside = |side: &BigInt| !Zero::is_zero(side) && side.is_positive() != towards.is_positive();
    if sides.iter().any(is_outside) {
        return None;
    }
    let before = n.dot(&a);
    let beyond = &towards - &before;
    let is_on_edge = [&before, &beyond].into_iter().all(|part| !is_outside(part));
    is_on_edge.then(|| BigRational::new(before, towards))
}

#[cfg(test)]
mod tests;
