//! Blocks a second time, on integers: edges and their numbers, κ, convexity, and what merging leaves of triangulated and divided surfaces.

use proptest::prelude::*;
use rockproof_model::{Block, BlockOptions, EdgeId, FaceId, Number, Point, Vec3, VertexId};
use std::collections::{BTreeMap, BTreeSet};

pub(super) type Units = [i128; 3];

pub(super) fn minus(p: Units, q: Units) -> Units {
    [0, 1, 2].map(|k| p[k] - q[k])
}

pub(super) fn cross(p: Units, q: Units) -> Units {
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

pub(super) fn dot(p: Units, q: Units) -> i128 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

/// A surface on whole numbers.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) vertices: Vec<Units>,
    pub(super) faces: Vec<Vec<usize>>,
}

/// A block as docs/spec.md, section 2, says it: edges by the sorted pair of their ends, with κ.
pub(super) struct Second {
    pub(super) edges: Vec<([usize; 2], i128)>,
}

impl Surface {
    /// N = Σ (v_k − v_0) × (v_{k+1} − v_0).
    pub(super) fn normal(&self, face: &[usize]) -> Units {
        let at = |k: usize| minus(self.vertices[face[k]], self.vertices[face[0]]);
        (1..face.len() - 1).fold([0; 3], |sum, k| {
            let more = cross(at(k), at(k + 1));
            [0, 1, 2].map(|axis| sum[axis] + more[axis])
        })
    }

    /// The face in whose loop an edge runs from one vertex to another.
    fn faces_by_edge(&self) -> BTreeMap<(usize, usize), usize> {
        let of_face = |(number, face): (usize, &Vec<usize>)| {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(p, q)| ((*p, *q), number)).collect::<Vec<_>>()
        };
        self.faces.iter().enumerate().flat_map(of_face).collect()
    }

    pub(super) fn second(&self) -> Second {
        let of = self.faces_by_edge();
        let pairs: BTreeSet<[usize; 2]> = of.keys().map(|&(p, q)| [p.min(q), p.max(q)]).collect();
        let kappa = |&[p, q]: &[usize; 2]| {
            let [left, right] = [of[&(p, q)], of[&(q, p)]].map(|face| self.normal(&self.faces[face]));
            dot(cross(left, right), minus(self.vertices[q], self.vertices[p]))
        };
        Second { edges: pairs.iter().map(|pair| (*pair, kappa(pair))).collect() }
    }

    fn block(&self) -> Block {
        let number = |n: i128| Number::from_integer(i32::try_from(n).expect("a small number"));
        let point = |v: &Units| -> Point { Vec3::new(number(v[0]), number(v[1]), number(v[2])) };
        let faces = self.faces.iter().map(|face| face.iter().map(|&v| v as u32).collect()).collect();
        Block::new(self.vertices.iter().map(point).collect(), faces, &BlockOptions::default()).expect("a block")
    }

    /// The surface under a linear map that does not mirror.
    pub(super) fn mapped(&self, matrix: [Units; 3]) -> Surface {
        let vertices = self.vertices.iter().map(|v| matrix.map(|row| dot(row, *v))).collect();
        Surface { vertices, faces: self.faces.clone() }
    }

    /// Every face cut into triangles: from a vertex of each from which that is possible.
    fn triangulated(&self) -> Surface {
        let fan = |face: &Vec<usize>| -> Vec<Vec<usize>> {
            let normal = self.normal(face);
            let from = |start: usize| -> Vec<Vec<usize>> {
                let at = |k: usize| face[(start + k) % face.len()];
                (1..face.len() - 1).map(|k| vec![at(0), at(k), at(k + 1)]).collect()
            };
            let mut all = (0..face.len()).map(from);
            let is_inside = |fan: &Vec<Vec<usize>>| fan.iter().all(|t| dot(self.normal(t), normal) > 0);
            all.find(is_inside).expect("a polygon that one of its corners sees whole")
        };
        Surface { vertices: self.vertices.clone(), faces: self.faces.iter().flat_map(fan).collect() }
    }

    /// Every triangle cut into four, at the middles of its edges; coordinates are doubled.
    fn divided(&self) -> Surface {
        let mut vertices: Vec<Units> = self.vertices.iter().map(|v| v.map(|c| 2 * c)).collect();
        let mut middles: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        let mut faces = Vec::new();
        for face in &self.faces {
            let [a, b, c] = [face[0], face[1], face[2]];
            let mut middle = |p: usize, q: usize| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    vertices.push([0, 1, 2].map(|axis| self.vertices[p][axis] + self.vertices[q][axis]));
                    vertices.len() - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            faces.extend([vec![a, ab, ca], vec![b, bc, ab], vec![c, ca, bc], vec![ab, bc, ca]]);
        }
        Surface { vertices, faces }
    }
}

