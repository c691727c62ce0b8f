//! Cases that are examined on every run of a gate.

use super::contradiction::{Contradiction, PairVerdict};
use super::{Check, CheckStatus};
use rockproof_campaign::engines::Engines;
use rockproof_differential::answer_detail::left_unsaid;
use rockproof_differential::case_file::{Case, CaseDescription, CaseError, ContactRow, contact_rows};
use rockproof_differential::collision::CollisionQuery;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::{Answer, Shortage, catch_panic};
use rockproof_differential::external::protocol::completed;
use rockproof_differential::external::spec::replay_command;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::{ReplayError, ReplayedStep, StepCase, StepCause};
use rockproof_differential::separation_state::ReportedState;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use std::collections::BTreeSet;
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
    /// A folder holds no case, though it is named as one that does.
    #[error(
        "corpus: the folder {0} holds no case, no file .toml or .json (folders in it are not looked through); `corpus = []` is a gate without cases"
    )]
    Empty(String),
    /// There is no such file or folder.
    #[error(
        "corpus: there is no {0}; it names case files or folders of them (cases/regressions where it is not set), and `corpus = []` is a gate without cases"
    )]
    Missing(String),
    /// A file is no case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A state file is none, or its step cannot be made.
    #[error("{file}: {source}")]
    Step {
        /// Which.
        file: String,
        /// Why.
        source: ReplayError,
    },
    /// An engine cannot be asked.
    #[error(transparent)]
    Shortage(#[from] Shortage),
}

/// Examines case files, and all in folders, in the order of their names. A case passes when the oracle's answer is the one it records
/// and the engine either still says what it records or has come to say what is right; for a defect only the latter. In folders these are the
/// files `.toml`, cases about pairs, and `.json`, state files.
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
/// When a folder cannot be read, or holds no case.
pub fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CorpusError> {
    paths.iter().map(|path| files_of(path)).collect::<Result<Vec<_>, _>>().map(|files| files.concat())
}

/// The engines that the cases of a corpus are about.
///
/// # Errors
/// When a folder or a case cannot be read.
pub fn engines_of(paths: &[PathBuf]) -> Result<BTreeSet<String>, CorpusError> {
    let files = files(paths)?;
    let cases = files.iter().filter(|file| !StepCase::is_named(file));
    cases.map(|file| Ok(Case::load(file)?.about.engine)).collect()
}

