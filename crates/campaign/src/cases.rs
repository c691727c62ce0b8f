//! The case files of a campaign: which findings get one, and how it is made.

use super::case_writer::{
    CaseCounts, CaseFiles, CaseQuota, CaseRequest, FurthestFinding, ROWS, each, each_in_threads, in_threads,
    write_cases,
};
use super::journal::{CampaignProgress, NewRows};
use super::run::{Campaign, RunError, Stopped, rows};
use super::shrink::Shrinker;
use super::steps::{self, StepFinding, StepFindingRow};
use rayon::prelude::*;
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::case_file::Case;
use rockproof_differential::external::without_counting_details;
use rockproof_differential::finding::{FAR_FROM_TIE, Finding, Fingerprint};
use rockproof_differential::lockstep::Intrusion;
use rockproof_differential::motion::PairMotion;
use rockproof_differential::row::FindingRow;
use rockproof_differential::subject::Subject;
use serde::Serialize;

/// A case file: its name and its content.
pub(super) type CaseFile = (String, Vec<u8>);

/// Of findings about steps one case is kept where of others so many are: they are larger, and each is a step made some ten times.
const STEP_CASES: u64 = 4;

/// The case file that the finding of a row would get.
pub(super) fn case_request(row: &FindingRow) -> CaseRequest {
    let fingerprint = Fingerprint::of_row(row);
    let name = format!("{}.toml", fingerprint.file_stem(&row.tolerances, row.index));
    let far = row.margin_ulps.map(f64::abs).filter(|ulps| *ulps > FAR_FROM_TIE);
    let furthest = far.map(|ulps| FurthestFinding {
        key: format!("furthest {} {}", row.engine, row.cause),
        decade: ulps.log10().floor() as u64,
    });
    CaseRequest { fingerprint: fingerprint.text(), cause: row.cause.name().to_owned(), name, furthest }
}

/// The same of a finding about a step. Passages and unseen overlaps, which are rarer and worse than other differences, do not share their quota.
pub(super) fn step_case_request(row: &StepFindingRow) -> CaseRequest {
    let intrusion = Intrusion::ALL.into_iter().find(|kind| kind.name() == row.change);
    let cause = match intrusion {
        Some(kind) => format!("{} {}", row.cause.name(), kind.name()),
        None => row.cause.name().to_owned(),
    };
    CaseRequest { fingerprint: row.fingerprint(), cause, name: row.file_name(), furthest: None }
}

/// [`rows`], on the threads of the pool that this is called in.
fn rows_in_threads<F: Sync, R: Serialize>(
    findings: &[F],
    names: &[Option<String>],
    row: impl Fn(&F, String) -> R + Sync,
) -> Result<Vec<u8>, csv::Error> {
    let parts = findings.par_chunks(ROWS).zip(names.par_chunks(ROWS));
    let parts: Vec<Vec<u8>> = parts.map(|(findings, names)| rows(findings, names, &row)).collect::<Result<_, _>>()?;
    Ok(parts.concat())
}

