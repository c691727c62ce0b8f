//! The pairs of a campaign. A pair is a function of (seed, index) and the configuration alone, in batches of sixteen that
//! share their base pair, so that blocks are built once a batch and moved for the rest.

use crate::directed::{self, DirectedPair, Rung};
use crate::families::{self, CoordinateStyle, Family, PairSampler};
use crate::ladder::{self, Critical, LadderPair};
pub use crate::tolerance_sets::SetSource;
use crate::{perturbation, tolerance_sets};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_model::decision::{Decision, Predicate};
use rockproof_model::{Block, Criteria, Number, Precision, Sign, ToleranceSet, Vec3};
use std::sync::Arc;

/// Pairs in a batch.
pub const BATCH: u64 = 16;

/// Pairs that follow one aim or ladder: three of these and the base make a batch.
const SEGMENT: usize = 5;

/// How a pair came about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PairForm {
    /// As its family generates it.
    Base,
    /// The base with B moved at random.
    Moved,
    /// B moved to the boundary of a decision.
    Directed {
        /// The decision.
        decision: Decision,
        /// Where around the boundary.
        rung: Rung,
    },
    /// The base with a tolerance at its critical value for a decision.
    Ladder {
        /// The tolerance's name.
        tolerance: &'static str,
        /// The decision.
        decision: Decision,
        /// Where around the critical value.
        rung: Rung,
    },
}

impl PairForm {
    /// `base`, `moved`, `directed` or `ladder`.
    pub fn name(&self) -> &'static str {
        match self {
            PairForm::Base => "base",
            PairForm::Moved => "moved",
            PairForm::Directed { .. } => "directed",
            PairForm::Ladder { .. } => "ladder",
        }
    }

    /// The decision aimed at.
    pub fn decision(&self) -> Option<&Decision> {
        match self {
            PairForm::Base | PairForm::Moved => None,
            PairForm::Directed { decision, .. } | PairForm::Ladder { decision, .. } => Some(decision),
        }
    }
}

/// One pair of a campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairCase {
    /// The pair's number.
    pub index: u64,
    /// The family that generated its base.
    pub family: &'static str,
    /// How it came about.
    pub form: PairForm,
    /// The sign of the margin (see [`directed`]) of the decision aimed at, for the exact input and `sets[0]` for the
    /// precision `aimed_for`, where the generator knows it.
    pub margin: Option<Sign>,
    /// The precision whose tolerance set an aim or ladder was found with.
    pub aimed_for: Precision,
    /// The first block.
    pub a: Block,
    /// The second block.
    pub b: Block,
    /// The tolerance sets to classify it with; at least one.
    pub sets: Vec<NamedSet>,
}

impl From<PairCase> for Subject {
    fn from(PairCase { index, family, form, a, b, sets, .. }: PairCase) -> Subject {
        Subject { index, family: family.into(), form: form.name().into(), a, b, sets }
    }
}

/// What a campaign's pairs are drawn from.
#[derive(Clone, Debug)]
pub struct PairConfig {
    /// The families, which take turns by batch. At least one.
    pub families: Vec<Arc<dyn Family>>,
    /// Where tolerance sets come from.
    pub sets: Vec<SetSource>,
    /// How many of the sets one batch uses. Its base pair gets all of them, each other pair one.
    pub sets_per_batch: usize,
    /// Share of boundary-directed pairs, in percent.
    pub directed_percent: u64,
    /// Share of tolerance ladders, in percent. The rest are random moves, or off no perturbed base mostly ladders of r and g.
    pub ladder_percent: u64,
    /// Share of batches taken off their ties, in percent: their base is perturbed by some steps of f32, and what is aimed
    /// from there keeps an f32 step or more away from the boundary.
    pub perturbed_percent: u64,
}

impl Default for PairConfig {
    /// Every family, the presets and the sets of few binary digits, half of all pairs directed, a quarter ladders.
    fn default() -> Self {
        PairConfig {
            families: families::all(),
            sets: default_sets(),
            sets_per_batch: 2,
            directed_percent: 50,
            ladder_percent: 25,
            perturbed_percent: 92,
        }
    }
}

