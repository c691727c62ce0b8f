//! Coordinates relative to another origin: surveys give eastings and northings of millions of metres, and digits that these take are gone for the blocks.

use crate::block::{Point, translated};
use crate::number::Number;
use crate::scene::Scene;
use crate::vector::Vec3;

/// A lowest coordinate counts as far from 0 along its axis where it is so many times as large as the longest side of the scene's box.
const FAR: f64 = 16.0;

impl Scene {
    /// Takes `origin` (m) from every point: vertices, points of loads, fixed points and measured points. Exact. Nothing else of a scene depends on where it is:
    /// the state that a run begins in, its loads and gravity are as before.
    pub fn move_origin_to(&mut self, origin: &Point) {
        let offset = origin.map(Number::negated);
        let simulation = &mut self.simulation;
        let loads = simulation.loads.iter_mut().map(|load| &mut load.at);
        let fixed = simulation.fixed_points.iter_mut().map(|point| &mut point.at);
        let measured = simulation.measured_points.iter_mut().map(|point| &mut point.at);
        for at in loads.chain(fixed).chain(measured) {
            *at = translated(at, &offset);
        }
        for block in &mut self.blocks {
            block.block = block.block.translated(&offset);
        }
    }

    /// A point near the lowest corner of the scene's box with few digits, to be taken from all coordinates: along each axis where blocks are further from 0 than 16 times
    /// the longest side of the box, the lowest coordinate rounded down to the power of ten that is not above that side, else 0. `None` where they are so far along no axis.
    pub fn local_origin(&self) -> Option<Point> {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for vertex in self.blocks.iter().flat_map(|block| block.block.vertices()) {
            for (axis, coordinate) in vertex.components().into_iter().enumerate() {
                let near = coordinate.approximate();
                low[axis] = low[axis].min(near);
                high[axis] = high[axis].max(near);
            }
        }
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let exponent = longest.log10().floor() as i32;
        let rounded_down = |low: f64, high: f64| {
            let is_far = low.abs().min(high.abs()) > FAR * longest;
            let count = (low / 10f64.powi(exponent)).floor();
            Number::parse(&format!("{count:.0}e{exponent}")).ok().filter(|_| is_far).unwrap_or(Number::ZERO)
        };
        let [x, y, z] = [0, 1, 2].map(|axis| rounded_down(low[axis], high[axis]));
        let origin = Vec3::new(x, y, z);
        origin.components().iter().any(|coordinate| !coordinate.is_zero()).then_some(origin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{FixedPoint, MeasuredPoint, PointLoad};
    use crate::{Block, BlockOptions, SceneBlock};

    fn point(coordinates: [&str; 3]) -> Point {
        let [x, y, z] = coordinates.map(|text| Number::parse(text).expect("a number"));
        Vec3::new(x, y, z)
    }

    fn tetrahedron_at(corner: [&str; 3], side: &str) -> Scene {
        let (corner, side) = (point(corner), Number::parse(side).expect("a number"));
        let mut vertices = vec![corner.clone(); 4];
        vertices[1].x = corner.x.plus(&side);
        vertices[2].y = corner.y.plus(&side);
        vertices[3].z = corner.z.plus(&side);
        let faces: Vec<Vec<u32>> = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]];
        let block = Block::new(vertices, faces, &BlockOptions::default()).expect("a block");
        Scene { blocks: vec![SceneBlock::new("one", block)], ..Scene::default() }
    }

    #[test]
    fn the_origin_is_near_and_short() {
        let far = |corner, side| tetrahedron_at(corner, side).local_origin();
        assert_eq!(far(["453216.455", "5210880.12", "15.8"], "14"), Some(point(["453210", "5210880", "0"])));
        assert_eq!(far(["-453216.455", "0", "0.3"], "2"), Some(point(["-453217", "0", "0"])));
        assert_eq!(far(["1.00234", "0", "0"], "0.003"), Some(point(["1.002", "0", "0"])));
        assert_eq!(far(["100", "0", "-3"], "14"), None, "seven times its size is not far");
        assert_eq!(far(["-7", "0", "0"], "14"), None);
    }

    #[test]
    fn every_point_goes_along_exactly() {
        let mut scene = tetrahedron_at(["453216.455", "5210880.12", "1/3"], "1");
        let at = point(["453216.5", "5210880.25", "2/3"]);
        scene.simulation.loads = vec![PointLoad { block: 0, at: at.clone(), table: Vec::new() }];
        scene.simulation.fixed_points = vec![FixedPoint { block: 0, at: at.clone(), stiffness: None }];
        scene.simulation.measured_points = vec![MeasuredPoint { name: "m".to_owned(), block: 0, at }];
        let mut moved = scene.clone();
        moved.move_origin_to(&point(["453000", "5210000", "1/3"]));
        assert_eq!(moved.blocks[0].block.vertices()[0], point(["216.455", "880.12", "0"]));
        let there = point(["216.5", "880.25", "1/3"]);
        assert_eq!(moved.simulation.loads[0].at, there);
        assert_eq!(moved.simulation.fixed_points[0].at, there);
        assert_eq!(moved.simulation.measured_points[0].at, there);
        moved.move_origin_to(&point(["-453000", "-5210000", "-1/3"]));
        assert_eq!(moved, scene, "and back");
    }
}
