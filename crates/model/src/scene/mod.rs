//! Scenes: blocks with names, what they were read from, and the tolerances asked for.

mod dda;
mod error;
mod obj;
mod raw;
mod tokens;
mod toml;
mod voro;
mod vtk;
mod write;

pub use error::{SceneError, SceneProblem};
pub use write::{FormatError, write_obj, write_tolerances, write_toml, write_vtk};

use crate::block::{Block, BlockOptions, Merged, Merging};
use crate::files::read_limited;
use crate::number::Number;
use crate::simulation::{Body, Motion, Simulation, derive_stiffness};
use crate::tolerance::ToleranceSet;
use crate::tolerance_spec::ToleranceSpec;
use raw::{Assembly, RawBlock};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use tokens::Located;
use toml::BodyProperties;

/// Blocks, in the order of their file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scene {
    /// The blocks.
    pub blocks: Vec<SceneBlock>,
    /// The tolerances that the file asks for.
    pub tolerances: Option<ToleranceSpec>,
    /// What makes the blocks move.
    pub simulation: Simulation,
}

/// A block with what is known about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneBlock {
    /// Its name in the file, or `block_` and its number.
    pub name: String,
    /// How it moves, and in which state it starts.
    pub body: Body,
    /// Where it was read from.
    pub origin: BlockOrigin,
    /// The planarity it was read with; see [`crate::BlockOptions`].
    pub planarity: Number,
    /// What was merged to bring it into canonical form.
    pub merged: Merged,
    /// The block.
    pub block: Block,
}

/// Where a block was read from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockOrigin {
    /// The file.
    pub file: PathBuf,
    /// The line it begins on, from 1.
    pub line: usize,
    /// Its number in that file, from 0.
    pub index: usize,
}

/// What a reader may be told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// How far faces may be from planar, whatever the file says; see [`crate::BlockOptions`].
    pub planarity: Option<Number>,
}

/// A file format for blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SceneFormat {
    /// The project's own scenes, `.toml`.
    Toml,
    /// UnBlocks-gen, `.dda`.
    Dda,
    /// Wavefront, `.obj`.
    Obj,
    /// Legacy VTK polyhedra in ASCII, `.vtk`.
    Vtk,
    /// voro++, `.txt` or `.voro`.
    Voro,
}

impl SceneFormat {
    /// The format that a file's extension names; upper or lower case.
    pub fn of_path(path: &Path) -> Option<SceneFormat> {
        match path.extension().and_then(OsStr::to_str)?.to_ascii_lowercase().as_str() {
            "toml" => Some(SceneFormat::Toml),
            "dda" => Some(SceneFormat::Dda),
            "obj" => Some(SceneFormat::Obj),
            "vtk" => Some(SceneFormat::Vtk),
            "txt" | "voro" => Some(SceneFormat::Voro),
            _ => None,
        }
    }

    /// Triangulated meshes with rounded coordinates come as OBJ and VTK; the other formats hold faces as they are.
    fn merging(self) -> Merging {
        match self {
            SceneFormat::Obj | SceneFormat::Vtk => Merging::WithinPlanarity,
            SceneFormat::Toml | SceneFormat::Dda | SceneFormat::Voro => Merging::Exact,
        }
    }
}

impl Scene {
    /// A scene that begins with a fixed block, on which others can stand.
    pub fn on_fixed(name: impl Into<String>, block: Block) -> Scene {
        let mut base = SceneBlock::new(name, block);
        base.body.motion = Motion::Fixed;
        Scene { blocks: vec![base], ..Scene::default() }
    }

    /// Gives every joint without a normal stiffness one that suits the blocks and a tolerance set ([`derive_stiffness`]).
    pub fn derive_stiffness(&mut self, set: &ToleranceSet) {
        let bodies: Vec<_> = self.blocks.iter().map(|block| (&block.block, &block.body)).collect();
        derive_stiffness(&mut self.simulation, &bodies, set);
    }

