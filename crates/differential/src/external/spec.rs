//! How an external engine is named and started.

use crate::builtin::ENGINES;
use rockproof_model::Precision;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::Path;

/// What an external engine is called, how it is started and what is asked of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineSpec {
    /// The name in tables and files.
    pub name: String,
    /// The program and its arguments: a list, or a text that is split as a shell would. No shell takes part.
    #[serde(deserialize_with = "command")]
    pub command: Vec<String>,
    /// The format its input is rounded to.
    #[serde(default)]
    pub precision: NumberFormat,
    /// How long it may take for one answer, the start of the program included (ms).
    #[serde(default = "default_timeout")]
    pub timeout_ms: u64,
    /// How far a gap or a normal may be off, in units of eps times the largest coordinate; for engines that say apart,
    /// touching or overlapping.
    #[serde(default = "default_accuracy")]
    pub accuracy: u64,
}

impl EngineSpec {
    /// The argument of `--engine-command` that names it, with all that is not usual of it, for a shell.
    pub fn argument(&self) -> String {
        let mut name = self.name.clone();
        if self.precision == NumberFormat::F32 {
            name += ":f32";
        }
        if !self.has_usual_accuracy() {
            name += &format!(":{ACCURACY}:{}", self.accuracy);
        }
        if self.timeout_ms != default_timeout() {
            name += &format!(":{TIMEOUT}:{}", self.timeout_ms);
        }
        let command: Vec<String> = self.command.iter().map(|word| quoted(word)).collect();
        quoted(&format!("{name}={}", command.join(" ")))
    }
}

/// A number format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NumberFormat {
    /// Single precision.
    F32,
    /// Double precision.
    #[default]
    F64,
}

impl From<NumberFormat> for Precision {
    fn from(format: NumberFormat) -> Precision {
        match format {
            NumberFormat::F32 => Precision::F32,
            NumberFormat::F64 => Precision::F64,
        }
    }
}

const fn default_timeout() -> u64 {
    10_000
}

const fn default_accuracy() -> u64 {
    1024
}

/// Why a text or a list of specifications names no engines.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EngineSpecError {
    /// Not `NAME=COMMAND`.
    #[error(
        "\"{}\": expected NAME=COMMAND or NAME:f32=COMMAND, as in parry=./parry-client or mine:f32=python3 client.py",
        excerpt(.0, EXCERPT_LENGTH)
    )]
    Form(String),
    /// A precision that is none.
    #[error("\"{}\" in \"{}\": a precision is f32 or f64; beside it there may be {ACCURACY}:NUMBER and {TIMEOUT}:NUMBER", excerpt(.found, EXCERPT_LENGTH), excerpt(.text, EXCERPT_LENGTH))]
    Precision {
        /// What was found.
        found: String,
        /// Where.
        text: String,
    },
    /// An accuracy, or a time to answer, that is no number.
    #[error("\"{}\" in \"{}\": allowed behind `{key}:` is a whole number", excerpt(.found, EXCERPT_LENGTH), excerpt(.text, EXCERPT_LENGTH))]
    Number {
        /// `accuracy` or `timeout_ms`.
        key: &'static str,
        /// What was found.
        found: String,
        /// Where.
        text: String,
    },
    /// A name that cannot be one.
    #[error("engine name \"{name}\": allowed are letters, digits, '-', '_' and '.', at most {LONGEST_NAME} of them, the first a letter or digit, and none of any, f32, f64, {list}", name = excerpt(.0, EXCERPT_LENGTH), list = ENGINES.join(", "))]
    Name(String),
    /// Two engines of one name.
    #[error("two external engines have the name \"{}\"; each needs its own", excerpt(.0, EXCERPT_LENGTH))]
    Twice(String),
    /// A command without a program, or with an open quote.
    #[error("engine \"{}\": the command \"{}\" names no program, or a quote is not closed", excerpt(.name, EXCERPT_LENGTH), excerpt(.command, EXCERPT_LENGTH))]
    Command {
        /// The engine.
        name: String,
        /// The command.
        command: String,
    },
    /// No time to answer.
    #[error("engine \"{}\": timeout_ms is 0; allowed are 1 and more", excerpt(.0, EXCERPT_LENGTH))]
    Timeout(String),
    /// A gap might be off by so much that none is wrong.
    #[error(
        "engine \"{}\": accuracy is {found}; allowed are at most {most}, with which a gap may be off by 1/512 of the largest coordinate",
        excerpt(.name, EXCERPT_LENGTH)
    )]
    Accuracy {
        /// The engine.
        name: String,
        /// Its accuracy.
        found: u64,
        /// The greatest accuracy.
        most: u64,
    },
}

