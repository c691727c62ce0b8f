//! The targets that read: good inputs are read, those of the corpus are borne, and mutated ones reach every kind of answer and error that a
//! reader has, so that the mutations cannot quietly miss the readers.

// Longer than 400 lines: half of it is one table of what mutated inputs reach.

#[path = "support/beside_one_another.rs"]
mod beside_one_another;

use rockproof_fuzz::{Dice, REFUSED, Reach, TARGETS, Target, TargetKind, corpus, seeds};

/// Inputs of each target; of directories a share.
const INPUTS: u64 = if cfg!(debug_assertions) { 150 } else { WANTED_OF / 2 };
/// One directory takes as long as so many files.
const DIRECTORY: u64 = 20;
/// Of those that are only read.
const READ_ONLY: u64 = 4;
/// The inputs that [`WANTED`] is about; of fewer nothing is asked.
const WANTED_OF: u64 = 3_000;

/// What [`WANTED_OF`] inputs of each target reach at least: about a third of what they did when this was written.
const WANTED: [(&str, &[(&str, u64)]); 27] = [
    (
        "scene",
        &[
            ("read", 200),
            ("Block", 20),
            ("NoBlock", 60),
            ("NotAllowed", 12),
            ("NotText", 40),
            ("Number", 12),
            ("Tolerances", 30),
            ("Toml", 480),
            ("Unexpected", 18),
            ("UnknownKey", 110),
        ],
    ),
    (
        "dda",
        &[
            ("read", 75),
            ("Block", 40),
            ("NotAllowed", 45),
            ("NotText", 30),
            ("Number", 4),
            ("Truncated", 55),
            ("Unexpected", 700),
        ],
    ),
    (
        "obj",
        &[
            ("read", 140),
            ("Block", 100),
            ("NoBlock", 30),
            ("NotAllowed", 180),
            ("NotText", 30),
            ("Number", 5),
            ("Unexpected", 500),
        ],
    ),
    (
        "vtk",
        &[
            ("read", 130),
            ("Block", 43),
            ("NotAllowed", 36),
            ("NotText", 30),
            ("Number", 2),
            ("Truncated", 80),
            ("Unexpected", 600),
            ("Unsupported", 50),
        ],
    ),
    (
        "stl",
        &[
            ("read", 86),
            ("Block", 47),
            ("NotAllowed", 24),
            ("NotText", 21),
            ("Number", 2),
            ("Truncated", 37),
            ("Unexpected", 781),
        ],
    ),
    ("ply", &[("read", 59), ("Block", 23), ("NotAllowed", 9), ("Truncated", 21), ("Unexpected", 885)]),
    (
        "msh",
        &[
            ("read", 67),
            ("Block", 21),
            ("NotAllowed", 108),
            ("NotText", 32),
            ("Number", 3),
            ("Truncated", 136),
            ("Unexpected", 582),
            ("Unsupported", 46),
        ],
    ),
    (
        "vtu",
        &[
            ("read", 90),
            ("Block", 45),
            ("NotAllowed", 191),
            ("NotText", 34),
            ("Number", 4),
            ("Truncated", 70),
            ("Unexpected", 547),
            ("Unsupported", 14),
        ],
    ),
    (
        "voro",
        &[
            ("read", 90),
            ("Block", 37),
            ("NoBlock", 75),
            ("NotAllowed", 45),
            ("NotText", 28),
            ("Number", 4),
            ("Truncated", 29),
            ("Unexpected", 680),
        ],
    ),
    (
        "tolerances",
        &[
            ("read", 140),
            ("NotText", 26),
            ("Tolerances", 250),
            ("Tolerances-GivenTwice", 2),
            ("Tolerances-NotAllowed", 32),
            ("Tolerances-Number", 19),
            ("Tolerances-UnknownName", 200),
            ("Toml", 560),
            ("resolved", 140),
            ("unresolved-Missing", 44),
            ("unresolved-Preset", 100),
        ],
    ),
    (
        "assignment",
        &[
            ("read", 95),
            ("NotAllowed", 109),
            ("NotAnAssignment", 300),
            ("Number", 64),
            ("UnknownName", 400),
            ("not-text", 19),
        ],
    ),
    ("case", &[("read", 90), ("Block", 12), ("Blocks", 1), ("Io", 22), ("Tolerance", 2), ("Toml", 850), ("Value", 15)]),
    ("state", &[("read", 90), ("Io", 26), ("Json", 790), ("Scene", 40), ("State", 50)]),
    ("campaign", &[("read", 200), ("Engines", 12), ("Io", 25), ("Source", 18), ("Toml", 740)]),
    ("gate", &[("read", 175), ("Io", 22), ("Source", 5), ("Toml", 730), ("Value", 57)]),
    ("baseline", &[("read", 250), ("Io", 22), ("Toml", 720)]),
    (
        "engine_spec",
        &[("read", 520), ("Command", 100), ("Form", 250), ("Name", 45), ("Precision", 60), ("not-text", 20)],
    ),
    (
        "number",
        &[
            ("read", 240),
            ("ExponentTooLarge", 6),
            ("NotANumber", 620),
            ("TooManyDigits", 33),
            ("ZeroDenominator", 3),
            ("not-text", 18),
        ],
    ),
    ("engine_answer", &[("contacts", 36), ("state-overlapping", 28), ("Unsupported", 48), ("Malformed", 880)]),
    (
        "message",
        &[
            ("read", 190),
            ("Csv", 55),
            ("Distribute", 660),
            ("case", 19),
            ("case-report", 37),
            ("cases", 14),
            ("end", 19),
            ("ended", 16),
            ("introduction", 22),
            ("stopped", 18),
            ("unit", 25),
            ("unit-report", 20),
        ],
    ),
    ("run_directory", &[("whole", 5), ("changed", 20), ("missing", 4), ("seal", 5), ("resealed-read", 6)]),
    (
        "report",
        &[
            ("read", 60),
            ("Contradiction", 1),
            ("Damaged", 157),
            ("Damaged-bench/bench.csv", 13),
            ("Damaged-campaign/agreement.csv", 11),
            ("Damaged-campaign/confusion.csv", 12),
            ("Damaged-campaign/diagnosis.csv", 12),
            ("Damaged-campaign/findings.csv", 11),
            ("Damaged-campaign/run.json", 13),
            ("Damaged-campaign/step_summary.csv", 9),
            ("Damaged-simulated/differences.csv", 14),
            ("Damaged-simulated/lockstep.csv", 10),
            ("Damaged-simulated/run.json", 9),
            ("Damaged-stress/limits.csv", 16),
            ("Damaged-stress/steps.csv", 13),
            ("Damaged-stress/stress.csv", 11),
            ("Io", 8),
            ("NoRun", 3),
            ("Version-campaign/run.json", 11),
            ("Version-simulated/run.json", 7),
        ],
    ),
    (
        "tally_directory",
        &[
            ("read", 90),
            ("Contradiction", 12),
            ("Csv-campaign/engines.csv", 24),
            ("Csv-campaign/findings.csv", 30),
            ("Csv-campaign/step_findings.csv", 26),
            ("Csv-campaign/step_summary.csv", 32),
            ("Csv-campaign/summary.csv", 31),
        ],
    ),
    ("simulation_directory", &[("Damaged", 31), ("Manifest", 8), ("resealed-run", 4), ("whole", 5)]),
    ("tune_directory", &[("Damaged", 25), ("Foreign", 1), ("Manifest", 11), ("resealed-read", 6), ("whole", 4)]),
    ("part_directory", &[("Results", 37), ("resealed-read", 6), ("whole", 6)]),
    (
        "comparison_directory",
        &[("Results", 29), ("added-up", 21), ("resealed-read", 8), ("total-Results", 28), ("whole", 12)],
    ),
];

