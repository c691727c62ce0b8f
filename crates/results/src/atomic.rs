//! Writing files so that nobody ever sees half of one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes `bytes` to a file beside `path` and renames it to `path`: whoever opens `path`, at whatever moment, and
/// whatever is killed, finds the old file or the new one.
///
/// # Errors
/// Those of the operating system; then the file beside is removed and `path` is as it was.
pub fn write_atomically(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let path = path.as_ref();
    let beside = temporary_path(path)?;
    let written = File::create_new(&beside).and_then(|mut file| {
        file.write_all(bytes.as_ref())?;
        file.sync_all()
    });
    let renamed = written.and_then(|()| fs::rename(&beside, path));
    if renamed.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&beside);
    }
    renamed
}

fn temporary_path(path: &Path) -> io::Result<PathBuf> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
    let mut beside = std::ffi::OsString::from(".");
    beside.push(name);
    beside.push(format!(".{}.{}.tmp", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
    Ok(path.with_file_name(beside))
}

/// The name that a file would have had which a killed process was writing under this one, if it is such a name.
pub(crate) fn unfinished(name: &str) -> Option<&str> {
    let rest = name.strip_prefix('.')?.strip_suffix(".tmp")?;
    let mut parts = rest.rsplitn(3, '.');
    let numbers = [parts.next()?, parts.next()?];
    let name = parts.next().filter(|name| !name.is_empty())?;
    let is_number = |n: &&str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    numbers.iter().all(is_number).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_what_a_kill_leaves() {
        let beside = temporary_path(Path::new("folder/run.json")).expect("a name");
        assert_eq!(beside.file_name().and_then(|name| unfinished(name.to_str()?)), Some("run.json"));
        assert_eq!(unfinished(".blocks_000010.vtu.71.12.tmp"), Some("blocks_000010.vtu"));
        let others = [".run.json", "run.json.71.0.tmp", ".run.json.x.0.tmp", ".0.tmp", ".a...tmp", "..1.2.tmp"];
        assert_eq!(others.map(unfinished), [None; 6]);
    }
}
