//! Legacy VTK files in ASCII with an unstructured grid of polyhedra (cell type 42), as UnBlocks-gen and ParaView write
//! them: a cell is its face stream `faces, (n, vertices*n)*faces`. Both layouts of CELLS are read, that of versions up
//! to 4 (each stream behind its length) and that of version 5 (OFFSETS and CONNECTIVITY).
//!
//! `vtkio` gives no line numbers, knows neither face streams nor the version 5 layout, and would read what is thrown
//! away here, so the file is read here. Attributes (CELL_DATA, POINT_DATA) end the part that is read.

use crate::block::Point;
use crate::scene::error::SceneProblem;
use crate::scene::raw::{FeatureLines, RawBlock};
use crate::scene::tokens::{Located, Token, Tokens, out_of, unexpected, whole};
use std::collections::{BTreeSet, HashMap};

/// VTK_POLYHEDRON.
const POLYHEDRON: usize = 42;

/// Whether the header of a file announces binary data.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.split(|&b| b == b'\n').nth(2).is_some_and(|line| line.trim_ascii() == b"BINARY")
}

/// That binary data cannot be read.
pub(super) fn binary() -> Located {
    let problem = SceneProblem::Unsupported {
        what: "a BINARY file".to_string(),
        allowed: "write it as ASCII (in ParaView: Save Data, File Type: Ascii)".to_string(),
    };
    (Some(3), problem)
}

pub(super) fn read(text: &str) -> Result<Vec<RawBlock>, Located> {
    let body = header(text)?;
    let mut tokens = Tokens::new(body, 4);
    tokens.keyword("DATASET")?;
    let kind = tokens.next("\"UNSTRUCTURED_GRID\"")?;
    if kind.text != "UNSTRUCTURED_GRID" {
        let what = format!("the dataset {}", crate::number_text::shown(kind.text));
        let allowed = "only UNSTRUCTURED_GRID with polyhedra can".to_string();
        return Err((Some(kind.line), SceneProblem::Unsupported { what, allowed }));
    }
    let mut points: Option<Vec<(Point, usize)>> = None;
    let mut cells: Option<Vec<FaceStream<'_>>> = None;
    let mut types: Option<Vec<Token<'_>>> = None;
    while let Some(keyword) = tokens.peek() {
        tokens.next("a section")?;
        match keyword.text {
            "FIELD" => skip_field(&mut tokens)?,
            "METADATA" => skip_metadata(&mut tokens)?,
            "POINTS" if points.is_none() => points = Some(read_points(&mut tokens)?),
            "CELLS" if cells.is_none() => cells = Some(read_cells(&mut tokens)?),
            "CELL_TYPES" if types.is_none() => types = Some(read_types(&mut tokens)?),
            "CELL_DATA" | "POINT_DATA" => break,
            _ => return Err(unexpected(keyword, "one of each of the sections POINTS, CELLS, CELL_TYPES")),
        }
    }
    let missing = |what: &str| (None, SceneProblem::Truncated { expected: format!("the section {what}") });
    let points = points.ok_or_else(|| missing("POINTS"))?;
    let cells = cells.ok_or_else(|| missing("CELLS"))?;
    let types = types.ok_or_else(|| missing("CELL_TYPES"))?;
    check_types(&types, cells.len())?;
    let blocks = cells.iter().map(|cell| block(cell, &points)).collect::<Result<Vec<_>, _>>()?;
    check_all_used(&cells, &points)?;
    Ok(blocks)
}

/// The text behind the three header lines.
fn header(text: &str) -> Result<&str, Located> {
    let mut lines = text.split_inclusive('\n');
    let mut line = |number: usize, expected: &str| {
        lines.next().ok_or_else(|| (Some(number), SceneProblem::Truncated { expected: expected.to_string() }))
    };
    let version = line(1, "\"# vtk DataFile Version\"")?;
    if !version.starts_with("# vtk DataFile Version") {
        return Err(unexpected(Token { text: version.trim_ascii(), line: 1 }, "\"# vtk DataFile Version\""));
    }
    let title = line(2, "the title")?;
    let encoding = line(3, "\"ASCII\"")?;
    match encoding.trim_ascii() {
        "ASCII" => Ok(&text[version.len() + title.len() + encoding.len()..]),
        "BINARY" => Err(binary()),
        other => Err(unexpected(Token { text: other, line: 3 }, "\"ASCII\"")),
    }
}

