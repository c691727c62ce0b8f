//! The settings of a campaign that a baseline remembers.

use rockproof_differential::external::EngineSpec;
use rockproof_model::Precision;
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

/// An engine's name, with its precision, and its accuracy where that is not the usual one. Earlier versions wrote the name alone.
fn engine(spec: &Value) -> Value {
    let Ok(spec) = serde_json::from_value::<EngineSpec>(spec.clone()) else { return spec["name"].clone() };
    let accuracy = if spec.has_usual_accuracy() { String::new() } else { format!(", accuracy {}", spec.accuracy) };
    format!("{} ({}{accuracy})", spec.name, Precision::from(spec.precision)).into()
}
