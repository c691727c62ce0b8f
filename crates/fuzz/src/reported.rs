//! What reports and gates count, one file damaged: it is read, or an error names the file.

mod tables;

use crate::Target;
use crate::dice::Dice;
use crate::reach::Reach;
use crate::readers::LONGEST_MESSAGE;
use crate::run_directory::{Damage, campaign, input, write};
use crate::scratch::{new_folder, scratch};
use crate::simulation_directory::begun;
use rockproof_gate::tally::CampaignTally;
use rockproof_report::load::Results;
use std::collections::BTreeMap;
use std::fmt::{Debug, Display};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tables::{BENCH, DIAGNOSIS, DIFFERENCES, ENGINES, LIMITS, LOCKSTEP, STEPS, STRESS};

/// The files of directories, by directory and name.
type Files = BTreeMap<String, Vec<u8>>;

/// All that reports read, by directory and name.
const REPORTED: [&str; 14] = [
    "campaign/run.json",
    "campaign/findings.csv",
    "campaign/agreement.csv",
    "campaign/confusion.csv",
    "campaign/step_summary.csv",
    "campaign/diagnosis.csv",
    "simulated/run.json",
    "simulated/checkpoint.jsonl",
    "simulated/lockstep.csv",
    "simulated/differences.csv",
    "stress/stress.csv",
    "stress/limits.csv",
    "stress/steps.csv",
    "bench/bench.csv",
];
/// What they name the version in that made the run.
const VERSIONED: [&str; 2] = ["campaign/run.json", "simulated/run.json"];
/// All that a gate reads of a campaign.
const TALLIED: [&str; 5] = [
    "campaign/findings.csv",
    "campaign/step_findings.csv",
    "campaign/summary.csv",
    "campaign/step_summary.csv",
    "campaign/engines.csv",
];

/// One directory of each sort that reports are made of. Those of a campaign and of a simulation were made; what an engine from outside, the
/// exact side, a stress set and measurements add to them stands in [`tables`].
fn undamaged() -> &'static Files {
    static FILES: OnceLock<Files> = OnceLock::new();
    FILES.get_or_init(|| {
        let made = |sort: &str, files: &Files| -> Files {
            files.iter().map(|(name, bytes)| (format!("{sort}/{name}"), bytes.clone())).collect()
        };
        let mut files = made("campaign", campaign());
        files.extend(made("simulated", begun()));
        let tables = [
            ("campaign/diagnosis.csv", DIAGNOSIS),
            ("campaign/engines.csv", ENGINES),
            ("simulated/lockstep.csv", LOCKSTEP),
            ("simulated/differences.csv", DIFFERENCES),
            ("stress/stress.csv", STRESS),
            ("stress/limits.csv", LIMITS),
            ("stress/steps.csv", STEPS),
            ("bench/bench.csv", BENCH),
        ];
        files.extend(tables.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())));
        files.retain(|name, _| REPORTED.contains(&name.as_str()) || TALLIED.contains(&name.as_str()));
        check(&files);
        files
    })
}

/// Every table of the undamaged directories is read, and has rows, so that damage meets something.
fn check(files: &Files) {
    let folder = new_folder();
    write(folder.path(), files);
    let dirs: Vec<PathBuf> = ["campaign", "simulated", "stress", "bench"].map(|sort| folder.path().join(sort)).into();
    let results = Results::read(&dirs).unwrap_or_else(|error| panic!("undamaged: {error}"));
    let ([campaign], [lockstep], [_], [stress], [timing]) = (
        &results.campaigns[..],
        &results.locksteps[..],
        &results.motions[..],
        &results.stresses[..],
        &results.timings[..],
    ) else {
        panic!("undamaged, of each sort one: {results:?}");
    };
    let rows = [
        campaign.agreement.len(),
        campaign.confusion.len(),
        campaign.steps.len(),
        campaign.diagnosis.len(),
        lockstep.points.len(),
        lockstep.sorts.len(),
        stress.cells.len(),
        stress.limits.len(),
        stress.steps.len(),
        timing.measurements.len(),
    ];
    assert!(campaign.tally.total > 0 && rows.iter().all(|rows| *rows > 0), "undamaged, rows: {rows:?}");
    let tally = CampaignTally::read(&dirs[0]).unwrap_or_else(|error| panic!("undamaged: {error}"));
    let steps = tally.rows.iter().filter(|row| row.is_of_step()).count();
    assert!((1..tally.rows.len()).contains(&steps) && !tally.engines.is_empty(), "undamaged: {tally:?}");
}

