//! Texts of others in our messages and tables: block names, file names, what an engine says.

/// So many characters of a text are shown where nothing else is said.
pub const SHOWN: usize = 200;

/// A text on one line that a terminal takes for text: control characters are escaped (`\n`, `\u{1b}`), those that turn the direction of
/// writing too, and what comes after `longest` characters is cut off.
pub fn excerpt(text: &str, longest: usize) -> String {
    let mut short: String = text.chars().take(longest).flat_map(harmless).collect();
    if text.chars().nth(longest).is_some() {
        short.push('…');
    }
    short
}

/// Whether a text begins with `=`, `+`, `-`, `@`, a tab or a carriage return: a spreadsheet calculates a cell that does.
pub fn begins_a_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r'])
}

/// A name or a sentence as the cell of a CSV file. Where a spreadsheet would calculate it, an apostrophe before it makes it a text. A
/// number stays as it is.
pub fn csv_cell(text: &str) -> String {
    let calculates = begins_a_formula(text) && text.parse::<f64>().is_err();
    if calculates { format!("'{text}") } else { text.to_owned() }
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

#[cfg(test)]
mod tests {
    use super::{csv_cell, excerpt};

    #[test]
    fn no_cell_is_a_formula() {
        for formula in ["=1+1", "+cmd|x", "-2+3", "@SUM(A1)", "\t=1", "-", "\r=1"] {
            assert_eq!(csv_cell(formula), format!("'{formula}"));
        }
        for text in ["", "a=b", "-1.5e-3", "+2", "-inf", "stepper-f32", "auto@territory*1/2"] {
            assert_eq!(csv_cell(text), text);
        }
    }

    #[test]
    fn nothing_reaches_a_terminal_but_what_shows() {
        let nasty = "a\n::error x\r\t\u{1b}[31m\0\u{7}\u{202e}é \"q\" \\";
        let shown = excerpt(nasty, 100);
        assert_eq!(shown, "a\\n::error x\\r\\t\\u{1b}[31m\\0\\u{7}\\u{202e}é \"q\" \\");
        assert_eq!(excerpt("abcdef", 3), "abc…");
        assert_eq!(excerpt("abc", 3), "abc");
    }
}
