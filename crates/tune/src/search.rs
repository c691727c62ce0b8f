//! Which candidate comes next, and which is the best.

use super::TuneError;
use super::candidate::{ModelLengths, SetParameters};
use super::evaluator::{Evaluator, Measurement};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_model::tolerance_rules::Rule;
use rockproof_model::{Preset, ToleranceSet, ToleranceSpec};
use rockproof_pairs::families::{CoordinateStyle, PairSampler};
use serde::{Deserialize, Serialize};

/// Draws before a candidate is taken although it breaks a rule or was there before.
const TRIES: usize = 200;

/// Candidates that are put to the lockstep although as many as a quarter of all have been.
const LOCKSTEPS: usize = 4;

/// Where a candidate comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandidateOrigin {
    /// What the author uses now.
    Author,
    /// What the author uses, with as little changed as the rules ask for.
    Repaired,
    /// The same with what docs/rules_of_thumb.md proposes.
    RuleOfThumb,
    /// A preset.
    Preset(Preset),
    /// Drawn at random.
    Random,
    /// The best so far with some parameters changed.
    Turned,
}

impl CandidateOrigin {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            CandidateOrigin::Author => "author",
            CandidateOrigin::Repaired => "mended",
            CandidateOrigin::RuleOfThumb => "thumb",
            CandidateOrigin::Preset(preset) => preset.name(),
            CandidateOrigin::Random => "drawn",
            CandidateOrigin::Turned => "turned",
        }
    }
}

/// A candidate and what was measured of it.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedCandidate {
    /// Where it comes from.
    pub origin: CandidateOrigin,
    /// The set.
    pub set: ToleranceSet,
    /// Its place on the scales of the search; none for sets from outside.
    pub parameters: Option<SetParameters>,
    /// What was measured.
    pub measurement: Measurement,
}

/// How a search of the same model, author and seed has a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum SetRecipe {
    /// One of those that are tried first.
    Given(usize),
    Drawn(SetParameters),
}

impl PendingCandidate {
    /// How to have the set of this candidate, whose number is told.
    pub(super) fn recipe(&self, number: usize) -> SetRecipe {
        self.parameters.map_or(SetRecipe::Given(number), SetRecipe::Drawn)
    }
}

/// A search over tolerance sets.
pub struct Search<'w> {
    evaluator: &'w Evaluator,
    model: ModelLengths,
    seed: u64,
    first: Vec<(CandidateOrigin, ToleranceSet)>,
    absent: Vec<(Preset, AbsentPreset)>,
    evaluated: Vec<EvaluatedCandidate>,
}

/// Why a preset is no candidate.
#[derive(Clone, Debug, PartialEq)]
pub enum AbsentPreset {
    /// It is the set of an earlier candidate.
    Same(usize),
    /// It cannot be had for these blocks, as this says.
    Refused(String),
}

/// A candidate that is still to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct PendingCandidate {
    /// Where it comes from.
    pub origin: CandidateOrigin,
    /// The set.
    pub set: ToleranceSet,
    /// Its place on the scales.
    pub parameters: Option<SetParameters>,
}

