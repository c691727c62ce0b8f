//! What is worked out of every block: boxes, normals, lengths and directions, and whether all of that has extent.

use super::{Collapsed, CollapsedPart, Face, FaceOfEdge, PreparedBlock, PreparedEdge, Vertex, not_asked};
use crate::contact::boxes::Bounds;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, EdgeId, FaceId, VertexId};
use std::sync::OnceLock;

impl<R: Real> PreparedBlock<R> {
    /// A block of which nothing is known yet.
    pub(crate) fn unprepared(block: Block) -> PreparedBlock<R> {
        let bounds = Bounds::of_point(Vector::ZERO);
        let (vertices, edges, faces) = (Vec::new(), Vec::new(), Vec::new());
        PreparedBlock { block, bounds, vertices, edges, faces, bulge: OnceLock::new() }
    }

    /// Prepares it with its vertices at these points, in the memory that it has; its convexity flags and what it touches stay as they are.
    ///
    /// # Errors
    /// When a feature has no extent, naming it.
    pub fn with_points(mut self, points: &[Vector<R>]) -> Result<PreparedBlock<R>, Collapsed> {
        self.vertices.clear();
        for &at in points {
            self.place(at);
        }
        self.prepare()?;
        Ok(self)
    }

    /// Places the next vertex.
    #[inline(always)]
    pub(crate) fn place(&mut self, at: Vector<R>) {
        if self.vertices.is_empty() {
            self.vertices.reserve_exact(self.block.topology().vertex_count());
        }
        let convex = self.block.vertex_is_convex(VertexId::at(self.vertices.len()));
        self.vertices.push(Vertex { at, shortest: R::ZERO, convex });
    }

    /// Prepares it once its vertices are placed, in the memory that it has.
    pub(crate) fn prepare(&mut self) -> Result<(), Collapsed> {
        self.prepare_faces()?;
        self.prepare_edges()?;
        let topology = self.block.topology();
        let mut bounds = Bounds::of_point(self.vertices[0].at);
        for (v, vertex) in (0..).map(VertexId).zip(&mut self.vertices) {
            let lengths = topology.vertex_edges(v).iter().map(|&e| self.edges[e.index()].length);
            vertex.shortest = lengths.reduce(R::smaller).unwrap_or(R::ZERO);
            bounds = bounds.joined(&Bounds::of_point(vertex.at));
        }
        self.bounds = bounds;
        self.bulge = OnceLock::new();
        Ok(())
    }

    fn prepare_faces(&mut self) -> Result<(), Collapsed> {
        let PreparedBlock { block, vertices, faces, .. } = self;
        let loops = block.topology().faces();
        faces.clear();
        faces.reserve_exact(loops.len());
        for (f, corners) in loops.iter().enumerate() {
            let (area, point) = area_and_point(vertices, corners);
            let size = area.length();
            if !has_extent(size) {
                let (is_large, face) = (!size.is_finite(), FaceId::at(f));
                let what = if is_large { CollapsedPart::LargeFace(face) } else { CollapsedPart::Face(face) };
                return Err(Collapsed { what });
            }
            faces.push(Face { normal: area / size, area, point, turns_left: not_asked() });
        }
        Ok(())
    }

    fn prepare_edges(&mut self) -> Result<(), Collapsed> {
        let PreparedBlock { block, vertices, edges, faces, .. } = self;
        let topology = block.topology();
        edges.clear();
        edges.reserve_exact(topology.edges().len());
        for (e, edge) in topology.edges().iter().enumerate() {
            let (p, q) = (vertices[edge.p.index()].at, vertices[edge.q.index()].at);
            let along = q - p;
            let length = along.length();
            if !has_extent(length) {
                return Err(Collapsed { what: CollapsedPart::Edge(EdgeId::at(e)) });
            }
            let direction = along / length;
            if let Some(face) = without_direction_across(faces, edge, direction) {
                return Err(Collapsed { what: CollapsedPart::EdgeOfFace(EdgeId::at(e), face) });
            }
            edges.push(PreparedEdge {
                edge: *edge,
                convex: block.edge_is_convex(EdgeId::at(e)),
                p,
                q,
                direction,
                length,
                into: [not_asked(), not_asked()],
                widths: not_asked(),
            });
        }
        Ok(())
    }
}

/// Positive and finite. Collapse is no decision of SPEC section 4, so nothing is counted.
fn has_extent<R: Real>(size: R) -> bool {
    R::ZERO.below(size) && size.is_finite()
}

