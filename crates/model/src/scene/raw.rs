//! A block as a file has it, before it is known to be one.

use crate::block::{Block, BlockError, BlockOptions, Merged, Merging, Point};
use crate::number::Number;
use crate::scene::error::{SceneError, SceneProblem};
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
    /// A cell of a grid: files do not agree on which way its faces run round, so they may be turned.
    pub(super) is_cell: bool,
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
    /// Builds one block. `index` is its number in its file, `number` that in the scene.
    pub(super) fn build(&self, raw: RawBlock, index: usize, number: usize) -> Result<SceneBlock, SceneError> {
        let default = BlockOptions::default();
        let planarity = self.options.planarity.as_ref().or(self.planarity).unwrap_or(&default.planarity);
        let options = BlockOptions { planarity: planarity.clone() };
        let label = match &raw.name {
            Some(name) => format!("block {number} \"{name}\""),
            None => format!("block {number}"),
        };
        let name = raw.name.unwrap_or_else(|| format!("block_{number}"));
        let merged = if raw.is_cell {
            self.build_cell(raw.vertices, raw.faces, &options)
        } else {
            Block::merged(raw.vertices, raw.faces, &options, self.merging)
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
            Err(error) => Err(SceneError {
                file: self.file.to_path_buf(),
                line: raw.line,
                problem: SceneProblem::Block { block: label, error },
            }),
        }
    }

    /// A cell whose faces run round alike, from outside or from inside.
    fn build_cell(
        &self,
        vertices: Vec<Point>,
        mut faces: Vec<Vec<u32>>,
        options: &BlockOptions,
    ) -> Result<(Block, Merged), BlockError> {
        orient_alike(&mut faces);
        match Block::merged(vertices.clone(), faces.clone(), options, self.merging) {
            Err(BlockError::NotPositiveVolume { volume }) if volume < 0.0 => {
                faces.iter_mut().for_each(|face| face.reverse());
                Block::merged(vertices, faces, options, self.merging)
            }
            outcome => outcome,
        }
    }
}
