//! The numbers of an array: as text, or binary in base64 or raw, as they are or compressed by zlib.

use super::arrays::{ArrayText, Grid, unknown};
use crate::files::LARGEST_INPUT;
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::{Located, Tokens, unexpected};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

/// The numbers of an array.
pub(super) enum Values {
    Floats(Vec<f64>),
    Integers(Vec<i64>),
}

/// How bytes are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw,
    Base64,
}

/// A type of numbers.
#[derive(Clone, Copy)]
struct Kind {
    bytes: usize,
    is_float: bool,
    is_signed: bool,
}

impl Kind {
    fn named(name: &str, line: usize) -> Result<Kind, Located> {
        let kind = |bytes, is_float, is_signed| Ok(Kind { bytes, is_float, is_signed });
        match name {
            "Float32" => kind(4, true, true),
            "Float64" => kind(8, true, true),
            "Int8" => kind(1, false, true),
            "Int16" => kind(2, false, true),
            "Int32" => kind(4, false, true),
            "Int64" => kind(8, false, true),
            "UInt8" => kind(1, false, false),
            "UInt16" => kind(2, false, false),
            "UInt32" => kind(4, false, false),
            "UInt64" => kind(8, false, false),
            other => {
                let allowed = "Float32, Float64, Int8 to Int64 and UInt8 to UInt64";
                Err(unknown(line, "`type` of a DataArray", other, allowed))
            }
        }
    }
}

/// The numbers of an array.
pub(super) fn values(array: &ArrayText, name: &str, grid: &Grid<'_>) -> Result<Values, Located> {
    let kind = Kind::named(&array.kind, array.line)?;
    let mut bytes = match array.format.as_str() {
        "ascii" => return from_text(array, name, kind),
        "binary" => EncodedBytes { rest: array.text.as_bytes(), encoding: Encoding::Base64, decoded: Vec::new() },
        "appended" => appended(array, name, grid)?,
        other => return Err(unknown(array.line, "`format` of a DataArray", other, "ascii, binary and appended")),
    };
    let content = bytes.content(grid).map_err(|wrong| wrong.of(name, array.line))?;
    if content.len() % kind.bytes != 0 {
        let what = format!("the number of bytes of the array \"{name}\"");
        let (found, allowed) = (content.len().to_string(), format!("a multiple of {}", kind.bytes));
        return Err((Some(array.line), SceneProblem::NotAllowed { what, found, allowed }));
    }
    from_bytes(&content, kind, grid.big_endian).map_err(|found| {
        let what = format!("a value of the array \"{name}\"");
        (Some(array.line), SceneProblem::NotAllowed { what, found, allowed: format!("at most {}", i64::MAX) })
    })
}

fn appended<'a>(array: &ArrayText, name: &str, grid: &Grid<'a>) -> Result<EncodedBytes<'a>, Located> {
    let Some((data, encoding)) = grid.appended else {
        return Err((None, SceneProblem::Truncated { expected: "the element AppendedData".to_owned() }));
    };
    let offset = array.offset.as_deref().unwrap_or_default();
    let rest = offset.trim_ascii().parse::<usize>().ok().and_then(|offset| data.get(offset..));
    let rest = rest.ok_or_else(|| {
        let allowed = format!("0 to {}, within the appended data", data.len());
        unknown(array.line, &format!("`offset` of the array \"{name}\""), offset, &allowed)
    })?;
    Ok(EncodedBytes { rest, encoding, decoded: Vec::new() })
}

fn from_text(array: &ArrayText, name: &str, kind: Kind) -> Result<Values, Located> {
    let what = format!("a value of the array \"{name}\"");
    let mut tokens = Tokens::new(&array.text, array.line);
    let (mut floats, mut integers) = (Vec::new(), Vec::new());
    while let Some(token) = tokens.peek() {
        if kind.is_float {
            let value = tokens.number(&what)?.approximate();
            // A decimal of an array of f32 stands for the f32 nearest to it.
            floats.push(if kind.bytes == 4 { f64::from(value as f32) } else { value });
        } else {
            tokens.next(&what)?;
            integers.push(token.text.parse().map_err(|_| unexpected(token, &format!("{what}, a whole number")))?);
        }
    }
    Ok(if kind.is_float { Values::Floats(floats) } else { Values::Integers(integers) })
}

