//! The built-in engines and the oracle behind the campaign's traits.

use super::attribution::EnginePanel;
use super::engine::{
    Engine, EngineFailure, ExactAnswer, ExactPair, ExactPrepared, Levels, Oracle, Prepared, Trace, WideAnswer,
};
use super::finding::{Finding, FindingScope};
use super::indexed_trace::IndexedTrace;
use rockproof_model::decision::Decision;
use rockproof_model::{Block, Contact, ContactKey, ExpectedContact, Precision, ToleranceSet};

use rockproof_stepper::contact::{ContactRules, PreparedBlock, SpecRules, Tolerances, classify, classify_traced};
use rockproof_stepper::engine::{settled_contacts, settled_departures};
use rockproof_stepper::{Collapsed, Real};
use std::marker::PhantomData;

/// The stepper's classification in the scalar `R` by the rules `M`: [`SpecRules`], or those with a deliberate mistake.
#[derive(Clone, Debug)]
pub struct StepperEngine<R, M> {
    name: String,
    precision: Precision,
    code: PhantomData<fn() -> (R, M)>,
}

impl<M: ContactRules> StepperEngine<f32, M> {
    /// The stepper in f32.
    pub fn f32(name: &str) -> Self {
        StepperEngine { name: name.to_owned(), precision: Precision::F32, code: PhantomData }
    }
}

impl<M: ContactRules> StepperEngine<f64, M> {
    /// The stepper in f64.
    pub fn f64(name: &str) -> Self {
        StepperEngine { name: name.to_owned(), precision: Precision::F64, code: PhantomData }
    }
}

/// A pair in the stepper.
struct StepperPair<R, M> {
    a: PreparedBlock<R>,
    b: PreparedBlock<R>,
    code: PhantomData<fn() -> M>,
}

fn collapsed(error: Collapsed) -> EngineFailure {
    EngineFailure::Collapsed(error.to_string())
}

impl<R: Real, M: ContactRules> Engine for StepperEngine<R, M> {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        let (a, b) = (PreparedBlock::new(a).map_err(collapsed)?, PreparedBlock::new(b).map_err(collapsed)?);
        Ok(Box::new(StepperPair::<R, M> { a, b, code: PhantomData }))
    }
}

impl<R: Real, M: ContactRules> Prepared for StepperPair<R, M> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        let tolerances = Tolerances::new(tolerances).map_err(|e| EngineFailure::Unsupported(e.to_string()))?;
        Ok(classify::<R, M>(&self.a, &self.b, &tolerances).into_iter().map(|found| found.contact).collect())
    }

    fn trace(&self, tolerances: &ToleranceSet) -> Option<Trace> {
        let tolerances = Tolerances::new(tolerances).ok()?;
        Some(classify_traced::<R, M>(&self.a, &self.b, &tolerances).1)
    }

    fn classify_wide(&self, tolerances: &ToleranceSet) -> Option<WideAnswer> {
        let settled = settled_contacts::<M>(self.a.block(), self.b.block(), tolerances).ok()?;
        Some(settled.map_or(WideAnswer { contacts: Vec::new(), settled: false }, |contacts| WideAnswer {
            contacts,
            settled: true,
        }))
    }

    fn departs_in_wide(&self, tolerances: &ToleranceSet, expected: &[ExpectedContact]) -> Option<Vec<ContactKey>> {
        settled_departures::<M>(self.a.block(), self.b.block(), tolerances, expected).ok()
    }
}

/// The oracle.
#[derive(Clone, Copy, Debug, Default)]
pub struct BuiltinOracle;

struct BuiltinPrepared {
    a: rockproof_oracle::PreparedBlock,
    b: rockproof_oracle::PreparedBlock,
}

impl Oracle for BuiltinOracle {
    fn prepare<'o>(&'o self, a: &Block, b: &Block) -> Box<dyn ExactPrepared + 'o> {
        Box::new(BuiltinPrepared {
            a: rockproof_oracle::PreparedBlock::new(a),
            b: rockproof_oracle::PreparedBlock::new(b),
        })
    }
}

