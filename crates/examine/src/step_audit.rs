//! `simulate` and `examine`: every step audited exactly (SPEC section 7), overlaps after it and, where asked for, passages within it.

use crate::deepest::deepest;
use crate::error::ExamineError;
use crate::false_entrances::{FacePlanes, Places, StepGeometry, places};
use crate::past_middle::past_middle;
use rayon::prelude::*;
use rockproof_model::{Block, Contact, ContactKey, Number, Precision, Scene, ToleranceSet};
use rockproof_oracle::audit::{Auditor, BoundedOverlap, Screen, rounding_depth_of_size};
use rockproof_oracle::passage::{PassageAnswer, StraightMotion, passage, swept_neighbours};
use rockproof_oracle::penetration::Penetration;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_simulate::run::StepAnnotations;
use rockproof_simulate::{AuditScope, FalseEntrance, PairDepth, StepAudit, StepPassages, Stepping};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{ClosedContacts, PressedBlocks, State, StepError, StepReport, yielding_size};

/// Pairs that f64 looks at in one thread: to wake others costs more.
const FEW: usize = 512;

/// A run of which every step is audited. The stepper's coordinates are taken as exact; pairs of two fixed blocks are left
/// out, as they never move.
pub struct AuditedRun<R> {
    stepping: Box<dyn Stepping<R>>,
    /// The blocks as the scene has them.
    shapes: Vec<Block>,
    set: ToleranceSet,
    precision: Precision,
    is_fixed: Vec<bool>,
    /// The blocks where the next step begins; `None` where passages are not looked for.
    before: Option<Vec<Block>>,
    last: Option<StepAudit>,
}

/// A pair that f64 does not prove to be apart.
struct Candidate {
    overlap: BoundedOverlap,
    /// Whether contacts may not see it.
    is_open: bool,
}

impl<R: Real> AuditedRun<R> {
    /// Audits the steps of a run from its present state on; `precision` is what the run calculates in.
    ///
    /// # Errors
    /// Where its present state has a coordinate that is not finite.
    pub fn new(
        stepping: Box<dyn Stepping<R>>,
        scene: &Scene,
        set: &ToleranceSet,
        (precision, scope): (Precision, AuditScope),
    ) -> Result<AuditedRun<R>, ExamineError> {
        let shapes: Vec<Block> = scene.blocks.iter().map(|block| block.block.clone()).collect();
        let screen = screened(&shapes, stepping.state()).ok_or(ExamineError::NotFinite)?;
        let before = (scope == AuditScope::OverlapsAndPassages).then(|| all_blocks(&screen, shapes.len()));
        let (set, is_fixed) = (set.clone(), scene.fixed());
        Ok(AuditedRun { stepping, shapes, set, precision, is_fixed, before, last: None })
    }

    /// Whether a contact that a step left closed sees an overlap whatever the next classification says.
    fn closed_contacts_see(&self) -> bool {
        self.before.is_none()
    }

    /// Whether one block of a pair can move.
    fn can_move(&self, pair: &[usize; 2]) -> bool {
        pair.iter().any(|&block| !self.is_fixed[block])
    }

    /// What blocks overlap after a step. Contacts see an overlap where one has h < 0 that an exact classification finds, which keeps those that the
    /// step left closed at any depth, as the next step does. Where overlaps alone are looked for, one that the step left closed and that has h < 0 is
    /// enough: it costs next to nothing, and what the next classification loses is unseen after that step.
    fn audit_overlaps(&self, screen: &Screen<'_>, state: &State<R>) -> StepAudit {
        let rounding = rounding_depth(screen, self.precision);
        // Blocks that overlap by no more are no concern of contacts; rounded down, so that "at most" is sure.
        let harmless = if rounding < self.set.penetration { &rounding } else { &self.set.penetration };
        let harmless = harmless.approximate().next_down();
        let (closed, see) = (ClosedContacts::of(state), self.closed_contacts_see());
        let pairs: Vec<[usize; 2]> = screen.pairs().into_iter().filter(|pair| self.can_move(pair)).collect();
        let candidate = |&blocks: &[usize; 2]| {
            let most_m = screen.greatest_depth(blocks)?;
            let is_seen =
                || see && closed.between(blocks).iter().any(|(_, c)| screen.surely_negative_gap(blocks, &c.entrance));
            let is_open = most_m > harmless && !is_seen();
            Some(Candidate { overlap: BoundedOverlap { blocks, most_m }, is_open })
        };
        let candidates: Vec<Candidate> = if pairs.len() < FEW {
            pairs.iter().filter_map(candidate).collect()
        } else {
            pairs.par_iter().filter_map(candidate).collect()
        };
        let open: Vec<[usize; 2]> = candidates.iter().filter(|c| c.is_open).map(|c| c.overlap.blocks).collect();
        let set = &self.set;
        let exactly = |&blocks: &[usize; 2]| unseen(screen, (set, see), blocks, (closed.between(blocks), &rounding));
        // Each takes long enough to be worth another thread.
        let unseen: Vec<UnseenOverlap> = open.par_iter().filter_map(exactly).collect();
        let (unseen, explained) = beyond_yielding(unseen, state, &self.is_fixed);
        let floor = rounding_depth(screen, Precision::F64);
        let bounded = candidates.into_iter().map(|candidate| candidate.overlap).collect();
        let deepest = deepest_beyond(screen, &self.set, bounded, &floor);
        let is_deep = deepest.is_some_and(|deepest| deepest.depth_m > self.set.penetration.approximate());
        let past_middle = past_middle(&self.shapes, &self.set, screen, state);
        StepAudit { unseen, explained, deepest, is_deep, past_middle, ..StepAudit::default() }
    }

