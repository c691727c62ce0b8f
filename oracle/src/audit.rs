//! The audit of overlaps (SPEC section 7), exactly: which pairs of blocks overlap, how deep, and whether the classification
//! sees it.
//!
//! What "inside" means: a block whose edges are all convex is the hull of its vertices, as its penetration takes it; any
//! other is what its faces' triangles from the first vertex of each loop enclose, as its volume is. Both are the same where
//! faces are planar. Two blocks **overlap** when their interiors meet; **touching is not overlapping**.
//!
//! A pair goes through these questions until one is decided, each certified:
//!
//! 1. boxes that share no more than their surfaces: apart;
//! 2. the plane of a face of either block has the blocks on different sides: apart. f64 measures all faces, with a proved
//!    bound; of those it leaves open, sums of two f64 decide, with a proved bound too, or exact integers;
//! 3. whether any plane separates the hulls of the vertices (`separation`, complete): if so the blocks are apart, else
//!    two convex blocks overlap;
//! 4. of other blocks, whether their surfaces enclose something that both share (`interiors`).
//!
//! [`Auditor::neighbours`] lists the pairs and [`Auditor::pair`] audits one of them, so that a caller can share the work
//! among threads; [`Audit::of`] puts the answers together in the order of the pairs, whoever found them. An overlap costs far
//! more to measure than to find: [`Auditor::pair_beyond_rounding`] measures none that is certainly rounding. Of blocks that a
//! stepper has moved, [`Screen`] leaves out in f64, proved, all pairs that need no exact answer.

mod decider;
mod planes;
mod screen;
mod severity;
mod unevenness;

use crate::boxes::{self, Box3, meeting_pairs};
use crate::interiors;
use crate::penetration::{Penetration, penetration};
use crate::separation::{PointSet, SeparationAnswer, separate};
use crate::{Gap, Pair, PreparedBlock};
pub use decider::{AuditCounts, Decider};
use num_rational::BigRational;
use num_traits::Zero;
use planes::FacePlanes;
use rockproof_model::{Block, Contact, ContactKey, Number, ToleranceSet};
pub use screen::Screen;
pub use severity::{OverlapSeverity, rounding_depth, rounding_depth_of_size};
use std::sync::OnceLock;
use unevenness::{UnevenFace, uneven_faces};

/// Whether the contacts of a pair tell of its overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OverlapVisibility {
    /// A contact has h < 0, and −h is at least half the penetration (**exactly half is seen**). Of a pair with a block
    /// that is not convex any contact with h < 0 will do: SPEC compares depths of convex pairs only.
    Seen,
    /// The pair is convex and every −h is less than half the penetration.
    Shallow,
    /// No contact has h < 0.
    Unseen,
}

impl OverlapVisibility {
    /// All, the best first.
    pub const ALL: [OverlapVisibility; 3] =
        [OverlapVisibility::Seen, OverlapVisibility::Shallow, OverlapVisibility::Unseen];

    /// `seen`, `shallow` or `unseen`, as written in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            OverlapVisibility::Seen => "seen",
            OverlapVisibility::Shallow => "shallow",
            OverlapVisibility::Unseen => "unseen",
        }
    }
}

/// A pair of blocks whose interiors meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overlap {
    /// The blocks, the lower number first: A and B of the classification.
    pub blocks: [usize; 2],
    /// How deep they overlap. Its gap is zero where all that the blocks share is thinner than the unevenness of a face.
    pub penetration: Penetration,
    /// The contact with the most negative h, of several equal ones the first in sorted order, and its gap.
    pub contact: Option<(Contact, Gap)>,
    /// Whether the contacts tell of it.
    pub sight: OverlapVisibility,
    /// Whether the penetration is above g; **exactly g is not**.
    pub is_deeper_than_g: bool,
    /// Whether the penetration is at most twice the greatest distance of a vertex from the plane of its face (**a tie says yes**), of some face of either
    /// block whose box meets that of the other one: so much can blocks overlap whose planes only touch, because rounded coordinates made faces uneven.
    /// Contacts, which ask for planes, need not tell of it.
    pub is_within_unevenness: bool,
}

/// What the audit says of one pair.
#[derive(Clone, Debug, PartialEq)]
pub struct PairAudit {
    /// What decided.
    pub decider: Decider,
    /// The overlap, if there is one and it was measured.
    pub overlap: Option<Overlap>,
    /// The overlap, if there is one that was only bounded.
    pub bounded: Option<BoundedOverlap>,
}

