//! Models: blocks of a file, or made in Python.

use crate::InputError;
use crate::arguments::{Arithmetic, input_error, load_options, shown, whole_number};
use crate::block::PyBlock;
use crate::contacts::{PairContacts, PreparedBlocks, PyContact};
use crate::signals::interruptible;
use crate::tolerances::{Tolerances, set_for, spec_of};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use rayon::prelude::*;
use rockproof_differential::neighbours::neighbours;
use rockproof_model::{Block, LoadOptions, Scene, SceneBlock, ToleranceSpec};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Blocks with names, the tolerances a file asks for, and what moves them.
///
/// `load` reads one; `Model(blocks)` makes one of blocks at hand. A model is a sequence of its blocks.
#[pyclass(frozen, module = "rockproof", from_py_object)]
#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) scene: Scene,
    pub(crate) path: Option<PathBuf>,
    /// How the file was read.
    pub(crate) options: LoadOptions,
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (blocks, *, names=None))]
    fn new(blocks: Vec<PyBlock>, names: Option<Vec<String>>) -> PyResult<Model> {
        if blocks.is_empty() {
            return Err(InputError::new_err("a model needs at least one block"));
        }
        let names = names.unwrap_or_else(|| (0..blocks.len()).map(|number| format!("block_{number}")).collect());
        if names.len() != blocks.len() {
            return Err(InputError::new_err(format!("there are {} names for {} blocks", names.len(), blocks.len())));
        }
        let blocks = names.into_iter().zip(blocks).map(|(name, block)| SceneBlock::new(name, block.0)).collect();
        Ok(Model { scene: Scene { blocks, ..Scene::default() }, path: None, options: LoadOptions::default() })
    }

    /// The file it was read from, or None.
    #[getter]
    fn path(&self) -> Option<PathBuf> {
        self.path.clone()
    }

    /// The blocks, in the order of the file.
    #[getter]
    fn blocks(&self) -> Vec<PyBlock> {
        self.scene.blocks.iter().map(|block| PyBlock(block.block.clone())).collect()
    }

    /// The blocks' names.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.scene.blocks.iter().map(|block| block.name.clone()).collect()
    }

    /// The tolerances the file asks for, or None.
    #[getter]
    fn tolerances(&self) -> Option<Tolerances> {
        self.scene.tolerances.clone().map(Tolerances)
    }

    /// The contacts between neighbouring blocks: one PairContacts for each pair that has any.
    ///
    /// `tolerances` are those of the file, or "auto", if they are not given; they are derived from all blocks. `pair` asks about two blocks alone,
    /// by their numbers. `engine` as in `classify`.
    #[pyo3(signature = (tolerances=None, *, engine="exact", pair=None))]
    fn classify(
        &self,
        py: Python<'_>,
        tolerances: Option<&Bound<'_, PyAny>>,
        engine: &str,
        pair: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<PairContacts>> {
        let engine = Arithmetic::named(engine, "engine")?;
        let pair = pair.map(numbers_of_two).transpose()?;
        let spec = spec_of(tolerances, self.scene.tolerances.as_ref())?;
        let found = interruptible(py, |stop| self.contacts(&spec, engine, pair, stop))??;
        let touching = found.into_iter().filter(|(_, contacts)| !contacts.is_empty());
        touching.map(|(pair, contacts)| PairContacts::new(py, pair, contacts)).collect()
    }

    fn __len__(&self) -> usize {
        self.scene.blocks.len()
    }

    fn __getitem__(&self, number: isize) -> PyResult<PyBlock> {
        let count = self.scene.blocks.len();
        let at = if number < 0 { number.checked_add_unsigned(count) } else { Some(number) };
        let block = at.and_then(|at| self.scene.blocks.get(usize::try_from(at).ok()?));
        block
            .map(|block| PyBlock(block.block.clone()))
            .ok_or_else(|| PyIndexError::new_err(format!("block {number} of {count}")))
    }

    fn __repr__(&self) -> String {
        let from = self.path.as_ref().map_or(String::new(), |path| format!(" of {}", path.display()));
        format!("<Model: {} blocks{from}>", self.scene.blocks.len())
    }
}

