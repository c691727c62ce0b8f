//! How a command ends, and how it talks.

use crate::reading::{is_apart, is_bent};
use crate::stop::is_ended;
use crate::terminal::{INTERRUPTED, to_stdout};
use anyhow::Context;
use rockproof_model::text::{cut_in_the_middle, is_harmful};
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// How much a command says beside its result.
#[derive(clap::Args)]
pub(crate) struct VerbosityArgs {
    /// Print nothing on stderr but errors: no progress, no notes
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// At the end print the run time, and the memory where the system reports it
    #[arg(short, long, global = true)]
    verbose: bool,
}

/// Whether notes and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Whether progress is drawn: on a terminal, unless `--quiet` is given.
pub(crate) fn shows_progress() -> bool {
    io::stderr().is_terminal() && !QUIET.load(Ordering::Relaxed)
}

impl VerbosityArgs {
    /// Makes it hold from now on.
    pub(crate) fn apply(&self) {
        QUIET.store(self.quiet, Ordering::Relaxed);
    }

    /// Tells what a command that began then has cost, where that is asked for.
    pub(crate) fn tell_cost(&self, begun: Instant) {
        if self.verbose {
            let memory = peak_memory_mb().map_or(String::new(), |mb| format!(", {mb} MB of memory at most"));
            print_note(&format!("{:.1} s{memory}", begun.elapsed().as_secs_f64()));
        }
    }
}

/// The most memory the program has held, in megabytes, where the system tells (Linux).
fn peak_memory_mb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kb: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kb.div_ceil(1024))
}

/// What `--mpi` comes to in a build without MPI.
#[cfg(not(feature = "mpi"))]
pub(crate) fn without_mpi() -> anyhow::Error {
    anyhow::anyhow!(
        "--mpi: this program was built without MPI; `cargo install --locked --path . --features mpi` builds it with, where an MPI and libclang are installed (docs/scale.md)"
    )
}

/// What a command comes to, or why it could not.
pub(crate) type Outcome = anyhow::Result<ExitStatus>;

/// What a command that ran to its end has to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExitStatus {
    /// Done, nothing to object to: exit 0.
    Passed,
    /// A rule violated, a gate failed, a denied finding: exit 1.
    CheckFailed,
    /// Stopped by Ctrl-C in good order: exit 130, as a shell has it.
    Interrupted,
}

/// The exit code of an outcome; an error is told on stderr and exits 2.
pub(crate) fn code(outcome: Outcome) -> ExitCode {
    if is_ended() {
        return ExitCode::from(INTERRUPTED);
    }
    match outcome {
        Ok(ExitStatus::Passed) => ExitCode::SUCCESS,
        Ok(ExitStatus::CheckFailed) => ExitCode::from(1),
        Ok(ExitStatus::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            print_error(&chain(&error));
            if error.downcast_ref().is_some_and(is_bent) {
                print_note("--planarity accepts faces further from planar; `rockproof check` says how far these are");
            }
            if error.downcast_ref().is_some_and(is_apart) {
                print_note("--weld joins vertices that are nearly one; `rockproof check` says whether that helps");
            }
            ExitCode::from(2)
        }
    }
}

/// An error with its causes, each said once: some errors say their cause themselves, and some name the file that was named before.
pub(crate) fn chain(error: &anyhow::Error) -> String {
    let mut parts: Vec<String> = Vec::new();
    for part in error.chain().map(ToString::to_string) {
        if parts.iter().any(|said| said.contains(&part)) {
            continue;
        }
        parts.retain(|said| !part.starts_with(&format!("{said}:")));
        parts.push(part);
    }
    parts.join(": ")
}

/// A text that does nothing but show: control characters are escaped, and no line is one of the commands that GitHub's runner takes from
/// a log (`::error …` at the beginning of a line, `##[error]` anywhere).
fn harmless(text: &str) -> String {
    let safe = |line: &str| {
        let mut shown = if line.trim_start().starts_with("::") { "| ".to_owned() } else { String::new() };
        for c in line.replace("##[", "## [").chars() {
            if is_harmful(c) && c != '\t' {
                shown.extend(c.escape_debug());
            } else {
                shown.push(c);
            }
        }
        shown
    };
    text.split('\n').map(safe).collect::<Vec<_>>().join("\n")
}

/// Prints to stdout, [`harmless`]. A reader that went away (`| head`) is no error.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    print_as_it_is(&harmless(text))
}

