//! Campaigns, with engines written in Python among the others.

use crate::InputError;
use crate::arguments::{input_error, load_options, no_precision, precision, shown, threads, whole_number};
use crate::block::PyBlock;
use crate::engine::PythonEngine;
use crate::signals::interruptible_with;
use crate::tolerances::Tolerances;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::in_memory::CampaignOutcome;
use rockproof_campaign::journal::ProgressCounts;
use rockproof_campaign::run::Campaign;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_campaign::summary::SummaryRow;
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::builtin::{self, BuiltinOracle};
use rockproof_differential::engine::Engine;
use rockproof_differential::external::spec::check_name;
use rockproof_differential::finding::Finding;
use rockproof_differential::row::FindingRow;
use rockproof_differential::subject::PairSource;
use rockproof_model::scene::LoadOptions;
use rockproof_pairs::families as made;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A campaign that is done, as `Results` reads it.
#[pyclass(frozen, module = "rockproof")]
pub(crate) struct CampaignRun {
    source: FamilySource,
    pairs: u64,
    found: CampaignOutcome,
    seconds: f64,
}

/// One pair of a campaign.
#[pyclass(frozen, module = "rockproof", get_all)]
pub(crate) struct ExaminedPair {
    /// Its number in the campaign.
    index: u64,
    /// The family that made it.
    family: String,
    /// How it was made: "random", or the boundary it was directed at.
    form: String,
    /// The first block, exact.
    a: PyBlock,
    /// The second block, exact.
    b: PyBlock,
    /// The tolerance sets it was examined under, by name and then by precision ("f32", "f64").
    tolerances: BTreeMap<String, BTreeMap<&'static str, Tolerances>>,
}

#[pymethods]
impl ExaminedPair {
    fn __repr__(&self) -> String {
        format!("<ExaminedPair {}: {}, {}>", self.index, self.family, self.form)
    }
}

#[pymethods]
impl CampaignRun {
    /// Pairs examined.
    #[getter]
    fn pairs(&self) -> u64 {
        self.pairs
    }

    /// Contacts in the exact answers.
    #[getter]
    fn contacts(&self) -> u64 {
        self.found.contacts
    }

    /// How long it took, in s.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The findings, one dict each.
    fn findings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.found.findings.iter().map(|finding| finding_dict(py, finding)).collect()
    }

    /// Pairs and findings by group, one dict each.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.found.summary.rows().into_iter().map(|row| summary_dict(py, row)).collect()
    }

    /// The pair of a number.
    fn pair(&self, py: Python<'_>, index: &Bound<'_, PyAny>) -> PyResult<ExaminedPair> {
        let none =
            || InputError::new_err(format!("there is no pair {}; there are {}, from 0", shown(index), self.pairs));
        let allowed = 0..=self.pairs.saturating_sub(1);
        let index = whole_number(index, "index", allowed, "").map_err(|_| none())?;
        let batch = py.detach(|| self.source.batch(index / self.source.batch_len()));
        let subject = batch.into_iter().find(|subject| subject.index == index).ok_or_else(none)?;
        let sets = subject.sets.into_iter().map(|set| {
            let both = [("f32", Tolerances(set.f32.into())), ("f64", Tolerances(set.f64.into()))];
            (set.name.to_string(), both.into_iter().collect())
        });
        Ok(ExaminedPair {
            index,
            family: subject.family.to_string(),
            form: subject.form.to_string(),
            tolerances: sets.collect(),
            a: PyBlock(subject.a),
            b: PyBlock(subject.b),
        })
    }
}

fn finding_dict<'py>(py: Python<'py>, finding: &Finding) -> PyResult<Bound<'py, PyDict>> {
    let row = finding.row(String::new());
    let FindingRow { index, family, form, tolerances, engine, cause, change, .. } = row;
    let dict = PyDict::new(py);
    dict.set_item("index", index)?;
    dict.set_item("family", family)?;
    dict.set_item("form", form)?;
    dict.set_item("tolerances", tolerances)?;
    dict.set_item("engine", engine.to_string())?;
    dict.set_item("cause", cause.name())?;
    dict.set_item("change", change.name())?;
    let told = |text: String| (!text.is_empty()).then_some(text);
    dict.set_item("kind_before", told(row.kind_before))?;
    dict.set_item("kind_after", told(row.kind_after))?;
    dict.set_item("predicate", told(row.predicate))?;
    dict.set_item("features", told(row.features))?;
    dict.set_item("margin", row.margin)?;
    dict.set_item("margin_ulps", row.margin_ulps)?;
    dict.set_item("note", finding.note.as_deref())?;
    Ok(dict)
}

fn summary_dict(py: Python<'_>, row: SummaryRow) -> PyResult<Bound<'_, PyDict>> {
    let SummaryRow { family, form, tolerances, pairs, engine, cause, change, kind, findings } = row;
    let dict = PyDict::new(py);
    dict.set_item("family", family)?;
    dict.set_item("form", form)?;
    dict.set_item("tolerances", tolerances)?;
    dict.set_item("pairs", pairs)?;
    let told = |text: String| (!text.is_empty()).then_some(text);
    dict.set_item("engine", told(engine))?;
    dict.set_item("cause", told(cause))?;
    dict.set_item("change", told(change))?;
    dict.set_item("kind", told(kind))?;
    dict.set_item("findings", findings)?;
    Ok(dict)
}

/// What a campaign is asked to do; `campaign` in Python says what each means. Numbers and names are looked at one by one, so that messages name the
/// argument.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    pairs: Py<PyAny>,
    seed: Py<PyAny>,
    families: Vec<String>,
    tolerances: Vec<String>,
    real: Vec<PathBuf>,
    planarity: Option<Py<PyAny>>,
    weld: Option<Py<PyAny>>,
    scale: Option<Py<PyAny>>,
    metamorphic_every: Py<PyAny>,
    exact_ties: bool,
    threads: Py<PyAny>,
    precision: Py<PyAny>,
}

