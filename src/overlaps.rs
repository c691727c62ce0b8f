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
    pub(crate) audit: Audit,
    /// 2⁸·eps·M of f64 in m, M the largest coordinate: below that rounding decides (SPEC section 3, the rule for `territory`).
    rounding: f64,
}

impl Overlaps {
    /// The overlaps that make a run untrustworthy: deeper than contacts are followed, or seen by no contact though more than what
    /// rounded coordinates and uneven faces make of blocks that touch.
    pub(crate) fn dangerous(&self) -> usize {
        self.audit.overlaps.iter().filter(|overlap| self.is_dangerous(overlap)).count()
    }

    fn is_dangerous(&self, overlap: &Overlap) -> bool {
        let is_rounding =
            overlap.is_within_unevenness || overlap.penetration.depth_m().is_some_and(|depth| depth <= self.rounding);
        overlap.is_deeper_than_g || (overlap.sight == Sight::Unseen && !is_rounding)
    }
}

/// What the audit found, in one sentence; `None` where nothing overlaps.
pub(crate) fn sentence(overlaps: &Overlaps) -> Option<String> {
    let audit = &overlaps.audit;
    let worst = audit.deepest()?;
    let all = audit.overlaps.len();
    let deep = audit.overlaps.iter().filter(|overlap| overlap.is_deeper_than_g).count();
    let (unseen, shallow) = (audit.count(Sight::Unseen), audit.count(Sight::Shallow));
    let [a, b] = worst.blocks;
    let mut text = format!("{all} pairs overlap, {deep} deeper than penetration (worst {a}–{b}, {} m)", depth(worst));
    // Writing to a String cannot fail.
    let _ = match (unseen, shallow) {
        (0, 0) => write!(text, "; contacts see all of them"),
        _ => write!(text, "; contacts do not see {unseen} of them, and {shallow} at less than half their depth"),
    };
    Some(text)
}

/// What `check` says: the sentence, the deepest pairs, and what follows.
pub(crate) fn report(overlaps: &Overlaps) -> String {
    let audit = &overlaps.audit;
    let neighbours = audit.counts.neighbours();
    let Some(sentence) = sentence(overlaps) else {
        return format!("\noverlaps: none in {neighbours} neighbouring pairs\n");
    };
    let mut out = format!("\noverlaps: {sentence}\n");
    let mut worst: Vec<&Overlap> = audit.overlaps.iter().collect();
    // A stable sort: of equally deep ones the first pair first.
    worst.sort_by_key(|overlap| std::cmp::Reverse(overlap.depth_squared()));
    for overlap in worst.iter().take(MOST_NAMED) {
        let [a, b] = overlap.blocks;
        let deep = if overlap.is_deeper_than_g { ", deeper than penetration" } else { "" };
        let uneven = if overlap.is_within_unevenness { ", within the unevenness of their faces" } else { "" };
        let _ = writeln!(
            out,
            "  {:<11} {:>12} m  {}{deep}{uneven}",
            format!("{a}–{b}"),
            depth(overlap),
            overlap.sight.name()
        );
    }
    if let Some(more) = worst.len().checked_sub(MOST_NAMED).filter(|more| *more > 0) {
        let _ = writeln!(out, "  and {more} more");
    }
    let dangerous = overlaps.dangerous();
    let _ = match dangerous {
        0 => writeln!(
            out,
            "  contacts hold them, or they are no more than rounded coordinates make of blocks that touch"
        ),
        _ => writeln!(
            out,
            "  in {dangerous} of them the overlap is deeper than contacts are followed, or no contact sees it: the blocks will pass through one another"
        ),
    };
    out
}

/// The penetration in metres, in four digits.
fn depth(overlap: &Overlap) -> String {
    match overlap.penetration.depth_m() {
        Some(depth) if depth == 0.0 || (1e-3..1e4).contains(&depth) => format!("{depth:.4}"),
        Some(depth) => format!("{depth:.3e}"),
        None => "beyond f64".to_owned(),
    }
}
