//! Where a campaign's pairs come from: the families, under the presets.

use super::config::{CampaignConfig, LARGEST_CHUNK, SettingPlace};
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_model::files::read_limited;
use rockproof_model::text::{EXCERPT_LENGTH, begins_a_formula, escaped, excerpt, is_harmful};
use rockproof_model::{Block, LoadOptions, Number, Precision, Scene, SceneError, SpecError, ToleranceSpec, Vec3};
use rockproof_pairs::batch::{self, PairCase, PairConfig};
use rockproof_pairs::families::{self, RealNeighbours};
use rockproof_pairs::passing::PASSAGE;
use rockproof_pairs::tolerance_grid::ToleranceGridError;
use rockproof_pairs::tolerance_sets::{self, SetSource};
use rockproof_pairs::{motion, passing};
use rockproof_results::digest;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Why a configuration names no pairs.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A family that does not exist.
    #[error("family \"{}\" does not exist; there are {allowed}", excerpt(.found, EXCERPT_LENGTH))]
    Family {
        /// What was found.
        found: String,
        /// The families.
        allowed: String,
    },
    /// A tolerance set that does not exist.
    #[error(
        "tolerance set \"{}\" does not exist; there are {allowed}, changes of them (auto@territory*1/2@criteria=classic), and TOML files of tolerances",
        excerpt(.found, EXCERPT_LENGTH)
    )]
    Set {
        /// What was found.
        found: String,
        /// The sets.
        allowed: String,
    },
    /// An option for reading block files with a value that it cannot have.
    #[error("{name} is {found}; allowed is {allowed}")]
    Reading {
        /// The option.
        name: &'static str,
        /// What was found.
        found: Number,
        /// What it may be.
        allowed: &'static str,
    },
    /// A chunk that is too large.
    #[error(
        "chunk is {0}; allowed are 1 to {LARGEST_CHUNK} pairs: what is found in a chunk waits in memory until the chunk ends"
    )]
    Chunk(u64),
    /// A file of tolerances that names no set.
    #[error("{file}: {source}")]
    Spec {
        /// The file.
        file: String,
        /// Why.
        source: Box<SpecError>,
    },
    /// A file whose name cannot be that of a set.
    #[error(
        "{file}: in tables its set would be called \"{}\"; allowed are names without ':', '@' and control characters, and not with '=', '+', '-', a tab or a carriage return at the beginning, where a spreadsheet would calculate it: rename the file", escaped(.stem)
    )]
    Stem {
        /// The file.
        file: String,
        /// Its stem.
        stem: String,
    },
    /// A file that is called as a preset or another set that every campaign knows.
    #[error(
        "{file}: \"{stem}\" is a tolerance set of its own, so tables could not tell the two apart; rename the file"
    )]
    Known {
        /// The file.
        file: String,
        /// Its stem.
        stem: String,
    },
    /// Two sets of one name.
    #[error("{file}: another tolerance set is called \"{name}\" as well; rename the file")]
    Twice {
        /// The file.
        file: String,
        /// Its stem.
        name: String,
    },
    /// A grid of tolerance sets that is none.
    #[error(transparent)]
    Grid(#[from] ToleranceGridError),
    /// A file of tolerances that cannot be read: that is done as with scenes.
    #[error(transparent)]
    Tolerances(Box<SceneError>),
    /// A block file that cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A block file without neighbours.
    #[error("{file}: no two blocks are near enough to make a pair")]
    NoNeighbours {
        /// The file.
        file: String,
    },
    /// Only the family that makes steps, and no steps.
    #[error(
        "family \"{PASSAGE}\" makes steps and nothing else, and steps_every is 0; allowed are 1 and more, or other families beside it"
    )]
    NothingToDo,
    /// The identity of the run cannot be written down.
    #[error("the configuration cannot be written as JSON: {0}")]
    Identity(#[from] serde_json::Error),
}

impl SourceError {
    /// What of the configuration it is about; `None` of it as a whole.
    pub fn setting(&self) -> Option<SettingPlace<'_>> {
        let (key, value) = match self {
            SourceError::Family { found, .. } => ("families", Some(found.as_str())),
            SourceError::Set { found, .. } => ("tolerances", Some(found.as_str())),
            SourceError::Reading { name, .. } => (*name, None),
            SourceError::Chunk(_) => ("chunk", None),
            SourceError::Spec { file, .. }
            | SourceError::Stem { file, .. }
            | SourceError::Known { file, .. }
            | SourceError::Twice { file, .. } => ("tolerances", Some(file.as_str())),
            SourceError::Grid(_) => ("grid", None),
            SourceError::Tolerances(error) => ("tolerances", error.file.to_str()),
            SourceError::Scene(error) => ("real", error.file.to_str()),
            SourceError::NoNeighbours { file } => ("real", Some(file.as_str())),
            SourceError::NothingToDo => ("steps_every", None),
            SourceError::Identity(_) => return None,
        };
        Some(SettingPlace { engine: None, key, value })
    }
}

