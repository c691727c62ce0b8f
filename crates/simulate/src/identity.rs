//! What must be the same for a run to go on.

use crate::Plan;
use rockproof_model::scene::write_toml;
use rockproof_model::simulation::Skips;
use rockproof_model::{Scene, SpecError, ToleranceSet, ToleranceSpec};
use rockproof_results::digest;
use serde_json::{Map, Value};

/// Everything that determines the bytes of a run but how long it goes on, key by key. The scene is represented by the
/// SHA-256 of its text with exact numbers, the stiffness of joints derived; where it was read from does not matter, nor what steps leave out.
pub fn identity(scene: &Scene, set: &ToleranceSet, engine: &str, plan: &Plan) -> Map<String, Value> {
    let bare = Scene { tolerances: None, ..with_all_skips(scene) };
    let mut map = Map::new();
    map.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
    map.insert("scene".to_owned(), digest(write_toml(&bare).as_bytes()).into());
    map.insert("engine".to_owned(), engine.into());
    for (name, number) in set.numbers() {
        map.insert(name.to_owned(), number.to_string().into());
    }
    map.insert("criteria".to_owned(), set.criteria.name().into());
    map.insert("every".to_owned(), plan.every.into());
    map.insert("contacts".to_owned(), plan.contacts.into());
    map
}

/// The scene as it is run: a TOML text with the stiffness of joints derived and every tolerance as its exact value.
///
/// # Errors
/// None for a set that [`ToleranceSpec::derive`] made.
pub fn with_tolerances(scene: &Scene, set: &ToleranceSet) -> Result<String, SpecError> {
    let mut spec = ToleranceSpec::default();
    for (name, number) in set.numbers() {
        spec.set_text(name, &number.to_string())?;
    }
    spec.set_text("criteria", set.criteria.name())?;
    Ok(write_toml(&Scene { tolerances: Some(spec), ..with_all_skips(scene) }))
}

/// What steps leave out changes no byte of a run, so it is no part of what a run says of its scene.
fn with_all_skips(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.simulation.control.skips = Skips::ALL;
    scene
}
