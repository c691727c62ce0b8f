//! How a command ends, and how it talks.

use crate::extents::is_bent;
use std::io::{self, Write};
use std::process::ExitCode;

/// What a command comes to, or why it could not.
pub(crate) type Outcome = anyhow::Result<Verdict>;

/// What a command that ran to its end has to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Done, nothing to object to: exit 0.
    Fine,
    /// A rule violated, a gate failed, a denied finding: exit 1.
    Objection,
    /// Stopped by Ctrl-C in good order: exit 130, as a shell has it.
    Interrupted,
}

/// The exit code of an outcome; an error is told on stderr and exits 2.
pub(crate) fn code(outcome: Outcome) -> ExitCode {
    match outcome {
        Ok(Verdict::Fine) => ExitCode::SUCCESS,
        Ok(Verdict::Objection) => ExitCode::from(1),
        Ok(Verdict::Interrupted) => ExitCode::from(130),
        Err(error) => {
            complain(&format!("{error:#}"));
            if error.downcast_ref().is_some_and(is_bent) {
                note("--planarity accepts faces further from planar; `rockproof check` says how far these are");
            }
            ExitCode::from(2)
        }
    }
}

/// Prints to stdout. A reader that went away (`| head`) is no error.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Tells an error on stderr.
pub(crate) fn complain(message: &str) {
    tell("error", message);
}

/// Tells something worth knowing on stderr.
pub(crate) fn note(message: &str) {
    tell("note", message);
}

fn tell(kind: &str, message: &str) {
    // Without a stderr there is nobody to tell.
    let _ = writeln!(io::stderr(), "{kind}: {message}");
}
