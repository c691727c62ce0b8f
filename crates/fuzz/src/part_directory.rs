//! The parts of a campaign, a file of one of them damaged, put together: the tables are those of the whole campaign, or an error names a file.

use crate::Target;
use crate::dice::Dice;
use crate::reach::Reach;
use crate::run_directory::{Damage, TABLES, campaign, files, input, with_campaign, write};
use crate::scratch::{new_folder, scratch};
use rockproof_campaign::journal::Journal;
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::{Machine, Part};
use rockproof_results::{MANIFEST, Start};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

/// What parts are put together from.
const PUT_TOGETHER: [&str; 5] = [MANIFEST, "progress.json", "findings.csv", "step_findings.csv", "no_case.csv"];
/// How many parts there are; the first one is damaged.
const PARTS: u64 = 2;

/// The machine that the parts say they were made on.
fn machine() -> Machine {
    Machine { os: "an os".to_owned(), architecture: "an architecture".to_owned(), answers: "answers".to_owned() }
}

/// The files of each part.
fn parts() -> &'static [BTreeMap<String, Vec<u8>>] {
    static PARTS_MADE: OnceLock<Vec<BTreeMap<String, Vec<u8>>>> = OnceLock::new();
    PARTS_MADE.get_or_init(|| {
        let folder = new_folder();
        (1..=PARTS).map(|number| made(&folder.path().join(number.to_string()), number)).collect()
    })
}

fn made(dir: &Path, number: u64) -> BTreeMap<String, Vec<u8>> {
    let part: Part = format!("{number}/{PARTS}").parse().expect("a part");
    with_campaign(|campaign, identity| {
        let mut journal = Journal::open_part(dir, identity, Start::Fresh, part, machine()).expect("a directory");
        campaign.run_part(part, &mut journal, &AtomicBool::new(false), &mut |_| {}).expect("a part");
    });
    files(dir, "")
}

/// Puts the parts together as `merge` does, or says why not: the kind and the message.
fn merged(dirs: &[PathBuf], out: &Path) -> Result<(), (String, String)> {
    with_campaign(|campaign, identity| {
        let batch_len = campaign.source.batch_len();
        let parts = Parts::open(dirs, false).and_then(|parts| {
            parts.check(&identity, &machine(), batch_len)?;
            (0..parts.len()).try_for_each(|place| parts.check_tables(place))?;
            Ok(parts)
        });
        let parts = parts.map_err(|error| (Reach::variant(&error), error.to_string()))?;
        let mut journal = Journal::open(out, parts.identity(batch_len), Start::Fresh).expect("a new directory");
        let made = campaign.merge(&parts, &mut journal, &AtomicBool::new(false), &mut |_| {});
        made.map(drop).map_err(|error| (format!("merge-{}", Reach::variant(&error)), error.to_string()))
    })
}

/// Parts are put together.
pub(crate) fn part_directory(bytes: &[u8], reach: &mut Reach) {
    let Some(damage) = Damage::of(bytes, &PUT_TOGETHER) else { return reach.count("too-short") };
    let place = scratch().join("parts");
    let dirs: Vec<PathBuf> = (1..=PARTS).map(|number| place.join(number.to_string())).collect();
    for (dir, files) in dirs.iter().zip(parts()) {
        write(dir, files);
    }
    damage.apply(&dirs[0]);
    let out = scratch().join("merged");
    drop(fs::remove_dir_all(&out));
    match merged(&dirs, &out) {
        Ok(()) => {
            for name in TABLES {
                let whole = fs::read(out.join(name)).ok().as_ref() == campaign().get(name);
                assert!(whole || damage.resealed, "{} was believed: {name} is another one", damage.name);
            }
            reach.count(if damage.resealed { "resealed-read" } else { "whole" });
        }
        Err((kind, message)) => {
            assert!(message.contains(&*place.to_string_lossy()), "no file is named: {message}");
            assert!(message.len() < 8_000, "a message of {} bytes: {message}", message.len());
            reach.count(kind);
        }
    }
}

/// An input of [`part_directory`].
pub(crate) fn part_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    input(&PUT_TOGETHER, &parts()[0], dice)
}
