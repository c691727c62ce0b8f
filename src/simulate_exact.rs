//! `simulate --engine exact`: the oracle steps by itself.

use crate::exit::{ExitStatus, Outcome, print_error, print_note, shows_progress};
use crate::input::FormatArgs;
use crate::stop::on_ctrl_c;
use indicatif::{ProgressBar, ProgressStyle};
use rockproof_differential::lockstep::Trajectory;
use rockproof_differential::lockstep::penetration::penetration;
use rockproof_model::Number;
use rockproof_model::simulation::step_in_words;
use rockproof_model::text::csv_cell;
use rockproof_model::text::noun;
use rockproof_oracle::step::{KeptPrecision, Mode, StepAnswer};
use rockproof_results::{Claim, Directory, FileKind, Owner, Start};
use rockproof_simulate::Plan;
use rockproof_simulate::tables::{MEASURED, lines};
use serde_json::json;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Columns of `trajectory.csv`.
const COLUMNS: [&str; 12] = [
    "step",
    "time_s",
    "time_step_s",
    "iterations",
    "converged",
    "retries",
    "contacts",
    "open",
    "sliding",
    "locked",
    "max_penetration_m",
    "undecided",
];

/// The files it writes.
const FILES: [&str; 4] = ["trajectory.csv", "measured.csv", "state.json", "run.json"];

/// An exact run.
pub(super) struct ExactRun {
    pub(super) file: PathBuf,
    pub(super) dir: PathBuf,
    pub(super) plan: Plan,
    pub(super) overwrite: bool,
    pub(super) names: Vec<String>,
}

impl ExactRun {
    pub(super) fn run(&self, format: &FormatArgs, mut trajectory: Trajectory) -> Outcome {
        let dir = &self.dir;
        let start = Start::of(false, self.overwrite);
        let mut directory = Directory::claim(Claim { dir, owner: Owner::Simulate, start, files: &FILES })?;
        let stop = on_ctrl_c()?;
        let mut display = StepDisplay::new();
        let (mut steps, mut measured) = (lines([COLUMNS])?, lines([MEASURED])?);
        let begin = trajectory.measured().to_vec();
        let (mut undecided, mut failure, mut ending) = (0, None, "finished");
        while !self.is_over(&trajectory) {
            if stop.load(Ordering::Relaxed) {
                ending = "interrupted";
                break;
            }
            let number = trajectory.next_number();
            display.begin(number, &trajectory);
            // A step may take hours, and a stop must not wait for it; what was before it is written then.
            let mut next = trajectory.clone();
            let step = move || {
                let made = next.step();
                // How deep blocks then overlap may take as long as the step.
                let made = made.map(|answer| (penetration(next.scene(), &answer.state), answer));
                (next, made)
            };
            let Some((after, made)) = stoppable(step, &stop, || display.show()) else { continue };
            trajectory = after;
            match made {
                Err(why) => {
                    (failure, ending) = (Some(format!("{}: {why}", step_in_words(number))), "stopped");
                    break;
                }
                Ok((deepest, answer)) => {
                    undecided += answer.levels.undecided;
                    steps.extend(lines([row(number, &answer, deepest)])?);
                    for ((name, now), then) in self.names.iter().zip(trajectory.measured()).zip(&begin) {
                        let mut cells = vec![number.to_string(), text(&answer.state.time), csv_cell(name)];
                        cells.extend(now.components().into_iter().map(text));
                        let moved = now.components().into_iter().zip(then.components());
                        cells.extend(moved.map(|(now, then)| text(&now.plus(&then.negated()))));
                        measured.extend(lines([cells])?);
                    }
                }
            }
        }
        display.end();
        let kept = precision_words(trajectory.keep());
        directory.write("trajectory.csv", FileKind::Table, &steps)?;
        directory.write("measured.csv", FileKind::Table, &measured)?;
        directory.write("state.json", FileKind::Run, &state(&trajectory)?)?;
        let mut about = serde_json::to_vec_pretty(&json!({
            "version": env!("CARGO_PKG_VERSION"),
            "file": self.file.display().to_string(),
            "engine": "exact",
            "kept": kept,
            "ending": ending,
            "stopped": failure,
            "steps": trajectory.steps(),
            "time_s": trajectory.state().time.to_string(),
            "undecided": undecided,
        }))?;
        about.push(b'\n');
        directory.write("run.json", FileKind::Run, &about)?;
        let time = trajectory.state().time.approximate();
        let text = || {
            format!(
                "time             {time} s after {} exact {}\nkept             {kept}\nundecided        {undecided} {}\naudit            none: nobody looked for overlaps that no contact sees (max_penetration_m in trajectory.csv is of all blocks)\nwritten to {}: {}\n",
                trajectory.steps(),
                noun(trajectory.steps(), "step", "steps"),
                noun(undecided, "decision", "decisions"),
                dir.display(),
                FILES.join(", ")
            )
        };
        format.print(text, || {
            json!({
                "ending": ending,
                "reason": failure,
                "time_s": time,
                "steps": trajectory.steps(),
                "kept": kept,
                "undecided": undecided,
                "directory": dir.display().to_string(),
                "files": FILES,
            })
        })?;
        Ok(match failure {
            Some(why) => {
                print_error(&why);
                ExitStatus::CheckFailed
            }
            None if ending == "interrupted" => ExitStatus::Interrupted,
            None => ExitStatus::Passed,
        })
    }

