//! What is wrong with the external engines of a campaign: `diagnosis.csv`, made of a sample of its pairs when all are done.
//!
//! The sample follows from the findings and the seed alone, and the engines are asked anew, so the table is the same after a resumption, on any
//! number of threads, and for parts put together, as long as the engines answer alike.

use super::cases::case_request;
use super::journal::{FINDINGS, Journal};
use super::run::{Campaign, Ending, RunError, Stopped};
use rayon::prelude::*;
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::case_file::Case;
use rockproof_differential::collapse::collapsed_feature;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::diagnosis::{
    DIAGNOSIS_COLUMNS, DiagnosisRow, DiagnosisVerdict, Question, Reply, Sample, ask, diagnose,
};
use rockproof_differential::engine::Engine;
use rockproof_differential::finding::{Cause, FINDING_COLUMNS, Finding, FindingScope};
use rockproof_differential::row::{FindingRow, typed_rows, written};
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_model::files::open_table;
use rockproof_results::{ResultsError, digest};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The table.
pub const DIAGNOSIS: &str = "diagnosis.csv";

/// Differing answers that are looked at, of each engine.
pub const DIFFERING: usize = 192;

/// Batches that right answers are taken from beside those of the differing ones, spread over the campaign, and of those with differing ones.
const SPREAD: u64 = 32;
const BESIDE: usize = 64;

/// Right answers taken from a batch, and those of them without contacts.
const OF_BATCH: usize = 6;
const WITHOUT_CONTACTS: usize = 2;

/// Batches in which right answers are looked for that speak against a hypothesis, and how many of them at a time.
const OTHERS: u64 = 128;
const OTHERS_OF_PART: u64 = 8;

/// Questions asked for them, and of these unanswered ones.
const ASKED: usize = 24;
const UNANSWERED: usize = 2;

/// One pair under one tolerance set, by a number that has nothing to do with either, so that the first are a sample of all.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct SampleKey {
    order: String,
    index: u64,
    set: String,
}

impl SampleKey {
    fn of(seed: u64, index: u64, set: &str) -> SampleKey {
        SampleKey { order: digest(format!("{seed} {index} {set}").as_bytes()), index, set: set.to_owned() }
    }

    fn label(&self) -> String {
        label(self.index, &self.set)
    }
}

/// The batch with a number among so many that are spread evenly over all; `None` beyond the last.
fn spread(number: u64, many: u64, all: u64) -> Option<u64> {
    let many = many.min(all);
    let place = || u64::try_from(u128::from(number) * u128::from(all) / u128::from(many)).ok();
    if number < many { place() } else { None }
}

/// What people call a pair under a set.
fn label(index: u64, set: &str) -> String {
    format!("pair {index} under {set}")
}

/// Answers about the pairs of one batch: those that differ in the campaign, and right ones.
type BatchAnswers = (Vec<(SampleKey, Question)>, Vec<Question>);

/// The differing answers of an engine.
#[derive(Default)]
struct Differing {
    /// Of the first, each with its case file, if it has one.
    first: BTreeMap<SampleKey, String>,
    all: u64,
    /// The sets under which the pair of the last row differs.
    last: (u64, BTreeSet<String>),
}

impl Differing {
    fn add(&mut self, seed: u64, row: FindingRow) {
        if self.last.0 != row.index {
            self.last = (row.index, BTreeSet::new());
        }
        let place = SampleKey::of(seed, row.index, &row.tolerances);
        if self.last.1.insert(row.tolerances) {
            self.all += 1;
            self.first.insert(place.clone(), String::new());
        }
        // Of several findings about one answer the first with a case.
        if let Some(case) = self.first.get_mut(&place).filter(|case| case.is_empty()) {
            *case = row.case;
        }
        if self.first.len() > DIFFERING {
            self.first.pop_last();
        }
    }
}

/// Whether a finding says that an answer differs from the exact one; the others are about failures, answers that cannot be read among them, and
/// about what an engine says of other pairs.
fn is_difference(change: AnswerChange) -> bool {
    use AnswerChange::{Entrance, Extra, Gap, GapSign, Kind, Missing, Normal, State};
    matches!(change, Missing | Extra | Kind | Entrance | GapSign | State | Gap | Normal)
}

