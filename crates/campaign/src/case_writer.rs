//! Which findings get a case file, and making them.

use super::run::RunError;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// The case file that is asked for a finding.
pub(super) struct CaseRequest {
    pub(super) fingerprint: String,
    /// The cause, and what else of it has a quota of its own.
    pub(super) cause: String,
    pub(super) name: String,
    /// Set where the finding is too far from a tie for rounding to be the reason.
    pub(super) furthest: Option<FurthestFinding>,
}

/// A finding far from a tie: it gets a file, whatever else has one, if it is further away than all before it.
pub(super) struct FurthestFinding {
    /// What it is compared with: findings about the same engine, of the same cause.
    pub(super) key: String,
    /// The decade of its margin in roundoffs, above 0.
    pub(super) decade: u64,
}

/// How many case files there may be.
pub(super) struct CaseQuota {
    /// Of one cause.
    pub(super) of_cause: u64,
    /// Of one fingerprint.
    pub(super) alike: u64,
}

/// How many case files there are.
pub(super) struct CaseCounts<'p> {
    /// Of each fingerprint.
    pub(super) alike: &'p mut BTreeMap<String, u64>,
    /// Of each cause.
    pub(super) of_cause: &'p mut BTreeMap<String, u64>,
}

/// Whether there is room for a file, of findings alike and of one cause. Between chunks the counts only grow, and so does the
/// furthest decade: what has no room before one chunk has none in any later one.
pub(super) fn has_room(
    alike: &BTreeMap<String, u64>,
    of_cause: &BTreeMap<String, u64>,
    request: &CaseRequest,
    quota: &CaseQuota,
) -> bool {
    let count = |counts: &BTreeMap<String, u64>, key: &str| counts.get(key).copied().unwrap_or(0);
    let usual = count(alike, &request.fingerprint) < quota.alike && count(of_cause, &request.cause) < quota.of_cause;
    let furthest = request.furthest.as_ref().is_some_and(|furthest| furthest.decade > count(alike, &furthest.key));
    usual || furthest && quota.of_cause > 0
}

impl CaseCounts<'_> {
    fn has_room(&self, request: &CaseRequest, quota: &CaseQuota) -> bool {
        has_room(self.alike, self.of_cause, request, quota)
    }

    /// Counts a file and gives the furthest decade before it, where that has grown.
    fn add(&mut self, request: &CaseRequest) -> Option<u64> {
        *self.alike.entry(request.fingerprint.clone()).or_default() += 1;
        *self.of_cause.entry(request.cause.clone()).or_default() += 1;
        let furthest = request.furthest.as_ref()?;
        let known = self.alike.entry(furthest.key.clone()).or_default();
        (furthest.decade > *known).then(|| std::mem::replace(known, furthest.decade))
    }

    /// Takes [`CaseCounts::add`] back.
    fn release(&mut self, request: &CaseRequest, before: Option<u64>) {
        if let (Some(furthest), Some(before)) = (&request.furthest, before)
            && self.alike.get(&furthest.key) == Some(&furthest.decade)
        {
            match before {
                0 => self.alike.remove(&furthest.key),
                before => self.alike.insert(furthest.key.clone(), before),
            };
        }
        for (counts, key) in
            [(&mut *self.alike, request.fingerprint.as_str()), (&mut *self.of_cause, request.cause.as_str())]
        {
            let left = counts.get(key).map_or(0, |count| count - 1);
            if left == 0 {
                counts.remove(key);
            } else {
                counts.insert(key.to_owned(), left);
            }
        }
    }
}

/// The case files of some findings.
pub(super) struct CaseFiles {
    /// The name of each finding's file, if it has one.
    pub(super) names: Vec<Option<String>>,
    /// The files by name.
    pub(super) files: Vec<(String, Vec<u8>)>,
    /// Where the findings stand whose file cannot be made.
    pub(super) failed: Vec<usize>,
}

impl CaseFiles {
    /// No files, of so many findings.
    pub(super) fn none(findings: usize) -> CaseFiles {
        CaseFiles { names: vec![None; findings], files: Vec::new(), failed: Vec::new() }
    }
}

/// Findings whose requests or rows one thread makes at least: they cost little.
pub(super) const ROWS: usize = 64;

/// So often files of other findings are tried in place of those that could not be made.
const ROUNDS: usize = 4;

/// Whether a finding's case file was requested, accepted or made.
#[derive(Clone, PartialEq, Eq)]
enum CaseStatus {
    Requested,
    /// With the furthest decade before it.
    Granted(Option<u64>),
    Made(Vec<u8>),
    /// Its file cannot be made.
    None,
}

/// Files made, in the order in which they were asked for; `None` where one cannot be made.
pub(super) type MadeFiles = Result<Vec<Option<Vec<u8>>>, RunError>;

/// Makes files on the threads of the pool that this is called in.
pub(super) fn in_threads<F: Sync>(
    file: impl Fn(&F) -> Result<Option<Vec<u8>>, RunError> + Sync,
) -> impl Fn(&[&F]) -> MadeFiles {
    move |findings| findings.par_iter().map(|finding| file(finding)).collect()
}

/// The requests of findings, one after the other.
pub(super) fn each<F>(request: impl Fn(&F) -> CaseRequest) -> impl FnOnce(&[F]) -> Vec<CaseRequest> {
    move |findings| findings.iter().map(request).collect()
}

/// The same on the threads of the pool that this is called in.
pub(super) fn each_in_threads<F: Sync>(
    request: impl Fn(&F) -> CaseRequest + Sync,
) -> impl FnOnce(&[F]) -> Vec<CaseRequest> {
    move |findings| findings.par_iter().with_min_len(ROWS).map(&request).collect()
}

