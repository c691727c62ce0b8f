//! A scene and its state, step by step (SPEC section 5).

#[cfg(test)]
mod bricks;
#[cfg(test)]
mod refinement_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod two_level_tests;

use crate::contact::{ClassificationRequest, PreparedBlock, SpecRules};
use crate::dynamics::area;
use crate::dynamics::contact::{ContactIterate, StepContact};
use crate::dynamics::friction::Friction;
use crate::dynamics::island::Memory;
use crate::dynamics::layout::Layouts;
use crate::dynamics::moments::{BlockMatrix, Moments};
use crate::dynamics::neighbour_list::{BlockTravel, NeighbourList, skin};
use crate::dynamics::neighbours::Neighbours;
use crate::dynamics::plane::plane;
use crate::dynamics::prescribed::PrescribedStep;
use crate::dynamics::report::{IterationTimes, StepError, StepReport};
use crate::dynamics::setup::{SceneSetup, SetupError};
use crate::dynamics::solve::Solve;
use crate::dynamics::state::{BlockState, Mode, State};
use crate::dynamics::step_rules::StepRules;
use crate::dynamics::transfer;
use crate::dynamics::unchanged::Unchanged;
use crate::real::Real;
use crate::vector::Vector;
use rayon::prelude::*;
use rockproof_model::simulation::Skips;
use rockproof_model::{Block, Contact, Scene, ToleranceSet};
use std::any::TypeId;
use std::marker::PhantomData;
use std::time::{Duration, Instant};

/// A scene in motion, in the scalar `R` and by the rules `M`.
#[derive(Debug)]
pub struct Dynamics<R, M = SpecRules> {
    pub(super) setup: SceneSetup<R>,
    pub(super) state: State<R>,
    pub(super) prepared: Vec<PreparedBlock<R>>,
    pub(super) moments: Vec<Moments<R>>,
    pub(super) neighbours: Neighbours,
    pub(super) travel: BlockTravel,
    pub(super) layouts: Layouts,
    /// Memory for factors, kept from step to step: to fetch it anew costs time.
    pub(super) spare: Memory<R>,
    pub(super) skips: Skips,
    pub(super) unchanged: Unchanged<R>,
    first_modes: Vec<Mode>,
    pub(super) modes: Vec<Vec<Vec<Mode>>>,
    phases: PhaseTimes,
    pub(super) iteration_times: IterationTimes,
    rules: PhantomData<fn() -> M>,
}

// Rules are no values, so M need not be Clone.
impl<R: Clone, M> Clone for Dynamics<R, M> {
    fn clone(&self) -> Self {
        Dynamics {
            setup: self.setup.clone(),
            state: self.state.clone(),
            prepared: self.prepared.clone(),
            moments: self.moments.clone(),
            neighbours: self.neighbours.clone(),
            travel: self.travel.clone(),
            layouts: self.layouts.clone(),
            spare: Memory::NONE,
            skips: self.skips,
            unchanged: self.unchanged.clone(),
            first_modes: self.first_modes.clone(),
            modes: self.modes.clone(),
            phases: self.phases,
            iteration_times: self.iteration_times,
            rules: PhantomData,
        }
    }
}

/// Where the time went, over all steps so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseTimes {
    /// Boxes, and pairs of neighbours.
    pub rough: Duration,
    /// Classification of neighbours, transfer, areas.
    pub contacts: Duration,
    /// Springs, assembly, solution, open–close iteration.
    pub iteration: Duration,
    /// Moving blocks, moments, energies.
    pub update: Duration,
}

/// So many pairs are classified while the contacts of as many go to the others. All at once would take the memory of the contacts twice.
const PAIRS_AT_ONCE: usize = 256;

/// What is known of blocks where they stand.
struct PreparedBlocks<R> {
    prepared: Vec<PreparedBlock<R>>,
    moments: Vec<Moments<R>>,
}

