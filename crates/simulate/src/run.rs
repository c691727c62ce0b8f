//! The run itself: step after step, each one written, until the plan is done, somebody asks to stop, or nothing goes on.

use crate::audit::{AuditTotals, StepAudit};
use crate::checkpoint::SavedState;
use crate::energy_gain::EnergyInput;
use crate::exact_float::ExactFloat;
use crate::record::{Frame, RunRecord, RunTable};
use crate::worst_intrusions::WorstIntrusion;
use crate::{Plan, frame, tables};
use rockproof_model::{Precision, Scene, vtu_writer};
use rockproof_results::ResultsError;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{Dynamics, Solve, State, StepError, StepReport, StepRules};
use serde_json::{Map, Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What makes steps.
pub trait Stepping<R> {
    /// Makes the next step; settling steps come first.
    ///
    /// # Errors
    /// Why it cannot be made; the state is then as it was before it.
    fn step(&mut self) -> Result<StepReport, StepError>;

    /// The state after the last step.
    fn state(&self) -> &State<R>;

    /// What was found beside the last step, made or not; asked once after each. Nothing, for a stepper by itself.
    fn annotations(&mut self) -> Option<StepAnnotations> {
        None
    }

    /// The exact audit of the last step that was made; asked once after each. None, for a run without audit.
    fn audit(&mut self) -> Option<StepAudit> {
        None
    }
}

/// What was found beside a step (`docs/lockstep.md`).
#[derive(Clone, Debug, Default)]
pub struct StepAnnotations {
    /// Rows, and the tables they belong to.
    pub rows: Vec<(RunTable, Vec<Vec<String>>)>,
    /// State files: a name within `states/`, and what it holds.
    pub states: Vec<(String, Vec<u8>)>,
    /// The passages and unseen overlaps of the run that get a case, where they are others than before.
    pub intrusions: Option<Vec<WorstIntrusion>>,
    /// What adds up over a run, by name.
    pub counts: Vec<(&'static str, u64)>,
    /// Why the run ends here, if it does.
    pub end: Option<Ending>,
}

impl<R: Solve, M: StepRules> Stepping<R> for Dynamics<R, M> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        Dynamics::step(self)
    }

    fn state(&self) -> &State<R> {
        Dynamics::state(self)
    }
}

/// A run ready to go.
pub struct Run<'r, R> {
    /// The scene.
    pub scene: &'r Scene,
    /// The state in which the scene begins, whatever the run goes on from.
    pub begin: &'r State<R>,
    /// What it calculates in.
    pub precision: Precision,
    /// How far, how often, how much.
    pub plan: Plan,
    /// What `run.json` says beside what the run knows.
    pub about: Map<String, Value>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The plan is done.
    Finished,
    /// Somebody asked it to stop; it can be resumed.
    Interrupted,
    /// It cannot go on.
    Stopped(StepError),
    /// Stepper and oracle differ, and the run was to end at the first such step.
    Diverged,
    /// The oracle cannot make the step, and why.
    Unproved(String),
}

impl Ending {
    fn name(&self) -> &'static str {
        match self {
            Ending::Finished => "finished",
            Ending::Interrupted => "interrupted",
            Ending::Stopped(_) => "stopped",
            Ending::Diverged => "parted",
            Ending::Unproved(_) => "unproved",
        }
    }
}

