//! Test 3: v-f, and f-v with the roles exchanged.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::Candidate;
use crate::contact::nearby_features::Planes;
use crate::contact::pair::Pair;
use crate::contact::prepared_block::{FaceOfEdge, PreparedBlock};
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, FaceId, VertexId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the contact of vertex `v` of `side` and face `f` of the other block, if there is one.
    #[inline(always)]
    pub(super) fn vertex_face(&mut self, side: Side, v: VertexId, f: FaceId, planes: Planes) {
        let contact = match side {
            Side::A => ContactKey::VertexFace(v, f),
            Side::B => ContactKey::FaceVertex(f, v),
        };
        let meets = planes.meets
            || self.vertex_meets_face(side, v, f, contact)
                && !self.belongs_to_rim(side, v, f)
                && self.cone_passes(side, v, f);
        if meets {
            let entrance = self.vertex_face_entrance(side, v, f);
            self.record(contact, Candidate { exits: planes.exits(), ..entrance });
        }
    }

    /// A vertex is near a face, not too deep, and its projection inside.
    #[inline(always)]
    pub(super) fn vertex_meets_face(&mut self, side: Side, v: VertexId, f: FaceId, contact: ContactKey) -> bool {
        let other = self.prepared(side.other());
        let (at, face) = (self.prepared(side).vertex(v).at, other.face(f));
        let asked = [Feature::Vertex(side, v), Feature::Face(side.other(), f)];
        let gap = face.normal.dot(at - face.point);
        self.ask(Predicate::VertexFaceNear, &asked, M::vertex_face_near(gap, self.t.search))
            && self.ask(Predicate::VertexFaceDepth, &asked, self.vertex_face_depth(gap, contact))
            && self.ask(Predicate::InsideFace, &asked, is_over_face::<R, M>(at, other, f))
    }

    /// Not too deep: the gap is at least −g, or the contact is kept.
    fn vertex_face_depth(&self, gap: R, contact: ContactKey) -> bool {
        M::vertex_face_depth(gap, self.t.penetration) || self.is_kept(contact)
    }

    /// A vertex is in the territory of a vertex or an edge of the face.
    pub(super) fn belongs_to_rim(&mut self, side: Side, v: VertexId, f: FaceId) -> bool {
        if !M::vertex_takes_part(self.prepared(side).vertex(v).convex) {
            return false;
        }
        let topology = self.prepared(side.other()).block().topology();
        (M::vertices_before_faces_and_edges() && topology.face(f).iter().any(|&w| self.in_vertex_territory(side, v, w)))
            || (M::edges_before_faces_and_edges()
                && topology.face_edges(f).iter().any(|&e| self.in_edge_territory(side, v, e)))
    }
}

/// The projection of a point along the normal lies strictly inside the face. **On the rim says no.**
fn is_over_face<R: Real, M: ContactRules>(at: Vector<R>, prepared: &PreparedBlock<R>, f: FaceId) -> bool {
    if prepared.turns_left(f) {
        prepared.block().topology().face_edges(f).iter().all(|&e| M::inside_face(inward(at, prepared, f, e)))
    } else {
        winds_around::<R, M>(at, prepared, f)
    }
}

/// How far a point is on the inner side of edge `e` of face `f`.
#[inline]
fn inward<R: Real>(at: Vector<R>, prepared: &PreparedBlock<R>, f: FaceId, e: EdgeId) -> R {
    let ridge = prepared.edge(e);
    let side = if ridge.edge.left == f { FaceOfEdge::Left } else { FaceOfEdge::Right };
    (at - ridge.p).dot(prepared.into_face(e, side))
}

/// Inside by the winding number (Sunday 2001), for a face with a corner that turns right. Levels are measured from the
/// point along a direction in the face plane. What counts as above at the point's own level changes nothing, because each
/// corner's level is judged once for both its edges; so only sides are decisions.
fn winds_around<R: Real, M: ContactRules>(at: Vector<R>, prepared: &PreparedBlock<R>, f: FaceId) -> bool {
    let topology = prepared.block().topology();
    let corners = topology.face(f);
    let upwards = across(prepared.face(f).normal);
    let level = |corner: VertexId| (prepared.vertex(corner).at - at).dot(upwards);
    let first = level(corners[0]);
    let mut start = first;
    let mut winding = 0;
    for (k, &e) in topology.face_edges(f).iter().enumerate() {
        let end = corners.get(k + 1).map_or(first, |&corner| level(corner));
        let (from_above, to_above) = (R::ZERO.below(start), R::ZERO.below(end));
        // Where an edge may lie at the point's own level, its side is asked: the point may be on it.
        let misses_level = (R::ZERO.surely_below(start) && R::ZERO.surely_below(end))
            || (start.surely_below(R::ZERO) && end.surely_below(R::ZERO));
        start = end;
        if misses_level {
            continue;
        }
        let side = inward(at, prepared, f, e);
        match (M::inside_face(side), M::inside_face(-side)) {
            (true, _) if !from_above && to_above => winding += 1,
            (_, true) if from_above && !to_above => winding -= 1,
            (false, false) if is_between_ends(at, prepared, e) => return false,
            _ => {}
        }
    }
    winding != 0
}

