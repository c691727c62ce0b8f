//! A program's three streams, carried without threads: what is not asked for is not read, so a program that writes without end fills its
//! pipe and not our memory; and what it leaves behind holds neither a thread nor a descriptor of ours.

use super::LONGEST_ANSWER;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{Errno, ioctl_fionbio};
use std::io::{self, ErrorKind, Read, Write};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout};
use std::time::Duration;

/// How much of what a program writes to stderr is kept, in bytes.
const KEPT_STDERR: usize = 2048;

/// How much is read at once, in bytes: what a pipe holds on Linux.
const CHUNK: usize = 1 << 16;

/// So many chunks of stderr are read at most of a program that has ended; what it started may write for ever.
const LAST_CHUNKS: usize = 16;

/// What a look at the streams brought.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum PipeEvent {
    /// A line, without its end.
    Line(Vec<u8>),
    /// More than [`LONGEST_ANSWER`] bytes without the end of a line.
    TooLong,
    /// Bytes without the end of a line.
    Part,
    /// The end of stdout.
    End,
    /// Nothing yet.
    Nothing,
}

/// The streams of a program.
#[derive(Debug)]
pub(super) struct Pipes {
    /// `None` once it is closed.
    stdin: Option<ChildStdin>,
    stdout: ChildStdout,
    stderr: Option<ChildStderr>,
    /// What is still to be written, and how much of it is.
    unsent: (Vec<u8>, usize),
    /// What was read of stdout and belongs to no answer yet.
    read: Vec<u8>,
    /// The end of what came on stderr.
    tail: Vec<u8>,
}

impl Pipes {
    /// The streams of a child that was started with all three.
    pub(super) fn of(child: &mut Child) -> io::Result<Pipes> {
        let all = child.stdin.take().zip(child.stdout.take()).zip(child.stderr.take());
        let Some(((stdin, stdout), stderr)) = all else { return Err(io::Error::other("it has no streams")) };
        ioctl_fionbio(&stdin, true)?;
        ioctl_fionbio(&stdout, true)?;
        ioctl_fionbio(&stderr, true)?;
        let (unsent, read, tail) = Default::default();
        Ok(Pipes { stdin: Some(stdin), stdout, stderr: Some(stderr), unsent, read, tail })
    }

    /// Takes what is to be written; [`Pipes::poll`] writes it.
    pub(super) fn send(&mut self, bytes: Vec<u8>) {
        self.unsent = (bytes, 0);
    }

    /// Closes stdin, which tells a program to end.
    pub(super) fn close_stdin(&mut self) {
        self.stdin = None;
    }

    /// Whether there is output that belongs to no answer.
    pub(super) fn has_unread(&mut self) -> bool {
        if self.read.is_empty() {
            // An error shows again, and is told, at the next look.
            let _ = self.read_chunk();
        }
        !self.read.is_empty()
    }

    /// The output that belongs to no answer, as far as it was read.
    pub(super) fn unread(&self) -> &[u8] {
        &self.read
    }

    /// Waits until something happens, for so long at most: writes what is unsent, and reads a line of stdout and whatever is on stderr.
    pub(super) fn poll(&mut self, patience: Duration) -> io::Result<PipeEvent> {
        let writing = self.stdin.as_ref().filter(|_| self.unsent.1 < self.unsent.0.len());
        let mut watched = vec![PollFd::new(&self.stdout, PollFlags::IN)];
        watched.extend(self.stderr.as_ref().map(|stderr| PollFd::new(stderr, PollFlags::IN)));
        watched.extend(writing.map(|stdin| PollFd::new(stdin, PollFlags::OUT)));
        wait(&mut watched, patience)?;
        let stirred = !watched[0].revents().is_empty();
        self.write_some();
        self.listen();
        if !stirred {
            return Ok(PipeEvent::Nothing);
        }
        let known = self.read.len();
        match self.read_chunk()? {
            Some(0) => return Ok(PipeEvent::End),
            Some(_) => {}
            None => return Ok(PipeEvent::Nothing),
        }
        match self.read[known..].iter().position(|byte| *byte == b'\n') {
            Some(at) => {
                let rest = self.read.split_off(known + at + 1);
                let mut line = std::mem::replace(&mut self.read, rest);
                line.pop();
                Ok(PipeEvent::Line(line))
            }
            None if self.read.len() >= LONGEST_ANSWER => Ok(PipeEvent::TooLong),
            None => Ok(PipeEvent::Part),
        }
    }

    /// The last line on stderr that is not blank, of a program that has ended.
    pub(super) fn last_words(&mut self) -> Option<String> {
        for _ in 0..LAST_CHUNKS {
            if !self.listen() {
                break;
            }
        }
        let text = String::from_utf8_lossy(&self.tail);
        text.lines().rev().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
    }

    /// Reads a chunk of stdout: how many bytes, or `None` where there are none yet.
    fn read_chunk(&mut self) -> io::Result<Option<usize>> {
        let known = self.read.len();
        self.read.resize(known + CHUNK, 0);
        let count = some(self.stdout.read(&mut self.read[known..]));
        self.read.truncate(known + count.as_ref().map_or(0, |count| count.unwrap_or(0)));
        count
    }

    /// Writes as much as the pipe takes. A program that closed its stdin is not told anything more; the look at stdout says what became of it.
    fn write_some(&mut self) {
        let (Some(stdin), (bytes, sent)) = (&mut self.stdin, &mut self.unsent) else { return };
        while *sent < bytes.len() {
            match some(stdin.write(&bytes[*sent..])) {
                Ok(Some(count)) => *sent += count,
                Ok(None) => return,
                Err(_) => {
                    self.stdin = None;
                    return;
                }
            }
        }
    }

    /// Reads a chunk of stderr; whether there was one.
    fn listen(&mut self) -> bool {
        let Some(stderr) = &mut self.stderr else { return false };
        let mut chunk = [0; CHUNK];
        match some(stderr.read(&mut chunk)) {
            Ok(Some(0)) | Err(_) => {
                self.stderr = None;
                false
            }
            Ok(None) => false,
            Ok(Some(count)) => {
                self.tail.extend_from_slice(&chunk[..count]);
                let surplus = self.tail.len().saturating_sub(KEPT_STDERR);
                self.tail.drain(..surplus);
                true
            }
        }
    }
}

/// Waits for one of the streams.
fn wait(watched: &mut [PollFd<'_>], patience: Duration) -> io::Result<()> {
    let patience = Timespec::try_from(patience).map_err(io::Error::other)?;
    match poll(watched, Some(&patience)) {
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// What a stream that does not wait gave or took; `None` where it would have waited.
fn some(result: io::Result<usize>) -> io::Result<Option<usize>> {
    match result {
        Ok(count) => Ok(Some(count)),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
        Err(error) => Err(error),
    }
}
