//! Pins that parts put together are the campaign of one machine, whatever interrupts parts and merge. Answers are toys; only the machinery
//! is tested.

use super::resume::{config, results, uninterrupted};
use super::scripted::{Counting, counting};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::{Machine, Part};
use rockproof_campaign::run::{Campaign, Ending, RunError};
use rockproof_campaign::source;
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::builtin;
use rockproof_differential::finding::{Cause, Finding, Fingerprint};
use rockproof_differential::subject::PairSource;
use rockproof_results::Start;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

fn machine() -> Machine {
    Machine { os: "toy".to_owned(), architecture: "toy".to_owned(), answers: "toy".to_owned() }
}

fn with_campaign<T>(threads: usize, work: impl FnOnce(&Campaign<'_>) -> T) -> T {
    let (config, panel) = (config(), counting());
    let narrow = |_: &Finding| counting();
    work(&Campaign { config: &config, source: &Counting, panel: &panel, narrow: &narrow, steppers: &[], threads })
}

/// Makes a part, stopping after each chunk and going on.
fn part(dir: &Path, part: Part) {
    with_campaign(2, |campaign| {
        let stop = AtomicBool::new(false);
        loop {
            let identity = config().identity().expect("a map");
            let mut journal = Journal::open_part(dir, identity, Start::Resume, part, machine()).expect("opens");
            stop.store(false, Ordering::Relaxed);
            let mut watch = |_: &_| stop.store(true, Ordering::Relaxed);
            if campaign.run_part(part, &mut journal, &stop, &mut watch).expect("runs") == Ending::Finished {
                return;
            }
        }
    });
}

/// Merges, until the first chunk is done if it is to be `stopped`.
fn merge(parts: &Parts, out: &Path, threads: usize, stopped: bool) -> Result<Ending, RunError> {
    with_campaign(threads, |campaign| {
        let batch_len = Counting.batch_len();
        parts.check(&config().identity().expect("a map"), &machine(), batch_len)?;
        let mut journal = Journal::open(out, parts.identity(batch_len), Start::Resume)?;
        let stop = AtomicBool::new(false);
        let merged = campaign.merge(parts, &mut journal, &stop, &mut |_| stop.store(stopped, Ordering::Relaxed))?;
        assert_eq!(merged.unseen, 0);
        Ok(merged.ending)
    })
}

/// Makes so many parts.
fn parts(dir: &Path, of: u64) -> Vec<PathBuf> {
    let one = |number: u64| {
        let out = dir.join(format!("{number}"));
        part(&out, format!("{number}/{of}").parse().expect("a part"));
        out
    };
    (1..=of).map(one).collect()
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn any_number_of_parts_makes_the_same_bytes_however_the_merge_is_interrupted() {
    let expected = uninterrupted();
    for of in [1, 2, 5, 51, 60] {
        let dir = crate::place::folder();
        let parts = Parts::open(&parts(dir.path(), of), false).expect("parts");
        let out = dir.path().join("merged");
        merge(&parts, &out, 1, false).expect("merges");
        assert!(results(&out) == expected, "{of} parts");
        assert!(!out.join("no_case.csv").exists());
        let (out, mut stops) = (dir.path().join("interrupted"), 0);
        while merge(&parts, &out, 2, true).expect("merges") == Ending::Stopped {
            stops += 1;
        }
        assert_eq!(stops, 203 / 16, "one chunk at a time");
        assert!(results(&out) == expected, "{of} parts, interrupted");
    }
}

#[test]
fn a_merge_that_is_stopped_while_it_makes_cases_makes_that_chunk_anew() {
    let dir = crate::place::folder();
    let parts = Parts::open(&parts(dir.path(), 3), false).expect("parts");
    let (config, panel, out) = (config(), counting(), dir.path().join("merged"));
    let mut stops = 0;
    // Each session comes one case further than the one before.
    for cases in 0.. {
        let (stop, made) = (AtomicBool::new(false), AtomicU64::new(0));
        let narrow = |_: &Finding| {
            stop.fetch_or(made.fetch_add(1, Ordering::Relaxed) == cases, Ordering::Relaxed);
            counting()
        };
        let campaign =
            Campaign { config: &config, source: &Counting, panel: &panel, narrow: &narrow, steppers: &[], threads: 1 };
        let identity = parts.identity(Counting.batch_len());
        let mut journal = Journal::open(&out, identity, Start::Resume).expect("opens");
        let merged = campaign.merge(&parts, &mut journal, &stop, &mut |_| {}).expect("merges");
        if merged.ending == Ending::Finished {
            break;
        }
        stops += 1;
    }
    assert!(stops > 1, "{stops} stops");
    assert!(results(&out) == uninterrupted());
}

#[test]
fn a_merge_and_a_campaign_do_not_go_on_with_one_another() {
    let dir = crate::place::folder();
    let parts = Parts::open(&parts(dir.path(), 3), false).expect("parts");
    let out = dir.path().join("out");
    assert_eq!(merge(&parts, &out, 1, true).expect("merges"), Ending::Stopped);
    let run = |out: &Path, stop: bool| {
        with_campaign(1, |campaign| {
            let mut journal = Journal::open(out, config().identity().expect("a map"), Start::Resume).expect("opens");
            let stopped = AtomicBool::new(false);
            campaign.run(&mut journal, &stopped, &mut |_| stopped.store(stop, Ordering::Relaxed))
        })
    };
    assert!(matches!(run(&out, false), Err(RunError::Merging { .. })));
    let begun = dir.path().join("begun");
    assert_eq!(run(&begun, true).expect("runs"), Ending::Stopped);
    let error = merge(&parts, &begun, 1, false).expect_err("not a merge").to_string();
    assert!(error.contains("begun") && error.contains("not being merged"), "{error}");
}

#[test]
fn a_row_tells_the_fingerprint_of_its_finding() {
    let config = CampaignConfig::default();
    let (source, panel) = (source::of(&config).expect("pairs"), builtin::panel(&config.engines, 4).expect("engines"));
    let mut sorts = BTreeSet::new();
    for subject in (0..42).flat_map(|number| source.batch(number)) {
        for finding in examine_pair(&subject, &panel).findings {
            sorts.insert(finding.fingerprint());
            // What is wrong with an external engine is told apart in another way.
            for finding in [Finding { cause: Cause::Engine, ..finding.clone() }, finding] {
                assert_eq!(Fingerprint::of_row(&finding.row(String::new())), finding.fingerprint());
            }
        }
    }
    assert!(sorts.len() > 50, "only {} sorts", sorts.len());
}
