//! The part of the Python package `trainsafe` that is written in Rust; what its users see is in `python/trainsafe`.

mod analysis;
mod document;
mod errors;
mod fleet;
mod pool;
#[allow(dead_code)]
#[path = "../../src/main.rs"]
mod program;
mod table;

use std::ffi::OsString;

use pyo3::prelude::*;

/// The command line `trainsafe` with these arguments; its exit status.
#[pyfunction]
fn main(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| program::run(std::iter::once("trainsafe".into()).chain(args)))
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", trainsafe::VERSION)?;
    module.add_class::<document::Document>()?;
    module.add_class::<analysis::Findings>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<fleet::FleetRun>()?;
    module.add_function(wrap_pyfunction!(analysis::analyze, module)?)?;
    module.add_function(wrap_pyfunction!(analysis::history, module)?)?;
    module.add_function(wrap_pyfunction!(table::csv_text, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)
}
