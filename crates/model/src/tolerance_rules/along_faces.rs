//! The estimate along the faces that something stands against: of each direction of a face the blocks that loads press along it, and what lies ahead of them.

use super::column::{Column, ColumnSource, Plans, across_and_against, dot, gravity};
use super::load_sums::{LoadSums, most_along};
use super::shape::{gap_ahead, length, turned};
use crate::number::Number;
use crate::scene::Scene;
use std::collections::{BTreeMap, BTreeSet};

/// What an estimate along faces took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    /// How often a block was looked at for a direction.
    pub(super) looks: usize,
    /// The columns made.
    pub(super) columns: usize,
    /// The directions in which loads may press a block too hard, and those of them looked along. Where it ended early, all that were not looked at may.
    pub(super) directions: [usize; 2],
}

/// What an estimate may take: some seconds.
pub(super) const MOST: Effort = Effort { looks: 200_000_000, columns: 2_000_000, directions: [0; 2] };

/// A face by block and number.
type FaceOf = (usize, usize);

/// The estimate along the faces that something stands against.
///
/// A contact pushes along the normal of a face of one of the two blocks (but for crossing edges). So a load F presses with F·n along the outward normal n of a face of its block that
/// another block is wholly in front of, and along −n for a face of another block that the loaded one is wholly in front of, where the two overlap seen along n. How far
/// apart they are does not matter: the load goes on. In front means by no more than `penetration` behind the plane. Of a block that is not convex, whatever is ahead of a face stands against it.
pub(super) struct AlongFaces<'a, 's> {
    pub(super) source: &'a ColumnSource<'s>,
    pub(super) scene: &'a Scene,
    pub(super) loads: LoadSums,
    /// How far behind a plane is in front of it (m).
    pub(super) within: f64,
    /// A force that all bear wherever it presses (N): no more is not looked at.
    pub(super) bearable: f64,
}

impl AlongFaces<'_, '_> {
    /// Shows the columns along each direction in which loads press something, one direction after the other, gravity's left out: the blocks that are pressed, with what their loads and weights press, and all that lies ahead of them.
    /// Of the others a weight counts only where it holds back. Ends where it takes more than `most`, which it may pass by one direction, without a look at the rest: of many loads on many blocks even to count
    /// the directions in which one presses takes as long as both numbers multiplied.
    pub(super) fn each(&self, most: Effort, mut show: impl FnMut(&[Column])) -> Effort {
        let mut effort = Effort::default();
        let force = |(block, sums): (&usize, &Vec<[f64; 3]>)| {
            sums.iter().map(|one| length(*one)).fold(0.0, f64::max) + length(self.weight(*block))
        };
        if self.loads.iter().map(force).sum::<f64>() <= self.bearable {
            return effort;
        }
        let down = gravity(self.scene).map(|(down, _)| down);
        let faces = self.faces();
        let none = Vec::new();
        let keys: BTreeSet<[i64; 3]> = faces.keys().flat_map(|key| [*key, key.map(|part| -part)]).collect();
        for (place, key) in keys.iter().copied().enumerate() {
            if effort.looks > most.looks || effort.columns > most.columns {
                effort.directions[0] += keys.len() - place;
                break;
            }
            let [own, against] = [key, key.map(|part| -part)].map(|key| faces.get(&key).unwrap_or(&none));
            let normal = |(block, face): &FaceOf| self.source.shapes()[*block].faces[*face].normal;
            let Some(n) = own.first().map(normal).or(against.first().map(|face| normal(face).map(|part| -part))) else {
                continue;
            };
            if down.is_some_and(|down| dot(down, n) > 1.0 - 1e-12) {
                continue;
            }
            effort.looks += self.loads.values().map(Vec::len).sum::<usize>();
            let pressed = self.pressed(n);
            if pressed.values().sum::<f64>() <= self.bearable {
                continue;
            }
            effort.directions.iter_mut().for_each(|count| *count += 1);
            let own: Vec<FaceOf> = own.iter().copied().filter(|(block, _)| pressed.contains_key(block)).collect();
            let stood = self.stood_against(n, (&own, against), &pressed, &mut effort);
            if stood.iter().map(|block| pressed[block]).sum::<f64>() > self.bearable {
                show(&self.columns_ahead(n, &stood, &mut effort));
            }
        }
        effort
    }

    /// The faces of all blocks by their normals, rounded.
    fn faces(&self) -> BTreeMap<[i64; 3], Vec<FaceOf>> {
        let mut faces: BTreeMap<[i64; 3], Vec<FaceOf>> = BTreeMap::new();
        for (block, shape) in self.source.shapes().iter().enumerate() {
            for (number, face) in shape.faces.iter().enumerate() {
                let key = face.normal.map(|part| (part * 1e7).round() as i64);
                faces.entry(key).or_default().push((block, number));
            }
        }
        faces
    }

