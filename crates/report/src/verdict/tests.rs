//! Pins which lines the verdict has, and how each is meant.

use super::*;
use crate::lockstep::LockstepRun;
use crate::motion::MotionRun;
use crate::step_tally::StepTally;
use crate::tally::FindingTally;
use rockproof_campaign::steps::STEP_FINDING_COLUMNS;
use rockproof_campaign::steps::summary::{StepCounts, StepGroup};
use rockproof_differential::agreement::ComparisonKey;
use rockproof_differential::finding::FINDING_COLUMNS;
use rockproof_simulate::audit::PairExtreme;
use rockproof_simulate::exact_float::ExactFloat;
use rockproof_simulate::totals::Extreme;
use rockproof_simulate::{AuditTotals, FalseEntranceSteps, FalseEntranceTotals, FirstFalseEntrance, Totals};
use serde::de::DeserializeOwned;
use serde_json::json;

fn rows<T: DeserializeOwned>(columns: &[&str], rows: &[&str]) -> Vec<T> {
    let text = format!("{}\n{}\n", columns.join(","), rows.join("\n"));
    csv::Reader::from_reader(text.as_bytes()).deserialize().map(|row| row.expect("a row")).collect()
}

/// A campaign of as many pairs as it takes, of which ten are compared, with these rows of its tables: engines by how many pairs they answer, all alike.
fn campaign(engines: &[(&str, u64)], findings: &[&str], step_findings: &[&str], steps: StepCounts) -> CampaignRun {
    let run = json!({
        "version": "0", "seed": 1, "configuration": {}, "machine": { "os": "", "architecture": "", "cores": 1 },
        "finished": true, "pairs": MIN_PAIRS, "contacts": 0, "findings": { "total": findings.len() },
        "metamorphic_checks": 0, "seconds": 1.0,
    });
    let (mut tally, mut step_tally) = (FindingTally::default(), StepTally::default());
    rows(&FINDING_COLUMNS, findings).into_iter().for_each(|row| tally.add(row));
    rows(&STEP_FINDING_COLUMNS, step_findings).into_iter().for_each(|row| step_tally.add(row));
    let agreement = engines.iter().map(|(engine, answered)| {
        let key = ComparisonKey { tolerances: "auto".into(), span: ChainSpan::Whole, engine: (*engine).to_owned() };
        let [pairs, agreeing, squared] = [10, *answered, 100];
        let counts = AgreementCounts {
            pairs,
            agreeing,
            silent: pairs - agreeing,
            agreeing_squared: agreeing * agreeing,
            agreeing_times_pairs: agreeing * pairs,
            pairs_squared: squared,
            ..AgreementCounts::default()
        };
        ("sliver".to_owned(), key, counts)
    });
    let [family, form, tolerances, engine] = ["sliver", "base", "auto", "stepper-f64"].map(str::to_owned);
    let steps = if steps == StepCounts::default() {
        Vec::new()
    } else {
        vec![(StepGroup { family, form, tolerances, engine }, steps)]
    };
    CampaignRun {
        dir: "run".into(),
        name: "run".to_owned(),
        run: serde_json::from_value(run).expect("a run"),
        agreement: agreement.collect(),
        confusion: Default::default(),
        tally,
        steps,
        step_tally,
        diagnosis: Vec::new(),
    }
}

/// Of an engine that says only how blocks lie the pairs that it does not take alone are counted along the whole chain, which would read as 0 % right.
#[test]
fn an_engine_without_contacts_has_no_rows_along_the_whole_chain() {
    let mut run = campaign(&[("states", 0), ("contacts", 7)], &[], &[], StepCounts::default());
    let arithmetic = campaign(&[("states", 6), ("contacts", 7)], &[], &[], StepCounts::default()).agreement;
    run.agreement.extend(
        arithmetic
            .into_iter()
            .map(|(family, key, counts)| (family, ComparisonKey { span: ChainSpan::Arithmetic, ..key }, counts)),
    );
    let expected =
        [("contacts", ChainSpan::Arithmetic), ("contacts", ChainSpan::Whole), ("states", ChainSpan::Arithmetic)];
    let mut settings: Vec<(String, ChainSpan)> =
        run.by_setting().into_keys().map(|key| (key.engine, key.span)).collect();
    settings.sort();
    assert_eq!(settings, expected.map(|(engine, span)| (engine.to_owned(), span)));
    let mut families: Vec<(&str, ChainSpan)> =
        run.by_family().into_keys().map(|(_, span, engine)| (engine, span)).collect();
    families.sort();
    assert_eq!(families, expected);
}

