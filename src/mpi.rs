//! `campaign --mpi`: the ranks of an MPI job. Rank 0 leads and keeps the journal, the others work (`crates/campaign/src/distribute/`).

use crate::campaign::{Campaign, Prepared, diagnosed, probed};
use crate::exit::{Outcome, Verdict, chain, print_error, print_note};
use crate::progress::shown_while;
use crate::stop::{on_ctrl_c, on_ctrl_c_silently};
use anyhow::Context;
use mpi::Threading;
use mpi::point_to_point::{MatchedReceiveVec, Source};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination};
use rockproof_campaign::distribute::{Crew, Introduction, Transport, serve};
use rockproof_campaign::journal::Journal;
use rockproof_campaign::part::Machine;
use rockproof_campaign::run::{Ending, RunError};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

/// The exit code of a program that panicked.
const PANICKED: i32 = 101;

/// Runs a campaign on all ranks, or in this process where there is only one.
pub(crate) fn run(command: &Campaign) -> Outcome {
    let (universe, threading) =
        mpi::initialize_with_threading(Threading::Funneled).context("MPI is running already in this process")?;
    anyhow::ensure!(threading >= Threading::Funneled, "this MPI bears no threads in a process");
    let mut ranks = Ranks { world: universe.world(), inbox: VecDeque::new() };
    // Whoever ends otherwise than with all others would leave them waiting.
    let ended = catch_unwind(AssertUnwindSafe(|| match (ranks.ranks(), ranks.own()) {
        (1, _) => command.run_here(),
        (_, 0) => lead(command, &mut ranks),
        (_, _) => work(command, &mut ranks),
    }));
    ended.unwrap_or_else(|_| ranks.end_all("a panic, told above", PANICKED))
}

/// Rank 0.
fn lead(command: &Campaign, ranks: &mut Ranks) -> Outcome {
    let outcome = led(command, ranks);
    Crew::dismiss(ranks)?;
    outcome
}

fn led(command: &Campaign, ranks: &mut Ranks) -> Outcome {
    let prepared = command.prepared()?;
    let stop = on_ctrl_c()?;
    if !probed(&prepared.engines, &stop)? {
        return Ok(Verdict::Interrupted);
    }
    let own = introduction(&prepared, command)?;
    let Some(mut crew) = Crew::gather(ranks, &own, &stop)? else { return Ok(Verdict::Interrupted) };
    let mut journal = command.journal(&prepared)?;
    let mut led = |journal: &mut Journal| {
        prepared.with_campaign(command.threads(), |campaign| {
            shown_while(prepared.config.pairs, journal.seen(), || campaign.run_on(&mut crew, journal, &stop))
        })
    };
    let distributed = led(&mut journal)?;
    if distributed.unseen > 0 {
        print_note(&format!(
            "{} findings have no case file, because an engine does not answer twice alike",
            distributed.unseen
        ));
    }
    let ending = match distributed.ending {
        Ending::Finished => {
            prepared.with_campaign(command.threads(), |campaign| diagnosed(campaign, &mut journal, &stop))?
        }
        ending @ Ending::Stopped => ending,
    };
    command.end(&prepared, &mut journal, ending)
}

/// Any other rank. What goes wrong before it works it tells rank 0, which tells the user.
fn work(command: &Campaign, ranks: &mut Ranks) -> Outcome {
    let stop = on_ctrl_c_silently()?;
    let prepared = command.prepared().and_then(|prepared| {
        probed(&prepared.engines, &stop)?;
        let introduction = introduction(&prepared, command)?;
        Ok((prepared, introduction))
    });
    let served = match &prepared {
        Ok((prepared, introduction)) => {
            prepared.with_campaign(command.threads(), |campaign| serve(Some(campaign), ranks, introduction, &stop))
        }
        Err(error) => {
            let introduction = Introduction { host: host(), threads: 1, work: Err(chain(error)) };
            serve(None, ranks, &introduction, &stop)
        }
    };
    match served {
        Ok(()) => Ok(Verdict::Passed),
        Err(error @ RunError::Panic(_)) => ranks.end_all(&error.to_string(), PANICKED),
        Err(error) => ranks.end_all(&error.to_string(), 2),
    }
}

fn introduction(prepared: &Prepared, command: &Campaign) -> anyhow::Result<Introduction> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if command.threads() == 0 { cores() } else { command.threads() };
    let machine = Machine::here(&*prepared.source)?;
    Ok(Introduction { host: host(), threads, work: Ok((prepared.identity.clone(), machine)) })
}

/// The machine, by the name that MPI gives it.
fn host() -> String {
    mpi::environment::processor_name().unwrap_or_else(|_| "a machine without a name".to_owned())
}

/// The ranks of the job.
struct Ranks {
    world: SimpleCommunicator,
    inbox: VecDeque<(usize, Vec<u8>)>,
}

/// How often a message that the other rank has not taken yet is looked after.
const LOOK: Duration = Duration::from_micros(100);

impl Ranks {
    fn own(&self) -> usize {
        usize::try_from(self.world.rank()).unwrap_or(0)
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
