//! One running program that answers questions, a line each. Whatever it does, asking comes back within the time allowed.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The longest line a program may answer with, in bytes.
pub const LONGEST_ANSWER: u64 = 1 << 24;

/// How much of what a program writes to stderr is kept, in bytes.
const KEPT_STDERR: usize = 2048;

/// How long a program may take to end once its stdin is closed.
const FAREWELL: Duration = Duration::from_millis(300);

/// Why a question got no line in answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Silence {
    /// The program could not be started.
    NotStarted(String),
    /// The program ended; how, and the last line it wrote to stderr.
    Ended(String),
    /// No line came in time.
    TimedOut,
    /// The line was longer than [`LONGEST_ANSWER`].
    TooLong,
}

enum Line {
    Text(Vec<u8>),
    TooLong,
}

/// A program with threads that carry its three streams, so that no full pipe can hold up the campaign.
#[derive(Debug)]
pub struct Process {
    child: Child,
    /// `None` once stdin is to be closed.
    requests: Option<Sender<Vec<u8>>>,
    lines: Receiver<Line>,
    stderr: Arc<Mutex<Vec<u8>>>,
    asked: u64,
}

impl Process {
    /// Starts a program with its arguments, in a process group of its own: Ctrl-C stops the campaign between two chunks, and
    /// must not stop the engine before.
    ///
    /// # Errors
    /// [`Silence::NotStarted`], with the reason.
    pub fn start(command: &[String]) -> Result<Process, Silence> {
        let (program, arguments) =
            command.split_first().ok_or_else(|| Silence::NotStarted("the command is empty".to_owned()))?;
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let not_started = |error: std::io::Error| Silence::NotStarted(format!("cannot start {program}: {error}"));
        let mut child = command.spawn().map_err(not_started)?;
        let stderr = Arc::new(Mutex::new(Vec::new()));
        let (Some(stdin), Some(stdout), Some(errors)) = (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            return Err(Silence::NotStarted(format!("{program} has no streams")));
        };
        let (requests, written) = mpsc::channel();
        let (read, lines) = mpsc::channel();
        let tail = Arc::clone(&stderr);
        thread::spawn(move || write_all(stdin, &written));
        thread::spawn(move || read_lines(stdout, &read));
        thread::spawn(move || keep_tail(errors, &tail));
        Ok(Process { child, requests: Some(requests), lines, stderr, asked: 0 })
    }

    /// How many questions it was asked before.
    pub fn asked(&self) -> u64 {
        self.asked
    }

    /// Sends a line (without its end) and waits for one.
    ///
    /// # Errors
    /// Why there was none. The program is of no further use then.
    pub fn ask(&mut self, line: String, patience: Duration) -> Result<Vec<u8>, Silence> {
        self.asked += 1;
        let mut bytes = line.into_bytes();
        bytes.push(b'\n');
        // Where the writer is gone the program has closed its stdin; the reader will tell what became of it.
        if let Some(requests) = &self.requests {
            let _ = requests.send(bytes);
        }
        match self.lines.recv_timeout(patience) {
            Ok(Line::Text(text)) => Ok(text),
            Ok(Line::TooLong) => Err(Silence::TooLong),
            Err(RecvTimeoutError::Timeout) => Err(Silence::TimedOut),
            Err(RecvTimeoutError::Disconnected) => Err(Silence::Ended(self.obituary())),
        }
    }

    /// How the program ended, and its last words.
    fn obituary(&mut self) -> String {
        self.requests = None;
        let how = match self.wait(FAREWELL) {
            Some(status) => describe(status),
            None => "it closed its output and went on running".to_owned(),
        };
        let tail = self.stderr.lock().unwrap_or_else(PoisonError::into_inner);
        let text = String::from_utf8_lossy(&tail).into_owned();
        match text.lines().rev().find(|line| !line.trim().is_empty()) {
            Some(last) => format!("{how}; its last words: {}", last.trim()),
            None => how,
        }
    }

    /// Waits for the end of the program.
    fn wait(&mut self, patience: Duration) -> Option<ExitStatus> {
        let begin = Instant::now();
        loop {
            if let Ok(Some(status)) = self.child.try_wait() {
                return Some(status);
            }
            if begin.elapsed() >= patience {
                return None;
            }
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// Ends it without waiting for a farewell, and whatever it started.
    pub fn kill(mut self) {
        self.end();
    }

    fn end(&mut self) {
        #[cfg(unix)]
        if let Some(group) = i32::try_from(self.child.id()).ok().and_then(rustix::process::Pid::from_raw) {
            // A group that is gone already is what is wanted.
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        // As above, on systems without groups.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    /// Closes stdin, which tells the program to end, and ends it if it does not.
    fn drop(&mut self) {
        self.requests = None;
        if self.wait(FAREWELL).is_none() {
            self.end();
        }
    }
}

/// `exit code 3` or `signal 11`.
fn describe(status: ExitStatus) -> String {
    if let Some(code) = status.code() {
        return format!("it ended with exit code {code}");
    }
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("it was ended by signal {signal}");
    }
    "it ended".to_owned()
}

fn write_all(mut stdin: ChildStdin, written: &Receiver<Vec<u8>>) {
    for bytes in written {
        if stdin.write_all(&bytes).and_then(|()| stdin.flush()).is_err() {
            return;
        }
    }
}

fn read_lines(stdout: ChildStdout, read: &Sender<Line>) {
    let mut reader = BufReader::new(stdout);
    loop {
        let mut text = Vec::new();
        match reader.by_ref().take(LONGEST_ANSWER).read_until(b'\n', &mut text) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let whole = text.pop_if(|last| *last == b'\n').is_some();
        let long = !whole && text.len() as u64 >= LONGEST_ANSWER;
        let line = if long { Line::TooLong } else { Line::Text(text) };
        if read.send(line).is_err() || long {
            return;
        }
    }
}

fn keep_tail(mut errors: impl Read, tail: &Mutex<Vec<u8>>) {
    let mut buffer = [0; 1024];
    while let Ok(count) = errors.read(&mut buffer) {
        if count == 0 {
            return;
        }
        let mut tail = tail.lock().unwrap_or_else(PoisonError::into_inner);
        tail.extend_from_slice(&buffer[..count]);
        let surplus = tail.len().saturating_sub(KEPT_STDERR);
        tail.drain(..surplus);
    }
}
