//! `examine`: is a model safe?

use crate::InputError;
use crate::arguments::{input_error, precision, threads, whole_number};
use crate::check::{Overlap, Violation};
use crate::model::Model;
use crate::signals::interruptible_with;
use crate::tolerances::{Tolerances, set_for, spec_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rockproof_differential::external::spec::quoted;
use rockproof_examine as lib;
use rockproof_model::Number;
use rockproof_model::scene::{SceneFormat, write_toml};
use rockproof_report::table::{Table, TableCell};
use rockproof_results::{Claim, Directory, FileKind, Owner, ResultsError, Start};
use std::path::{Path, PathBuf};

/// The most tolerance sets tried.
const MAX_CANDIDATES: u32 = 10_000;
/// The file that a model made in Python is written to.
const MODEL: &str = "model.toml";

/// An examination that is done, as `Examination` reads it.
#[pyclass(frozen, module = "rockproof")]
pub(crate) struct ExaminationRun {
    model: Model,
    found: lib::Examination,
    cases: Vec<lib::KeptCase>,
    verdict: lib::Verdict,
    /// The tolerances asked for, as options of a command.
    tolerances: String,
}

#[pymethods]
impl ExaminationRun {
    /// Whether the model is safe with the tolerances it was examined with.
    #[getter]
    fn is_safe(&self) -> bool {
        self.verdict.is_safe
    }

    /// "safe", "safe with another set", "not safe" or "not decided".
    #[getter]
    fn answer(&self) -> &'static str {
        self.verdict.answer
    }

    /// The answer as `rockproof examine` prints it, but for the next command.
    #[getter]
    fn text(&self) -> String {
        self.verdict.text()
    }

    /// The rules that the tolerances break.
    #[getter]
    fn violations(&self) -> Vec<Violation> {
        self.found.given.violations.iter().map(Violation::from).collect()
    }

    /// The blocks that overlap, by their numbers.
    #[getter]
    fn overlaps(&self) -> Vec<Overlap> {
        self.found.given.overlaps.all().map(|(found, severity)| Overlap::new(found, severity)).collect()
    }

    /// The complete tolerances that the model was examined with.
    #[getter]
    fn tolerances(&self) -> Tolerances {
        Tolerances(self.found.given.set.clone().into())
    }

    /// The complete tolerances that are better, or None.
    #[getter]
    fn recommended(&self) -> Option<Tolerances> {
        self.found.recommended().map(|other| Tolerances(other.set.clone().into()))
    }

    /// The pairs of blocks with something to say, the worst first, one dict each.
    fn findings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        dicts(py, &lib::findings_table(&self.found))
    }

    /// All neighbouring pairs of blocks, one dict each.
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        dicts(py, &lib::pair_table(&self.found))
    }

    /// Everything, as JSON.
    fn json(&self) -> String {
        lib::document(&self.found, &self.verdict).to_string()
    }

    /// Writes the results into a directory and answers the names of the files.
    fn write(&self, py: Python<'_>, directory: PathBuf, overwrite: bool) -> PyResult<Vec<String>> {
        py.detach(|| self.write_into(&directory, overwrite))
    }
}

impl ExaminationRun {
    fn write_into(&self, dir: &Path, overwrite: bool) -> PyResult<Vec<String>> {
        let own = self.model.path.is_none().then_some(MODEL);
        let files: Vec<&str> = lib::FILES.into_iter().chain(own).collect();
        let start = Start::of(false, overwrite);
        start.refuse_inputs(dir, self.model.path.as_deref()).map_err(refused)?;
        let mut directory =
            Directory::claim(Claim { dir, owner: Owner::Examine, start, files: &files }).map_err(refused)?;
        let naming = naming(&self.model, &self.tolerances, Some(dir));
        let verdict = lib::Verdict::of(&self.found, &self.cases, &naming);
        let written = lib::write((&self.found, &naming), &verdict, &self.cases, &mut directory).map_err(input_error)?;
        let mut names = written.names;
        if let Some(own) = own {
            directory
                .write(own, FileKind::Input, write_toml(&self.found.model.scene).as_bytes())
                .map_err(input_error)?;
            names.push(own.to_owned());
        }
        Ok(names)
    }
}