/// Why a run cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The directory cannot be used.
    #[error(transparent)]
    Record(#[from] ResultsError),
    /// A table cannot be written.
    #[error("cannot write a table: {0}")]
    Csv(#[from] csv::Error),
    /// A frame cannot be written.
    #[error("cannot write a frame: {0}")]
    Frame(#[from] std::io::Error),
    /// `run.json` cannot be written.
    #[error("cannot write run.json: {0}")]
    Json(#[from] serde_json::Error),
}

/// The first lines of the tables that a plan asks for; those of lockstep are not among them.
///
/// # Errors
/// None that writing to memory has.
pub fn headers(plan: &Plan) -> Result<[Option<Vec<u8>>; RunTable::COUNT], csv::Error> {
    let contacts = plan.contacts.then(|| tables::lines([tables::CONTACTS])).transpose()?;
    Ok([
        Some(tables::lines([tables::step_columns()])?),
        Some(tables::lines([tables::MEASURED])?),
        contacts,
        None,
        None,
        None,
    ])
}

impl<R: Real> Run<'_, R> {
    /// Runs until the plan is done, `stop` is set or a step cannot be made, calling `watch` after each step.
    ///
    /// # Errors
    /// When a file cannot be written. What was committed before stays, and can be resumed.
    pub fn run(
        &self,
        stepping: &mut dyn Stepping<R>,
        record: &mut RunRecord,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&StepReport, &State<R>),
    ) -> Result<Ending, RunError> {
        let clock = SessionClock { before: record.progress().seconds, started: Instant::now() };
        if record.progress().totals == Default::default() && record.progress().frames.is_empty() {
            self.checkpoint(stepping.state(), record, &clock)?;
        }
        let input = EnergyInput::of(self.scene, self.precision, self.begin);
        let ending = loop {
            if self.plan.is_over(stepping.state()) {
                break Ending::Finished;
            }
            if stop.load(Ordering::Relaxed) {
                break Ending::Interrupted;
            }
            let load_points = input.load_points(stepping.state());
            let made = stepping.step();
            let end = stepping.annotations().map(|beside| append_beside(beside, record)).transpose()?.flatten();
            match made {
                Err(stopped) => break Ending::Stopped(stopped),
                Ok(report) => {
                    let audit = stepping.audit();
                    let state = stepping.state();
                    self.append(&report, audit.as_ref(), state, record)?;
                    let totals = &mut record.progress_mut().totals;
                    totals.add(&report);
                    let put_in = [input.weight(state), input.work(&load_points, state)];
                    totals.balance.add(&report, put_in, || input.rounding(state));
                    if let Some(audit) = &audit {
                        totals.audit.get_or_insert_with(AuditTotals::default).add(report.step, audit);
                    }
                    if self.plan.has_checkpoint(state) {
                        self.checkpoint(state, record, &clock)?;
                    }
                    watch(&report, state);
                    if let Some(end) = end {
                        break end;
                    }
                }
            }
        };
        let state = stepping.state();
        if ending != Ending::Interrupted && !self.plan.has_frame(state) {
            let frame = self.write_frame(state, record)?;
            record.progress_mut().last_frame = Some(frame);
        }
        record.progress_mut().seconds = clock.seconds();
        record.commit(SavedState::of(state))?;
        let about = self.run_json(record, state, &ending)?;
        record.write("run.json", &about)?;
        Ok(ending)
    }

    fn append(
        &self,
        report: &StepReport,
        audit: Option<&StepAudit>,
        state: &State<R>,
        record: &mut RunRecord,
    ) -> Result<(), RunError> {
        record.append(RunTable::Steps, &tables::lines([tables::step_row(report, audit)])?)?;
        let measured = tables::measured_rows(self.scene, self.begin, report, state);
        record.append(RunTable::Measured, &tables::lines(measured)?)?;
        if self.plan.contacts {
            record.append(RunTable::Contacts, &tables::lines(tables::contact_rows(report, state))?)?;
        }
        Ok(())
    }

    fn checkpoint(&self, state: &State<R>, record: &mut RunRecord, clock: &SessionClock) -> Result<(), RunError> {
        if self.plan.has_frame(state) {
            let frame = self.write_frame(state, record)?;
            record.progress_mut().frames.push(frame);
        }
        record.progress_mut().seconds = clock.seconds();
        Ok(record.commit(SavedState::of(state))?)
    }

    fn write_frame(&self, state: &State<R>, record: &mut RunRecord) -> Result<Frame, RunError> {
        let blocks = vtu_writer::vtu(&frame::blocks(self.scene, self.begin, state))?;
        let contacts = vtu_writer::vtu(&frame::contacts(state))?;
        let frame = Frame { step: state.step, time: ExactFloat(state.time.to_f64()) };
        record.write_frame(frame, [&blocks, &contacts])?;
        Ok(frame)
    }

    fn run_json(&self, record: &RunRecord, state: &State<R>, ending: &Ending) -> Result<Vec<u8>, RunError> {
        let progress = record.progress();
        let totals = &progress.totals;
        let mut map = self.about.clone();
        map.extend(progress.identity.clone());
        let own = json!({
            "steps_asked": self.plan.steps,
            "time_asked_s": self.plan.time,
            "machine": {
                "os": std::env::consts::OS,
                "architecture": std::env::consts::ARCH,
                "cores": std::thread::available_parallelism().map_or(1, usize::from),
            },
            "blocks": self.scene.blocks.len(),
            "ending": ending.name(),
            "stopped": if let Ending::Stopped(stopped) = ending { describe(stopped) } else { Value::Null },
            "step": state.step,
            "time_s": state.time.to_f64(),
            "totals": totals,
            "frames": progress.frames.len() + usize::from(progress.last_frame.is_some()),
            "seconds": progress.seconds,
            "resumed": progress.resumed,
        });
        if let Value::Object(own) = own {
            map.extend(own);
        }
        if let Ending::Unproved(why) = ending {
            map.insert("unproved".to_owned(), why.as_str().into());
        }
        if !progress.beside.is_empty() {
            map.insert("lockstep".to_owned(), json!(progress.beside));
        }
        let mut bytes = serde_json::to_vec_pretty(&map)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

fn append_beside(beside: StepAnnotations, record: &mut RunRecord) -> Result<Option<Ending>, RunError> {
    for (table, rows) in beside.rows {
        record.append(table, &tables::lines(rows)?)?;
    }
    for (name, bytes) in &beside.states {
        record.write_state(name, bytes)?;
    }
    if let Some(intrusions) = beside.intrusions {
        record.progress_mut().intrusions = intrusions;
    }
    let counts = &mut record.progress_mut().beside;
    for (name, count) in beside.counts {
        *counts.entry(name.to_owned()).or_default() += count;
    }
    Ok(beside.end)
}

/// Counts the seconds of all sessions.
struct SessionClock {
    before: f64,
    started: Instant,
}

impl SessionClock {
    fn seconds(&self) -> f64 {
        self.before + self.started.elapsed().as_secs_f64()
    }
}

/// Why a run stopped, for programs.
fn describe(stopped: &StepError) -> Value {
    let mut value = json!({ "message": stopped.to_string() });
    match stopped {
        StepError::NotConverged { step, contacts, .. } => {
            value["step"] = (*step).into();
            let contact = |c: &rockproof_stepper::dynamics::ModeChange| {
                json!({
                    "blocks": c.blocks, "kind": c.contact.kind().name(), "features": c.contact.numbers(),
                    "from": c.from.name(), "to": c.to.name(),
                })
            };
            value["contacts"] = contacts.iter().map(contact).collect();
        }
        StepError::TooFast { step, block, .. }
        | StepError::Inverted { step, block, .. }
        | StepError::Collapsed { step, block, .. }
        | StepError::NotFinite { step, block }
        | StepError::Singular { step, block } => {
            value["step"] = (*step).into();
            value["block"] = (*block).into();
        }
    }
    value
}
