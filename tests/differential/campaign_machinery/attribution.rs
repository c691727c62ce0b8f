//! Pins which cause and change each difference gets, link by link of SPEC section 6's chain, with scripted answers.

use super::scripted::{Script, ScriptedAnswer, contact, cube, decision, scripted, subject};
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source;
use rockproof_differential::attribution::{PairExamination, WantedFindings, examine_pair, findings_wanted};
use rockproof_differential::builtin;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::engine::{EngineFailure, WideAnswer};
use rockproof_differential::finding::{Cause, Finding, FindingScope};
use rockproof_differential::subject::PairSource;
use rockproof_model::{Contact, ContactKind, EdgeId, Entrance, Precision, Sign};
use std::collections::BTreeSet;

fn run(script: &Script) -> PairExamination {
    // 0.1 is not an f32, so the oracle can tell the exact pair from the rounded one.
    examine_pair(&subject(5, cube(0.1, 1.0), cube(1.0, 1.0)), &scripted(script))
}

fn found(script: &Script) -> Vec<(String, Cause, AnswerChange)> {
    run(script).findings.iter().map(|f| (f.scope.to_string(), f.cause, f.difference.change)).collect()
}

fn said(contacts: &[Contact]) -> ScriptedAnswer {
    ScriptedAnswer { contacts: contacts.to_vec(), trace: Vec::new() }
}

const CORNER: u32 = 4;

fn base() -> Contact {
    contact(ContactKind::VertexFace, 0, 1)
}

/// One answer for each change from `base`.
fn changed() -> Vec<(AnswerChange, Vec<Contact>)> {
    let base = base();
    let turned = Entrance::EdgeEdge(EdgeId(2), EdgeId(3));
    vec![
        (AnswerChange::Missing, vec![]),
        (AnswerChange::Extra, vec![base, contact(ContactKind::EdgeEdge, 7, 7)]),
        (AnswerChange::Kind, vec![contact(ContactKind::VertexVertex, 0, CORNER)]),
        (AnswerChange::Entrance, vec![Contact { entrance: turned, ..base }]),
        (AnswerChange::GapSign, vec![Contact { gap: Sign::Negative, ..base }]),
    ]
}

#[test]
fn agreement_is_no_finding() {
    let examined = run(&Script::unanimous(&[base()]));
    assert_eq!(examined.findings, []);
    assert_eq!(examined.contacts, 1);
    assert!(examined.levels.0[0] >= 2, "the exact and the rounded pair were both asked");
}

#[test]
fn every_change_at_every_link_has_its_cause() {
    let unanimous = Script::unanimous(&[base()]);
    for (change, answer) in changed() {
        let other = said(&answer);
        let old = said(&[base()]);
        let mut script = Script::unanimous(&answer);
        script.ideal = old.clone();
        assert_eq!(found(&script), [("any".to_owned(), Cause::Tolerance, change)]);
        script.exact = old.clone();
        assert_eq!(found(&script), [("f32".to_owned(), Cause::Representation, change)]);
        script.rounded = old;
        assert_eq!(found(&script), [("scripted".to_owned(), Cause::Arithmetic, change)]);

        let wide = |settled, contacts: &[Contact]| Some(WideAnswer { contacts: contacts.to_vec(), settled });
        let script = Script { engine: Ok(other), ..unanimous.clone() };
        let cause = |wide| found(&Script { wide, ..script.clone() })[0].1;
        assert_eq!(cause(wide(true, &answer)), Cause::Defect, "{change}: it remains although nothing was close");
        assert_eq!(cause(wide(false, &answer)), Cause::Arithmetic, "{change}: a tie may explain it");
        assert_eq!(cause(wide(true, &[base()])), Cause::Arithmetic, "{change}: more bits mend it");
    }
}

#[test]
fn findings_that_are_wanted_are_found_as_among_all() {
    let config = CampaignConfig::default();
    let (source, panel) = (source::of(&config).expect("pairs"), builtin::panel(&config.engines, 2).expect("engines"));
    let predicate = |f: &Finding| f.predicate().map_or("", |predicate| predicate.name());
    let of = |f: &Finding| (f.cause.name(), f.difference.change.name(), f.difference.kinds(), predicate(f));
    let (mut sought, mut left_out) = (BTreeSet::new(), 0);
    for subject in (0..24).flat_map(|number| source.batch(number)) {
        let all = examine_pair(&subject, &panel).findings;
        for sort in all.iter().map(of).collect::<BTreeSet<_>>() {
            let (cause, change, kind, predicate) = &sort;
            let such = |findings: &[Finding]| findings.iter().filter(|f| of(f) == sort).cloned().collect::<Vec<_>>();
            for predicate in [None, Some(*predicate)] {
                let wanted = WantedFindings { cause, change, kind, predicate, check: None };
                let found = findings_wanted(&subject, &panel, wanted);
                left_out += all.len() - found.len();
                assert_eq!(such(&found), such(&all), "pair {}, {sort:?} by {predicate:?}", subject.index);
            }
            sought.insert(sort);
        }
    }
    assert!(sought.len() > 20 && left_out > 100, "{} sorts, {left_out} left out", sought.len());
}

