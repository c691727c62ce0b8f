//! Legacy VTK files in ASCII with an unstructured grid, as UnBlocks-gen and ParaView write them. A polyhedron (cell type 42) is its face stream
//! `faces, (n, vertices*n)*faces`, a cell of another kind its corners. Both layouts of CELLS are read, that of versions up
//! to 4 (each stream behind its length) and that of version 5 (OFFSETS and CONNECTIVITY).
//!
//! `vtkio` gives no line numbers, knows neither face streams nor the version 5 layout, and would read what is thrown
//! away here, so the file is read here. Attributes (CELL_DATA, POINT_DATA) end the part that is read.

use crate::block::Point;
use crate::scene::cells::{CellKind, KINDS, POLYHEDRON, known_kinds};
use crate::scene::error::SceneProblem;
use crate::scene::raw::{FeatureLines, RawBlock, Winding};
use crate::scene::tokens::{Located, Token, Tokens, out_of, unexpected, whole};
use std::collections::{BTreeSet, HashMap};

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
        let allowed = "only UNSTRUCTURED_GRID can".to_string();
        return Err((Some(kind.line), SceneProblem::Unsupported { what, allowed }));
    }
    let mut points: Option<Vec<(Point, usize)>> = None;
    let mut cells: Option<Vec<CellEntries<'_>>> = None;
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
    let kinds = cell_kinds(&types, cells.len())?;
    let mut used = vec![false; points.len()];
    let cells = cells.iter().zip(kinds).enumerate();
    let blocks = cells.map(|(number, (cell, kind))| {
        let (faces, lines) = match kind {
            None => cell.polyhedron(points.len())?,
            Some(kind) => (cell.faces_of(kind, number, points.len())?, Vec::new()),
        };
        faces.iter().flatten().for_each(|&point| used[point as usize] = true);
        let winding = if kind.is_some() { Winding::Any } else { Winding::Outward };
        Ok(RawBlock { winding, ..block(&faces, lines, cell.line, &points) })
    });
    let blocks = blocks.collect::<Result<Vec<_>, _>>()?;
    check_all_used(&used, &points)?;
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

/// The entries of one cell: a face stream, or corners.
struct CellEntries<'a> {
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

fn read_cells<'a>(tokens: &mut Tokens<'a>) -> Result<Vec<CellEntries<'a>>, Located> {
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
        cells.push(CellEntries { stream, line: length.line });
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
fn read_offsets<'a>(tokens: &mut Tokens<'a>, offsets: usize, size: usize) -> Result<Vec<CellEntries<'a>>, Located> {
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
        CellEntries { line: stream.first().map_or(line, |t| t.line), stream }
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

/// The kind of every cell; none for polyhedra.
fn cell_kinds(types: &[Token<'_>], cells: usize) -> Result<Vec<Option<&'static CellKind>>, Located> {
    if types.len() != cells {
        let problem = SceneProblem::NotAllowed {
            what: "the number of cell types".to_string(),
            found: types.len().to_string(),
            allowed: format!("{cells}, one for every cell"),
        };
        return Err((types.first().map(|t| t.line), problem));
    }
    let kind = |(cell, token): (usize, &Token<'_>)| {
        let number = whole(*token, "a cell type")? as i64;
        let known = KINDS.iter().find(|kind| kind.number == number);
        if known.is_none() && number != POLYHEDRON {
            let what = format!("cell {cell} of type {number}");
            return Err((Some(token.line), SceneProblem::Unsupported { what, allowed: known_kinds() }));
        }
        Ok(known)
    };
    types.iter().enumerate().map(kind).collect()
}

impl CellEntries<'_> {
    /// The faces of a polyhedron and their lines.
    fn polyhedron(&self, points: usize) -> Result<(Vec<Vec<u32>>, Vec<usize>), Located> {
        let mut stream = self.stream.iter();
        let mut entry = |what: &str| {
            let token = stream.next().ok_or_else(|| {
                (
                    Some(self.line),
                    SceneProblem::Truncated { expected: format!("{what} (the cell is shorter than its faces)") },
                )
            })?;
            whole(*token, what).map(|value| (value, token.line))
        };
        let (face_count, _) = entry("the number of faces")?;
        let mut faces: Vec<Vec<u32>> = Vec::new();
        let mut lines = Vec::new();
        for _ in 0..face_count {
            let (length, line) = entry("the number of vertices of a face")?;
            lines.push(line);
            let mut face = Vec::new();
            for _ in 0..length {
                let (index, line) = entry("a point number of a face")?;
                if index >= points {
                    return Err((Some(line), out_of("a point number of a face", index, points)));
                }
                face.push(index as u32);
            }
            faces.push(face);
        }
        match stream.next() {
            Some(token) => Err(unexpected(*token, "the end of the cell behind its last face")),
            None => Ok((faces, lines)),
        }
    }

    /// The faces of a cell that its corners make.
    fn faces_of(&self, kind: &CellKind, number: usize, points: usize) -> Result<Vec<Vec<u32>>, Located> {
        let corner = |token: &Token<'_>| {
            let corner = whole(*token, "a point number of a cell")?;
            if corner >= points {
                return Err((Some(token.line), out_of("a point number of a cell", corner, points)));
            }
            Ok(corner as u32)
        };
        let corners = self.stream.iter().map(corner).collect::<Result<Vec<u32>, _>>()?;
        if corners.len() != kind.corners {
            let problem = SceneProblem::NotAllowed {
                what: format!("the number of points of cell {number}, a {},", kind.name),
                found: corners.len().to_string(),
                allowed: kind.corners.to_string(),
            };
            return Err((Some(self.line), problem));
        }
        Ok(kind.faces_on(&corners))
    }
}

/// A cell with faces on points of the grid.
fn block(faces: &[Vec<u32>], face_lines: Vec<usize>, line: usize, points: &[(Point, usize)]) -> RawBlock {
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
    RawBlock {
        vertices: used.iter().map(|&v| points[v as usize].0.clone()).collect(),
        faces: faces.iter().map(|f| f.iter().map(|v| place[v]).collect()).collect(),
        line: Some(line),
        lines: FeatureLines { vertices: used.iter().map(|&v| points[v as usize].1).collect(), faces: face_lines },
        ..RawBlock::default()
    }
}

fn check_all_used(used: &[bool], points: &[(Point, usize)]) -> Result<(), Located> {
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
