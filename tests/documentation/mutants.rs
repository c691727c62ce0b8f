//! The verdicts on mutants that no test finds, and the page that counts them (docs/mutants.md).

use std::collections::BTreeMap;
use std::path::Path;

/// The verdicts that a mutant may have; the page says what each means.
const VERDICTS: [&str; 6] = ["speed", "slack", "same", "text", "test", "gap"];

fn read(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(root.join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn every_mutant_that_lives_has_a_verdict_and_the_page_counts_them() {
    let table = read("examples/mutants/survivors.tsv");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("outcome\tverdict\tmutant\treason"));
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for line in lines {
        let cells: Vec<&str> = line.split('\t').collect();
        let [_, verdict, mutant, reason] = cells[..] else { panic!("not four cells: {line}") };
        assert!(VERDICTS.contains(&verdict), "no verdict: {line}");
        assert!(reason.len() > 10 && mutant.contains(".rs:"), "no reason: {line}");
        *counts.entry(verdict).or_default() += 1;
    }
    let page = read("docs/mutants.md");
    for verdict in VERDICTS {
        let count = counts.get(verdict).copied().unwrap_or(0);
        let row = page.lines().find(|line| line.starts_with(&format!("| `{verdict}` |")));
        let row = row.unwrap_or_else(|| panic!("the page has no row for {verdict}"));
        assert!(row.ends_with(&format!("| {count} |")), "{count} of {verdict}: {row}");
    }
}
