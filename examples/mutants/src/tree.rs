//! A copy of the project with all mutants in it, and its test programs.

use crate::list::Mutant;
use crate::rewrite::{Id, Region, rewrite};
use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Asked by every branch: which mutants are chosen, and which ones a test reaches.
const MODULE: &str = r#"
#[doc(hidden)]
pub mod mutation {
    //! Which mutants are chosen, and which are reached.
    use std::io::Write;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::{Acquire, Relaxed, Release}};
    use std::sync::{Mutex, OnceLock};

    /// Not asked the environment yet; some mutants, or none; no mutant, but what is reached is written down.
    const UNKNOWN: usize = 0;
    const CHOOSING: usize = 1;
    const TRACING: usize = 2;
    static MODE: AtomicUsize = AtomicUsize::new(UNKNOWN);
    static TRACE: OnceLock<Mutex<std::fs::File>> = OnceLock::new();
    static CHOSEN: [AtomicBool; 16384] = [const { AtomicBool::new(false) }; 16384];
    static REACHED: [AtomicBool; 16384] = [const { AtomicBool::new(false) }; 16384];

    /// Whether the mutant is chosen.
    #[inline]
    pub fn chosen(id: usize) -> bool {
        match MODE.load(Acquire) {
            CHOOSING => CHOSEN[id].load(Relaxed),
            TRACING => reached(id),
            _ => first(id),
        }
    }

    #[cold]
    fn first(id: usize) -> bool {
        if let Ok(path) = std::env::var("MUTANT_TRACE") {
            TRACE.get_or_init(|| Mutex::new(std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap()));
            MODE.store(TRACING, Release);
        } else {
            for number in std::env::var("MUTANTS").unwrap_or_default().split_whitespace() {
                CHOSEN[number.parse::<usize>().unwrap()].store(true, Relaxed);
            }
            MODE.store(CHOOSING, Release);
        }
        chosen(id)
    }

    #[cold]
    fn reached(id: usize) -> bool {
        if !REACHED[id].load(Relaxed) && !REACHED[id].swap(true, Relaxed) {
            writeln!(TRACE.get().unwrap().lock().unwrap(), "{id}").unwrap();
        }
        false
    }
}
"#;

/// Mutants that no branch holds, and why.
#[derive(Default, serde::Serialize, serde::Deserialize)]
pub struct Absent {
    /// The compiler refuses the change.
    pub uncompilable: BTreeSet<Id>,
    /// The change would compile, but not as a branch.
    pub unchoosable: BTreeSet<Id>,
}

impl Absent {
    fn holds(&self, id: Id) -> bool {
        self.uncompilable.contains(&id) || self.unchoosable.contains(&id)
    }
}

/// Copies the project without what is built, and puts the question into the model.
pub fn copy(project: &Path, tree: &Path) -> Result<()> {
    std::fs::create_dir_all(tree)?;
    let archive = Command::new("git").args(["archive", "HEAD"]).current_dir(project).stdout(Stdio::piped()).spawn()?;
    let status =
        Command::new("tar").args(["-x", "-C"]).arg(tree).stdin(archive.stdout.context("no archive")?).status()?;
    ensure!(status.success(), "the project cannot be copied");
    let model = tree.join("crates/model/src/lib.rs");
    let text = std::fs::read_to_string(&model)?;
    std::fs::write(model, text + MODULE)?;
    Ok(())
}