/// Convex and concave: a box, a tetrahedron, an octahedron, a wedge, an L and an arrow, each standing on its polygon.
pub(super) fn shapes() -> Vec<(&'static str, Surface)> {
    let prism = |polygon: &[[i128; 2]], height: i128| {
        let n = polygon.len();
        let at = |z: i128| polygon.iter().map(move |[x, y]| [*x, *y, z]);
        let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
        let faces = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
        Surface { vertices: at(0).chain(at(height)).collect(), faces }
    };
    let tetrahedron = Surface {
        vertices: vec![[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]],
        faces: vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]],
    };
    let octahedron = Surface {
        vertices: vec![[2, 0, 0], [0, 2, 0], [-2, 0, 0], [0, -2, 0], [0, 0, 2], [0, 0, -2]],
        faces: (0..4).flat_map(|k| [vec![k, (k + 1) % 4, 4], vec![(k + 1) % 4, k, 5]]).collect(),
    };
    vec![
        ("box", prism(&[[0, 0], [4, 0], [4, 2], [0, 2]], 6)),
        ("tetrahedron", tetrahedron),
        ("octahedron", octahedron),
        ("wedge", prism(&[[0, 0], [6, 0], [0, 4]], 4)),
        ("L", prism(&[[0, 0], [8, 0], [8, 4], [4, 4], [4, 8], [0, 8]], 2)),
        ("arrow", prism(&[[0, 0], [4, 2], [8, 0], [4, 8]], 2)),
    ]
}

/// Edges that are reflex, and blocks that are convex, by hand.
const BY_HAND: [(&str, usize, usize); 6] =
    [("box", 12, 0), ("tetrahedron", 6, 0), ("octahedron", 12, 0), ("wedge", 9, 0), ("L", 18, 1), ("arrow", 12, 1)];

#[test]
fn shapes_have_the_edges_that_one_counts() {
    for ((name, surface), (wanted, edges, reflex)) in shapes().into_iter().zip(BY_HAND) {
        let block = surface.block();
        let found = (0..edges as u32).filter(|edge| !block.edge_is_convex(EdgeId(*edge))).count();
        assert_eq!(
            (name, block.topology().edges().len(), found, block.is_convex()),
            (wanted, edges, reflex, reflex == 0)
        );
    }
}

/// A loop of points that begins with the least of them.
fn from_least(mut points: Vec<Units>) -> Vec<Units> {
    let least = (0..points.len()).min_by_key(|k| points[*k]).unwrap_or(0);
    points.rotate_left(least);
    points
}

/// The points of a block, which are whole numbers.
fn units_of(block: &Block) -> Vec<Units> {
    let unit = |n: &Number| n.approximate() as i128;
    block.vertices().iter().map(|v| [unit(&v.x), unit(&v.y), unit(&v.z)]).collect()
}

