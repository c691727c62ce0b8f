//! Work disturbed and taken up again: afterwards every file holds the bytes of a run that was never disturbed.

use crate::counts::Counts;
use crate::jobs::{Job, OUT, all_files, write};
use crate::program::{Call, Disturbance, Ended, Program, Told};
use crate::tmpfs::Tmpfs;
use rockproof_fuzz::{Dice, mutated, new_folder};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::time::Duration;

/// An attack in a folder of its own.
pub(crate) struct Attack {
    pub(crate) program: Program,
    pub(crate) dice: Dice,
    pub(crate) counts: Counts,
    pub(crate) folder: tempfile::TempDir,
}

/// Time zones: the ends of the day, one of half an hour, and none.
pub(crate) const ZONES: [&str; 6] = ["UTC", "Pacific/Kiritimati", "America/St_Johns", "Asia/Kathmandu", "no/zone", ""];

/// A share of a time, as the dice fall.
pub(crate) fn share_of(time: Duration, dice: &mut Dice) -> Duration {
    time.mul_f64(dice.below(1_000) as f64 / 1_000.0)
}

impl Attack {
    pub(crate) fn new(program: &Program, dice: Dice) -> Attack {
        Attack { program: program.clone(), dice, counts: Counts::default(), folder: new_folder() }
    }

    pub(crate) fn run(&mut self, call: &Call, disturbance: Disturbance) -> Told<Ended> {
        self.program.run(self.folder.path(), call, disturbance, &mut self.counts)
    }

    /// Goes on with a command to its end.
    pub(crate) fn finish(&mut self, call: &Call, codes: &[i32]) -> Told<()> {
        let call = call.clone().and("--resume");
        self.run(&call, Disturbance::None)?.has_code(codes, &call.arguments.join(" "))
    }

    /// Kills each command of a job some times, and goes on after each kill.
    pub(crate) fn kills(&mut self) -> Told<()> {
        self.stopped_midway(|dice, took| Disturbance::Kill(share_of(took, dice)))
    }

    /// Asks each command of a job to end, some times.
    pub(crate) fn interruptions(&mut self) -> Told<()> {
        let signals = ["INT", "TERM", "HUP"];
        self.stopped_midway(|dice, took| Disturbance::Signal(signals[dice.below(3)], share_of(took, dice)))
    }

