//! What can be wrong with a file of blocks, and where.

use crate::block::{BlockError, Point};
use crate::number::{Number, NumberError};
use crate::number_text::{decimal, shown};
use crate::scene::SceneFormat;
use crate::tolerance_spec::SpecError;
use std::fmt;
use std::path::PathBuf;

/// A file that cannot be used: which one, where in it, and why.
#[derive(Debug, thiserror::Error)]
pub struct SceneError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1, where one is to blame.
    pub line: Option<usize>,
    /// What is wrong; part of this error's own message.
    pub problem: SceneProblem,
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        write!(f, " {}", self.problem)
    }
}

/// What is wrong with a file: what was found, and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum SceneProblem {
    /// The operating system's answer.
    #[error("{0}")]
    Io(std::io::Error),
    /// A file that a scene names and that cannot be read.
    #[error("`file` {file}: {error}")]
    NamedFile {
        /// The file, as looked for.
        file: String,
        /// The operating system's answer.
        error: std::io::Error,
    },
    /// A name that says nothing about the format.
    #[error("cannot tell the format from the name; known are {}, the last two for voro++; CAD programs export STL and OBJ", SceneFormat::listed(|_| true))]
    UnknownFormat,
    /// A byte that no text file contains.
    #[error("byte {offset} of the file is 0x{byte:02x}, which is not text; only text files can be read")]
    NotText {
        /// Position of the byte, from 0.
        offset: usize,
        /// The byte.
        byte: u8,
    },
    /// A text that has two bytes or four a letter.
    #[error("this is a text in UTF-16; texts in UTF-8 or ASCII can be read: save it as UTF-8")]
    Utf16,
    /// Something else than what must stand here.
    #[error("found {found} where {expected} should stand")]
    Unexpected {
        /// What was found.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// The end of the file in the middle of something.
    #[error("the file ends where {expected} should stand")]
    Truncated {
        /// What is allowed.
        expected: String,
    },
    /// A value that is no number, or none that can be used.
    #[error("{what}: {error}")]
    Number {
        /// What the number is for.
        what: String,
        /// Why it cannot be used.
        error: NumberError,
    },
    /// A number out of its range, or counts that do not fit together.
    #[error("{what} is {found}; allowed is {allowed}")]
    NotAllowed {
        /// What the number is for.
        what: String,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// A part of the format that this reader does not know.
    #[error("{what} cannot be read; {allowed}")]
    Unsupported {
        /// What was found.
        what: String,
        /// What can be read.
        allowed: String,
    },
    /// TOML that does not parse.
    #[error("not valid TOML: {message}")]
    Toml {
        /// The parser's words.
        message: String,
    },
    /// A key that means nothing here.
    #[error("unknown key `{found}` in {place}; known are {known}")]
    UnknownKey {
        /// The key.
        found: String,
        /// The table it stands in.
        place: String,
        /// What may stand there.
        known: String,
    },
    /// A block that is none.
    #[error("{}", block_in_words(error, place))]
    Block {
        /// What is wrong with it.
        error: BlockError,
        /// Which block it is, and where the error is in it.
        place: Box<BlockPlace>,
    },
    /// Tolerances that are none.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// A scene in TOML whose lengths are to be multiplied.
    #[error(
        "a scale is for files of coordinates; a scene in TOML has other lengths in metres as well: scale what it was made from"
    )]
    ScaledScene,
    /// A file of whose blocks joining vertices leaves none.
    #[error("--weld {} joins all vertices of block {}, and there is no other in it", shown(&distance.to_string()), shown(name))]
    JoinedAway {
        /// The distance.
        distance: Number,
        /// The first block.
        name: String,
    },
    /// A file without any block.
    #[error("there is no block in it")]
    NoBlock,
}

/// Which block an error is about, and where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockPlace {
    /// The block, by number and name.
    pub block: String,
    /// Where the vertices that the error names are: not every format numbers them, and none as blocks do.
    pub vertices: Vec<VertexPlace>,
    /// The block that it is a cavity of, by name: where it is turned inside out and lies within that.
    pub cavity_of: Option<String>,
}

/// Where a vertex of a file is.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexPlace {
    /// Its number in its block, from 0.
    pub vertex: usize,
    /// Where the file has it, in the file's unit of length.
    pub point: Point,
    /// The line, from 1, where it is known.
    pub line: Option<usize>,
}

impl fmt::Display for VertexPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.point.components().map(decimal);
        write!(f, "vertex {} at ({x}, {y}, {z})", self.vertex)?;
        match self.line {
            Some(line) => write!(f, " in line {line}"),
            None => Ok(()),
        }
    }
}

/// A block that is none, in a sentence.
fn block_in_words(error: &BlockError, place: &BlockPlace) -> String {
    let BlockPlace { block, vertices, cavity_of } = place;
    match cavity_of {
        None => format!("{block}: {error}{}", behind_error(vertices)),
        Some(name) => {
            let around = shown(name);
            format!(
                "{block}: its faces run clockwise seen from outside, and it lies within \"{around}\": a cavity, which no block can have; \
                 split \"{around}\" into several blocks around it"
            )
        }
    }
}

/// Where vertices are, in parentheses behind a sentence about them.
fn behind_error(vertices: &[VertexPlace]) -> String {
    const MAX_VERTICES: usize = 4;
    let shown: Vec<String> = vertices.iter().take(MAX_VERTICES).map(VertexPlace::to_string).collect();
    if shown.is_empty() { String::new() } else { format!(" ({})", shown.join(", ")) }
}
