//! The directory of a run, so that it can be killed at any moment and go on.
//!
//! Rows are appended to the tables step by step. A checkpoint makes them durable, then replaces `checkpoint.jsonl` in one
//! step: the state, how long each table is, which frames there are. What came after the last such step is cut off on
//! resuming and made again, byte for byte, because it depends on scene and state alone.

use crate::checkpoint::Saved;
use crate::exact::Exact;
use crate::identity::digest;
use crate::totals::Totals;
use crate::vtu;
use rockproof_model::files::write_atomically;
use rockproof_results::identity_differences;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What a run knows of itself between two steps, beside its state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Progress {
    /// What must be the same for the run to go on.
    pub identity: Map<String, Value>,
    /// Lengths of the tables in bytes, by [`Table`].
    pub bytes: [u64; Table::COUNT],
    /// The frames every so many steps.
    pub frames: Vec<Frame>,
    /// The frame at the end of the run, where none of the others is. A run that goes on does not keep it.
    pub last_frame: Option<Frame>,
    /// Sums over all steps.
    pub totals: Totals,
    /// Sums over all steps of what lockstep found, by name; empty without it.
    pub beside: BTreeMap<String, u64>,
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
    pub time: Exact,
}

/// The form of `checkpoint.jsonl`. Form 1, which did not say so, had no Δt of the last step and was of version 1 of SPEC.
const FORM: u32 = 2;

/// The content of `checkpoint.jsonl`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Checkpoint {
    form: u32,
    progress: Progress,
    state: Saved,
}

/// Of a checkpoint of whatever form, which one it is.
#[derive(Deserialize)]
struct Form {
    #[serde(default = "first_form")]
    form: u32,
}

fn first_form() -> u32 {
    1
}

impl Checkpoint {
    /// Reads the first line of `checkpoint.jsonl`, or tells why it is none.
    fn read(line: &str) -> Result<Checkpoint, String> {
        let Form { form } = serde_json::from_str(line).map_err(|e| e.to_string())?;
        if form != FORM {
            return Err(format!("it is of form {form}, this program goes on from form {FORM}"));
        }
        serde_json::from_str(line).map_err(|e| e.to_string())
    }
}

/// The second line of `checkpoint.jsonl`: what the first must be.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Seal {
    sha256: String,
}

/// A table that grows with every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
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

impl Table {
    /// How many there are.
    pub const COUNT: usize = 6;

    const ALL: [Table; Table::COUNT] =
        [Table::Steps, Table::Measured, Table::Contacts, Table::Lockstep, Table::Differences, Table::Free];

    fn name(self) -> &'static str {
        match self {
            Table::Steps => "steps.csv",
            Table::Measured => "measured.csv",
            Table::Contacts => "contacts.csv",
            Table::Lockstep => "lockstep.csv",
            Table::Differences => "differences.csv",
            Table::Free => "free.csv",
        }
    }
}

/// The two pictures of a frame.
const PICTURES: [&str; 2] = ["blocks", "contacts"];
const FRAMES: &str = "frames";
const STATES: &str = "states";
const CHECKPOINT: &str = "checkpoint.jsonl";
/// Every file of a run but the tables and frames.
const OTHERS: [&str; 5] = ["blocks.pvd", "contacts.pvd", "scene.toml", "run.json", CHECKPOINT];

/// How to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// In a directory that holds no run.
    Fresh,
    /// From the last checkpoint of the same run; from the beginning if there is none.
    Resume,
    /// From the beginning, discarding the run in the directory.
    Overwrite,
}

/// Why a run cannot be started, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The directory holds another run.
    #[error("{dir} holds a run already; --resume goes on with it, --overwrite discards it, --out DIR writes elsewhere")]
    Occupied {
        /// The directory.
        dir: PathBuf,
    },
    /// The run in the directory is another one.
    #[error(
        "{dir} holds another run, so it cannot go on:\n  {}\nrun it as it was started, or use --overwrite or --out DIR",
        differences.join("\n  ")
    )]
    OtherRun {
        /// The directory.
        dir: PathBuf,
        /// One line for each key.
        differences: Vec<String>,
    },
    /// A file of the run is damaged.
    #[error("{file}: {what}; --overwrite starts again")]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A file cannot be read or written.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
}

