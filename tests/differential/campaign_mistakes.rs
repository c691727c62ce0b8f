//! Campaigns find every deliberate mistake: a stepper that makes one, examined on a campaign's pairs, has a finding with the cause
//! `defect`; the stepper as it is has none.
//!
//! In release all mistakes are looked for, on a fraction of the default campaign's pairs, and the few that show at a rare tie only
//! on pairs that are not perturbed; a debug build takes the first batches and asks for half of them.

use crate::mistaken_engine::OneEngine;
use crate::mistakes::Mistaken;
use rayon::prelude::*;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::source::{self, FamilySource};
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin::{self, BuiltinOracle};
use rockproof_differential::engine::Engine;
use rockproof_differential::finding::{Cause, Finding};
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_model::{Block, Contact, Precision};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::{Classifier, Stepper};

/// Pairs looked at: a fraction of the default campaign's, in which at least half of the mistakes show; and so many that nearly all do.
const PAIRS: u64 = if cfg!(debug_assertions) { 512 } else { 2_048 };
const FULL_PAIRS: u64 = 65_536;

/// Pairs looked at for what the default campaign's did not show: bases that are not perturbed, which hold more ties.
const UNPERTURBED: u64 = 8_192;

/// How many mistakes may be left to them.
const MAX_LEFT: usize = 8;

/// Mistakes whose ties no campaign has been seen to reach in a pair where they change a contact: hand-worked pairs hold them
/// (`crates/stepper/tests/contacts/`).
const BY_HAND: [&str; 2] =
    ["revised no-overlap check: a tie of the length g fails", "true exit: a tie of the length fails"];

/// Batches examined together; mistakes already found are not looked for in the next ones.
const CHUNK: u64 = 16;

/// A mistake, and where it was found.
struct Sought {
    name: &'static str,
    engine: Mistaken,
    found: Option<(u64, Finding)>,
}

fn sought() -> Vec<Sought> {
    crate::mistakes::all().into_iter().map(|(name, engine)| Sought { name, engine, found: None }).collect()
}

fn default_source() -> FamilySource {
    source::of(&CampaignConfig::default()).expect("the default configuration names what exists")
}

/// The pairs of the option `--exact-ties`.
fn ties_source() -> FamilySource {
    let config = CampaignConfig { exact_ties: true, ..CampaignConfig::default() };
    source::of(&config).expect("the default configuration names what exists")
}

/// The first defect that a campaign with this engine alone reports for the pair.
fn defect(subject: &Subject, name: &'static str, engine: Mistaken) -> Option<Finding> {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(OneEngine(name, engine))];
    let panel = EnginePanel { oracle: Box::new(BuiltinOracle), engines, metamorphic_every: 0 };
    examine_pair(subject, &panel).findings.into_iter().find(|f| f.cause == Cause::Defect)
}

/// Whether the mistake changes an answer of the stepper in f64 on this pair. Only then is it worth a full examination:
/// what both answer is an error of rounding, or none.
fn shows(subject: &Subject, rounded: &[Block; 2], engine: Mistaken, spec: &Spectrum) -> bool {
    let [a, b] = rounded;
    subject.sets.iter().zip(&spec.0).any(|(set, right)| engine.f64(a, b, &set.f64).ok() != *right)
}

/// The answers of the stepper as it is, one for each tolerance set.
struct Spectrum(Vec<Option<Vec<Contact>>>);

impl Spectrum {
    fn of(subject: &Subject, [a, b]: &[Block; 2]) -> Spectrum {
        let spec = Stepper::<SpecRules>::new();
        Spectrum(subject.sets.iter().map(|set| spec.f64(a, b, &set.f64).ok()).collect())
    }
}

/// Looks at one batch: the defects of the mistakes still sought, by their place in the list, and those of the stepper.
fn finding_of(
    source: &FamilySource,
    batch: u64,
    list: &[Sought],
    right: &EnginePanel,
) -> (Vec<(usize, u64, Finding)>, Vec<Finding>) {
    let mut found: Vec<(usize, u64, Finding)> = Vec::new();
    let mut wrong = Vec::new();
    for subject in source.batch(batch) {
        wrong.extend(examine_pair(&subject, right).findings.into_iter().filter(|f| f.cause == Cause::Defect));
        let (Some(a), Some(b)) = (subject.a.rounded(Precision::F64), subject.b.rounded(Precision::F64)) else {
            continue;
        };
        let rounded = [a, b];
        let spec = Spectrum::of(&subject, &rounded);
        for (number, mistake) in list.iter().enumerate() {
            if mistake.found.is_none()
                && found.iter().all(|(n, _, _)| *n != number)
                && shows(&subject, &rounded, mistake.engine, &spec)
                && let Some(finding) = defect(&subject, mistake.name, mistake.engine)
            {
                found.push((number, subject.index, finding));
            }
        }
    }
    (found, wrong)
}