impl Campaign<'_> {
    /// How many case files there may be.
    pub(super) fn case_quota(&self) -> CaseQuota {
        CaseQuota { of_cause: self.config.cases_per_cause, alike: self.config.cases_per_fingerprint }
    }

    /// The same of findings about steps.
    pub(super) fn step_case_quota(&self) -> CaseQuota {
        CaseQuota { of_cause: self.config.cases_per_cause / STEP_CASES, ..self.case_quota() }
    }

    /// The rows of a chunk's findings and their case files. A part makes no case files. Where the run is stopped meanwhile, the rest is not
    /// made, and what comes of it is to be thrown away.
    pub(super) fn chosen(
        &self,
        findings: &[Finding],
        stepped: &[StepFinding],
        progress: &mut CampaignProgress,
        stopped: Stopped<'_>,
    ) -> Result<(NewRows, Vec<CaseFile>), RunError> {
        let (kept, kept_steps, no_case) = if progress.part.is_some() {
            let no_case = self.without_case(stepped, progress, stopped)?;
            (CaseFiles::none(findings.len()), CaseFiles::none(stepped.len()), no_case)
        } else {
            let kept = self.keep_cases(findings, progress, stopped)?;
            (kept, self.keep_step_cases(stepped, progress, stopped)?, Vec::new())
        };
        let new = NewRows {
            findings: rows_in_threads(findings, &kept.names, Finding::row)?,
            steps: rows_in_threads(stepped, &kept_steps.names, StepFinding::row)?,
            no_case,
        };
        Ok((new, kept.files.into_iter().chain(kept_steps.files).collect()))
    }

    /// Keeps case files of findings: the first few of each fingerprint, and those further from a tie than all before.
    fn keep_cases(
        &self,
        findings: &[Finding],
        progress: &mut CampaignProgress,
        stopped: Stopped<'_>,
    ) -> Result<CaseFiles, RunError> {
        let request = |finding: &Finding| case_request(&finding.row(String::new()));
        let counts = CaseCounts { alike: &mut progress.fingerprints, of_cause: &mut progress.cases };
        let case = |finding: &Finding| if stopped() { Ok(None) } else { self.case(finding) };
        write_cases(findings, each_in_threads(request), self.case_quota(), counts, in_threads(case))
    }

    /// The same of findings about steps: the first few of each fingerprint.
    fn keep_step_cases(
        &self,
        findings: &[StepFinding],
        progress: &mut CampaignProgress,
        stopped: Stopped<'_>,
    ) -> Result<CaseFiles, RunError> {
        let request = |finding: &StepFinding| step_case_request(&finding.row(String::new()));
        let counts = CaseCounts { alike: &mut progress.step_fingerprints, of_cause: &mut progress.step_cases };
        let case = |finding: &StepFinding| if stopped() { Ok(None) } else { self.step_case(finding) };
        write_cases(findings, each_in_threads(request), self.step_case_quota(), counts, in_threads(case))
    }

    /// Rows of `no_case.csv`: of the findings about steps that a campaign of this part alone would keep, those that cannot have a case file.
    /// Finding that out is most of what a merge would have to do again.
    fn without_case(
        &self,
        findings: &[StepFinding],
        progress: &mut CampaignProgress,
        stopped: Stopped<'_>,
    ) -> Result<Vec<u8>, RunError> {
        let Some(part) = &mut progress.part else { return Ok(Vec::new()) };
        let request = |finding: &StepFinding| step_case_request(&finding.row(String::new()));
        let counts = CaseCounts { alike: &mut part.fingerprints, of_cause: &mut part.causes };
        let tried = |finding: &StepFinding| {
            if stopped() {
                return Ok(None);
            }
            let moving = self.source.moving(finding.index, &finding.family);
            let possible = moving
                .is_some_and(|(subject, motion)| steps::case::is_possible(finding, &subject, &motion, self.steppers));
            Ok(possible.then(Vec::new))
        };
        let kept = write_cases(findings, each(request), self.step_case_quota(), counts, in_threads(tried))?;
        let mut rows = Vec::new();
        for at in kept.failed {
            let index = findings[at].index;
            let before = findings[..at].iter().rev().take_while(|finding| finding.index == index).count();
            rows.extend(format!("{index},{before}\n").into_bytes());
        }
        Ok(rows)
    }

    /// The subject of a pair.
    pub(super) fn subject(&self, index: u64) -> Option<Subject> {
        let subjects = self.source.batch(index / self.source.batch_len());
        subjects.into_iter().find(|subject| subject.index == index)
    }

    /// The pairs of an index that move, and how they do, in the order in which a campaign makes their steps.
    fn moving(&self, index: u64) -> Vec<(Subject, PairMotion)> {
        let of_index = self.subject(index).and_then(|subject| Some((self.source.motion(&subject)?, subject)));
        let beside = self.source.step_pairs(index / self.source.batch_len());
        let beside = beside.into_iter().filter(|(subject, _)| subject.index == index);
        of_index.map(|(motion, subject)| (subject, motion)).into_iter().chain(beside).collect()
    }

    /// The case file of a finding, made small; none where the pair alone does not show the finding again.
    fn case(&self, finding: &Finding) -> Result<Option<Vec<u8>>, RunError> {
        let panel = (self.narrow)(finding);
        let shrunk = without_counting_details(|| {
            let case = self.subject(finding.index).and_then(|s| Case::of(finding, &s, self.config.seed, &panel));
            case.map(|case| Shrinker::new(&panel, self.config.shrink_evaluations).shrink(case))
        });
        Ok(shrunk.map(|case| case.to_toml()).transpose()?.map(String::into_bytes))
    }

    /// The case file of a finding about a step; none where the oracle's step ends in a stop, so that there is no answer to record, or where
    /// the step does not show the finding again.
    fn step_case(&self, finding: &StepFinding) -> Result<Option<Vec<u8>>, RunError> {
        let Some((subject, motion)) = self.source.moving(finding.index, &finding.family) else { return Ok(None) };
        let case = steps::case::of(finding, &subject, &motion, self.steppers, self.config.shrink_evaluations);
        Ok(case.map(|case| case.text()).transpose()?)
    }

    /// The finding behind a row, the `place`-th of its pair, from 0: the pair is examined again. `None` where it does not say the same,
    /// which an external engine may do.
    fn finding_again(&self, row: &FindingRow, place: usize) -> Option<Finding> {
        let findings = examine_pair(&self.subject(row.index)?, self.panel).findings;
        findings.into_iter().nth(place).filter(|finding| finding.row(String::new()) == *row)
    }

    /// The same of a finding about a step.
    fn step_finding_again(&self, row: &StepFindingRow, place: usize) -> Option<StepFinding> {
        let moving = self.moving(row.index);
        let moving: Vec<_> = moving.iter().map(|(subject, motion)| (subject, motion.clone())).collect();
        let findings = steps::examine_all(&moving, self.steppers).findings;
        findings.into_iter().nth(place).filter(|finding| finding.row(String::new()) == *row)
    }

    /// The case file of the finding behind a row, if the pair shows that again.
    pub(super) fn case_of_row(&self, row: &FindingRow, place: usize) -> Option<Result<Option<Vec<u8>>, RunError>> {
        let finding = without_counting_details(|| self.finding_again(row, place))?;
        Some(self.case(&finding))
    }

    /// The same of a finding about a step.
    pub(super) fn step_case_of_row(
        &self,
        row: &StepFindingRow,
        place: usize,
    ) -> Option<Result<Option<Vec<u8>>, RunError>> {
        Some(self.step_case(&self.step_finding_again(row, place)?))
    }
}
