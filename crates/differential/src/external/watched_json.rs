//! JSON with the keys that are there twice in one object: `serde_json` keeps the last value of a key and tells nothing of the others.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// A value, and the first key found that an object in it has twice.
pub(super) struct WatchedJson {
    pub(super) value: Value,
    pub(super) repeated: Option<String>,
}

impl<'d> Deserialize<'d> for WatchedJson {
    fn deserialize<D: Deserializer<'d>>(deserializer: D) -> Result<WatchedJson, D::Error> {
        deserializer.deserialize_any(JsonVisitor)
    }
}

struct JsonVisitor;

impl From<Value> for WatchedJson {
    fn from(value: Value) -> WatchedJson {
        WatchedJson { value, repeated: None }
    }
}

impl<'d> Visitor<'d> for JsonVisitor {
    type Value = WatchedJson;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E: Error>(self) -> Result<WatchedJson, E> {
        Ok(Value::Null.into())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<WatchedJson, E> {
        Ok(Value::from(value).into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<WatchedJson, E> {
        Ok(Value::from(value).into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<WatchedJson, E> {
        Ok(Value::from(value).into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<WatchedJson, E> {
        Ok(Value::from(value).into())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<WatchedJson, E> {
        Ok(Value::from(value).into())
    }

    fn visit_seq<A: SeqAccess<'d>>(self, mut list: A) -> Result<WatchedJson, A::Error> {
        let (mut values, mut first) = (Vec::new(), None);
        while let Some(WatchedJson { value, repeated }) = list.next_element()? {
            values.push(value);
            first = first.or(repeated);
        }
        Ok(WatchedJson { value: values.into(), repeated: first })
    }

    fn visit_map<A: MapAccess<'d>>(self, mut object: A) -> Result<WatchedJson, A::Error> {
        let (mut values, mut first) = (Map::new(), None);
        while let Some((key, WatchedJson { value, repeated })) = object.next_entry::<String, WatchedJson>()? {
            first = first.or(repeated);
            if values.contains_key(&key) {
                first = first.or_else(|| Some(key.clone()));
            }
            values.insert(key, value);
        }
        Ok(WatchedJson { value: values.into(), repeated: first })
    }
}