/// Looks for the mistakes of a list in the first pairs of a source until no more than so many are left, and for defects of the stepper itself in all of
/// these pairs, or those up to the last mistake.
fn search(list: &mut [Sought], source: &FamilySource, pairs: u64, may_be_left: usize) {
    let names = CampaignConfig::default().engines;
    let right = builtin::panel(&names, 0).expect("the engines of the default configuration");
    let batches = pairs / source.batch_len();
    for chunk in 0..batches.div_ceil(CHUNK) {
        if list.iter().all(|m| m.found.is_some()) {
            break;
        }
        let numbers: Vec<u64> = (chunk * CHUNK..((chunk + 1) * CHUNK).min(batches)).collect();
        let sought: &[Sought] = if missed(list).len() > may_be_left { list } else { &[] };
        let results: Vec<_> = numbers.par_iter().map(|&batch| finding_of(source, batch, sought, &right)).collect();
        for (found, wrong) in results {
            assert!(wrong.is_empty(), "the stepper itself has a defect: {:?}", wrong[0]);
            for (number, index, finding) in found {
                list[number].found.get_or_insert((index, finding));
            }
        }
    }
}

fn missed(list: &[Sought]) -> Vec<&'static str> {
    list.iter().filter(|m| m.found.is_none()).map(|m| m.name).collect()
}

#[test]
fn a_short_campaign_finds_most_mistakes() {
    // One fewer than half of them may be left.
    let list = sought_in(PAIRS, (sought().len() - 1) / 2);
    let missed = missed(&list);
    assert!(missed.len() * 2 < list.len(), "in {PAIRS} pairs too few are found; missed are {missed:#?}");
}

/// Looks for all mistakes in the first pairs of the default campaign, and prints where they were found.
fn sought_in(pairs: u64, may_be_left: usize) -> Vec<Sought> {
    assert!(pairs <= CampaignConfig::default().pairs);
    let mut list = sought();
    search(&mut list, &default_source(), pairs, may_be_left);
    list.sort_by_key(|m| m.found.as_ref().map_or(u64::MAX, |(index, _)| *index));
    for mistake in &list {
        if let Some((index, f)) = &mistake.found {
            println!("{index:6}  {:60} {} {} {}", mistake.name, f.family, f.form, f.set);
        }
    }
    let found = list.len() - missed(&list).len();
    println!("{found} of {} mistakes found in {pairs} pairs of the default campaign", list.len());
    list
}

#[test]
#[ignore = "a minute of two cores; .ci/run runs it"]
fn campaigns_find_every_mistake_at_full_size() {
    let mut list = sought_in(FULL_PAIRS, 0);
    let ties = missed(&list);
    // What shows at one rare tie only is looked for where ties are many.
    assert!(ties.len() <= MAX_LEFT, "in {FULL_PAIRS} pairs too few are found; missed are {ties:#?}");
    search(&mut list, &ties_source(), UNPERTURBED, 0);
    for mistake in list.iter().filter(|m| ties.contains(&m.name)) {
        if let Some((index, f)) = &mistake.found {
            println!("{index:6}  {:60} {} {} {}, unshaken", mistake.name, f.family, f.form, f.set);
        }
    }
    let mut missed = missed(&list);
    missed.retain(|name| !BY_HAND.contains(name));
    assert!(missed.is_empty(), "nor in {UNPERTURBED} unshaken pairs: {missed:#?}");
}

/// Mistakes that show at exact ties alone.
const AT_TIES: [&str; 18] = [
    "cone: strict",
    "v-f: gap < s",
    "e-e: gap < s",
    "v-v: distance < s",
    "v-e: distance < s",
    "vertex territory: distance < radius",
    "edge territory: distance < radius",
    "nearly parallel: strict",
    "Eq. (1): strict",
    "foot region: strict",
    "vertex region: strict",
    "edge region: strict",
    "v-f: gap > -g",
    "e-e: gap > -g",
    "v-v, v-e: gap > -g",
    "a zero gap counts as apart",
    "exits: a zero gap counts as overlap",
    "sigma: a tie gives minus",
];

/// What an engine that answers some ten questions a second can be asked in minutes.
#[test]
#[ignore = "seconds of two cores; .ci/run runs it"]
fn ties_of_a_small_campaign_find_every_mistake_there_at_full_size() {
    const FEW: u64 = 4_096;
    let at_ties = |source: &FamilySource| {
        let mut list = sought();
        list.retain(|mistake| AT_TIES.contains(&mistake.name));
        assert_eq!(list.len(), AT_TIES.len(), "a name is none");
        search(&mut list, source, FEW, 0);
        missed(&list).len()
    };
    let [missed_there, missed_by_default] = [ties_source(), default_source()].map(|source| at_ties(&source));
    // As docs/engines.md has it.
    assert_eq!([missed_there, missed_by_default], [0, 12], "missed in {FEW} pairs of each");
}
