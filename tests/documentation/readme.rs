//! What the documents show is what the program does: every command in a `console` block of README.md and of the pages in docs/
//! is run, page by page and in order, and its output compared. So that none escapes, commands stand nowhere else.
//!
//! A line `$ command` may end in `# exits 1`. Lines below it are its output; `…` stands for any lines left out, and a
//! command without lines below it only has to succeed. A shell runs it, in a folder with `cases/`, `examples/` and `rockproof`. Blocks
//! ```` ```console,slow ```` are run in release by `cargo test --release --test documentation readme:: -- --ignored`. What is not run at all stands in
//! `NOT_RUN`, with the reason. With ROCKPROOF_RENEW=1 the outputs are written anew instead.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Beginnings of commands that are not run, and why.
const NOT_RUN: [(&str, &str); 12] = [
    ("cargo test", "it is the test, or one of hours; `.ci/run` has `cargo test --release`"),
    ("cargo install", "it builds the program anew; `.ci/run` builds it"),
    ("cargo build --release --locked --manifest-path examples/other_codes/parry", "minutes; `.ci/run` has it"),
    ("cargo run --release -p rockproof-validation", "minutes; the tests of that crate hold what it finds"),
    ("cargo run --release --example soak", "minutes; `.ci/run` has it, and tests/commands/soak.rs some seconds"),
    (
        "cargo run --release --example self_comparison",
        "hours; `.ci/run` has seconds of it, and so has tests/commands/self_comparison.rs",
    ),
    ("mpirun", "an MPI; `.ci/run` runs tests/mpi where it can install one"),
    ("mdbook", "a tool that neither the program nor its tests need; tests/documentation/book.rs checks what it would"),
    ("sbatch", "a cluster; docs/scale.md runs the script itself without one"),
    (
        "pip install",
        "other people's codes, of hundreds of megabytes, or the package for Python, which `.ci/run` builds",
    ),
    ("cargo run --release --features gmp", "GMP builds for minutes; `.ci/run` tests with it"),
    ("ROCKPROOF_", "settings of tests that take hours; docs/validation.md says when they were run"),
];
/// Commands that need programs which are not built or installed here: what they show was compared when the page was written.
const NEEDS_OTHER_CODES: [&str; 2] = ["examples/other_codes/", "rockproof-parry"];
/// Programs a page may need, beside the shell. Pages that need one that is not there are skipped, unless ROCKPROOF_NO_SKIP is set.
const PROGRAMS: [&str; 2] = ["c++", "python3"];
/// The campaign without arguments takes a minute; here it is a short one.
const SHORT_CAMPAIGN: &str = "rockproof campaign --pairs 64";

/// One command of a document and what is shown below it.
#[derive(Debug, PartialEq)]
struct Shown {
    command: String,
    exit: i32,
    slow: bool,
    output: Vec<String>,
    /// Lines of the document that hold the output.
    lines: std::ops::Range<usize>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README.md and the pages, by their paths from the root, in order.
fn pages() -> Vec<String> {
    let names = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().file_name());
    let names = names.map(|name| name.into_string().unwrap()).filter(|name| name.ends_with(".md"));
    let mut pages: Vec<String> = names.map(|name| format!("docs/{name}")).collect();
    pages.push("README.md".to_owned());
    pages.sort();
    pages
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap()
}

fn shown(document: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = Vec::new();
    let (mut inside, mut slow) = (false, false);
    for (number, line) in document.lines().enumerate() {
        if line.starts_with("```") {
            slow = line == "```console,slow";
            inside = slow || line == "```console";
        } else if let (true, Some(text)) = (inside, line.strip_prefix("$ ")) {
            let (command, exit) = match text.split_once("# exits ") {
                Some((command, code)) => (command.trim(), code.trim().parse().unwrap()),
                None => (text.trim(), 0),
            };
            let output = Vec::new();
            found.push(Shown { command: command.to_owned(), exit, slow, output, lines: number + 1..number + 1 });
        } else if inside {
            let last = found.last_mut().unwrap_or_else(|| panic!("output without a command: {line}"));
            last.output.push(line.trim_end().to_owned());
            last.lines.end = number + 1;
        }
    }
    found
}

/// Why a command is not run, if it is not.
fn not_run(command: &str) -> Option<&'static str> {
    let listed = NOT_RUN.iter().find(|(start, _)| command.starts_with(start)).map(|(_, why)| *why);
    let other = NEEDS_OTHER_CODES.iter().any(|part| command.contains(part));
    listed.or(other.then_some("it needs other people's codes"))
}

