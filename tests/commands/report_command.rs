//! Pins what `report` reads, writes and refuses.

use crate::campaigns::CASES_AS_FOUND;
use crate::place::rockproof;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

/// A small campaign, made once.
pub(crate) fn run() -> &'static Path {
    static DIR: OnceLock<tempfile::TempDir> = OnceLock::new();
    let dir = DIR.get_or_init(|| {
        let dir = crate::place::folder();
        let out = dir.path().join("small");
        let out = out.to_str().expect("text");
        let pairs = ["--pairs", "256", "--tolerances", "auto,shi,dyadic", "--out", out];
        let (code, _, err) = rockproof(&[&["campaign", CASES_AS_FOUND], &pairs[..]].concat());
        assert_eq!(code, 0, "{err}");
        dir
    });
    Box::leak(dir.path().join("small").into_boxed_path())
}

/// A copy of it to damage.
pub(super) fn copy() -> (tempfile::TempDir, String) {
    let dir = crate::place::folder();
    let steps = ["step_findings.csv", "step_summary.csv"];
    for name in ["run.json", "findings.csv", "agreement.csv", "confusion.csv", "summary.csv"].into_iter().chain(steps) {
        fs::copy(run().join(name), dir.path().join(name)).expect(name);
    }
    fs::create_dir(dir.path().join("cases")).expect("cases");
    for entry in fs::read_dir(run().join("cases")).expect("cases") {
        let entry = entry.expect("a case");
        fs::copy(entry.path(), dir.path().join("cases").join(entry.file_name())).expect("copied");
    }
    let path = dir.path().to_str().expect("text").to_owned();
    (dir, path)
}

/// A command that the page has for its reader runs as it stands there.
#[test]
fn findings_of_an_external_engine_are_replayed_with_it() {
    let dir = crate::place::folder();
    let out = dir.path().join("run");
    let (path, mine) = (out.to_str().expect("text"), format!("mine={} sign", crate::engines::client()));
    let settings = ["--pairs", "64", "--family", "sliver", "--tolerances", "auto", "--engine", "mine"];
    let (code, _, err) =
        rockproof(&[&["campaign", CASES_AS_FOUND, "--engine-command", &mine, "--out", path], &settings[..]].concat());
    assert_eq!(code, 0, "{err}");
    assert_eq!(rockproof(&["report", path]).0, 0);
    let page = fs::read_to_string(out.join("report/report.html")).expect("a page");
    let commands = page.split("rockproof replay ").skip(1).filter_map(|rest| rest.split_once("</code>"));
    let told = commands.map(|(command, _)| command).find(|command| command.contains("--engine-command"));
    let told = told.expect("a command with the engine").replace("&#x27;", "'").replace("&#x2f;", "/");
    let words = shlex::split(&told).expect("words of a shell");
    let words: Vec<&str> = std::iter::once("replay").chain(words.iter().map(String::as_str)).collect();
    let (code, out, err) = rockproof(&words);
    assert!(code != 2 && out.contains("mine"), "{code}: {told}: {out}{err}");
}

