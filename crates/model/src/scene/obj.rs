//! Wavefront OBJ: one block for every set of faces joined by edges, within each object.
//!
//! The crates for OBJ (`tobj`, `obj-rs`) give errors without line numbers, and `tobj` triangulates or renumbers on its
//! way to what graphics cards want; the part of the format that matters here is two statements, so it is read here.
//! Texture coordinates, normals, groups, materials, smoothing, and lines and points of no face are skipped.

use crate::block::Point;
use crate::number::Number;
use crate::number_text::shown;
use crate::scene::error::SceneProblem;
use crate::scene::mesh::{Face, blocks, weld};
use crate::scene::raw::RawBlock;
use crate::scene::tokens::{Located, Token, number, unexpected};
use crate::vector::Vec3;
use std::collections::BTreeSet;

/// The faces between two `o` statements.
#[derive(Default)]
struct Object {
    name: Option<String>,
    faces: Vec<Face>,
}

pub(super) fn read(text: &str, weld_distance: Option<&Number>) -> Result<Vec<RawBlock>, Located> {
    let mut vertices: Vec<(Point, usize)> = Vec::new();
    let mut objects = vec![Object::default()];
    let mut loose: BTreeSet<u32> = BTreeSet::new();
    for (line, statement) in statements(text) {
        let mut words = statement.split_ascii_whitespace().map(|text| Token { text, line });
        let Some(keyword) = words.next() else { continue };
        match keyword.text {
            "v" => vertices.push((vertex(keyword, words)?, line)),
            "f" => {
                let face = face(words, &vertices, line)?;
                if let Some(object) = objects.last_mut() {
                    object.faces.push(face);
                }
            }
            "o" => {
                let name = words.map(|word| word.text).collect::<Vec<_>>().join(" ");
                if name.chars().any(char::is_control) {
                    return Err(unexpected(Token { text: &name, line }, "a name without control characters"));
                }
                objects.push(Object { name: (!name.is_empty()).then_some(name), faces: Vec::new() });
            }
            // Edges and points of no face, as Blender writes them.
            "l" | "p" => {
                for word in words {
                    loose.insert(corner(word, vertices.len(), if keyword.text == "l" { "line" } else { "point" })?);
                }
            }
            "vt" | "vn" | "vp" | "g" | "s" | "usemtl" | "mtllib" => {}
            _ => {
                return Err(unexpected(
                    keyword,
                    "one of the statements v, f, o, l, p, vt, vn, vp, g, s, usemtl, mtllib",
                ));
            }
        }
    }
    let used: BTreeSet<u32> = objects.iter().flat_map(|o| &o.faces).flat_map(|f| f.vertices.iter().copied()).collect();
    if let Some(unused) = (0..vertices.len() as u32).find(|v| !used.contains(v) && !loose.contains(v)) {
        let problem = SceneProblem::NotAllowed {
            what: format!("vertex {} of the file", unused + 1),
            found: "in no face".to_string(),
            allowed: "to be in a face".to_string(),
        };
        return Err((Some(vertices[unused as usize].1), problem));
    }
    let (points, lines): (Vec<Point>, Vec<usize>) = vertices.into_iter().unzip();
    if let Some(distance) = weld_distance {
        objects.iter_mut().for_each(|object| weld(&mut object.faces, &points, distance));
    }
    Ok(objects.iter().flat_map(|object| blocks(object.name.as_deref(), &object.faces, &points, &lines)).collect())
}

/// Statements with the line each begins on: without comments, lines that end in a backslash joined to the next.
fn statements(text: &str) -> Vec<(usize, String)> {
    let mut statements: Vec<(usize, String)> = Vec::new();
    let mut continues = false;
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        let (line, continued) = match line.trim_ascii_end().strip_suffix('\\') {
            Some(line) => (line, true),
            None => (line, false),
        };
        match statements.last_mut().filter(|_| continues) {
            Some((_, statement)) => {
                statement.push(' ');
                statement.push_str(line);
            }
            None => statements.push((i + 1, line.to_string())),
        }
        continues = continued;
    }
    statements
}

/// `v x y z`, also with a weight of 1, or with a colour.
fn vertex<'a>(keyword: Token<'a>, words: impl Iterator<Item = Token<'a>>) -> Result<Point, Located> {
    let words: Vec<Token<'_>> = words.collect();
    if let [x, y, z, rest @ ..] = words.as_slice() {
        let coordinate = |token: &Token<'_>| number(*token, "a coordinate of a vertex");
        let point = Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?);
        let rest: Vec<_> =
            rest.iter().map(|t| number(*t, "the weight or colour of a vertex")).collect::<Result<_, _>>()?;
        match rest.as_slice() {
            [] | [_, _, _] => return Ok(point),
            [weight] if weight.as_f64() == Some(1.0) => return Ok(point),
            _ => {}
        }
    }
    let found = format!("\"v\" with {} numbers", words.len());
    let expected = "a vertex of 3 coordinates, with no weight but 1".to_string();
    Err((Some(keyword.line), SceneProblem::Unexpected { found, expected }))
}

fn face<'a>(words: impl Iterator<Item = Token<'a>>, vertices: &[(Point, usize)], line: usize) -> Result<Face, Located> {
    let vertices = words.map(|word| corner(word, vertices.len(), "face")).collect::<Result<Vec<u32>, _>>()?;
    if vertices.len() < 3 {
        let found = format!("a face of {} vertices", vertices.len());
        return Err((
            Some(line),
            SceneProblem::Unexpected { found, expected: "a face of 3 vertices or more".to_string() },
        ));
    }
    Ok(Face { vertices, line: Some(line) })
}

/// `i`, `i/t`, `i//n` or `i/t/n`: vertices count from 1, or from −1 backwards, among those above the statement. `of` says what of: a face, a line, a point.
fn corner(word: Token<'_>, count: usize, of: &str) -> Result<u32, Located> {
    let mut parts = word.text.split('/');
    let index = parts.next().unwrap_or("");
    let others: Vec<&str> = parts.collect();
    let is_integer = |text: &str| {
        let digits = text.strip_prefix('-').unwrap_or(text);
        !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
    };
    let well_formed = match others.as_slice() {
        [] => true,
        [texture] => is_integer(texture),
        [texture, normal] => (texture.is_empty() || is_integer(texture)) && is_integer(normal),
        _ => false,
    };
    if !is_integer(index) || !well_formed {
        return Err(unexpected(word, &format!("a vertex of a {of}: i, i/t, i//n or i/t/n")));
    }
    let place = match index.parse::<i64>() {
        Ok(index) if index > 0 => Some(index - 1),
        Ok(index) if index < 0 => Some(count as i64 + index),
        _ => None,
    };
    match place {
        Some(place) if (0..count as i64).contains(&place) => Ok(place as u32),
        _ => {
            let problem = SceneProblem::NotAllowed {
                what: format!("a vertex number of a {of}"),
                found: shown(index),
                allowed: match count {
                    0 => "none, there is no vertex above it".to_string(),
                    count => format!("1 to {count}, or -{count} to -1, the vertices above it"),
                },
            };
            Err((Some(word.line), problem))
        }
    }
}
