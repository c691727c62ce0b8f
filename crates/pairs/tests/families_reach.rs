//! Pins that ladders and families reach what they are for under version 2 of the rules, by the oracle's trace: each
//! measure of "passes" and "nearly parallel" deciding alone, true exits, chains of exits, level edges, g > s, round
//! blocks. A generator that aims where nothing is decided any more fails here.

use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, ContactKey, FaceId, Sign, VertexId};
use rockproof_oracle::{Pair, PreparedBlock, TraceEntry};
use rockproof_pairs::batch::{PairCase, PairConfig, PairForm, SetSource, batch};
use rockproof_pairs::families::{self, Family};
use std::collections::{BTreeMap, BTreeSet};

/// No, tie and yes.
type Counts = [u32; 3];

fn place(sign: Sign) -> usize {
    match sign {
        Sign::Negative => 0,
        Sign::Zero => 1,
        Sign::Positive => 2,
    }
}

fn sets(names: &[&str]) -> Vec<SetSource> {
    names.iter().map(|name| SetSource::named(name).unwrap()).collect()
}

fn trace(case: &PairCase) -> Vec<TraceEntry> {
    let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
    Pair::new(&a, &b).trace(case.sets[0].of(case.aimed_for))
}

fn family(name: &str) -> PairConfig {
    PairConfig { families: families::named(&[name]).unwrap(), perturbed_percent: 0, ..PairConfig::default() }
}

/// Whether a plane is that of a v-f contact, and so asked in test 5: its vertex projects into the face, and is in no
/// territory.
fn is_contact(entries: &[TraceEntry], plane: &Decision) -> bool {
    let (vertex, face) = match plane.features() {
        [Some(v @ Feature::Vertex(..)), Some(f @ Feature::Face(..)), ..]
        | [Some(f @ Feature::Face(..)), Some(v @ Feature::Vertex(..)), ..] => (v, f),
        _ => return false,
    };
    let about = |p: Predicate, e: &TraceEntry, feature| {
        e.decision.predicate == p && e.decision.features().contains(&Some(feature))
    };
    let mut yes = entries.iter().filter(|e| e.outcome == 1);
    let territory = |e: &TraceEntry| {
        [Predicate::VertexTerritory, Predicate::EdgeTerritory].into_iter().any(|p| about(p, e, vertex))
    };
    let inside = |e: &TraceEntry| about(Predicate::InsideFace, e, vertex) && about(Predicate::InsideFace, e, face);
    yes.clone().any(inside) && !yes.any(territory)
}

/// Ladders of the default families under sets of the revised criteria. What a ladder says is what the oracle decides: no
/// below the critical value, yes at and above it, whatever the other measure.
#[test]
fn ladders_decide_by_each_measure_alone() {
    let names = ["auto", "dyadic", "dyadic-coarse", "dyadic-deep", "fractional"];
    let mut counts: BTreeMap<(&str, Predicate, &str), Counts> = BTreeMap::new();
    let mut aims: BTreeMap<(&str, Predicate), [u32; 2]> = BTreeMap::new();
    let mut wrong = Vec::new();
    for perturbed_percent in [0, 92] {
        let config = PairConfig {
            sets: sets(&names),
            directed_percent: 0,
            ladder_percent: 100,
            perturbed_percent,
            ..PairConfig::default()
        };
        for case in (0..450).flat_map(|k| batch(17, k, &config)) {
            let (PairForm::Ladder { tolerance, decision, .. }, Some(margin)) = (&case.form, case.margin) else {
                continue;
            };
            let [all, asked] = aims.entry((tolerance, decision.predicate)).or_default();
            *all += 1;
            let entries = trace(&case);
            let Some(entry) = entries.iter().find(|e| e.decision == *decision) else { continue };
            *asked += 1;
            let within = match decision.predicate {
                Predicate::TrueExit if is_contact(&entries, decision) => "test 5",
                Predicate::TrueExit => "entrance",
                _ => "",
            };
            counts.entry((tolerance, decision.predicate, within)).or_default()[place(margin)] += 1;
            let fixed = [Predicate::ConePasses, Predicate::WedgesPass, Predicate::NearlyParallel, Predicate::TrueExit];
            let agrees = (entry.outcome == 1) == (margin != Sign::Negative) && (margin != Sign::Zero || entry.tie);
            if fixed.contains(&decision.predicate) && !agrees {
                wrong.push(format!("{} {} {:?} {margin:?}: {entry:?}", case.index, case.family, case.form));
            }
        }
    }
    for ((tolerance, predicate, within), [no, tie, yes]) in &counts {
        let [all, asked] = aims[&(*tolerance, *predicate)];
        println!("{tolerance:14} {:20} {within:12} {no:5} {tie:5} {yes:5}  asked {asked} of {all}", predicate.name());
    }
    assert!(wrong.is_empty(), "{} wrong, first {:#?}", wrong.len(), &wrong[..wrong.len().min(8)]);
    for key in [
        ("overlap_sine", Predicate::ConePasses, ""),
        ("penetration", Predicate::ConePasses, ""),
        ("overlap_sine", Predicate::WedgesPass, ""),
        ("penetration", Predicate::WedgesPass, ""),
        ("parallel_sine", Predicate::NearlyParallel, ""),
        ("territory", Predicate::NearlyParallel, ""),
        ("territory", Predicate::TrueExit, "entrance"),
        ("territory", Predicate::TrueExit, "test 5"),
        ("overlap_sine", Predicate::OneExit, ""),
    ] {
        let [no, tie, yes] = counts.get(&key).copied().unwrap_or_default();
        assert!(no >= 10 && tie >= 2 && yes >= 10, "{key:?}: {no} no, {tie} ties, {yes} yes");
    }
}