fn lines_of(run: CampaignRun) -> Vec<VerdictLine> {
    verdict(&Results { campaigns: vec![run], ..Results::default() })
}

fn has(lines: &[VerdictLine], severity: Severity, text: &str) -> bool {
    lines.iter().any(|line| line.severity == severity && line.text.starts_with(text))
}

const BOTH: [(&str, u64); 2] = [("stepper-f32", 10), ("stepper-f64", 10)];
/// So many steps, all of them watched.
const WATCHED: u64 = 8;

fn watched() -> StepCounts {
    StepCounts { pairs: WATCHED, steps: WATCHED, compared: WATCHED, watched: WATCHED, ..StepCounts::default() }
}

fn step(cause: &str, change: &str, case: &str) -> String {
    format!("3,sliver,base,auto,stepper-f64,1,{cause},{change},,,,,none,{change},,,,,,,,{case}")
}

#[test]
fn passages_are_told_with_causes_and_the_worst_and_nothing_is_called_well() {
    let rows = [
        step("step-length", "passage", "cases/length.json"),
        step("not-held", "passage", "cases/held.json"),
        step("arithmetic", "unseen", "cases/unseen.json"),
        step("tolerance", "iterations", "cases/iterations.json"),
    ];
    let counts = StepCounts { passages_stepper: 2, unseen_stepper: 1, ..watched() };
    let lines = lines_of(campaign(&[], &[], &rows.each_ref().map(String::as_str), counts));
    assert!(lines.iter().all(|line| line.severity == Severity::Fair), "{lines:?}");
    let told = "2 passages and 1 unseen overlap in 8 watched steps (3 findings, one where engines share it, by cause: arithmetic 1, not-held 1, step-length 1; worst: case cases/held.json); \
                1 other finding in steps (tolerance 1, mostly iterations).";
    assert!(has(&lines, Severity::Fair, told) && has(&lines, Severity::Fair, "No pair was classified"), "{lines:?}");
    // A passage that both engines make is one finding.
    let counts_of_both = StepCounts { passages_stepper: 4, ..counts };
    let lines = lines_of(campaign(&[], &[], &rows.each_ref().map(String::as_str), counts_of_both));
    let told = "4 passages and 1 unseen overlap in 8 watched steps (3 findings, one where engines share it, by cause: ";
    assert!(has(&lines, Severity::Fair, told), "{lines:?}");
    // A mistake in code comes before all else, and is bad whatever contacts say.
    let defect = step("defect", "unseen", "cases/defect.json");
    let counts = StepCounts { defect: 1, ..counts };
    let lines = lines_of(campaign(&BOTH, &[], &[&rows[1], &defect], counts));
    assert!(
        has(&lines, Severity::Bad, "1 difference of the pairs' steps is a mistake in code: look at this first."),
        "{lines:?}"
    );
    assert!(
        lines.iter().any(|line| line.severity == Severity::Bad && line.text.contains("worst: case cases/defect.json")),
        "{lines:?}"
    );
    assert!(!lines.iter().any(|line| line.text.contains("No difference")), "{lines:?}");
    // Without a case the pair is named.
    let lines = lines_of(campaign(&BOTH, &[], &[&step("not-held", "passage", "")], counts));
    assert!(
        lines.iter().any(|line| line.text.contains("worst: passage of pair 3 of sliver under auto, without a case")),
        "{lines:?}"
    );
}

