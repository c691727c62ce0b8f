//! The program under attack: started with limits, watched, killed, and judged by how it ends.

use crate::counts::Counts;
// What an input to a reader may take, a process may: of seconds processor time, of memory what it may map. Everything that a soak asks for is small.
pub(crate) use rockproof_fuzz::{MAX_MEMORY, MAX_SECONDS, peak_memory};
use std::fs;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The most time by the clock, on a machine that is busy with other things: who waits for ever takes no processor time.
const PATIENCE: Duration = Duration::from_secs(180);
/// So much of what a process prints is kept.
const KEPT: usize = 1 << 20;

/// What went wrong.
pub(crate) type Told<T> = Result<T, String>;

/// How a process is disturbed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Disturbance {
    None,
    /// Killed after so long.
    Kill(Duration),
    /// Sent a signal that asks it to end, after so long.
    Signal(&'static str, Duration),
    /// No file may grow beyond so many blocks of 512 bytes.
    LimitedFiles(u64),
}

/// How a process ended, and what it said.
#[derive(Clone, Debug)]
pub(crate) struct Ended {
    /// `None` where a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) signal: Option<i32>,
    /// Whether it was disturbed before its end.
    pub(crate) disturbed: bool,
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) took: Duration,
}

impl Ended {
    /// The exit code, where no signal ended it.
    pub(crate) fn code(&self, what: &str) -> Told<i32> {
        self.code.ok_or_else(|| format!("{what}: ended by signal {:?}: {}", self.signal, self.err))
    }

    /// That it came to its end with one of these codes.
    pub(crate) fn has_code(&self, allowed: &[i32], what: &str) -> Told<()> {
        let code = self.code(what)?;
        if allowed.contains(&code) {
            return Ok(());
        }
        Err(format!("{what}: exit {code}, allowed are {allowed:?}: {}{}", self.out, self.err))
    }
}

/// The program in a folder.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) engine_client: PathBuf,
    /// The library that shifts the clock.
    pub(crate) clock: PathBuf,
}

/// A call of the program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Call {
    pub(crate) arguments: Vec<String>,
    pub(crate) environment: Vec<(&'static str, Option<String>)>,
}

impl Call {
    pub(crate) fn of<S: Into<String>>(arguments: impl IntoIterator<Item = S>) -> Call {
        Call { arguments: arguments.into_iter().map(Into::into).collect(), environment: Vec::new() }
    }

    pub(crate) fn and(mut self, argument: &str) -> Call {
        self.arguments.push(argument.to_owned());
        self
    }

    /// The directory that it writes.
    pub(crate) fn out(&self) -> &str {
        let at = self.arguments.iter().position(|argument| argument == "--out").map_or(0, |at| at + 1);
        &self.arguments[at]
    }
}