/// Numbers of a kind; an integer beyond an i64 is given back.
fn from_bytes(content: &[u8], kind: Kind, big_endian: bool) -> Result<Values, String> {
    let all = content.chunks_exact(kind.bytes).map(|chunk| {
        let byte = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        if big_endian { chunk.iter().fold(0, byte) } else { chunk.iter().rev().fold(0, byte) }
    });
    if kind.is_float {
        let float =
            |bits: u64| if kind.bytes == 4 { f64::from(f32::from_bits(bits as u32)) } else { f64::from_bits(bits) };
        return Ok(Values::Floats(all.map(float).collect()));
    }
    let unused = 64 - 8 * kind.bytes as u32;
    let integer = |bits: u64| {
        if kind.is_signed {
            Ok((bits << unused) as i64 >> unused)
        } else {
            i64::try_from(bits).map_err(|_| bits.to_string())
        }
    };
    all.map(integer).collect::<Result<_, _>>().map(Values::Integers)
}

/// What is wrong with binary data.
enum Wrong {
    Short,
    NoBase64(String),
    TooLong(u64),
    Compressed(String),
}

impl Wrong {
    fn of(self, name: &str, line: usize) -> Located {
        let what = format!("the data of the array \"{name}\"");
        let problem = match self {
            Wrong::Short => SceneProblem::Truncated { expected: format!("more of {what}") },
            Wrong::NoBase64(found) => SceneProblem::Unexpected { found, expected: format!("{what} in base64") },
            Wrong::TooLong(bytes) => SceneProblem::NotAllowed {
                what,
                found: format!("{bytes} bytes"),
                allowed: format!("at most {LARGEST_INPUT}"),
            },
            Wrong::Compressed(found) => {
                SceneProblem::Unexpected { found, expected: format!("{what}, compressed by zlib") }
            }
        };
        (Some(line), problem)
    }
}

/// Bytes that are decoded as they are asked for.
struct EncodedBytes<'a> {
    rest: &'a [u8],
    encoding: Encoding,
    /// Decoded and not yet asked for.
    decoded: Vec<u8>,
}

impl EncodedBytes<'_> {
    /// The content of an array, whose length stands before it.
    fn content(&mut self, grid: &Grid<'_>) -> Result<Vec<u8>, Wrong> {
        let first = self.length(grid)?;
        if !grid.is_compressed {
            return self.take(first);
        }
        if first == 0 {
            return Ok(Vec::new());
        }
        let (size, last) = (self.length(grid)?, self.length(grid)?);
        let last = if last == 0 { size } else { last };
        let total = (first - 1).saturating_mul(size).saturating_add(last);
        if total > LARGEST_INPUT {
            return Err(Wrong::TooLong(total));
        }
        // Every block has a length that stands here, so their number is bounded by what is there.
        let lengths = (0..first).map(|_| self.length(grid)).collect::<Result<Vec<u64>, _>>()?;
        let mut content = Vec::new();
        for (number, length) in lengths.iter().enumerate() {
            let expected = if number + 1 == lengths.len() { last } else { size };
            let block = self.take(*length)?;
            let block = decompress_to_vec_zlib_with_limit(&block, expected as usize)
                .map_err(|error| Wrong::Compressed(format!("block {number} that does not decompress ({error})")))?;
            if block.len() as u64 != expected {
                return Err(Wrong::Compressed(format!(
                    "block {number} of {} bytes instead of {expected}",
                    block.len()
                )));
            }
            content.extend(block);
        }
        Ok(content)
    }

    fn length(&mut self, grid: &Grid<'_>) -> Result<u64, Wrong> {
        let bytes = self.take(grid.length_bytes as u64)?;
        let byte = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        Ok(if grid.big_endian { bytes.iter().fold(0, byte) } else { bytes.iter().rev().fold(0, byte) })
    }

    fn take(&mut self, count: u64) -> Result<Vec<u8>, Wrong> {
        // Base64 takes more bytes than it stands for.
        if count > (self.rest.len() + self.decoded.len()) as u64 {
            return Err(Wrong::Short);
        }
        let count = count as usize;
        match self.encoding {
            Encoding::Raw => {
                let (taken, rest) = self.rest.split_at(count);
                self.rest = rest;
                Ok(taken.to_vec())
            }
            Encoding::Base64 => {
                while self.decoded.len() < count {
                    self.decode_group()?;
                }
                let rest = self.decoded.split_off(count);
                Ok(std::mem::replace(&mut self.decoded, rest))
            }
        }
    }

    /// Decodes the next four characters. Writers end base64 with `=` behind the lengths, or behind each block, or at the end alone.
    fn decode_group(&mut self) -> Result<(), Wrong> {
        let mut group = [0; 4];
        for place in &mut group {
            let skipped = self.rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
            *place = *self.rest.get(skipped).filter(|&&b| b != b'<').ok_or(Wrong::Short)?;
            self.rest = &self.rest[skipped + 1..];
        }
        match STANDARD.decode_vec(group, &mut self.decoded) {
            Ok(()) => Ok(()),
            Err(_) => Err(Wrong::NoBase64(format!("\"{}\"", shown(&String::from_utf8_lossy(&group))))),
        }
    }
}
