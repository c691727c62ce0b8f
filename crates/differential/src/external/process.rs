//! One running program that answers questions, a line each. Whatever it does, asking comes back within the time allowed, and what is kept
//! of its output is bounded.

use super::group::Group;
use super::pipes::{PipeEvent, Pipes};
use rockproof_model::text::excerpt;
use rustix::io::Errno;
use std::io;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// How long a program may take to end once its stdin is closed.
const FAREWELL: Duration = Duration::from_millis(300);

/// How often a program that does not answer is looked at: it may have ended while something that it started holds its pipes.
const LOOK: Duration = Duration::from_millis(20);

/// How long a program that gave no answer may take to say more, which nobody asked for.
const MORE: Duration = Duration::from_millis(250);

/// So many characters of a program's last words are told.
const WORDS: usize = 200;

/// Why a question got no line in answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoAnswer {
    /// The program could not be started.
    NotStarted(String),
    /// The program could not be started, for want of something that this process or its system has no more of.
    Shortage(String),
    /// The program ended; how, and the last line it wrote to stderr.
    Ended(String),
    /// No line came in time.
    TimedOut,
    /// The line was longer than [`LONGEST_ANSWER`](super::LONGEST_ANSWER).
    TooLong,
    /// There was output before the question, or more than a line after it: this line.
    Unasked(Vec<u8>),
}

/// A program, ended together with whatever it started when this is dropped.
#[derive(Debug)]
pub struct Process {
    pipes: Pipes,
    group: Group,
    asked: u64,
}

impl Process {
    /// Starts a program with its arguments, in a process group of its own.
    ///
    /// # Errors
    /// [`NoAnswer::NotStarted`] or [`NoAnswer::Shortage`], with the reason.
    pub fn start(command: &[String]) -> Result<Process, NoAnswer> {
        let (program, arguments) =
            command.split_first().ok_or_else(|| NoAnswer::NotStarted("the command is empty".to_owned()))?;
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let not_started = |error: io::Error| {
            let why = format!("cannot start {program}: {error}");
            if is_shortage(&error) { NoAnswer::Shortage(why) } else { NoAnswer::NotStarted(why) }
        };
        let mut group = Group::start(&mut command).map_err(not_started)?;
        let pipes = Pipes::of(group.child()).map_err(not_started)?;
        Ok(Process { pipes, group, asked: 0 })
    }

    /// How many questions it was asked before.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// Sends a line (without its end) and waits for one.
    ///
    /// # Errors
    /// Why there was none. The program is of no further use then.
    pub fn ask(&mut self, line: String, patience: Duration) -> Result<Vec<u8>, NoAnswer> {
        self.asked += 1;
        if self.pipes.has_unread() {
            return Err(NoAnswer::Unasked(first_line(self.pipes.unread())));
        }
        let mut bytes = line.into_bytes();
        bytes.push(b'\n');
        self.pipes.send(bytes);
        let begin = Instant::now();
        loop {
            // Before the look: what it wrote until its end is seen by the looks that follow.
            let ended = self.group.has_ended();
            let left = patience.saturating_sub(begin.elapsed());
            let wait = if ended { Duration::ZERO } else { LOOK.min(left) };
            match self.pipes.poll(wait) {
                Ok(PipeEvent::Line(line)) if self.pipes.has_unread() => {
                    // The answer is an object; what came beside it may have come before it or after.
                    let is_answer = line.trim_ascii_start().starts_with(b"{");
                    let unasked = if is_answer { first_line(self.pipes.unread()) } else { line };
                    return Err(NoAnswer::Unasked(unasked));
                }
                Ok(PipeEvent::Line(line)) => return Ok(line),
                Ok(PipeEvent::TooLong) => return Err(NoAnswer::TooLong),
                Ok(PipeEvent::End) | Err(_) => return Err(NoAnswer::Ended(self.exit_description())),
                Ok(PipeEvent::Nothing) if ended => return Err(NoAnswer::Ended(self.exit_description())),
                Ok(PipeEvent::Nothing | PipeEvent::Part) if left.is_zero() => return Err(NoAnswer::TimedOut),
                Ok(PipeEvent::Nothing | PipeEvent::Part) => {}
            }
        }
    }

    /// Whether it writes more soon, without being asked.
    pub fn has_unread_output(&mut self) -> bool {
        let begin = Instant::now();
        loop {
            let left = MORE.saturating_sub(begin.elapsed());
            match self.pipes.poll(left) {
                Ok(PipeEvent::Line(_) | PipeEvent::Part | PipeEvent::TooLong) => return true,
                Ok(PipeEvent::End) | Err(_) => return false,
                Ok(PipeEvent::Nothing) if left.is_zero() => return false,
                Ok(PipeEvent::Nothing) => {}
            }
        }
    }

    /// How the program ended, and its last words.
    fn exit_description(&mut self) -> String {
        self.pipes.close_stdin();
        let by_itself = self.group.wait(FAREWELL);
        let words = self.pipes.last_words();
        let how = match self.group.end() {
            Some(status) if by_itself => describe(status),
            _ => "it closed its output and went on running".to_owned(),
        };
        words.map_or(how.clone(), |words| format!("{how}; its last words: {}", excerpt(&words, WORDS)))
    }

    /// Ends it without waiting for a farewell, and whatever it started.
    pub fn kill(mut self) {
        self.group.end();
    }
}

impl Drop for Process {
    /// Closes stdin, which tells the program to end, and ends it if it does not; then whatever it started and left running.
    fn drop(&mut self) {
        self.pipes.close_stdin();
        self.group.wait(FAREWELL);
        self.group.end();
    }
}

/// The first line of some output, as far as it was read.
fn first_line(output: &[u8]) -> Vec<u8> {
    output.split(|byte| *byte == b'\n').next().unwrap_or_default().to_vec()
}

/// Whether an error says that there are no more files, processes or memory to be had here, which is no fault of a program that is to be started.
fn is_shortage(error: &io::Error) -> bool {
    matches!(Errno::from_io_error(error), Some(Errno::MFILE | Errno::NFILE | Errno::AGAIN | Errno::NOMEM))
}

/// `exit code 3` or `signal 11`.
fn describe(status: ExitStatus) -> String {
    if let Some(code) = status.code() {
        return format!("it ended with exit code {code}");
    }
    match std::os::unix::process::ExitStatusExt::signal(&status) {
        Some(signal) => format!("it was ended by signal {signal}"),
        None => "it ended".to_owned(),
    }
}
