//! The words of a text file, each with its line.

use crate::files::is_utf16;
use crate::number::{Number, NumberError};
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::vector::Vec3;
use std::borrow::Cow;

/// A problem with the line it is on.
pub(super) type Located = (Option<usize>, SceneProblem);

/// A file whose lines end in a carriage return alone, as those of early Macintosh do, with line feeds in place of them; any other as it is.
pub(super) fn with_line_feeds(bytes: &[u8]) -> Cow<'_, [u8]> {
    if bytes.contains(&b'\n') || !bytes.contains(&b'\r') {
        return Cow::Borrowed(bytes);
    }
    Cow::Owned(bytes.iter().map(|&byte| if byte == b'\r' { b'\n' } else { byte }).collect())
}

/// The bytes of a file as text, without the mark that some editors begin one with.
pub(super) fn as_text(bytes: &[u8]) -> Result<&str, Located> {
    let not_text = |offset: usize| {
        let line = bytes[..offset].iter().filter(|&&b| b == b'\n').count() + 1;
        (Some(line), SceneProblem::NotText { offset, byte: bytes[offset] })
    };
    if is_utf16(bytes) {
        return Err((None, SceneProblem::Utf16));
    }
    if let Some(offset) = bytes.iter().position(|&b| b == 0) {
        return Err(not_text(offset));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| not_text(error.valid_up_to()))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// One word of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
}

/// Reads a text word by word.
pub(super) struct Tokens<'a> {
    rest: std::iter::Peekable<Box<dyn Iterator<Item = Token<'a>> + 'a>>,
    last_line: usize,
}

impl<'a> Tokens<'a> {
    /// The words of `text`, whose first line is `first_line`.
    pub(super) fn new(text: &'a str, first_line: usize) -> Tokens<'a> {
        let words = text.lines().enumerate().flat_map(move |(i, line)| {
            line.split_ascii_whitespace().map(move |text| Token { text, line: first_line + i })
        });
        let words: Box<dyn Iterator<Item = Token<'a>> + 'a> = Box::new(words);
        Tokens { rest: words.peekable(), last_line: first_line }
    }

    /// The next word, if there is one.
    pub(super) fn peek(&mut self) -> Option<Token<'a>> {
        self.rest.peek().copied()
    }

    /// The next word; `expected` says what it should be.
    pub(super) fn next(&mut self, expected: &str) -> Result<Token<'a>, Located> {
        match self.rest.next() {
            Some(token) => {
                self.last_line = token.line;
                Ok(token)
            }
            None => Err((Some(self.last_line), SceneProblem::Truncated { expected: expected.to_string() })),
        }
    }

    /// The next word, which must be `keyword`.
    pub(super) fn keyword(&mut self, keyword: &str) -> Result<Token<'a>, Located> {
        let expected = format!("\"{keyword}\"");
        let token = self.next(&expected)?;
        if token.text == keyword { Ok(token) } else { Err(unexpected(token, &expected)) }
    }

    /// A number of things, or a number that names one.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, Located> {
        let token = self.next(what)?;
        whole(token, what)
    }

    /// The number of one of `limit` things.
    pub(super) fn index(&mut self, what: &str, limit: usize) -> Result<usize, Located> {
        let token = self.next(what)?;
        let index = whole(token, what)?;
        if index < limit { Ok(index) } else { Err((Some(token.line), out_of(what, index, limit))) }
    }

    /// The f64 that the next word parses to.
    pub(super) fn number(&mut self, what: &str) -> Result<Number, Located> {
        let token = self.next(what)?;
        number(token, what)
    }

    /// Three numbers.
    pub(super) fn point(&mut self, what: &str) -> Result<Vec3<Number>, Located> {
        Ok(Vec3::new(self.number(what)?, self.number(what)?, self.number(what)?))
    }
}

/// "Found this where that should stand."
pub(super) fn unexpected(token: Token<'_>, expected: &str) -> Located {
    let problem =
        SceneProblem::Unexpected { found: format!("\"{}\"", shown(token.text)), expected: expected.to_string() };
    (Some(token.line), problem)
}

/// `index` where only 0 to `limit` − 1 exist.
pub(super) fn out_of(what: &str, index: impl ToString, limit: usize) -> SceneProblem {
    let allowed = match limit {
        0 => "none, there are none".to_string(),
        limit => format!("0 to {}", limit - 1),
    };
    SceneProblem::NotAllowed { what: what.to_string(), found: index.to_string(), allowed }
}

/// The non-negative integer a word stands for.
pub(super) fn whole(token: Token<'_>, what: &str) -> Result<usize, Located> {
    if token.text.is_empty() || !token.text.bytes().all(|b| b.is_ascii_digit()) {
        return Err(unexpected(token, &format!("{what}, a whole number from 0")));
    }
    let too_large = || SceneProblem::NotAllowed {
        what: what.to_string(),
        found: shown(token.text),
        allowed: format!("at most {}", u32::MAX),
    };
    match token.text.parse::<u32>() {
        Ok(value) => Ok(value as usize),
        Err(_) => Err((Some(token.line), too_large())),
    }
}

/// The f64 a word parses to (SPEC section 1).
pub(super) fn number(token: Token<'_>, what: &str) -> Result<Number, Located> {
    number_written(token, token.text, what)
}

/// The f64 that a word parses to when it is written as `text`; errors tell the word.
pub(super) fn number_written(token: Token<'_>, text: &str, what: &str) -> Result<Number, Located> {
    let fail = |error| (Some(token.line), SceneProblem::Number { what: what.to_string(), error });
    let is_plain = text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    match text.parse::<f64>() {
        Ok(value) if !is_plain || value.is_infinite() => Number::from_f64(if is_plain { value } else { f64::NAN })
            .map_err(|_| fail(NumberError::NotFinite { found: shown(token.text) })),
        Ok(value) => Number::from_f64(value).map_err(fail),
        Err(_) => Err(unexpected(token, &format!("{what}, a decimal number"))),
    }
}
