//! The parts to be put together, and whether they are those of one campaign.

use crate::config::CampaignConfig;
use crate::journal::{CampaignProgress, FINDINGS, NO_CASE, PROGRESS, STEP_FINDINGS};
use crate::part::{Machine, Part, PartProgress};
use rockproof_results::{Owner, ResultsError, View, setting_text};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why directories are no parts of one campaign.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A directory cannot be read, or is damaged.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A campaign of all its pairs.
    #[error(
        "{dir} holds a whole campaign, or a merged one, and no part of one: parts are made by `rockproof campaign --part K/N`"
    )]
    Whole {
        /// The directory.
        dir: PathBuf,
    },
    /// A part of another version.
    #[error("{dir} was made by version {found}, and this is {}: parts are merged by the version that made them", env!("CARGO_PKG_VERSION"))]
    Version {
        /// The directory.
        dir: PathBuf,
        /// Its version.
        found: String,
    },
    /// A part of another number of parts.
    #[error("{dir} is part {part}, and {first} is part {first_part}: parts of one campaign are of one number of parts")]
    Split {
        /// The directory.
        dir: PathBuf,
        /// Which part it holds.
        part: Part,
        /// The first directory.
        first: PathBuf,
        /// Which part that holds.
        first_part: Part,
    },
    /// A part given twice.
    #[error("part {part} is there twice, in {} and {}", dirs[0].display(), dirs[1].display())]
    Twice {
        /// Which part.
        part: Part,
        /// Where it is.
        dirs: [PathBuf; 2],
    },
    /// Parts of campaigns that were started otherwise.
    #[error("{dir} (part {part}) and {first} (part {first_part}) are of different campaigns:\n  {}", differences.join("\n  "))]
    Configuration {
        /// The directory.
        dir: PathBuf,
        /// Which part it holds.
        part: Part,
        /// The first directory.
        first: PathBuf,
        /// Which part that holds.
        first_part: Part,
        /// One line for each key that differs.
        differences: Vec<String>,
    },
    /// A configuration that is none of this version.
    #[error("{dir}: the configuration of the part cannot be read: {source}")]
    Unreadable {
        /// The directory.
        dir: PathBuf,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// The parts were made from other input files than are here.
    #[error("the parts cannot be merged with the files that are here:\n  {}", differences.join("\n  "))]
    Inputs {
        /// One line for each key that differs.
        differences: Vec<String>,
    },
    /// Two machines answer differently.
    #[error(
        "{dir} (part {part}, {machine}) and {other} answer the first pairs differently, so their findings do not go together: make the parts with one build of the program, on machines of one kind"
    )]
    Machines {
        /// The directory.
        dir: PathBuf,
        /// Which part it holds.
        part: Part,
        /// Where it was made.
        machine: String,
        /// The other part, or this program.
        other: String,
    },
    /// Parts that are not there.
    #[error("of {of} parts {missing} missing; make and name them as well, or merge what is there with --partial")]
    Missing {
        /// How many parts there are.
        of: u64,
        /// Which are not there: `2, 5 and 11 more are`.
        missing: String,
    },
    /// A part that has not ended.
    #[error(
        "part {part} in {dir} has done {done} of its {pairs} pairs: finish it with `rockproof campaign` as it was started and --resume, or merge what is there with --partial"
    )]
    Unfinished {
        /// The directory.
        dir: PathBuf,
        /// Which part it holds.
        part: Part,
        /// Pairs done.
        done: u64,
        /// Its pairs.
        pairs: u64,
    },
    /// A directory that was begun in another way is to be gone on with.
    #[error("{dir} holds a campaign that is not being merged: --overwrite discards it, --out DIR writes elsewhere")]
    NoMerge {
        /// The directory.
        dir: PathBuf,
    },
    /// A row that cannot be read, although the file is as it was written.
    #[error("{file}: {source}")]
    Row {
        /// The file.
        file: PathBuf,
        /// What is wrong, with its line.
        source: csv::Error,
    },
}

/// A part on disk.
#[derive(Debug)]
pub(super) struct OnePart {
    pub(super) view: View,
    pub(super) part: Part,
    /// What its journal held when it was opened.
    pub(super) progress: CampaignProgress,
}

/// Parts of one campaign, all of them or some, in the order of their pairs.
#[derive(Debug)]
pub struct Parts {
    pub(super) parts: Vec<OnePart>,
    config: CampaignConfig,
    /// The configuration that they have in common.
    configuration: Map<String, Value>,
    of: u64,
    partial: bool,
}

/// How many parts an error lists.
const LISTED: usize = 12;

impl Parts {
    /// The key of the parts in the configuration of a directory that is made of some of them.
    pub const KEY: &'static str = "parts";

