//! Pins that each metamorphic check catches an engine that is right on the pair itself and wrong on the changed one, and
//! that an engine which is always right violates none.

use super::scripted::{cube, subject};
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin::BuiltinOracle;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::{Answer, Engine, EngineFailure, Oracle, Prepared, Trace, WideAnswer};
use rockproof_differential::external::protocol::answer;
use rockproof_differential::finding::Cause;
use rockproof_model::{Block, Contact, ContactKind, Precision, ToleranceSet, VertexId};
use serde_json::json;

/// Answers as the oracle does, but loses every contact of a pair changed in the given way.
struct Upset(Option<AnswerChange>);

struct UpsetPair {
    a: Block,
    b: Block,
    upset: bool,
    invents: bool,
}

impl Engine for Upset {
    fn name(&self) -> &str {
        "upset"
    }
    fn precision(&self) -> Precision {
        Precision::F32
    }
    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        let corner = |block: &Block, v: usize| block.vertices()[v].x.approximate();
        let edge = (corner(a, 1) - corner(a, 0)).abs();
        let far = corner(b, 0).abs() > 10.0 || corner(a, 0).abs() > 10.0;
        // The pair itself: A a unit cube from 0, B one from 1, face 0 the loop 0 3 2 1.
        let upset = match self.0 {
            Some(AnswerChange::Swap) => {
                edge == 1.0 && !far && corner(a, 0) > corner(b, 0) && a.topology().faces()[0][0] == VertexId(0)
            }
            Some(AnswerChange::Renumber) => a.topology().faces()[0][0] != VertexId(0),
            Some(AnswerChange::Translate) => edge == 1.0 && !far && corner(a, 0) >= 2.0,
            Some(AnswerChange::Scale) => edge < 1.0,
            _ => false,
        };
        let invents = self.0 == Some(AnswerChange::FarBlock) && far;
        Ok(Box::new(UpsetPair { a: a.clone(), b: b.clone(), upset, invents }))
    }
}

impl Prepared for UpsetPair {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        if self.invents {
            return Ok(vec![super::scripted::contact(ContactKind::VertexVertex, 0, 0)]);
        }
        let contacts = BuiltinOracle.prepare(&self.a, &self.b).pair().classify(tolerances).contacts;
        Ok(if self.upset { Vec::new() } else { contacts })
    }
    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }
    fn classify_wide(&self, tolerances: &ToleranceSet) -> Option<WideAnswer> {
        Some(WideAnswer { contacts: self.classify(tolerances).ok()?, settled: true })
    }
}

fn violations(upset: Option<AnswerChange>) -> Vec<(Cause, AnswerChange)> {
    let panel =
        EnginePanel { oracle: Box::new(BuiltinOracle), engines: vec![Box::new(Upset(upset))], metamorphic_every: 1 };
    let examined = examine_pair(&subject(0, cube(0.0, 1.0), cube(1.0, 1.0)), &panel);
    assert_eq!(examined.metamorphic_checks, 5);
    let engine = examined.findings.iter().filter(|f| f.scope.to_string() == "upset");
    let mut found: Vec<_> = engine.map(|f| (f.cause, f.difference.change)).collect();
    found.dedup();
    found
}

#[test]
fn an_engine_that_is_always_right_violates_nothing() {
    assert_eq!(violations(None), []);
}

#[test]
fn each_check_catches_its_violation() {
    for change in [AnswerChange::Swap, AnswerChange::Renumber, AnswerChange::Translate, AnswerChange::Scale] {
        assert_eq!(violations(Some(change)), [(Cause::Defect, change)], "{change}");
    }
    assert_eq!(violations(Some(AnswerChange::FarBlock)), [(Cause::Arithmetic, AnswerChange::FarBlock)]);
}

/// Answers as the oracle does, but names no entrance where A is beyond 1.5 m, or elsewhere.
struct Terse {
    is_terse_beyond: bool,
}

struct TersePair<'p> {
    blocks: [&'p Block; 2],
    is_terse: bool,
}

impl Engine for Terse {
    fn name(&self) -> &str {
        "terse"
    }
    fn precision(&self) -> Precision {
        Precision::F32
    }
    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        let is_beyond = a.vertices()[0].x.approximate() > 1.5;
        Ok(Box::new(TersePair { blocks: [a, b], is_terse: is_beyond == self.is_terse_beyond }))
    }
}

impl Prepared for TersePair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        let [a, b] = self.blocks;
        let contacts = BuiltinOracle.prepare(a, b).pair().classify(tolerances).contacts;
        if !self.is_terse {
            return Ok(contacts);
        }
        let kinds = contacts.iter().map(|contact| {
            let [a, b] = contact.key.numbers();
            json!({ "kind": contact.kind().name(), "feature_a": a, "feature_b": b })
        });
        let line = json!({ "id": 0, "contacts": kinds.collect::<Vec<_>>() }).to_string();
        match answer(line.as_bytes(), 0, [a.topology(), b.topology()])? {
            Answer::Contacts(contacts) => Ok(contacts),
            Answer::State(said) => panic!("{said}"),
        }
    }
    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }
    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        None
    }
}

#[test]
fn what_is_left_unsaid_on_one_side_of_a_check_is_not_compared() {
    for is_terse_beyond in [true, false] {
        let engines: Vec<Box<dyn Engine>> = vec![Box::new(Terse { is_terse_beyond })];
        let panel = EnginePanel { oracle: Box::new(BuiltinOracle), engines, metamorphic_every: 1 };
        let examined = examine_pair(&subject(0, cube(0.0, 1.0), cube(1.0, 1.0)), &panel);
        assert_eq!(examined.metamorphic_checks, 5);
        let of_engine = examined.findings.iter().filter(|finding| finding.scope.to_string() == "terse");
        assert_eq!(of_engine.count(), 0, "{is_terse_beyond}");
    }
}