/// Faces in a chain of exits: the vertices whose overlap the shortest exit of three faces or more ends, and of those
/// where two of the faces do not meet.
#[test]
fn concave_notches_have_chains_of_exits() {
    let config = PairConfig { sets: sets(&["dyadic-coarse", "dyadic-deep"]), ..family("concave_notch") };
    let (mut groups, mut chains) = (0, 0);
    for case in (0..150).flat_map(|k| batch(23, k, &config)) {
        let mut exits: BTreeMap<(Side, VertexId), Vec<FaceId>> = BTreeMap::new();
        for entry in trace(&case) {
            if let (Predicate::ShortestExit, [Some(Feature::Vertex(side, v)), Some(Feature::Face(_, f)), ..]) =
                (entry.decision.predicate, entry.decision.features())
            {
                exits.entry((side, v)).or_default().push(f);
            }
        }
        for ((side, _), faces) in exits.into_iter().filter(|(_, faces)| faces.len() >= 3) {
            let block = if side == Side::A { &case.b } else { &case.a };
            let meet = |f: FaceId, g: FaceId| {
                block.topology().edges().iter().any(|e| [e.left, e.right] == [f, g] || [e.left, e.right] == [g, f])
            };
            groups += 1;
            chains += u32::from(faces.iter().any(|&f| faces.iter().any(|&g| f < g && !meet(f, g))));
        }
    }
    println!("{groups} groups of three faces or more, {chains} of them chains");
    assert!(groups >= 10 && chains >= 5, "{groups} groups, {chains} chains");
}

/// Whether the foot of a vertex is on the line of an edge of a concave face, but not on the edge.
fn is_level(vertex: &Block, v: VertexId, block: &Block, face: FaceId) -> bool {
    let point = |block: &Block, v: VertexId| block.vertices()[v.index()].components().map(|c| c.to_rational());
    let minus = |a: &[BigRational; 3], b: &[BigRational; 3]| [0, 1, 2].map(|i| &a[i] - &b[i]);
    let dot = |a: &[BigRational; 3], b: &[BigRational; 3]| &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2];
    let cross = |a: &[BigRational; 3], b: &[BigRational; 3]| {
        [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
    };
    let corners: Vec<_> = block.topology().faces()[face.index()].iter().map(|&c| point(block, c)).collect();
    let arms: Vec<_> = corners[1..].iter().map(|c| minus(c, &corners[0])).collect();
    let normal = arms.windows(2).map(|two| cross(&two[0], &two[1])).reduce(|n, m| [0, 1, 2].map(|i| &n[i] + &m[i]));
    let (normal, x) = (normal.unwrap(), point(vertex, v));
    (0..corners.len()).any(|k| {
        let (p, q) = (&corners[k], &corners[(k + 1) % corners.len()]);
        let d = minus(q, p);
        let along = dot(&minus(&x, p), &d);
        let beyond = along.is_negative() || along > dot(&d, &d);
        beyond && dot(&minus(&x, p), &cross(&normal, &d)).is_zero()
    })
}

/// Points level with an edge of a concave face, inside and outside the face.
#[test]
fn concave_notches_have_level_edges() {
    let config = PairConfig { sets: sets(&["dyadic", "dyadic-deep"]), ..family("concave_notch") };
    let mut counts = [0; 2];
    for case in (0..600).map(|k| batch(29, k, &config).remove(0)) {
        for entry in trace(&case) {
            if let (Predicate::InsideFace, [Some(Feature::Vertex(side, v)), Some(Feature::Face(_, f)), ..]) =
                (entry.decision.predicate, entry.decision.features())
            {
                let (own, other) = if side == Side::A { (&case.a, &case.b) } else { (&case.b, &case.a) };
                if !entry.tie && !other.face_is_convex(f) && is_level(own, v, other, f) {
                    counts[usize::from(entry.outcome == 1)] += 1;
                }
            }
        }
    }
    println!("level with an edge of a concave face: {} outside, {} inside", counts[0], counts[1]);
    assert!(counts.iter().all(|&n| n >= 10), "{counts:?} outside, inside");
}

