//! What the exact audit of steps found (SPEC section 7), as a run records it. The audit is made outside: this crate knows no
//! oracle.

use crate::exact_float::{ExactFloat, in_four_digits};
use crate::false_entrances::{FalseEntrance, FalseEntranceTotals};
use rockproof_model::simulation::step_in_words;
use rockproof_model::text::noun;
use serde::{Deserialize, Serialize};

/// The columns of `steps.csv` that the audit fills; empty without one, those of passages where these are not looked for.
pub const COLUMNS: [&str; 5] =
    ["unseen_pairs", "true_penetration_m", "passages", "undecided_passages", "explained_pairs"];

/// Two blocks and how deep they overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairDepth {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// The penetration (m): the f64 nearest to the exact one, infinite beyond f64.
    pub depth_m: f64,
}

/// What of a step is audited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AuditScope {
    /// The blocks after the step: which overlap, how deep, and whether contacts see it.
    Overlaps,
    /// That, and within the step which pairs pass through one another.
    OverlapsAndPassages,
}

impl AuditScope {
    /// The name in the identity of a run.
    pub fn name(self) -> &'static str {
        match self {
            AuditScope::Overlaps => "overlaps",
            AuditScope::OverlapsAndPassages => "overlaps and passages",
        }
    }
}

/// The exact audit of one step: the blocks as they are after it, and what happened within it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepAudit {
    /// Pairs that overlap by more than rounding where no contact sees it, in ascending order, without those of `explained`.
    pub unseen: Vec<PairDepth>,
    /// Pairs that overlap so too, but by no more than springs of other contacts explain, in ascending order.
    pub explained: Vec<PairDepth>,
    /// The deepest overlap of all, of equal ones the first; none where all are within the rounding of f64.
    pub deepest: Option<PairDepth>,
    /// Whether that is deeper than `penetration`: only contacts that were closed before are still seen there.
    pub is_deep: bool,
    /// Pairs that are past the middle of one another, in ascending order, each with the overlap that a contact measures: contacts push them back the way they
    /// came, though the other way out is shorter.
    pub past_middle: Vec<PairDepth>,
    /// The false entrances through which contacts pressed, in ascending order.
    pub false_entrances: Vec<FalseEntrance>,
    /// The passages within the step; `None` where these were not looked for.
    pub passages: Option<StepPassages>,
}

/// Passages within one step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepPassages {
    /// Pairs that passed through one another, in ascending order, each with the depth that was shown; they may have been deeper at other
    /// times of the step.
    pub pairs: Vec<PairDepth>,
    /// Pairs of which neither a passage nor its absence was shown.
    pub undecided: u64,
}

impl StepAudit {
    /// The cells of [`COLUMNS`].
    pub fn cells(&self) -> [String; 5] {
        let deepest = self.deepest.map_or(0.0, |deepest| deepest.depth_m);
        let passages = self.passages.as_ref().map(|found| found.pairs.len().to_string());
        let undecided = self.passages.as_ref().map(|found| found.undecided.to_string());
        let [passages, undecided] = [passages, undecided].map(Option::unwrap_or_default);
        let unseen = self.unseen.len() + self.past_middle.len();
        [unseen.to_string(), format!("{deepest:?}"), passages, undecided, self.explained.len().to_string()]
    }
}

/// Whether a count need not be written.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks by reference")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// The deepest pair, of equal ones the first.
fn deepest_of(pairs: &[PairDepth]) -> Option<PairDepth> {
    pairs.iter().rev().copied().max_by(|one, two| one.depth_m.total_cmp(&two.depth_m))
}

/// The audits of all steps of a run, settling included.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AuditTotals {
    /// Steps audited.
    pub steps: u64,
    /// Steps after which some pair was unseen.
    pub steps_unseen: u64,
    /// Unseen pairs after the step with most of them.
    pub most_unseen: u64,
    /// The deepest overlap after a step that no contact saw.
    pub worst_unseen: Option<PairExtreme>,
    /// Steps after which springs of other contacts explained an overlap that no contact saw.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub steps_explained: u64,
    /// Such pairs after the step with most of them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub most_explained: u64,
    /// The deepest such overlap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_explained: Option<PairExtreme>,
    /// The deepest overlap after a step.
    pub deepest: Option<PairExtreme>,
    /// Steps after which some overlap was deeper than `penetration`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub steps_deep: u64,
    /// Steps after which some pair was past the middle of one another.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub steps_past_middle: u64,
    /// The first of these pairs, of several the one whose contact measures most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_past_middle: Option<PairExtreme>,
    /// The false entrances.
    #[serde(default, skip_serializing_if = "FalseEntranceTotals::has_no_steps")]
    pub false_entrances: FalseEntranceTotals,
    /// Passages, over all steps; none where they were not looked for.
    pub passages: Option<u64>,
    /// The passage with the greatest depth that was shown.
    pub worst_passage: Option<PairExtreme>,
    /// Pairs and steps of which neither a passage nor its absence was shown; none where passages were not looked for.
    pub undecided: Option<u64>,
}

