//! Surfaces of polygons: points near one another joined, and the surface taken apart into blocks.

use crate::block::Point;
use crate::number::Number;
use crate::scene::raw::{FeatureLines, RawBlock};
use crate::topology::loop_pairs;
use std::collections::{BTreeSet, HashMap};

/// A polygon by numbers of points.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub(super) vertices: Vec<u32>,
    /// Where it stands, in a file of lines.
    pub(super) line: Option<usize>,
}

/// The blocks of a surface: one for every set of faces joined by edges, in the order of their first faces. Several have the name and a
/// number. Points in no face are left out. `lines` are those of the points, empty where the file has none.
pub(super) fn blocks(name: Option<&str>, faces: &[Face], points: &[Point], lines: &[usize]) -> Vec<RawBlock> {
    let components = components(faces);
    let count = components.len();
    let block = |(i, members): (usize, Vec<usize>)| {
        let faces: Vec<&Face> = members.iter().map(|&face| &faces[face]).collect();
        RawBlock {
            name: name.map(|name| if count == 1 { name.to_owned() } else { format!("{name}_{i}") }),
            line: faces.first().and_then(|face| face.line),
            ..of_faces(&faces, points, lines)
        }
    };
    components.into_iter().enumerate().map(block).collect()
}

/// A block of faces with the points that they name, and no others.
fn of_faces(faces: &[&Face], points: &[Point], lines: &[usize]) -> RawBlock {
    let used: BTreeSet<u32> = faces.iter().flat_map(|face| face.vertices.iter().copied()).collect();
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
    RawBlock {
        vertices: used.iter().map(|&v| points[v as usize].clone()).collect(),
        faces: faces.iter().map(|face| face.vertices.iter().map(|v| place[v]).collect()).collect(),
        lines: FeatureLines {
            vertices: used.iter().filter_map(|&v| lines.get(v as usize).copied()).collect(),
            faces: faces.iter().filter_map(|face| face.line).collect(),
        },
        ..RawBlock::default()
    }
}

/// Which faces are joined by edges. Where more than two faces have an edge, as where blocks touch along it, the first that runs along it
/// one way belongs to the first that runs the other way, the second to the second: files hold block after block.
pub(super) fn components(faces: &[Face]) -> Vec<Vec<usize>> {
    let mut uses: HashMap<(u32, u32), [Vec<usize>; 2]> = HashMap::new();
    for (i, face) in faces.iter().enumerate() {
        for (p, q) in loop_pairs(&face.vertices) {
            uses.entry((p.min(q), p.max(q))).or_default()[usize::from(p > q)].push(i);
        }
    }
    let mut sets = DisjointSets::new(faces.len());
    for [one_way, other_way] in uses.values() {
        let (longer, shorter) =
            if one_way.len() < other_way.len() { (other_way, one_way) } else { (one_way, other_way) };
        for (k, &face) in longer.iter().enumerate() {
            // What has no partner stays with the last that has, so that the edge is told with all of its faces.
            let partner = shorter.get(k).or(shorter.last()).unwrap_or(&longer[0]);
            sets.join(face, *partner);
        }
    }
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut components: Vec<Vec<usize>> = Vec::new();
    for face in 0..faces.len() {
        let number = *numbers.entry(sets.find(face)).or_insert(components.len());
        if number == components.len() {
            components.push(Vec::new());
        }
        components[number].push(face);
    }
    components
}

/// Union–find.
struct DisjointSets(Vec<usize>);

impl DisjointSets {
    fn new(count: usize) -> DisjointSets {
        DisjointSets((0..count).collect())
    }

    fn find(&mut self, mut member: usize) -> usize {
        while self.0[member] != member {
            self.0[member] = self.0[self.0[member]];
            member = self.0[member];
        }
        member
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.find(one), self.find(other));
        self.0[one.max(other)] = one.min(other);
    }
}

/// Joins points: each goes to the first point kept that is no further than `distance` (m) from it, decided exactly. Faces that have fewer
/// than three corners left are dropped.
pub(super) fn weld(faces: &mut Vec<Face>, points: &[Point], distance: &Number) {
    let used: BTreeSet<u32> = faces.iter().flat_map(|face| face.vertices.iter().copied()).collect();
    let mut kept = KeptPoints::new(points, distance);
    let place: HashMap<u32, u32> = used.into_iter().map(|v| (v, kept.place(v))).collect();
    for face in faces.iter_mut() {
        face.vertices.iter_mut().for_each(|v| *v = place[v]);
        face.vertices.dedup();
        if face.vertices.len() > 1 && face.vertices.first() == face.vertices.last() {
            face.vertices.pop();
        }
    }
    faces.retain(|face| face.vertices.len() > 2);
}

