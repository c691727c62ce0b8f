//! Every decision of a classification, with ties and margins: for comparing with an engine and for explaining.

use crate::classification::{Classification, Observer};
use crate::pair::Pair;
use foldhash::fast::FixedState;
use rockproof_model::decision::Decision;
use rockproof_model::{ContactKey, Sign, ToleranceSet};
use std::collections::HashSet;

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
        self.trace_keeping(tolerances, &[])
    }

    /// All decisions of [`Pair::classify_keeping`], likewise.
    pub fn trace_keeping(&self, tolerances: &ToleranceSet, kept: &[ContactKey]) -> Vec<TraceEntry> {
        let mut recorder = Recorder::default();
        let observer: &mut dyn Observer = &mut recorder;
        Classification::new(self, tolerances, observer).keeping(kept).classify();
        let mut entries = recorder.entries;
        let mut seen = HashSet::with_capacity_and_hasher(entries.len(), FixedState::default());
        entries.retain(|entry| seen.insert(entry.decision));
        entries
    }

    /// The exact margins of several decisions, for the price of one classification and of the margins themselves; `None` for
    /// one that [`Pair::classify`] does not come to make, or that asks no sign of its own.
    pub fn margins(&self, tolerances: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<Margin>> {
        self.margins_keeping(tolerances, &[], decisions)
    }

    /// The exact margins of decisions of [`Pair::classify_keeping`].
    pub fn margins_keeping(
        &self,
        tolerances: &ToleranceSet,
        kept: &[ContactKey],
        decisions: &[Decision],
    ) -> Vec<Option<Margin>> {
        let mut measure = Measure { wanted: decisions, margins: vec![None; decisions.len()], measuring: None };
        let observer: &mut dyn Observer = &mut measure;
        Classification::new(self, tolerances, observer).keeping(kept).classify();
        measure.margins
    }
}

/// Notes every decision.
#[derive(Default)]
struct Recorder {
    entries: Vec<TraceEntry>,
    tie: bool,
}

impl Observer for Recorder {
    fn begin(&mut self, _decision: &Decision) {
        self.tie = false;
    }

    fn sign(&mut self, sign: Sign, _margin: &mut dyn FnMut() -> f64) -> Sign {
        self.tie |= sign.is_zero();
        sign
    }

    fn end(&mut self, decision: &Decision, yes: bool) -> bool {
        self.entries.push(TraceEntry { decision: *decision, outcome: i8::from(yes), tie: self.tie });
        yes
    }

    fn end_with_sign(&mut self, decision: &Decision, sign: Sign) -> Sign {
        self.entries.push(TraceEntry { decision: *decision, outcome: sign.as_i8(), tie: self.tie });
        sign
    }
}

/// Measures the decisions wanted.
struct Measure<'d> {
    wanted: &'d [Decision],
    margins: Vec<Option<Margin>>,
    /// Place of the decision being made among those wanted.
    measuring: Option<usize>,
}

impl Observer for Measure<'_> {
    fn begin(&mut self, decision: &Decision) {
        self.measuring = self.wanted.iter().position(|wanted| wanted == decision);
    }

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
}