/// The pairs of a seed.
pub struct FamilySource {
    seed: u64,
    pairs: PairConfig,
    /// One pair in so many moves, for so many steps.
    steps: (u64, u32),
    /// The tolerance sets of the pairs of [`PASSAGE`]; none where it takes no part.
    passages: Vec<SetSource>,
}

/// That the options for reading block files have values that they can have.
fn check_reading(config: &CampaignConfig) -> Result<(), SourceError> {
    for (name, value, may_be_zero) in
        [("planarity", &config.planarity, true), ("weld", &config.weld, true), ("scale", &config.scale, false)]
    {
        if let Some(found) = value.as_ref().filter(|value| value.is_negative() || value.is_zero() && !may_be_zero) {
            let allowed = if may_be_zero { "0 or more" } else { "above 0" };
            return Err(SourceError::Reading { name, found: found.clone(), allowed });
        }
    }
    Ok(())
}

/// The pairs that a configuration asks for.
///
/// # Errors
/// When it names what does not exist, or a file that holds no pairs.
pub fn of(config: &CampaignConfig) -> Result<FamilySource, SourceError> {
    let names: Vec<&str> = config.families.iter().map(String::as_str).filter(|name| *name != PASSAGE).collect();
    let with_passages = config.families.is_empty() || names.len() < config.families.len();
    let chosen = if config.families.is_empty() { Ok(families::all()) } else { families::named(&names) };
    let mut families = chosen.map_err(|found| SourceError::Family {
        found: found.to_owned(),
        allowed: families::all().iter().map(|f| f.name()).chain([PASSAGE]).collect::<Vec<_>>().join(", "),
    })?;
    check_reading(config)?;
    if config.chunk == 0 || config.chunk > LARGEST_CHUNK {
        return Err(SourceError::Chunk(config.chunk));
    }
    if !config.real.is_empty() {
        let (planarity, weld, scale) = (config.planarity.clone(), config.weld.clone(), config.scale.clone());
        let options = LoadOptions { planarity, weld, scale };
        let mut blocks = Vec::new();
        for file in &config.real {
            // Pairs are sought within a file, so files are kept apart by a family of their own each.
            let scene = Scene::load_with(file, &options)?;
            blocks.push(
                RealNeighbours::neighbours(&scene.shapes().into_iter().cloned().collect::<Vec<Block>>())
                    .ok_or_else(|| SourceError::NoNeighbours { file: file.display().to_string() })?,
            );
        }
        families.retain(|f| f.name() != "real");
        families.extend(blocks.into_iter().map(|real| Arc::new(real) as Arc<dyn families::Family>));
    }
    let own = config.tolerances.is_empty() && config.grid.is_none();
    let names: Vec<&str> =
        if own { tolerance_sets::NAMES.to_vec() } else { config.tolerances.iter().map(String::as_str).collect() };
    let mut sets = set_sources(&names)?;
    // On a grid sets are to be compared with one another, so every base pair gets all of them.
    let sets_per_batch = if config.grid.is_some() { usize::MAX } else { sets.len().min(3) };
    if let Some(grid) = &config.grid {
        sets.extend(grid.sources()?);
    }
    if families.is_empty() && config.steps_every == 0 {
        return Err(SourceError::NothingToDo);
    }
    let passages = match (with_passages, own) {
        (false, _) => Vec::new(),
        (true, true) => passing::SETS.into_iter().map(set_source).collect::<Result<_, _>>()?,
        (true, false) => sets.clone(),
    };
    let perturbed_percent = if config.exact_ties { 0 } else { PairConfig::default().perturbed_percent };
    Ok(FamilySource {
        seed: config.seed,
        passages,
        pairs: PairConfig { families, sets, sets_per_batch, perturbed_percent, ..PairConfig::default() },
        steps: (config.steps_every, config.steps),
    })
}

/// The tolerance sets of a name, or of a TOML file of tolerances, which the file's stem names in tables.
///
/// # Errors
/// When there is none of that name, the file is none of tolerances, or its stem cannot be a name.
pub fn set_source(name: &str) -> Result<SetSource, SourceError> {
    if let Some(known) = SetSource::named(name) {
        return Ok(known);
    }
    let Some(file) = tolerance_file(name) else {
        return Err(SourceError::Set { found: name.to_owned(), allowed: tolerance_sets::NAMES.join(", ") });
    };
    let spec = ToleranceSpec::load(file).map_err(|error| SourceError::Tolerances(Box::new(error)))?;
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    // A colon is for ladders, an @ for changes, and a name is of one set; tables hold names as they are.
    let is_plain = !stem.contains([':', '@']) && !stem.contains(is_harmful) && !begins_a_formula(&stem);
    if SetSource::named(&stem).is_some() {
        return Err(SourceError::Known { file: name.to_owned(), stem });
    }
    if stem.is_empty() || !is_plain {
        return Err(SourceError::Stem { file: name.to_owned(), stem });
    }
    // Values missing without a preset would be missing for every pair.
    let zero = || Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
    let one = Vec3::new(Number::from_integer(1), Number::from_integer(1), Number::from_integer(1));
    if let Ok(cube) = Block::cuboid(&zero(), &one) {
        spec.derive(&[&cube, &cube], Precision::F64)
            .map_err(|source| SourceError::Spec { file: name.to_owned(), source: Box::new(source) })?;
    }
    Ok(SetSource::new(stem, move |a, b, precision| spec.derive(&[a, b], precision).ok()))
}

