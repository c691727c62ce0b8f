//! The two sides of every comparison behind small traits: engines (anything that classifies) and the oracle.
//!
//! Everything the campaign knows about the stepper and the oracle is in `builtin`, and in `diagnosis` which departs from their rules; the
//! rest of the campaign sees these traits only, so that a mistaken stepper or an external program plugs in without a change elsewhere.

use super::answer_detail::AnswerDetail;
use super::compare::AnswerChange;
use super::finding::Cause;
use super::indexed_trace::IndexedTrace;
use super::separation_state::ReportedState;
use rockproof_model::decision::Decision;
use rockproof_model::text::excerpt;
use rockproof_model::{Block, Contact, ContactKey, ExpectedContact, Precision, ToleranceSet, unexpected_contacts};
use serde::{Deserialize, Serialize};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Decisions and their outcomes, in the order they were taken.
pub type Trace = Vec<(Decision, i8)>;

/// Anything that classifies pairs of blocks in floating point.
pub trait Engine: Send + Sync {
    /// The name used in tables and files.
    fn name(&self) -> &str;

    /// The format its input is rounded to.
    fn precision(&self) -> Precision;

    /// Takes in two blocks whose coordinates are already rounded to [`Engine::precision`].
    ///
    /// # Errors
    /// When the engine cannot take them; that is a verdict about the engine, never the end of a campaign.
    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure>;

    /// The cause of what it answers otherwise than the oracle, as far as is known before looking closer.
    fn cause(&self) -> Cause {
        Cause::Arithmetic
    }

    /// How far a gap or a normal it states may be off, in units of eps times the largest coordinate.
    fn accuracy(&self) -> u64 {
        1024
    }

    /// Takes note that an answer of its could not be compared, for want of an exact one.
    fn not_compared(&self) {}

    /// What this program lacked when it was to ask the engine; what the engine said since then counts for nothing.
    fn shortage(&self) -> Option<&Shortage> {
        None
    }

    /// What it was put through since the program began; `None` for a built-in engine.
    fn counts(&self) -> Option<EngineCounts> {
        None
    }
}

/// An engine cannot be asked, for want of files, processes or memory that this program or its system has no more of: no verdict about the
/// engine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "engine \"{engine}\" cannot be asked: {what}; this says nothing about the engine: use fewer --threads, or raise the limit (`ulimit -n` is that on open files, `ulimit -u` on processes)"
)]
pub struct Shortage {
    /// The engine.
    pub engine: String,
    /// What the system said.
    pub what: String,
}

/// What an external engine was put through. These depend on threads and on luck; findings do not.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineCounts {
    /// Questions asked.
    pub asked: u64,
    /// Processes started.
    pub processes_started: u64,
    /// Failures that a fresh process did not repeat.
    pub recovered: u64,
    /// Answers that nothing exact stands against.
    pub not_compared: u64,
    /// What the first of the failures were that a fresh process did not repeat, each text once, at most [`EngineCounts::FIRST_FAILURES`] of them. Runs
    /// of earlier versions have none.
    #[serde(default)]
    pub first_failures: Vec<String>,
    /// The same of failures that are findings: a fresh process repeated them, or was not asked.
    #[serde(default)]
    pub first_repeated: Vec<String>,
    /// A digest of each program that was asked, the first one first: several where it changed before the run went on, or between parts. Empty where it is
    /// not known.
    #[serde(default)]
    pub programs: Vec<String>,
    /// What it said of contacts and of how blocks lie. Runs of earlier versions say nothing of it.
    #[serde(default)]
    pub detail: AnswerDetail,
}

impl EngineCounts {
    /// So many of the failures are told.
    pub const FIRST_FAILURES: usize = 3;

    /// So many characters of each.
    const FAILURE_LENGTH: usize = 400;

    /// What came on top of `before` since it was taken.
    #[must_use]
    pub fn since(&self, before: &EngineCounts) -> EngineCounts {
        EngineCounts {
            asked: self.asked.saturating_sub(before.asked),
            processes_started: self.processes_started.saturating_sub(before.processes_started),
            recovered: self.recovered.saturating_sub(before.recovered),
            not_compared: self.not_compared.saturating_sub(before.not_compared),
            first_failures: self.first_failures.iter().skip(before.first_failures.len()).cloned().collect(),
            first_repeated: self.first_repeated.iter().skip(before.first_repeated.len()).cloned().collect(),
            programs: self.programs.clone(),
            detail: self.detail.since(before.detail),
        }
    }

