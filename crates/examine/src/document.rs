//! The examination as one JSON document (docs/formats.md).

use crate::assess::{Assessment, Examination};
use crate::bare_edges::BareEdge;
use crate::checked::{tolerances_json, violation_json, warning_json};
use crate::local_origin::LocalOrigin;
use crate::pairs::{ExaminedPair, PRECISIONS};
use crate::recommend::Recommendation;
use crate::results::PairFacts;
use crate::steps::Steps;
use crate::stored_energy::StoredEnergy;
use crate::verdict::{Verdict, best_of};
use rockproof_model::{Number, Precision};
use serde_json::{Value, json};

/// The document; `next` in it is null where the verdict has none.
pub fn document(found: &Examination, verdict: &Verdict) -> Value {
    let pairs = PairFacts::all(found);
    let lines: Vec<Value> = verdict
        .lines
        .iter()
        .map(|line| json!({ "about": line.about, "severity": line.severity, "text": line.text }))
        .collect();
    let (recommended, why) = match &found.other {
        Recommendation::Skipped(why) => (Value::Null, why.clone()),
        Recommendation::Given { candidates, refused } => {
            (Value::Null, format!("the set given is the best of {}", best_of(*candidates, *refused)))
        }
        Recommendation::Other(other) => (
            assessment(&other.assessed, found.model.precision),
            format!("{}, the best of {}", other.origin, other.candidates),
        ),
    };
    let bad = pairs.iter().filter(|pair| {
        let is_quiet = pair.overlap.is_none() && pair.passage_m.is_none() && pair.unseen_m.is_none();
        !is_quiet || PRECISIONS.iter().any(|precision| pair.in_precision(*precision).total() > 0)
    });
    json!({
        "answer": verdict.answer,
        "safe": verdict.is_safe,
        "sentence": verdict.sentence,
        "lines": lines,
        "next": verdict.next,
        "model": found.model.json(),
        "local_origin": found.local_origin.as_ref().map(local_origin),
        "given": assessment(&found.given, found.model.precision),
        "recommended": recommended,
        "search": why,
        "pairs": bad.map(pair).collect::<Vec<_>>(),
    })
}

fn local_origin(of: &LocalOrigin) -> Value {
    json!({
        "origin_m": of.origin.components().map(Number::approximate),
        "pairs_broken": of.broken,
        "rules_violated": of.violations,
    })
}

fn assessment(of: &Assessment, precision: Precision) -> Value {
    let engines = PRECISIONS.map(|precision| {
        let [differ, broken] = of.differing(precision);
        let sum = |count: fn(&ExaminedPair, Precision) -> u64| -> u64 {
            of.pairs.iter().map(|pair| count(pair, precision)).sum()
        };
        json!({
            "pairs_differing": differ,
            "pairs_broken": broken,
            "contacts_by_representation": sum(|pair, precision| pair.in_precision(precision).representation),
            "contacts_by_arithmetic": sum(|pair, precision| pair.in_precision(precision).arithmetic),
            "contacts_by_defect": sum(|pair, precision| pair.in_precision(precision).defects),
        })
    });
    let [f32, f64] = engines;
    json!({
        "safe_but_for_units": of.is_safe(precision),
        "tolerances": tolerances_json(&of.set),
        "rules_violated": of.violations.iter().map(violation_json).collect::<Vec<_>>(),
        "warnings": of.warnings.iter().map(warning_json).collect::<Vec<_>>(),
        "overlaps": of.overlaps.json(),
        "unexplained_energy": of.stored.iter().map(StoredEnergy::json).collect::<Vec<_>>(),
        "reflex_edges": of.bare_edges.iter().map(BareEdge::json).collect::<Vec<_>>(),
        "pairs_examined": of.pairs.len(),
        "f32": f32,
        "f64": f64,
        "contacts_changed_by_tolerances": of.pairs.iter().map(|pair| pair.tolerance).sum::<u64>(),
        "steps": steps(&of.steps),
    })
}

fn steps(steps: &Steps) -> Value {
    match steps {
        Steps::Skipped(why) => json!({ "made": 0, "skipped": why }),
        Steps::Made(made) => {
            let pairs = |all: &std::collections::BTreeMap<[usize; 2], f64>| -> Vec<Value> {
                all.iter().map(|(blocks, depth)| json!({ "blocks": blocks, "depth_m": depth })).collect()
            };
            json!({
                "made": made.made,
                "asked": made.asked,
                "held": made.held.sentence(),
                "unconverged": made.unconverged,
                "friction_not_settled": made.unsettled,
                "stopped": made.stopped,
                "passages": pairs(&made.passages),
                "unseen": pairs(&made.unseen),
                "explained": pairs(&made.explained),
                "undecided_passages": made.totals.undecided,
                "steps_with_false_entrances": { "unmet": made.totals.false_entrances.unmet.steps, "covered": made.totals.false_entrances.covered.steps },
            })
        }
    }
}

fn pair(pair: &PairFacts<'_>) -> Value {
    let engines = PRECISIONS.map(|precision| {
        let found = pair.in_precision(precision);
        json!({ "differ": found.total(), "broken": found.broken })
    });
    let [f32, f64] = engines;
    json!({
        "blocks": pair.blocks,
        "overlap_m": pair.depth_m(),
        "overlap": pair.overlap.map(|(_, severity)| severity.name()),
        "f32": f32,
        "f64": f64,
        "passage_m": pair.passage_m,
        "unseen_after_step_m": pair.unseen_m,
    })
}
