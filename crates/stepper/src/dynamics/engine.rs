//! A scene and its state, step by step (SPEC section 5).

#[cfg(test)]
mod tests;

use crate::contact::{Collapsed, Solid, Spec, classify};
use crate::dynamics::area;
use crate::dynamics::attempt::{Ended, Iteration};
use crate::dynamics::contact::{Active, Now};
use crate::dynamics::displacement::{Twelve, displacement};
use crate::dynamics::given::Given;
use crate::dynamics::kinematics::Motion;
use crate::dynamics::layout::Layouts;
use crate::dynamics::moments::{Matrix, Moments};
use crate::dynamics::neighbours::Neighbours;
use crate::dynamics::plane::plane;
use crate::dynamics::report::{Retry, RetryReason, Spent, StepReport, Stopped};
use crate::dynamics::rules::StepRules;
use crate::dynamics::setup::{Setup, SetupError};
use crate::dynamics::solve::Solve;
use crate::dynamics::state::{BlockState, Mode, State};
use crate::dynamics::transfer;
use crate::real::Real;
use crate::vector::Vector;
use rayon::prelude::*;
use rockproof_model::{Block, Contact, Scene, ToleranceSet};
use std::marker::PhantomData;
use std::ops::Range;
use std::time::{Duration, Instant};

/// A scene in motion, in the scalar `R` and by the rules `M`.
#[derive(Debug)]
pub struct Dynamics<R, M = Spec> {
    pub(super) setup: Setup<R>,
    pub(super) state: State<R>,
    pub(super) solids: Vec<Solid<R>>,
    pub(super) moments: Vec<Moments<R>>,
    neighbours: Neighbours,
    pub(super) layouts: Layouts,
    pub(super) modes: Vec<Vec<Vec<Mode>>>,
    phases: Phases,
    pub(super) spent: Spent,
    rules: PhantomData<fn() -> M>,
}

// Rules are no values, so M need not be Clone.
impl<R: Clone, M> Clone for Dynamics<R, M> {
    fn clone(&self) -> Self {
        Dynamics {
            setup: self.setup.clone(),
            state: self.state.clone(),
            solids: self.solids.clone(),
            moments: self.moments.clone(),
            neighbours: self.neighbours.clone(),
            layouts: self.layouts.clone(),
            modes: self.modes.clone(),
            phases: self.phases,
            spent: self.spent,
            rules: PhantomData,
        }
    }
}

/// Where the time went, over all steps so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Phases {
    /// Boxes, and pairs of neighbours.
    pub rough: Duration,
    /// Classification of neighbours, transfer, areas.
    pub contacts: Duration,
    /// Springs, assembly, solution, open–close iteration.
    pub iteration: Duration,
    /// Moving blocks, moments, energies.
    pub update: Duration,
}

/// So many pairs are classified before their contacts go to the others. All at once would take the memory of the contacts twice.
const PAIRS_AT_ONCE: usize = 512;

/// What is known of blocks where they stand.
struct Prepared<R> {
    solids: Vec<Solid<R>>,
    moments: Vec<Moments<R>>,
}

impl<R: Real> Prepared<R> {
    fn new(blocks: &[Block], states: &[BlockState<R>]) -> Result<Prepared<R>, SetupError> {
        let both = || blocks.iter().zip(states);
        let solid = |(k, (block, state)): (usize, (&Block, &BlockState<R>))| {
            Solid::with_points(block.clone(), &state.vertices).map_err(|what| SetupError::Collapsed { block: k, what })
        };
        let moments = |(block, state): (&Block, &BlockState<R>)| Moments::of(block.topology(), &state.vertices);
        Ok(Prepared {
            solids: both().enumerate().map(solid).collect::<Result<_, _>>()?,
            moments: both().map(moments).collect(),
        })
    }
}

