//! Implementations against each other on pairs of blocks.

use crate::input::PairInput;
use crate::reach::Reach;
use num_rational::BigRational;
use rockproof_differential::external::protocol;
use rockproof_model::{Block, Contact, Number, Precision, VertexId};
use rockproof_oracle::{Pair, PreparedBlock, plain};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::{settled_contacts, wide_contacts};
use serde_json::Value;

/// The oracle's contacts, what it met on its way being counted.
fn exact(input: &PairInput, reach: &mut Reach) -> Vec<Contact> {
    let (a, b) = (PreparedBlock::new(&input.a), PreparedBlock::new(&input.b));
    let pair = Pair::new(&a, &b);
    let answer = pair.classify(&input.tolerances);
    for contact in &answer.contacts {
        reach.count(format!("kind-{}", contact.kind()));
        reach.count(format!("gap-sign-{}", contact.gap.as_i8()));
    }
    for entry in pair.trace(&input.tolerances).iter().filter(|entry| entry.tie) {
        reach.count(format!("tie-{}", entry.decision.predicate.name()));
    }
    for (level, count) in answer.levels.by_name() {
        reach.add(format!("level-{level}"), count);
    }
    answer.contacts
}

/// The oracle's fast path against the plain one in fractions.
pub(crate) fn fast_plain(bytes: &[u8], reach: &mut Reach) {
    let Some(input) = PairInput::of(bytes) else { return reach.count("no-pair") };
    let fast = exact(&input, reach);
    let PairInput { a, b, tolerances } = &input;
    let plain = plain::classify::<BigRational>(a, b, tolerances);
    let plain: Vec<Contact> = plain.into_iter().map(|found| found.contact).collect();
    assert_eq!(fast, plain, "fast (left), plain (right): {input:?}");
    reach.count("pair");
}

/// The stepper in 512 bits against the oracle, where no comparison is left unsettled.
pub(crate) fn wide_oracle(bytes: &[u8], reach: &mut Reach) {
    let Some(input) = PairInput::of(bytes) else { return reach.count("no-pair") };
    let exact = exact(&input, reach);
    let PairInput { a, b, tolerances } = &input;
    let Ok((wide, unsettled)) = wide_contacts::<SpecRules>(a, b, tolerances) else {
        return reach.count("collapsed");
    };
    let settled = settled_contacts::<SpecRules>(a, b, tolerances).expect("a block that did not collapse before");
    assert_eq!(
        settled,
        (unsettled == 0).then(|| wide.clone()),
        "settled sooner (left), by counting (right): {input:?}"
    );
    match unsettled {
        0 => {
            assert_eq!(wide, exact, "512 bits (left), oracle (right): {input:?}");
            reach.count("settled");
        }
        _ => reach.count("unsettled"),
    }
}

/// The question that an external engine is asked holds the pair as it is.
pub(crate) fn engine_question(bytes: &[u8], reach: &mut Reach) {
    let Some(PairInput { a, b, tolerances }) = PairInput::of(bytes) else { return reach.count("no-pair") };
    let near = |block: &Block| block.rounded(Precision::F64);
    let (Some(a), Some(b), Ok(tolerances)) = (near(&a), near(&b), tolerances.rounded(Precision::F64)) else {
        return reach.count("overflow");
    };
    let line = protocol::question(7, &protocol::blocks_text(&a, &b), &tolerances);
    assert!(!line.contains('\n'), "a question of more than a line: {line}");
    let value: Value = serde_json::from_str(&line).expect("a question is JSON");
    let same = |number: &Number, value: &Value| number.as_f64().map(f64::to_bits) == value.as_f64().map(f64::to_bits);
    for (block, name) in [(&a, "a"), (&b, "b")] {
        let vertices = value[name]["vertices"].as_array().expect("vertices");
        assert_eq!(vertices.len(), block.vertices().len(), "{line}");
        for (vertex, written) in block.vertices().iter().zip(vertices) {
            let all = vertex.components().into_iter().enumerate().all(|(axis, number)| same(number, &written[axis]));
            assert!(all, "{vertex:?} is written {written}");
        }
        let faces: Vec<Vec<VertexId>> = serde_json::from_value(value[name]["faces"].clone()).expect("faces");
        assert_eq!(faces, block.topology().faces(), "{line}");
        let reflex = block.topology().edge_ids().filter(|edge| !block.edge_is_convex(*edge)).count();
        assert_eq!(value[name]["reflex"].as_array().map(Vec::len), Some(reflex), "{line}");
        reach.add("reflex", reflex as u64);
    }
    for (name, number) in tolerances.numbers() {
        assert!(same(number, &value["tolerances"][name]), "{name}: {line}");
    }
    reach.count("question");
}
