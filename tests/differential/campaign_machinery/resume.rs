//! Pins that a campaign writes the same bytes whatever interrupts it: stops between chunks, a torn tail of
//! `findings.csv`, a lost rename, any number of threads. Answers are toys; only the machinery is tested.

use super::scripted::{Counting, counting};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::{Campaign, Ending};
use rockproof_differential::finding::Finding;
use rockproof_results::{ResultsError, Start};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn config() -> CampaignConfig {
    CampaignConfig { pairs: 203, chunk: 16, shrink_evaluations: 20, ..CampaignConfig::default() }
}

/// Runs for at most `chunks` chunks.
fn run(
    dir: &Path,
    config: &CampaignConfig,
    start: Start,
    threads: usize,
    chunks: usize,
) -> Result<Ending, ResultsError> {
    let panel = counting();
    let narrow = |_: &Finding| counting();
    let campaign = Campaign { config, source: &Counting, panel: &panel, narrow: &narrow, steppers: &[], threads };
    let mut journal = Journal::open(dir, config.identity().expect("a map"), start)?;
    let stop = AtomicBool::new(chunks == 0);
    let mut done = 0;
    let ending = campaign.run(&mut journal, &stop, &mut |_| {
        done += 1;
        stop.store(done >= chunks, Ordering::Relaxed);
    });
    Ok(ending.expect("the directory can be written"))
}

/// Every file that must not depend on how a run went.
pub(crate) fn results(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for name in ["findings.csv", "summary.csv", "agreement.csv", "confusion.csv"] {
        files.insert(name.to_owned(), fs::read(dir.join(name)).expect(name));
    }
    for entry in fs::read_dir(dir.join("cases")).expect("cases") {
        let path = entry.expect("entry").path();
        files
            .insert(path.file_name().expect("a name").to_string_lossy().into_owned(), fs::read(&path).expect("a case"));
    }
    files
}

pub(crate) fn uninterrupted() -> BTreeMap<String, Vec<u8>> {
    let dir = crate::place::folder();
    assert_eq!(run(dir.path(), &config(), Start::Fresh, 1, usize::MAX).expect("runs"), Ending::Finished);
    results(dir.path())
}

#[test]
fn finds_what_it_must_and_no_more() {
    let results = uninterrupted();
    let findings = String::from_utf8(results["findings.csv"].clone()).expect("text");
    // 0..203 holds 29 multiples of 7, and 19 of 11 of which 3 are multiples of 77.
    assert_eq!(findings.lines().count(), 1 + 29 + 16);
    assert!(findings.lines().any(|l| l.starts_with("198,three,random,toy,mistaken,arithmetic,gap-sign,v-v,v-v,")));
    assert_eq!(results.len(), 4 + 4, "one case for each family and change");
    let summary = String::from_utf8(results["summary.csv"].clone()).expect("text");
    assert!(summary.contains("three,random,toy,68,mistaken,arithmetic,missing,v-v,10"), "{summary}");
}

#[test]
fn two_threads_write_what_one_writes() {
    let dir = crate::place::folder();
    run(dir.path(), &config(), Start::Fresh, 2, usize::MAX).expect("runs");
    assert!(results(dir.path()) == uninterrupted());
}

#[test]
fn resumed_runs_write_the_same_bytes() {
    let expected = uninterrupted();
    for chunks in [0, 1, 5, 12] {
        let dir = crate::place::folder();
        assert_eq!(run(dir.path(), &config(), Start::Resume, 2, chunks).expect("runs"), Ending::Stopped);
        // What a kill leaves behind: rows after the last commit, half a case, a file that was not renamed.
        let mut findings = fs::OpenOptions::new().append(true).open(dir.path().join("findings.csv")).expect("open");
        findings.write_all(b"999,three,random,toy,mis").expect("write");
        fs::write(dir.path().join("progress.part"), b"{\"configur").expect("write");
        fs::write(dir.path().join("cases/half.part"), b"[ca").expect("write");
        assert_eq!(run(dir.path(), &config(), Start::Resume, 1, usize::MAX).expect("runs"), Ending::Finished);
        fs::remove_file(dir.path().join("cases/half.part")).expect("still there");
        assert!(results(dir.path()) == expected, "stopped after {chunks} chunks");
        // Resuming a finished run changes nothing.
        assert_eq!(run(dir.path(), &config(), Start::Resume, 1, usize::MAX).expect("runs"), Ending::Finished);
        assert!(fs::read(dir.path().join("findings.csv")).expect("read") == expected["findings.csv"]);
    }
}

#[test]
fn another_run_is_neither_overwritten_nor_continued() {
    let dir = crate::place::folder();
    run(dir.path(), &config(), Start::Fresh, 1, 2).expect("runs");
    let error = run(dir.path(), &config(), Start::Fresh, 1, 1).expect_err("occupied");
    assert!(matches!(error, ResultsError::Occupied { .. }));
    let other = CampaignConfig { seed: 7, pairs: 99, ..config() };
    let error = run(dir.path(), &other, Start::Resume, 1, 1).expect_err("other configuration").to_string();
    assert!(error.contains("seed: the run has 1, asked for is 7"), "{error}");
    assert!(error.contains("pairs: the run has 203, asked for is 99"), "{error}");
    run(dir.path(), &other, Start::Overwrite, 1, usize::MAX).expect("overwritten");
    assert_eq!(fs::read_to_string(dir.path().join("findings.csv")).expect("read").lines().count(), 1 + 15 + 7);
}

#[test]
fn damaged_runs_are_not_guessed_at() {
    let dir = crate::place::folder();
    run(dir.path(), &config(), Start::Fresh, 1, 2).expect("runs");
    fs::write(dir.path().join("findings.csv"), b"index\n").expect("write");
    assert!(matches!(run(dir.path(), &config(), Start::Resume, 1, 1), Err(ResultsError::Damaged { .. })));
    fs::write(dir.path().join("progress.json"), b"{").expect("write");
    assert!(matches!(run(dir.path(), &config(), Start::Resume, 1, 1), Err(ResultsError::Damaged { .. })));
}
