//! Reads the directories of runs.

// Longer than 400 lines: every kind of run, its files and what is refused of them.

use super::error::{ReportError, at};
use super::pair_numbers::{self, PairNumbers};
use super::rows::CsvTable;
use super::step_tally::StepTally;
use super::tally::FindingTally;
use super::{lockstep, motion, stress, timing};
use rockproof_campaign::engine_counts::{ENGINE_COLUMNS, ENGINES};
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::Part;
use rockproof_campaign::proportion::{ClusterSums, Proportion};
use rockproof_campaign::steps::summary::{StepCounts, StepGroup};
use rockproof_campaign::steps::{STEP_SUMMARY_COLUMNS, StepSummaryRow};
use rockproof_campaign::summary::SUMMARY_COLUMNS;
use rockproof_differential::agreement::{
    AGREEMENT_COLUMNS, AgreementCounts, AgreementRow, CONFUSION_COLUMNS, ChainSpan, ComparisonKey, ConfusionRow,
};
use rockproof_differential::diagnosis::{DIAGNOSIS_COLUMNS, DiagnosisRow};
use rockproof_differential::engine::EngineCounts;
use rockproof_differential::finding::FINDING_COLUMNS;
use rockproof_differential::row::FindingRow;
use rockproof_model::files::{read_text, refuse_what_is_no_file};
use rockproof_model::text::{EXCERPT_LENGTH, escaped, excerpt, noun};
use rockproof_results::{is_inside, owner_without};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Everything a report is made of.
#[derive(Debug, Default)]
pub struct Results {
    /// Campaigns, in the order they were given.
    pub campaigns: Vec<CampaignRun>,
    /// Runs in which stepper and oracle made the same steps.
    pub locksteps: Vec<lockstep::LockstepRun>,
    /// Runs of a scene over time, those with a lockstep among them.
    pub motions: Vec<motion::MotionRun>,
    /// Stress sets.
    pub stresses: Vec<stress::StressRun>,
    /// Measurements of run time against error.
    pub timings: Vec<timing::TimingRun>,
}

/// What `run.json` tells.
#[derive(Clone, Debug, Deserialize)]
pub struct RunFile {
    /// The program's version.
    pub version: String,
    /// The seed.
    pub seed: u64,
    /// The configuration.
    pub configuration: Map<String, Value>,
    /// Where it ran.
    pub machine: Machine,
    /// Whether all pairs are done.
    pub finished: bool,
    /// Pairs done.
    pub pairs: u64,
    /// Contacts in the exact answers.
    pub contacts: u64,
    /// How many findings.
    pub findings: FindingCounts,
    /// The steps of its pairs.
    #[serde(default)]
    pub steps: StepTotals,
    /// Metamorphic checks made.
    pub metamorphic_checks: u64,
    /// How long it took.
    pub seconds: f64,
    /// What external engines were put through.
    #[serde(default)]
    pub external_engines: BTreeMap<String, EngineCounts>,
    /// How many rows its tables of counts have; runs of earlier versions do not say.
    #[serde(default)]
    pub table_rows: BTreeMap<String, u64>,
}

/// Where a campaign ran.
#[derive(Clone, Debug, Deserialize)]
pub struct Machine {
    /// The operating system.
    pub os: String,
    /// The processor's architecture.
    pub architecture: String,
    /// How many cores it has.
    pub cores: u64,
}

/// How many findings.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct FindingCounts {
    /// All of them.
    pub total: u64,
}

/// The steps of a campaign's pairs.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub struct StepTotals {
    /// Findings about them.
    pub findings: u64,
}

/// The share of pairs with the same answer, of all that were compared.
pub fn agreeing_share(counts: &AgreementCounts) -> Option<Proportion> {
    let clusters = ClusterSums {
        hits_squared: counts.agreeing_squared,
        hits_times_trials: counts.agreeing_times_pairs,
        trials_squared: counts.pairs_squared,
    };
    Proportion::of(counts.agreeing, counts.pairs, clusters.effective(counts.agreeing, counts.pairs))
}

/// Which kind became which, and how often.
pub type ConfusionCounts = BTreeMap<(String, String), u64>;