/// What is wrong with blocks, and how often [`WANTED_OF`] inputs of each target reach it at least, all together; 0 where only a kept input does.
/// Two errors of blocks are missing: `Overflow`, for readers refuse a number beyond f64 as such, before there is a block, and `FlatEdge`:
/// merging makes an edge flat only where faces are bent within the planarity allowed, and no input is known that does.
const WRONG_WITH_BLOCKS: [(&str, u64); 22] = [
    ("DegenerateFace", 6),
    ("Disconnected", 0),
    ("FaceWithHole", 0),
    ("FacesMeet", 5),
    ("FoldedEdge", 8),
    ("NoSuchVertex", 5),
    ("NonManifoldVertex", 0),
    ("NotPlanar", 98),
    ("NotPositiveVolume", 16),
    ("NothingLeft", 2),
    ("Open", 95),
    ("PinchedFace", 0),
    ("RepeatedVertex", 25),
    ("RunsThroughItself", 0),
    ("SameDirection", 42),
    ("SelfIntersecting", 30),
    ("ShortFace", 1),
    // Made by the test: a file of it is of more than 20 kB.
    ("TooFine", 0),
    ("TooFew", 7),
    ("TwoEdgeVertex", 6),
    ("UnusedVertex", 0),
    ("VertexTwice", 26),
];

