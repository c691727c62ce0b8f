//! Text put around and between what a source file holds, and where it ends up.

use super::{CHOSEN, Id};
use std::ops::Range;

/// Bytes of a rewritten file.
pub struct Region {
    pub bytes: Range<usize>,
    pub mutants: Vec<Id>,
    /// Whether an error here says that the mutant does not compile; else it is the rewriting that does not.
    pub is_alternative: bool,
}

/// A piece of inserted text, with the alternatives in it.
#[derive(Default)]
pub(super) struct Inserted {
    pub(super) text: String,
    pub(super) alternatives: Vec<(Range<usize>, Id)>,
}

impl Inserted {
    pub(super) fn plain(text: impl Into<String>) -> Inserted {
        Inserted { text: text.into(), alternatives: Vec::new() }
    }

    /// `if chosen(id) { alternative } else `
    pub(super) fn alternative(&mut self, id: Id, text: &str) {
        self.text.push_str(&format!("if {CHOSEN}({id}) {{ "));
        let start = self.text.len();
        self.text.push_str(text);
        self.alternatives.push((start..self.text.len(), id));
        self.text.push_str(" } else ");
    }
}

/// What is done to bytes of the source: prefix, what takes the place of an operator, suffix; the bytes of the whole expression.
pub(super) struct Edit {
    pub(super) whole: Range<usize>,
    pub(super) prefix: Inserted,
    pub(super) replaced: Vec<(Range<usize>, Inserted)>,
    pub(super) suffix: Inserted,
    pub(super) mutants: Vec<Id>,
}

/// Writes the source with its edits.
pub(super) fn apply(source: &str, edits: Vec<Edit>) -> (String, Vec<Region>) {
    /// An insertion: at which byte, in which order there, how many bytes it takes the place of.
    struct Piece<'e> {
        order: (usize, u8, isize),
        skipped: usize,
        text: &'e Inserted,
        edit: usize,
        role: u8,
    }
    let mut pieces: Vec<Piece<'_>> = Vec::new();
    // What is deleted may hold the beginning of an inner expression, whose edits then make no sense; it holds none that is edited.
    let deleted: Vec<Range<usize>> =
        edits.iter().flat_map(|e| e.replaced.iter().map(|(range, _)| range.clone())).collect();
    for (number, edit) in edits.iter().enumerate() {
        let inside =
            |at: &Range<usize>| deleted.iter().any(|d| d.start <= at.start && at.end <= d.end && d.len() > at.len());
        if inside(&edit.whole) && !edit.whole.is_empty() {
            continue;
        }
        let n = number as isize;
        pieces.push(Piece { order: (edit.whole.start, 2, n), skipped: 0, text: &edit.prefix, edit: number, role: 0 });
        for (range, text) in &edit.replaced {
            pieces.push(Piece { order: (range.start, 3, n), skipped: range.len(), text, edit: number, role: 1 });
        }
        pieces.push(Piece { order: (edit.whole.end, 1, -n), skipped: 0, text: &edit.suffix, edit: number, role: 2 });
    }
    // Suffixes of an empty range come after its prefix.
    for piece in &mut pieces {
        if piece.role == 2 && edits[piece.edit].whole.is_empty() {
            piece.order.1 = 3;
        }
    }
    pieces.sort_by_key(|piece| piece.order);
    let (mut text, mut at) = (String::with_capacity(2 * source.len()), 0);
    let mut begun = vec![0; edits.len()];
    let mut regions = Vec::new();
    for piece in pieces {
        let position = piece.order.0;
        if position > at {
            text.push_str(&source[at..position]);
            at = position;
        }
        let begin = text.len();
        text.push_str(&piece.text.text);
        at = at.max(position + piece.skipped);
        for (range, id) in &piece.text.alternatives {
            let bytes = begin + range.start..begin + range.end;
            regions.push(Region { bytes, mutants: vec![*id], is_alternative: true });
        }
        match piece.role {
            0 => begun[piece.edit] = begin,
            2 => regions.push(Region {
                bytes: begun[piece.edit]..text.len(),
                mutants: edits[piece.edit].mutants.clone(),
                is_alternative: false,
            }),
            _ => {}
        }
    }
    text.push_str(&source[at..]);
    (text, regions)
}