/// An attempt that was good, or the last one.
pub(super) struct Accepted<R> {
    pub(super) time_step: R,
    pub(super) ended: Ended<R>,
    pub(super) retries: Vec<Retry>,
    /// The largest displacement of a vertex, squared (m²).
    pub(super) farthest: R,
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
        let setup = Setup::new(scene, set)?;
        let state = setup.begin(scene)?;
        let Prepared { solids, moments } = Prepared::new(&setup.blocks, &state.blocks)?;
        let at = |moments: &Moments<R>| moments.centroid.components().map(Real::to_f64);
        let layouts = Layouts::new(moments.iter().map(at).collect());
        Ok(Dynamics {
            setup,
            state,
            solids,
            moments,
            neighbours: Neighbours::default(),
            layouts,
            modes: Vec::new(),
            phases: Phases::default(),
            spent: Spent::default(),
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
        let Prepared { solids, moments } = Prepared::new(&self.setup.blocks, &state.blocks)?;
        (self.state, self.solids, self.moments) = (state, solids, moments);
        self.neighbours.forget();
        Ok(())
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
    pub fn mass(&self, block: usize) -> Matrix<R> {
        let density = self.setup.bodies[block].elastic.density;
        self.moments[block].inertia().map(|row| row.map(|value| value * density))
    }

    /// For each attempt at the last step, the modes of its contacts (in the order of the state) after each solve.
    pub fn modes(&self) -> &[Vec<Vec<Mode>>] {
        &self.modes
    }

    /// Where the time went.
    pub fn phases(&self) -> Phases {
        self.phases
    }

    /// Where the time of the open–close iteration went.
    pub fn spent(&self) -> Spent {
        self.spent
    }

    /// One step: of settling, while some are left, else of time. When it fails the state is as before.
    ///
    /// # Errors
    /// When the run cannot go on.
    pub fn step(&mut self) -> Result<StepReport, Stopped> {
        self.step_with(None)
    }

    pub(super) fn step_with(&mut self, given: Option<&Given<'_>>) -> Result<StepReport, Stopped> {
        let settling = self.state.settling > 0;
        let number = if settling { 1 - i64::from(self.state.settling) } else { self.state.step as i64 + 1 };
        let mut contacts = match given {
            None => self.contacts(),
            Some(given) => self.given_contacts(given.contacts),
        };
        let begun = Instant::now();
        self.modes.clear();
        let accepted = match given.and_then(|given| given.attempt.as_ref()) {
            None => self.attempts(&mut contacts, number, settling)?,
            Some(attempt) => self.given_attempt(&mut contacts, attempt, number, settling)?,
        };
        self.phases.iteration += begun.elapsed();
        let begun = Instant::now();
        let report = self.accept(&contacts, accepted, number, settling);
        self.phases.update += begun.elapsed();
        report
    }

    /// The contacts at the start of a step, with what they remember.
    fn contacts(&mut self) -> Vec<Active<R>> {
        let begun = Instant::now();
        let fixed: Vec<bool> = self.setup.bodies.iter().map(|body| body.motion.unknowns() == 0).collect();
        let pairs = self.neighbours.pairs(&self.solids, &fixed, &self.setup.tolerances).to_vec();
        self.phases.rough += begun.elapsed();
        let begun = Instant::now();
        let of_pair = |&pair: &[u32; 2]| {
            let [a, b] = pair.map(|block| &self.solids[block as usize]);
            let found = classify::<R, M>(a, b, &self.setup.tolerances);
            let contacts: Vec<Contact> = found.into_iter().map(|found| found.contact).collect();
            self.of_pair(pair, &contacts)
        };
        let before = self.state.contacts.len();
        let mut contacts = Vec::with_capacity(before + before / 8);
        for part in pairs.chunks(PAIRS_AT_ONCE) {
            let found: Vec<Vec<Active<R>>> = part.par_iter().map(of_pair).collect();
            found.into_iter().for_each(|pair| contacts.extend(pair));
        }
        self.phases.contacts += begun.elapsed();
        contacts
    }

    pub(super) fn of_pair(&self, pair: [u32; 2], contacts: &[Contact]) -> Vec<Active<R>> {
        if contacts.is_empty() {
            return Vec::new();
        }
        let solids = pair.map(|block| &self.solids[block as usize]);
        let joint = *self.setup.joint(pair[0] as usize, pair[1] as usize);
        let old = &self.state.contacts[transfer::of_pair(&self.state.contacts, pair)];
        let memories = if M::transfers() { transfer::continued(contacts, old) } else { vec![None; contacts.len()] };
        let active = contacts.iter().zip(memories).map(|(contact, memory)| {
            let plane = plane::<R, M>(solids[0], solids[1], &contact.entrance);
            let feet = [plane.p, plane.q];
            let (begins, anchors) = match memory {
                None => (M::begins(plane.gap), feet),
                Some((Mode::Open, _)) => (Mode::Open, feet),
                Some((mode, [a, b])) => (mode, if plane.a_enters { [a, b] } else { [b, a] }),
            };
            let now = Now { mode: begins, gap: plane.gap, stretch: Vector::ZERO, slip_force: Vector::ZERO };
            let (arms, zero) = ([Vector::ZERO; 2], R::ZERO);
            let contact = *contact;
            let (cohesive, tensile_gap, stretch) = (zero, zero, Vector::ZERO);
            let mut active = Active {
                blocks: pair,
                contact,
                plane,
                joint,
                cohesive,
                tensile_gap,
                anchors,
                stretch,
                begins,
                arms,
                now,
            };
            active.stretch = active.across(anchors[0] - anchors[1]);
            active.measure_from(active.entering().map(|block| self.moments[block].centroid));
            active
        });
        let mut active: Vec<Active<R>> = active.collect();
        if joint.needs_area() {
            area::share(&mut active, solids, &joint, self.setup.tolerances.overlap_sine);
        }
        active
    }

    /// Tries until an attempt is good (SPEC section 5, step control).
    fn attempts(&mut self, contacts: &mut [Active<R>], number: i64, settling: bool) -> Result<Accepted<R>, Stopped> {
        let full = self.setup.control.time_step;
        let smallest = M::smallest(full);
        let mut time_step = full;
        let mut retries = Vec::new();
        loop {
            let alone = self.alone(time_step, settling);
            let iteration = Iteration { alone: &alone, limits: &self.setup.limits, settling, given: None };
            let ended = iteration
                .run::<M>(contacts, &mut self.layouts, &mut self.spent)
                .map_err(|unsolved| Stopped::Singular { step: number, block: unsolved.block })?;
            self.modes.push(ended.modes.clone());
            if let Some(block) = ended.d.iter().position(|d| !d.iter().all(|x| x.is_finite())) {
                return Err(Stopped::NotFinite { step: number, block });
            }
            let accepts = self.setup.control.unconverged == rockproof_model::simulation::Unconverged::Accept;
            let at = time_step.to_f64();
            let why = if ended.changing.is_empty() {
                None
            } else if M::cut(time_step) < smallest {
                if !accepts {
                    return Err(Stopped::NotConverged { step: number, time_step: at, contacts: ended.changing });
                }
                None
            } else {
                Some((RetryReason::NotConverged, M::cut(time_step)))
            };
            let why = match why {
                Some(why) => Some(why),
                None => match self.beyond_limits(&ended.d) {
                    Err((block, why)) => {
                        let half = time_step / R::from_f64(2.0);
                        if half < smallest {
                            return Err(Stopped::TooFast { step: number, time_step: at, block, why });
                        }
                        Some((why, half))
                    }
                    Ok(farthest) => {
                        self.layouts.forget_unused();
                        return Ok(Accepted { time_step, ended, retries, farthest });
                    }
                },
            };
            if let Some((why, next)) = why {
                retries.push(Retry { time_step: at, why });
                time_step = next;
            }
        }
    }

    /// The largest squared displacement of a vertex, or the first block that exceeds a limit: first that of displacement.
    fn beyond_limits(&self, d: &[Twelve<R>]) -> Result<R, (usize, RetryReason)> {
        let limits = &self.setup.limits;
        let (far, turned) = (limits.displacement * limits.displacement, limits.rotation * limits.rotation);
        let moving = || d.iter().enumerate().filter(|&(block, _)| !self.is_fixed(block));
        let mut farthest = R::ZERO;
        for (block, d) in moving() {
            for &vertex in &self.state.blocks[block].vertices {
                let moved = displacement(vertex - self.moments[block].centroid, d);
                let squared = moved.dot(moved);
                if M::too_far(squared, far) {
                    return Err((block, RetryReason::Displacement));
                }
                farthest = farthest.larger(squared);
            }
        }
        let turns = |d: &Twelve<R>| M::turned_too_far(d[3] * d[3] + d[4] * d[4] + d[5] * d[5], turned);
        match moving().find(|(_, d)| turns(d)) {
            Some((block, _)) => Err((block, RetryReason::Rotation)),
            None => Ok(farthest),
        }
    }

    pub(super) fn is_fixed(&self, block: usize) -> bool {
        self.setup.bodies[block].motion.unknowns() == 0
    }

    /// Prepares those of some blocks that are not fixed again, one in place of the other: two of each would take twice the memory. Tells
    /// which one collapsed; those before it are replaced.
    fn prepare_moving(&mut self, states: &[BlockState<R>], blocks: Range<usize>) -> Result<(), (usize, Collapsed)> {
        for block in blocks {
            if !self.is_fixed(block) {
                let shape = self.setup.blocks[block].clone();
                self.solids[block] =
                    Solid::with_points(shape, &states[block].vertices).map_err(|what| (block, what))?;
            }
        }
        Ok(())
    }

    /// Moves everything by an accepted attempt. Of blocks that end not finite or inverted the first is told, and before any that collapsed.
    fn accept(
        &mut self,
        contacts: &[Active<R>],
        accepted: Accepted<R>,
        number: i64,
        settling: bool,
    ) -> Result<StepReport, Stopped> {
        let Accepted { time_step, ended, retries, farthest } = accepted;
        let motions: Vec<Motion<R>> = (0..self.solids.len())
            .map(|block| Motion::new(self.setup.control.kinematics, self.moments[block].centroid, &ended.d[block]))
            .collect();
        let now = &self.state;
        let mut next = State {
            step: now.step,
            time: now.time,
            settling: now.settling,
            blocks: now.blocks.clone(),
            load_points: now.load_points.clone(),
            fixed_points: now.fixed_points.clone(),
            measured_points: now.measured_points.clone(),
            contacts: Vec::new(),
        };
        let dynamic = if settling { R::ZERO } else { self.setup.control.dynamic };
        let twice = R::from_f64(2.0) / time_step;
        let mut moments = self.moments.clone();
        for block in (0..motions.len()).filter(|&block| !self.is_fixed(block)) {
            let (state, d) = (&mut next.blocks[block], &ended.d[block]);
            for vertex in &mut state.vertices {
                *vertex = motions[block].of(*vertex);
            }
            for (rate, &d) in state.velocity.iter_mut().zip(d) {
                *rate = M::rate(dynamic, twice * d, *rate);
            }
            let added = self.setup.bodies[block].elastic.stress(&d[6..]);
            for (stress, added) in state.stress.iter_mut().zip(added) {
                *stress = *stress + added;
            }
            moments[block] = Moments::of(self.setup.blocks[block].topology(), &state.vertices);
            let finite = state.velocity.iter().chain(&state.stress).all(|x| x.is_finite());
            if !(finite && state.vertices.iter().all(|v| v.is_finite()) && moments[block].volume.is_finite()) {
                return Err(Stopped::NotFinite { step: number, block });
            }
            if !R::ZERO.below(moments[block].volume) {
                let volume = moments[block].volume.to_f64();
                return Err(Stopped::Inverted { step: number, block, volume });
            }
        }
        let load_blocks = self.setup.loads.iter().map(|load| load.block);
        let held_blocks = self.setup.held.iter().map(|held| held.block);
        for (block, point) in load_blocks.zip(&mut next.load_points).chain(held_blocks.zip(&mut next.fixed_points)) {
            *point = motions[block].of(*point);
        }
        for (&block, point) in self.setup.measured.iter().zip(&mut next.measured_points) {
            *point = motions[block].of(*point);
        }
        next.contacts = contacts
            .iter()
            .map(|contact| {
                contact.leave::<M>(|block, point| if self.is_fixed(block) { point } else { motions[block].of(point) })
            })
            .collect();
        if settling {
            next.settling -= 1;
            if next.settling == 0 {
                for (state, body) in next.blocks.iter_mut().zip(&self.setup.bodies) {
                    state.velocity = body.velocity;
                }
            }
        } else {
            next.step += 1;
            next.time = next.time + time_step;
        }
        if let Err((block, what)) = self.prepare_moving(&next.blocks, 0..motions.len()) {
            // What they were before did not collapse.
            let before = std::mem::take(&mut self.state.blocks);
            let restored = self.prepare_moving(&before, 0..block);
            self.state.blocks = before;
            debug_assert!(restored.is_ok(), "a state that was prepared once is prepared again");
            return Err(Stopped::Collapsed { step: number, block, what });
        }
        self.state = next;
        self.moments = moments;
        let farthest = farthest.to_f64().sqrt();
        // The map of `cayley` differs from first order by less than this.
        self.neighbours.moved(1.25 * farthest);
        Ok(self.report(contacts, number, time_step.to_f64(), (&ended, retries), farthest))
    }
}

fn vertices<R>(state: &State<R>) -> usize {
    state.blocks.iter().map(|block| block.vertices.len()).sum()
}
