//! What the exact audit of steps found (SPEC section 7), as a run records it. The audit is made outside: this crate knows no
//! oracle.

use crate::exact_float::ExactFloat;
use rockproof_model::simulation::step_in_words;
use serde::{Deserialize, Serialize};

/// The columns of `steps.csv` that the audit fills; empty without one.
pub const COLUMNS: [&str; 4] = ["unseen_pairs", "true_penetration_m", "passages", "undecided_passages"];

/// Two blocks and how deep they overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairDepth {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// The penetration (m): the f64 nearest to the exact one, infinite beyond f64.
    pub depth_m: f64,
}

/// The exact audit of one step: the blocks as they are after it, and what happened within it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepAudit {
    /// Pairs that overlap by more than rounding where no contact sees it.
    pub unseen: u64,
    /// The deepest of these, of equal ones the first.
    pub worst_unseen: Option<PairDepth>,
    /// The deepest overlap of all.
    pub deepest: Option<PairDepth>,
    /// Pairs that passed through one another within the step.
    pub passages: u64,
    /// The passage with the greatest depth that was shown; pairs may have been deeper at other times of the step.
    pub worst_passage: Option<PairDepth>,
    /// Pairs of which neither a passage nor its absence was shown.
    pub undecided: u64,
    /// The pairs behind `unseen`, in ascending order.
    pub unseen_pairs: Vec<PairDepth>,
    /// The pairs behind `passages`, in ascending order, each with the depth that was shown.
    pub passage_pairs: Vec<PairDepth>,
}

impl StepAudit {
    /// The cells of [`COLUMNS`].
    pub fn cells(&self) -> [String; 4] {
        let deepest = self.deepest.map_or(0.0, |deepest| deepest.depth_m);
        [self.unseen.to_string(), format!("{deepest:?}"), self.passages.to_string(), self.undecided.to_string()]
    }
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
    /// The deepest overlap after a step.
    pub deepest: Option<PairExtreme>,
    /// Passages, over all steps.
    pub passages: u64,
    /// The passage with the greatest depth that was shown.
    pub worst_passage: Option<PairExtreme>,
    /// Pairs and steps of which neither a passage nor its absence was shown.
    pub undecided: u64,
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
        self.steps_unseen += u64::from(audit.unseen > 0);
        self.most_unseen = self.most_unseen.max(audit.unseen);
        self.passages += audit.passages;
        self.undecided += audit.undecided;
        for (worst, found) in [
            (&mut self.worst_unseen, audit.worst_unseen),
            (&mut self.deepest, audit.deepest),
            (&mut self.worst_passage, audit.worst_passage),
        ] {
            let Some(PairDepth { blocks, depth_m }) = found else { continue };
            if worst.is_none_or(|worst| depth_m > worst.depth_m.0) {
                *worst = Some(PairExtreme { blocks, depth_m: ExactFloat(depth_m), step });
            }
        }
    }

    /// Whether blocks passed through one another or were about to: a passage, or an overlap that no contact saw.
    pub fn objects(&self) -> bool {
        self.steps_unseen > 0 || self.passages > 0
    }

    /// What was found, in one line.
    pub fn sentence(&self) -> String {
        let mut parts: Vec<String> = Vec::new();
        if self.steps_unseen > 0 {
            let [count, steps, all] = [self.most_unseen, self.steps_unseen, self.steps];
            let pairs = if count == 1 { "1 pair overlaps".to_owned() } else { format!("up to {count} pairs overlap") };
            let worst = worst_pair_note(self.worst_unseen);
            parts.push(format!("{pairs} where no contact sees it, after {steps} of {all} steps{worst}"));
        }
        if self.passages > 0 {
            let passages = if self.passages == 1 { "passage" } else { "passages" };
            let worst = worst_pair_note(self.worst_passage);
            parts.push(format!("{} {passages} within a step{worst}", self.passages));
        }
        if self.objects() {
            parts[0].insert_str(0, "blocks pass through one another: ");
        } else {
            parts.push(format!("contacts see every overlap after {} steps, and no passage within one", self.steps));
        }
        if self.undecided > 0 {
            parts.push(format!("{} passages undecided", self.undecided));
        }
        parts.push(match self.deepest {
            None => "no overlap after any step".to_owned(),
            deepest => format!("deepest overlap of all{}", worst_pair_note(deepest)),
        });
        parts.join("; ")
    }
}

/// The worst pair with its depth and step, in brackets.
fn worst_pair_note(worst: Option<PairExtreme>) -> String {
    let Some(PairExtreme { blocks: [a, b], depth_m: ExactFloat(depth), step }) = worst else { return String::new() };
    let depth = if (1e-3..1e4).contains(&depth) { format!("{depth:.4}") } else { format!("{depth:.3e}") };
    format!(" (worst {a}–{b}, {depth} m, {})", step_in_words(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(a: usize, b: usize, depth_m: f64) -> Option<PairDepth> {
        Some(PairDepth { blocks: [a, b], depth_m })
    }

    #[test]
    fn a_run_is_told_by_its_worst_pairs_and_the_first_steps_that_have_them() {
        let mut totals = AuditTotals::default();
        totals.add(0, &StepAudit::default());
        assert!(!totals.objects());
        let nothing = "contacts see every overlap after 1 steps, and no passage within one; no overlap after any step";
        assert_eq!(totals.sentence(), nothing);
        let held = StepAudit { deepest: pair(0, 1, 0.5), ..StepAudit::default() };
        totals.add(1, &held);
        totals.add(2, &held);
        assert!(!totals.objects());
        assert!(totals.sentence().ends_with("; deepest overlap of all (worst 0–1, 0.5000 m, step 1)"));
        let unseen = |count, worst| StepAudit { unseen: count, worst_unseen: worst, ..held.clone() };
        totals.add(3, &unseen(2, pair(2, 3, 1e-5)));
        totals.add(4, &unseen(1, pair(4, 5, 2e-5)));
        let passed = StepAudit { passages: 1, worst_passage: pair(6, 7, 0.25), undecided: 3, ..held.clone() };
        totals.add(5, &passed);
        assert!(totals.objects());
        let expected = "blocks pass through one another: up to 2 pairs overlap where no contact sees it, after 2 of 6 steps \
                        (worst 4–5, 2.000e-5 m, step 4); 1 passage within a step (worst 6–7, 0.2500 m, step 5); 3 passages \
                        undecided; deepest overlap of all (worst 0–1, 0.5000 m, step 1)";
        assert_eq!(totals.sentence(), expected);
        assert_eq!(passed.cells(), ["0", "0.5", "1", "3"]);
    }

    #[test]
    fn a_pair_that_is_worst_while_blocks_settle_is_said_to_be() {
        let mut totals = AuditTotals::default();
        totals.add(-19, &StepAudit { deepest: pair(0, 1, 0.5), ..StepAudit::default() });
        let sentence = totals.sentence();
        assert!(sentence.ends_with("all (worst 0–1, 0.5000 m, settling step -19 (the last is 0))"), "{sentence}");
    }
}
