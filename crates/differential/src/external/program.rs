//! Which program an engine is, by what is in its file: a run that goes on later may meet another one under the same command.

use rockproof_results::digest;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// The longest file that is read, in bytes; of a longer one size and time tell.
const LONGEST: u64 = 1 << 26;

/// A digest of the program's file and of the first file among its arguments, which is what an interpreter runs. `None` where the program is not found:
/// starting it says more.
pub(super) fn program_digest(command: &[String]) -> Option<String> {
    let (program, arguments) = command.split_first()?;
    let script = arguments.iter().map(Path::new).find(|argument| argument.is_file());
    let files = [Some(found(program)?), script.map(Path::to_owned)];
    let contents: Option<Vec<String>> = files.iter().flatten().map(|file| content(file)).collect();
    Some(digest(contents?.join("\n").as_bytes()))
}

/// The file of a program, as the system finds it.
fn found(program: &str) -> Option<PathBuf> {
    if program.contains('/') {
        return Some(PathBuf::from(program)).filter(|file| file.is_file());
    }
    let path = env::var_os("PATH")?;
    env::split_paths(&path).map(|folder| folder.join(program)).find(|file| file.is_file())
}

fn content(file: &Path) -> Option<String> {
    let known = fs::metadata(file).ok()?;
    if known.len() <= LONGEST {
        return Some(digest(&fs::read(file).ok()?));
    }
    let changed = known.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some(format!("{} bytes, {} ns", known.len(), changed.as_nanos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_another_one_when_its_file_or_its_script_changes() {
        let dir = tempfile::tempdir().expect("a folder");
        let script = dir.path().join("client.py");
        let told = |text: &str| {
            fs::write(&script, text).expect("written");
            let path = script.to_string_lossy().into_owned();
            let direct = program_digest(std::slice::from_ref(&path)).expect("a file");
            let run = program_digest(&["sh".to_owned(), "-u".to_owned(), path]).expect("a file");
            [direct, run]
        };
        let (one, other) = (told("one"), told("other"));
        assert!(one[0] != other[0] && one[1] != other[1] && one[0] != one[1], "{one:?} {other:?}");
        assert_eq!(told("one"), one);
        assert_eq!(program_digest(&["no/such/program".to_owned()]), None);
        // Nothing is known of what a shell is told to do.
        let shell = |words: &str| program_digest(&["sh".to_owned(), "-c".to_owned(), words.to_owned()]);
        assert_eq!(shell("./client"), shell("./other"));
    }
}
