//! The wall clock set back and forward between a kill and what goes on after it, and files dated in the past and the future: no byte may depend
//! on either. A library in front of the program's own (`clock.c`) shifts what it is told; that the shift reaches it is shown by the lock of a
//! killed run, which says since when, and by the gate, whose second seed is the day's number.

use crate::attacks::{Attack, ZONES, share_of};
use crate::jobs::{Job, OUT, write};
use crate::program::{Call, Disturbance, Told};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// What the clock is set to, in seconds since 1970, and its date. Most are the last seconds that fit into some number: 32 bits of either kind
/// with a sign, those without, 64 bits of nanoseconds, four digits of a year. None comes to another date while a process runs.
const TIMES: [(i64, &str); 9] = [
    (-2_147_483_650, "1901-12-13"),
    (-3_600, "1969-12-31"),
    (3_600, "1970-01-01"),
    (951_827_696, "2000-02-29"),
    (2_147_483_646, "2038-01-19"),
    (4_107_499_200, "2100-02-28"),
    (4_294_967_294, "2106-02-07"),
    (9_223_372_035, "2262-04-11"),
    (253_402_257_600, "9999-12-31"),
];
/// That of them by which a soak shows at its start that the shift reaches the program.
const SHOWN: (i64, &str) = TIMES[5];

/// A gate that takes its second seed from today's date.
const GATE: &str = "corpus = []\nrotating_pairs = 8\n[campaign]\npairs = 8\nfamilies = [\"edge_cross\"]\n\
                    [[limit]]\ncause = \"defect\"\ncount = 0\n";

/// Makes the library that shifts the clock.
pub(crate) fn build_clock(folder: &Path) -> Told<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/soak/clock.c");
    let library = folder.join("clock.so");
    let made = Command::new("cc").args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(&source).output();
    match made {
        Ok(made) if made.status.success() => Ok(library),
        Ok(made) => Err(format!("{}: {}", source.display(), String::from_utf8_lossy(&made.stderr))),
        Err(error) => Err(format!("cc: {error}; the soak needs a C compiler")),
    }
}

impl Attack {
    /// A call that begins at that time.
    fn begun_at(&self, call: &Call, (seconds, _): (i64, &str)) -> Told<Call> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_err(|error| error.to_string())?;
        let shift = seconds - i64::try_from(now.as_secs()).map_err(|error| error.to_string())?;
        let library = self.program.clock.to_str().ok_or("the folder for temporary files has no name in UTF-8")?;
        let mut call = call.clone();
        call.environment.push(("LD_PRELOAD", Some(library.to_owned())));
        call.environment.push(("SOAK_CLOCK_SHIFT", Some(shift.to_string())));
        Ok(call)
    }

    /// Kills a command that began at a time; whether it was killed. If it had its lock by then, that must say the time.
    fn killed_at(&mut self, call: &Call, time: (i64, &str), after: Duration, codes: &[i32]) -> Told<bool> {
        let lock = self.folder.path().join(call.out()).join(".rockproof.lock");
        let read = || fs::read_to_string(&lock).unwrap_or_default();
        let before = read();
        let call = self.begun_at(call, time)?.and("--resume");
        let ended = self.run(&call, Disturbance::Kill(after))?;
        if ended.code.is_some() {
            ended.has_code(codes, &format!("{} at {}", call.arguments.join(" "), time.1))?;
            return Ok(false);
        }
        self.counts.kills += 1;
        let held = read();
        // It was killed before it had the lock, or had written to it.
        if held == before || held.is_empty() {
            return Ok(true);
        }
        if !held.contains(&format!(", since {} ", time.1)) {
            return Err(format!("the clock is set to {}, and the lock of a killed run says {held:?}", time.1));
        }
        self.counts.clocks_seen += 1;
        Ok(true)
    }

    /// That a shifted clock reaches the program.
    pub(crate) fn clock_is_seen(&mut self) -> Told<()> {
        self.gate_at(SHOWN)
    }

    /// Kills each command of a job some times; each goes on under a clock that was set anew, in the midst of files that were dated anew.
    pub(crate) fn clock(&mut self) -> Told<()> {
        let job = Job::any(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        for (mut call, took) in job.calls().into_iter().zip(&whole.took) {
            call.environment.push(("TZ", Some((*self.dice.one_of(&ZONES)).to_owned())));
            for _ in 0..1 + self.dice.below(3) {
                let (time, after) = (*self.dice.one_of(&TIMES), share_of(*took, &mut self.dice));
                self.counts.clocks += 1;
                let was_killed = self.killed_at(&call, time, after, &whole.codes())?;
                let folder = self.folder.path().to_owned();
                self.date_files(&folder)?;
                if !was_killed {
                    break;
                }
            }
            let time = *self.dice.one_of(&TIMES);
            self.counts.clocks += 1;
            let last = self.begun_at(&call, time)?;
            self.finish(&last, &whole.codes())?;
        }
        if self.dice.once_in(4) {
            let time = *self.dice.one_of(&TIMES);
            self.gate_at(time)?;
        }
        whole.compare(&self.folder.path().join(OUT), &mut self.counts).map_err(|what| format!("{job:?}: {what}"))
    }

    /// Dates every file and folder in the past or the future.
    fn date_files(&mut self, folder: &Path) -> Told<()> {
        let at = |error: std::io::Error| format!("{}: {error}", folder.display());
        for entry in fs::read_dir(folder).map_err(at)? {
            let path = entry.map_err(at)?.path();
            if path.is_dir() {
                self.date_files(&path)?;
            }
            let seconds = self.dice.one_of(&TIMES).0;
            let since = Duration::from_secs(seconds.unsigned_abs());
            let time = if seconds < 0 { UNIX_EPOCH - since } else { UNIX_EPOCH + since };
            let dated = File::open(&path).and_then(|file| file.set_modified(time));
            dated.map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(())
    }

    /// That the gate's second seed is the number of the day that the clock is set to.
    fn gate_at(&mut self, time: (i64, &str)) -> Told<()> {
        write(self.folder.path(), "gate.toml", GATE.as_bytes())?;
        self.counts.clocks += 1;
        let call = self.begun_at(&Call::of(["gate", "gate.toml", "--out", "gate"]), time)?;
        let ended = self.run(&call, Disturbance::None)?;
        let (code, said) = match time.0 {
            ..0 => (2, "the clock is before 1970".to_owned()),
            seconds => (0, format!("the rotating seed is {}\n", seconds / 86_400)),
        };
        ended.has_code(&[code], &format!("a gate on {}", time.1))?;
        if !ended.err.contains(&said) {
            return Err(format!("a gate on {} does not say {said:?}: {}", time.1, ended.err));
        }
        self.counts.clocks_seen += 1;
        Ok(())
    }
}
