//! Polygon files (Stanford), text or binary: vertices and faces that name them. What else there is of an element, and other elements, are
//! skipped. A coordinate is the number that its type in the header holds: of a `float`, also in a text, the f32.

use crate::block::Point;
use crate::files::is_utf16;
use crate::number::{Number, NumberError};
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::mesh::{Face, blocks, weld};
use crate::scene::raw::RawBlock;
use crate::scene::tokens::{Located, out_of};
use crate::text::{EXCERPT_LENGTH, excerpt};
use crate::vector::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType, Version,
};
use std::io::ErrorKind;

/// An element: a vertex, a face, or one of which nothing is kept.
struct Row {
    at: [f64; 3],
    corners: Vec<i64>,
}

impl PropertyAccess for Row {
    fn new() -> Row {
        Row { at: [f64::NAN; 3], corners: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(axis) = AXES.iter().position(|axis| *axis == name) {
            if let Some(value) = coordinate(&property) {
                self.at[axis] = value;
            }
        } else if CORNERS.contains(&name) {
            self.corners = numbers(property);
        }
        PropertyAccessResult::Set
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
/// Programs call them either way.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

fn coordinate(property: &Property) -> Option<f64> {
    Some(match property {
        Property::Char(v) => f64::from(*v),
        Property::UChar(v) => f64::from(*v),
        Property::Short(v) => f64::from(*v),
        Property::UShort(v) => f64::from(*v),
        Property::Int(v) => f64::from(*v),
        Property::UInt(v) => f64::from(*v),
        Property::Float(v) => f64::from(*v),
        Property::Double(v) => *v,
        _ => return None,
    })
}

fn numbers(property: Property) -> Vec<i64> {
    match property {
        Property::ListChar(all) => all.into_iter().map(i64::from).collect(),
        Property::ListUChar(all) => all.into_iter().map(i64::from).collect(),
        Property::ListShort(all) => all.into_iter().map(i64::from).collect(),
        Property::ListUShort(all) => all.into_iter().map(i64::from).collect(),
        Property::ListInt(all) => all.into_iter().map(i64::from).collect(),
        Property::ListUInt(all) => all.into_iter().map(i64::from).collect(),
        _ => Vec::new(),
    }
}

/// The elements of one sort, and the line of the first, in a text.
#[derive(Default)]
struct Rows {
    rows: Vec<Row>,
    first_line: Option<usize>,
}

impl Rows {
    fn line(&self, number: usize) -> Option<usize> {
        self.first_line.map(|first| first + number)
    }
}

/// The blocks of a file: one for every set of faces joined by edges.
pub(super) fn read(bytes: &[u8], distance: Option<&Number>) -> Result<Vec<RawBlock>, Located> {
    if is_utf16(bytes) {
        return Err((None, SceneProblem::Utf16));
    }
    let mut reader = Reader::new(bytes);
    let parser = Parser::<Row>::new();
    let in_header = "a line of a PLY header (format, element, property, comment, end_header)";
    let header = parser.read_header(&mut reader).map_err(|error| {
        let is_of_format = error.line().is_some() || error.kind() == ErrorKind::UnexpectedEof;
        without_format(bytes).filter(|_| !is_of_format).unwrap_or_else(|| located(&error, bytes, in_header))
    })?;
    let Version { major, minor } = header.version;
    if (major, minor) != (1, 0) {
        let (what, found) = ("the version of the format".to_owned(), format!("{major}.{minor}"));
        let problem = SceneProblem::NotAllowed { what, found, allowed: "1.0".to_owned() };
        return Err((header_line(bytes, "format"), problem));
    }
    let is_text = header.encoding == Encoding::Ascii;
    let (mut vertices, mut faces) = (Rows::default(), Rows::default());
    for element in header.elements.values() {
        check_element(element, bytes.len())
            .map_err(|(_, problem)| (header_line(bytes, &format!("element {} ", element.name)), problem))?;
        let first_line = is_text.then(|| reader.line().max(1));
        let rows = parser.read_payload_for_element(&mut reader, element, &header).map_err(|error| {
            let name = excerpt(&element.name, EXCERPT_LENGTH);
            if error.kind() == ErrorKind::UnexpectedEof {
                let expected = format!("the last of {} elements \"{name}\"", element.count);
                return (last_line(bytes).filter(|_| is_text), SceneProblem::Truncated { expected });
            }
            let value = error.line().filter(|_| is_text).and_then(|line| {
                let text = line_of(bytes, line)?;
                Some((Some(line), wrong_value(element, line.checked_sub(first_line?)?, text)?))
            });
            value.unwrap_or_else(|| {
                let expected = format!("a \"{name}\" with the properties that the header announces");
                let (line, problem) = located(&error, if is_text { bytes } else { b"" }, &expected);
                (line.filter(|_| is_text), problem)
            })
        })?;
        match element.name.as_str() {
            "vertex" => vertices = Rows { rows, first_line },
            "face" => faces = Rows { rows, first_line },
            _ => {}
        }
    }
    check_end(reader.get_ref(), is_text.then(|| reader.line()))?;
    let texts = header.elements.get("vertex").filter(|_| is_text).map(|element| (element, bytes));
    let points = points(&vertices, texts)?;
    let mut faces = polygons(&faces, points.len())?;
    let mut used = vec![false; points.len()];
    faces.iter().flat_map(|face| &face.vertices).for_each(|&vertex| used[vertex as usize] = true);
    if let Some(unused) = used.iter().position(|&used| !used) {
        let what = format!("vertex {unused} of the file");
        let problem =
            SceneProblem::NotAllowed { what, found: "in no face".to_owned(), allowed: "to be in a face".to_owned() };
        return Err((vertices.line(unused), problem));
    }
    if let Some(distance) = distance {
        weld(&mut faces, &points, distance);
    }
    let lines: Vec<usize> = (0..points.len()).map_while(|number| vertices.line(number)).collect();
    Ok(blocks(None, &faces, &points, &lines))
}

/// What of an element cannot be, before any of it is read.
fn check_element(element: &ElementDef, bytes: usize) -> Result<(), Located> {
    let scalar = |name: &&str| {
        matches!(element.properties.get(*name).map(|property| &property.data_type), Some(PropertyType::Scalar(_)))
    };
    let list = |name: &&str| {
        let kind = element.properties.get(*name).map(|property| &property.data_type);
        matches!(kind, Some(PropertyType::List(_, entry)) if !matches!(entry, ScalarType::Float | ScalarType::Double))
    };
    let missing = match element.name.as_str() {
        "vertex" => AXES.iter().find(|name| !scalar(name)).map(|name| format!("a number \"{name}\"")),
        "face" if !CORNERS.iter().any(list) => {
            Some("a list of whole numbers \"vertex_indices\" or \"vertex_index\"".to_owned())
        }
        _ => None,
    };
    if let Some(expected) = missing {
        let what = format!("element \"{}\" without {expected} among its properties", element.name);
        let allowed = "vertices need x, y and z, faces the numbers of their vertices".to_owned();
        return Err((None, SceneProblem::Unsupported { what, allowed }));
    }
    // Each takes a byte or more, and one without properties would take none.
    if element.properties.is_empty() || element.count > bytes {
        let what = format!("the number of elements \"{}\"", excerpt(&element.name, EXCERPT_LENGTH));
        let allowed = match element.properties.is_empty() {
            true => "0, since they have no property".to_owned(),
            false => format!("at most {bytes}, the bytes of the file"),
        };
        if element.count > 0 {
            return Err((None, SceneProblem::NotAllowed { what, found: element.count.to_string(), allowed }));
        }
    }
    Ok(())
}

/// The points of the vertices; of a file of text with what the header says of them and the bytes, where what stands there is found.
fn points(vertices: &Rows, texts: Option<(&ElementDef, &[u8])>) -> Result<Vec<Point>, Located> {
    let point = |(number, row): (usize, &Row)| {
        let written = |axis: usize| {
            let ((element, bytes), line) = (texts?, vertices.line(number)?);
            let place = element.properties.keys().position(|name| name == AXES[axis])?;
            let is_scalar = |property: &PropertyDef| matches!(property.data_type, PropertyType::Scalar(_));
            // Behind a list nobody knows which word it is without its length.
            let is_known = element.properties.values().take(place).all(is_scalar);
            let line = std::str::from_utf8(line_of(bytes, line)?).ok()?;
            line.split_ascii_whitespace().nth(place).filter(|_| is_known)
        };
        let coordinate = |axis: usize| {
            Number::from_f64(row.at[axis]).map_err(|error| {
                let what = format!("coordinate {} of vertex {number}", AXES[axis]);
                let found = written(axis).map(|word| NumberError::NotFinite { found: shown(word) });
                (vertices.line(number), SceneProblem::Number { what, error: found.unwrap_or(error) })
            })
        };
        Ok(Vec3::new(coordinate(0)?, coordinate(1)?, coordinate(2)?))
    };
    vertices.rows.iter().enumerate().map(point).collect()
}

fn polygons(faces: &Rows, points: usize) -> Result<Vec<Face>, Located> {
    let polygon = |(number, row): (usize, &Row)| {
        let line = faces.line(number);
        let corner = |&corner: &i64| match u32::try_from(corner) {
            Ok(place) if (place as usize) < points => Ok(place),
            _ => Err((line, out_of(&format!("a vertex number of face {number}"), corner, points))),
        };
        let vertices = row.corners.iter().map(corner).collect::<Result<Vec<u32>, Located>>()?;
        if vertices.len() < 3 {
            let found = format!("face {number} of {} vertices", vertices.len());
            let expected = "a face of 3 vertices or more".to_owned();
            return Err((line, SceneProblem::Unexpected { found, expected }));
        }
        Ok(Face { vertices, line })
    };
    faces.rows.iter().enumerate().map(polygon).collect()
}

/// That nothing but white space is behind the last element; `line` is that of the next line, of a text.
fn check_end(rest: &[u8], line: Option<usize>) -> Result<(), Located> {
    let Some(first) = rest.iter().position(|byte| !byte.is_ascii_whitespace()) else { return Ok(()) };
    let line = line.map(|line| line + rest[..first].iter().filter(|&&byte| byte == b'\n').count());
    let bytes = rest.len() - first;
    let found = match line {
        Some(_) => quoted(rest[first..].split(|&byte| byte == b'\n').next().unwrap_or_default()),
        None => format!("{bytes} more bytes"),
    };
    let expected = "the end of the file, after as many elements as the header announces".to_owned();
    Err((line, SceneProblem::Unexpected { found, expected }))
}

/// The number of a line of the header, which is a text in every file, by how it begins.
fn header_line(bytes: &[u8], start: &str) -> Option<usize> {
    let begins = |line: &[u8]| line.starts_with(start.as_bytes());
    bytes.split(|&byte| byte == b'\n').position(begins).map(|place| place + 1)
}

/// Where the last line with anything in it stands.
fn last_line(bytes: &[u8]) -> Option<usize> {
    Some(bytes.trim_ascii_end().split(|&byte| byte == b'\n').count())
}

/// That of a file that begins as PLY the second line is not the one that says the format, and no other line says it.
fn without_format(bytes: &[u8]) -> Option<Located> {
    line_of(bytes, 1).filter(|first| first.trim_ascii() == b"ply")?;
    let second = line_of(bytes, 2).filter(|_| header_line(bytes, "format").is_none())?;
    let expected = "the format of the file (`format ascii 1.0`, binary_little_endian or binary_big_endian)".to_owned();
    Some((Some(2), SceneProblem::Unexpected { found: quoted(second), expected }))
}

/// A line of the file, from 1.
fn line_of(bytes: &[u8], line: usize) -> Option<&[u8]> {
    bytes.split(|&byte| byte == b'\n').nth(line.checked_sub(1)?)
}

/// The first word of an element's line, in a text, that is not the number which the header announces there.
fn wrong_value(element: &ElementDef, number: usize, line: &[u8]) -> Option<SceneProblem> {
    let line = std::str::from_utf8(line).ok()?;
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let mut place = 0;
    for (name, property) in &element.properties {
        let wrong = |place: usize, kind: &ScalarType| {
            let word = words.get(place).copied();
            if word.is_some_and(|word| is_read(word, kind)) {
                return None;
            }
            let what = value_name(element, number, name);
            Some(match word {
                Some(word) if word.parse().is_ok_and(|value: f64| !value.is_finite()) => {
                    SceneProblem::Number { what, error: NumberError::NotFinite { found: shown(word) } }
                }
                _ => {
                    let found = word.map_or("the end of the line".to_owned(), |word| quoted(word.as_bytes()));
                    SceneProblem::Unexpected { found, expected: format!("{what}, {}", number_of(kind)) }
                }
            })
        };
        let (count, kind) = match &property.data_type {
            PropertyType::Scalar(kind) => (1, kind),
            PropertyType::List(_, kind) => {
                if let Some(problem) = wrong(place, &ScalarType::UInt) {
                    return Some(problem);
                }
                place += 1;
                (words[place - 1].parse().ok()?, kind)
            }
        };
        if let Some(problem) = (place..).take(count).find_map(|place| wrong(place, kind)) {
            return Some(problem);
        }
        place += count;
    }
    None
}

/// Whether the library reads a word as a number of a type.
fn is_read(word: &str, kind: &ScalarType) -> bool {
    let mut element = ElementDef::new(String::new());
    element.properties.add(PropertyDef::new(String::new(), PropertyType::Scalar(kind.clone())));
    Parser::<Row>::new().read_ascii_element(word, &element).is_ok()
}

/// What a number of an element is called in an error.
fn value_name(element: &ElementDef, number: usize, property: &str) -> String {
    let [element_name, name] = [&element.name, property].map(|name| excerpt(name, EXCERPT_LENGTH));
    match element.name.as_str() {
        "vertex" if AXES.contains(&property) => format!("coordinate {name} of vertex {number}"),
        "face" if CORNERS.contains(&property) => format!("a number of `{name}` of face {number}"),
        _ => format!("`{name}` of element {number} of \"{element_name}\""),
    }
}

fn number_of(kind: &ScalarType) -> &'static str {
    match kind {
        ScalarType::Float | ScalarType::Double => "a number as 1, -0.5 or 2e-3",
        _ => "a whole number of the type in the header",
    }
}

/// A line of the file, in an error.
fn quoted(line: &[u8]) -> String {
    format!("\"{}\"", shown(String::from_utf8_lossy(line).trim()))
}

/// Where something else stands than what is expected. What the library says of it is about its own parser.
fn located(error: &ParseError, bytes: &[u8], expected: &str) -> Located {
    if error.kind() == ErrorKind::UnexpectedEof {
        return (None, SceneProblem::Truncated { expected: expected.to_owned() });
    }
    let line = error.line();
    let text = line.and_then(|line| line_of(bytes, line));
    let found = text.map_or_else(|| "what is no PLY".to_owned(), quoted);
    (line, SceneProblem::Unexpected { found, expected: expected.to_owned() })
}
