//! A block as a file has it, before it is known to be one.

use crate::block::{Block, BlockError, BlockOptions, LARGEST_COORDINATE, Merged, Merging, Point};
use crate::number::Number;
use crate::scene::error::{BlockPlace, SceneError, SceneProblem, VertexPlace};
use crate::scene::mesh::orient_alike;
use crate::scene::{BlockOrigin, LoadOptions, SceneBlock};
use crate::simulation::{Body, Motion};
use std::path::Path;

/// Vertices and faces as read.
#[derive(Clone, Debug, Default)]
pub(super) struct RawBlock {
    pub(super) name: Option<String>,
    pub(super) fixed: bool,
    pub(super) vertices: Vec<Point>,
    pub(super) faces: Vec<Vec<u32>>,
    /// Where it begins, in a file of lines.
    pub(super) line: Option<usize>,
    pub(super) lines: FeatureLines,
    pub(super) winding: Winding,
}

/// Which way the faces of a block run round in its file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Winding {
    /// Counter-clockwise seen from outside.
    #[default]
    Outward,
    /// All counter-clockwise or all clockwise: the sign of the volume tells.
    Alike,
    /// Each either way, as in cells of grids, on which files do not agree.
    Any,
}

/// The lines of vertices and of faces; empty where the file has none, or the block's own line is that of all.
#[derive(Clone, Debug, Default)]
pub(super) struct FeatureLines {
    pub(super) vertices: Vec<usize>,
    pub(super) faces: Vec<usize>,
}

/// How the blocks of one file become blocks of a scene.
pub(super) struct Assembly<'a> {
    pub(super) file: &'a Path,
    pub(super) options: &'a LoadOptions,
    /// What the scene file asks for, if it does.
    pub(super) planarity: Option<&'a Number>,
    pub(super) merging: Merging,
}

impl Assembly<'_> {
    /// Builds one block, or says what is wrong, and with which vertices. `index` is its number in its file, `number` that in the scene.
    pub(super) fn build(
        &self,
        raw: RawBlock,
        index: usize,
        number: usize,
    ) -> Result<SceneBlock, Box<(SceneError, Vec<Point>)>> {
        let default = BlockOptions::default();
        let planarity = self.options.planarity.as_ref().or(self.planarity).unwrap_or(&default.planarity);
        let options = BlockOptions { planarity: planarity.clone() };
        let label = match &raw.name {
            Some(name) => format!("block {number} \"{name}\""),
            None => format!("block {number}"),
        };
        let name = raw.name.unwrap_or_else(|| format!("block_{number}"));
        let merged = match raw.winding {
            Winding::Outward => Block::merged(raw.vertices.clone(), raw.faces, &options, self.merging),
            Winding::Alike => self.build_either_way(&raw.vertices, raw.faces, &options),
            Winding::Any => {
                let mut faces = raw.faces;
                orient_alike(&mut faces);
                self.build_either_way(&raw.vertices, faces, &options)
            }
        };
        match merged {
            Ok((block, merged)) => Ok(SceneBlock {
                name,
                body: Body { motion: if raw.fixed { Motion::Fixed } else { Motion::default() }, ..Body::default() },
                origin: BlockOrigin { file: self.file.to_path_buf(), line: raw.line, index },
                planarity: options.planarity,
                merged,
                block,
            }),
            Err(error) => {
                let error = self.too_large(&raw.vertices).unwrap_or_else(|| self.scaled(error));
                let (line, vertices) = places(&error, &raw.vertices, &raw.lines);
                let place = Box::new(BlockPlace { block: label, vertices, cavity_of: None });
                let problem = SceneProblem::Block { error, place };
                let error = SceneError { file: self.file.to_path_buf(), line: line.or(raw.line), problem };
                Err(Box::new((error, raw.vertices)))
            }
        }
    }

    /// The first coordinate beyond [`LARGEST_COORDINATE`] that f64 holds: faces that cross, bend or stay open are what it makes of a block.
    fn too_large(&self, vertices: &[Point]) -> Option<BlockError> {
        let scale = self.options.scaled().map_or(1.0, Number::approximate);
        vertices.iter().enumerate().find_map(|(vertex, point)| {
            let metres = point.components().map(|c| c.approximate() * scale);
            let coordinate = metres.into_iter().find(|c| c.abs() > LARGEST_COORDINATE && c.is_finite())?;
            Some(BlockError::TooLarge { vertex, coordinate })
        })
    }

    /// The error with its volume in m³: blocks are built in the file's unit of length, and multiplied afterwards.
    fn scaled(&self, error: BlockError) -> BlockError {
        match (error, self.options.scaled()) {
            (BlockError::NotPositiveVolume { volume }, Some(scale)) => {
                BlockError::NotPositiveVolume { volume: volume * scale.approximate().powi(3) }
            }
            (error, _) => error,
        }
    }

    /// A block whose faces run round alike, seen from outside or from inside.
    fn build_either_way(
        &self,
        vertices: &[Point],
        mut faces: Vec<Vec<u32>>,
        options: &BlockOptions,
    ) -> Result<(Block, Merged), BlockError> {
        match Block::merged(vertices.to_vec(), faces.clone(), options, self.merging) {
            Err(BlockError::NotPositiveVolume { volume }) if volume < 0.0 => {
                faces.iter_mut().for_each(|face| face.reverse());
                Block::merged(vertices.to_vec(), faces, options, self.merging)
            }
            outcome => outcome,
        }
    }
}

/// The line that an error is about, of the face that it names or else of the vertex, and where the vertices are that it names.
fn places(error: &BlockError, vertices: &[Point], lines: &FeatureLines) -> (Option<usize>, Vec<VertexPlace>) {
    let (face, named) = error.features();
    let vertex_line = |vertex: usize| lines.vertices.get(vertex).copied();
    let line = match face {
        Some(face) => lines.faces.get(face).copied(),
        None => named.first().and_then(|&vertex| vertex_line(vertex)),
    };
    // This one has the point in its own words.
    let is_told = matches!(error, BlockError::RepeatedVertex { .. });
    let place = |&vertex: &usize| {
        let point = vertices.get(vertex)?.clone();
        Some(VertexPlace { vertex, point, line: vertex_line(vertex) })
    };
    (line, named.iter().filter(|_| !is_told).filter_map(place).collect())
}
