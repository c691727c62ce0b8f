//! Mutated input: to the program, and in this process to every reader.

use crate::attacks::Attack;
use crate::jobs::write;
use crate::program::{Call, Disturbance, Told};
use rockproof_fuzz::{Dice, Reach, TARGETS, Target, TargetKind, mutated};
use rockproof_gate::config::GateConfig;
use rockproof_model::text::escaped;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

thread_local! {
    /// What the last panic of this thread said.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Panics are told where they are caught, not as they happen.
pub(crate) fn keep_panics() {
    std::panic::set_hook(Box::new(|about| PANIC.with(|said| *said.borrow_mut() = about.to_string())));
}

/// What the last panic of this thread said.
pub(crate) fn last_panic() -> String {
    PANIC.with(|said| said.borrow().clone())
}

/// Inputs of one step: of files, and of whole directories, which take longer.
const INPUTS: u64 = 3_000;
const DIRECTORIES: u64 = 100;
/// Inputs of one step to the program.
const PROGRAM_INPUTS: u64 = 20;

/// What the program does with inputs: the target that makes them, the name of the file, the command.
const COMMANDS: [(&str, &str, &[&str]); 18] = [
    ("scene", "input.toml", &["check", "input.toml"]),
    ("scene", "input.toml", &["classify", "input.toml"]),
    ("scene", "input.toml", &["convert", "input.toml", "made.vtk", "--overwrite"]),
    ("dda", "input.dda", &["check", "input.dda"]),
    ("dda", "input.dda", &["classify", "input.dda", "--engine", "f32"]),
    ("obj", "input.obj", &["classify", "input.obj"]),
    ("obj", "input.obj", &["convert", "input.obj", "made.toml", "--overwrite"]),
    ("vtk", "input.vtk", &["classify", "input.vtk", "--engine", "f64"]),
    ("voro", "input.voro", &["check", "input.voro"]),
    ("stl", "input.stl", &["check", "input.stl"]),
    ("ply", "input.ply", &["classify", "input.ply"]),
    ("msh", "input.msh", &["classify", "input.msh", "--engine", "f64"]),
    ("vtu", "input.vtu", &["convert", "input.vtu", "made.obj", "--overwrite"]),
    ("gate", "input.toml", &["gate", "input.toml", "--out", "gated"]),
    ("tolerances", "input.toml", &["check", "good.obj", "--tolerances", "input.toml"]),
    ("case", "input.toml", &["replay", "input.toml"]),
    ("case", "input.toml", &["shrink", "input.toml", "--out", "made.toml", "--overwrite"]),
    ("state", "input.json", &["replay", "input.json"]),
];

const GOOD: &str = include_str!("../../tests/fixtures/two_cubes.obj");

/// A gate file over few pairs, with all that takes numbers and names.
const GATE: &str = "corpus = []\nrotating_pairs = 16\n[campaign]\npairs = 16\nchunk = 16\nfamilies = [\"sliver\", \"edge_cross\"]\n\
    tolerances = [\"auto\"]\nsteps_every = 8\nshrink_evaluations = 4\n[baseline]\nfile = \"known.toml\"\ncauses = [\"defect\"]\n\
    confidence = 0.99\n[[limit]]\nengine = \"stepper-f32\"\nbeyond_ulps = 100\ncount = 0\n[[limit]]\ncause = \"arithmetic\"\nkind = \"v-f\"\n\
    rate = 0.5\nconfidence = 0.99\n";

/// A gate file with a few changes that the program can be given: it starts no program and is about few pairs, or is refused. Every other one is of the
/// corpus.
fn small_gate(dice: &mut Dice) -> Vec<u8> {
    loop {
        let bytes = match Target::named("gate").filter(|_| dice.once_in(2)) {
            Some(target) => target.input(dice),
            None => mutated(GATE.as_bytes(), GATE.as_bytes(), dice),
        };
        let is_small = |gate: &GateConfig| {
            let GateConfig { campaign, rotating_pairs, .. } = gate;
            let few =
                campaign.pairs.max(*rotating_pairs) <= 64 && campaign.steps <= 4 && campaign.shrink_evaluations <= 300;
            few && campaign.external.is_empty() && campaign.grid.is_none()
        };
        if gate_of(&bytes).as_ref().is_none_or(is_small) {
            return bytes;
        }
    }
}

/// The gate in a file, where it is one.
fn gate_of(bytes: &[u8]) -> Option<GateConfig> {
    GateConfig::from_toml(std::str::from_utf8(bytes).ok()?, "input.toml").ok()
}

/// A name as messages show it, which keep tabs and line breaks.
fn shown(name: &str) -> String {
    name.split_inclusive(['\t', '\n'])
        .map(|part| match part.char_indices().next_back() {
            Some((at, end @ ('\t' | '\n'))) => format!("{}{end}", escaped(&part[..at])),
            _ => escaped(part),
        })
        .collect()
}

/// What a gate file names beside itself, as messages show it.
fn named_by(gate: &[u8]) -> impl Iterator<Item = String> {
    let gate = gate_of(gate).map(|gate| (gate.corpus, gate.campaign, gate.baseline));
    gate.into_iter().flat_map(|(corpus, campaign, baseline)| {
        let files = corpus.into_iter().chain(campaign.real).chain(baseline.map(|baseline| baseline.file));
        let files: Vec<String> = files.map(|file| shown(&file.display().to_string())).collect();
        files.into_iter().chain(campaign.tolerances.into_iter().map(|set| shown(&set)))
    })
}

impl Attack {
    /// Mutated input to the program, in files.
    pub(crate) fn program_inputs(&mut self) -> Told<()> {
        let (target, name, arguments) = *self.dice.one_of(&COMMANDS);
        let target = Target::named(target).ok_or_else(|| format!("no target {target}"))?;
        write(self.folder.path(), "good.obj", GOOD.as_bytes())?;
        for _ in 0..PROGRAM_INPUTS {
            let bytes = if target.name == "gate" { small_gate(&mut self.dice) } else { target.input(&mut self.dice) };
            write(self.folder.path(), name, &bytes)?;
            let judged = self.run(&Call::of(arguments.iter().copied()), Disturbance::None).and_then(|ended| {
                ended.has_code(&[0, 1, 2], &arguments.join(" "))?;
                // What cannot be written is said of the other file.
                let is_named = ended.err.contains(name) || ended.err.contains("made.");
                // A gate names files itself.
                let is_named =
                    is_named || target.name == "gate" && named_by(&bytes).any(|name| ended.err.contains(&name));
                match ended.code {
                    Some(2) if !is_named => Err(format!("the file is not named: {}", ended.err)),
                    Some(2) if ended.err.len() > 6_000 => Err(format!("a message of {} bytes", ended.err.len())),
                    _ => Ok(()),
                }
            });
            judged.map_err(|what| format!("{}: {what}; {}", arguments.join(" "), kept(target.name, &bytes)))?;
            self.counts.program_inputs += 1;
        }
        Ok(())
    }

    /// Mutated input to a reader in this process.
    pub(crate) fn reader_inputs(&mut self) -> Told<()> {
        let readers: Vec<Target> = TARGETS.iter().copied().filter(|target| target.kind == TargetKind::Reader).collect();
        let target = *self.dice.one_of(&readers);
        let mut reach = Reach::default();
        for _ in 0..if target.takes_directory() { DIRECTORIES } else { INPUTS } {
            let bytes = target.input(&mut self.dice);
            let ran = catch_unwind(AssertUnwindSafe(|| target.run_within_limits(&bytes, &mut reach)));
            let took = ran
                .unwrap_or_else(|_| Err(last_panic()))
                .map_err(|what| format!("{}: {what}; {}", target.name, kept(target.name, &bytes)))?;
            self.counts.longest_input = self.counts.longest_input.max(took);
            self.counts.reader_inputs += 1;
        }
        Ok(())
    }
}

/// Keeps an input that was not borne, and says where.
fn kept(target: &str, bytes: &[u8]) -> String {
    let digest = bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3));
    let path: PathBuf = std::env::temp_dir().join(format!("rockproof-{target}-{digest:016x}.bin"));
    match std::fs::write(&path, bytes) {
        Ok(()) => format!("the input is kept in {}", path.display()),
        Err(error) => format!("the input cannot be kept: {error}"),
    }
}