/// An overlap that is certainly rounding ([`OverlapSeverity::Rounding`]), not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedOverlap {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// The penetration certainly does not exceed it (m).
    pub most_m: f64,
}

/// The overlaps of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// The pairs that overlap and were measured, in ascending order.
    pub overlaps: Vec<Overlap>,
    /// The pairs that overlap and were only bounded, in ascending order.
    pub bounded: Vec<BoundedOverlap>,
    /// How all neighbouring pairs were decided.
    pub counts: AuditCounts,
}

impl Audit {
    /// The answers of an auditor put together.
    pub fn of(pairs: impl IntoIterator<Item = PairAudit>) -> Audit {
        pairs.into_iter().fold(Audit::default(), Audit::with).sorted()
    }

    /// The same with the answer about another pair, last whatever its blocks.
    #[must_use]
    pub fn with(mut self, pair: PairAudit) -> Audit {
        self.counts += pair.decider;
        self.overlaps.extend(pair.overlap);
        self.bounded.extend(pair.bounded);
        self
    }

    /// The answers about other pairs as well, in ascending order.
    #[must_use]
    pub fn and(mut self, other: Audit) -> Audit {
        self.counts += other.counts;
        self.overlaps.extend(other.overlaps);
        self.bounded.extend(other.bounded);
        self.sorted()
    }

    fn sorted(mut self) -> Audit {
        self.overlaps.sort_by_key(|overlap| overlap.blocks);
        self.bounded.sort_by_key(|overlap| overlap.blocks);
        self
    }

    /// The deepest overlap that was measured, of several equally deep the first.
    pub fn deepest(&self) -> Option<&Overlap> {
        self.deepest_of(|_| true)
    }

    /// The deepest of some overlaps, of several equally deep the first.
    pub fn deepest_of(&self, is_meant: impl Fn(&Overlap) -> bool) -> Option<&Overlap> {
        let meant = self.overlaps.iter().rev().filter(|overlap| is_meant(overlap));
        // `max_by` keeps the last of several.
        meant.max_by(|one, two| one.depth_squared().cmp(&two.depth_squared()))
    }
}

impl Overlap {
    /// The square of the penetration in m².
    pub fn depth_squared(&self) -> BigRational {
        self.penetration.depth_squared()
    }
}

/// Audits the pairs of a scene. What it keeps of a block serves all its pairs.
pub struct Auditor<'s> {
    prepared: &'s [PreparedBlock],
    tolerances: &'s ToleranceSet,
    bodies: Vec<AuditedBlock>,
}

/// What is kept of a block.
struct AuditedBlock {
    planes: FacePlanes,
    has_inside: bool,
    uneven_faces: OnceLock<Vec<UnevenFace>>,
}

/// The audit of all pairs in one thread.
pub fn audit(blocks: &[&Block], tolerances: &ToleranceSet) -> Audit {
    let prepared: Vec<PreparedBlock> = blocks.iter().map(|block| PreparedBlock::new(block)).collect();
    let auditor = Auditor::new(&prepared, tolerances);
    Audit::of(auditor.neighbours().into_iter().map(|pair| auditor.pair(pair)))
}

