//! Which command a directory belongs to, and which files in it that command wrote.

use super::atomic::write_atomically;
use super::bounded_read::read_whole;
use super::error::ResultsError;
use super::seal::{sealed, unsealed};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Component, Path};

/// The name of the manifest.
pub const MANIFEST: &str = "rockproof.manifest.json";

/// A command that writes directories of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Owner {
    /// `rockproof campaign`
    Campaign,
    /// `rockproof simulate`
    Simulate,
    /// `rockproof tune`
    Tune,
    /// `rockproof gate`
    Gate,
    /// `rockproof bench`
    Bench,
    /// `rockproof examine`
    Examine,
    /// `rockproof report`
    Report,
    /// The example `self_comparison`
    #[serde(rename = "self_comparison")]
    SelfComparison,
}

impl Owner {
    /// The command's name.
    pub fn name(self) -> &'static str {
        match self {
            Owner::Campaign => "campaign",
            Owner::Simulate => "simulate",
            Owner::Tune => "tune",
            Owner::Gate => "gate",
            Owner::Bench => "bench",
            Owner::Examine => "examine",
            Owner::Report => "report",
            Owner::SelfComparison => "self_comparison",
        }
    }

    /// How it is called on a command line, without its arguments.
    pub fn command(self) -> String {
        match self {
            Owner::SelfComparison => format!("cargo run --example {self}"),
            command => format!("rockproof {command}"),
        }
    }

    /// What it writes, in a sentence.
    pub(crate) fn results(self) -> &'static str {
        match self {
            Owner::Campaign | Owner::Gate => "a campaign",
            Owner::Simulate => "a run",
            Owner::Tune => "a search",
            Owner::Bench => "measurements",
            Owner::Examine => "an examination",
            Owner::Report => "a report",
            Owner::SelfComparison => "a comparison",
        }
    }

    /// Whether it goes on with what is there when asked to.
    pub(crate) fn resumes(self) -> bool {
        matches!(self, Owner::Campaign | Owner::Simulate | Owner::Tune | Owner::SelfComparison)
    }
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FileKind {
    /// Rows of CSV.
    Table,
    /// What the run knows of itself: configuration, progress, checkpoint.
    Run,
    /// Something to replay.
    Case,
    /// Blocks or contacts for ParaView, or a plot.
    Picture,
    /// An input of this program: a scene, a tolerance set.
    Input,
    /// Something to read.
    Text,
}

/// Whose results a directory holds of which a file is none; `None` where it is one, or no manifest tells.
pub fn owner_without(dir: &Path, file: &str) -> Option<Owner> {
    let manifest = Manifest::read(dir).ok().flatten()?;
    (!manifest.files.contains_key(file)).then_some(manifest.owner)
}

/// The content of the manifest.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    pub(crate) owner: Owner,
    /// What each file is, by its path within the directory, the parts separated by `/`.
    pub(crate) files: BTreeMap<String, FileKind>,
}

impl Manifest {
    /// The manifest of a directory, if it has one.
    pub(crate) fn read(dir: &Path) -> Result<Option<Manifest>, ResultsError> {
        let file = dir.join(MANIFEST);
        if file.exists() && !file.is_file() {
            let what = "it is a folder or a device, not a file".to_owned();
            return Err(ResultsError::Manifest { file, what });
        }
        let text = match read_whole(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(ResultsError::at(&file))?,
        };
        let damaged = |what: &dyn fmt::Display| ResultsError::Manifest { file: file.clone(), what: what.to_string() };
        let text = std::str::from_utf8(&text).map_err(|e| damaged(&e))?;
        let object = unsealed(text).map_err(|e| damaged(&e))?;
        let manifest: Manifest = serde_json::from_str(&object).map_err(|e| damaged(&e))?;
        if let Some(outside) = manifest.files.keys().find(|name| !is_inside(name)) {
            return Err(damaged(&format_args!("\"{outside}\" is not in the directory")));
        }
        Ok(Some(manifest))
    }

    pub(crate) fn write(&self, dir: &Path) -> Result<(), ResultsError> {
        let file = dir.join(MANIFEST);
        let text = serde_json::to_string_pretty(self).map_err(|e| ResultsError::at(&file)(e.into()))?;
        write_atomically(&file, sealed(&text)).map_err(ResultsError::at(&file))
    }
}

/// Whether a name, as a manifest or a table has it, is that of a file within a directory: it leads nowhere else.
pub fn is_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}
