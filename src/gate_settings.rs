//! The settings of a campaign that a baseline remembers.

use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// What of a campaign's identity decides what it finds, each setting as JSON; of external engines their names.
pub(crate) fn of(identity: Map<String, Value>) -> BTreeMap<String, String> {
    let is_about_findings = |name: &str| {
        !["version", "chunk", "cases_per_fingerprint", "cases_per_cause", "shrink_evaluations"].contains(&name)
    };
    let settings = identity.into_iter().filter(|(name, value)| is_about_findings(name) && !value.is_null());
    let shown = |(name, value): (String, Value)| {
        let names = |engines: &Vec<Value>| engines.iter().map(|engine| engine["name"].clone()).collect::<Vec<_>>();
        let of_engines = value.as_array().filter(|_| name == "external").map(names);
        (name, of_engines.map_or(value, Value::Array).to_string())
    };
    settings.map(shown).collect()
}