#[test]
fn writes_a_page_and_the_same_tables_as_csv() {
    let (dir, path) = copy();
    let (code, out, err) = rockproof(&["report", &path]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(out.lines().count(), 4, "the verdict: {out}");
    let page = fs::read_to_string(dir.path().join("report/report.html")).expect("a page");
    for line in out.lines() {
        assert!(page.contains(&line.replace('"', "&quot;")), "{line}");
    }
    for name in ["agreement", "families", "confusion", "causes", "predicates", "margins", "worst", "runs"] {
        let file = dir.path().join(format!("report/tables/{name}.csv"));
        let rows = csv::Reader::from_path(&file).expect(name).into_records().count();
        assert!(rows > 0, "{name} is empty");
    }
    assert!(page.contains("rockproof replay") && page.contains("mesh3d"), "views");
    assert!(
        !page.contains("http-equiv=\"refresh\"") && !page.contains("src=\"http") && !page.contains("<link"),
        "requests"
    );
}

#[test]
fn every_chart_is_a_picture_with_its_numbers() {
    let (dir, path) = copy();
    let (code, _, err) = rockproof(&["report", &path]);
    assert_eq!(code, 0, "{err}");
    let report = dir.path().join("report");
    let page = fs::read_to_string(report.join("report.html")).expect("a page");
    let stems: Vec<&str> = page
        .split("<figure class=\"chart")
        .skip(1)
        .filter_map(|rest| rest.split_once("id=\"chart-")?.1.split_once('"'))
        .map(|(stem, _)| stem)
        .collect();
    assert!(stems.len() >= 6, "{stems:?}");
    let of_folder = fs::read_dir(report.join("charts")).expect("charts").count();
    assert_eq!(of_folder, 2 * stems.len(), "a picture and a table for each chart");
    for stem in &stems {
        let picture = fs::read_to_string(report.join(format!("charts/{stem}.svg"))).expect(stem);
        assert!(picture.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\""), "{stem}");
        let rows =
            csv::Reader::from_path(report.join(format!("charts/{stem}.csv"))).expect(stem).into_records().count();
        assert!(rows > 0, "{stem} is empty");
    }
    // The numbers are those of the table.
    let shown = table(&report, "charts/agreement.csv");
    let all = table(&report, "tables/agreement.csv");
    for point in &shown {
        let row = all
            .iter()
            .find(|row| row["setting"] == point["y"] && row["engine"] == point["series"] && row["compared"] == "whole");
        let share =
            |row: &std::collections::BTreeMap<String, String>, name: &str| row[name].parse::<f64>().expect("a number");
        let row = row.unwrap_or_else(|| panic!("{point:?}"));
        for (column, of) in [("x", "agreement"), ("low", "low"), ("high", "high")] {
            assert!((share(point, column) - 100.0 * share(row, of)).abs() < 1e-3, "{point:?}: {row:?}");
        }
    }
    assert_eq!(shown.len(), 4, "two engines under auto and shi: {shown:?}");
    let causes: u64 =
        table(&report, "charts/causes.csv").iter().map(|row| row["x"].parse::<u64>().expect("a count")).sum();
    let shown = |row: &&std::collections::BTreeMap<String, String>| ["auto", "shi"].contains(&&*row["setting"]);
    let found: u64 = table(&report, "tables/causes.csv")
        .iter()
        .filter(shown)
        .map(|row| row["findings"].parse::<u64>().expect("a count"))
        .sum();
    assert_eq!(causes, found);
}

/// The table's rows as columns by name.
fn table(dir: &Path, name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(dir.join(name)).expect(name);
    reader.deserialize().collect::<Result<_, _>>().expect(name)
}

#[test]
fn the_numbers_are_those_of_the_run() {
    let (dir, path) = copy();
    let out = dir.path().join("out");
    let (code, _, err) = rockproof(&["report", &path, "--out", out.to_str().expect("text")]);
    assert_eq!(code, 0, "{err}");
    let summary = table(run(), "summary.csv");
    let findings: u64 = summary.iter().map(|row| row["findings"].parse::<u64>().expect("a count")).sum();
    let of = |name: &str, column: &str| -> u64 {
        table(&out, name).iter().map(|row| row[column].parse::<u64>().expect("a count")).sum()
    };
    assert!(findings > 100);
    assert_eq!(of("tables/causes.csv", "findings"), findings);
    assert_eq!(of("tables/margins.csv", "findings"), findings);
    // Every pair is compared under every set it was examined under, by each engine along the whole chain.
    let mut examined = std::collections::BTreeMap::new();
    for row in &summary {
        let key = [&row["family"], &row["form"], &row["tolerances"]].map(String::clone);
        examined.insert(key, row["pairs"].parse::<u64>().expect("a count"));
    }
    let agreement = table(&out, "tables/agreement.csv");
    for engine in ["stepper-f32", "stepper-f64"] {
        let whole = agreement.iter().filter(|row| row["engine"] == engine && row["compared"] == "whole");
        let pairs: u64 = whole.map(|row| row["pairs"].parse::<u64>().expect("a count")).sum();
        assert_eq!(pairs, examined.values().sum::<u64>(), "{engine}");
    }
    for row in &agreement {
        let [low, share, high] = ["low", "agreement", "high"].map(|name| row[name].parse::<f64>().expect("a share"));
        assert!((0.0..=share).contains(&low) && (share..=1.0).contains(&high), "{row:?}");
    }
    // Contacts of the true kinds are the contacts compared, less those without an answer.
    let truly: u64 = table(&out, "tables/confusion.csv")
        .iter()
        .filter(|row| row["compared"] == "arithmetic" && row["true_kind"] != "none")
        .map(|row| row["contacts"].parse::<u64>().expect("a count"))
        .sum();
    let compared: u64 = agreement
        .iter()
        .filter(|row| row["compared"] == "arithmetic")
        .map(|row| row["contacts"].parse::<u64>().expect("a count"))
        .sum();
    assert_eq!(truly, compared);
}

