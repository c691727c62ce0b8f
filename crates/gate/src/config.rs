//! What a gate file says.

use super::possible_findings;
use super::setting_line::line_of_setting;
use super::toml_error::toml_error;
use rockproof_campaign::config::{CampaignConfig, SettingPlace};
use rockproof_campaign::steps::StepChange;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::{Intrusion, StepCause};
use rockproof_model::ContactKind;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use serde::Deserialize;
use std::path::PathBuf;
use toml::Spanned;

/// A gate, as its file says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GateConfig {
    /// The campaign behind the gate; its seed is the fixed one. Without `steps_every` no pair makes steps.
    #[serde(default)]
    pub campaign: CampaignConfig,
    /// Pairs of a second campaign, whose seed changes from run to run; 0 for none.
    #[serde(default)]
    pub rotating_pairs: u64,
    /// Known findings; anything else fails.
    pub baseline: Option<Baseline>,
    /// Case files and folders of them that are always examined.
    #[serde(default = "default_corpus")]
    pub corpus: Vec<PathBuf>,
    /// What may be found at most.
    #[serde(default)]
    pub limit: Vec<Spanned<FindingLimit>>,
}

/// Where known findings are kept, and which are.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// The file.
    pub file: PathBuf,
    /// The causes whose findings must be known.
    #[serde(default = "default_causes")]
    pub causes: Vec<String>,
    /// The columns of `findings.csv` that make two findings alike.
    #[serde(default = "default_fields")]
    pub fields: Vec<String>,
    /// How sure one must be that a known sort of finding became more frequent; [`CONFIDENCE`](super::CONFIDENCE) if absent.
    pub confidence: Option<f64>,
}

impl Baseline {
    /// Whether findings about external engines must be known, and so what these engines say.
    pub fn is_about_external_engines(&self) -> bool {
        self.causes.iter().any(|cause| cause == Cause::Engine.name())
    }
}

/// How many findings of a sort there may be. What a limit leaves out may be anything.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FindingLimit {
    /// The engine; or `any`, `f32`, `f64` as in `findings.csv`. Of passages and unseen overlaps the engine in whose steps they are, whoever shares them.
    pub engine: Option<String>,
    /// The tolerance set.
    pub tolerances: Option<String>,
    /// The family.
    pub family: Option<String>,
    /// The cause.
    pub cause: Option<String>,
    /// The change.
    pub change: Option<String>,
    /// The contact's kind, before the change or after it.
    pub kind: Option<String>,
    /// Only findings further from a tie than this many roundoffs; finite, from 0.
    pub beyond_ulps: Option<f64>,
    /// Findings at most, plainly counted.
    pub count: Option<u64>,
    /// Pairs with such a finding at most, as a share of the pairs examined; more is a failure only where it is no chance.
    pub rate: Option<f64>,
    /// How sure one must be that a rate is exceeded.
    pub confidence: Option<f64>,
}

fn default_corpus() -> Vec<PathBuf> {
    vec!["cases/regressions".into()]
}

fn default_causes() -> Vec<String> {
    ["arithmetic", "defect", "engine"].map(str::to_owned).to_vec()
}

fn default_fields() -> Vec<String> {
    ["engine", "cause", "change", "kind_before", "kind_after", "predicate", "family"].map(str::to_owned).to_vec()
}

/// The change that a limit names to count failures of external engines that a fresh process did not repeat. No finding has it.
pub const RECOVERED: &str = "recovered";

/// The columns a baseline may tell findings apart by.
pub const FIELDS: [&str; 9] =
    ["family", "form", "tolerances", "engine", "cause", "change", "kind_before", "kind_after", "predicate"];

impl GateConfig {
    /// The gate in a text; `file` is its name in messages.
    ///
    /// # Errors
    /// What is wrong, with the line, and what is allowed.
    pub fn from_toml(text: &str, file: &str) -> Result<GateConfig, String> {
        let told = |error: toml::de::Error| toml_error(file, text, &error);
        let mut config: GateConfig = toml::from_str(text).map_err(told)?;
        let table: toml::Table = toml::from_str(text).map_err(told)?;
        if table.is_empty() {
            return Err(format!(
                "{file}: nothing stands in it; allowed are corpus, rotating_pairs, [campaign], [baseline] and [[limit]], as in docs/gate.md"
            ));
        }
        if table.get("campaign").and_then(|campaign| campaign.get("steps_every")).is_none() {
            config.campaign.steps_every = 0;
        }
        config.campaign.settle_engines();
        let line_of_key =
            |table, key| line_of_setting(text, Some(table), &SettingPlace { engine: None, key, value: None });
        if config.campaign.stress {
            return Err(format!(
                "{file} line {}: campaign.stress is true; a gate has pairs of families: `rockproof campaign --stress --deny` is for the stress set",
                line_of_key("campaign", "stress")
            ));
        }
        if config.campaign.pairs == 0 && (!config.limit.is_empty() || config.baseline.is_some()) {
            return Err(format!(
                "{file} line {}: campaign.pairs is 0, where limits and baselines hold whatever the engines do; allowed are 1 and more",
                line_of_key("campaign", "pairs")
            ));
        }
        for limit in &config.limit {
            let place = format!("{file} line {}", line_of(text, limit.span().start));
            limit.get_ref().check().map_err(|what| format!("{place}: {what}"))?;
        }
        if let Some(baseline) = &config.baseline {
            let known: Vec<&str> = Cause::ALL.map(Cause::name).into_iter().chain(StepCause::NAMES).collect();
            for (key, list, allowed) in
                [("causes", &baseline.causes, &known[..]), ("fields", &baseline.fields, &FIELDS[..])]
            {
                if list.is_empty() {
                    let line = line_of_key("baseline", key);
                    let why = "with none every run would pass";
                    return Err(format!(
                        "{file} line {line}: baseline.{key} is empty, {why}; allowed are {}",
                        allowed.join(", ")
                    ));
                }
                if let Some(found) = list.iter().find(|name| !allowed.contains(&name.as_str())) {
                    let found = excerpt(found, EXCERPT_LENGTH);
                    let line = line_of_key("baseline", key);
                    let allowed = allowed.join(", ");
                    return Err(format!("{file} line {line}: baseline.{key} has \"{found}\"; allowed are {allowed}"));
                }
            }
            if let Some(found) = baseline.confidence.filter(|value| !is_confidence(*value)) {
                let line = line_of_key("baseline", "confidence");
                return Err(format!("{file} line {line}: baseline.confidence is {found}; {CONFIDENCES}"));
            }
        }
        Ok(config)
    }
}