#[test]
fn steps_are_good_only_where_all_were_watched_and_agree() {
    let told = |rows: &[&str], counts| lines_of(campaign(&BOTH, &[], rows, counts));
    let lines = told(&[], watched());
    assert!(has(&lines, Severity::Good, "No passage and no unseen overlap in 8 watched steps."), "{lines:?}");
    assert!(has(&lines, Severity::Good, "No difference was found at all in 300 pairs."), "{lines:?}");
    let lines = told(&[], StepCounts::default());
    assert!(has(&lines, Severity::Fair, "No step was made, so nothing is known of passages"), "{lines:?}");
    let lines = told(&[], StepCounts { pairs: 2, silent: 2, ..StepCounts::default() });
    assert!(has(&lines, Severity::Fair, "None of 2 steps could be watched"), "{lines:?}");
    for counts in [
        StepCounts { silent: 1, ..watched() },
        StepCounts { steps: WATCHED + 1, stopped: 1, ..watched() },
        StepCounts { passages_undecided: 1, ..watched() },
    ] {
        assert!(
            has(&told(&[], counts), Severity::Fair, "No passage and no unseen overlap in 8 watched steps; "),
            "{counts:?}"
        );
    }
    let lines = told(&[&step("tolerance", "mode", "")], watched());
    let text =
        "No passage and no unseen overlap in 8 watched steps; 1 other finding in steps (tolerance 1, mostly mode).";
    assert!(
        has(&lines, Severity::Fair, text)
            && has(&lines, Severity::Good, "No difference of contacts was found in 300 pairs."),
        "{lines:?}"
    );
    let lines = told(&[&step("arithmetic", "passage", "")], StepCounts { passages_oracle: 1, ..watched() });
    assert!(
        has(&lines, Severity::Fair, "Passages or unseen overlaps in exact steps alone, none in an engine's, of 8"),
        "{lines:?}"
    );
    // A panic has no step, so no count, and is a mistake all the same.
    let lines = told(&[&step("defect", "stopped", "")], watched());
    assert!(has(&lines, Severity::Bad, "1 difference of the pairs' steps is a mistake"), "{lines:?}");
}

#[test]
fn code_that_never_answered_is_not_called_free_of_mistakes() {
    let collapsed = ["0,real,base,auto,f32,representation,collapsed,,,,,,,"];
    let lines = lines_of(campaign(&[("stepper-f32", 0)], &collapsed, &[], watched()));
    assert!(
        has(&lines, Severity::Fair, "Exactly right on hard pairs: stepper-f32 0 % of 10 comparisons ("),
        "{lines:?}"
    );
    assert!(lines[0].text.ends_with("without an answer to any pair."), "{lines:?}");
    let text = "No built-in engine answered, so nothing is known of their code. What differs (1 finding) is due to: representation 100 %.";
    assert!(has(&lines, Severity::Fair, text), "{lines:?}");
    let lines = lines_of(campaign(&[("stepper-f32", 0), ("stepper-f64", 10)], &collapsed, &[], watched()));
    assert!(has(&lines, Severity::Good, "No mistake in code of stepper-f64 was found in 300 pairs."), "{lines:?}");
}

/// Its lines look final otherwise.
#[test]
fn a_campaign_that_was_interrupted_is_said_to_be_before_all_else() {
    let interrupted = || {
        let mut run = campaign(&BOTH, &[], &[], watched());
        run.run.finished = false;
        run.run.configuration.insert("pairs".to_owned(), 60_000.into());
        run
    };
    let lines = lines_of(interrupted());
    let told = "Not finished (interrupted after 300 of 60\u{202f}000 pairs): the rest is about these pairs alone.";
    assert!(lines[0].severity == Severity::Fair && lines[0].text == told, "{lines:?}");
    // It takes the place of no other line.
    assert_eq!(lines[1..], lines_of(campaign(&BOTH, &[], &[], watched()))[..]);
    let mut part = interrupted();
    part.run.configuration.insert("part".to_owned(), "1/2".into());
    assert!(lines_of(part)[0].text.starts_with("Not finished (interrupted after 300 pairs)"), "of the part's own");
    // A merge that does without parts says so elsewhere, and one before its first pair is not final anyhow.
    let mut merged = interrupted();
    merged.run.configuration.insert("parts".to_owned(), "1 of 2".into());
    assert!(!lines_of(merged)[0].text.contains("Not finished"));
    let mut begun = interrupted();
    begun.run.pairs = 0;
    assert!(!lines_of(begun).iter().any(|line| line.text.contains("Not finished")));
    let both = [interrupted(), campaign(&BOTH, &[], &[], watched())];
    let lines = verdict(&Results { campaigns: both.into(), ..Results::default() });
    assert!(lines[0].text.starts_with("Not finished (run, interrupted after 300 of"), "{lines:?}");
}

