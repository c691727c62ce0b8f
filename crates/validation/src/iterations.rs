//! How the open–close iteration ends, and how deep closed contacts are kept: over the energy suites and the scenes of `cases/handmade`. And what
//! cohesion and a load do to the energy of a pour.

use crate::energy::{DropScene, EnergyResult, EnergyRun, TIME_STEPS};
use crate::stepped_scene::{CaseFailure, SteppedScene, number, vector};
use rayon::prelude::*;
use rockproof_model::simulation::PointLoad;
use rockproof_model::{ContactKey, Motion, Precision, Scene, ToleranceSpec};
use rockproof_stepper::Vector;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Mode, RetryReason, StepReport, StepRules};
use std::collections::HashSet;
use std::path::PathBuf;

/// Steps made of each scene of `cases/handmade`, settling among them: those of the table of lockstep.
pub const HANDMADE_STEPS: u64 = 200;

/// What the steps of some runs come to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IterationCensus {
    /// Runs.
    pub runs: u64,
    /// Steps.
    pub steps: u64,
    /// Attempts at them.
    pub attempts: u64,
    /// Solves of all attempts.
    pub solves: u64,
    /// Attempts that end with their seventh solve in which no mode changes. Friction may have settled in that very solve, which would
    /// have ended them too.
    pub sevenths: u64,
    /// Attempts given up because modes changed: cuts of Δt to 0.3 of it.
    pub cuts: u64,
    /// Attempts given up because something moved too far: halvings of Δt.
    pub halvings: u64,
    /// Steps that were accepted unconverged.
    pub unconverged: u64,
    /// Contacts found, step by step, that are deeper than g and there only because the step before left them closed.
    pub beyond: u64,
    /// The deepest contact that was kept, as a share of g; above 1 it is one of `beyond`.
    pub deepest: f64,
}

impl IterationCensus {
    /// Both together.
    pub fn and(self, other: IterationCensus) -> IterationCensus {
        IterationCensus {
            runs: self.runs + other.runs,
            steps: self.steps + other.steps,
            attempts: self.attempts + other.attempts,
            solves: self.solves + other.solves,
            sevenths: self.sevenths + other.sevenths,
            cuts: self.cuts + other.cuts,
            halvings: self.halvings + other.halvings,
            unconverged: self.unconverged + other.unconverged,
            beyond: self.beyond + other.beyond,
            deepest: self.deepest.max(other.deepest),
        }
    }

    /// Steps a scene while `goes_on` says so, by the rules `M`.
    ///
    /// # Errors
    /// When a step cannot be made.
    pub fn of<M: StepRules>(
        scene: Scene,
        goes_on: impl Fn(&IterationCensus, f64) -> bool,
    ) -> Result<IterationCensus, CaseFailure> {
        let default = ToleranceSpec::default();
        let set = scene.tolerances.as_ref().unwrap_or(&default).derive(&scene.shapes(), Precision::F64)?;
        let limit = set.penetration.approximate();
        let mut stepped = SteppedScene::<f64, M>::new(scene)?;
        let mut census = IterationCensus { runs: 1, ..IterationCensus::default() };
        while goes_on(&census, stepped.time()) {
            let closed = closed(&stepped);
            let report = stepped.step()?.clone();
            census.add_step(&report);
            let unchanging = |attempt: &Vec<Vec<Mode>>| ends_unchanged(stepped.dynamics.first_modes(), attempt);
            census.sevenths += stepped.dynamics.modes().iter().filter(|attempt| unchanging(attempt)).count() as u64;
            census.solves += stepped.dynamics.modes().iter().map(|attempt| attempt.len() as u64).sum::<u64>();
            for contact in &stepped.dynamics.state().contacts {
                if closed.contains(&(contact.blocks, contact.key())) {
                    let depth = -contact.normal.dot(contact.points[0] - contact.points[1]) / limit;
                    census.beyond += u64::from(depth > 1.0);
                    census.deepest = census.deepest.max(depth);
                }
            }
        }
        Ok(census)
    }

