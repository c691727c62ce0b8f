//! A comparison on disk: what it counted so far, so that it can be killed at any moment and go on.
//!
//! Rows of `disagreements.csv` are appended and made durable; then `comparison.json`, which seals them and holds every count, is replaced in one step.

use super::compare::BatchResult;
use super::disagreement::{DISAGREEMENT_COLUMNS, Disagreement};
use super::tally::Totals;
use rockproof_campaign::part::Part;
use rockproof_model::{Number, ToleranceSet, Vec3};
use rockproof_pairs::batch::{BATCH, PairConfig, batch};
use rockproof_results::{
    AppendedTable, Claim, Directory, FileKind, Owner, ResultsError, Seal, Start, digest, identity_differences,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// What is to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ComparisonPlan {
    /// Chooses the pairs, as in a campaign.
    pub seed: u64,
    /// How many pairs: whole batches.
    pub pairs: u64,
    /// The plain path in pure Rust rationals joins in one round of all families in so many; 0 for never.
    pub plain_every: u64,
    /// The same of the plain path in GMP's rationals.
    pub gmp_every: u64,
    /// Which share of the pairs; all of them if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
}

impl ComparisonPlan {
    /// The pairs of this share, by their numbers.
    pub fn share(&self) -> Range<u64> {
        self.part.map_or(0..self.pairs, |part| part.pairs(self.pairs, BATCH))
    }

    /// What must be the same for a run to go on.
    fn identity(&self, mark: &PairsMark) -> Map<String, Value> {
        let mut identity = Map::new();
        identity.insert(VERSION.to_owned(), env!("CARGO_PKG_VERSION").into());
        identity.insert(GENERATOR.to_owned(), mark.0.clone().into());
        let part = self.part.map(|part| part.to_string());
        let numbers = [
            ("seed", self.seed),
            (PAIRS, self.pairs),
            ("plain_every", self.plain_every),
            ("gmp_every", self.gmp_every),
        ];
        identity.extend(numbers.map(|(name, number)| (name.to_owned(), number.into())));
        identity.extend(part.map(|part| (Part::KEY.to_owned(), part.into())));
        identity
    }
}

/// The key of the program's version.
pub(super) const VERSION: &str = "version";
/// The key of [`generator`].
pub(super) const GENERATOR: &str = "generator";
/// The key of the plan that may grow from one session to the next.
const PAIRS: &str = "pairs";

/// What tells which pairs a seed makes: SHA-256 of the coordinates and tolerances in one batch of each family of seed 0, since other versions may make
/// other pairs of a seed. To make these batches takes as long as to compare some: who opens many records makes it once.
#[derive(Clone, Debug)]
pub struct PairsMark(String);

impl PairsMark {
    /// The mark of what these settings make.
    pub fn of(config: &PairConfig) -> PairsMark {
        let mut text = String::new();
        for case in (0..config.families.len() as u64).flat_map(|number| batch(0, number, config)) {
            let coordinates =
                [&case.a, &case.b].into_iter().flat_map(|block| block.vertices()).flat_map(Vec3::components);
            let tolerances = case.sets.iter().flat_map(|set| [&set.f32, &set.f64]).flat_map(ToleranceSet::numbers);
            let numbers = coordinates.chain(tolerances.map(|(_, number)| number)).map(Number::to_string);
            text += &format!("{} {}\n", case.family, numbers.collect::<Vec<_>>().join(" "));
        }
        PairsMark(digest(text.as_bytes()))
    }
}

/// The content of `comparison.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ComparisonProgress {
    /// The plan, the version of the program and which pairs its seeds make.
    pub configuration: Map<String, Value>,
    /// Pairs done, from the first of the share.
    pub pairs_done: u64,
    /// What was counted.
    pub totals: Totals,
    /// Case files written.
    pub cases: u64,
    /// What `disagreements.csv` held then.
    pub disagreements: Seal,
    /// Seconds of work so far, over all sessions.
    pub seconds: f64,
}

impl ComparisonProgress {
    /// The plan.
    ///
    /// # Errors
    /// When the configuration holds none.
    pub fn plan(&self) -> Result<ComparisonPlan, serde_json::Error> {
        serde_json::from_value(Value::Object(self.configuration.clone()))
    }
}

pub(super) const STATE: &str = "comparison.json";
pub(super) const TABLE: &str = "disagreements.csv";
const TOTALS: &str = "totals.csv";
const LEVELS: &str = "levels.csv";
/// The files of every comparison.
const FILES: [&str; 4] = [STATE, TABLE, TOTALS, LEVELS];
/// Disagreements that get a case file, the first of a directory: where a path is wrong everywhere, more would say no more.
pub const MAX_CASES: u64 = 100;

