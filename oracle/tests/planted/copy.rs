//! A copy of the oracle with all mistakes in it, of which a variable of the environment chooses one at run time: so it is built once, and
//! not once for each mistake.

use crate::list::Mistake;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const CRATE: &str = env!("CARGO_MANIFEST_DIR");

/// The variable that names the mistake by its number.
const CHOICE: &str = "ROCKPROOF_MISTAKE";

/// No test takes so long; one that does will not end.
const LONGEST: Duration = Duration::from_secs(600);

/// What the copy's `lib.rs` holds besides: which mistake is made, 0 for none.
const SWITCH: &str = r#"
mod planted {
    pub(crate) fn number() -> usize {
        static NUMBER: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
        *NUMBER.get_or_init(|| std::env::var("ROCKPROOF_MISTAKE").ok().and_then(|n| n.parse().ok()).unwrap_or(0))
    }
}
"#;

/// The workspace's manifest without its own package; the tests have their debug sizes, integers wrap as they do in a release.
const PROFILE: &str = "
[profile.release.package.rockproof-oracle]
opt-level = 1
debug-assertions = true
overflow-checks = false
[profile.release.package.rockproof-model]
opt-level = 2
";

/// The sources with a choice at every place where a mistake can be made, by file.
pub(crate) fn changed_sources(mistakes: &[Mistake]) -> BTreeMap<String, String> {
    let mut places: BTreeMap<&str, BTreeMap<usize, Vec<&Mistake>>> = BTreeMap::new();
    let mut sources = BTreeMap::new();
    for mistake in mistakes {
        let source = sources.entry(mistake.file.clone()).or_insert_with(|| {
            let path = Path::new(CRATE).join(&mistake.file);
            std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        });
        let (around, begin) = match &mistake.within {
            Some(within) => (within.as_str(), only_place(source, within, mistake)),
            None => (source.as_str(), 0),
        };
        let place = begin + only_place(around, &mistake.old, mistake);
        places.entry(&mistake.file).or_default().entry(place).or_default().push(mistake);
    }
    for (file, places) in places {
        let source = sources.get_mut(file).expect("read above");
        let mut end = source.len();
        for (place, of_place) in places.into_iter().rev() {
            let old = &of_place[0].old;
            assert!(place + old.len() <= end, "\"{}\" overlaps another mistake", of_place[0].name);
            assert!(of_place.iter().all(|m| m.old == *old), "\"{}\" overlaps another mistake", of_place[0].name);
            let arms: String = of_place.iter().map(|m| format!("{} => {{ {} }} ", m.number, m.new)).collect();
            let choice = format!("(match crate::planted::number() {{ {arms} _ => {{ {old} }} }})");
            source.replace_range(place..place + old.len(), &choice);
            end = place;
        }
    }
    sources
}

/// Where a text occurs, once and no more.
fn only_place(source: &str, text: &str, mistake: &Mistake) -> usize {
    let found: Vec<usize> = source.match_indices(text).map(|(place, _)| place).collect();
    assert_eq!(found.len(), 1, "\"{}\": {text:?} occurs {} times in {}", mistake.name, found.len(), mistake.file);
    found[0]
}

/// How a test went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Passed,
    Failed,
    /// It was stopped after [`LONGEST`].
    Hung,
}

/// The crates of the copy: the oracle and those that it stands on.
const MEMBERS: &str = r#"members = ["oracle", "crates/cholesky", "crates/model"]"#;

/// The copy, built: its test programs by name, `lib` for the unit tests.
pub(crate) struct Copy {
    programs: BTreeMap<String, PathBuf>,
}

