//! Convex polyhedra cut by planes, exactly. Coordinates are homogeneous integers, so a cut never rounds and the numbers
//! stay as small as the planes that meet at a vertex allow.

use super::lattice_solid::number_of;
use num_integer::Integer;
use rockproof_model::{Block, BlockError, BlockOptions, Number, Vec3};

/// The half space `normal·x <= level`, everything in lattice units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfSpace {
    /// Points out of the part that stays.
    pub normal: [i128; 3],
    /// `normal·x` of the plane's points.
    pub level: i128,
}

impl HalfSpace {
    /// The plane with the other side kept.
    #[must_use]
    pub fn reversed(self) -> HalfSpace {
        HalfSpace { normal: self.normal.map(|c| -c), level: -self.level }
    }
}

/// Why a cut left no block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClipError {
    /// Nothing, or nothing solid, on the side that was to stay.
    #[error("nothing is left of the block on the plane's inner side")]
    Empty,
    /// Numbers beyond 128 bits.
    #[error("the cut needs numbers of more than 126 bits")]
    TooLarge,
    /// What was left is not a canonical block.
    #[error(transparent)]
    Block(#[from] BlockError),
}

/// A point `(x, y, z) / w` in lattice units, `w > 0`, in lowest terms.
type Homogeneous = [i128; 4];

/// A convex polyhedron while it is being cut.
#[derive(Clone, Debug)]
pub struct ClippedPolyhedron {
    vertices: Vec<Homogeneous>,
    faces: Vec<Vec<u32>>,
    denominator: i128,
}

impl ClippedPolyhedron {
    /// The box between two corners, given in units of `1/denominator` metres.
    pub fn cuboid(low: [i128; 3], high: [i128; 3], denominator: i128) -> ClippedPolyhedron {
        let corner = |i: usize| {
            let side = |bit: usize, axis: usize| if i >> bit & 1 == 1 { high[axis] } else { low[axis] };
            [side(0, 0), side(1, 1), side(2, 2), 1]
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
            .map(Vec::from)
            .to_vec();
        ClippedPolyhedron { vertices: (0..8).map(corner).collect(), faces, denominator }
    }

    /// What lies on the inner side of `plane`; the cut closes with a new last face where it takes something away.
    ///
    /// # Errors
    /// When nothing solid is left, or numbers outgrow 126 bits.
    pub fn clipped(&self, plane: HalfSpace) -> Result<ClippedPolyhedron, ClipError> {
        let heights = self.vertices.iter().map(|v| height(&plane, v)).collect::<Option<Vec<i128>>>();
        let heights = heights.ok_or(ClipError::TooLarge)?;
        if heights.iter().all(|&h| h <= 0) {
            return Ok(self.clone());
        }
        if heights.iter().all(|&h| h >= 0) {
            return Err(ClipError::Empty);
        }
        let mut cut = Clipping {
            old: self,
            heights,
            vertices: Vec::new(),
            kept: vec![None; self.vertices.len()],
            crossings: Vec::new(),
        };
        let mut faces = Vec::new();
        let mut rim = Vec::new();
        for face in &self.faces {
            let (polygon, seam) = cut.polygon(face)?;
            if polygon.len() >= 3 {
                faces.push(polygon);
            }
            rim.extend(seam);
        }
        faces.push(chain(&rim).ok_or(ClipError::Empty)?);
        Ok(ClippedPolyhedron { vertices: cut.vertices, faces, denominator: self.denominator })
    }

    /// The block, its length scaled by `2^exponent`.
    ///
    /// # Errors
    /// When the surface is not a canonical block: cuts through a vertex or along a face can leave one.
    pub fn block(&self, exponent: i32) -> Result<Block, ClipError> {
        let vertices = self
            .vertices
            .iter()
            .map(|[x, y, z, w]| {
                let number = |c: &i128| number_of(*c, w * self.denominator, exponent);
                Vec3::new(number(x), number(y), number(z))
            })
            .collect();
        Ok(Block::new(vertices, self.faces.clone(), &BlockOptions { planarity: Number::ZERO })?)
    }
}

/// What is left of a face, and the directed edge that the cut's own face runs along it.
type Clipped = (Vec<u32>, Option<(u32, u32)>);

/// `normal·(x, y, z) − level·w`, of the sign of the distance; `None` beyond 126 bits.
fn height(plane: &HalfSpace, [x, y, z, w]: &Homogeneous) -> Option<i128> {
    let [a, b, c] = plane.normal;
    let sum = a.checked_mul(*x)?.checked_add(b.checked_mul(*y)?)?.checked_add(c.checked_mul(*z)?)?;
    sum.checked_sub(plane.level.checked_mul(*w)?)
}

struct Clipping<'a> {
    old: &'a ClippedPolyhedron,
    heights: Vec<i128>,
    vertices: Vec<Homogeneous>,
    kept: Vec<Option<u32>>,
    /// Old edge (inner vertex, outer vertex) and the new vertex on it.
    crossings: Vec<((u32, u32), u32)>,
}

