//! Candidates that are measured before it is sure that they will be tried: they are those that come if none before them is the best.
//! When one is, those after it that come out otherwise are dropped.

use super::message::{Job, JobResult, Work};
use crate::TuneError;
use crate::evaluator::Measurement;
use crate::search::{PendingCandidate, Search};
use crate::steps::LockstepMeasures;
use std::collections::VecDeque;

/// The next candidates of a search.
pub(super) struct Lookahead {
    /// The first is the next.
    entries: VecDeque<Entry>,
    /// Candidates ahead, at most.
    room: usize,
    /// Candidates in all, at most.
    most: Option<usize>,
    jobs: u64,
}

struct Entry {
    candidate: PendingCandidate,
    measured: State<Measurement>,
    lockstep: State<LockstepMeasures>,
}

/// What is known of a part of the work with a candidate.
#[derive(Clone, Debug, PartialEq)]
enum State<T> {
    Waiting,
    /// By the job of this number.
    InWork(u64),
    Done(Result<T, String>),
}

impl<T> State<T> {
    /// Takes in what came of a job, if it was this one's.
    fn take(&mut self, number: u64, result: Result<T, String>) -> bool {
        let is_meant = matches!(self, State::InWork(own) if *own == number);
        if is_meant {
            *self = State::Done(result);
        }
        is_meant
    }
}

impl Entry {
    fn new(candidate: PendingCandidate) -> Entry {
        Entry { candidate, measured: State::Waiting, lockstep: State::Waiting }
    }
}

impl Lookahead {
    /// Looks so many candidates ahead, of so many in all at most.
    pub(super) fn new(room: usize, most: Option<usize>) -> Lookahead {
        Lookahead { entries: VecDeque::new(), room, most, jobs: 0 }
    }

    /// What to do next: for the earliest candidate that has something left to do; `None` where nothing may be begun.
    pub(super) fn job(&mut self, search: &Search<'_>) -> Option<Job> {
        let tried = search.tried().len();
        // Before there is a best every candidate may be, and few are.
        let (has_best, number) = (search.best().is_some(), self.jobs);
        let found = self.entries.iter_mut().enumerate().find_map(|(at, entry)| {
            let work = match (&entry.measured, &entry.lockstep) {
                (State::Waiting, _) => Work::Measure,
                (State::Done(Ok(m)), State::Waiting) if (has_best || at == 0) && search.may_be_best(m) => {
                    Work::Lockstep
                }
                _ => return None,
            };
            match work {
                Work::Measure => entry.measured = State::InWork(number),
                Work::Lockstep => entry.lockstep = State::InWork(number),
            }
            Some(Job { number, work, set: entry.candidate.recipe(tried + at) })
        });
        let ahead = self.entries.len();
        let found = found.or_else(|| {
            if ahead >= self.room || self.most.is_some_and(|most| tried + ahead >= most) {
                return None;
            }
            let candidate = search.candidate_after(self.entries.iter().map(|entry| &entry.candidate));
            let set = candidate.recipe(tried + ahead);
            self.entries.push_back(Entry { measured: State::InWork(number), ..Entry::new(candidate) });
            Some(Job { number, work: Work::Measure, set })
        });
        self.jobs += u64::from(found.is_some());
        found
    }

    /// Takes in what came of a job. What was dropped meanwhile is forgotten.
    pub(super) fn take(&mut self, number: u64, result: JobResult) {
        for entry in &mut self.entries {
            let is_meant = match result.clone() {
                JobResult::Measured(measured) => entry.measured.take(number, measured),
                JobResult::Lockstep(lockstep) => entry.lockstep.take(number, lockstep),
            };
            if is_meant {
                return;
            }
        }
    }

    /// Gives the search its next candidate, if all is known of that; says whether it was.
    ///
    /// # Errors
    /// When it cannot be measured.
    pub(super) fn advance(&mut self, search: &mut Search<'_>) -> Result<bool, TuneError> {
        let Some(Entry { measured: State::Done(measured), lockstep, .. }) = self.entries.front() else {
            return Ok(false);
        };
        let known = |why: &String| TuneError::Candidate(why.clone());
        let mut measurement = measured.clone().map_err(|why| known(&why))?;
        if search.may_be_best(&measurement) {
            let State::Done(lockstep) = lockstep else { return Ok(false) };
            measurement.lockstep = Some(lockstep.clone().map_err(|why| known(&why))?);
        }
        let Some(Entry { candidate, .. }) = self.entries.pop_front() else { return Ok(false) };
        let best = search.best();
        search.add(candidate, measurement);
        if search.best() != best {
            self.revise(search);
        }
        Ok(true)
    }

    /// Puts the candidates that come now in the places of those that were expected.
    fn revise(&mut self, search: &Search<'_>) {
        for at in 0..self.entries.len() {
            let next = search.candidate_after(self.entries.range(..at).map(|entry| &entry.candidate));
            if next != self.entries[at].candidate {
                self.entries[at] = Entry::new(next);
            }
        }
    }
}
