//! Directories of results in which others put something else: what is no file is not waited for, and errors in tables name their line however
//! lines end.

use crate::place::rockproof_in;
use crate::untrusted_input::refused;
use std::fs;
use std::path::Path;

/// What is in the place of a table, of run.json or of a case is not waited for.
#[cfg(unix)]
#[test]
fn a_pipe_in_a_directory_of_results_is_refused() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (code, out, err) = rockproof_in(dir, &["campaign", "--pairs", "64", "--family", "sliver", "--out", "run"]);
    assert_eq!(code, 0, "{out}{err}");
    let pipe = |file: &Path| assert!(std::process::Command::new("mkfifo").arg(file).status().expect("runs").success());
    fs::create_dir(dir.join("locked")).expect("a folder");
    pipe(&dir.join("locked/.rockproof.lock"));
    refused(dir, &["campaign", "--pairs", "16", "--out", "locked"], &[".rockproof.lock is in the way"]);
    let (report, compare) = (&["report", "run", "--out", "page"][..], &["compare", "run", "run"][..]);
    let cases = fs::read_dir(dir.join("run/cases")).expect("cases").map(|case| case.expect("a case").file_name());
    // What comes of tolerances is as it should be, and not shown.
    let shown = |name: &String| name.contains("arithmetic") && name.ends_with(".toml");
    let pairs: Vec<String> = cases.map(|name| format!("cases/{}", name.to_string_lossy())).filter(shown).collect();
    assert!(!pairs.is_empty(), "a case that a report shows");
    for name in ["findings.csv", "run.json"].into_iter().chain(pairs.iter().map(String::as_str)) {
        let (file, aside) = (dir.join("run").join(name), dir.join("aside"));
        fs::rename(&file, &aside).expect("moved");
        pipe(&file);
        let only_reported = name.starts_with("cases/");
        for arguments in [report, compare].into_iter().take(if only_reported { 1 } else { 2 }) {
            refused(dir, arguments, &[&format!("{name}: this is a folder, a device or a pipe")]);
        }
        fs::remove_file(&file).expect("removed");
        fs::rename(&aside, &file).expect("moved");
    }
}

#[test]
fn errors_in_tables_name_their_line_however_lines_end() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (code, out, err) = rockproof_in(dir, &["campaign", "--pairs", "64", "--family", "sliver", "--out", "run"]);
    assert_eq!(code, 0, "{out}{err}");
    let file = dir.join("run/findings.csv");
    let table = fs::read_to_string(&file).expect("a table");
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines.len() > 4, "{table}");
    for end in ["\n", "\r\n", "\r"] {
        for line in [2, 4] {
            // A field too many.
            let changed = lines.iter().zip(1..).map(|(text, number)| match number == line {
                true => format!("{text},{end}"),
                false => format!("{text}{end}"),
            });
            fs::write(&file, changed.collect::<String>()).expect("write");
            refused(dir, &["report", "run", "--out", "page"], &[&format!("findings.csv: line {line}:")]);
            let (code, _, err) = rockproof_in(dir, &["compare", "run", "run"]);
            assert!(
                code == 2 && err.contains(&format!("line: {line}")) || err.contains(&format!("line {line}")),
                "{err}"
            );
        }
        fs::write(&file, table.replace('\n', end)).expect("write");
        let (code, out, err) = rockproof_in(dir, &["report", "run", "--out", "page", "--overwrite"]);
        assert_eq!(code, 0, "{end:?}: {out}{err}");
    }
}