/// What an engine says that it does not support is no mistake: the share of the rest is told beside.
#[test]
fn pairs_that_an_engine_does_not_support_are_told_apart() {
    let row = |index: u32| format!("{index},sliver,base,auto,mine,engine,unsupported,,,,,,,");
    let unsupported: Vec<String> = (0..4).map(row).collect();
    let rows: Vec<&str> = unsupported.iter().map(String::as_str).collect();
    let lines = lines_of(campaign(&[("mine", 6)], &rows, &[], watched()));
    assert!(lines[0].text.starts_with("Exactly right on hard pairs: mine 60.00 % of 10 comparisons ("), "{lines:?}");
    assert!(lines[0].text.ends_with("), 100 % of the 6 comparisons that it supports."), "{lines:?}");
    let lines = lines_of(campaign(&[("mine", 6)], &[], &[], watched()));
    assert!(!lines[0].text.contains("supports"), "{lines:?}");
}

#[test]
fn an_engine_that_is_not_always_right_does_not_hide_one_that_had_to_be_started_anew() {
    let mut run = campaign(&[("a-mine", 10), ("stepper-f32", 9)], &[], &[], watched());
    let counts = json!({ "asked": 4, "processes_started": 2, "recovered": 1, "not_compared": 0 });
    run.run.external_engines.insert("a-mine".to_owned(), serde_json::from_value(counts).expect("counts"));
    let lines = lines_of(run);
    assert!(has(&lines, Severity::Bad, "Exactly right on hard pairs: a-mine 100 % of 10 comparisons ("), "{lines:?}");
}