/// The file of tolerances that a name stands for, if it is one.
fn tolerance_file(name: &str) -> Option<&Path> {
    let path = Path::new(name);
    let is_toml = path.extension().is_some_and(|extension| extension == "toml");
    (SetSource::named(name).is_none() && (is_toml || path.is_file())).then_some(path)
}

/// The sources of these names and files; no two of one name.
///
/// # Errors
/// As [`set_source`], and when two files would have one name.
pub(super) fn set_sources(names: &[&str]) -> Result<Vec<SetSource>, SourceError> {
    let sources = names.iter().map(|name| set_source(name)).collect::<Result<Vec<_>, _>>()?;
    let twice = |at: usize| sources[..at].iter().any(|other| other.name() == sources[at].name());
    match (0..sources.len()).find(|&at| twice(at)) {
        Some(at) if tolerance_file(names[at]).is_some() => {
            Err(SourceError::Twice { file: names[at].to_owned(), name: sources[at].name().to_owned() })
        }
        _ => Ok(sources),
    }
}

/// What the sets of a configuration are called in tables.
///
/// # Errors
/// As [`set_source`].
pub fn set_names(config: &CampaignConfig) -> Result<Vec<String>, SourceError> {
    config.tolerances.iter().map(|name| Ok(set_source(name)?.name().to_owned())).collect()
}

/// What stands before a file's name in the key of its content.
pub(crate) const CONTENT: &str = "content of ";

/// What must be the same for a run to go on: the configuration, and the content of the block files.
///
/// # Errors
/// When a path cannot be written as JSON.
pub fn identity(config: &CampaignConfig) -> Result<Map<String, Value>, SourceError> {
    let mut identity = config.identity()?;
    let tolerances = config.tolerances.iter().filter_map(|name| tolerance_file(name));
    for file in config.real.iter().map(PathBuf::as_path).chain(tolerances) {
        identity.insert(format!("{CONTENT}{}", file.display()), content(file).into());
    }
    Ok(identity)
}

/// Length and SHA-256 of a file; empty if it cannot be read, which [`of`] reports.
fn content(file: &Path) -> String {
    read_limited(file).map_or(String::new(), |bytes| format!("{} bytes, SHA-256 {}", bytes.len(), digest(&bytes)))
}

impl FamilySource {
    /// The names of its families, that of pairs that only move last.
    pub fn families(&self) -> Vec<&str> {
        let moving = (!self.passages.is_empty()).then_some(PASSAGE);
        self.pairs.families.iter().map(|family| family.name()).chain(moving).collect()
    }

    /// The names of its tolerance sets; what ladders make of them is left out.
    pub fn sets(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for set in self.pairs.sets.iter().chain(&self.passages) {
            if !names.contains(&set.name()) {
                names.push(set.name());
            }
        }
        names
    }

    /// The pairs of one batch with all that is known of how they were made.
    pub fn cases(&self, number: u64) -> Vec<PairCase> {
        if self.pairs.families.is_empty() {
            return Vec::new();
        }
        batch::batch(self.seed, number, &self.pairs)
    }
}

impl PairSource for FamilySource {
    fn batch_len(&self) -> u64 {
        batch::BATCH
    }

    fn batch(&self, number: u64) -> Vec<Subject> {
        self.cases(number).into_iter().map(Subject::from).collect()
    }

    fn motion(&self, subject: &Subject) -> Option<PairMotion> {
        let (every, steps) = self.steps;
        let mut rng = motion::generator(self.seed, subject.index);
        if steps == 0 || !motion::moves(&mut rng, every) {
            return None;
        }
        let family = self.pairs.families.iter().find(|family| family.name() == &*subject.family);
        let manner = family.map(|family| family.motion_style()).unwrap_or_default();
        Some(motion::drawn(&mut rng, manner, &subject.a, &subject.b, steps))
    }

    fn step_pairs(&self, number: u64) -> Vec<(Subject, PairMotion)> {
        let (every, steps) = self.steps;
        if self.passages.is_empty() || steps == 0 {
            return Vec::new();
        }
        // Half as many as of another family, for each makes its step under more sets.
        let every = every * (2 * self.pairs.families.len() as u64).max(1);
        let indices = number * batch::BATCH..(number + 1) * batch::BATCH;
        indices.filter_map(|index| passing::pair(self.seed, index, every, steps, &self.passages)).collect()
    }
}
