//! From vertices and face loops to a canonical block, or to the reason why they are none (SPEC section 2).

use crate::block::certain_sign::{Coordinates, Surface};
use crate::block::error::BlockError;
use crate::block::face_intersection::{FaceIntersection, TriangulatedFaces};
use crate::block::measure::LazyMoments;
use crate::block::merge;
use crate::block::planarity::Planarity;
use crate::block::polynomials::{Area, EdgeConvexity, Orientation, SameSide, Volume};
use crate::block::simple::check_simple;
use crate::block::triangles::TriangulatedFace;
use crate::block::{Block, BlockOptions, BlockShape, Merged, Merging, Point};
use crate::sign::Sign;
use crate::topology::{Edge, Topology, VertexId};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::One;
use std::cmp::Ordering;
use std::sync::Arc;

/// Vertices and faces with the numbers they had in the input.
pub(super) struct BlockDraft {
    pub(super) vertices: Vec<Point>,
    pub(super) approximate: Vec<[f64; 3]>,
    pub(super) topology: Topology,
    /// Input number of each vertex.
    pub(super) vertex_names: Vec<usize>,
    /// Lowest input number of the faces that became this one.
    pub(super) face_names: Vec<usize>,
}

pub(super) fn build(
    vertices: Vec<Point>,
    faces: Vec<Vec<impl Into<VertexId>>>,
    options: &BlockOptions,
    merging: Merging,
) -> Result<(Block, Merged), BlockError> {
    check_denominator(&vertices)?;
    let approximate = approximate(&vertices)?;
    check_distinct(&vertices, &approximate)?;
    let topology = Topology::new(vertices.len(), faces)?;
    let (vertex_count, face_count) = (vertices.len(), topology.faces().len());
    let mut draft = BlockDraft {
        vertex_names: (0..vertex_count).collect(),
        face_names: (0..face_count).collect(),
        vertices,
        approximate,
        topology,
    };
    let mut signs = check_input(&draft, options)?;
    let needed =
        signs.contains(&Sign::Zero) || merging == Merging::WithinPlanarity || has_two_edge_vertex(&draft.topology);
    if needed {
        draft = merge::merge(draft, &signs, options, merging)?;
        signs = check_merged(&draft, options)?;
    }
    check_canonical(&draft, &signs)?;
    check_embedded(&draft, options)?;
    let merged =
        Merged { faces: face_count - draft.topology.faces().len(), vertices: vertex_count - draft.vertices.len() };
    let shape = shape(&draft, &signs)?;
    Ok((Block { shape: Arc::new(shape), vertices: draft.vertices.into(), moments: LazyMoments::default() }, merged))
}

/// Bits of the common denominator of all coordinates: n fractions of d digits would otherwise cost n²·d.
const MAX_BITS: u64 = 1 << 16;

fn check_denominator(vertices: &[Point]) -> Result<(), BlockError> {
    let ratios = || vertices.iter().flat_map(|v| v.components()).filter_map(|c| c.as_ratio());
    // The product of all denominators bounds their least common multiple.
    if ratios().map(|r| r.denom().bits()).sum::<u64>() <= MAX_BITS {
        return Ok(());
    }
    let mut common = BigInt::one();
    for ratio in ratios() {
        if !common.is_multiple_of(ratio.denom()) {
            common = common.lcm(ratio.denom());
        }
        if common.bits() > MAX_BITS {
            return Err(BlockError::TooFine { limit: MAX_BITS });
        }
    }
    Ok(())
}

fn approximate(vertices: &[Point]) -> Result<Vec<[f64; 3]>, BlockError> {
    let near = |v: &Point| v.components().map(|c| c.approximate());
    let all: Vec<[f64; 3]> = vertices.iter().map(near).collect();
    match all.iter().position(|v| v.iter().any(|c| c.is_infinite())) {
        Some(vertex) => Err(BlockError::Overflow { vertex }),
        None => Ok(all),
    }
}