/// The face stream of one cell.
struct FaceStream<'a> {
    stream: Vec<Token<'a>>,
    line: usize,
}

fn read_points(tokens: &mut Tokens<'_>) -> Result<Vec<(Point, usize)>, Located> {
    let count = tokens.count("the number of points")?;
    tokens.next("the type of the points")?;
    let mut points = Vec::new();
    for _ in 0..count {
        let line = tokens.peek().map_or(0, |t| t.line);
        points.push((tokens.point("a coordinate of a point")?, line));
    }
    Ok(points)
}

fn read_cells<'a>(tokens: &mut Tokens<'a>) -> Result<Vec<FaceStream<'a>>, Located> {
    let first = tokens.count("the number of cells")?;
    let size_token = tokens.next("the size of the cell list")?;
    let size = whole(size_token, "the size of the cell list")?;
    if tokens.peek().is_some_and(|t| t.text == "OFFSETS") {
        return read_offsets(tokens, first, size);
    }
    let mut cells = Vec::new();
    let mut total = 0;
    for _ in 0..first {
        let length = tokens.next("the length of a cell")?;
        let count = whole(length, "the length of a cell")?;
        let mut stream = Vec::new();
        for _ in 0..count {
            stream.push(tokens.next("an entry of a cell")?);
        }
        total += count + 1;
        cells.push(FaceStream { stream, line: length.line });
    }
    if total != size {
        let problem = SceneProblem::NotAllowed {
            what: "the size of the cell list".to_string(),
            found: size.to_string(),
            allowed: format!("{total}, the cells with their lengths"),
        };
        return Err((Some(size_token.line), problem));
    }
    Ok(cells)
}

/// The layout of version 5: `offsets` is one more than the number of cells.
fn read_offsets<'a>(tokens: &mut Tokens<'a>, offsets: usize, size: usize) -> Result<Vec<FaceStream<'a>>, Located> {
    tokens.keyword("OFFSETS")?;
    tokens.next("the type of the offsets")?;
    let mut ends: Vec<usize> = Vec::new();
    for _ in 0..offsets {
        let token = tokens.next("an offset")?;
        let offset = whole(token, "an offset")?;
        let least = ends.last().copied().unwrap_or(0);
        let most = if ends.is_empty() { 0 } else { size };
        if !(least..=most).contains(&offset) {
            let problem = SceneProblem::NotAllowed {
                what: "an offset".to_string(),
                found: offset.to_string(),
                allowed: format!("{least} to {most}"),
            };
            return Err((Some(token.line), problem));
        }
        ends.push(offset);
    }
    let line = tokens.keyword("CONNECTIVITY")?.line;
    tokens.next("the type of the connectivity")?;
    let mut entries = Vec::new();
    for _ in 0..size {
        entries.push(tokens.next("an entry of the connectivity")?);
    }
    if ends.last().is_some_and(|&last| last != size) {
        let problem = SceneProblem::NotAllowed {
            what: "the last offset".to_string(),
            found: ends.last().copied().unwrap_or(0).to_string(),
            allowed: format!("{size}, the length of the connectivity"),
        };
        return Err((Some(line), problem));
    }
    let cell = |pair: &[usize]| {
        let stream = entries[pair[0]..pair[1]].to_vec();
        FaceStream { line: stream.first().map_or(line, |t| t.line), stream }
    };
    Ok(ends.windows(2).map(cell).collect())
}

fn read_types<'a>(tokens: &mut Tokens<'a>) -> Result<Vec<Token<'a>>, Located> {
    let count = tokens.count("the number of cell types")?;
    let mut types = Vec::new();
    for _ in 0..count {
        types.push(tokens.next("a cell type")?);
    }
    Ok(types)
}