/// What a number of seeded inputs reach, each within the time and the memory that an input may take.
fn reached(target: &Target, inputs: u64, seed: u64) -> Reach {
    let (mut dice, mut reach) = (Dice::new(seed), Reach::default());
    let share = match target.name {
        "report" | "tally_directory" => READ_ONLY,
        _ if target.takes_directory() => DIRECTORY,
        _ => 1,
    };
    for number in 0..inputs / share {
        let bytes = target.input(&mut dice);
        if let Err(what) = target.run_within_limits(&bytes, &mut reach) {
            panic!("{}, seed {seed}, input {number}: {what}: {:?}", target.name, String::from_utf8_lossy(&bytes));
        }
    }
    reach
}

fn readers() -> impl Iterator<Item = &'static Target> {
    TARGETS.iter().filter(|target| target.kind == TargetKind::Reader)
}

#[test]
fn good_inputs_are_read() {
    for target in readers().filter(|target| !target.takes_directory()) {
        let seeds = seeds(target.name);
        assert!(!seeds.is_empty(), "{}", target.name);
        for (path, bytes) in seeds {
            let mut reach = Reach::default();
            target.run(&bytes, &mut reach);
            let good = ["read", "contacts", "state-overlapping", "Unsupported"];
            // What was found once and broke something has no right to be good.
            let is_found = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("found-"));
            assert!(is_found || good.iter().any(|kind| reach.of(kind) == 1), "{}: {reach}", path.display());
        }
    }
}

#[test]
fn the_corpus_is_borne() {
    beside_one_another::of_each(TARGETS, |target| {
        let corpus = corpus(target.name);
        let bytes: usize = corpus.iter().map(|(_, bytes)| bytes.len()).sum();
        assert!((1..=48).contains(&corpus.len()) && bytes <= 60_000, "{}: {} inputs", target.name, corpus.len());
        for (path, bytes) in corpus {
            println!("{}", path.display());
            target.run(&bytes, &mut Reach::default());
        }
    });
}

/// A block of so long fractions that exact arithmetic would take forever.
fn too_fine() -> String {
    let number = |k: usize| format!("\"1/1{:0900}\"", 2 * k + 1);
    let vertex = |v: usize| format!("[{}]", [0, 1, 2].map(|axis| number(3 * v + axis)).join(", "));
    let vertices: Vec<String> = (0..8).map(vertex).collect();
    let faces = "[[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]";
    format!("[[block]]\nvertices = [{}]\nfaces = {faces}\n", vertices.join(", "))
}

