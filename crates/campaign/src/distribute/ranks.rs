//! What jobs on many processes have in common, whatever they do: the ranks introduce themselves, workers obey orders and report, and are dismissed.

use super::{Backoff, DistributeError, Transport};
use crate::part::Machine;
use rockproof_results::identity_differences;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

/// How a worker introduces itself, and what rank 0 compares that with. In JSON, which programs of other versions understand too.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Introduction {
    /// The machine it runs on, by name.
    pub host: String,
    /// Its worker threads.
    pub threads: usize,
    /// What it is to do, with the version of the program; why it cannot, otherwise.
    pub work: Result<(Map<String, Value>, Machine), String>,
}

/// From rank 0 to a worker, in a job with orders `O`.
#[derive(Debug, Serialize, Deserialize)]
pub enum Order<O> {
    /// There is no more to do, whatever is in work.
    End,
    /// Something to do.
    Job(O),
}

/// From a worker to rank 0, in a job with reports `R`.
#[derive(Debug, Serialize, Deserialize)]
pub enum Report<R> {
    /// The answer to [`Order::End`].
    Ended,
    /// It was told to stop.
    Stopped,
    /// What came of an order.
    Job(R),
}

/// Tells rank 0 who this worker is.
///
/// # Errors
/// None that can be foreseen: the message cannot be written.
pub fn introduce<T: Transport>(transport: &mut T, introduction: &Introduction) -> Result<(), DistributeError> {
    transport.send(0, &serde_json::to_vec(introduction).map_err(DistributeError::Introduction)?);
    Ok(())
}

/// Waits for the workers to introduce themselves, and compares what they are to do with what rank 0 is; gives them from rank 1 on. `None`
/// where `stop` is set meanwhile, or a worker was told to stop, which sets it.
///
/// # Errors
/// The first worker that cannot begin, is to do something else, or answers the first pairs differently.
pub fn gather<T: Transport>(
    transport: &mut T,
    own: &Introduction,
    stop: &AtomicBool,
) -> Result<Option<Vec<Introduction>>, DistributeError> {
    let mut workers: BTreeMap<usize, Introduction> = BTreeMap::new();
    let mut patience = Backoff::default();
    while workers.len() + 1 < transport.ranks() {
        if stop.load(Ordering::SeqCst) {
            return Ok(None);
        }
        let Some((rank, message)) = transport.receive() else {
            patience.wait();
            continue;
        };
        patience.reset();
        if workers.contains_key(&rank) {
            // A worker without work has only one thing more to say: that it was told to stop.
            stop.store(true, Ordering::SeqCst);
            return Ok(None);
        }
        let worker = introduced(rank, &message)?;
        compare(rank, &worker, own)?;
        workers.insert(rank, worker);
    }
    Ok(Some(workers.into_values().collect()))
}

/// The introduction in a message from a rank.
pub(super) fn introduced(rank: usize, message: &[u8]) -> Result<Introduction, DistributeError> {
    serde_json::from_slice(message).map_err(|e| DistributeError::Message { rank, what: e.to_string() })
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

/// What a worker does after its introduction, until rank 0 says that there is no more to do: gives orders to `carry_out`, which does not wait
/// until they are, and sends the encoded `reports` of whoever does. When `stop` is set rank 0 is told, which then says so.
///
/// # Errors
/// When a message cannot be read or written, and what `reports` brings.
pub fn follow_orders<T: Transport, O: DeserializeOwned, E: From<DistributeError>>(
    transport: &mut T,
    reports: &Receiver<Result<Vec<u8>, E>>,
    stop: &AtomicBool,
    mut carry_out: impl FnMut(O),
) -> Result<(), E> {
    let (mut patience, mut has_said_so) = (Backoff::default(), false);
    loop {
        let mut idle = true;
        while let Some((rank, message)) = transport.receive() {
            idle = false;
            match taken(rank, &message)?.0 {
                Order::End => {
                    transport.send(0, &encoded(&Report::<()>::Ended)?);
                    return Ok(());
                }
                Order::Job(order) => carry_out(order),
            }
        }
        while let Ok(report) = reports.try_recv() {
            idle = false;
            transport.send(0, &report?);
        }
        if stop.load(Ordering::SeqCst) && !has_said_so {
            has_said_so = true;
            transport.send(0, &encoded(&Report::<()>::Stopped)?);
        }
        if idle {
            patience.wait();
        } else {
            patience.reset();
        }
    }
}

/// Tells all workers that there is no more to do, and waits until each has answered that it has ended. They hear it whatever became of the job.
///
/// # Errors
/// None that can be foreseen: the message cannot be written.
pub fn end_workers<T: Transport>(transport: &mut T) -> Result<(), DistributeError> {
    let end = encoded(&Order::<()>::End)?;
    for rank in 1..transport.ranks() {
        transport.send(rank, &end);
    }
    let (mut ended, mut patience) = (1, Backoff::default());
    while ended < transport.ranks() {
        match transport.receive() {
            // What else comes was on its way.
            Some((rank, message)) => {
                // Of a report the kind is read alone.
                ended += usize::from(matches!(taken(rank, &message), Ok((Report::<()>::Ended, _))));
                patience.reset();
            }
            None => patience.wait(),
        }
    }
    Ok(())
}

/// A message, in postcard.
///
/// # Errors
/// None that can be foreseen.
pub fn encoded<T: Serialize>(message: &T) -> Result<Vec<u8>, DistributeError> {
    postcard::to_extend(message, Vec::new()).map_err(DistributeError::Unwritable)
}

/// A message from a rank, and what follows upon it.
///
/// # Errors
/// When it cannot be read.
pub fn taken<T: DeserializeOwned>(rank: usize, bytes: &[u8]) -> Result<(T, &[u8]), DistributeError> {
    postcard::take_from_bytes(bytes).map_err(|e| DistributeError::Message { rank, what: e.to_string() })
}