#[test]
fn a_lockstep_is_good_only_where_no_decision_differs_and_no_bad_line_is_left_out() {
    let of = |run: LockstepRun, motions| verdict(&Results { locksteps: vec![run], motions, ..Results::default() });
    let run = LockstepRun { steps: 5, ..LockstepRun::default() };
    assert!(has(&of(run.clone(), Vec::new()), Severity::Good, "In motion, 0 of 5 steps"));
    for other in [
        LockstepRun { modes_differ: 1, ..run.clone() },
        LockstepRun { converged_differ: 1, ..run.clone() },
        LockstepRun { failure: Some("step 3: no".to_owned()), ..run.clone() },
        LockstepRun::default(),
    ] {
        let lines = of(other, Vec::new());
        assert!(has(&lines, Severity::Fair, "In motion, 0 of "), "{lines:?}");
    }
    let audit = AuditTotals { steps: 5, passages: Some(1), ..AuditTotals::default() };
    let motion = |name: &str, audit| MotionRun {
        name: name.to_owned(),
        totals: Totals { audit, steps: 5, ..Totals::default() },
        ending: "finished".to_owned(),
        ..MotionRun::default()
    };
    for (steps, severity) in [(5, Severity::Fair), (299, Severity::Fair), (300, Severity::Good)] {
        let lines = of(LockstepRun { steps, ..LockstepRun::default() }, Vec::new());
        assert!(has(&lines, severity, "No mistake in code was found in the steps."), "{lines:?}");
        let says_so = lines.iter().any(|line| line.text.contains("300 show a mistake of one step in a hundred"));
        assert_eq!(says_so, steps < 300, "{lines:?}");
    }
    let defect = LockstepRun { causes: [(Cause::Defect, 2)].into(), ..run.clone() };
    let lines = of(defect, vec![motion("shot", Some(audit.clone())), motion("second", Some(audit))]);
    assert!(lines[0].severity == Severity::Bad && lines[0].text.starts_with("shot: blocks pass through"), "{lines:?}");
    assert!(lines[0].text.ends_with("; so they do in 1 other run."), "{lines:?}");
    assert!(has(&lines, Severity::Bad, "2 differences of the steps are mistakes"), "{lines:?}");
    let sound = AuditTotals { steps: 5, passages: Some(0), undecided: Some(0), ..AuditTotals::default() };
    let lines = of(run.clone(), vec![motion("one", Some(sound.clone())), motion("two", None)]);
    assert!(
        has(&lines, Severity::Fair, "No passage and no unseen overlap in 5 audited steps of 1 of 2 runs."),
        "{lines:?}"
    );
    let overlaps_alone = AuditTotals { steps: 5, ..AuditTotals::default() };
    let lines = of(run.clone(), vec![motion("one", Some(overlaps_alone.clone())), motion("two", Some(sound.clone()))]);
    let told = "No passage and no unseen overlap in 10 audited steps of 2 of 2 runs; passages within steps were not looked for in 1";
    assert!(has(&lines, Severity::Fair, told), "{lines:?}");
    let lines = of(run.clone(), vec![motion("one", Some(overlaps_alone))]);
    assert!(has(&lines, Severity::Fair, "one: no unseen overlap in 5 steps; passages"), "{lines:?}");
    let deepest = |depth_m| Some(PairExtreme { blocks: [0, 1], depth_m: ExactFloat(depth_m), step: 3 });
    let deep = |steps_deep, depth_m| AuditTotals { steps_deep, deepest: deepest(depth_m), ..sound.clone() };
    // The third is deepest, but no deeper than its `penetration`.
    let deep = [("one", deep(2, 0.25)), ("two", deep(3, 0.5)), ("three", deep(0, 0.75))];
    let lines = of(run.clone(), deep.map(|(name, audit)| motion(name, Some(audit))).into());
    let told = "No passage and no unseen overlap in 15 audited steps of 3 of 3 runs; blocks overlap deeper than `penetration` after 5 of 15 steps (at most 0.500 m, in two).";
    assert!(has(&lines, Severity::Fair, told), "{lines:?}");
    let open = AuditTotals { undecided: Some(1), ..sound.clone() };
    assert!(has(&of(run.clone(), vec![motion("one", Some(sound))]), Severity::Good, "one: no unseen overlap"));
    assert!(has(&of(run, vec![motion("one", Some(open))]), Severity::Fair, "one: no unseen overlap"));
}

#[test]
fn a_run_by_force_or_without_settled_friction_is_doubted() {
    let of = |motions| verdict(&Results { motions, ..Results::default() });
    let sound = ended("finished", 5, Some(5), "");
    assert!(of(vec![sound.clone()]).iter().all(|line| line.severity == Severity::Good));
    let forced = MotionRun { violated: vec!["r ≥ s".to_owned(), "s ≥ t".to_owned()], ..sound.clone() };
    let lines = of(vec![forced.clone()]);
    assert!(has(&lines, Severity::Fair, "one: run by --force although its tolerances violate 2 rules: r ≥ s; s ≥ t."));
    assert!(lines[0].severity == Severity::Fair, "{lines:?}");
    let mut slipping = sound.clone();
    slipping.totals.unsettled = 2;
    slipping.totals.friction_left = Extreme { value: ExactFloat(0.625), step: 4 };
    let mut thrown = sound.clone();
    let first = FirstFalseEntrance { blocks: [0, 1], into: None, share: ExactFloat(0.5), step: 3 };
    let unmet = FalseEntranceSteps { steps: 2, first: Some(first), most: ExactFloat(0.75) };
    let false_entrances = FalseEntranceTotals { steps: 5, unmet, ..FalseEntranceTotals::default() };
    let audit = AuditTotals { steps: 5, false_entrances, ..AuditTotals::default() };
    thrown.totals.audit = Some(audit);
    let told = "one: false entrances: contacts pushed blocks apart that never met in 2 of 5 steps (first 0–1, step 3, with 50.0 %";
    assert!(has(&of(vec![thrown]), Severity::Fair, told));
    let lines = of(vec![slipping, sound]);
    let told = "one: friction not settled in 2 steps (in step 4 by 62 % of the forces on a block)";
    assert!(has(&lines, Severity::Fair, told), "{lines:?}");
    let lines = of(vec![forced.clone(), forced]);
    assert!(lines[0].text.ends_with("; likewise 1 other run."), "{lines:?}");
}

