//! The combinatorics of a block: which vertices, edges and faces meet. No coordinates.

use std::collections::BTreeMap;

/// How the faces of a block fit together. Vertices and faces are numbered as in the input, edges by the sorted pair
/// of their vertex indices (SPEC section 4, "Result").
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    vertex_count: usize,
    faces: Vec<Vec<u32>>,
    face_edges: Lists,
    edges: Vec<Edge>,
    vertex_edges: Lists,
    vertex_faces: Lists,
}

/// Lists of numbers, one behind the other: of a small block, vectors of vectors would take several times the memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Lists {
    ends: Vec<u32>,
    numbers: Vec<u32>,
}

impl Lists {
    fn new(lists: &[Vec<u32>]) -> Lists {
        let mut all = Lists { ends: Vec::with_capacity(lists.len()), numbers: lists.concat() };
        let mut end = 0;
        all.ends.extend(lists.iter().map(|list| {
            end += list.len() as u32;
            end
        }));
        all
    }

    #[inline]
    fn of(&self, k: u32) -> &[u32] {
        let begin = if k == 0 { 0 } else { self.ends[k as usize - 1] };
        &self.numbers[begin as usize..self.ends[k as usize] as usize]
    }
}

/// An edge from vertex `p` to vertex `q`, `p < q`, with its direction `d = q − p`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Vertex with the lower index; the edge's direction starts here.
    pub p: u32,
    /// Vertex with the higher index.
    pub q: u32,
    /// The face L, in whose loop the edge runs p → q.
    pub left: u32,
    /// The face R, in whose loop the edge runs q → p.
    pub right: u32,
}

impl Edge {
    /// The edge's other end.
    pub fn other(&self, vertex: u32) -> u32 {
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
    #[error("the surface is open at edge {p}-{q} of face {face}: no other face runs {q} to {p}")]
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
    #[error("the faces form more than one shell: face {face} is not connected to face 0")]
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
    pub fn new(vertex_count: usize, faces: Vec<Vec<u32>>) -> Result<Topology, TopologyError> {
        if vertex_count < 4 || faces.len() < 4 {
            return Err(TopologyError::TooFew { vertices: vertex_count, faces: faces.len() });
        }
        let half_edges = half_edges(vertex_count, &faces)?;
        let mut edges = Vec::new();
        for (&(p, q), &left) in &half_edges {
            match half_edges.get(&(q, p)) {
                None => return Err(TopologyError::Open { p, q, face: left as usize }),
                Some(&right) if p < q => edges.push(Edge { p, q, left, right }),
                Some(_) => {}
            }
        }
        let mut topology = Topology {
            vertex_count,
            face_edges: Lists::default(),
            faces,
            vertex_edges: Lists::default(),
            vertex_faces: Lists::default(),
            edges,
        };
        topology.link();
        topology.check_vertices()?;
        topology.check_connected()?;
        Ok(topology)
    }

    fn link(&mut self) {
        let mut at_vertices = vec![Vec::new(); self.vertex_count];
        for (i, edge) in (0..).zip(&self.edges) {
            at_vertices[edge.p as usize].push(i);
            at_vertices[edge.q as usize].push(i);
        }
        self.vertex_edges = Lists::new(&at_vertices);
        at_vertices.iter_mut().for_each(Vec::clear);
        for (i, face) in (0..).zip(&self.faces) {
            for &v in face {
                at_vertices[v as usize].push(i);
            }
        }
        self.vertex_faces = Lists::new(&at_vertices);
        let of_face =
            |face: &Vec<u32>| loop_pairs(face).map(|(p, q)| self.edge_between(p, q).unwrap_or(u32::MAX)).collect();
        self.face_edges = Lists::new(&self.faces.iter().map(of_face).collect::<Vec<Vec<u32>>>());
    }

    fn check_vertices(&self) -> Result<(), TopologyError> {
        for vertex in 0..self.vertex_count {
            let faces = self.vertex_faces(vertex as u32);
            if faces.is_empty() {
                return Err(TopologyError::UnusedVertex { vertex });
            }
            // Walk the fan: from each face leave by the edge that arrives at the vertex.
            let mut face = faces[0];
            let mut steps = 0;
            loop {
                let boundary = &self.faces[face as usize];
                let at = boundary.iter().position(|&v| v as usize == vertex).unwrap_or(0);
                let edge = &self.edges[self.face_edges(face)[(at + boundary.len() - 1) % boundary.len()] as usize];
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
        let mut queue = vec![0u32];
        seen[0] = true;
        while let Some(face) = queue.pop() {
            for &edge in self.face_edges(face) {
                let edge = &self.edges[edge as usize];
                for next in [edge.left, edge.right] {
                    if !std::mem::replace(&mut seen[next as usize], true) {
                        queue.push(next);
                    }
                }
            }
        }
        match seen.iter().position(|&s| !s) {
            Some(face) => Err(TopologyError::Disconnected { face }),
            None => Ok(()),
        }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The face loops, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[Vec<u32>] {
        &self.faces
    }

    /// The edges, by the sorted pair of their vertex indices.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Edge numbers of a face: entry k joins loop vertices k and k + 1.
    pub fn face_edges(&self, face: u32) -> &[u32] {
        self.face_edges.of(face)
    }

    /// Edges at a vertex, ascending.
    pub fn vertex_edges(&self, vertex: u32) -> &[u32] {
        self.vertex_edges.of(vertex)
    }

    /// Faces at a vertex, ascending.
    pub fn vertex_faces(&self, vertex: u32) -> &[u32] {
        self.vertex_faces.of(vertex)
    }

    /// The edge that joins two vertices.
    pub fn edge_between(&self, p: u32, q: u32) -> Option<u32> {
        let key = (p.min(q), p.max(q));
        self.edges.binary_search_by_key(&key, |e| (e.p, e.q)).ok().map(|i| i as u32)
    }
}

/// The directed edges of a loop, the closing one included.
pub fn loop_pairs(face: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..face.len()).map(move |k| (face[k], face[(k + 1) % face.len()]))
}

fn half_edges(vertex_count: usize, faces: &[Vec<u32>]) -> Result<BTreeMap<(u32, u32), u32>, TopologyError> {
    let mut half_edges = BTreeMap::new();
    let mut last_seen = vec![usize::MAX; vertex_count];
    for (face, boundary) in faces.iter().enumerate() {
        if boundary.len() < 3 {
            return Err(TopologyError::ShortFace { face, found: boundary.len() });
        }
        for &v in boundary {
            match last_seen.get_mut(v as usize) {
                None => return Err(TopologyError::NoSuchVertex { face, found: v, last: vertex_count - 1 }),
                Some(seen) if *seen == face => return Err(TopologyError::VertexTwice { face, vertex: v }),
                Some(seen) => *seen = face,
            }
        }
        for (p, q) in loop_pairs(boundary) {
            if let Some(first) = half_edges.insert((p, q), face as u32) {
                return Err(TopologyError::SameDirection { p, q, first: first as usize, second: face });
            }
        }
    }
    Ok(half_edges)
}
