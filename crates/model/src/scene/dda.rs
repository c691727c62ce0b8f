//! UnBlocks-gen's `.dda` files.
//!
//! Words separated by white space; blank lines appear between sections in different places, so lines mean nothing. The
//! EDGES sections repeat what the faces say and are only checked for their counts; of the scalars only `fixedFlag` is
//! used. No library reads this format.

use crate::block::Point;
use crate::number::Number;
use crate::scene::error::SceneProblem;
use crate::scene::raw::{FeatureLines, RawBlock, Winding};
use crate::scene::tokens::{self, Located, Tokens, unexpected, whole};
use crate::text::noun;
use crate::vector::Vec3;

/// Consecutive entries of a list.
#[derive(Clone, Copy)]
struct Slice {
    start: usize,
    length: usize,
    line: usize,
}

pub(super) fn read(text: &str) -> Result<Vec<RawBlock>, Located> {
    let mut tokens = Tokens::new(text, 1);
    let tokens = &mut tokens;
    tokens.keyword("#_DDA_DataFile_Version_1.0")?;
    let (blocks, vertex_slices) = slices(tokens, "POINTS_START_LENGTH", "vertices of a block")?;
    let points_line = tokens.peek().map_or(0, |token| token.line);
    tokens.keyword("POINTS")?;
    let announced = tokens.count("the number of points")?;
    let miscounted = |error| miscount_or(error, text, (points_line, announced));
    let points = points(tokens, announced).map_err(miscounted)?;
    tokens.keyword(BEHIND_POINTS).map_err(miscounted)?;
    check_used_once(&vertex_slices, points.len(), "vertex of the list")?;
    let node_count = tokens.count("the length of the node list")?;
    let mut nodes = Vec::new();
    let mut node_lines = Vec::new();
    for _ in 0..node_count {
        node_lines.push(tokens.peek().map_or(0, |token| token.line));
        nodes.push(tokens.count("a vertex number of a face")? as u32);
    }
    let (faces, face_slices) = slices(tokens, "FACES", "vertices of a face")?;
    check_used_once(&face_slices, nodes.len(), "entry of the node list")?;
    let (shells, shell_slices) = slices(tokens, "BLOCK_FACES", "faces of a block")?;
    check_same(shells, "blocks of BLOCK_FACES", blocks)?;
    check_used_once(&shell_slices, faces.0, "face of the list")?;
    edges(tokens, blocks)?;
    let fixed = scalars(tokens, blocks.0)?;
    boundaries(tokens)?;

    let block = |(i, (own, shell)): (usize, (&Slice, &Slice))| {
        let own_points = &points[own.start..own.start + own.length];
        let own_faces = &face_slices[shell.start..shell.start + shell.length];
        RawBlock {
            name: None,
            fixed: fixed[i],
            vertices: own_points.iter().map(|(p, _)| p.clone()).collect(),
            faces: own_faces.iter().map(|face| nodes[face.start..face.start + face.length].to_vec()).collect(),
            line: Some(points.get(own.start).map_or(own.line, |(_, line)| *line)),
            lines: FeatureLines {
                vertices: own_points.iter().map(|(_, line)| *line).collect(),
                faces: own_faces.iter().map(|face| *node_lines.get(face.start).unwrap_or(&face.line)).collect(),
            },
            winding: Winding::Outward,
        }
    };
    Ok(vertex_slices.iter().zip(&shell_slices).enumerate().map(block).collect())
}

/// A count and the line it stands on.
type Count = (usize, usize);

fn slices(tokens: &mut Tokens<'_>, keyword: &str, what: &str) -> Result<(Count, Vec<Slice>), Located> {
    let line = tokens.keyword(keyword)?.line;
    let count = tokens.count(&format!("the number of entries of {keyword}"))?;
    let mut slices = Vec::new();
    for _ in 0..count {
        let start = tokens.next(&format!("the start of the {what}"))?;
        let length = tokens.count(&format!("the number of {what}"))?;
        let line = start.line;
        slices.push(Slice { start: whole(start, &format!("the start of the {what}"))?, length, line });
    }
    Ok(((count, line), slices))
}