fn check_distinct(vertices: &[Point], approximate: &[[f64; 3]]) -> Result<(), BlockError> {
    let compare = |&i: &usize, &j: &usize| {
        (0..3).fold(Ordering::Equal, |order, axis| {
            order
                .then_with(|| approximate[i][axis].total_cmp(&approximate[j][axis]))
                .then_with(|| vertices[i].components()[axis].cmp(vertices[j].components()[axis]))
        })
    };
    let mut order: Vec<usize> = (0..vertices.len()).collect();
    order.sort_by(|i, j| compare(i, j).then(i.cmp(j)));
    let same = order.windows(2).filter(|pair| compare(&pair[0], &pair[1]).is_eq()).map(|pair| (pair[0], pair[1])).min();
    match same {
        None => Ok(()),
        Some((first, second)) => {
            let [x, y, z] = approximate[first];
            Err(BlockError::RepeatedVertex { first, second, x, y, z })
        }
    }
}

/// Checks what the input must satisfy before anything is merged, and answers the sign of κ at every edge.
fn check_input(draft: &BlockDraft, options: &BlockOptions) -> Result<Vec<Sign>, BlockError> {
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let surface = Surface::new(&coordinates, draft.topology.faces());
    check_faces(&surface, draft, options)?;
    check_volume(&surface)?;
    signs_of_edges(&surface, draft)
}

/// Checks area, planarity and simplicity of every face.
fn check_faces(surface: &Surface<'_>, draft: &BlockDraft, options: &BlockOptions) -> Result<(), BlockError> {
    let planarity = Planarity::new(surface.coordinates(), options);
    for (face, boundary) in surface.faces().iter().enumerate() {
        if surface.sign(&Area { face }).is_zero() {
            return Err(BlockError::DegenerateFace { face: draft.face_names[face], length: boundary.len() });
        }
        if let Some(worst) = planarity.violation(surface, face) {
            return Err(BlockError::NotPlanar {
                face: draft.face_names[face],
                corners: boundary.len(),
                vertices: worst.vertices.iter().map(|v| draft.vertex_names[v.index()]).collect(),
                deviation: worst.deviation,
                allowed: options.planarity.approximate(),
            });
        }
        if let Err((first, second)) = check_simple(surface, face, &draft.approximate, planarity.slack()) {
            let named = |(p, q): (VertexId, VertexId)| (draft.vertex_names[p.index()], draft.vertex_names[q.index()]);
            return Err(BlockError::SelfIntersecting {
                face: draft.face_names[face],
                first: named(first),
                second: named(second),
            });
        }
    }
    Ok(())
}

fn check_volume(surface: &Surface<'_>) -> Result<(), BlockError> {
    if surface.sign(&Volume).is_positive() {
        return Ok(());
    }
    let (numerator, denominator) = surface.coordinates().lattice().units_per_metre();
    let scale = BigRational::new(denominator, numerator);
    let volume =
        BigRational::from_integer(surface.exact_value(&Volume)) * scale.pow(3) / BigRational::from_integer(6.into());
    Err(BlockError::NotPositiveVolume { volume: crate::Number::from_rational(volume).approximate() })
}

/// Checks what merging has made, and answers the sign of κ at every edge.
fn check_merged(draft: &BlockDraft, options: &BlockOptions) -> Result<Vec<Sign>, BlockError> {
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let surface = Surface::new(&coordinates, draft.topology.faces());
    check_faces(&surface, draft, options)?;
    signs_of_edges(&surface, draft)
}

/// The sign of κ at every edge; a folded edge is an error.
fn signs_of_edges(surface: &Surface<'_>, draft: &BlockDraft) -> Result<Vec<Sign>, BlockError> {
    let sign = |edge: &Edge| {
        let &Edge { p, q, left, right } = edge;
        let sign = surface.sign(&EdgeConvexity { p, q, left, right });
        if sign.is_zero() && !surface.sign(&SameSide { left, right }).is_positive() {
            let [p, q] = [p, q].map(|v| draft.vertex_names[v.index()]);
            let [left, right] = [left, right].map(|f| draft.face_names[f.index()]);
            return Err(BlockError::FoldedEdge { p, q, left, right });
        }
        Ok(sign)
    };
    draft.topology.edges().iter().map(sign).collect()
}

