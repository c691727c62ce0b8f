//! VTK's unstructured grids in XML: a block for every cell. Polyhedra come as face streams (`faces`, `faceoffsets`) or, from VTK 9.4 on, as
//! lists of faces (`polyhedron_to_faces`). Data on points and cells is skipped.
//!
//! `vtkio` cannot hold polyhedra in XML, and gives errors without a place.

mod arrays;
mod data;

use crate::block::Point;
use crate::number::Number;
use crate::scene::cells::{KINDS, POLYHEDRON, known_kinds};
use crate::scene::error::SceneProblem;
use crate::scene::raw::{RawBlock, Winding};
use crate::scene::tokens::{Located, out_of};
use crate::vector::Vec3;
use arrays::{Grid, Piece};
use data::{Encoding, Values};
use std::collections::{BTreeSet, HashMap};

pub(super) fn read(bytes: &[u8]) -> Result<Vec<RawBlock>, Located> {
    let grid = arrays::read(bytes)?;
    let several = grid.pieces.len() > 1;
    let mut blocks = Vec::new();
    for (number, piece) in grid.pieces.iter().enumerate() {
        let place = if several { format!(" of piece {number}") } else { String::new() };
        blocks.extend(PieceReader { grid: &grid, piece, place }.blocks()?);
    }
    Ok(blocks)
}

/// Reads one piece.
struct PieceReader<'a> {
    grid: &'a Grid<'a>,
    piece: &'a Piece,
    /// Which piece it is, for messages; nothing where there is one alone.
    place: String,
}

/// The faces of polyhedra, as far as the file has any.
enum Polyhedra {
    None,
    /// For each cell: number of faces, then for each face number of points and points.
    Streams {
        faces: Vec<i64>,
        ends: Vec<i64>,
    },
    /// For each cell numbers of faces, and the points of these.
    Lists {
        faces: Vec<i64>,
        ends: Vec<i64>,
        points: Vec<i64>,
        point_ends: Vec<i64>,
    },
}

