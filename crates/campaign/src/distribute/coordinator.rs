//! Hands out units of pairs and case files, and brings the results in order to whoever writes them.

use super::message::{CampaignOrder, CampaignReport, CaseReply, CaseState, CaseTask};
use super::plan::{Plan, UNITS_PER_WORKER, WINDOW};
use super::ranks::{Order, Report, encoded, taken};
use super::{Backoff, DistributeError, Transport};
use crate::journal::ProgressCounts;
use crate::run::{Campaign, RunError};
use rockproof_differential::engine::EngineCounts;
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError};

/// A unit that was examined.
pub(super) struct ExaminedUnit {
    pub(super) pairs: Range<u64>,
    pub(super) rank: usize,
    /// The message, and where the result begins in it.
    pub(super) message: Vec<u8>,
    pub(super) result: usize,
    pub(super) engines: BTreeMap<String, EngineCounts>,
}

/// A case file, or why there is none, and what external engines were asked for it.
pub(super) struct CaseDone {
    /// The place of its task among those that were asked for together.
    pub(super) at: usize,
    pub(super) reply: CaseReply,
    pub(super) engines: BTreeMap<String, EngineCounts>,
}

/// What the writer asks for.
pub(super) enum Request {
    /// Case files.
    Cases(Vec<CaseTask>, Sender<CaseDone>),
    /// Nothing: so many case files there are now.
    State(CaseState),
    /// Nothing: a unit is no longer in memory.
    Taken,
}

/// A worker, as it is known to rank 0.
struct Worker {
    threads: usize,
    /// Pairs a second.
    rate: Option<f64>,
    units: usize,
    cases: usize,
    /// Which state of the case files it knows.
    state: u64,
}

pub(super) struct Coordinator<'t, T: Transport> {
    transport: &'t mut T,
    workers: Vec<Worker>,
    plan: Plan,
    /// To the writer; none once it is to stop.
    units: Option<Sender<ExaminedUnit>>,
    requests: Receiver<Request>,
    /// Units in work, by number.
    in_work: BTreeMap<u64, Range<u64>>,
    /// Units that came before an earlier one.
    early: BTreeMap<u64, ExaminedUnit>,
    handed_out: u64,
    delivered: u64,
    /// Units that the writer has done with.
    taken: u64,
    tasks: VecDeque<(u64, CaseTask)>,
    /// Whom to tell of a case file, by its number, and at which place.
    asked: BTreeMap<u64, (Sender<CaseDone>, usize)>,
    case_number: u64,
    /// The newest state of the case files, and the message that tells it.
    state: (u64, Vec<u8>),
}