/// Why a directory was refused, in terms of `write`.
fn refused(error: ResultsError) -> PyErr {
    match error {
        ResultsError::Occupied { dir, .. } => {
            InputError::new_err(format!("{} holds an examination already; overwrite=True discards it", dir.display()))
        }
        ResultsError::OtherCommand { dir, found, .. } => {
            InputError::new_err(format!("{} belongs to `{}`; take another directory", dir.display(), found.command()))
        }
        ResultsError::Foreign { file, .. } => InputError::new_err(format!(
            "{} is in the way: no manifest says that an examination wrote it; move it, or take another directory",
            file.display()
        )),
        error => input_error(error),
    }
}

/// How commands name a model, of which results are in `dir`, if they are anywhere; one made in Python stands there as well.
fn naming(model: &Model, tolerances: &str, dir: Option<&Path>) -> lib::Naming {
    let file = model.path.clone().unwrap_or_else(|| dir.unwrap_or(Path::new("")).join(MODEL));
    lib::Naming {
        file: quoted(&file.display().to_string()),
        read: lib::reading(&model.options),
        tolerances: tolerances.to_owned(),
        units_are_meant: model.options.scale == Some(Number::from_integer(1)),
        dir: dir.map(Path::to_path_buf),
        is_usual_dir: false,
    }
}

fn dicts<'py>(py: Python<'py>, table: &Table) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let row = |cells: &Vec<TableCell>| {
        let dict = PyDict::new(py);
        for (name, cell) in table.columns.iter().zip(cells) {
            match cell {
                TableCell::Empty => dict.set_item(name, py.None())?,
                TableCell::Text(text) | TableCell::Scope(text) => dict.set_item(name, text)?,
                TableCell::Count(count) => dict.set_item(name, count)?,
                TableCell::Share(number) | TableCell::Number(number) | TableCell::Setting(number) => {
                    dict.set_item(name, number)?
                }
            }
        }
        Ok(dict)
    };
    table.rows.iter().map(row).collect()
}

/// Examines a model; `examine` in Python says what each argument means.
///
/// `progress` is called now and then with what is being done, how much of it is done, and how much there is.
#[pyfunction]
#[pyo3(signature = (model, tolerances, precision, steps, candidates, threads, progress=None))]
#[expect(clippy::too_many_arguments, reason = "one for each of the function in Python, which has them by name")]
pub(crate) fn run_examination(
    py: Python<'_>,
    model: &Model,
    tolerances: Option<&Bound<'_, PyAny>>,
    precision: &str,
    steps: Option<&Bound<'_, PyAny>>,
    candidates: &Bound<'_, PyAny>,
    threads: &Bound<'_, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<ExaminationRun> {
    let precision = self::precision(precision)?;
    let allowed = format!("whole numbers from 0 to {}, and None for as many as suit the model", u64::MAX);
    let steps = steps.map(|steps| whole_number(steps, "steps", 0..=u64::MAX, &allowed)).transpose()?;
    let allowed = format!("1 to {MAX_CANDIDATES}, and 0 for no search");
    let candidates = whole_number(candidates, "candidates", 0..=MAX_CANDIDATES.into(), &allowed)? as u32;
    let threads = self::threads(threads)?;
    let spec = spec_of(tolerances, model.scene.tolerances.as_ref())?;
    let given = tolerances.map_or(String::new(), |_| lib::setting(&spec));
    let settings = lib::Settings { steps, candidates, threads };
    let seen = lib::WorkProgress::default();
    let tick = |py: Python<'_>| match (&progress, seen.now()) {
        (Some(progress), Some(now)) => progress.call1(py, (now.stage.name(), now.done, now.total)).map(drop),
        _ => Ok(()),
    };
    let examined = interruptible_with(py, tick, |stop| {
        let set = set_for(&spec, &model.scene.shapes(), precision).map_err(|error| model.at(error))?;
        let name = model.path.clone().unwrap_or_else(|| PathBuf::from(MODEL));
        let format = SceneFormat::of_path(&name);
        let checked = lib::CheckedModel::new((name, format), model.scene.clone(), (spec, set), precision)
            .map_err(|error| model.at(input_error(error)))?;
        let found = lib::examine(checked, &settings, &seen, stop).map_err(|error| model.at(input_error(error)))?;
        Ok::<_, PyErr>(found.map(|found| {
            let cases = lib::worst_cases(&found);
            let verdict = lib::Verdict::of(&found, &cases, &naming(model, &given, None));
            (found, cases, verdict)
        }))
    })??;
    // Where it was stopped the signal was raised instead.
    let (found, cases, verdict) = examined.ok_or_else(|| InputError::new_err("the examination was stopped"))?;
    Ok(ExaminationRun { model: model.clone(), found, cases, verdict, tolerances: given })
}
