//! All ranks of a campaign, as rank 0 sees them.

use super::coordinator::Coordinator;
use super::message::{Introduction, Order, Report, encoded, taken};
use super::remote::Remote;
use super::{DistributeError, Patience, Transport};
use crate::journal::Journal;
use crate::run::{Campaign, Ending, RunError};
use rockproof_results::identity_differences;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// How a campaign on many processes ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Distributed {
    /// Whether it came to its end.
    pub ending: Ending,
    /// Findings chosen for a case file that the pair did not show again: what an external engine says may change.
    pub unseen: u64,
}

/// Rank 0 and its workers.
pub struct Crew<'t, T: Transport> {
    transport: &'t mut T,
    /// The threads of each worker, from rank 1 on.
    threads: Vec<usize>,
    /// What `run.json` says of the ranks.
    told: Map<String, Value>,
}

impl<'t, T: Transport> Crew<'t, T> {
    /// Waits for the workers to introduce themselves, and compares what they are to do with what rank 0 is. `None` where `stop` is set
    /// meanwhile. Nothing is written before.
    ///
    /// # Errors
    /// The first worker that cannot begin, is to do something else, or answers the first pairs differently.
    pub fn gather(
        transport: &'t mut T,
        own: &Introduction,
        stop: &AtomicBool,
    ) -> Result<Option<Crew<'t, T>>, DistributeError> {
        let mut workers: BTreeMap<usize, Introduction> = BTreeMap::new();
        let mut patience = Patience::default();
        while workers.len() + 1 < transport.ranks() {
            if stop.load(Ordering::SeqCst) {
                return Ok(None);
            }
            let Some((rank, message)) = transport.receive() else {
                patience.wait();
                continue;
            };
            patience.reset();
            let worker: Introduction =
                serde_json::from_slice(&message).map_err(|e| DistributeError::Message { rank, what: e.to_string() })?;
            compare(rank, &worker, own)?;
            workers.insert(rank, worker);
        }
        let threads: Vec<usize> = workers.values().map(|worker| worker.threads).collect();
        let mut hosts: BTreeMap<&str, u64> = BTreeMap::new();
        for introduction in workers.values().chain([own]) {
            *hosts.entry(&introduction.host).or_default() += 1;
        }
        let told = [
            ("ranks", json!(transport.ranks())),
            ("worker_threads", json!(threads.iter().sum::<usize>())),
            ("hosts", json!(hosts)),
        ];
        let told = told.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        Ok(Some(Crew { transport, threads, told }))
    }

    /// Tells all workers that there is no more to do, and waits until they have heard it. They hear it whatever became of the campaign.
    ///
    /// # Errors
    /// None that can be foreseen: the message cannot be written.
    pub fn dismiss(transport: &mut T) -> Result<(), RunError> {
        let end = encoded(&Order::End)?;
        for rank in 1..transport.ranks() {
            transport.send(rank, &end);
        }
        let (mut ended, mut patience) = (1, Patience::default());
        while ended < transport.ranks() {
            match transport.receive() {
                // What else comes was on its way.
                Some((rank, message)) => {
                    ended += usize::from(matches!(taken::<Report>(rank, &message), Ok((Report::Ended, _))));
                    patience.reset();
                }
                None => patience.wait(),
            }
        }
        Ok(())
    }
}

/// Compares a worker with rank 0.
fn compare(rank: usize, worker: &Introduction, own: &Introduction) -> Result<(), DistributeError> {
    let host = || worker.host.clone();
    let (identity, machine) = match &worker.work {
        Ok(work) => work,
        Err(what) => return Err(DistributeError::Worker { rank, host: host(), what: what.clone() }),
    };
    let Ok((own_identity, own_machine)) = &own.work else { return Ok(()) };
    let differences = identity_differences(own_identity, identity);
    if !differences.is_empty() {
        let told = |line: String| line.replace("the run has", "rank 0 has").replace("asked for is", "this rank has");
        let differences = differences.into_iter().map(told).collect();
        return Err(DistributeError::Configuration { rank, host: host(), differences });
    }
    if machine.answers != own_machine.answers {
        let (machine, here) = (machine.to_string(), own_machine.to_string());
        return Err(DistributeError::Answers { rank, host: host(), machine, here });
    }
    Ok(())
}

impl Campaign<'_> {
    /// Runs as [`Campaign::run`] does, with what workers examine who [`super::serve`] the same campaign. Examines nothing itself.
    ///
    /// # Errors
    /// As [`Campaign::run`], and when a worker fails. The workers are not dismissed.
    pub fn run_on<T: Transport>(
        &self,
        crew: &mut Crew<'_, T>,
        journal: &mut Journal,
        stop: &AtomicBool,
    ) -> Result<Distributed, RunError> {
        let progress = journal.progress();
        let pairs = progress.pairs_done.min(self.config.pairs)..self.config.pairs;
        let seen = journal.seen();
        let (to_writer, units) = mpsc::channel();
        let (to_coordinator, orders) = mpsc::channel();
        let mut remote = Remote::new(self, progress, units, to_coordinator, crew.told.clone());
        let mut coordinator = Coordinator::new(
            &mut *crew.transport,
            &crew.threads,
            self.plan(pairs, crew.threads.len()),
            to_writer,
            orders,
        );
        let stopped = || stop.load(Ordering::SeqCst);
        std::thread::scope(|scope| {
            let writer = scope.spawn(move || {
                let ending = self.work(0..self.config.pairs, journal, &stopped, &mut |_| {}, &mut remote)?;
                Ok(Distributed { ending, unseen: remote.unseen() })
            });
            let led = coordinator.lead(&seen, stop);
            drop(coordinator);
            let written = writer.join().unwrap_or_else(|panic| resume_unwind(panic));
            led.and(written)
        })
    }
}
