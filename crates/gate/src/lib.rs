//! The gate for continuous integration: a campaign, a corpus of cases, limits, and a list of known findings (docs/gate.md).

pub mod answers;
pub mod comparison;
pub mod config;
mod contradiction;
pub mod corpus;
pub mod junit;
pub mod known_findings;
pub mod limit_count;
pub mod limit_scope;
mod possible_findings;
pub mod setting_line;
pub mod tally;
pub mod tally_row;
pub mod toml_error;

use config::{FindingLimit, GateConfig, RECOVERED, line_of};
use rockproof_model::text::noun;
use tally::CampaignTally;

/// How a check came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStatus {
    /// As it should be.
    Pass,
    /// Not as it should be.
    Fail,
    /// Not examined; why is in the check's text.
    Skip,
}

impl CheckStatus {
    /// `pass`, `FAIL` or `skip`.
    pub fn name(self) -> &'static str {
        match self {
            CheckStatus::Pass => "pass",
            CheckStatus::Fail => "FAIL",
            CheckStatus::Skip => "skip",
        }
    }
}

/// One check of a gate.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// `limit`, `engine`, `baseline`, `corpus`, or `gate` for what is checked of the gate itself.
    pub group: &'static str,
    /// What was checked.
    pub name: String,
    /// What was found, and what is allowed.
    pub message: String,
    /// How it came out.
    pub status: CheckStatus,
    /// The file it is about, and the line in it.
    pub place: (String, usize),
    /// The rows of the tally it fails for.
    pub rows: Vec<usize>,
    /// How long it took (s). The time of a campaign is shared out among its checks.
    pub seconds: f64,
    /// The command that replays a case which shows why it fails.
    pub replay: Option<String>,
}

/// How sure one must be that a rate is exceeded, where a limit does not say.
pub const CONFIDENCE: f64 = 0.999;

/// Checks the limits of a gate file against what a campaign found; `run` names the campaign.
pub fn limits(config: &GateConfig, (file, text): (&str, &str), run: &str, tally: &CampaignTally) -> Vec<Check> {
    let check = |limit: &toml::Spanned<FindingLimit>| {
        let place = (file.to_owned(), line_of(text, limit.span().start));
        let limit = limit.get_ref();
        let found = tally.count(limit);
        let fails_from = limit.rate.and_then(|rate| found.fails_from(rate, limit.confidence.unwrap_or(CONFIDENCE)));
        let (failed, message) = if let (Some(count), true) = (limit.count, limit.is_of_recovered()) {
            let message = format!(
                "{} {} that a fresh process did not repeat, at most {count}",
                found.findings,
                noun(found.findings, "failure", "failures")
            );
            (found.findings > count, message)
        } else if let Some(count) = limit.count {
            (
                found.findings > count,
                format!("{} {}, at most {count}", found.findings, noun(found.findings, "finding", "findings")),
            )
        } else {
            let (rate, confidence) = (limit.rate.unwrap_or(1.0), limit.confidence.unwrap_or(CONFIDENCE));
            let from = match fails_from {
                Some(from) => format!("fails from {from} on"),
                None => "so few pairs can never fail".to_owned(),
            };
            let message = format!(
                "{} of {} {} ({:.3e}), at most {rate}, {from}; by chance with probability {:.2e}",
                found.pairs,
                found.examined,
                noun(found.examined, "pair", "pairs"),
                found.rate(),
                found.chance(rate)
            );
            (found.exceeds(rate, confidence), message)
        };
        let given = limit_scope::given_note(limit, config, tally).map_or(String::new(), |note| format!("; {note}"));
        let message = message + &given;
        let rows = (0..tally.rows.len()).filter(|&at| failed && tally.rows[at].is_of(limit)).collect();
        let unreached = || {
            let unbreakable = limit_scope::unbreakable(limit, config).or_else(|| tally.missing(limit));
            let unsaid = unbreakable.or_else(|| limit_scope::unsaid(limit, config, tally));
            unsaid.or_else(|| limit_scope::seldom(limit, config, tally))
        };
        let (status, message) = match unreached() {
            _ if failed => (CheckStatus::Fail, message),
            Some(why) => (CheckStatus::Skip, why),
            None if limit.rate.is_some() && fails_from.is_none() => (CheckStatus::Skip, message),
            None => (CheckStatus::Pass, message),
        };
        Check {
            group: "limit",
            name: format!("{run}: {}", limit.text()),
            message,
            status,
            place,
            rows,
            seconds: 0.0,
            replay: None,
        }
    };
    config.limit.iter().map(check).chain(recovered(config, file, run, tally)).collect()
}

/// A check that fails where all of the gate in `file` were skipped: nothing of the engines was checked, so the gate cannot pass.
pub fn nothing_checked(checks: &[Check], file: &str) -> Option<Check> {
    let all_skipped = !checks.is_empty() && checks.iter().all(|check| check.status == CheckStatus::Skip);
    all_skipped.then(|| Check {
        group: "gate",
        name: "the gate checks something".to_owned(),
        message: "every check was skipped, for the reasons given, so nothing was checked".to_owned(),
        status: CheckStatus::Fail,
        place: (file.to_owned(), 1),
        rows: Vec::new(),
        seconds: 0.0,
        replay: None,
    })
}

/// How many checks passed, were skipped and failed, in words.
pub fn summary(checks: &[Check]) -> String {
    let of = |status| checks.iter().filter(|check| check.status == status).count();
    let [passed, skipped, failed] = [CheckStatus::Pass, CheckStatus::Skip, CheckStatus::Fail].map(of);
    let none = if passed + failed == 0 && skipped > 0 { "; nothing was checked" } else { "" };
    format!("{passed} passed, {skipped} skipped, {failed} failed{none}")
}

/// Says of engines whose failures did not repeat that they had some, where no limit names these: such a failure is no finding, so all limits may
/// hold of an engine that crashes every now and then.
fn recovered<'x>(
    config: &'x GateConfig,
    file: &'x str,
    run: &'x str,
    tally: &'x CampaignTally,
) -> impl Iterator<Item = Check> + 'x {
    let limited = |engine: &str| {
        let of = config.limit.iter().map(toml::Spanned::get_ref).filter(|limit| limit.is_of_recovered());
        of.into_iter().any(|limit| limit.engine.as_ref().is_none_or(|name| name == engine))
    };
    let rows = tally.engines.iter().filter(move |row| row.recovered > 0 && !limited(&row.engine));
    rows.map(move |row| Check {
        group: "limit",
        name: format!("{run}: engine {}, change {RECOVERED}", row.engine),
        message: format!(
            "{} of {} questions failed and were answered by a fresh process; no limit names them",
            row.recovered, row.asked
        ),
        status: CheckStatus::Skip,
        place: (file.to_owned(), 1),
        rows: Vec::new(),
        seconds: 0.0,
        replay: None,
    })
}
