//! Overlaps of a model, for every command that begins with one: the exact audit (SPEC section 7), in words.

// Longer than 400 lines: what overlaps mean and the sentences that say so, with the tests of both.

use crate::deepest::deepest;
use crate::near_others::near_others;
use crate::progress::{Stage, WorkProgress};
use rayon::prelude::*;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt, noun};
use rockproof_model::{Block, Number, Precision, Scene, ToleranceSet};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Audit, Auditor, Overlap, OverlapSeverity, OverlapVisibility, rounding_depth};
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// Overlaps named one by one.
const MAX_NAMED: usize = 5;

/// Which overlaps are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredOverlaps {
    /// All, however little they mean: an exact depth and the contacts of each.
    All,
    /// Those that may be more than rounding, and where there are none the deepest. Of a mass of blocks that touch this takes a
    /// fraction of the time.
    BeyondRounding,
}

/// Whose overlaps are looked for, and which are measured.
#[derive(Clone, Copy, Debug)]
pub struct OverlapScope<'s> {
    /// Pairs of blocks; all neighbouring ones where none are given.
    pub only: Option<&'s [(usize, usize)]>,
    /// Which are measured.
    pub measured: MeasuredOverlaps,
    /// Whether each block is fixed; blocks beyond the end are not. Two fixed blocks never move, so among all pairs theirs are left out.
    pub fixed: &'s [bool],
}

/// The overlaps of all neighbouring pairs, or of some. Where `stop` is set meanwhile, those of the pairs looked at until then.
pub fn overlaps(
    blocks: &[&Block],
    tolerances: &ToleranceSet,
    OverlapScope { only, measured, fixed }: OverlapScope<'_>,
    seen: &WorkProgress,
    stop: &AtomicBool,
) -> Overlaps {
    let prepared: Vec<PreparedBlock> = blocks.par_iter().map(|block| PreparedBlock::new(block)).collect();
    let auditor = Auditor::new(&prepared, tolerances);
    let pairs = match only {
        None => auditor.neighbours(),
        Some(pairs) => pairs.iter().map(|&(i, j)| [i.min(j), i.max(j)]).collect(),
    };
    let rounding = rounding_depth(blocks, Precision::F64);
    // Of pairs that were asked for all is said.
    let may_move = |pair: &&[usize; 2]| only.is_some() || !pair.iter().all(|&block| fixed.get(block) == Some(&true));
    let asked: Vec<&[usize; 2]> = pairs.iter().filter(may_move).collect();
    seen.begin(Stage::Overlaps, asked.len());
    let audited = asked.into_par_iter().filter(|_| !stop.load(Ordering::Relaxed)).map(|&pair| {
        let audited = match measured {
            MeasuredOverlaps::All => auditor.pair(pair),
            MeasuredOverlaps::BeyondRounding => auditor.pair_beyond_rounding(pair, &rounding),
        };
        seen.advance();
        audited
    });
    // Most pairs of a mass are apart, so nothing is kept of them.
    let audit = audited.fold(Audit::default, Audit::with).reduce(Audit::default, Audit::and);
    let is_near = near_others(blocks.len(), &audit, (&auditor, &tolerances.search), &pairs);
    let found = Overlaps::of(audit, &rounding, pairs, is_near);
    if found.severities.iter().any(|&severity| severity != OverlapSeverity::Rounding) {
        return found;
    }
    Overlaps::of(with_deepest_measured(found.audit, &auditor), &rounding, found.neighbours, found.is_near)
}

/// The same with the deepest of the overlaps that were bounded measured: the only one of rounding whose depth anyone is told.
fn with_deepest_measured(mut audit: Audit, auditor: &Auditor<'_>) -> Audit {
    let Some((blocks, _)) = deepest(audit.bounded.clone(), |blocks| auditor.depth(blocks)) else { return audit };
    audit.bounded.retain(|overlap| overlap.blocks != blocks);
    let measured = Audit { overlaps: auditor.pair(blocks).overlap.into_iter().collect(), ..Audit::default() };
    audit.and(measured)
}

