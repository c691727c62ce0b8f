//! What `check` warns of under a set that a search recommends: no rule is violated, no step of the search shows it, and yet blocks may hang or pass through one another later.

use rockproof_model::tolerance_rules::{Fall, Thin, fall, thin, warnings};
use rockproof_model::{Scene, ToleranceSet};

/// The warnings that `check` has of a scene under a set, each with what mends it; not those about single pairs (the energy of their overlaps, reflex edges).
pub fn rule_warnings(set: &ToleranceSet, scene: &Scene) -> Vec<String> {
    let fall = fall(set, scene).map(|fall| {
        let Fall { block, remedy, .. } = fall;
        format!("a fall from the height of the model may end deeper than `penetration` (block {block}): use {remedy}")
    });
    let thin = thin(set, &scene.shapes()).map(|thin| {
        let Thin { block, remedy, .. } = thin;
        format!("`penetration` is more than half of the thickness of block {block}: use {remedy}")
    });
    let others = warnings(set, scene).into_iter().map(|warning| {
        let by = warning.block.map_or(String::new(), |block| format!(" (block {block})"));
        format!("{}{by}: use {}", warning.kind.title(), warning.remedy)
    });
    fall.into_iter().chain(thin).chain(others).collect()
}
