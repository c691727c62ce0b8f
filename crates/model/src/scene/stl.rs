//! Stereolithography files, text or binary: triangles, each with its own corners.
//!
//! `stl_io` stops behind the first solid of a text, rounds the decimals of a text to f32, drops the names, and gives errors without a line;
//! the format is a list of triangles, so it is read here. Normals say nothing that the corners do not, and are skipped.

use crate::block::Point;
use crate::files::{is_utf16, without_mark};
use crate::number::Number;
use crate::scene::error::SceneProblem;
use crate::scene::mesh::{Face, blocks, weld};
use crate::scene::raw::RawBlock;
use crate::scene::tokens::{Located, Token, Tokens, as_text, unexpected};
use crate::text::{EXCERPT_LENGTH, excerpt};
use crate::vector::Vec3;

/// Bytes before the triangles of a binary file: any 80, and their number.
const HEADER: usize = 84;
/// Bytes of a triangle: a normal and three corners of three f32 each, and two bytes of anything.
const TRIANGLE: usize = 50;

/// The blocks of a file. Corners within `distance` of one another are one vertex.
pub(super) fn read(bytes: &[u8], distance: &Number) -> Result<Vec<RawBlock>, Located> {
    // A binary file may begin with any bytes.
    let bytes = Some(without_mark(bytes)).filter(|bytes| is_text(bytes)).unwrap_or(bytes);
    if is_text(bytes) { read_text(as_text(bytes)?, distance) } else { read_binary(bytes, distance) }
}

/// Binary files may begin with "solid" as well, but not a text with a zero byte.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let is_solid = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    is_solid && !bytes.contains(&0)
}

/// Whether these are the bytes of a binary file, by their number.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    triangle_count(bytes).is_some() && !is_text(bytes)
}

/// The number of triangles that a binary file announces, where its length is the one that follows.
fn triangle_count(bytes: &[u8]) -> Option<usize> {
    let count = u32::from_le_bytes(bytes.get(HEADER - 4..HEADER)?.try_into().ok()?) as usize;
    (count.checked_mul(TRIANGLE)?.checked_add(HEADER)? == bytes.len()).then_some(count)
}

fn read_binary(bytes: &[u8], distance: &Number) -> Result<Vec<RawBlock>, Located> {
    let Some(count) = triangle_count(bytes) else {
        if is_utf16(bytes) {
            return Err((None, SceneProblem::Utf16));
        }
        let announced = bytes.get(HEADER - 4..HEADER).and_then(|four| four.try_into().ok()).map(u32::from_le_bytes);
        let allowed = match announced {
            Some(count) => format!(
                "{} for the {count} triangles that bytes 80 to 83 announce (a text begins with the word solid)",
                HEADER as u64 + TRIANGLE as u64 * u64::from(count)
            ),
            None => format!("{HEADER} or more (a text begins with the word solid)"),
        };
        let what = "the number of bytes of the file, read as binary STL,".to_owned();
        return Err((None, SceneProblem::NotAllowed { what, found: bytes.len().to_string(), allowed }));
    };
    let mut solid = Solid::default();
    for number in 0..count {
        let start = HEADER + number * TRIANGLE;
        for corner in 0..3 {
            let coordinate = |axis: usize| {
                let at = start + 12 * (corner + 1) + 4 * axis;
                let value = f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
                Number::from_f64(f64::from(value)).map_err(|error| {
                    let what =
                        format!("a coordinate of corner {corner} of triangle {number}, at byte {at} of the file");
                    (None, SceneProblem::Number { what, error })
                })
            };
            solid.points.push(Vec3::new(coordinate(0)?, coordinate(1)?, coordinate(2)?));
        }
        solid.add_triangle(None);
    }
    Ok(solid.blocks(distance))
}

/// A solid as read.
#[derive(Default)]
struct Solid {
    name: Option<String>,
    points: Vec<Point>,
    /// Of the points of a text.
    lines: Vec<usize>,
    faces: Vec<Face>,
}

impl Solid {
    /// Makes a triangle of the last three points.
    fn add_triangle(&mut self, line: Option<usize>) {
        let end = self.points.len() as u32;
        self.faces.push(Face { vertices: vec![end - 3, end - 2, end - 1], line });
    }

    fn blocks(mut self, distance: &Number) -> Vec<RawBlock> {
        weld(&mut self.faces, &self.points, distance);
        blocks(self.name.as_deref(), &self.faces, &self.points, &self.lines)
    }
}

fn read_text(text: &str, distance: &Number) -> Result<Vec<RawBlock>, Located> {
    let mut tokens = Tokens::new(text, 1);
    let mut all = Vec::new();
    while tokens.peek().is_some() {
        let line = word(&mut tokens, "solid")?.line;
        let mut solid = Solid { name: rest_of_line(&mut tokens, line)?, ..Solid::default() };
        while let Some(facet) = tokens.peek() {
            if facet.text.eq_ignore_ascii_case("endsolid") {
                break;
            }
            read_facet(&mut tokens, &mut solid)?;
        }
        let line = word(&mut tokens, "endsolid")?.line;
        rest_of_line(&mut tokens, line)?;
        all.extend(solid.blocks(distance));
    }
    Ok(all)
}

fn read_facet(tokens: &mut Tokens<'_>, solid: &mut Solid) -> Result<(), Located> {
    let line = word(tokens, "facet")?.line;
    word(tokens, "normal")?;
    for _ in 0..3 {
        // Any word: some programs write nan for triangles without area.
        tokens.next("a component of the normal")?;
    }
    word(tokens, "outer")?;
    word(tokens, "loop")?;
    for _ in 0..3 {
        solid.lines.push(word(tokens, "vertex")?.line);
        solid.points.push(tokens.point("a coordinate of a vertex")?);
    }
    word(tokens, "endloop")?;
    word(tokens, "endfacet")?;
    solid.add_triangle(Some(line));
    Ok(())
}

/// The next word, which must be `keyword` in small or capital letters.
fn word<'a>(tokens: &mut Tokens<'a>, keyword: &str) -> Result<Token<'a>, Located> {
    let expected = format!("\"{keyword}\"");
    let token = tokens.next(&expected)?;
    if token.text.eq_ignore_ascii_case(keyword) { Ok(token) } else { Err(unexpected(token, &expected)) }
}

/// The words that stand on a line yet, if there are any: the name of a solid.
fn rest_of_line(tokens: &mut Tokens<'_>, line: usize) -> Result<Option<String>, Located> {
    let mut words = Vec::new();
    while tokens.peek().is_some_and(|token| token.line == line) {
        words.push(tokens.next("a name")?.text);
    }
    let name = words.join(" ");
    if name.chars().any(char::is_control) {
        let found = format!("\"{}\"", excerpt(&name, EXCERPT_LENGTH));
        return Err((
            Some(line),
            SceneProblem::Unexpected { found, expected: "a name without control characters".to_owned() },
        ));
    }
    Ok(Some(name).filter(|name| !name.is_empty()))
}
