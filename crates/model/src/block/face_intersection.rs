//! Whether faces meet outside their common vertices and edges (SPEC section 2).
//!
//! A face is the surface of its triangles ([`TriangulatedFace`]), so a face that rounding has bent stands for its own vertices and
//! adjacent faces have their edge in common whatever their planes are. All signs are exact.
//!
//! **What is tested is enough.** Let triangles S of face F and T of face G have a point in common that is on no common
//! vertex and no common edge of F and G. S ∩ T is convex, so it has an extreme point of that kind, or all its extreme
//! points are on common vertices and edges. An extreme point is on a side of S or of T: the first kind is found where
//! the sides of one face's triangles are held against the other's triangles. In the second kind either two extreme
//! points are vertices of both that no common edge joins, which is a side of both triangles and found likewise; or S and
//! T have a common edge and lie in one plane on the same side of it, which is the fold looked for.

use crate::block::certain_sign::{Coordinates, Surface};
use crate::block::polynomials::{OrientationInPlane, SideOfPlane};
use crate::block::triangles::TriangulatedFace;
use crate::sign::Sign;
use crate::topology::{Topology, VertexId, loop_pairs};

/// Two faces with a common point that they may not have.
#[derive(Clone, Copy)]
pub(super) struct FaceIntersection {
    /// The face whose line meets the other, and the other.
    pub(super) faces: [usize; 2],
    /// The ends of an edge or a diagonal of the first face.
    pub(super) line: [VertexId; 2],
    /// Whether it is a diagonal.
    pub(super) diagonal: bool,
}

/// Least and greatest coordinate along each axis. Coordinates are rounded to the nearest f64, which keeps their order:
/// when one is below another, so are the exact ones.
type Box3 = [(f64, f64); 3];

/// The faces of a block as triangles.
pub(super) struct TriangulatedFaces<'a> {
    coordinates: &'a Coordinates<'a>,
    topology: &'a Topology,
    approximate: &'a [[f64; 3]],
    patches: Vec<TriangulatedFace>,
    boxes: Vec<Box3>,
}