/// All of [`tolerance_sets::NAMES`].
pub fn default_sets() -> Vec<SetSource> {
    tolerance_sets::NAMES.into_iter().filter_map(SetSource::named).collect()
}

/// The pairs `16·batch .. 16·batch + 16` of a seed.
pub fn batch(seed: u64, batch: u64, config: &PairConfig) -> Vec<PairCase> {
    let mut rng = generator(seed, batch);
    let family = &config.families[(batch % config.families.len() as u64) as usize];
    let (a, mut b) = family.generate(&mut rng);
    let mut sampler = PairSampler::with_style(&mut rng, CoordinateStyle::Grid);
    let perturbed = config.perturbed_percent > 0 && sampler.chance(config.perturbed_percent);
    if perturbed {
        b = perturbation::perturbed(&mut sampler, &b, directed::magnitude(&a, &b));
    }
    let sets = chosen_sets(&mut sampler, (&a, &b), config);
    let (form, margin, aimed_for) = (PairForm::Base, None, Precision::F64);
    let base = PairCase { index: batch * BATCH, family: family.name(), form, margin, aimed_for, a, b, sets };
    let mut cases = Vec::with_capacity(BATCH as usize);
    let mut variants =
        PairVariants { sampler: &mut sampler, base: &base, magnitude: 0.0, held_by_f32: false, perturbed };
    variants.magnitude = directed::magnitude(&base.a, &base.b);
    variants.held_by_f32 = base.a.is_exact_in(Precision::F32) && base.b.is_exact_in(Precision::F32);
    let mut made = Vec::with_capacity(BATCH as usize - 1);
    while made.len() < BATCH as usize - 1 {
        let room = (BATCH as usize - 1 - made.len()).min(SEGMENT);
        let draw = variants.sampler.below(100);
        let segment = if draw < config.directed_percent {
            variants.directed(room)
        } else if draw < config.directed_percent + config.ladder_percent {
            variants.ladder(room)
        } else if !perturbed && config.ladder_percent > 0 && variants.sampler.chance(60) {
            variants.length_ladder(room)
        } else {
            None
        };
        made.extend(segment.unwrap_or_else(|| variants.moved(room)));
    }
    cases.push(base);
    for (case, index) in made.into_iter().zip(batch * BATCH + 1..) {
        cases.push(PairCase { index, ..case });
    }
    cases
}

/// The generator of one batch: the seed is the key, the batch the stream.
fn generator(seed: u64, batch: u64) -> ChaCha8Rng {
    let mut key = *b"rockproof pairs, version 2......";
    key[24..].copy_from_slice(&seed.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(batch);
    rng
}

/// The batch's share of the configured sets, in turn from a random one; where none can be derived, [`SetSource::dyadic`].
fn chosen_sets(sampler: &mut PairSampler<'_>, (a, b): (&Block, &Block), config: &PairConfig) -> Vec<NamedSet> {
    let count = config.sets.len();
    let first = sampler.below(count.max(1) as u64) as usize;
    let wanted = config.sets_per_batch.clamp(1, count.max(1));
    let mut sets: Vec<NamedSet> =
        (0..count).map(|i| &config.sets[(first + i) % count]).filter_map(|s| s.derive(a, b)).take(wanted).collect();
    if sets.is_empty() {
        sets.extend(SetSource::dyadic(Criteria::Revised).derive(a, b));
    }
    sets
}

/// Makes the pairs after the base.
struct PairVariants<'k, 'r, 'b> {
    sampler: &'k mut PairSampler<'r>,
    base: &'b PairCase,
    magnitude: f64,
    held_by_f32: bool,
    perturbed: bool,
}

/// How often another predicate or other features are tried before a segment becomes random moves.
const TRIES: usize = 4;

/// How many critical values are looked at for an exact one.
const EXACT_TRIES: usize = 24;

/// The tolerances that dips are measured by.
const LENGTHS: [&str; 2] = ["territory", "penetration"];