/// Runs a campaign. `engines` are names and pairs of a name and a function; `line` writes a function's answer as a line of the protocol.
///
/// `progress` is called now and then with the pairs looked at and the findings made.
#[pyfunction]
#[pyo3(signature = (engines, line, settings, progress=None))]
pub(crate) fn run_campaign(
    py: Python<'_>,
    engines: Vec<Bound<'_, PyAny>>,
    line: Py<PyAny>,
    settings: Settings,
    progress: Option<Py<PyAny>>,
) -> PyResult<CampaignRun> {
    let calculated = settings.precision.bind(py);
    let calculated = match calculated.cast::<PyString>() {
        Ok(name) => precision(&name.to_cow()?)?,
        Err(_) => return Err(no_precision(&shown(calculated))),
    };
    let counted = |value: &Py<PyAny>, name: &str, least: u64| {
        let allowed = format!("whole numbers from {least} to {}", u64::MAX);
        whole_number(value.bind(py), name, least..=u64::MAX, &allowed)
    };
    let (pairs, seed) = (counted(&settings.pairs, "pairs", 1)?, counted(&settings.seed, "seed", 0)?);
    let metamorphic_every = counted(&settings.metamorphic_every, "metamorphic_every", 0)?;
    let threads = threads(settings.threads.bind(py))?;
    for (name, given) in [("planarity", &settings.planarity), ("weld", &settings.weld), ("scale", &settings.scale)] {
        if given.is_some() && settings.real.is_empty() {
            return Err(InputError::new_err(format!("{name} is about the files of `real`, and there are none")));
        }
    }
    let bound = |given: &Option<Py<PyAny>>| given.as_ref().map(|given| given.bind(py).clone());
    let [planarity, weld, scale] = [&settings.planarity, &settings.weld, &settings.scale].map(bound);
    let LoadOptions { planarity, weld, scale } = load_options(planarity.as_ref(), weld.as_ref(), scale.as_ref())?;
    let mut config = CampaignConfig {
        pairs,
        seed,
        engines: Vec::new(),
        families: settings.families,
        tolerances: settings.tolerances,
        real: settings.real,
        planarity,
        weld,
        scale,
        metamorphic_every,
        exact_ties: settings.exact_ties,
        steps_every: 0,
        ..CampaignConfig::default()
    };
    let mut functions: Vec<PythonEngine> = Vec::new();
    for engine in engines {
        if let Ok(name) = engine.cast::<PyString>() {
            config.engines.push(name.extract()?);
        } else {
            let (name, function): (String, Py<PyAny>) = engine.extract()?;
            check_name(&name).map_err(input_error)?;
            functions.push(PythonEngine::new(name, calculated, function, line.clone_ref(py)));
        }
    }
    config.settle_engines();
    if !config.engines.is_empty() || functions.is_empty() {
        Engines::of(&config).map_err(input_error)?;
    }
    let names: Vec<&str> =
        config.engines.iter().map(String::as_str).chain(functions.iter().map(|f| f.name())).collect();
    if let Some(twice) = (1..names.len()).find(|&at| names[..at].contains(&names[at])) {
        return Err(InputError::new_err(format!("two engines are called \"{}\"", names[twice])));
    }
    let source = source::of(&config).map_err(input_error)?;
    let all = || -> Vec<Box<dyn Engine>> {
        let own = functions.iter().map(|function| Box::new(function.clone()) as Box<dyn Engine>);
        config.engines.iter().filter_map(|name| builtin::engine(name)).chain(own).collect()
    };
    let panel =
        EnginePanel { oracle: Box::new(BuiltinOracle), engines: all(), metamorphic_every: config.metamorphic_every };
    let started = Instant::now();
    let seen = ProgressCounts::default();
    let counted = |count: &AtomicU64| count.load(Ordering::Relaxed);
    let tick = |py: Python<'_>| match &progress {
        None => Ok(()),
        Some(progress) => progress.call1(py, (counted(&seen.pairs), counted(&seen.findings))).map(drop),
    };
    let examined = interruptible_with(py, tick, |stop| {
        let narrow = |finding: &Finding| builtin::narrowed(all(), &finding.scope, finding.needs_checks());
        let (config, source, panel) = (&config, &source, &panel);
        let campaign = Campaign { config, source, panel, narrow: &narrow, steppers: &[], threads };
        campaign.examine(stop, &seen)
    })?;
    let failed = |why: String| PyRuntimeError::new_err(why);
    let found = examined.map_err(|error| failed(error.to_string()))?;
    let found = found.ok_or_else(|| failed("the campaign was stopped".to_owned()))?;
    Ok(CampaignRun { source, pairs: config.pairs, found, seconds: started.elapsed().as_secs_f64() })
}

/// The families of pairs that a campaign can take, with what each is for.
#[pyfunction]
pub(crate) fn families() -> Vec<(&'static str, &'static str)> {
    made::all().iter().map(|family| (family.name(), family.describe())).collect()
}
