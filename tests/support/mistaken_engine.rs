//! A stepper with a mistake, in f64, behind the campaign's trait.

use super::mistakes::Mistaken;
use rockproof_differential::engine::{Engine, EngineFailure, Prepared, Trace, WideAnswer};
use rockproof_model::{Block, Contact, Precision, ToleranceSet};
use rockproof_stepper::Classifier;

/// The engine, by its name and its mistake.
pub(crate) struct OneEngine(pub(crate) &'static str, pub(crate) Mistaken);

struct MistakenPair<'p>(Mistaken, &'p Block, &'p Block);

impl Engine for OneEngine {
    fn name(&self) -> &str {
        self.0
    }

    fn precision(&self) -> Precision {
        Precision::F64
    }

    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        Ok(Box::new(MistakenPair(self.1, a, b)))
    }
}

impl Prepared for MistakenPair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        self.0.f64(self.1, self.2, tolerances).map_err(|e| EngineFailure::Failed(e.to_string()))
    }

    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }

    fn classify_wide(&self, tolerances: &ToleranceSet) -> Option<WideAnswer> {
        let (contacts, unsettled) = self.0.wide(self.1, self.2, tolerances).ok()?;
        Some(WideAnswer { contacts, settled: unsettled == 0 })
    }
}