fn at(file: &Path) -> impl FnOnce(io::Error) -> RecordError {
    let file = file.to_owned();
    move |source| RecordError::Io { file, source }
}

fn damaged(file: &Path, what: impl ToString) -> RecordError {
    RecordError::Damaged { file: file.to_owned(), what: what.to_string() }
}

/// A run on disk.
#[derive(Debug)]
pub struct Record {
    dir: PathBuf,
    /// By [`Table`]; the contacts only where asked for.
    tables: [Option<File>; Table::COUNT],
    progress: Progress,
}

impl Record {
    /// Opens the run in `dir`, or makes one. With it the state to go on from; none at the beginning.
    ///
    /// `headers` are the first lines of the tables, by [`Table`]; a table without one is not written.
    ///
    /// # Errors
    /// When the directory holds a run that may not be touched, or cannot be written.
    pub fn open(
        dir: &Path,
        identity: Map<String, Value>,
        headers: [Option<Vec<u8>>; Table::COUNT],
        start: Start,
    ) -> Result<(Record, Option<Saved>), RecordError> {
        let held = Table::ALL.iter().map(|t| t.name()).chain(OTHERS).any(|name| dir.join(name).exists());
        match start {
            Start::Fresh if held => return Err(RecordError::Occupied { dir: dir.to_owned() }),
            Start::Resume if dir.join(CHECKPOINT).exists() => return Record::resume(dir, &identity),
            Start::Overwrite | Start::Resume if held => discard(dir)?,
            _ => {}
        }
        let frames = dir.join(FRAMES);
        fs::create_dir_all(&frames).map_err(at(&frames))?;
        let progress = Progress { identity, ..Progress::default() };
        let mut record = Record { dir: dir.to_owned(), tables: [const { None }; Table::COUNT], progress };
        for (table, header) in Table::ALL.into_iter().zip(headers) {
            if let Some(header) = header {
                let path = dir.join(table.name());
                record.tables[table as usize] = Some(File::create(&path).map_err(at(&path))?);
                record.append(table, &header)?;
            }
        }
        Ok((record, None))
    }

    fn resume(dir: &Path, identity: &Map<String, Value>) -> Result<(Record, Option<Saved>), RecordError> {
        let path = dir.join(CHECKPOINT);
        let text = fs::read_to_string(&path).map_err(at(&path))?;
        let no_checkpoint = |why: &dyn ToString| damaged(&path, format!("no checkpoint ({})", why.to_string()));
        let (first, second) = text.split_once('\n').ok_or_else(|| no_checkpoint(&"one line"))?;
        let seal: Seal = serde_json::from_str(second).map_err(|e| no_checkpoint(&e))?;
        if seal.sha256 != digest(first.as_bytes()) {
            return Err(damaged(&path, "the checkpoint is not as it was written"));
        }
        let Checkpoint { mut progress, state, .. } = Checkpoint::read(first).map_err(|e| no_checkpoint(&e))?;
        let differences = identity_differences(&progress.identity, identity);
        if !differences.is_empty() {
            return Err(RecordError::OtherRun { dir: dir.to_owned(), differences });
        }
        let mut tables = [const { None }; Table::COUNT];
        for table in Table::ALL {
            let bytes = progress.bytes[table as usize];
            if bytes > 0 {
                tables[table as usize] = Some(cut(&dir.join(table.name()), bytes)?);
            }
        }
        progress.resumed += 1;
        progress.last_frame = None;
        let frames = dir.join(FRAMES);
        fs::create_dir_all(&frames).map_err(at(&frames))?;
        sweep(dir, &progress.frames)?;
        Ok((Record { dir: dir.to_owned(), tables, progress }, Some(state)))
    }

    /// What is known of the run.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The same, to change it.
    pub fn progress_mut(&mut self) -> &mut Progress {
        &mut self.progress
    }