    /// The weight of a block (N).
    fn weight(&self, block: usize) -> [f64; 3] {
        let mass = self.source.masses[block].unwrap_or(0.0);
        self.scene.simulation.gravity.components().map(|pull| mass * pull.approximate())
    }

    /// The blocks that loads press along a direction, each with what they and its weight press with.
    fn pressed(&self, n: [f64; 3]) -> BTreeMap<usize, f64> {
        let pressed = self.loads.iter().filter_map(|(&block, sums)| {
            let most = most_along(sums, n);
            let largest = sums.iter().map(|force| length(*force)).fold(0.0, f64::max);
            let with_weight = most + dot(self.weight(block), n);
            // What a load across a face presses is rounding.
            (most > 0.0 && most >= 1e-6 * largest && with_weight > 0.0).then_some((block, with_weight))
        });
        pressed.collect()
    }

    /// Of blocks that are pressed along a direction those that something stands against there: `own` are their faces whose normal that is, `against` all faces whose normal is against it.
    fn stood_against(
        &self,
        n: [f64; 3],
        (own, against): (&[FaceOf], &[FaceOf]),
        pressed: &BTreeMap<usize, f64>,
        effort: &mut Effort,
    ) -> BTreeSet<usize> {
        let (axes, shapes) = (across_and_against(n), self.source.shapes());
        let face_box = |(block, face): &FaceOf| shapes[*block].face_box(*face, axes);
        let Some(region) = own.iter().chain(against).map(face_box).reduce(around) else { return BTreeSet::new() };
        let blocks: Vec<usize> = if own.is_empty() {
            let owners = against.iter().map(|(block, _)| *block).collect::<BTreeSet<usize>>();
            owners.into_iter().chain(pressed.keys().copied()).collect::<BTreeSet<usize>>().into_iter().collect()
        } else {
            (0..shapes.len()).collect()
        };
        // How far apart blocks are along the direction does not matter.
        let endless = [[region[0][0], region[0][1], f64::NEG_INFINITY], [region[1][0], region[1][1], f64::INFINITY]];
        let columns = self.columns_in(n, blocks.into_iter(), endless, effort);
        let (plans, places) = (Plans::of(&columns), places(&columns));
        let mut stood = BTreeSet::new();
        for (faces, is_own) in [(own, true), (against, false)] {
            for face in faces {
                let owner = face.0;
                let Some(&place) = places.get(&owner).filter(|_| !is_own || !stood.contains(&owner)) else { continue };
                let of_face = face_box(face);
                let near = plans.near(&columns[place]);
                effort.looks += near.len();
                let stands = |other: &Column| {
                    let are_convex = shapes[owner].is_convex && shapes[other.block].is_convex;
                    let boxes = if is_own { [of_face, other.sides()] } else { [of_face, other.sides()].map(turned) };
                    other.block != owner && gap_ahead(boxes[0], boxes[1], are_convex, self.within).is_some()
                };
                let mut others = near.into_iter().map(|place| &columns[place]);
                if is_own {
                    stood.extend(others.any(stands).then_some(owner));
                } else {
                    let asked = |other: &&Column| pressed.contains_key(&other.block) && !stood.contains(&other.block);
                    let found: Vec<usize> =
                        others.filter(asked).filter(|other| stands(other)).map(|one| one.block).collect();
                    stood.extend(found);
                }
            }
        }
        stood
    }

    /// The columns of the blocks that are pressed along a direction and of those ahead of one of them.
    fn columns_ahead(&self, n: [f64; 3], stood: &BTreeSet<usize>, effort: &mut Effort) -> Vec<Column> {
        let sides = |block: &usize| self.source.column(*block, n, 0.0).sides();
        effort.columns += stood.len();
        let Some([mut low, high]) = stood.iter().map(sides).reduce(around) else { return Vec::new() };
        low[2] = f64::NEG_INFINITY;
        let mut columns = self.columns_in(n, 0..self.source.shapes().len(), [low, high], effort);
        for column in &mut columns {
            if stood.contains(&column.block) {
                column.weight = column.weight.map(|_| dot(self.weight(column.block), n));
                column.pushed = most_along(&self.loads[&column.block], n);
            }
        }
        columns
    }

    /// The columns of those of some blocks that meet a box along a direction.
    fn columns_in(
        &self,
        n: [f64; 3],
        blocks: impl Iterator<Item = usize>,
        [low, high]: [[f64; 3]; 2],
        effort: &mut Effort,
    ) -> Vec<Column> {
        let (axes, shapes) = (across_and_against(n), self.source.shapes());
        let pull = dot(self.scene.simulation.gravity.components().map(Number::approximate), n).min(0.0);
        let mut columns = Vec::new();
        for block in blocks {
            effort.looks += 1;
            let shape = &shapes[block];
            let at = axes.map(|axis| dot(shape.centre, axis));
            let meets = |k: usize| at[k] - shape.radius <= high[k] && at[k] + shape.radius >= low[k];
            if (0..3).all(meets) {
                columns.push(self.source.column(block, n, pull));
            }
        }
        effort.columns += columns.len();
        columns
    }
}