/// A campaign read from disk.
#[derive(Debug)]
pub struct CampaignRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// Its name in the report: that of the directory.
    pub name: String,
    /// What `run.json` tells.
    pub run: RunFile,
    /// Counts by family and what was compared.
    pub agreement: Vec<(String, ComparisonKey, AgreementCounts)>,
    /// Kinds by what was compared.
    pub confusion: BTreeMap<ComparisonKey, ConfusionCounts>,
    /// The findings, counted.
    pub tally: FindingTally,
    /// Counts of steps by family, tolerance set and engine; empty where no pair made any.
    pub steps: Vec<(StepGroup, StepCounts)>,
    /// The findings about steps, counted.
    pub step_tally: StepTally,
    /// What is wrong with its external engines; empty where it has none, or is not finished.
    pub diagnosis: Vec<DiagnosisRow>,
}

impl Results {
    /// Reads the directories.
    ///
    /// # Errors
    /// When one is no run, is damaged, is named twice, or was made by another version.
    pub fn read(dirs: &[PathBuf]) -> Result<Results, ReportError> {
        let mut results = Results::default();
        let mut places: BTreeMap<PathBuf, &PathBuf> = BTreeMap::new();
        for dir in dirs {
            // By another name a run counts once more; what is no directory is told of below.
            if let Some(first) = dir.canonicalize().ok().and_then(|place| places.insert(place, dir)) {
                return Err(ReportError::Twice { dirs: [first.clone(), dir.clone()] });
            }
            let has = |name: &str| dir.join(name).is_file();
            let (campaign, lockstep, timing) = (has("findings.csv"), has("lockstep.csv"), has(timing::FILE));
            let (motion, stress) = (has(motion::FILE), has(stress::FILE));
            let findings = dir.join("findings.csv");
            if !findings.exists() && has("agreement.csv") {
                let other = "the other tables of a campaign are there: it was left out or removed".to_owned();
                return Err(ReportError::Contradiction {
                    file: findings,
                    found: "the file is missing".to_owned(),
                    other,
                });
            }
            if !campaign && !lockstep && !timing && !motion && !stress {
                for name in ["findings.csv", "lockstep.csv", timing::FILE, motion::FILE, stress::FILE] {
                    let file = dir.join(name);
                    if file.exists() {
                        refuse_what_is_no_file(&file).map_err(at(&file))?;
                    }
                }
                if has("trajectory.csv") && has("state.json") {
                    return Err(ReportError::ExactRun { dir: dir.clone() });
                }
                return Err(ReportError::NoRun { dir: dir.clone(), found: what_is_there(dir) });
            }
            if let Some(owner) = owner_without(dir, "findings.csv").filter(|_| campaign) {
                return Err(ReportError::Foreign { file: findings, owner });
            }
            if campaign {
                results.campaigns.push(CampaignRun::read(dir)?);
            }
            if lockstep {
                results.locksteps.push(lockstep::LockstepRun::read(dir)?);
            }
            if motion {
                results.motions.push(motion::MotionRun::read(dir)?);
            }
            if stress {
                results.stresses.push(stress::StressRun::read(dir)?);
            }
            if timing {
                results.timings.push(timing::TimingRun::read(dir)?);
            }
        }
        results.refuse_shared_pairs()?;
        let mut names: Vec<String> = results.campaigns.iter().map(|c| c.name.clone()).collect();
        names.sort();
        if names.windows(2).any(|two| two[0] == two[1]) {
            for campaign in &mut results.campaigns {
                campaign.name = escaped(&campaign.dir.display().to_string());
            }
        }
        Ok(results)
    }

    /// Pairs that two runs have, with an engine that takes part in both, would count twice.
    fn refuse_shared_pairs(&self) -> Result<(), ReportError> {
        for (at, one) in self.campaigns.iter().enumerate() {
            let engines = one.engines();
            for two in &self.campaigns[at + 1..] {
                let shared = PairNumbers::of(&one.run).shared(&PairNumbers::of(&two.run));
                let same = pair_numbers::are_of_one_campaign(&one.run.configuration, &two.run.configuration);
                if let (Some(shared), true) =
                    (shared.ends(), same && two.engines().iter().any(|name| engines.contains(name)))
                {
                    return Err(ReportError::Shared { dirs: [one.dir.clone(), two.dir.clone()], shared });
                }
            }
        }
        Ok(())
    }

    /// Runs of a scene that have no lockstep.
    pub fn without_lockstep(&self) -> impl Iterator<Item = &motion::MotionRun> {
        self.motions.iter().filter(|run| self.locksteps.iter().all(|lockstep| lockstep.dir != run.dir))
    }
}