fn check_types(types: &[Token<'_>], cells: usize) -> Result<(), Located> {
    if types.len() != cells {
        let problem = SceneProblem::NotAllowed {
            what: "the number of cell types".to_string(),
            found: types.len().to_string(),
            allowed: format!("{cells}, one for every cell"),
        };
        return Err((types.first().map(|t| t.line), problem));
    }
    for (cell, token) in types.iter().enumerate() {
        let kind = whole(*token, "a cell type")?;
        if kind != POLYHEDRON {
            let what = format!("cell {cell} of type {kind}");
            let allowed = format!("only polyhedra, type {POLYHEDRON}, can");
            return Err((Some(token.line), SceneProblem::Unsupported { what, allowed }));
        }
    }
    Ok(())
}

fn block(cell: &FaceStream<'_>, points: &[(Point, usize)]) -> Result<RawBlock, Located> {
    let mut stream = cell.stream.iter();
    let mut entry = |what: &str| {
        let token = stream.next().ok_or_else(|| {
            (
                Some(cell.line),
                SceneProblem::Truncated { expected: format!("{what} (the cell is shorter than its faces)") },
            )
        })?;
        whole(*token, what).map(|value| (value, token.line))
    };
    let (face_count, _) = entry("the number of faces")?;
    let mut faces: Vec<Vec<u32>> = Vec::new();
    let mut face_lines = Vec::new();
    for _ in 0..face_count {
        let (length, line) = entry("the number of vertices of a face")?;
        face_lines.push(line);
        let mut face = Vec::new();
        for _ in 0..length {
            let (index, line) = entry("a point number of a face")?;
            if index >= points.len() {
                return Err((Some(line), out_of("a point number of a face", index, points.len())));
            }
            face.push(index as u32);
        }
        faces.push(face);
    }
    if let Some(token) = stream.next() {
        return Err(unexpected(*token, "the end of the cell behind its last face"));
    }
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
    Ok(RawBlock {
        vertices: used.iter().map(|&v| points[v as usize].0.clone()).collect(),
        faces: faces.iter().map(|f| f.iter().map(|v| place[v]).collect()).collect(),
        line: Some(cell.line),
        lines: FeatureLines { vertices: used.iter().map(|&v| points[v as usize].1).collect(), faces: face_lines },
        ..RawBlock::default()
    })
}

fn check_all_used(cells: &[FaceStream<'_>], points: &[(Point, usize)]) -> Result<(), Located> {
    let mut used = vec![false; points.len()];
    for cell in cells {
        let mut stream = cell.stream.iter().filter_map(|t| t.text.parse::<usize>().ok()).skip(1);
        while let Some(length) = stream.next() {
            for index in stream.by_ref().take(length) {
                if let Some(used) = used.get_mut(index) {
                    *used = true;
                }
            }
        }
    }
    match used.iter().position(|&u| !u) {
        None => Ok(()),
        Some(point) => {
            let problem = SceneProblem::NotAllowed {
                what: format!("point {point}"),
                found: "in no cell".to_string(),
                allowed: "to be in a cell".to_string(),
            };
            Err((Some(points[point].1), problem))
        }
    }
}

/// `FIELD name n`, then n arrays `name components tuples type values…`.
fn skip_field(tokens: &mut Tokens<'_>) -> Result<(), Located> {
    tokens.next("the name of a field")?;
    for _ in 0..tokens.count("the number of arrays of a field")? {
        tokens.next("the name of an array")?;
        let components = tokens.count("the components of an array")?;
        let tuples = tokens.count("the tuples of an array")?;
        tokens.next("the type of an array")?;
        for _ in 0..components.saturating_mul(tuples) {
            tokens.next("a value of an array")?;
        }
    }
    Ok(())
}

/// Version 5 writes METADATA of any words up to the next section.
fn skip_metadata(tokens: &mut Tokens<'_>) -> Result<(), Located> {
    const SECTIONS: [&str; 6] = ["POINTS", "CELLS", "CELL_TYPES", "CELL_DATA", "POINT_DATA", "FIELD"];
    while tokens.peek().is_some_and(|t| !SECTIONS.contains(&t.text)) {
        tokens.next("metadata")?;
    }
    Ok(())
}