impl<R: Real> PreparedBlocks<R> {
    fn new(blocks: &[Block], states: &[BlockState<R>]) -> Result<PreparedBlocks<R>, SetupError> {
        let both = || blocks.iter().zip(states);
        let prepare = |(k, (block, state)): (usize, (&Block, &BlockState<R>))| {
            PreparedBlock::unprepared(block.clone())
                .with_points(&state.vertices)
                .map_err(|what| SetupError::Collapsed { block: k, what })
        };
        let moments = |(block, state): (&Block, &BlockState<R>)| Moments::of(block.topology(), &state.vertices);
        Ok(PreparedBlocks {
            prepared: both().enumerate().map(prepare).collect::<Result<_, _>>()?,
            moments: both().map(moments).collect(),
        })
    }
}

impl<R: Solve> Dynamics<R> {
    /// The scene at its beginning, by the rules of SPEC. Its joints have stiffnesses
    /// ([`rockproof_model::simulation::derive_stiffness`]).
    ///
    /// # Errors
    /// When a number overflows or a block collapses in the scalar.
    pub fn new(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<R>, SetupError> {
        Dynamics::with_rules(scene, set)
    }
}

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// As [`Dynamics::new`], by other rules.
    ///
    /// # Errors
    /// When a number overflows or a block collapses in the scalar.
    pub fn with_rules(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<R, M>, SetupError> {
        M::begin_dynamics(scene, set)
    }

    pub(super) fn begin(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<R, M>, SetupError> {
        let setup = SceneSetup::new(scene, set)?;
        let state = setup.begin(scene)?;
        let PreparedBlocks { prepared, moments } = PreparedBlocks::new(&setup.blocks, &state.blocks)?;
        let at = |moments: &Moments<R>| moments.centroid.components().map(Real::to_f64);
        let travel = BlockTravel::of(prepared.len());
        let layouts =
            Layouts::new(moments.iter().map(at).collect(), R::USES_CONJUGATE_GRADIENTS.then_some(setup.control.solver));
        Ok(Dynamics {
            setup,
            state,
            prepared,
            moments,
            neighbours: Neighbours::default(),
            travel,
            layouts,
            spare: Memory::NONE,
            skips: scene.simulation.control.skips,
            unchanged: Unchanged::NONE,
            first_modes: Vec::new(),
            modes: Vec::new(),
            phases: PhaseTimes::default(),
            iteration_times: IterationTimes::default(),
            rules: PhantomData,
        })
    }

    /// The state after the last step.
    pub fn state(&self) -> &State<R> {
        &self.state
    }

    /// Goes on from another state of the same scene: a checkpoint.
    ///
    /// # Errors
    /// When the state does not fit the scene, or a block collapses. Then nothing changes.
    pub fn restore(&mut self, state: State<R>) -> Result<(), SetupError> {
        M::restore_dynamics(self, state)
    }

    pub(super) fn continue_from(&mut self, state: State<R>) -> Result<(), SetupError> {
        let fits = [
            ("blocks", state.blocks.len(), self.state.blocks.len()),
            ("load points", state.load_points.len(), self.state.load_points.len()),
            ("fixed points", state.fixed_points.len(), self.state.fixed_points.len()),
            ("measured points", state.measured_points.len(), self.state.measured_points.len()),
            ("vertices", vertices(&state), vertices(&self.state)),
        ];
        if let Some((what, found, expected)) = fits.into_iter().find(|(_, found, expected)| found != expected) {
            return Err(SetupError::Mismatch { what, found, expected });
        }
        if let Some(contact) = state.contacts.iter().position(|contact| !self.setup.has(contact)) {
            return Err(SetupError::NoSuchContact { contact });
        }
        let PreparedBlocks { prepared, moments } = PreparedBlocks::new(&self.setup.blocks, &state.blocks)?;
        (self.state, self.prepared, self.moments) = (state, prepared, moments);
        self.neighbours.forget();
        self.unchanged = Unchanged::NONE;
        Ok(())
    }

    /// What the following steps leave out where nothing can have changed, instead of what the scene says. No bit of any result depends on it.
    pub fn skip(&mut self, skips: Skips) {
        self.skips = skips;
        if !skips.features {
            self.neighbours.forget_features();
        }
    }

    /// Of how many pairs of blocks only nearby features are looked at until a block has moved on ([`Skips::features`]).
    pub fn pairs_with_known_features(&self) -> usize {
        self.neighbours.pairs_with_known_features()
    }

    /// The volume of a block (m³).
    pub fn volume(&self, block: usize) -> f64 {
        self.moments[block].volume.to_f64()
    }

    /// The centroid of a block (m).
    pub fn centroid(&self, block: usize) -> Vector<R> {
        self.moments[block].centroid
    }

    /// The mass matrix of a block, in kg, kg·m and kg·m².
    pub fn mass(&self, block: usize) -> BlockMatrix<R> {
        let density = self.setup.bodies[block].elastic.density;
        self.moments[block].inertia().map(|row| row.map(|value| value * density))
    }

    /// The modes with which the contacts of the last step began (in the order of the state): those of the first solve of each attempt.
    pub fn first_modes(&self) -> &[Mode] {
        &self.first_modes
    }

    /// For each attempt at the last step, the modes of its contacts (in the order of the state) after each solve.
    pub fn modes(&self) -> &[Vec<Vec<Mode>>] {
        &self.modes
    }

    /// Where the time went.
    pub fn phases(&self) -> PhaseTimes {
        self.phases
    }

    /// Where the time of the open–close iteration went.
    pub fn iteration_times(&self) -> IterationTimes {
        self.iteration_times
    }

    /// One step: of settling, while some are left, else of time. When it fails the state is as before.
    ///
    /// # Errors
    /// When the run cannot go on.
    pub fn step(&mut self) -> Result<StepReport, StepError> {
        M::step_dynamics(self, None)
    }

    // By itself, so that its instructions can be counted (`.ci/instructions`).
    #[inline(never)]
    pub(super) fn make_step(&mut self, prescribed: Option<&PrescribedStep<'_>>) -> Result<StepReport, StepError> {
        let settling = self.state.settling > 0;
        let number = self.next_number();
        let contacts = match prescribed {
            None => self.contacts(),
            Some(prescribed) => self.prescribed_contacts(prescribed.contacts),
        };
        let begun = Instant::now();
        let mut contacts = self.begin_step(contacts);
        let accepted = match prescribed.and_then(|prescribed| prescribed.attempt.as_ref()) {
            None => self.attempts(&mut contacts, number, settling)?,
            Some(attempt) => self.prescribed_attempt(&mut contacts, attempt, number, settling)?,
        };
        self.phases.iteration += begun.elapsed();
        let begun = Instant::now();
        let report = self.accept(&contacts, accepted, number, settling);
        self.phases.update += begun.elapsed();
        if prescribed.is_some() {
            // Its contacts were not classified, nor its modes found.
            self.unchanged = Unchanged::NONE;
            self.neighbours.forget_features();
        }
        report
    }

    /// The number of the next step.
    pub(super) fn next_number(&self) -> i64 {
        let settling = self.state.settling;
        if settling > 0 { 1 - i64::from(settling) } else { self.state.step as i64 + 1 }
    }

    /// Takes note of how the contacts of a step begin, and hands them on.
    pub(super) fn begin_step(&mut self, contacts: Vec<StepContact<R>>) -> Vec<StepContact<R>> {
        self.first_modes = contacts.iter().map(|contact| contact.begins).collect();
        self.modes.clear();
        contacts
    }

    /// The contacts at the start of a step, with what they remember.
    fn contacts(&mut self) -> Vec<StepContact<R>> {
        let begun = Instant::now();
        let fixed: Vec<bool> = self.setup.bodies.iter().map(|body| body.motion.unknowns() == 0).collect();
        let mut neighbours = std::mem::take(&mut self.neighbours);
        let (pairs, watched) = neighbours.pairs(&self.prepared, &fixed, &self.setup.tolerances);
        self.phases.rough += begun.elapsed();
        let begun = Instant::now();
        let margin = skin(self.setup.tolerances.search);
        // What other rules refuse is not known.
        let watches = self.skips.features && TypeId::of::<M>() == TypeId::of::<SpecRules>();
        let of_pair = |(&pair, watched): (&[u32; 2], &mut NeighbourList)| {
            let [a, b] = pair.map(|block| &self.prepared[block as usize]);
            let old = &self.state.contacts[transfer::of_pair(&self.state.contacts, pair)];
            if self.skips.pairs && self.unchanged.has(pair) {
                let contacts: Vec<Contact> = old.iter().map(|old| old.contact).collect();
                return self.of_pair(pair, &contacts);
            }
            let kept = self.kept_contacts(pair);
            let all = ClassificationRequest { a, b, tolerances: &self.setup.tolerances, kept: &kept, among: None };
            let among = if watches { watched.nearby(pair, &self.travel, all, margin) } else { None };
            let found = M::contacts(ClassificationRequest { among, ..all });
            let contacts: Vec<Contact> = found.into_iter().map(|found| found.contact).collect();
            self.of_pair(pair, &contacts)
        };
        let before = self.state.contacts.len();
        let mut contacts = Vec::with_capacity(before + before / 8);
        let classified = |(part, watched): (&[[u32; 2]], &mut [NeighbourList])| -> Vec<Vec<StepContact<R>>> {
            part.par_iter().zip(watched).map(of_pair).collect()
        };
        let mut parts = pairs.chunks(PAIRS_AT_ONCE).zip(watched.chunks_mut(PAIRS_AT_ONCE));
        let mut found = parts.next().map_or_else(Vec::new, classified);
        for part in parts {
            let others = || contacts.extend(found.into_iter().flatten());
            found = rayon::join(|| classified(part), others).0;
        }
        contacts.extend(found.into_iter().flatten());
        self.neighbours = neighbours;
        self.phases.contacts += begun.elapsed();
        contacts
    }

    pub(super) fn of_pair(&self, pair: [u32; 2], contacts: &[Contact]) -> Vec<StepContact<R>> {
        if contacts.is_empty() {
            return Vec::new();
        }
        let prepared = pair.map(|block| &self.prepared[block as usize]);
        let joint = *self.setup.joint(pair[0] as usize, pair[1] as usize);
        let old = &self.state.contacts[transfer::of_pair(&self.state.contacts, pair)];
        let memories = if M::transfers() { transfer::continued(contacts, old) } else { vec![None; contacts.len()] };
        let active = contacts.iter().zip(memories).map(|(contact, memory)| {
            let plane = plane::<R, M>(prepared[0], prepared[1], &contact.entrance);
            let feet = [plane.p, plane.q];
            let (begins, anchors) = match memory {
                None => (M::begins(plane.gap), feet),
                Some((Mode::Open, _)) => (Mode::Open, feet),
                Some((mode, [a, b])) => (mode, if plane.a_enters { [a, b] } else { [b, a] }),
            };
            let iterate =
                ContactIterate { mode: begins, gap: plane.gap, stretch: Vector::ZERO, friction: Friction::NONE };
            StepContact {
                blocks: pair,
                contact: *contact,
                plane,
                joint: joint.springs(),
                cohesive: R::ZERO,
                tensile_gap: R::ZERO,
                anchors,
                begins,
                iterate,
            }
        });
        let mut active: Vec<StepContact<R>> = active.collect();
        if joint.needs_area() {
            area::share(&mut active, prepared, &joint, self.setup.tolerances.overlap_sine);
        }
        active
    }

    pub(super) fn is_fixed(&self, block: usize) -> bool {
        self.setup.bodies[block].motion.unknowns() == 0
    }
}

fn vertices<R>(state: &State<R>) -> usize {
    state.blocks.iter().map(|block| block.vertices.len()).sum()
}