impl Program {
    /// Runs the program in a folder until it ends. That it panicked, or took too long or too much memory, is an error.
    pub(crate) fn run(&self, dir: &Path, call: &Call, disturbance: Disturbance, counts: &mut Counts) -> Told<Ended> {
        let files = match disturbance {
            Disturbance::LimitedFiles(blocks) => format!("trap '' XFSZ; ulimit -f {blocks}; "),
            _ => String::new(),
        };
        let script = format!("ulimit -v {MAX_MEMORY}; {files}exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script]).arg(&self.path).args(&call.arguments).current_dir(dir);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        for (name, value) in &call.environment {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        let begin = Instant::now();
        let mut child = command.spawn().map_err(|error| format!("{}: {error}", self.path.display()))?;
        let pipes = (kept(child.stdout.take()), kept(child.stderr.take()));
        let (status, disturbed) = watch(&mut child, disturbance, begin, counts)
            .map_err(|what| format!("rockproof {}: {what}", call.arguments.join(" ")))?;
        let took = begin.elapsed();
        counts.processes += 1;
        counts.longest = counts.longest.max(took);
        let text = |pipe: JoinHandle<Vec<u8>>| String::from_utf8_lossy(&pipe.join().unwrap_or_default()).into_owned();
        let (out, err) = (text(pipes.0), text(pipes.1));
        let ended = Ended { code: status.code(), signal: status.signal(), disturbed, out, err, took };
        let told = |what: &str| Err(format!("rockproof {}: {what}: {}", call.arguments.join(" "), ended.err));
        if ended.err.contains("panicked at") || ended.err.contains("memory allocation of") {
            return told("it panicked");
        }
        let killed = matches!(disturbance, Disturbance::Kill(_)) && disturbed;
        let asked = matches!(disturbance, Disturbance::Signal(..)) && disturbed;
        if ended.code.is_none() && !killed && !asked {
            return told(&format!("ended by signal {:?}", ended.signal));
        }
        Ok(ended)
    }
}

/// Reads a pipe to its end and keeps the beginning.
fn kept(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let (mut all, mut part) = (Vec::new(), [0; 1 << 13]);
        let Some(mut pipe) = pipe else { return all };
        while let Ok(n @ 1..) = pipe.read(&mut part) {
            all.extend_from_slice(&part[..n.min(KEPT.saturating_sub(all.len()))]);
        }
        all
    })
}

fn watch(child: &mut Child, disturbance: Disturbance, begin: Instant, counts: &mut Counts) -> Told<(ExitStatus, bool)> {
    let (mut disturbed, mut looked) = (false, Instant::now());
    loop {
        if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
            return Ok((status, disturbed));
        }
        match disturbance {
            Disturbance::Kill(after) if !disturbed && begin.elapsed() >= after => {
                child.kill().map_err(|error| error.to_string())?;
                disturbed = true;
            }
            Disturbance::Signal(name, after) if !disturbed && begin.elapsed() >= after => {
                signal(child.id(), name)?;
                disturbed = true;
            }
            _ => {}
        }
        if looked.elapsed() >= Duration::from_millis(5) {
            looked = Instant::now();
            let proc = PathBuf::from(format!("/proc/{}", child.id()));
            counts.memory = counts.memory.max(peak_memory(&proc));
            let (cpu, wall) = (processor_seconds(&proc), begin.elapsed());
            if cpu > MAX_SECONDS as f64 || wall > PATIENCE {
                let threads = waiting_at(&proc);
                drop(child.kill());
                drop(child.wait());
                return Err(format!("no end after {cpu:.1} s of processor time, {wall:.0?} by the clock; {threads}"));
            }
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}

/// Sends a signal by its name.
fn signal(id: u32, name: &str) -> Told<()> {
    // Who has ended already needs no signal.
    let sent = Command::new("kill").args([format!("-{name}"), id.to_string()]).stderr(Stdio::null()).status();
    sent.map(drop).map_err(|error| format!("kill: {error}"))
}

/// The ticks of Linux's clock of processes, a second.
const TICKS: f64 = 100.0;

/// The processor time of a process so far, in seconds; 0 where it has ended.
fn processor_seconds(proc: &Path) -> f64 {
    let stat = fs::read_to_string(proc.join("stat")).unwrap_or_default();
    // Behind the name, which may hold anything: the state, ten numbers, then user and system time.
    let rest = stat.rsplit_once(") ").map_or("", |(_, rest)| rest);
    let ticks = rest.split(' ').skip(11).take(2).filter_map(|n| n.parse::<f64>().ok());
    ticks.sum::<f64>() / TICKS
}

/// What the threads of a process that does not end wait for.
fn waiting_at(proc: &Path) -> String {
    let tasks = fs::read_dir(proc.join("task")).into_iter().flatten().flatten();
    let waits = tasks.map(|task| fs::read_to_string(task.path().join("wchan")).unwrap_or_default());
    format!("threads wait at {}", waits.collect::<Vec<_>>().join(", "))
}
