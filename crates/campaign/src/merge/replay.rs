//! Goes through the rows of all parts as a campaign goes through its pairs.

use super::parts::{MergeError, Parts};
use super::rows::{NumberedRow, Rows};
use crate::case_writer::{CaseCounts, CaseFiles, each_in_threads, in_threads, write_cases};
use crate::cases::{CaseFile, case_request, step_case_request};
use crate::engine_counts::{self, EngineSums};
use crate::journal::{CampaignProgress, FINDINGS, Journal, NO_CASE, NewRows, STEP_FINDINGS};
use crate::run::{Campaign, Ending, RunError, Stopped};
use crate::steps::StepFindingRow;
use rockproof_differential::engine::Levels;
use rockproof_differential::row::FindingRow;
use serde_json::Map;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// How a merge ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Merged {
    /// Whether it came to its end.
    pub ending: Ending,
    /// Findings chosen for a case file that the pair did not show again: what an external engine says may change.
    pub unseen: u64,
}

/// Bytes of rows between two states on disk.
const COMMIT: usize = 4 << 20;

/// Rows of one chunk, and which of those about steps cannot have a case file.
struct Chunk {
    findings: Vec<NumberedRow<FindingRow>>,
    steps: Vec<NumberedRow<StepFindingRow>>,
    no_case: BTreeSet<(u64, usize)>,
}

impl Campaign<'_> {
    /// Puts parts together in a journal that was opened with [`Parts::identity`], until all are there or `stop` is set, calling `watch` after
    /// each chunk: its progress counts pairs of the whole campaign whose rows are there. The chunk in which it is stopped is made anew when
    /// the merge is resumed, so that answers of engines that end together with this program count for nothing.
    ///
    /// # Errors
    /// When a part cannot be read, a file cannot be written, or an engine cannot be asked for want of something here. What was committed before stays, and can be resumed.
    pub fn merge(
        &self,
        parts: &Parts,
        journal: &mut Journal,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&CampaignProgress),
    ) -> Result<Merged, RunError> {
        let batch_len = self.source.batch_len();
        let (whole, unseen) = (parts.is_whole(batch_len), AtomicU64::new(0));
        let json = Map::from_iter([("parts".to_owned(), parts.json(batch_len))]);
        let done = journal.progress().pairs_done;
        if done > 0 && !journal.progress().merging {
            // Only a merge that came to its end may be asked for again.
            if done < self.config.pairs {
                return Err(MergeError::NoMerge { dir: journal.dir().to_owned() }.into());
            }
            self.write_tables(journal, whole, json)?;
            return Ok(Merged { ending: Ending::Finished, unseen: 0 });
        }
        let pool = self.pool()?;
        if self.makes_steps() {
            journal.keep_steps()?;
        }
        let mut progress = journal.progress().clone();
        if !progress.merging {
            progress = totals(parts, CampaignProgress { merging: true, ..progress });
        }
        let (before, started) = (progress.seconds, Instant::now());
        let engines = EngineSums::begin(self.panel, &progress.engines);
        let stopped = || self.is_over(stop);
        let seen = journal.seen();
        let mut findings = Rows::of(&parts.parts, FINDINGS, |row: &FindingRow| row.index)?;
        let mut steps = Rows::of(&parts.parts, STEP_FINDINGS, |row: &StepFindingRow| row.index)?;
        let mut no_case = Rows::of(&parts.parts, NO_CASE, |row: &(u64, usize)| row.0)?;
        seen.findings.store(findings.skip(done)?, Ordering::Relaxed);
        steps.skip(done)?;
        no_case.skip(done)?;
        let (chunk, mut first) = (self.chunk(), done);
        let mut new = NewRows::default();
        while first < self.config.pairs && !stopped() {
            let end = (first / chunk + 1).saturating_mul(chunk).min(self.config.pairs);
            let no_case = no_case.until(end)?.into_iter().map(|tried| tried.row).collect();
            let rows = Chunk { findings: findings.until(end)?, steps: steps.until(end)?, no_case };
            seen.shrinking.store(true, Ordering::Relaxed);
            let cases = pool.install(|| self.replay(&rows, &mut progress, &mut new, &stopped, &unseen))?;
            let Some(cases) = cases else { break };
            journal.write_cases(cases)?;
            seen.shrinking.store(false, Ordering::Relaxed);
            seen.findings.fetch_add(rows.findings.len() as u64, Ordering::Relaxed);
            seen.pairs.store(end, Ordering::Relaxed);
            first = end;
            progress.pairs_done = first;
            progress.engines = engines.totals(self.panel);
            progress.seconds = before + started.elapsed().as_secs_f64();
            if first < self.config.pairs && new.findings.len() + new.steps.len() >= COMMIT {
                journal.commit(&std::mem::take(&mut new), progress.clone())?;
            }
            watch(&progress);
        }
        let finished = first >= self.config.pairs;
        if finished {
            progress.pairs_done = parts.parts.iter().map(|part| part.progress.pairs_done).sum();
            progress.merging = false;
        }
        let committed = journal.commit(&new, progress);
        self.panel.check_shortage()?;
        committed?;
        if finished {
            self.write_tables(journal, whole, json)?;
        }
        let ending = if finished { Ending::Finished } else { Ending::Stopped };
        Ok(Merged { ending, unseen: unseen.into_inner() })
    }

    /// Chooses the case files of a chunk, makes them, and appends its rows to `new`. `None` where the merge is stopped meanwhile: then no row is
    /// appended, and the choice is as it was before.
    fn replay(
        &self,
        chunk: &Chunk,
        progress: &mut CampaignProgress,
        new: &mut NewRows,
        stopped: Stopped<'_>,
        unseen: &AtomicU64,
    ) -> Result<Option<Vec<CaseFile>>, RunError> {
        let before = [&progress.fingerprints, &progress.cases, &progress.step_fingerprints, &progress.step_cases];
        let before = before.map(Clone::clone);
        let counted = |seen: Option<Result<Option<Vec<u8>>, RunError>>| {
            seen.unwrap_or_else(|| {
                unseen.fetch_add(1, Ordering::Relaxed);
                Ok(None)
            })
        };
        let counts = CaseCounts { alike: &mut progress.fingerprints, of_cause: &mut progress.cases };
        let case = |found: &NumberedRow<FindingRow>| match stopped() {
            true => Ok(None),
            false => counted(self.case_of_row(&found.row, found.place)),
        };
        let kept = write_cases(
            &chunk.findings,
            each_in_threads(|found: &NumberedRow<FindingRow>| case_request(&found.row)),
            self.case_quota(),
            counts,
            in_threads(case),
        )?;
        let counts = CaseCounts { alike: &mut progress.step_fingerprints, of_cause: &mut progress.step_cases };
        let case = |found: &NumberedRow<StepFindingRow>| match stopped()
            || chunk.no_case.contains(&(found.row.index, found.place))
        {
            true => Ok(None),
            false => counted(self.step_case_of_row(&found.row, found.place)),
        };
        let kept_steps = write_cases(
            &chunk.steps,
            each_in_threads(|found: &NumberedRow<StepFindingRow>| step_case_request(&found.row)),
            self.step_case_quota(),
            counts,
            in_threads(case),
        )?;
        if stopped() {
            [progress.fingerprints, progress.cases, progress.step_fingerprints, progress.step_cases] = before;
            return Ok(None);
        }
        appended(&mut new.findings, &chunk.findings, &kept)?;
        appended(&mut new.steps, &chunk.steps, &kept_steps)?;
        Ok(Some(kept.files.into_iter().chain(kept_steps.files).collect()))
    }
}

