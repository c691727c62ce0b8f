//! File names that every file system takes.

use super::seal::digest;

/// The longest stem in bytes: with an extension and what [`write_atomically`](super::write_atomically) adds while it writes it stays
/// below the 255 that a file system allows.
const LONGEST: usize = 120;
/// Hexadecimal digits of SHA-256 that tell cut stems apart.
const DIGITS: usize = 16;

/// A stem of at most 120 bytes: `stem` itself, or where it is longer its beginning and the first digits of the whole stem's SHA-256, so
/// that two that begin alike stay apart.
pub fn bounded(stem: &str) -> String {
    if stem.len() <= LONGEST {
        return stem.to_owned();
    }
    let mut end = LONGEST - DIGITS - 1;
    while !stem.is_char_boundary(end) {
        end -= 1;
    }
    format!("{}-{}", &stem[..end], &digest(stem.as_bytes())[..DIGITS])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stems_are_bounded_and_stay_apart() {
        for short in ["v-v-arithmetic", &"é".repeat(60)] {
            assert_eq!(bounded(short), short);
        }
        let long = |last: char| format!("{}{last}", "é".repeat(150));
        let cut = bounded(&long('a'));
        assert!(cut.len() <= LONGEST && cut.starts_with(&"é".repeat(50)), "{cut}");
        assert_ne!(cut, bounded(&long('b')));
        assert_eq!(bounded(&cut), cut);
    }
}
