//! What the documents show is what the program does: every command in a `console` block of README.md and docs/finding.md is
//! run, in order, and its output compared.
//!
//! A line `$ command` may end in `# exits 1`. Lines below it are its output; `…` stands for any lines left out, and a
//! command without lines below it only has to succeed. With ROCKPROOF_RENEW=1 the outputs are written anew instead.

use std::fs;
use std::path::Path;
use std::process::Command;

const DOCUMENTS: [&str; 2] = ["README.md", "docs/finding.md"];
/// Commands that are too long to run within a test, or that are the test; they must be in `.ci/run` as they stand.
const RUN_BY_CI: [&str; 1] = ["cargo test --release"];
/// The campaign without arguments takes a minute; here it is a short one.
const SHORT_CAMPAIGN: [&str; 2] = ["--pairs", "64"];

/// One command of a document and what is shown below it.
#[derive(Debug, PartialEq)]
struct Shown {
    command: String,
    exit: i32,
    output: Vec<String>,
    /// Lines of the document that hold the output.
    lines: std::ops::Range<usize>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn shown(document: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = Vec::new();
    let mut inside = false;
    for (number, line) in document.lines().enumerate() {
        if line.starts_with("```") {
            inside = line == "```console";
        } else if let (true, Some(text)) = (inside, line.strip_prefix("$ ")) {
            let (command, exit) = match text.split_once("# exits ") {
                Some((command, code)) => (command.trim(), code.trim().parse().unwrap()),
                None => (text.trim(), 0),
            };
            let output = Vec::new();
            found.push(Shown { command: command.to_owned(), exit, output, lines: number + 1..number + 1 });
        } else if inside {
            let last = found.last_mut().unwrap_or_else(|| panic!("output without a command: {line}"));
            last.output.push(line.trim_end().to_owned());
            last.lines.end = number + 1;
        }
    }
    found
}

/// Runs a command in `folder` and gives its standard output; `None` for one that the CI runs.
fn run(shown: &Shown, folder: &Path) -> Option<Vec<String>> {
    let command = shown.command.as_str();
    if RUN_BY_CI.contains(&command) {
        let ci = fs::read_to_string(root().join(".ci/run")).unwrap();
        assert!(ci.contains(command), ".ci/run does not run `{command}`");
        return None;
    }
    let arguments = ["rockproof ", "cargo run --release -- "].iter().find_map(|start| command.strip_prefix(start));
    let mut arguments: Vec<&str> =
        arguments.unwrap_or_else(|| panic!("no idea how to run `{command}`")).split_whitespace().collect();
    if arguments == ["campaign"] {
        arguments.extend(SHORT_CAMPAIGN);
    }
    let output = Command::new(env!("CARGO_BIN_EXE_rockproof")).args(&arguments).current_dir(folder).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(shown.exit), "`{command}`: {errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(|line| line.trim_end().to_owned()).collect())
}

/// A line without what differs from run to run: how long it took.
fn lasting(line: &str) -> String {
    for counted in [" pairs in ", " steps in "] {
        if let (Some((before, _)), Some((_, after))) = (line.split_once(counted), line.split_once(" a second)")) {
            return format!("{before}{counted}… a second){after}");
        }
    }
    line.to_owned()
}

/// Whether lines are as shown, `…` standing for any number of lines.
fn alike(shown: &[String], found: &[String]) -> bool {
    match shown.split_first() {
        None => found.is_empty(),
        Some((first, rest)) if first == "…" => (0..=found.len()).any(|skipped| alike(rest, &found[skipped..])),
        Some((first, rest)) => {
            found.split_first().is_some_and(|(line, others)| lasting(first) == lasting(line) && alike(rest, others))
        }
    }
}

/// A folder to run in, with the cases that commands name.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    copy(&root().join("cases"), &folder.path().join("cases"));
    folder
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn documents_show_what_happens() {
    let renew = std::env::var_os("ROCKPROOF_RENEW").is_some();
    let mut wrong = Vec::new();
    for name in DOCUMENTS {
        let path = root().join(name);
        let document = fs::read_to_string(&path).unwrap();
        let commands = shown(&document);
        assert!(!commands.is_empty(), "{name} shows no command");
        let folder = workplace();
        let mut lines: Vec<String> = document.lines().map(str::to_owned).collect();
        // From the end, so that line numbers before it stay right; but run in order.
        let outputs: Vec<_> = commands.iter().map(|command| run(command, folder.path())).collect();
        for (command, output) in commands.iter().zip(outputs).rev() {
            let Some(output) = output else { continue };
            let bare = command.command.ends_with(" campaign");
            if renew && !bare && !alike(&command.output, &output) {
                lines.splice(command.lines.clone(), output);
            } else if !command.output.is_empty() && !alike(&command.output, &output) {
                wrong.push(format!("{name}: $ {}\n{}", command.command, output.join("\n")));
            }
        }
        if renew {
            fs::write(&path, lines.join("\n") + "\n").unwrap();
        }
    }
    assert!(wrong.is_empty(), "these say something else now (ROCKPROOF_RENEW=1 renews them):\n{}", wrong.join("\n\n"));
}

#[test]
fn the_reader_of_documents_sees_a_difference() {
    let document = "text\n```console\n$ rockproof x # exits 1\none\ntwo\n$ rockproof y\n```\n$ not this\n```toml\n$ nor this\n```\n";
    let found = shown(document);
    let lines = |all: &[&str]| all.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
    assert_eq!(found.len(), 2);
    assert_eq!(
        (found[0].command.as_str(), found[0].exit, &found[0].output),
        ("rockproof x", 1, &lines(&["one", "two"]))
    );
    assert_eq!((found[0].lines.clone(), found[1].lines.clone()), (3..5, 6..6));
    assert!(alike(&lines(&["a", "…", "d"]), &lines(&["a", "b", "c", "d"])));
    assert!(alike(
        &lines(&["4 pairs in 1.0 s (4 a second), 2 findings"]),
        &lines(&["4 pairs in 2.0 s (2 a second), 2 findings"])
    ));
    assert!(!alike(
        &lines(&["4 pairs in 1.0 s (4 a second), 2 findings"]),
        &lines(&["4 pairs in 1.0 s (4 a second), 3 findings"])
    ));
    assert!(!alike(&lines(&["a", "…", "d"]), &lines(&["a", "b", "d", "c"])));
    assert!(!alike(&lines(&["a"]), &lines(&["a", "b"])) && !alike(&lines(&["a", "b"]), &lines(&["a"])));
}
