//! That margins which a recorded classification leads to are those of one that asks everything itself.

use super::{Dice, INPUTS, block, tolerances};
use crate::classification::{Classification, Observer};
use crate::pair::Pair;
use crate::prepared_block::PreparedBlock;
use crate::trace::Margin;
use rockproof_model::decision::Decision;
use rockproof_model::{ContactKey, EdgeId, Sign, VertexId};
use std::collections::HashMap;

/// Measures every decision whenever it is made.
#[derive(Default)]
struct MeasureAll {
    margins: Vec<(Decision, Option<Margin>)>,
    /// Where each decision is among them.
    places: HashMap<Decision, usize>,
    /// Where the decision under way is.
    at: Option<usize>,
}

impl Observer for MeasureAll {
    fn begin(&mut self, decision: &Decision) {
        let place = *self.places.entry(*decision).or_insert(self.margins.len());
        self.at = Some(place);
        if place == self.margins.len() {
            self.margins.push((*decision, None));
        }
    }

    fn sign(&mut self, sign: Sign, margin: &mut dyn FnMut() -> f64) -> Sign {
        let Some(at) = self.at else { return sign };
        let (relative, nearest) = (margin(), &mut self.margins[at].1);
        if nearest.is_none_or(|nearest| relative < nearest.relative) {
            *nearest = Some(Margin { sign, relative });
        }
        sign
    }

    fn end(&mut self, _decision: &Decision, yes: bool) -> bool {
        self.at = None;
        yes
    }

    fn end_with_sign(&mut self, _decision: &Decision, sign: Sign) -> Sign {
        self.at = None;
        sign
    }
}

fn bits(margin: Option<Margin>) -> Option<(Sign, u64)> {
    margin.map(|margin| (margin.sign, margin.relative.to_bits()))
}

#[test]
fn margins_by_a_recorded_classification_are_those_of_one_of_its_own() {
    let mut dice = Dice(77);
    let (mut measured, mut without_sign, mut ties) = (0, 0, 0);
    for round in 0..120 {
        let input = INPUTS[round % INPUTS.len()];
        let shift = [0, 1, 1][dice.below(3) as usize];
        let (Some(a), Some(b)) = (block(&mut dice, input, 0), block(&mut dice, input, shift)) else { continue };
        let size = a.coordinates().chain(b.coordinates()).map(|c| c.approximate().abs()).fold(0.0, f64::max);
        let (t, other) = (tolerances(&mut dice, size), tolerances(&mut dice, size));
        let kept = [ContactKey::VertexVertex(VertexId(0), VertexId(0)), ContactKey::EdgeEdge(EdgeId(0), EdgeId(1))];
        let kept = &kept[..round % 3];
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let pair = Pair::new(&a, &b);
        let mut plain = MeasureAll::default();
        let observer: &mut dyn Observer = &mut plain;
        Classification::new(&pair, &t, observer).with_kept(kept).classify();
        let MeasureAll { margins: plain, places, .. } = plain;
        let decisions: Vec<Decision> = plain.iter().map(|(decision, _)| *decision).collect();
        let traced: Vec<Decision> = pair.trace_with_kept(&t, kept).iter().map(|entry| entry.decision).collect();
        assert_eq!(traced, decisions, "round {round}");
        // All, every third in another order than they are made in, and one; with another trace between.
        let thirds: Vec<Decision> = decisions.iter().rev().step_by(3).copied().collect();
        pair.trace(&other);
        for wanted in [&decisions, &thirds, &decisions[..1].to_vec()] {
            let margins = pair.margins_with_kept(&t, kept, wanted);
            assert_eq!(margins.len(), wanted.len());
            for (decision, margin) in wanted.iter().zip(margins) {
                let right = places.get(decision).and_then(|&place| plain[place].1);
                assert_eq!(bits(margin), bits(right), "{decision}, round {round}");
            }
        }
        measured += plain.iter().filter(|(_, margin)| margin.is_some()).count();
        without_sign += plain.iter().filter(|(_, margin)| margin.is_none()).count();
        ties += plain.iter().filter(|(_, margin)| margin.is_some_and(|margin| margin.relative == 0.0)).count();
    }
    assert!(measured > 5_000 && without_sign > 50 && ties > 100, "{measured} {without_sign} {ties}");
}

/// More sets than are remembered, in turn: what was forgotten is made anew.
#[test]
fn what_is_no_longer_remembered_is_made_anew() {
    let mut dice = Dice(5);
    let (Some(a), Some(b)) = (block(&mut dice, INPUTS[0], 0), block(&mut dice, INPUTS[0], 0)) else { panic!("blocks") };
    let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
    let pair = Pair::new(&a, &b);
    let sets: Vec<_> = (0..9).map(|_| tolerances(&mut dice, 4.0)).collect();
    for set in sets.iter().chain(&sets) {
        let fresh = Pair::new(&a, &b).trace(set);
        assert_eq!(pair.trace(set), fresh);
        let decisions: Vec<Decision> = fresh.iter().map(|entry| entry.decision).collect();
        assert_eq!(pair.margins(set, &decisions), Pair::new(&a, &b).margins(set, &decisions));
    }
}
