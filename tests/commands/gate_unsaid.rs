//! What an external engine leaves unsaid of its contacts is not compared, and the gate tells it.
#![cfg(unix)]

use crate::engines::client;
use crate::gates::{around, gate};

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
