//! The directory of a run, so that it can be killed at any moment and go on.
//!
//! Rows are appended to the tables step by step. A checkpoint makes them durable, then replaces `checkpoint.jsonl` in one
//! step: the state, the seal of each table, which frames there are. What came after the last such step is cut off on
//! resuming and made again, byte for byte, because it depends on scene and state alone.

use crate::checkpoint::SavedState;
use crate::exact_float::ExactFloat;
use crate::run::RunError;
use crate::tables;
use crate::totals::Totals;
use crate::worst_intrusions::{INTRUSIONS, IntrusionRow, WorstIntrusion};
use rockproof_model::vtu_writer;
use rockproof_results as results;
use rockproof_results::{Claim, Directory, FileKind, Owner, ResultsError, Seal, Start, identity_differences};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// What a run knows of itself between two steps, beside its state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunProgress {
    /// What must be the same for the run to go on.
    pub identity: Map<String, Value>,
    /// What the tables hold, by [`RunTable`]; none for a table that is not written.
    pub tables: [Option<Seal>; RunTable::COUNT],
    /// The frames every so many steps.
    pub frames: Vec<Frame>,
    /// The frame at the end of the run, where none of the others is. A run that goes on does not keep it.
    pub last_frame: Option<Frame>,
    /// Sums over all steps.
    pub totals: Totals,
    /// Sums over all steps of what lockstep found, by name; empty without it.
    pub beside: BTreeMap<String, u64>,
    /// Passages and unseen overlaps that get a case; empty without an audit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub intrusions: Vec<WorstIntrusion>,
    /// Seconds of work, over all sessions.
    pub seconds: f64,
    /// How often the run was taken up again.
    pub resumed: u64,
}

/// A frame: a picture of the blocks and one of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// After which step.
    pub step: u64,
    /// The time then (s).
    pub time: ExactFloat,
}

/// The form of `checkpoint.jsonl`. Form 1, which did not say so, had no Δt of the last step and was of version 1 of SPEC; runs of
/// form 2 have a `steps.csv` without columns for the audit, those of form 3 one without the pairs that springs explain.
const FORM: u32 = 4;

/// The content of `checkpoint.jsonl`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Checkpoint {
    form: u32,
    progress: RunProgress,
    state: SavedState,
}

/// A table that grows with every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunTable {
    /// `steps.csv`
    Steps,
    /// `measured.csv`
    Measured,
    /// `contacts.csv`
    Contacts,
    /// `lockstep.csv`
    Lockstep,
    /// `differences.csv`
    Differences,
    /// `free.csv`
    Free,
}

impl RunTable {
    /// How many there are.
    pub const COUNT: usize = 6;

    const ALL: [RunTable; RunTable::COUNT] = [
        RunTable::Steps,
        RunTable::Measured,
        RunTable::Contacts,
        RunTable::Lockstep,
        RunTable::Differences,
        RunTable::Free,
    ];

    fn name(self) -> &'static str {
        match self {
            RunTable::Steps => "steps.csv",
            RunTable::Measured => "measured.csv",
            RunTable::Contacts => "contacts.csv",
            RunTable::Lockstep => "lockstep.csv",
            RunTable::Differences => "differences.csv",
            RunTable::Free => "free.csv",
        }
    }
}

/// The two pictures of a frame.
const PICTURES: [&str; 2] = ["blocks", "contacts"];
const FRAMES: &str = "frames";
const STATES: &str = "states";
const CASES: &str = "cases";
const CHECKPOINT: &str = "checkpoint.jsonl";
/// Every file of a run but the tables, frames and states.
const OTHERS: [&str; 5] = ["blocks.pvd", "contacts.pvd", "scene.toml", "run.json", CHECKPOINT];

/// A run on disk.
#[derive(Debug)]
pub struct RunRecord {
    directory: Directory,
    /// By [`RunTable`]; the contacts only where asked for.
    tables: [Option<results::AppendedTable>; RunTable::COUNT],
    progress: RunProgress,
    /// The rows of `intrusions.csv`, once they are written.
    intrusions: Vec<IntrusionRow>,
}

impl RunRecord {
    /// Opens the run in `dir`, or makes one. With it the state to go on from; none at the beginning.
    ///
    /// `headers` are the first lines of the tables, by [`RunTable`]; a table without one is not written.
    ///
    /// # Errors
    /// When the directory holds something that may not be touched, or cannot be written.
    pub fn open(
        dir: &Path,
        identity: Map<String, Value>,
        headers: [Option<Vec<u8>>; RunTable::COUNT],
        start: Start,
    ) -> Result<(RunRecord, Option<SavedState>), ResultsError> {
        let written = RunTable::ALL.into_iter().zip(&headers).filter(|(_, header)| header.is_some());
        let audited = identity.contains_key("audit").then_some(INTRUSIONS);
        let files: Vec<_> = written.map(|(table, _)| table.name()).chain(OTHERS).chain(audited).collect();
        let mut directory = Directory::claim(Claim { dir, owner: Owner::Simulate, start, files: &files })?;
        if directory.is_resumable(CHECKPOINT, RunTable::Steps.name())? {
            return RunRecord::resume(directory, &identity);
        }
        directory.make_folder(FRAMES)?;
        let mut tables = [const { None }; RunTable::COUNT];
        for (table, header) in RunTable::ALL.into_iter().zip(headers) {
            tables[table as usize] = header.map(|header| directory.begin_table(table.name(), &header)).transpose()?;
        }
        let progress = RunProgress { identity, ..RunProgress::default() };
        Ok((RunRecord { directory, tables, progress, intrusions: Vec::new() }, None))
    }