/// The numbers of two blocks. One beyond all numbers of blocks is told as one that there is not.
fn numbers_of_two(pair: &Bound<'_, PyAny>) -> PyResult<(usize, usize)> {
    let refuse = || InputError::new_err(format!("pair is {}; allowed are two numbers of blocks, from 0", shown(pair)));
    let (i, j): (Bound<'_, PyAny>, Bound<'_, PyAny>) = pair.extract().map_err(|_| refuse())?;
    let number = |value| whole_number(value, "pair", 0..=u32::MAX.into(), "").map_err(|_| refuse());
    Ok((number(&i)? as usize, number(&j)? as usize))
}

/// Two blocks, by their numbers, and their contacts.
type PairAnswer = ((usize, usize), Vec<PyContact>);

impl Model {
    /// What messages about the model begin with.
    pub(crate) fn place(&self) -> String {
        self.path.as_ref().map_or(String::new(), |path| format!("{}: ", path.display()))
    }

    /// The blocks' numbers and names, for messages.
    fn labels(&self) -> Vec<String> {
        self.scene.blocks.iter().enumerate().map(|(number, block)| format!("{number} \"{}\"", block.name)).collect()
    }

    fn contacts(
        &self,
        spec: &ToleranceSpec,
        engine: Arithmetic,
        pair: Option<(usize, usize)>,
        stop: &AtomicBool,
    ) -> PyResult<Vec<PairAnswer>> {
        let blocks: Vec<&Block> = self.scene.shapes();
        let set = set_for(spec, &blocks, engine.precision()).map_err(|error| self.at(error))?;
        let pairs = match pair {
            None => neighbours(&blocks, &set),
            Some((i, j)) if i == j => return Err(InputError::new_err("a block is no pair with itself")),
            Some((i, j)) => {
                if let Some(missing) = [i, j].into_iter().find(|&number| number >= blocks.len()) {
                    let (place, count) = (self.place(), blocks.len());
                    return Err(InputError::new_err(format!(
                        "{place}pair names block {missing}; there are {count}, numbered from 0"
                    )));
                }
                vec![(i, j)]
            }
        };
        let prepared = PreparedBlocks::new(&blocks, &self.labels(), engine, &set).map_err(|error| self.at(error))?;
        let found: Option<Vec<_>> = pairs
            .into_par_iter()
            .map(|pair| (!stop.load(Ordering::Relaxed)).then(|| (pair, prepared.contacts(pair, &set))))
            .collect();
        // Where it was stopped the signal is raised instead.
        Ok(found.unwrap_or_default())
    }

    /// An error with the model's file before it.
    pub(crate) fn at(&self, error: PyErr) -> PyErr {
        match self.path {
            None => error,
            Some(_) => Python::attach(|py| InputError::new_err(format!("{}{}", self.place(), error.value(py)))),
        }
    }
}

/// Reads the blocks of a file, its format told by its extension: .toml, .dda, .obj, .stl, .ply, .msh, .vtk, .vtu, .txt and .voro (voro++).
///
/// `planarity` is how far faces may be from planar, as a share of a block's size; what the file says, or 1e-9, if it is not given. `weld` joins
/// vertices no further apart than this, in the file's unit of length; those of STL at one place, if it is not given.
///
/// `scale` is what every length is multiplied by, "1/1000" for a file in millimetres; `examine` takes 1 for "metres are meant". Scenes in TOML, which
/// have other lengths as well, are refused.
///
/// Raises InputError for the first thing wrong with the file, naming file and line, or the block.
#[pyfunction]
#[pyo3(signature = (path, *, planarity=None, weld=None, scale=None))]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    planarity: Option<&Bound<'_, PyAny>>,
    weld: Option<&Bound<'_, PyAny>>,
    scale: Option<&Bound<'_, PyAny>>,
) -> PyResult<Model> {
    let options = load_options(planarity, weld, scale)?;
    let scene = interruptible(py, |_| Scene::load_with(&path, &options))?.map_err(input_error)?;
    Ok(Model { scene, path: Some(path), options })
}
