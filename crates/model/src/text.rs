//! Texts of others in our messages and tables: block names, file names, what an engine says.

/// So many characters of a text are shown where nothing else is said.
pub const EXCERPT_LENGTH: usize = 200;

/// A text on one line that a terminal takes for text: control characters are escaped (`\n`, `\u{1b}`), those that turn the direction of
/// writing too, and what comes after `longest` characters is cut off.
pub fn excerpt(text: &str, longest: usize) -> String {
    let mut short: String = text.chars().take(longest).flat_map(harmless).collect();
    if text.chars().nth(longest).is_some() {
        short.push('…');
    }
    short
}

/// A text of any length on one line, escaped as [`excerpt`] does.
pub fn escaped(text: &str) -> String {
    text.chars().flat_map(harmless).collect()
}

/// A line of an error with more characters is cut in the middle.
const LONGEST_LINE: usize = 1000;
/// An error with more lines is cut in the middle.
const MAX_LINES: usize = 40;

/// An error whose long lines, and lines that are too many, are cut in the middle: what is wrong stands at the beginning, what is allowed at
/// the end. Parsers quote lines of a file in full, whatever their length.
pub fn cut_in_the_middle(text: &str) -> String {
    let short = |line: &str| match line.chars().count().checked_sub(LONGEST_LINE) {
        None | Some(0) => line.to_owned(),
        Some(more) => {
            let (begin, end): (String, String) =
                (line.chars().take(600).collect(), line.chars().skip(700 + more).collect());
            format!("{begin}…{end}")
        }
    };
    let mut lines: Vec<String> = text.split('\n').map(short).collect();
    if lines.len() > MAX_LINES {
        lines.splice(MAX_LINES / 2..lines.len() - MAX_LINES / 2, ["…".to_owned()]);
    }
    lines.join("\n")
}

/// Whether a text begins with `=`, `+`, `-`, `@`, a tab or a carriage return: a spreadsheet calculates a cell that does.
pub fn begins_a_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// A name or a sentence as the cell of a CSV file, [`escaped`]. Where a spreadsheet would calculate it, an apostrophe before it makes it a text. A
/// number stays as it is.
pub fn csv_cell(text: &str) -> String {
    let calculates = begins_a_formula(text) && text.parse::<f64>().is_err();
    let text = escaped(text);
    if calculates { format!("'{text}") } else { text }
}

/// Whether a character does something else than to show.
pub fn is_harmful(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns || matches!(c, '\u{2028}' | '\u{2029}')
}

fn harmless(c: char) -> impl Iterator<Item = char> {
    let escaped = is_harmful(c).then(|| c.escape_debug());
    let plain = escaped.is_none().then_some(c);
    escaped.into_iter().flatten().chain(plain)
}

/// The noun, or the verb, for a count: the first form for one, the second for any other.
pub fn noun<'n>(count: impl TryInto<u64>, one: &'n str, many: &'n str) -> &'n str {
    if matches!(count.try_into(), Ok(1)) { one } else { many }
}

#[cfg(test)]
mod tests {
    use super::{csv_cell, cut_in_the_middle, escaped, excerpt};

    #[test]
    fn no_cell_is_a_formula() {
        for formula in ["=1+1", "+cmd|x", "-2+3", "@SUM(A1)", "\t=1", "-", "\r=1"] {
            assert_eq!(csv_cell(formula), format!("'{}", escaped(formula)));
        }
        for text in ["", "a=b", "-1.5e-3", "+2", "-inf", "stepper-f32", "auto@territory*1/2"] {
            assert_eq!(csv_cell(text), text);
        }
    }

    #[test]
    fn no_cell_is_a_command_to_a_terminal() {
        assert_eq!(csv_cell("a\u{1b}[31m\n\u{202e}b"), "a\\u{1b}[31m\\n\\u{202e}b");
        assert_eq!(csv_cell("\u{1b}é, \"q\""), "\\u{1b}é, \"q\"");
    }

    #[test]
    fn nothing_reaches_a_terminal_but_what_shows() {
        let nasty = "a\n::error x\r\t\u{1b}[31m\0\u{7}\u{202e}é \"q\" \\";
        let shown = excerpt(nasty, 100);
        assert_eq!(shown, "a\\n::error x\\r\\t\\u{1b}[31m\\0\\u{7}\\u{202e}é \"q\" \\");
        assert_eq!(escaped(nasty), shown);
        assert_eq!(excerpt("abcdef", 3), "abc…");
        assert_eq!(excerpt("abc", 3), "abc");
    }

    #[test]
    fn errors_are_cut_in_the_middle() {
        let line = "é".repeat(1000);
        assert_eq!(cut_in_the_middle(&line), line);
        assert_eq!(cut_in_the_middle(&format!("a{line}b")), format!("a{}…{}b", "é".repeat(599), "é".repeat(299)));
        let many = |last: u32| (1..=last).map(|number| number.to_string()).collect::<Vec<_>>();
        assert_eq!(cut_in_the_middle(&many(40).join("\n")), many(40).join("\n"));
        let lines = cut_in_the_middle(&many(100).join("\n"));
        assert!(lines.starts_with("1\n2\n") && lines.contains("\n20\n…\n81\n") && lines.ends_with("\n100"), "{lines}");
    }
}