    /// The contacts of a step that pushed where nothing met, or through a face that another block covers; `before` is where the blocks were.
    fn false_entrances(&self, screen: &Screen<'_>, (before, state): (&[Places], &State<R>)) -> Vec<FalseEntrance> {
        let geometry = StepGeometry {
            shapes: &self.shapes,
            is_fixed: &self.is_fixed,
            before,
            after: &places(state),
            screen,
            planes: FacePlanes::of(self.shapes.len()),
            penetration: self.set.penetration.approximate(),
            rounding: rounding_depth(screen, self.precision).approximate(),
        };
        geometry.false_entrances(state)
    }

    /// Which pairs passed through one another. Only pairs whose boxes over the whole step meet are asked about.
    fn passages(&self, before: &[Block], after: &[Block]) -> StepPassages {
        let ends = || before.iter().zip(after);
        let motions: Vec<StraightMotion> = ends().map(|(before, after)| StraightMotion::new(before, after)).collect();
        let has_moved: Vec<bool> = ends().map(|(before, after)| before.vertices() != after.vertices()).collect();
        let mut pairs = swept_neighbours(&motions);
        pairs.retain(|[a, b]| has_moved[*a] || has_moved[*b]);
        let limit = &self.set.penetration;
        let asked = pairs.par_iter().map(|[a, b]| passage(&motions[*a], &motions[*b], limit).answer);
        let mut found = StepPassages::default();
        for (&pair, answer) in pairs.iter().zip(asked.collect::<Vec<_>>()) {
            match answer {
                PassageAnswer::Passage { depth, .. } => found.pairs.push(pair_depth(pair, &depth)),
                PassageAnswer::Undecided => found.undecided += 1,
                PassageAnswer::NoPassage | PassageAnswer::DeepAtEnd => {}
            }
        }
        found.pairs.sort_by_key(|pair| pair.blocks);
        found
    }
}

impl<R: Real> Stepping<R> for AuditedRun<R> {
    fn step(&mut self) -> Result<StepReport, StepError> {
        self.last = None;
        let before = places(self.stepping.state());
        let report = self.stepping.step()?;
        let state = self.stepping.state();
        // A step whose numbers are not finite is not made.
        if let Some(screen) = screened(&self.shapes, state) {
            let mut found = self.audit_overlaps(&screen, state);
            found.false_entrances = self.false_entrances(&screen, (&before, state));
            if let Some(before) = &self.before {
                let after = all_blocks(&screen, self.shapes.len());
                found.passages = Some(self.passages(before, &after));
                self.before = Some(after);
            }
            self.last = Some(found);
        }
        Ok(report)
    }

    fn state(&self) -> &State<R> {
        self.stepping.state()
    }

    fn annotations(&mut self) -> Option<StepAnnotations> {
        self.stepping.annotations()
    }

    fn audit(&mut self) -> Option<StepAudit> {
        self.last.take()
    }
}

/// Whether a pair of blocks overlaps in a state by more than rounding where no contact sees it; yes where a number is not finite.
pub(crate) fn is_unseen<R: Real>(
    (shapes, is_fixed): (&[Block], &[bool]),
    (set, precision, scope): (&ToleranceSet, Precision, AuditScope),
    state: &State<R>,
    blocks: [usize; 2],
) -> bool {
    let Some(screen) = screened(shapes, state) else { return true };
    let rounding = rounding_depth(&screen, precision);
    let closed_see = scope == AuditScope::Overlaps;
    let found = unseen(&screen, (set, closed_see), blocks, (ClosedContacts::of(state).between(blocks), &rounding));
    !beyond_yielding(found.into_iter().collect(), state, is_fixed).0.is_empty()
}