impl Copy {
    /// Copies and builds the programs of these tests; panics where that fails, as it does where a mistake does not compile.
    pub(crate) fn build(mistakes: &[Mistake], finders: &BTreeSet<&str>) -> Copy {
        let root = Path::new(CRATE).parent().expect("a workspace");
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("a target directory");
        let tree = target.join("planted-oracle");
        let _ = std::fs::remove_dir_all(&tree);
        for folder in ["oracle", "crates/cholesky", "crates/model", "tests/golden", "cases/handmade"] {
            copy_folder(&root.join(folder), &tree.join(folder));
        }
        std::fs::copy(root.join("Cargo.lock"), tree.join("Cargo.lock")).unwrap();
        let manifest = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
        let (workspace, _) = manifest.split_once("\n[package]").expect("the root is a package as well");
        let without = |line: &&str| !line.starts_with("default-members");
        let own = |line| if str::starts_with(line, "members = [") { MEMBERS } else { line };
        let manifest: String = workspace.lines().filter(without).flat_map(|line| [own(line), "\n"]).collect();
        assert!(manifest.contains(MEMBERS), "members are on one line");
        std::fs::write(tree.join("Cargo.toml"), manifest + "\n[profile.release]\ndebug = false\n" + PROFILE).unwrap();
        std::fs::remove_file(tree.join("oracle/tests/planted.rs")).unwrap();
        for (file, text) in changed_sources(mistakes) {
            std::fs::write(tree.join("oracle").join(file), text).unwrap();
        }
        let library = tree.join("oracle/src/lib.rs");
        let text = std::fs::read_to_string(&library).unwrap();
        std::fs::write(&library, format!("#![allow(unused_parens)]\n{text}{SWITCH}")).unwrap();
        let programs: BTreeSet<&str> = finders.iter().map(|finder| program_of(finder).0).collect();
        let built = Command::new(env!("CARGO"))
            .args(["test", "--release", "--offline", "--no-run", "--package", "rockproof-oracle"])
            .args(programs.iter().flat_map(|&program| match program {
                "lib" => vec!["--lib"],
                _ => vec!["--test", program],
            }))
            .args(["--message-format", "json-render-diagnostics"])
            .env("CARGO_TARGET_DIR", target)
            .current_dir(&tree)
            .stderr(Stdio::inherit())
            .output()
            .unwrap();
        assert!(built.status.success(), "the copy does not build");
        let mut programs = BTreeMap::new();
        for line in String::from_utf8(built.stdout).unwrap().lines() {
            let message: serde_json::Value = serde_json::from_str(line).unwrap();
            let (Some(path), target) = (message["executable"].as_str(), &message["target"]) else { continue };
            let name = if target["kind"][0] == "lib" { Some("lib") } else { target["name"].as_str() };
            programs.insert(name.expect("a target has a name").to_owned(), PathBuf::from(path));
        }
        Copy { programs }
    }

    /// Runs one test, named as in [`Mistake::found_by`], with one mistake, 0 for none.
    pub(crate) fn run(&self, mistake: usize, finder: &str) -> Outcome {
        let (program, test) = program_of(finder);
        let path = self.programs.get(program).unwrap_or_else(|| panic!("no test program \"{program}\""));
        let listed = Command::new(path).args([test, "--exact", "--list"]).output().unwrap();
        assert!(String::from_utf8_lossy(&listed.stdout).contains(": test"), "no test \"{finder}\"");
        let mut child = Command::new(path)
            .args([test, "--exact"])
            .current_dir(CRATE)
            .env(CHOICE, mistake.to_string())
            // What a mistake makes fail is no case to keep.
            .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        loop {
            if let Some(status) = child.try_wait().unwrap() {
                return if status.success() { Outcome::Passed } else { Outcome::Failed };
            }
            if begun.elapsed() > LONGEST {
                child.kill().unwrap();
                child.wait().unwrap();
                return Outcome::Hung;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// The test program of a finder, and the test.
fn program_of(finder: &str) -> (&str, &str) {
    finder.split_once(' ').unwrap_or_else(|| panic!("\"{finder}\" names no test"))
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (path, place) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &place);
        } else {
            std::fs::copy(&path, &place).unwrap();
        }
    }
}
