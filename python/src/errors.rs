//! Errors of the library as those of Python.

use std::fmt::Display;

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use trainsafe::document::ReplaceError;
use trainsafe::error::InputError;
use trainsafe::findings::AnalyzeError;
use trainsafe::fleet::FleetError;

/// `trainsafe.InputError` with its problems.
pub fn input(py: Python<'_>, error: &InputError) -> PyErr {
    let (problems, _) = error.problems();
    let json = serde_json::to_string(&problems).unwrap_or_else(|_| "[]".to_owned());
    made(py, "input_error", (error.render(false), json))
}

/// `trainsafe.AnalysisError`.
pub fn analysis(py: Python<'_>, error: &dyn Display) -> PyErr {
    made(py, "analysis_error", (error.to_string(),))
}

/// `trainsafe.AnalysisError` for an invalid argument.
pub fn refused(error: &dyn Display) -> PyErr {
    Python::attach(|py| analysis(py, error))
}

fn made<'py, A: pyo3::call::PyCallArgs<'py>>(py: Python<'py>, name: &str, args: A) -> PyErr {
    match py.import("trainsafe._errors").and_then(|errors| errors.call_method1(name, args)) {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

pub fn analyze(py: Python<'_>, error: &AnalyzeError) -> PyErr {
    analysis(py, error)
}

pub fn replace(py: Python<'_>, error: &ReplaceError) -> PyErr {
    match error {
        ReplaceError::Input(error) => input(py, error),
        ReplaceError::Key(_) => analysis(py, error),
    }
}

pub fn fleet(py: Python<'_>, error: &FleetError) -> PyErr {
    match error {
        FleetError::Study(error) => input(py, error),
        _ => analysis(py, error),
    }
}

pub fn os(error: &dyn Display) -> PyErr {
    PyOSError::new_err(error.to_string())
}