impl PairVariants<'_, '_, '_> {
    fn case(
        &self,
        (form, aimed_for): (PairForm, Precision),
        margin: Option<Sign>,
        offset: Option<[Number; 3]>,
        set: NamedSet,
    ) -> PairCase {
        let b = offset.map_or_else(|| self.base.b.clone(), |[x, y, z]| self.base.b.translated(&Vec3::new(x, y, z)));
        PairCase { form, margin, aimed_for, a: self.base.a.clone(), b, sets: vec![set], ..*self.base }
    }

    fn set(&mut self) -> NamedSet {
        self.sampler.pick(&self.base.sets).clone()
    }

    /// The number format whose spacing the rungs step by.
    fn precision(&mut self) -> Precision {
        let share = match (self.perturbed, self.held_by_f32) {
            (true, _) => 100,
            (false, true) => 65,
            (false, false) => 35,
        };
        if self.sampler.chance(share) { Precision::F32 } else { Precision::F64 }
    }

    /// The tie (but not off a perturbed base), one step to each side, and places further off: powers of two of steps, and
    /// thousandths.
    fn rungs(&mut self, precision: Precision, room: usize) -> Vec<Rung> {
        let far = if precision == Precision::F32 { 14 } else { 40 };
        let mut variants = vec![Rung::Exact, Rung::Steps(precision, -1), Rung::Steps(precision, 1)];
        if self.perturbed {
            variants.remove(0);
        }
        while variants.len() < room {
            let away = self.sampler.sign() as i64;
            variants.push(match self.sampler.below(3) {
                0 => Rung::Permille(*self.sampler.pick(&[-100, -50, -10, -1, 1, 10, 50, 100])),
                1 => Rung::Steps(precision, away * (1 << self.sampler.between(1, 4))),
                _ => Rung::Steps(precision, away * (1 << self.sampler.between(1, far))),
            });
        }
        variants.truncate(room);
        variants
    }

    fn directed(&mut self, room: usize) -> Option<Vec<PairCase>> {
        let set = self.set();
        let precision = self.precision();
        let chosen = set.of(precision).clone();
        let base = self.base;
        let pair = DirectedPair::new(&base.a, &base.b, &chosen);
        let aim = (0..TRIES).find_map(|_| {
            let predicate = self.predicate();
            // Other features may serve where the first ones do not.
            (0..3).find_map(|_| directed::aim(self.sampler, &pair, predicate))
        })?;
        // A long fraction is carried now and then only: it makes every exact number after it long.
        let carry = aim.is_short() || self.sampler.chance(10);
        let tolerance = chosen.search.approximate();
        let variants = self.rungs(precision, room);
        let cases = variants.into_iter().map(|rung| {
            let exact = if carry { aim.step(rung, self.magnitude, tolerance) } else { None };
            let rung = if rung == Rung::Exact && exact.is_none() { Rung::Steps(precision, 0) } else { rung };
            let step = exact.or_else(|| aim.step(rung, self.magnitude, tolerance));
            let form = PairForm::Directed { decision: aim.decision, rung };
            let (offset, margin) = step.map_or((None, None), |s| (Some(s.offset), s.margin));
            self.case((form, precision), margin, offset, set.clone())
        });
        Some(cases.collect())
    }

    fn predicate(&mut self) -> Predicate {
        let concave = !(self.base.a.is_convex() && self.base.b.is_convex());
        match self.sampler.below(20) {
            0..=6 if concave => Predicate::ShortestExit,
            0..=2 => Predicate::EntranceChoice,
            3 => Predicate::EntranceDepth,
            _ => *self.sampler.pick(&directed::MOVED),
        }
    }

    fn ladder(&mut self, room: usize) -> Option<Vec<PairCase>> {
        // The overlap angle and the territory settle the most kinds of decision, the edges' angle one that every pair has.
        let [search, territory, penetration, overlap, parallel, equal] = ladder::TOLERANCES;
        let weighted =
            [search, territory, territory, penetration, penetration, overlap, overlap, overlap, parallel, equal];
        self.ladder_of(&weighted, room)
    }

    /// A ladder of r or g: ties of lengths are rare among all that these settle, and seldom change a contact.
    fn length_ladder(&mut self, room: usize) -> Option<Vec<PairCase>> {
        self.ladder_of(&LENGTHS, room)
    }

    fn ladder_of(&mut self, tolerances: &[&'static str], room: usize) -> Option<Vec<PairCase>> {
        let set = self.set();
        let precision = self.precision();
        let (set, critical) = (0..TRIES).find_map(|_| {
            let tolerance = self.sampler.pick(tolerances);
            self.critical(&set, precision, tolerance)
        })?;
        let variants = self.rungs(precision, room);
        let cases = variants.into_iter().filter_map(|rung| {
            // Where the tolerance may not be so large the rung is on the other side; an exact tie that is irrational is rounded.
            let rungs = [rung, rung.mirrored(), Rung::Steps(precision, 0)];
            let (rung, (value, margin)) = rungs.into_iter().find_map(|rung| Some((rung, critical.at(rung)?)))?;
            let changed = NamedSet {
                name: format!("{}:{}", set.name, critical.tolerance).into(),
                f32: critical.applied(&set.f32, &value),
                f64: critical.applied(&set.f64, &value),
            };
            let form = PairForm::Ladder { tolerance: critical.tolerance, decision: critical.decision, rung };
            Some(self.case((form, precision), Some(margin), critical.offset.clone(), changed))
        });
        Some(cases.collect())
    }

    /// A critical value of one tolerance, and the set it was found with; off no perturbed base an exact one if some tries
    /// meet one, for only there is a tie, and best one that f32 holds, for only there does the tie survive in a float.
    fn critical(
        &mut self,
        set: &NamedSet,
        precision: Precision,
        tolerance: &'static str,
    ) -> Option<(NamedSet, Critical)> {
        let revised = set.of(precision).criteria == Criteria::Revised;
        let steep = !self.perturbed && revised && LENGTHS.contains(&tolerance) && self.sampler.chance(60);
        let set = if steep { tolerance_sets::steep(set, &self.base.a, &self.base.b) } else { set.clone() };
        let kind = self.sampler.below(ladder::KINDS);
        let found = self.nearest_to_exact(set.of(precision), (tolerance, kind))?;
        Some((set, found))
    }

    /// The first critical value that is exact and that f32 holds, or else the first that is exact, or the first.
    fn nearest_to_exact(&mut self, set: &ToleranceSet, sought: (&'static str, u64)) -> Option<Critical> {
        let base = self.base;
        let pair = LadderPair::new((&base.a, &base.b), set, sought);
        let mut found: Option<Critical> = None;
        for _ in 0..if self.perturbed { 3 } else { EXACT_TRIES } {
            let Some(next) = ladder::critical(self.sampler, &pair) else { continue };
            if self.perturbed || (next.exact && next.value.is_exact_in(Precision::F32)) {
                return Some(next);
            }
            if found.as_ref().is_none_or(|f| next.exact && !f.exact) {
                found = Some(next);
            }
        }
        found
    }

    /// Random moves: of the order of a tolerance, or of a few steps of a number format.
    fn moved(&mut self, room: usize) -> Vec<PairCase> {
        (0..room)
            .map(|_| {
                let set = self.set();
                let precision = self.precision();
                let spacing = directed::f64_view::quantum(self.magnitude, precision);
                let reach = set.f64.search.approximate();
                let range = match self.sampler.below(3) {
                    0 => 4,
                    1 => 1 << self.sampler.between(3, 10),
                    _ => ((2.0 * reach / spacing) as i128).clamp(4, 1 << 50),
                };
                let one_axis = self.sampler.chance(40).then(|| self.sampler.below(3) as usize);
                let offset = [0, 1, 2].map(|axis| {
                    let steps = self.sampler.between(-range, range);
                    let metres = if one_axis.is_none_or(|a| a == axis) { steps as f64 * spacing } else { 0.0 };
                    Number::from_f64(metres).unwrap_or(Number::ZERO)
                });
                self.case((PairForm::Moved, precision), None, Some(offset), set)
            })
            .collect()
    }
}