fn points(tokens: &mut Tokens<'_>, count: usize) -> Result<Vec<(Point, usize)>, Located> {
    tokens.keyword("double")?;
    let mut points = Vec::new();
    for _ in 0..count {
        let line = tokens.peek().map_or(0, |t| t.line);
        let mut coordinate = || number(tokens, "a coordinate of a vertex");
        points.push((Vec3::new(coordinate()?, coordinate()?, coordinate()?), line));
    }
    Ok(points)
}

/// The next word as a number, also with the exponent that Fortran writes in double precision: `1.0D0`.
fn number(tokens: &mut Tokens<'_>, what: &str) -> Result<Number, Located> {
    let token = tokens.next(what)?;
    let with_e = token.text.replace(['D', 'd'], "e");
    let is_fortran = with_e != token.text && with_e.parse::<f64>().is_ok();
    if is_fortran { tokens::number_written(token, &with_e, what) } else { tokens::number(token, what) }
}

/// The section behind the points.
const BEHIND_POINTS: &str = "FACES_NODELIST";

/// An error about coordinates too many or too few, at the line that has them where the other lines have three each, or at the line that says how
/// many points there are where that is another number than follow.
fn miscount_or(error: Located, text: &str, (points_line, announced): (usize, usize)) -> Located {
    let SceneProblem::Unexpected { found, expected } = &error.1 else { return error };
    if ![found, expected].iter().any(|text| text.contains(BEHIND_POINTS)) {
        return error;
    }
    let lines = text.lines().enumerate().skip(points_line).take_while(|(_, line)| !line.contains(BEHIND_POINTS));
    let counts: Vec<(usize, usize)> = lines.map(|(i, line)| (i + 1, line.split_ascii_whitespace().count())).collect();
    let is_uneven = |&&(_, count): &&(usize, usize)| count != 0 && count != 3;
    let of_three = counts.iter().filter(|(_, count)| *count == 3).count();
    let uneven: Vec<&(usize, usize)> = counts.iter().filter(is_uneven).collect();
    match uneven.first() {
        Some(&&(line, count)) if uneven.len() < of_three => {
            let found = format!("a line of {count} {}", noun(count, "word", "words"));
            (Some(line), SceneProblem::Unexpected { found, expected: "the 3 coordinates of a vertex".to_string() })
        }
        None if of_three != announced => {
            let (what, found) = ("the number of points".to_owned(), announced.to_string());
            let last = counts.iter().rev().find(|(_, count)| *count != 0).map_or(points_line, |(line, _)| *line);
            let allowed = format!("{of_three}, as many as follow up to line {last} if none is missing there");
            (Some(points_line), SceneProblem::NotAllowed { what, found, allowed })
        }
        _ => error,
    }
}

/// Every entry of a list must belong to exactly one slice; this also bounds what slices can ask to be copied.
fn check_used_once(slices: &[Slice], count: usize, what: &str) -> Result<(), Located> {
    let mut used = vec![false; count];
    for slice in slices {
        let end = slice.start + slice.length;
        if end > count {
            let problem = SceneProblem::NotAllowed {
                what: format!("the last {what} that a slice asks for"),
                found: (end - 1).to_string(),
                allowed: format!("at most {}", count as i64 - 1),
            };
            return Err((Some(slice.line), problem));
        }
        if let Some(again) = used[slice.start..end].iter().position(|&u| u) {
            return Err((Some(slice.line), wrong_use(what, slice.start + again, "in two slices")));
        }
        used[slice.start..end].fill(true);
    }
    match used.iter().position(|&u| !u) {
        Some(entry) => Err((slices.last().map(|s| s.line), wrong_use(what, entry, "in no slice"))),
        None => Ok(()),
    }
}

fn wrong_use(what: &str, entry: usize, found: &str) -> SceneProblem {
    SceneProblem::NotAllowed {
        what: format!("{what} {entry}"),
        found: found.to_string(),
        allowed: "to be in exactly one".to_string(),
    }
}

fn check_same((found, line): Count, what: &str, (expected, _): Count) -> Result<(), Located> {
    if found == expected {
        return Ok(());
    }
    let problem = SceneProblem::NotAllowed {
        what: format!("the number of {what}"),
        found: found.to_string(),
        allowed: format!("{expected}, as in POINTS_START_LENGTH"),
    };
    Err((Some(line), problem))
}

