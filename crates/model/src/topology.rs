//! The combinatorics of a block: which vertices, edges and faces meet. No coordinates.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// Defines the number of one kind of feature as a type of its own, so that a vertex is never taken for a face.
macro_rules! numbers_of {
    ($(#[$about:meta])* $name:ident) => {
        $(#[$about])*
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The place in lists that hold one item for every such feature.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }

            /// The feature at this place of such a list; a block has fewer than 2³² features of a kind.
            #[inline]
            pub fn at(index: usize) -> $name {
                $name(index as u32)
            }
        }

        impl From<u32> for $name {
            fn from(number: u32) -> $name {
                $name(number)
            }
        }

        /// As its number alone: what holds it says which feature it is.
        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

numbers_of! {
    /// The number of a vertex of a block, as in the input.
    VertexId
}
numbers_of! {
    /// The number of an edge of a block: its place among the sorted pairs of vertices that edges join.
    EdgeId
}
numbers_of! {
    /// The number of a face of a block, as in the input.
    FaceId
}

/// How the faces of a block fit together. Vertices and faces are numbered as in the input, edges by the sorted pair
/// of their vertex indices (SPEC section 4, "Result").
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Topology {
    vertex_count: usize,
    faces: Vec<Vec<VertexId>>,
    face_edges: Lists<EdgeId>,
    edges: Vec<Edge>,
    vertex_edges: Lists<EdgeId>,
    vertex_faces: Lists<FaceId>,
}

/// Lists of numbers, one behind the other: of a small block, vectors of vectors would take several times the memory.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Lists<T> {
    ends: Vec<u32>,
    numbers: Vec<T>,
}

impl<T: Copy> Lists<T> {
    const EMPTY: Lists<T> = Lists { ends: Vec::new(), numbers: Vec::new() };

    fn new(lists: &[Vec<T>]) -> Lists<T> {
        let mut all = Lists { ends: Vec::with_capacity(lists.len()), numbers: lists.concat() };
        let mut end = 0;
        all.ends.extend(lists.iter().map(|list| {
            end += list.len() as u32;
            end
        }));
        all
    }

    #[inline]
    fn of(&self, k: usize) -> &[T] {
        let begin = if k == 0 { 0 } else { self.ends[k - 1] };
        &self.numbers[begin as usize..self.ends[k] as usize]
    }
}

/// An edge from vertex `p` to vertex `q`, `p < q`, with its direction `d = q − p`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Edge {
    /// Vertex with the lower index; the edge's direction starts here.
    pub p: VertexId,
    /// Vertex with the higher index.
    pub q: VertexId,
    /// The face L, in whose loop the edge runs p → q.
    pub left: FaceId,
    /// The face R, in whose loop the edge runs q → p.
    pub right: FaceId,
}

impl Edge {
    /// The edge's other end.
    pub fn other(&self, vertex: VertexId) -> VertexId {
        if vertex == self.p { self.q } else { self.p }
    }
}

/// Why a list of face loops is not the surface of a block.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TopologyError {
    /// Fewer than four faces or vertices.
    #[error("a block needs at least 4 vertices and 4 faces, found {vertices} vertices and {faces} faces")]
    TooFew {
        /// Vertices given.
        vertices: usize,
        /// Faces given.
        faces: usize,
    },
    /// A face with fewer than three vertices.
    #[error("face {face} has {found} vertices; a face needs at least 3")]
    ShortFace {
        /// The face.
        face: usize,
        /// Vertices in its loop.
        found: usize,
    },
    /// A vertex number that does not exist.
    #[error("face {face} names vertex {found}; vertices are numbered 0 to {last}")]
    NoSuchVertex {
        /// The face.
        face: usize,
        /// The number found.
        found: u32,
        /// The largest number allowed.
        last: usize,
    },
    /// A face loop that visits a vertex twice.
    #[error("face {face} visits vertex {vertex} twice; a face is a simple polygon")]
    VertexTwice {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// An edge with a face on one side only.
    #[error(
        "the surface is open at edge {p}-{q} of face {face}: no other face runs {q} to {p}; add the face that is missing there, or give the one that is there the same vertices (a T-junction)"
    )]
    Open {
        /// First vertex.
        p: u32,
        /// Second vertex.
        q: u32,
        /// The face that has the edge.
        face: usize,
    },
    /// Two faces that run the same edge in the same direction.
    #[error(
        "faces {first} and {second} both run edge {p} to {q}: either one of them is turned over, or more than two faces meet there"
    )]
    SameDirection {
        /// First vertex.
        p: u32,
        /// Second vertex.
        q: u32,
        /// The face seen first.
        first: usize,
        /// The face seen second.
        second: usize,
    },
    /// A vertex that no face uses.
    #[error("vertex {vertex} belongs to no face")]
    UnusedVertex {
        /// The vertex.
        vertex: usize,
    },
    /// A vertex at which two fans of faces meet.
    #[error("the surface is not a manifold at vertex {vertex}: its faces form more than one fan")]
    NonManifoldVertex {
        /// The vertex.
        vertex: usize,
    },
    /// Two surfaces that do not hang together.
    #[error("the faces form more than one shell: face {face} is not connected to face 0; a block has one, no cavity")]
    Disconnected {
        /// A face of the second shell.
        face: usize,
    },
}