    fn resume(
        mut directory: Directory,
        identity: &Map<String, Value>,
    ) -> Result<(RunRecord, Option<SavedState>), ResultsError> {
        let Checkpoint { form, mut progress, state } = directory.read_sealed(CHECKPOINT)?;
        if form != FORM {
            let (file, what) = (directory.path().join(CHECKPOINT), format!("it is of form {form}, not {FORM}"));
            return Err(ResultsError::Damaged { file, what });
        }
        let differences = identity_differences(&progress.identity, identity);
        if !differences.is_empty() {
            let (dir, owner) = (directory.path().to_owned(), directory.owner());
            return Err(ResultsError::OtherIdentity { dir, owner, differences });
        }
        let sealed = RunTable::ALL.into_iter().filter_map(|t| Some((t, progress.tables[t as usize].as_ref()?)));
        let mut resumed = directory.resume_tables(sealed.map(|(table, seal)| (table.name(), seal)))?.into_iter();
        let tables = RunTable::ALL.map(|t| progress.tables[t as usize].as_ref().and_then(|_| resumed.next()));
        progress.resumed += 1;
        progress.last_frame = None;
        // What came after the checkpoint is made again.
        let wanted: std::collections::HashSet<String> =
            progress.frames.iter().flat_map(|frame| PICTURES.map(|name| picture(name, frame.step))).collect();
        directory.remove(|name| name.starts_with(&format!("{FRAMES}/")) && !wanted.contains(name))?;
        Ok((RunRecord { directory, tables, progress, intrusions: Vec::new() }, Some(state)))
    }

    /// What is known of the run.
    pub fn progress(&self) -> &RunProgress {
        &self.progress
    }

    /// The same, to change it.
    pub fn progress_mut(&mut self) -> &mut RunProgress {
        &mut self.progress
    }

    /// The directory of the run.
    pub fn dir(&self) -> &Path {
        self.directory.path()
    }

    /// Whether it can be gone on with: the exact trajectory beside it is kept in no checkpoint.
    pub fn can_be_resumed(&self) -> bool {
        self.tables[RunTable::Free as usize].is_none()
    }

    /// Names of the files and folders it writes.
    pub fn names(&self) -> Vec<&'static str> {
        let tables = RunTable::ALL.into_iter().filter(|t| self.tables[*t as usize].is_some()).map(RunTable::name);
        let states = self.tables[RunTable::Differences as usize].is_some().then_some(STATES);
        let found = if self.intrusions.is_empty() { &[][..] } else { &[INTRUSIONS, CASES] };
        tables.chain(OTHERS).chain([FRAMES]).chain(states).chain(found.iter().copied()).collect()
    }

    /// Appends rows to a table; nothing for a table that is not written.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn append(&mut self, table: RunTable, rows: &[u8]) -> Result<(), ResultsError> {
        self.tables[table as usize].as_mut().map_or(Ok(()), |table| table.append(rows))
    }

    /// Writes the pictures of a frame, first the blocks, then the contacts.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn write_frame(&mut self, frame: Frame, pictures: [&[u8]; 2]) -> Result<(), ResultsError> {
        let pictures = PICTURES.into_iter().zip(pictures);
        self.directory.write_all(pictures.map(|(name, bytes)| (picture(name, frame.step), FileKind::Picture, bytes)))
    }

    /// Writes a state file, beside its final name first.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_state(&mut self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        self.directory.write(&format!("{STATES}/{name}"), FileKind::Case, bytes)
    }

    /// The passages and unseen overlaps that got a case in this session, by cause.
    pub fn intrusions(&self) -> &[IntrusionRow] {
        &self.intrusions
    }

    /// Writes `intrusions.csv` and the cases that it names, in place of those that were there; nothing where there are no rows.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write_intrusions(&mut self, rows: Vec<IntrusionRow>, cases: &[(String, Vec<u8>)]) -> Result<(), RunError> {
        self.directory
            .remove(|name| name.starts_with(&format!("{CASES}/")) && cases.iter().all(|(case, _)| case != name))?;
        if !rows.is_empty() {
            let cells =
                [IntrusionRow::COLUMNS.map(str::to_owned)].into_iter().chain(rows.iter().map(IntrusionRow::cells));
            let table = tables::lines(cells)?;
            let files = cases.iter().map(|(name, bytes)| (name.clone(), FileKind::Case, &bytes[..]));
            self.directory.write_all(files.chain([(INTRUSIONS.to_owned(), FileKind::Table, &table[..])]))?;
        }
        self.intrusions = rows;
        Ok(())
    }

    /// Makes everything written so far what a resumed run goes on from, together with `state`.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn commit(&mut self, state: SavedState) -> Result<(), ResultsError> {
        for (seal, table) in self.progress.tables.iter_mut().zip(&self.tables) {
            *seal = table.as_ref().map(results::AppendedTable::seal).transpose()?;
        }
        self.directory.write_sealed(CHECKPOINT, &Checkpoint { form: FORM, progress: self.progress.clone(), state })?;
        for name in PICTURES {
            let frames = self.progress.frames.iter().chain(&self.progress.last_frame);
            let files: Vec<_> = frames.map(|frame| (frame.time.0, picture(name, frame.step))).collect();
            let list = format!("{name}.pvd");
            let text = vtu_writer::pvd(&files).map_err(ResultsError::at(&self.dir().join(&list)))?;
            self.directory.write(&list, FileKind::Picture, &text)?;
        }
        Ok(())
    }

    /// Writes `scene.toml` or `run.json`, beside its final name first.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        let kind = if name.ends_with(".toml") { FileKind::Input } else { FileKind::Run };
        self.directory.write(name, kind, bytes)
    }
}

/// The name of a picture within the directory of the run.
fn picture(name: &str, step: u64) -> String {
    format!("{FRAMES}/{name}_{step:06}.vtu")
}
