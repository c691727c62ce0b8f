//! Which findings get a case file, and writing them.

use super::journal::at;
use super::run::RunError;
use crate::model::files::write_atomically;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// The case file that a finding would get.
pub(super) struct Wish {
    pub(super) fingerprint: String,
    pub(super) cause: &'static str,
    pub(super) name: String,
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
        count(self.alike, &wish.fingerprint) < most.alike && count(self.of_cause, wish.cause) < most.of_cause
    }

    fn add(&mut self, wish: &Wish) {
        *self.alike.entry(wish.fingerprint.clone()).or_default() += 1;
        *self.of_cause.entry(wish.cause.to_owned()).or_default() += 1;
    }

    fn take_back(&mut self, wish: &Wish) {
        for (counts, key) in [(&mut *self.alike, wish.fingerprint.as_str()), (&mut *self.of_cause, wish.cause)] {
            if let Some(count) = counts.get_mut(key) {
                *count -= 1;
            }
            counts.retain(|_, count| *count > 0);
        }
    }
}

/// Grants the first wishes, writes the files, and counts and names those that are there afterwards. A file that cannot be made (`None`)
/// takes nobody's place among later findings.
pub(super) fn keep<F: Sync>(
    findings: &[F],
    wish: impl Fn(&F) -> Wish,
    most: Most,
    mut counts: Counts<'_>,
    dir: &Path,
    file: impl Fn(&F) -> Result<Option<Vec<u8>>, RunError> + Sync,
) -> Result<Vec<Option<String>>, RunError> {
    let mut wishes: Vec<Option<Wish>> = Vec::with_capacity(findings.len());
    for finding in findings {
        let wish = wish(finding);
        // Two findings of one pair may be alike in everything the name tells; the first stands for both.
        let granted = counts.allow(&wish, &most) && !wishes.iter().flatten().any(|other| other.name == wish.name);
        if granted {
            counts.add(&wish);
        }
        wishes.push(granted.then_some(wish));
    }
    let write = |(finding, wish): (&F, &Option<Wish>)| -> Result<bool, RunError> {
        let Some(wish) = wish else { return Ok(false) };
        let Some(bytes) = file(finding)? else { return Ok(false) };
        let path = dir.join(&wish.name);
        write_atomically(&path, &bytes).map_err(at(&path))?;
        Ok(true)
    };
    let written: Vec<bool> = findings.par_iter().zip(&wishes).map(write).collect::<Result<_, _>>()?;
    let name = |(wish, written): (Option<Wish>, bool)| {
        let wish = wish?;
        if !written {
            counts.take_back(&wish);
            return None;
        }
        Some(wish.name)
    };
    Ok(wishes.into_iter().zip(written).map(name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_there_and_what_cannot_be_made_takes_no_place() {
        let dir = tempfile::tempdir().expect("a folder");
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let wish = |number: &u32| Wish {
            fingerprint: format!("kind {}", number % 2),
            cause: "tolerance",
            name: format!("{number}.toml"),
        };
        let mut kept = |findings: &[u32]| {
            let counts = Counts { alike: &mut alike, of_cause: &mut of_cause };
            let file = |number: &u32| Ok((*number != 1 && *number != 2).then(|| number.to_string().into_bytes()));
            let names = keep(findings, wish, Most { of_cause: 3, alike: 2 }, counts, dir.path(), file).expect("files");
            let there = |name: &Option<String>| name.as_ref().is_none_or(|name| dir.path().join(name).is_file());
            assert!(names.iter().all(there), "{names:?}");
            names.iter().map(Option::is_some).collect::<Vec<_>>()
        };
        // The even ones are 0 and 2 (a third would be one too many), the odd one 1; of them only 0 can be made.
        assert_eq!(kept(&[0, 1, 2, 4]), [true, false, false, false]);
        // The places of 1 and 2 are free: for 6 as the second of its kind, for 3; then three of the cause are there.
        assert_eq!(kept(&[6, 8, 3, 5]), [true, false, true, false]);
        assert_eq!(alike, BTreeMap::from([("kind 0".to_owned(), 2), ("kind 1".to_owned(), 1)]));
        assert_eq!(of_cause, BTreeMap::from([("tolerance".to_owned(), 3)]));
    }

    #[test]
    fn findings_alike_in_name_share_the_first_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let (mut alike, mut of_cause) = (BTreeMap::new(), BTreeMap::new());
        let counts = Counts { alike: &mut alike, of_cause: &mut of_cause };
        let wish = |_: &u32| Wish { fingerprint: "kind".to_owned(), cause: "defect", name: "same.toml".to_owned() };
        let file = |number: &u32| Ok(Some(number.to_string().into_bytes()));
        let names = keep(&[1, 2], wish, Most { of_cause: 9, alike: 9 }, counts, dir.path(), file).expect("files");
        assert_eq!(names, [Some("same.toml".to_owned()), None]);
        assert_eq!(std::fs::read(dir.path().join("same.toml")).expect("a file"), b"1");
    }
}
