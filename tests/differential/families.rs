//! Pins what the pair generators promise: canonical blocks, the same pairs for the same seed, and that aims hit. The
//! margins are evaluated here a second time, in plain fractions straight from SPEC section 4.

mod margin;

use margin::{margin, points};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_model::decision::Predicate;
use rockproof_model::{Block, BlockOptions, ContactKind, Criteria, Number, Precision, Sign};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_pairs::batch::{BATCH, PairCase, PairConfig, PairForm, SetSource, batch};
use rockproof_pairs::directed::{FACE_CHOICES, MOVED, Rung};
use rockproof_pairs::families::{self, Family};
use rockproof_pairs::ladder::TOLERANCES;
use std::collections::BTreeMap;
use std::sync::Arc;

fn only(family: Arc<dyn Family>) -> PairConfig {
    PairConfig { families: vec![family], ..PairConfig::default() }
}

#[test]
fn every_family_yields_canonical_blocks() {
    for family in families::all() {
        let planarity = Number::from_f64(if family.name() == "real" { 1e-3 } else { 0.0 }).unwrap();
        let options = BlockOptions { planarity };
        let mut rng = ChaCha8Rng::from_seed([7; 32]);
        for n in 0..300 {
            let (a, b) = family.generate(&mut rng);
            for block in [&a, &b] {
                let again = Block::new(block.vertices().to_vec(), block.topology().faces().to_vec(), &options);
                assert_eq!(again.as_ref(), Ok(block), "{} {n}", family.name());
            }
        }
    }
}

#[test]
fn a_pair_depends_on_seed_and_index_alone() {
    let config = unperturbed();
    let forwards: Vec<Vec<PairCase>> = (0..60).map(|k| batch(3, k, &config)).collect();
    let mut backwards: Vec<Vec<PairCase>> = (0..60).rev().map(|k| batch(3, k, &config)).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    assert_ne!(forwards[5], batch(4, 5, &config));
    for (k, cases) in forwards.iter().enumerate() {
        let indices: Vec<u64> = cases.iter().map(|c| c.index).collect();
        assert_eq!(indices, (k as u64 * BATCH..(k as u64 + 1) * BATCH).collect::<Vec<_>>());
        assert_eq!(cases[0].form, PairForm::Base);
        assert!(cases.iter().all(|c| !c.sets.is_empty()));
    }
}

