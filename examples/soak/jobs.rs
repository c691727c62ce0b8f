//! The work that is disturbed: small campaigns, parts of campaigns with their merge, simulations, searches of `tune`; and what each leaves when nothing
//! disturbs it.

use crate::counts::Counts;
use crate::program::{Call, Disturbance, Program, Told};
use rockproof_fuzz::{Dice, new_folder};
use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Campaign,
    Parts,
    Simulate,
    Lockstep,
    Tune,
}

/// A piece of work: of a kind, in one of a few variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Job {
    pub(crate) kind: Kind,
    variant: usize,
}

/// How many variants of each kind there are.
const VARIANTS: usize = 3;
/// How many parts a campaign in parts has.
const PARTS: usize = 3;

/// What a run leaves when nothing disturbs it.
#[derive(Debug)]
pub(crate) struct Undisturbed {
    /// The files that depend on the settings alone.
    pub(crate) files: BTreeMap<String, Vec<u8>>,
    /// How long each command took.
    pub(crate) took: Vec<Duration>,
    /// The size of the largest file of any sort, and of all.
    pub(crate) largest: u64,
    pub(crate) total: u64,
    code: i32,
}

const SCENE: &str = "[simulation]
gravity = [-6.1, 0, -8.1]
time_step = 0.01
[[joint]]
friction = 0.3
normal_stiffness = 1e8
[[block]]
name = \"incline\"
fixed = true
box = { min = [-12, -2, -1], max = [4, 3, 0] }
[[block]]
name = \"slider\"
box = { min = [0.1, 0.1, 0], max = [1.1, 1.1, 1] }
";

const MODEL: &str = "[tolerances]
preset = \"shi\"
search = 0.01
[[block]]
fixed = true
box = { min = [-1, -1, -1], max = [3, 3, 0] }
[[block]]
motion = \"rigid\"
box = { min = [0, 0, 0], max = [1, 1, 1] }
[[block]]
motion = \"rigid\"
box = { min = [1, 0, 0], max = [2, 1, 1] }
";

/// Files that hold times, counts of sessions, or what depends on them.
const OWN: [&str; 7] = [
    "run.json",
    "progress.json",
    "engines.csv",
    "checkpoint.jsonl",
    "tune.json",
    "rockproof.manifest.json",
    ".rockproof.lock",
];

/// The name of the directory that a job writes in the end.
pub(crate) const OUT: &str = "out";

impl Job {
    /// Any job, as the dice fall.
    pub(crate) fn any(dice: &mut Dice) -> Job {
        let kinds = [Kind::Campaign, Kind::Campaign, Kind::Parts, Kind::Simulate, Kind::Lockstep, Kind::Tune];
        Job { kind: *dice.one_of(&kinds), variant: dice.below(VARIANTS) }
    }

    /// Any job that writes one directory only.
    pub(crate) fn any_single(dice: &mut Dice) -> Job {
        loop {
            let job = Job::any(dice);
            if job.kind != Kind::Parts {
                return job;
            }
        }
    }

    /// Writes the input files into a folder.
    pub(crate) fn prepare(self, dir: &Path) -> Told<()> {
        let campaign = |families: &str, more: &str| {
            format!(
                "pairs = 96\nchunk = 16\nseed = {}\nfamilies = [{families}]\ntolerances = [\"auto\"]\nmetamorphic_every = 32\n\
                 shrink_evaluations = 2\ncases_per_cause = 3\n{more}",
                self.variant + 1
            )
        };
        let settings = match self.variant {
            0 => campaign("\"face_stack\", \"edge_cross\"", "steps_every = 16\n"),
            1 => campaign("\"sliver\"", "steps_every = 0\n"),
            _ => campaign("\"corner_corner\", \"size_ratio\", \"edge_cross\"", "steps_every = 24\nsteps = 2\n"),
        };
        write(dir, "campaign.toml", settings.as_bytes())?;
        write(dir, "scene.toml", SCENE.as_bytes())?;
        write(dir, "model.toml", MODEL.as_bytes())
    }