/// An overlap by more than rounding where no contact sees it.
struct UnseenOverlap {
    blocks: [usize; 2],
    penetration: Penetration,
    /// As of [`yielding_size`].
    size: Option<f64>,
}

/// Of unseen overlaps those that are more than springs of other contacts explain, and those that these explain.
fn beyond_yielding<R: Real>(
    unseen: Vec<UnseenOverlap>,
    state: &State<R>,
    is_fixed: &[bool],
) -> (Vec<PairDepth>, Vec<PairDepth>) {
    if unseen.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let pressed = PressedBlocks::of(state, is_fixed);
    let (mut beyond, mut explained) = (Vec::new(), Vec::new());
    for found in unseen {
        let pair = pair_depth(found.blocks, &found.penetration);
        let way_out = found.penetration.way_out();
        let yields = found.size.is_some_and(|size| pressed.explain(pair.blocks, pair.depth_m, way_out, size));
        if yields { explained.push(pair) } else { beyond.push(pair) }
    }
    (beyond, explained)
}

/// A pair exactly: how it overlaps, if it does by more than rounding where no contact sees it; `closed_see` where closed contacts with h < 0 are enough.
fn unseen(
    screen: &Screen<'_>,
    (set, closed_see): (&ToleranceSet, bool),
    blocks: [usize; 2],
    (closed, rounding): (&[([usize; 2], Contact)], &Number),
) -> Option<UnseenOverlap> {
    let prepared = blocks.map(|block| PreparedBlock::new(&screen.block(block)));
    let kept: Vec<ContactKey> = closed.iter().map(|(_, contact)| contact.key).collect();
    let pair = Pair::new(&prepared[0], &prepared[1]);
    let is_pressed = || closed_see && closed.iter().any(|(_, contact)| pair.gap(&contact.entrance).sign.is_negative());
    // The contacts first: to find them costs a fraction of what an exact depth does.
    if pair.classify_with_kept(set, &kept).contacts.iter().any(|contact| contact.gap.is_negative()) || is_pressed() {
        return None;
    }
    let overlap = Auditor::new(&prepared, set).pair_with_kept([0, 1], &kept).overlap?;
    overlap.is_unseen(rounding).then(|| {
        let size = yielding_size(prepared.each_ref().map(PreparedBlock::block), set.penetration.approximate());
        UnseenOverlap { blocks, penetration: overlap.penetration, size }
    })
}

/// The deepest of some pairs, exactly, of equal ones the first; none where none is deeper than `floor`.
fn deepest_beyond(
    screen: &Screen<'_>,
    set: &ToleranceSet,
    mut bounded: Vec<BoundedOverlap>,
    floor: &Number,
) -> Option<PairDepth> {
    bounded.retain(|overlap| overlap.most_m > floor.approximate());
    let measure = |blocks: [usize; 2]| {
        let prepared = blocks.map(|block| PreparedBlock::new(&screen.block(block)));
        Auditor::new(&prepared, set).depth([0, 1])
    };
    let (blocks, depth) = deepest(bounded, measure)?;
    let floor_squared = floor.times(floor).to_rational();
    (depth.depth_squared() > floor_squared).then(|| pair_depth(blocks, &depth))
}

/// The blocks where a state has them, for f64 to look at; `None` where a number is not finite.
fn screened<'s, R: Real>(shapes: &'s [Block], state: &State<R>) -> Option<Screen<'s>> {
    Screen::new(shapes.iter().zip(places(state)))
}

/// The depth in m below which rounding decides whether blocks overlap, at their largest coordinate.
fn rounding_depth(screen: &Screen<'_>, precision: Precision) -> Number {
    let largest = Number::from_f64(screen.largest_coordinate()).unwrap_or(Number::ZERO);
    rounding_depth_of_size(&largest, precision)
}

fn all_blocks(screen: &Screen<'_>, count: usize) -> Vec<Block> {
    (0..count).map(|block| screen.block(block)).collect()
}

fn pair_depth(blocks: [usize; 2], penetration: &Penetration) -> PairDepth {
    PairDepth { blocks, depth_m: penetration.depth_m().unwrap_or(f64::INFINITY) }
}