    /// The sums of both.
    #[must_use]
    pub fn plus(&self, other: &EngineCounts) -> EngineCounts {
        let both = |mut failures: Vec<String>, others: &[String]| {
            others.iter().for_each(|failure| EngineCounts::note(&mut failures, failure.clone()));
            failures
        };
        let mut programs = self.programs.clone();
        programs.extend(other.programs.iter().filter(|program| !self.programs.contains(program)).cloned());
        EngineCounts {
            programs,
            asked: self.asked.saturating_add(other.asked),
            processes_started: self.processes_started.saturating_add(other.processes_started),
            recovered: self.recovered.saturating_add(other.recovered),
            not_compared: self.not_compared.saturating_add(other.not_compared),
            first_failures: both(self.first_failures.clone(), &other.first_failures),
            first_repeated: both(self.first_repeated.clone(), &other.first_repeated),
            detail: self.detail.plus(other.detail),
        }
    }

    fn note(failures: &mut Vec<String>, failure: String) {
        if failures.len() < EngineCounts::FIRST_FAILURES && !failures.contains(&failure) {
            failures.push(failure);
        }
    }

    /// Keeps what a failure was, if it is one of the first.
    pub fn note_failure(failures: &mut Vec<String>, failure: &EngineFailure) {
        EngineCounts::note(failures, excerpt(&failure.to_string(), EngineCounts::FAILURE_LENGTH));
    }

    /// Says that the program is not the one that was asked first, where that is so.
    pub fn changed_note(&self) -> Option<String> {
        (self.programs.len() > 1).then(|| {
            format!(
                "its program, or the first file among its arguments, changed while the campaign went on: {} different ones were asked and count as one engine; --overwrite asks one about all pairs",
                self.programs.len()
            )
        })
    }

    /// Says that failures did not repeat, where there were any.
    pub fn recovered_note(&self) -> Option<String> {
        let EngineCounts { asked, recovered, .. } = self;
        (*recovered > 0).then(|| {
            format!("{recovered} of {asked} questions failed and were answered by a fresh process (\"recovered\")")
        })
    }
}

/// What an engine answers.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The contacts, sorted as SPEC section 4 asks.
    Contacts(Vec<Contact>),
    /// Only how the blocks lie to one another, as a collision code tells.
    State(ReportedState),
}

impl Answer {
    /// The contacts that it names.
    ///
    /// # Errors
    /// When it says only how the blocks lie: then [`EngineFailure::Unsupported`], with what it says.
    pub fn into_contacts(self) -> Result<Vec<Contact>, EngineFailure> {
        match self {
            Answer::Contacts(contacts) => Ok(contacts),
            Answer::State(said) => {
                Err(EngineFailure::Unsupported(format!("it says {}, not which contacts", said.state)))
            }
        }
    }

    /// The same with other contacts in place of those that it names, if it names any.
    #[must_use]
    pub fn map_contacts(self, other: impl FnOnce(Vec<Contact>) -> Vec<Contact>) -> Answer {
        match self {
            Answer::Contacts(contacts) => Answer::Contacts(other(contacts)),
            state @ Answer::State(_) => state,
        }
    }
}

/// A pair of blocks inside an engine.
pub trait Prepared {
    /// The contacts of the pair, sorted as SPEC section 4 asks, for tolerances rounded to the engine's precision.
    ///
    /// # Errors
    /// When the engine gives no answer.
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure>;

    /// The answer, of whichever sort.
    ///
    /// # Errors
    /// When the engine gives no answer.
    fn answer(&self, tolerances: &ToleranceSet) -> Result<Answer, EngineFailure> {
        self.classify(tolerances).map(Answer::Contacts)
    }

    /// The decisions behind the answer, or `None` for an engine that does not tell.
    fn trace(&self, tolerances: &ToleranceSet) -> Option<Trace>;

    /// The answer of the same code with a scalar of several hundred bits, or `None` for an engine without one.
    fn classify_wide(&self, tolerances: &ToleranceSet) -> Option<WideAnswer>;

    /// Those of the contacts asked for that [`Prepared::classify_wide`] has otherwise than expected, which is `None` where there should be no
    /// such contact; none where its answer is not settled.
    fn departs_in_wide(&self, tolerances: &ToleranceSet, expected: &[ExpectedContact]) -> Option<Vec<ContactKey>> {
        let wide = self.classify_wide(tolerances)?;
        Some(if wide.settled { unexpected_contacts(&wide.contacts, expected) } else { Vec::new() })
    }
}

/// What an engine's code answers when rounding is all but taken away.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WideAnswer {
    /// The contacts, where all comparisons are settled; otherwise they mean nothing.
    pub contacts: Vec<Contact>,
    /// Whether no comparison was so close that rounding in the wide scalar could still explain its outcome (an exact tie).
    pub settled: bool,
}

