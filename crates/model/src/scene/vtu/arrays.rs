//! The XML around the arrays of a grid.

use super::Encoding;
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::tokens::{Located, as_text};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;

/// A file, its numbers not yet decoded.
pub(super) struct Grid<'a> {
    pub(super) big_endian: bool,
    /// Bytes of the lengths before binary data: 4 or 8.
    pub(super) length_bytes: usize,
    pub(super) is_compressed: bool,
    /// What stands behind the underscore of `AppendedData`, and whether in base64.
    pub(super) appended: Option<(&'a [u8], Encoding)>,
    pub(super) pieces: Vec<Piece>,
}

/// A part of the grid.
#[derive(Default)]
pub(super) struct Piece {
    pub(super) points: usize,
    pub(super) cells: usize,
    /// The array of `Points` by that name, those of `Cells` by their own.
    pub(super) arrays: HashMap<String, ArrayText>,
    pub(super) line: usize,
}

/// An array as it stands in the file.
pub(super) struct ArrayText {
    pub(super) kind: String,
    pub(super) format: String,
    /// Where it is in the appended data.
    pub(super) offset: Option<String>,
    pub(super) text: String,
    /// The line of its tag.
    pub(super) line: usize,
}

const APPENDED: &[u8] = b"<AppendedData";

pub(super) fn read(bytes: &[u8]) -> Result<Grid<'_>, Located> {
    // What is appended may be raw bytes, which no reader of XML can pass.
    let (head, appended) = match bytes.windows(APPENDED.len()).position(|window| window == APPENDED) {
        None => (bytes, None),
        Some(start) => {
            let end = bytes[start..].iter().position(|&b| b == b'>').map_or(bytes.len(), |end| start + end + 1);
            let underscore = bytes[end..].iter().position(|&b| b == b'_');
            (&bytes[..end], Some(underscore.map_or(&[][..], |at| &bytes[end + at + 1..])))
        }
    };
    let text = as_text(head)?;
    let mut walk = Walk {
        text,
        counted: (0, 1),
        grid: Grid { big_endian: false, length_bytes: 4, is_compressed: false, appended: None, pieces: Vec::new() },
        is_grid: false,
        section: None,
        open: None,
    };
    let mut reader = Reader::from_str(text);
    loop {
        let at = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|error| {
            let line = walk.line(reader.error_position() as usize);
            not_xml(line, &error.to_string())
        })?;
        let line = walk.line(at);
        match event {
            Event::Start(tag) if tag.name().as_ref() == b"AppendedData" => {
                let encoding = walk.attributes(&tag, line)?.remove("encoding");
                let encoding = match encoding.as_deref() {
                    Some("raw") => Encoding::Raw,
                    None | Some("base64") => Encoding::Base64,
                    Some(other) => return Err(unknown(line, "`encoding` of AppendedData", other, "raw and base64")),
                };
                walk.grid.appended = appended.map(|data| (data, encoding));
                break;
            }
            Event::Start(tag) => walk.begin(&tag, line)?,
            Event::Empty(tag) => {
                walk.begin(&tag, line)?;
                walk.end(tag.name().as_ref());
            }
            Event::End(tag) => walk.end(tag.name().as_ref()),
            Event::Text(content) => walk.add_text(&content),
            Event::CData(content) => walk.add_text(&content),
            Event::Eof => break,
            _ => {}
        }
    }
    if !walk.is_grid {
        let expected = "<VTKFile type=\"UnstructuredGrid\"".to_owned();
        return Err((Some(walk.line(text.len())), SceneProblem::Truncated { expected }));
    }
    Ok(walk.grid)
}

/// Where the reader is.
struct Walk<'a> {
    text: &'a str,
    /// A byte of the text, and the line it is on.
    counted: (usize, usize),
    grid: Grid<'a>,
    is_grid: bool,
    /// `Points` or `Cells`, while within one.
    section: Option<&'static str>,
    /// The array that is open, and its name.
    open: Option<(String, ArrayText)>,
}

