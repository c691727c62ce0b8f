//! A worker: examines the units that rank 0 hands out, and makes case files, with all its threads.

use super::Transport;
use super::message::{CampaignOrder, CampaignReport, Candidate, CaseReply, CaseState, CaseTask, FoundRows, UnitResult};
use super::ranks::{Introduction, Report, encoded, follow_orders, introduce};
use super::remote::row;
use crate::case_writer::{CaseQuota, CaseRequest, has_room};
use crate::cases::{case_request, step_case_request};
use crate::engine_counts::EngineMeter;
use crate::examiner::Counts;
use crate::journal::ProgressCounts;
use crate::run::{BatchResult, Campaign, RunError};
use crate::steps::StepFinding;
use rockproof_differential::finding::Finding;
use serde::Serialize;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Sender};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Instant;

/// A thread of a worker panicked; what it said is on stderr.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a worker thread panicked")]
pub struct WorkerPanic;

/// Tells rank 0 who this worker is and, where there is a `campaign`, works at it until rank 0 says that there is no more to do. When `stop` is set rank 0 is told,
/// which then says so.
///
/// # Errors
/// When a message cannot be read or written, or a thread panicked, which nobody but the caller can tell rank 0.
pub fn serve<T: Transport>(
    campaign: Option<&Campaign<'_>>,
    transport: &mut T,
    introduction: &Introduction,
    stop: &AtomicBool,
) -> Result<(), RunError> {
    introduce(transport, introduction)?;
    let jobs = Jobs::default();
    let batch_len = campaign.map_or(1, |campaign| campaign.source.batch_len());
    let (sender, done) = mpsc::channel();
    std::thread::scope(|scope| {
        if let Some(campaign) = campaign {
            let meter = Arc::new(EngineMeter::new(campaign.panel));
            for _ in 0..introduction.threads.max(1) {
                let worker = Worker { campaign, jobs: &jobs, meter: Arc::clone(&meter), stop };
                let sender = sender.clone();
                scope.spawn(move || worker.work(&sender));
            }
        }
        // However this ends, the threads end too.
        let _closes = Closes(&jobs);
        follow_orders(transport, &done, stop, |order| jobs.add(order, batch_len))
    })
}

/// What waits for a thread.
#[derive(Default)]
struct Waiting {
    /// Before units: rank 0 waits for them.
    cases: VecDeque<(u64, CaseTask)>,
    /// Each with the next of its batches.
    units: VecDeque<(Arc<Unit>, u64)>,
    state: Arc<CaseState>,
}

#[derive(Default)]
struct Jobs {
    waiting: Mutex<Waiting>,
    news: Condvar,
    closed: AtomicBool,
}

/// A unit in work.
struct Unit {
    number: u64,
    pairs: Range<u64>,
    /// The number of its first batch.
    first: u64,
    state: Arc<CaseState>,
    progress: Mutex<UnitProgress>,
}

/// The batches of a unit that are done.
struct UnitProgress {
    begun: Option<Instant>,
    done: BTreeMap<u64, BatchResult>,
}

enum Job {
    Case(u64, CaseTask),
    /// A batch of a unit.
    Batch(Arc<Unit>, u64),
}

impl Jobs {
    /// Takes up an order about batches of so many pairs.
    fn add(&self, order: CampaignOrder, batch_len: u64) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        match order {
            CampaignOrder::Cases(state) => waiting.state = Arc::new(state),
            CampaignOrder::Case { number, task } => waiting.cases.push_back((number, task)),
            CampaignOrder::Unit { number, pairs } => {
                let progress = Mutex::new(UnitProgress { begun: None, done: BTreeMap::new() });
                let unit =
                    Unit { number, state: Arc::clone(&waiting.state), progress, first: pairs.start / batch_len, pairs };
                let first = unit.first;
                waiting.units.push_back((Arc::new(unit), first));
            }
        }
        drop(waiting);
        self.news.notify_all();
    }

    /// The next job, of units of batches of so many pairs; none when there will be no more.
    fn take(&self, batch_len: u64) -> Option<Job> {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if self.is_closed() {
                return None;
            }
            if let Some((number, task)) = waiting.cases.pop_front() {
                return Some(Job::Case(number, task));
            }
            if let Some((unit, next)) = waiting.units.front_mut() {
                let job = Job::Batch(Arc::clone(unit), *next);
                *next += 1;
                if next.saturating_mul(batch_len) >= unit.pairs.end {
                    waiting.units.pop_front();
                }
                return Some(job);
            }
            waiting = self.news.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn is_closed(&self) -> bool {
        self.closed.load(Ordering::SeqCst)
    }

    fn close(&self) {
        // While nobody is between looking and waiting.
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        self.closed.store(true, Ordering::SeqCst);
        drop(waiting);
        self.news.notify_all();
    }
}

/// Closes jobs when it is dropped.
struct Closes<'j>(&'j Jobs);

impl Drop for Closes<'_> {
    fn drop(&mut self) {
        self.0.close();
    }
}