impl Topology {
    /// Fits `faces` together.
    ///
    /// # Errors
    /// When the loops are not one closed, connected, consistently oriented 2-manifold using every vertex.
    pub fn new(vertex_count: usize, faces: Vec<Vec<impl Into<VertexId>>>) -> Result<Topology, TopologyError> {
        if vertex_count < 4 || faces.len() < 4 {
            return Err(TopologyError::TooFew { vertices: vertex_count, faces: faces.len() });
        }
        let numbered = |boundary: Vec<_>| boundary.into_iter().map(Into::into).collect();
        let faces: Vec<Vec<VertexId>> = faces.into_iter().map(numbered).collect();
        let half_edges = half_edges(vertex_count, &faces)?;
        let mut edges = Vec::new();
        for (&(p, q), &left) in &half_edges {
            match half_edges.get(&(q, p)) {
                None => return Err(TopologyError::Open { p: p.0, q: q.0, face: left.index() }),
                Some(&right) if p < q => edges.push(Edge { p, q, left, right }),
                Some(_) => {}
            }
        }
        let mut topology = Topology {
            vertex_count,
            face_edges: Lists::EMPTY,
            faces,
            vertex_edges: Lists::EMPTY,
            vertex_faces: Lists::EMPTY,
            edges,
        };
        topology.link();
        topology.check_vertices()?;
        topology.check_connected()?;
        Ok(topology)
    }

    fn link(&mut self) {
        let mut at_vertices = vec![Vec::new(); self.vertex_count];
        for (i, edge) in (0..).map(EdgeId).zip(&self.edges) {
            at_vertices[edge.p.index()].push(i);
            at_vertices[edge.q.index()].push(i);
        }
        self.vertex_edges = Lists::new(&at_vertices);
        let mut at_vertices = vec![Vec::new(); self.vertex_count];
        for (i, face) in (0..).map(FaceId).zip(&self.faces) {
            for &v in face {
                at_vertices[v.index()].push(i);
            }
        }
        self.vertex_faces = Lists::new(&at_vertices);
        let of_face = |face: &Vec<VertexId>| {
            loop_pairs(face).map(|(p, q)| self.edge_between(p, q).unwrap_or(EdgeId(u32::MAX))).collect()
        };
        self.face_edges = Lists::new(&self.faces.iter().map(of_face).collect::<Vec<Vec<EdgeId>>>());
    }

    fn check_vertices(&self) -> Result<(), TopologyError> {
        for vertex in 0..self.vertex_count {
            let faces = self.vertex_faces(VertexId::at(vertex));
            if faces.is_empty() {
                return Err(TopologyError::UnusedVertex { vertex });
            }
            // Walk the fan: from each face leave by the edge that arrives at the vertex.
            let mut face = faces[0];
            let mut steps = 0;
            loop {
                let boundary = self.face(face);
                let at = boundary.iter().position(|&v| v.index() == vertex).unwrap_or(0);
                let edge = self.edge(self.face_edges(face)[(at + boundary.len() - 1) % boundary.len()]);
                face = if edge.left == face { edge.right } else { edge.left };
                steps += 1;
                if face == faces[0] || steps > faces.len() {
                    break;
                }
            }
            if steps != faces.len() {
                return Err(TopologyError::NonManifoldVertex { vertex });
            }
        }
        Ok(())
    }

