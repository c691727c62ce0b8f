//! Pins that a campaign on many processes is the campaign of one, whoever is slow, stopped or refused. Threads stand for the processes, and
//! answers are toys; only the machinery is tested.

use super::resume::{config, results, uninterrupted};
use super::scripted::{Counting, counting};
use crate::thread_ranks::Threads;
use rockproof_campaign::distribute::ranks::end_workers;
use rockproof_campaign::distribute::{Crew, DistributeError, Introduction, serve};
use rockproof_campaign::journal::Journal;
use rockproof_campaign::part::Machine;
use rockproof_campaign::run::{Campaign, Ending, RunError};
use rockproof_differential::finding::Finding;
use rockproof_results::Start;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

fn introduction(answers: &str, threads: usize) -> Introduction {
    let [os, architecture] = ["toy", "toy"].map(str::to_owned);
    let machine = Machine { os, architecture, answers: answers.to_owned() };
    let host = format!("host-{answers}");
    Introduction { host, threads, work: Ok((config().identity().expect("a map"), machine)) }
}

/// What may go wrong.
#[derive(Clone, Copy, Default)]
struct Trouble {
    /// After so many examined pairs everything is to stop; 0 for never.
    stop_after: u64,
    /// Every so-many-th message of the last worker is cut in half, unless it is one of few bytes; 0 for none.
    damage: u64,
    /// The last worker answers otherwise.
    other_answers: bool,
}

/// Runs or goes on with so many ranks.
fn run(dir: &Path, ranks: usize, trouble: Trouble) -> Result<Option<Ending>, RunError> {
    let (config, panel) = (config(), counting());
    let narrow = |_: &Finding| counting();
    let campaign =
        Campaign { config: &config, source: &Counting, panel: &panel, narrow: &narrow, steppers: &[], threads: 1 };
    let mut all = Threads::all(ranks);
    let mut first = all.remove(0);
    let (stop, over) = (AtomicBool::new(false), AtomicBool::new(false));
    let examined = AtomicU64::new(0);
    std::thread::scope(|scope| {
        let last = all.len();
        for mut transport in all {
            let (campaign, is_last) = (&campaign, transport.own == last);
            transport.damage = if is_last { trouble.damage } else { 0 };
            let answers = if is_last && trouble.other_answers { "other" } else { "toy" };
            // Only one rank is told to stop; the others must hear of it.
            let own_stop = AtomicBool::new(false);
            let introduction = introduction(answers, transport.own);
            scope.spawn(move || serve(Some(campaign), &mut transport, &introduction, &own_stop));
        }
        let led = (|| {
            let Some(mut crew) = Crew::gather(&mut first, &introduction("toy", 1), &stop)? else { return Ok(None) };
            let mut journal = Journal::open(dir, config.identity().expect("a map"), Start::Resume)?;
            let seen = journal.seen();
            let ended = std::thread::scope(|scope| {
                scope.spawn(|| {
                    while !over.load(Ordering::SeqCst) {
                        let pairs = seen.pairs.load(Ordering::SeqCst);
                        examined.store(pairs, Ordering::SeqCst);
                        if trouble.stop_after > 0 && pairs >= trouble.stop_after {
                            stop.store(true, Ordering::SeqCst);
                        }
                        std::thread::sleep(Duration::from_micros(50));
                    }
                });
                let ended = campaign.run_on(&mut crew, &mut journal, &stop);
                over.store(true, Ordering::SeqCst);
                ended
            })?;
            assert_eq!(ended.unseen, 0);
            Ok(Some(ended.ending))
        })();
        end_workers(&mut first).expect("a message");
        led
    })
}

#[test]
fn any_number_of_ranks_writes_what_one_process_writes() {
    let whole = uninterrupted();
    for ranks in [2, 3, 6] {
        let dir = crate::place::folder();
        assert_eq!(run(dir.path(), ranks, Trouble::default()).expect("runs"), Some(Ending::Finished));
        assert!(results(dir.path()) == whole, "{ranks} ranks");
    }
}

#[test]
fn what_is_stopped_goes_on_with_other_ranks_to_the_same_bytes() {
    let whole = uninterrupted();
    let mut stopped = 0;
    for first in (16..200).step_by(23) {
        let dir = crate::place::folder();
        for ranks in 2..20 {
            let stop_after = first * (ranks as u64 - 1);
            let ending = run(dir.path(), 2 + ranks % 4, Trouble { stop_after, ..Trouble::default() }).expect("runs");
            stopped += u64::from(ending == Some(Ending::Stopped));
            if ending == Some(Ending::Finished) {
                break;
            }
        }
        assert!(results(dir.path()) == whole, "stopped after {first} pairs");
    }
    assert!(stopped > 4, "only {stopped} runs were stopped");
}

#[test]
fn a_rank_that_does_not_belong_is_named_and_nothing_is_written() {
    let dir = crate::place::folder();
    let out = dir.path().join("out");
    let error = run(&out, 4, Trouble { other_answers: true, ..Trouble::default() }).expect_err("refused");
    let text = error.to_string();
    assert!(matches!(error, RunError::Distribute(DistributeError::Answers { rank: 3, .. })), "{text}");
    assert!(text.contains("rank 3 (host-other, toy toy)") && !out.exists(), "{text}");
}

#[test]
fn a_damaged_message_ends_the_run_and_what_is_there_goes_on() {
    let whole = uninterrupted();
    for damage in [2, 3, 5] {
        let dir = crate::place::folder();
        let error = run(dir.path(), 3, Trouble { damage, ..Trouble::default() }).expect_err("damaged").to_string();
        assert!(error.starts_with("rank 2 sent a message that cannot be read"), "{error}");
        assert_eq!(run(dir.path(), 2, Trouble::default()).expect("runs"), Some(Ending::Finished));
        assert!(results(dir.path()) == whole, "every {damage}th message");
    }
}
