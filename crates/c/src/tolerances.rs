//! Tolerances: a preset, and values that replace some of its own.

use crate::block::Block;
use rockproof_model::{Precision, ToleranceSet, ToleranceSpec};

/// Tolerances. Setting a value is the only change; threads may share them while nobody does.
pub struct Tolerances(ToleranceSpec);

impl Tolerances {
    pub(crate) fn of_preset(preset: &str) -> Result<Tolerances, String> {
        let mut spec = ToleranceSpec::empty();
        spec.set_text("preset", preset).map_err(|error| error.to_string())?;
        Ok(Tolerances(spec))
    }

    pub(crate) fn set(&mut self, assignment: &str) -> Result<(), String> {
        self.0.assign(assignment).map_err(|error| error.to_string())
    }
}

/// The tolerances that are meant for two blocks: of the preset `auto` where none are given.
pub(crate) fn set_for(
    tolerances: Option<&Tolerances>,
    blocks: [&Block; 2],
    precision: Precision,
) -> Result<ToleranceSet, String> {
    let default = ToleranceSpec::default();
    let spec = tolerances.map_or(&default, |given| &given.0);
    let set = spec.derive(&blocks.map(|block| &block.block), precision).map_err(|error| error.to_string())?;
    match set.rounded(precision) {
        Ok(_) => Ok(set),
        Err(name) => Err(format!("tolerance `{name}` overflows when rounded to {precision}")),
    }
}
