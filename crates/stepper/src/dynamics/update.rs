//! What an accepted attempt does to the state (SPEC section 5, update).

use crate::contact::{Collapsed, PreparedBlock};
use crate::dynamics::attempt::IterationResult;
use crate::dynamics::contact::StepContact;
use crate::dynamics::control::AcceptedAttempt;
use crate::dynamics::displacement::BlockVector;
use crate::dynamics::island::islands;
use crate::dynamics::kinematics::AffineMotion;
use crate::dynamics::moments::Moments;
use crate::dynamics::neighbour_list::{farthest, skin};
use crate::dynamics::report::{StepError, StepReport};
use crate::dynamics::solve::Solve;
use crate::dynamics::state::{BlockState, Mode, State};
use crate::dynamics::step::Dynamics;
use crate::dynamics::step_rules::StepRules;
use crate::dynamics::system::CONTACTS_AT_ONCE;
use crate::dynamics::unchanged::{Unchanged, UnchangedIslands, different_pairs, same_motion, same_points};
use rayon::prelude::*;

/// A thread takes so many blocks at a time.
const BLOCKS_AT_ONCE: usize = 64;

/// What an accepted attempt does to all blocks.
struct Move<'m, R> {
    d: &'m [BlockVector<R>],
    motions: &'m [AffineMotion<R>],
    /// The share of velocities that a step keeps.
    dynamic: R,
    /// 2/Δt in 1/s.
    twice: R,
}

/// A block after a step.
struct MovedBlock<R> {
    state: BlockState<R>,
    moments: Moments<R>,
    /// Whether its vertices are where they were, bit for bit.
    unmoved: bool,
    /// How far a coordinate of a vertex moved at most (m).
    distance: f64,
}

impl<R: Solve, M: StepRules> Dynamics<R, M> {
    /// Prepares those blocks again that have moved, each in the memory that it has. Tells the first that collapsed; those that did are not
    /// prepared then.
    fn prepare_moved(&mut self, states: &[BlockState<R>], unmoved: &[bool]) -> Result<(), (usize, Collapsed)> {
        let (setup, skips) = (&self.setup, self.skips);
        let prepare = |(block, old): (usize, &mut PreparedBlock<R>)| {
            if setup.bodies[block].motion.unknowns() == 0 || skips.blocks && unmoved[block] {
                return None;
            }
            let before = std::mem::replace(old, PreparedBlock::unprepared(setup.blocks[block].clone()));
            match before.with_points(&states[block].vertices) {
                Ok(new) => *old = new,
                Err(what) => return Some((block, what)),
            }
            None
        };
        let prepared = self.prepared.par_iter_mut().enumerate().with_min_len(BLOCKS_AT_ONCE);
        prepared.filter_map(prepare).min_by_key(|(block, _)| *block).map_or(Ok(()), Err)
    }

    /// A block as an accepted attempt leaves it.
    fn moved(&self, block: usize, by: &Move<'_, R>, number: i64) -> Result<MovedBlock<R>, StepError> {
        let (mut state, mut moments, d) = (self.state.blocks[block].clone(), self.moments[block], &by.d[block]);
        if self.is_fixed(block) {
            return Ok(MovedBlock { state, moments, unmoved: true, distance: 0.0 });
        }
        for vertex in &mut state.vertices {
            *vertex = by.motions[block].of(*vertex);
        }
        for (rate, &d) in state.velocity.iter_mut().zip(d) {
            *rate = M::rate(by.dynamic, by.twice * d, *rate);
        }
        let added = self.setup.bodies[block].elastic.stress(&d[6..]);
        for (stress, added) in state.stress.iter_mut().zip(added) {
            *stress = *stress + added;
        }
        let unmoved = same_points(&self.state.blocks[block].vertices, &state.vertices);
        let distance = farthest(&self.state.blocks[block].vertices, &state.vertices);
        if !(self.skips.blocks && unmoved) {
            moments = Moments::of(self.setup.blocks[block].topology(), &state.vertices);
        }
        let finite = state.velocity.iter().chain(&state.stress).all(|x| x.is_finite());
        if !(finite && state.vertices.iter().all(|v| v.is_finite()) && moments.volume.is_finite()) {
            return Err(StepError::NotFinite { step: number, block });
        }
        if !R::ZERO.below(moments.volume) {
            return Err(StepError::Inverted { step: number, block, volume: moments.volume.to_f64() });
        }
        Ok(MovedBlock { state, moments, unmoved, distance })
    }

