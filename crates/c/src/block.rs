//! Blocks, and models of several.

use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{BlockOptions, LoadOptions, Number, Scene, SceneBlock, Vec3};
use std::path::Path;

/// A closed polyhedron with exact vertices in metres. It never changes, so threads may share it.
pub struct Block {
    pub(crate) block: rockproof_model::Block,
    pub(crate) vertices: Vec<Point>,
}

/// Coordinates in metres.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Point {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

/// An edge by its two vertices.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Edge {
    /// The vertex with the lower number.
    pub p: u32,
    /// The vertex with the higher number.
    pub q: u32,
}

/// The blocks of a file. It never changes, so threads may share it.
pub struct Model(Scene);

/// A number that is given where it is not negative.
fn given(value: f64, what: &str) -> Result<Option<Number>, String> {
    if value < 0.0 {
        return Ok(None);
    }
    Number::from_f64(value).map(Some).map_err(|error| format!("{what}: {error}"))
}

/// A factor of lengths.
fn factor(text: &str) -> Result<Number, String> {
    let number = Number::parse(text).map_err(|error| format!("scale: {error}"))?;
    if number.is_negative() || number.is_zero() {
        return Err(format!(
            "scale is {}; allowed is a number above 0, as \"1/1000\" for a file in millimetres",
            excerpt(text, EXCERPT_LENGTH)
        ));
    }
    Ok(number)
}

impl Block {
    pub(crate) fn new(block: rockproof_model::Block) -> Block {
        let near = |v: &rockproof_model::Point| {
            let [x, y, z] = v.components().map(|c| c.approximate());
            Point { x, y, z }
        };
        Block { vertices: block.vertices().iter().map(near).collect(), block }
    }

    /// The block with these coordinates, three a vertex, and faces, whose vertices follow one another.
    pub(crate) fn from_arrays(
        coordinates: &[f64],
        corners: &[u32],
        lengths: &[u32],
        planarity: f64,
    ) -> Result<Block, String> {
        let coordinate =
            |at: usize| Number::from_f64(coordinates[at]).map_err(|error| format!("vertex {}: {error}", at / 3));
        let vertices = (0..coordinates.len() / 3)
            .map(|v| Ok(Vec3::new(coordinate(3 * v)?, coordinate(3 * v + 1)?, coordinate(3 * v + 2)?)))
            .collect::<Result<Vec<_>, String>>()?;
        let mut rest = corners;
        let mut faces = Vec::with_capacity(lengths.len());
        for (number, &length) in lengths.iter().enumerate() {
            let (face, others) = rest
                .split_at_checked(length as usize)
                .ok_or_else(|| format!("face {number} has {length} vertices, and only {} are left", rest.len()))?;
            faces.push(face.to_vec());
            rest = others;
        }
        let options =
            given(planarity, "planarity")?.map_or_else(BlockOptions::default, |planarity| BlockOptions { planarity });
        rockproof_model::Block::new(vertices, faces, &options).map(Block::new).map_err(|error| error.to_string())
    }
}

impl Model {
    pub(crate) fn load(path: &str, planarity: f64, weld: f64, scale: Option<&str>) -> Result<Model, String> {
        let scale = scale.map(factor).transpose()?;
        let options = LoadOptions { planarity: given(planarity, "planarity")?, weld: given(weld, "weld")?, scale };
        Scene::load_with(Path::new(path), &options).map(Model).map_err(|error| error.to_string())
    }

    pub(crate) fn count(&self) -> usize {
        self.0.blocks.len()
    }

    pub(crate) fn block(&self, number: usize) -> Result<&SceneBlock, String> {
        let count = self.count();
        self.0
            .blocks
            .get(number)
            .ok_or_else(|| format!("block {number} of a model of {count}; allowed is 0 to {}", count - 1))
    }
}
