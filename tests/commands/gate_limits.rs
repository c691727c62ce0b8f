//! No limit on what a campaign finds is refused.

use crate::place::Place;
use rockproof_gate::config::GateConfig;
use std::collections::BTreeSet;

/// Each sort of finding that a campaign has may be limited.
#[test]
fn what_a_campaign_finds_may_be_limited() {
    limits_on_what_is_found("512");
}

#[test]
#[ignore = "four seconds; .ci/run runs it"]
fn what_a_campaign_finds_may_be_limited_at_full_size() {
    limits_on_what_is_found("1024");
}

fn limits_on_what_is_found(pairs: &str) {
    let place = Place::new();
    place.file(
        "mine.sh",
        "exec sed -u 's/^{\"id\":\\([0-9]*\\),.*/{\"id\":\\1,\"state\":\"overlapping\",\"depth\":1}/'\n",
    );
    // To make cases smaller would take four times as long as to find them.
    place.file("campaign.toml", "cases_per_cause = 0\n");
    // Seed 4 has overlaps that contacts of the step before do not hold.
    let campaign = "campaign campaign.toml --seed 4 --steps-every 8 --out run --tolerances auto,shi,zero --pairs";
    let campaign: Vec<&str> = campaign.split(' ').chain([pairs]).collect();
    let mine = ["--engine", "stepper-f32,stepper-f64,mine", "--engine-command", "mine=sh mine.sh"];
    let (code, out, err) = place.run(&[&campaign[..], &mine].concat());
    assert_eq!(code, 0, "{out}{err}");
    let mut sorts: BTreeSet<String> = BTreeSet::new();
    for row in ["run/findings.csv", "run/step_findings.csv"].iter().flat_map(|table| place.rows(table)) {
        let mut limit = format!("cause = \"{}\"\nchange = \"{}\"\ncount = 0\n", row["cause"], row["change"]);
        let kind = row.get("kind").or_else(|| row.get("kind_before").filter(|kind| !kind.is_empty()));
        let kind = kind.or_else(|| row.get("kind_after")).filter(|kind| kind.contains('-'));
        limit.extend(kind.map(|kind| format!("kind = \"{kind}\"\n")));
        if !row["margin_ulps"].is_empty() {
            limit.push_str("beyond_ulps = 0\n");
        }
        sorts.insert(limit);
    }
    for limit in &sorts {
        let read = GateConfig::from_toml(&format!("[[limit]]\n{limit}"), "gate.toml");
        assert!(read.is_ok(), "{limit}: {}", read.expect_err("refused"));
    }
    for some in
        ["not-held", "\"unseen\"", "\"mode\"", "\"state\"", "tolerance", "representation", "arithmetic", "engine"]
    {
        assert!(sorts.iter().any(|limit| limit.contains(some)), "{some}: {sorts:?}");
    }
}
