//! A gate says of a baseline whose counts cannot be those of its campaign that they are not, and of few pairs that they tell little.

use crate::gates::gate;
use std::fs;

const GATE: &str = "corpus = []\n[campaign]\npairs = 16\nfamilies = [\"size_ratio\"]\nengines = [\"f32\"]\ntolerances = [\"auto\"]\n\
                    [baseline]\nfile = \"known.toml\"\n";

#[test]
fn a_baseline_that_no_campaign_comes_to_is_refused_or_told() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let ran = gate(dir, GATE, &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let known = fs::read_to_string(dir.join("known.toml")).expect("a baseline");
    let ran = gate(dir, GATE, &[], false);
    assert!(ran.code == 0 && !ran.out.contains("settings of the baseline"), "{}{}", ran.out, ran.err);
    let change = |from: &str, to: &str| {
        assert!(known.contains(from), "{from}: {known}");
        fs::write(dir.join("known.toml"), known.replacen(from, to, 1)).expect("written");
        gate(dir, GATE, &[], false)
    };
    // As often as one likes might it then occur.
    let counts = known.lines().last().expect("a sort").rsplit_once(" = { ").expect("its counts").1;
    let often = "findings = 999999, pairs = 999999, squares = 999999 }";
    let ran = change(counts, often);
    let told = "pairs examined, which cannot be; --update-baseline writes it anew";
    assert!(ran.code == 2 && ran.err.contains("known.toml: ") && ran.err.contains(told), "{}{}", ran.out, ran.err);
    // Nor is anything significant of pairs that all hang together.
    let (start, _) = counts.rsplit_once("squares = ").expect("squares");
    let ran = change(counts, &format!("{start}squares = 99999999 }}"));
    assert!(ran.code == 2 && ran.err.contains("add up to 99999999, which cannot be"), "{}{}", ran.out, ran.err);
    // Those that were examined are other ones than it says.
    let row = known.lines().find(|line| line.starts_with("\"size_ratio\" = ")).expect("the family");
    let examined = row.rsplit_once(' ').expect("a number").1;
    let ran = change(row, "\"size_ratio\" = 999999");
    let told = format!("pairs examined of size_ratio are {examined}, in the baseline 999999; what is new or gone");
    let skipped = ran.out.lines().find(|line| line.contains("fixed: settings of the baseline"));
    let skipped = skipped.unwrap_or_else(|| panic!("{}{}", ran.out, ran.err));
    assert!(skipped.starts_with(" skip") && skipped.contains(&told), "{skipped}");
}

#[test]
fn few_pairs_are_said_to_tell_little_where_they_pass() {
    let dir = crate::place::folder();
    let of = |pairs: u32, limit: &str, more: &[&str]| {
        let text = format!(
            "corpus = []\n[campaign]\npairs = {pairs}\nfamilies = [\"sliver\"]\nengines = [\"f64\"]\ntolerances = [\"auto\"]\n\
             [[limit]]\n{limit}"
        );
        let ran = gate(dir.path(), &text, more, false);
        assert!(ran.code < 2, "{}{}", ran.out, ran.err);
        ran
    };
    let told = "fixed campaign: 1 pair examined. So few pairs tell little: 300 show a mistake of one pair in a hundred";
    let defect = "cause = \"defect\"\ncount = 0\n";
    let one = of(1, defect, &[]);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(one.code == 0 && words(&one.out).contains(told), "{}", one.out);
    let document: serde_json::Value = serde_json::from_str(&of(1, defect, &["--format", "json"]).out).expect("JSON");
    assert!(document["remarks"][0].as_str().is_some_and(|remark| remark.starts_with(told)), "{document}");
    assert_eq!(document["passed"], true);
    assert!(!of(320, defect, &[]).out.contains("tell little"), "enough pairs");
    // Where nothing passed there is nothing to be modest about.
    let skipped = of(1, "cause = \"defect\"\nrate = 0.001\n", &[]);
    assert!(skipped.code == 1 && !skipped.out.contains("tell little"), "{}", skipped.out);
}
