//! Engines that are programs of their own, asked over stdin and stdout (docs/engines.md).

#[cfg(unix)]
mod group;
#[cfg(unix)]
mod pipes;
#[cfg(unix)]
pub mod process;
mod program;
pub mod protocol;
pub mod spec;
mod watched_json;

#[cfg(not(unix))]
#[path = "unsupported_platform.rs"]
pub mod process;

#[cfg(unix)]
pub use group::end_all;
#[cfg(not(unix))]
pub use process::end_all;
pub use spec::{EngineSpec, EngineSpecError};

use super::answer_detail::AnswerDetail;
use super::engine::{Answer, Engine, EngineCounts, EngineFailure, Prepared, Shortage, Trace, WideAnswer};
use super::finding::Cause;
use process::{NoAnswer, Process};
use rockproof_model::text::noun;
use rockproof_model::{Block, Contact, Precision, ToleranceSet};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

/// The longest line a program may answer with, in bytes.
pub const LONGEST_ANSWER: usize = 1 << 24;

/// [`EngineCounts`], counted by many threads.
#[derive(Debug, Default)]
struct EngineCounters {
    asked: AtomicU64,
    started: AtomicU64,
    recovered: AtomicU64,
    uncompared: AtomicU64,
    /// [`EngineCounts::first_failures`].
    failures: Mutex<Vec<String>>,
    /// [`EngineCounts::first_repeated`].
    repeated: Mutex<Vec<String>>,
    detail: Mutex<AnswerDetail>,
}

/// The texts in a list that many threads add to.
fn texts(list: &Mutex<Vec<String>>) -> MutexGuard<'_, Vec<String>> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a note says of an answer that the program gave beside those asked for, when it had answered before.
const BESIDE_ANSWERS: &str =
    "output that nobody asked for, from a process that had answered before: a fresh one may not come to it";

/// Whether the note of a finding is about such output, so that asking about the pair alone may not show it.
pub fn is_of_earlier_answers(note: &str) -> bool {
    note.contains(BESIDE_ANSWERS)
}

struct Shared {
    spec: EngineSpec,
    ask_twice: bool,
    idle: Mutex<Vec<Process>>,
    /// [`program::program_digest`], as it was when the counts were asked for first.
    program: OnceLock<Option<String>>,
    /// Set while `idle` is held, so that nothing rests there any more.
    shortage: OnceLock<Shortage>,
    counts: EngineCounters,
}

/// A program that answers questions about pairs. Copies share its running processes, of which there is one for each thread that
/// asks at the same time, and twice as many when every pair is asked twice.
#[derive(Clone)]
pub struct External(Arc<Shared>);

impl External {
    /// The engine of a specification. Nothing is started before the first question. With `ask_twice`, every question goes to two
    /// processes, whose answers must be the same.
    pub fn new(spec: EngineSpec, ask_twice: bool) -> External {
        let (idle, program, shortage, counts) = Default::default();
        External(Arc::new(Shared { spec, ask_twice, idle, program, shortage, counts }))
    }

    /// What it was asked for.
    pub fn spec(&self) -> &EngineSpec {
        &self.0.spec
    }

    /// Asks about two blocks that any engine can take, to see whether anybody answers.
    ///
    /// # Errors
    /// What went wrong, as text for a person. That an engine does not support the pair is an answer.
    pub fn probe(&self, a: &Block, b: &Block, tolerances: &ToleranceSet) -> Result<(), String> {
        match self.prepare(a, b).and_then(|pair| pair.answer(tolerances)) {
            Ok(_) | Err(EngineFailure::Unsupported(_)) => Ok(()),
            Err(failure) => Err(failure.to_string()),
        }
    }