/// Accepts the first requests within the quota, has `make` make the files, and counts and names those that are there afterwards. Where a file
/// cannot be made (`None`) the place is free again, for the next findings and for later calls.
pub(super) fn write_cases<F>(
    findings: &[F],
    requests: impl FnOnce(&[F]) -> Vec<CaseRequest>,
    quota: CaseQuota,
    mut counts: CaseCounts<'_>,
    make: impl Fn(&[&F]) -> MadeFiles,
) -> Result<CaseFiles, RunError> {
    let requests = requests(findings);
    let mut statuses = vec![CaseStatus::Requested; findings.len()];
    let mut names: BTreeSet<&str> = BTreeSet::new();
    for _ in 0..ROUNDS {
        for (request, status) in
            requests.iter().zip(&mut statuses).filter(|(_, status)| **status == CaseStatus::Requested)
        {
            // Two findings of one pair may be alike in everything the name tells; the first stands for both.
            if counts.has_room(request, &quota) && names.insert(&request.name) {
                *status = CaseStatus::Granted(counts.add(request));
            }
        }
        let granted = statuses.iter().enumerate();
        let granted: Vec<(usize, Option<u64>)> = granted
            .filter_map(
                |(at, status)| if let CaseStatus::Granted(before) = status { Some((at, *before)) } else { None },
            )
            .collect();
        let made = make(&granted.iter().map(|&(at, _)| &findings[at]).collect::<Vec<_>>())?;
        let mut freed = false;
        for ((at, before), made) in granted.into_iter().zip(made) {
            statuses[at] = match made {
                Some(bytes) => CaseStatus::Made(bytes),
                None => {
                    counts.release(&requests[at], before);
                    names.remove(requests[at].name.as_str());
                    freed = true;
                    CaseStatus::None
                }
            };
        }
        if !freed {
            break;
        }
    }
    let failed = (0..statuses.len()).filter(|&at| statuses[at] == CaseStatus::None).collect();
    let mut kept = CaseFiles { names: Vec::new(), files: Vec::new(), failed };
    for (request, status) in requests.into_iter().zip(statuses) {
        let CaseStatus::Made(bytes) = status else {
            kept.names.push(None);
            continue;
        };
        kept.names.push(Some(request.name.clone()));
        kept.files.push((request.name, bytes));
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_there_and_what_cannot_be_made_takes_no_place() {
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let request = |number: &u32| CaseRequest {
            fingerprint: format!("kind {}", number % 2),
            cause: "tolerance".to_owned(),
            name: format!("{number}.toml"),
            furthest: None,
        };
        let mut kept = |findings: &[u32]| {
            let counts = CaseCounts { alike: &mut alike, of_cause: &mut of_cause };
            let file = |number: &u32| Ok((*number != 1 && *number != 2).then(|| number.to_string().into_bytes()));
            let CaseFiles { names, files, .. } = write_cases(
                findings,
                each_in_threads(request),
                CaseQuota { of_cause: 3, alike: 2 },
                counts,
                in_threads(file),
            )
            .expect("files");
            assert!(names.iter().flatten().eq(files.iter().map(|(name, _)| name)), "{names:?}");
            names.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        // Of 0, 2 and 4 two may have a file, and 2 cannot be made: 4 has its place. 1 cannot be made, and no other odd one is there.
        assert_eq!(kept(&[0, 1, 2, 4]), [true, false, false, true]);
        // Nothing is left for even ones. Three of the cause may be there: one more, 3.
        assert_eq!(kept(&[6, 8, 1, 3, 5]), [false, false, false, true, false]);
        assert_eq!(alike, BTreeMap::from([("kind 0".to_owned(), 2), ("kind 1".to_owned(), 1)]));
        assert_eq!(of_cause, BTreeMap::from([("tolerance".to_owned(), 3)]));
    }

    #[test]
    fn findings_alike_in_name_share_the_first_file() {
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let counts = CaseCounts { alike: &mut alike, of_cause: &mut of_cause };
        let request = |_: &u32| CaseRequest {
            fingerprint: "kind".to_owned(),
            cause: "defect".to_owned(),
            name: "same.toml".to_owned(),
            furthest: None,
        };
        let file = |number: &u32| Ok(Some(number.to_string().into_bytes()));
        let kept = write_cases(&[1, 2], each(request), CaseQuota { of_cause: 9, alike: 9 }, counts, in_threads(file))
            .expect("files");
        assert_eq!(kept.names, [Some("same.toml".to_owned()), None]);
        assert_eq!(kept.files, [("same.toml".to_owned(), b"1".to_vec())]);
    }

    #[test]
    fn what_is_further_from_a_tie_than_all_before_has_a_file() {
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let mut kept = |findings: &[u64]| {
            let counts = CaseCounts { alike: &mut alike, of_cause: &mut of_cause };
            let request = |decade: &u64| CaseRequest {
                fingerprint: "kind".to_owned(),
                cause: "arithmetic".to_owned(),
                name: format!("{decade}.toml"),
                furthest: (*decade > 0).then(|| FurthestFinding { key: "furthest".to_owned(), decade: *decade }),
            };
            let file = |decade: &u64| Ok((*decade != 9).then(Vec::new));
            let kept =
                write_cases(findings, each(request), CaseQuota { of_cause: 1, alike: 1 }, counts, in_threads(file))
                    .expect("files");
            kept.names.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        // One of the kind, and 4 and 7 beyond it; 5 is behind 7, and 9 cannot be made.
        assert_eq!(kept(&[0, 4, 7, 5, 9]), [true, true, true, false, false]);
        assert_eq!(kept(&[0, 6, 8]), [false, false, true]);
        assert_eq!(alike.get("furthest"), Some(&8));
    }
}
