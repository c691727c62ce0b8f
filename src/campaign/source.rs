//! Where a campaign's pairs come from: the families, under the presets.

use super::config::CampaignConfig;
use super::families::{self, Family};
use super::subject::{Source, Subject, SubjectSet};
use crate::model::preset::{self, Preset};
use crate::model::{Block, Precision};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde_json::{Map, Value};
use std::sync::Arc;

/// Why a configuration names no pairs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SourceError {
    /// A family that does not exist.
    #[error("family \"{found}\" does not exist; there are {allowed}")]
    Family {
        /// What was found.
        found: String,
        /// The families.
        allowed: String,
    },
    /// A preset that does not exist.
    #[error("tolerance preset \"{found}\" does not exist; there are auto, shi, zero")]
    Preset {
        /// What was found.
        found: String,
    },
    /// The identity of the run cannot be written down.
    #[error("the configuration cannot be written as JSON: {0}")]
    Identity(String),
}

/// Pairs of the families in turn.
pub struct FamilySource {
    seed: u64,
    families: Vec<Arc<dyn Family>>,
    presets: Vec<Preset>,
}

/// The pairs that a configuration asks for.
///
/// # Errors
/// When it names what does not exist.
pub fn of(config: &CampaignConfig) -> Result<FamilySource, SourceError> {
    let names: Vec<&str> = config.families.iter().map(String::as_str).collect();
    let chosen = if names.is_empty() { Ok(families::all()) } else { families::named(&names) };
    let families = chosen.map_err(|found| SourceError::Family {
        found: found.to_owned(),
        allowed: families::all().iter().map(|f| f.name()).collect::<Vec<_>>().join(", "),
    })?;
    let preset = |name: &String| Preset::from_name(name).ok_or_else(|| SourceError::Preset { found: name.clone() });
    let presets = if config.tolerances.is_empty() {
        Preset::ALL.to_vec()
    } else {
        config.tolerances.iter().map(preset).collect::<Result<_, _>>()?
    };
    Ok(FamilySource { seed: config.seed, families, presets })
}

/// What must be the same for a run to go on.
///
/// # Errors
/// When the configuration cannot be written as JSON.
pub fn identity(config: &CampaignConfig) -> Result<Map<String, Value>, SourceError> {
    config.identity().map_err(|e| SourceError::Identity(e.to_string()))
}

impl FamilySource {
    fn sets(&self, a: &Block, b: &Block) -> Vec<SubjectSet> {
        let derive = |preset, precision| preset::derive(preset, &[a, b], precision).ok();
        let set = |&preset: &Preset| {
            let (f32, f64) = (derive(preset, Precision::F32)?, derive(preset, Precision::F64)?);
            Some(SubjectSet { name: preset.name().into(), f32, f64 })
        };
        self.presets.iter().filter_map(set).collect()
    }
}

impl Source for FamilySource {
    fn batch_len(&self) -> u64 {
        16
    }

    fn batch(&self, number: u64) -> Vec<Subject> {
        let first = number * self.batch_len();
        let subject = |index: u64| {
            let family = &self.families[(index % self.families.len() as u64) as usize];
            let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
            rng.set_stream(index);
            let (a, b) = family.generate(&mut rng);
            let sets = self.sets(&a, &b);
            Subject { index, family: family.name().into(), form: "random".into(), a, b, sets }
        };
        (first..first + self.batch_len()).map(subject).collect()
    }
}
