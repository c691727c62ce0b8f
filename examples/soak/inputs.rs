//! Mutated input: to the program, and in this process to every reader.

use crate::attacks::Attack;
use crate::jobs::write;
use crate::program::{Call, Disturbance, MOST_MEMORY, MOST_SECONDS, Told, peak_memory};
use rockproof_fuzz::{Reach, TARGETS, Target, TargetKind};
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

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
const COMMANDS: [(&str, &str, &[&str]); 13] = [
    ("scene", "input.toml", &["check", "input.toml"]),
    ("scene", "input.toml", &["classify", "input.toml"]),
    ("scene", "input.toml", &["convert", "input.toml", "made.vtk", "--overwrite"]),
    ("dda", "input.dda", &["check", "input.dda"]),
    ("dda", "input.dda", &["classify", "input.dda", "--engine", "f32"]),
    ("obj", "input.obj", &["classify", "input.obj"]),
    ("obj", "input.obj", &["convert", "input.obj", "made.toml", "--overwrite"]),
    ("vtk", "input.vtk", &["classify", "input.vtk", "--engine", "f64"]),
    ("voro", "input.voro", &["check", "input.voro"]),
    ("tolerances", "input.toml", &["check", "good.obj", "--tolerances", "input.toml"]),
    ("case", "input.toml", &["replay", "input.toml"]),
    ("case", "input.toml", &["shrink", "input.toml", "--out", "made.toml", "--overwrite"]),
    ("state", "input.json", &["replay", "input.json"]),
];

const GOOD: &str = include_str!("../../tests/fixtures/two_cubes.obj");

impl Attack {
    /// Mutated input to the program, in files.
    pub(crate) fn program_inputs(&mut self) -> Told<()> {
        let (target, name, arguments) = *self.dice.one_of(&COMMANDS);
        let target = Target::named(target).ok_or_else(|| format!("no target {target}"))?;
        write(self.folder.path(), "good.obj", GOOD.as_bytes())?;
        for _ in 0..PROGRAM_INPUTS {
            let bytes = target.input(&mut self.dice);
            write(self.folder.path(), name, &bytes)?;
            let judged = self.run(&Call::of(arguments.iter().copied()), Disturbance::None).and_then(|ended| {
                ended.has_code(&[0, 1, 2], &arguments.join(" "))?;
                // What cannot be written is said of the other file.
                let is_named = ended.err.contains(name) || ended.err.contains("made.");
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
            let (begin, memory_before) = (Instant::now(), peak_memory(Path::new("/proc/self")));
            let panicked = catch_unwind(AssertUnwindSafe(|| target.run(&bytes, &mut reach))).is_err();
            if panicked {
                return Err(format!("{}: {}; {}", target.name, last_panic(), kept(target.name, &bytes)));
            }
            let took = begin.elapsed();
            if took.as_secs() >= MOST_SECONDS {
                return Err(format!("{}: an input of {took:.0?}; {}", target.name, kept(target.name, &bytes)));
            }
            let memory = peak_memory(Path::new("/proc/self"));
            // The peak is that of all threads, and never falls.
            if memory_before <= MOST_MEMORY && memory > MOST_MEMORY {
                let mib = memory / 1024;
                return Err(format!(
                    "{}: {mib} MiB while it read this or another thread something else; {}",
                    target.name,
                    kept(target.name, &bytes)
                ));
            }
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
