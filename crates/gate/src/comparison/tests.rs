use super::*;
use rockproof_campaign::summary::SUMMARY_COLUMNS;
use rockproof_differential::finding::FINDING_COLUMNS;
use std::fs;

/// A campaign over 1,000 pairs of one family with findings of one sort in these pairs, and of another in those.
fn tally(gaps: &[u64], others: &[u64]) -> CampaignTally {
    let dir = tempfile::tempdir().expect("a folder");
    let row = |index: &u64, change: &str| {
        format!("{index},sliver,random,auto,stepper-f32,arithmetic,{change},v-f,v-f,gap,,1e-9,2.5,")
    };
    let rows: Vec<String> = gaps
        .iter()
        .map(|index| row(index, "gap-sign"))
        .chain(others.iter().map(|index| row(index, "entrance")))
        .collect();
    let summary = "sliver,random,auto,1000,stepper-f32,arithmetic,gap-sign,v-f,1";
    let write = |name: &str, columns: &[&str], rows: &str| {
        fs::write(dir.path().join(name), format!("{}\n{rows}\n", columns.join(","))).expect("write");
    };
    write("findings.csv", &FINDING_COLUMNS, &rows.join("\n"));
    write("summary.csv", &SUMMARY_COLUMNS, summary);
    CampaignTally::read(dir.path()).expect("a tally")
}

fn compare(before: &CampaignTally, after: &CampaignTally, same_pairs: Option<u64>) -> Vec<(String, Trend)> {
    let engines = BTreeSet::from(["stepper-f32".to_owned()]);
    let same_pairs = same_pairs.map(|pairs| std::iter::once(0..pairs).collect());
    let found = FindingComparison::of(before, after, &Comparable { same_pairs, engines, tolerance: true });
    found.classes.into_iter().map(|class| (class.class.change, class.trend)).collect()
}

fn named(changes: &[(&str, Trend)]) -> Vec<(String, Trend)> {
    changes.iter().map(|(name, trend)| ((*name).to_owned(), *trend)).collect()
}

#[test]
fn over_the_same_pairs_every_difference_counts() {
    let (none, one, two) = (tally(&[], &[5]), tally(&[3], &[5]), tally(&[3, 40], &[6]));
    assert_eq!(compare(&none, &one, Some(1000)), named(&[("gap-sign", Trend::New), ("entrance", Trend::Same)]));
    assert_eq!(compare(&one, &two, Some(1000)), named(&[("gap-sign", Trend::More), ("entrance", Trend::Other)]));
    assert_eq!(compare(&two, &one, Some(1000)), named(&[("entrance", Trend::Other), ("gap-sign", Trend::Fewer)]));
    assert_eq!(compare(&one, &none, Some(1000)), named(&[("gap-sign", Trend::Gone), ("entrance", Trend::Same)]));
    // Pair 40 was not examined by the shorter run.
    assert_eq!(compare(&one, &two, Some(16)), named(&[("entrance", Trend::Other), ("gap-sign", Trend::Same)]));
}

#[test]
fn over_other_pairs_a_difference_must_be_no_chance() {
    // One pair a batch, so that all are independent.
    let some = |count: u64| -> Vec<u64> { (0..count).map(|n| 16 * n).collect() };
    let (few, alike, many) = (tally(&some(10), &[]), tally(&some(14), &[]), tally(&some(60), &[]));
    assert_eq!(compare(&few, &alike, None), named(&[("gap-sign", Trend::Same)]));
    assert_eq!(compare(&few, &many, None), named(&[("gap-sign", Trend::More)]));
    assert_eq!(compare(&many, &few, None), named(&[("gap-sign", Trend::Fewer)]));
    let none = tally(&[], &[]);
    assert_eq!(compare(&none, &few, None), named(&[("gap-sign", Trend::New)]));
    assert_eq!(compare(&many, &none, None), named(&[("gap-sign", Trend::Gone)]));
    assert_eq!(
        compare(&tally(&[16], &[]), &none, None),
        named(&[("gap-sign", Trend::Same)]),
        "one finding may be missed by chance"
    );
}

#[test]
fn who_takes_part_in_one_run_alone_is_left_out() {
    let (before, after) = (tally(&[], &[]), tally(&[3], &[]));
    let comparable = Comparable {
        same_pairs: Some(std::iter::once(0..1000).collect()),
        engines: BTreeSet::from(["mine".to_owned()]),
        tolerance: true,
    };
    assert!(FindingComparison::of(&before, &after, &comparable).classes.is_empty());
}