impl<'w> Search<'w> {
    /// A search that begins with the author's set, the same repaired by the rules, the same by the rules of thumb, and the presets; none of them twice.
    ///
    /// # Errors
    /// When the author's set cannot be derived.
    pub fn new(evaluator: &'w Evaluator, author: &ToleranceSpec, seed: u64) -> Result<Search<'w>, TuneError> {
        let shapes = evaluator.scene().shapes();
        let precision = evaluator.precision();
        let model = ModelLengths::of(&shapes, precision).map_err(rockproof_model::SpecError::from)?;
        let author = author.derive(&shapes, precision)?;
        let repaired =
            if evaluator.broken_rules(&author).is_empty() { author.clone() } else { model.repaired(&author) };
        let thumbs = [false, true]
            .map(|territory| (CandidateOrigin::RuleOfThumb, model.by_rules_of_thumb(&repaired, territory)));
        let mut first: Vec<(CandidateOrigin, ToleranceSet)> = vec![(CandidateOrigin::Author, author)];
        for (origin, set) in [(CandidateOrigin::Repaired, repaired)].into_iter().chain(thumbs) {
            if first.iter().all(|(_, known)| *known != set) {
                first.push((origin, set));
            }
        }
        let mut absent = Vec::new();
        for preset in Preset::ALL {
            match ToleranceSpec::from(preset).derive(&shapes, precision) {
                Err(why) => absent.push((preset, AbsentPreset::Refused(why.to_string()))),
                Ok(set) => match first.iter().position(|(_, known)| *known == set) {
                    Some(same) => absent.push((preset, AbsentPreset::Same(same))),
                    None => first.push((CandidateOrigin::Preset(preset), set)),
                },
            }
        }
        Ok(Search { evaluator, model, seed, first, absent, evaluated: Vec::new() })
    }

    /// The presets that are no candidates of their own, and why.
    pub fn absent(&self) -> &[(Preset, AbsentPreset)] {
        &self.absent
    }

    /// Candidates that are tried before any is drawn.
    pub fn initial_count(&self) -> usize {
        self.first.len()
    }

    /// The next candidate: a function of the seed and of what was measured so far.
    pub fn candidate(&self) -> PendingCandidate {
        self.candidate_after(std::iter::empty())
    }

    /// The candidate after the next ones, which are still to be measured, if none of these is the best.
    pub(super) fn candidate_after<'a>(
        &self,
        ahead: impl Iterator<Item = &'a PendingCandidate> + Clone,
    ) -> PendingCandidate {
        let number = self.evaluated.len() + ahead.clone().count();
        if let Some((origin, set)) = self.first.get(number) {
            return PendingCandidate { origin: *origin, set: set.clone(), parameters: None };
        }
        let mut key = *b"rockproof tuner, version 1......";
        key[24..].copy_from_slice(&self.seed.to_le_bytes());
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(number as u64);
        let mut sampler = PairSampler::with_style(&mut rng, CoordinateStyle::Grid);
        let best = self.best().map(|best| &self.evaluated[best]);
        let best = best.map(|best| best.parameters.unwrap_or_else(|| SetParameters::nearest(&best.set, &self.model)));
        // One in three looks elsewhere.
        let origin =
            if best.is_none() || number.is_multiple_of(3) { CandidateOrigin::Random } else { CandidateOrigin::Turned };
        let mut draw = || match best {
            Some(best) if origin == CandidateOrigin::Turned => best.mutated(&mut sampler),
            _ => SetParameters::random(&mut sampler),
        };
        let mut parameters = draw();
        for _ in 0..TRIES {
            let evaluated = self.evaluated.iter().map(|evaluated| evaluated.parameters);
            let mut known = evaluated.chain(ahead.clone().map(|candidate| candidate.parameters));
            if known.all(|other| other != Some(parameters))
                && self.evaluator.broken_rules(&parameters.set(&self.model)).is_empty()
            {
                break;
            }
            parameters = draw();
        }
        PendingCandidate { origin, set: parameters.set(&self.model), parameters: Some(parameters) }
    }

    /// Takes in what was measured of the next candidate.
    pub fn add(&mut self, next: PendingCandidate, measurement: Measurement) {
        let PendingCandidate { origin, set, parameters } = next;
        self.evaluated.push(EvaluatedCandidate { origin, set, parameters, measurement });
    }

    /// Measures the next candidate and takes it in.
    ///
    /// # Errors
    /// When it cannot be measured.
    pub fn step(&mut self) -> Result<&EvaluatedCandidate, TuneError> {
        let next = self.candidate();
        let mut measurement = self.evaluator.measure(&next.set)?;
        if self.may_be_best(&measurement) {
            measurement.lockstep = Some(self.evaluator.lockstep(&next.set)?);
        }
        self.add(next, measurement);
        Ok(&self.evaluated[self.evaluated.len() - 1])
    }

