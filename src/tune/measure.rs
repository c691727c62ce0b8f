//! What a candidate is worth: the rules, the pairs, and the steps.

use super::TuneError;
use super::cluster::{self, Cluster};
use super::probes::{Differences, Probes};
use crate::campaign::attribution::Panel;
use crate::campaign::builtin;
use crate::model::rules::{self, Measured, Rule, Slack};
use crate::model::simulation::derive_stiffness;
use crate::model::{Block, Number, Precision, Scene, ToleranceSet, Vec3};
use crate::oracle::penetration::penetration;
use crate::stepper::dynamics::{Dynamics, Solve};

/// Steps of the cluster for every candidate, after its settling.
pub(super) const STEPS: u64 = 16;

/// What steps under a set came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stepped {
    /// Steps made, settling not counted.
    pub steps: u64,
    /// The exact depth of the deepest overlap of two convex blocks after the last step (m), one of them free to move.
    pub penetration: f64,
    /// Steps accepted without converging.
    pub unconverged: u64,
    /// Attempts given up.
    pub retries: u64,
    /// Why the run stopped, if it did.
    pub stopped: Option<String>,
}

/// Everything measured of one set.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The rules that are not met.
    pub violated: Vec<Rule>,
    /// The rule that is nearest to be broken.
    pub tightest: Slack,
    /// Where engine and oracle differ.
    pub differences: Differences,
    /// What steps came to.
    pub stepped: Stepped,
}

/// The order of merit; smaller is better. See [`Measurement::merit`].
pub(super) type Merit = (usize, u64, bool, u64, u64, std::cmp::Reverse<u64>, u64);

impl Measurement {
    /// Rules broken, pairs that differ, a run that stopped, steps that did not converge, penetration, slack to the nearest rule, pairs that
    /// differ on a boundary. Penetration and slack count in steps of a sixteenth, so that what comes after them has a say.
    pub(super) fn merit(&self) -> Merit {
        // The leading digits of a positive f64, in order: sign, exponent and four binary digits.
        let coarse = |value: f64| value.max(0.0).to_bits() >> 48;
        (
            self.violated.len(),
            self.differences.avoidable(),
            self.stepped.stopped.is_some(),
            self.stepped.unconverged,
            coarse(self.stepped.penetration),
            std::cmp::Reverse(coarse(self.tightest.factor)),
            self.differences.boundary[1],
        )
    }
}

/// A scene made ready for measuring sets.
pub struct Workbench {
    scene: Scene,
    precision: Precision,
    lengths: Measured,
    /// The pairs.
    pub probes: Probes,
    /// The part that is stepped.
    pub cluster: Cluster,
    panel: Panel,
}

impl Workbench {
    /// Makes a scene ready; the seed chooses pairs.
    ///
    /// # Errors
    /// When there is nothing to measure, or the scene does not fit the precision.
    pub fn new(scene: &Scene, precision: Precision, seed: u64) -> Result<Workbench, TuneError> {
        if let Some(block) = scene.blocks.iter().find(|block| block.block.rounded(precision).is_none()) {
            return Err(TuneError::Overflow { what: format!("a coordinate of block \"{}\"", block.name), precision });
        }
        let probes = Probes::of(scene, seed)?;
        let cluster = Cluster::of(scene, &cluster::neighbours(scene));
        let name = match precision {
            Precision::F32 => builtin::ENGINES[0],
            Precision::F64 => builtin::ENGINES[1],
        };
        let engines = builtin::engine(name).into_iter().collect();
        let panel = Panel { oracle: Box::new(builtin::Exact), engines, metamorphic_every: 0 };
        let lengths = Measured::of(&scene.shapes());
        Ok(Workbench { scene: scene.clone(), precision, lengths, probes, cluster, panel })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The precision of the engine.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// The rules about lengths and angles that a set breaks; the one on stiffness is left to [`Workbench::measure`].
    pub fn broken(&self, set: &ToleranceSet) -> Vec<Rule> {
        self.lengths.check(set, self.precision).into_iter().map(|violation| violation.rule).collect()
    }

    /// Measures a set.
    ///
    /// # Errors
    /// When a tolerance overflows in the precision, or the part cannot be set up.
    pub fn measure(&self, set: &ToleranceSet) -> Result<Measurement, TuneError> {
        set.rounded(self.precision)
            .map_err(|name| TuneError::Overflow { what: format!("tolerance `{name}`"), precision: self.precision })?;
        let mut scene = self.scene.clone();
        let bodies: Vec<_> = self.scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
        derive_stiffness(&mut scene.simulation, &bodies, set);
        let mut slacks = self.lengths.slacks(set, self.precision);
        slacks.extend(rules::stiffness_slack(set, &scene));
        let violated = slacks.iter().filter(|slack| slack.factor < 1.0).map(|slack| slack.rule);
        let mut violated: Vec<Rule> = violated.chain(self.broken(set)).collect();
        violated.sort_unstable();
        violated.dedup();
        // There are always the rules between tolerances.
        let none = Slack { rule: Rule::Search, factor: f64::INFINITY };
        let tightest = slacks.into_iter().min_by(|a, b| a.factor.total_cmp(&b.factor)).unwrap_or(none);
        let differences = self.probes.compare(set, &self.panel);
        let mut part = self.cluster.scene.clone();
        part.simulation.joints = scene.simulation.joints;
        let stepped = match self.precision {
            Precision::F32 => stepped::<f32>(&part, set)?,
            Precision::F64 => stepped::<f64>(&part, set)?,
        };
        Ok(Measurement { violated, tightest, differences, stepped })
    }
}

/// Steps the part and looks how deep its blocks overlap then.
fn stepped<R: Solve>(part: &Scene, set: &ToleranceSet) -> Result<Stepped, TuneError> {
    let mut dynamics = Dynamics::<R>::new(part, set)?;
    let mut found = Stepped::default();
    while found.steps < STEPS && found.stopped.is_none() {
        match dynamics.step() {
            Ok(report) => {
                found.steps = dynamics.state().step;
                found.unconverged += u64::from(!report.converged);
                found.retries += report.retries.len() as u64;
            }
            Err(error) => found.stopped = Some(error.to_string()),
        }
    }
    let placed = |(scene_block, state): (&crate::model::SceneBlock, &crate::stepper::dynamics::BlockState<R>)| {
        let number = |value: R| Number::from_f64(value.to_f64()).unwrap_or(Number::ZERO);
        let points = state.vertices.iter().map(|v| Vec3::new(number(v.x), number(v.y), number(v.z)));
        scene_block.block.with_vertices(points.collect())
    };
    let blocks: Vec<Block> = part.blocks.iter().zip(&dynamics.state().blocks).map(placed).collect();
    let is_fixed = |block: usize| part.blocks[block].body.is_fixed();
    for i in 0..blocks.len() {
        for j in i + 1..blocks.len() {
            if !(is_fixed(i) && is_fixed(j)) && boxes_overlap(&blocks[i], &blocks[j]) {
                let depth = penetration(&blocks[i], &blocks[j]).and_then(|found| found.depth_m());
                found.penetration = found.penetration.max(depth.unwrap_or(0.0));
            }
        }
    }
    Ok(found)
}

fn boxes_overlap(a: &Block, b: &Block) -> bool {
    let (a, b) = (a.bounds(), b.bounds());
    let below = |low: &Vec3<&Number>, high: &Vec3<&Number>| low.x < high.x && low.y < high.y && low.z < high.z;
    below(&a.min, &b.max) && below(&b.min, &a.max)
}