impl Walk<'_> {
    /// The line of a byte that is not before those asked for earlier.
    fn line(&mut self, at: usize) -> usize {
        let (from, line) = self.counted;
        let bytes = self.text.as_bytes();
        let between = bytes.get(from..at.min(bytes.len())).unwrap_or(&[]);
        let breaks = between.iter().filter(|&&b| b == b'\n').count();
        self.counted = (from.max(at.min(bytes.len())), line + breaks);
        self.counted.1
    }

    fn begin(&mut self, tag: &BytesStart<'_>, line: usize) -> Result<(), Located> {
        let name = tag.name();
        match name.as_ref() {
            b"VTKFile" => self.file(tag, line)?,
            b"Piece" => {
                let mut attributes = self.attributes(tag, line)?;
                let mut count = |key: &str| {
                    let text = attributes.remove(key).unwrap_or_default();
                    text.trim_ascii().parse::<u32>().map(|count| count as usize).map_err(|_| {
                        unknown(line, &format!("`{key}` of Piece"), &text, &format!("whole numbers up to {}", u32::MAX))
                    })
                };
                let (points, cells) = (count("NumberOfPoints")?, count("NumberOfCells")?);
                self.grid.pieces.push(Piece { points, cells, line, ..Piece::default() });
            }
            b"Points" => self.section = Some("Points"),
            b"Cells" => self.section = Some("Cells"),
            b"DataArray" if self.section.is_some() && !self.grid.pieces.is_empty() => {
                let mut attributes = self.attributes(tag, line)?;
                let mut take = |key: &str| attributes.remove(key);
                let name = match self.section {
                    Some("Points") => "Points".to_owned(),
                    _ => take("Name").unwrap_or_default(),
                };
                let array = ArrayText {
                    kind: take("type").unwrap_or_default(),
                    format: take("format").unwrap_or_else(|| "ascii".to_owned()),
                    offset: take("offset"),
                    text: String::new(),
                    line,
                };
                self.open = Some((name, array));
            }
            _ => {}
        }
        Ok(())
    }

    fn file(&mut self, tag: &BytesStart<'_>, line: usize) -> Result<(), Located> {
        let attributes = self.attributes(tag, line)?;
        let get = |key: &str| attributes.get(key).map(String::as_str);
        if get("type") != Some("UnstructuredGrid") {
            let what = format!("a VTKFile of type \"{}\"", shown(get("type").unwrap_or_default()));
            let allowed = "only UnstructuredGrid can".to_owned();
            return Err((Some(line), SceneProblem::Unsupported { what, allowed }));
        }
        self.is_grid = true;
        self.grid.big_endian = match get("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => return Err(unknown(line, "`byte_order`", other, "LittleEndian and BigEndian")),
        };
        self.grid.length_bytes = match get("header_type") {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(unknown(line, "`header_type`", other, "UInt32 and UInt64")),
        };
        self.grid.is_compressed = match get("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let what = format!("data of the compressor {}", shown(other));
                let allowed = "only vtkZLibDataCompressor, or no compressor, can".to_owned();
                return Err((Some(line), SceneProblem::Unsupported { what, allowed }));
            }
        };
        Ok(())
    }

    fn end(&mut self, name: &[u8]) {
        match name {
            b"Points" | b"Cells" => self.section = None,
            b"DataArray" => {
                if let (Some((name, array)), Some(piece)) = (self.open.take(), self.grid.pieces.last_mut()) {
                    piece.arrays.insert(name, array);
                }
            }
            _ => {}
        }
    }

    fn add_text(&mut self, content: &[u8]) {
        if let (Some((_, array)), Ok(text)) = (&mut self.open, std::str::from_utf8(content)) {
            array.text.push_str(text);
        }
    }

    fn attributes(&self, tag: &BytesStart<'_>, line: usize) -> Result<HashMap<String, String>, Located> {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        tag.attributes()
            .map(|attribute| {
                let attribute = attribute.map_err(|error| not_xml(line, &error.to_string()))?;
                Ok((text(attribute.key.as_ref()), text(&attribute.value)))
            })
            .collect()
    }
}

fn not_xml(line: usize, message: &str) -> Located {
    let found = format!("what is no XML ({})", crate::text::excerpt(message, crate::text::EXCERPT_LENGTH));
    (Some(line), SceneProblem::Unexpected { found, expected: "a VTK file in XML".to_owned() })
}

pub(super) fn unknown(line: usize, what: &str, found: &str, allowed: &str) -> Located {
    let found = format!("\"{}\"", shown(found));
    (Some(line), SceneProblem::NotAllowed { what: what.to_owned(), found, allowed: allowed.to_owned() })
}