const CONFIDENCES: &str = "allowed are 0.5 to below 1";

fn is_confidence(value: f64) -> bool {
    (0.5..1.0).contains(&value)
}

/// The line, from 1, of a place in a text.
pub fn line_of(text: &str, place: usize) -> usize {
    1 + text.bytes().take(place).filter(|byte| *byte == b'\n').count()
}

impl FindingLimit {
    fn check(&self) -> Result<(), String> {
        let one_of = |key: &str, value: &Option<String>, allowed: &[&str]| match value {
            Some(found) if !allowed.contains(&found.as_str()) => {
                Err(format!("{key} is \"{}\"; allowed are {}", excerpt(found, EXCERPT_LENGTH), allowed.join(", ")))
            }
            _ => Ok(()),
        };
        let causes: Vec<&str> = Cause::ALL.map(Cause::name).into_iter().chain(StepCause::NAMES).collect();
        one_of("cause", &self.cause, &causes)?;
        let of_steps = StepChange::NAMES.into_iter().chain([RECOVERED]);
        let changes: Vec<&str> = AnswerChange::ALL.map(AnswerChange::name).into_iter().chain(of_steps).collect();
        one_of("change", &self.change, &changes)?;
        one_of("kind", &self.kind, &ContactKind::ALL.map(ContactKind::name))?;
        // Compared with NaN no margin is larger, so such a limit would hold whatever is found.
        if let Some(found) = self.beyond_ulps.filter(|ulps| !(ulps.is_finite() && *ulps >= 0.0)) {
            return Err(format!("beyond_ulps is {found}; allowed are finite numbers from 0"));
        }
        if self.is_of_recovered() {
            let more = [&self.tolerances, &self.family, &self.cause, &self.kind].into_iter().any(Option::is_some);
            if more || self.beyond_ulps.is_some() || self.rate.is_some() {
                return Err(format!(
                    "a limit of change \"{RECOVERED}\" is about questions, not findings: it may name engine, and needs count"
                ));
            }
        }
        if let Some(why) = possible_findings::contradiction(self) {
            return Err(why);
        }
        match (self.count, self.rate) {
            (Some(_), None) if self.confidence.is_some() => {
                Err("the limit has confidence and count; confidence is allowed with rate alone".into())
            }
            (Some(_), None) => Ok(()),
            // No share is above 1, so such a limit would hold whatever is found.
            (None, Some(rate)) if !(0.0..1.0).contains(&rate) => {
                Err(format!("rate is {rate}; allowed are 0 to below 1"))
            }
            (None, Some(_)) => match self.confidence.filter(|value| !is_confidence(*value)) {
                Some(found) => Err(format!("confidence is {found}; {CONFIDENCES}")),
                None => Ok(()),
            },
            (Some(_), Some(_)) => Err("the limit has count and rate; allowed is one of them alone".into()),
            (None, None) => Err("the limit has neither count nor rate; one of them is needed".into()),
        }
    }

    /// Whether it counts failures that a fresh process did not repeat.
    pub fn is_of_recovered(&self) -> bool {
        self.change.as_deref() == Some(RECOVERED)
    }

    /// Whether it is about passages and unseen overlaps alone, which are looked for in steps only.
    pub fn is_of_intrusions(&self) -> bool {
        let named = |name: &Option<String>, names: &[&str]| name.as_deref().is_some_and(|name| names.contains(&name));
        named(&self.change, &Intrusion::ALL.map(Intrusion::name)) || named(&self.cause, &StepCause::NAMES)
    }

    /// The limit in one line.
    pub fn text(&self) -> String {
        let parts = [
            ("engine", &self.engine),
            ("tolerances", &self.tolerances),
            ("family", &self.family),
            ("cause", &self.cause),
            ("change", &self.change),
            ("kind", &self.kind),
        ];
        let mut words: Vec<String> =
            parts.iter().filter_map(|(key, value)| Some(format!("{key} {}", value.as_ref()?))).collect();
        words.extend(self.beyond_ulps.map(|ulps| format!("beyond {ulps} roundoffs")));
        if words.is_empty() { "all findings".to_owned() } else { words.join(", ") }
    }
}