/// The same pairs on every machine and with every compiler: one number for the first batches, without presets. A change
/// to a generator changes it, and every seed's meaning with it.
#[test]
fn the_first_pairs_are_pinned() {
    let sets = [Criteria::Revised, Criteria::Classic].map(SetSource::dyadic).to_vec();
    let config = PairConfig { sets, ..unperturbed() };
    // FNV-1a, 64 bits.
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    let mut eat = |text: String| text.bytes().for_each(|b| hash = (hash ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    for case in (0..42).flat_map(|k| batch(1, k, &config)) {
        eat(format!("{} {} {:?}", case.index, case.family, case.form));
        case.a.coordinates().chain(case.b.coordinates()).for_each(|c| eat(c.to_rational().to_string()));
        let set = case.sets[0].of(case.aimed_for);
        set.numbers().iter().for_each(|(name, value)| eat(format!("{name} {}", value.to_rational())));
    }
    assert_eq!(hash, PINNED, "{hash:#x}");
}

const PINNED: u64 = 0x7a54_70c6_f8bf_82ff;

/// What aims at one predicate, or ladders across one tolerance, came to.
#[derive(Default, Debug)]
struct Hits {
    ties: u32,
    below: u32,
    above: u32,
    unknown: u32,
}

impl Hits {
    fn add(&mut self, sign: Option<Sign>) {
        match sign {
            Some(Sign::Zero) => self.ties += 1,
            Some(Sign::Negative) => self.below += 1,
            Some(Sign::Positive) => self.above += 1,
            None => self.unknown += 1,
        }
    }
}

/// Runs the default configuration and evaluates each margin anew.
#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn aims_hit_and_ladders_turn_where_they_say() {
    let config = unperturbed();
    let mut by_predicate: BTreeMap<Predicate, Hits> = BTreeMap::new();
    let mut by_tolerance: BTreeMap<&str, Hits> = BTreeMap::new();
    let mut wrong = Vec::new();
    for k in 0..1800 {
        for case in batch(11, k, &config) {
            let Some(decision) = case.form.decision() else { continue };
            if let PairForm::Ladder { tolerance, .. } = case.form {
                by_tolerance.entry(tolerance).or_default().add(case.margin);
            }
            by_predicate.entry(decision.predicate).or_default().add(case.margin);
            if let (Some(said), Some(found)) = (case.margin, margin(&case))
                && said != found
            {
                wrong.push(format!("{} {} {:?}: said {said:?}, is {found:?}", case.index, case.family, case.form));
            }
        }
    }
    println!("{:24} {:>7} {:>7} {:>7} {:>7}", "", "ties", "below", "above", "unknown");
    let rows = by_predicate.iter().map(|(p, h)| (p.name(), h)).chain(by_tolerance.iter().map(|(t, h)| (*t, h)));
    for (name, h) in rows {
        println!("{name:24} {:7} {:7} {:7} {:7}", h.ties, h.below, h.above, h.unknown);
    }
    assert!(wrong.is_empty(), "{} wrong, first {:#?}", wrong.len(), &wrong[..wrong.len().min(12)]);
    let enough = |h: Option<&Hits>, ties: u32| h.is_some_and(|h| h.ties >= ties && h.below >= 5 && h.above >= 5);
    for predicate in MOVED.iter().chain(&FACE_CHOICES) {
        assert!(enough(by_predicate.get(predicate), 10), "{predicate}");
    }
    // Most sines are irrational: ties are rarer there, near-ties are not.
    for predicate in [Predicate::ConePasses, Predicate::NearlyParallel, Predicate::WedgesPass, Predicate::OneExit] {
        assert!(enough(by_predicate.get(&predicate), 2), "{predicate}");
    }
    for tolerance in TOLERANCES {
        assert!(enough(by_tolerance.get(tolerance), 2), "{tolerance}");
    }
}

/// Ties must survive rounding to be seen by a float engine: exact rungs whose blocks and tolerances f32 holds.
#[test]
fn ties_that_f32_holds_are_frequent() {
    let config = unperturbed();
    let mut held: BTreeMap<Predicate, u32> = BTreeMap::new();
    for k in 0..1800 {
        for case in batch(5, k, &config) {
            let tie = case.margin == Some(Sign::Zero);
            let exact = |n: &Number| n.is_exact_in(Precision::F32);
            let lengths = case.sets[0].f32.numbers();
            if tie
                && case.a.coordinates().chain(case.b.coordinates()).all(exact)
                && lengths.iter().all(|(_, n)| exact(n))
            {
                *held.entry(case.form.decision().unwrap().predicate).or_default() += 1;
            }
        }
    }
    for (predicate, count) in &held {
        println!("{:20} {count:5}", predicate.name());
    }
    for predicate in MOVED.iter().chain(&FACE_CHOICES) {
        assert!(held.contains_key(predicate), "{predicate}: {held:?}");
    }
}

/// What the oracle says of the base pairs and of the pairs made from them: every kind a family is for, and whether the
/// decisions aimed at are asked at all, and tie where the aim is exact.
#[test]
fn the_oracle_sees_the_kinds_and_the_aims() {
    let mut aims: BTreeMap<Predicate, [u32; 4]> = BTreeMap::new();
    println!("{:22} {}", "pairs with", ContactKind::ALL.map(|k| format!("{:>5}", k.name())).join(" "));
    for family in families::all() {
        let (name, reaches) = (family.name(), family.reaches());
        let mut kinds: BTreeMap<ContactKind, u32> = BTreeMap::new();
        let config = only(family);
        for case in (0..80).flat_map(|k| batch(21, k, &config)) {
            let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
            let pair = Pair::new(&a, &b);
            let set = case.sets[0].of(case.aimed_for);
            let contacts = pair.classify(set).contacts;
            let found: std::collections::BTreeSet<ContactKind> = contacts.iter().map(|c| c.kind()).collect();
            for kind in found {
                *kinds.entry(kind).or_default() += 1;
            }
            let Some(decision) = case.form.decision() else { continue };
            let entry = pair.trace(set).into_iter().find(|e| e.decision == *decision);
            let tie = case.margin == Some(Sign::Zero);
            let counts = aims.entry(decision.predicate).or_default();
            counts[0] += 1;
            counts[1] += u32::from(entry.is_some());
            counts[2] += u32::from(tie && entry.is_some());
            counts[3] += u32::from(tie && entry.as_ref().is_some_and(|e| e.tie));
        }
        let count = |k: &ContactKind| kinds.get(k).copied().unwrap_or(0);
        println!("{name:22} {}", ContactKind::ALL.map(|k| format!("{:5}", count(&k))).join(" "));
        for kind in reaches {
            assert!(count(kind) >= 8, "{name} is for {kind}, and has it in {} of 1280 pairs", count(kind));
        }
    }
    println!("{:20} {:>6} {:>6} {:>6} {:>6}", "aims", "all", "asked", "due", "tie");
    for (predicate, [all, asked, exact, tie]) in &aims {
        println!("{:20} {all:6} {asked:6} {exact:6} {tie:6}", predicate.name());
        assert!(asked * 2 > *all, "{predicate} is aimed at {all} times, and asked {asked} times");
    }
    // Aims at gaps and places tie as they say. Of two faces chosen between, others may be the better way in.
    for predicate in MOVED.iter().filter(|p| **p != Predicate::EntranceDepth) {
        let [_, _, exact, tie] = aims[predicate];
        assert!(tie * 10 >= exact * 9, "{predicate}: {tie} ties of {exact}");
    }
}

/// The largest gap over the planes of both blocks' faces, as a share of the pair's size: below zero they overlap (for
/// convex blocks that no crossing edges part).
fn face_gap(a: &Block, b: &Block) -> f64 {
    let (pa, pb) = (points(a), points(b));
    let mut largest = f64::NEG_INFINITY;
    for (block, own, other) in [(a, &pa, &pb), (b, &pb, &pa)] {
        for face in block.topology().faces() {
            let n = margin::normal(own, face);
            let from = &own[face[0].index()];
            let norm = margin::approximate(&margin::dot(&n, &n)).sqrt();
            let least = other.iter().map(|x| margin::dot(&n, &margin::minus(x, from))).min().unwrap();
            largest = largest.max(margin::approximate(&least) / norm);
        }
    }
    let size = pa.iter().flatten().map(|c| margin::approximate(c).abs()).fold(0.0, f64::max);
    largest / size
}

#[test]
fn families_reach_what_they_are_for() {
    reach_what_they_are_for(80);
}

#[test]
#[ignore = "four seconds; .ci/run runs it"]
fn families_reach_what_they_are_for_at_full_size() {
    reach_what_they_are_for(200);
}

fn reach_what_they_are_for(pairs: usize) {
    println!("{:22} {:>6} {:>6} {:>6} | {:>6} {:>6} {:>6}", "", "apart", "touch", "into", "f32", "f64", "finer");
    let mut styles = [0; 3];
    for family in families::all() {
        let mut rng = ChaCha8Rng::from_seed([9; 32]);
        let (mut signs, mut held) = ([0; 3], [0; 3]);
        for _ in 0..pairs {
            let (a, b) = family.generate(&mut rng);
            let gap = face_gap(&a, &b);
            signs[if gap > 1e-14 {
                0
            } else if gap >= -1e-14 {
                1
            } else {
                2
            }] += 1;
            let both = |p: Precision| a.is_exact_in(p) && b.is_exact_in(p);
            held[if both(Precision::F32) {
                0
            } else if both(Precision::F64) {
                1
            } else {
                2
            }] += 1;
        }
        println!(
            "{:22} {:6} {:6} {:6} | {:6} {:6} {:6}",
            family.name(),
            signs[0],
            signs[1],
            signs[2],
            held[0],
            held[1],
            held[2]
        );
        let least = if family.name() == "real" || family.name() == "joint_cut" { 0 } else { pairs / 25 };
        assert!(
            signs.iter().all(|&n| n >= least),
            "{}: {signs:?} of {pairs} apart, touching, overlapping",
            family.name()
        );
        for (all, n) in styles.iter_mut().zip(held) {
            *all += n;
        }
    }
    assert!(styles.iter().all(|&n| 2 * n > 3 * pairs), "f32, f64, neither: {styles:?}");
}

#[test]
fn exact_rungs_are_named_so() {
    let config = unperturbed();
    for case in (0..200).flat_map(|k| batch(2, k, &config)) {
        if let PairForm::Directed { rung: Rung::Exact, .. } | PairForm::Ladder { rung: Rung::Exact, .. } = case.form {
            assert_eq!(case.margin, Some(Sign::Zero), "{}", case.index);
        }
    }
}

/// The default, with every base left on its ties.
fn unperturbed() -> PairConfig {
    PairConfig { perturbed_percent: 0, ..PairConfig::default() }
}