/// Runs a command in `folder` and gives its standard output.
fn run(shown: &Shown, folder: &Path) -> Vec<String> {
    let command = shown.command.replace("cargo run --release -- ", "rockproof ");
    let command = if command == "rockproof campaign" { SHORT_CAMPAIGN } else { &command };
    let path = std::env::var("PATH").unwrap_or_default();
    let output = Command::new("sh")
        .args(["-c", command])
        .env("PATH", format!("{}:{path}", folder.join("bin").display()))
        .env_remove("GITHUB_ACTIONS")
        .env_remove("GITHUB_STEP_SUMMARY")
        .current_dir(folder)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(shown.exit), "`{command}`: {errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| line.trim_end().to_owned()).collect()
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

/// A folder to run in, with the files that commands name and the program.
fn workplace() -> tempfile::TempDir {
    let folder = crate::place::folder();
    for name in ["cases", "examples/engines", "examples/scale"] {
        copy(&root().join(name), &folder.path().join(name));
    }
    fs::create_dir(folder.path().join("bin")).unwrap();
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_rockproof"), folder.path().join("bin/rockproof")).unwrap();
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

fn there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Runs a page's commands, quick or slow ones, and gives what is otherwise than shown, and how many were run.
fn checked(page: &str, slow: bool) -> (Vec<String>, usize) {
    let document = read(page);
    let all = shown(&document);
    let commands: Vec<&Shown> = all.iter().filter(|c| c.slow == slow && not_run(&c.command).is_none()).collect();
    let needed =
        |program: &&&str| commands.iter().any(|c| c.command.split([' ', '"', '=']).any(|word| word == **program));
    if let Some(missing) = PROGRAMS.iter().filter(needed).find(|program| !there(program)) {
        assert!(std::env::var_os("ROCKPROOF_NO_SKIP").is_none(), "{page} needs {missing}");
        eprintln!("SKIPPED: {page} needs {missing}");
        return (Vec::new(), 0);
    }
    let renew = std::env::var_os("ROCKPROOF_RENEW").is_some();
    let (folder, mut wrong) = (workplace(), Vec::new());
    let mut lines: Vec<String> = document.lines().map(str::to_owned).collect();
    let outputs: Vec<_> = commands.iter().map(|command| run(command, folder.path())).collect();
    // From the end, so that line numbers before it stay right; but run in order.
    for (command, output) in commands.iter().zip(outputs).rev() {
        let bare = command.command.ends_with(" campaign");
        if command.output.is_empty() || bare || alike(&command.output, &output) {
            continue;
        }
        if renew {
            lines.splice(command.lines.clone(), output);
        } else {
            wrong.push(format!("{page}: $ {}\n{}", command.command, output.join("\n")));
        }
    }
    if renew {
        fs::write(root().join(page), lines.join("\n") + "\n").unwrap();
    }
    (wrong, commands.len())
}

fn check_all(slow: bool) {
    // Each page has a folder of its own, so as many are checked at a time as the machine has cores; those with many commands first, that none of them
    // is the last.
    let (mut pages, next) = (pages(), AtomicUsize::new(0));
    pages.sort_by_key(|page| std::cmp::Reverse(shown(&read(page)).len()));
    let work = || -> Vec<_> {
        let mine = std::iter::from_fn(|| pages.get(next.fetch_add(1, Ordering::Relaxed)));
        mine.map(|page| checked(page, slow)).collect()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let checks: Vec<_> = std::thread::scope(|scope| {
        let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        all.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    let wrong: Vec<&String> = checks.iter().flat_map(|(wrong, _)| wrong).collect();
    println!("{} commands of {} pages run", checks.iter().map(|(_, count)| count).sum::<usize>(), checks.len());
    assert!(wrong.is_empty(), "these say something else now (ROCKPROOF_RENEW=1 renews them):\n{wrong:#?}");
}

#[test]
fn documents_show_what_happens() {
    check_all(false);
}

#[test]
#[ignore = "minutes, and only in release: cargo test --release --test documentation readme:: -- --ignored"]
fn documents_show_what_happens_slowly() {
    check_all(true);
}

#[test]
fn no_command_escapes() {
    let ci = fs::read_to_string(root().join(".ci/run")).unwrap();
    assert!(ci.contains("cargo test --release") && ci.contains("examples/other_codes/parry"));
    let (mut run, mut left) = (0, Vec::new());
    for page in pages() {
        let document = read(&page);
        let mut fence = None;
        for (number, line) in document.lines().enumerate() {
            if let Some(language) = line.strip_prefix("```") {
                let known = [
                    "console",
                    "console,slow",
                    "toml",
                    "json",
                    "yaml",
                    "text",
                    "python",
                    "rust",
                    "cpp",
                    "csv",
                    "sh",
                    "tex",
                ];
                assert!(fence.is_some() || known.contains(&language), "{page}:{}: {line}", number + 1);
                fence = if fence.is_some() { None } else { Some(language.to_owned()) };
            } else if !fence.as_ref().is_some_and(|language| language.starts_with("console")) {
                let start = line.trim_start();
                let command = ["rockproof ", "cargo ", "pip ", "$ "].iter().any(|program| start.starts_with(program));
                let indented = line.starts_with("    ") && fence.is_none() || fence.as_deref() == Some("text");
                assert!(!(command && indented), "{page}:{}: a command outside a console block: {line}", number + 1);
            }
        }
        assert!(fence.is_none(), "{page}: a block is not closed");
        let (excluded, included): (Vec<_>, Vec<_>) =
            shown(&document).into_iter().partition(|command| not_run(&command.command).is_some());
        run += included.len();
        left.extend(excluded.into_iter().map(|command| (page.clone(), command.command)));
    }
    for (page, command) in &left {
        println!("not run: {page}: {command}: {}", not_run(command).unwrap_or_default());
    }
    println!("{run} commands are run, {} are not", left.len());
    for (start, _) in NOT_RUN {
        assert!(left.iter().any(|(_, command)| command.starts_with(start)), "no page has `{start}`: strike it out");
    }
    assert!(run >= 30, "{run} commands");
    // Every command of the program is shown somewhere.
    let help = Command::new(env!("CARGO_BIN_EXE_rockproof")).arg("--help").output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let list = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| line.starts_with("  "));
    let names: Vec<&str> = list.filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    let all: String = pages().iter().map(|page| read(page)).collect();
    assert!(names.len() > 8, "{help}");
    for name in names.iter().filter(|name| !["", "help"].contains(name)) {
        assert!(all.contains(&format!("\n$ rockproof {name} ")), "no page runs `rockproof {name}`");
    }
}

/// The directories that a command leaves results in, to be refused by the next one that would.
fn directory(command: &str) -> Option<String> {
    let words: Vec<&str> = command.strip_prefix("rockproof ")?.split_whitespace().collect();
    let after = |flag: &str| words.iter().position(|word| *word == flag).and_then(|at| words.get(at + 1)).copied();
    let again = words.iter().any(|word| matches!(*word, "--overwrite" | "--resume" | "markdown"));
    let stem = |file: &str| Path::new(file).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let default = match *words.first()? {
        "campaign" => format!("reports/campaign-{}", after("--seed").unwrap_or("1")),
        what @ ("simulate" | "tune" | "examine") => format!("reports/{what}-{}", stem(words.get(1)?)?),
        "report" => format!("{}/report", words.get(1)?),
        _ => return None,
    };
    (!again).then(|| after("--out").map_or(default, str::to_owned))
}

#[test]
fn pages_of_the_book_can_be_followed_one_after_another() {
    let mut taken: std::collections::BTreeMap<String, String> = std::collections::BTreeMap::new();
    for page in pages().into_iter().filter(|page| page.starts_with("docs/")) {
        for command in shown(&read(&page)) {
            let command = command.command.replace("cargo run --release -- ", "rockproof ");
            let Some(directory) = directory(&command).filter(|_| not_run(&command).is_none()) else { continue };
            if let Some(other) = taken.insert(directory.clone(), page.clone()) {
                panic!("{other} and {page} both leave results in {directory}: the second is refused");
            }
        }
    }
    assert!(taken.len() > 12, "{taken:?}");
}

#[test]
fn the_reader_of_documents_sees_a_difference() {
    let document = "text\n```console\n$ rockproof x # exits 1\none\ntwo\n$ rockproof y\n```\n$ not this\n```console,slow\n$ rockproof z\n```\n```toml\n$ nor this\n```\n";
    let found = shown(document);
    let lines = |all: &[&str]| all.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
    assert_eq!(found.len(), 3);
    assert!(!found[1].slow && found[2].slow);
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