/// What stands before an accuracy in `--engine-command`, the key of a file.
const ACCURACY: &str = "accuracy";

/// The same before the time for an answer (ms).
const TIMEOUT: &str = "timeout_ms";

/// The most characters of the name of an engine.
pub const LONGEST_NAME: usize = 300;

/// Whether a text can be the name of an engine, in tables and files; no spreadsheet takes it for a formula.
pub fn is_name(text: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let begins = text.starts_with(|c: char| c.is_ascii_alphanumeric());
    begins && text.chars().all(plain) && text.len() <= LONGEST_NAME
}

/// Whether an engine that is not built in can have a name: it can stand in tables, and means nothing else there.
///
/// # Errors
/// What names are allowed.
pub fn check_name(name: &str) -> Result<(), EngineSpecError> {
    let taken = ["any", "f32", "f64"].into_iter().chain(ENGINES).any(|known| known == name);
    if is_name(name) && !taken { Ok(()) } else { Err(EngineSpecError::Name(name.to_owned())) }
}

/// A text as one word of a command, for a shell.
pub fn quoted(word: &str) -> String {
    shlex::try_quote(word).map_or_else(|_| word.to_owned(), std::borrow::Cow::into_owned)
}

/// The command that replays a case, for a shell; with the program of its engine where that is an external one.
pub fn replay_command(case: &Path, engine: Option<&EngineSpec>) -> String {
    let engine = engine.map_or(String::new(), |spec| format!(" --engine-command {}", spec.argument()));
    format!("rockproof replay {}{engine}", quoted(&case.display().to_string()))
}

fn split(command: &str) -> Option<Vec<String>> {
    shlex::split(command).filter(|words| words.first().is_some_and(|program| !program.is_empty()))
}

/// A command in a file; of what is none the error tells what stands there.
fn command<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    struct CommandVisitor;
    impl<'de> Visitor<'de> for CommandVisitor {
        type Value = Vec<String>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a text in quotes, as \"python3 client.py\", or a list of texts")
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<Vec<String>, E> {
            split(text).ok_or_else(|| {
                let text = excerpt(text, EXCERPT_LENGTH);
                E::custom(format!("\"{text}\" names no program, or a quote is not closed"))
            })
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec<String>, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(list))
        }
    }
    deserializer.deserialize_any(CommandVisitor)
}