/// Why a comparison cannot be started, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The directory cannot be used.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A table cannot be written.
    #[error("cannot write a table: {0}")]
    Csv(#[from] csv::Error),
    /// No threads are to be had.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// A comparison on disk.
#[derive(Debug)]
pub struct ComparisonRecord {
    directory: Directory,
    table: AppendedTable,
    plan: ComparisonPlan,
    progress: ComparisonProgress,
    /// What waits for a commit.
    rows: Vec<u8>,
    cases: BTreeMap<String, String>,
}

impl ComparisonRecord {
    /// Opens the comparison in `dir`, or begins one. One of all pairs, which is no part, may go on to more of them.
    ///
    /// # Errors
    /// When the directory holds something that may not be touched, a comparison that was started otherwise or is damaged, or cannot be written.
    pub fn open(
        dir: &Path,
        plan: ComparisonPlan,
        mark: &PairsMark,
        start: Start,
    ) -> Result<ComparisonRecord, RecordError> {
        let configuration = plan.identity(mark);
        let mut directory = Directory::claim(Claim { dir, owner: Owner::SelfComparison, start, files: &FILES })?;
        // Tables of counts are written when a run ends: there was a state.
        if directory.resumes() && directory.has(TOTALS) && !directory.has(STATE) {
            return Err(ResultsError::damaged(&dir.join(STATE), "it is missing").into());
        }
        if directory.is_resumable(STATE, TABLE)? {
            return ComparisonRecord::resume(directory, plan, configuration);
        }
        let table = directory.begin_table(TABLE, format!("{}\n", DISAGREEMENT_COLUMNS.join(",")).as_bytes())?;
        let progress = ComparisonProgress {
            configuration,
            pairs_done: 0,
            totals: Totals::default(),
            cases: 0,
            disagreements: table.seal()?,
            seconds: 0.0,
        };
        directory.write_sealed(STATE, &progress)?;
        Ok(ComparisonRecord { directory, table, plan, progress, rows: Vec::new(), cases: BTreeMap::new() })
    }

    fn resume(
        directory: Directory,
        plan: ComparisonPlan,
        configuration: Map<String, Value>,
    ) -> Result<ComparisonRecord, RecordError> {
        let mut progress: ComparisonProgress = directory.read_sealed(STATE)?;
        let (mut asked, known) = (configuration.clone(), progress.configuration.get(PAIRS));
        // A pair depends on seed and number alone, so a longer comparison begins with the shorter one. Parts of more pairs are other parts.
        if plan.part.is_none()
            && let Some(known) = known.filter(|known| known.as_u64().is_some_and(|pairs| pairs < plan.pairs))
        {
            asked.insert(PAIRS.to_owned(), known.clone());
        }
        let differences = identity_differences(&progress.configuration, &asked);
        if !differences.is_empty() {
            let (dir, owner) = (directory.path().to_owned(), directory.owner());
            return Err(ResultsError::OtherIdentity { dir, owner, differences }.into());
        }
        let share = plan.share();
        if progress.pairs_done > share.end - share.start || !progress.pairs_done.is_multiple_of(BATCH) {
            let what = format!("{} pairs are done of {}", progress.pairs_done, share.end - share.start);
            return Err(ResultsError::damaged(&directory.path().join(STATE), what).into());
        }
        let tables = directory.resume_tables([(TABLE, &progress.disagreements)])?;
        let table = tables.into_iter().next();
        let table = table.ok_or_else(|| ResultsError::damaged(&directory.path().join(TABLE), "it is missing"))?;
        progress.configuration = configuration;
        Ok(ComparisonRecord { directory, table, plan, progress, rows: Vec::new(), cases: BTreeMap::new() })
    }

    /// Where it is.
    pub fn dir(&self) -> &Path {
        self.directory.path()
    }

    /// What is to be compared.
    pub fn plan(&self) -> ComparisonPlan {
        self.plan
    }

    /// What is done; what waits for a commit among it.
    pub fn progress(&self) -> &ComparisonProgress {
        &self.progress
    }

    /// Takes the results of the next batches, which cost so many seconds. They are on disk after the next commit.
    pub(super) fn add(&mut self, batches: Vec<BatchResult>, seconds: f64) -> Result<(), RecordError> {
        self.progress.seconds += seconds;
        for BatchResult { family, tally, levels, disagreements } in batches {
            self.progress.pairs_done += BATCH;
            self.progress.totals.add(family, tally);
            self.progress.totals.add_levels(levels);
            for disagreement in disagreements {
                self.tell(disagreement)?;
            }
        }
        Ok(())
    }

    fn tell(&mut self, disagreement: Disagreement) -> Result<(), RecordError> {
        let has_room = self.progress.cases < MAX_CASES;
        let file = has_room.then(|| disagreement.case_file()).flatten();
        let name = file.map_or(String::new(), |(name, text)| {
            let name = format!("cases/{name}");
            self.cases.insert(name.clone(), text);
            self.progress.cases += 1;
            name
        });
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut self.rows);
        writer.serialize(disagreement.into_row(name))?;
        writer.flush().map_err(csv::Error::from)?;
        Ok(())
    }

    /// Makes all that was taken the state to go on from.
    pub(super) fn commit(&mut self) -> Result<(), RecordError> {
        let cases = std::mem::take(&mut self.cases);
        self.directory.write_all(cases.into_iter().map(|(name, text)| (name, FileKind::Case, text)))?;
        self.table.append(&self.rows)?;
        self.rows.clear();
        self.progress.disagreements = self.table.seal()?;
        Ok(self.directory.write_sealed(STATE, &self.progress)?)
    }

    /// Writes the tables of counts.
    pub(super) fn write_tables(&mut self) -> Result<(), RecordError> {
        let totals = &self.progress.totals;
        let tables = [(TOTALS, totals.to_csv()?), (LEVELS, totals.levels_to_csv()?)];
        let tables = tables.map(|(name, bytes)| (name.to_owned(), FileKind::Table, bytes));
        Ok(self.directory.write_all(tables)?)
    }
}
