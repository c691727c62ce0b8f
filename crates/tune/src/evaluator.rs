//! What a candidate is worth: the rules, the pairs, and the steps.

use super::TuneError;
use super::cluster::{self, Cluster};
use super::given_overlaps::{GivenOverlap, GivenOverlaps, Share};
use super::probes::{Differences, Probes};
use super::steps::{InitialOverlaps, LockstepMeasures, StepMeasures, measure_lockstep, measure_steps};
use rockproof_differential::builtin::{ENGINES, StepperEngine};
use rockproof_differential::engine::Engine;
use rockproof_model::preset::{self, Preset};
use rockproof_model::tolerance_rules::{self, MeasuredModel, Rule, RuleSlack};
use rockproof_model::{Precision, Scene, SpecError, ToleranceSet};
use rockproof_stepper::contact::SpecRules;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;

/// Everything measured of one set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// The rules that are not met.
    pub violated: Vec<Rule>,
    /// The rule that is nearest to be broken.
    pub tightest: RuleSlack,
    /// Pairs of the model as given that overlap deeper than `penetration`, or by more than rounding where no contact sees it.
    pub lost_pairs: u64,
    /// Where engine and oracle differ.
    pub differences: Differences,
    /// What steps came to.
    pub steps_measured: StepMeasures,
    /// What the oracle says of these steps; only of candidates that may be the best.
    pub lockstep: Option<LockstepMeasures>,
}

/// The order of merit: the first field that differs decides, and smaller is better. What has a sample or a range counts in steps, so that what comes
/// after it has a say.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Merit {
    /// Whether pairs of the model as given are lost.
    loses_pairs: bool,
    /// Where steps stop, how many were made, in powers of two: the more the better. After the last step anything may come, and nothing was measured.
    pub(super) stopped: Option<Reverse<u32>>,
    /// The deepest overlap that no contact sees after a step, in powers of two; 0 where there is none.
    pub(super) unseen: u64,
    /// Rules broken.
    violated: usize,
    /// Whether blocks sink deeper than `penetration`.
    is_deep: bool,
    /// Pairs that differ as they stand.
    standing: u64,
    /// Pairs moved that differ, in steps of twice the root, which is what chance makes of such a count.
    moved: u64,
    /// Steps that one side could not make, one more where the scene stops at a step that does not converge.
    failed: u64,
    /// The share of contacts that differ in steps from the oracle's, in themselves or in their mode, in sixteenths. A share and no count, since a
    /// set under which fewer contacts are found has fewer that can differ.
    share: u64,
    /// Steps that did not converge.
    unconverged: u64,
    /// The most by which a pair sinks, in sixteenths.
    sunk: u64,
    /// Slack to the nearest rule, in sixteenths.
    slack: Reverse<u64>,
    /// Pairs that differ on a boundary.
    boundary: u64,
}

impl Merit {
    /// Whether it is as good as another in all that is cheap and comes before how far blocks sink.
    pub(super) fn is_no_worse_before_sinking(&self, other: &Merit) -> bool {
        let key = |m: &Merit| {
            (
                m.loses_pairs,
                m.stopped,
                m.unseen,
                m.violated,
                m.is_deep,
                [m.standing, m.moved],
                [m.failed, m.share, m.unconverged],
            )
        };
        key(self) <= key(other)
    }
}

impl Measurement {
    /// What decides between two sets.
    pub(super) fn merit(&self) -> Merit {
        // The leading digits of a positive f64, in order: sign, exponent and four binary digits.
        let coarse = |value: f64| value.max(0.0).to_bits() >> 48;
        let made = &self.steps_measured;
        let failed = self.lockstep.as_ref().map_or(0, |lockstep| lockstep.failed);
        let d = &self.differences;
        Merit {
            loses_pairs: self.lost_pairs > 0,
            stopped: made.stopped.is_some().then(|| Reverse(u64::BITS - made.made().leading_zeros())),
            // Sign and exponent, behind 0 for none.
            unseen: u64::from(made.unseen.steps > 0) + (made.unseen.deepest.to_bits() >> 52),
            violated: self.violated.len(),
            is_deep: made.deep > 0,
            standing: d.standing[1],
            moved: (4 * (d.moved[1] + d.near[1])).isqrt(),
            failed: failed + u64::from(made.refused > 0),
            share: coarse(self.lockstep.as_ref().map_or(0.0, LockstepMeasures::share)),
            unconverged: made.unconverged,
            sunk: coarse(made.overlaps.sunk),
            slack: Reverse(coarse(self.tightest.factor)),
            boundary: d.boundary[1],
        }
    }