/// The overlaps of a model, and what they mean.
#[derive(Clone, Debug)]
pub struct Overlaps {
    /// The audit.
    audit: Audit,
    /// What each overlap means.
    severities: Vec<OverlapSeverity>,
    /// The neighbouring pairs, or those asked for.
    neighbours: Vec<[usize; 2]>,
    /// Of each block whether it may be near another one of these pairs.
    is_near: Vec<bool>,
    /// The depth that rounded coordinates alone can make (m).
    rounding: Number,
}

impl Overlaps {
    /// Those of an audit of these pairs; within `rounding` m rounding decides.
    fn of(audit: Audit, rounding: &Number, neighbours: Vec<[usize; 2]>, is_near: Vec<bool>) -> Overlaps {
        let severities = audit.overlaps.par_iter().map(|overlap| overlap.severity(rounding)).collect();
        Overlaps { audit, severities, neighbours, is_near, rounding: rounding.clone() }
    }

    /// How many overlaps make a run untrustworthy: deeper than `penetration`, or seen by no contact though more than rounding.
    pub fn lost(&self) -> usize {
        self.count(OverlapSeverity::Lost)
    }

    /// The neighbouring pairs, whether they overlap or not, in ascending order; those of two fixed blocks too, whose overlaps are not looked for.
    pub fn neighbours(&self) -> &[[usize; 2]] {
        &self.neighbours
    }

    /// The blocks that are further than `search` from all others, as far as boxes and the normals of faces show it, in ascending order; none where there is only one block.
    pub fn lonely(&self) -> Vec<usize> {
        let all = if self.is_near.len() == 1 { &[] } else { self.is_near.as_slice() };
        all.iter().enumerate().filter(|(_, is_near)| !**is_near).map(|(block, _)| block).collect()
    }

    /// The blocks that touch nothing, the first of them with their names; `None` where every block is near another.
    pub fn lonely_sentence(&self, scene: &Scene) -> Option<String> {
        let lonely = self.lonely();
        let named = lonely.iter().take(MAX_NAMED).map(|&block| match scene.own_name(block) {
            Some(name) => format!("{block} ({})", excerpt(name, EXCERPT_LENGTH)),
            None => block.to_string(),
        });
        let named = named.collect::<Vec<_>>().join(", ");
        let (count, more) = (lonely.len(), if lonely.len() > MAX_NAMED { ", …" } else { "" });
        (count > 0).then(|| {
            let (blocks, touch) = (noun(count, "block", "blocks"), noun(count, "touches", "touch"));
            format!("{count} {blocks} {touch} nothing, being apart from all others by more than search: {named}{more}")
        })
    }

    /// The pairs that overlap and were measured, in ascending order, each with what that means.
    pub fn all(&self) -> impl Iterator<Item = (&Overlap, OverlapSeverity)> {
        self.audit.overlaps.iter().zip(self.severities.iter().copied())
    }

    /// Whether only the unevenness of faces excuses an overlap: it is deeper than rounded coordinates make it.
    pub(crate) fn is_excused_as_uneven(&self, overlap: &Overlap) -> bool {
        overlap.is_within_unevenness && overlap.depth_squared() > self.rounding.times(&self.rounding).to_rational()
    }

    /// The deepest pair that makes a run untrustworthy, of equal ones the first.
    pub fn worst_lost(&self) -> Option<&Overlap> {
        self.worst(OverlapSeverity::Lost)
    }

    /// How many overlaps mean this.
    pub fn count(&self, severity: OverlapSeverity) -> usize {
        let bounded = if severity == OverlapSeverity::Rounding { self.audit.bounded.len() } else { 0 };
        self.severities.iter().filter(|&&found| found == severity).count() + bounded
    }

    /// How many overlaps of one severity that were measured contacts see so well: of all that are more than rounding.
    pub fn count_seen(&self, severity: OverlapSeverity, sight: OverlapVisibility) -> usize {
        self.that(|found| found == severity).filter(|overlap| overlap.sight == sight).count()
    }

    /// How many overlaps of one severity contacts see, in brackets. None that contacts hold is unseen.
    fn sights_in_words(&self, severity: OverlapSeverity) -> String {
        let told = OverlapVisibility::ALL.into_iter();
        let told = told.filter(|&sight| severity == OverlapSeverity::Lost || sight != OverlapVisibility::Unseen);
        let counts = told.map(|sight| format!("{} {}", self.count_seen(severity, sight), sight.name()));
        format!(" ({})", counts.collect::<Vec<_>>().join(", "))
    }

