//! The default campaign is worth its name: it finds what f32 gets wrong, much less in f64, and no defect; it reaches
//! every kind its families are for, every predicate of SPEC section 4 with each outcome and at an exact tie, and its
//! aims are where they say.
//!
//! Without a look at the shares, a campaign of exact ties alone reported as many differences in f64 as in f32.

use rayon::prelude::*;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_differential::attribution::examine_pair;
use rockproof_differential::builtin;
use rockproof_differential::finding::{Cause, FindingScope};
use rockproof_differential::subject::PairSource;
use rockproof_model::decision::Predicate;
use rockproof_model::{ContactKind, Precision, Sign};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_pairs::batch::{PairCase, PairForm};
use rockproof_pairs::directed::FACE_CHOICES;
use rockproof_pairs::families;
use std::collections::{BTreeMap, BTreeSet};

/// Batches of the slice, small and at full size: fourteen families take turns.
const BATCHES: u64 = if cfg!(debug_assertions) { 42 } else { 14 * 64 };
const FULL_BATCHES: u64 = 14 * 128;

fn default_source() -> FamilySource {
    source::of(&CampaignConfig::default()).expect("the default configuration names what exists")
}

/// How many findings there are, by engine, cause and predicate.
type Counts = BTreeMap<(String, Cause), usize>;

