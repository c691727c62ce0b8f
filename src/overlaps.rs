//! Overlaps of a model, for every command that begins with one: the exact audit (SPEC section 7), in words.

use rayon::prelude::*;
use rockproof_model::{Block, ToleranceSet};
use rockproof_oracle::Solid;
use rockproof_oracle::audit::{Audit, Auditor, Overlap, Sight};
use std::fmt::Write;

/// Overlaps named one by one.
const MOST_NAMED: usize = 5;

/// The overlaps of all neighbouring pairs, or of some.
pub(crate) fn overlaps(blocks: &[&Block], tolerances: &ToleranceSet, only: Option<&[(usize, usize)]>) -> Overlaps {
    let solids: Vec<Solid> = blocks.par_iter().map(|block| Solid::new(block)).collect();
    let auditor = Auditor::new(&solids, tolerances);
    let pairs = match only {
        None => auditor.neighbours(),
        Some(pairs) => pairs.iter().map(|&(i, j)| [i.min(j), i.max(j)]).collect(),
    };
    let audited: Vec<_> = pairs.par_iter().map(|&pair| auditor.pair(pair)).collect();
    let coordinates = blocks.iter().flat_map(|block| block.coordinates());
    let largest = coordinates.fold(0.0f64, |largest, c| largest.max(c.approximate().abs()));
    Overlaps { audit: Audit::of(audited), rounding: 256.0 * f64::EPSILON * largest }
}

/// The overlaps of a model, and what rounded coordinates alone make blocks overlap by.
pub(crate) struct Overlaps {
    /// The audit.
    audit: Audit,
    /// 2⁸·eps·M of f64 in m, M the largest coordinate: below that rounding decides (SPEC section 3, the rule for `territory`).
    rounding: f64,
}

/// What an overlap means for a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meaning {
    /// Deeper than `penetration`, or seen by no contact: the blocks will pass through one another.
    Lost,
    /// Seen by a contact that can push the blocks apart.
    Held,
    /// No more than rounded coordinates and uneven faces make of blocks that touch.
    Rounding,
}

impl Overlaps {
    /// How many overlaps make a run untrustworthy: deeper than `penetration`, or seen by no contact though more than rounding.
    pub(crate) fn lost(&self) -> usize {
        self.count(Meaning::Lost)
    }

    fn count(&self, meaning: Meaning) -> usize {
        self.audit.overlaps.iter().filter(|overlap| self.meaning(overlap) == meaning).count()
    }

    fn meaning(&self, overlap: &Overlap) -> Meaning {
        let is_tiny = || overlap.penetration.depth_m().is_some_and(|depth| depth <= self.rounding);
        if overlap.is_deeper_than_g {
            Meaning::Lost
        } else if overlap.is_within_unevenness || is_tiny() {
            Meaning::Rounding
        } else if overlap.sight == Sight::Unseen {
            Meaning::Lost
        } else {
            Meaning::Held
        }
    }

    /// What the audit found, in one sentence; `None` where nothing overlaps.
    pub(crate) fn sentence(&self) -> Option<String> {
        let worst = self.audit.deepest()?;
        let [a, b] = worst.blocks;
        let worst = format!("worst {a}–{b}, {} m", depth(worst));
        let counts = [Meaning::Lost, Meaning::Held, Meaning::Rounding].map(|meaning| self.count(meaning));
        let said = [
            "overlap deeper than penetration or where no contact sees it, and will pass through one another",
            "overlap and are held by contacts",
            "overlap by no more than rounding",
        ];
        let mut parts: Vec<String> = Vec::new();
        for (count, said) in counts.into_iter().zip(said).filter(|(count, _)| *count > 0) {
            let pairs = if count == 1 { "pair" } else { "pairs" };
            let worst = if parts.is_empty() { format!(" ({worst})") } else { String::new() };
            parts.push(format!("{count} {pairs}{worst} {said}"));
        }
        Some(parts.join("; "))
    }

    /// What `check` says: the sentence and the deepest pairs.
    pub(crate) fn report(&self) -> String {
        let Some(sentence) = self.sentence() else {
            return format!("\noverlaps: none in {} neighbouring pairs\n", self.audit.counts.neighbours());
        };
        let mut out = format!("\noverlaps: {sentence}\n");
        let told = |overlap: &&Overlap| self.meaning(overlap) != Meaning::Rounding;
        let mut worst: Vec<&Overlap> = self.audit.overlaps.iter().filter(told).collect();
        // A stable sort: of equally deep ones the first pair first.
        worst.sort_by_cached_key(|overlap| std::cmp::Reverse(overlap.depth_squared()));
        for overlap in worst.iter().take(MOST_NAMED) {
            let [a, b] = overlap.blocks;
            let deep = if overlap.is_deeper_than_g { ", deeper than penetration" } else { "" };
            let blocks = format!("{a}–{b}");
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {blocks:<11} {:>12} m  {}{deep}", depth(overlap), overlap.sight.name());
        }
        if let Some(more) = worst.len().checked_sub(MOST_NAMED).filter(|more| *more > 0) {
            let _ = writeln!(out, "  and {more} more");
        }
        out
    }
}

/// The penetration in metres, in four digits.
fn depth(overlap: &Overlap) -> String {
    match overlap.penetration.depth_m() {
        Some(depth) if depth == 0.0 || (1e-3..1e4).contains(&depth) => format!("{depth:.4}"),
        Some(depth) => format!("{depth:.3e}"),
        None => "beyond f64".to_owned(),
    }
}