/// Why an engine gave no answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EngineFailure {
    /// Rounding the input destroyed a feature: an edge without length, a face without area.
    #[error("collapsed: {0}")]
    Collapsed(String),
    /// The engine says it cannot do this pair.
    #[error("unsupported: {0}")]
    Unsupported(String),
    /// A built-in engine panicked.
    #[error("failed: {0}")]
    Failed(String),
    /// The engine's program could not be started, or ended instead of answering.
    #[error("crashed: {0}")]
    Crashed(String),
    /// The engine's program did not answer in time.
    #[error("timed out: {0}")]
    TimedOut(String),
    /// The answer made no sense.
    #[error("malformed answer: {0}")]
    Malformed(String),
    /// Asked twice, the engine answered differently.
    #[error("two answers: {0}")]
    Unstable(String),
}

impl EngineFailure {
    /// What a finding about it is called.
    pub fn change(&self) -> AnswerChange {
        match self {
            EngineFailure::Collapsed(_) => AnswerChange::Collapsed,
            EngineFailure::Unsupported(_) => AnswerChange::Unsupported,
            EngineFailure::Failed(_) => AnswerChange::Failure,
            EngineFailure::Crashed(_) => AnswerChange::Crash,
            EngineFailure::TimedOut(_) => AnswerChange::Timeout,
            EngineFailure::Malformed(_) => AnswerChange::Malformed,
            EngineFailure::Unstable(_) => AnswerChange::Unstable,
        }
    }
}

/// The exact side.
pub trait Oracle: Send + Sync {
    /// Prepares two blocks for exact classification.
    fn prepare<'o>(&'o self, a: &Block, b: &Block) -> Box<dyn ExactPrepared + 'o>;
}

/// Two blocks inside the oracle.
pub trait ExactPrepared {
    /// The two as a pair, A first. Keep it for as long as questions are asked: it remembers what it worked out.
    fn pair(&self) -> Box<dyn ExactPair + '_>;
}

/// A pair of blocks inside the oracle.
pub trait ExactPair {
    /// The exact contacts, sorted as SPEC section 4 asks.
    fn classify(&self, tolerances: &ToleranceSet) -> ExactAnswer;

    /// The exact decisions behind the answer, each once.
    fn trace(&self, tolerances: &ToleranceSet) -> Trace;

    /// The same in a form in which decisions are found.
    fn indexed_trace(&self, tolerances: &ToleranceSet) -> IndexedTrace {
        IndexedTrace::of(self.trace(tolerances))
    }

    /// The exact margins of decisions: value over the sum of the magnitudes of its terms (between −1 and 1, **0 is a
    /// tie**). `None` for a decision that is not a comparison, or that the oracle does not come to make.
    fn margins(&self, tolerances: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<f64>>;
}

/// An exact answer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExactAnswer {
    /// The contacts.
    pub contacts: Vec<Contact>,
    /// What each level of the oracle decided on the way.
    pub levels: Levels,
}

/// Signs decided by each level of the oracle, in the order of [`Levels::NAMES`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Levels(pub [u64; 7]);

impl Levels {
    /// What the levels are called in `run.json`.
    pub const NAMES: [&'static str; 7] = ["f64", "i128", "ball", "i256", "i512", "i1024", "heap"];

    /// Adds the counts of `other`.
    pub fn add(&mut self, other: &Levels) {
        for (sum, count) in self.0.iter_mut().zip(other.0) {
            *sum += count;
        }
    }
}

/// Runs an engine's code; a panic in it becomes [`EngineFailure::Failed`].
///
/// # Errors
/// What the engine said, or that it panicked.
pub fn catch_panic<T>(work: impl FnOnce() -> Result<T, EngineFailure>) -> Result<T, EngineFailure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()))
            .unwrap_or_else(|| "no message".to_owned());
        Err(EngineFailure::Failed(format!("panic: {text}")))
    })
}

#[cfg(test)]
mod tests {
    use super::{EngineCounts, EngineFailure};

    #[test]
    fn the_first_failures_are_few_short_and_told_once() {
        let of = |texts: &[&str]| {
            let mut counts = EngineCounts::default();
            for text in texts {
                EngineCounts::note_failure(&mut counts.first_failures, &EngineFailure::Crashed((*text).to_owned()));
            }
            counts
        };
        let (one, long) = (of(&["a", "a", "\u{1b}[31m"]), of(&[&"x".repeat(10_000), "a", "b", "c"]));
        assert_eq!(one.first_failures, ["crashed: a", "crashed: \\u{1b}[31m"]);
        assert_eq!(long.first_failures.len(), EngineCounts::FIRST_FAILURES);
        assert!(long.first_failures[0].chars().count() <= 401, "{long:?}");
        let sum = one.plus(&of(&["a", "b", "c"]));
        assert_eq!(sum.first_failures, ["crashed: a", "crashed: \\u{1b}[31m", "crashed: b"]);
        assert_eq!(sum.since(&one).first_failures, ["crashed: b"]);
    }
}