/// The worst pair of a run and the step it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairExtreme {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// The penetration (m).
    pub depth_m: ExactFloat,
    /// The first step that has it; of settling 0 or below.
    pub step: i64,
}

impl AuditTotals {
    /// Adds the audit of a step.
    pub fn add(&mut self, step: i64, audit: &StepAudit) {
        self.steps += 1;
        self.steps_unseen += u64::from(!audit.unseen.is_empty());
        self.steps_deep += u64::from(audit.is_deep);
        self.steps_past_middle += u64::from(!audit.past_middle.is_empty());
        if self.first_past_middle.is_none() {
            let first = deepest_of(&audit.past_middle);
            self.first_past_middle =
                first.map(|PairDepth { blocks, depth_m }| PairExtreme { blocks, depth_m: ExactFloat(depth_m), step });
        }
        self.most_unseen = self.most_unseen.max(audit.unseen.len() as u64);
        self.steps_explained += u64::from(!audit.explained.is_empty());
        self.most_explained = self.most_explained.max(audit.explained.len() as u64);
        self.false_entrances.add(&audit.false_entrances, step);
        let passages = audit.passages.as_ref();
        if let Some(found) = passages {
            *self.passages.get_or_insert(0) += found.pairs.len() as u64;
            *self.undecided.get_or_insert(0) += found.undecided;
        }
        for (worst, found) in [
            (&mut self.worst_unseen, deepest_of(&audit.unseen)),
            (&mut self.worst_explained, deepest_of(&audit.explained)),
            (&mut self.deepest, audit.deepest),
            (&mut self.worst_passage, passages.and_then(|found| deepest_of(&found.pairs))),
        ] {
            let Some(PairDepth { blocks, depth_m }) = found else { continue };
            if worst.is_none_or(|worst| depth_m > worst.depth_m.0) {
                *worst = Some(PairExtreme { blocks, depth_m: ExactFloat(depth_m), step });
            }
        }
    }

    /// Whether blocks passed through one another or were about to: a passage, an overlap that no contact saw, or blocks past the middle of one another.
    pub fn finds_fault(&self) -> bool {
        self.steps_unseen > 0 || self.steps_past_middle > 0 || self.passages.is_some_and(|passages| passages > 0)
    }

    /// What was found, in one line, with the deepest overlap of all.
    pub fn sentence(&self) -> String {
        let deepest = match self.deepest {
            None => "no overlap beyond rounding after any step".to_owned(),
            deepest => format!("deepest overlap{}", worst_pair_note(deepest)),
        };
        format!("{}; {deepest}", self.verdict())
    }

    /// Whether contacts see every overlap and no pair passes through another, in one line. What springs of other contacts explain is told, and is no fault.
    pub fn verdict(&self) -> String {
        let mut parts: Vec<String> = Vec::new();
        if self.steps_unseen > 0 {
            let [count, steps, all] = [self.most_unseen, self.steps_unseen, self.steps];
            let pairs = if count == 1 { "1 pair overlaps".to_owned() } else { format!("up to {count} pairs overlap") };
            let worst = worst_pair_note(self.worst_unseen);
            parts.push(format!(
                "{pairs} unseen by contacts after {steps} of {all} {}{worst}",
                noun(all, "step", "steps")
            ));
        }
        if let Some(PairExtreme { blocks: [a, b], depth_m: ExactFloat(depth), step }) = self.first_past_middle {
            let [steps, all] = [self.steps_past_middle, self.steps];
            parts.push(format!(
                "past the middle of one another after {steps} of {all} {} (first {a}–{b}, {}, where a contact closed before measures {} m and pushes against the shorter way out)",
                noun(all, "step", "steps"),
                step_in_words(step),
                in_four_digits(depth)
            ));
        }
        let passages = self.passages.unwrap_or(0);
        if passages > 0 {
            let worst = worst_pair_note(self.worst_passage);
            parts.push(format!("{passages} {} within a step{worst}", noun(passages, "passage", "passages")));
        }
        if self.finds_fault() {
            let pass = passages > 0 || self.steps_past_middle > 0;
            let what = if pass { "pass through one another" } else { "overlap where no contact holds them" };
            parts[0].insert_str(0, &format!("blocks {what}: "));
            if let Some(explained) = self.explained_in_words() {
                parts.push(format!("not counted: unseen overlaps {explained}"));
            }
        } else {
            let none = match (self.passages, self.undecided) {
                (None, _) => "",
                (_, None | Some(0)) => " and no passage",
                _ => " and no passage shown",
            };
            let but = self.explained_in_words().map_or(String::new(), |explained| format!(" but those {explained}"));
            parts.push(format!("no unseen overlap{but}{none} in {} {}", self.steps, noun(self.steps, "step", "steps")));
        }
        if self.steps_deep > 0 && !self.finds_fault() {
            let (deep, all) = (self.steps_deep, self.steps);
            parts.push(format!(
                "deeper than penetration after {deep} of {all} {}, seen only by contacts that were closed before, and no block is past the middle of another",
                noun(all, "step", "steps")
            ));
        }
        match self.undecided {
            None if self.steps == 0 => {}
            None => parts.push("passages not looked for (--audit does)".to_owned()),
            Some(0) => {}
            Some(undecided) => parts.push(format!("{undecided} {} undecided", noun(undecided, "passage", "passages"))),
        }
        parts.join("; ")
    }