fn what_is_there(dir: &Path) -> String {
    if dir.is_file() {
        return "a file, not a directory".to_owned();
    }
    let Ok(entries) = std::fs::read_dir(dir) else { return "no such directory".to_owned() };
    let mut names: Vec<String> = entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    match names.len() {
        0 => "an empty directory".to_owned(),
        n if n > 6 => format!("{} and {} more", names[..6].join(", "), n - 6),
        _ => names.join(", "),
    }
}

/// The name of a run in the report: that of its directory, as a text that only shows.
pub(super) fn name_of(dir: &Path) -> String {
    escaped(&last_name(dir))
}

/// The last name of a directory's path.
pub(super) fn last_name(dir: &Path) -> String {
    let last = dir.file_name().map(|name| name.to_string_lossy().into_owned());
    last.unwrap_or_else(|| dir.display().to_string())
}

/// Reads a JSON file that names the version that wrote it.
pub(super) fn read_json<T: for<'d> Deserialize<'d>>(file: &Path) -> Result<T, ReportError> {
    let text = refuse_what_is_no_file(file).and_then(|()| read_text(file)).map_err(at(file))?;
    let damaged = |error: &serde_json::Error, expected: &str| ReportError::Damaged {
        file: file.to_owned(),
        line: error.line() as u64,
        found: error.to_string(),
        expected: expected.to_owned(),
    };
    #[derive(Deserialize)]
    struct Versioned {
        version: String,
    }
    // The version first: a file of another version may hold anything else.
    let Versioned { version } = serde_json::from_str(&text).map_err(|e| damaged(&e, "JSON with a \"version\""))?;
    let ours = env!("CARGO_PKG_VERSION");
    let series = |version: &str| version.rsplit_once('.').map_or(version.to_owned(), |(series, _)| series.to_owned());
    if series(&version) != series(ours) {
        let line = text.lines().position(|line| line.contains("\"version\"")).map_or(1, |n| n as u64 + 1);
        return Err(ReportError::Version { file: file.to_owned(), line, found: version, ours });
    }
    serde_json::from_str(&text).map_err(|e| damaged(&e, "what this version writes there"))
}

/// The file that a run writes last; `beside` is one that it has from the beginning.
pub(crate) fn ended(dir: &Path, beside: &str) -> Result<PathBuf, ReportError> {
    let file = dir.join("run.json");
    if !file.exists() && dir.join(beside).is_file() {
        return Err(ReportError::NotWritten { dir: dir.to_owned() });
    }
    Ok(file)
}

impl CampaignRun {
    fn read(dir: &Path) -> Result<CampaignRun, ReportError> {
        let run: RunFile = read_json(&ended(dir, "progress.json")?)?;
        let agreement = read_agreement(&dir.join("agreement.csv"))?;
        let confusion = read_confusion(&dir.join("confusion.csv"))?;
        let file = dir.join("findings.csv");
        let mut rows = CsvTable::open(file.clone(), &FINDING_COLUMNS)?;
        let mut tally = FindingTally::default();
        while let Some(row) = rows.next(&FINDING_COLUMNS)? {
            let finding: FindingRow = row.parsed()?;
            if !finding.case.is_empty() && !is_inside(&finding.case) {
                return Err(row.invalid_row(
                    &format!("case is \"{}\"", excerpt(&finding.case, EXCERPT_LENGTH)),
                    "the name of a file in the directory of the run, as cases/NAME.toml",
                ));
            }
            if [finding.margin, finding.margin_ulps].into_iter().flatten().any(|margin| !margin.is_finite()) {
                return Err(row.invalid_row("a margin that is no finite number", "a finite number or nothing"));
            }
            tally.add(finding);
        }
        if tally.total != run.findings.total {
            return Err(ReportError::Contradiction {
                file,
                found: format!("{} findings", tally.total),
                other: format!("run.json counts {}: a file was changed or cut off", run.findings.total),
            });
        }
        let file = dir.join("step_findings.csv");
        let step_tally = if file.is_file() { StepTally::read(&file)? } else { StepTally::default() };
        if step_tally.total() != run.steps.findings {
            return Err(ReportError::Contradiction {
                file,
                found: format!("{} findings about steps", step_tally.total()),
                other: format!("run.json counts {}: a file was changed, cut off or left out", run.steps.findings),
            });
        }
        let name = name_of(dir);
        check_rows(dir, &run)?;
        let file = dir.join("step_summary.csv");
        let steps = if file.is_file() { read_steps(&file)? } else { Vec::new() };
        let file = dir.join("diagnosis.csv");
        // What is there of a run that goes on to more pairs is about fewer. What is made of some parts stays as it is.
        let is_current = run.finished || run.configuration.contains_key(Parts::KEY);
        let diagnosis = if is_current && file.is_file() { read_diagnosis(&file)? } else { Vec::new() };
        Ok(CampaignRun { dir: dir.to_owned(), name, run, agreement, confusion, tally, steps, step_tally, diagnosis })
    }