#[test]
fn an_error_that_undoes_a_tolerance_still_counts() {
    let mut script = Script::unanimous(&[base()]);
    script.exact = said(&[]);
    script.rounded = said(&[]);
    assert_eq!(
        found(&script),
        [
            ("any".to_owned(), Cause::Tolerance, AnswerChange::Missing),
            ("scripted".to_owned(), Cause::Arithmetic, AnswerChange::Extra)
        ]
    );
}

#[test]
fn no_answer_is_a_verdict() {
    for (failure, change) in [
        (EngineFailure::Unsupported("concave".into()), AnswerChange::Unsupported),
        (EngineFailure::Failed("panic".into()), AnswerChange::Failure),
        (EngineFailure::Crashed("signal 11".into()), AnswerChange::Crash),
        (EngineFailure::TimedOut("10 s".into()), AnswerChange::Timeout),
        (EngineFailure::Malformed("no JSON".into()), AnswerChange::Malformed),
        (EngineFailure::Unstable("one, then two".into()), AnswerChange::Unstable),
    ] {
        let script = Script { engine: Err(failure.clone()), ..Script::unanimous(&[base()]) };
        let examined = run(&script);
        assert_eq!(examined.findings.len(), 1);
        assert_eq!(examined.findings[0].difference.change, change);
        assert_eq!(examined.findings[0].note, Some(failure.to_string()));
    }
    let script = Script { engine: Err(EngineFailure::Collapsed("edge 3".into())), ..Script::unanimous(&[base()]) };
    assert_eq!(
        found(&script),
        [("scripted".to_owned(), Cause::Arithmetic, AnswerChange::Collapsed)],
        "the rounded block still has its features, so the engine lost them"
    );
}

#[test]
fn features_that_rounding_destroyed_are_counted_once_for_the_precision() {
    let tiny = subject(5, cube(1.0, 1e-9), cube(3.0, 1.0));
    let findings = examine_pair(&tiny, &scripted(&Script::unanimous(&[base()]))).findings;
    assert_eq!(findings.len(), 1);
    assert_eq!(findings[0].scope, FindingScope::Rounded(Precision::F32));
    assert_eq!((findings[0].cause, findings[0].difference.change), (Cause::Representation, AnswerChange::Collapsed));
    assert_eq!(findings[0].note.as_deref(), Some("edge 0 has no length in block A"));
    let huge = subject(5, cube(1.0, 1e300), cube(3.0, 1.0));
    let findings = examine_pair(&huge, &scripted(&Script::unanimous(&[base()]))).findings;
    assert_eq!((findings[0].cause, findings[0].difference.change), (Cause::Representation, AnswerChange::Failure));
}

#[test]
fn the_decision_nearest_to_a_tie_decides() {
    let corner = contact(ContactKind::VertexVertex, 2, 2);
    let mut script = Script::unanimous(&[corner]);
    script.rounded.trace = vec![(decision(6), 1), (decision(3), 1), (decision(2), 1), (decision(1), 1)];
    let engine = |trace: &[(u32, i8)]| {
        let trace = trace.iter().map(|&(n, outcome)| (decision(n), outcome)).collect();
        Ok(ScriptedAnswer { contacts: vec![], trace })
    };
    let deciding = |script: &Script| run(script).findings[0].deciding;
    // Decisions 6 and 2 part; both touch what the difference is about or not: 2 does.
    script.engine = engine(&[(6, 0), (3, 1), (2, 0)]);
    let reason = deciding(&script).expect("a decision");
    assert_eq!((reason.decision, reason.outcomes), (decision(2), [1, 0]));
    assert_eq!(reason.margin, Some(0.002));
    assert_eq!(reason.margin_ulps, Some(0.002 / 2f64.powi(-24)));
    // Where none touches it, any that parted will do.
    script.engine = engine(&[(6, 0), (3, 1), (2, 1)]);
    assert_eq!(deciding(&script).expect("a decision").decision, decision(6));
    // Of several, the one with the smallest margin; a tie has margin 0.
    script.engine = engine(&[(6, 0), (3, 0), (2, 1)]);
    assert_eq!(deciding(&script).expect("a decision").decision, decision(3));
    // A decision that only one side took decides nothing.
    script.engine = engine(&[(5, 0), (3, 1)]);
    assert_eq!(deciding(&script), None);
}
