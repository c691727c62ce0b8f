//! Fuzz targets: functions of bytes that must come to an end, whatever the bytes are, with what they say being true.
//!
//! They run in two ways: under libFuzzer (`fuzz/`, a workspace of its own), and on stable Rust, where [`Target::input`] makes seeded inputs
//! and [`Target::run`] takes them (`tests/`, and `examples/soak`). A target that finds something wrong panics. What inputs reach is
//! counted in a [`Reach`], so that a test can hold that they reach what a target is for.

mod comparison_directory;
mod comparisons;
mod dice;
mod engine_answer;
mod input;
mod limits;
mod message;
mod mutate;
mod part_directory;
mod reach;
mod readers;
mod reported;
mod run_directory;
mod scratch;
mod seeds;
mod simulation_directory;
mod steps;
mod tune_directory;

pub use dice::Dice;
pub use input::PairInput;
pub use limits::{MAX_MEMORY, MAX_SECONDS, peak_memory};
pub use mutate::mutated;
pub use reach::Reach;
pub use run_directory::files;
pub use scratch::new_folder;
pub use seeds::{REACHES, REFUSED, corpus, seeds};

use std::fmt;

/// Bytes of an input that is decoded: all choices that a comparison makes.
const LENGTH: usize = 256;

/// A fuzz target.
#[derive(Clone, Copy)]
pub struct Target {
    /// Its name, that of its folder in `fuzz/corpus/` too.
    pub name: &'static str,
    /// What it is for.
    pub kind: TargetKind,
    test: fn(&[u8], &mut Reach),
    input: fn(&Target, &mut Dice) -> Vec<u8>,
}

/// What targets are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetKind {
    /// Something that a user or a program wrote is read.
    Reader,
    /// Implementations are compared.
    Comparison,
}

impl Target {
    /// Takes an input and counts what it reaches.
    ///
    /// # Panics
    /// When something is wrong.
    pub fn run(&self, bytes: &[u8], reach: &mut Reach) {
        (self.test)(bytes, reach);
    }

    /// An input as the dice fall.
    pub fn input(&self, dice: &mut Dice) -> Vec<u8> {
        (self.input)(self, dice)
    }

    /// Whether it takes a whole directory, which takes longer than a file.
    pub fn takes_directory(&self) -> bool {
        self.name == "report" || self.name.ends_with("_directory")
    }

    /// The target of a name.
    pub fn named(name: &str) -> Option<Target> {
        TARGETS.iter().copied().find(|target| target.name == name)
    }
}

impl fmt::Debug for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Target").field("name", &self.name).field("kind", &self.kind).finish_non_exhaustive()
    }
}

/// Defines a function of bytes for each target, and the list of all.
macro_rules! targets {
    ($($(#[$about:meta])* $name:ident: $kind:ident, $test:path, $input:expr;)*) => {
        $(
            $(#[$about])*
            ///
            /// # Panics
            /// When something is wrong.
            pub fn $name(bytes: &[u8]) {
                $test(bytes, &mut Reach::default());
            }
        )*

        /// All targets.
        pub const TARGETS: &[Target] = &[$(Target {
            name: stringify!($name),
            kind: TargetKind::$kind,
            test: $test,
            input: $input,
        }),*];
    };
}

targets! {
    /// A scene of the project, `.toml`.
    scene: Reader, readers::scene, seeds::changed_seed;
    /// A file of UnBlocks-gen.
    dda: Reader, readers::dda, seeds::changed_seed;
    /// A Wavefront file.
    obj: Reader, readers::obj, seeds::changed_seed;
    /// A legacy VTK file.
    vtk: Reader, readers::vtk, seeds::changed_seed;
    /// An STL file.
    stl: Reader, readers::stl, seeds::changed_seed;
    /// A PLY file.
    ply: Reader, readers::ply, seeds::changed_seed;
    /// A mesh of Gmsh.
    msh: Reader, readers::msh, seeds::changed_seed;
    /// A VTK file in XML.
    vtu: Reader, readers::vtu, seeds::changed_seed;
    /// A file of voro++.
    voro: Reader, readers::voro, seeds::changed_seed;
    /// A file of tolerances.
    tolerances: Reader, readers::tolerances, seeds::changed_seed;
    /// A tolerance as `--set` names it.
    assignment: Reader, readers::assignment, seeds::changed_seed;
    /// A case of a pair; what is read is written, and reads back the same.
    case: Reader, readers::case, seeds::changed_seed;
    /// A case of a step, likewise.
    state: Reader, readers::state, seeds::changed_seed;
    /// The settings of a campaign, and the names in them.
    campaign: Reader, readers::campaign, seeds::changed_seed;
    /// A gate file, and the names in it.
    gate: Reader, readers::gate, seeds::changed_seed;
    /// The baseline of a gate; what is read is written, and reads back the same.
    baseline: Reader, readers::baseline, seeds::changed_seed;
    /// What `--engine-command` names.
    engine_spec: Reader, readers::engine_spec, seeds::changed_seed;
    /// A number; what is read is written exactly.
    number: Reader, readers::number, seeds::changed_seed;
    /// The answer of an external engine.
    engine_answer: Reader, engine_answer::engine_answer, seeds::changed_seed;
    /// A message between ranks of a campaign; what is read is written, and reads back the same.
    message: Reader, message::message, seeds::changed_seed;
    /// A campaign's directory with one file damaged, gone on with: what was written is found, or an error names a file.
    run_directory: Reader, run_directory::run_directory, run_directory::run_directory_input;
    /// Directories of every sort that reports are made of, one file damaged.
    report: Reader, reported::report, reported::report_input;
    /// The tables of a campaign, one damaged, counted as gates count them.
    tally_directory: Reader, reported::tally_directory, reported::tally_directory_input;
    /// The directory of `simulate`, likewise gone on with.
    simulation_directory: Reader, simulation_directory::simulation_directory, simulation_directory::simulation_directory_input;
    /// The directory of `tune`, likewise gone on with.
    tune_directory: Reader, tune_directory::tune_directory, tune_directory::tune_directory_input;
    /// The parts of a campaign with one file damaged, put together.
    part_directory: Reader, part_directory::part_directory, part_directory::part_directory_input;
    /// The directory of a comparison of the exact side with itself, added up and gone on with.
    comparison_directory: Reader, comparison_directory::comparison_directory, comparison_directory::comparison_directory_input;
    /// The question that an external engine is asked about a pair holds the pair.
    engine_question: Comparison, comparisons::engine_question, any_bytes;
    /// The oracle's fast path and its plain path say the same of a pair.
    fast_plain: Comparison, comparisons::fast_plain, any_bytes;
    /// The stepper in 512 bits and the oracle say the same of a pair, where no comparison is left unsettled.
    wide_oracle: Comparison, comparisons::wide_oracle, any_bytes;
    /// The certified step, the step in fractions, the plain classification and the stepper in 512 bits say the same of a small scene.
    step: Comparison, steps::step, any_bytes;
}

/// So many bytes as a comparison may take choices from.
fn any_bytes(_: &Target, dice: &mut Dice) -> Vec<u8> {
    dice.bytes(LENGTH)
}
