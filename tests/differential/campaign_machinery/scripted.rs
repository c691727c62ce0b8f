//! Toys for the tests of the campaign's machinery: a scripted oracle and engine, whose answers a test chooses, and a
//! counting pair of them, whose answers follow from the pair's index. No geometry is decided here.

use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::engine::{
    Engine, EngineFailure, ExactAnswer, ExactPair, ExactPrepared, Levels, Oracle, Prepared, Trace, WideAnswer,
};
use rockproof_differential::subject::{NamedSet, PairSource, Subject};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{
    Block, BlockOptions, Contact, ContactKey, ContactKind, Entrance, FaceId, Number, Point, Precision, Sign,
    ToleranceSet, VertexId,
};

pub(crate) fn number(value: f64) -> Number {
    Number::from_f64(value).expect("finite")
}

/// A box with one corner at `at` and the given edge.
pub(crate) fn cube(at: f64, edge: f64) -> Block {
    let ends = [number(at), number(at).plus(&number(edge))];
    let corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)];
    let points = corners.map(|(x, y, z)| Point::new(ends[x].clone(), ends[y].clone(), ends[z].clone())).to_vec();
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    Block::new(points, faces.map(|f| f.to_vec()).to_vec(), &BlockOptions { planarity: Number::ZERO }).expect("a box")
}

pub(crate) fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: number(0.5),
        territory: number(0.25),
        penetration: number(0.25),
        overlap_sine: number(0.0625),
        parallel_sine: number(0.0625),
        max_displacement: number(0.125),
        max_rotation: number(0.125),
        ..ToleranceSet::ZERO
    }
}

pub(crate) fn contact(kind: ContactKind, a: u32, b: u32) -> Contact {
    let entrance = Entrance::VertexFace(VertexId(0), FaceId(1));
    Contact { key: ContactKey::of_kind(kind, [a, b]), entrance, gap: Sign::Positive }
}

pub(crate) fn subject(index: u64, a: Block, b: Block) -> Subject {
    let set = NamedSet::same("toy", &tolerances());
    Subject { index, family: "toy".into(), form: "random".into(), a, b, sets: vec![set] }
}

/// An answer and the decisions behind it.
#[derive(Clone, Default)]
pub(crate) struct ScriptedAnswer {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) trace: Trace,
}

/// The four answers of SPEC section 6's chain, and the wide one.
#[derive(Clone)]
pub(crate) struct Script {
    pub(crate) ideal: ScriptedAnswer,
    pub(crate) exact: ScriptedAnswer,
    pub(crate) rounded: ScriptedAnswer,
    pub(crate) engine: Result<ScriptedAnswer, EngineFailure>,
    pub(crate) wide: Option<WideAnswer>,
}

impl Script {
    /// Everybody says the same.
    pub(crate) fn unanimous(contacts: &[Contact]) -> Script {
        let said = ScriptedAnswer { contacts: contacts.to_vec(), trace: Vec::new() };
        Script { ideal: said.clone(), exact: said.clone(), rounded: said.clone(), engine: Ok(said), wide: None }
    }
}

/// Margins by vertex number of the decision's first feature: number n has margin n/1000.
pub(crate) fn decision(n: u32) -> Decision {
    Decision::about(
        Predicate::VertexVertexNear,
        &[Feature::Vertex(Side::A, VertexId(n)), Feature::Vertex(Side::B, VertexId(n))],
    )
}

struct ScriptedOracle(Script);

struct ScriptedPair<'s> {
    script: &'s Script,
    rounded: bool,
}

impl ScriptedPair<'_> {
    fn said(&self, tolerances: &ToleranceSet) -> &ScriptedAnswer {
        match (self.rounded, tolerances.territory.is_zero()) {
            (true, _) => &self.script.rounded,
            (false, true) => &self.script.ideal,
            (false, false) => &self.script.exact,
        }
    }
}

impl Oracle for ScriptedOracle {
    fn prepare<'o>(&'o self, a: &Block, b: &Block) -> Box<dyn ExactPrepared + 'o> {
        let rounded = a.is_exact_in(Precision::F32) && b.is_exact_in(Precision::F32);
        Box::new(ScriptedPair { script: &self.0, rounded })
    }
}

impl ExactPrepared for ScriptedPair<'_> {
    fn pair(&self) -> Box<dyn ExactPair + '_> {
        Box::new(ScriptedPair { script: self.script, rounded: self.rounded })
    }
}

