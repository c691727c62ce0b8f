//! All ranks of a search, as rank 0 sees them, which measures candidates too.

use super::lookahead::Lookahead;
use super::message::{JobResult, SearchOrder, SearchReport, SentOverlap, unexpected_message};
use crate::TuneError;
use crate::evaluator::{Evaluator, UnauditedEvaluator};
use crate::given_overlaps::{GivenOverlap, Share};
use crate::search::Search;
use rayon::ThreadPool;
use rockproof_campaign::distribute::ranks::{self, Introduction, Order, Report, encoded, taken};
use rockproof_campaign::distribute::{Backoff, DistributeError, Transport};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, TryRecvError};

/// When a search has tried enough.
pub struct StopCriterion<'e> {
    /// Whether so many candidates are.
    pub reached: &'e dyn Fn(usize) -> bool,
    /// Candidates that are enough whatever [`StopCriterion::reached`] says; no more than these are looked at.
    pub most: Option<usize>,
}

/// Candidates ahead for each rank: one in work, one that waits for an earlier one.
const AHEAD: usize = 2;

/// Rank 0 and its workers.
pub struct Crew<'t, T: Transport> {
    transport: &'t mut T,
    pool: &'t ThreadPool,
}

impl<'t, T: Transport> Crew<'t, T> {
    /// Waits for the workers ([`ranks::gather`]). Rank 0 measures in `pool`.
    ///
    /// # Errors
    /// As [`ranks::gather`].
    pub fn gather(
        transport: &'t mut T,
        own: &Introduction,
        pool: &'t ThreadPool,
        stop: &AtomicBool,
    ) -> Result<Option<Crew<'t, T>>, DistributeError> {
        let gathered = ranks::gather(transport, own, stop)?.is_some();
        Ok(gathered.then_some(Crew { transport, pool }))
    }

    /// Finds the overlaps of the model, every rank those of its share. `None` where `stop` is set meanwhile.
    ///
    /// # Errors
    /// When a worker fails.
    pub fn audited(
        &mut self,
        evaluator: UnauditedEvaluator,
        stop: &AtomicBool,
    ) -> Result<Option<Evaluator>, TuneError> {
        let of = self.transport.ranks();
        for number in 1..of {
            self.transport.send(number, &encoded(&Order::Job(SearchOrder::Audit(Share { number, of })))?);
        }
        let mut found: Vec<Option<Vec<GivenOverlap>>> = vec![None; of];
        found[0] = Some(self.pool.install(|| evaluator.overlaps(Share { number: 0, of })));
        let mut patience = Backoff::default();
        while found.contains(&None) {
            if stop.load(Ordering::SeqCst) {
                return Ok(None);
            }
            let Some((rank, message)) = self.transport.receive() else {
                patience.wait();
                continue;
            };
            patience.reset();
            match (taken(rank, &message)?.0, found.get_mut(rank)) {
                (Report::Job(SearchReport::Audited(sent)), Some(place @ None)) => {
                    let overlaps = sent.iter().map(|sent| sent.read(rank, evaluator.blocks()));
                    *place = Some(overlaps.collect::<Result<_, _>>()?);
                }
                (Report::Stopped, _) => stop.store(true, Ordering::SeqCst),
                _ => return Err(unexpected_message(rank).into()),
            }
        }
        let found: Vec<GivenOverlap> = found.into_iter().flatten().flatten().collect();
        let overlaps = SearchOrder::Overlaps(found.iter().map(SentOverlap::of).collect());
        let order = encoded(&Order::Job(overlaps))?;
        (1..of).for_each(|rank| self.transport.send(rank, &order));
        Ok(Some(evaluator.with(found)))
    }

    /// Tries candidates until there are enough or `stop` is set, and commits each. The workers are not dismissed ([`ranks::end_workers`]).
    ///
    /// # Errors
    /// When a candidate cannot be measured or committed, or a worker fails.
    pub fn search<E: From<TuneError>>(
        &mut self,
        search: &mut Search<'_>,
        enough: &StopCriterion<'_>,
        stop: &AtomicBool,
        commit: &mut dyn FnMut(&Search<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let (evaluator, pool, count) = (search.evaluator(), self.pool, self.transport.ranks());
        let mut ahead = Lookahead::new(AHEAD * count, enough.most);
        std::thread::scope(|scope| {
            let (to_thread, jobs) = mpsc::channel();
            let (to_here, results) = mpsc::channel();
            let thread = scope.spawn(move || {
                for (number, work, set) in jobs {
                    let result = pool.install(|| JobResult::of(evaluator, work, &set));
                    // Nobody listens any more when the search is over.
                    let _ = to_here.send((number, result));
                }
            });
            // The job that each rank has.
            let (mut in_work, mut patience) = (vec![None; count], Backoff::default());
            loop {
                let mut idle = true;
                while let Some((rank, message)) = self.transport.receive() {
                    idle = false;
                    match hear(rank, &message, &mut in_work)? {
                        Some((number, result)) => ahead.take(number, result),
                        None => stop.store(true, Ordering::SeqCst),
                    }
                }
                match results.try_recv() {
                    Ok((number, result)) => {
                        idle = false;
                        in_work[0] = None;
                        ahead.take(number, result);
                    }
                    Err(TryRecvError::Empty) => {}
                    // It ends before its jobs do only by a panic.
                    Err(TryRecvError::Disconnected) => break,
                }
                loop {
                    if stop.load(Ordering::SeqCst) || (enough.reached)(search.tried().len()) {
                        return Ok(());
                    }
                    if !ahead.advance(search)? {
                        break;
                    }
                    commit(search)?;
                }
                for (rank, own) in in_work.iter_mut().enumerate().filter(|(_, own)| own.is_none()) {
                    let Some(job) = ahead.job(search) else { break };
                    *own = Some(job.number);
                    match rank {
                        0 => {
                            let set = search.set_of(job.set).ok_or_else(|| TuneError::from(unexpected_message(0)))?;
                            let _ = to_thread.send((job.number, job.work, set));
                        }
                        _ => {
                            let order = encoded(&Order::Job(SearchOrder::Job(job))).map_err(TuneError::from)?;
                            self.transport.send(rank, &order);
                        }
                    }
                }
                if idle {
                    patience.wait();
                } else {
                    patience.reset();
                }
            }
            drop(to_thread);
            thread.join().map_err(|panic| resume_unwind(panic))
        })
    }
}

/// What a worker tells while candidates are tried: what came of its job, or `None` where it was told to stop.
fn hear(rank: usize, message: &[u8], in_work: &mut [Option<u64>]) -> Result<Option<(u64, JobResult)>, TuneError> {
    match (taken(rank, message)?.0, in_work.get_mut(rank)) {
        (Report::Job(SearchReport::Done { number, result }), Some(place)) if rank > 0 && *place == Some(number) => {
            *place = None;
            Ok(Some((number, *result)))
        }
        (Report::Stopped, _) => Ok(None),
        _ => Err(unexpected_message(rank).into()),
    }
}