impl<'s> Auditor<'s> {
    /// Makes blocks ready.
    pub fn new(prepared: &'s [PreparedBlock], tolerances: &'s ToleranceSet) -> Auditor<'s> {
        let body = |prepared: &PreparedBlock| AuditedBlock {
            planes: FacePlanes::of(prepared),
            has_inside: planes::has_inside(prepared),
            uneven_faces: OnceLock::new(),
        };
        Auditor { prepared, tolerances, bodies: prepared.iter().map(body).collect() }
    }

    /// The neighbouring pairs (SPEC section 4, rough phase; **touching counts**), the lower number first, in ascending order.
    pub fn neighbours(&self) -> Vec<[usize; 2]> {
        let search = self.tolerances.search.approximate().next_up();
        // Grown on both sides by half of s, a little more than that because of rounding; the exact question follows.
        let boxes: Vec<Box3> = self.prepared.iter().map(|block| Box3::around(block, search / 2.0)).collect();
        let mut pairs = meeting_pairs(&boxes);
        pairs.retain(|&[i, j]| Pair::new(&self.prepared[i], &self.prepared[j]).are_neighbours(self.tolerances));
        pairs.sort_unstable();
        pairs
    }

    /// Whether the normal of a face of either block shows that they are further apart than a length (m): that of neighbouring pairs whose boxes alone are near.
    /// False where no face shows it, though the blocks may be so far apart.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn is_surely_apart(&self, blocks: [usize; 2], length: &Number) -> bool {
        let prepared = blocks.map(|k| &self.prepared[k]);
        planes::greatest_certain_gap(prepared, blocks.map(|k| &self.bodies[k].planes)) > length.approximate().next_up()
    }

    /// The audit of one pair. The pair need not be of those that [`Auditor::neighbours`] lists.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn pair(&self, blocks: [usize; 2]) -> PairAudit {
        self.pair_with_kept(blocks, &[])
    }

    /// As [`Auditor::pair`], where the step before left the contacts `kept` of the pair closed.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn pair_with_kept(&self, blocks: [usize; 2], kept: &[ContactKey]) -> PairAudit {
        let (overlaps, decider) = self.overlap(blocks);
        PairAudit { decider, overlap: overlaps.then(|| self.measure(blocks, kept)), bounded: None }
    }

    /// As [`Auditor::pair`], where an overlap that is certainly [`OverlapSeverity::Rounding`] is bounded and not measured, nor its
    /// contacts looked for; `rounding` (m) is the depth that rounded coordinates alone can make ([`rounding_depth`]).
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn pair_beyond_rounding(&self, blocks: [usize; 2], rounding: &Number) -> PairAudit {
        let (overlaps, decider) = self.overlap(blocks);
        let bounded = if overlaps { self.surely_rounding(blocks, rounding) } else { None };
        let is_measured = overlaps && bounded.is_none();
        PairAudit { decider, overlap: is_measured.then(|| self.measure(blocks, &[])), bounded }
    }

    /// The overlap of two blocks of which no contact tells, where the step before left the contacts `kept` of the pair closed;
    /// `None` where they do not overlap or a contact has h < 0. Cheaper than [`Auditor::pair_with_kept`], since contacts are asked
    /// before the depth is measured.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn unseen_with_kept(&self, blocks: [usize; 2], kept: &[ContactKey]) -> Option<Overlap> {
        if !self.overlap(blocks).0 {
            return None;
        }
        let [a, b] = blocks.map(|k| &self.prepared[k]);
        let contacts = Pair::new(a, b).classify_with_kept(self.tolerances, kept).contacts;
        let is_seen = contacts.iter().any(|contact| contact.gap.is_negative());
        (!is_seen).then(|| self.measured(blocks, None))
    }

    /// How deep two blocks overlap, without asking what contacts see of it; `None` where they do not.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn depth(&self, blocks: [usize; 2]) -> Option<Penetration> {
        let (overlaps, _) = self.overlap(blocks);
        overlaps.then(|| self.penetration(blocks))
    }

    fn penetration(&self, blocks: [usize; 2]) -> Penetration {
        let [one, two] = blocks.map(|k| self.prepared[k].block());
        // A block with an inside has faces with areas but where they cancel; then nothing is known of its depth.
        penetration(one, two).unwrap_or_else(Penetration::none)
    }

    /// Whether the interiors meet, and what decided it.
    fn overlap(&self, blocks: [usize; 2]) -> (bool, Decider) {
        let [a, b] = blocks.map(|k| &self.prepared[k]);
        let bodies = blocks.map(|k| &self.bodies[k]);
        if !bodies.iter().all(|body| body.has_inside) {
            return (false, Decider::LeftOut);
        }
        if boxes::share_surfaces_at_most(a, b) {
            return (false, Decider::Boxes);
        }
        if let Some(decider) = planes::separating_face([a, b], bodies.map(|body| &body.planes)) {
            return (false, decider);
        }
        let SeparationAnswer { is_separated, by_float } = separate(PointSet::of(a), PointSet::of(b));
        let decider = if by_float { Decider::Float } else { Decider::Exact };
        if is_separated {
            return (false, decider);
        }
        match [a, b].map(|prepared| prepared.block().is_convex()) {
            [true, true] => (true, decider),
            [false, true] => (interiors::meets_hull(a.block(), PointSet::of(b)), Decider::Surfaces),
            [true, false] => (interiors::meets_hull(b.block(), PointSet::of(a)), Decider::Surfaces),
            [false, false] => (interiors::surfaces_meet(a.block(), b.block()), Decider::Surfaces),
        }
    }

    /// The bound of an overlap that certainly is rounding, however the contacts see it.
    fn surely_rounding(&self, blocks: [usize; 2], rounding: &Number) -> Option<BoundedOverlap> {
        let [a, b] = blocks.map(|k| &self.prepared[k]);
        if !a.block().is_convex() || !b.block().is_convex() {
            return None;
        }
        let most_m = planes::greatest_depth([a, b], blocks.map(|k| &self.bodies[k].planes));
        // Rounded to nearest, so one float less is certainly not more.
        let below = |limit: &Number| most_m <= limit.approximate().next_down();
        let is_rounding = || below(rounding) || self.is_surely_within_unevenness(blocks, most_m);
        (below(&self.tolerances.penetration) && is_rounding()).then_some(BoundedOverlap { blocks, most_m })
    }

    fn is_surely_within_unevenness(&self, blocks: [usize; 2], most_m: f64) -> bool {
        most_m <= 2.0 * self.bulge(blocks)
            && BigRational::from_float(most_m).is_some_and(|most| self.unevenness_explains(blocks, &(&most * &most)))
    }

    /// How deep blocks overlap that do, and what the classification says of it.
    fn measure(&self, blocks: [usize; 2], kept: &[ContactKey]) -> Overlap {
        let [a, b] = blocks.map(|k| &self.prepared[k]);
        self.measured(blocks, self.deepest_contact(&Pair::new(a, b), kept))
    }

    /// How deep blocks overlap that do, given the contact with the most negative gap.
    fn measured(&self, blocks: [usize; 2], contact: Option<(Contact, Gap)>) -> Overlap {
        let [one, two] = blocks.map(|k| self.prepared[k].block());
        let penetration = self.penetration(blocks);
        let square = penetration.depth_squared();
        let four = BigRational::from_integer(4.into());
        let sight = match &contact {
            None => OverlapVisibility::Unseen,
            Some((_, gap)) if one.is_convex() && two.is_convex() && four * &gap.squared < square => {
                OverlapVisibility::Shallow
            }
            Some(_) => OverlapVisibility::Seen,
        };
        let g = self.tolerances.penetration.to_rational();
        Overlap {
            blocks,
            is_deeper_than_g: square > &g * &g,
            is_within_unevenness: self.is_within_unevenness(blocks, &penetration),
            penetration,
            contact,
            sight,
        }
    }

    fn is_within_unevenness(&self, blocks: [usize; 2], penetration: &Penetration) -> bool {
        let square = penetration.depth_squared();
        if square.is_zero() {
            return true;
        }
        // f64 bounds leave out nearly all; NaN leaves out nothing. The depth is rounded to nearest, which keeps the order.
        if penetration.depth_m().is_some_and(|depth| depth > 2.0 * self.bulge(blocks)) {
            return false;
        }
        self.unevenness_explains(blocks, &square)
    }

    fn unevenness_explains(&self, blocks: [usize; 2], square: &BigRational) -> bool {
        unevenness::explains(blocks.map(|k| self.prepared[k].block()), self.uneven_faces(blocks), square)
    }

    /// Bounds the unevenness of both blocks' faces.
    fn bulge(&self, blocks: [usize; 2]) -> f64 {
        blocks.iter().map(|&k| self.prepared[k].bulge).fold(0.0, f64::max)
    }

    fn uneven_faces(&self, blocks: [usize; 2]) -> [&[UnevenFace]; 2] {
        blocks.map(|k| self.bodies[k].uneven_faces.get_or_init(|| uneven_faces(self.prepared[k].block())).as_slice())
    }

    /// The contact with the most negative gap.
    fn deepest_contact(&self, pair: &Pair<'_>, kept: &[ContactKey]) -> Option<(Contact, Gap)> {
        let contacts = pair.classify_with_kept(self.tolerances, kept).contacts;
        let overlapping = contacts.into_iter().filter(|contact| contact.gap.is_negative());
        let mut deepest: Option<(Contact, Gap)> = None;
        for contact in overlapping {
            let gap = pair.gap(&contact.entrance);
            if deepest.as_ref().is_none_or(|(_, deepest)| gap.squared > deepest.squared) {
                deepest = Some((contact, gap));
            }
        }
        deepest
    }
}