#[test]
fn few_pairs_without_a_mistake_are_not_called_well() {
    let finding = ["0,real,base,auto,any,tolerance,missing,,,,,,,"];
    for findings in [&[][..], &finding] {
        let mut run = campaign(&BOTH, findings, &[], StepCounts::default());
        let lines = |run: &CampaignRun| mistakes(std::slice::from_ref(run)).expect("a line");
        let line = lines(&run);
        assert!(line.severity == Severity::Good && line.text.contains(" in 300 pairs."), "{line:?}");
        run.run.pairs = MIN_PAIRS - 1;
        let line = lines(&run);
        assert!(line.severity == Severity::Fair && line.text.contains(" in 299 pairs."), "{line:?}");
        assert!(line.text.contains("300 show a mistake of one pair in a hundred with 95 %"), "{line:?}");
        run.run.pairs = 1;
        run.run.configuration.insert("part".to_owned(), "1/2".into());
        let line = lines(&run);
        assert!(line.severity == Severity::Fair && line.text.contains(" in 1 pair (part 1 of 2)."), "{line:?}");
    }
    // What the number is chosen by.
    assert!(0.99_f64.powi(MIN_PAIRS as i32) < 0.05 && 0.99_f64.powi(MIN_PAIRS as i32 - 10) > 0.05);
}

/// A run of five audited steps in which all is well, asked for so many, with an ending.
fn ended(ending: &str, steps: u64, asked: Option<u64>, reason: &str) -> MotionRun {
    let audit = AuditTotals { steps, passages: Some(0), undecided: Some(0), ..AuditTotals::default() };
    MotionRun {
        name: "one".to_owned(),
        totals: Totals { audit: (steps > 0).then_some(audit), steps, ..Totals::default() },
        ending: ending.to_owned(),
        steps_asked: asked,
        time_asked_s: asked.is_none().then_some(2.0),
        time_s: 0.5,
        reason: reason.to_owned(),
        ..MotionRun::default()
    }
}

#[test]
fn a_run_that_was_cut_short_is_not_called_well_and_says_where_and_why() {
    let of = |runs: Vec<MotionRun>| verdict(&Results { motions: runs, ..Results::default() });
    let lines = of(vec![ended("finished", 5, Some(5), "")]);
    assert!(has(&lines, Severity::Good, "one: no unseen overlap"), "{lines:?}");
    for (run, told) in [
        (ended("stopped", 3, Some(5), "step 4: no"), "one: stopped at step 4 of 5: no; no unseen overlap"),
        (ended("interrupted", 70, Some(300), ""), "one: interrupted after 70 of 300 steps; no unseen overlap"),
        (ended("interrupted", 70, None, ""), "one: interrupted after 70 steps, at 0.500 of 2.000 s; no unseen overlap"),
        (ended("unproved", 3, Some(5), "why"), "one: stopped at step 4 of 5: why; no unseen overlap"),
        (ended("stopped", 0, Some(5), "why"), "one: stopped at step 1 of 5: why; no step was made"),
        (ended("finished", 0, Some(0), ""), "one: no step was made, so nothing is known of overlaps."),
    ] {
        let lines = of(vec![run.clone()]);
        assert!(lines.len() == 1 && has(&lines, Severity::Fair, told), "{told}: {lines:?}");
        let lines = of(vec![ended("finished", 5, Some(5), ""), run.clone()]);
        assert!(lines.iter().all(|line| line.severity == Severity::Fair), "{lines:?}");
        assert_eq!(lines.len(), if run.ending == "finished" { 1 } else { 2 }, "{lines:?}");
    }
}