    /// Reads a file, its format told by its extension.
    ///
    /// # Errors
    /// The first thing wrong with the file or with a block in it.
    pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        Scene::load_with(path, &LoadOptions::default())
    }

    /// As [`Scene::load`], with options.
    ///
    /// # Errors
    /// The first thing wrong with the file or with a block in it.
    pub fn load_with(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Scene, SceneError> {
        match Scene::survey(path, options)? {
            (scene, problems) if problems.is_empty() => Ok(scene),
            (_, mut problems) => Err(problems.swap_remove(0)),
        }
    }

    /// As [`Scene::load_with`], but goes on behind blocks that are none and answers what is wrong with each.
    ///
    /// # Errors
    /// When the file cannot be read to its end, or holds no block.
    pub fn survey(path: impl AsRef<Path>, options: &LoadOptions) -> Result<(Scene, Vec<SceneError>), SceneError> {
        let path = path.as_ref();
        let format = SceneFormat::of_path(path).ok_or_else(|| at(path, (None, SceneProblem::UnknownFormat)))?;
        let text = read_text(path, format)?;
        Scene::of_text(&text, format, path, options)
    }

    /// Reads a scene from a text instead of a file; `path` is what messages call it, and files named in it are looked
    /// for beside it.
    ///
    /// # Errors
    /// The first thing wrong with the text or with a block in it.
    pub fn parse(text: &str, format: SceneFormat, path: &Path) -> Result<Scene, SceneError> {
        match Scene::of_text(text, format, path, &LoadOptions::default())? {
            (scene, problems) if problems.is_empty() => Ok(scene),
            (_, mut problems) => Err(problems.swap_remove(0)),
        }
    }

    fn of_text(
        text: &str,
        format: SceneFormat,
        path: &Path,
        options: &LoadOptions,
    ) -> Result<(Scene, Vec<SceneError>), SceneError> {
        let mut gathered = SceneBuilder::default();
        let mut scene = Scene::default();
        let mut attached = None;
        match read_foreign(text, format) {
            None => {
                let document = toml::read(text).map_err(|problem| at(path, problem))?;
                gathered.add_entries(&document, path, options)?;
                (scene.tolerances, scene.simulation) = (document.tolerances, document.simulation);
                attached = Some(document.attached);
            }
            Some(blocks) => {
                let blocks = blocks.map_err(|problem| at(path, problem))?;
                let assembly = Assembly { file: path, options, planarity: None, merging: format.merging() };
                gathered.add_all(blocks, &assembly, &BodyProperties::default());
            }
        }
        if gathered.count == 0 {
            return Err(at(path, (None, SceneProblem::NoBlock)));
        }
        scene.blocks = gathered.blocks;
        // Where blocks are missing the numbers of the others mean nothing.
        if let (Some(attached), true) = (attached, gathered.problems.is_empty()) {
            attached.attach(&mut scene.blocks, &mut scene.simulation).map_err(|problem| at(path, problem))?;
        }
        Ok((scene, gathered.problems))
    }

    /// The blocks alone, in order.
    pub fn shapes(&self) -> Vec<&Block> {
        self.blocks.iter().map(|b| &b.block).collect()
    }
}

impl SceneBlock {
    /// A block that was made, not read.
    pub fn new(name: impl Into<String>, block: Block) -> SceneBlock {
        SceneBlock {
            name: name.into(),
            body: Body::default(),
            origin: BlockOrigin::default(),
            planarity: BlockOptions::default().planarity,
            merged: Merged::default(),
            block,
        }
    }
}

impl ToleranceSpec {
    /// Reads a TOML file of tolerances: a table `[tolerances]`, beside which anything may stand, or the bare values.
    ///
    /// # Errors
    /// When the file cannot be read or says what is not allowed.
    pub fn load(path: impl AsRef<Path>) -> Result<ToleranceSpec, SceneError> {
        let path = path.as_ref();
        let text = read_text(path, SceneFormat::Toml)?;
        toml::read_tolerances(&text).map_err(|problem| at(path, problem))
    }
}

/// Blocks read so far. Blocks are numbered in the order read, good or bad.
#[derive(Default)]
struct SceneBuilder {
    blocks: Vec<SceneBlock>,
    problems: Vec<SceneError>,
    count: usize,
}

