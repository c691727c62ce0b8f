//! Engines that misbehave as programs: whatever they write, leave running or hold open, asking comes back, the right failure is told, and
//! nothing of theirs stays behind. One test: it counts what this process holds.
#![cfg(target_os = "linux")]

use rockproof_differential::external::process::{NoAnswer, Process};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

fn shell(script: &str) -> Process {
    Process::start(&["sh".to_owned(), "-c".to_owned(), script.to_owned()]).expect("a shell")
}

fn ask(process: &mut Process, patience_s: u64) -> Result<String, NoAnswer> {
    let line = process.ask("question".to_owned(), Duration::from_secs(patience_s))?;
    Ok(String::from_utf8(line).expect("text"))
}

/// Entries of a folder of /proc/self.
fn held(what: &str) -> usize {
    fs::read_dir(Path::new("/proc/self").join(what)).expect("a folder").count()
}

/// The most memory this process ever held (kB).
fn peak_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("status");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a peak");
    line.trim().trim_end_matches(" kB").parse().expect("kB")
}

/// Whether a process runs; what has ended and is not reaped does not.
fn runs(id: &str) -> bool {
    let state = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    state.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
}

/// Waits until a process does not run any more.
fn ends(id: &str) -> bool {
    let begin = Instant::now();
    while runs(id) && begin.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(10));
    }
    !runs(id)
}

#[test]
fn nothing_of_an_engine_stays_behind() {
    // Most of the time goes by in waiting.
    std::thread::scope(|scope| {
        scope.spawn(output_nobody_asked_for);
        scope.spawn(output_without_end);
        scope.spawn(long_answers_and_children);
    });
    // Forty restarts leave nothing, not even where a child left the group and holds the pipes.
    let before = ["fd", "task"].map(held);
    let restart = || {
        for script in ["read line; exit 3", "setsid sleep 3 & read line; exit 3"] {
            assert!(matches!(ask(&mut shell(script), 10), Err(NoAnswer::Ended(_))));
        }
    };
    std::thread::scope(|scope| (0..20).for_each(|_| drop(scope.spawn(restart))));
    let after = ["fd", "task"].map(held);
    assert!(after.iter().zip(before).all(|(after, before)| *after <= before + 4), "{before:?}, then {after:?}");
}

/// Output before the question and after the answer.
fn output_nobody_asked_for() {
    let mut early = shell("echo welcome; sleep 1000");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(ask(&mut early, 10), Err(NoAnswer::Unasked(b"welcome".to_vec())));
    // What is told is the line that is no answer, whichever came first.
    for lines in ["near parallel\\n{}", "{}\\nnear parallel"] {
        let engine = format!("read line; printf '{lines}\\n'; sleep 1000");
        assert_eq!(ask(&mut shell(&engine), 10), Err(NoAnswer::Unasked(b"near parallel".to_vec())));
    }
}

/// Output without end: in lines, and without any.
fn output_without_end() {
    let before = peak_kb();
    let mut endless = shell("read line; exec yes abcdefghijklmnopqrstuvwxyz");
    assert!(matches!(ask(&mut endless, 10), Ok(_) | Err(NoAnswer::Unasked(_))));
    // Some hundred MB, if anybody took them.
    std::thread::sleep(Duration::from_millis(300));
    assert!(matches!(ask(&mut endless, 10), Err(NoAnswer::Unasked(_))));
    assert_eq!(ask(&mut shell("read line; tr '\\0' x </dev/zero"), 60), Err(NoAnswer::TooLong));
    let grown = peak_kb() - before;
    assert!(grown < 96 * 1024, "{grown} kB for engines that write without end");
}

/// A long answer, what an engine started, and a crash.
fn long_answers_and_children() {
    // A long answer, in pieces, from a program that ends with it.
    let long = "read line; head -c 300000 /dev/zero | tr '\\0' x; sleep 0.1; echo y";
    assert_eq!(ask(&mut shell(long), 10).expect("an answer").len(), 300_001);

    // What an engine started ends with it: where it ends by itself, and where it is killed.
    let mut with_child = shell("sleep 1000 >/dev/null 2>&1 & read line; echo $!; read line");
    let child = ask(&mut with_child, 10).expect("a number");
    assert!(runs(&child));
    drop(with_child);
    assert!(ends(&child), "a child of an engine that ended");
    let mut hanging = shell("sleep 1000 & read line; echo $!; exec sleep 1000");
    let child = ask(&mut hanging, 10).expect("a number");
    assert_eq!(ask(&mut hanging, 0), Err(NoAnswer::TimedOut));
    hanging.kill();
    assert!(ends(&child), "a child of an engine that was killed");

    // A crash is one, although a child holds the pipes.
    let begin = Instant::now();
    let crashed = ask(&mut shell("sleep 1000 & read line; printf 'out of \\033[31mrock\\n' >&2; exit 3"), 30);
    let told = "it ended with exit code 3; its last words: out of \\u{1b}[31mrock".to_owned();
    assert_eq!(crashed, Err(NoAnswer::Ended(told)));
    assert!(begin.elapsed() < Duration::from_secs(10), "{:?}", begin.elapsed());
}
