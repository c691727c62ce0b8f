//! Reading a file whole that somebody else may have made.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

/// The largest file that is read whole: 1 GiB. The largest that a command writes has some hundred megabytes.
const LARGEST: u64 = 1 << 30;

/// The bytes of a file of at most [`LARGEST`]; a larger one is refused unread.
pub(crate) fn read_whole(file: &Path) -> io::Result<Vec<u8>> {
    read_at_most(file, LARGEST)
}

fn read_at_most(file: &Path, largest: u64) -> io::Result<Vec<u8>> {
    let file = File::open(file)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= largest {
        file.take(largest + 1).read_to_end(&mut bytes)?;
    }
    let found = length.max(bytes.len() as u64);
    if found > largest {
        let text = format!("the file has {found} bytes; at most {largest} are read");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
    }
    Ok(bytes)
}

/// Whether a file has two lines or more. No more of it than a piece is held.
pub(crate) fn has_rows(file: &Path) -> io::Result<bool> {
    let table = BufReader::with_capacity(1 << 16, File::open(file)?);
    let mut ends = table.bytes().filter(|byte| byte.as_ref().map_or(true, |byte| *byte == b'\n'));
    let two = [ends.next().transpose()?, ends.next().transpose()?];
    Ok(two[1].is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Claim, Directory, MANIFEST, Owner, Start};
    use std::collections::BTreeMap;
    use std::fs;

    #[test]
    fn a_file_is_read_up_to_the_limit_and_no_further() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("progress.json");
        fs::write(&file, b"12345").expect("write");
        assert_eq!(read_at_most(&file, 5).expect("read"), b"12345");
        let error = read_at_most(&file, 4).expect_err("too large");
        assert_eq!(error.to_string(), "the file has 5 bytes; at most 4 are read");
    }

    #[test]
    fn rows_are_looked_for_in_pieces() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("steps.csv");
        assert!(has_rows(&file).is_err());
        for (text, rows) in [("a,b", false), ("a,b\n", false), ("a,b\n1,2", false), ("a,b\n1,2\n", true)] {
            fs::write(&file, text).expect("write");
            assert_eq!(has_rows(&file).expect("read"), rows, "{text}");
        }
        fs::write(&file, format!("{}\n{}\n", "a".repeat(1 << 17), "b".repeat(1 << 17))).expect("write");
        assert!(has_rows(&file).expect("read"));
    }

    /// Sparse files: they take no room on the disk of a Unix system.
    #[cfg(unix)]
    #[test]
    fn files_of_gigabytes_are_refused_unread() {
        let dir = tempfile::tempdir().expect("a folder");
        let claim = |start| Directory::claim(Claim { dir: dir.path(), owner: Owner::Campaign, start, files: &[] });
        let mut directory = claim(Start::Fresh).expect("free");
        let large = |name: &str| {
            let file = File::options().write(true).open(dir.path().join(name)).expect("a file");
            file.set_len(5 << 30).expect("a sparse file");
        };
        directory.write_sealed("progress.json", &BTreeMap::from([("a", 1)])).expect("written");
        large("progress.json");
        let error = directory.read_sealed::<serde_json::Value>("progress.json").expect_err("too large").to_string();
        assert!(error.contains("progress.json: the file has 5368709120 bytes; at most 1073741824"), "{error}");
        drop(directory);
        large(MANIFEST);
        let error = claim(Start::Resume).expect_err("too large").to_string();
        assert!(error.contains(MANIFEST) && error.contains("has 5368709120 bytes"), "{error}");
    }
}
