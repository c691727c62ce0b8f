//! The blocks of a scene, gathered from one file or several.

use crate::block::{Block, BlockOptions, Merging, Shapes};
use crate::files::read_limited;
use crate::number::Number;
use crate::scene::cavity::InvertedBlocks;
use crate::scene::error::{BlockPlace, SceneError, SceneProblem};
use crate::scene::raw::{Assembly, FeatureLines, RawBlock};
use crate::scene::toml::{self, BodyProperties};
use crate::scene::{LoadOptions, SceneBlock, SceneFormat, at, read_foreign};
use std::path::Path;

/// Blocks read so far. Blocks are numbered in the order read, good or bad.
#[derive(Default)]
pub(super) struct SceneBuilder {
    pub(super) blocks: Vec<SceneBlock>,
    shapes: Shapes,
    pub(super) problems: Vec<SceneError>,
    pub(super) count: usize,
    inverted: InvertedBlocks,
}

impl SceneBuilder {
    pub(super) fn add_all(&mut self, raws: Vec<RawBlock>, assembly: &Assembly<'_>, patch: &BodyProperties) {
        for (index, raw) in raws.into_iter().enumerate() {
            self.add_one(raw, index, assembly, patch);
        }
    }

    pub(super) fn add_entries(
        &mut self,
        document: &toml::Document,
        path: &Path,
        options: &LoadOptions,
    ) -> Result<(), SceneError> {
        for (index, entry) in document.entries.iter().enumerate() {
            let planarity = entry.planarity.as_ref().or(document.planarity.as_ref());
            let assembly = Assembly { file: path, options, planarity, merging: Merging::Exact };
            let raw = |vertices, faces, lines| RawBlock {
                name: entry.name.clone(),
                vertices,
                faces,
                lines,
                line: Some(entry.line),
                ..RawBlock::default()
            };
            match &entry.content {
                toml::ShapeSource::Mesh { vertices, faces, lines } => {
                    let raw = raw(vertices.clone(), faces.clone(), lines.clone());
                    self.add_one(raw, index, &assembly, &entry.patch);
                }
                toml::ShapeSource::Box { min, max } => {
                    let (vertices, faces) = crate::block::cuboid_mesh(min, max);
                    self.add_one(raw(vertices, faces, FeatureLines::default()), index, &assembly, &entry.patch);
                }
                toml::ShapeSource::File(name) => {
                    let refuse = |problem| at(path, (Some(entry.line), problem));
                    let file = path.parent().unwrap_or(Path::new("")).join(name);
                    let format = SceneFormat::of_path(&file).filter(|f| *f != SceneFormat::Toml).ok_or_else(|| {
                        refuse(SceneProblem::Unsupported {
                            what: format!("`file` {}", crate::number_text::shown(name)),
                            allowed: format!(
                                "a scene can take blocks from {}",
                                SceneFormat::listed(|format| format != SceneFormat::Toml)
                            ),
                        })
                    })?;
                    let bytes = read_limited(&file)
                        .map_err(|error| refuse(SceneProblem::NamedFile { file: file.display().to_string(), error }))?;
                    let raws = read_foreign(&bytes, format, options).unwrap_or(Ok(Vec::new()));
                    let mut raws = raws.map_err(|problem| at(&file, problem))?;
                    let several = raws.len() > 1;
                    for (i, raw) in raws.iter_mut().enumerate() {
                        if let Some(name) = &entry.name {
                            raw.name = Some(if several { format!("{name}_{i}") } else { name.clone() });
                        }
                    }
                    let assembly = Assembly { file: &file, merging: format.merging(), ..assembly };
                    self.add_all(raws, &assembly, &entry.patch);
                }
            }
        }
        Ok(())
    }

    /// Says of blocks turned inside out which of them are cavities of others.
    pub(super) fn tell_cavities(&mut self) {
        self.inverted.tell_cavities(&self.blocks, &mut self.problems);
    }

    /// Multiplies every length of the blocks read so far; a block that is none then is a problem.
    pub(super) fn scale(&mut self, factor: &Number, path: &Path) {
        for mut block in std::mem::take(&mut self.blocks) {
            let vertices = block.block.vertices().iter().map(|v| v.map(|c| c.times(factor))).collect();
            let options = BlockOptions { planarity: block.planarity.clone() };
            match Block::new(vertices, block.block.topology().faces().to_vec(), &options) {
                Ok(scaled) => {
                    block.block = scaled;
                    self.shapes.share(&mut block.block);
                    self.blocks.push(block);
                }
                Err(error) => {
                    let block = format!("block {} \"{}\", scaled", block.origin.index, block.name);
                    let place = Box::new(BlockPlace { block, vertices: Vec::new(), cavity_of: None });
                    self.problems.push(at(path, (None, SceneProblem::Block { error, place })));
                }
            }
        }
    }

    fn add_one(&mut self, raw: RawBlock, index: usize, assembly: &Assembly<'_>, patch: &BodyProperties) {
        match assembly.build(raw, index, self.count) {
            Ok(mut block) => {
                patch.apply(&mut block.body);
                self.shapes.share(&mut block.block);
                self.blocks.push(block);
            }
            Err(wrong) => {
                let (problem, vertices) = *wrong;
                self.inverted.note(&problem, vertices, self.problems.len());
                self.problems.push(problem);
            }
        }
        self.count += 1;
    }
}
