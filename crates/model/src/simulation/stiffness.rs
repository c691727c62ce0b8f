//! The penalty stiffness of joints that name none.

use crate::block::{Block, face_normal};
use crate::number::Number;
use crate::simulation::{Body, Simulation};
use crate::tolerance::ToleranceSet;

/// Gives every joint without a normal stiffness one: Young's modulus of the stiffest material times the cube root of
/// the mean block volume, or twice what SPEC section 3 asks for (a block's weight on its smallest face overlaps by no
/// more than `penetration`) if that is stiffer. A choice, not a decision: calculated in f64, and exact from then on.
pub fn derive_stiffness(simulation: &mut Simulation, blocks: &[(&Block, &Body)], set: &ToleranceSet) {
    derive_stiffness_of(simulation, &moving_blocks(blocks), set);
}

/// A block that can move.
pub(crate) struct MovingBlock<'b> {
    /// Its number among all blocks.
    pub(crate) number: usize,
    pub(crate) block: &'b Block,
    pub(crate) body: &'b Body,
    /// Its volume in m³, rounded to the nearest f64.
    pub(crate) volume: f64,
}

/// The blocks that can move, in the order of all.
pub(crate) fn moving_blocks<'b>(blocks: &[(&'b Block, &'b Body)]) -> Vec<MovingBlock<'b>> {
    let moving = blocks.iter().enumerate().filter(|(_, (_, body))| !body.is_fixed());
    let measured = moving.map(|(number, &(block, body))| {
        let volume = Number::from_rational(block.volume()).approximate();
        MovingBlock { number, block, body, volume }
    });
    measured.collect()
}

/// As [`derive_stiffness`], by the blocks that can move.
pub(crate) fn derive_stiffness_of(simulation: &mut Simulation, moving: &[MovingBlock<'_>], set: &ToleranceSet) {
    let material = |body: &Body| &simulation.materials[body.material];
    let mean = moving.iter().map(|one| one.volume).sum::<f64>() / (moving.len().max(1) as f64);
    let young = moving.iter().map(|one| material(one.body).young.approximate()).fold(0.0, f64::max);
    let gravity = simulation.gravity.components().iter().map(|g| g.approximate() * g.approximate()).sum::<f64>().sqrt();
    let allowed = set.penetration.approximate();
    let under_weight = moving.iter().map(|one| {
        let weight = one.volume * material(one.body).density.approximate() * gravity;
        weight / (allowed * smallest_face(one.block) as f64)
    });
    let softest = if allowed > 0.0 { 2.0 * under_weight.fold(0.0, f64::max) } else { 0.0 };
    let chosen = (young * libm::cbrt(mean)).max(softest);
    let chosen = if chosen.is_finite() && chosen > 0.0 { chosen } else { 1e9 };
    let chosen = Number::from_f64(chosen).unwrap_or(Number::from_integer(1));
    for properties in simulation.joints.all_mut() {
        properties.normal_stiffness.get_or_insert_with(|| chosen.clone());
    }
}

/// The number of corners of the face with the least area; of several, the fewest.
pub(crate) fn smallest_face(block: &Block) -> usize {
    let faces = block.topology().faces();
    let corners = faces.first().map_or(3, Vec::len);
    if faces.iter().all(|face| face.len() == corners) {
        return corners;
    }
    let (_, points) = block.lattice_points();
    let areas = faces.iter().map(|face| (face_normal(&points, face).norm_squared(), face.len()));
    areas.min().map_or(corners, |(_, corners)| corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::{Preset, derive};
    use crate::{Motion, Precision, Vec3};

    fn boxed(x: i32, y: i32, z: i32) -> Block {
        let whole = Number::from_integer;
        Block::cuboid(&Vec3::new(whole(0), whole(0), whole(0)), &Vec3::new(whole(x), whole(y), whole(z))).unwrap()
    }

    fn derived(simulation: &mut Simulation, blocks: &[(&Block, &Body)], penetration: f64) -> Vec<Option<f64>> {
        let shapes: Vec<&Block> = blocks.iter().map(|(block, _)| *block).collect();
        let mut set = derive(Preset::Auto, &shapes, Precision::F64).unwrap();
        set.penetration = Number::from_f64(penetration).unwrap();
        derive_stiffness(simulation, blocks, &set);
        simulation.joints.all().map(|joint| joint.normal_stiffness.as_ref().map(Number::approximate)).collect()
    }

    #[test]
    fn young_times_size_where_that_is_stiff_enough() {
        // Mean volume of what moves: 8 m³, so 1e10 Pa · 2 m.
        let (small, huge, body) = (boxed(2, 2, 2), boxed(9, 9, 9), Body::default());
        let fixed = Body { motion: Motion::Fixed, ..Body::default() };
        let mut simulation = Simulation::default();
        assert_eq!(derived(&mut simulation, &[(&small, &body), (&huge, &fixed)], 0.01), [Some(2e10)]);
    }

    #[test]
    fn the_weight_decides_where_rock_is_soft() {
        let (block, body) = (boxed(2, 2, 8), Body::default());
        let mut simulation = Simulation::default();
        simulation.materials[0].young = Number::from_integer(1);
        simulation.gravity = Vec3::new(Number::ZERO, Number::ZERO, Number::from_integer(-10));
        // 2600 · 32 · 10 N on 4 corners, 1 mm deep: 2.08e8 N/m, of which twice.
        let [Some(stiffness)] = derived(&mut simulation, &[(&block, &body)], 0.001)[..] else { panic!() };
        assert!((stiffness / 4.16e8 - 1.0).abs() < 1e-14, "{stiffness}");
    }

    #[test]
    fn what_is_given_stays() {
        let (block, body) = (boxed(1, 1, 1), Body::default());
        let mut simulation = Simulation::default();
        simulation.joints.other.normal_stiffness = Some(Number::from_integer(7));
        assert_eq!(derived(&mut simulation, &[(&block, &body)], 0.001), [Some(7.0)]);
    }

    #[test]
    fn nothing_that_moves_and_no_penetration_still_give_a_stiffness() {
        let (block, fixed) = (boxed(1, 1, 1), Body { motion: Motion::Fixed, ..Body::default() });
        assert_eq!(derived(&mut Simulation::default(), &[(&block, &fixed)], 0.0), [Some(1e9)]);
    }

    #[test]
    fn the_smallest_face_of_a_prism_is_its_triangle() {
        let point = |x, y, z| Vec3::new(x, y, z).map(|&c| Number::from_integer(c));
        let vertices =
            [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 5), (1, 0, 5), (0, 1, 5)].map(|(x, y, z)| point(x, y, z));
        let faces = [vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]];
        let prism = Block::new(vertices.into(), faces.into(), &crate::BlockOptions::default()).unwrap();
        assert_eq!(smallest_face(&prism), 3);
        assert_eq!(smallest_face(&boxed(1, 2, 3)), 4);
    }
}