    /// The directory of the run.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Names of the files and folders it writes.
    pub fn names(&self) -> Vec<&'static str> {
        let tables = Table::ALL.into_iter().filter(|t| self.tables[*t as usize].is_some()).map(Table::name);
        let states = self.tables[Table::Differences as usize].is_some().then_some(STATES);
        tables.chain(OTHERS).chain([FRAMES]).chain(states).collect()
    }

    /// Appends rows to a table; nothing for a table that is not written.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn append(&mut self, table: Table, rows: &[u8]) -> Result<(), RecordError> {
        let Some(file) = &mut self.tables[table as usize] else { return Ok(()) };
        file.write_all(rows).map_err(at(&self.dir.join(table.name())))?;
        self.progress.bytes[table as usize] += rows.len() as u64;
        Ok(())
    }

    /// Writes the pictures of a frame, first the blocks, then the contacts.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn write_frame(&self, frame: Frame, pictures: [&[u8]; 2]) -> Result<(), RecordError> {
        PICTURES.iter().zip(pictures).try_for_each(|(name, bytes)| self.write(&picture(name, frame.step), bytes))
    }

    /// Writes a state file, beside its final name first.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_state(&self, name: &str, bytes: &[u8]) -> Result<(), RecordError> {
        let states = self.dir.join(STATES);
        fs::create_dir_all(&states).map_err(at(&states))?;
        self.write(&format!("{STATES}/{name}"), bytes)
    }

    /// Makes everything written so far what a resumed run goes on from, together with `state`.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn commit(&mut self, state: Saved) -> Result<(), RecordError> {
        for (table, file) in Table::ALL.into_iter().zip(&self.tables) {
            if let Some(file) = file {
                file.sync_data().map_err(at(&self.dir.join(table.name())))?;
            }
        }
        let checkpoint = Checkpoint { form: FORM, progress: self.progress.clone(), state };
        let path = self.dir.join(CHECKPOINT);
        let no_text = |e: serde_json::Error| at(&path)(e.into());
        let mut text = serde_json::to_vec(&checkpoint).map_err(no_text)?;
        let seal = serde_json::to_vec(&Seal { sha256: digest(&text) }).map_err(no_text)?;
        text.push(b'\n');
        text.extend(seal);
        text.push(b'\n');
        self.write(CHECKPOINT, &text)?;
        for name in PICTURES {
            let frames = self.progress.frames.iter().chain(&self.progress.last_frame);
            let files: Vec<_> = frames.map(|frame| (frame.time.0, picture(name, frame.step))).collect();
            let list = format!("{name}.pvd");
            self.write(&list, &vtu::pvd(&files).map_err(at(&self.dir.join(&list)))?)?;
        }
        Ok(())
    }

    /// Writes a file of the run beside its final name and renames it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), RecordError> {
        let path = self.dir.join(name);
        write_atomically(&path, bytes).map_err(at(&path))
    }
}

/// The name of a picture within the directory of the run.
fn picture(name: &str, step: u64) -> String {
    format!("{FRAMES}/{name}_{step:06}.vtu")
}

/// Opens a table to append to its first `bytes`.
fn cut(path: &Path, bytes: u64) -> Result<File, RecordError> {
    let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(at(path))?;
    let length = file.metadata().map_err(at(path))?.len();
    if length < bytes {
        return Err(damaged(path, format!("{length} bytes long, but {bytes} were written")));
    }
    file.set_len(bytes).map_err(at(path))?;
    file.seek(SeekFrom::End(0)).map_err(at(path))?;
    Ok(file)
}

/// Whether a name is that of a picture.
fn is_picture(name: &str) -> bool {
    let step = PICTURES.iter().find_map(|picture| name.strip_prefix(picture)?.strip_prefix('_')?.strip_suffix(".vtu"));
    step.is_some_and(|step| step.len() >= 6 && step.bytes().all(|b| b.is_ascii_digit()))
}

/// Whether a name is that of a state file.
fn is_state(name: &str) -> bool {
    let step = name.strip_prefix("step_").and_then(|name| name.strip_suffix(".json"));
    step.is_some_and(|step| {
        step.trim_start_matches('-').len() >= 6 && step.bytes().all(|b| b.is_ascii_digit() || b == b'-')
    })
}

/// Removes the files of `folder` that `unwanted` names.
fn remove(folder: &Path, unwanted: impl Fn(&str) -> bool) -> Result<(), RecordError> {
    if folder.is_dir() {
        for entry in fs::read_dir(folder).map_err(at(folder))? {
            let path = entry.map_err(at(folder))?.path();
            if path.file_name().and_then(|name| name.to_str()).is_some_and(&unwanted) {
                fs::remove_file(&path).map_err(at(&path))?;
            }
        }
    }
    Ok(())
}

