//! Scenes: blocks with names, what they were read from, and the tolerances asked for.

mod builder;
mod cavity;
mod cells;
mod dda;
mod error;
mod format;
mod local_origin;
mod mesh;
mod msh;
mod obj;
mod ply;
mod raw;
mod stl;
mod tokens;
mod toml;
mod voro;
mod vtk;
mod vtu;
mod write;

pub use error::{BlockPlace, SceneError, SceneProblem, VertexPlace};
pub use format::SceneFormat;
pub use write::{FormatError, losses, write, write_tolerances, write_toml};

use crate::block::{Block, BlockOptions, Merged, Shapes};
use crate::files::{read_limited, without_mark};
use crate::number::Number;
use crate::simulation::{Body, Motion, Simulation, derive_stiffness};
use crate::tolerance::ToleranceSet;
use crate::tolerance_spec::ToleranceSpec;
use builder::SceneBuilder;
use raw::{Assembly, RawBlock};
use std::path::{Path, PathBuf};
use tokens::{Located, as_text, with_line_feeds};
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
    /// The line it begins on, from 1; none in a file that has no lines.
    pub line: Option<usize>,
    /// Its number in that file, from 0.
    pub index: usize,
}

/// What a reader may be told.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// How far faces may be from planar, whatever the file says; see [`crate::BlockOptions`].
    pub planarity: Option<Number>,
    /// Vertices no further apart than this (in the file's unit of length) become the first of them, whatever the format but TOML. If it is not
    /// given, those of STL that are one point, and no others.
    pub weld: Option<Number>,
    /// What every length is multiplied by, exactly, after vertices are joined; above 0. For files of coordinates alone: a scene in TOML, which has
    /// other lengths as well, is refused, but for a factor of 1.
    pub scale: Option<Number>,
}

impl LoadOptions {
    /// The factor that lengths are multiplied by, where that changes them.
    pub fn scaled(&self) -> Option<&Number> {
        self.scale.as_ref().filter(|scale| **scale != Number::from_integer(1))
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
        let bytes = read_limited(path).map_err(|error| at(path, (None, SceneProblem::Io(error))))?;
        Scene::survey_bytes(&bytes, format, path, options)
    }

    /// Reads a scene from the text of a file; `path` is what messages call it, and files named in it are looked
    /// for beside it.
    ///
    /// # Errors
    /// The first thing wrong with the text or with a block in it.
    pub fn parse(text: &str, format: SceneFormat, path: &Path) -> Result<Scene, SceneError> {
        Scene::parse_bytes(text.as_bytes(), format, path, &LoadOptions::default())
    }

    /// As [`Scene::parse`], of the bytes of a file, with options.
    ///
    /// # Errors
    /// The first thing wrong with the bytes or with a block in them.
    pub fn parse_bytes(
        bytes: &[u8],
        format: SceneFormat,
        path: &Path,
        options: &LoadOptions,
    ) -> Result<Scene, SceneError> {
        match Scene::survey_bytes(bytes, format, path, options)? {
            (scene, problems) if problems.is_empty() => Ok(scene),
            (_, mut problems) => Err(problems.swap_remove(0)),
        }
    }

    /// As [`Scene::survey`], of the bytes of a file; `path` as for [`Scene::parse`].
    ///
    /// # Errors
    /// When the bytes cannot be read to their end, or hold no block.
    pub fn survey_bytes(
        bytes: &[u8],
        format: SceneFormat,
        path: &Path,
        options: &LoadOptions,
    ) -> Result<(Scene, Vec<SceneError>), SceneError> {
        let mut gathered = SceneBuilder::default();
        let mut scene = Scene::default();
        let mut attached = None;
        match read_foreign(bytes, format, options) {
            None => {
                if options.scaled().is_some() {
                    return Err(at(path, (None, SceneProblem::ScaledScene)));
                }
                let document = as_text(bytes).and_then(toml::read).map_err(|problem| at(path, problem))?;
                gathered.add_entries(&document, path, options)?;
                gathered.tell_cavities();
                (scene.tolerances, scene.simulation) = (document.tolerances, document.simulation);
                attached = Some(document.attached);
            }
            Some(blocks) => {
                let blocks = blocks.map_err(|problem| at(path, problem))?;
                let assembly = Assembly { file: path, options, planarity: None, merging: format.merging() };
                gathered.add_all(blocks, &assembly, &BodyProperties::default());
                gathered.tell_cavities();
                if let Some(scale) = options.scaled() {
                    gathered.scale(scale, path);
                }
            }
        }
        if gathered.count == 0 {
            return Err(at(path, (None, joined_away(bytes, format, options).unwrap_or(SceneProblem::NoBlock))));
        }
        scene.blocks = gathered.blocks;
        // Where blocks are missing the numbers of the others mean nothing.
        if let (Some(attached), true) = (attached, gathered.problems.is_empty()) {
            attached.attach(&mut scene.blocks, &mut scene.simulation).map_err(|problem| at(path, problem))?;
        }
        Ok((scene, gathered.problems))
    }