impl<'a> TriangulatedFaces<'a> {
    /// The faces must be simple polygons; `slack` is how far, in metres, a vertex may be from its face's plane.
    pub(super) fn new(
        surface: &Surface<'a>,
        topology: &'a Topology,
        approximate: &'a [[f64; 3]],
        slack: f64,
    ) -> TriangulatedFaces<'a> {
        let patches =
            (0..topology.faces().len()).map(|face| TriangulatedFace::new(surface, face, approximate, slack)).collect();
        let boxes = topology.faces().iter().map(|boundary| bounds(approximate, boundary)).collect();
        TriangulatedFaces { coordinates: surface.coordinates(), topology, approximate, patches, boxes }
    }

    /// Of the pairs of faces that meet where they may not, the first by their numbers.
    pub(super) fn first_intersection(&self) -> Option<FaceIntersection> {
        let boxes = &self.boxes;
        let axis = sweep_axis(boxes);
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|&i, &j| boxes[i][axis].0.total_cmp(&boxes[j][axis].0));
        let mut first: Option<((usize, usize), FaceIntersection)> = None;
        for (place, &i) in order.iter().enumerate() {
            for &j in order[place + 1..].iter().take_while(|&&j| boxes[j][axis].0 <= boxes[i][axis].1) {
                let pair = (i.min(j), i.max(j));
                if boxes_meet(&boxes[i], &boxes[j]) && first.is_none_or(|(least, _)| pair < least) {
                    first = self.intersection(pair).map(|meeting| (pair, meeting)).or(first);
                }
            }
        }
        first.map(|(_, meeting)| meeting)
    }

    fn intersection(&self, (f, g): (usize, usize)) -> Option<FaceIntersection> {
        let [of_f, of_g] = [f, g].map(|face| &self.topology.faces()[face]);
        let shared: Vec<VertexId> = of_f.iter().copied().filter(|v| of_g.contains(v)).collect();
        let is_plain = match *shared.as_slice() {
            [] | [_] => true,
            [p, q] => self.is_common_edge([p, q], [f, g]),
            _ => false,
        };
        let cost = |face: usize, of_other: &[VertexId]| self.patches[face].planes.len() * of_other.len();
        let (cheaper, of_other) = if cost(f, of_g) <= cost(g, of_f) { (f, of_g) } else { (g, of_f) };
        if is_plain && self.is_apart(cheaper, of_other, &shared) {
            return None;
        }
        let [near_f, near_g] = [self.reaching(f, g), self.reaching(g, f)];
        let is_apart = |face: usize, near: &[[VertexId; 3]]| {
            let mut vertices = near.concat();
            vertices.sort_unstable();
            vertices.dedup();
            self.is_apart(face, &vertices, &shared)
        };
        if is_plain && (is_apart(f, &near_g) || is_apart(g, &near_f)) {
            return None;
        }
        let edges = |faces: [usize; 2], near: &[[VertexId; 3]]| {
            let mut lines = loop_pairs(&self.topology.faces()[faces[0]]);
            let line = lines.find(|&(p, q)| self.line_meets([p, q], faces, near));
            line.map(|(p, q)| FaceIntersection { faces, line: [p, q], diagonal: false })
        };
        let diagonals = |faces: [usize; 2], near: &[[VertexId; 3]]| {
            let line = self.patches[faces[0]].diagonals.iter().find(|&&line| self.line_meets(line, faces, near));
            line.map(|&line| FaceIntersection { faces, line, diagonal: true })
        };
        let fold = || {
            let mut lines = loop_pairs(of_f);
            let line = lines.find(|&(p, q)| self.is_common_edge([p, q], [f, g]) && self.is_folded([p, q], [f, g]));
            line.map(|(p, q)| FaceIntersection { faces: [f, g], line: [p, q], diagonal: false })
        };
        edges([f, g], &near_g)
            .or_else(|| edges([g, f], &near_f))
            .or_else(fold)
            .or_else(|| diagonals([f, g], &near_g))
            .or_else(|| diagonals([g, f], &near_f))
    }

    /// The triangles of `face` whose boxes meet that of `other`; no others have a point in common with it.
    fn reaching(&self, face: usize, other: usize) -> Vec<[VertexId; 3]> {
        let all = self.patches[face].triangles.iter().copied();
        all.filter(|triangle| boxes_meet(&bounds(self.approximate, triangle), &self.boxes[other])).collect()
    }

    /// Whether the edge p-q joins the two faces.
    fn is_common_edge(&self, [p, q]: [VertexId; 2], [f, g]: [usize; 2]) -> bool {
        self.topology.edge_between(p, q).is_some_and(|edge| {
            let edge = &self.topology.edge(edge);
            let joined = [edge.left.index(), edge.right.index()];
            joined == [f, g] || joined == [g, f]
        })
    }

    /// A quick proof that face F meets those triangles of a face G that have all their corners among `vertices` at most
    /// in `shared`, which is nothing, one vertex or one common edge: the other vertices are strictly on one side of the
    /// planes of all triangles of F, and F is convex or `shared` is nothing.
    ///
    /// Proof. A point of such a triangle is s, or on a segment from s to y, with s on `shared` and y strictly on that side (say below)
    /// of all planes; or, as y, it is itself below all planes and not on F. Seen along F's normal F is convex, so
    /// where the segment is over F it is so from s on. There it leaves s downwards from F. If it met F again, first at x
    /// in triangle S, it would come to x from below S, and being straight go on above the plane of S up to y, which
    /// is below it.
    fn is_apart(&self, f: usize, vertices: &[VertexId], shared: &[VertexId]) -> bool {
        let patch = &self.patches[f];
        if !patch.is_convex && !shared.is_empty() {
            return false;
        }
        let mut side = None;
        patch.planes.iter().all(|&plane| {
            vertices.iter().filter(|v| !shared.contains(v)).all(|&vertex| {
                let sign = self.coordinates.cheap_sign(&SideOfPlane { plane, vertex });
                sign.is_some_and(|sign| !sign.is_zero() && *side.get_or_insert(sign) == sign)
            })
        })
    }

    /// Whether the triangles of two faces at their common edge p-q lie on one another.
    fn is_folded(&self, [p, q]: [VertexId; 2], faces: [usize; 2]) -> bool {
        let tips = faces.map(|face| {
            let at_edge = self.patches[face].triangles.iter().find(|t| t.contains(&p) && t.contains(&q));
            at_edge.and_then(|t| t.iter().copied().find(|&v| v != p && v != q))
        });
        let [Some(a), Some(b)] = tips else { return false };
        let (triangle, side) = ([p, q, a], SideOfPlane { plane: [p, q, a], vertex: b });
        a == b
            || self.coordinates.sign(&side).is_zero()
                && self.coordinates.sign(&OrientationInPlane { triangle, a: p, b: q, c: b }).is_positive()
    }

    /// Whether an edge or a diagonal of one face meets the other face, of which the triangles `near` reach the first,
    /// outside their common vertices and edges.
    fn line_meets(&self, line: [VertexId; 2], faces: [usize; 2], near: &[[VertexId; 3]]) -> bool {
        let around = bounds(self.approximate, &line);
        boxes_meet(&around, &self.boxes[faces[1]])
            && !self.is_common_edge(line, faces)
            && near.iter().any(|&triangle| {
                boxes_meet(&around, &bounds(self.approximate, &triangle)) && self.segment_meets(line, triangle)
            })
    }

    /// Whether a segment that is no common edge meets a triangle outside a common vertex.
    fn segment_meets(&self, [p, q]: [VertexId; 2], triangle: [VertexId; 3]) -> bool {
        match (triangle.iter().position(|&v| v == p), triangle.iter().position(|&v| v == q)) {
            (Some(_), Some(_)) => true,
            (Some(corner), None) => self.leaves_into(q, triangle, corner),
            (None, Some(corner)) => self.leaves_into(p, triangle, corner),
            (None, None) => self.pierces([p, q], triangle),
        }
    }

    /// Whether the segment from a triangle's corner to `end` runs in the triangle or along a side of it.
    fn leaves_into(&self, end: VertexId, triangle: [VertexId; 3], corner: usize) -> bool {
        let [a, b, c] = [corner, corner + 1, corner + 2].map(|k| triangle[k % 3]);
        let turn = |to: VertexId| self.coordinates.sign(&OrientationInPlane { triangle, a, b: to, c: end });
        self.coordinates.sign(&SideOfPlane { plane: triangle, vertex: end }).is_zero()
            && turn(b).is_at_least_zero()
            && turn(c).is_at_most_zero()
    }

    /// Whether a segment and a triangle without common vertices have a common point; **touching counts**.
    fn pierces(&self, [p, q]: [VertexId; 2], triangle: [VertexId; 3]) -> bool {
        let [a, b, c] = triangle;
        let ends = [p, q].map(|vertex| SideOfPlane { plane: triangle, vertex });
        // On which side of each side of the triangle the line passes it.
        let passes = [(a, b), (b, c), (c, a)].map(|(from, to)| SideOfPlane { plane: [p, q, from], vertex: to });
        let cheap = |side: &SideOfPlane| self.coordinates.cheap_sign(side);
        if let [Some(before), Some(after)] = ends.each_ref().map(cheap)
            && is_one_side(&[before, after])
        {
            return false;
        }
        if are_opposed(&passes.each_ref().map(|side| cheap(side).unwrap_or(Sign::Zero))) {
            return false;
        }
        let ends = ends.map(|side| self.coordinates.sign(&side));
        if ends == [Sign::Zero; 2] {
            return self.overlaps_in_plane([p, q], triangle);
        }
        !is_one_side(&ends) && !are_opposed(&passes.map(|side| self.coordinates.sign(&side)))
    }

    /// Whether a segment in the plane of a triangle has a point in common with it: no side of the triangle, nor the
    /// segment, has the other strictly beyond it (separating axes of two convex sets, one with an interior).
    fn overlaps_in_plane(&self, [p, q]: [VertexId; 2], triangle: [VertexId; 3]) -> bool {
        let [a, b, c] = triangle;
        let turn =
            |a: VertexId, b: VertexId, c: VertexId| self.coordinates.sign(&OrientationInPlane { triangle, a, b, c });
        let is_beyond = |from: VertexId, to: VertexId| [p, q].iter().all(|&v| turn(from, to, v).is_negative());
        !is_beyond(a, b) && !is_beyond(b, c) && !is_beyond(c, a) && !is_one_side(&[a, b, c].map(|v| turn(p, q, v)))
    }
}

