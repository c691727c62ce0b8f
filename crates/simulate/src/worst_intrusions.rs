//! Passages and unseen overlaps of a run that get a case: the worst few, each with the state before its step. What their causes are is
//! found outside: this crate knows no oracle.

use crate::audit::PairDepth;
use crate::checkpoint::SavedState;
use crate::exact_float::ExactFloat;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// The table of those that have a case.
pub const INTRUSIONS: &str = "intrusions.csv";

/// So many of each sort are kept at most.
const MAX_OF_A_KIND: usize = 3;

/// A passage or an unseen overlap of a run, and where its step began.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorstIntrusion {
    /// `passage` or `unseen`.
    pub change: String,
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// How deep they were (m): of a passage the depth that was shown, of an overlap that after the step.
    pub depth_m: ExactFloat,
    /// The step; of settling 0 or below.
    pub step: i64,
    /// The state before it.
    pub state: SavedState,
}

impl WorstIntrusion {
    /// The deeper first; of equal ones the earlier.
    fn cmp(&self, other: &WorstIntrusion) -> Ordering {
        let deeper = other.depth_m.0.total_cmp(&self.depth_m.0);
        deeper.then(self.step.cmp(&other.step)).then(self.blocks.cmp(&other.blocks))
    }
}

/// The worst of a run so far, one for each sort and pair of blocks, by sort and then by depth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorstIntrusions(Vec<WorstIntrusion>);

impl WorstIntrusions {
    /// Those of the run that is gone on with.
    pub fn new(kept: Vec<WorstIntrusion>) -> WorstIntrusions {
        WorstIntrusions(kept)
    }

    /// All of them.
    pub fn all(&self) -> &[WorstIntrusion] {
        &self.0
    }

    /// Whether one of a sort would be kept.
    pub fn wants(&self, change: &str, pair: PairDepth) -> bool {
        let mut of_sort = self.0.iter().filter(|one| one.change == change);
        let is_deeper = |one: &WorstIntrusion| pair.depth_m > one.depth_m.0;
        match of_sort.clone().find(|one| one.blocks == pair.blocks) {
            Some(known) => is_deeper(known),
            None => of_sort.clone().count() < MAX_OF_A_KIND || of_sort.any(is_deeper),
        }
    }

    /// Keeps one that is wanted ([`WorstIntrusions::wants`]), in place of another of its pair or of the least deep of its sort.
    pub fn keep(&mut self, intrusion: WorstIntrusion) {
        let is_other = |one: &WorstIntrusion| one.change != intrusion.change;
        self.0.retain(|one| is_other(one) || one.blocks != intrusion.blocks);
        self.0.push(intrusion);
        self.0.sort_by(|one, other| one.change.cmp(&other.change).then_with(|| one.cmp(other)));
        for change in ["passage", "unseen"] {
            let mut left = MAX_OF_A_KIND;
            self.0.retain(|one| one.change != change || left.checked_sub(1).map(|fewer| left = fewer).is_some());
        }
    }
}

/// A row of `intrusions.csv`: one cause of one that was kept. The fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct IntrusionRow {
    /// The step; of settling 0 or below.
    pub step: i64,
    /// `passage` or `unseen`.
    pub change: String,
    /// The block with the lower number.
    pub block_a: usize,
    /// The other block.
    pub block_b: usize,
    /// How deep (m), as [`WorstIntrusion`] has it.
    pub depth_m: f64,
    /// Why; empty where that could not be found.
    pub cause: String,
    /// What the link before has: `none`, or the change.
    pub before: String,
    /// What the link behind has.
    pub after: String,
    /// Blocks in the case: those without which the stepper's step does the same are left out. Where there is no case, the number of blocks
    /// that show it, if it is too large for one.
    pub case_blocks: Option<usize>,
    /// The case, by its place in the directory; empty where there is none.
    pub case: String,
}

impl IntrusionRow {
    /// The columns.
    pub const COLUMNS: [&'static str; 10] =
        ["step", "change", "block_a", "block_b", "depth_m", "cause", "before", "after", "case_blocks", "case"];

    /// Its cells.
    pub fn cells(&self) -> [String; 10] {
        let IntrusionRow { step, change, block_a, block_b, depth_m, cause, before, after, case_blocks, case } = self;
        let texts = [change, cause, before, after, case].map(String::clone);
        let [change, cause, before, after, case] = texts;
        let blocks = case_blocks.map_or(String::new(), |blocks| blocks.to_string());
        let numbers = [step.to_string(), block_a.to_string(), block_b.to_string(), format!("{depth_m:?}")];
        let [step, a, b, depth] = numbers;
        [step, change, a, b, depth, cause, before, after, blocks, case]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intrusion(change: &str, blocks: [usize; 2], depth_m: f64, step: i64) -> Option<WorstIntrusion> {
        let state = r#"{"step":0,"time":"0","settling":0,"last_time_step":"1","blocks":[],"load_points":[],"fixed_points":[],"measured_points":[],"contacts":[]}"#;
        let state = serde_json::from_str(&state.replace("\"0\"", "0.0").replace("\"1\"", "1.0")).ok()?;
        Some(WorstIntrusion { change: change.to_owned(), blocks, depth_m: ExactFloat(depth_m), step, state })
    }

    #[test]
    fn the_deepest_of_each_pair_and_three_of_each_sort_are_kept() {
        let mut kept = WorstIntrusions::default();
        let found = [
            ("unseen", [0, 1], 0.5, 1),
            ("passage", [0, 1], 0.1, 1),
            ("passage", [0, 1], 0.3, 2),
            ("passage", [0, 1], 0.3, 3),
            ("passage", [0, 1], 0.2, 4),
            ("passage", [0, 2], 0.2, 4),
            ("passage", [1, 2], 0.2, 4),
            ("passage", [3, 4], 0.2, 5),
            ("passage", [3, 4], 0.25, 6),
        ];
        for (change, blocks, depth_m, step) in found {
            if kept.wants(change, PairDepth { blocks, depth_m }) {
                kept.keep(intrusion(change, blocks, depth_m, step).expect("a state"));
            }
        }
        let all: Vec<_> = kept.all().iter().map(|one| (one.change.as_str(), one.blocks, one.step)).collect();
        let passages = [("passage", [0, 1], 2), ("passage", [3, 4], 6), ("passage", [0, 2], 4)];
        assert_eq!(all, [&passages[..], &[("unseen", [0, 1], 1)]].concat());
    }
}
