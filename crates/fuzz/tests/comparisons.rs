//! The targets that compare: seeded inputs reach every kind of contact, ties of every predicate, every level of the oracle and every mode, and the
//! deliberate mistakes of the stepper, so that what is made of bytes cannot quietly become harmless.

#[path = "../../stepper/tests/support/mistakes.rs"]
mod mistakes;

use rockproof_fuzz::{Dice, PairInput, REACHES, Reach, TARGETS, Target, TargetKind, corpus};
use rockproof_stepper::Classifier;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::settled_contacts;

/// So many inputs of a target in a release build, and what they reach at least: about a third of what they did when this was written.
struct Wanted {
    target: &'static str,
    inputs: u64,
    reached: &'static [(&'static str, u64)],
}

/// A debug build takes one in so many inputs, and asks nothing of what they reach.
const SHARE: u64 = if cfg!(debug_assertions) { 10 } else { 1 };

/// What pairs reach.
const PAIRS: &[(&str, u64)] = &[
    ("gap-sign--1", 35),
    ("gap-sign-0", 9),
    ("gap-sign-1", 95),
    ("kind-e-e", 23),
    ("kind-e-v", 7),
    ("kind-f-v", 7),
    ("kind-v-e", 4),
    ("kind-v-f", 7),
    ("kind-v-v", 91),
    ("level-ball", 1968),
    ("level-f64", 23431),
    ("level-heap", 616),
    ("level-i1024", 134),
    ("level-i128", 8175),
    ("level-i256", 2678),
    ("level-i512", 931),
    ("tie-cone-passes", 418),
    ("tie-edge-edge-depth", 1),
    ("tie-edge-edge-near", 1),
    ("tie-edge-region", 10),
    ("tie-edge-territory", 2),
    ("tie-entrance-choice", 87),
    ("tie-entrance-depth", 13),
    ("tie-feet-inside", 120),
    ("tie-foot-inside", 186),
    ("tie-foot-region", 4),
    ("tie-gap-sign", 65),
    ("tie-inside-face", 41),
    ("tie-nearly-parallel", 178),
    ("tie-neighbours", 2),
    ("tie-one-exit", 36),
    ("tie-shortest-exit", 1),
    ("tie-true-exit", 24),
    ("tie-vertex-edge-near", 3),
    ("tie-vertex-face-depth", 44),
    ("tie-vertex-face-near", 20),
    ("tie-vertex-region", 10),
    ("tie-vertex-territory", 2),
    ("tie-vertex-vertex-near", 1),
    ("tie-wedges-pass", 218),
];

const WANTED: [Wanted; 4] = [
    Wanted { target: "engine_question", inputs: 500, reached: &[("question", 120), ("reflex", 30)] },
    Wanted { target: "fast_plain", inputs: 150, reached: PAIRS },
    Wanted { target: "wide_oracle", inputs: 150, reached: PAIRS },
    Wanted {
        target: "step",
        inputs: 24,
        reached: &[
            ("contacts", 12),
            ("cuts", 5),
            ("enclosed", 2),
            ("failure-Inverted", 1),
            ("level-float", 66),
            ("mode-locked", 6),
            ("mode-open", 16),
            ("mode-sliding", 6),
            ("not-kept", 2),
            ("solves", 5),
            ("step", 3),
            ("wide-settled", 2),
        ],
    },
];

/// What the targets of pairs reach beside what [`PAIRS`] says.
const OF_TARGET: [(&str, &str, u64); 3] =
    [("fast_plain", "pair", 34), ("wide_oracle", "settled", 19), ("wide_oracle", "unsettled", 15)];

fn reached(target: &Target, inputs: u64, seed: u64) -> Reach {
    let (mut dice, mut reach) = (Dice::new(seed), Reach::default());
    for _ in 0..inputs {
        target.run(&target.input(&mut dice), &mut reach);
    }
    reach
}

fn comparisons() -> impl Iterator<Item = &'static Target> {
    TARGETS.iter().filter(|target| target.kind == TargetKind::Comparison)
}