/// Ties at tolerances that no binary number holds, in aims and ladders.
#[test]
fn fractional_tolerances_tie() {
    let config =
        PairConfig { sets: sets(&["fractional"]), sets_per_batch: 1, perturbed_percent: 0, ..PairConfig::default() };
    let mut ties: BTreeMap<&str, u32> = BTreeMap::new();
    for case in (0..400).flat_map(|k| batch(37, k, &config)) {
        let (Some(decision), Some(Sign::Zero)) = (case.form.decision(), case.margin) else { continue };
        let set = case.sets[0].of(case.aimed_for);
        let name = match &case.form {
            PairForm::Ladder { tolerance, .. } => {
                let value = set.numbers().into_iter().find(|(name, _)| name == tolerance).unwrap().1;
                if value.as_f64().is_some() {
                    continue;
                }
                "ladder"
            }
            _ => decision.predicate.name(),
        };
        let entry = trace(&case).into_iter().find(|e| e.decision == *decision);
        *ties.entry(name).or_default() += u32::from(entry.is_some_and(|e| e.tie));
    }
    println!("{ties:?}");
    for (name, least) in [
        ("vertex-vertex-near", 3),
        ("vertex-edge-near", 3),
        ("vertex-face-near", 3),
        ("vertex-face-depth", 3),
        ("edge-edge-depth", 3),
        ("vertex-territory", 3),
        ("edge-territory", 3),
        ("ladder", 6),
    ] {
        assert!(ties.get(name).is_some_and(|&n| n >= least), "{name}: {ties:?}");
    }
}

/// With g > s there are contacts that g = s would lose.
#[test]
fn deep_sets_have_contacts_deeper_than_the_search_distance() {
    let config =
        PairConfig { sets: sets(&["dyadic-deep"]), perturbed_percent: 0, sets_per_batch: 1, ..PairConfig::default() };
    let mut deeper = 0;
    for case in (0..200).flat_map(|k| batch(31, k, &config)) {
        let set = case.sets[0].of(case.aimed_for);
        let shallow = rockproof_model::ToleranceSet { penetration: set.search.clone(), ..set.clone() };
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let lost = |p: Predicate| matches!(p, Predicate::VertexFaceDepth | Predicate::EdgeEdgeDepth);
        let too_deep: BTreeSet<Decision> = pair
            .trace(&shallow)
            .into_iter()
            .filter(|e| lost(e.decision.predicate) && e.outcome == 0)
            .map(|e| e.decision)
            .collect();
        let found = pair.classify(set).contacts;
        let contact = |d: &Decision| {
            found.iter().any(|c| {
                let key = match (d.features()[0], d.features()[1]) {
                    (Some(Feature::Vertex(Side::B, v)), Some(Feature::Face(_, f))) => ContactKey::FaceVertex(f, v),
                    (Some(Feature::Vertex(_, v)), Some(Feature::Face(_, f))) => ContactKey::VertexFace(v, f),
                    (Some(Feature::Edge(_, e)), Some(Feature::Edge(_, f))) => ContactKey::EdgeEdge(e, f),
                    _ => return false,
                };
                c.key == key
            })
        };
        deeper += u32::from(too_deep.iter().any(contact));
    }
    println!("{deeper} of 3200 pairs have a contact deeper than s");
    assert!(deeper >= 30, "{deeper}");
}

/// A small share of round blocks, and corners of five edges and more.
#[test]
fn some_blocks_are_round_and_have_corners_of_many_edges() {
    let (mut round, mut largest, mut many, mut all) = (0, 0, 0, 0);
    for family in families::all() {
        let mut rng = ChaCha8Rng::from_seed([5; 32]);
        for _ in 0..500 {
            let (a, b) = Family::generate(&*family, &mut rng);
            let size = a.vertices().len().max(b.vertices().len());
            let edges = |block: &Block| {
                (0..block.vertices().len() as u32).any(|v| block.topology().vertex_edges(VertexId(v)).len() >= 5)
            };
            all += 1;
            round += u32::from(size >= 50);
            largest = largest.max(size);
            many += u32::from(edges(&a) || edges(&b));
        }
    }
    println!("of {all} pairs {round} with 50 vertices or more (largest {largest}), {many} with a corner of five edges");
    assert!(round * 1000 >= all && round * 50 <= all && largest >= 125 && many * 20 >= all, "{round} {largest} {many}");
}
