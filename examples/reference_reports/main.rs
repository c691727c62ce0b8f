//! Makes the reports in `reports/reference/` anew, or checks that their tables have not drifted:
//!
//! ```text
//! cargo run --release --example reference_reports            all of them, some minutes
//! cargo run --release --example reference_reports -- small   one
//! cargo run --release --example reference_reports -- --check those that are quick, compared with what is committed
//! ```
//!
//! Runs are made in a directory for temporary files, by `cargo run --release`, or the program that the variable ROCKPROOF names, and by the commands that `reports/reference/README.md` shows.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// A reference report.
struct Reference {
    name: &'static str,
    made_of: MadeOf,
    /// Whether the page is kept: it holds megabytes of library.
    page: bool,
    /// Whether it is quick enough to be made again by `--check`.
    quick: bool,
}

/// What a report is about.
enum MadeOf {
    /// One run: arguments of `rockproof`.
    Run(&'static [&'static str]),
    /// Scenes in lockstep, in f64 and f32: the scene, and so many steps after settling.
    Lockstep(&'static [(&'static str, &'static str)]),
    /// Tables that are committed already.
    Committed(&'static str),
}

/// The paper's four examples: sliding block, approaching vertices, quasi-parallel edges, failure of a block system. 200 steps with those of
/// settling, but of the last, which is slow.
const EXAMPLES: [(&str, &str); 7] = [
    ("incline_0_settled", "195"),
    ("incline_1_4_settled", "195"),
    ("incline_1_2_settled", "195"),
    ("incline_4_5_settled", "195"),
    ("approaching_vertices", "200"),
    ("quasi_parallel_edges", "180"),
    ("slope_failure", "40"),
];

const REFERENCES: [Reference; 6] = [
    Reference { name: "campaign", made_of: MadeOf::Run(&["campaign", "--seed", "1"]), page: true, quick: true },
    Reference {
        name: "small",
        made_of: MadeOf::Run(&["campaign", "--seed", "7", "--pairs", "2048"]),
        page: false,
        quick: true,
    },
    Reference {
        name: "sweep",
        made_of: MadeOf::Run(&["campaign", "reports/reference/sweep.toml"]),
        page: false,
        quick: false,
    },
    Reference { name: "examples", made_of: MadeOf::Lockstep(&EXAMPLES), page: true, quick: true },
    Reference { name: "stress", made_of: MadeOf::Committed("reports/stress"), page: true, quick: true },
    Reference { name: "bench", made_of: MadeOf::Committed("reports/bench"), page: false, quick: true },
];

/// What goes wrong, told.
type Told<T> = Result<T, String>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.first().map(String::as_str) {
        Some("--check") => REFERENCES.iter().filter(|r| r.quick).try_for_each(check),
        _ => REFERENCES
            .iter()
            .filter(|r| arguments.is_empty() || arguments.iter().any(|a| a == r.name))
            .try_for_each(renew),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(told) => {
            eprintln!("{told}");
            ExitCode::FAILURE
        }
    }
}