fn is_one_side(signs: &[Sign]) -> bool {
    !signs[0].is_zero() && signs.iter().all(|&sign| sign == signs[0])
}

fn are_opposed(signs: &[Sign]) -> bool {
    signs.contains(&Sign::Negative) && signs.contains(&Sign::Positive)
}

fn bounds(approximate: &[[f64; 3]], vertices: &[VertexId]) -> Box3 {
    std::array::from_fn(|axis| {
        let all = vertices.iter().map(|&v| approximate[v.index()][axis]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), c| (least.min(c), most.max(c)))
    })
}

fn boxes_meet(a: &Box3, b: &Box3) -> bool {
    (0..3).all(|axis| a[axis].0 <= b[axis].1 && b[axis].0 <= a[axis].1)
}

/// The axis along which the boxes take the smallest share of the whole, so that a sweep finds the fewest pairs.
fn sweep_axis(boxes: &[Box3]) -> usize {
    let share = |axis: usize| {
        let whole = boxes
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), b| (least.min(b[axis].0), most.max(b[axis].1)));
        boxes.iter().map(|b| b[axis].1 - b[axis].0).sum::<f64>() / (whole.1 - whole.0)
    };
    let shares = [share(0), share(1), share(2)];
    (0..3).min_by(|&i, &j| shares[i].total_cmp(&shares[j])).unwrap_or(0)
}
