//! A reader beneath a reader of CSV, which holds one row at a time: no row is longer than a limit.

use std::io::{self, Read};

/// The longest row of a table that is read: 16 MiB. The longest that the program writes has a few thousand bytes.
pub const LONGEST_ROW: usize = 16 << 20;

/// Passes on the bytes of a table as long as no row is longer than [`LONGEST_ROW`]; the table may be of any length. Rows end where a reader
/// of CSV with commas and double quotes sees their end, so that a quote that stays open counts as one row. Between rows `\r\n` and `\r` become
/// `\n`: a reader of CSV takes the row after `\r\n` to begin in the line before.
#[derive(Debug)]
pub struct BoundedRows<R> {
    inner: R,
    rows: Rows,
}

/// Where in a table its reader is: apart from the reader, so that bytes are looked at by code compiled here, once.
#[derive(Debug)]
struct Rows {
    longest: usize,
    /// Bytes read of this row.
    length: usize,
    /// The line that is read, and the one in which this row began, from 1.
    line: u64,
    begin: u64,
    place: Place,
    /// Whether the last byte was a `\r` between rows.
    after_return: bool,
    /// How many bytes of a byte order mark the table began with, as long as there was nothing else.
    mark: Option<usize>,
}

/// Where in a row the next byte is.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// At the beginning of a field: only there a quote opens.
    Begin,
    /// In a field that is not quoted.
    Plain,
    Quoted,
    /// After a quote in a quoted field: another one is a quote as text, anything else ends the quoted part.
    AfterQuote,
}

/// Readers of CSV skip it.
const MARK: &[u8] = b"\xef\xbb\xbf";

impl<R: Read> BoundedRows<R> {
    /// The rows of a table.
    pub fn new(inner: R) -> BoundedRows<R> {
        BoundedRows::at_most(inner, LONGEST_ROW)
    }

    /// The same with another limit, in bytes.
    pub fn at_most(inner: R, longest: usize) -> BoundedRows<R> {
        let place = Place::Begin;
        let rows = Rows { longest, length: 0, line: 1, begin: 1, place, after_return: false, mark: Some(0) };
        BoundedRows { inner, rows }
    }
}

impl Rows {
    /// Moves the bytes that are passed on to the front, and returns how many they are.
    fn pass_on(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut kept = 0;
        for at in 0..bytes.len() {
            if let Some(byte) = self.passed(bytes[at])? {
                bytes[kept] = byte;
                kept += 1;
            }
        }
        Ok(kept)
    }

    /// What becomes of a byte; nothing of the `\n` of a `\r\n` between rows, whose `\r` has become one.
    fn passed(&mut self, byte: u8) -> io::Result<Option<u8>> {
        let is_second = std::mem::take(&mut self.after_return) && byte == b'\n';
        if is_second {
            return Ok(None);
        }
        self.after_return = byte == b'\r' && !matches!(self.place, Place::Quoted);
        let byte = if self.after_return { b'\n' } else { byte };
        self.pass(byte)?;
        Ok(Some(byte))
    }

    fn pass(&mut self, byte: u8) -> io::Result<()> {
        if let Some(seen) = self.mark.filter(|seen| MARK.get(*seen) == Some(&byte)) {
            self.mark = Some(seen + 1);
            return Ok(());
        }
        self.mark = None;
        self.place = match (self.place, byte) {
            (Place::Quoted, b'"') => Place::AfterQuote,
            (Place::Begin | Place::AfterQuote, b'"') | (Place::Quoted, _) => Place::Quoted,
            (_, b',' | b'\n') => Place::Begin,
            _ => Place::Plain,
        };
        self.line += u64::from(byte == b'\n');
        if matches!((self.place, byte), (Place::Begin, b'\n')) {
            (self.length, self.begin) = (0, self.line);
            return Ok(());
        }
        self.length += 1;
        if self.length > self.longest {
            let Self { begin, longest, .. } = self;
            let text =
                format!("the row that begins in line {begin} has more than {longest} bytes; at most so many are read");
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        Ok(())
    }
}

impl<R: Read> Read for BoundedRows<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let count = self.inner.read(buffer)?;
            let kept = self.rows.pass_on(&mut buffer[..count])?;
            // No byte would mean the end.
            if kept > 0 || count == 0 {
                return Ok(kept);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What comes of a table whose rows may have eight bytes.
    fn read(table: &[u8]) -> Result<(), String> {
        let mut bytes = Vec::new();
        BoundedRows::at_most(table, 8).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        let text = String::from_utf8_lossy(table).replace("\r\n", "\n");
        assert_eq!(String::from_utf8_lossy(&bytes), text);
        Ok(())
    }

    #[test]
    fn rows_begin_in_their_line_whatever_ends_the_one_before() {
        /// A table of which one byte is had at a time.
        struct ByteByByte<'t>(&'t [u8]);
        impl Read for ByteByByte<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let one = buffer.len().min(1);
                self.0.read(&mut buffer[..one])
            }
        }
        let table = "a,b\n1,2\n\"3\r\n\",4\n5,6\n";
        let quoted = "\"3\r\n\"";
        for end in ["\n", "\r\n", "\r"] {
            let table = table.replace(quoted, "Q").replace('\n', end).replace('Q', quoted);
            let mut bytes = Vec::new();
            BoundedRows::new(ByteByByte(table.as_bytes())).read_to_end(&mut bytes).expect("rows");
            assert_eq!(String::from_utf8_lossy(&bytes), "a,b\n1,2\n\"3\r\n\",4\n5,6\n", "{end:?}");
            let mut whole = Vec::new();
            BoundedRows::new(table.as_bytes()).read_to_end(&mut whole).expect("rows");
            assert_eq!(whole, bytes);
        }
    }

    #[test]
    fn tables_of_any_length_are_read() {
        assert_eq!(read(b"\xef\xbb\xbf12345678\n1"), Ok(()));
        for table in [&b"a,b\n1,2\n"[..], b"12345678\r\n\"2\n4\",78\n\xef", b"a\"b,c\"d\n1\n2\n3\n4"] {
            assert_eq!(read(table), Ok(()));
            assert_eq!(read(&[table, b"\n"].concat().repeat(100)), Ok(()));
        }
    }

    #[test]
    fn a_row_is_bounded_however_it_goes_on() {
        for (table, line) in [
            (&b"123456789"[..], 1),
            (b"a,b\n\n1,2,3,4,5\n", 3),
            // Line ends in quotes, after quotes as text, and after a quote that is none since its field began without.
            (b"a\n\"\n\n\n\n\n\n\n\n\"", 2),
            (b"\"\"\"\n\n\n\n\n\n\n\n\"", 1),
            (b"a\"b,\"\n\n\n\n\n\n\n\n", 1),
            (b"\xef\xbb\xbf\"\n\n\n\n\n\n\n\n\n", 1),
        ] {
            let error = read(table).expect_err("too long");
            let text = format!("the row that begins in line {line} has more than 8 bytes; at most so many are read");
            assert_eq!(error, text);
        }
    }
}
