//! What a run was asked to do, so that a resumed one is asked the same.

use serde_json::{Map, Value};

/// One line for each key in which two identities differ.
pub fn identity_differences(was: &Map<String, Value>, now: &Map<String, Value>) -> Vec<String> {
    let keys: std::collections::BTreeSet<&String> = was.keys().chain(now.keys()).collect();
    let shown = |value: Option<&Value>| value.map_or("absent".to_owned(), ToString::to_string);
    keys.into_iter()
        .filter(|key| was.get(*key) != now.get(*key))
        .map(|key| format!("{key}: the run has {}, asked for is {}", shown(was.get(key)), shown(now.get(key))))
        .collect()
}