impl ExactPair for ScriptedPair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> ExactAnswer {
        ExactAnswer { contacts: self.said(tolerances).contacts.clone(), levels: Levels([1, 0, 0, 0, 0, 0, 0]) }
    }
    fn trace(&self, tolerances: &ToleranceSet) -> Trace {
        self.said(tolerances).trace.clone()
    }
    fn margins(&self, _: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<f64>> {
        let margin = |decision: &Decision| match decision.features()[0] {
            Some(Feature::Vertex(_, n)) => Some(f64::from(n.0) / 1000.0),
            _ => None,
        };
        decisions.iter().map(margin).collect()
    }
}

struct ScriptedEngine(Script);

impl Engine for ScriptedEngine {
    fn name(&self) -> &str {
        "scripted"
    }
    fn precision(&self) -> Precision {
        Precision::F32
    }
    fn prepare<'p>(&'p self, _: &'p Block, _: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        match &self.0.engine {
            Err(failure @ EngineFailure::Collapsed(_)) => Err(failure.clone()),
            _ => Ok(Box::new(&self.0)),
        }
    }
}

impl Prepared for &Script {
    fn classify(&self, _: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        self.engine.clone().map(|said| said.contacts)
    }
    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        self.engine.as_ref().ok().map(|said| said.trace.clone())
    }
    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        self.wide.clone()
    }
}

/// A panel that plays the script. The pair it is asked about must not be representable in f32, so that the links differ.
pub(crate) fn scripted(script: &Script) -> EnginePanel {
    EnginePanel {
        oracle: Box::new(ScriptedOracle(script.clone())),
        engines: vec![Box::new(ScriptedEngine(script.clone()))],
        metamorphic_every: 0,
    }
}

/// Pairs whose first coordinate is their index.
pub(crate) struct Counting;

pub(crate) const BATCH: u64 = 4;

impl PairSource for Counting {
    fn batch_len(&self) -> u64 {
        BATCH
    }
    fn batch(&self, number: u64) -> Vec<Subject> {
        (number * BATCH..(number + 1) * BATCH)
            .map(|index| {
                let mut subject = subject(index, cube(index as f64, 1.0), cube(index as f64 + 1.0, 1.0));
                subject.family = if index % 3 == 0 { "three".into() } else { "other".into() };
                subject
            })
            .collect()
    }
}

/// An oracle that finds one corner contact, and an engine that misses it at every seventh pair and calls it touching at
/// every eleventh.
struct CountingSide {
    name: &'static str,
    precision: Precision,
    mistaken: bool,
}

impl CountingSide {
    fn contacts(&self, a: &Block) -> Vec<Contact> {
        let index = a.vertices()[0].x.approximate() as u64;
        let right = contact(ContactKind::VertexVertex, 6, 0);
        match (self.mistaken, index % 7, index % 11) {
            (true, 0, _) => Vec::new(),
            (true, _, 0) => vec![Contact { gap: Sign::Zero, ..right }],
            _ => vec![right],
        }
    }
}

struct CountingPair<'p>(&'p CountingSide, Block);

impl Oracle for CountingSide {
    fn prepare<'o>(&'o self, a: &Block, _: &Block) -> Box<dyn ExactPrepared + 'o> {
        Box::new(CountingPair(self, a.clone()))
    }
}

impl ExactPrepared for CountingPair<'_> {
    fn pair(&self) -> Box<dyn ExactPair + '_> {
        Box::new(CountingPair(self.0, self.1.clone()))
    }
}

impl ExactPair for CountingPair<'_> {
    fn classify(&self, _: &ToleranceSet) -> ExactAnswer {
        ExactAnswer { contacts: self.0.contacts(&self.1), levels: Levels([2, 1, 0, 0, 0, 0, 0]) }
    }
    fn trace(&self, _: &ToleranceSet) -> Trace {
        vec![(decision(3), 1)]
    }
    fn margins(&self, _: &ToleranceSet, decisions: &[Decision]) -> Vec<Option<f64>> {
        vec![Some(1e-9); decisions.len()]
    }
}

impl Engine for CountingSide {
    fn name(&self) -> &str {
        self.name
    }
    fn precision(&self) -> Precision {
        self.precision
    }
    fn prepare<'p>(&'p self, a: &'p Block, _: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        Ok(Box::new(CountingPair(self, a.clone())))
    }
}

impl Prepared for CountingPair<'_> {
    fn classify(&self, _: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        Ok(self.0.contacts(&self.1))
    }
    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        Some(vec![(decision(3), 0)])
    }
    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        None
    }
}

/// A panel for [`Counting`].
pub(crate) fn counting() -> EnginePanel {
    let side = |name, mistaken| CountingSide { name, precision: Precision::F64, mistaken };
    EnginePanel {
        oracle: Box::new(side("oracle", false)),
        engines: vec![Box::new(side("right", false)), Box::new(side("mistaken", true))],
        metamorphic_every: 0,
    }
}