impl Clipping<'_> {
    fn polygon(&mut self, face: &[u32]) -> Result<Clipped, ClipError> {
        let mut polygon = Vec::new();
        let mut on_plane = Vec::new();
        let mut inside = false;
        for k in 0..face.len() {
            let (p, q) = (face[k], face[(k + 1) % face.len()]);
            let (hp, hq) = (self.heights[p as usize], self.heights[q as usize]);
            inside |= hp < 0;
            if hp <= 0 {
                let new = self.keep(p);
                polygon.push(new);
                if hp == 0 {
                    on_plane.push(polygon.len() - 1);
                }
            }
            if (hp < 0 && hq > 0) || (hp > 0 && hq < 0) {
                let (inner, outer) = if hp < 0 { (p, q) } else { (q, p) };
                polygon.push(self.crossing(inner, outer)?);
                on_plane.push(polygon.len() - 1);
            }
        }
        if !inside {
            return Ok((Vec::new(), None));
        }
        // A convex face with something inside meets the plane in at most two of its corners, one after the other.
        let seam = match on_plane[..] {
            [i, j] if i + 1 == j => Some((polygon[j], polygon[i])),
            [i, j] if i == 0 && j + 1 == polygon.len() => Some((polygon[i], polygon[j])),
            _ => None,
        };
        Ok((polygon, seam))
    }

    fn keep(&mut self, vertex: u32) -> u32 {
        let vertices = &mut self.vertices;
        *self.kept[vertex as usize].get_or_insert_with(|| {
            vertices.push(self.old.vertices[vertex as usize]);
            vertices.len() as u32 - 1
        })
    }

    fn crossing(&mut self, inner: u32, outer: u32) -> Result<u32, ClipError> {
        if let Some((_, known)) = self.crossings.iter().find(|(edge, _)| *edge == (inner, outer)) {
            return Ok(*known);
        }
        let (p, q) = (&self.old.vertices[inner as usize], &self.old.vertices[outer as usize]);
        let (down, up) = (-self.heights[inner as usize], self.heights[outer as usize]);
        let mut point = [0; 4];
        for (i, c) in point.iter_mut().enumerate() {
            let sum = p[i].checked_mul(up).zip(q[i].checked_mul(down)).and_then(|(a, b)| a.checked_add(b));
            *c = sum.ok_or(ClipError::TooLarge)?;
        }
        let common = point.iter().fold(0i128, |g, c| g.gcd(c));
        self.vertices.push(point.map(|c| c / common));
        let new = self.vertices.len() as u32 - 1;
        self.crossings.push(((inner, outer), new));
        Ok(new)
    }
}

/// The loop that runs along all of `edges`; `None` when they form none.
fn chain(edges: &[(u32, u32)]) -> Option<Vec<u32>> {
    let mut face = vec![edges.first()?.0];
    while face.len() <= edges.len() {
        let last = *face.last()?;
        let next = edges.iter().find(|(p, _)| *p == last)?.1;
        if next == face[0] {
            return (face.len() == edges.len() && face.len() >= 3).then_some(face);
        }
        face.push(next);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> ClippedPolyhedron {
        ClippedPolyhedron::cuboid([0; 3], [12, 12, 12], 12)
    }

    #[test]
    fn halves_share_their_cut() {
        let plane = HalfSpace { normal: [1, 2, 5], level: 47 };
        let below = unit_box().clipped(plane).unwrap().block(0).unwrap();
        let above = unit_box().clipped(plane.reversed()).unwrap().block(0).unwrap();
        assert!(below.is_convex() && above.is_convex());
        let shared = |a: &Block, b: &Block| a.vertices().iter().filter(|v| b.vertices().contains(v)).count();
        assert_eq!(shared(&below, &above), below.topology().faces().last().unwrap().len());
        assert!(below.coordinates().any(|c| c.as_f64().is_none()));
    }

    #[test]
    fn cuts_through_corners_and_edges_stay_blocks() {
        for (normal, level) in [([1, 1, 0], 12), ([1, 1, 1], 12), ([1, 0, 0], 5), ([2, 1, 0], 12)] {
            let plane = HalfSpace { normal, level };
            for side in [plane, plane.reversed()] {
                assert!(unit_box().clipped(side).unwrap().block(3).unwrap().is_convex(), "{side:?}");
            }
        }
    }

    #[test]
    fn a_plane_that_misses_keeps_all_or_nothing() {
        let whole = unit_box().clipped(HalfSpace { normal: [0, 0, 1], level: 12 }).unwrap();
        assert_eq!(whole.vertices.len(), 8);
        assert!(matches!(unit_box().clipped(HalfSpace { normal: [0, 0, 1], level: 0 }), Err(ClipError::Empty)));
    }
}
