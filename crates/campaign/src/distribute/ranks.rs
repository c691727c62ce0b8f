//! What a job on many processes begins and ends with, whatever it does: the ranks introduce themselves, and are dismissed.

use super::{DistributeError, Patience, Transport};
use crate::part::Machine;
use rockproof_results::identity_differences;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

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
        if workers.contains_key(&rank) {
            // A worker without work has only one thing more to say: that it was told to stop.
            stop.store(true, Ordering::SeqCst);
            return Ok(None);
        }
        let worker: Introduction =
            serde_json::from_slice(&message).map_err(|e| DistributeError::Message { rank, what: e.to_string() })?;
        compare(rank, &worker, own)?;
        workers.insert(rank, worker);
    }
    Ok(Some(workers.into_values().collect()))
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

/// Sends all workers the message that there is no more to do, and waits until each has answered that it has ended. They hear it whatever
/// became of the job.
pub fn dismiss<T: Transport>(transport: &mut T, end: &[u8], has_ended: impl Fn(&[u8]) -> bool) {
    for rank in 1..transport.ranks() {
        transport.send(rank, end);
    }
    let (mut ended, mut patience) = (1, Patience::default());
    while ended < transport.ranks() {
        match transport.receive() {
            // What else comes was on its way.
            Some((_, message)) => {
                ended += usize::from(has_ended(&message));
                patience.reset();
            }
            None => patience.wait(),
        }
    }
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