#[test]
fn seeded_inputs_agree_and_reach_what_they_are_for() {
    assert_eq!(WANTED.map(|w| w.target).to_vec(), comparisons().map(|target| target.name).collect::<Vec<_>>());
    for Wanted { target: name, inputs, reached: wanted } in WANTED {
        let target = Target::named(name).expect(name);
        let reach = reached(&target, inputs.div_ceil(SHARE), 1);
        println!("{name}: {reach}");
        let of_target = OF_TARGET.iter().filter(|(of, _, _)| *of == name).map(|(_, kind, least)| (*kind, *least));
        for (kind, least) in wanted.iter().copied().chain(of_target).filter(|_| SHARE == 1) {
            assert!(reach.of(kind) >= least, "{name}: {kind} only {} times, not {least}: {reach}", reach.of(kind));
        }
    }
}

/// What few inputs of `step` reach, so that one is kept for each. `failure-Degenerate` is none of them: it takes a volume or an area of zero,
/// which no block has that is read, and a step that would leave none is `Inverted`.
const KEPT_STEPS: [&str; 8] = [
    "failure-Inverted",
    "failure-NoElasticity",
    "failure-NoStiffness",
    "failure-NotConverged",
    "failure-TooFast",
    "level-double",
    "level-exact",
    "level-wide",
];

#[test]
fn kept_inputs_reach_what_their_names_say() {
    let target = Target::named("step").expect("a target");
    let mut kept = Vec::new();
    for (path, bytes) in corpus(target.name) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some(kind) = name.strip_prefix(REACHES) else { continue };
        let mut reach = Reach::default();
        target.run(&bytes, &mut reach);
        assert!(reach.of(kind) > 0, "{}: {reach}", path.display());
        kept.push(kind.to_owned());
    }
    assert_eq!(kept, KEPT_STEPS);
}

#[test]
#[ignore = "as many as ROCKPROOF_FUZZ_INPUTS says, 2,000 of each target: --release -- --ignored --nocapture"]
fn many_inputs_agree() {
    let number = |name: &str, otherwise: u64| {
        std::env::var(name).map_or(otherwise, |text| text.parse().unwrap_or_else(|_| panic!("{name} is \"{text}\"")))
    };
    let (inputs, seed) = (number("ROCKPROOF_FUZZ_INPUTS", 2_000), number("ROCKPROOF_FUZZ_SEED", 2));
    for target in comparisons() {
        println!("{}: {}", target.name, reached(target, inputs, seed));
    }
}

/// Pairs until a mistaken stepper is looked at no further.
const MAX_PAIRS: usize = 4_000;
/// So many of the mistakes that can show in a pair do: 89 of 92 when this was written.
const FOUND: usize = 85;

#[test]
#[ignore = "some minutes on a busy machine; .ci/run runs it"]
fn pairs_made_of_bytes_show_mistakes_at_full_size() {
    let mut dice = Dice::new(1);
    let target = Target::named("wide_oracle").expect("a target");
    let settled = |pair: &PairInput| settled_contacts::<SpecRules>(&pair.a, &pair.b, &pair.tolerances).ok().flatten();
    let (mut left, all) = (mistakes::all(), mistakes::all().len());
    for _ in 0..MAX_PAIRS {
        let Some(pair) = PairInput::of(&target.input(&mut dice)) else { continue };
        let Some(right) = settled(&pair) else { continue };
        let differs = |mistaken: &mistakes::Mistaken| {
            mistaken.wide(&pair.a, &pair.b, &pair.tolerances).is_ok_and(|(found, _)| found != right)
        };
        left.retain(|(_, mistaken)| !differs(mistaken));
    }
    let names: Vec<&str> = left.iter().map(|(name, _)| *name).collect();
    println!("{} of {all} mistakes show; not: {names:?}", all - left.len());
    assert!(all - left.len() >= FOUND, "only {} of {all} mistakes show; not: {names:?}", all - left.len());
}