#[test]
fn the_same_runs_make_the_same_bytes() {
    let (dir, path) = copy();
    let report = |name: &str| {
        let out = dir.path().join(name);
        assert_eq!(rockproof(&["report", &path, "--out", out.to_str().expect("text")]).0, 0);
        fs::read(out.join("report.html")).expect("a page")
    };
    assert!(report("one") == report("two"));
}

#[test]
fn markdown_is_short_and_goes_to_stdout() {
    let path = run().to_str().expect("text");
    let (code, out, err) = rockproof(&["report", path, "--format", "markdown"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.starts_with("## Rockproof: small\n\n- "), "{out}");
    assert!(out.len() < 20_000 && out.contains("| setting | engine |") && out.contains("<details>"), "{out}");
    assert!(!run().join("report").exists(), "nothing is written");
}

#[test]
fn a_report_is_replaced_only_when_asked() {
    let (dir, path) = copy();
    assert_eq!(rockproof(&["report", &path]).0, 0);
    let page = dir.path().join("report/report.html");
    fs::write(&page, "mine").expect("written");
    fs::write(dir.path().join("report/notes.txt"), "mine").expect("written");
    fs::write(dir.path().join("report/tables/old.csv"), "mine").expect("written");
    let (code, _, err) = rockproof(&["report", &path]);
    assert_eq!(code, 2);
    assert!(err.contains("holds a report already") && err.contains("--overwrite"), "{err}");
    assert_eq!(fs::read_to_string(&page).expect("read"), "mine");
    assert_eq!(rockproof(&["report", &path, "--overwrite"]).0, 0);
    assert_ne!(fs::read_to_string(&page).expect("read"), "mine");
    assert!(dir.path().join("report/notes.txt").exists() && dir.path().join("report/tables/old.csv").exists());
}

#[test]
fn what_is_no_run_is_refused() {
    let dir = crate::place::folder();
    let empty = dir.path().to_str().expect("text");
    let (code, _, err) = rockproof(&["report", empty]);
    assert!(code == 2 && err.contains("an empty directory") && err.contains("findings.csv"), "{err}");
    let (code, _, err) = rockproof(&["report", "nowhere/at/all"]);
    assert!(code == 2 && err.contains("no such directory"), "{err}");
    let (code, _, err) = rockproof(&["report", "Cargo.toml"]);
    assert!(code == 2 && err.contains("a file, not a directory"), "{err}");
    assert_eq!(rockproof(&["report"]).0, 2);
}

#[test]
fn damage_is_named_with_file_and_line() {
    // File, what to replace, with what, and what the message must say.
    let damages: [(&str, &str, &str, &[&str]); 7] = [
        ("findings.csv", "index,family", "number,family", &["findings.csv: line 1:", "number,family", "index,family"]),
        ("findings.csv", ",tolerance,", ",malice,", &["findings.csv: line 2:", "cause is \"malice\""]),
        (
            "agreement.csv",
            ",tolerance,f32,",
            ",tolerance,f32,x",
            &["agreement.csv: line 2:", "pairs is \"x", "a count"],
        ),
        ("confusion.csv", ",tolerance,f32,", ",sideways,f32,", &["confusion.csv: line 2:", "span is \"sideways\""]),
        ("run.json", "\n  \"version\": \"0.1.0\"", "\n  \"version\": \"7.2.0\"", &["run.json: line", "7.2.0", "0.1.0"]),
        ("run.json", "\n  \"seed\":", "\n  \"seeds\":", &["run.json: line", "seed"]),
        ("run.json", "{", "[", &["run.json: line"]),
    ];
    for (name, from, to, wanted) in damages {
        let (dir, path) = copy();
        let file = dir.path().join(name);
        let text = fs::read_to_string(&file).expect("read");
        assert!(text.contains(from), "{name} has no {from}");
        fs::write(&file, text.replacen(from, to, 1)).expect("written");
        let (code, _, err) = rockproof(&["report", &path]);
        assert_eq!(code, 2, "{name}: {err}");
        assert!(wanted.iter().all(|part| err.contains(part)), "{name}, {to}: {err}");
        assert!(!dir.path().join("report").exists(), "nothing is written");
    }
}

#[test]
fn what_is_cut_off_is_noticed() {
    let (dir, path) = copy();
    let file = dir.path().join("findings.csv");
    let text = fs::read_to_string(&file).expect("read");
    let lines: Vec<&str> = text.lines().collect();
    fs::write(&file, lines[..lines.len() - 3].join("\n") + "\n").expect("written");
    let (code, _, err) = rockproof(&["report", &path]);
    assert!(code == 2 && err.contains("findings.csv") && err.contains("cut off"), "{err}");
    fs::write(&file, &text[..text.len() - 20]).expect("written");
    let (code, _, err) = rockproof(&["report", &path]);
    assert!(code == 2 && err.contains(&format!("line {}", lines.len())) && err.contains("fields"), "{err}");
    fs::write(&file, &text).expect("written");
    assert_eq!(rockproof(&["report", &path, "--out", &format!("{path}/whole")]).0, 0);
    fs::remove_file(&file).expect("removed");
    let (code, _, err) = rockproof(&["report", &path]);
    assert!(code == 2 && err.contains("findings.csv: the file is missing"), "{err}");
    fs::write(&file, &text).expect("written");
    fs::remove_file(dir.path().join("confusion.csv")).expect("removed");
    let (code, _, err) = rockproof(&["report", &path]);
    assert!(code == 2 && err.contains("confusion.csv"), "{err}");
}

#[test]
fn names_are_escaped() {
    let (dir, path) = copy();
    let evil = "<script>alert(1)</script>";
    for name in ["findings.csv", "agreement.csv", "confusion.csv"] {
        let file = dir.path().join(name);
        let text = fs::read_to_string(&file).expect("read");
        fs::write(&file, text.replace(",stepper-f32,", &format!(",{evil},"))).expect("written");
    }
    assert_eq!(rockproof(&["report", &path]).0, 0);
    let page = fs::read_to_string(dir.path().join("report/report.html")).expect("a page");
    assert!(!page.contains(evil) && page.contains("&lt;script&gt;alert(1)"), "escaped");
    let (_, out, _) = rockproof(&["report", &path, "--format", "markdown"]);
    assert!(!out.contains(evil));
}

#[test]
fn a_stress_set_and_measurements_are_read_from_their_tables_alone() {
    let dir = crate::place::folder();
    let out = dir.path().join("report");
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let [stress, bench] = ["stress", "bench"].map(|name| reports.join(name).to_str().expect("text").to_owned());
    let title = "Stress & time";
    let (code, verdict, err) =
        rockproof(&["report", &stress, &bench, "--title", title, "--out", out.to_str().expect("text")]);
    assert_eq!(code, 0, "{err}");
    assert!(
        verdict.starts_with("stepper-f64, no ties: safe to 10⁷ times the pair's size from the origin; "),
        "{verdict}"
    );
    assert_eq!(verdict.lines().count(), 3, "{verdict}");
    for (kept, made, rows) in
        [("stress", "stress", 180), ("limits", "stress_limits", 24), ("steps", "stress_steps", 42)]
    {
        let kept = table(&reports.join("stress"), &format!("{kept}.csv"));
        let made = table(&out, &format!("tables/{made}.csv"));
        assert_eq!((kept.len(), made.len()), (rows, rows));
    }
    let differ = |rows: Vec<std::collections::BTreeMap<String, String>>| -> u64 {
        rows.iter().map(|row| row["differ"].parse::<u64>().expect("a count")).sum()
    };
    assert_eq!(differ(table(&out, "tables/stress.csv")), differ(table(&reports.join("stress"), "stress.csv")));
    // Every subject has something that nothing beats, and what has no figure has no row.
    let measured = table(&out, "tables/timing.csv");
    for row in &measured {
        let efficient = |other: &&std::collections::BTreeMap<String, String>| {
            other["case"] == row["case"] && other["efficient"] == "yes"
        };
        assert!(measured.iter().any(|other| efficient(&other)), "{row:?}");
    }
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(page.contains("<h1>Stress &amp; time</h1>"));
    for id in [
        "chart-stress-0-offset",
        "chart-stress-0-angle",
        "chart-stress-0-contrast",
        "chart-timing-0-0",
        "table-stress_limits",
    ] {
        assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
    }
}

#[test]
fn damage_of_a_stress_set_is_named() {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/stress_quick");
    for (name, from, to, wanted) in [
        ("stress.csv", "offset,0,", "sideways,0,", "axis is \"sideways\""),
        ("stress.csv", ",0.062500,0.011119,", ",0.062500,-1,", "low is \"-1\""),
        ("limits.csv", "clean_to", "clean", "clean_to"),
        ("steps.csv", "rest,rigid,stepper-f32,1,", "rest,rigid,stepper-f32,many,", "level is \"many\""),
    ] {
        let dir = crate::place::folder();
        for file in ["stress.csv", "limits.csv", "steps.csv"] {
            fs::copy(kept.join(file), dir.path().join(file)).expect(file);
        }
        let file = dir.path().join(name);
        let text = fs::read_to_string(&file).expect("read");
        assert!(text.contains(from), "{name} has no {from}");
        fs::write(&file, text.replacen(from, to, 1)).expect("written");
        let (code, _, err) = rockproof(&["report", dir.path().to_str().expect("text")]);
        assert!(code == 2 && err.contains(&format!("{name}: line ")) && err.contains(wanted), "{name}: {err}");
    }
}

/// The verdict and the rows of the page's table of agreement about an engine that says the same of every pair.
fn says_always(answer: &str) -> (String, usize) {
    let dir = crate::place::folder();
    let out = dir.path().join("run");
    let out = out.to_str().expect("text");
    let engine = format!(r#"mine=sed -u -E 's/^."id":([0-9]+),.*/{{"id":\1,{answer}}}/'"#);
    let pairs = ["--pairs", "96", "--family", "face_stack", "--tolerances", "auto", "--out", out];
    let campaign = [&["campaign", CASES_AS_FOUND], &pairs[..]].concat();
    let (code, _, err) = rockproof(&[&campaign[..], &["--engine-command", &engine, "--engine", "mine"]].concat());
    assert_eq!(code, 0, "{err}");
    assert_eq!(rockproof(&["report", out]).0, 0);
    let page = fs::read_to_string(Path::new(out).join("report/report.html")).expect("a page");
    let table = page.split("id=\"table-agreement\"").nth(1).and_then(|rest| rest.split("</table>").next());
    let rows = table.expect("a table").matches("<td>mine</td>").count();
    let (_, verdict, _) = rockproof(&["report", out, "--format", "markdown"]);
    (verdict.lines().filter(|line| line.starts_with("- ")).collect::<Vec<_>>().join("\n"), rows)
}

#[test]
fn a_broken_engine_is_never_called_good() {
    for answer in [r#""state":"apart""#, r#""contacts":[]"#] {
        let (verdict, rows) = says_always(answer);
        assert!(rows > 0, "{answer}: the table of agreement is empty");
        assert!(verdict.contains("- ❌ mine: ") && verdict.contains("almost surely mistakes"), "{verdict}");
        assert!(!verdict.contains('✅'), "{verdict}");
    }
}