/// Writes the files with the mutants that are not absent, and checks them until the compiler takes all that is left.
pub fn make(project: &Path, tree: &Path, mutants: &[Mutant], absent: &mut Absent, kept: &Path) -> Result<()> {
    let mut files: BTreeMap<&str, Vec<(Id, &Mutant)>> = BTreeMap::new();
    for (at, mutant) in mutants.iter().enumerate() {
        files.entry(&mutant.file).or_default().push((at + 1, mutant));
    }
    let show = |command: &mut Command| -> Result<String> {
        let output = command.current_dir(project).output()?;
        ensure!(output.status.success(), "{command:?}");
        Ok(String::from_utf8(output.stdout)?)
    };
    loop {
        let mut regions: BTreeMap<String, Vec<Region>> = BTreeMap::new();
        for (file, all) in &files {
            let source = show(Command::new("git").arg("show").arg(format!("HEAD:{file}")))?;
            let chosen: Vec<(Id, &Mutant)> = all.iter().copied().filter(|(id, _)| !absent.holds(*id)).collect();
            let rewritten = rewrite(&source, &chosen).with_context(|| (*file).to_owned())?;
            absent.unchoosable.extend(rewritten.left_out);
            let path = tree.join(file);
            if std::fs::read_to_string(&path)? != rewritten.text {
                std::fs::write(&path, rewritten.text)?;
            }
            regions.insert((*file).to_owned(), rewritten.regions);
        }
        let errors = errors(tree)?;
        std::fs::write(kept, serde_json::to_string(absent)?)?;
        if errors.is_empty() {
            return Ok(());
        }
        let before = absent.uncompilable.len() + absent.unchoosable.len();
        let mut unknown = Vec::new();
        for (text, places) in errors {
            let mut found: Vec<&Region> = Vec::new();
            for (file, byte) in places {
                let here = regions.get(&file).into_iter().flatten().filter(|region| region.bytes.contains(&byte));
                found.extend(here.min_by_key(|region| region.bytes.len()));
            }
            // One alternative among the places of an error is to blame; if there is none, the innermost rewriting.
            let blamed = found.iter().find(|region| region.is_alternative).or(found.first());
            match blamed {
                Some(region) if region.is_alternative => absent.uncompilable.extend(&region.mutants),
                Some(region) => absent.unchoosable.extend(&region.mutants),
                None => unknown.push(text),
            }
        }
        let now = absent.uncompilable.len() + absent.unchoosable.len();
        eprintln!("{now} mutants cannot be built ({} more)", now - before);
        if now == before {
            bail!("errors that belong to no mutant:\n{}", unknown.join("\n"));
        }
    }
}

/// Errors of the compiler: text, and the places that it points at, its primary ones first.
type Errors = Vec<(String, Vec<(String, usize)>)>;

fn errors(tree: &Path) -> Result<Errors> {
    let output = Command::new("cargo")
        .args([
            "check",
            "--release",
            "--message-format=json",
            "--keep-going",
            "-p",
            "rockproof-oracle",
            "-p",
            "rockproof-stepper",
        ])
        .current_dir(tree)
        .stderr(Stdio::null())
        .output()?;
    let mut found = Vec::new();
    for line in String::from_utf8(output.stdout)?.lines() {
        let message: Value = serde_json::from_str(line)?;
        let message = &message["message"];
        if message["level"] != "error" {
            continue;
        }
        let Some(spans) = message["spans"].as_array().filter(|spans| !spans.is_empty()) else {
            continue;
        };
        let mut spans: Vec<&Value> = spans.iter().collect();
        spans.sort_by_key(|span| span["is_primary"] != true);
        // Where a macro was called, for what it wrote.
        let place = |span: &&Value| {
            let mut span = *span;
            while span["expansion"]["span"].is_object() {
                span = &span["expansion"]["span"];
            }
            Some((span["file_name"].as_str()?.to_owned(), span["byte_start"].as_u64()? as usize))
        };
        let text = message["rendered"].as_str().unwrap_or_default().to_owned();
        found.push((text, spans.iter().filter_map(place).collect()));
    }
    ensure!(output.status.success() || !found.is_empty(), "cargo check fails and says nothing of it");
    Ok(found)
}

/// Builds test programs and tells where they are.
pub fn test_programs(tree: &Path, packages: &[Vec<String>]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for arguments in packages {
        let output = Command::new("cargo")
            .args(["test", "--release", "--no-run", "--message-format=json"])
            .args(arguments)
            .current_dir(tree)
            .stderr(Stdio::inherit())
            .output()?;
        ensure!(output.status.success(), "cargo test --no-run {arguments:?} fails");
        for line in String::from_utf8(output.stdout)?.lines() {
            let message: Value = serde_json::from_str(line)?;
            if message["profile"]["test"] == true
                && let Some(program) = message["executable"].as_str()
            {
                found.push(PathBuf::from(program));
            }
        }
    }
    Ok(found)
}