    /// Whether blocks pass through one another, or may: pairs of the model are lost as given, the steps stop, or pairs overlap unseen after a step.
    pub(super) fn passing(&self) -> [bool; 3] {
        let made = &self.steps_measured;
        [self.lost_pairs > 0, made.stopped.is_some(), made.unseen.steps > 0]
    }

    /// Whether blocks pass through one another, sink so deep that they may, or cannot be stepped to the end: the model is not safe under the set, whatever else is
    /// right.
    pub fn is_unsafe(&self) -> bool {
        self.passing() != [false; 3] || self.steps_measured.deep > 0
    }

    /// The same without what the oracle says of steps.
    pub(super) fn screened(&self) -> Merit {
        Measurement { lockstep: None, ..self.clone() }.merit()
    }

    /// Whether the search prefers this to another, of which the oracle was asked about the steps as well.
    pub fn is_better_than(&self, other: &Measurement) -> bool {
        self.lockstep.is_some() && self.merit() < other.merit()
    }

    /// Whether nothing is wrong with the set: every rule kept, no pair of the model lost, no pair that differs but for those on a boundary, no step that
    /// differs, none after which a pair overlaps unseen or blocks have sunk deeper than `penetration`, none that cannot be made, and none that does not converge where
    /// the scene stops at it.
    pub fn is_clean(&self) -> bool {
        let steps = self.lockstep.as_ref().is_some_and(|lockstep| lockstep.failed + lockstep.differ == 0);
        let made = &self.steps_measured;
        let holds = self.violated.is_empty() && !self.is_unsafe();
        holds && self.differences.avoidable() == 0 && made.refused == 0 && steps
    }
}

/// An evaluator that does not know yet which pairs of the model overlap: finding them may take longer than all else before the first candidate.
pub struct UnauditedEvaluator {
    evaluator: Evaluator,
    auto: ToleranceSet,
}

/// A scene made ready for measuring sets.
pub struct Evaluator {
    scene: Scene,
    precision: Precision,
    lengths: MeasuredModel,
    /// The pairs.
    pub probes: Probes,
    /// The part that is stepped.
    pub cluster: Cluster,
    initial: InitialOverlaps,
    given: GivenOverlaps,
    steps: u64,
    engine: Box<dyn Engine>,
}

impl UnauditedEvaluator {
    /// Makes a scene ready but for its overlaps; the seed chooses pairs. `steps` are those of the part for every candidate, after its settling; `None` for as many as
    /// a budget of so many seconds allows.
    ///
    /// # Errors
    /// When there is nothing to measure, or the scene does not fit the precision.
    pub fn new(
        scene: &Scene,
        precision: Precision,
        seed: u64,
        steps: Option<u64>,
        budget: u64,
    ) -> Result<UnauditedEvaluator, TuneError> {
        if let Some(block) = scene.blocks.iter().find(|block| block.block.rounded(precision).is_none()) {
            return Err(TuneError::Overflow { what: format!("a coordinate of block \"{}\"", block.name), precision });
        }
        let probes = Probes::of(scene, precision, seed)?;
        let auto = preset::derive(Preset::Auto, &scene.shapes(), precision).map_err(SpecError::from)?;
        let cluster = Cluster::of(scene, &cluster::neighbours(scene), &auto);
        let engine: Box<dyn Engine> = match precision {
            Precision::F32 => Box::new(StepperEngine::<f32, SpecRules>::f32(ENGINES[0])),
            Precision::F64 => Box::new(StepperEngine::<f64, SpecRules>::f64(ENGINES[1])),
        };
        let lengths = MeasuredModel::of(&scene.shapes());
        let (initial, steps) =
            (InitialOverlaps::of(&cluster.scene, precision), steps.unwrap_or_else(|| cluster.steps_for(budget)));
        let (given, scene) = (GivenOverlaps::none_of(&scene.shapes()), scene.clone());
        let evaluator = Evaluator { scene, precision, lengths, probes, cluster, initial, given, steps, engine };
        Ok(UnauditedEvaluator { evaluator, auto })
    }