    fn add_step(&mut self, report: &StepReport) {
        self.steps += 1;
        self.attempts += 1 + report.retries.len() as u64;
        let cuts = report.retries.iter().filter(|retry| retry.why == RetryReason::NotConverged).count() as u64;
        self.cuts += cuts;
        self.halvings += report.retries.len() as u64 - cuts;
        self.unconverged += u64::from(!report.converged);
    }
}

/// The contacts that the last step left closed.
fn closed<M: StepRules>(stepped: &SteppedScene<f64, M>) -> HashSet<([u32; 2], ContactKey)> {
    let contacts = stepped.dynamics.state().contacts.iter();
    contacts.filter(|contact| contact.mode.is_closed()).map(|contact| (contact.blocks, contact.key())).collect()
}

/// Whether an attempt ends with its seventh solve in which no mode changes; `modes` has those after each solve.
fn ends_unchanged(first: &[Mode], modes: &[Vec<Mode>]) -> bool {
    let before = std::iter::once(first).chain(modes.iter().map(Vec::as_slice));
    let same: Vec<bool> = before.zip(modes).map(|(before, after)| before == after).collect();
    same.last() == Some(&true) && same.iter().filter(|same| **same).count() >= SpecRules::unchanging_solves() as usize
}

/// The census of the energy suites, by scene and Δt, and that of `cases/handmade` in f64, with what each is called.
///
/// # Errors
/// When a scene cannot be read or run.
pub fn census() -> Result<Vec<(String, IterationCensus)>, CaseFailure> {
    let mut all = Vec::new();
    for scene in DropScene::ALL {
        for time_step in TIME_STEPS {
            let motions = [Motion::Rigid, Motion::Deformable];
            let runs: Vec<EnergyRun> =
                motions.into_iter().flat_map(|motion| EnergyRun::variants(scene, motion, time_step)).collect();
            let goes_on = |_: &IterationCensus, time: f64| time < scene.duration() - 1e-9;
            let of = |run: EnergyRun| IterationCensus::of::<SpecRules>(run.scene()?, goes_on);
            all.push((format!("{}, {} ms", scene.name(), 1e3 * time_step), sum(runs, of)?));
        }
    }
    let goes_on = |census: &IterationCensus, _: f64| census.steps < HANDMADE_STEPS;
    let of = |path: PathBuf| IterationCensus::of::<SpecRules>(Scene::load(&path)?, goes_on);
    all.push(("scenes of `cases/handmade`, 200 steps each".to_owned(), sum(handmade()?, of)?));
    Ok(all)
}

fn sum<T: Send>(
    runs: Vec<T>,
    of: impl Fn(T) -> Result<IterationCensus, CaseFailure> + Sync + Send,
) -> Result<IterationCensus, CaseFailure> {
    let all = runs.into_par_iter().map(of).collect::<Result<Vec<_>, _>>()?;
    Ok(all.into_iter().fold(IterationCensus::default(), IterationCensus::and))
}

/// The scenes of `cases/handmade`, in the order of their names.
fn handmade() -> Result<Vec<PathBuf>, CaseFailure> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/handmade");
    let failed = |failure: std::io::Error| CaseFailure::Unexpected(format!("{folder}: {failure}"));
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<Vec<_>, CaseFailure>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    Ok(paths)
}

rockproof_model::named_enum! {
    /// What is done to a pour beside letting it fall.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Pour {
        /// Nothing.
        Plain = "as it is",
        /// Every joint has a cohesion of 0.1 MPa.
        Cohesion = "cohesion of 0.1 MPa",
        /// A constant force acts on a corner of the brick poured last, as large as its weight, nearly downwards.
        Load = "a load on a corner",
    }
}