    fn is_over(&self, trajectory: &Trajectory) -> bool {
        let missing = |end: f64| end - trajectory.state().time.approximate();
        trajectory.state().settling == 0
            && (self.plan.steps.is_some_and(|steps| trajectory.steps() >= steps)
                || self.plan.time.is_some_and(|end| missing(end) < self.plan.smallest_step))
    }
}

/// Does work in a thread of its own, and shows now and then that it goes on; `None` where somebody asked to stop before it was done. The thread then ends with the program.
fn stoppable<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    stop: &AtomicBool,
    mut show: impl FnMut(),
) -> Option<T> {
    // Nothing is ever sent: the channel closes where the work ends, well or by a panic.
    let (working, ended) = mpsc::channel::<Infallible>();
    let thread = std::thread::spawn(move || {
        let made = work();
        drop(working);
        made
    });
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(StepDisplay::PAUSE) {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        show();
    }
    // A panic within the work is one of the program.
    Some(thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

/// Which step is being made, and for how long: on a terminal always, otherwise now and then.
struct StepDisplay {
    bar: Option<ProgressBar>,
    told: Instant,
    begun: Instant,
    step: String,
}

impl StepDisplay {
    /// How often it is looked at whether somebody wants to stop.
    const PAUSE: Duration = Duration::from_millis(50);
    /// How often a line is printed where there is no terminal.
    const LINES: Duration = Duration::from_secs(10);

    fn new() -> StepDisplay {
        let bar = shows_progress().then(|| {
            let bar = ProgressBar::new_spinner();
            if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}, {msg}") {
                bar.set_style(style);
            }
            bar
        });
        StepDisplay { bar, told: Instant::now(), begun: Instant::now(), step: String::new() }
    }

    /// A step begins.
    fn begin(&mut self, number: i64, trajectory: &Trajectory) {
        self.begun = Instant::now();
        self.step = format!("{}, from {} s on", step_in_words(number), trajectory.state().time.approximate());
    }

    fn show(&mut self) {
        let line = || format!("working on {} for {} s", self.step, self.begun.elapsed().as_secs());
        match &self.bar {
            Some(bar) => {
                bar.set_message(line());
                bar.tick();
            }
            None if self.told.elapsed() >= Self::LINES => {
                print_note(&line());
                self.told = Instant::now();
            }
            None => {}
        }
    }

    fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// How coordinates are kept, in words.
fn precision_words(keep: KeptPrecision) -> String {
    match keep {
        KeptPrecision::Exact => "exactly, as fractions".to_owned(),
        KeptPrecision::Grid { exponent } => format!("within 2^-{exponent} m, on that grid"),
    }
}

/// The f64 nearest to a number.
fn text(number: &Number) -> String {
    format!("{:?}", number.approximate())
}

fn row(step: i64, answer: &StepAnswer, deepest: Option<f64>) -> Vec<String> {
    let retries: Vec<String> =
        answer.retries.iter().map(|attempt| format!("{:?}", attempt.reason).to_lowercase()).collect();
    let count = |mode| answer.state.contacts.iter().filter(|contact| contact.mode == mode).count().to_string();
    let mut row = vec![step.to_string(), text(&answer.state.time)];
    row.push(text(&Number::from_rational(answer.time_step.clone())));
    row.extend([answer.iterations.to_string(), answer.converged.to_string(), retries.join(" ")]);
    row.push(answer.contacts.len().to_string());
    row.extend([Mode::Open, Mode::Sliding, Mode::Locked].map(count));
    row.push(deepest.map_or(String::new(), |depth| format!("{depth:?}")));
    row.push(answer.levels.undecided.to_string());
    row
}

/// The last state, every number in full.
fn state(trajectory: &Trajectory) -> anyhow::Result<Vec<u8>> {
    let state = trajectory.state();
    let exact = |numbers: &[Number]| numbers.iter().map(Number::to_string).collect::<Vec<_>>();
    let blocks: Vec<_> = state
        .blocks
        .iter()
        .map(|block| {
            let vertices = block.vertices.iter().map(|v| v.components().map(|c| c.to_string()));
            json!({
                "vertices": vertices.collect::<Vec<_>>(),
                "velocity": exact(&block.velocity),
                "stress": exact(&block.stress),
            })
        })
        .collect();
    let mut text = serde_json::to_vec(&json!({ "time": state.time.to_string(), "blocks": blocks }))?;
    text.push(b'\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_with_its_answer_its_panic_or_a_stop() {
        let stop = AtomicBool::new(false);
        assert_eq!(stoppable(|| 5, &stop, || {}), Some(5));
        let panics =
            std::panic::catch_unwind(|| stoppable(|| -> u8 { panic!("within") }, &AtomicBool::new(false), || {}));
        assert_eq!(panics.err().and_then(|panic| panic.downcast_ref::<&str>().copied()), Some("within"));
        let (_keep, endless) = mpsc::channel::<()>();
        let mut shown = 0;
        let waits = stoppable(
            move || endless.recv(),
            &stop,
            || {
                shown += 1;
                stop.store(true, Ordering::Relaxed);
            },
        );
        assert!(waits.is_none() && shown == 1);
    }
}
