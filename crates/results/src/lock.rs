//! One process at a time in a directory.

use super::error::ResultsError;
use super::manifest::Owner;
use super::unprotected::notify;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The file that is locked; it is there while somebody works in the directory, and after a kill.
const LOCK: &str = ".rockproof.lock";
/// What it begins with; it goes on with the process that holds it.
const FIRST: &str = "locked by ";

/// So many bytes of it are read; what we write there is shorter.
const LONGEST: u64 = 4096;

/// How long a holder may take to write itself into the file after it has locked it, and how often that is looked for.
const NAMING: Duration = Duration::from_secs(1);
const LOOK: Duration = Duration::from_millis(10);

/// An advisory lock on a directory, given up when it is dropped. The operating system gives it up for a process that was killed.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Takes the lock. On a file system without locks there is none to take: better unprotected, and told, than not at all.
    pub(crate) fn take(dir: &Path, owner: Owner) -> Result<Lock, ResultsError> {
        let (lock, protects) = Lock::take_by(File::try_lock, dir, owner, NAMING)?;
        if !protects {
            notify(dir);
        }
        Ok(lock)
    }

    /// The same by a function that tries to lock a file, waiting so long for a holder to write itself into it; whether the lock protects.
    fn take_by(
        try_lock: impl Fn(&File) -> Result<(), TryLockError>,
        dir: &Path,
        owner: Owner,
        naming: Duration,
    ) -> Result<(Lock, bool), ResultsError> {
        let path = dir.join(LOCK);
        let at = || ResultsError::at(&path);
        let begin = Instant::now();
        loop {
            ResultsError::refuse_link(&path)?;
            // A pipe would be waited for.
            if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
                return Err(ResultsError::Foreign { file: path, owner });
            }
            let mut file =
                OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(at())?;
            let attempt = Attempt::of(try_lock(&file)).map_err(at())?;
            let mut text = Vec::new();
            let read = (&mut file).take(LONGEST).read_to_end(&mut text);
            let held = String::from_utf8_lossy(&text);
            if attempt == Attempt::Held {
                // On Windows what another process has locked cannot be read: there is nothing to wait for.
                if read.is_ok() && !held.starts_with(FIRST) && begin.elapsed() < naming {
                    thread::sleep(LOOK);
                    continue;
                }
                let holder = held.strip_prefix(FIRST).map_or("another process", |held| held.trim_end());
                return Err(ResultsError::InUse { dir: dir.to_owned(), holder: holder.to_owned() });
            }
            read.map_err(at())?;
            if !held.is_empty() && !held.starts_with(FIRST) {
                return Err(ResultsError::Foreign { file: path, owner });
            }
            let holder = holder();
            let written = file.set_len(0).and_then(|()| file.rewind()).and_then(|()| file.write_all(holder.as_bytes()));
            written.map_err(at())?;
            // Whoever held the lock may have removed the file after we opened it: then this is not the file that others would lock.
            let locked = file.try_clone().and_then(same_file::Handle::from_file).map_err(at())?;
            match same_file::Handle::from_path(&path) {
                Ok(found) if found == locked => return Ok((Lock { path, _file: file }, attempt == Attempt::Taken)),
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(at()(error)),
                _ => {}
            }
        }
    }
}

/// What trying to lock a file came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attempt {
    Taken,
    /// Another process has it.
    Held,
    /// The file system has no locks.
    Unsupported,
}

impl Attempt {
    fn of(tried: Result<(), TryLockError>) -> io::Result<Attempt> {
        match tried {
            Ok(()) => Ok(Attempt::Taken),
            Err(TryLockError::WouldBlock) => Ok(Attempt::Held),
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(Attempt::Unsupported),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked. A file that stays is no harm: its lock is gone.
        let _ = fs::remove_file(&self.path);
    }
}

/// This process: number, command, since when. Two locks of one process differ in the last number.
fn holder() -> String {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let command: Vec<String> = std::env::args().collect();
    let shown: String = command.join(" ").chars().filter(|c| !c.is_control()).take(200).collect();
    let count = COUNTER.fetch_add(1, Ordering::Relaxed);
    format!(
        "{FIRST}process {} ({shown}), since {}, lock {count}\n",
        std::process::id(),
        utc(seconds_since_1970(SystemTime::now()))
    )
}

/// Whole seconds since 1970; negative where a clock is set to before.
fn seconds_since_1970(time: SystemTime) -> i64 {
    let whole = |seconds: u128| i64::try_from(seconds).unwrap_or(i64::MAX);
    match time.duration_since(UNIX_EPOCH) {
        Ok(since) => whole(since.as_secs().into()),
        Err(before) => -whole(before.duration().as_nanos().div_ceil(1_000_000_000)),
    }
}

/// A time in seconds since 1970 as date and time of day.
fn utc(seconds: i64) -> String {
    let (days, rest) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    // Days from civil, inverted (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms", 2013): years begin in March.
    let days = days + 719_468;
    let (era, day_of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = 400 * era + year_of_era + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02} UTC", rest / 3600, rest / 60 % 60, rest % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_and_the_holder_is_named() {
        let dir = tempfile::tempdir().expect("a folder");
        let lock = Lock::take(dir.path(), Owner::Campaign).expect("free");
        let error = Lock::take(dir.path(), Owner::Campaign).expect_err("held").to_string();
        assert!(error.contains(&format!("process {}", std::process::id())) && error.contains("UTC"), "{error}");
        drop(lock);
        assert!(!dir.path().join(LOCK).exists());
        // What a kill leaves is no lock.
        fs::write(dir.path().join(LOCK), format!("{FIRST}process 1 (rockproof), since then")).expect("write");
        drop(Lock::take(dir.path(), Owner::Campaign).expect("free"));
        fs::write(dir.path().join(LOCK), "mine").expect("write");
        assert!(matches!(Lock::take(dir.path(), Owner::Campaign), Err(ResultsError::Foreign { .. })));
        assert_eq!(fs::read(dir.path().join(LOCK)).expect("read"), b"mine");
    }

