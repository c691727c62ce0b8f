//! The penalty stiffness of joints that name none.

use crate::block::{Block, face_normal};
use crate::number::Number;
use crate::simulation::{Body, Simulation};
use crate::tolerance::ToleranceSet;

/// Gives every joint without a normal stiffness one: Young's modulus of the stiffest material times the cube root of
/// the mean block volume, or twice what SPEC section 3 asks for (a block's weight on its smallest face overlaps by no
/// more than `penetration`) if that is stiffer. A choice, not a decision: calculated in f64, and exact from then on.
pub fn derive_stiffness(simulation: &mut Simulation, blocks: &[(&Block, &Body)], set: &ToleranceSet) {
    let moving: Vec<&(&Block, &Body)> = blocks.iter().filter(|(_, body)| !body.is_fixed()).collect();
    let volume = |block: &Block| Number::from_rational(block.volume()).approximate();
    let material = |body: &Body| &simulation.materials[body.material];
    let mean = moving.iter().map(|(block, _)| volume(block)).sum::<f64>() / (moving.len().max(1) as f64);
    let young = moving.iter().map(|(_, body)| material(body).young.approximate()).fold(0.0, f64::max);
    let gravity = simulation.gravity.components().iter().map(|g| g.approximate() * g.approximate()).sum::<f64>().sqrt();
    let allowed = set.penetration.approximate();
    let under_weight = moving.iter().map(|(block, body)| {
        let weight = volume(block) * material(body).density.approximate() * gravity;
        weight / (allowed * smallest_face(block) as f64)
    });
    let softest = if allowed > 0.0 { 2.0 * under_weight.fold(0.0, f64::max) } else { 0.0 };
    let chosen = (young * libm::cbrt(mean)).max(softest);
    let chosen = if chosen.is_finite() && chosen > 0.0 { chosen } else { 1e9 };
    let chosen = Number::from_f64(chosen).unwrap_or(Number::from_integer(1));
    for properties in simulation.joints.all_mut() {
        properties.normal_stiffness.get_or_insert_with(|| chosen.clone());
    }
}

/// The number of corners of the face with the least area.
fn smallest_face(block: &Block) -> usize {
    let points: Vec<_> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let faces = block.topology().faces();
    let areas = faces.iter().map(|face| (face_normal(&points, face).norm_squared(), face.len()));
    areas.min_by(|(one, _), (other, _)| one.cmp(other)).map_or(3, |(_, corners)| corners)
}
