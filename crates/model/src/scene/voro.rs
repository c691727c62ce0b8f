//! Cells as voro++ prints them with `-c "%i %w %P %s %t"`: `id n (x,y,z)*n m (i,j,k,…)*m`, one block a line.
//!
//! Faces run clockwise seen from outside there, so they are turned round; cells whose faces all run the other way are read too. No library
//! reads this format.

use crate::scene::error::SceneProblem;
use crate::scene::raw::{RawBlock, Winding};
use crate::scene::tokens::{Located, Token, Tokens, number, out_of, unexpected, whole};
use crate::vector::Vec3;

pub(super) fn read(text: &str) -> Result<Vec<RawBlock>, Located> {
    text.lines()
        .enumerate()
        .filter(|(_, line)| !line.trim_ascii().is_empty())
        .map(|(i, line)| read_line(line, i + 1))
        .collect()
}

fn read_line(text: &str, line: usize) -> Result<RawBlock, Located> {
    let mut tokens = Tokens::new(text, line);
    let id = tokens.count("the number of a cell")?;
    let vertex_count = tokens.count("the number of vertices")?;
    let mut vertices = Vec::new();
    for _ in 0..vertex_count {
        let token = tokens.next("a vertex (x,y,z)")?;
        let parts = parts(token, "a vertex (x,y,z)")?;
        let [x, y, z] = parts.as_slice() else { return Err(unexpected(token, "a vertex (x,y,z)")) };
        let coordinate = |part: &Token<'_>| number(*part, "a coordinate of a vertex");
        vertices.push(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?));
    }
    let face_count = tokens.count("the number of faces")?;
    let mut faces = Vec::new();
    for _ in 0..face_count {
        let token = tokens.next("a face (i,j,k,…)")?;
        let mut face = Vec::new();
        for part in parts(token, "a face (i,j,k,…)")?.into_iter().rev() {
            let index = whole(part, "a vertex number of a face")?;
            if index >= vertices.len() {
                return Err((Some(line), out_of("a vertex number of a face", index, vertices.len())));
            }
            face.push(index as u32);
        }
        faces.push(face);
    }
    if let Some(token) = tokens.peek() {
        let problem = SceneProblem::Unexpected {
            found: format!("\"{}\" after {face_count} faces", crate::number_text::shown(token.text)),
            expected: "the end of the line".to_string(),
        };
        return Err((Some(line), problem));
    }
    Ok(RawBlock {
        name: Some(format!("cell_{id}")),
        vertices,
        faces,
        line: Some(line),
        winding: Winding::Alike,
        ..RawBlock::default()
    })
}

/// The words between the parentheses and commas of one word.
fn parts<'a>(token: Token<'a>, expected: &str) -> Result<Vec<Token<'a>>, Located> {
    let inner = token.text.strip_prefix('(').and_then(|t| t.strip_suffix(')'));
    let inner = inner.ok_or_else(|| unexpected(token, expected))?;
    Ok(inner.split(',').map(|text| Token { text, line: token.line }).collect())
}
