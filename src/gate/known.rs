//! The baseline: findings that are known, by what makes them alike.

use super::config::Baseline;
use super::tally::Tally;
use super::{Check, Verdict};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The file of known findings.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// The columns of `findings.csv` a line is made of.
    pub fields: Vec<String>,
    /// How many findings of each fingerprint there were when the file was written.
    pub known: BTreeMap<String, u64>,
}

impl Known {
    /// The fingerprints in what a campaign found.
    pub fn of(tally: &Tally, baseline: &Baseline) -> Known {
        let mut known = BTreeMap::new();
        for row in tally.rows.iter().filter(|row| baseline.causes.iter().any(|c| c == row.get("cause"))) {
            *known.entry(row.fingerprint(baseline)).or_default() += 1;
        }
        Known { fields: baseline.fields.clone(), known }
    }

    /// The file's text.
    ///
    /// # Errors
    /// Those of the TOML writer.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        Ok(format!("# Known findings, written by `rockproof gate --update-baseline`.\n{}", toml::to_string(self)?))
    }

    /// The checks of what a campaign found against what is known: one for each fingerprint that is new, or one that passes.
    pub fn check(&self, tally: &Tally, baseline: &Baseline) -> Vec<Check> {
        let place = (baseline.file.display().to_string(), 1);
        let now = Known::of(tally, baseline);
        let new = now.known.iter().filter(|(fingerprint, _)| !self.known.contains_key(*fingerprint));
        let mut checks: Vec<Check> = new
            .map(|(fingerprint, count)| Check {
                group: "baseline",
                name: format!("new: {fingerprint}"),
                told: format!("{count} findings that the baseline does not know"),
                verdict: Verdict::Fail,
                place: place.clone(),
                rows: (0..tally.rows.len())
                    .filter(|&at| tally.rows[at].fingerprint(baseline) == *fingerprint)
                    .collect(),
            })
            .collect();
        if checks.is_empty() {
            let gone = self.known.keys().filter(|fingerprint| !now.known.contains_key(*fingerprint)).count();
            let told = format!("{} known sorts of finding, {gone} of them gone, none new", self.known.len());
            let name = "no new findings".to_owned();
            checks.push(Check { group: "baseline", name, told, verdict: Verdict::Pass, place, rows: Vec::new() });
        }
        checks
    }
}
