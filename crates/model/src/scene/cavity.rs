//! Blocks turned inside out that lie within another: cavities of it, which no block can have.

use crate::block::{Block, BlockError, Point};
use crate::scene::SceneBlock;
use crate::scene::error::{SceneError, SceneProblem};

/// How many are looked at: a file that is wrong throughout has as many as blocks.
const MAX_INVERTED: usize = 100;

/// Blocks turned inside out: their numbers among the problems, and their vertices.
#[derive(Default)]
pub(super) struct InvertedBlocks(Vec<(usize, Vec<Point>)>);

impl InvertedBlocks {
    /// Takes note of a problem, which gets this number, where that is what it is about.
    pub(super) fn note(&mut self, problem: &SceneError, vertices: Vec<Point>, number: usize) {
        let is_inverted = matches!(
            problem.problem,
            SceneProblem::Block { error: BlockError::NotPositiveVolume { volume }, .. } if volume < 0.0
        );
        if is_inverted && self.0.len() < MAX_INVERTED {
            self.0.push((number, vertices));
        }
    }

    /// Says in problems of which of these blocks they are cavities.
    pub(super) fn tell_cavities(&self, blocks: &[SceneBlock], problems: &mut [SceneError]) {
        for (number, vertices) in &self.0 {
            let around = blocks.iter().find(|block| encloses(&block.block, vertices));
            if let (Some(around), SceneProblem::Block { place, .. }) = (around, &mut problems[*number].problem) {
                place.cavity_of = Some(around.name.clone());
            }
        }
    }
}

/// Whether all of some points lie within a block, not on its sides. This chooses the words of a message alone, so f64 will do.
fn encloses(block: &Block, points: &[Point]) -> bool {
    let bounds = block.bounds();
    let (min, max) = (bounds.min.components(), bounds.max.components());
    let is_in_box = |point: &Point| {
        point.components().into_iter().zip(min.into_iter().zip(max)).all(|(c, (min, max))| **min < *c && *c < **max)
    };
    !points.is_empty() && points.iter().all(|point| is_in_box(point) && turns_around(block, point).abs() > 0.5)
}

/// How often a surface goes round a point, outward faces counted as positive: the solid angle of its faces, cut into triangles at a corner,
/// over 4π (van Oosterom and Strackee 1983).
fn turns_around(block: &Block, point: &Point) -> f64 {
    let away = |vertex: &Point| {
        let [a, b] = [vertex, point].map(|p| p.components().map(|c| c.approximate()));
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let mut sum = 0.0;
    for face in block.topology().faces() {
        let corners: Vec<[f64; 3]> = face.iter().map(|v| away(&block.vertices()[v.index()])).collect();
        for pair in corners[1..].windows(2) {
            let [a, b, c] = [corners[0], pair[0], pair[1]];
            let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
            let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
            sum += 2.0 * dot(a, cross(b, c)).atan2(below);
        }
    }
    sum / (4.0 * std::f64::consts::PI)
}
