//! Every decision of a classification, with ties and margins: for comparing with an engine and for explaining.

use crate::classification::{Classification, Observer};
use crate::pair::Pair;
use rockproof_model::decision::Decision;
use rockproof_model::decision_index::DecisionIndex;
use rockproof_model::{Contact, ContactKey, Sign, ToleranceSet};
use std::cell::{Ref, RefCell};

/// One decision the oracle made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceEntry {
    /// What was asked.
    pub decision: Decision,
    /// 1 yes, 0 no; the sign for gap-sign.
    pub outcome: i8,
    /// Whether a sign asked for it is exactly zero. A choice between planes that the signs of their gaps settle, as between two
    /// that touch, asks none: those signs are decisions of their own. Of inside-face: whether the projection lies on the face's
    /// boundary, or the face has no area.
    pub tie: bool,
}

/// How close a decision is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Sign of the polynomial nearest to zero among those the decision rests on; of those equally near, the first asked. Of
    /// inside-face positive inside.
    pub sign: Sign,
    /// The size of that polynomial over the sum of the magnitudes of its terms (coordinates, counted from A's first vertex,
    /// are terms of degree one): 0 at a tie, 1 where nothing cancels. Of inside-face, how close the projection is to the
    /// edge closest to it, by the largest of four: off its line, and beyond its ends along each coordinate axis.
    pub relative: f64,
}