impl PieceReader<'_> {
    fn blocks(&self) -> Result<Vec<RawBlock>, Located> {
        if self.piece.cells == 0 {
            return Ok(Vec::new());
        }
        let points = self.points()?;
        let [connectivity, ends, kinds] =
            [self.integers("connectivity")?, self.integers("offsets")?, self.integers("types")?];
        for (name, array) in [("offsets", &ends), ("types", &kinds)] {
            self.check_length(name, array.len(), self.piece.cells)?;
        }
        let polyhedra = if kinds.contains(&POLYHEDRON) { self.polyhedra()? } else { Polyhedra::None };
        let mut used = vec![false; points.len()];
        let mut blocks = Vec::new();
        for (cell, &kind) in kinds.iter().enumerate() {
            // Of a polyhedron its faces say what it is, but a cell must be in the list all the same.
            let corners = self.part(&connectivity, &ends, cell, "connectivity")?;
            let faces = if kind == POLYHEDRON {
                self.polyhedron(&polyhedra, cell, points.len())?
            } else {
                let corners = self.numbers(corners, points.len(), &format!("a point number of cell {cell}"))?;
                let Some(known) = KINDS.iter().find(|known| known.number == kind) else {
                    return Err(self.unknown_kind(cell, kind));
                };
                if corners.len() != known.corners {
                    let what = format!("the number of points of cell {cell}{}, a {},", self.place, known.name);
                    return Err(not_allowed(what, corners.len(), known.corners.to_string()));
                }
                known.faces_on(&corners)
            };
            faces.iter().flatten().for_each(|&point| used[point as usize] = true);
            blocks.push(block(&faces, &points));
        }
        match used.iter().position(|&used| !used) {
            None => Ok(blocks),
            Some(point) => {
                Err(not_allowed(format!("point {point}{}", self.place), "in no cell", "to be in a cell".to_owned()))
            }
        }
    }

    fn points(&self) -> Result<Vec<Point>, Located> {
        let values = match self.values("Points")? {
            Values::Floats(values) => values,
            Values::Integers(values) => values.into_iter().map(|value| value as f64).collect(),
        };
        let expected = self.piece.points.saturating_mul(3);
        self.check_length("Points", values.len(), expected)?;
        let coordinate = |at: usize| {
            Number::from_f64(values[at]).map_err(|error| {
                let what = format!("a coordinate of point {}{}", at / 3, self.place);
                (None, SceneProblem::Number { what, error })
            })
        };
        (0..self.piece.points)
            .map(|p| Ok(Vec3::new(coordinate(3 * p)?, coordinate(3 * p + 1)?, coordinate(3 * p + 2)?)))
            .collect()
    }

    fn polyhedra(&self) -> Result<Polyhedra, Located> {
        if self.piece.arrays.contains_key("polyhedron_to_faces") {
            return Ok(Polyhedra::Lists {
                faces: self.integers("polyhedron_to_faces")?,
                ends: self.integers("polyhedron_offsets")?,
                points: self.integers("face_connectivity")?,
                point_ends: self.integers("face_offsets")?,
            });
        }
        let (faces, ends) = (self.integers("faces")?, self.integers("faceoffsets")?);
        self.check_length("faceoffsets", ends.len(), self.piece.cells)?;
        Ok(Polyhedra::Streams { faces, ends })
    }

    fn polyhedron(&self, polyhedra: &Polyhedra, cell: usize, points: usize) -> Result<Vec<Vec<u32>>, Located> {
        let what = format!("a point number of cell {cell}");
        match polyhedra {
            Polyhedra::None => Ok(Vec::new()),
            Polyhedra::Lists { faces, ends, points: all, point_ends } => {
                let numbers = self.part(faces, ends, cell, "polyhedron_to_faces")?;
                let numbers = self.numbers(numbers, point_ends.len(), &format!("a face number of cell {cell}"))?;
                let face = |&number: &u32| {
                    let corners = self.part(all, point_ends, number as usize, "face_connectivity")?;
                    self.numbers(corners, points, &what)
                };
                numbers.iter().map(face).collect()
            }
            Polyhedra::Streams { faces, ends } => {
                // Other cells between polyhedra have −1 for their end.
                let before = ends[..cell].iter().rev().find(|&&end| end >= 0).copied().unwrap_or(0);
                let stream = self.between(faces, before, ends[cell], "faceoffsets", cell)?;
                let short = || {
                    let expected = format!("the next entry of the face stream of cell {cell}{}", self.place);
                    (None, SceneProblem::Truncated { expected })
                };
                let mut rest = stream;
                let mut next = |count: usize| -> Result<&[i64], Located> {
                    let (taken, others) = rest.split_at_checked(count).ok_or_else(short)?;
                    rest = others;
                    Ok(taken)
                };
                let count = next(1)?[0];
                let mut all = Vec::new();
                for _ in 0..count {
                    let length = usize::try_from(next(1)?[0]).map_err(|_| short())?;
                    all.push(self.numbers(next(length)?, points, &what)?);
                }
                if !rest.is_empty() {
                    let what = format!("the length of the face stream of cell {cell}{}", self.place);
                    let allowed = format!("{}, behind its last face", stream.len() - rest.len());
                    return Err(not_allowed(what, stream.len(), allowed));
                }
                Ok(all)
            }
        }
    }

    /// The entries of a list that belong to one of those whose ends are given.
    fn part<'l>(&self, list: &'l [i64], ends: &[i64], which: usize, name: &str) -> Result<&'l [i64], Located> {
        let Some(&end) = ends.get(which) else {
            return Err((None, out_of(&format!("a number in \"{name}\"{}", self.place), which, ends.len())));
        };
        let begin = if which == 0 { 0 } else { ends[which - 1] };
        self.between(list, begin, end, name, which)
    }

    fn between<'l>(
        &self,
        list: &'l [i64],
        begin: i64,
        end: i64,
        name: &str,
        which: usize,
    ) -> Result<&'l [i64], Located> {
        let range = usize::try_from(begin).ok().zip(usize::try_from(end).ok());
        range.and_then(|(begin, end)| list.get(begin..end)).ok_or_else(|| {
            let what = format!("offset {which} into \"{name}\"{}", self.place);
            not_allowed(what, end, format!("{begin} to {}", list.len()))
        })
    }

    fn numbers(&self, values: &[i64], limit: usize, what: &str) -> Result<Vec<u32>, Located> {
        let number = |&value: &i64| match u32::try_from(value) {
            Ok(number) if (number as usize) < limit => Ok(number),
            _ => Err((None, out_of(&format!("{what}{}", self.place), value, limit))),
        };
        values.iter().map(number).collect()
    }

    fn integers(&self, name: &str) -> Result<Vec<i64>, Located> {
        match self.values(name)? {
            Values::Integers(values) => Ok(values),
            Values::Floats(_) => {
                let what = format!("the type of the array \"{name}\"{}", self.place);
                Err(not_allowed(what, "one of fractions", "Int8 to Int64 or UInt8 to UInt64".to_owned()))
            }
        }
    }

    fn values(&self, name: &str) -> Result<Values, Located> {
        let Some(array) = self.piece.arrays.get(name) else {
            let expected = format!("the array \"{name}\"{}", self.place);
            return Err((Some(self.piece.line), SceneProblem::Truncated { expected }));
        };
        data::values(array, name, self.grid)
    }

    fn check_length(&self, name: &str, found: usize, expected: usize) -> Result<(), Located> {
        if found == expected {
            return Ok(());
        }
        let what = format!("the number of values of \"{name}\"{}", self.place);
        let line = self.piece.arrays.get(name).map(|array| array.line);
        Err((line, SceneProblem::NotAllowed { what, found: found.to_string(), allowed: expected.to_string() }))
    }

    fn unknown_kind(&self, cell: usize, kind: i64) -> Located {
        let what = format!("cell {cell}{} of type {kind}", self.place);
        (None, SceneProblem::Unsupported { what, allowed: known_kinds() })
    }
}

fn not_allowed(what: String, found: impl ToString, allowed: String) -> Located {
    (None, SceneProblem::NotAllowed { what, found: found.to_string(), allowed })
}

/// A cell with faces on points of the grid.
fn block(faces: &[Vec<u32>], points: &[Point]) -> RawBlock {
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&v, i)| (v, i)).collect();
    RawBlock {
        vertices: used.iter().map(|&v| points[v as usize].clone()).collect(),
        faces: faces.iter().map(|face| face.iter().map(|v| place[v]).collect()).collect(),
        winding: Winding::Any,
        ..RawBlock::default()
    }
}