fn has_two_edge_vertex(topology: &Topology) -> bool {
    topology.vertex_ids().any(|v| topology.vertex_edges(v).len() < 3)
}

/// No flat edge, and three edges or more at every vertex.
fn check_canonical(draft: &BlockDraft, signs: &[Sign]) -> Result<(), BlockError> {
    let topology = &draft.topology;
    if let Some(edge) = signs.iter().position(|s| s.is_zero()) {
        let Edge { p, q, left, right } = topology.edges()[edge];
        let [p, q] = [p, q].map(|v| draft.vertex_names[v.index()]);
        let [left, right] = [left, right].map(|f| draft.face_names[f.index()]);
        return Err(BlockError::FlatEdge { p, q, left, right });
    }
    for v in topology.vertex_ids() {
        if let [first, second] = topology.vertex_edges(v) {
            let name = |v: VertexId| draft.vertex_names[v.index()];
            return Err(BlockError::TwoEdgeVertex {
                vertex: name(v),
                before: name(topology.edge(*first).other(v)),
                after: name(topology.edge(*second).other(v)),
            });
        }
    }
    let (vertices, edges, faces) = (topology.vertex_count(), topology.edges().len(), topology.faces().len());
    let euler = vertices as i64 - edges as i64 + faces as i64;
    if signs.iter().all(|s| s.is_positive()) && euler != 2 {
        return Err(BlockError::RunsThroughItself { edges, euler });
    }
    Ok(())
}

/// Faces meet in common vertices and edges only.
fn check_embedded(draft: &BlockDraft, options: &BlockOptions) -> Result<(), BlockError> {
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let surface = Surface::new(&coordinates, draft.topology.faces());
    let slack = Planarity::new(&coordinates, options).slack();
    match TriangulatedFaces::new(&surface, &draft.topology, &draft.approximate, slack).first_intersection() {
        None => Ok(()),
        Some(FaceIntersection { faces: [first, second], line: [p, q], diagonal }) => Err(BlockError::FacesMeet {
            first: draft.face_names[first],
            second: draft.face_names[second],
            p: draft.vertex_names[p.index()],
            q: draft.vertex_names[q.index()],
            diagonal,
        }),
    }
}

/// The faces of a block as triangles between its own vertices; see [`Block::triangles`].
pub(super) fn triangles(block: &Block, options: &BlockOptions) -> Vec<[VertexId; 3]> {
    let approximate: Vec<[f64; 3]> = block.vertices.iter().map(|v| v.components().map(|c| c.approximate())).collect();
    let coordinates = Coordinates::new(&block.vertices, &approximate);
    let surface = Surface::new(&coordinates, block.topology().faces());
    let slack = Planarity::new(&coordinates, options).slack();
    let cut = |face| TriangulatedFace::new(&surface, face, &approximate, slack).triangles;
    (0..block.topology().faces().len()).flat_map(cut).collect()
}

fn shape(draft: &BlockDraft, signs: &[Sign]) -> Result<BlockShape, BlockError> {
    let coordinates = Coordinates::new(&draft.vertices, &draft.approximate);
    let topology = draft.topology.clone();
    let surface = Surface::new(&coordinates, topology.faces());
    let edge_convex: Vec<bool> = signs.iter().map(|s| s.is_positive()).collect();
    let vertex_convex =
        topology.vertex_ids().map(|v| topology.vertex_edges(v).iter().all(|&e| edge_convex[e.index()])).collect();
    let face_convex = (0..topology.faces().len()).map(|face| turns_left_only(&surface, face)).collect();
    let convex = edge_convex.iter().all(|&c| c);
    drop(surface);
    Ok(BlockShape { topology, edge_convex, vertex_convex, face_convex, convex })
}

/// Whether a simple loop is a convex polygon; a straight angle counts as convex.
fn turns_left_only(surface: &Surface<'_>, face: usize) -> bool {
    let boundary = &surface.faces()[face];
    let n = boundary.len();
    n == 3
        || (0..n).all(|k| {
            let [a, b, c] = [k, k + 1, k + 2].map(|i| boundary[i % n]);
            surface.sign(&Orientation { face, a, b, c }).is_at_least_zero()
        })
}