    /// Moves everything by an accepted attempt. Of blocks that end not finite or inverted the first is told, and before any that collapsed.
    pub(super) fn accept(
        &mut self,
        contacts: &[StepContact<R>],
        accepted: AcceptedAttempt<R>,
        number: i64,
        settling: bool,
    ) -> Result<StepReport, StepError> {
        let AcceptedAttempt { time_step, ended, retries } = accepted;
        let farthest = self.farthest(&ended.d);
        let blocks = || (0..self.prepared.len()).into_par_iter().with_min_len(BLOCKS_AT_ONCE);
        let kinematics = self.setup.control.kinematics;
        let motions: Vec<AffineMotion<R>> = blocks()
            .map(|block| AffineMotion::new(kinematics, self.moments[block].centroid, &ended.d[block]))
            .collect();
        let dynamic = if settling { R::ZERO } else { self.setup.control.dynamic };
        let by = Move { d: &ended.d, motions: &motions, dynamic, twice: R::from_f64(2.0) / time_step };
        let now = &self.state;
        let mut next = State {
            step: now.step,
            time: now.time,
            settling: now.settling,
            last_time_step: time_step,
            blocks: Vec::with_capacity(motions.len()),
            load_points: now.load_points.clone(),
            fixed_points: now.fixed_points.clone(),
            measured_points: now.measured_points.clone(),
            contacts: Vec::new(),
        };
        let (mut moments, mut unmoved) = (Vec::with_capacity(motions.len()), Vec::with_capacity(motions.len()));
        let moved: Vec<Result<MovedBlock<R>, StepError>> =
            blocks().map(|block| self.moved(block, &by, number)).collect();
        let mut distances = Vec::with_capacity(motions.len());
        for moved in moved {
            let moved = moved?;
            distances.push(moved.distance);
            next.blocks.push(moved.state);
            moments.push(moved.moments);
            unmoved.push(moved.unmoved);
        }
        let load_blocks = self.setup.loads.iter().map(|load| load.block);
        let held_blocks = self.setup.held.iter().map(|held| held.block);
        for (block, point) in load_blocks.zip(&mut next.load_points).chain(held_blocks.zip(&mut next.fixed_points)) {
            *point = motions[block].of(*point);
        }
        for (&block, point) in self.setup.measured.iter().zip(&mut next.measured_points) {
            *point = motions[block].of(*point);
        }
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
        if let Err((block, what)) = self.prepare_moved(&next.blocks, &unmoved) {
            // What they were before did not collapse.
            let before = std::mem::take(&mut self.state.blocks);
            let restored = self.prepare_moved(&before, &unmoved);
            self.state.blocks = before;
            debug_assert!(restored.is_ok(), "a state that was prepared once is prepared again");
            return Err(StepError::Collapsed { step: number, block, what });
        }
        if !self.any_unmoved(&unmoved) {
            // Nothing is compared with them. Both at once would take the most memory of a step.
            self.state.contacts = Vec::new();
        }
        let after = |contact: &StepContact<R>| {
            let moved = |block: usize, point| if self.is_fixed(block) { point } else { motions[block].of(point) };
            contact.state_after_step::<M>(moved)
        };
        next.contacts = contacts.par_iter().with_min_len(CONTACTS_AT_ONCE).map(after).collect();
        self.unchanged = self.still_after(contacts, &next, unmoved, (&ended, time_step, settling));
        self.state = next;
        self.moments = moments;
        let margin = skin(self.setup.tolerances.search);
        for (block, distance) in distances.into_iter().enumerate() {
            self.travel.add(block, distance, margin);
        }
        let farthest = farthest.to_f64().sqrt();
        // The map of `cayley` differs from first order by less than this.
        self.neighbours.moved(1.25 * farthest);
        Ok(self.report(contacts, number, time_step.to_f64(), (&ended, retries), farthest))
    }

    /// Whether a block that can move stayed where it was.
    fn any_unmoved(&self, unmoved: &[bool]) -> bool {
        unmoved.iter().enumerate().any(|(block, &unmoved)| unmoved && !self.is_fixed(block))
    }

    /// What a step left as it was. `next` is the state that it leads to.
    fn still_after(
        &self,
        contacts: &[StepContact<R>],
        next: &State<R>,
        unmoved: Vec<bool>,
        (ended, time_step, settling): (&IterationResult<R>, R, bool),
    ) -> Unchanged<R> {
        if !self.any_unmoved(&unmoved) {
            return Unchanged::NONE;
        }
        let moving = |block: usize| !self.is_fixed(block);
        let kept_others = different_pairs(&self.state.contacts, &next.contacts, |contact| M::leaves_kept(contact.mode));
        // Velocities of the scene are set when settling is over.
        if !self.skips.islands || settling != (next.settling > 0) {
            return Unchanged { unmoved, kept_others, islands: None };
        }
        let mut unchanged: Vec<bool> = (0..unmoved.len())
            .map(|block| {
                let same = || same_motion(&self.state.blocks[block], &next.blocks[block]);
                moving(block) && unmoved[block] && !ended.touched[block] && same()
            })
            .collect();
        // What time or its own motion may change.
        for block in self.setup.loads.iter().map(|load| load.block).chain(self.setup.held.iter().map(|held| held.block))
        {
            unchanged[block] = false;
        }
        for pair in &kept_others {
            pair.iter().for_each(|&block| unchanged[block as usize] = false);
        }
        for (contact, after) in contacts.iter().zip(&next.contacts).filter(|(contact, _)| contact.is_closed()) {
            let [a, b] = contact.anchors;
            let before = if contact.plane.a_enters { [a, b] } else { [b, a] };
            if !same_points(&before, &after.anchors) {
                after.blocks.iter().for_each(|&block| unchanged[block as usize] = false);
            }
        }
        let unknowns: Vec<usize> = self.setup.bodies.iter().map(|body| body.motion.unknowns()).collect();
        let blocks: Vec<[u32; 2]> = contacts.iter().map(|contact| contact.blocks).collect();
        let modes: Vec<Mode> = contacts.iter().map(|contact| contact.iterate.mode).collect();
        for island in islands(&unknowns, &blocks, &modes) {
            let all = island.couplings.blocks.iter().all(|&block| unchanged[block as usize]);
            island.couplings.blocks.iter().for_each(|&block| unchanged[block as usize] = all);
        }
        let islands = UnchangedIslands { time_step, settling, blocks: unchanged, d: ended.d.clone() };
        Unchanged { unmoved, kept_others, islands: Some(islands) }
    }
}