    /// Steps of the part for every candidate, after its settling.
    pub fn steps(&self) -> u64 {
        self.evaluator.steps
    }

    /// Finds the pairs that overlap.
    pub fn audited(self) -> Evaluator {
        let overlaps = self.overlaps(Share::WHOLE);
        self.with(overlaps)
    }

    /// Those of a share of the pairs.
    pub(super) fn overlaps(&self, share: Share) -> Vec<GivenOverlap> {
        self.evaluator.given.found(&self.evaluator.scene.shapes(), &self.auto, share)
    }

    /// The evaluator, told which pairs overlap.
    pub(super) fn with(mut self, overlaps: Vec<GivenOverlap>) -> Evaluator {
        self.evaluator.given.add(overlaps);
        self.evaluator
    }

    /// How many blocks the model has.
    pub(super) fn blocks(&self) -> usize {
        self.evaluator.given.blocks()
    }
}

impl Evaluator {
    /// Makes a scene ready, as [`UnauditedEvaluator::new`], and finds its overlaps.
    ///
    /// # Errors
    /// As [`UnauditedEvaluator::new`].
    pub fn new(
        scene: &Scene,
        precision: Precision,
        seed: u64,
        steps: Option<u64>,
        budget: u64,
    ) -> Result<Evaluator, TuneError> {
        Ok(UnauditedEvaluator::new(scene, precision, seed, steps, budget)?.audited())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The precision of the engine.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Steps of the part for every candidate, after its settling.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Pairs of the model as given that overlap by more than rounding.
    pub fn overlapping(&self) -> u64 {
        self.given.count()
    }

    /// The rules about lengths and angles that a set breaks; the one on stiffness is left to [`Evaluator::measure`].
    pub fn broken_rules(&self, set: &ToleranceSet) -> Vec<Rule> {
        self.lengths.check(set, self.precision).into_iter().map(|violation| violation.rule).collect()
    }

    /// Measures a set, but for what the oracle says of steps.
    ///
    /// # Errors
    /// When a tolerance overflows in the precision, or the part cannot be set up.
    pub fn measure(&self, set: &ToleranceSet) -> Result<Measurement, TuneError> {
        let scene = self.stiff(set);
        let mut slacks = self.lengths.slacks(set, self.precision);
        slacks.extend(tolerance_rules::stiffness_slack(set, &scene));
        let violated = slacks.iter().filter(|slack| slack.factor < 1.0).map(|slack| slack.rule);
        let mut violated: Vec<Rule> = violated.chain(self.broken_rules(set)).collect();
        violated.sort_unstable();
        violated.dedup();
        // There are always the rules between tolerances.
        let none = RuleSlack { rule: Rule::Search, factor: f64::INFINITY };
        let tightest = slacks.into_iter().min_by(|a, b| a.factor.total_cmp(&b.factor)).unwrap_or(none);
        let differences = self
            .probes
            .compare(set, &*self.engine)
            .map_err(|name| TuneError::Overflow { what: format!("tolerance `{name}`"), precision: self.precision })?;
        let (part, unconverged) = (self.part(&scene), scene.simulation.control.unconverged);
        let part = (&part, &*self.cluster.members);
        let steps_measured = match self.precision {
            Precision::F32 => {
                measure_steps::<f32>(part, (set, self.precision), &self.initial, self.steps, unconverged)?
            }
            Precision::F64 => {
                measure_steps::<f64>(part, (set, self.precision), &self.initial, self.steps, unconverged)?
            }
        };
        let lost_pairs = self.given.lost(set);
        Ok(Measurement { violated, tightest, lost_pairs, differences, steps_measured, lockstep: None })
    }

    /// Asks the oracle about the steps of a set.
    ///
    /// # Errors
    /// When a number of the scene overflows in the precision, or the part cannot be set up.
    pub fn lockstep(&self, set: &ToleranceSet) -> Result<LockstepMeasures, TuneError> {
        let part = self.part(&self.stiff(set));
        match self.precision {
            Precision::F32 => measure_lockstep::<f32>(&part, set, self.precision, &self.initial, self.steps),
            Precision::F64 => measure_lockstep::<f64>(&part, set, self.precision, &self.initial, self.steps),
        }
    }

    /// A scene whose joints have stiffnesses: those that suit a set where the scene names none.
    fn stiff(&self, set: &ToleranceSet) -> Scene {
        let mut scene = self.scene.clone();
        scene.derive_stiffness(set);
        scene
    }

    /// The part with the joints of the whole scene.
    fn part(&self, scene: &Scene) -> Scene {
        let mut part = self.cluster.scene.clone();
        part.simulation.joints = scene.simulation.joints.clone();
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps::Overlaps;
    use crate::unseen_overlaps::UnseenOverlaps;

    fn flawless() -> Measurement {
        Measurement {
            violated: Vec::new(),
            tightest: RuleSlack { rule: Rule::Search, factor: 2.0 },
            lost_pairs: 0,
            differences: Differences::default(),
            steps_measured: StepMeasures::default(),
            lockstep: Some(LockstepMeasures::default()),
        }
    }

    fn with_unseen(deepest: f64) -> Measurement {
        let unseen = UnseenOverlaps { steps: 1, most_pairs: 1, deepest };
        Measurement { steps_measured: StepMeasures { unseen, ..StepMeasures::default() }, ..flawless() }
    }

    /// Steps that stop after so many, of which so many leave a pair that overlaps unseen.
    fn with_stop(steps: u64, unseen: u64) -> Measurement {
        let unseen = UnseenOverlaps { steps: unseen, most_pairs: unseen, deepest: unseen as f64 };
        let stopped = Some("step 3: a number of block 1 is not finite".to_owned());
        Measurement { steps_measured: StepMeasures { stopped, steps, unseen, ..StepMeasures::default() }, ..flawless() }
    }

    fn with_deep() -> Measurement {
        Measurement { steps_measured: StepMeasures { deep: 1, ..StepMeasures::default() }, ..flawless() }
    }

    /// In this order, best first: nothing wrong; all wrong that is no matter of safety; sunk deep; a rule broken; unseen overlaps, of which only a depth
    /// of another power of two makes a difference; steps that stop, the earlier the worse, of which only another power of two makes a difference; pairs lost as given.
    #[test]
    fn a_model_that_holds_together_comes_before_pairs_and_rules() {
        let differing = Measurement {
            differences: Differences { standing: [9, 9], moved: [9, 9], ..Differences::default() },
            steps_measured: StepMeasures {
                refused: 3,
                overlaps: Overlaps { deepest: 1.0, sunk: 1.0 },
                ..StepMeasures::default()
            },
            ..flawless()
        };
        let breaking = Measurement { violated: vec![Rule::Search; 3], ..flawless() };
        let lost = Measurement { lost_pairs: 1, ..flawless() };
        let mut order = vec![flawless(), differing, with_deep(), breaking, with_unseen(1e-3), with_unseen(1e-2)];
        order.extend([with_stop(15, 0), with_stop(8, 1), with_stop(7, 0), with_stop(1, 1), with_stop(0, 0), lost]);
        for [better, worse] in order.windows(2).filter_map(|pair| pair.first_chunk()) {
            assert!(better.is_better_than(worse) && !worse.is_better_than(better), "{better:?} {worse:?}");
        }
        assert_eq!(with_unseen(1.0).merit(), with_unseen(1.9).merit());
        let of_no_depth = Measurement { lockstep: None, ..with_unseen(f64::MIN_POSITIVE / 2.0) };
        assert!(flawless().is_better_than(&of_no_depth));
    }

    #[test]
    fn no_set_is_clean_under_which_blocks_pass_through_one_another() {
        assert!(flawless().is_clean() && !flawless().is_unsafe());
        let lost = Measurement { lost_pairs: 1, ..flawless() };
        for passing in [with_unseen(1e-9), with_deep(), with_stop(0, 0), with_stop(40, 0), lost] {
            assert!(passing.is_unsafe() && !passing.is_clean(), "{passing:?}");
        }
    }
}
