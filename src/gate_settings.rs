//! The settings of a campaign that a baseline remembers.

use rockproof_differential::external::EngineSpec;
use rockproof_differential::external::spec::NumberFormat;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// What of a campaign's identity decides what it finds, each setting as JSON; of external engines their names, and what is not usual of how they are judged.
pub(crate) fn of(identity: Map<String, Value>) -> BTreeMap<String, String> {
    let is_about_findings = |name: &str| {
        !["version", "chunk", "cases_per_fingerprint", "cases_per_cause", "shrink_evaluations"].contains(&name)
    };
    let settings = identity.into_iter().filter(|(name, value)| is_about_findings(name) && !value.is_null());
    let shown = |(name, value): (String, Value)| {
        let of_engines = value.as_array().filter(|_| name == "external").map(|engines| engines.iter().map(engine));
        (name, of_engines.map_or(value.clone(), |engines| Value::Array(engines.collect())).to_string())
    };
    settings.map(shown).collect()
}

/// An engine's name, with its precision and accuracy where they are not those of an engine of which only the command is given.
fn engine(spec: &Value) -> Value {
    let usual = EngineSpec::parse("usual=command").map(|usual| usual.accuracy);
    let Ok(spec) = serde_json::from_value::<EngineSpec>(spec.clone()) else { return spec["name"].clone() };
    let precision = (spec.precision == NumberFormat::F32).then(|| "f32".to_owned());
    let accuracy = (usual != Ok(spec.accuracy)).then(|| format!("accuracy {}", spec.accuracy));
    let words: Vec<String> = precision.into_iter().chain(accuracy).collect();
    let words = if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) };
    format!("{}{words}", spec.name).into()
}
