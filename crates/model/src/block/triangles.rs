//! A face as triangles between its own vertices: the surface that stands for it where faces are tested against faces.

use crate::block::certain_sign::Surface;
use crate::block::polynomials::{Orientation, SideOfPlane};
use crate::sign::Sign;
use crate::topology::VertexId;

/// The triangles of a face, counter-clockwise like its loop, none of them without area seen along the face's normal.
pub(super) struct TriangulatedFace {
    pub(super) triangles: Vec<[VertexId; 3]>,
    /// The sides of triangles that are no edges of the face.
    pub(super) diagonals: Vec<[VertexId; 2]>,
    /// Triangles in whose planes all triangles lie: one of a long face that is exactly planar, else all.
    pub(super) planes: Vec<[VertexId; 3]>,
    /// Whether the face, seen along its normal, is a convex polygon; a straight angle counts as convex.
    pub(super) is_convex: bool,
}

impl TriangulatedFace {
    /// Cuts up a face whose loop is a simple polygon seen along its normal. `slack` is how far, in metres, its vertices
    /// may be from its plane. Only signs of turns decide, so a turned face gives the same triangles.
    pub(super) fn new(surface: &Surface<'_>, face: usize, approximate: &[[f64; 3]], slack: f64) -> TriangulatedFace {
        let boundary = &surface.faces()[face];
        let n = boundary.len();
        if let &[a, b, c] = boundary.as_slice() {
            let triangles = vec![[a, b, c]];
            return TriangulatedFace { planes: triangles.clone(), triangles, diagonals: Vec::new(), is_convex: true };
        }
        let turn = |k: usize| {
            let [a, b, c] = [k + n - 1, k, k + 1].map(|i| boundary[i % n]);
            surface.sign(&Orientation { face, a, b, c })
        };
        let turns: Vec<Sign> = (0..n).map(turn).collect();
        if turns.iter().all(|t| t.is_positive()) {
            let triangles: Vec<[VertexId; 3]> =
                boundary[1..].windows(2).map(|pair| [boundary[0], pair[0], pair[1]]).collect();
            let diagonals = boundary[2..n - 1].iter().map(|&v| [boundary[0], v]).collect();
            return TriangulatedFace {
                planes: planes(surface, boundary, &triangles),
                triangles,
                diagonals,
                is_convex: true,
            };
        }
        let is_convex = turns.iter().all(|t| t.is_at_least_zero());
        let blunt = (0..n).filter(|&k| turns[k].is_at_most_zero()).map(|k| boundary[k]).collect();
        let (triangles, diagonals) = EarClipping { surface, face, approximate, slack, blunt }.clipped();
        TriangulatedFace { planes: planes(surface, boundary, &triangles), triangles, diagonals, is_convex }
    }
}

/// See [`TriangulatedFace::planes`]. Of a short face a proof that it is planar costs more than it saves.
fn planes(surface: &Surface<'_>, boundary: &[VertexId], triangles: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    const LONG: usize = 32;
    let is_on = |plane: [VertexId; 3]| {
        boundary.iter().all(|&vertex| surface.coordinates().sign(&SideOfPlane { plane, vertex }).is_zero())
    };
    match triangles {
        [first, ..] if boundary.len() > LONG && is_on(*first) => vec![*first],
        all => all.to_vec(),
    }
}

/// Ear clipping (Meisters 1975): a simple polygon of more than three vertices has two ears.
struct EarClipping<'a, 's> {
    surface: &'a Surface<'s>,
    face: usize,
    approximate: &'a [[f64; 3]],
    slack: f64,
    /// Vertices whose angle is 180° or more. Of the vertices within an ear's triangle the one furthest from the
    /// diagonal has such an angle, so no others need to be looked at; clipping makes angles smaller only.
    blunt: Vec<VertexId>,
}

impl EarClipping<'_, '_> {
    fn clipped(&self) -> (Vec<[VertexId; 3]>, Vec<[VertexId; 2]>) {
        let mut rest = self.surface.faces()[self.face].clone();
        let (mut triangles, mut diagonals) = (Vec::new(), Vec::new());
        let mut place = 0;
        while rest.len() > 3 {
            let n = rest.len();
            let corner = |k: usize| [k + n - 1, k, k + 1].map(|i| rest[i % n]);
            // By the theorem there is always one.
            let Some(ear) = (place..place + n).find(|&k| self.is_ear(corner(k), &rest)) else { break };
            let [u, v, w] = corner(ear);
            triangles.push([u, v, w]);
            diagonals.push([u, w]);
            rest.remove(ear % n);
            place = (ear % n + n - 2) % (n - 1);
        }
        if let &[a, b, c] = rest.as_slice() {
            triangles.push([a, b, c]);
        }
        (triangles, diagonals)
    }

    /// Whether u-v-w turns left and its triangle, boundary included, holds no other vertex of the rest.
    fn is_ear(&self, [u, v, w]: [VertexId; 3], rest: &[VertexId]) -> bool {
        let is_left = |a, b, c| self.surface.sign(&Orientation { face: self.face, a, b, c }).is_at_least_zero();
        let in_triangle = |z: VertexId| is_left(u, v, z) && is_left(v, w, z) && is_left(w, u, z);
        let spans = self.spans([u, v, w]);
        self.surface.sign(&Orientation { face: self.face, a: u, b: v, c: w }).is_positive()
            && !self
                .blunt
                .iter()
                .any(|&z| ![u, v, w].contains(&z) && self.is_within(z, &spans) && rest.contains(&z) && in_triangle(z))
    }

    /// A box so wide that a point outside it is outside the triangle, seen along the normal.
    fn spans(&self, triangle: [VertexId; 3]) -> [(f64, f64); 3] {
        std::array::from_fn(|axis| {
            let all = triangle.map(|v| self.approximate[v.index()][axis]);
            let least = all.iter().fold(f64::INFINITY, |least, &c| least.min(c));
            let most = all.iter().fold(f64::NEG_INFINITY, |most, &c| most.max(c));
            let margin = 2.0 * self.slack + (least.abs() + most.abs()) * 1e-12;
            (least - margin, most + margin)
        })
    }

    fn is_within(&self, vertex: VertexId, spans: &[(f64, f64); 3]) -> bool {
        let place = &self.approximate[vertex.index()];
        (0..3).all(|axis| (spans[axis].0..=spans[axis].1).contains(&place[axis]))
    }
}