impl Campaign<'_> {
    /// Asks the external engines again about some of the pairs that are done, and writes `diagnosis.csv`: what explains the answers that
    /// differ. Nothing is done where no engine is external. `done` counts the differing answers asked for, of [`DIFFERING`] for each engine at most.
    ///
    /// # Errors
    /// When a table cannot be read or written, or an engine cannot be asked for want of something here.
    pub fn diagnose(&self, journal: &mut Journal, stop: &AtomicBool, done: &AtomicU64) -> Result<Ending, RunError> {
        let engines: Vec<&dyn Engine> = self.panel.engines.iter().map(|engine| &**engine).collect();
        let external: Vec<&dyn Engine> = engines.into_iter().filter(|engine| engine.cause() == Cause::Engine).collect();
        if external.is_empty() {
            return Ok(Ending::Finished);
        }
        let mut differing = differing(&journal.dir().join(FINDINGS), self.config.seed)?;
        let pool = self.pool()?;
        let stopped = || self.is_over(stop);
        let (mut rows, mut cases) = (Vec::new(), Vec::new());
        for engine in external {
            let found = differing.remove(engine.name()).unwrap_or_default();
            let mut of_engine = match found.first.is_empty() {
                true => Vec::new(),
                false => pool.install(|| self.diagnosed(engine, &found, &stopped, done)),
            };
            for row in of_engine.iter_mut().filter(|row| row.verdict == DiagnosisVerdict::Unexplained) {
                let place = found.first.keys().find(|place| place.label() == row.example);
                if let Some((name, bytes)) = place.map(|place| self.unexplained(engine, place)).transpose()?.flatten() {
                    row.example = format!("cases/{name}");
                    cases.push((name, bytes));
                }
            }
            rows.extend(of_engine);
            // Answers of engines that end together with this program count for nothing.
            self.panel.check_shortage()?;
            if stopped() {
                return Ok(Ending::Stopped);
            }
        }
        journal.write_cases(cases)?;
        journal.write(DIAGNOSIS, &written(&DIAGNOSIS_COLUMNS, &rows)?)?;
        Ok(Ending::Finished)
    }

    fn diagnosed(
        &self,
        engine: &dyn Engine,
        found: &Differing,
        stopped: Stopped<'_>,
        done: &AtomicU64,
    ) -> Vec<DiagnosisRow> {
        let batch_len = self.source.batch_len();
        let mut batches: BTreeMap<u64, Vec<(&SampleKey, &String)>> = BTreeMap::new();
        for (place, case) in &found.first {
            batches.entry(place.index / batch_len).or_default().push((place, case));
        }
        let beside: BTreeSet<u64> = found.first.keys().map(|place| place.index / batch_len).take(BESIDE).collect();
        let all = self.config.pairs.div_ceil(batch_len);
        for number in (0..SPREAD).filter_map(|number| spread(number, SPREAD, all)) {
            batches.entry(number).or_default();
        }
        let asked: Vec<BatchAnswers> = batches
            .par_iter()
            .map(|(&number, places)| {
                if stopped() {
                    return (Vec::new(), Vec::new());
                }
                let subjects = self.source.batch(number);
                let right = !places.is_empty() && !beside.contains(&number);
                let right = if right { Vec::new() } else { self.right_answers(engine, &subjects, places) };
                let question = |(place, case): &(&SampleKey, &String)| {
                    let subject = subjects.iter().find(|subject| subject.index == place.index)?;
                    let set = subject.sets.iter().find(|set| *set.name == *place.set)?;
                    let mut question = question(engine, subject, set)?;
                    done.fetch_add(1, Ordering::Relaxed);
                    if !case.is_empty() {
                        question.label.clone_from(case);
                    }
                    Some(((*place).clone(), question))
                };
                (places.iter().filter_map(question).collect(), right)
            })
            .collect();
        let (differing, agreeing): (Vec<_>, Vec<_>) = asked.into_iter().unzip();
        let mut differing: Vec<(SampleKey, Question)> = differing.into_iter().flatten().collect();
        differing.sort_by(|(one, _), (other, _)| one.cmp(other));
        if stopped() {
            return Vec::new();
        }
        let sample = Sample {
            differing: differing.into_iter().map(|(_, question)| question).collect(),
            agreeing: agreeing.into_iter().flatten().collect(),
            all_differing: found.all,
        };
        let known: BTreeSet<(u64, &str)> = found.first.keys().map(|place| (place.index, place.set.as_str())).collect();
        let others = |part: u64| {
            let batches = (part * OTHERS_OF_PART..(part + 1) * OTHERS_OF_PART).filter_map(|n| spread(n, OTHERS, all));
            let batches: Vec<u64> = batches.collect();
            let is_over = batches.is_empty() || stopped();
            let questions = || batches.into_par_iter().flat_map_iter(|number| self.others(engine, number, &known));
            (!is_over).then(|| questions().collect())
        };
        diagnose(engine.name(), &sample, &|blocks, tolerances| ask(engine, blocks, tolerances), &others)
    }

    /// The questions about pairs of a batch but those whose answers are known to differ, not asked.
    fn others(&self, engine: &dyn Engine, number: u64, known: &BTreeSet<(u64, &str)>) -> Vec<Question> {
        let subjects = self.source.batch(number);
        let subjects = subjects.iter().filter(|subject| subject.index < self.config.pairs);
        let sets = subjects.flat_map(|subject| subject.sets.iter().map(move |set| (subject, set)));
        let others = sets.filter(|(subject, set)| !known.contains(&(subject.index, &*set.name)));
        others.filter_map(|(subject, set)| unasked(engine, subject, set)).collect()
    }

    /// The case file of an answer that nothing explains and that has none: the pair as it is, since what is left of it when it is made small may be
    /// explained.
    fn unexplained(&self, engine: &dyn Engine, place: &SampleKey) -> Result<Option<(String, Vec<u8>)>, RunError> {
        let Some(subject) = self.subject(place.index) else { return Ok(None) };
        let scope = FindingScope::Engine(engine.name().into());
        let is_it = |finding: &Finding| {
            finding.scope == scope && *finding.set == *place.set && is_difference(finding.difference.change)
        };
        let Some(finding) = examine_pair(&subject, self.panel).findings.into_iter().find(is_it) else {
            return Ok(None);
        };
        let case = Case::of(&finding, &subject, self.config.seed, self.panel);
        let Some(case) = case else { return Ok(None) };
        Ok(Some((case_request(&finding.row(String::new())).name, case.to_toml()?.into_bytes())))
    }

    /// Some questions about pairs of a batch that the engine answers exactly, most of them with contacts.
    fn right_answers(
        &self,
        engine: &dyn Engine,
        subjects: &[Subject],
        differing: &[(&SampleKey, &String)],
    ) -> Vec<Question> {
        let mut places: Vec<(SampleKey, &Subject, &NamedSet)> = Vec::new();
        for subject in subjects.iter().filter(|subject| subject.index < self.config.pairs) {
            for set in &subject.sets {
                let place = SampleKey::of(self.config.seed, subject.index, &set.name);
                if differing.iter().all(|(known, _)| **known != place) {
                    places.push((place, subject, set));
                }
            }
        }
        places.sort_by(|(one, ..), (other, ..)| one.cmp(other));
        let (mut right, mut empty, mut unanswered) = (Vec::new(), 0, 0);
        for (_, subject, set) in places.into_iter().take(ASKED) {
            if right.len() == OF_BATCH || unanswered == UNANSWERED {
                break;
            }
            let Some(question) = question(engine, subject, set) else { continue };
            unanswered += usize::from(matches!(question.reply, Reply::Nothing(_)));
            let nothing = matches!(question.reply, Reply::Contacts(_)) && !question.has_contacts();
            if question.is_right() == Some(true) && (!nothing || empty < WITHOUT_CONTACTS) {
                empty += usize::from(nothing);
                right.push(question);
            }
        }
        right
    }
}