/// Appends rows, each with the case file of its finding, which is the last column.
fn appended<R>(rows: &mut Vec<u8>, found: &[NumberedRow<R>], kept: &CaseFiles) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(rows);
    for (found, name) in found.iter().zip(&kept.names) {
        let columns = found.record.len().saturating_sub(1);
        found.record.iter().take(columns).try_for_each(|field| writer.write_field(field))?;
        let case = name.as_ref().map_or(String::new(), |name| format!("cases/{name}"));
        writer.write_field(case)?;
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(writer.flush()?)
}

/// Adds up what the parts counted, but for the pairs whose rows are there.
fn totals(parts: &Parts, mut progress: CampaignProgress) -> CampaignProgress {
    for CampaignProgress {
        summary,
        levels,
        contacts,
        metamorphic_checks,
        agreement,
        steps,
        engines,
        seconds,
        resumed,
        ..
    } in parts.parts.iter().map(|part| part.progress.clone())
    {
        progress.summary.add(summary);
        let mut sum = Levels(progress.levels);
        sum.add(&Levels(levels));
        progress.levels = sum.0;
        progress.contacts += contacts;
        progress.metamorphic_checks += metamorphic_checks;
        progress.agreement.add(agreement);
        progress.steps.add(steps);
        for (name, counts) in engines {
            engine_counts::add(&mut progress.engines, name, &counts);
        }
        progress.seconds += seconds;
        progress.resumed += resumed;
    }
    progress
}
