//! Errors of a gate's files in one style: file, line, what was found and what is allowed.

use super::config::line_of;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};

/// What is wrong with a text in TOML, whose file is called `file`.
pub fn toml_error(file: &str, text: &str, error: &toml::de::Error) -> String {
    let place = error.span().map_or(0, |span| span.start);
    let what = match header_at(text, place).filter(|_| error.message().starts_with("invalid type: map, expected a seq"))
    {
        Some(table) => format!("[{table}] is one table; allowed is a list of tables, each below [[{table}]]"),
        None => what(error.message(), key_at(text, place)),
    };
    format!("{file} line {}: {}", line_of(text, place), excerpt(&what, EXCERPT_LENGTH * 4))
}

/// What a message of the reader says, and the key that it is about.
fn what(message: &str, setting: Option<(&str, &str)>) -> String {
    let key = setting.map(|(key, _)| key);
    let named = key.map_or(String::new(), |key| format!("{} is ", excerpt(key, EXCERPT_LENGTH)));
    if let Some((found, allowed)) =
        message.strip_prefix("unknown field `").and_then(|rest| rest.split_once("`, expected "))
    {
        let allowed = allowed.strip_prefix("one of ").unwrap_or(allowed).replace('`', "").replace(" or ", ", ");
        return format!("\"{}\" is no key here; allowed are {allowed}", excerpt(found, EXCERPT_LENGTH));
    }
    if let Some(key) = message.strip_prefix("missing field `").and_then(|rest| rest.split_once('`')) {
        return format!("{} is not given, and is needed", key.0);
    }
    if let Some((found, allowed)) =
        message.strip_prefix("unknown variant `").and_then(|rest| rest.split_once("`, expected "))
    {
        let allowed = allowed.strip_prefix("one of ").unwrap_or(allowed).replace('`', "").replace(" or ", ", ");
        return format!("{named}\"{}\"; allowed are {allowed}", excerpt(found, EXCERPT_LENGTH));
    }
    if ["value was too large", "` as i128, expected", "` as u128, expected"].iter().any(|part| message.contains(part)) {
        return format!("{named}too large, or too small; allowed is a whole number from 0 to {}", i64::MAX);
    }
    let wrong = ["invalid type: ", "invalid value: "].iter().find_map(|start| message.strip_prefix(start));
    if let Some((found, expected)) = wrong.and_then(|rest| rest.rsplit_once(", expected ")) {
        // Dates are read as tables.
        let date = setting.filter(|(_, value)| found == "map" && !value.is_empty() && !value.starts_with(['{', '[']));
        let found = date.map_or_else(|| found_words(found), |(_, value)| value.to_owned());
        return format!("{named}{}; allowed is {}", excerpt(&found, EXCERPT_LENGTH), allowed_words(expected));
    }
    match key {
        Some(key) => format!("{}: {message}", excerpt(key, EXCERPT_LENGTH)),
        None => message.to_owned(),
    }
}

/// A value as it stands in the file.
fn found_words(found: &str) -> String {
    let quoted = found.split_once('`').and_then(|(_, rest)| rest.strip_suffix('`'));
    match (found.strip_prefix("string "), quoted) {
        (Some(text), _) => text.to_owned(),
        (None, Some("NaN")) => "nan".to_owned(),
        (None, Some(value)) => value.to_owned(),
        (None, None) if found == "map" => "a table".to_owned(),
        (None, None) if found == "sequence" => "a list".to_owned(),
        (None, None) => found.to_owned(),
    }
}

/// A type as the pages name it.
fn allowed_words(expected: &str) -> String {
    let words = match expected {
        "u64" | "u32" | "usize" => "a whole number from 0",
        "f64" | "f32" => "a number",
        "a string" | "string" | "path string" => "a text in quotes",
        "a sequence" | "sequence" => "a list in brackets",
        "a boolean" => "true or false",
        "a map" | "map" => "a table",
        struct_name if struct_name.starts_with("struct ") => "a table",
        other => other,
    };
    words.to_owned()
}

