//! The words and numbers of a mesh file, in ASCII or binary.
//!
//! A binary file has its headings, names and, in version 2, its counts in ASCII as well.

use crate::number::Number;
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::{Located, Token, Tokens, as_text, out_of, unexpected, whole};
use crate::text::{EXCERPT_LENGTH, excerpt};
use crate::vector::Vec3;

/// A file, read from front to back.
pub(super) enum Input<'a> {
    Text(Tokens<'a>),
    Binary(Bytes<'a>),
}

/// A binary file.
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Bytes of a count or number of version 4.
    width: usize,
}

/// Where something stands.
#[derive(Clone, Copy)]
pub(super) enum InputPosition {
    Line(usize),
    Byte(usize),
}

impl InputPosition {
    /// Its line, if it has one.
    pub(super) fn line(self) -> Option<usize> {
        match self {
            InputPosition::Line(line) => Some(line),
            InputPosition::Byte(_) => None,
        }
    }

    /// What a message calls something here.
    pub(super) fn name(self, what: &str) -> String {
        match self {
            InputPosition::Line(_) => what.to_owned(),
            InputPosition::Byte(at) => format!("{what}, at byte {at} of the file,"),
        }
    }
}

/// Whether the second word of the heading says so.
fn is_binary(bytes: &[u8]) -> bool {
    let Some(rest) = bytes.trim_ascii_start().strip_prefix(b"$MeshFormat") else { return false };
    let mut words = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    words.nth(1) == Some(b"1")
}

impl<'a> Input<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Result<Input<'a>, Located> {
        if is_binary(bytes) {
            return Ok(Input::Binary(Bytes { bytes, at: 0, big_endian: false, width: 8 }));
        }
        Ok(Input::Text(Tokens::new(as_text(bytes)?, 1)))
    }

    pub(super) fn is_binary(&self) -> bool {
        matches!(self, Input::Binary(_))
    }

    /// Reads what a binary file has behind its heading: the number 1, which shows the order of bytes. `width` is that of a count.
    pub(super) fn begin_binary(&mut self, width: usize) -> Result<(), Located> {
        let Input::Binary(input) = self else { return Ok(()) };
        input.width = width;
        let at = input.at;
        match input.take("the number 1 that shows the order of bytes")? {
            [1, 0, 0, 0] => Ok(()),
            [0, 0, 0, 1] => {
                input.big_endian = true;
                Ok(())
            }
            found => {
                let what = InputPosition::Byte(at).name("the number that shows the order of bytes");
                Err(not_allowed(what, format!("{found:02x?}"), "1 in four bytes"))
            }
        }
    }

    /// Where the next word or number stands.
    pub(super) fn position(&mut self) -> InputPosition {
        match self {
            Input::Text(tokens) => InputPosition::Line(tokens.peek().map_or(0, |token| token.line)),
            Input::Binary(input) => InputPosition::Byte(input.at),
        }
    }

    /// The next word. Behind one a binary file has the end of a line, and numbers begin after it.
    pub(super) fn word(&mut self, what: &str) -> Result<Token<'a>, Located> {
        match self {
            Input::Text(tokens) => tokens.next(what),
            Input::Binary(input) => input.word(what),
        }
    }

    /// The next word, which must be `keyword`.
    pub(super) fn keyword(&mut self, keyword: &str) -> Result<(), Located> {
        let position = self.position();
        let expected = format!("\"{keyword}\"");
        let token = self.word(&expected)?;
        if token.text == keyword { Ok(()) } else { Err(other(token, position, &expected)) }
    }

    /// The heading of the next section without its `$`; none at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<&'a str>, Located> {
        let is_over = match self {
            Input::Text(tokens) => tokens.peek().is_none(),
            Input::Binary(input) => input.bytes[input.at..].trim_ascii().is_empty(),
        };
        if is_over {
            return Ok(None);
        }
        let position = self.position();
        let heading = self.word("a section")?;
        match heading.text.strip_prefix('$') {
            Some(name) => Ok(Some(name)),
            None => Err(other(heading, position, "a section, which begins with $")),
        }
    }

    /// Goes to the end of a section of which nothing is kept.
    pub(super) fn skip(&mut self, section: &str) -> Result<(), Located> {
        let end = format!("$End{section}");
        match self {
            Input::Text(tokens) => {
                while tokens.peek().is_some_and(|token| token.text != end) {
                    tokens.next("an entry of a section")?;
                }
            }
            Input::Binary(input) => {
                let rest = &input.bytes[input.at..];
                let found = rest.windows(end.len()).position(|window| window == end.as_bytes());
                input.at += found.unwrap_or(rest.len());
            }
        }
        Ok(())
    }

    /// The rest of the line of a name in quotes, which may have spaces.
    pub(super) fn name(&mut self) -> Result<String, Located> {
        let position = self.position();
        let mut last = self.word("the name of a physical group")?;
        let first = last;
        let mut words = vec![first.text];
        while words.len() == 1 && first.text == "\"" || !last.text.ends_with('"') {
            let is_more = match self {
                Input::Text(tokens) => tokens.peek().is_some_and(|token| token.line == first.line),
                Input::Binary(input) => !input.is_new_line(),
            };
            if !is_more {
                return Err(other(first, position, "a name in quotes"));
            }
            last = self.word("the name of a physical group")?;
            words.push(last.text);
        }
        let name = words.join(" ");
        let name = name.trim_matches('"');
        if name.chars().any(char::is_control) {
            return Err(other(Token { text: name, line: first.line }, position, "a name without control characters"));
        }
        Ok(name.to_owned())
    }

    /// A number in ASCII that is not negative, also in a binary file.
    pub(super) fn plain_count(&mut self, what: &str) -> Result<usize, Located> {
        let position = self.position();
        let token = self.word(what)?;
        whole(token, &position.name(what)).map_err(|(line, problem)| (position.line().and(line), problem))
    }

    /// A whole number in ASCII, also in a binary file.
    pub(super) fn plain_integer(&mut self, what: &str) -> Result<i64, Located> {
        let position = self.position();
        let token = self.word(what)?;
        token.text.parse().map_err(|_| other(token, position, &format!("{what}, a whole number")))
    }

    /// A whole number of four bytes.
    pub(super) fn integer(&mut self, what: &str) -> Result<i64, Located> {
        match self {
            Input::Text(_) => self.plain_integer(what),
            Input::Binary(input) => input.integer(what).map(i64::from),
        }
    }

    /// A whole number of four bytes that is not negative.
    pub(super) fn small_count(&mut self, what: &str) -> Result<usize, Located> {
        match self {
            Input::Text(_) => self.plain_count(what),
            Input::Binary(input) => {
                let position = InputPosition::Byte(input.at);
                let found = input.integer(what)?;
                usize::try_from(found).map_err(|_| not_allowed(position.name(what), found.to_string(), "0 or more"))
            }
        }
    }

    /// One of `limit` things, of four bytes.
    pub(super) fn index(&mut self, what: &str, limit: usize) -> Result<usize, Located> {
        let position = self.position();
        let index = self.small_count(what)?;
        if index < limit { Ok(index) } else { Err((position.line(), out_of(&position.name(what), index, limit))) }
    }

    /// A count of version 4.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, Located> {
        match self {
            Input::Text(_) => self.plain_count(what),
            Input::Binary(input) => input.size(what).map(|size| size as usize),
        }
    }

    /// The number of a node or an element of version 4.
    pub(super) fn tag(&mut self, what: &str) -> Result<i64, Located> {
        match self {
            Input::Text(_) => self.plain_integer(what),
            Input::Binary(input) => input.size(what),
        }
    }

    /// A coordinate.
    pub(super) fn number(&mut self, what: &str) -> Result<Number, Located> {
        match self {
            Input::Text(tokens) => tokens.number(what),
            Input::Binary(input) => input.number(what),
        }
    }

    pub(super) fn point(&mut self, what: &str) -> Result<Vec3<Number>, Located> {
        Ok(Vec3::new(self.number(what)?, self.number(what)?, self.number(what)?))
    }
}