/// For a point on an edge's line: whether it is on the edge, ends included.
fn is_between_ends<R: Real>(at: Vector<R>, prepared: &PreparedBlock<R>, e: EdgeId) -> bool {
    let ridge = prepared.edge(e);
    !(at - ridge.p).dot(ridge.direction).surely_below(R::ZERO)
        && !R::ZERO.surely_below((at - ridge.q).dot(ridge.direction))
}

/// A direction across `normal`, without rounding: the cross product with the axis it leans to least.
fn across<R: Real>(normal: Vector<R>) -> Vector<R> {
    let Vector { x, y, z } = normal;
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    if !ay.below(ax) && !az.below(ax) {
        Vector::new(R::ZERO, z, -y)
    } else if !az.below(ay) {
        Vector::new(-z, R::ZERO, x)
    } else {
        Vector::new(y, -x, R::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::contact_rules::SpecRules;
    use crate::wide::Wide;
    use rockproof_model::{Block, BlockOptions, Number, Vec3};

    /// A polygon, and rectangles that make it up and overlap where they meet: what is strictly inside one of them is strictly inside it.
    type Shape = (&'static [[i32; 2]], &'static [[[i32; 2]; 2]]);

    /// An L, a U and a plus.
    const SHAPES: [Shape; 3] = [
        (&[[0, 0], [6, 0], [6, 2], [2, 2], [2, 6], [0, 6]], &[[[0, 0], [6, 2]], [[0, 0], [2, 6]]]),
        (
            &[[0, 0], [6, 0], [6, 4], [4, 4], [4, 2], [2, 2], [2, 4], [0, 4]],
            &[[[0, 0], [6, 2]], [[0, 0], [2, 4]], [[4, 0], [6, 4]]],
        ),
        (
            &[[2, 0], [4, 0], [4, 2], [6, 2], [6, 4], [4, 4], [4, 6], [2, 6], [2, 4], [0, 4], [0, 2], [2, 2]],
            &[[[2, 0], [4, 6]], [[0, 2], [6, 4]]],
        ),
    ];

    /// Maps that keep angles and the way round: the normal of the top comes to lie along an axis or halfway between two, either way.
    fn turned([x, y, z]: [i32; 3], way: usize) -> [i32; 3] {
        let [x, y, z] = if way & 1 == 0 { [x, y, z] } else { [x, -y, -z] };
        let turned = if way & 2 == 0 { [x, y, z] } else { [x, y + z, z - y] };
        [0, 1, 2].map(|k| turned[(k + way / 4) % 3])
    }

    fn over_every_point<R: Real>() {
        let [mut inside, mut outside] = [0; 2];
        for (outline, rectangles) in SHAPES {
            for way in 0..12 {
                let n = outline.len() as u32;
                let at = |z: i32| outline.iter().map(move |&[x, y]| turned([x, y, z], way));
                let vertices =
                    at(-1).chain(at(0)).map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
                let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
                let faces = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
                let block = Block::new(vertices.collect(), faces, &BlockOptions { planarity: Number::ZERO }).unwrap();
                let prepared = PreparedBlock::<R>::new(&block).unwrap();
                for (x, y) in (-1..8).flat_map(|x| (-1..8).map(move |y| (x, y))) {
                    let [u, v, w] = turned([x, y, 1], way).map(|c| R::from_f64(f64::from(c)));
                    let found = is_over_face::<R, SpecRules>(Vector::new(u, v, w), &prepared, FaceId(1));
                    let strictly = |[[x0, y0], [x1, y1]]: &[[i32; 2]; 2]| *x0 < x && x < *x1 && *y0 < y && y < *y1;
                    let expected = rectangles.iter().any(strictly);
                    assert_eq!(found, expected, "({x}, {y}) over {outline:?}, turned the way {way}");
                    *if expected { &mut inside } else { &mut outside } += 1;
                }
            }
        }
        // Nine points are strictly inside each shape.
        assert_eq!((inside, outside), (3 * 12 * 9, 3 * 12 * (81 - 9)));
    }

    #[test]
    fn a_point_is_over_a_concave_face_where_it_is_strictly_inside_a_part_of_it() {
        over_every_point::<f32>();
        over_every_point::<f64>();
        over_every_point::<Wide>();
    }

    /// Levels along a short direction would be lost to underflow.
    #[test]
    fn a_direction_across_a_unit_normal_is_not_short_and_is_across() {
        let small = f32::from_bits(1);
        for axis in 0..3 {
            for long in [1.0, -1.0] {
                for [one, two] in
                    [[0.0, 0.0], [small, 0.0], [0.0, small], [small, small], [0.6, 0.0], [0.0, -0.6], [0.6, 0.6]]
                {
                    let mut c = [long, one, two];
                    c.rotate_right(axis);
                    let normal = Vector::new(c[0], c[1], c[2]);
                    let found = across(normal);
                    assert!(found.length() >= 0.5 && found.dot(normal) == 0.0, "{found:?} across {normal:?}");
                }
            }
        }
    }
}
