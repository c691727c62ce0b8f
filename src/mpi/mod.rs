//! The ranks of an MPI job, and how they end: what `campaign --mpi` and `tune --mpi` have in common. Rank 0 leads and writes, the others work.

mod campaign;
mod tune;

use crate::exit::{ExitStatus, Outcome, chain, print_error};
use anyhow::Context;
use mpi::Threading;
use mpi::point_to_point::{MatchedReceiveVec, Source};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination};
use rockproof_campaign::distribute::ranks::end_workers;
use rockproof_campaign::distribute::{Introduction, Transport};
use rockproof_campaign::part::Machine;
use serde_json::{Map, Value};
use std::collections::VecDeque;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

/// The exit code of a program that panicked.
const PANICKED: i32 = 101;

/// What a command does on the ranks of a job.
pub(crate) trait Job {
    /// All of it, in the only process there is.
    fn alone(&self) -> Outcome;

    /// The part of rank 0. The others are dismissed afterwards, whatever became of it.
    fn lead(&self, ranks: &mut Ranks) -> Outcome;

    /// The part of any other rank. What goes wrong before it works it tells rank 0, which tells the user.
    fn work(&self, ranks: &mut Ranks) -> Outcome;
}

/// Does a job on all ranks, or in this process where there is only one.
pub(crate) fn on_all_ranks(job: &dyn Job) -> Outcome {
    let (universe, threading) =
        mpi::initialize_with_threading(Threading::Funneled).context("MPI is running already in this process")?;
    anyhow::ensure!(threading >= Threading::Funneled, "this MPI bears no threads in a process");
    let mut ranks = Ranks { world: universe.world(), inbox: VecDeque::new() };
    // Whoever ends otherwise than with all others would leave them waiting.
    let ended = catch_unwind(AssertUnwindSafe(|| match (ranks.ranks(), ranks.own()) {
        (1, _) => job.alone(),
        (_, 0) => {
            let outcome = job.lead(&mut ranks);
            end_workers(&mut ranks)?;
            outcome
        }
        (_, _) => job.work(&mut ranks),
    }));
    ended.unwrap_or_else(|_| ranks.end_all("a panic, told above", PANICKED))
}

/// How this rank introduces itself, with so many worker threads; 0 for one a core.
fn introduction(threads: usize, work: anyhow::Result<(Map<String, Value>, Machine)>) -> Introduction {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads };
    Introduction { host: host(), threads, work: work.map_err(|error| chain(&error)) }
}

/// The machine, by the name that MPI gives it.
fn host() -> String {
    mpi::environment::processor_name().unwrap_or_else(|_| "a machine without a name".to_owned())
}

/// The ranks of the job.
pub(crate) struct Ranks {
    world: SimpleCommunicator,
    inbox: VecDeque<(usize, Vec<u8>)>,
}

/// How often a message that the other rank has not taken yet is looked after.
const LOOK: Duration = Duration::from_micros(100);

impl Ranks {
    fn own(&self) -> usize {
        usize::try_from(self.world.rank()).unwrap_or(0)
    }

    /// What a worker comes to that has served; an error, which may be a panic, ends all ranks.
    fn served<E: Display>(&self, served: Result<(), E>, is_panic: impl FnOnce(&E) -> bool) -> Outcome {
        match served {
            Ok(()) => Ok(ExitStatus::Passed),
            Err(error) => self.end_all(&error.to_string(), if is_panic(&error) { PANICKED } else { 2 }),
        }
    }

    /// Ends all ranks at once; what is on disk bears it.
    fn end_all(&self, why: &str, code: i32) -> ! {
        print_error(&format!("rank {} ({}) ends all ranks: {why}; --resume goes on", self.own(), host()));
        self.world.abort(code)
    }
}

/// Takes in a message that has come.
fn take_in(world: &SimpleCommunicator, inbox: &mut VecDeque<(usize, Vec<u8>)>) -> bool {
    let Some(message) = world.any_process().immediate_matched_probe() else { return false };
    let (bytes, status) = message.matched_receive_vec::<u8>();
    inbox.push_back((usize::try_from(status.source_rank()).unwrap_or(0), bytes));
    true
}

impl Transport for Ranks {
    fn ranks(&self) -> usize {
        usize::try_from(self.world.size()).unwrap_or(1)
    }

    fn send(&mut self, to: usize, message: &[u8]) {
        let Ranks { world, inbox } = self;
        let to = i32::try_from(to).unwrap_or(0);
        mpi::request::scope(|scope| {
            let mut request = world.process_at_rank(to).immediate_send(scope, message);
            while let Err(again) = request.test() {
                request = again;
                if !take_in(world, inbox) {
                    std::thread::sleep(LOOK);
                }
            }
        });
    }

    fn receive(&mut self) -> Option<(usize, Vec<u8>)> {
        take_in(&self.world, &mut self.inbox);
        self.inbox.pop_front()
    }
}