    /// Opens the directories, some of which may not be there or not be finished if the merge is to be `partial`.
    ///
    /// # Errors
    /// When one is no part, or they are not of one campaign; when one is given twice; when one is missing.
    pub fn open(dirs: &[PathBuf], partial: bool) -> Result<Parts, MergeError> {
        let mut parts: Vec<OnePart> = dirs.iter().map(|dir| OnePart::open(dir)).collect::<Result<_, _>>()?;
        let Some(first) = parts.first() else {
            return Err(MergeError::Missing { of: 0, missing: "all are".to_owned() });
        };
        for other in &parts[1..] {
            other.goes_with(first)?;
        }
        let (of, configuration) = (first.part.of(), first.configuration());
        let dir = first.dir().to_owned();
        let config = config_of(&configuration).map_err(|source| MergeError::Unreadable { dir, source })?;
        parts.sort_by_key(|part| part.part);
        if let Some(two) = parts.windows(2).find(|two| two[0].part == two[1].part) {
            let dirs = [two[0].dir().to_owned(), two[1].dir().to_owned()];
            return Err(MergeError::Twice { part: two[0].part, dirs });
        }
        let there: BTreeSet<u64> = parts.iter().map(|part| part.part.number()).collect();
        let absent = of - there.len() as u64;
        if absent > 0 && !partial {
            let missing: Vec<String> =
                (1..=of).filter(|number| !there.contains(number)).take(LISTED).map(|n| n.to_string()).collect();
            let more = absent - missing.len() as u64;
            let verb = if absent == 1 { "is" } else { "are" };
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            return Err(MergeError::Missing { of, missing: format!("{}{more} {verb}", missing.join(", ")) });
        }
        Ok(Parts { parts, config, configuration, of, partial })
    }

    /// What the campaign was asked to do.
    pub fn config(&self) -> &CampaignConfig {
        &self.config
    }

    /// How many parts there are here.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Checks the parts against what is here: what the campaign's `identity` is with the input files here, how this machine answers, and, with
    /// the length of the source's batches, whether each part is finished.
    ///
    /// # Errors
    /// When something differs; when a part is not finished and the merge is to be whole.
    pub fn check(&self, identity: &Map<String, Value>, here: &Machine, batch_len: u64) -> Result<(), MergeError> {
        let differences = differences(&self.configuration, identity, "in the parts", "here");
        if !differences.is_empty() {
            return Err(MergeError::Inputs { differences });
        }
        for part in &self.parts {
            let machine = part.state().map(|state| &state.machine);
            if let Some(machine) = machine.filter(|machine| machine.answers != here.answers) {
                let other = format!("this program on {here}");
                let (dir, part, machine) = (part.dir().to_owned(), part.part, machine.to_string());
                return Err(MergeError::Machines { dir, part, machine, other });
            }
            let pairs = part.part.pairs(self.config.pairs, batch_len);
            let (done, pairs) = (part.progress.pairs_done, pairs.end - pairs.start);
            if done > pairs {
                let what = format!("{done} pairs are done, but the part has only {pairs}");
                return Err(ResultsError::damaged(&part.dir().join(PROGRESS), what).into());
            }
            if done < pairs && !self.partial {
                return Err(MergeError::Unfinished { dir: part.dir().to_owned(), part: part.part, done, pairs });
            }
        }
        Ok(())
    }

    /// Reads the tables of the part at a place, to see that they are as they were written.
    ///
    /// # Errors
    /// When one is not.
    pub fn check_tables(&self, place: usize) -> Result<(), MergeError> {
        let Some(part) = self.parts.get(place) else { return Ok(()) };
        for (name, seal) in part.tables() {
            part.view.check_table(name, seal)?;
        }
        Ok(())
    }

    /// Whether a directory is one of the parts.
    pub fn hold(&self, dir: &Path) -> bool {
        let same = |part: &OnePart| matches!((part.dir().canonicalize(), dir.canonicalize()), (Ok(one), Ok(other)) if one == other);
        self.parts.iter().any(same)
    }

    /// Whether all parts are there, with all their pairs.
    pub(super) fn is_whole(&self, batch_len: u64) -> bool {
        self.parts.len() as u64 == self.of && self.parts.iter().all(|part| part.is_done(&self.config, batch_len))
    }

    /// The configuration of the directory that is made of them: that of the whole campaign, or one that says which parts it has, so that
    /// nobody takes it for the whole.
    pub fn identity(&self, batch_len: u64) -> Map<String, Value> {
        let mut configuration = self.configuration.clone();
        if !self.is_whole(batch_len) {
            configuration.insert(Parts::KEY.to_owned(), self.part_list(batch_len).into());
        }
        configuration
    }

