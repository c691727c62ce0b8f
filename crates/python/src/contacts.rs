//! Contacts of pairs of blocks, exactly or as a program in floats finds them.

use crate::arguments::{Arithmetic, input_error};
use crate::block::PyBlock;
use crate::number::exact_root;
use crate::tolerances::{set_for, spec_of};
use num_rational::BigRational;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rockproof_model::{Block, Contact, Number, Precision, ToleranceSet};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{Gap, Pair, PreparedBlock};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{
    PreparedBlock as PreparedFloatBlock, SpecRules, Tolerances, classify as classify_in_floats,
};

/// One contact of a pair: which feature of A touches which of B, and the plane through which the blocks enter one another.
#[pyclass(frozen, name = "Contact", module = "rockproof", eq)]
#[derive(Clone, PartialEq)]
pub(crate) struct PyContact {
    pub(crate) contact: Contact,
    gap: ContactGap,
}

/// How far apart the blocks are at a contact.
#[derive(Clone, PartialEq)]
enum ContactGap {
    /// As the oracle has it.
    Exact(Gap),
    /// As a program in floats has it (m).
    Float(f64),
}

#[pymethods]
impl PyContact {
    /// "v-v", "v-e", "e-v", "v-f", "f-v" or "e-e"; A's feature is named first.
    #[getter]
    fn kind(&self) -> &'static str {
        self.contact.kind().name()
    }

    /// A's feature: its place among the block's vertices, edges or faces, by `kind`.
    #[getter]
    fn feature_a(&self) -> u32 {
        self.contact.key.numbers()[0]
    }

    /// B's feature, likewise.
    #[getter]
    fn feature_b(&self) -> u32 {
        self.contact.key.numbers()[1]
    }

    /// The features that span the entrance plane: "v-f", "f-v" or "e-e".
    #[getter]
    fn entrance(&self) -> &'static str {
        self.contact.entrance.kind().name()
    }

    /// A's feature of the entrance plane.
    #[getter]
    fn entrance_a(&self) -> u32 {
        self.contact.entrance.numbers()[0]
    }

    /// B's feature of the entrance plane.
    #[getter]
    fn entrance_b(&self) -> u32 {
        self.contact.entrance.numbers()[1]
    }

    /// 1 apart, 0 touching, -1 overlapping.
    #[getter]
    fn gap_sign(&self) -> i8 {
        self.contact.gap.as_i8()
    }

    /// The gap in metres as a Fraction, negative for an overlap; None where it is irrational. Of a float engine, the number it calculated.
    #[getter]
    fn gap(&self) -> Option<BigRational> {
        match &self.gap {
            ContactGap::Exact(gap) => signed(exact_root(&gap.squared)?, gap.sign.is_negative()),
            ContactGap::Float(gap) => Number::from_f64(*gap).ok().map(|gap| gap.to_rational()),
        }
    }

    /// The square of the gap in m², exactly.
    #[getter]
    fn gap_squared(&self) -> Option<BigRational> {
        match &self.gap {
            ContactGap::Exact(gap) => Some(gap.squared.clone()),
            ContactGap::Float(gap) => Number::from_f64(*gap).ok().map(|gap| gap.to_rational().squared()),
        }
    }

    /// The gap in metres to the nearest float, negative for an overlap.
    #[getter]
    fn gap_m(&self) -> f64 {
        match &self.gap {
            ContactGap::Exact(gap) => {
                let size = gap.squared.sqrt_rounded().unwrap_or(f64::INFINITY);
                if gap.sign.is_negative() { -size } else { size }
            }
            ContactGap::Float(gap) => *gap,
        }
    }

    /// What identifies the contact as an engine answers it: a dict of kind, features, entrance and gap.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("kind", self.kind())?;
        dict.set_item("feature_a", self.feature_a())?;
        dict.set_item("feature_b", self.feature_b())?;
        dict.set_item("entrance", self.entrance())?;
        dict.set_item("entrance_a", self.entrance_a())?;
        dict.set_item("entrance_b", self.entrance_b())?;
        dict.set_item("gap_sign", self.gap_sign())?;
        dict.set_item("gap_m", self.gap_m())?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let (kind, [a, b]) = (self.contact.kind(), self.contact.key.numbers());
        format!("<Contact {kind} {a},{b}: gap {:?} m>", self.gap_m())
    }
}

fn signed(size: BigRational, negative: bool) -> Option<BigRational> {
    Some(if negative { -size } else { size })
}

/// The contacts between two blocks of a model.
#[pyclass(frozen, module = "rockproof", get_all)]
pub(crate) struct PairContacts {
    /// The number of the first block.
    a: usize,
    /// The number of the second block.
    b: usize,
    /// The contacts, sorted by kind and features.
    contacts: Vec<Py<PyContact>>,
}