/// The differing answers of each engine.
fn differing(findings: &Path, seed: u64) -> Result<BTreeMap<String, Differing>, RunError> {
    let mut found: BTreeMap<String, Differing> = BTreeMap::new();
    let table = open_table(findings).map_err(ResultsError::at(findings))?;
    for row in typed_rows(table, &FINDING_COLUMNS)? {
        let row: FindingRow = row?;
        if let FindingScope::Engine(name) = &row.engine
            && row.cause == Cause::Engine
            && is_difference(row.change)
        {
            found.entry(name.to_string()).or_default().add(seed, row);
        }
    }
    Ok(found)
}

/// A question with the engine's answer, where it is asked.
fn question(engine: &dyn Engine, subject: &Subject, set: &NamedSet) -> Option<Question> {
    let question = unasked(engine, subject, set)?;
    let reply = ask(engine, &question.blocks, &question.tolerances);
    Some(Question { reply, ..question })
}

/// A question before it is asked; `None` where the engine is not asked, because rounding destroys the pair.
fn unasked(engine: &dyn Engine, subject: &Subject, set: &NamedSet) -> Option<Question> {
    let precision = engine.precision();
    let blocks = [subject.a.rounded(precision)?, subject.b.rounded(precision)?];
    if blocks.iter().any(|block| collapsed_feature(block).is_some()) {
        return None;
    }
    let tolerances = set.of(precision).rounded(precision).ok()?;
    // Until it is asked.
    let reply = Reply::Nothing(AnswerChange::Failure);
    let label = label(subject.index, &set.name);
    Some(Question { blocks, tolerances, precision, accuracy: engine.accuracy(), reply, label })
}
