//! A part of a campaign: a share of its pairs, examined in a directory of its own, by another process or on another machine.
//!
//! Whether a finding gets a case file depends on all findings before it, so a part makes none: [`crate::merge`] chooses and makes them. Of
//! steps a part keeps which findings cannot have one, for that is found out by making the step again.

use super::run::RunError;
use super::steps::{self, StepFinding, StepSummary};
use rockproof_differential::agreement::Agreement;
use rockproof_differential::attribution::{PairExamination, examine_pair};
use rockproof_differential::builtin;
use rockproof_differential::finding::Finding;
use rockproof_differential::subject::PairSource;
use rockproof_results::{Seal, digest};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Which part of how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Part {
    of: u64,
    number: u64,
}

/// Why a text names no part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is no part: allowed are K/N with K from 1 to N, as in 3/8")]
pub struct PartFault(String);

impl FromStr for Part {
    type Err = PartFault;

    fn from_str(text: &str) -> Result<Part, PartFault> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Part { of, number }),
            _ => Err(PartFault(text.to_owned())),
        }
    }
}

impl TryFrom<String> for Part {
    type Error = PartFault;

    fn try_from(text: String) -> Result<Part, PartFault> {
        text.parse()
    }
}

impl From<Part> for String {
    fn from(part: Part) -> String {
        part.to_string()
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl Part {
    /// The key of a part in the configuration of its run.
    pub const KEY: &'static str = "part";

    /// Which one, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// Of how many.
    pub fn of(self) -> u64 {
        self.of
    }

    /// Its pairs, of so many: whole batches, and of any two parts as many or one batch more. Empty where there are more parts than batches.
    pub fn pairs(self, pairs: u64, batch_len: u64) -> Range<u64> {
        let batches = u128::from(pairs.div_ceil(batch_len));
        let end = |number: u64| {
            let batches = batches * u128::from(number) / u128::from(self.of);
            u64::try_from(batches * u128::from(batch_len)).map_or(pairs, |end| end.min(pairs))
        };
        end(self.number - 1)..end(self.number)
    }
}

/// What a part's journal holds beside that of a whole campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartProgress {
    /// Where it runs.
    pub machine: Machine,
    /// What `no_case.csv` held; none where no pair makes steps.
    pub no_case: Option<Seal>,
    /// Findings about steps that can have a case file, as many of each fingerprint as a campaign keeps.
    pub fingerprints: BTreeMap<String, u64>,
    /// The same of each cause.
    pub causes: BTreeMap<String, u64>,
}

/// A machine, and what it answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// The operating system.
    pub os: String,
    /// The processor's architecture.
    pub architecture: String,
    /// SHA-256 of what the built-in engines and the oracle say about the first pairs. The same program says the same everywhere; a build or
    /// a processor that does not shows here, before its findings are mixed with others.
    pub answers: String,
}

/// Batches that are asked about.
const FIRST_BATCHES: u64 = 4;

impl Machine {
    /// This machine, asked about the first pairs of a source and their steps. External engines are not asked: they may be slow, and what
    /// they say is theirs.
    ///
    /// # Errors
    /// When a table cannot be written.
    pub fn current(source: &dyn PairSource) -> Result<Machine, RunError> {
        let names = builtin::ENGINES.map(str::to_owned);
        let panel = builtin::panel(&names, 1).map_err(RunError::Engine)?;
        let steppers = steps::engines(builtin::ENGINES);
        let mut said = Vec::new();
        let (mut agreement, mut steps) = (Agreement::default(), StepSummary::default());
        for subject in (0..FIRST_BATCHES).flat_map(|number| source.batch(number)) {
            let PairExamination { findings, agreement: of_pair, .. } = examine_pair(&subject, &panel);
            agreement.add_record(of_pair);
            said.extend(super::run::rows(&findings, &vec![None; findings.len()], Finding::row)?);
            if let Some(motion) = source.motion(&subject) {
                let made = steps::examine_all(&[(&subject, motion)], &steppers);
                said.extend(super::run::rows(&made.findings, &vec![None; made.findings.len()], StepFinding::row)?);
                steps.add(made.summary);
            }
        }
        said.extend(agreement.to_csv()?);
        said.extend(agreement.confusion_to_csv()?);
        said.extend(steps.to_csv()?);
        Ok(Machine {
            os: std::env::consts::OS.to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            answers: digest(&said),
        })
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.os, self.architecture)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_written_k_of_n_and_nothing_else() {
        assert_eq!("3/8".parse::<Part>(), Ok(Part { of: 8, number: 3 }));
        assert_eq!("3/8".parse::<Part>().expect("a part").to_string(), "3/8");
        for wrong in ["", "3", "0/8", "9/8", "1/0", "-1/2", "1/2/3", "a/b", "1 / 2"] {
            let error = wrong.parse::<Part>().expect_err(wrong).to_string();
            assert!(error.contains("K from 1 to N"), "{error}");
        }
    }

    #[test]
    fn parts_hold_each_batch_once_in_order_and_are_about_as_large() {
        for (pairs, batch_len, of) in
            [(0, 16, 3), (1, 16, 3), (2688, 16, 7), (1000, 16, 4), (100, 16, 90), (u64::MAX, 16, 9)]
        {
            let parts: Vec<_> = (1..=of).map(|number| Part { of, number }.pairs(pairs, batch_len)).collect();
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, pairs));
            for two in parts.windows(2) {
                assert_eq!(two[0].end, two[1].start);
            }
            assert!(parts.iter().all(|part| part.start % batch_len == 0 || part.start == pairs), "{parts:?}");
            let batches = |part: &Range<u64>| (part.end - part.start).div_ceil(batch_len);
            let (least, most) = (parts.iter().map(batches).min(), parts.iter().map(batches).max());
            assert!(most <= least.map(|least| least + 1), "{parts:?}");
        }
    }
}
