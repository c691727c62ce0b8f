//! What a step begins with: contacts, what they remember, joints (SPEC 5.2 to 5.6 and 5.15).

use super::answer::{StepFailure, StepModel};
use super::approximate::Layout;
use super::attempt::{Attempt, Joint, force_at};
use super::known_neighbours::KnownNeighbours;
use super::state::{ContactsByPair, State};
use super::strength;
use super::transfer::{StartingContact, transfer};
use crate::{LevelCounts, Pair, PreparedBlock, mass};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::CheckedDiv;
use rockproof_model::{Block, Contact, Number};

/// Everything that the attempts at a step share.
pub(crate) struct PreparedStep<'a> {
    pub(crate) model: &'a StepModel<'a>,
    pub(crate) state: &'a State,
    blocks: Vec<Block>,
    pub(crate) contacts: Vec<([usize; 2], Contact)>,
    pub(crate) contact_levels: LevelCounts,
    started: Vec<StartingContact>,
    joints: Vec<Joint<'a>>,
    fixed_stiffness: Vec<Number>,
    /// Unknowns of each moving block.
    sizes: Vec<usize>,
    /// The place of each block among the moving ones.
    rows: Vec<Option<usize>>,
    pub(crate) layout: Layout,
}

impl<'a> PreparedStep<'a> {
    /// Finds the contacts of a state and what they remember.
    pub(crate) fn new(model: &'a StepModel<'a>, state: &'a State) -> Result<PreparedStep<'a>, StepFailure> {
        PreparedStep::with_contacts(model, state, None)
    }

    /// The same with contacts that are known already, if any are.
    pub(crate) fn with_contacts(
        model: &'a StepModel<'a>,
        state: &'a State,
        known: Option<Vec<([usize; 2], Contact)>>,
    ) -> Result<PreparedStep<'a>, StepFailure> {
        let blocks = blocks_at(model, state);
        if !model.bodies.iter().all(|body| mass::is_elastic(&model.simulation.materials[body.material])) {
            return Err(StepFailure::NoElasticity);
        }
        let (contacts, contact_levels) = match known {
            Some(contacts) => (contacts, LevelCounts::default()),
            None => contacts(model, &blocks, state),
        };
        let started = transfer(&contacts, &state.contacts);
        let joints = joints(model, &blocks, &started)?;
        let sizes: Vec<usize> = model.bodies.iter().map(|b| b.motion.unknowns()).filter(|&n| n > 0).collect();
        let mut next = 0..sizes.len();
        let rows: Vec<Option<usize>> =
            model.bodies.iter().map(|b| if b.is_fixed() { None } else { next.next() }).collect();
        let pairs = started.iter().filter_map(|s| Some([rows[s.blocks[0]]?, rows[s.blocks[1]]?]));
        let moving = blocks.iter().zip(&rows).filter(|(_, row)| row.is_some());
        let at = moving.map(|(block, _)| block.vertices()[0].components().map(|x| x.approximate())).collect();
        let layout = Layout::new(&sizes, pairs, at);
        let fixed_stiffness = fixed_stiffness(model)?;
        Ok(PreparedStep {
            model,
            state,
            blocks,
            contacts,
            contact_levels,
            started,
            joints,
            fixed_stiffness,
            sizes,
            rows,
            layout,
        })
    }

    /// Δt of a full step, in s.
    pub(crate) fn full_time_step(&self) -> BigRational {
        self.model.simulation.control.time_step.to_rational()
    }

    /// An attempt with this Δt.
    pub(crate) fn attempt(&self, time_step: BigRational) -> Attempt<'_> {
        let settling = self.state.settling > 0;
        let loads = if self.model.simulation.loads.is_empty() {
            Vec::new()
        } else {
            let begin = self.state.time.to_rational();
            let time = if settling { begin } else { begin + &time_step };
            self.model.simulation.loads.iter().map(|load| (load.block, force_at(load, &time))).collect()
        };
        Attempt {
            model: self.model,
            state: self.state,
            blocks: &self.blocks,
            started: &self.started,
            joints: &self.joints,
            fixed_stiffness: &self.fixed_stiffness,
            sizes: &self.sizes,
            rows: &self.rows,
            rate: BigRational::from_integer(BigInt::from(2)) / &time_step,
            time_step,
            settling,
            loads,
        }
    }
}

/// The contacts of all neighbours; of each pair those are kept that the step before left closed.
fn contacts(model: &StepModel<'_>, blocks: &[Block], state: &State) -> (Vec<([usize; 2], Contact)>, LevelCounts) {
    let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
    let before = ContactsByPair::new(&state.contacts);
    let (mut found, mut levels) = (Vec::new(), LevelCounts::default());
    for [i, j] in neighbours(model, &prepared) {
        let kept = before.kept([i, j]);
        let answer = Pair::new(&prepared[i], &prepared[j]).classify_with_kept(model.tolerances, &kept);
        levels += answer.levels;
        found.extend(answer.contacts.into_iter().map(|contact| ([i, j], contact)));
    }
    (found, levels)
}

/// The contacts that a step finds in a state, for [`super::certified_step_with`]; of pairs of blocks that have hardly moved since earlier steps, by what is known
/// of them.
pub fn known_contacts(model: &StepModel<'_>, state: &State, known: &mut KnownNeighbours) -> Vec<([usize; 2], Contact)> {
    let prepared: Vec<PreparedBlock> = blocks_at(model, state).iter().map(PreparedBlock::new).collect();
    let before = ContactsByPair::new(&state.contacts);
    known.begin_step();
    let mut found = Vec::new();
    for [i, j] in neighbours(model, &prepared) {
        let pair = Pair::new(&prepared[i], &prepared[j]);
        let contacts = known.contacts([i, j], &pair, model.tolerances, &before.kept([i, j]));
        found.extend(contacts.into_iter().map(|contact| ([i, j], contact)));
    }
    found
}

