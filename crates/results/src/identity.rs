//! What a run was asked to do, so that a resumed one is asked the same.

use serde_json::{Map, Value};

/// One line for each key in which two identities differ.
pub fn identity_differences(was: &Map<String, Value>, now: &Map<String, Value>) -> Vec<String> {
    let keys: std::collections::BTreeSet<&String> = was.keys().chain(now.keys()).collect();
    keys.into_iter()
        .filter(|key| was.get(*key) != now.get(*key))
        .map(|key| {
            format!("{key}: the run has {}, asked for is {}", setting_text(was.get(key)), setting_text(now.get(key)))
        })
        .collect()
}

/// A setting as people read it: an empty list names nothing, which for most settings means all there is.
pub fn setting_text(value: Option<&Value>) -> String {
    match value {
        None => "not set".to_owned(),
        Some(Value::Array(list)) if list.is_empty() => "none named".to_owned(),
        Some(value) => value.to_string(),
    }
}