impl ExactPrepared for BuiltinPrepared {
    fn pair(&self) -> Box<dyn ExactPair + '_> {
        Box::new(rockproof_oracle::Pair::new(&self.a, &self.b))
    }
}

impl ExactPair for rockproof_oracle::Pair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> ExactAnswer {
        let answer = rockproof_oracle::Pair::classify(self, tolerances);
        ExactAnswer { contacts: answer.contacts, levels: Levels(answer.levels.by_name().map(|(_, count)| count)) }
    }

    fn trace(&self, tolerances: &ToleranceSet) -> Trace {
        self.outcomes_with_kept(tolerances, &[]).0
    }

    fn indexed_trace(&self, tolerances: &ToleranceSet) -> IndexedTrace {
        let (decisions, index) = self.outcomes_with_kept(tolerances, &[]);
        IndexedTrace::with_index(decisions, index)
    }

    fn margins(&self, tolerances: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<f64>> {
        rockproof_oracle::Pair::margins(self, tolerances, decisions)
            .into_iter()
            .map(|margin| margin.map(signed))
            .collect()
    }
}

/// A margin with the sign of its polynomial.
pub(crate) fn signed(margin: rockproof_oracle::Margin) -> f64 {
    f64::from(margin.sign.as_i8()) * margin.relative
}

/// The names of the built-in engines.
pub const ENGINES: [&str; 2] = ["stepper-f32", "stepper-f64"];

/// The name in tables of a built-in engine that is called by it or, in short, by its precision.
pub fn full_name(name: &str) -> Option<&'static str> {
    ENGINES.into_iter().find(|full| *full == name || full.strip_prefix("stepper-") == Some(name))
}

/// The built-in engine of a name, if there is one.
pub fn engine(name: &str) -> Option<Box<dyn Engine>> {
    match name {
        "stepper-f32" => Some(Box::new(StepperEngine::<f32, SpecRules>::f32(name))),
        "stepper-f64" => Some(Box::new(StepperEngine::<f64, SpecRules>::f64(name))),
        _ => None,
    }
}

/// The oracle with the engines named, or the first name that no engine has.
///
/// # Errors
/// The unknown name.
pub fn panel(names: &[String], metamorphic_every: u64) -> Result<EnginePanel, String> {
    let engines = names.iter().map(|name| engine(name).ok_or_else(|| name.clone())).collect::<Result<_, _>>()?;
    Ok(EnginePanel { oracle: Box::new(BuiltinOracle), engines, metamorphic_every })
}

/// A panel with no engine that a finding is not about, and metamorphic checks only where it is about one: what it takes to
/// see the finding again.
pub fn panel_for(names: &[String], finding: &Finding) -> EnginePanel {
    narrowed(names.iter().filter_map(|n| engine(n)).collect(), &finding.scope, finding.needs_checks())
}

/// The same of engines at hand, for a finding about `scope` that metamorphic checks show or not. What tolerances or rounding the input do shows with any engine of the precision, so
/// a built-in one stands for them all: it answers at once.
pub fn narrowed(mut engines: Vec<Box<dyn Engine>>, scope: &FindingScope, needs_checks: bool) -> EnginePanel {
    engines.retain(|engine| match scope {
        FindingScope::Any => true,
        FindingScope::Rounded(precision) => engine.precision() == *precision,
        FindingScope::Engine(name) => engine.name() == &**name,
    });
    if !matches!(scope, FindingScope::Engine(_)) {
        let finest = if engines.iter().any(|e| e.precision() == Precision::F64) { ENGINES[1] } else { ENGINES[0] };
        engines = if engines.is_empty() { Vec::new() } else { engine(finest).into_iter().collect() };
    }
    EnginePanel { oracle: Box::new(BuiltinOracle), engines, metamorphic_every: u64::from(needs_checks) }
}