    fn stopped_midway(&mut self, disturbance: impl Fn(&mut Dice, Duration) -> Disturbance) -> Told<()> {
        let job = Job::any(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        for (call, took) in job.calls().iter().zip(&whole.took) {
            let again = call.clone().and("--resume");
            for _ in 0..2 + self.dice.below(4) {
                let how = disturbance(&mut self.dice, *took);
                let ended = self.run(&again, how)?;
                match how {
                    Disturbance::Kill(_) if ended.code.is_none() => self.counts.kills += 1,
                    // Before it listens, a signal ends it as any program.
                    Disturbance::Signal(..) if ended.disturbed && ended.code.is_none_or(|code| code == 130) => {
                        self.counts.interruptions += 1;
                    }
                    // It came to its end before.
                    _ => {
                        ended.has_code(&whole.codes(), &format!("{job:?} before a disturbance"))?;
                        break;
                    }
                }
            }
            self.finish(call, &whole.codes())?;
        }
        whole.compare(&self.folder.path().join(OUT), &mut self.counts).map_err(|what| format!("{job:?}: {what}"))
    }

    /// That a command ended well, or failed to write and says where; whether it failed.
    fn failed_to_write(ended: &Ended, codes: [i32; 2], job: Job) -> Told<bool> {
        if ended.code != Some(2) {
            ended.has_code(&codes, &format!("{job:?} without room"))?;
            return Ok(false);
        }
        let named = ended.err.contains(&format!("{OUT}/")) || ended.err.contains(&format!("{OUT}:"));
        let parts = (1..=3).any(|n| ended.err.contains(&format!("part{n}")));
        if named || parts {
            Ok(true)
        } else {
            Err(format!("{job:?}: a failed write that names no file: {}", ended.err))
        }
    }

    /// No file can grow beyond a limit.
    pub(crate) fn limited_files(&mut self) -> Told<()> {
        let job = Job::any(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        for call in &job.calls() {
            let blocks = self.dice.below((whole.largest / 512) as usize + 2) as u64;
            let ended = self.run(&call.clone().and("--resume"), Disturbance::LimitedFiles(blocks))?;
            let failed = Attack::failed_to_write(&ended, whole.codes(), job)?;
            self.counts.limited_files += u64::from(failed);
            self.finish(call, &whole.codes())?;
        }
        whole.compare(&self.folder.path().join(OUT), &mut self.counts).map_err(|what| format!("{job:?}: {what}"))
    }

    /// The disk is full, then has room. Where no disk may be mounted nothing is done.
    pub(crate) fn full_disk(&mut self) -> Told<()> {
        let job = Job::any_single(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        let room = 4 * (1 + self.dice.below(whole.total as usize / 4096 + whole.files.len() + 4) as u64);
        let out = self.folder.path().join(OUT);
        let Some(disk) = Tmpfs::mount(&out, room) else { return Ok(()) };
        for call in &job.calls() {
            let ended = self.run(&call.clone().and("--resume"), Disturbance::None)?;
            let failed = Attack::failed_to_write(&ended, whole.codes(), job)?;
            self.counts.full_disks += u64::from(failed);
            disk.remount("size=256m")?;
            self.finish(call, &whole.codes())?;
        }
        whole.compare(&out, &mut self.counts).map_err(|what| format!("{job:?} on a disk of {room} KiB: {what}"))
    }

    /// The directory cannot be written for a while, in the middle of the work.
    pub(crate) fn read_only(&mut self) -> Told<()> {
        let job = Job::any_single(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        let out = self.folder.path().join(OUT);
        let disk = Tmpfs::mount(&out, 1 << 18);
        for (call, took) in job.calls().iter().zip(&whole.took) {
            let again = call.clone().and("--resume");
            let disturbance = Disturbance::Kill(share_of(*took, &mut self.dice));
            let killed = self.run(&again, disturbance)?.disturbed;
            self.counts.kills += u64::from(killed);
            fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
            let before = all_files(&out, "")?;
            set_writable(&out, disk.as_ref(), false)?;
            let ended = self.run(&again, Disturbance::None);
            set_writable(&out, disk.as_ref(), true)?;
            // Permissions do not keep root from writing.
            if Attack::failed_to_write(&ended?, whole.codes(), job)? {
                self.counts.read_only += 1;
                // Files that are there may still grow where permissions alone forbid new ones.
                if disk.is_some() && all_files(&out, "")? != before {
                    return Err(format!("{job:?}: a read-only directory has changed"));
                }
            } else if disk.is_some() {
                return Err(format!("{job:?}: it ran in a read-only directory"));
            }
            self.finish(call, &whole.codes())?;
        }
        whole.compare(&out, &mut self.counts).map_err(|what| format!("{job:?}: {what}"))
    }

    /// Another time zone, another language, another home, another number of threads.
    pub(crate) fn environment(&mut self) -> Told<()> {
        let job = Job::any(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        let languages =
            ["C", "POSIX", "C.UTF-8", "de_DE.UTF-8", "tr_TR.UTF-8", "ar_EG.UTF-8", "ja_JP.eucJP", "no-language"];
        for mut call in job.calls() {
            let environment = [
                ("TZ", Some(*self.dice.one_of(&ZONES))),
                ("LC_ALL", Some(*self.dice.one_of(&languages))),
                ("LANG", Some(*self.dice.one_of(&languages))),
                ("COLUMNS", Some(*self.dice.one_of(&["1", "80", "100000", "none"]))),
                ("RAYON_NUM_THREADS", Some(*self.dice.one_of(&["1", "2", "3", "0"]))),
                ("HOME", *self.dice.one_of(&[None, Some("/nowhere")])),
                ("TERM", *self.dice.one_of(&[None, Some("dumb"), Some("xterm-256color")])),
            ];
            call.environment = environment.map(|(name, value)| (name, value.map(str::to_owned))).to_vec();
            self.run(&call, Disturbance::None)?.has_code(&whole.codes(), &format!("{:?}", call.environment))?;
        }
        self.counts.environments += 1;
        whole.compare(&self.folder.path().join(OUT), &mut self.counts).map_err(|what| format!("{job:?}: {what}"))
    }

    /// One file of a run that was killed, or has ended, is damaged. Going on is refused, or comes to the right bytes in everything else.
    pub(crate) fn damage(&mut self) -> Told<()> {
        let job = Job::any(&mut self.dice);
        let whole = job.undisturbed(&self.program, &mut self.counts)?;
        job.prepare(self.folder.path())?;
        let calls = job.calls();
        // Which command's directory is damaged.
        let number = self.dice.below(calls.len());
        for (k, call) in calls.iter().enumerate().take(number + 1) {
            let how = match self.dice.below(2) {
                0 if k == number => Disturbance::Kill(share_of(whole.took[k], &mut self.dice)),
                _ => Disturbance::None,
            };
            let ended = self.run(&call.clone().and("--resume"), how)?;
            self.counts.kills += u64::from(ended.disturbed && ended.code.is_none());
        }
        let dir = calls[number].out().to_owned();
        let path = self.folder.path().join(&dir);
        if !path.is_dir() {
            // It was killed before it began.
            return Ok(());
        }
        let Some((name, how)) = self.damage_one(&path)? else { return Ok(()) };
        let about = format!("{job:?}: {dir}/{name} {how}");
        for call in &calls[number..] {
            let ended = self.run(&call.clone().and("--resume"), Disturbance::None)?;
            if ended.code == Some(2) {
                let says = ended.err.contains(&dir) || ended.err.contains(&name);
                self.counts.damages_refused += 1;
                return if says { Ok(()) } else { Err(format!("{about}: refused without a name: {}", ended.err)) };
            }
            ended.has_code(&whole.codes(), &about)?;
        }
        self.counts.damages_harmless += 1;
        self.counts.comparisons += 1;
        let differences = whole.differences(&self.folder.path().join(OUT))?;
        // What was written before and nothing goes on from stays as damaged as it is, and nothing else is touched by it.
        let left = differences.iter().filter(|other| dir != OUT || **other != name || is_gone_on_from(&name));
        let left: Vec<&str> = left.map(String::as_str).collect();
        if left.is_empty() { Ok(()) } else { Err(format!("{about} was believed: {} differ", left.join(", "))) }
    }

    /// Damages a file of a directory; which, and how. None where there is none.
    fn damage_one(&mut self, dir: &Path) -> Told<Option<(String, &'static str)>> {
        let files: Vec<(String, Vec<u8>)> = all_files(dir, "")?.into_iter().collect();
        if files.is_empty() {
            return Ok(None);
        }
        // What a run goes on from as often as all else together.
        let sealed: Vec<_> = files.iter().filter(|(name, _)| is_gone_on_from(name)).collect();
        let (name, bytes) = match self.dice.once_in(2) && !sealed.is_empty() {
            true => *self.dice.one_of(&sealed),
            false => self.dice.one_of(&files),
        };
        let other = &self.dice.one_of(&files).1;
        let how = match self.dice.below(6) {
            0 => {
                fs::remove_file(dir.join(name)).map_err(|error| error.to_string())?;
                return Ok(Some((name.clone(), "removed")));
            }
            1 => ("exchanged", other.clone()),
            2 => ("cut off", bytes[..self.dice.below(bytes.len())].to_vec()),
            3 => ("zeros", vec![0; bytes.len()]),
            _ => ("changed", mutated(bytes, other, &mut self.dice)),
        };
        write(dir, name, &how.1)?;
        Ok(Some((name.clone(), how.0)))
    }
}

/// Lets a directory be written or not: by its disk, or where none could be mounted by its permissions.
fn set_writable(dir: &Path, disk: Option<&Tmpfs>, writable: bool) -> Told<()> {
    match disk {
        Some(disk) => disk.remount(if writable { "rw" } else { "ro" }),
        None => {
            let permissions = fs::Permissions::from_mode(if writable { 0o755 } else { 0o555 });
            fs::set_permissions(dir, permissions).map_err(|error| format!("{}: {error}", dir.display()))
        }
    }
}

/// Whether a run goes on from a file: then it must be as it was written. Of a finished table the same is asked.
fn is_gone_on_from(name: &str) -> bool {
    let files = [
        "rockproof.manifest.json",
        "progress.json",
        "findings.csv",
        "step_findings.csv",
        "no_case.csv",
        "checkpoint.jsonl",
        "steps.csv",
        "measured.csv",
        "contacts.csv",
        "lockstep.csv",
        "differences.csv",
        "tune.json",
        "candidates.csv",
    ];
    files.contains(&name)
}