    /// What was compared, by family. Of an engine that says only how blocks lie the whole chain would hold what it does not take and nothing else, so
    /// that is left out.
    fn compared(&self) -> impl Iterator<Item = &(String, ComparisonKey, AgreementCounts)> {
        let engines = self.engines();
        let states: BTreeSet<String> =
            engines.into_iter().filter(|engine| self.span_of(engine) != ChainSpan::Whole).collect();
        self.agreement
            .iter()
            .filter(move |(_, compared, _)| compared.span != ChainSpan::Whole || !states.contains(&compared.engine))
    }

    /// Sums over families and over the rungs of ladders, by what was compared; see [`setting`].
    pub fn by_setting(&self) -> BTreeMap<ComparisonKey, AgreementCounts> {
        let mut sums: BTreeMap<ComparisonKey, AgreementCounts> = BTreeMap::new();
        for (_, compared, counts) in self.compared() {
            let compared = ComparisonKey { tolerances: setting(&compared.tolerances), ..compared.clone() };
            sums.entry(compared).or_default().add(counts);
        }
        sums
    }

    /// Sums over tolerance sets, by family, span and engine.
    pub fn by_family(&self) -> BTreeMap<(&str, ChainSpan, &str), AgreementCounts> {
        let mut sums: BTreeMap<(&str, ChainSpan, &str), AgreementCounts> = BTreeMap::new();
        for (family, compared, counts) in self.compared() {
            sums.entry((family, compared.span, &compared.engine)).or_default().add(counts);
        }
        sums
    }

    /// Whether a setting is shown: those made for ties only where there are no others.
    pub fn shows(&self, setting: &str) -> bool {
        let usual =
            || self.agreement.iter().any(|(_, compared, _)| !is_made_for_ties(&self::setting(&compared.tolerances)));
        !is_made_for_ties(setting) || !usual()
    }

    /// How many settings are not shown.
    pub fn not_shown(&self) -> usize {
        let settings: BTreeSet<String> = self.agreement.iter().map(|(_, c, _)| setting(&c.tolerances)).collect();
        settings.iter().filter(|setting| !self.shows(setting)).count()
    }

    /// `part 1 of 2`, where it is a part of a campaign.
    pub fn part(&self) -> Option<String> {
        let (number, of) = self.run.configuration.get(Part::KEY)?.as_str()?.split_once('/')?;
        Some(format!("part {number} of {of}"))
    }

    /// Whether pairs are left that are neither of another part nor of one that a merge did without.
    pub fn is_interrupted(&self) -> bool {
        !self.run.finished && self.run.configuration.get("parts").is_none()
    }

    /// The engines, in order.
    pub fn engines(&self) -> Vec<String> {
        let of = self.agreement.iter().filter(|(_, c, _)| matches!(c.span, ChainSpan::Arithmetic | ChainSpan::Whole));
        of.map(|(_, c, _)| c.engine.clone()).collect::<std::collections::BTreeSet<_>>().into_iter().collect()
    }

    /// Which links show how often an engine is right: the whole chain, or for one that says only how blocks lie the arithmetic alone.
    pub fn span_of(&self, engine: &str) -> ChainSpan {
        let answers = |span| {
            let of = self.agreement.iter().filter(|(_, c, _)| c.span == span && c.engine == engine);
            of.map(|(_, _, counts)| counts.pairs - counts.silent).sum::<u64>()
        };
        if answers(ChainSpan::Whole) == 0 && answers(ChainSpan::Arithmetic) > 0 {
            ChainSpan::Arithmetic
        } else {
            ChainSpan::Whole
        }
    }

    /// Whether a comparison is the one that shows how often an engine is right.
    pub fn is_of_users(&self, compared: &ComparisonKey) -> bool {
        let engine = matches!(compared.span, ChainSpan::Whole | ChainSpan::Arithmetic);
        engine && compared.span == self.span_of(&compared.engine)
    }

