//! What the comparisons of a few pairs come to, before it is added to the counts of a campaign: few rows, found one after the other, so that
//! a comparison costs neither texts nor trees.

use super::agreement::{AgreementCounts, ChainSpan, NONE};
use super::compare::{AnswerChange, Difference, Features, differences};
use super::separation_state::StateComparison;
use rockproof_model::{Contact, ContactKind};
use std::sync::Arc;

/// What was compared, as [`super::agreement::ComparisonKey`] has it, of a pair of some family.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'x> {
    /// The family.
    pub family: &'x Arc<str>,
    /// The tolerance set.
    pub tolerances: &'x Arc<str>,
    /// The links.
    pub span: ChainSpan,
    /// The precision or the engine.
    pub engine: &'x str,
}

/// The comparisons of a family under one tolerance set, of the same links for the same engine.
#[derive(Clone, Debug)]
pub(super) struct RecordedRow {
    pub(super) family: Arc<str>,
    pub(super) tolerances: Arc<str>,
    pub(super) span: ChainSpan,
    pub(super) engine: Box<str>,
    pub(super) counts: AgreementCounts,
    /// How often what was before became what was after.
    pub(super) transitions: Vec<([&'static str; 2], u64)>,
}

/// The comparisons of a few pairs.
#[derive(Clone, Debug, Default)]
pub struct AgreementRecord {
    pub(super) rows: Vec<RecordedRow>,
}

impl RecordedRow {
    fn is_of(&self, compared: &Compared<'_>) -> bool {
        let Compared { family, tolerances, span, engine } = *compared;
        self.span == span && *self.engine == *engine && same(&self.tolerances, tolerances) && same(&self.family, family)
    }

    fn add_transition(&mut self, became: [&'static str; 2], times: u64) {
        match self.transitions.iter_mut().find(|(known, _)| *known == became) {
            Some((_, sum)) => *sum += times,
            None => self.transitions.push((became, times)),
        }
    }
}

fn same(one: &Arc<str>, other: &Arc<str>) -> bool {
    Arc::ptr_eq(one, other) || one == other
}

impl AgreementRecord {
    fn row(&mut self, compared: &Compared<'_>) -> &mut RecordedRow {
        let at = self.rows.iter().position(|row| row.is_of(compared)).unwrap_or_else(|| {
            let Compared { family, tolerances, span, engine } = *compared;
            self.rows.push(RecordedRow {
                family: Arc::clone(family),
                tolerances: Arc::clone(tolerances),
                span,
                engine: engine.into(),
                counts: AgreementCounts::default(),
                transitions: Vec::new(),
            });
            self.rows.len() - 1
        });
        &mut self.rows[at]
    }

    /// How many contacts were there before, in all comparisons of these links.
    pub fn contacts_before(&self, span: ChainSpan) -> u64 {
        self.rows.iter().filter(|row| row.span == span).map(|row| row.counts.contacts).sum()
    }

    /// Two answers.
    pub fn answers(&mut self, compared: &Compared<'_>, before: &[Contact], after: &[Contact], features: Features<'_>) {
        let row = self.row(compared);
        let changed = differences(before, after, features);
        let of = |change| changed.iter().filter(|d| d.change == change).count() as u64;
        row.counts.add(&AgreementCounts {
            pairs: 1,
            agreeing: u64::from(changed.is_empty()),
            contacts: before.len() as u64,
            entrance: of(AnswerChange::Entrance),
            gap_sign: of(AnswerChange::GapSign),
            ..AgreementCounts::default()
        });
        let name = |contact: Option<Contact>| contact.map_or(NONE, |c| c.kind().name());
        let moved =
            |d: &&Difference| matches!(d.change, AnswerChange::Missing | AnswerChange::Extra | AnswerChange::Kind);
        for kind in ContactKind::ALL {
            let there = before.iter().filter(|c| c.kind() == kind).count();
            let left = changed.iter().filter(moved).filter(|d| d.before.is_some_and(|c| c.kind() == kind)).count();
            if there > left {
                row.add_transition([kind.name(); 2], (there - left) as u64);
            }
        }
        for difference in changed.iter().filter(moved) {
            row.add_transition([name(difference.before), name(difference.after)], 1);
        }
    }

    /// An engine's word on how two blocks lie, and whether it is right in all it said.
    pub fn state(&mut self, compared: &Compared<'_>, comparison: &StateComparison, right: bool) {
        let row = self.row(compared);
        row.counts.add(&AgreementCounts { pairs: 1, agreeing: u64::from(right), ..AgreementCounts::default() });
        row.add_transition([comparison.exact.name(), comparison.reported.state.name()], 1);
    }

    /// No answer on the later side.
    pub fn no_answer(&mut self, compared: &Compared<'_>) {
        self.row(compared).counts.add(&AgreementCounts { pairs: 1, silent: 1, ..AgreementCounts::default() });
    }

    /// Adds the comparisons of other pairs.
    pub fn add(&mut self, other: AgreementRecord) {
        for row in other.rows {
            let RecordedRow { family, tolerances, span, engine, .. } = &row;
            let compared = Compared { family, tolerances, span: *span, engine };
            match self.rows.iter_mut().find(|known| known.is_of(&compared)) {
                None => self.rows.push(row),
                Some(known) => {
                    known.counts.add(&row.counts);
                    for (became, times) in row.transitions {
                        known.add_transition(became, times);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agreement::Agreement;
    use rockproof_model::{ContactKey, Entrance, FaceId, Sign, Topology, VertexId};

    /// Pairs added one by one to the counts of a campaign are what they are when added to one another first, in whichever order.
    #[test]
    fn what_is_added_up_first_comes_to_the_same() {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let solid = Topology::new(4, faces.map(|face| face.to_vec()).to_vec()).expect("a tetrahedron");
        let features = Features { a: &solid, b: &solid };
        let contact = |kind, v| Contact {
            key: ContactKey::of_kind(kind, [v, 1]),
            entrance: Entrance::VertexFace(VertexId(v), FaceId(0)),
            gap: Sign::Zero,
        };
        let of_pair = |pair: u32| {
            let family: Arc<str> = ["sliver", "corner"][pair as usize % 2].into();
            let tolerances: Arc<str> = ["shi", "auto", "zero"][pair as usize % 3].into();
            let mut record = AgreementRecord::default();
            for (span, engine) in [(ChainSpan::Tolerance, "f32"), (ChainSpan::Whole, "f32"), (ChainSpan::Whole, "f64")]
            {
                let compared = Compared { family: &family, tolerances: &tolerances, span, engine };
                let kind = ContactKind::ALL[pair as usize % ContactKind::ALL.len()];
                let before = [contact(ContactKind::VertexVertex, 0), contact(kind, 1 + pair % 3)];
                let after = &before[..(pair as usize / 2) % 3];
                record.answers(&compared, &before, after, features);
                if pair.is_multiple_of(5) {
                    record.no_answer(&compared);
                }
            }
            record
        };
        let added = |records: Vec<AgreementRecord>| {
            let mut sum = Agreement::default();
            records.into_iter().for_each(|record| sum.add_record(record));
            sum
        };
        let mut together = AgreementRecord::default();
        (0..40).rev().for_each(|pair| together.add(of_pair(pair)));
        let (one_by_one, together) = (added((0..40).map(of_pair).collect()), added(vec![together]));
        assert_eq!(one_by_one, together);
        let rows = String::from_utf8(one_by_one.to_csv().expect("rows")).expect("text");
        // Six sets and families, three spans each; of 40 pairs 7 are of the first.
        assert_eq!(rows.lines().count(), 1 + 18);
        assert!(rows.contains("sliver,shi,whole,f64,9,"), "{rows}");
    }
}