pub(super) fn matrix() -> impl Strategy<Value = [Units; 3]> {
    let row = || prop::array::uniform3(-3_i32..=3).prop_map(|row| row.map(i128::from));
    [row(), row(), row()].prop_filter("no mirror", |[a, b, c]| dot(cross(*a, *b), *c) > 0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 40 } else { 300 }))]

    /// The number of each edge, its faces, and every flag of convexity.
    #[test]
    fn edges_and_convexity_are_as_the_specification_says(number in 0_usize..6, matrix in matrix()) {
        let (name, surface) = shapes().swap_remove(number);
        let surface = surface.mapped(matrix);
        let (block, second, of) = (surface.block(), surface.second(), surface.faces_by_edge());
        prop_assert_eq!(block.topology().edges().len(), second.edges.len(), "{}", name);
        for (k, (edge, ([p, q], kappa))) in block.topology().edges().iter().zip(&second.edges).enumerate() {
            prop_assert_eq!([edge.p.index(), edge.q.index()], [*p, *q], "{} edge {}", name, k);
            prop_assert_eq!([edge.left.index(), edge.right.index()], [of[&(*p, *q)], of[&(*q, *p)]], "{} edge {}", name, k);
            prop_assert!(*kappa != 0);
            prop_assert_eq!(block.edge_is_convex(EdgeId(k as u32)), *kappa > 0, "{} edge {}", name, k);
        }
        for vertex in 0..surface.vertices.len() {
            let convex = second.edges.iter().filter(|([p, q], _)| [*p, *q].contains(&vertex)).all(|(_, kappa)| *kappa > 0);
            prop_assert_eq!(block.vertex_is_convex(VertexId(vertex as u32)), convex, "{} vertex {}", name, vertex);
        }
        prop_assert_eq!(block.is_convex(), second.edges.iter().all(|(_, kappa)| *kappa > 0));
        // Lists of edges and faces by vertex, ascending, and of edges by face, in the order of its loop.
        let number_of = |p: usize, q: usize| second.edges.iter().position(|(ends, _)| *ends == [p.min(q), p.max(q)]);
        for vertex in 0..surface.vertices.len() {
            let at = VertexId(vertex as u32);
            let edges: Vec<usize> = (0..second.edges.len()).filter(|&k| second.edges[k].0.contains(&vertex)).collect();
            let faces: Vec<usize> = (0..surface.faces.len()).filter(|&k| surface.faces[k].contains(&vertex)).collect();
            prop_assert_eq!(block.topology().vertex_edges(at).iter().map(|e| e.index()).collect::<Vec<_>>(), edges);
            prop_assert_eq!(block.topology().vertex_faces(at).iter().map(|f| f.index()).collect::<Vec<_>>(), faces);
        }
        for (k, face) in surface.faces.iter().enumerate() {
            let round = face.iter().zip(face.iter().cycle().skip(1));
            let edges: Vec<Option<usize>> = round.map(|(&p, &q)| number_of(p, q)).collect();
            let found = block.topology().face_edges(FaceId(k as u32)).iter().map(|e| Some(e.index()));
            prop_assert_eq!(found.collect::<Vec<_>>(), edges);
        }
        for (k, face) in surface.faces.iter().enumerate() {
            let (normal, n) = (surface.normal(face), face.len());
            let corner = |i: usize| [0, 1, 2].map(|j| surface.vertices[face[(i + j) % n]]);
            let turns_left = |[a, b, c]: [Units; 3]| dot(cross(minus(b, a), minus(c, b)), normal) > 0;
            prop_assert_eq!(block.face_is_convex(FaceId(k as u32)), (0..n).all(|i| turns_left(corner(i))), "{} face {}", name, k);
        }
    }

    /// A surface cut into triangles, and those into four, is the block that it was before: the same corners in the same order, and the same loops.
    #[test]
    fn merging_undoes_triangles_and_vertices_in_line(number in 0_usize..6, matrix in matrix(), divide: bool) {
        let (name, surface) = shapes().swap_remove(number);
        let surface = surface.mapped(matrix);
        let (cut, factor) = match divide {
            true => (surface.triangulated().divided(), 2),
            false => (surface.triangulated(), 1),
        };
        let merged = cut.block();
        let wanted: Vec<Units> = surface.vertices.iter().map(|v| v.map(|c| factor * c)).collect();
        let found = units_of(&merged);
        prop_assert_eq!(&found, &wanted, "{}: corners, and no vertex in line", name);
        let loops = |points: &[Units], faces: Vec<Vec<usize>>| -> Vec<Vec<Units>> {
            faces.into_iter().map(|face| from_least(face.into_iter().map(|v| points[v]).collect())).collect()
        };
        let faces = merged.topology().faces().iter().map(|face| face.iter().map(|&v| v.index()).collect()).collect();
        prop_assert_eq!(loops(&found, faces), loops(&wanted, surface.faces.clone()), "{}", name);
    }
}