/// What a kill left of a file that was being written: the name it would have had.
fn unfinished(name: &str) -> Option<&str> {
    let rest = name.strip_prefix('.')?.strip_suffix(".tmp")?;
    let mut parts = rest.rsplitn(3, '.');
    let numbers = [parts.next()?, parts.next()?];
    let name = parts.next()?;
    numbers.iter().all(|n| n.bytes().all(|b| b.is_ascii_digit())).then_some(name)
}

/// Removes pictures that belong to none of `frames`, and what a kill left of files that were being written.
fn sweep(dir: &Path, frames: &[Frame]) -> Result<(), RecordError> {
    let wanted: std::collections::HashSet<String> =
        frames.iter().flat_map(|frame| PICTURES.map(|name| picture(name, frame.step))).collect();
    let is_wanted = |name: &str| wanted.contains(&format!("{FRAMES}/{name}"));
    remove(&dir.join(FRAMES), |name| is_picture(name) && !is_wanted(name) || unfinished(name).is_some_and(is_picture))?;
    remove(dir, |name| unfinished(name).is_some_and(|name| OTHERS.contains(&name)))
}

/// Removes the files of a run, and nothing else.
fn discard(dir: &Path) -> Result<(), RecordError> {
    sweep(dir, &[])?;
    remove(&dir.join(STATES), |name| is_state(unfinished(name).unwrap_or(name)))?;
    remove(dir, |name| OTHERS.contains(&name) || Table::ALL.iter().any(|table| table.name() == name))
}

#[cfg(test)]
mod tests {
    use super::{Checkpoint, FORM, Progress, Table, is_picture, is_state, unfinished};
    use crate::checkpoint::Saved;
    use rockproof_stepper::dynamics::State;

    #[test]
    fn a_checkpoint_of_another_form_is_refused_by_its_form() {
        let nothing = Vec::new;
        let state = State::<f64> {
            step: 3,
            time: 0.03,
            settling: 0,
            last_time_step: 0.01,
            blocks: Vec::new(),
            load_points: nothing(),
            fixed_points: nothing(),
            measured_points: nothing(),
            contacts: Vec::new(),
        };
        let (progress, state) = (Progress::default(), Saved::of(&state));
        let checkpoint = Checkpoint { form: FORM, progress, state: state.clone() };
        let text = serde_json::to_string(&checkpoint).expect("JSON");
        let read = Checkpoint::read(&text).unwrap_or_else(|why| panic!("{why}"));
        assert_eq!((read.state, read.progress.bytes), (state, [0; Table::COUNT]));
        // As version 1 wrote it.
        let old = text.replacen("\"form\":2,", "", 1);
        let start = old.find("\"last_time_step\"").expect("the field");
        let end = start + old[start..].find(',').expect("another field") + 1;
        let old = format!("{}{}", &old[..start], &old[end..]);
        assert_eq!(Checkpoint::read(&old).err().as_deref(), Some("it is of form 1, this program goes on from form 2"));
        let later = text.replacen("\"form\":2", "\"form\":3", 1);
        assert_eq!(
            Checkpoint::read(&later).err().as_deref(),
            Some("it is of form 3, this program goes on from form 2")
        );
    }

    #[test]
    fn knows_its_own_files() {
        assert!(is_picture("blocks_000010.vtu") && is_picture("contacts_1234567.vtu"));
        for other in ["blocks_10.vtu", "blocks_000010.vtk", "my_000010.vtu", "blocks_00001x.vtu", "blocks.pvd"] {
            assert!(!is_picture(other), "{other}");
        }
        assert!(is_state("step_000012.json") && is_state("step_-000004.json"));
        assert!(!is_state("step_12.json") && !is_state("my_000012.json") && !is_state("step_00001x.json"));
        assert_eq!(unfinished(".run.json.71.0.tmp"), Some("run.json"));
        assert_eq!(unfinished(".blocks_000010.vtu.71.12.tmp"), Some("blocks_000010.vtu"));
        assert_eq!([".run.json", "run.json.71.0.tmp", ".run.json.x.0.tmp", ".0.tmp"].map(unfinished), [None; 4]);
    }
}
