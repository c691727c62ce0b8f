//! A worker: measures the candidates that rank 0 asks for.

use super::message::{JobResult, SearchOrder, SearchReport, SentOverlap, unexpected_message, unreadable};
use crate::TuneError;
use crate::evaluator::UnauditedEvaluator;
use crate::search::Search;
use rayon::ThreadPool;
use rockproof_campaign::distribute::ranks::{Introduction, Report, encoded, follow_orders, introduce};
use rockproof_campaign::distribute::{Transport, WorkerPanic};
use rockproof_model::ToleranceSpec;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{self, Receiver, Sender};

/// What a worker measures.
pub struct SearchTask<'t> {
    /// The model.
    pub evaluator: UnauditedEvaluator,
    /// What the author uses.
    pub author: &'t ToleranceSpec,
    /// The seed of candidates.
    pub seed: u64,
    /// What it measures in.
    pub pool: &'t ThreadPool,
}

/// Tells rank 0 who this worker is and, where there is a `task`, works at it until rank 0 says that there is no more to do. When `stop` is set
/// rank 0 is told, which then says so. What has begun is ended even so.
///
/// # Errors
/// When a message cannot be read or written, or the thread that measures panicked, which nobody but the caller can tell rank 0.
pub fn serve<T: Transport>(
    task: Option<SearchTask<'_>>,
    transport: &mut T,
    introduction: &Introduction,
    stop: &AtomicBool,
) -> Result<(), TuneError> {
    introduce(transport, introduction)?;
    std::thread::scope(|scope| {
        // Dropped however this ends, and the thread ends with them.
        let (to_thread, orders) = mpsc::channel();
        let (reports, done) = mpsc::channel();
        if let Some(task) = task {
            scope.spawn(move || {
                let worked = catch_unwind(AssertUnwindSafe(|| task.work(&orders, &reports)));
                if let Err(error) = worked.unwrap_or_else(|_| Err(WorkerPanic.into())) {
                    let _ = reports.send(Err(error));
                }
            });
        }
        follow_orders(transport, &done, stop, |order| drop(to_thread.send(order)))
    })
}

impl SearchTask<'_> {
    /// Carries out orders until there are no more.
    fn work(
        self,
        orders: &Receiver<SearchOrder>,
        reports: &Sender<Result<Vec<u8>, TuneError>>,
    ) -> Result<(), TuneError> {
        let SearchTask { evaluator, author, seed, pool } = self;
        // Nobody listens any more when the search is over.
        let tell = |report: SearchReport| drop(reports.send(encoded(&Report::Job(report)).map_err(TuneError::from)));
        let overlaps = loop {
            match orders.recv() {
                Ok(SearchOrder::Audit(share)) => {
                    let found = pool.install(|| evaluator.overlaps(share));
                    tell(SearchReport::Audited(found.iter().map(SentOverlap::of).collect()));
                }
                Ok(SearchOrder::Overlaps(all)) => break all,
                Ok(_) => return Err(unexpected_message(0).into()),
                Err(_) => return Ok(()),
            }
        };
        let overlaps = overlaps.iter().map(|sent| sent.read(0, evaluator.blocks()));
        let overlaps = overlaps.collect::<Result<_, _>>()?;
        let evaluator = evaluator.with(overlaps);
        let search = Search::new(&evaluator, author, seed)?;
        for order in orders {
            let SearchOrder::Job(job) = order else { return Err(unexpected_message(0).into()) };
            let set = search.set_of(job.set).ok_or_else(|| unreadable(0, "a set that there is not"))?;
            let result = Box::new(pool.install(|| JobResult::of(&evaluator, job.work, &set)));
            tell(SearchReport::Done { number: job.number, result });
        }
        Ok(())
    }
}