    /// The commands one after the other; each can be resumed.
    pub(crate) fn calls(self) -> Vec<Call> {
        let campaign = || Call::of(["campaign", "campaign.toml", "--threads", "2"]);
        let simulate = |more: &[&str]| {
            let common = ["simulate", "scene.toml", "--out", OUT, "--engine", ["f32", "f64"][self.variant % 2]];
            Call::of(common.iter().chain(more).copied())
        };
        match self.kind {
            Kind::Campaign => vec![campaign().and("--out").and(OUT)],
            Kind::Parts => {
                let part = |n: usize| format!("part{n}");
                let parts = (1..=PARTS)
                    .map(|n| campaign().and("--part").and(&format!("{n}/{PARTS}")).and("--out").and(&part(n)));
                let merge =
                    Call::of(["merge", "--out", OUT].map(str::to_owned).into_iter().chain((1..=PARTS).map(part)));
                parts.chain([merge]).collect()
            }
            Kind::Simulate => {
                let steps = ["60", "45", "80"][self.variant];
                vec![simulate(&["--steps", steps, "--every", "2", "--contacts"])]
            }
            Kind::Lockstep => vec![simulate(&["--steps", "10", "--every", "1", "--lockstep", "--audit"])],
            Kind::Tune => {
                let seed = (self.variant + 1).to_string();
                vec![Call::of([
                    "tune",
                    "model.toml",
                    "--candidates",
                    "6",
                    "--threads",
                    "2",
                    "--seed",
                    &seed,
                    "--out",
                    OUT,
                ])]
            }
        }
    }

    /// What the job leaves when nothing disturbs it; made once.
    pub(crate) fn undisturbed(self, program: &Program, counts: &mut Counts) -> Told<Arc<Undisturbed>> {
        static MADE: Mutex<Option<HashMap<Job, Arc<Undisturbed>>>> = Mutex::new(None);
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let made = made.get_or_insert_with(HashMap::new);
        if let Some(known) = made.get(&self) {
            return Ok(Arc::clone(known));
        }
        let folder = new_folder();
        self.prepare(folder.path())?;
        let (mut took, mut code) = (Vec::new(), 0);
        for call in self.calls() {
            let ended = program.run(folder.path(), &call, Disturbance::None, counts)?;
            ended.has_code(&[0, 1], &format!("{self:?}, undisturbed"))?;
            code = ended.code.unwrap_or(0);
            took.push(ended.took);
        }
        let out = folder.path().join(OUT);
        let sizes: Vec<u64> = all_files(&out, "")?.values().map(|bytes| bytes.len() as u64).collect();
        let (largest, total) = (sizes.iter().copied().max().unwrap_or(0), sizes.iter().sum());
        let undisturbed = Arc::new(Undisturbed { files: comparable(&out)?, took, largest, total, code });
        if undisturbed.files.len() < 3 {
            return Err(format!("{self:?} writes only {:?}", undisturbed.files.keys()));
        }
        made.insert(self, Arc::clone(&undisturbed));
        Ok(undisturbed)
    }
}

impl Undisturbed {
    /// The exit code of its last command.
    pub(crate) fn codes(&self) -> [i32; 2] {
        [0, self.code]
    }

    /// The names of files in a directory that are not as they should be; `[]` where it is the same run.
    pub(crate) fn differences(&self, out: &Path) -> Told<Vec<String>> {
        let found = comparable(out)?;
        let names = self.files.keys().chain(found.keys().filter(|name| !self.files.contains_key(*name)));
        Ok(names.filter(|name| self.files.get(*name) != found.get(*name)).cloned().collect())
    }

    /// That a directory holds the same bytes.
    pub(crate) fn compare(&self, out: &Path, counts: &mut Counts) -> Told<()> {
        counts.comparisons += 1;
        match self.differences(out)? {
            differences if differences.is_empty() => Ok(()),
            differences => Err(format!("not the bytes of an undisturbed run: {}", differences.join(", "))),
        }
    }
}

/// Writes a file of a step.
pub(crate) fn write(dir: &Path, name: &str, bytes: &[u8]) -> Told<()> {
    let path = dir.join(name);
    fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))
}

/// The files of a directory that depend on its settings alone.
fn comparable(out: &Path) -> Told<BTreeMap<String, Vec<u8>>> {
    let mut files = all_files(out, "")?;
    files.retain(|name, _| !OWN.contains(&name.as_str()));
    Ok(files)
}

/// All files of a directory, by their names within it.
pub(crate) fn all_files(dir: &Path, before: &str) -> Told<BTreeMap<String, Vec<u8>>> {
    let mut found = BTreeMap::new();
    let at = |error: std::io::Error| format!("{}: {error}", dir.display());
    for entry in fs::read_dir(dir).map_err(at)? {
        let path = entry.map_err(at)?.path();
        let name = format!("{before}{}", path.file_name().unwrap_or_default().to_string_lossy());
        match path.is_dir() {
            true => found.extend(all_files(&path, &format!("{name}/"))?),
            false => drop(found.insert(name, fs::read(&path).map_err(at)?)),
        }
    }
    Ok(found)
}