impl Pair<'_> {
    /// All decisions of [`Pair::classify`] in the order made, each once.
    pub fn trace(&self, tolerances: &ToleranceSet) -> Vec<TraceEntry> {
        self.trace_with_kept(tolerances, &[])
    }

    /// All decisions of [`Pair::classify_with_kept`], likewise.
    pub fn trace_with_kept(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Vec<TraceEntry> {
        self.recording(tolerances, kept).entries.clone()
    }

    /// What came of each decision of [`Pair::trace_with_kept`], and where each is in that list.
    pub fn outcomes_with_kept(
        &self,
        tolerances: &ToleranceSet,
        kept: &[ContactKey],
    ) -> (Vec<(Decision, i8)>, DecisionIndex) {
        let recording = self.recording(tolerances, kept);
        let outcomes = recording.entries.iter().map(|entry| (entry.decision, entry.outcome)).collect();
        (outcomes, recording.index.clone())
    }

    /// The contacts of [`Pair::classify_with_kept`], found by the way of [`Pair::trace_with_kept`]: for who asks for both.
    pub fn traced_contacts(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Vec<Contact> {
        self.recording(tolerances, kept).contacts.clone()
    }

    /// The exact margins of several decisions, for the price of the margins themselves once [`Pair::trace`] was asked under the same
    /// tolerances; `None` for one that [`Pair::classify`] does not come to make, or that asks no sign of its own.
    pub fn margins(&self, tolerances: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<Margin>> {
        self.margins_with_kept(tolerances, &[], decisions)
    }

    /// The exact margins of decisions of [`Pair::classify_with_kept`].
    pub fn margins_with_kept(
        &self,
        tolerances: &ToleranceSet,
        kept: &[ContactKey],
        decisions: &[Decision],
    ) -> Vec<Option<Margin>> {
        let recording = self.recording(tolerances, kept);
        let mut replay = Replay::new(&recording, decisions);
        let observer: &mut dyn Observer = &mut replay;
        Classification::new(self, tolerances, observer).with_kept(kept).classify();
        replay.margins
    }

    /// The classification with its decisions, from memory where it was asked for before.
    fn recording(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Ref<'_, Recording> {
        let known = |recordings: &Recordings| recordings.position(tolerances, kept);
        let at = known(&self.recordings).unwrap_or_else(|| {
            let mut recorder = Recorder { entries: Vec::with_capacity(512), ..Recorder::default() };
            let observer: &mut dyn Observer = &mut recorder;
            let contacts = Classification::new(self, tolerances, observer).with_kept(kept).classify();
            self.recordings.add(tolerances, kept, recorder.into_recording(contacts))
        });
        Ref::map(self.recordings.made.borrow(), |made| &made[at].2)
    }
}

/// What is remembered of a classification: all it takes to come by the same way again without asking anything twice.
struct Recording {
    /// What came of it.
    contacts: Vec<Contact>,
    /// The decisions, each once.
    entries: Vec<TraceEntry>,
    /// Where each of them is.
    index: DecisionIndex,
    /// For each of them, which of all `outcomes` is its first.
    first: Vec<u32>,
    /// The outcomes of all decisions in the order made, those asked again too.
    outcomes: Vec<i8>,
    /// The signs that no decision asked for.
    signs: Vec<Sign>,
}

/// The last few classifications of a pair that were recorded.
#[derive(Default)]
pub(crate) struct Recordings {
    made: RefCell<Vec<(ToleranceSet, Vec<ContactKey>, Recording)>>,
}

/// How many classifications of a pair are remembered. The chain of causes asks for six at most: ideal and given tolerances, for each precision.
const REMEMBERED: usize = 6;

impl Recordings {
    fn position(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Option<usize> {
        self.made.borrow().iter().position(|(set, contacts, _)| set == tolerances && contacts == kept)
    }

    /// Remembers one more, and says where it is.
    fn add(&self, tolerances: &ToleranceSet, kept: &[ContactKey], recording: Recording) -> usize {
        let mut made = self.made.borrow_mut();
        if made.len() == REMEMBERED {
            made.remove(0);
        }
        made.push((tolerances.clone(), kept.to_vec(), recording));
        made.len() - 1
    }
}

/// Notes every decision.
#[derive(Default)]
struct Recorder {
    entries: Vec<TraceEntry>,
    signs: Vec<Sign>,
    /// Whether a decision is being made.
    deciding: bool,
    tie: bool,
}

impl Recorder {
    fn note(&mut self, decision: &Decision, outcome: i8) {
        self.deciding = false;
        self.entries.push(TraceEntry { decision: *decision, outcome, tie: self.tie });
    }

    fn into_recording(self, contacts: Vec<Contact>) -> Recording {
        let Recorder { mut entries, signs, .. } = self;
        let outcomes = entries.iter().map(|entry| entry.outcome).collect();
        let mut first: Vec<u32> = Vec::with_capacity(entries.len());
        let mut index = DecisionIndex::with_room(entries.len());
        for number in 0..entries.len() {
            let entry = entries[number];
            if index.add(&entry.decision, first.len(), |place| &entries[place].decision).is_none() {
                entries[first.len()] = entry;
                first.push(number as u32);
            }
        }
        entries.truncate(first.len());
        Recording { contacts, entries, index, first, outcomes, signs }
    }
}

impl Observer for Recorder {
    fn begin(&mut self, _decision: &Decision) {
        (self.deciding, self.tie) = (true, false);
    }

    fn sign(&mut self, sign: Sign, _margin: &mut dyn FnMut() -> f64) -> Sign {
        self.tie |= sign.is_zero();
        if !self.deciding {
            self.signs.push(sign);
        }
        sign
    }

    fn end(&mut self, decision: &Decision, yes: bool) -> bool {
        self.note(decision, i8::from(yes));
        yes
    }

    fn end_with_sign(&mut self, decision: &Decision, sign: Sign) -> Sign {
        self.note(decision, sign.as_i8());
        sign
    }
}

/// Measures the decisions wanted, each the first time that it comes; all else comes out as recorded.
struct Replay<'r> {
    recording: &'r Recording,
    /// Which of all decisions are wanted, in the order made, and the place of each among those wanted.
    wanted: Vec<(u32, usize)>,
    margins: Vec<Option<Margin>>,
    /// How many decisions have come.
    decided: u32,
    /// How many signs that no decision asked for.
    signs: usize,
    /// How many of the decisions wanted.
    measured: usize,
    /// Place of the decision being made among those wanted.
    measuring: Option<usize>,
}

impl<'r> Replay<'r> {
    fn new(recording: &'r Recording, decisions: &[Decision]) -> Replay<'r> {
        let place = |decision| recording.index.find(decision, |place| &recording.entries[place].decision);
        let first = |decision| Some(recording.first[place(decision)?]);
        let mut wanted: Vec<(u32, usize)> =
            decisions.iter().zip(0..).filter_map(|(d, at)| Some((first(d)?, at))).collect();
        wanted.sort_unstable();
        wanted.dedup_by_key(|(first, _)| *first);
        let margins = vec![None; decisions.len()];
        Replay { recording, wanted, margins, decided: 0, signs: 0, measured: 0, measuring: None }
    }
}

impl Observer for Replay<'_> {
    fn begin(&mut self, _decision: &Decision) {}

    fn sign(&mut self, sign: Sign, margin: &mut dyn FnMut() -> f64) -> Sign {
        if let Some(at) = self.measuring {
            let relative = margin();
            if self.margins[at].is_none_or(|nearest| relative < nearest.relative) {
                self.margins[at] = Some(Margin { sign, relative });
            }
        }
        sign
    }

    fn end(&mut self, _decision: &Decision, yes: bool) -> bool {
        self.measuring = None;
        yes
    }

    fn end_with_sign(&mut self, _decision: &Decision, sign: Sign) -> Sign {
        self.measuring = None;
        sign
    }

    fn known_outcome(&mut self) -> Option<i8> {
        let number = self.decided;
        self.decided += 1;
        match self.wanted.get(self.measured) {
            Some(&(wanted, place)) if wanted == number => {
                self.measured += 1;
                self.measuring = Some(place);
                None
            }
            _ => self.recording.outcomes.get(number as usize).copied(),
        }
    }

    fn known_sign(&mut self) -> Option<Sign> {
        if self.measuring.is_some() {
            return None;
        }
        self.signs += 1;
        self.recording.signs.get(self.signs - 1).copied()
    }
}