fn files_of(path: &Path) -> Result<Vec<PathBuf>, CorpusError> {
    let at = |source| CorpusError::Io { file: path.display().to_string(), source };
    if !path.is_dir() {
        // Dangling links as well.
        return if path.exists() {
            Ok(vec![path.to_owned()])
        } else {
            Err(CorpusError::Missing(path.display().to_string()))
        };
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(at)? {
        files.push(entry.map_err(at)?.path());
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml" || extension == "json"));
    files.sort();
    if files.is_empty() { Err(CorpusError::Empty(path.display().to_string())) } else { Ok(files) }
}

fn check(file: &Path, engines: &Engines) -> Result<Check, CorpusError> {
    let begun = Instant::now();
    let ((status, message), engine) = if StepCase::is_named(file) {
        let at = |source| CorpusError::Step { file: file.display().to_string(), source };
        let case = StepCase::load(file).map_err(|error| at(error.into()))?;
        (judge_step(&case, engines).map_err(at)?, None)
    } else {
        let case = Case::load(file)?;
        (judge(&case, engines), engines.spec(&case.about.engine))
    };
    let name = file.display().to_string();
    let replay = (status == CheckStatus::Fail).then(|| replay_command(file, engine));
    Ok(Check {
        group: "corpus",
        name: name.clone(),
        message,
        status,
        place: (name, 1),
        rows: Vec::new(),
        seconds: begun.elapsed().as_secs_f64(),
        replay,
    })
}

fn judge(case: &Case, engines: &Engines) -> (CheckStatus, String) {
    let about = &case.about;
    let Some(panel) = engines.panel_of(case) else {
        let reason = match about.engine.as_str() {
            precision @ ("f32" | "f64") => format!("no engine that is given {precision} takes part in this gate"),
            engine => format!("engine {engine} takes no part in this gate"),
        };
        return (CheckStatus::Skip, reason);
    };
    let exact = |a: &_, b: &_, t: &_| panel.oracle.prepare(a, b).pair().classify(t).contacts;
    let precision = panel.precisions().pop().unwrap_or(rockproof_model::Precision::F64);
    let near =
        || Some((case.a.rounded(precision)?, case.b.rounded(precision)?, case.tolerances.rounded(precision).ok()?));
    let Some((a, b, t)) = near() else { return (CheckStatus::Fail, format!("the input overflows in {precision}")) };
    let right = match about.cause.as_str() {
        "tolerance" => exact(&case.a, &case.b, &case.tolerances.ideal()),
        "representation" => exact(&case.a, &case.b, &case.tolerances),
        _ => exact(&a, &b, &t),
    };
    if contact_rows(&right) != about.expected {
        return (CheckStatus::Fail, "the exact answer is not the one the case expects".to_owned());
    }
    let said = match about.cause.as_str() {
        "tolerance" => exact(&case.a, &case.b, &case.tolerances),
        "representation" => exact(&a, &b, &t),
        _ => {
            let Some(engine) = panel.engines.first() else { return (CheckStatus::Skip, "no engine".to_owned()) };
            let answer = match catch_panic(|| engine.prepare(&a, &b)?.answer(&t)) {
                Ok(answer) => answer,
                Err(failure) if failure.change().name() == about.change && about.check.is_none() => {
                    return (CheckStatus::Pass, "as recorded".to_owned());
                }
                Err(failure) => return (CheckStatus::Fail, failure.to_string()),
            };
            if let Some(unsaid) = left_unsaid(about, &answer) {
                let engine = &about.engine;
                let message =
                    format!("{engine} gives {unsaid}, which the case is about: what is not given is not compared");
                return (CheckStatus::Fail, message);
            }
            let contradiction = Contradiction::of(case, &panel, &**engine, &answer);
            let verdict = match answer {
                Answer::Contacts(contacts) => judge_contacts(&contact_rows(&completed(contacts, &right)), about),
                Answer::State(said) => {
                    let query = CollisionQuery { blocks: &[a, b], precision, accuracy: engine.accuracy() };
                    judge_state(&query, said, about)
                }
            };
            return match contradiction {
                Some(contradiction) => contradiction.judge(case, verdict),
                None => (verdict.status, verdict.message),
            };
        }
    };
    let PairVerdict { status, message, .. } = judge_contacts(&contact_rows(&said), about);
    (status, message)
}

/// What the contacts named of the pair as it stands come to.
fn judge_contacts(said: &[ContactRow], about: &CaseDescription) -> PairVerdict {
    // A case about how blocks lie records no contacts.
    let is_recorded = said == about.found && about.states.is_none() && about.found_state.is_none();
    let (status, message) = if said == about.expected {
        (CheckStatus::Pass, "the engine agrees".to_owned())
    } else if about.cause == "defect" {
        (CheckStatus::Fail, "a defect is back".to_owned())
    } else if is_recorded {
        (CheckStatus::Pass, "as recorded".to_owned())
    } else {
        (CheckStatus::Fail, format!("{} says neither what is right nor what the case records", about.engine))
    };
    PairVerdict { status, message, is_recorded }
}

/// The same of an engine that says only how the blocks lie.
fn judge_state(query: &CollisionQuery<'_>, said: ReportedState, about: &CaseDescription) -> PairVerdict {
    let CaseDescription { change, engine, .. } = about;
    let is_judged = |change: AnswerChange| change.is_of_states() || change.is_metamorphic() || !change.is_of_answers();
    let is_contradiction = about.is_contradiction_of_states();
    let is_of_changed_pair = is_contradiction || about.check.is_some();
    let recorded = if is_of_changed_pair { about.found_state.as_deref() } else { about.said_state() };
    let is_said = recorded.is_some_and(|recorded| recorded == said.to_string());
    let (is_recorded, status, message) = match query.compare(said) {
        None => {
            let concave = "a block is concave, so nothing exact stands against the answer".to_owned();
            (false, CheckStatus::Skip, concave)
        }
        Some((None, _)) if AnswerChange::from_name(change).is_some_and(is_judged) => {
            // A right gap may have other last digits elsewhere; one that is right in place of a wrong one is another answer.
            let was_right = |recorded| query.compare(recorded).is_some_and(|(wrong, _)| wrong.is_none());
            let is_recorded = recorded.and_then(ReportedState::from_text).is_none_or(was_right);
            (is_recorded, CheckStatus::Pass, "the engine agrees".to_owned())
        }
        Some((None, _)) => (false, CheckStatus::Skip, format!("of the change \"{change}\" nothing is known here")),
        Some((Some(_), _)) if is_said => (true, CheckStatus::Pass, "as recorded".to_owned()),
        Some((Some(wrong), compared)) if recorded.is_none() && is_contradiction => {
            let unknown = format!(
                "{wrong}: {compared}; the case, of an earlier version, does not record what {engine} said of the pair as it stands"
            );
            (true, CheckStatus::Skip, unknown)
        }
        Some((Some(wrong), compared)) if recorded.is_none() && wrong.name() == change => {
            (false, CheckStatus::Skip, format!("{wrong}: {compared}; the case does not record what {engine} said"))
        }
        Some((Some(wrong), compared)) => {
            let of = if is_of_changed_pair { " of the pair as it stands" } else { "" };
            (false, CheckStatus::Fail, format!("{wrong}: {compared}, which the case does not record{of}"))
        }
    };
    PairVerdict { status, message, is_recorded }
}

/// The same of a state file, whose engine is the stepper of its precision.
fn judge_step(case: &StepCase, engines: &Engines) -> Result<(CheckStatus, String), ReplayError> {
    let engine = format!("stepper-{}", case.precision()?);
    if engines.find(&engine).is_none() {
        return Ok((CheckStatus::Skip, format!("engine {engine} takes no part in this gate")));
    }
    let step = ReplayedStep::of(case)?;
    if !step.is_expected(case) {
        return Ok((CheckStatus::Fail, "the oracle's answer is not the one the case expects".to_owned()));
    }
    if let Some(missing) = step.missing(case) {
        let missing = excerpt(missing, EXCERPT_LENGTH);
        return Ok((CheckStatus::Fail, format!("what the case records has no longer its cause: {missing}")));
    }
    if let Some(drift) = step.drift {
        return Ok((CheckStatus::Fail, format!("a defect: {drift}")));
    }
    let is_own = |cause| matches!(cause, StepCause::Link(Cause::Arithmetic | Cause::Defect));
    let own: Vec<_> = step.differences().into_iter().filter(|one| is_own(one.cause)).collect();
    if let Some(defect) = own.iter().find(|one| one.cause == Cause::Defect.into()) {
        return Ok((CheckStatus::Fail, defect.words().to_owned()));
    }
    Ok(match own.iter().find(|one| !one.is_in(case)) {
        Some(new) => (
            CheckStatus::Fail,
            format!("{engine} does neither what is right nor what the case records: {}", new.words()),
        ),
        None if step.recurs() => (CheckStatus::Pass, "as recorded".to_owned()),
        None => match step.undecided() {
            Some(undecided) => (CheckStatus::Skip, undecided),
            None => (CheckStatus::Pass, "the engine agrees".to_owned()),
        },
    })
}