impl EngineSpec {
    /// The engine in `NAME=COMMAND` or `NAME:f32=COMMAND`, or with more of it before the sign, as in `NAME:f32:accuracy:4096:timeout_ms:500=COMMAND`.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn parse(text: &str) -> Result<EngineSpec, EngineSpecError> {
        let (name, command) = text.split_once('=').ok_or_else(|| EngineSpecError::Form(text.to_owned()))?;
        let mut parts = name.split(':');
        let name = parts.next().unwrap_or_default().trim().to_owned();
        let (mut precision, mut timeout_ms, mut accuracy) =
            (NumberFormat::default(), default_timeout(), default_accuracy());
        while let Some(part) = parts.next() {
            let mut number = |key| {
                let found = parts.next().unwrap_or_default();
                let no_number = |_| EngineSpecError::Number { key, found: found.to_owned(), text: text.to_owned() };
                found.parse().map_err(no_number)
            };
            match part {
                "f32" => precision = NumberFormat::F32,
                "f64" => precision = NumberFormat::F64,
                ACCURACY => accuracy = number(ACCURACY)?,
                TIMEOUT => timeout_ms = number(TIMEOUT)?,
                found => {
                    return Err(EngineSpecError::Precision { found: found.to_owned(), text: text.to_owned() });
                }
            }
        }
        let command = command.to_owned();
        let words = split(&command).ok_or_else(|| EngineSpecError::Command { name: name.clone(), command })?;
        let spec = EngineSpec { name, command: words, precision, timeout_ms, accuracy };
        spec.check()?;
        Ok(spec)
    }

    /// Whether the names can stand in tables and files, and each engine can be started and waited for.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check_all(specs: &[EngineSpec]) -> Result<(), EngineSpecError> {
        for (number, spec) in specs.iter().enumerate() {
            spec.check()?;
            if specs[..number].iter().any(|other| other.name == spec.name) {
                return Err(EngineSpecError::Twice(spec.name.clone()));
            }
        }
        Ok(())
    }

    /// Whether its accuracy is that of an engine of which only the command is given.
    pub fn has_usual_accuracy(&self) -> bool {
        self.accuracy == default_accuracy()
    }

    fn check(&self) -> Result<(), EngineSpecError> {
        check_name(&self.name)?;
        if self.command.first().is_none_or(String::is_empty) {
            return Err(EngineSpecError::Command { name: self.name.clone(), command: self.command.join(" ") });
        }
        if self.timeout_ms == 0 {
            return Err(EngineSpecError::Timeout(self.name.clone()));
        }
        // What codes that iterate in f32 are off by at most (docs/benchmark_set.md).
        let most = (1.0 / (512.0 * Precision::from(self.precision).epsilon())) as u64;
        if self.accuracy > most {
            return Err(EngineSpecError::Accuracy { name: self.name.clone(), found: self.accuracy, most });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_names_precisions_and_quotes() {
        let spec = EngineSpec::parse("mine:f32=python3 'my client.py' --fast").expect("good");
        assert_eq!((spec.name.as_str(), spec.precision), ("mine", NumberFormat::F32));
        assert_eq!(spec.command, ["python3", "my client.py", "--fast"]);
        assert_eq!(EngineSpec::parse("a=b=c").expect("good").command, ["b=c"]);
    }

    #[test]
    fn an_argument_names_the_same_engine() {
        let usual = EngineSpec::parse("mine=./client --fast").expect("good");
        assert_eq!(usual.argument(), "'mine=./client --fast'");
        let f32 = EngineSpec { precision: NumberFormat::F32, ..usual.clone() };
        let loose = EngineSpec { accuracy: 4096, ..f32.clone() };
        let hasty = EngineSpec { timeout_ms: 500, ..loose.clone() };
        assert_eq!(hasty.argument(), "'mine:f32:accuracy:4096:timeout_ms:500=./client --fast'");
        let spaced = EngineSpec { timeout_ms: 60_000, command: vec!["a b".to_owned()], ..usual.clone() };
        for spec in [usual, f32, loose, hasty, spaced] {
            let words = shlex::split(&spec.argument()).expect("one word");
            assert_eq!(words.iter().map(|word| EngineSpec::parse(word)).collect::<Vec<_>>(), [Ok(spec)]);
        }
    }

    #[test]
    fn says_what_is_wrong_and_what_is_allowed() {
        for (text, told) in [
            ("client.py", "NAME=COMMAND"),
            ("=client", "allowed are letters"),
            ("f32=client", "none of any, f32, f64, stepper-f32"),
            ("stepper-f64=client", "none of any"),
            ("a b=client", "allowed are letters"),
            (&format!("{}=client", "e".repeat(301)), "at most 300 of them"),
            ("-a=client", "the first a letter or digit"),
            ("a:f16=client", "f32 or f64"),
            ("a:accuracy=client", "\"\" in \"a:accuracy=client\": allowed behind `accuracy:` is a whole number"),
            ("a:timeout_ms:-1=client", "allowed behind `timeout_ms:` is a whole number"),
            ("a:timeout_ms:0=client", "timeout_ms is 0"),
            ("a:accuracy:9000000000000=client", "accuracy is 9000000000000"),
            ("a=", "names no program"),
            ("a='client", "a quote is not closed"),
        ] {
            let fault = EngineSpec::parse(text).expect_err(text).to_string();
            assert!(fault.contains(told), "{text}: {fault}");
        }
        for (text, most) in [("a=x", 1 << 43), ("a:f32=x", 1 << 14)] {
            let with = |accuracy| EngineSpec { accuracy, ..EngineSpec::parse(text).expect("good") };
            assert_eq!(EngineSpec::check_all(&[with(most)]), Ok(()));
            let fault = EngineSpec::check_all(&[with(most + 1)]).expect_err("no gap is wrong").to_string();
            assert!(fault.contains(&format!("allowed are at most {most},")), "{fault}");
        }
        let one = EngineSpec::parse("a=x").expect("good");
        let fault = EngineSpec::check_all(&[one.clone(), one]).expect_err("twice").to_string();
        assert!(fault.contains("\"a\""), "{fault}");
    }
}