#[pymethods]
impl PairContacts {
    fn __repr__(&self) -> String {
        format!("<PairContacts {}–{}: {} contacts>", self.a, self.b, self.contacts.len())
    }
}

impl PairContacts {
    pub(crate) fn new(py: Python<'_>, (a, b): (usize, usize), contacts: Vec<PyContact>) -> PyResult<PairContacts> {
        let contacts = contacts.into_iter().map(|contact| Py::new(py, contact)).collect::<PyResult<_>>()?;
        Ok(PairContacts { a, b, contacts })
    }
}

/// The contacts of two blocks, sorted by kind and features.
///
/// `engine` is "exact" (the oracle), "f64" or "f32" (the float code, which rounds blocks and tolerances to its precision first). `tolerances` is a
/// Tolerances, a preset's name or a dict of values; "auto" if it is not given, derived from the two blocks.
#[pyfunction]
#[pyo3(signature = (a, b, tolerances=None, *, engine="exact"))]
pub(crate) fn classify(
    py: Python<'_>,
    a: &PyBlock,
    b: &PyBlock,
    tolerances: Option<&Bound<'_, PyAny>>,
    engine: &str,
) -> PyResult<Vec<PyContact>> {
    let engine = Arithmetic::named(engine, "engine")?;
    let spec = spec_of(tolerances, None)?;
    py.detach(|| {
        let blocks = [&a.0, &b.0];
        let set = set_for(&spec, &blocks, engine.precision())?;
        let all = PreparedBlocks::new(&blocks, &["a".to_owned(), "b".to_owned()], engine, &set)?;
        Ok(all.contacts((0, 1), &set))
    })
}

/// Blocks prepared for an engine.
pub(crate) enum PreparedBlocks {
    Exact(Vec<PreparedBlock>),
    F64(Vec<PreparedFloatBlock<f64>>, Tolerances<f64>),
    F32(Vec<PreparedFloatBlock<f32>>, Tolerances<f32>),
}

impl PreparedBlocks {
    /// Prepares blocks; `names` are what messages call them.
    ///
    /// # Errors
    /// `InputError` where a block does not survive rounding.
    pub(crate) fn new(
        blocks: &[&Block],
        names: &[String],
        engine: Arithmetic,
        set: &ToleranceSet,
    ) -> PyResult<PreparedBlocks> {
        Ok(match engine {
            Arithmetic::Exact => PreparedBlocks::Exact(blocks.iter().map(|block| PreparedBlock::new(block)).collect()),
            Arithmetic::Float(Precision::F64) => PreparedBlocks::F64(in_floats(blocks, names)?, rounded(set)?),
            Arithmetic::Float(Precision::F32) => PreparedBlocks::F32(in_floats(blocks, names)?, rounded(set)?),
        })
    }

    /// The contacts of a pair.
    pub(crate) fn contacts(&self, (a, b): (usize, usize), set: &ToleranceSet) -> Vec<PyContact> {
        match self {
            PreparedBlocks::Exact(prepared) => {
                let pair = Pair::new(&prepared[a], &prepared[b]);
                let with_gap =
                    |contact: Contact| PyContact { contact, gap: ContactGap::Exact(pair.gap(&contact.entrance)) };
                pair.classify(set).contacts.into_iter().map(with_gap).collect()
            }
            PreparedBlocks::F64(prepared, tolerances) => of_floats(&prepared[a], &prepared[b], tolerances),
            PreparedBlocks::F32(prepared, tolerances) => of_floats(&prepared[a], &prepared[b], tolerances),
        }
    }
}

fn rounded<R: Real>(set: &ToleranceSet) -> PyResult<Tolerances<R>> {
    Tolerances::new(set).map_err(input_error)
}

fn in_floats<R: Real>(blocks: &[&Block], names: &[String]) -> PyResult<Vec<PreparedFloatBlock<R>>> {
    let prepare = |(block, name): (&&Block, &String)| {
        PreparedFloatBlock::new(block).map_err(|error| input_error(format!("block {name}: {error}")))
    };
    blocks.iter().zip(names).map(prepare).collect()
}

fn of_floats<R: Real + Into<f64>>(
    a: &PreparedFloatBlock<R>,
    b: &PreparedFloatBlock<R>,
    tolerances: &Tolerances<R>,
) -> Vec<PyContact> {
    let found = classify_in_floats::<R, SpecRules>(a, b, tolerances).into_iter();
    found.map(|found| PyContact { contact: found.contact, gap: ContactGap::Float(found.gap.into()) }).collect()
}