#[test]
fn f32_differs_and_f64_far_less() {
    // Of arithmetic, f64 has some fifty findings in so many.
    compare_precisions(BATCHES.min(14 * 16));
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn f32_differs_and_f64_far_less_at_full_size() {
    compare_precisions(FULL_BATCHES);
}

fn compare_precisions(batches: u64) {
    let config = CampaignConfig::default();
    let source = default_source();
    let panel = builtin::panel(&config.engines, config.metamorphic_every).expect("the default engines");
    let examined: Vec<(String, Cause)> = (0..batches)
        .into_par_iter()
        .flat_map_iter(|number| source.batch(number))
        .flat_map_iter(|subject| examine_pair(&subject, &panel).findings)
        .map(|finding| {
            let scope = match &finding.scope {
                FindingScope::Any => "any".to_owned(),
                FindingScope::Rounded(precision) => precision.to_string(),
                FindingScope::Engine(name) => name.to_string(),
            };
            assert_ne!(finding.cause, Cause::Defect, "{finding:?}");
            (scope, finding.cause)
        })
        .collect();
    let mut counts = Counts::new();
    for key in examined {
        *counts.entry(key).or_default() += 1;
    }
    for ((scope, cause), count) in &counts {
        println!("{scope:12} {:15} {count:6}", cause.name());
    }
    let of = |scope: &str, cause| counts.get(&(scope.to_owned(), cause)).copied().unwrap_or(0);
    let (single, double) = (of("stepper-f32", Cause::Arithmetic), of("stepper-f64", Cause::Arithmetic));
    println!("arithmetic: {single} in f32, {double} in f64, in {} pairs", batches * source.batch_len());
    assert!(double > 0 && double * 5 <= single, "arithmetic: {single} in f32, {double} in f64");
    let (single, double) = (of("f32", Cause::Representation), of("f64", Cause::Representation));
    assert!(double < single, "representation: {single} in f32, {double} in f64");
    assert!(of("any", Cause::Tolerance) > 0, "tolerances change answers");
}

/// What the oracle says of a part of the slice.
#[derive(Default)]
struct Seen {
    /// Pairs of each family with each kind.
    kinds: BTreeMap<(&'static str, ContactKind), u32>,
    /// How often each predicate came out each way.
    outcomes: BTreeMap<(Predicate, i8), u32>,
    /// How often a predicate tied.
    ties: BTreeMap<Predicate, u32>,
    /// For each predicate aimed at: aims, how many were asked, and how many of these came out as the aim says.
    aims: BTreeMap<Predicate, [u32; 3]>,
    /// Aims that missed.
    wrong: Vec<String>,
}

fn merged<K: Ord, V: Copy>(into: &mut BTreeMap<K, V>, from: BTreeMap<K, V>, add: impl Fn(V, V) -> V) {
    for (key, value) in from {
        into.entry(key).and_modify(|sum| *sum = add(*sum, value)).or_insert(value);
    }
}

impl Seen {
    fn plus(mut self, other: Seen) -> Seen {
        merged(&mut self.kinds, other.kinds, |a, b| a + b);
        merged(&mut self.outcomes, other.outcomes, |a, b| a + b);
        merged(&mut self.ties, other.ties, |a, b| a + b);
        merged(&mut self.aims, other.aims, |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        self.wrong.extend(other.wrong);
        self
    }

    fn examine(&mut self, case: &PairCase) {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let mut kinds = BTreeSet::new();
        for set in &case.sets {
            kinds.extend(pair.classify(set.of(Precision::F64)).contacts.iter().map(|contact| contact.kind()));
        }
        for kind in kinds {
            *self.kinds.entry((case.family, kind)).or_default() += 1;
        }
        let trace = pair.trace(case.sets[0].of(case.aimed_for));
        for entry in &trace {
            *self.outcomes.entry((entry.decision.predicate, entry.outcome)).or_default() += 1;
            *self.ties.entry(entry.decision.predicate).or_default() += u32::from(entry.tie);
        }
        let PairForm::Directed { decision, rung } = &case.form else { return };
        // Of two faces chosen between, a third may be the better way in, and then the choice is not between the two.
        let chosen = FACE_CHOICES.contains(&decision.predicate) || decision.predicate == Predicate::EntranceDepth;
        let (Some(margin), false) = (case.margin, chosen) else { return };
        let aims = self.aims.entry(decision.predicate).or_default();
        aims[0] += 1;
        let Some(entry) = trace.iter().find(|entry| entry.decision == *decision) else { return };
        aims[1] += 1;
        let lands = match margin {
            Sign::Zero => entry.tie,
            sign if decision.predicate == Predicate::GapSign => entry.outcome == sign.as_i8(),
            sign => entry.outcome == i8::from(sign == Sign::Positive),
        };
        aims[2] += u32::from(lands);
        if !lands {
            let asked = format!("{decision:?} at {rung:?}");
            self.wrong.push(format!("{} {}: {asked} should be {margin:?}, is {entry:?}", case.index, case.family));
        }
    }
}

#[test]
fn kinds_predicates_and_ties_are_reached() {
    reach_everything(BATCHES);
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn kinds_predicates_and_ties_are_reached_at_full_size() {
    reach_everything(FULL_BATCHES);
}

fn reach_everything(batches: u64) {
    let source = default_source();
    let look = |mut seen: Seen, number| {
        source.cases(number).iter().for_each(|case| seen.examine(case));
        seen
    };
    let seen = (0..batches).into_par_iter().fold(Seen::default, look).reduce(Seen::default, Seen::plus);
    for family in families::all() {
        for kind in family.reaches() {
            let count = seen.kinds.get(&(family.name(), *kind)).copied().unwrap_or(0);
            assert!(count > 0, "{} is for {kind}, and never has it", family.name());
        }
    }
    println!("{:20} {:>8} {:>8} {:>8} {:>8}", "predicate", "-1", "0", "1", "tie");
    let count = |predicate, outcome| seen.outcomes.get(&(predicate, outcome)).copied().unwrap_or(0);
    let ties = |predicate| seen.ties.get(&predicate).copied().unwrap_or(0);
    for predicate in Predicate::ALL {
        let [minus, no, yes] = [-1, 0, 1].map(|outcome| count(predicate, outcome));
        println!("{:20} {minus:8} {no:8} {yes:8} {:8}", predicate.name(), ties(predicate));
    }
    println!("{:20} {:>8} {:>8} {:>8}", "aim", "all", "asked", "hit");
    for (predicate, [all, asked, hit]) in &seen.aims {
        println!("{:20} {all:8} {asked:8} {hit:8}", predicate.name());
    }
    for predicate in Predicate::ALL {
        assert!(count(predicate, 0) > 0 && count(predicate, 1) > 0, "{predicate} comes out both ways");
        assert!(ties(predicate) > 0, "{predicate} ties");
    }
    assert!(count(Predicate::GapSign, -1) > 0, "gaps are negative as well");
    assert!(seen.wrong.is_empty(), "{} aims missed: {:#?}", seen.wrong.len(), &seen.wrong[..seen.wrong.len().min(8)]);
    for (predicate, [all, asked, _]) in &seen.aims {
        assert!(asked * 2 > *all, "{predicate} is aimed at {all} times, and asked {asked} times");
    }
}
