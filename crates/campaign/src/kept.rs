//! Which findings get a case file, and making them.

use super::run::RunError;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// The case file that a finding would get.
pub(super) struct Wish {
    pub(super) fingerprint: String,
    pub(super) cause: &'static str,
    pub(super) name: String,
    /// Set where the finding is too far from a tie for rounding to be the reason.
    pub(super) record: Option<Record>,
}

/// A finding far from a tie, which gets a file whatever else has one if none so far has been kept.
pub(super) struct Record {
    /// What it is compared with: findings about the same engine, of the same cause.
    pub(super) key: String,
    /// The decade of its margin in roundoffs, above 0.
    pub(super) decade: u64,
}

/// How many case files there may be.
pub(super) struct Most {
    /// Of one cause.
    pub(super) of_cause: u64,
    /// Of one fingerprint.
    pub(super) alike: u64,
}

/// How many case files there are.
pub(super) struct Counts<'p> {
    /// Of each fingerprint.
    pub(super) alike: &'p mut BTreeMap<String, u64>,
    /// Of each cause.
    pub(super) of_cause: &'p mut BTreeMap<String, u64>,
}

impl Counts<'_> {
    fn allow(&self, wish: &Wish, most: &Most) -> bool {
        let count = |counts: &BTreeMap<String, u64>, key: &str| counts.get(key).copied().unwrap_or(0);
        let usual =
            count(self.alike, &wish.fingerprint) < most.alike && count(self.of_cause, wish.cause) < most.of_cause;
        let record = wish.record.as_ref().is_some_and(|record| record.decade > count(self.alike, &record.key));
        usual || record && most.of_cause > 0
    }

    /// Counts a file and gives what the record was before.
    fn add(&mut self, wish: &Wish) -> Option<u64> {
        *self.alike.entry(wish.fingerprint.clone()).or_default() += 1;
        *self.of_cause.entry(wish.cause.to_owned()).or_default() += 1;
        let record = wish.record.as_ref()?;
        let known = self.alike.entry(record.key.clone()).or_default();
        (record.decade > *known).then(|| std::mem::replace(known, record.decade))
    }

    /// Takes [`Counts::add`] back.
    fn take_back(&mut self, wish: &Wish, before: Option<u64>) {
        if let (Some(record), Some(before)) = (&wish.record, before)
            && self.alike.get(&record.key) == Some(&record.decade)
        {
            match before {
                0 => self.alike.remove(&record.key),
                before => self.alike.insert(record.key.clone(), before),
            };
        }
        for (counts, key) in [(&mut *self.alike, wish.fingerprint.as_str()), (&mut *self.of_cause, wish.cause)] {
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
pub(super) struct Kept {
    /// The name of each finding's file, if it has one.
    pub(super) names: Vec<Option<String>>,
    /// The files by name.
    pub(super) files: Vec<(String, Vec<u8>)>,
    /// Where the findings stand whose file cannot be made.
    pub(super) failed: Vec<usize>,
}

impl Kept {
    /// No files, of so many findings.
    pub(super) fn none(findings: usize) -> Kept {
        Kept { names: vec![None; findings], files: Vec::new(), failed: Vec::new() }
    }
}

/// So often files of other findings are tried in place of those that could not be made.
const ROUNDS: usize = 4;

/// Where a finding stands.
#[derive(Clone, PartialEq, Eq)]
enum Place {
    Waiting,
    /// With the record before it.
    Granted(Option<u64>),
    Made(Vec<u8>),
    /// Its file cannot be made.
    None,
}

/// Grants the first wishes, makes the files, and counts and names those that are there afterwards. Where a file cannot be made (`None`)
/// the place is free again, for the next findings and for later calls.
pub(super) fn keep<F: Sync>(
    findings: &[F],
    wish: impl Fn(&F) -> Wish,
    most: Most,
    mut counts: Counts<'_>,
    file: impl Fn(&F) -> Result<Option<Vec<u8>>, RunError> + Sync,
) -> Result<Kept, RunError> {
    let wishes: Vec<Wish> = findings.iter().map(wish).collect();
    let mut places = vec![Place::Waiting; findings.len()];
    let mut names: BTreeSet<&str> = BTreeSet::new();
    for _ in 0..ROUNDS {
        for (wish, place) in wishes.iter().zip(&mut places).filter(|(_, place)| **place == Place::Waiting) {
            // Two findings of one pair may be alike in everything the name tells; the first stands for both.
            if counts.allow(wish, &most) && names.insert(&wish.name) {
                *place = Place::Granted(counts.add(wish));
            }
        }
        let granted = places.iter().enumerate();
        let granted: Vec<(usize, Option<u64>)> = granted
            .filter_map(|(at, place)| if let Place::Granted(before) = place { Some((at, *before)) } else { None })
            .collect();
        let made: Vec<Option<Vec<u8>>> =
            granted.par_iter().map(|&(at, _)| file(&findings[at])).collect::<Result<_, RunError>>()?;
        let mut freed = false;
        for ((at, before), made) in granted.into_iter().zip(made) {
            places[at] = match made {
                Some(bytes) => Place::Made(bytes),
                None => {
                    counts.take_back(&wishes[at], before);
                    names.remove(wishes[at].name.as_str());
                    freed = true;
                    Place::None
                }
            };
        }
        if !freed {
            break;
        }
    }
    let failed = (0..places.len()).filter(|&at| places[at] == Place::None).collect();
    let mut kept = Kept { names: Vec::new(), files: Vec::new(), failed };
    for (wish, place) in wishes.into_iter().zip(places) {
        let Place::Made(bytes) = place else {
            kept.names.push(None);
            continue;
        };
        kept.names.push(Some(wish.name.clone()));
        kept.files.push((wish.name, bytes));
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_there_and_what_cannot_be_made_takes_no_place() {
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let wish = |number: &u32| Wish {
            fingerprint: format!("kind {}", number % 2),
            cause: "tolerance",
            name: format!("{number}.toml"),
            record: None,
        };
        let mut kept = |findings: &[u32]| {
            let counts = Counts { alike: &mut alike, of_cause: &mut of_cause };
            let file = |number: &u32| Ok((*number != 1 && *number != 2).then(|| number.to_string().into_bytes()));
            let Kept { names, files, .. } =
                keep(findings, wish, Most { of_cause: 3, alike: 2 }, counts, file).expect("files");
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
        let counts = Counts { alike: &mut alike, of_cause: &mut of_cause };
        let wish = |_: &u32| Wish {
            fingerprint: "kind".to_owned(),
            cause: "defect",
            name: "same.toml".to_owned(),
            record: None,
        };
        let file = |number: &u32| Ok(Some(number.to_string().into_bytes()));
        let kept = keep(&[1, 2], wish, Most { of_cause: 9, alike: 9 }, counts, file).expect("files");
        assert_eq!(kept.names, [Some("same.toml".to_owned()), None]);
        assert_eq!(kept.files, [("same.toml".to_owned(), b"1".to_vec())]);
    }

    #[test]
    fn what_is_further_from_a_tie_than_all_before_has_a_file() {
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let mut kept = |findings: &[u64]| {
            let counts = Counts { alike: &mut alike, of_cause: &mut of_cause };
            let wish = |decade: &u64| Wish {
                fingerprint: "kind".to_owned(),
                cause: "arithmetic",
                name: format!("{decade}.toml"),
                record: (*decade > 0).then(|| Record { key: "furthest".to_owned(), decade: *decade }),
            };
            let file = |decade: &u64| Ok((*decade != 9).then(Vec::new));
            let kept = keep(findings, wish, Most { of_cause: 1, alike: 1 }, counts, file).expect("files");
            kept.names.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        // One of the kind, and 4 and 7 beyond it; 5 is behind 7, and 9 cannot be made.
        assert_eq!(kept(&[0, 4, 7, 5, 9]), [true, true, true, false, false]);
        assert_eq!(kept(&[0, 6, 8]), [false, false, true]);
        assert_eq!(alike.get("furthest"), Some(&8));
    }
}
