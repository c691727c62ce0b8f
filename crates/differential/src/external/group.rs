//! The process groups of running engines: a program and whatever it started are ended together.

use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, WaitIdStatus, kill_process_group, waitid};
use std::collections::BTreeSet;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How often a program is looked at while its end is awaited.
const LOOK: Duration = Duration::from_millis(2);

/// The groups that run now.
struct Running {
    ids: BTreeSet<i32>,
    /// Whether [`end_all`] was called: nothing is started any more.
    over: bool,
}

static RUNNING: Mutex<Running> = Mutex::new(Running { ids: BTreeSet::new(), over: false });

fn running() -> MutexGuard<'static, Running> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends every engine that runs, with whatever it started, and lets none start again: for a program that is about to end itself. Questions
/// that wait for an answer fail at once.
pub fn end_all() {
    let mut running = running();
    running.over = true;
    running.ids.iter().for_each(|id| end(*id));
}

/// Ends a group; one that is gone already is what is wanted.
fn end(id: i32) {
    if let Some(group) = Pid::from_raw(id) {
        let _ = kill_process_group(group, Signal::KILL);
    }
}

/// A program in a process group of its own, so that a Ctrl-C meant for us does not reach it before we decide.
#[derive(Debug)]
pub(super) struct Group {
    child: Child,
    id: i32,
    /// How it ended, once it is reaped. Until then its number, which is the group's, belongs to nobody else.
    ended: Option<io::Result<ExitStatus>>,
}

impl Group {
    /// Starts a program.
    pub(super) fn start(command: &mut Command) -> io::Result<Group> {
        // Held while it starts: none can slip through between `end_all` and its being listed.
        let mut running = running();
        if running.over {
            return Err(io::Error::other("this program is about to end"));
        }
        let child = command.process_group(0).spawn()?;
        let id = i32::try_from(child.id()).map_err(io::Error::other)?;
        running.ids.insert(id);
        Ok(Group { child, id, ended: None })
    }

    /// The program.
    pub(super) fn child(&mut self) -> &mut Child {
        &mut self.child
    }

    /// Whether the program has ended, whatever became of those it started. It is not reaped by this.
    pub(super) fn has_ended(&self) -> bool {
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        let look = |pid: Pid| waitid(WaitId::Pid(pid), options);
        self.ended.is_some()
            || Pid::from_raw(self.id).is_none_or(|pid| matches!(look(pid), Ok(Some::<WaitIdStatus>(_))))
    }

    /// Waits for the end of the program, for so long; whether it came.
    pub(super) fn wait(&self, patience: Duration) -> bool {
        let begin = Instant::now();
        while !self.has_ended() {
            if begin.elapsed() >= patience {
                return false;
            }
            thread::sleep(LOOK);
        }
        true
    }

    /// Ends the program, if it has not ended, and whatever it started and left running; how the program ended.
    pub(super) fn end(&mut self) -> Option<ExitStatus> {
        if self.ended.is_none() {
            {
                let mut running = running();
                end(self.id);
                running.ids.remove(&self.id);
            }
            self.ended = Some(self.child.wait());
        }
        self.ended.as_ref().and_then(|status| status.as_ref().ok().copied())
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        self.end();
    }
}
