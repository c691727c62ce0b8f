//! What is noted of numbers, and how they are worked out from it.

use crate::wide::{BITS, Wide, in_bits};

/// How a number came about.
#[derive(Clone, Copy)]
pub(super) enum Note {
    /// Made in [`Wide`] at once: its place among those.
    Given(u32),
    Sum([Operand; 2]),
    Product([Operand; 2]),
    Quotient([Operand; 2]),
    Larger([Operand; 2]),
    Root(Operand),
    Magnitude(Operand),
}

#[derive(Clone, Copy)]
pub(super) enum Operand {
    Exact(f64),
    Noted { note: u32, negated: bool },
}

impl Note {
    fn operands(&self) -> &[Operand] {
        match self {
            Note::Given(_) => &[],
            Note::Sum(both) | Note::Product(both) | Note::Quotient(both) | Note::Larger(both) => both,
            Note::Root(one) | Note::Magnitude(one) => std::slice::from_ref(one),
        }
    }
}

/// What is noted on a thread.
pub(super) struct Notes {
    notes: Vec<Note>,
    given: Vec<Wide>,
    pub(super) short: WorkedOut,
    pub(super) long: WorkedOut,
    pub(super) is_full: bool,
}

/// What of the notes is worked out already in so many bits.
pub(super) struct WorkedOut {
    bits: u32,
    /// For each of the first notes the place of its number, or [`NOT_YET`].
    places: Vec<u32>,
    pub(super) numbers: Vec<Wide>,
    /// Notes that are being worked out; kept to reuse its memory.
    waiting: Vec<u32>,
}

const NOT_YET: u32 = u32::MAX;

/// Notes kept at a time. More are made by blocks so large that nothing should be kept of every operation.
pub(super) const MAX_NOTES: usize = 1 << 18;
/// Notes that a thread keeps room for, if the work before had not more.
const KEPT: usize = 1 << 15;
/// Bits in which a comparison is tried first.
pub(super) const FEWER_BITS: u32 = 128;

/// Empties a list. It keeps room for twice as many as it had: the next piece of work on a thread is often as long, and to fetch memory anew costs more
/// than to fill it.
fn emptied<T>(list: &mut Vec<T>) {
    let room = (2 * list.len()).max(KEPT);
    list.clear();
    list.shrink_to(room);
}

impl WorkedOut {
    const fn new(bits: u32) -> WorkedOut {
        WorkedOut { bits, places: Vec::new(), numbers: Vec::new(), waiting: Vec::new() }
    }

    fn place(&self, note: u32) -> Option<usize> {
        self.places.get(note as usize).filter(|&&place| place != NOT_YET).map(|&place| place as usize)
    }

    fn add(&mut self, note: u32, value: Wide) {
        if self.places.len() <= note as usize {
            self.places.resize(note as usize + 1, NOT_YET);
        }
        self.places[note as usize] = self.numbers.len() as u32;
        self.numbers.push(value);
    }
}

impl Notes {
    pub(super) const fn new() -> Notes {
        Notes {
            notes: Vec::new(),
            given: Vec::new(),
            short: WorkedOut::new(FEWER_BITS),
            long: WorkedOut::new(BITS),
            is_full: false,
        }
    }

    pub(super) fn begin(&mut self) {
        emptied(&mut self.notes);
        emptied(&mut self.given);
        for worked_out in [&mut self.short, &mut self.long] {
            emptied(&mut worked_out.places);
            emptied(&mut worked_out.numbers);
        }
        self.is_full = false;
    }

    pub(super) fn add(&mut self, note: Note) -> u32 {
        if self.notes.len() >= MAX_NOTES {
            self.is_full = true;
            return 0;
        }
        self.notes.push(note);
        self.notes.len() as u32 - 1
    }

    pub(super) fn add_given(&mut self, value: Wide) -> u32 {
        let note = self.add(Note::Given(self.given.len() as u32));
        if !self.is_full {
            self.given.push(value);
        }
        note
    }

    /// The note of an operand that has not been worked out yet.
    fn missing(&self, operand: Operand, worked_out: &WorkedOut) -> Option<u32> {
        let Operand::Noted { note, .. } = operand else { return None };
        let is_given = matches!(self.notes[note as usize], Note::Given(_));
        (!is_given && worked_out.place(note).is_none()).then_some(note)
    }

    /// The number of an operand that is worked out.
    fn number(&self, operand: Operand, worked_out: &WorkedOut) -> Wide {
        match operand {
            Operand::Exact(value) => Wide::of_f64(value),
            Operand::Noted { note, negated } => {
                let value = match self.notes[note as usize] {
                    Note::Given(place) => self.given[place as usize],
                    _ => worked_out.numbers[worked_out.places[note as usize] as usize],
                };
                if negated { -value } else { value }
            }
        }
    }

    /// What is noted, of operands that are worked out.
    fn calculated(&self, note: Note, worked_out: &WorkedOut) -> Wide {
        let number = |operand| self.number(operand, worked_out);
        match note {
            Note::Given(place) => self.given[place as usize],
            Note::Sum([one, two]) => number(one) + number(two),
            Note::Product([one, two]) => number(one) * number(two),
            Note::Quotient([one, two]) => number(one) / number(two),
            Note::Larger([one, two]) => number(one).maximum(number(two)),
            Note::Root(operand) => number(operand).root(),
            Note::Magnitude(operand) => number(operand).magnitude(),
        }
    }

    /// Works out an operand, and what it was made of, without recursion: sums over long faces are as deep as these are long.
    fn work_out(&self, operand: Operand, worked_out: &mut WorkedOut) -> Wide {
        in_bits(worked_out.bits, || {
            let mut waiting = std::mem::take(&mut worked_out.waiting);
            waiting.extend(self.missing(operand, worked_out));
            while let Some(&next) = waiting.last() {
                let note = self.notes[next as usize];
                let before = waiting.len();
                let missing = |operand: &Operand| self.missing(*operand, worked_out);
                waiting.extend(note.operands().iter().filter_map(missing));
                if waiting.len() == before {
                    waiting.pop();
                    // It may have been waited for twice.
                    if worked_out.place(next).is_none() {
                        let value = self.calculated(note, worked_out);
                        worked_out.add(next, value);
                    }
                }
            }
            worked_out.waiting = waiting;
            self.number(operand, worked_out)
        })
    }

    /// The number in all bits.
    pub(super) fn in_all_bits(&mut self, operand: Operand) -> Wide {
        let mut worked_out = std::mem::replace(&mut self.long, WorkedOut::new(BITS));
        let value = self.work_out(operand, &mut worked_out);
        self.long = worked_out;
        value
    }

    /// Two numbers in fewer bits.
    pub(super) fn in_fewer_bits(&mut self, operands: [Operand; 2]) -> [Wide; 2] {
        let mut worked_out = std::mem::replace(&mut self.short, WorkedOut::new(FEWER_BITS));
        let values = operands.map(|operand| self.work_out(operand, &mut worked_out));
        self.short = worked_out;
        values
    }
}
