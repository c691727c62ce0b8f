//! Whether tolerances suit a pair of blocks.

use crate::block::Block;
use crate::boundary::text;
use crate::tolerances::{Tolerances, set_for};
use rockproof_model::{Precision, Scene, SceneBlock, tolerance_rules};
use std::ffi::CString;

/// The rules that tolerances break for two blocks. It never changes, so threads may share it.
pub struct Check(pub(crate) Vec<CString>);

impl Check {
    pub(crate) fn of(
        [a, b]: [&Block; 2],
        tolerances: Option<&Tolerances>,
        precision: Precision,
    ) -> Result<Check, String> {
        let set = set_for(tolerances, [a, b], precision)?;
        let blocks = [("a", a), ("b", b)].map(|(name, block)| SceneBlock::new(name, block.block.clone())).to_vec();
        let scene = Scene { blocks, ..Scene::default() };
        let violations = tolerance_rules::check_scene(&set, &scene, precision);
        let sentence = |broken: &tolerance_rules::Violation| text(&format!("{broken} ({})", broken.rule.reason()));
        Ok(Check(violations.iter().map(sentence).collect()))
    }
}
