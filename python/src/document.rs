//! Trains.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, StringArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use trainsafe::Train;
use trainsafe::consist;
use trainsafe::document::Document as Text;
use trainsafe::doubts::doubts;
use trainsafe::error::InputError;
use trainsafe::train::{Coupler, Source};

use crate::errors;
use crate::table::{Table, whole};

/// A file beside a train file: path, SHA-256 of its bytes, text.
type Held = (PathBuf, Vec<u8>, String);

/// A train file's text, the files it names, and the train that they give.
#[pyclass(frozen, module = "trainsafe._native")]
pub struct Document {
    text: Text,
    pub train: Arc<Train>,
}

fn made(py: Python<'_>, read: Result<(Text, Train), InputError>) -> PyResult<Document> {
    let (text, train) = read.map_err(|e| errors::input(py, &e))?;
    Ok(Document { text, train: Arc::new(train) })
}

#[pymethods]
impl Document {
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Document> {
        made(py, py.detach(|| Text::read(&path)))
    }

    #[staticmethod]
    fn of_text(py: Python<'_>, text: &str, path: PathBuf, held: Vec<Held>) -> PyResult<Document> {
        let source = |(path, sha256, text): Held| -> PyResult<(Source, Arc<str>)> {
            let sha256 = sha256.try_into().map_err(|_| PyValueError::new_err("a SHA-256 has 32 bytes"))?;
            Ok((Source { path, sha256 }, text.into()))
        };
        let held = held.into_iter().map(source).collect::<PyResult<Vec<_>>>()?;
        made(py, py.detach(|| Text::of_text(text, &path, held)))
    }

    /// A copy with another value of a key.
    fn replace(&self, py: Python<'_>, key: &str, value: &str) -> PyResult<Document> {
        let table: Result<toml::Table, _> = format!("value = {value}").parse();
        let value = table.ok().and_then(|mut table| table.remove("value"));
        let value = value.ok_or_else(|| PyValueError::new_err("the value has no form in a train file"))?;
        let (text, train) = py.detach(|| self.text.replace(key, value)).map_err(|e| errors::replace(py, &e))?;
        Ok(Document { text, train: Arc::new(train) })
    }

    #[getter]
    fn path(&self) -> &Path {
        self.text.path()
    }

    #[getter]
    fn text(&self) -> &str {
        self.text.text()
    }

    #[getter]
    fn held<'py>(&self, py: Python<'py>) -> Vec<(PathBuf, Bound<'py, PyBytes>, String)> {
        let one =
            |(source, text): (Source, Arc<str>)| (source.path, PyBytes::new(py, &source.sha256), text.to_string());
        self.text.other_files().into_iter().map(one).collect()
    }

    #[getter]
    fn name(&self) -> &str {
        self.train.name()
    }

    #[getter]
    fn scenarios(&self) -> Vec<String> {
        self.train.scenarios().iter().map(|s| s.name.clone()).collect()
    }

    /// Doubts as code, scenario and text.
    #[getter]
    fn doubts(&self) -> Vec<(&'static str, Option<String>, String)> {
        doubts(&self.train).into_iter().map(|d| (d.code, d.scenario, d.text)).collect()
    }

    fn describe(&self) -> String {
        consist::describe(&self.train)
    }

    fn __len__(&self) -> usize {
        self.train.vehicles().len()
    }

    /// A row for each vehicle and the coupler behind it.
    fn vehicles(&self) -> PyResult<Table> {
        let train = &self.train;
        let count = train.vehicles().len();
        let behind = |of: fn(&Coupler) -> f64| -> ArrayRef {
            Arc::new((0..count).map(|i| train.couplers().get(i).map(of)).collect::<Float64Array>())
        };
        let labels = train.vehicles().iter().map(|v| Some(v.label.as_str()));
        let columns: [(&str, ArrayRef); 9] = [
            ("vehicle", Arc::new(whole((1..=count).map(Some)))),
            ("label", Arc::new(labels.collect::<StringArray>())),
            ("mass_kg", Arc::new(train.vehicles().iter().map(|v| Some(v.mass_kg)).collect::<Float64Array>())),
            ("held", Arc::new(train.vehicles().iter().map(|v| Some(v.held)).collect::<BooleanArray>())),
            ("length_m", Arc::new(train.vehicles().iter().map(|v| v.length_m).collect::<Float64Array>())),
            ("stiffness_n_per_m", behind(|c| c.stiffness_n_per_m)),
            ("rated_draft_n", behind(|c| c.rated_draft_n)),
            ("rated_buff_n", behind(|c| c.rated_buff_n)),
            (
                "initial_force_n",
                Arc::new((0..count).map(|i| train.initial_force_n().get(i).copied()).collect::<Float64Array>()),
            ),
        ];
        Table::new(columns.into_iter().map(|(name, array)| (name.to_owned(), array)).collect())
    }
}
