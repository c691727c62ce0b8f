//! `simulate --engine exact`: the oracle steps by itself.

use crate::exit::{ExitStatus, Outcome, print_error};
use crate::input::FormatArgs;
use crate::stop::on_ctrl_c;
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
use std::path::PathBuf;
use std::sync::atomic::Ordering;

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
        let (mut steps, mut measured) = (lines([COLUMNS])?, lines([MEASURED])?);
        let begin = trajectory.measured().to_vec();
        let (mut undecided, mut failure, mut ending) = (0, None, "finished");
        while !self.is_over(&trajectory) {
            if stop.load(Ordering::Relaxed) {
                ending = "interrupted";
                break;
            }
            let number = trajectory.next_number();
            match trajectory.step() {
                Err(why) => {
                    (failure, ending) = (Some(format!("{}: {why}", step_in_words(number))), "stopped");
                    break;
                }
                Ok(answer) => {
                    undecided += answer.levels.undecided;
                    steps.extend(lines([row(number, &answer, &trajectory)])?);
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

fn row(step: i64, answer: &StepAnswer, trajectory: &Trajectory) -> Vec<String> {
    let retries: Vec<String> =
        answer.retries.iter().map(|attempt| format!("{:?}", attempt.reason).to_lowercase()).collect();
    let count = |mode| answer.state.contacts.iter().filter(|contact| contact.mode == mode).count().to_string();
    let mut row = vec![step.to_string(), text(&answer.state.time)];
    row.push(text(&Number::from_rational(answer.time_step.clone())));
    row.extend([answer.iterations.to_string(), answer.converged.to_string(), retries.join(" ")]);
    row.push(answer.contacts.len().to_string());
    row.extend([Mode::Open, Mode::Sliding, Mode::Locked].map(count));
    row.push(penetration(trajectory.scene(), &answer.state).map_or(String::new(), |depth| format!("{depth:?}")));
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
