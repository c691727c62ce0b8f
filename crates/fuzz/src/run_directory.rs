//! The directory of a campaign that was damaged: one file exchanged for other bytes, or removed. A run that is taken up again finds what was
//! written, byte by byte, or an error names a file. No file of somebody else is touched.

use crate::Target;
use crate::dice::Dice;
use crate::mutate::mutated;
use crate::reach::Reach;
use crate::scratch::{new_folder, scratch};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::engines::Engines;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::Campaign;
use rockproof_campaign::{source, steps};
use rockproof_differential::finding::Finding;
use rockproof_results::{MANIFEST, Start, digest};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

/// A file of somebody else in the directory.
const THEIRS: (&str, &[u8]) = ("theirs.txt", b"not ours");
/// What an input begins with: the number of the file, and how it is damaged.
const HEAD: usize = 2;
/// The file is removed instead.
const REMOVED: u8 = 1;
/// The bytes get a seal that is right, as by somebody who means harm.
const RESEALED: u8 = 2;
/// What a run goes on from.
const GONE_ON_FROM: [&str; 4] = [MANIFEST, "progress.json", "findings.csv", "step_findings.csv"];

/// What a campaign that was gone on with, or put together, must have made again.
pub(crate) const TABLES: [&str; 6] =
    ["findings.csv", "summary.csv", "agreement.csv", "confusion.csv", "step_findings.csv", "step_summary.csv"];

/// The files of a finished campaign of a few pairs, by name.
pub(crate) fn campaign() -> &'static BTreeMap<String, Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let folder = new_folder();
        let dir = folder.path().join("run");
        run_into(&dir, Start::Fresh).expect("a campaign of a few pairs");
        let mut files = files(&dir, "");
        files.insert(THEIRS.0.to_owned(), THEIRS.1.to_vec());
        files
    })
}

/// The files of a directory and its folders, with `before` in front of their names.
///
/// # Panics
/// When one cannot be read.
pub fn files(dir: &Path, before: &str) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(dir).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = format!("{before}{}", path.file_name().expect("a name").to_string_lossy());
        match path.is_dir() {
            true => found.extend(files(&path, &format!("{name}/"))),
            false => drop(found.insert(name, fs::read(&path).expect("a file"))),
        }
    }
    found
}

/// What the campaign is asked.
pub(crate) fn config() -> CampaignConfig {
    CampaignConfig {
        pairs: 32,
        chunk: 16,
        families: ["edge_cross", "sliver"].map(str::to_owned).to_vec(),
        tolerances: vec!["auto".to_owned()],
        metamorphic_every: 0,
        steps_every: 4,
        cases_per_cause: 2,
        shrink_evaluations: 1,
        ..CampaignConfig::default()
    }
}

