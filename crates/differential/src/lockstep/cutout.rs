//! A part of a scene in motion: some of its blocks in the state in which they are, as a scene of their own.

use rockproof_model::Scene;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{BlockState, ContactState, State};

/// Some blocks of a scene, in ascending order, and what a state says of them: their contacts with one another, and the points on them. The
/// scene's stiffnesses are derived ([`Scene::derive_stiffness`]), so that they stay what they are.
pub fn cutout<R: Real>(scene: &Scene, state: &State<R>, blocks: &[usize]) -> (Scene, State<R>) {
    let place = |block: usize| blocks.binary_search(&block).ok();
    let mut part = Scene { blocks: Vec::new(), ..scene.clone() };
    part.blocks = blocks.iter().map(|&block| scene.blocks[block].clone()).collect();
    let simulation = &mut part.simulation;
    simulation.loads.retain_mut(|load| place(load.block).map(|to| load.block = to).is_some());
    simulation.fixed_points.retain_mut(|point| place(point.block).map(|to| point.block = to).is_some());
    simulation.measured_points.retain_mut(|point| place(point.block).map(|to| point.block = to).is_some());
    let on_kept = |block: usize| place(block).is_some();
    let old = &scene.simulation;
    let states: Vec<BlockState<R>> = blocks.iter().map(|&block| state.blocks[block].clone()).collect();
    let contact = |contact: &ContactState<R>| {
        let [a, b] = contact.blocks.map(|block| place(block as usize));
        let blocks = [a? as u32, b? as u32];
        Some(ContactState { blocks, ..contact.clone() })
    };
    let cut = State {
        blocks: states,
        load_points: kept(&state.load_points, old.loads.iter().map(|load| on_kept(load.block))),
        fixed_points: kept(&state.fixed_points, old.fixed_points.iter().map(|point| on_kept(point.block))),
        measured_points: kept(&state.measured_points, old.measured_points.iter().map(|point| on_kept(point.block))),
        contacts: state.contacts.iter().filter_map(contact).collect(),
        ..state.clone()
    };
    (part, cut)
}

/// Those that are wanted.
fn kept<T: Copy>(all: &[T], wanted: impl Iterator<Item = bool>) -> Vec<T> {
    all.iter().zip(wanted).filter(|(_, wanted)| *wanted).map(|(one, _)| *one).collect()
}