impl<'t, T: Transport> Coordinator<'t, T> {
    pub(super) fn new(
        transport: &'t mut T,
        threads: &[usize],
        plan: Plan,
        units: Sender<ExaminedUnit>,
        requests: Receiver<Request>,
    ) -> Coordinator<'t, T> {
        let worker = |&threads| Worker { threads, rate: None, units: 0, cases: 0, state: 0 };
        Coordinator {
            transport,
            workers: threads.iter().map(worker).collect(),
            plan,
            units: Some(units),
            requests,
            in_work: BTreeMap::new(),
            early: BTreeMap::new(),
            handed_out: 0,
            delivered: 0,
            taken: 0,
            tasks: VecDeque::new(),
            asked: BTreeMap::new(),
            case_number: 0,
            state: (0, Vec::new()),
        }
    }

    /// Leads the workers until the writer asks no more. When `stop` is set, or a worker was told to stop, which sets it, the writer gets
    /// nothing more.
    pub(super) fn lead(&mut self, seen: &ProgressCounts, stop: &AtomicBool) -> Result<(), RunError> {
        let mut patience = Backoff::default();
        loop {
            if stop.load(Ordering::SeqCst) {
                self.give_up();
            }
            let mut idle = true;
            while let Some((rank, message)) = self.transport.receive() {
                idle = false;
                if let Err(error) = self.hear(rank, message, seen, stop) {
                    self.give_up();
                    return Err(error);
                }
            }
            loop {
                match self.requests.try_recv() {
                    Ok(request) => {
                        idle = false;
                        self.note(request)?;
                    }
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return Ok(()),
                }
            }
            if self.units.is_some() {
                self.hand_out()?;
            }
            if idle {
                patience.wait();
            } else {
                patience.reset();
            }
        }
    }

    /// Lets the writer wait for nothing.
    fn give_up(&mut self) {
        self.units = None;
        self.tasks.clear();
        self.asked.clear();
    }

    fn note(&mut self, request: Request) -> Result<(), RunError> {
        match request {
            Request::Taken => self.taken += 1,
            Request::State(state) => {
                self.state = (self.state.0 + 1, encoded(&Order::Job(CampaignOrder::Cases(state)))?)
            }
            Request::Cases(tasks, reply) if self.units.is_some() => {
                for (at, task) in tasks.into_iter().enumerate() {
                    self.case_number += 1;
                    self.asked.insert(self.case_number, (reply.clone(), at));
                    self.tasks.push_back((self.case_number, task));
                }
            }
            // The sender is dropped, and whoever waits for replies sees it.
            Request::Cases(..) => {}
        }
        Ok(())
    }

    fn hear(
        &mut self,
        rank: usize,
        message: Vec<u8>,
        seen: &ProgressCounts,
        stop: &AtomicBool,
    ) -> Result<(), RunError> {
        let (report, rest): (Report<CampaignReport>, &[u8]) = taken(rank, &message)?;
        let unasked = || DistributeError::Message { rank, what: "nobody asked for it".to_owned() };
        let worker = rank.checked_sub(1).and_then(|at| self.workers.get_mut(at)).ok_or_else(unasked)?;
        match report {
            Report::Job(CampaignReport::Unit { number, seconds, findings, engines }) => {
                let pairs = self.in_work.remove(&number).ok_or_else(unasked)?;
                worker.units = worker.units.saturating_sub(1);
                let length = pairs.end - pairs.start;
                let now = length as f64 / seconds.max(1e-6);
                worker.rate = Some(worker.rate.map_or(now, |before| (before + now) / 2.0));
                seen.pairs.fetch_add(length, Ordering::Relaxed);
                seen.findings.fetch_add(findings, Ordering::Relaxed);
                let result = message.len() - rest.len();
                self.early.insert(number, ExaminedUnit { pairs, rank, message, result, engines });
                while let Some(next) = self.early.remove(&self.delivered) {
                    self.delivered += 1;
                    // A writer that has ended wants no more.
                    let _ = self.units.as_ref().map(|units| units.send(next));
                }
            }
            Report::Job(CampaignReport::Case { number, reply, engines }) => {
                worker.cases = worker.cases.saturating_sub(1);
                // Nobody waits for it when the run is stopped.
                if let Some((sender, at)) = self.asked.remove(&number) {
                    let _ = sender.send(CaseDone { at, reply, engines });
                }
            }
            Report::Stopped => stop.store(true, Ordering::SeqCst),
            Report::Ended => return Err(unasked().into()),
        }
        Ok(())
    }

    /// Gives work to whoever has room for some: case files first, for the writer waits for them.
    fn hand_out(&mut self) -> Result<(), RunError> {
        while !self.tasks.is_empty() {
            let free = self.workers.iter().enumerate().filter(|(_, worker)| worker.cases < worker.threads);
            // The share of its threads that make cases, without fractions.
            let Some(at) = free.min_by_key(|(_, worker)| worker.cases * 1024 / worker.threads).map(|(at, _)| at) else {
                break;
            };
            let Some((number, task)) = self.tasks.pop_front() else { break };
            self.workers[at].cases += 1;
            self.transport.send(at + 1, &encoded(&Order::Job(CampaignOrder::Case { number, task }))?);
        }
        for units in 0..UNITS_PER_WORKER {
            for at in 0..self.workers.len() {
                let ahead = self.handed_out - self.taken;
                if self.workers[at].units != units || ahead >= (WINDOW * self.workers.len()) as u64 {
                    continue;
                }
                let Worker { threads, rate, .. } = self.workers[at];
                let Some(pairs) = self.plan.next(threads, rate) else { return Ok(()) };
                if self.workers[at].state < self.state.0 {
                    self.workers[at].state = self.state.0;
                    self.transport.send(at + 1, &self.state.1);
                }
                let number = self.handed_out;
                self.handed_out += 1;
                self.workers[at].units += 1;
                self.in_work.insert(number, pairs.clone());
                self.transport.send(at + 1, &encoded(&Order::Job(CampaignOrder::Unit { number, pairs }))?);
            }
        }
        Ok(())
    }
}

impl Campaign<'_> {
    /// How pairs are handed out.
    pub(super) fn plan(&self, pairs: Range<u64>, workers: usize) -> Plan {
        Plan::new(pairs, self.source.batch_len(), self.chunk(), workers)
    }
}