/// The key that a place is about, and what begins behind it: on the line of the place, or above it where its list goes over several lines.
fn key_at(text: &str, place: usize) -> Option<(&str, &str)> {
    let end = text.get(place..)?.find('\n').map_or(text.len(), |end| place + end);
    for line in text.get(..end)?.lines().rev().map(str::trim).filter(|line| !line.starts_with('#')) {
        if header(line).is_some() {
            return None;
        }
        if let Some((key, value)) =
            line.split_once('=').filter(|(key, _)| !key.trim().is_empty() && !key.contains([',', '#']))
        {
            return Some((key.trim(), value.trim()));
        }
    }
    None
}

/// The table whose head stands on the line of a place, in single brackets.
fn header_at(text: &str, place: usize) -> Option<&str> {
    let start = text.get(..place)?.rfind('\n').map_or(0, |end| end + 1);
    header(text.get(start..)?.lines().next()?.trim()).filter(|table| !table.starts_with('['))
}

/// What stands in the brackets of the head of a table.
fn header(line: &str) -> Option<&str> {
    line.split_once('#').map_or(line, |(line, _)| line.trim()).strip_prefix('[')?.strip_suffix(']')
}

#[cfg(test)]
mod tests {
    use super::toml_error;
    use crate::config::GateConfig;

    fn told(text: &str) -> String {
        let error = toml::from_str::<GateConfig>(text).expect_err("an error");
        toml_error("gate.toml", text, &error)
    }

    #[test]
    fn errors_name_the_line_what_was_found_and_what_is_allowed() {
        let limit = |line: &str| told(&format!("corpus = []\n[[limit]]\n{line}\n"));
        for (line, wanted) in [
            ("count = nan", "count is nan; allowed is a whole number from 0"),
            ("count = -1", "count is -1; allowed is a whole number from 0"),
            ("count = \"no\"", "count is \"no\"; allowed is a whole number from 0"),
            ("rate = 1e400", "rate: floating-point number overflowed"),
            ("rate = true", "rate is true; allowed is a number"),
            ("cause = 3", "cause is 3; allowed is a text in quotes"),
            ("cause = [\"defect\"]", "cause is a list; allowed is a text in quotes"),
            ("count = 1979-05-27", "count is 1979-05-27; allowed is a whole number from 0"),
            ("count = {}", "count is a table; allowed is a whole number from 0"),
            (
                "count = 99999999999999999999999",
                "count is too large, or too small; allowed is a whole number from 0 to 9223372036854775807",
            ),
        ] {
            assert_eq!(limit(line), format!("gate.toml line 3: {wanted}"));
        }
        let unknown = limit("causes = \"engine\"");
        assert!(
            unknown.starts_with("gate.toml line 3: \"causes\" is no key here; allowed are engine, tolerances, "),
            "{unknown}"
        );
        assert_eq!(told("corpus = []\n[baseline]\n"), "gate.toml line 2: file is not given, and is needed");
        assert_eq!(told("corpus = 3\n"), "gate.toml line 1: corpus is 3; allowed is a list in brackets");
        assert_eq!(
            told("corpus = []\n[limit]\ncount = 0\n"),
            "gate.toml line 2: [limit] is one table; allowed is a list of tables, each below [[limit]]"
        );
        let over_lines = told("corpus = [\n\"a\", # = 1\n3,\n]\n");
        assert_eq!(over_lines, "gate.toml line 3: corpus is 3; allowed is a text in quotes");
        let engine = told("[[campaign.external]]\nname = \"a\"\ncommand = [\"a\"]\nprecision = \"f16\"\n");
        assert_eq!(engine, "gate.toml line 4: precision is \"f16\"; allowed are f32, f64");
        let cut = told("corpus = []\n[campaign]\nfamilies = [\"sliver");
        assert!(cut.starts_with("gate.toml line 3: ") && !cut.contains('\n'), "{cut}");
    }
}