/// `N_f`, twice the area vector, relative to the loop's first vertex, and `c_f`.
fn area_and_point<R: Real>(vertices: &[Vertex<R>], corners: &[VertexId]) -> (Vector<R>, Vector<R>) {
    let at = |corner: VertexId| vertices[corner.index()].at;
    let origin = at(corners[0]);
    let (mut area, mut sum) = (Vector::ZERO, Vector::ZERO);
    let mut before = at(corners[1]) - origin;
    sum = sum + before;
    for &corner in &corners[2..] {
        let next = at(corner) - origin;
        area = area + before.cross(next);
        sum = sum + next;
        before = next;
    }
    (area, origin + mean(sum, corners.len()))
}

/// A sum of so many over their number.
fn mean<R: Real>(sum: Vector<R>, count: usize) -> Vector<R> {
    if R::IS_FLOAT && count.is_power_of_two() {
        // The same bits, without three divisions.
        return sum * R::from_f64(1.0 / count as f64);
    }
    sum / R::from_f64(count as f64)
}

/// The face of an edge whose plane holds no direction across it, if there is one.
fn without_direction_across<R: Real>(faces: &[Face<R>], edge: &Edge, direction: Vector<R>) -> Option<FaceId> {
    FaceOfEdge::BOTH.into_iter().find_map(|side| {
        let (f, face) = (side.of(edge), &faces[side.of(edge).index()]);
        (!surely_has_direction_across(face.normal, direction) && !has_direction_across(face, direction, side))
            .then_some(f)
    })
}

fn has_direction_across<R: Real>(face: &Face<R>, direction: Vector<R>, side: FaceOfEdge) -> bool {
    let across = face.across(direction, side);
    // The root of something that is positive and finite is so too, and the other way round: the length itself can wait.
    has_extent(across.dot(across))
}

/// The same with fewer operations. `|n × d|² = |n|²|d|² − (n·d)²` is far from zero where `n·d` is below 1/4: n and d are of unit length, or, where
/// squares of what they are made of underflow, longer than 0.7.
fn surely_has_direction_across<R: Real>(normal: Vector<R>, direction: Vector<R>) -> bool {
    R::IS_FLOAT && normal.dot(direction).abs().below(R::from_f64(0.25))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vector over its own length, if it has one, as preparation makes them.
    fn over_length(vector: Vector<f32>) -> Option<Vector<f32>> {
        let length = vector.length();
        has_extent(length).then(|| vector / length)
    }

    /// Vectors of ordinary size, and such whose squares underflow.
    #[test]
    fn what_surely_has_a_direction_across_has_one() {
        let least = f32::from_bits(1).sqrt();
        let parts = [0.0, 0.4, 0.75, 1.0, 1.2, 3.0];
        let signed = parts.into_iter().flat_map(|part| [part, -part]);
        let all: Vec<Vector<f32>> = [1.0, least, 8.0 * least]
            .into_iter()
            .flat_map(|size| {
                let signed = signed.clone();
                signed.clone().flat_map(move |x| {
                    let signed = signed.clone();
                    parts
                        .into_iter()
                        .flat_map(move |y| signed.clone().map(move |z| Vector::new(x * size, y * size, z * size)))
                })
            })
            .filter_map(over_length)
            .collect();
        let (mut sure, mut open, mut without) = (0, 0, 0);
        for &normal in &all {
            let face = Face { normal, area: normal, point: Vector::ZERO, turns_left: not_asked() };
            for &direction in &all {
                let has = has_direction_across(&face, direction, FaceOfEdge::Right);
                if surely_has_direction_across(normal, direction) {
                    assert!(has, "{normal:?} {direction:?}");
                    sure += 1;
                } else {
                    open += 1;
                    without += usize::from(!has);
                }
            }
        }
        assert!(sure > 10_000 && open > 10_000 && without > 100, "{sure} sure, {open} open, {without} without");
    }

    #[test]
    fn a_mean_of_a_power_of_two_is_the_quotient_bit_for_bit() {
        for count in 3..=64 {
            for bits in [0u64, 1, 3, 7, 1 << 51, 0x000F_FFFF_FFFF_FFFF, 0x3FF5_5555_5555_5555, 0x7FEF_FFFF_FFFF_FFFF] {
                for value in [f64::from_bits(bits), -f64::from_bits(bits), 1.0 / 3.0] {
                    let found = mean(Vector::new(value, 1.0, -value), count);
                    let expected = Vector::new(value, 1.0, -value) / count as f64;
                    let same = [(found.x, expected.x), (found.y, expected.y), (found.z, expected.z)];
                    assert!(same.into_iter().all(|(one, other)| one.is_same(other)), "{value:e} over {count}");
                }
            }
        }
    }
}
