//! Contacts that push where nothing met, or through a face that another block covers (docs/step.md, "False entrances"), as a run records them.

use crate::exact_float::ExactFloat;
use rockproof_model::simulation::step_in_words;
use rockproof_model::text::noun;
use serde::{Deserialize, Serialize};

/// A contact that pushes where nothing met, or through a face that another block covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseEntrance {
    /// The blocks of the contact, the lower number first.
    pub blocks: [usize; 2],
    /// The block behind the face; none where the two never met within the step.
    pub into: Option<usize>,
    /// What all such contacts press one of its blocks with, those of other pairs too, as a share of what all contacts press it with.
    pub share: f64,
}

/// A larger share than this decides how a block moves: two of the four corners that bear a block bear half of it, and as much again through a seam that holds them, a third of
/// all.
const DECISIVE: f64 = 1.0 / 3.0;

/// The false entrances of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FalseEntranceTotals {
    /// The steps looked at; those of settling, after which blocks are at rest whatever pushed them, are not.
    pub steps: u64,
    /// Where the blocks never met within the step.
    #[serde(default)]
    pub unmet: FalseEntranceSteps,
    /// Where another block covers the face through which a contact pushes.
    #[serde(default)]
    pub covered: FalseEntranceSteps,
}

/// The steps with false entrances of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FalseEntranceSteps {
    /// How many steps.
    pub steps: u64,
    /// The first of them, of several pairs the one that is pressed with the largest share.
    pub first: Option<FirstFalseEntrance>,
    /// The largest share in any of them.
    pub most: ExactFloat,
}

/// The first false entrance of a run and the step it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FirstFalseEntrance {
    /// The blocks of the contact, the lower number first.
    pub blocks: [usize; 2],
    /// The block behind the face, where one covers it.
    pub into: Option<usize>,
    /// As of [`FalseEntrance`].
    pub share: ExactFloat,
    /// The step.
    pub step: i64,
}

impl FalseEntranceTotals {
    /// Whether there are none: every contact pushes where blocks met, and through a face that is free.
    pub fn is_none(&self) -> bool {
        self.unmet.steps == 0 && self.covered.steps == 0
    }

    /// Whether no step was looked at.
    pub(crate) fn has_no_steps(&self) -> bool {
        *self == FalseEntranceTotals::default()
    }

    /// Whether in some step more than a third of what contacts press a block with goes through false entrances of one kind: what becomes of it is then not what would
    /// become of rock. Where blocks of cut rock lie at rest, corners at seams bear less in most steps.
    pub fn are_decisive(&self) -> bool {
        [&self.unmet, &self.covered].into_iter().any(|kind| kind.most.0 > DECISIVE)
    }

    /// Adds those of a step; of settling nothing.
    pub(crate) fn add(&mut self, found: &[FalseEntrance], step: i64) {
        if step <= 0 {
            return;
        }
        self.steps += 1;
        for (is_covered, kind) in [(false, &mut self.unmet), (true, &mut self.covered)] {
            let such = found.iter().rev().filter(|entrance| entrance.into.is_some() == is_covered);
            let worst = such.copied().max_by(|one, two| one.share.total_cmp(&two.share));
            let Some(FalseEntrance { blocks, into, share }) = worst else { continue };
            kind.steps += 1;
            kind.most = ExactFloat(kind.most.0.max(share));
            kind.first.get_or_insert(FirstFalseEntrance { blocks, into, share: ExactFloat(share), step });
        }
    }

    /// The false entrances, each kind with its first and what helps; `None` where there are none.
    pub fn sentence(&self) -> Option<String> {
        let all = self.steps;
        let among = |kind: &FalseEntranceSteps| {
            let FirstFalseEntrance { blocks: [a, b], into, share, step } = kind.first?;
            let into = into.map_or(String::new(), |block| format!(" into {block}"));
            Some(format!(
                "in {} of {all} {} (first {a}–{b}{into}, {}, with {:.1} % of what contacts press a block with, at most {:.1} %)",
                kind.steps,
                noun(all, "step", "steps"),
                step_in_words(step),
                100.0 * share.0,
                100.0 * kind.most.0
            ))
        };
        let covered = among(&self.covered).map(|among| {
            format!(
                "contacts pushed a block out through a face that another block covers {among}, as at a seam between flush blocks: what slides over it is held or thrown; model as one block what stays together"
            )
        });
        let unmet = among(&self.unmet).map(|among| {
            format!("contacts pushed blocks apart that never met {among}: take a smaller max_displacement or time_step")
        });
        let parts: Vec<String> = covered.into_iter().chain(unmet).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_told_by_its_first_step_and_its_largest_share() {
        let of = |blocks, into, share| FalseEntrance { blocks, into, share };
        let mut totals = FalseEntranceTotals::default();
        totals.add(&[], 1);
        assert_eq!((totals.is_none(), totals.sentence()), (true, None));
        totals.add(&[of([0, 1], None, 1.0)], 0);
        assert!(totals.is_none(), "settling");
        totals.add(&[of([0, 1], None, 0.25), of([2, 3], None, 0.5), of([4, 5], None, 0.5)], 2);
        totals.add(&[of([0, 1], Some(7), 0.25), of([0, 1], None, 1.0)], 3);
        let sentence = totals.sentence().expect("a sentence");
        let [covered, unmet] = [
            "in 1 of 3 steps (first 0–1 into 7, step 3, with 25.0 % of what contacts press a block with, at most 25.0 %)",
            "in 2 of 3 steps (first 2–3, step 2, with 50.0 % of what contacts press a block with, at most 100.0 %)",
        ];
        assert!(sentence.contains(covered) && sentence.contains(unmet), "{sentence}");
        assert!(totals.are_decisive());
        let third = FalseEntranceSteps { most: ExactFloat(1.0 / 3.0), ..totals.unmet.clone() };
        assert!(!FalseEntranceTotals { unmet: third, ..totals.clone() }.are_decisive(), "a third is not more");
        let text = serde_json::to_string(&totals).expect("JSON");
        assert_eq!(serde_json::from_str::<FalseEntranceTotals>(&text).ok(), Some(totals));
    }
}
