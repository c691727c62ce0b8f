//! Every table for a paper goes through pdfLaTeX, and so do names that are not of the Latin alphabet: `cargo test --release --test commands latex:: --
//! --ignored` where pdflatex and booktabs are installed; with ROCKPROOF_REQUIRE_PDFLATEX=1, as in `.ci/run` where they are to be had, their absence is a
//! failure.

use rockproof_report::latex::latex;
use rockproof_report::table::{Table, TableCell};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn rockproof(args: &[&str], codes: &[i32]) {
    let output = assert_cmd::Command::cargo_bin("rockproof").expect("built").args(args).output().expect("runs");
    let code = output.status.code().expect("a code");
    assert!(codes.contains(&code), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// What pdfLaTeX says of a document that holds these tables.
fn compiled(dir: &Path, tables: &[PathBuf]) -> Output {
    let shown = |table: &PathBuf| format!("\\input{{{}}}\\par\n", table.display());
    let tables: String = tables.iter().map(shown).collect();
    let document = format!(
        "\\documentclass{{article}}\n\\usepackage{{booktabs}}\n\\begin{{document}}\\tiny\n{tables}\\end{{document}}\n"
    );
    fs::write(dir.join("paper.tex"), document).expect("written");
    Command::new("pdflatex")
        .args(["-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "paper.tex"])
        .current_dir(dir)
        .output()
        .expect("pdflatex runs")
}

fn is_installed() -> bool {
    let asked = Command::new("kpsewhich").arg("booktabs.sty").output();
    let has_booktabs = asked.is_ok_and(|output| output.status.success());
    let found = has_booktabs && Command::new("pdflatex").arg("--version").output().is_ok();
    assert!(
        found || std::env::var_os("ROCKPROOF_REQUIRE_PDFLATEX").is_none(),
        "there is no pdflatex with booktabs; install them (apt-get install texlive-latex-recommended)"
    );
    if !found {
        eprintln!("not tested: there is no pdflatex with booktabs");
    }
    found
}

#[test]
#[ignore = "needs pdflatex; .ci/run runs it"]
fn tables_for_a_paper_are_latex() {
    if !is_installed() {
        return;
    }
    let dir = crate::place::folder();
    let path = |name: &str| dir.path().join(name).to_str().expect("text").to_owned();
    let [campaign, lockstep, report] = ["campaign", "lockstep", "report"].map(path);
    rockproof(
        &["campaign", "--pairs", "128", "--steps-every", "8", "--tolerances", "auto,shi", "--out", &campaign],
        &[0],
    );
    let scene = "cases/handmade/incline_1_4_settled.toml";
    rockproof(&["simulate", scene, "--engine", "f32", "--lockstep", "--steps", "3", "--out", &lockstep], &[0]);
    rockproof(&["report", &campaign, &lockstep, "reports/stress", "reports/bench", "--out", &report], &[0]);
    rockproof(&["tune", "cases/real/slope_joints.dda", "--candidates", "3", "--out", &path("tune")], &[0, 1]);
    rockproof(&["examine", "cases/real/slope_joints.dda", "--no-tune", "--out", &path("examine")], &[0, 1]);
    rockproof(&["bench", "--error", "--quick", "--out", &path("bench")], &[0]);
    let folders = ["report/latex", "tune", "examine", "bench"].map(|folder| dir.path().join(folder));
    let mut tables: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()))
        .filter(|file| file.extension().is_some_and(|kind| kind == "tex"))
        .collect();
    tables.sort();
    assert!(tables.len() > 15, "{tables:?}");
    // What names and messages may hold.
    let mut odd = Table::new("odd", "odd\ntexts % \\end", &["odd_name"]);
    let ascii: String = (' '..='~').collect();
    let signs = "é Å ß ÿ þ ð × ÷ ° µ θ Δ ε ≤ ≥ → √ 10⁻¹² m² … – − 岩盤 \u{7}\u{202f}\u{1f600}";
    for text in [&*ascii, signs, "[x]", "*", "'' --- ``", "\\input{x}"] {
        odd.push(vec![text.into()]);
    }
    odd.push(vec![TableCell::Number(-1.25e-9)]);
    odd.push(vec![TableCell::Number(f64::INFINITY)]);
    let file = dir.path().join("odd.tex");
    fs::write(&file, latex(&odd, 60)).expect("written");
    tables.push(file);
    let output = compiled(dir.path(), &tables);
    let log = String::from_utf8_lossy(&output.stdout);
    let wrong: Vec<&str> = log.lines().skip_while(|line| !line.starts_with('!')).take(8).collect();
    assert!(output.status.success() && !log.contains("Missing character"), "{}", wrong.join("\n"));
    assert!(fs::metadata(dir.path().join("paper.pdf")).expect("a PDF").len() > 10_000);
}
