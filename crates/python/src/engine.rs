//! A Python function as an engine of a campaign.

use crate::block::PyBlock;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rockproof_differential::engine::{Answer, Engine, EngineFailure, Prepared, Trace, WideAnswer};
use rockproof_differential::external::protocol;
use rockproof_differential::finding::Cause;
use rockproof_model::{Block, Contact, Precision, ToleranceSet};
use std::sync::Arc;

/// A function that is asked about pairs. Its answers are those of external engines (`docs/engines.md`), as Python objects.
#[derive(Clone)]
pub(crate) struct PythonEngine {
    name: String,
    precision: Precision,
    functions: Arc<Functions>,
}

struct Functions {
    /// The user's: blocks A and B and a dict of tolerances to an answer.
    engine: Py<PyAny>,
    /// Writes its answer as a line of the protocol.
    line: Py<PyAny>,
}

impl PythonEngine {
    pub(crate) fn new(name: String, precision: Precision, engine: Py<PyAny>, line: Py<PyAny>) -> PythonEngine {
        PythonEngine { name, precision, functions: Arc::new(Functions { engine, line }) }
    }
}

impl Engine for PythonEngine {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn prepare<'p>(&'p self, a: &'p Block, b: &'p Block) -> Result<Box<dyn Prepared + 'p>, EngineFailure> {
        Ok(Box::new(PythonPair { functions: &self.functions, a, b }))
    }

    fn cause(&self) -> Cause {
        Cause::Engine
    }
}

/// A pair for the function.
struct PythonPair<'p> {
    functions: &'p Functions,
    a: &'p Block,
    b: &'p Block,
}

impl PythonPair<'_> {
    fn ask(&self, py: Python<'_>, tolerances: &ToleranceSet) -> Result<String, EngineFailure> {
        let raised = |error: PyErr| EngineFailure::Failed(last_line(py, &error));
        let arguments = || -> PyResult<_> {
            let named = PyDict::new(py);
            for (name, number) in tolerances.numbers() {
                named.set_item(name, number.approximate())?;
            }
            named.set_item("criteria", tolerances.criteria.name())?;
            Ok((PyBlock(self.a.clone()), PyBlock(self.b.clone()), named))
        };
        let answer = arguments().and_then(|all| self.functions.engine.bind(py).call1(all)).map_err(raised)?;
        let line = self.functions.line.bind(py).call1((answer,)).and_then(|line| line.extract());
        line.map_err(|error| EngineFailure::Malformed(last_line(py, &error)))
    }
}

/// The last line of a traceback, with the line of code that raised.
fn last_line(py: Python<'_>, error: &PyErr) -> String {
    let mut at = None;
    let mut traceback = error.traceback(py).map(|traceback| traceback.into_any());
    while let Some(frame) = traceback {
        at = frame.getattr("tb_lineno").and_then(|line| line.extract::<u64>()).ok().or(at);
        traceback = frame.getattr("tb_next").ok().filter(|next| !next.is_none());
    }
    let name = error.get_type(py).name().map_or_else(|_| "an exception".to_owned(), |name| name.to_string());
    let said = error.value(py).to_string();
    let text = if said.is_empty() { name } else { format!("{name}: {said}") };
    at.map_or(text.clone(), |line| format!("{text} (line {line})"))
}

impl Prepared for PythonPair<'_> {
    fn classify(&self, tolerances: &ToleranceSet) -> Result<Vec<Contact>, EngineFailure> {
        self.answer(tolerances)?.into_contacts()
    }

    fn answer(&self, tolerances: &ToleranceSet) -> Result<Answer, EngineFailure> {
        let line = Python::attach(|py| self.ask(py, tolerances))?;
        protocol::answer(line.as_bytes(), 0, [self.a.topology(), self.b.topology()])
    }

    fn trace(&self, _: &ToleranceSet) -> Option<Trace> {
        None
    }

    fn classify_wide(&self, _: &ToleranceSet) -> Option<WideAnswer> {
        None
    }
}