/// "Found this where that should stand."
fn other(token: Token<'_>, position: InputPosition, expected: &str) -> Located {
    match position {
        InputPosition::Line(_) => unexpected(token, expected),
        InputPosition::Byte(at) => {
            let found = format!("\"{}\" at byte {at} of the file", shown(token.text));
            (None, SceneProblem::Unexpected { found, expected: expected.to_owned() })
        }
    }
}

fn not_allowed(what: String, found: String, allowed: &str) -> Located {
    (None, SceneProblem::NotAllowed { what, found, allowed: allowed.to_owned() })
}

impl<'a> Bytes<'a> {
    /// The next N bytes, the first of the file first.
    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Located> {
        let found = self.bytes[self.at..].first_chunk::<N>();
        let found = found.ok_or_else(|| (None, SceneProblem::Truncated { expected: what.to_owned() }))?;
        self.at += N;
        Ok(*found)
    }

    /// The next N bytes, the least significant first.
    fn little<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Located> {
        let mut found = self.take::<N>(what)?;
        if self.big_endian {
            found.reverse();
        }
        Ok(found)
    }

    fn integer(&mut self, what: &str) -> Result<i32, Located> {
        self.little(what).map(i32::from_le_bytes)
    }

    fn size(&mut self, what: &str) -> Result<i64, Located> {
        if self.width == 4 {
            return self.little(what).map(|bytes| i64::from(u32::from_le_bytes(bytes)));
        }
        let position = InputPosition::Byte(self.at);
        let found = u64::from_le_bytes(self.little(what)?);
        i64::try_from(found).map_err(|_| not_allowed(position.name(what), found.to_string(), "less than 2^63"))
    }

    fn number(&mut self, what: &str) -> Result<Number, Located> {
        let position = InputPosition::Byte(self.at);
        let value = f64::from_le_bytes(self.little(what)?);
        Number::from_f64(value).map_err(|error| (None, SceneProblem::Number { what: position.name(what), error }))
    }

    /// Whether what follows is the end of a line, or of the file.
    fn is_new_line(&self) -> bool {
        self.at == 0 || self.bytes[self.at - 1] == b'\n' || self.at == self.bytes.len()
    }

    fn word(&mut self, what: &str) -> Result<Token<'a>, Located> {
        let is_space = |byte: &u8| byte.is_ascii_whitespace();
        let spaces = self.bytes[self.at..].iter().take_while(|byte| is_space(byte)).count();
        let begin = self.at + spaces;
        let length = self.bytes[begin..].iter().take_while(|byte| !is_space(byte)).count();
        let word = &self.bytes[begin..begin + length];
        if word.is_empty() {
            return Err((None, SceneProblem::Truncated { expected: what.to_owned() }));
        }
        self.at = begin + length;
        // Of white space behind it no more than the end of its line: numbers may begin with such bytes.
        let rest = &self.bytes[self.at..];
        let blanks = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'\r')).count();
        if rest.get(blanks) == Some(&b'\n') {
            self.at += blanks + 1;
        }
        let text = std::str::from_utf8(word).map_err(|_| {
            let found =
                format!("\"{}\" at byte {begin} of the file", excerpt(&String::from_utf8_lossy(word), EXCERPT_LENGTH));
            (None, SceneProblem::Unexpected { found, expected: what.to_owned() })
        })?;
        // Lines mean nothing between numbers.
        Ok(Token { text, line: 0 })
    }
}