/// What all kept inputs reach whose names say how they are refused: that.
fn refused() -> Reach {
    let mut all = Reach::default();
    for target in readers() {
        for (path, bytes) in corpus(target.name) {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            if let Some(kind) = stem.strip_prefix(REFUSED) {
                let mut reach = Reach::default();
                target.run(&bytes, &mut reach);
                assert_eq!(reach.of(kind), 1, "{}: {reach}", path.display());
                all.count(kind);
            }
        }
    }
    Target::named("scene").expect("a target").run(too_fine().as_bytes(), &mut all);
    all
}

#[test]
fn kept_inputs_are_refused_as_their_names_say() {
    let refused = refused();
    let only_kept = WRONG_WITH_BLOCKS.iter().filter(|(_, least)| *least == 0).map(|(kind, _)| format!("Block-{kind}"));
    for kind in only_kept.chain(["NamedFile", "Format", "Engine"].map(str::to_owned)) {
        assert!(refused.of(&kind) > 0, "no kept input is refused as {kind}: {refused}");
    }
}

#[test]
fn mutated_inputs_are_read_or_refused_with_a_reason() {
    read_or_refused(INPUTS);
}

#[test]
#[ignore = "eight seconds; .ci/run runs it"]
fn mutated_inputs_are_read_or_refused_with_a_reason_at_full_size() {
    read_or_refused(WANTED_OF);
}

fn read_or_refused(inputs: u64) {
    assert_eq!(WANTED.map(|(name, _)| name).to_vec(), readers().map(|target| target.name).collect::<Vec<_>>());
    let mut all = Reach::default();
    let reached_by = |(name, _): &(&str, _)| reached(&Target::named(name).expect(name), inputs, 1);
    let reaches: Vec<Reach> = beside_one_another::of_each(&WANTED, reached_by);
    for ((name, wanted), reach) in WANTED.into_iter().zip(reaches) {
        println!("{name}: {reach}");
        reach.all().for_each(|(kind, count)| all.add(kind, count));
        for (kind, at_least) in wanted {
            let at_least = (at_least * inputs).div_ceil(WANTED_OF);
            assert!(
                reach.of(kind) >= at_least,
                "{name}: {kind} only {} times, not {at_least}: {reach}",
                reach.of(kind)
            );
        }
    }
    for (kind, at_least) in WRONG_WITH_BLOCKS {
        // What is reached once is held at full size alone.
        let (count, at_least) = (all.of(&format!("Block-{kind}")), at_least * inputs / WANTED_OF);
        assert!(count >= at_least, "blocks are {kind} only {count} times, not {at_least}: {all}");
    }
}

#[test]
#[ignore = "as many as ROCKPROOF_FUZZ_INPUTS says, 100,000 of each target: --release -- --ignored --nocapture"]
fn many_mutated_inputs_are_read_or_refused() {
    let number = |name: &str, otherwise: u64| {
        std::env::var(name).map_or(otherwise, |text| text.parse().unwrap_or_else(|_| panic!("{name} is \"{text}\"")))
    };
    let (inputs, seed) = (number("ROCKPROOF_FUZZ_INPUTS", 100_000), number("ROCKPROOF_FUZZ_SEED", 2));
    for target in readers() {
        println!("{}: {}", target.name, reached(target, inputs, seed));
    }
}

/// The workspace for libFuzzer is not built by the tests: here its files are compared with the list of targets.
#[test]
fn every_target_stands_in_the_workspace_for_libfuzzer() {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz"));
    let read =
        |name: &str| std::fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let manifest = read("Cargo.toml");
    assert_eq!(manifest.matches("[[bin]]").count(), TARGETS.len());
    for target in TARGETS {
        let name = target.name;
        assert!(manifest.contains(&format!("name = \"{name}\"\npath = \"fuzz_targets/{name}.rs\"")), "{name}");
        assert!(read(&format!("fuzz_targets/{name}.rs")).contains(&format!("rockproof_fuzz::{name}(bytes)")), "{name}");
    }
}