    /// The name of a block that has one of its own, not one made of its number.
    pub fn own_name(&self, number: usize) -> Option<&str> {
        let name = self.blocks.get(number)?.name.as_str();
        (name != format!("block_{number}") && name != number.to_string()).then_some(name)
    }

    /// The blocks alone, in order.
    pub fn shapes(&self) -> Vec<&Block> {
        self.blocks.iter().map(|b| &b.block).collect()
    }

    /// Lets blocks of one shape hold it together, which takes less memory. Blocks that were read do.
    pub fn share_shapes(&mut self) {
        let mut shapes = Shapes::default();
        self.blocks.iter_mut().for_each(|block| shapes.share(&mut block.block));
    }

    /// The pairs of joint materials that two blocks have, the lower place first, in ascending order; those of two fixed blocks too.
    pub fn joint_pairs(&self) -> Vec<[usize; 2]> {
        let mut counts = vec![0_usize; self.simulation.joints.names.len()];
        self.blocks.iter().for_each(|block| counts[block.body.joint] += 1);
        let present: Vec<usize> = (0..counts.len()).filter(|&joint| counts[joint] > 0).collect();
        let from = |(place, &one): (usize, &usize)| present[place..].iter().map(move |&other| [one, other]);
        let pairs = present.iter().enumerate().flat_map(from);
        pairs.filter(|&[one, other]| one != other || counts[one] > 1).collect()
    }

    /// Whether each block is fixed, in order.
    pub fn fixed(&self) -> Vec<bool> {
        self.blocks.iter().map(|b| b.body.is_fixed()).collect()
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
        let bytes = read_limited(path).map_err(|error| at(path, (None, SceneProblem::Io(error))))?;
        as_text(&bytes).and_then(toml::read_tolerances).map_err(|problem| at(path, problem))
    }
}

/// The blocks of a file in a format that is not the project's own.
fn read_foreign(bytes: &[u8], format: SceneFormat, options: &LoadOptions) -> Option<Result<Vec<RawBlock>, Located>> {
    let weld = options.weld.as_ref();
    let text = |read: fn(&str) -> Result<Vec<RawBlock>, Located>| {
        let blocks = as_text(&with_line_feeds(bytes)).and_then(read);
        blocks.map(|blocks| blocks.into_iter().map(|raw| welded(raw, weld)).collect())
    };
    Some(match format {
        SceneFormat::Toml => return None,
        SceneFormat::Dda => text(dda::read),
        SceneFormat::Obj => as_text(&with_line_feeds(bytes)).and_then(|text| obj::read(text, weld)),
        SceneFormat::Stl => stl::read(bytes, weld.unwrap_or(&Number::ZERO)),
        SceneFormat::Ply => ply::read(without_mark(bytes), weld),
        SceneFormat::Msh => msh::read(without_mark(bytes), weld),
        SceneFormat::Vtk if vtk::is_binary(bytes) => Err(vtk::binary()),
        SceneFormat::Vtk => text(vtk::read),
        SceneFormat::Vtu => {
            vtu::read(without_mark(bytes)).map(|blocks| blocks.into_iter().map(|raw| welded(raw, weld)).collect())
        }
        SceneFormat::Voro => text(voro::read),
    })
}

/// Why a file has no block, where joining vertices left none.
fn joined_away(bytes: &[u8], format: SceneFormat, options: &LoadOptions) -> Option<SceneProblem> {
    let distance = options.weld.clone()?;
    let apart = read_foreign(bytes, format, &LoadOptions { weld: None, ..options.clone() })?.ok()?;
    let name = apart.first()?.name.clone().unwrap_or_else(|| "block_0".to_owned());
    Some(SceneProblem::JoinedAway { distance, name })
}

fn welded(raw: RawBlock, distance: Option<&Number>) -> RawBlock {
    match distance {
        Some(distance) => mesh::weld_block(raw, distance),
        None => raw,
    }
}

fn at(file: &Path, (line, problem): Located) -> SceneError {
    SceneError { file: file.to_path_buf(), line, problem }
}