/// Prints a document on stdout. What would do something else than to show is escaped as JSON has it, so that the texts read from the document
/// are those put into it. No line of it begins with `::`: its texts have no line breaks, and begin with a quotation mark.
pub(crate) fn print_json(document: &impl Serialize) -> anyhow::Result<()> {
    print_as_it_is(&(harmless_json(&serde_json::to_string_pretty(document)?) + "\n"))
}

fn harmless_json(document: &str) -> String {
    let mut shown = String::with_capacity(document.len());
    for c in document.replace("##[", "#\\u0023[").chars() {
        // Between texts there are spaces and line breaks, which stay; within them serde has escaped these.
        if is_harmful(c) && c != '\n' {
            c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| shown.push_str(&format!("\\u{unit:04x}")));
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Prints commands for GitHub's runner.
pub(crate) fn print_as_it_is(text: &str) -> anyhow::Result<()> {
    write_to_stdout(|out| out.write_all(text.as_bytes()))
}

/// As [`to_stdout`], with an error that names stdout.
pub(crate) fn write_to_stdout(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> anyhow::Result<()> {
    to_stdout(write).context("stdout")
}

/// Tells an error on stderr.
pub(crate) fn print_error(message: &str) {
    print_labelled(&cut_in_the_middle(&harmless(&format!("error: {message}"))));
}

/// Tells what is wrong with a command line, as other errors are told; or the help or version that it asks for.
pub(crate) fn refuse(error: &clap::Error) -> ExitCode {
    use clap::error::ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
    if matches!(error.kind(), DisplayHelp | DisplayHelpOnMissingArgumentOrSubcommand | DisplayVersion) {
        error.exit();
    }
    print_labelled(&cut_in_the_middle(&harmless(error.to_string().trim_end())));
    ExitCode::from(2)
}

/// Whether notes are printed: what takes long to find out need not be, without.
pub(crate) fn shows_notes() -> bool {
    !QUIET.load(Ordering::Relaxed)
}

/// Tells something worth knowing on stderr, unless `--quiet` is given.
pub(crate) fn print_note(message: &str) {
    if shows_notes() {
        print_labelled(&harmless(&format!("note: {message}")));
    }
}

fn print_labelled(text: &str) {
    // Without a stderr there is nobody to tell.
    let _ = writeln!(io::stderr(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::{chain, harmless, harmless_json};
    use anyhow::Context;
    use serde_json::{Value, json};

    #[test]
    fn no_text_is_a_command_to_a_terminal_or_a_runner() {
        let nasty = "a\u{1b}[31m\0\n::error file=x::y\n  ::debug::z\nb ##[error]c\td::e";
        assert_eq!(harmless(nasty), "a\\u{1b}[31m\\0\n| ::error file=x::y\n|   ::debug::z\nb ## [error]c\td::e");
    }

    #[test]
    fn a_document_is_no_command_and_says_what_was_put_in() {
        let nasty = "\n::error::x ##[error]####[ \u{1b}[31m\u{7f}\u{85}\u{202e}\u{2028}\t\"\\u{1b}\\ é \u{10000}";
        let document = json!({ nasty: [nasty, 1, null], "b": {} });
        let pretty = serde_json::to_string_pretty(&document).expect("a document");
        let shown = harmless_json(&pretty);
        assert_eq!(serde_json::from_str::<Value>(&shown).expect("JSON"), document);
        assert!(!shown.contains("##[") && !shown.lines().any(|line| line.trim_start().starts_with("::")), "{shown}");
        assert!(!shown.contains(|c: char| super::is_harmful(c) && c != '\n'), "{shown:?}");
        assert!(shown.contains("\\u007f\\u0085\\u202e\\u2028\\t") && shown.contains("é \u{10000}"), "{shown}");
        let plain = serde_json::to_string_pretty(&json!({ "a": ["#[", "##", 0.5] })).expect("a document");
        assert_eq!(harmless_json(&plain), plain);
    }

    #[derive(Debug, thiserror::Error)]
    #[error("a.toml: {source}")]
    struct Told {
        source: std::io::Error,
    }

    #[test]
    fn nothing_is_said_twice() {
        let told = || Told { source: std::io::Error::other("no room") };
        assert_eq!(chain(&told().into()), "a.toml: no room");
        let again = Err::<(), _>(told()).context("a.toml").context("campaign").unwrap_err();
        assert_eq!(chain(&again), "campaign: a.toml: no room");
    }
}