    /// Which parts there are: `1, 2 (unfinished), 4 of 7`.
    fn part_list(&self, batch_len: u64) -> String {
        let one = |part: &OnePart| {
            let unfinished = if part.is_done(&self.config, batch_len) { "" } else { " (unfinished)" };
            format!("{}{unfinished}", part.part.number())
        };
        format!("{} of {}", self.parts.iter().map(one).collect::<Vec<_>>().join(", "), self.of)
    }

    /// What `run.json` says of the parts.
    pub(super) fn json(&self, batch_len: u64) -> Value {
        let mut machines: BTreeMap<String, u64> = BTreeMap::new();
        for state in self.parts.iter().filter_map(OnePart::state) {
            *machines.entry(state.machine.to_string()).or_default() += 1;
        }
        serde_json::json!({ "there": self.part_list(batch_len), "machines": machines })
    }
}

impl OnePart {
    fn open(dir: &Path) -> Result<OnePart, MergeError> {
        /// What any version writes.
        #[derive(Deserialize)]
        struct AnyVersion {
            configuration: Map<String, Value>,
        }
        let view = View::open(dir, Owner::Campaign)?;
        let AnyVersion { configuration } = view.read_sealed(PROGRESS)?;
        let text = |key: &str| configuration.get(key).and_then(Value::as_str);
        let version = text("version").unwrap_or("that it does not say");
        if version != env!("CARGO_PKG_VERSION") {
            return Err(MergeError::Version { dir: dir.to_owned(), found: version.to_owned() });
        }
        let part = text(Part::KEY).and_then(|part| part.parse().ok());
        let part = part.ok_or_else(|| MergeError::Whole { dir: dir.to_owned() })?;
        let progress: CampaignProgress = view.read_sealed(PROGRESS)?;
        if progress.part.is_none() {
            let what = "it does not say where the part was made: the campaign was killed before its first pair, or is just beginning";
            return Err(ResultsError::damaged(&dir.join(PROGRESS), what).into());
        }
        Ok(OnePart { view, part, progress })
    }

    fn dir(&self) -> &Path {
        self.view.path()
    }

    fn state(&self) -> Option<&PartProgress> {
        self.progress.part.as_ref()
    }

    fn is_done(&self, config: &CampaignConfig, batch_len: u64) -> bool {
        let pairs = self.part.pairs(config.pairs, batch_len);
        self.progress.pairs_done == pairs.end - pairs.start
    }

    /// The configuration of the campaign that this is a part of.
    fn configuration(&self) -> Map<String, Value> {
        let mut configuration = self.progress.configuration.clone();
        configuration.remove(Part::KEY);
        configuration
    }

    fn goes_with(&self, first: &OnePart) -> Result<(), MergeError> {
        let (dir, part) = (self.dir().to_owned(), self.part);
        let (first_dir, first_part) = (first.dir().to_owned(), first.part);
        if part.of() != first_part.of() {
            return Err(MergeError::Split { dir, part, first: first_dir, first_part });
        }
        let differences = differences(&self.configuration(), &first.configuration(), "there", "here");
        if !differences.is_empty() {
            return Err(MergeError::Configuration { dir, part, first: first_dir, first_part, differences });
        }
        if let (Some(one), Some(other)) = (self.state(), first.state())
            && one.machine.answers != other.machine.answers
        {
            let other = format!("{} (part {first_part}, {})", first_dir.display(), other.machine);
            return Err(MergeError::Machines { dir, part, machine: one.machine.to_string(), other });
        }
        Ok(())
    }

    /// Its tables, with what was sealed of them.
    pub(super) fn tables(&self) -> Vec<(&'static str, &rockproof_results::Seal)> {
        let no_case = self.state().and_then(|state| state.no_case.as_ref());
        let all = [
            (FINDINGS, Some(&self.progress.findings)),
            (STEP_FINDINGS, self.progress.step_findings.as_ref()),
            (NO_CASE, no_case),
        ];
        all.into_iter().filter_map(|(name, seal)| Some((name, seal?))).collect()
    }
}

/// The settings of a campaign out of its identity.
fn config_of(identity: &Map<String, Value>) -> Result<CampaignConfig, serde_json::Error> {
    let is_setting = |key: &str| key != "version" && !key.starts_with(crate::source::CONTENT);
    let settings = identity.iter().filter(|(key, _)| is_setting(key));
    serde_json::from_value(settings.map(|(key, value)| (key.clone(), value.clone())).collect::<Map<_, _>>().into())
}

/// One line for each key in which two configurations differ.
fn differences(one: &Map<String, Value>, other: &Map<String, Value>, of_one: &str, of_other: &str) -> Vec<String> {
    let keys: BTreeSet<&String> = one.keys().chain(other.keys()).collect();
    keys.into_iter()
        .filter(|key| one.get(*key) != other.get(*key))
        .map(|key| {
            format!("{key}: {} {of_one}, {} {of_other}", setting_text(one.get(key)), setting_text(other.get(key)))
        })
        .collect()
}
