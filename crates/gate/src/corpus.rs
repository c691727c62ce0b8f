//! Cases that are examined on every run of a gate.

use super::{Check, Verdict};
use rockproof_campaign::engines::Engines;
use rockproof_differential::case_file::{Case, CaseError, contact_rows};
use rockproof_differential::engine::{Shortage, catch_panic};
use rockproof_differential::external::protocol::completed;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Why a corpus cannot be examined.
#[derive(Debug, thiserror::Error)]
pub enum CorpusError {
    /// A file or folder cannot be read.
    #[error("{file}: {source}")]
    Io {
        /// Which.
        file: String,
        /// Why.
        source: io::Error,
    },
    /// A file is no case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// An engine cannot be asked.
    #[error(transparent)]
    Shortage(#[from] Shortage),
}

/// Examines case files, and all in folders, in the order of their names. A case passes when the oracle's answer is the one it records
/// and the engine either still says what it records or has come to say what is right; for a defect only the latter.
///
/// # Errors
/// When a file cannot be read, or an engine cannot be asked for want of something here.
pub fn checks(paths: &[PathBuf], engines: &Engines) -> Result<Vec<Check>, CorpusError> {
    let mut checks = Vec::new();
    for file in files(paths)? {
        checks.push(check(&file, engines)?);
        engines.check_shortage()?;
    }
    Ok(checks)
}

/// The case files of a corpus: those named, and all in the folders named, in the order of their names.
///
/// # Errors
/// When a folder cannot be read.
pub fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CorpusError> {
    paths.iter().map(|path| files_of(path)).collect::<Result<Vec<_>, _>>().map(|files| files.concat())
}

fn files_of(path: &Path) -> Result<Vec<PathBuf>, CorpusError> {
    let at = |source| CorpusError::Io { file: path.display().to_string(), source };
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(at)? {
        files.push(entry.map_err(at)?.path());
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    Ok(files)
}

fn check(file: &Path, engines: &Engines) -> Result<Check, CorpusError> {
    let begun = Instant::now();
    let case = Case::load(file)?;
    let (verdict, message) = judge(&case, engines);
    let name = file.display().to_string();
    let case = (verdict == Verdict::Fail).then(|| file.to_owned());
    Ok(Check {
        group: "corpus",
        name: name.clone(),
        message,
        verdict,
        place: (name, 1),
        rows: Vec::new(),
        seconds: begun.elapsed().as_secs_f64(),
        case,
    })
}

fn judge(case: &Case, engines: &Engines) -> (Verdict, String) {
    let about = &case.about;
    let Some(panel) = engines.panel_of(case) else {
        let reason = match about.engine.as_str() {
            precision @ ("f32" | "f64") => format!("no engine that is given {precision} takes part in this gate"),
            engine => format!("engine {engine} takes no part in this gate"),
        };
        return (Verdict::Skip, reason);
    };
    let exact = |a: &_, b: &_, t: &_| panel.oracle.prepare(a, b).pair().classify(t).contacts;
    let precision = panel.precisions().pop().unwrap_or(rockproof_model::Precision::F64);
    let near =
        || Some((case.a.rounded(precision)?, case.b.rounded(precision)?, case.tolerances.rounded(precision).ok()?));
    let Some((a, b, t)) = near() else { return (Verdict::Fail, format!("the input overflows in {precision}")) };
    let right = match about.cause.as_str() {
        "tolerance" => exact(&case.a, &case.b, &case.tolerances.ideal()),
        "representation" => exact(&case.a, &case.b, &case.tolerances),
        _ => exact(&a, &b, &t),
    };
    if contact_rows(&right) != about.expected {
        return (Verdict::Fail, "the exact answer is not the one the case expects".to_owned());
    }
    let said = match about.cause.as_str() {
        "tolerance" => exact(&case.a, &case.b, &case.tolerances),
        "representation" => exact(&a, &b, &t),
        _ => {
            let Some(engine) = panel.engines.first() else { return (Verdict::Skip, "no engine".to_owned()) };
            match catch_panic(|| engine.prepare(&a, &b)?.classify(&t)) {
                Ok(contacts) => completed(contacts, &right),
                Err(failure) if failure.change().name() == about.change => {
                    return (Verdict::Pass, "as recorded".to_owned());
                }
                Err(failure) => return (Verdict::Fail, failure.to_string()),
            }
        }
    };
    let said = contact_rows(&said);
    if said == about.expected {
        (Verdict::Pass, "the engine agrees".to_owned())
    } else if about.cause == "defect" {
        (Verdict::Fail, "a defect is back".to_owned())
    } else if said == about.found {
        (Verdict::Pass, "as recorded".to_owned())
    } else {
        (Verdict::Fail, format!("{} says neither what is right nor what the case records", about.engine))
    }
}
