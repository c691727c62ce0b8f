//! The engines of a campaign: the built-in ones and external programs, as panels.

use super::config::{CampaignConfig, SettingPlace};
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::builtin::{self, BuiltinOracle};
use rockproof_differential::case_file::Case;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::{Engine, Shortage};
use rockproof_differential::external::{EngineSpec, EngineSpecError, External};
use rockproof_differential::finding::{Finding, FindingScope};
use rockproof_differential::hull::convex_hull;
use rockproof_model::preset::{self, Preset};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Block, Number, Point, Precision};

/// The engines of a campaign.
pub struct Engines {
    builtin: Vec<String>,
    external: Vec<External>,
    /// The external engines as they are asked about cases of unstable answers: twice. None where they are asked all twice.
    asked_twice: Vec<External>,
    metamorphic_every: u64,
}

/// Why there are no such engines.
#[derive(Debug, thiserror::Error)]
pub enum EnginesError {
    /// A name that no engine has.
    #[error("engine \"{}\" does not exist; there are {allowed}", excerpt(.found, EXCERPT_LENGTH))]
    Unknown {
        /// What was found.
        found: String,
        /// The engines.
        allowed: String,
    },
    /// An external engine that cannot be.
    #[error(transparent)]
    Spec(#[from] EngineSpecError),
    /// No engine is left.
    #[error("no engine is named; there are {allowed}")]
    None {
        /// The engines.
        allowed: String,
    },
    /// An external engine that does not answer a first question.
    #[error(
        "engine \"{name}\" ({command}) does not answer a first question about two boxes: {what}; docs/engines.md shows what is asked and what to answer"
    )]
    NoReply {
        /// The engine.
        name: String,
        /// How it is started.
        command: String,
        /// What went wrong.
        what: String,
    },
    /// An external engine that cannot be asked.
    #[error(transparent)]
    Shortage(#[from] Shortage),
}

impl EnginesError {
    /// What of the configuration it is about; `None` of it as a whole.
    pub fn setting(&self) -> Option<SettingPlace<'_>> {
        let (engine, key, value) = match self {
            EnginesError::Unknown { found, .. } => (None, "engines", Some(found.as_str())),
            EnginesError::None { .. } => (None, "engines", None),
            EnginesError::NoReply { name, .. } => (Some(name), "command", None),
            EnginesError::Spec(error) => match error {
                EngineSpecError::Name(name) | EngineSpecError::Twice(name) => (Some(name), "name", None),
                EngineSpecError::Command { name, .. } => (Some(name), "command", None),
                EngineSpecError::Timeout(name) => (Some(name), "timeout_ms", None),
                EngineSpecError::Accuracy { name, .. } => (Some(name), "accuracy", None),
                EngineSpecError::Form(_) | EngineSpecError::Precision { .. } | EngineSpecError::Number { .. } => {
                    return None;
                }
            },
            EnginesError::Shortage(_) => return None,
        };
        Some(SettingPlace { engine: engine.map(String::as_str), key, value })
    }
}

impl Engines {
    /// The engines a configuration names. No program is started.
    ///
    /// # Errors
    /// When an engine does not exist or cannot be, or there is none.
    pub fn of(config: &CampaignConfig) -> Result<Engines, EnginesError> {
        let known = || builtin::ENGINES.into_iter().chain(config.external.iter().map(|spec| spec.name.as_str()));
        let allowed = || known().collect::<Vec<_>>().join(", ");
        EngineSpec::check_all(&config.external)?;
        if let Some(found) = config.engines.iter().find(|name| builtin::engine(name).is_none()) {
            return Err(EnginesError::Unknown { found: found.clone(), allowed: allowed() });
        }
        if config.engines.is_empty() && config.external.is_empty() {
            return Err(EnginesError::None { allowed: allowed() });
        }
        let started = |twice| config.external.iter().map(|spec| External::new(spec.clone(), twice)).collect();
        let asked_twice = if config.ask_twice { Vec::new() } else { started(true) };
        let (builtin, external) = (config.engines.clone(), started(config.ask_twice));
        Ok(Engines { builtin, external, asked_twice, metamorphic_every: config.metamorphic_every })
    }

    /// Asks every external engine about two boxes, so that one that never answers is told of at once.
    ///
    /// # Errors
    /// The first that does not answer.
    pub fn probe(&self) -> Result<(), EnginesError> {
        self.external.iter().try_for_each(|engine| self.probe_engine(engine))
    }