    fn start(&self) -> Result<Process, NoAnswer> {
        self.0.counts.started.fetch_add(1, Ordering::Relaxed);
        Process::start(&self.0.spec.command)
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Process>> {
        self.0.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn rest(&self, process: Process) {
        let mut idle = self.idle();
        match self.0.shortage.get() {
            None => idle.push(process),
            Some(_) => process.kill(),
        }
    }

    /// Keeps what this program lacks, and ends the processes that rest: whoever ends in good order now needs what they hold.
    #[cfg(unix)]
    fn give_up(&self, what: String) {
        let mut idle = self.idle();
        self.0.shortage.get_or_init(|| Shortage { engine: self.0.spec.name.clone(), what });
        idle.drain(..).for_each(Process::kill);
    }

    /// Asks a process that has time. Whatever fails there is asked again of a fresh one: a failure is a verdict about the
    /// pair, so it must not depend on what a process went through before. Output that nobody asked for is told where it is seen: a fresh
    /// process has not come to it yet.
    fn ask(&self, question: &Question<'_>) -> Asked {
        let asked = self.ask_any(question);
        if let (Err(failure), None) = (&asked.answer, &asked.process) {
            EngineCounts::note_failure(&mut texts(&self.0.counts.repeated), failure);
        }
        asked
    }

    fn ask_any(&self, question: &Question<'_>) -> Asked {
        let idle = self.idle().pop();
        if let Some(idle) = idle {
            let asked = self.ask_of(idle, question);
            if asked.process.is_some() || asked.unasked {
                return asked;
            }
            let again = self.ask_fresh(question);
            if again.process.is_some() {
                self.0.counts.recovered.fetch_add(1, Ordering::Relaxed);
                if let Err(failure) = &asked.answer {
                    EngineCounts::note_failure(&mut texts(&self.0.counts.failures), failure);
                }
            }
            return again;
        }
        self.ask_fresh(question)
    }

    fn ask_fresh(&self, question: &Question<'_>) -> Asked {
        match self.start() {
            Ok(fresh) => self.ask_of(fresh, question),
            Err(silence) => self.silent(silence, 0),
        }
    }

    /// What asking one process comes to.
    fn ask_of(&self, mut process: Process, question: &Question<'_>) -> Asked {
        self.0.counts.asked.fetch_add(1, Ordering::Relaxed);
        let id = process.asked();
        let line = protocol::question(id, question.pair.text.as_str(), question.tolerances);
        let patience = Duration::from_millis(self.0.spec.timeout_ms);
        match process.ask(line, patience) {
            Ok(line) => {
                let features = [question.pair.a.topology(), question.pair.b.topology()];
                let (mut answer, detail) = protocol::detailed_answer(&line, id, features);
                // How other blocks lie is not compared.
                if !matches!(answer, Ok(Answer::State(_)))
                    || (question.pair.a.is_convex() && question.pair.b.is_convex())
                {
                    self.count_detail(detail);
                }
                if let Err(EngineFailure::Malformed(what)) = &mut answer {
                    // A line that is no answer may be one that nobody asked for, with the answer behind it. Of a fresh process it would come again.
                    let unasked = id > 0 && (protocol::is_of_earlier(&line, id) || process.has_unread_output());
                    if unasked {
                        *what = format!("{BESIDE_ANSWERS}; {what}");
                    }
                    // Who knows what else it is about to say.
                    process.kill();
                    return Asked { answer, process: None, unasked };
                }
                Asked { answer, process: Some(process), unasked: false }
            }
            Err(silence) => {
                process.kill();
                self.silent(silence, id)
            }
        }
    }

    fn count_detail(&self, detail: AnswerDetail) {
        if UNCOUNTED.get() {
            return;
        }
        let mut sum = self.0.counts.detail.lock().unwrap_or_else(PoisonError::into_inner);
        *sum = sum.plus(detail);
    }

    /// What no answer comes to, of a process that was asked so many questions before.
    fn silent(&self, silence: NoAnswer, before: u64) -> Asked {
        #[cfg(unix)]
        let unasked = matches!(silence, NoAnswer::Unasked(_));
        #[cfg(not(unix))]
        let unasked = false;
        Asked { answer: Err(self.verdict(silence, before)), process: None, unasked }
    }

    #[cfg_attr(not(unix), allow(unused_variables, reason = "no process is asked here"))]
    fn verdict(&self, silence: NoAnswer, before: u64) -> EngineFailure {
        match silence {
            NoAnswer::NotStarted(why) => EngineFailure::Crashed(why),
            #[cfg(unix)]
            NoAnswer::Shortage(why) => {
                self.give_up(why.clone());
                EngineFailure::Crashed(why)
            }
            #[cfg(unix)]
            NoAnswer::Ended(why) => EngineFailure::Crashed(why),
            #[cfg(unix)]
            NoAnswer::TimedOut => EngineFailure::TimedOut(format!("no answer within {} ms", self.0.spec.timeout_ms)),
            #[cfg(unix)]
            NoAnswer::TooLong => EngineFailure::Malformed(format!("a line of more than {LONGEST_ANSWER} bytes")),
            #[cfg(unix)]
            NoAnswer::Unasked(output) => {
                let what = if before == 0 { "output that nobody asked for" } else { BESIDE_ANSWERS };
                let output = protocol::quoted(&output);
                EngineFailure::Malformed(format!("{what}: {output}; each question has one line in answer"))
            }
        }
    }
}

thread_local! {
    /// Whether what answers say is not counted, of questions asked on this thread.
    static UNCOUNTED: Cell<bool> = const { Cell::new(false) };
}

/// Does some work on this thread and does not count what engines say in their answers meanwhile, as while a case is made smaller: how many pairs are asked
/// about then depends on what was found, so counts of runs over the same pairs could not be compared.
pub fn without_counting_details<T>(work: impl FnOnce() -> T) -> T {
    struct Before(bool);
    impl Drop for Before {
        fn drop(&mut self) {
            UNCOUNTED.set(self.0);
        }
    }
    let _before = Before(UNCOUNTED.replace(true));
    work()
}

/// What asking a process came to.
struct Asked {
    answer: Result<Answer, EngineFailure>,
    /// The process, where it can be asked again.
    process: Option<Process>,
    /// Whether there was output that nobody asked for, or the answer to an earlier question.
    unasked: bool,
}

struct Question<'x> {
    pair: &'x ExternalPair<'x>,
    tolerances: &'x ToleranceSet,
}

/// A pair written out for the engine.
struct ExternalPair<'p> {
    engine: &'p External,
    a: &'p Block,
    b: &'p Block,
    text: String,
}