    fn check_connected(&self) -> Result<(), TopologyError> {
        let mut seen = vec![false; self.faces.len()];
        let mut queue = vec![FaceId(0)];
        seen[0] = true;
        while let Some(face) = queue.pop() {
            for &edge in self.face_edges(face) {
                let edge = self.edge(edge);
                for next in [edge.left, edge.right] {
                    if !std::mem::replace(&mut seen[next.index()], true) {
                        queue.push(next);
                    }
                }
            }
        }
        let apart = seen.iter().position(|&s| !s);
        apart.map_or(Ok(()), |face| Err(TopologyError::Disconnected { face }))
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The numbers of all vertices, ascending.
    pub fn vertex_ids(&self) -> impl DoubleEndedIterator<Item = VertexId> + ExactSizeIterator + use<> {
        (0..self.vertex_count).map(VertexId::at)
    }

    /// The numbers of all edges, ascending.
    pub fn edge_ids(&self) -> impl DoubleEndedIterator<Item = EdgeId> + ExactSizeIterator + use<> {
        (0..self.edges.len()).map(EdgeId::at)
    }

    /// The numbers of all faces, ascending.
    pub fn face_ids(&self) -> impl DoubleEndedIterator<Item = FaceId> + ExactSizeIterator + use<> {
        (0..self.faces.len()).map(FaceId::at)
    }

    /// The loop of a face, counter-clockwise seen from outside.
    #[inline]
    pub fn face(&self, face: FaceId) -> &[VertexId] {
        &self.faces[face.index()]
    }

    /// An edge's vertices and faces.
    #[inline]
    pub fn edge(&self, edge: EdgeId) -> &Edge {
        &self.edges[edge.index()]
    }

    /// The face loops, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[Vec<VertexId>] {
        &self.faces
    }

    /// The edges, by the sorted pair of their vertex indices.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Edge numbers of a face: entry k joins loop vertices k and k + 1.
    #[inline]
    pub fn face_edges(&self, face: FaceId) -> &[EdgeId] {
        self.face_edges.of(face.index())
    }

    /// Edges at a vertex, ascending.
    #[inline]
    pub fn vertex_edges(&self, vertex: VertexId) -> &[EdgeId] {
        self.vertex_edges.of(vertex.index())
    }

    /// Faces at a vertex, ascending.
    #[inline]
    pub fn vertex_faces(&self, vertex: VertexId) -> &[FaceId] {
        self.vertex_faces.of(vertex.index())
    }

    /// The edge that joins two vertices.
    pub fn edge_between(&self, p: VertexId, q: VertexId) -> Option<EdgeId> {
        let key = (p.min(q), p.max(q));
        self.edges.binary_search_by_key(&key, |e| (e.p, e.q)).ok().map(EdgeId::at)
    }
}

/// The directed edges of a loop, the closing one included.
pub fn loop_pairs<V: Copy>(face: &[V]) -> impl Iterator<Item = (V, V)> + '_ {
    (0..face.len()).map(move |k| (face[k], face[(k + 1) % face.len()]))
}

/// The face in whose loop each directed edge runs.
type HalfEdges = BTreeMap<(VertexId, VertexId), FaceId>;

fn half_edges(vertex_count: usize, faces: &[Vec<VertexId>]) -> Result<HalfEdges, TopologyError> {
    let mut half_edges = HalfEdges::new();
    let mut last_seen = vec![usize::MAX; vertex_count];
    for (face, boundary) in faces.iter().enumerate() {
        if boundary.len() < 3 {
            return Err(TopologyError::ShortFace { face, found: boundary.len() });
        }
        for &v in boundary {
            match last_seen.get_mut(v.index()) {
                None => return Err(TopologyError::NoSuchVertex { face, found: v.0, last: vertex_count - 1 }),
                Some(seen) if *seen == face => return Err(TopologyError::VertexTwice { face, vertex: v.0 }),
                Some(seen) => *seen = face,
            }
        }
        for (p, q) in loop_pairs(boundary) {
            if let Some(first) = half_edges.insert((p, q), FaceId::at(face)) {
                return Err(TopologyError::SameDirection { p: p.0, q: q.0, first: first.index(), second: face });
            }
        }
    }
    Ok(half_edges)
}