    /// The same of the external engine of this name, if there is one.
    ///
    /// # Errors
    /// When it does not answer.
    pub fn probe_named(&self, name: &str) -> Result<(), EnginesError> {
        self.external.iter().filter(|engine| engine.name() == name).try_for_each(|engine| self.probe_engine(engine))
    }

    fn probe_engine(&self, engine: &External) -> Result<(), EnginesError> {
        let Some((a, b)) = box_at(0).zip(box_at(2)) else { return Ok(()) };
        let Ok(tolerances) = preset::derive(Preset::Auto, &[&a, &b], engine.precision()) else { return Ok(()) };
        let near = |block: &Block| block.rounded(engine.precision());
        let Some(((a, b), tolerances)) = near(&a).zip(near(&b)).zip(tolerances.rounded(engine.precision()).ok()) else {
            return Ok(());
        };
        let answered = engine.probe(&a, &b, &tolerances);
        self.check_shortage()?;
        answered.map_err(|what| EnginesError::NoReply {
            name: engine.name().to_owned(),
            command: engine.spec().command.join(" "),
            what,
        })
    }

    /// That all engines could be asked so far.
    ///
    /// # Errors
    /// What this program lacked for one: then what that one said counts for nothing.
    pub fn check_shortage(&self) -> Result<(), Shortage> {
        let mut all = self.external.iter().chain(&self.asked_twice);
        all.find_map(|engine| engine.shortage()).map_or(Ok(()), |shortage| Err(shortage.clone()))
    }

    fn named(&self) -> Vec<Box<dyn Engine>> {
        self.with(&self.external)
    }

    /// The built-in engines and these.
    fn with(&self, external: &[External]) -> Vec<Box<dyn Engine>> {
        let external = external.iter().map(|engine| Box::new(engine.clone()) as Box<dyn Engine>);
        self.builtin.iter().filter_map(|name| builtin::engine(name)).chain(external).collect()
    }

    /// How an external engine is started; `None` where none has the name.
    pub fn spec(&self, name: &str) -> Option<&EngineSpec> {
        self.external.iter().map(External::spec).find(|spec| spec.name == name)
    }

    /// The names in the order of the panel.
    pub fn names(&self) -> Vec<String> {
        self.named().iter().map(|engine| engine.name().to_owned()).collect()
    }

    /// The names in the order of the panel, each with the precision that the engine rounds its input to.
    pub fn precisions(&self) -> Vec<(String, Precision)> {
        self.named().iter().map(|engine| (engine.name().to_owned(), engine.precision())).collect()
    }

    /// The engine of a name, if it takes part.
    pub fn find(&self, name: &str) -> Option<Box<dyn Engine>> {
        self.named().into_iter().find(|engine| engine.name() == name)
    }

    /// The oracle with all engines.
    pub fn panel(&self) -> EnginePanel {
        EnginePanel {
            oracle: Box::new(BuiltinOracle),
            engines: self.named(),
            metamorphic_every: self.metamorphic_every,
        }
    }

    /// A panel with no engine that a finding is not about, and metamorphic checks only where it is about one: what it takes
    /// to see the finding again.
    pub fn panel_for(&self, finding: &Finding) -> EnginePanel {
        self.narrow(&finding.scope, finding.difference.change, finding.needs_checks())
    }

    /// The same for a finding about `scope` with the given change, which metamorphic checks show or not. Whether answers are unstable nobody sees who asks once, so of such a finding external
    /// engines are asked twice, whatever the configuration says.
    fn narrow(&self, scope: &FindingScope, change: AnswerChange, needs_checks: bool) -> EnginePanel {
        let twice = change == AnswerChange::Unstable && !self.asked_twice.is_empty();
        builtin::narrowed(if twice { self.with(&self.asked_twice) } else { self.named() }, scope, needs_checks)
    }

    /// The same for a case; `None` where its change does not exist or its engine takes no part.
    pub fn panel_of(&self, case: &Case) -> Option<EnginePanel> {
        let about = &case.about;
        let scope = FindingScope::from_name(&about.engine);
        let panel = self.narrow(&scope, AnswerChange::from_name(&about.change)?, about.checked_change().is_some());
        (!panel.engines.is_empty()).then_some(panel)
    }
}

/// A box of edge 1 at a place along x.
fn box_at(x: i32) -> Option<Block> {
    let corner = |n: i32| {
        let [x, y, z] = [x + (n & 1), (n >> 1) & 1, (n >> 2) & 1].map(Number::from_integer);
        Point::new(x, y, z)
    };
    convex_hull(&(0..8).map(corner).collect::<Vec<_>>()).ok()
}
