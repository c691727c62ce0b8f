//! Rockproof for Python: blocks, exact and floating-point classification, checks, examinations, campaigns with engines written in Python, and steps.
//!
//! This crate converts arguments and answers and decides nothing. What Python sees of it is put together in `python/rockproof/`.

mod arguments;
mod block;
mod campaign;
mod check;
mod contacts;
mod engine;
mod examine;
mod model;
mod number;
mod scene;
mod separation;
mod signals;
mod tolerances;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    rockproof,
    InputError,
    PyValueError,
    "Input that cannot be used: a file, a block, a number, a tolerance or a name.\n\nThe message names the file and line, or the block, what was found and what is allowed."
);

/// The compiled part of `rockproof`.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::InputError;
    #[pymodule_export]
    use super::block::PyBlock;
    #[pymodule_export]
    use super::campaign::{CampaignRun, ExaminedPair, families, run_campaign};
    #[pymodule_export]
    use super::check::{CheckReport, Fall, Overlap, Violation, check};
    #[pymodule_export]
    use super::contacts::{PairContacts, PyContact, classify};
    #[pymodule_export]
    use super::examine::{ExaminationRun, run_examination};
    #[pymodule_export]
    use super::model::{Model, load};
    #[pymodule_export]
    use super::scene::{PyScene, Step, StepContact};
    #[pymodule_export]
    use super::separation::{PyPenetration, PySeparation, penetration, separation};
    #[pymodule_export]
    use super::tolerances::Tolerances;

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
