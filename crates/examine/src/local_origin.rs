//! Whether a model does better relative to a local origin: coordinates far larger than the model take digits that its blocks need.

use crate::assess::Assessment;
use crate::checked::CheckedModel;
use crate::error::ExamineError;
use crate::pairs;
use crate::progress::{Stage, WorkProgress};
use rockproof_differential::subject::NamedSet;
use rockproof_model::block::Point;
use rockproof_model::tolerance_rules::check_scene;
use rockproof_model::{Number, Scene};
use std::sync::atomic::AtomicBool;

/// How a model does relative to a local origin ([`Scene::local_origin`]), where that is better than as it is.
#[derive(Clone, Debug)]
pub struct LocalOrigin {
    /// The point that is taken from all coordinates (m).
    pub origin: Point,
    /// How many of the pairs that are broken in the precision asked for are broken there as well.
    pub broken: usize,
    /// How many rules are violated there, with the same spec of tolerances.
    pub violations: usize,
}

impl LocalOrigin {
    /// Looks again at what is wrong with a model, relative to a local origin: broken pairs and rules. `None` where nothing of that is wrong, coordinates are not far larger
    /// than the model, a local origin is no better, or it was stopped meanwhile.
    ///
    /// # Errors
    /// When tolerances cannot be derived.
    pub(crate) fn of(
        model: &CheckedModel,
        given: &Assessment,
        name: &str,
        (seen, stop): (&WorkProgress, &AtomicBool),
    ) -> Result<Option<LocalOrigin>, ExamineError> {
        let precision = model.precision;
        let is_broken = |pair: &&pairs::ExaminedPair| pair.in_precision(precision).broken > 0;
        let broken: Vec<[usize; 2]> = given.pairs.iter().filter(is_broken).map(|pair| pair.blocks).collect();
        if broken.is_empty() && given.violations.is_empty() {
            return Ok(None);
        }
        let Some(origin) = model.scene.local_origin() else { return Ok(None) };
        let mut scene: Scene = model.scene.clone();
        scene.move_origin_to(&origin);
        let shapes = scene.shapes();
        let [f32, f64] = pairs::PRECISIONS.map(|precision| model.spec.derive(&shapes, precision));
        let sets = NamedSet { name: name.into(), f32: f32?, f64: f64? };
        seen.begin(Stage::Pairs, broken.len());
        let Some(again) = pairs::examine_all(&shapes, &broken, &sets, (seen, stop)) else { return Ok(None) };
        let found = LocalOrigin {
            origin,
            broken: again.iter().filter(is_broken).count(),
            violations: check_scene(sets.of(precision), &scene, precision).len(),
        };
        let [before, after] = [[broken.len(), given.violations.len()], [found.broken, found.violations]];
        let is_better = after != before && after.iter().zip(before).all(|(after, before)| *after <= before);
        Ok(is_better.then_some(found))
    }

    /// Its coordinates.
    pub(crate) fn point(&self) -> String {
        point_in_decimals(&self.origin)
    }
}

/// The coordinates of a point, as decimals where f64 writes them exactly so.
pub fn point_in_decimals(point: &Point) -> String {
    let shown = |coordinate: &Number| {
        let decimal = coordinate.approximate().to_string();
        if Number::parse(&decimal).is_ok_and(|same| same == *coordinate) { decimal } else { coordinate.to_string() }
    };
    point.components().map(shown).join(", ")
}