    /// The overlaps that are meant, in the order of their pairs.
    fn that(&self, is_meant: impl Fn(OverlapSeverity) -> bool) -> impl DoubleEndedIterator<Item = &Overlap> {
        let all = self.audit.overlaps.iter().zip(&self.severities);
        all.filter(move |(_, severity)| is_meant(**severity)).map(|(overlap, _)| overlap)
    }

    /// The deepest of one severity, of several equally deep the first.
    fn worst(&self, severity: OverlapSeverity) -> Option<&Overlap> {
        // `max_by` keeps the last of several.
        self.that(|found| found == severity).rev().max_by(|one, two| one.depth_squared().cmp(&two.depth_squared()))
    }

    /// What the audit found, in one sentence, with the deepest pair of the first count; `None` where nothing overlaps.
    pub fn sentence(&self) -> Option<String> {
        let mut parts: Vec<String> = Vec::new();
        for severity in OverlapSeverity::ALL {
            let count = self.count(severity);
            if count == 0 {
                continue;
            }
            let (pairs, overlap) = (noun(count, "pair", "pairs"), noun(count, "overlaps", "overlap"));
            let said = match severity {
                OverlapSeverity::Lost => format!("{overlap} {}, and will pass through one another", self.why_lost()),
                OverlapSeverity::Held => format!("{overlap} and {} held by contacts", noun(count, "is", "are")),
                OverlapSeverity::Rounding => {
                    let is_uneven =
                        self.that(|found| found == severity).any(|overlap| self.is_excused_as_uneven(overlap));
                    let uneven = if is_uneven { " or the unevenness of faces" } else { "" };
                    format!("{overlap} by no more than rounding{uneven}")
                }
            };
            let in_brackets = |worst: &Overlap| {
                let [a, b] = worst.blocks;
                format!(" (worst {a}–{b}, {} m)", depth(worst))
            };
            // Of rounding the deepest is measured only where it is told.
            let worst = if parts.is_empty() { self.worst(severity) } else { None };
            let worst = worst.map_or_else(String::new, in_brackets);
            let sights =
                if severity == OverlapSeverity::Rounding { String::new() } else { self.sights_in_words(severity) };
            parts.push(format!("{count} {pairs}{worst} {said}{sights}"));
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    /// Which of both it is that makes overlaps lost, with their numbers where it is both. A deep one may be unseen as well.
    fn why_lost(&self) -> String {
        let deep =
            self.that(|severity| severity == OverlapSeverity::Lost).filter(|overlap| overlap.is_deeper_than_g).count();
        match (deep, self.count(OverlapSeverity::Lost) - deep) {
            (_, 0) => "deeper than penetration".to_owned(),
            (0, _) => "where no contact sees it".to_owned(),
            (deep, unseen) => format!("deeper than penetration ({deep}) or where no contact sees it ({unseen})"),
        }
    }

    /// The sentence after its name, also where nothing overlaps.
    pub fn line(&self) -> String {
        match self.sentence() {
            None => {
                let neighbours = self.audit.counts.neighbours();
                format!("overlaps: none in {neighbours} neighbouring {}", noun(neighbours, "pair", "pairs"))
            }
            Some(sentence) => format!("overlaps: {sentence}"),
        }
    }

    /// The overlaps for programs: how many of each severity; of those deeper than rounding how many contacts see, and every pair.
    pub fn json(&self) -> Value {
        let told = |(_, severity): &(&Overlap, OverlapSeverity)| *severity != OverlapSeverity::Rounding;
        let pair = |(overlap, severity): (&Overlap, OverlapSeverity)| {
            json!({
                "blocks": overlap.blocks,
                "depth_m": overlap.penetration.depth_m(),
                "lost": severity == OverlapSeverity::Lost,
                "contacts_see_it": overlap.sight.name(),
                "deeper_than_penetration": overlap.is_deeper_than_g,
            })
        };
        let [lost, held, rounding] = OverlapSeverity::ALL.map(|severity| self.count(severity));
        let more_than_rounding = |sight: OverlapVisibility| {
            [OverlapSeverity::Lost, OverlapSeverity::Held]
                .into_iter()
                .map(|severity| self.count_seen(severity, sight))
                .sum::<usize>()
        };
        json!({
            "neighbours": self.audit.counts.neighbours(),
            "lost": lost,
            "held": held,
            "rounding": rounding,
            "seen": more_than_rounding(OverlapVisibility::Seen),
            "shallow": more_than_rounding(OverlapVisibility::Shallow),
            "unseen": more_than_rounding(OverlapVisibility::Unseen),
            "pairs": self.all().filter(told).map(pair).collect::<Vec<_>>(),
        })
    }

    /// What `check` says: the line and the deepest pairs, with the names that blocks of the scene have.
    pub fn report(&self, scene: &Scene) -> String {
        let mut out = format!("\n{}\n", self.line());
        let mut worst: Vec<&Overlap> = self.that(|severity| severity != OverlapSeverity::Rounding).collect();
        // A stable sort: of equally deep ones the first pair first.
        worst.sort_by_cached_key(|overlap| std::cmp::Reverse(overlap.depth_squared()));
        let more = worst.len().saturating_sub(MAX_NAMED);
        worst.truncate(MAX_NAMED);
        let blocks: Vec<String> = worst.iter().map(|overlap| pair_in_words(overlap.blocks, scene)).collect();
        let width = blocks.iter().map(|blocks| blocks.chars().count()).max().unwrap_or(0).max(11);
        for (overlap, blocks) in worst.iter().zip(blocks) {
            let deep = if overlap.is_deeper_than_g { ", deeper than penetration" } else { "" };
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {blocks:<width$} {:>12} m  {}{deep}", depth(overlap), overlap.sight.name());
        }
        if more > 0 {
            let _ = writeln!(out, "  and {more} more");
        }
        out
    }
}

/// Two blocks by number, and by name where one has a name of its own.
pub(crate) fn pair_in_words(pair: [usize; 2], scene: &Scene) -> String {
    let [a, b] = pair;
    if pair.iter().all(|&number| scene.own_name(number).is_none()) {
        return format!("{a}–{b}");
    }
    let [one, other] = pair.map(|number| excerpt(&scene.blocks[number].name, EXCERPT_LENGTH));
    format!("{a}–{b} ({one}, {other})")
}

/// The penetration in metres, in four digits.
fn depth(overlap: &Overlap) -> String {
    match overlap.penetration.depth_m() {
        Some(depth) if depth == 0.0 || (1e-3..1e4).contains(&depth) => format!("{depth:.4}"),
        Some(depth) => format!("{depth:.3e}"),
        None => "beyond f64".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;
    use rockproof_model::preset::{Preset, derive};

    fn all_pairs(measured: MeasuredOverlaps) -> OverlapScope<'static> {
        OverlapScope { only: None, measured, fixed: &[] }
    }

    /// A cube of 1 m on a fixed slab, sunk by so many thousandths.
    fn sunk(x: i32, thousandths: i32) -> Block {
        let at = |z: i32| Number::from_rational(num_rational::BigRational::new(z.into(), 1000.into()));
        let [low, high] = [(x, -thousandths), (x + 1, 1000 - thousandths)];
        let corner = |(x, z): (i32, i32), y: i32| Vec3::new(Number::from_integer(x), Number::from_integer(y), at(z));
        Block::cuboid(&corner(low, 0), &corner(high, 1)).expect("a cube")
    }

    #[test]
    fn what_is_told_is_the_same_whether_rounding_is_measured_or_bounded() {
        let whole = Number::from_integer;
        let corner = |x, y, z| Vec3::new(whole(x), whole(y), whole(z));
        let slab = Block::cuboid(&corner(-9, -9, -4), &corner(9, 9, 0)).expect("a slab");
        // Less deep than rounding makes, the second deepest; and one that is more.
        let little = |parts: i32| Number::from_f64(-f64::from(parts) * 2f64.powi(-50)).expect("a number");
        let touching = |x: i32, parts: i32| sunk(x, 0).translated(&Vec3::new(whole(0), whole(0), little(parts)));
        let set = |blocks: &[&Block]| derive(Preset::Auto, blocks, Precision::F64).expect("a set");
        let rounded = [slab, touching(0, 1), touching(2, 7), touching(4, 7), touching(6, 3)];
        for blocks in [rounded.to_vec(), [rounded.to_vec(), vec![sunk(-3, 3)]].concat()] {
            let blocks: Vec<&Block> = blocks.iter().collect();
            let found = |measured| {
                overlaps(&blocks, &set(&blocks), all_pairs(measured), &WorkProgress::default(), &AtomicBool::new(false))
            };
            let [all, few] = [MeasuredOverlaps::All, MeasuredOverlaps::BeyondRounding].map(found);
            let scene = Scene::default();
            assert_eq!((few.line(), few.report(&scene), few.json()), (all.line(), all.report(&scene), all.json()));
            assert_eq!((few.all().count(), all.all().count()), (1, blocks.len() - 1));
            let is_told = all.line().contains("4 pairs overlap by no more than rounding");
            assert!(is_told || all.line().contains("4 pairs (worst 0–2, 6.217e-15 m)"), "{}", all.line());
        }
    }

    #[test]
    fn two_fixed_blocks_overlap_as_they_are_meant_to() {
        let blocks = [sunk(0, 0), sunk(0, 500), sunk(0, 900)];
        let blocks: Vec<&Block> = blocks.iter().collect();
        let set = derive(Preset::Auto, &blocks, Precision::F64).expect("a set");
        let found = |only: Option<&[(usize, usize)]>, fixed: &[bool]| {
            let scope = OverlapScope { only, measured: MeasuredOverlaps::All, fixed };
            overlaps(&blocks, &set, scope, &WorkProgress::default(), &AtomicBool::new(false))
        };
        assert_eq!((found(None, &[]).lost(), found(None, &[true, false, false]).lost()), (3, 3));
        let two = found(None, &[true, false, true]);
        assert_eq!((two.lost(), two.neighbours().len()), (2, 3), "of the first with the last nothing is said");
        assert_eq!(found(Some(&[(0, 2)]), &[true, false, true]).lost(), 1, "but where that is asked for");
    }

    #[test]
    fn the_worst_pair_named_is_of_the_first_count() {
        let whole = Number::from_integer;
        let corner = |x, y, z| Vec3::new(whole(x), whole(y), whole(z));
        let slab = Block::cuboid(&corner(-9, -9, -4), &corner(9, 9, 0)).expect("a slab");
        let blocks = [slab, sunk(0, 1), sunk(2, 2), sunk(4, 3)];
        let blocks: Vec<&Block> = blocks.iter().collect();
        let mut set = derive(Preset::Auto, &blocks, Precision::F64).expect("a set");
        set.penetration = Number::from_f64(0.0625).expect("a number");
        let mut found = overlaps(
            &blocks,
            &set,
            all_pairs(MeasuredOverlaps::All),
            &WorkProgress::default(),
            &AtomicBool::new(false),
        );
        let held = "3 pairs (worst 0–3, 0.0030 m) overlap and are held by contacts (3 seen, 0 shallow)";
        assert_eq!(found.sentence().as_deref(), Some(held));
        // The two shallower ones unseen: the deepest pair of all is not theirs.
        for overlap in &mut found.audit.overlaps[..2] {
            (overlap.sight, overlap.contact) = (OverlapVisibility::Unseen, None);
        }
        found.audit.overlaps[2].sight = OverlapVisibility::Shallow;
        let found =
            Overlaps::of(found.audit, &rounding_depth(&blocks, Precision::F64), found.neighbours, found.is_near);
        let said = found.sentence().expect("overlaps");
        assert!(said.starts_with("2 pairs (worst 0–2, 0.0020 m) overlap where no contact sees it, and will"), "{said}");
        assert!(said.contains(" pass through one another (0 seen, 0 shallow, 2 unseen); "), "{said}");
        assert!(said.ends_with("; 1 pair overlaps and is held by contacts (0 seen, 1 shallow)"), "{said}");
        // Which of both it is.
        for (deep, why) in [
            (1, "deeper than penetration (1) or where no contact sees it (1), and"),
            (2, "deeper than penetration, and"),
        ] {
            let mut found = found.clone();
            found.audit.overlaps[..deep].iter_mut().for_each(|overlap| overlap.is_deeper_than_g = true);
            let said = found.sentence().expect("overlaps");
            assert!(said.contains(&format!(" m) overlap {why} will pass through one another")), "{said}");
        }
        let json = found.json();
        assert_eq!([&json["seen"], &json["shallow"], &json["unseen"]], [0, 1, 2]);
    }
}