impl Engine for External {
    fn name(&self) -> &str {
        &self.0.spec.name
    }

    fn precision(&self) -> Precision {
        self.0.spec.precision.into()
    }

    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        Ok(Box::new(ExternalPair { engine: self, a, b, text: protocol::blocks_text(a, b) }))
    }

    fn cause(&self) -> Cause {
        Cause::Engine
    }

    fn accuracy(&self) -> u64 {
        self.0.spec.accuracy
    }

    fn not_compared(&self) {
        self.0.counts.uncompared.fetch_add(1, Ordering::Relaxed);
    }

    fn shortage(&self) -> Option<&Shortage> {
        self.0.shortage.get()
    }

    fn counts(&self) -> Option<EngineCounts> {
        let count = |n: &AtomicU64| n.load(Ordering::Relaxed);
        let EngineCounters { asked, started, recovered, uncompared, .. } = &self.0.counts;
        Some(EngineCounts {
            asked: count(asked),
            processes_started: count(started),
            recovered: count(recovered),
            not_compared: count(uncompared),
            detail: *self.0.counts.detail.lock().unwrap_or_else(PoisonError::into_inner),
            first_failures: texts(&self.0.counts.failures).clone(),
            first_repeated: texts(&self.0.counts.repeated).clone(),
            programs: self
                .0
                .program
                .get_or_init(|| program::program_digest(&self.0.spec.command))
                .iter()
                .cloned()
                .collect(),
        })
    }
}

impl Prepared for ExternalPair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        self.answer(tolerances)?.into_contacts()
    }

    fn answer(&self, tolerances: &ToleranceSet) -> Result<Answer, EngineFailure> {
        let question = Question { pair: self, tolerances };
        let Asked { answer: first, process, unasked } = self.engine.ask(&question);
        if !self.engine.0.ask_twice || unasked {
            process.into_iter().for_each(|process| self.engine.rest(process));
            return first;
        }
        // The first process is kept back, so that another one is asked: one with another past, and other addresses.
        let Asked { answer: second, process: other, unasked } = self.engine.ask(&question);
        process.into_iter().chain(other).for_each(|process| self.engine.rest(process));
        if same(&first, &second) {
            return first;
        }
        if unasked {
            return second;
        }
        Err(EngineFailure::Unstable(format!("first {}, then {}", describe_answer(&first), describe_answer(&second))))
    }

    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }

    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        None
    }
}

/// Whether two answers are the same; of failures, that both are of one sort.
fn same(one: &Result<Answer, EngineFailure>, other: &Result<Answer, EngineFailure>) -> bool {
    match (one, other) {
        (Ok(one), Ok(other)) => one == other,
        (Err(one), Err(other)) => std::mem::discriminant(one) == std::mem::discriminant(other),
        _ => false,
    }
}

fn describe_answer(answer: &Result<Answer, EngineFailure>) -> String {
    match answer {
        Ok(Answer::Contacts(contacts)) => {
            let list: Vec<String> = contacts.iter().map(|c| c.key.to_string()).collect();
            format!("{} {} ({})", list.len(), noun(list.len(), "contact", "contacts"), list.join(", "))
        }
        Ok(Answer::State(said)) => said.to_string(),
        Err(failure) => failure.to_string(),
    }
}