    /// Sums over everything, for an engine, along [`CampaignRun::span_of`] it.
    pub fn of_engine(&self, engine: &str) -> AgreementCounts {
        let span = self.span_of(engine);
        let mut sums = AgreementCounts::default();
        for (_, _, counts) in self.agreement.iter().filter(|(_, c, _)| c.span == span && c.engine == engine) {
            sums.add(counts);
        }
        sums
    }
}

/// The setting a set belongs to: itself, or for a set that a ladder has changed, all of those: `auto:territory` is `auto
/// (ladders)`.
pub fn setting(set: &str) -> String {
    match set.split_once(':') {
        Some((base, _)) => format!("{base} (ladders)"),
        None => set.to_owned(),
    }
}

/// Whether a setting was made to hold exact ties or put on the edge of a decision: a hard question for engines, and none that a user
/// would take.
pub fn is_made_for_ties(setting: &str) -> bool {
    setting.ends_with("(ladders)")
        || setting.ends_with("-steep")
        || ["dyadic", "fractional"].iter().any(|start| setting.starts_with(start))
}

/// Checks that the tables of counts have as many rows as `run.json` says, which knows of no others.
fn check_rows(dir: &Path, run: &RunFile) -> Result<(), ReportError> {
    // Tables that are read here, in `compare` or by people.
    let tables: [(&str, &[&str], bool); 5] = [
        ("agreement.csv", &AGREEMENT_COLUMNS, true),
        ("confusion.csv", &CONFUSION_COLUMNS, true),
        ("step_summary.csv", STEP_SUMMARY_COLUMNS, true),
        ("summary.csv", &SUMMARY_COLUMNS, false),
        (ENGINES, &ENGINE_COLUMNS, false),
    ];
    for (name, columns, is_needed) in tables {
        let file = dir.join(name);
        let Some(&expected) = run.table_rows.get(name).filter(|_| is_needed || file.is_file()) else { continue };
        let mut rows = CsvTable::open_wider(file.clone(), columns)?;
        let mut found = 0;
        while rows.next(&[])?.is_some() {
            found += 1;
        }
        if found != expected {
            let found = format!("{found} {}", noun(found, "row", "rows"));
            let other = format!("run.json counts {expected}: a file was changed or cut off");
            return Err(ReportError::Contradiction { file, found, other });
        }
    }
    Ok(())
}

fn read_agreement(file: &Path) -> Result<Vec<(String, ComparisonKey, AgreementCounts)>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), &AGREEMENT_COLUMNS)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(&AGREEMENT_COLUMNS)? {
        let counted: AgreementRow = row.parsed()?;
        let AgreementCounts { pairs, agreeing, silent, .. } = counted.counts;
        if agreeing.checked_add(silent).is_none_or(|sum| sum > pairs) {
            let found = format!("{agreeing} pairs agree and {silent} have no answer");
            return Err(row.invalid_row(&found, &format!("at most {pairs} together, as there are pairs")));
        }
        let compared = counted.key();
        found.push((counted.family, compared, counted.counts));
    }
    Ok(found)
}

fn read_diagnosis(file: &Path) -> Result<Vec<DiagnosisRow>, ReportError> {
    let columns = &DIAGNOSIS_COLUMNS;
    let mut rows = CsvTable::open(file.to_owned(), columns)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(columns)? {
        found.push(row.parsed()?);
    }
    Ok(found)
}

fn read_steps(file: &Path) -> Result<Vec<(StepGroup, StepCounts)>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), STEP_SUMMARY_COLUMNS)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(STEP_SUMMARY_COLUMNS)? {
        found.push(row.parsed::<StepSummaryRow>()?.counts());
    }
    Ok(found)
}

fn read_confusion(file: &Path) -> Result<BTreeMap<ComparisonKey, ConfusionCounts>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), &CONFUSION_COLUMNS)?;
    let mut found: BTreeMap<ComparisonKey, ConfusionCounts> = BTreeMap::new();
    while let Some(row) = rows.next(&CONFUSION_COLUMNS)? {
        let ConfusionRow { tolerances, span, engine, before, after, contacts } = row.parsed()?;
        let compared = ComparisonKey { tolerances: setting(&tolerances), span, engine };
        *found.entry(compared).or_default().entry((before, after)).or_default() += contacts;
    }
    Ok(found)
}
