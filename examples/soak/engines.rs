//! Engines that misbehave: the campaign tells it as a finding or refuses the engine, and leaves none running.

use crate::attacks::Attack;
use crate::jobs::{all_files, write};
use crate::program::{Call, Disturbance, Told};
use std::fs;
use std::time::{Duration, Instant};

/// How engines misbehave: tricks of `examples/engine_client`, and programs that are none. `{}` stands for a word by which the process is known
/// afterwards.
const TRICKS: [&str; 9] =
    ["crash", "hang", "malformed", "unsupported", "unstable", "none", "state", "second", "escape"];
const OTHERS: [&str; 7] = [
    "cat",
    "true",
    "/nowhere/engine",
    "yes {}",
    "head -c 100000 /dev/urandom",
    "sh -c 'sleep 600; : {}'",
    "sh -c 'sleep 600 & echo {}; sleep 600'",
];
/// Tricks whose answers depend on the question alone.
const STEADY: [&str; 5] = ["crash", "malformed", "unsupported", "none", "state"];

const SETTINGS: &str = "pairs = 48\nchunk = 8\nfamilies = [\"edge_cross\"]\ntolerances = [\"auto\"]\nmetamorphic_every = 0\n\
                        steps_every = 0\nshrink_evaluations = 2\ncases_per_cause = 2\n";

impl Attack {
    /// A campaign with an engine that misbehaves.
    pub(crate) fn faulty_engine(&mut self) -> Told<()> {
        write(self.folder.path(), "campaign.toml", SETTINGS.as_bytes())?;
        // A word that no other process has in its arguments.
        let mark = format!("soak-{}-{:016x}", std::process::id(), self.dice.bits());
        let trick = *self.dice.one_of(&TRICKS);
        let other = *self.dice.one_of(&OTHERS);
        let is_trick = self.dice.below(3) > 0;
        let command = match is_trick {
            true => format!("'{}' {trick} {mark}", self.program.engine_client.display()),
            false => other.replace("{}", &mark),
        };
        let mut call = Call::of(["campaign", "campaign.toml", "--threads", "2", "--engine-timeout", "0.5"]);
        call = call.and("--engine-command").and(&format!("faulty={command}"));
        if self.dice.once_in(3) {
            call = call.and("--ask-twice");
        }
        let steady = is_trick && STEADY.contains(&trick) && !call.arguments.contains(&"--ask-twice".to_owned());
        let whole = call.clone().and("--out").and("whole");
        let ended = self.run(&whole, Disturbance::None)?;
        ended.has_code(&[0, 2], &format!("an engine that is `{command}`"))?;
        self.counts.faulty_engines += 1;
        if ended.out.contains('\u{1b}') || ended.err.contains('\u{1b}') {
            return Err(format!("an engine that is `{command}` speaks to the terminal"));
        }
        self.none_left(&mark, &command)?;
        if !steady || ended.code != Some(0) {
            return Ok(());
        }
        // Killed in between it comes to the same.
        let parts = call.and("--out").and("parts").and("--resume");
        let after = ended.took.mul_f64(self.dice.below(1000) as f64 / 1000.0);
        let killed = self.run(&parts, Disturbance::Kill(after))?;
        self.counts.kills += u64::from(killed.code.is_none());
        self.run(&parts, Disturbance::None)?.has_code(&[0], &format!("`{command}`, killed and taken up again"))?;
        self.counts.comparisons += 1;
        let tables = |dir: &str| {
            let mut files = all_files(&self.folder.path().join(dir), "")?;
            files.retain(|name, _| name == "findings.csv" || name == "summary.csv" || name.starts_with("cases/"));
            Ok::<_, String>(files)
        };
        match tables("whole")? == tables("parts")? {
            true => Ok(()),
            false => Err(format!("`{command}`: not the bytes of an undisturbed run")),
        }
    }

    /// That no process has `mark` among its arguments any more.
    fn none_left(&self, mark: &str, command: &str) -> Told<()> {
        let begin = Instant::now();
        loop {
            let left = processes_with(mark);
            if left.is_empty() {
                return Ok(());
            }
            if begin.elapsed() > Duration::from_secs(10) {
                return Err(format!("`{command}`: processes {left:?} run on"));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// The processes that have a word among their arguments and have not ended.
fn processes_with(mark: &str) -> Vec<u32> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    let numbers = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    let has = |number: &u32| {
        let arguments = fs::read(format!("/proc/{number}/cmdline")).unwrap_or_default();
        arguments.windows(mark.len()).any(|window| window == mark.as_bytes())
    };
    numbers.filter(has).collect()
}