    /// What springs of other contacts explain of the overlaps that no contact saw; `None` where there is nothing of that kind.
    fn explained_in_words(&self) -> Option<String> {
        let PairExtreme { blocks: [a, b], depth_m: ExactFloat(depth), step } = self.worst_explained?;
        let pairs = match self.most_explained {
            1 => "1 pair at a time".to_owned(),
            count => format!("up to {count} pairs"),
        };
        let [steps, all] = [self.steps_explained, self.steps];
        Some(format!(
            "that springs elsewhere explain ({pairs} after {steps} of {all} {}, worst {a}–{b}, {} m, {})",
            noun(all, "step", "steps"),
            in_four_digits(depth),
            step_in_words(step)
        ))
    }

    /// The true penetration, in words: the deepest overlap after any step, with its pair and step.
    pub fn deepest_in_words(&self) -> String {
        let Some(PairExtreme { blocks: [a, b], depth_m: ExactFloat(depth), step }) = self.deepest else {
            return "none: no two blocks overlap by more than rounding after any step".to_owned();
        };
        format!("{} m at most, of blocks {a} and {b} in {}", in_four_digits(depth), step_in_words(step))
    }
}

/// The worst pair with its depth and step, in brackets.
fn worst_pair_note(worst: Option<PairExtreme>) -> String {
    let Some(PairExtreme { blocks: [a, b], depth_m: ExactFloat(depth), step }) = worst else { return String::new() };
    format!(" (worst {a}–{b}, {} m, {})", in_four_digits(depth), step_in_words(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: usize, b: usize, depth_m: f64) -> PairDepth {
        PairDepth { blocks: [a, b], depth_m }
    }

    fn passing(pairs: Vec<PairDepth>, undecided: u64) -> Option<StepPassages> {
        Some(StepPassages { pairs, undecided })
    }

    #[test]
    fn a_run_is_told_by_its_worst_pairs_and_the_first_steps_that_have_them() {
        let mut totals = AuditTotals::default();
        totals.add(0, &StepAudit { passages: passing(vec![], 0), ..StepAudit::default() });
        assert!(!totals.finds_fault());
        let nothing = "no unseen overlap and no passage in 1 step; no overlap beyond rounding after any step";
        assert_eq!(totals.sentence(), nothing);
        assert_eq!(totals.deepest_in_words(), "none: no two blocks overlap by more than rounding after any step");
        let held = StepAudit { deepest: Some(pair(0, 1, 0.5)), passages: passing(vec![], 0), ..StepAudit::default() };
        totals.add(1, &held);
        totals.add(2, &held);
        assert!(!totals.finds_fault() && !totals.sentence().contains("deeper than"));
        let mut deep = totals.clone();
        deep.add(3, &StepAudit { is_deep: true, ..held.clone() });
        let expected = "no unseen overlap and no passage in 4 steps; deeper than penetration after 1 of 4 steps, seen only by contacts that were closed before, and no block is past the middle of another";
        assert_eq!((deep.verdict().as_str(), deep.finds_fault()), (expected, false));
        assert!(totals.sentence().ends_with("; deepest overlap (worst 0–1, 0.5000 m, step 1)"));
        assert_eq!(totals.deepest_in_words(), "0.5000 m at most, of blocks 0 and 1 in step 1");
        totals.add(3, &StepAudit { unseen: vec![pair(2, 3, 1e-5), pair(4, 5, 1e-6)], ..held.clone() });
        totals.add(4, &StepAudit { unseen: vec![pair(4, 5, 2e-5)], ..held.clone() });
        let passed = StepAudit { passages: passing(vec![pair(6, 7, 0.25)], 3), ..held.clone() };
        totals.add(5, &passed);
        assert!(totals.finds_fault());
        let expected = "blocks pass through one another: up to 2 pairs overlap unseen by contacts after 2 of 6 steps \
                        (worst 4–5, 2.000e-5 m, step 4); 1 passage within a step (worst 6–7, 0.2500 m, step 5); 3 passages \
                        undecided; deepest overlap (worst 0–1, 0.5000 m, step 1)";
        assert_eq!(totals.sentence(), expected);
        assert_eq!(passed.cells(), ["0", "0.5", "1", "3", "0"]);
    }

    #[test]
    fn what_springs_elsewhere_explain_is_told_beside_what_is_sound_and_what_is_not() {
        let explained = |all: &[PairDepth]| StepAudit {
            explained: all.to_vec(),
            passages: passing(vec![], 0),
            ..StepAudit::default()
        };
        assert_eq!(explained(&[pair(2, 3, 1e-9), pair(4, 5, 2e-9)]).cells(), ["0", "0.0", "0", "0", "2"]);
        let mut totals = AuditTotals::default();
        totals.add(0, &explained(&[]));
        let text = serde_json::to_string(&totals).expect("JSON");
        assert!(!text.contains("explained"), "{text}");
        totals.add(1, &explained(&[pair(2, 3, 1e-9)]));
        let told = "no unseen overlap but those that springs elsewhere explain (1 pair at a time after 1 of 2 steps, worst 2–3, 1.000e-9 m, step 1) and no passage in 2 steps";
        assert_eq!((totals.verdict().as_str(), totals.finds_fault()), (told, false));
        totals.add(2, &explained(&[pair(2, 3, 1e-9), pair(4, 5, 2e-9)]));
        // Of equal ones the first.
        totals.add(3, &explained(&[pair(0, 1, 2e-9)]));
        let told = "that springs elsewhere explain (up to 2 pairs after 3 of 4 steps, worst 4–5, 2.000e-9 m, step 2)";
        assert_eq!(totals.verdict(), format!("no unseen overlap but those {told} and no passage in 4 steps"));
        totals.add(4, &StepAudit { unseen: vec![pair(2, 3, 0.5)], ..explained(&[]) });
        let expected = format!(
            "blocks overlap where no contact holds them: 1 pair overlaps unseen by contacts after 1 of 5 steps (worst 2–3, 0.5000 m, step 4); not counted: unseen overlaps {}",
            told.replace("3 of 4", "3 of 5")
        );
        assert_eq!((totals.verdict(), totals.finds_fault()), (expected, true));
        // As `run.json` and a checkpoint have it.
        let text = serde_json::to_string(&totals).expect("JSON");
        assert_eq!(serde_json::from_str::<AuditTotals>(&text).expect("what was written"), totals);
    }

    #[test]
    fn blocks_past_the_middle_of_one_another_are_told_by_the_first_step_that_has_them() {
        let mut totals = AuditTotals::default();
        totals.add(1, &StepAudit { is_deep: true, ..StepAudit::default() });
        assert!(!totals.finds_fault());
        let past = |depths: [f64; 2]| StepAudit {
            past_middle: vec![pair(0, 1, depths[0]), pair(0, 2, depths[1])],
            is_deep: true,
            ..StepAudit::default()
        };
        totals.add(2, &past([0.5, 0.625]));
        totals.add(3, &past([0.75, 0.875]));
        let expected = "blocks pass through one another: past the middle of one another after 2 of 3 steps (first 0–2, step 2, where a contact closed before measures 0.6250 m and pushes against the shorter way out); passages not looked for (--audit does)";
        assert_eq!((totals.finds_fault(), totals.verdict().as_str()), (true, expected));
        assert_eq!(past([0.5, 0.5]).cells()[0], "2");
    }

    #[test]
    fn passages_that_nobody_looked_for_are_not_said_to_be_none() {
        let mut totals = AuditTotals::default();
        let found = StepAudit { unseen: vec![pair(0, 2, 0.5), pair(1, 2, 0.5)], ..StepAudit::default() };
        assert_eq!(found.cells(), ["2", "0.0", "", "", "0"]);
        totals.add(1, &StepAudit::default());
        let nothing = "no unseen overlap in 1 step; passages not looked for (--audit does)";
        assert_eq!(totals.verdict(), nothing);
        totals.add(2, &found);
        // Of equal ones the first.
        assert!(totals.finds_fault() && totals.verdict().contains("after 1 of 2 steps (worst 0–2, 0.5000 m, step 2)"));
        assert_eq!((totals.passages, totals.undecided), (None, None));
    }

    #[test]
    fn a_pair_that_is_worst_while_blocks_settle_is_said_to_be() {
        let mut totals = AuditTotals::default();
        totals.add(-19, &StepAudit { deepest: Some(pair(0, 1, 0.5)), ..StepAudit::default() });
        let sentence = totals.sentence();
        assert!(sentence.ends_with("overlap (worst 0–1, 0.5000 m, settling step -19 (the last is 0))"), "{sentence}");
    }
}
