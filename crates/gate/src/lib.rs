//! The gate for continuous integration: a campaign, a corpus of cases, limits, and a list of known findings (docs/gate.md).

pub mod config;
pub mod corpus;
pub mod junit;
pub mod known;
pub mod tally;

use config::{GateConfig, Limit, line_of};
use tally::Tally;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As it should be.
    Pass,
    /// Not as it should be.
    Fail,
    /// Not examined; why is in the check's text.
    Skip,
}

impl Verdict {
    /// `pass`, `FAIL` or `skip`.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
            Verdict::Skip => "skip",
        }
    }
}

/// One check of a gate.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// `limit`, `baseline` or `corpus`.
    pub group: &'static str,
    /// What was checked.
    pub name: String,
    /// What was found, and what is allowed.
    pub told: String,
    /// How it came out.
    pub verdict: Verdict,
    /// The file it is about, and the line in it.
    pub place: (String, usize),
    /// The rows of the tally it fails for.
    pub rows: Vec<usize>,
}

/// How sure one must be that a rate is exceeded, where a limit does not say.
pub const CONFIDENCE: f64 = 0.999;

/// Checks the limits of a gate file against what a campaign found; `run` names the campaign.
pub fn limits(config: &GateConfig, (file, text): (&str, &str), run: &str, tally: &Tally) -> Vec<Check> {
    let check = |limit: &toml::Spanned<Limit>| {
        let place = (file.to_owned(), line_of(text, limit.span().start));
        let limit = limit.get_ref();
        let found = tally.count(limit);
        let (failed, told) = if let Some(count) = limit.count {
            (found.findings > count, format!("{} findings, at most {count}", found.findings))
        } else {
            let rate = limit.rate.unwrap_or(1.0);
            let chance = found.chance(rate);
            let told = format!(
                "{} of {} pairs ({:.3e}), at most {rate}; by chance with probability {chance:.2e}",
                found.pairs,
                found.examined,
                found.rate()
            );
            (found.rate() > rate && chance < 1.0 - limit.confidence.unwrap_or(CONFIDENCE), told)
        };
        let rows = (0..tally.rows.len()).filter(|&at| failed && tally.rows[at].is_of(limit)).collect();
        let verdict = if failed { Verdict::Fail } else { Verdict::Pass };
        Check { group: "limit", name: format!("{run}: {}", limit.text()), told, verdict, place, rows }
    };
    config.limit.iter().map(check).collect()
}