    /// Whether the oracle is asked about the steps of the next candidate, which takes much longer than all else: always for the first; later if it is better
    /// than the best so far in what is cheap, or no worse in pairs and rules where the steps of the best differ from the oracle's; and no more often than
    /// for a quarter of all candidates, but for the first that loses no pair of the model, the first whose steps do not stop, and the first without unseen overlaps in
    /// steps: a set that is worse in these is never the best beside it.
    pub(super) fn may_be_best(&self, measurement: &Measurement) -> bool {
        let Some(best) = self.best().map(|best| &self.evaluated[best].measurement) else { return true };
        if measurement.passing() < best.passing() {
            return true;
        }
        let lockstep = self.evaluated.iter().filter(|evaluated| evaluated.measurement.lockstep.is_some()).count();
        if lockstep >= LOCKSTEPS + self.evaluated.len() / 4 {
            return false;
        }
        let (new, old) = (measurement.screened(), best.screened());
        let faulty = best.lockstep.as_ref().is_some_and(|lockstep| lockstep.failed + lockstep.differ > 0);
        new < old || (faulty && new.is_no_worse_before_sinking(&old))
    }

    /// What measures.
    pub(super) fn evaluator(&self) -> &'w Evaluator {
        self.evaluator
    }

    /// The set of candidate `number`, as [`PendingCandidate::recipe`] tells it.
    pub(super) fn set_of(&self, recipe: SetRecipe) -> Option<ToleranceSet> {
        match recipe {
            SetRecipe::Given(number) => self.first.get(number).map(|(_, set)| set.clone()),
            SetRecipe::Drawn(parameters) => Some(parameters.set(&self.model)),
        }
    }

    /// All candidates measured, in order.
    pub fn tried(&self) -> &[EvaluatedCandidate] {
        &self.evaluated
    }

    /// The number of the best candidate of those whose steps the oracle was asked about, the first of equals; `None` before the first.
    pub fn best(&self) -> Option<usize> {
        let lockstep = (0..self.evaluated.len()).filter(|&k| self.evaluated[k].measurement.lockstep.is_some());
        lockstep.min_by_key(|&k| self.evaluated[k].measurement.merit())
    }

    /// The best candidate, then those that no other beats in all of: pairs that differ, sinking, slack to the nearest rule, length of a step, contacts
    /// changed by tolerances; by pairs that differ, then sinking. All keep every rule and make every step, and none loses a pair of the model, or lets one overlap
    /// unseen, if the best does not.
    pub fn front(&self) -> Vec<usize> {
        let of_best = self.best().map_or([true; 3], |best| self.evaluated[best].measurement.passing());
        let no_worse = |own: [bool; 3]| own.iter().zip(of_best).all(|(own, best)| *own <= best);
        let fine: Vec<usize> = (0..self.evaluated.len())
            .filter(|&k| {
                let m = &self.evaluated[k].measurement;
                m.violated.is_empty() && m.steps_measured.stopped.is_none() && no_worse(m.passing())
            })
            .collect();
        let costs = |k: usize| {
            let m = &self.evaluated[k].measurement;
            let d = &m.differences;
            let step_limit = self.evaluated[k].set.max_displacement.approximate();
            [d.avoidable() as f64, m.steps_measured.overlaps.sunk, -m.tightest.factor, d.changed as f64, -step_limit]
        };
        let beaten = |k: usize| {
            fine.iter().any(|&other| {
                let (one, by) = (costs(k), costs(other));
                let no_worse = one.iter().zip(&by).all(|(a, b)| b <= a);
                no_worse && (one != by || other < k)
            })
        };
        let is_best = |k: usize| self.best() == Some(k);
        let mut front: Vec<usize> = fine.iter().copied().filter(|&k| is_best(k) || !beaten(k)).collect();
        front.sort_by(|&a, &b| {
            let (one, other) = (costs(a), costs(b));
            let first = is_best(b).cmp(&is_best(a));
            first.then(one[0].total_cmp(&other[0])).then(one[1].total_cmp(&other[1])).then(a.cmp(&b))
        });
        front
    }
}

