//! What an external engine leaves unsaid of its contacts is not compared: the gate, campaigns, reports and `compare` tell it.
#![cfg(unix)]

use crate::engines::client;
use crate::gates::{around, gate};
use crate::place::rockproof_in;

/// A gate around an engine, on few pairs.
fn around_few(command: &[String], rest: &str) -> String {
    around(&command.iter().map(String::as_str).collect::<Vec<_>>(), rest).replace("pairs = 256", "pairs = 32")
}

/// The client in `examples/` with all that it says of entrances and gaps left out.
fn bare() -> Vec<String> {
    let edit = r#"s/"entrance[_ab]*":[^,]*,//g; s/"gap_sign":[-0-9]*,//g"#;
    ["sh", "-c", &format!("'{}' | sed -u '{edit}'", client())].map(str::to_owned).to_vec()
}

/// A limit on what an engine leaves unsaid of its contacts is not looked at, and none on its answers; the others are, and it is said what is missing.
#[test]
fn a_limit_on_entrances_that_an_engine_never_gives_is_skipped() {
    let dir = tempfile::tempdir().expect("a directory");
    let limit = |change: &str| format!("[[limit]]\nengine = \"mine\"\nchange = \"{change}\"\ncount = 9999\n");
    let unsaid = format!("{}{}", limit("gap-sign"), limit("entrance"));
    let ran = gate(dir.path(), &around_few(&bare(), &unsaid), &[], false);
    let rows: Vec<&str> = ran.out.lines().filter(|line| line.contains("mine gave neither entrance nor sign")).collect();
    assert!(ran.code == 1 && rows.len() == 2, "{}{}", ran.out, ran.err);
    assert!(
        rows.iter().all(|row| row.starts_with(" skip") && row.contains("what is not given is not compared")),
        "{rows:?}"
    );
    let row = ran.out.lines().find(|line| line.contains("engine mine answers")).expect("a row");
    assert!(row.contains("FAIL") && row.contains("whatever it answers would pass"), "{row}");
    assert!(row.contains("entrances and signs of gaps given for 0 of "), "{row}");

    let ran = gate(dir.path(), &around_few(&bare(), &format!("{unsaid}{}", limit("missing"))), &[], false);
    let told = "; mine answered 36 of 36 pairs, entrances and signs of gaps given for 0 of ";
    assert!(ran.code == 0 && ran.out.contains("gate passed: 2 passed, 2 skipped"), "{}{}", ran.out, ran.err);
    assert!(ran.out.contains(told), "{}", ran.out);
    let whole = around_few(&[client(), String::new()], &unsaid);
    let ran = gate(dir.path(), &whole, &[], false);
    assert!(ran.code == 0 && !ran.out.contains("signs of gaps given"), "{}{}", ran.out, ran.err);
}

/// An engine that leaves unsaid what it said when the baseline was written has no finding that is new, and fails all the same.
#[test]
fn an_engine_that_says_less_than_in_the_baseline_fails() {
    let dir = tempfile::tempdir().expect("a directory");
    let baseline = "[baseline]\nfile = \"known.toml\"\n";
    let whole = around_few(&[client(), String::new()], baseline);
    let ran = gate(dir.path(), &whole, &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = gate(dir.path(), &whole, &[], false);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
    let less = around_few(&bare(), baseline);
    let ran = gate(dir.path(), &less, &[], false);
    let row = ran.out.lines().find(|line| line.contains("fixed: engine mine says less of its contacts"));
    let row = row.unwrap_or_else(|| panic!("{}{}", ran.out, ran.err));
    assert!(ran.code == 1 && row.contains("FAIL") && row.contains("given for 0 of "), "{row}");
    // A file of an earlier version says nothing of it.
    let file = dir.path().join("known.toml");
    let text = std::fs::read_to_string(&file).expect("a baseline");
    let (start, rest) = text.split_once("\n[said]\n").expect("what engines said");
    let known = rest.split_once("\n[known]\n").expect("the sorts").1;
    std::fs::write(&file, format!("{start}\n[known]\n{known}")).expect("write");
    let ran = gate(dir.path(), &less, &[], false);
    assert!(ran.code == 0 && ran.out.contains("none new"), "{}{}", ran.out, ran.err);
}

/// Campaigns say of how many contacts entrances were given, tables do not show 0 of what was never said, and `compare` tells an engine that says less.
#[test]
fn what_an_engine_leaves_unsaid_is_told_by_campaign_report_and_compare() {
    let dir = tempfile::tempdir().expect("a directory");
    let dir = dir.path();
    let campaign = |out: &str, command: &[String]| {
        let words: Vec<String> = command.iter().map(|word| toml::Value::from(word.as_str()).to_string()).collect();
        let text = format!(
            "pairs = 32\nengines = []\nfamilies = [\"face_stack\", \"edge_cross\"]\nshrink_evaluations = 0\nsteps_every = 0\n\
             [[external]]\nname = \"mine\"\ncommand = [{}]\n",
            words.join(", ")
        );
        std::fs::write(dir.join("few.toml"), text).expect("write");
        let (code, said, err) = rockproof_in(dir, &["campaign", "few.toml", "--out", out]);
        assert_eq!(code, 0, "{said}{err}");
        said
    };
    let whole = campaign("whole", &[client(), String::new()]);
    assert!(!whole.contains("signs of gaps given"), "{whole}");
    let said = campaign("bare", &bare());
    let told = "entrances and signs of gaps given for 0 of ";
    let lines = ["Exactly right on hard pairs: mine ", "mine: "].map(|start| {
        said.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{said}")).contains(told)
    });
    assert_eq!(lines, [true, true], "{said}");
    let (code, page, err) = rockproof_in(dir, &["report", "bare", "--format", "markdown"]);
    assert!(code == 0 && page.contains(told), "{page}{err}");
    for (run, empty) in [("bare", true), ("whole", false)] {
        let (code, _, err) = rockproof_in(dir, &["report", run, "--out", &format!("{run}-page")]);
        assert_eq!(code, 0, "{err}");
        let table = std::fs::read_to_string(dir.join(format!("{run}-page/tables/agreement.csv"))).expect("a table");
        let row = table.lines().find(|row| row.contains(",mine,whole,")).unwrap_or_else(|| panic!("{table}"));
        assert_eq!(row.ends_with(",,"), empty, "{row}");
    }
    let (code, said, err) = rockproof_in(dir, &["compare", "whole", "bare"]);
    let less = said.lines().find(|line| line.starts_with("mine gave entrances and signs of gaps for "));
    let less = less.unwrap_or_else(|| panic!("{said}{err}"));
    assert!(code == 0 && less.contains(" before, for 0 of ") && less.ends_with("is not compared."), "{less}");
    // What is not compared any more must not pass for mended; an engine that says more is no regression.
    for deny in ["new", "more", "other"] {
        let codes = [["whole", "bare"], ["bare", "whole"], ["whole", "whole"], ["bare", "bare"]]
            .map(|[one, other]| rockproof_in(dir, &["compare", one, other, "--deny", deny]).0);
        assert_eq!(codes, [1, 0, 0, 0], "{deny}");
    }
    let (_, said, _) = rockproof_in(dir, &["compare", "whole", "whole"]);
    assert!(!said.contains("entrances and signs"), "{said}");
}