fn blocks_at(model: &StepModel<'_>, state: &State) -> Vec<Block> {
    let moved = |(shape, block): (&&Block, &super::BlockState)| shape.with_vertices(block.vertices.clone());
    model.shapes.iter().zip(&state.blocks).map(moved).collect()
}

/// The pairs of blocks that a step classifies, in this order: not both fixed, and not proved by f64 to be out of reach; ascending.
pub fn neighbours(model: &StepModel<'_>, prepared: &[PreparedBlock]) -> Vec<[usize; 2]> {
    let ends = prepared.iter().flat_map(|block| block.box_min.iter().chain(&block.box_max));
    let size = ends.fold(0.0f64, |most, end| most.max(end.abs()));
    let search = model.tolerances.search.approximate();
    // A few roundings: of each end, of their difference, of the reach.
    let reach = search + 16.0 * f64::EPSILON * (size + search);
    let mut order: Vec<usize> = (0..prepared.len()).collect();
    order.sort_by(|&i, &j| prepared[i].box_min[0].total_cmp(&prepared[j].box_min[0]));
    let mut pairs = Vec::new();
    for (place, &i) in order.iter().enumerate() {
        for &j in &order[place + 1..] {
            if prepared[j].box_min[0] - prepared[i].box_max[0] > reach {
                break;
            }
            let apart = |k: usize| {
                prepared[j].box_min[k] - prepared[i].box_max[k] > reach
                    || prepared[i].box_min[k] - prepared[j].box_max[k] > reach
            };
            let fixed = model.bodies[i].is_fixed() && model.bodies[j].is_fixed();
            if !fixed && !apart(1) && !apart(2) {
                pairs.push([i.min(j), i.max(j)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// The joint of each contact.
fn joints<'a>(
    model: &StepModel<'a>,
    blocks: &[Block],
    started: &[StartingContact],
) -> Result<Vec<Joint<'a>>, StepFailure> {
    let mut joints = Vec::with_capacity(started.len());
    for pair in started.chunk_by(|one, two| one.blocks == two.blocks) {
        let [i, j] = pair[0].blocks;
        let properties = model.simulation.joints.between(model.bodies[i].joint, model.bodies[j].joint);
        let normal = properties.normal_stiffness.as_ref().ok_or(StepFailure::NoStiffness)?;
        if properties.cohesion.is_zero() && properties.tension.is_zero() {
            joints.extend(pair.iter().map(|_| Joint { properties, normal, cohesive: None, tensile: None }));
            continue;
        }
        let contacts: Vec<Contact> = pair.iter().map(|started| started.contact).collect();
        let areas = strength::shares([&blocks[i], &blocks[j]], &contacts, &model.tolerances.overlap_sine)
            .ok_or(StepFailure::Degenerate)?;
        let over_normal = BigRational::from_integer(1.into()).checked_div(&normal.to_rational());
        for area in areas {
            let stretched = over_normal.as_ref().map(|over| &area * properties.tension.to_rational() * over);
            let cohesive = Some(area * properties.cohesion.to_rational());
            joints.push(Joint { properties, normal, cohesive, tensile: stretched });
        }
    }
    Ok(joints)
}

fn fixed_stiffness(model: &StepModel<'_>) -> Result<Vec<Number>, StepFailure> {
    let stiffest = model.simulation.joints.all().filter_map(|joint| joint.normal_stiffness.as_ref()).max();
    let fixed = model.simulation.fixed_points.iter();
    fixed.map(|f| f.stiffness.as_ref().or(stiffest).cloned().ok_or(StepFailure::NoStiffness)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soundness::without_tolerances;
    use rockproof_model::simulation::{Body, Motion, Simulation};
    use rockproof_model::{ToleranceSet, Vec3};

    #[test]
    fn neighbours_are_two_blocks_within_reach_not_both_fixed() {
        let at = |x, y, z| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z));
        // Cubes of side 2 in the order of their numbers: along x 0 and 2 touch; 1 is 1 beside 2 along y, 3 is 3 above it, and 4 far away.
        let corners = [(0, 0, 0), (2, 3, 0), (2, 0, 0), (2, 0, 5), (20, 0, 0)];
        let blocks = corners.map(|(x, y, z)| Block::cuboid(&at(x, y, z), &at(x + 2, y + 2, z + 2)).unwrap());
        let shapes: Vec<&Block> = blocks.iter().collect();
        let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
        let tolerances = ToleranceSet { search: Number::from_integer(1), ..without_tolerances() };
        let simulation = Simulation::default();
        let of = |motions: [Motion; 5]| {
            let bodies = motions.map(|motion| Body { motion, ..Body::default() });
            let model =
                StepModel { shapes: &shapes, bodies: &bodies, simulation: &simulation, tolerances: &tolerances };
            neighbours(&model, &prepared)
        };
        let (fixed, rigid) = (Motion::Fixed, Motion::Rigid);
        assert_eq!(of([rigid; 5]), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!(of([fixed, rigid, fixed, rigid, rigid]), [[0, 1], [1, 2]]);
        assert_eq!(of([fixed; 5]), [[0usize; 2]; 0]);
    }
}