    #[test]
    fn a_holder_that_has_not_written_itself_yet_is_named() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join(LOCK);
        let mut file = File::create(&path).expect("a file");
        file.try_lock().expect("free");
        let refused = || Lock::take(dir.path(), Owner::Campaign).expect_err("held").to_string();
        let error = thread::scope(|scope| {
            let error = scope.spawn(refused);
            thread::sleep(Duration::from_millis(100));
            file.write_all(format!("{FIRST}process 7 (rockproof), since now\n").as_bytes()).expect("written");
            error.join().expect("no panic")
        });
        assert!(error.contains("in use by process 7 (rockproof), since now;"), "{error}");
        // One that never does is given up after a while.
        file.set_len(0).expect("emptied");
        let (begin, while_long) = (Instant::now(), Duration::from_millis(50));
        let error = Lock::take_by(File::try_lock, dir.path(), Owner::Campaign, while_long).expect_err("held");
        assert!(error.to_string().contains("in use by another process;"), "{error}");
        assert!((while_long..NAMING).contains(&begin.elapsed()), "{:?}", begin.elapsed());
    }

    #[test]
    fn a_file_system_without_locks_is_no_obstacle_and_does_not_protect() {
        let dir = tempfile::tempdir().expect("a folder");
        let by = |kind: ErrorKind| {
            let fails = move |_: &File| Err(TryLockError::Error(kind.into()));
            Lock::take_by(fails, dir.path(), Owner::Campaign, NAMING)
                .map(|(lock, protects)| (lock.path.exists(), protects))
        };
        assert_eq!(by(ErrorKind::Unsupported).expect("no obstacle"), (true, false));
        assert!(matches!(by(ErrorKind::PermissionDenied), Err(ResultsError::Io { .. })));
        let (lock, protects) = Lock::take_by(File::try_lock, dir.path(), Owner::Campaign, NAMING).expect("free");
        assert!(protects && lock.path.exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_lock_that_is_a_link_or_no_file_is_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let (results, theirs) = (dir.path().join("run"), dir.path().join("theirs"));
        fs::create_dir(&results).expect("a folder");
        std::os::unix::fs::symlink(&theirs, results.join(LOCK)).expect("a link");
        for _ in 0..2 {
            let error = Lock::take(&results, Owner::Campaign).expect_err("a link");
            assert!(matches!(&error, ResultsError::Link { file } if file.ends_with(LOCK)), "{error}");
            // Once where it leads nowhere, and once to an empty file.
            assert!(fs::read(&theirs).map_or(true, |bytes| bytes.is_empty()));
            fs::write(&theirs, "").expect("written");
        }
        let other = dir.path().join("other");
        fs::create_dir_all(other.join(LOCK)).expect("a folder");
        assert!(matches!(Lock::take(&other, Owner::Campaign), Err(ResultsError::Foreign { .. })));
    }

    #[test]
    fn many_threads_never_hold_it_together() {
        let dir = tempfile::tempdir().expect("a folder");
        let inside = AtomicU64::new(0);
        let work = || {
            for _ in 0..200 {
                if let Ok(lock) = Lock::take(dir.path(), Owner::Tune) {
                    assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                    inside.fetch_sub(1, Ordering::SeqCst);
                    drop(lock);
                }
            }
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(work))));
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(utc(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(utc(951_827_696), "2000-02-29 12:34:56 UTC");
        assert_eq!(utc(4_107_542_399), "2100-02-28 23:59:59 UTC");
        // A clock may be set to before 1970.
        let before = |seconds: f64| utc(seconds_since_1970(UNIX_EPOCH - Duration::from_secs_f64(seconds)));
        assert_eq!(before(0.5), "1969-12-31 23:59:59 UTC");
        assert_eq!(before(2_147_483_648.0), "1901-12-13 20:45:52 UTC");
        assert_eq!(utc(-70_000_000_000), "-249-10-15 19:33:20 UTC");
    }
}