fn edges(tokens: &mut Tokens<'_>, blocks: Count) -> Result<(), Located> {
    tokens.keyword("EDGES")?;
    let count = tokens.count("the number of edges")?;
    for _ in 0..2 * count {
        tokens.count("a vertex number of an edge")?;
    }
    let (shells, slices) = slices(tokens, "EDGES", "edges of a block")?;
    check_same(shells, "blocks of EDGES", blocks)?;
    check_used_once(&slices, count, "edge of the list")
}

/// The scalar that says which blocks are fixed.
const FIXED: &str = "fixedFlag";

/// The `fixedFlag` of every block; without that section none is fixed.
fn scalars(tokens: &mut Tokens<'_>, blocks: usize) -> Result<Vec<bool>, Located> {
    let mut fixed = vec![false; blocks];
    while let Some(token) = tokens.peek() {
        if token.text.starts_with("///") {
            break;
        }
        tokens.keyword("SCALARS")?;
        let name = tokens.next("the name of a scalar")?;
        if is_misspelt(name.text) {
            // Every other scalar is skipped, and blocks that were meant to be fixed would fall.
            let (what, found) = ("a scalar".to_owned(), crate::number_text::shown(name.text));
            let allowed = format!("{FIXED}, in these letters, for blocks that are fixed, or another name");
            return Err((Some(name.line), SceneProblem::NotAllowed { what, found, allowed }));
        }
        tokens.next("the type of a scalar")?;
        for block_is_fixed in &mut fixed {
            if name.text == FIXED {
                *block_is_fixed = tokens.index("a fixedFlag", 2)? == 1;
            } else {
                number(tokens, &format!("a value of {}", crate::number_text::shown(name.text)))?;
            }
        }
    }
    Ok(fixed)
}

/// Whether a name is meant for [`FIXED`]: other letters or marks in it, or the same word shortened.
fn is_misspelt(name: &str) -> bool {
    let letters = |text: &str| -> Vec<char> {
        text.chars().filter(|c| c.is_alphanumeric()).take(2 * FIXED.len()).map(|c| c.to_ascii_lowercase()).collect()
    };
    let (name_letters, fixed) = (letters(name), letters(FIXED));
    let is_shortened = ["fix", "fixed", "flag", "isfixed"].iter().any(|word| letters(word) == name_letters);
    name != FIXED && (is_shortened || changes(&name_letters, &fixed) <= 2)
}

/// The fewest letters added, left out or replaced that make one word of the other.
fn changes(one: &[char], other: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, a) in one.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, b) in other.iter().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[other.len()]
}

/// The lists behind the line "/////////////Boundaries": read, and of no use to contacts.
fn boundaries(tokens: &mut Tokens<'_>) -> Result<(), Located> {
    const LISTS: [&str; 5] = ["Bond:", "Viscous:", "Roller:", "Input:", "FixFace:"];
    let Some(heading) = tokens.peek() else { return Ok(()) };
    if !heading.text.trim_matches('/').starts_with("Boundaries") {
        return Err(unexpected(heading, "the heading of the boundaries"));
    }
    tokens.next("the heading of the boundaries")?;
    while let Some(token) = tokens.peek() {
        if LISTS.contains(&token.text) {
            tokens.next("a list")?;
            tokens.count("the length of a boundary list")?;
        } else {
            number(
                tokens,
                "an entry of a boundary list, or \"Bond:\", \"Viscous:\", \"Roller:\", \"Input:\", \"FixFace:\"",
            )?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::is_misspelt;

    #[test]
    fn only_names_near_the_flag_are_taken_for_it() {
        for name in [
            "fixedflag",
            "FixedFlag",
            "fixed_flag",
            "fixFlag",
            "fixedFlags",
            "fxiedFlag",
            "fixed",
            "isFixed",
            "fix",
            "flag",
        ] {
            assert!(is_misspelt(name), "{name}");
        }
        for name in ["fixedFlag", "boundaryFlag", "prefix", "inscribedSphereRadius", "mixed", "volume", ""] {
            assert!(!is_misspelt(name), "{name}");
        }
    }
}
