//! Seals: what a file held when it was written, so that a changed one is never gone on from.

use super::bounded_read::read_whole;
use super::error::ResultsError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::Path;

/// What the beginning of a table was when it was last made durable.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seal {
    /// How many bytes are sealed; what comes after them does not count.
    pub bytes: u64,
    /// Their SHA-256 in hexadecimal digits.
    pub sha256: String,
}

/// SHA-256 in hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What stands before the seal of a JSON object; the seal is its last value.
const BEFORE: &str = ",\"sha256\":\"";
/// What stands after it.
const AFTER: &str = "\"}\n";
const DIGITS: usize = 64;

/// A JSON object that is not empty, with one value more: the SHA-256 of everything before it.
pub(crate) fn sealed(object: &str) -> String {
    let body = object.trim_end().strip_suffix('}').unwrap_or(object).trim_end();
    format!("{body}{BEFORE}{}{AFTER}", digest(body.as_bytes()))
}

/// The object without its seal; what is wrong where the seal is broken.
pub(crate) fn unsealed(text: &str) -> Result<String, &'static str> {
    let place = text.len().checked_sub(BEFORE.len() + DIGITS + AFTER.len()).filter(|&at| text.is_char_boundary(at));
    let (body, seal) = place.map(|at| text.split_at(at)).ok_or("it has no seal")?;
    let found = seal.strip_prefix(BEFORE).and_then(|seal| seal.strip_suffix(AFTER)).ok_or("it has no seal")?;
    if found == digest(body.as_bytes()) { Ok(format!("{body}}}")) } else { Err("it is not as it was written") }
}

/// Reads a sealed JSON object.
pub(crate) fn read_sealed<T: DeserializeOwned>(file: &Path) -> Result<T, ResultsError> {
    let text = read_whole(file).map_err(ResultsError::at(file))?;
    let text = std::str::from_utf8(&text).map_err(|e| ResultsError::damaged(file, e))?;
    let object = unsealed(text).map_err(|what| ResultsError::damaged(file, what))?;
    serde_json::from_str(&object).map_err(|e| ResultsError::damaged(file, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digest_is_sha_256() {
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(digest(b"abc"), expected, "FIPS 180-2, appendix B.1");
    }

    #[test]
    fn no_bit_of_a_sealed_object_can_change() {
        for object in ["{\"a\":1,\"b\":\"é\"}", "{\n  \"a\": 1\n}\n"] {
            let text = sealed(object);
            let value = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
            assert_eq!(value(&unsealed(&text).expect("whole")), value(object));
            assert_eq!(value(&text)["a"], 1, "a sealed object is JSON");
            for at in 0..text.len() {
                for bit in 0..8 {
                    let mut bytes = text.clone().into_bytes();
                    bytes[at] ^= 1 << bit;
                    let Ok(changed) = String::from_utf8(bytes) else { continue };
                    assert!(unsealed(&changed).is_err(), "{changed}");
                }
                assert!(!text.is_char_boundary(at) || unsealed(&text[..at]).is_err());
            }
        }
    }
}