/// The rules as a list of their formulas.
pub(super) fn formulas(rules: &[Rule]) -> String {
    rules.iter().map(|rule| rule.formula()).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LockstepMeasures, StepMeasures, UnseenOverlaps};
    use rockproof_bench::stepping::wall;
    use rockproof_model::Precision;

    /// The first set lets blocks overlap unseen, and so do others that the oracle is asked about until it is asked no more: but for one under which
    /// none does. That is the best then, and no trade-off is one that does.
    #[test]
    fn the_first_set_without_unseen_overlaps_is_always_put_to_the_oracle() {
        let scene = wall(4).expect("a wall");
        let evaluator = Evaluator::new(&scene, Precision::F64, 1, Some(1), 0).expect("an evaluator");
        let mut search = Search::new(&evaluator, &ToleranceSpec::default(), 1).expect("a search");
        let measured = evaluator.measure(&search.candidate().set).expect("measures");
        let lockstep = evaluator.lockstep(&search.candidate().set).expect("steps");
        let unseen = UnseenOverlaps { steps: 1, most_pairs: 1, deepest: 0.01 };
        let passing = |differ: u64| {
            let mut passing = measured.clone();
            passing.steps_measured.unseen = unseen;
            passing.differences.standing[1] = differ;
            passing
        };
        for differ in (0..19).rev() {
            let next = search.candidate();
            let mut measurement = passing(differ);
            measurement.lockstep = search.may_be_best(&measurement).then(|| lockstep.clone());
            search.add(next, measurement);
        }
        assert!(!search.may_be_best(&passing(0)), "the oracle is asked no more");
        // Worse in pairs, which come after.
        let mut whole = measured.clone();
        whole.differences.standing[1] = 30;
        assert!(search.may_be_best(&whole));
        whole.lockstep = Some(lockstep);
        assert!(search.front().len() > 1);
        search.add(search.candidate(), whole);
        assert_eq!((search.best(), search.front()), (Some(19), vec![19]));
    }

    /// A set whose steps stop at once has nothing that could overlap in them: it is not the best beside one that makes all, nor a trade-off, however few pairs differ.
    #[test]
    fn a_set_whose_steps_stop_is_not_the_best_beside_one_that_makes_them() {
        let scene = wall(4).expect("a wall");
        let evaluator = Evaluator::new(&scene, Precision::F64, 1, Some(1), 0).expect("an evaluator");
        let mut search = Search::new(&evaluator, &ToleranceSpec::default(), 1).expect("a search");
        let mut made = evaluator.measure(&search.candidate().set).expect("measures");
        let lockstep = evaluator.lockstep(&search.candidate().set).expect("steps");
        made.steps_measured.unseen = UnseenOverlaps { steps: 1, most_pairs: 1, deepest: 0.01 };
        made.differences.standing[1] = 9;
        let mut stopped = made.clone();
        stopped.steps_measured = StepMeasures { stopped: Some("step 1".to_owned()), ..StepMeasures::default() };
        stopped.differences.standing[1] = 0;
        for _ in 0..LOCKSTEPS + 2 {
            let next = search.candidate();
            assert_eq!(search.may_be_best(&stopped), search.tried().is_empty());
            search.add(next, Measurement { lockstep: Some(LockstepMeasures::default()), ..stopped.clone() });
        }
        assert_eq!((search.best(), search.front()), (Some(0), vec![]));
        assert!(search.may_be_best(&made), "the first that makes its steps");
        made.lockstep = Some(lockstep);
        search.add(search.candidate(), made);
        assert_eq!((search.best(), search.front()), (Some(LOCKSTEPS + 2), vec![LOCKSTEPS + 2]));
    }
}
