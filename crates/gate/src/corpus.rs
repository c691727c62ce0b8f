//! Cases that are examined on every run of a gate.

use super::{Check, CheckStatus};
use rockproof_campaign::engines::Engines;
use rockproof_differential::answer_detail::left_unsaid;
use rockproof_differential::attribution::{EnginePanel, WantedFindings, findings_wanted};
use rockproof_differential::case_file::{
    Case, CaseDescription, CaseError, ChangedAnswer, ChangedAnswers, ContactRow, contact_rows,
};
use rockproof_differential::collision::CollisionQuery;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::{Answer, Engine, Shortage, catch_panic};
use rockproof_differential::external::protocol::completed;
use rockproof_differential::external::spec::replay_command;
use rockproof_differential::finding::{Cause, Finding};
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
    let mut contradicted = None;
    let said = match about.cause.as_str() {
        "tolerance" => exact(&case.a, &case.b, &case.tolerances),
        "representation" => exact(&a, &b, &t),
        _ => {
            let Some(engine) = panel.engines.first() else { return (CheckStatus::Skip, "no engine".to_owned()) };
            let answer = catch_panic(|| engine.prepare(&a, &b)?.answer(&t));
            let unsaid = answer.as_ref().ok().and_then(|answer| left_unsaid(about, answer));
            if let Some(unsaid) = unsaid {
                let engine = &about.engine;
                let message =
                    format!("{engine} gives {unsaid}, which the case is about: what is not given is not compared");
                return (CheckStatus::Fail, message);
            }
            if answer.is_ok() {
                contradicted = Contradiction::of(case, &panel, &**engine);
            }
            match answer {
                Ok(Answer::Contacts(contacts)) => completed(contacts, &right),
                Ok(Answer::State(said)) => {
                    let query = CollisionQuery { blocks: &[a, b], precision, accuracy: engine.accuracy() };
                    return contradicted
                        .and_then(|found| found.judge(case, true))
                        .unwrap_or_else(|| judge_state(&query, said, about));
                }
                Err(failure) if failure.change().name() == about.change => {
                    return (CheckStatus::Pass, "as recorded".to_owned());
                }
                Err(failure) => return (CheckStatus::Fail, failure.to_string()),
            }
        }
    };
    let said = contact_rows(&said);
    if let Some(verdict) = contradicted.and_then(|found| found.judge(case, said == about.found)) {
        return verdict;
    }
    if said == about.expected {
        (CheckStatus::Pass, "the engine agrees".to_owned())
    } else if about.cause == "defect" {
        (CheckStatus::Fail, "a defect is back".to_owned())
    } else if said == about.found {
        (CheckStatus::Pass, "as recorded".to_owned())
    } else {
        (CheckStatus::Fail, format!("{} says neither what is right nor what the case records", about.engine))
    }
}

/// What an engine says of the pair of a case that is about how it contradicts itself, changed as the case says.
struct Contradiction {
    /// What was changed; `None` where the pair cannot be changed so.
    words: Option<String>,
    /// Why it gave no answer to the changed pair.
    failure: Option<String>,
    /// Its contacts there, where there is one changed pair and it names some.
    said: Option<Vec<ContactRow>>,
    /// How it contradicts itself.
    found: Vec<Finding>,
}

impl Contradiction {
    /// `None` of a case that is about no contradiction.
    fn of(case: &Case, panel: &EnginePanel, engine: &dyn Engine) -> Option<Contradiction> {
        let about = &case.about;
        AnswerChange::from_name(&about.change).filter(|change| change.is_metamorphic())?;
        let says_state = about.states.is_some();
        let Some(ChangedAnswers { words, answers }) = case.changed_answers(engine, &*panel.oracle, says_state) else {
            return Some(Contradiction { words: None, failure: None, said: None, found: Vec::new() });
        };
        let failure = answers.iter().find_map(|answer| answer.said.as_ref().err()).map(ToString::to_string);
        let said = match &answers[..] {
            [ChangedAnswer { said: Ok(Answer::Contacts(contacts)), .. }] => Some(contact_rows(contacts)),
            _ => None,
        };
        let wanted = WantedFindings { cause: &about.cause, change: &about.change, kind: "", predicate: None };
        let is_such = |finding: &Finding| {
            finding.difference.change.name() == about.change && finding.scope.to_string() == about.engine
        };
        let found = findings_wanted(&case.subject(), panel, wanted).into_iter().filter(is_such).collect();
        Some(Contradiction { words: Some(words), failure, said, found })
    }

    /// What that comes to where the engine says of the pair itself what the case records, or not; `None` where it contradicts itself in nothing, so that what it
    /// says of the pair decides.
    fn judge(self, case: &Case, is_base_recorded: bool) -> Option<(CheckStatus, String)> {
        let Contradiction { words, failure, said, found } = self;
        let about = &case.about;
        let Some(words) = words else {
            return Some((
                CheckStatus::Skip,
                format!("the pair cannot be changed as the case says ({})", about.change),
            ));
        };
        let engine = &about.engine;
        if let Some(failure) = failure {
            return Some((CheckStatus::Fail, format!("{engine} gives no answer to the pair with {words}: {failure}")));
        }
        let first = found.first()?;
        let is_outside = first.cause == Cause::Engine;
        if is_outside && first.difference.change.is_never_rounding() {
            let message = format!(
                "{engine} contradicts itself, and rounding is no reason: its answer is another one for the pair with {words}"
            );
            return Some((CheckStatus::Fail, message));
        }
        if found.iter().any(|finding| finding.cause == Cause::Defect) {
            return Some((CheckStatus::Fail, "a defect is back".to_owned()));
        }
        let is_recorded = match (first.comparison, &about.changed) {
            (Some(comparison), _) => about.states.as_ref() == Some(&comparison.to_string()),
            (None, Some(changed)) => is_base_recorded && said.as_ref() == Some(changed),
            // A case of an earlier version, or of a built-in engine, says of what kind the contact is.
            (None, None) => {
                is_base_recorded && found.iter().any(|f| about.kind.is_empty() || f.difference.kinds() == about.kind)
            }
        };
        Some(match is_recorded {
            true => (CheckStatus::Pass, "as recorded".to_owned()),
            false => (
                CheckStatus::Fail,
                format!(
                    "{engine} contradicts itself otherwise than the case records: its answer is another one for the pair with {words}"
                ),
            ),
        })
    }
}

/// The same of an engine that says only how the blocks lie.
fn judge_state(query: &CollisionQuery<'_>, said: ReportedState, about: &CaseDescription) -> (CheckStatus, String) {
    let CaseDescription { change, engine, .. } = about;
    let is_judged = |change: AnswerChange| change.is_of_states() || change.is_metamorphic() || !change.is_of_answers();
    match query.compare(said) {
        None => (CheckStatus::Skip, "a block is concave, so nothing exact stands against the answer".to_owned()),
        Some((None, _)) if AnswerChange::from_name(change).is_some_and(is_judged) => {
            (CheckStatus::Pass, "the engine agrees".to_owned())
        }
        Some((None, _)) => (CheckStatus::Skip, format!("of the change \"{change}\" nothing is known here")),
        Some((Some(wrong), compared)) => match about.said_state() {
            Some(recorded) if recorded == said.to_string() => (CheckStatus::Pass, "as recorded".to_owned()),
            None if wrong.name() == change => {
                (CheckStatus::Skip, format!("{wrong}: {compared}; the case does not record what {engine} said"))
            }
            _ => (CheckStatus::Fail, format!("{wrong}: {compared}, which the case does not record")),
        },
    }
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
