use super::*;
use std::fs;

#[test]
fn a_number_that_cannot_be_read_is_an_error_and_not_zero() {
    let dir = tempfile::tempdir().expect("a folder");
    let finding = "3,sliver,random,auto,f32,representation,missing,v-v,,,,1e-9,2.5,";
    let origin = "sliver,random,auto,1000,f32,representation,missing,v-v,1";
    let read = |finding: &str, origin: &str| {
        let write = |name: &str, columns: &[&str], row: &str| {
            fs::write(dir.path().join(name), format!("{}\n{row}\n", columns.join(","))).expect("write");
        };
        write("findings.csv", &FINDING_COLUMNS, finding);
        write("summary.csv", &SUMMARY_COLUMNS, origin);
        CampaignTally::read(dir.path())
    };
    let limit = FindingLimit { rate: Some(1e-4), beyond_ulps: Some(2.0), ..FindingLimit::default() };
    let found = read(finding, origin).expect("a tally").count(&limit);
    assert_eq!((found.pairs, found.examined, found.rate()), (1, 1000, 1e-3));
    for damaged in [finding.replacen('3', "x", 1), finding.replace("2.5", "2.5.1"), finding.replace(",f32,", ",,")] {
        let error = read(&damaged, origin).expect_err("no number").to_string();
        assert!(error.contains("findings.csv"), "{error}");
    }
    // Read as zero, no pair was examined, and the rate was within every limit.
    for damaged in [origin.replace("1000", "1000.0"), origin.replace("1000", ""), origin.replace("1000", "-1")] {
        let error = read(finding, &damaged).expect_err("no count").to_string();
        assert!(error.contains("summary.csv"), "{error}");
    }
    let error = read(finding, &format!("{origin}\n{}", origin.replace("1000", "9"))).expect_err("two counts");
    assert!(matches!(error, TallyError::Contradiction { found: [1000, 9], .. }), "{error}");
}

#[test]
fn a_table_without_its_columns_is_none_without_rows() {
    let dir = tempfile::tempdir().expect("a folder");
    let table = dir.path().join("findings.csv");
    let header = FINDING_COLUMNS.join(",");
    for (text, missing) in [("", "index"), ("\n", "index"), (&header.replace("cause", "because"), "cause")] {
        fs::write(&table, text).expect("write");
        let error = CampaignTally::read(dir.path()).expect_err("no table").to_string();
        assert!(error.contains(&format!("findings.csv: there is no column \"{missing}\"")), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn a_row_without_end_is_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = fs::File::create(dir.path().join("findings.csv")).expect("a file");
    // Sparse: it takes no room on the disk.
    file.set_len(3 << 30).expect("a sparse file");
    let error = CampaignTally::read(dir.path()).expect_err("one row").to_string();
    let text = "findings.csv: the row that begins in line 1 has more than 16777216 bytes; at most so many are read";
    assert!(error.ends_with(text), "{error}");
}

#[test]
fn passages_are_a_share_of_the_pairs_looked_through() {
    let dir = tempfile::tempdir().expect("a folder");
    let cell = |column: &&str| match *column {
        "family" | "form" | "tolerances" | "engine" => "sliver",
        "pairs" => "20",
        "watched" => "15",
        _ => "0",
    };
    let row: Vec<&str> = STEP_SUMMARY_COLUMNS.iter().map(cell).collect();
    let origin = "sliver,random,sliver,1000,f32,representation,missing,v-v,1";
    let [steps, row] = [STEP_SUMMARY_COLUMNS.join(","), row.join(",")];
    let tables = [(FINDING_COLUMNS.join(","), ""), (SUMMARY_COLUMNS.join(","), origin), (steps, &row)];
    for (name, (columns, row)) in ["findings", "summary", "step_summary"].iter().zip(tables) {
        fs::write(dir.path().join(format!("{name}.csv")), format!("{columns}\n{row}\n")).expect("write");
    }
    let tally = CampaignTally::read(dir.path()).expect("a tally");
    let examined = |change: Option<&str>| {
        tally.count(&FindingLimit { change: change.map(str::to_owned), ..FindingLimit::default() }).examined
    };
    assert_eq!([examined(Some("passage")), examined(Some("mode")), examined(None)], [15, 1000, 1000]);
}

#[test]
fn chance_is_the_binomial_tail() {
    let found = |pairs, examined, design_effect| LimitCount { findings: pairs, pairs, examined, design_effect };
    // P(X ≥ 2), X binomial of 10 and 0.1: 1 − 0.9¹⁰ − 10·0.1·0.9⁹.
    let tail = 1.0 - 0.9f64.powi(10) - 0.9f64.powi(9);
    assert!((found(2, 10, 1.0).chance(0.1) - tail).abs() < 1e-12);
    assert_eq!(found(0, 10, 1.0).chance(0.0), 1.0);
    assert_eq!(found(1, 10, 1.0).chance(0.0), 0.0);
    assert!(found(40, 1000, 8.0).chance(0.02) > found(40, 1000, 1.0).chance(0.02), "clustered pairs tell less");
}
