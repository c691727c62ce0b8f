//! What makes the steps of a campaign: the stepper beside the oracle, in f32 or f64.

use rockproof_differential::collapse::collapsed_feature;
use rockproof_differential::lockstep::penetration::DepthDifference;
use rockproof_differential::lockstep::{ComparedLinks, ComparedStep, DriftQuantity, Lockstep};
use rockproof_differential::motion::PairMotion;
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_model::Precision;
use rockproof_simulate::checkpoint::SavedState;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Mode, Solve, StepRules};
use std::marker::PhantomData;

/// One step, made on both sides.
#[derive(Clone, Debug)]
pub struct ComparedPairStep {
    /// What both did.
    pub compared: ComparedStep,
    /// The state before it.
    pub before: SavedState,
    /// What differs of the state after it where all decisions are the same, and as much in 512 bits: no rounding.
    pub drift: Option<DriftQuantity>,
    /// Contacts by their mode after the last solve of the oracle: open, sliding, locked.
    pub modes: [u64; 3],
    /// Contacts that, exactly, chattered: closed after one solve and open after another of the accepted attempt.
    pub chattering: u64,
}

impl ComparedPairStep {
    /// How the penetrations after it differ, if by more than rounding.
    pub fn depth_difference(&self, subject: &Subject, precision: Precision) -> Option<DepthDifference> {
        DepthDifference::of(&[&subject.a, &subject.b], precision, &self.compared, self.drift.is_some())
    }
}

/// Something that makes steps beside the oracle.
pub trait StepEngine: Send + Sync {
    /// Its name in tables: that of the engine whose arithmetic it is.
    fn name(&self) -> &str;

    /// The precision it calculates in.
    fn precision(&self) -> Precision;

    /// The steps of a pair under a tolerance set; fewer than asked for where one cannot be made.
    ///
    /// # Errors
    /// Why there is not even one: the pair does not survive rounding.
    fn steps(&self, subject: &Subject, set: &NamedSet, motion: &PairMotion) -> Result<Vec<ComparedPairStep>, String>;
}

/// The stepper in the scalar `R` by the rules `M`.
#[derive(Clone, Debug)]
pub struct StepperStepEngine<R, M> {
    name: String,
    precision: Precision,
    code: PhantomData<fn() -> (R, M)>,
}

impl<M: StepRules> StepperStepEngine<f32, M> {
    /// In f32.
    pub fn f32(name: &str) -> Self {
        StepperStepEngine { name: name.to_owned(), precision: Precision::F32, code: PhantomData }
    }
}

impl<M: StepRules> StepperStepEngine<f64, M> {
    /// In f64.
    pub fn f64(name: &str) -> Self {
        StepperStepEngine { name: name.to_owned(), precision: Precision::F64, code: PhantomData }
    }
}

/// The engines of these names that can make steps: the built-in ones.
pub fn engines<'n>(names: impl IntoIterator<Item = &'n str>) -> Vec<Box<dyn StepEngine>> {
    let engine = |name: &str| -> Option<Box<dyn StepEngine>> {
        match name {
            "stepper-f32" => Some(Box::new(StepperStepEngine::<f32, SpecRules>::f32(name))),
            "stepper-f64" => Some(Box::new(StepperStepEngine::<f64, SpecRules>::f64(name))),
            _ => None,
        }
    };
    names.into_iter().filter_map(engine).collect()
}

impl<R: Solve, M: StepRules> StepEngine for StepperStepEngine<R, M> {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn steps(&self, subject: &Subject, set: &NamedSet, motion: &PairMotion) -> Result<Vec<ComparedPairStep>, String> {
        for block in [&subject.a, &subject.b] {
            let rounded = block.rounded(self.precision).ok_or("a coordinate overflows")?;
            if let Some(what) = collapsed_feature(&rounded) {
                return Err(what);
            }
        }
        let tolerances = set.of(self.precision);
        let scene = motion.scene(&subject.a, &subject.b, tolerances);
        let mut lockstep = Lockstep::<R, M>::new(&scene, tolerances, self.precision, ComparedLinks::All)
            .map_err(|failure| failure.to_string())?
            .watching();
        let mut all = Vec::new();
        for _ in 0..motion.steps {
            let before = lockstep.state().clone();
            let (made, compared) = lockstep.step();
            let drift = lockstep.drift(&before, &compared).map(|drift| drift.what);
            let ends = made.is_err() || compared.unproved.is_some();
            all.push(ComparedPairStep {
                before: SavedState::of(&before),
                drift,
                modes: final_modes(&compared),
                chattering: chattering(&compared),
                compared,
            });
            if ends {
                break;
            }
        }
        Ok(all)
    }
}

fn final_modes(compared: &ComparedStep) -> [u64; 3] {
    let last = compared.oracle.as_ref().and_then(|oracle| oracle.modes.last());
    let count = |mode: Mode| last.map_or(0, |modes| modes.iter().filter(|m| **m == mode).count() as u64);
    [count(Mode::Open), count(Mode::Sliding), count(Mode::Locked)]
}

fn chattering(compared: &ComparedStep) -> u64 {
    let Some(oracle) = &compared.oracle else { return 0 };
    let turned = |contact: usize| {
        let closed = || oracle.modes.iter().filter_map(move |all| all.get(contact)).map(|mode| mode.is_closed());
        closed().any(|is| is) && closed().any(|is| !is)
    };
    (0..oracle.contacts.len()).filter(|contact| turned(*contact)).count() as u64
}