fn rockproof(arguments: &[String], directory: &Path) -> Told<()> {
    // A program that is built already, or this repository's.
    let mut command = match std::env::var_os("ROCKPROOF") {
        Some(program) => Command::new(program),
        None => {
            let mut command = Command::new(env!("CARGO"));
            command.args(["run", "--release", "--locked", "--quiet", "--manifest-path"]).arg(root().join("Cargo.toml"));
            command.args(["--bin", "rockproof", "--"]);
            command
        }
    };
    let status =
        command.args(arguments).current_dir(directory).status().map_err(|e| format!("it does not run: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("rockproof {} failed", arguments.join(" "))) }
}

/// Makes the runs of a reference and its report; gives the directory of the report.
fn make(reference: &Reference, directory: &Path) -> Told<PathBuf> {
    // The same paths as in the repository, so that the commands in the page work there.
    let run = format!("reports/reference/{}", reference.name);
    fs::create_dir_all(directory.join("reports/reference")).map_err(|e| e.to_string())?;
    let mut runs = Vec::new();
    match reference.made_of {
        MadeOf::Run(command) => {
            let mut arguments: Vec<String> = command.iter().map(|a| absolute(a)).collect();
            arguments.extend(["--out".to_owned(), run.clone()]);
            rockproof(&arguments, directory)?;
            runs.push(run.clone());
        }
        MadeOf::Lockstep(scenes) => {
            for (scene, steps) in scenes {
                for engine in ["f64", "f32"] {
                    let (out, scene) = (format!("{run}/{scene}-{engine}"), format!("cases/handmade/{scene}.toml"));
                    let arguments = [
                        "simulate",
                        &absolute(&scene),
                        "--engine",
                        engine,
                        "--lockstep",
                        "--steps",
                        steps,
                        "--out",
                        &out,
                    ];
                    rockproof(&arguments.map(str::to_owned), directory)?;
                    runs.push(out);
                }
            }
        }
        MadeOf::Committed(tables) => {
            copy_all(&root().join(tables), &directory.join(tables), &|name| name.ends_with(".csv"))?;
            runs.push(tables.to_owned());
        }
    }
    for format in ["markdown", "html"] {
        let mut arguments = vec!["report".to_owned()];
        arguments.extend(runs.iter().cloned());
        arguments.extend(["--out", &format!("{run}-{format}"), "--format", format].map(str::to_owned));
        if let MadeOf::Lockstep(_) = reference.made_of {
            arguments.extend(["--title", "The paper's four examples, step by step"].map(str::to_owned));
        }
        rockproof(&arguments, directory)?;
    }
    Ok(directory.join("reports/reference"))
}

/// Files of the repository by their whole path.
fn absolute(argument: &str) -> String {
    let path = root().join(argument);
    if argument.contains('/') && path.is_file() { path.display().to_string() } else { argument.to_owned() }
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("rockproof-{name}-{}", std::process::id()))
}

fn renew(reference: &Reference) -> Told<()> {
    println!("{}", reference.name);
    let directory = temporary(reference.name);
    let made = make(reference, &directory)?;
    let (html, markdown) =
        (made.join(format!("{}-html", reference.name)), made.join(format!("{}-markdown", reference.name)));
    let kept = root().join("reports/reference").join(reference.name);
    if kept.exists() {
        fs::remove_dir_all(&kept).map_err(|e| e.to_string())?;
    }
    copy_all(&html.join("tables"), &kept.join("tables"), &|_| true)?;
    copy(&markdown.join("report.md"), &kept.join("report.md"))?;
    if reference.page {
        copy(&html.join("report.html"), &kept.join("report.html"))?;
        // The cases that the page shows how to replay.
        let page = fs::read_to_string(html.join("report.html")).map_err(|e| e.to_string())?;
        let cases = made.join(reference.name).join("cases");
        if cases.is_dir() {
            copy_all(&cases, &kept.join("cases"), &|name| page.contains(&format!("{name}<")))?;
        }
    }
    fs::remove_dir_all(&directory).map_err(|e| e.to_string())
}

/// Compares the tables of a reference with those committed.
fn check(reference: &Reference) -> Told<()> {
    let (name, begun) = (reference.name, Instant::now());
    let directory = temporary(name);
    let made = make(reference, &directory)?.join(format!("{name}-html/tables"));
    let kept = root().join("reports/reference").join(name).join("tables");
    let (made, known) = (tables(&made)?, tables(&kept)?);
    let mut drifted = Vec::new();
    for (table, bytes) in &made {
        match known.iter().find(|(name, _)| name == table) {
            None => drifted.push(format!("{table}: not in {}", kept.display())),
            Some((_, old)) if old != bytes => drifted.push(first_difference(table, old, bytes)),
            Some(_) => {}
        }
    }
    drifted.extend(
        known
            .iter()
            .filter(|(name, _)| !made.iter().any(|(new, _)| new == name))
            .map(|(name, _)| format!("{name}: no longer made")),
    );
    fs::remove_dir_all(&directory).map_err(|e| e.to_string())?;
    if drifted.is_empty() {
        println!("{name}: {} tables as committed ({} s)", made.len(), begun.elapsed().as_secs());
        return Ok(());
    }
    Err(format!(
        "the tables of reports/reference/{name} have drifted; if that is meant: cargo run --release --example reference_reports\n  {}",
        drifted.join("\n  ")
    ))
}

fn first_difference(table: &str, old: &[u8], new: &[u8]) -> String {
    let lines = |bytes: &[u8]| String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect::<Vec<_>>();
    let (old, new) = (lines(old), lines(new));
    let at = old.iter().zip(&new).position(|(old, new)| old != new).unwrap_or(old.len().min(new.len()));
    let line = |lines: &[String]| lines.get(at).cloned().unwrap_or_else(|| "(end)".to_owned());
    format!("{table}: line {}: {}, committed {}", at + 1, line(&new), line(&old))
}

/// The files of a directory by name.
fn tables(directory: &Path) -> Told<Vec<(String, Vec<u8>)>> {
    let told = |e: std::io::Error| format!("{}: {e}", directory.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).map_err(told)? {
        let entry = entry.map_err(told)?;
        found.push((entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).map_err(told)?));
    }
    found.sort();
    Ok(found)
}

fn copy(from: &Path, to: &Path) -> Told<()> {
    let parent = to.parent().ok_or("no directory")?;
    fs::create_dir_all(parent).map_err(|e| e.to_string())?;
    fs::copy(from, to).map(drop).map_err(|e| format!("{}: {e}", from.display()))
}

fn copy_all(from: &Path, to: &Path, wanted: &dyn Fn(&str) -> bool) -> Told<()> {
    for (name, _) in tables(from)? {
        if wanted(&name) {
            copy(&from.join(&name), &to.join(&name))?;
        }
    }
    Ok(())
}