impl Pour {
    /// The first variant of the pour of rigid bricks, changed.
    ///
    /// # Errors
    /// When it cannot be run. That a number is none cannot be.
    pub fn measure(self, time_step: f64) -> Result<EnergyResult, CaseFailure> {
        let run = EnergyRun { scene: DropScene::Poured, variant: 0, motion: Motion::Rigid, time_step };
        let mut scene = run.scene()?;
        match self {
            Pour::Plain => {}
            Pour::Cohesion => scene.simulation.joints.other.cohesion = number(1e5)?,
            Pour::Load => {
                let block = scene.blocks.len() - 1;
                let at = scene.blocks[block].block.vertices()[0].clone();
                // A brick of 0.2 m³ weighs 5.2 kN.
                let force = vector([1e3, 5e2, -5e3])?;
                scene.simulation.loads.push(PointLoad { block, at, table: vec![(number(0.0)?, force)] });
            }
        }
        run.measure_in::<SpecRules>(scene)
    }
}

/// The potential of the loads of a scene, −Σ f·x (J): what they have yet to spend. Of loads that do not change with time alone.
pub(crate) fn load_potential(scene: &Scene, points: &[Vector<f64>]) -> f64 {
    let of = |(load, at): (&PointLoad, &Vector<f64>)| {
        let force = load.table.first().map_or([0.0; 3], |(_, force)| force.components().map(|c| c.approximate()));
        force.iter().zip(at.components()).map(|(f, x)| f * x).sum::<f64>()
    };
    -scene.simulation.loads.iter().zip(points).map(of).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_seventh_unchanged_solve_ends_an_attempt_so() {
        let [open, locked] = [vec![Mode::Open], vec![Mode::Locked]];
        let seven = vec![open.clone(); 7];
        assert!(ends_unchanged(&open, &seven) && !ends_unchanged(&open, &seven[..6]));
        // The first solve changed a mode, so seven more are needed.
        assert!(!ends_unchanged(&locked, &seven));
        let changed_at_last = [seven.clone(), vec![locked]].concat();
        assert!(!ends_unchanged(&open, &changed_at_last));
        assert!(ends_unchanged(&open, &[vec![vec![Mode::Locked]], vec![open.clone()], seven].concat()));
    }

    /// A brick that falls freely: nothing is iterated, nothing kept; one that stands is kept in every step but the first.
    #[test]
    fn a_census_counts_what_is_there() {
        let goes_on = |census: &IterationCensus, _: f64| census.steps < 10;
        let fall =
            IterationCensus::of::<SpecRules>(crate::stepped_scene::scene("free_fall").unwrap(), goes_on).unwrap();
        assert_eq!([fall.runs, fall.steps, fall.attempts, fall.solves], [1, 10, 10, 10]);
        assert_eq!([fall.sevenths, fall.cuts, fall.halvings, fall.unconverged, fall.beyond], [0; 5]);
        assert_eq!(fall.deepest, 0.0);
        let rest = IterationCensus::of::<SpecRules>(crate::stepped_scene::scene("rest_on_floor").unwrap(), goes_on);
        let rest = rest.unwrap();
        assert!(rest.deepest > 0.0 && rest.deepest < 1.0 && rest.beyond == 0, "{rest:?}");
        let both = fall.and(rest);
        assert_eq!([both.runs, both.steps], [2, 20]);
        assert_eq!(both.deepest, rest.deepest);
    }

    /// The work of a load is no gain: without it in the account a load that pushes downwards would seem to gain energy.
    #[test]
    fn the_work_of_a_load_is_accounted_for() {
        let [plain, loaded] = [Pour::Plain, Pour::Load].map(|pour| pour.measure(1e-2).unwrap());
        assert!(loaded.drop > 1.05 * plain.drop, "{} J and {} J", plain.drop, loaded.drop);
        assert!(loaded.worst.gain < 0.01 && loaded.gained < 0.02, "{loaded:?}");
    }
}