/// The same with the faces of one block; points that are in no face any more are left out.
pub(super) fn weld_block(raw: RawBlock, distance: &Number) -> RawBlock {
    let RawBlock { name, fixed, vertices, faces, line, lines, winding } = raw;
    let face = |(i, vertices)| Face { vertices, line: lines.faces.get(i).copied() };
    let mut faces: Vec<Face> = faces.into_iter().enumerate().map(face).collect();
    weld(&mut faces, &vertices, distance);
    let faces: Vec<&Face> = faces.iter().collect();
    RawBlock { name, fixed, line, winding, ..of_faces(&faces, &vertices, &lines.vertices) }
}

/// Points kept so far, by the cell of a grid that they lie in. Cells have at least twice the distance on each side, so two points within it
/// lie in one cell or in neighbouring ones, whatever rounding does to the numbers of cells; whether they are within it is decided exactly.
struct KeptPoints<'a> {
    points: &'a [Point],
    squared_distance: Number,
    cell: f64,
    same: HashMap<[u64; 3], Vec<u32>>,
    cells: HashMap<[u64; 3], Vec<u32>>,
}

impl<'a> KeptPoints<'a> {
    fn new(points: &'a [Point], distance: &Number) -> KeptPoints<'a> {
        let furthest = points.iter().flat_map(|p| p.components()).map(|c| c.approximate().abs()).fold(0.0, f64::max);
        let cell = (2.0 * distance.approximate()).max(furthest * 2f64.powi(-48)).max(f64::MIN_POSITIVE);
        let squared_distance = distance.times(distance);
        KeptPoints { points, squared_distance, cell, same: HashMap::new(), cells: HashMap::new() }
    }

    /// The point that a point goes to: one kept before, or itself.
    fn place(&mut self, point: u32) -> u32 {
        let at = &self.points[point as usize];
        let near = at.components().map(|c| c.approximate());
        let key = near.map(|c| (c + 0.0).to_bits());
        let same = self.same.get(&key).into_iter().flatten().copied();
        if let Some(same) = same.min().filter(|&kept| self.points[kept as usize] == *at) {
            return same;
        }
        let found = if self.squared_distance.is_zero() { None } else { self.nearby(near, at) };
        if found.is_none() {
            self.same.entry(key).or_default().push(point);
            self.cells.entry(self.cell_of(near, [0.0; 3])).or_default().push(point);
        }
        found.unwrap_or(point)
    }

    fn nearby(&self, near: [f64; 3], at: &Point) -> Option<u32> {
        const STEPS: [f64; 3] = [-1.0, 0.0, 1.0];
        let neighbours = STEPS.iter().flat_map(|&x| STEPS.iter().flat_map(move |&y| STEPS.map(|z| [x, y, z])));
        let candidates = neighbours.filter_map(|step| self.cells.get(&self.cell_of(near, step))).flatten();
        candidates.copied().filter(|&kept| self.is_within(&self.points[kept as usize], at)).min()
    }

    fn cell_of(&self, near: [f64; 3], step: [f64; 3]) -> [u64; 3] {
        std::array::from_fn(|axis| ((near[axis] / self.cell).floor() + step[axis] + 0.0).to_bits())
    }

    fn is_within(&self, one: &Point, other: &Point) -> bool {
        let square = |axis: usize| {
            let along = one.components()[axis].plus(&other.components()[axis].negated());
            along.times(&along)
        };
        square(0).plus(&square(1)).plus(&square(2)) <= self.squared_distance
    }
}

/// Turns faces round until neighbours run along their common edge in opposite directions, beginning with the first face as it is. Edges of
/// more or fewer than two faces join nothing.
pub(super) fn orient_alike(faces: &mut [Vec<u32>]) {
    let mut uses: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
    for (i, face) in faces.iter().enumerate() {
        for (p, q) in loop_pairs(face) {
            uses.entry((p.min(q), p.max(q))).or_default().push(i);
        }
    }
    let mut seen = vec![false; faces.len()];
    for first in 0..faces.len() {
        let mut queue = if std::mem::replace(&mut seen[first], true) { Vec::new() } else { vec![first] };
        while let Some(face) = queue.pop() {
            let edges: Vec<(u32, u32)> = loop_pairs(&faces[face]).collect();
            for (p, q) in edges {
                let Some(&[a, b]) = uses.get(&(p.min(q), p.max(q))).map(Vec::as_slice) else { continue };
                let other = if a == face { b } else { a };
                if std::mem::replace(&mut seen[other], true) {
                    continue;
                }
                if loop_pairs(&faces[other]).any(|edge| edge == (p, q)) {
                    faces[other].reverse();
                }
                queue.push(other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::Vec3;

    fn point(x: f64, y: f64, z: f64) -> Point {
        Vec3::new(x, y, z).map(|c| Number::from_f64(*c).unwrap())
    }

    fn triangle(a: u32, b: u32, c: u32) -> Face {
        Face { vertices: vec![a, b, c], line: None }
    }

    #[test]
    fn a_point_goes_to_the_first_one_within_the_distance_and_no_further() {
        // The second is exactly at the distance from the first, the third from the second, and 2 × the distance from the first.
        let points = [point(0.0, 0.0, 0.0), point(0.25, 0.0, 0.0), point(0.5, 0.0, 0.0), point(0.0, 1.0, 0.0)];
        let mut faces = vec![triangle(0, 1, 3), triangle(1, 2, 3), triangle(2, 0, 3)];
        weld(&mut faces, &points, &Number::from_f64(0.25).unwrap());
        // The first triangle has collapsed.
        assert_eq!(faces.iter().map(|face| face.vertices.clone()).collect::<Vec<_>>(), [[0, 2, 3], [2, 0, 3]]);
        let mut faces = vec![triangle(0, 1, 3)];
        weld(&mut faces, &points, &Number::from_f64(0.25f64.next_down()).unwrap());
        assert_eq!(faces[0].vertices, [0, 1, 3]);
    }

    #[test]
    fn points_at_cell_borders_and_far_away_are_found() {
        for far in [0.0, 1e6, -1e15, 1e300] {
            let near = if far == 0.0 { 1e-9 } else { f64::next_up(far) - far };
            let points =
                [point(far, -1e-9, 0.0), point(far + near, 0.0, 0.0), point(far, 2.0, 0.0), point(far, 0.0, 2.0)];
            let mut faces = vec![triangle(0, 2, 3), triangle(1, 2, 3)];
            weld(&mut faces, &points, &Number::from_f64(near * 2.0 + 2e-9).unwrap());
            // Where the distance is coarser than the triangle nothing is left of it.
            assert!(faces.iter().all(|face| face.vertices == [0, 2, 3]), "{far}: {faces:?}");
        }
    }

    #[test]
    fn minus_zero_is_zero() {
        let points = [point(0.0, 0.0, 0.0), point(-0.0, -0.0, 0.0), point(1.0, 0.0, 0.0), point(0.0, 1.0, 0.0)];
        let mut faces = vec![triangle(0, 2, 3), triangle(1, 3, 2)];
        weld(&mut faces, &points, &Number::ZERO);
        assert_eq!(faces[1].vertices, [0, 3, 2]);
    }

    /// A tetrahedron whose corners are given.
    fn tetrahedron([a, b, c, d]: [u32; 4]) -> [Face; 4] {
        [triangle(a, c, b), triangle(a, b, d), triangle(b, c, d), triangle(c, a, d)]
    }

    #[test]
    fn blocks_that_share_a_face_come_apart() {
        let faces = [tetrahedron([0, 1, 2, 3]), tetrahedron([0, 2, 1, 4])].concat();
        assert_eq!(components(&faces), [[0, 1, 2, 3], [4, 5, 6, 7]]);
        // An edge with a face too many stays one set, whose topology is then refused.
        let faces = [tetrahedron([0, 1, 2, 3]).to_vec(), vec![triangle(0, 2, 1)]].concat();
        assert_eq!(components(&faces).len(), 1);
    }

    #[test]
    fn faces_are_turned_until_they_fit() {
        let mut faces: Vec<Vec<u32>> = tetrahedron([0, 1, 2, 3]).map(|face| face.vertices).to_vec();
        let wanted = faces.clone();
        faces[1].reverse();
        faces[3].reverse();
        orient_alike(&mut faces);
        let rotated = |face: &Vec<u32>| {
            let at = (0..3).min_by_key(|&k| face[k]).unwrap();
            [face[at], face[(at + 1) % 3], face[(at + 2) % 3]]
        };
        assert_eq!(faces.iter().map(rotated).collect::<Vec<_>>(), wanted.iter().map(rotated).collect::<Vec<_>>());
    }
}