/// Where the column of a block is.
fn places(columns: &[Column]) -> BTreeMap<usize, usize> {
    columns.iter().enumerate().map(|(place, one)| (one.block, place)).collect()
}

/// The box around two boxes.
fn around(one: [[f64; 3]; 2], other: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [std::array::from_fn(|k| one[0][k].min(other[0][k])), std::array::from_fn(|k| one[1][k].max(other[1][k]))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Block, BlockOptions};
    use crate::simulation::PointLoad;
    use crate::tolerance_rules::WarningKind;
    use crate::tolerance_rules::load_sums::load_sums;
    use crate::tolerance_rules::pressing::left_out;
    use crate::topology::VertexId;
    use crate::{SceneBlock, ToleranceSet, Vec3};

    fn at(c: [i32; 3]) -> Vec3<Number> {
        Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c))
    }

    /// Tetrahedra in a cubic lattice with no two faces alike, each with a load on it.
    fn heap(side: i32) -> Scene {
        let mut scene = Scene::default();
        let mut state = 1_u32;
        let mut offset = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            i32::try_from(state >> 23).unwrap()
        };
        for place in 0..side * side * side {
            let low = [place % side, place / side % side, place / side / side].map(|part| part * 2048);
            let mut corner = |by: [i32; 3]| at([0, 1, 2].map(|k| low[k] + by[k] * 1536 + offset()));
            let points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(&mut corner).to_vec();
            let loops = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
            let loops = loops.iter().map(|face| face.iter().map(|&k| VertexId(k)).collect());
            scene
                .blocks
                .push(SceneBlock::new("stone", Block::new(points, loops.collect(), &BlockOptions::default()).unwrap()));
        }
        scene.simulation.gravity = at([0, 0, 0]);
        let load = |block| PointLoad { block, at: at([0, 0, 0]), table: vec![(Number::ZERO, at([3, 2, 1]))] };
        scene.simulation.loads = (0..scene.blocks.len()).map(load).collect();
        scene
    }

    fn effort(scene: &Scene, most: Effort) -> (Effort, usize) {
        let set = ToleranceSet { penetration: Number::parse("1/8").unwrap(), ..ToleranceSet::ZERO };
        let (source, loads) = (ColumnSource::of(&set, scene), load_sums(scene));
        // As soft as makes every load count.
        let along_faces = AlongFaces { source: &source, scene, loads, within: 0.125, bearable: 0.0 };
        let mut most_shown = 0;
        let effort = along_faces.each(most, |columns| most_shown = most_shown.max(columns.len()));
        (effort, most_shown)
    }

    #[test]
    fn columns_are_made_of_what_lies_ahead_alone() {
        let scene = heap(7);
        let (blocks, (effort, most_shown)) = (scene.blocks.len(), effort(&scene, MOST));
        let [directions, looked_along] = effort.directions;
        assert!(directions > 3 * blocks && looked_along == directions, "{effort:?} of {blocks}");
        assert!(effort.columns < directions * blocks / 2, "{effort:?} of {blocks}");
        assert!(effort.looks < 3 * 8 * blocks * blocks, "{effort:?} of {blocks}");
        assert!(most_shown > 3 && most_shown < blocks, "{most_shown} of {blocks}");
    }

    #[test]
    fn directions_that_would_take_too_long_are_left_out_and_told() {
        let scene = heap(3);
        let (all, _) = effort(&scene, MOST);
        assert_eq!(left_out(&all), None);
        let (some, _) = effort(&scene, Effort { columns: all.columns / 2, ..MOST });
        assert!(some.columns > all.columns / 2 && some.columns < all.columns / 2 + 3 * 27, "{some:?} of {all:?}");
        let warning = left_out(&some).unwrap();
        assert_eq!(warning.kind, WarningKind::Loads);
        // Those that were not looked at count, two for each face at most.
        assert!(warning.found >= all.directions[0] as f64 && warning.found <= 8.0 * 27.0, "{warning:?} of {all:?}");
        assert!(warning.allowed > 0.0 && warning.allowed < warning.found, "{warning:?}");
        let (few, _) = effort(&scene, Effort { looks: all.looks / 2, ..MOST });
        assert!(few.directions[1] > 0 && few.directions[1] < all.directions[1], "{few:?}");
        assert!(few.looks < all.looks / 2 + 10 * 27, "nothing is looked at any more: {few:?} of {all:?}");
    }
}
