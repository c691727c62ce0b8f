//! What a trace says of choices: which entrance was chosen, and which exits stay.

use crate::golden_contacts;
use crate::pairs::{corner_block, leaning, tolerances};
use rockproof_model::Block;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{FaceId, VertexId};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{ComputedContact, PreparedBlock, Tolerances, classify_traced};

fn traced(a: &Block, b: &Block, t: &rockproof_model::ToleranceSet) -> (Vec<ComputedContact<f64>>, Vec<(Decision, i8)>) {
    let (a, b) = (PreparedBlock::new(a).unwrap(), PreparedBlock::new(b).unwrap());
    classify_traced::<f64, SpecRules>(&a, &b, &Tolerances::new(t).unwrap())
}

/// The candidates of one contact stand together: its two features, then those of the candidate.
fn is_same_choice(one: &(Decision, i8), two: &(Decision, i8)) -> bool {
    let of = |&(decision, _): &(Decision, i8)| (decision.predicate, decision.features()[0], decision.features()[1]);
    of(one) == of(two)
}

#[test]
fn one_entrance_of_each_contact_is_chosen_and_it_is_that_of_the_contact() {
    let (mut alone, mut among_several) = (0, 0);
    for pair in golden_contacts::pairs() {
        let (found, decisions) = traced(&pair.a, &pair.b, &pair.tolerances);
        let mut before = None;
        for choice in decisions.chunk_by(is_same_choice) {
            let last = before.replace(choice[choice.len() - 1].0.predicate);
            if choice[0].0.predicate != Predicate::EntranceChoice {
                continue;
            }
            let chosen: Vec<_> = choice.iter().filter(|(_, outcome)| *outcome == 1).collect();
            assert_eq!(chosen.len(), 1, "{}: {choice:?}", pair.name);
            let [a, b, c, d] = chosen[0].0.features();
            let contact = found.iter().find(|found| found.contact.key.features().map(Some) == [a, b]);
            if let Some(found) = contact {
                assert_eq!(found.contact.entrance.features().map(Some), [c, d], "{}", pair.name);
            }
            // Where there is nothing to choose, nobody asks whether it is a true exit.
            let asked = last == Some(Predicate::TrueExit);
            assert_eq!(asked, choice.len() > 1, "{}: {choice:?}", pair.name);
            *if asked { &mut among_several } else { &mut alone } += 1;
        }
    }
    assert!(alone > 0 && among_several > 100, "{alone} alone, {among_several} among several");
}

#[test]
fn of_two_exits_the_one_that_stays_is_named_with_its_vertex_first() {
    // 1/32 below the top, 3/64 behind the side at x = 4.
    let (tip, block) = (leaning(3.953125, 0.5, 0.96875), corner_block());
    for (side, [a, b]) in [(Side::A, [&tip, &block]), (Side::B, [&block, &tip])] {
        let (_, decisions) = traced(a, b, &tolerances());
        let exits: Vec<_> = decisions.into_iter().filter(|(d, _)| d.predicate == Predicate::ShortestExit).collect();
        let about = |face: u32| {
            let features = [Feature::Vertex(side, VertexId(0)), Feature::Face(side.other(), FaceId(face))];
            Decision::about(Predicate::ShortestExit, &features)
        };
        assert_eq!(exits, [(about(1), 1), (about(3), 0)]);
    }
}