/// Does something with the campaign, which is ready to go.
pub(crate) fn with_campaign<T>(work: impl FnOnce(&Campaign<'_>, Map<String, Value>) -> T) -> T {
    let config = config();
    let engines = Engines::of(&config).expect("the built-in engines");
    let source = source::of(&config).expect("a family");
    let (panel, narrow) = (engines.panel(), |finding: &Finding| engines.panel_for(finding));
    let steppers = steps::engines(engines.names().iter().map(String::as_str));
    let campaign =
        Campaign { config: &config, source: &source, panel: &panel, narrow: &narrow, steppers: &steppers, threads: 1 };
    work(&campaign, source::identity(&config).expect("a map"))
}

/// Begins the campaign, or goes on with it.
fn run_into(dir: &Path, start: Start) -> Result<(), String> {
    with_campaign(|campaign, identity| {
        let mut journal = Journal::open(dir, identity, start).map_err(|error| error.to_string())?;
        campaign.run(&mut journal, &AtomicBool::new(false), &mut |_| {}).map_err(|error| error.to_string())?;
        Ok(())
    })
}

/// A JSON object with a seal that is right, if it looks like one that had one.
pub(crate) fn resealed(bytes: &[u8]) -> Vec<u8> {
    let mark = b",\"sha256\":\"";
    let place = bytes.windows(mark.len()).rposition(|window| window == mark);
    let body = &bytes[..place.unwrap_or(bytes.len())];
    [body, mark, digest(body).as_bytes(), b"\"}\n"].concat()
}

/// What an input does to a directory.
pub(crate) struct Damage {
    /// The file.
    pub(crate) name: &'static str,
    /// None where the file is removed.
    pub(crate) bytes: Option<Vec<u8>>,
    /// Whether its seal is right.
    pub(crate) resealed: bool,
}

impl Damage {
    /// The damage that bytes say; none if there are too few.
    pub(crate) fn of(bytes: &[u8], names: &[&'static str]) -> Option<Damage> {
        let ([number, how], given) = (bytes.first_chunk::<HEAD>()?, &bytes[HEAD..]);
        let name = names[usize::from(*number) % names.len()];
        let (removed, reseal) = (how & REMOVED != 0, how & RESEALED != 0);
        let bytes = if reseal { resealed(given) } else { given.to_vec() };
        Some(Damage { name, bytes: (!removed).then_some(bytes), resealed: reseal && !removed })
    }

    /// Does it.
    pub(crate) fn apply(&self, dir: &Path) {
        let path = dir.join(self.name);
        match &self.bytes {
            None => drop(fs::remove_file(path)),
            Some(bytes) => fs::write(path, bytes).expect("a damaged file"),
        }
    }
}

/// The directory anew, of such files.
pub(crate) fn write(dir: &Path, files: &BTreeMap<String, Vec<u8>>) {
    drop(fs::remove_dir_all(dir));
    for (name, bytes) in files {
        let path = dir.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    }
}

/// The campaign goes on: nothing is left to do, so all it does is look at what is there and write its last tables again.
pub(crate) fn run_directory(bytes: &[u8], reach: &mut Reach) {
    let Some(damage) = Damage::of(bytes, &GONE_ON_FROM) else { return reach.count("too-short") };
    let dir = scratch().join("resumed");
    write(&dir, campaign());
    damage.apply(&dir);
    match run_into(&dir, Start::Resume) {
        Ok(()) => {
            let found = files(&dir, "");
            for name in TABLES {
                let whole = found.get(name) == campaign().get(name);
                assert!(whole || damage.resealed, "{} was believed: {name} is another one", damage.name);
            }
            reach.count(if damage.resealed { "resealed-read" } else { "whole" });
        }
        Err(message) => {
            assert!(message.contains(&*dir.to_string_lossy()), "no file is named: {message}");
            let kinds = [("expected", "expected"), ("seal", "seal"), ("missing", "missing"), ("as it was", "changed")];
            let kind = kinds.iter().find(|(part, _)| message.contains(part)).map_or("refused", |(_, kind)| kind);
            reach.count(kind);
        }
    }
    assert_eq!(fs::read(dir.join(THEIRS.0)).ok().as_deref(), Some(THEIRS.1), "a file of somebody else");
}

/// An input that damages one of the files, mostly a little.
pub(crate) fn input(names: &[&str], files: &BTreeMap<String, Vec<u8>>, dice: &mut Dice) -> Vec<u8> {
    let number = dice.below(names.len());
    let content = |name: &str| files.get(name).map_or(&[][..], Vec::as_slice);
    let other = content(names[dice.below(names.len())]);
    let how = match dice.below(12) {
        0 => REMOVED,
        1..=4 => RESEALED,
        _ => 0,
    };
    let mut bytes = vec![number as u8, how];
    match dice.below(8) {
        0 => bytes.extend_from_slice(other),
        1 => bytes.extend(std::iter::repeat_n(0, dice.below(500))),
        2 => bytes.extend_from_slice(content(names[number])),
        _ => bytes.extend(mutated(content(names[number]), other, dice)),
    }
    bytes
}

/// An input of [`run_directory`].
pub(crate) fn run_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    input(&GONE_ON_FROM, campaign(), dice)
}
