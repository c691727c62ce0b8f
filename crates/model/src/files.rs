//! Reading files that have an end: every file that a user names is read through here.

use crate::bounded_rows::BoundedRows;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// The largest file that is read: 1 GiB. The largest scene of a few thousand blocks takes a hundredth of that.
pub const LARGEST_INPUT: u64 = 1 << 30;

/// The bytes of a file of at most [`LARGEST_INPUT`]. A pipe is read as a file is; a device is refused unread, since it
/// may have no end, and whatever grows while it is read is given up at the limit.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::FileTooLarge`] beyond the limit and
/// [`io::ErrorKind::InvalidInput`] for a device, the limit being named in both.
pub fn read_limited(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    read_at_most(path.as_ref(), LARGEST_INPUT)
}

/// The bytes of a stream, such as stdin, to its end: at most [`LARGEST_INPUT`].
///
/// # Errors
/// Those of the stream; [`io::ErrorKind::FileTooLarge`] beyond the limit, which is named.
pub fn read_stream(stream: impl Read) -> io::Result<Vec<u8>> {
    stream_at_most(stream, LARGEST_INPUT, 0)
}

/// The text of a file of at most [`LARGEST_INPUT`].
///
/// # Errors
/// As [`read_limited`] and [`text_of`].
pub fn read_text(path: impl AsRef<Path>) -> io::Result<String> {
    text_of(read_limited(path)?)
}

/// The mark (U+FEFF in UTF-8) that some editors begin a text with.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// The bytes of a file without the mark that some editors begin a text with.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

/// Whether bytes begin as a text in UTF-16 does: with its mark, or with two letters of ASCII.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [0, a, 0, b, ..] | [a, 0, b, 0, ..] => {
            [a, b].into_iter().all(|c| c.is_ascii_graphic() || c.is_ascii_whitespace())
        }
        _ => false,
    }
}

/// The text that the bytes of a file are, without the mark that some editors begin one with.
///
/// # Errors
/// [`io::ErrorKind::InvalidData`] for bytes that are not UTF-8, with line and byte.
pub fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    let text = String::from_utf8(bytes).map_err(|error| {
        let (at, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
        let line = bytes[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
        let text = format!("line {line}: byte {at} of the file is {:#04x}; a text in UTF-8 is expected", bytes[at]);
        io::Error::new(io::ErrorKind::InvalidData, text)
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Opens a table that is read row by row and may be of any length; its rows are bounded.
///
/// # Errors
/// Those of the operating system; [`io::ErrorKind::InvalidInput`] for a folder, a device or a pipe.
pub fn open_table(path: impl AsRef<Path>) -> io::Result<BoundedRows<File>> {
    refuse_what_is_no_file(&path)?;
    Ok(BoundedRows::new(File::open(path)?))
}

/// Refuses what a directory of results may hold in a file's place: a folder, a device or a pipe, which may have no end.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`]; those of the operating system, also where there is nothing.
pub fn refuse_what_is_no_file(path: impl AsRef<Path>) -> io::Result<()> {
    if fs::metadata(path)?.is_file() {
        return Ok(());
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "this is a folder, a device or a pipe; a file is expected"))
}

fn device() -> io::Error {
    let text = format!("this is a device and may have no end; files of at most {LARGEST_INPUT} bytes are read");
    io::Error::new(io::ErrorKind::InvalidInput, text)
}

fn read_at_most(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let about = file.metadata()?;
    if is_device(&about.file_type()) {
        return Err(device());
    }
    if about.len() > limit {
        return Err(too_large(&about.len().to_string(), limit));
    }
    stream_at_most(file, limit, about.len() as usize)
}

/// `length` is how long the stream says it is.
fn stream_at_most(stream: impl Read, limit: u64, length: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(length);
    stream.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(too_large(&format!("more than {limit}"), limit)) } else { Ok(bytes) }
}

fn too_large(found: &str, limit: u64) -> io::Error {
    let text = format!("the file has {found} bytes; at most {limit} are read, so split it into several files");
    io::Error::new(io::ErrorKind::FileTooLarge, text)
}

#[cfg(unix)]
fn is_device(kind: &fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &fs::FileType) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit_and_no_further() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, b"12345").unwrap();
        assert_eq!(read_at_most(&path, 5).unwrap(), b"12345");
        let error = read_at_most(&path, 4).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("has 5 bytes; at most 4"), "{error}");
        assert_eq!(read_limited(&path).unwrap(), b"12345");
    }

    #[test]
    fn a_file_beyond_the_limit_is_refused_unread() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sparse.dda");
        // Sparse: it takes no room on the disk.
        File::create(&path).unwrap().set_len(LARGEST_INPUT + 1).unwrap();
        let error = crate::Scene::load(&path).unwrap_err().to_string();
        assert!(
            error.contains("sparse.dda") && error.contains("1073741825") && error.contains("1073741824"),
            "{error}"
        );
    }

    #[test]
    fn a_stream_without_an_end_is_given_up_at_the_limit() {
        assert_eq!(stream_at_most(&b"12345"[..], 5, 0).unwrap(), b"12345");
        let error = stream_at_most(io::repeat(0), 5, 0).unwrap_err();
        assert!(error.kind() == io::ErrorKind::FileTooLarge && error.to_string().contains("at most 5"), "{error}");
    }

    /// What says it is empty and is not, as files of the system do, is given up at the limit.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_that_hides_its_length_is_limited() {
        assert_eq!(fs::metadata("/proc/self/maps").unwrap().len(), 0);
        let error = read_at_most(Path::new("/proc/self/maps"), 10).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("more than 10"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_an_endless_device_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let zeros = folder.path().join("zeros.toml");
        std::os::unix::fs::symlink("/dev/zero", &zeros).unwrap();
        for error in [crate::Scene::load(&zeros).unwrap_err(), crate::ToleranceSpec::load(&zeros).unwrap_err()] {
            let text = error.to_string();
            assert!(text.contains("zeros.toml") && text.contains("device") && text.contains("1073741824"), "{text}");
        }
        // Named by a scene.
        std::os::unix::fs::symlink("/dev/zero", folder.path().join("zeros.dda")).unwrap();
        let scene = folder.path().join("scene.toml");
        fs::write(&scene, "[[block]]\nfile = \"zeros.dda\"\n").unwrap();
        let text = crate::Scene::load(&scene).unwrap_err().to_string();
        assert!(text.contains("zeros.dda") && text.contains("device"), "{text}");
    }
}