/// The directory of the damaged file, and what is read of it or said why not.
fn damaged<T, E: Debug + Display>(
    bytes: &[u8],
    names: &[&'static str],
    reach: &mut Reach,
    read: impl FnOnce(&Path) -> Result<T, E>,
) -> Option<T> {
    let Some(damage) = Damage::of(bytes, names) else {
        reach.count("too-short");
        return None;
    };
    let sort = damage.name.split('/').next().unwrap_or_default();
    let place = scratch().join("reported");
    let of_sort = undamaged().iter().filter(|(name, _)| name.split('/').next() == Some(sort));
    write(&place, &of_sort.map(|(name, bytes)| (name.clone(), bytes.clone())).collect());
    damage.apply(&place);
    let dir = place.join(sort);
    match read(&dir) {
        Ok(found) => {
            reach.count("read");
            Some(found)
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains(&*dir.to_string_lossy()), "no file is named: {message}");
            assert!(message.len() < LONGEST_MESSAGE, "a message of {} bytes: {message}", message.len());
            // Which file it was as well: a target that misses one would reach the same errors by the others.
            reach.count(Reach::variant(&error));
            reach.count(format!("{}-{}", Reach::variant(&error), damage.name));
            None
        }
    }
}

/// A report of one directory.
pub(crate) fn report(bytes: &[u8], reach: &mut Reach) {
    damaged(bytes, &REPORTED, reach, |dir| Results::read(&[dir.to_owned()]));
}

/// A campaign counted as gates do it.
pub(crate) fn tally_directory(bytes: &[u8], reach: &mut Reach) {
    let tally = damaged(bytes, &TALLIED, reach, CampaignTally::read);
    drop(tally.map(|tally| tally.examined_by_family()));
}

/// An input of [`report`].
pub(crate) fn report_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    if dice.once_in(12) { of_other_version(dice) } else { input(&REPORTED, undamaged(), dice) }
}

/// A run that another version made, or one that differs in its last figure alone. Damage to any byte seldom meets the version.
fn of_other_version(dice: &mut Dice) -> Vec<u8> {
    let name = *dice.one_of(&VERSIONED);
    let text = undamaged().get(name).map(|bytes| String::from_utf8_lossy(bytes)).unwrap_or_default();
    let version = [0; 3].map(|_| dice.below(2).to_string()).join(".");
    let number = REPORTED.iter().position(|other| *other == name).unwrap_or_default();
    let text = text.replace(&format!("\"{}\"", env!("CARGO_PKG_VERSION")), &format!("\"{version}\""));
    [&[number as u8, 0], text.as_bytes()].concat()
}

/// An input of [`tally_directory`].
pub(crate) fn tally_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    if dice.once_in(12) { with_other_count(dice) } else { input(&TALLIED, undamaged(), dice) }
}

/// A row of `summary.csv` that counts other pairs than the rest of its origin. Damage to any byte seldom leaves such a table readable.
fn with_other_count(dice: &mut Dice) -> Vec<u8> {
    const SUMMARY: &str = "campaign/summary.csv";
    let text = undamaged().get(SUMMARY).map(|bytes| String::from_utf8_lossy(bytes)).unwrap_or_default();
    let mut rows: Vec<Vec<&str>> = text.lines().map(|row| row.split(',').collect()).collect();
    let (row, pairs) = (dice.below(rows.len()), dice.below(40).to_string());
    let place = rows[0].iter().position(|column| *column == "pairs").unwrap_or_default();
    rows[row][place] = &pairs;
    let text: String = rows.iter().map(|row| row.join(",") + "\n").collect();
    let number = TALLIED.iter().position(|name| *name == SUMMARY).unwrap_or_default();
    [&[number as u8, 0], text.as_bytes()].concat()
}
