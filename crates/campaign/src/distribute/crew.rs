//! All ranks of a campaign, as rank 0 sees them.

use super::coordinator::Coordinator;
use super::ranks::{self, Introduction};
use super::remote::Remote;
use super::{DistributeError, Transport};
use crate::journal::Journal;
use crate::run::{Campaign, Ending, RunError};
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
    /// Waits for the workers ([`ranks::gather`]). Nothing is written before.
    ///
    /// # Errors
    /// As [`ranks::gather`].
    pub fn gather(
        transport: &'t mut T,
        own: &Introduction,
        stop: &AtomicBool,
    ) -> Result<Option<Crew<'t, T>>, DistributeError> {
        let Some(workers) = ranks::gather(transport, own, stop)? else { return Ok(None) };
        let threads: Vec<usize> = workers.iter().map(|worker| worker.threads).collect();
        let mut hosts: BTreeMap<&str, u64> = BTreeMap::new();
        for introduction in workers.iter().chain([own]) {
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
}

impl Campaign<'_> {
    /// Runs as [`Campaign::run`] does, with what workers examine who [`super::serve`] the same campaign. Examines nothing itself.
    ///
    /// # Errors
    /// As [`Campaign::run`], and when a worker fails. The workers are not dismissed ([`ranks::end_workers`]).
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