/// A thread of a worker.
struct Worker<'w> {
    campaign: &'w Campaign<'w>,
    jobs: &'w Jobs,
    meter: Arc<EngineMeter<'w>>,
    stop: &'w AtomicBool,
}

impl Worker<'_> {
    fn work(&self, done: &Sender<Result<Vec<u8>, RunError>>) {
        while let Some(job) = self.jobs.take(self.campaign.source.batch_len()) {
            let message = catch_unwind(AssertUnwindSafe(|| self.message(job)));
            let message = message.unwrap_or_else(|_| Err(WorkerPanic.into()));
            // Nobody listens any more when the run is over.
            if let Some(message) = message.transpose() {
                let _ = done.send(message);
            }
        }
    }

    /// Does a job; `None` where there is nothing to tell yet, or the run is stopped meanwhile.
    fn message(&self, job: Job) -> Result<Option<Vec<u8>>, RunError> {
        match job {
            Job::Case(number, task) => {
                let reply = self.case(&task)?;
                self.campaign.panel.check_shortage()?;
                if self.is_stopped() {
                    return Ok(None);
                }
                let engines = self.meter.since_last();
                Ok(Some(encoded(&Report::Job(CampaignReport::Case { number, reply, engines }))?))
            }
            Job::Batch(unit, number) => {
                let lock = || unit.progress.lock().unwrap_or_else(PoisonError::into_inner);
                lock().begun.get_or_insert_with(Instant::now);
                let stopped = || self.is_stopped();
                let batch = self.campaign.batch(number, unit.pairs.end, &ProgressCounts::default(), &stopped);
                self.campaign.panel.check_shortage()?;
                let Some(batch) = batch else { return Ok(None) };
                let mut progress = lock();
                progress.done.insert(number, batch);
                let batch_len = self.campaign.source.batch_len();
                let batches = unit.pairs.end.div_ceil(batch_len) - unit.first;
                if (progress.done.len() as u64) < batches {
                    return Ok(None);
                }
                let seconds = progress.begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64());
                let batches = std::mem::take(&mut progress.done).into_values().collect();
                drop(progress);
                self.result(&unit, batches, seconds).map(Some)
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.campaign.is_over(self.stop) || self.jobs.is_closed()
    }

    /// The message of a unit.
    fn result(&self, unit: &Unit, batches: Vec<BatchResult>, seconds: f64) -> Result<Vec<u8>, RunError> {
        let (mut counts, mut findings, mut stepped) = (Counts::default(), Vec::new(), Vec::new());
        for batch in batches {
            counts.add(batch.counts);
            findings.extend(batch.findings);
            stepped.extend(batch.stepped);
        }
        let (campaign, state) = (self.campaign, &unit.state);
        let room =
            |alike, of_cause, quota: CaseQuota| move |request: &CaseRequest| has_room(alike, of_cause, request, &quota);
        let pairs = room(&state.alike, &state.of_cause, campaign.case_quota());
        let steps = room(&state.steps_alike, &state.steps_of_cause, campaign.step_case_quota());
        let count = findings.len() as u64;
        let row_of = |finding: &Finding| {
            let row = finding.row(String::new());
            let wanted = pairs(&case_request(&row));
            (finding.index, row, wanted)
        };
        let step_row_of = |finding: &StepFinding| {
            let row = finding.row(String::new());
            let wanted = steps(&step_case_request(&row));
            (finding.index, row, wanted)
        };
        let (findings, steps) = (found(&findings, row_of)?, found(&stepped, step_row_of)?);
        let engines = self.meter.since_last();
        UnitResult { counts, findings, steps }.message(CampaignReport::Unit {
            number: unit.number,
            seconds,
            findings: count,
            engines,
        })
    }

    fn case(&self, task: &CaseTask) -> Result<CaseReply, RunError> {
        let made = match task.about_step {
            false => self.campaign.case_of_row(&row(&task.row)?, task.place),
            true => self.campaign.step_case_of_row(&row(&task.row)?, task.place),
        };
        Ok(match made {
            None => CaseReply::Unseen,
            Some(Ok(None)) => CaseReply::Impossible,
            Some(Ok(Some(bytes))) => CaseReply::Made(bytes),
            Some(Err(error)) => CaseReply::Failed(error.to_string()),
        })
    }
}

/// The rows of findings, of each its pair, its values, and whether it may get a case file.
fn found<F, R: Serialize>(findings: &[F], row: impl Fn(&F) -> (u64, R, bool)) -> Result<FoundRows, RunError> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    let (mut candidates, mut begin, mut last) = (Vec::new(), 0, None);
    for finding in findings {
        let (index, row, wanted) = row(finding);
        let place = match last {
            Some((before, place)) if before == index => place + 1,
            _ => 0,
        };
        last = Some((index, place));
        writer.serialize(row)?;
        writer.flush().map_err(csv::Error::from)?;
        let end = writer.get_ref().len();
        if wanted {
            candidates.push(Candidate { bytes: begin..end, place });
        }
        begin = end;
    }
    let bytes = writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))?;
    Ok(FoundRows { bytes, candidates })
}