impl SceneBuilder {
    fn add_all(&mut self, raws: Vec<RawBlock>, assembly: &Assembly<'_>, patch: &BodyProperties) {
        for (index, raw) in raws.into_iter().enumerate() {
            self.add_one(raw, index, assembly, patch);
        }
    }

    fn add_entries(&mut self, document: &toml::Document, path: &Path, options: &LoadOptions) -> Result<(), SceneError> {
        for (index, entry) in document.entries.iter().enumerate() {
            let planarity = entry.planarity.as_ref().or(document.planarity.as_ref());
            let assembly = Assembly { file: path, options, planarity, merging: Merging::Exact };
            let raw = |vertices, faces| RawBlock {
                name: entry.name.clone(),
                fixed: false,
                vertices,
                faces,
                line: entry.line,
            };
            match &entry.content {
                toml::ShapeSource::Mesh { vertices, faces } => {
                    self.add_one(raw(vertices.clone(), faces.clone()), index, &assembly, &entry.patch);
                }
                toml::ShapeSource::Box { min, max } => {
                    let (vertices, faces) = crate::block::cuboid_mesh(min, max);
                    self.add_one(raw(vertices, faces), index, &assembly, &entry.patch);
                }
                toml::ShapeSource::File(name) => {
                    let refuse = |problem| at(path, (Some(entry.line), problem));
                    let file = path.parent().unwrap_or(Path::new("")).join(name);
                    let format = SceneFormat::of_path(&file).filter(|f| *f != SceneFormat::Toml).ok_or_else(|| {
                        refuse(SceneProblem::Unsupported {
                            what: format!("`file` {}", crate::number_text::shown(name)),
                            allowed: "a scene can take blocks from .dda, .obj, .vtk, .txt and .voro".to_string(),
                        })
                    })?;
                    let text = read_text(&file, format).map_err(|error| match error.problem {
                        SceneProblem::Io(error) => {
                            refuse(SceneProblem::NamedFile { file: file.display().to_string(), error })
                        }
                        _ => error,
                    })?;
                    let mut raws = read_foreign(&text, format).unwrap_or(Ok(Vec::new())).map_err(|p| at(&file, p))?;
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

    fn add_one(&mut self, raw: RawBlock, index: usize, assembly: &Assembly<'_>, patch: &BodyProperties) {
        match assembly.build(raw, index, self.count) {
            Ok(mut block) => {
                patch.apply(&mut block.body);
                self.blocks.push(block);
            }
            Err(problem) => self.problems.push(problem),
        }
        self.count += 1;
    }
}

/// The blocks of a file in a format that is not the project's own.
fn read_foreign(text: &str, format: SceneFormat) -> Option<Result<Vec<RawBlock>, Located>> {
    match format {
        SceneFormat::Toml => None,
        SceneFormat::Dda => Some(dda::read(text)),
        SceneFormat::Obj => Some(obj::read(text)),
        SceneFormat::Vtk => Some(vtk::read(text)),
        SceneFormat::Voro => Some(voro::read(text)),
    }
}

/// A file as text, or why it is none.
fn read_text(path: &Path, format: SceneFormat) -> Result<String, SceneError> {
    let bytes = read_limited(path).map_err(|error| at(path, (None, SceneProblem::Io(error))))?;
    if format == SceneFormat::Vtk && vtk::is_binary(&bytes) {
        return Err(at(path, vtk::binary()));
    }
    let not_text = |offset: usize, bytes: &[u8]| {
        let line = bytes[..offset].iter().filter(|&&b| b == b'\n').count() + 1;
        at(path, (Some(line), SceneProblem::NotText { offset, byte: bytes[offset] }))
    };
    if let Some(offset) = bytes.iter().position(|&b| b == 0) {
        return Err(not_text(offset, &bytes));
    }
    String::from_utf8(bytes).map_err(|error| not_text(error.utf8_error().valid_up_to(), error.as_bytes()))
}

fn at(file: &Path, (line, problem): Located) -> SceneError {
    SceneError { file: file.to_path_buf(), line, problem }
}
