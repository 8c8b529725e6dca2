//! Analyses.

use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, StringArray};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use trainsafe::findings::{self, CaseFindings, Of, ScenarioFindings, Stop};
use trainsafe::report::{self, CouplerRow, Format};
use trainsafe::solve::Method;
use trainsafe::{Analysis, Options, Train};

use crate::document::Document;
use crate::errors;
use crate::pool::work;
use crate::table::{Table, whole};

/// What was found for a train.
#[pyclass(frozen, module = "trainsafe._native")]
pub struct Findings {
    train: Arc<Train>,
    analysis: Arc<Analysis>,
}

/// Runs a train's scenarios, or one of them.
#[allow(clippy::too_many_arguments)] // They are keywords in Python.
#[pyfunction]
#[pyo3(signature = (document, scenario, tolerance, method, verdict_only, all_time_bound, map, damping))]
pub fn analyze(
    py: Python<'_>,
    document: &Bound<'_, Document>,
    scenario: Option<String>,
    tolerance: f64,
    method: Option<&str>,
    verdict_only: bool,
    all_time_bound: bool,
    map: bool,
    damping: bool,
) -> PyResult<Findings> {
    let train = document.get().train.clone();
    let options = Options { scenario, verdict_only, all_time_bound, map, damping, ..options(tolerance, method)? };
    let (stop, of) = (options.stop.clone(), train.clone());
    let analysis = work(py, &stop, move || {
        // Refuses what would take hours or all memory.
        findings::estimate_s(&of, &options)?;
        findings::analyze(&of, &options)
    })?;
    let analysis = Arc::new(analysis.map_err(|e| errors::analyze(py, &e))?);
    Ok(Findings { train, analysis })
}

/// Options of tolerance and method.
pub fn options(tolerance: f64, method: Option<&str>) -> PyResult<Options> {
    if !(tolerance > 0.0 && tolerance < 1.0) {
        return Err(errors::refused(&"tolerance is a number between 0 and 1, such as 1e-9"));
    }
    let known = |name: &str| {
        let unknown = || format!("no method is named {name:?}; there are fronts, modal and propagator");
        Method::from_name(name).ok_or_else(|| errors::refused(&unknown()))
    };
    Ok(Options { tolerance, method: method.map(known).transpose()?, ..Options::default() })
}

#[pymethods]
impl Findings {
    fn json(&self) -> PyResult<String> {
        report::json(&self.analysis).map_err(|e| errors::os(&e))
    }

    fn summary(&self) -> String {
        report::terminal(&self.analysis, &[])
    }

    /// Every coupler of every case.
    fn couplers(&self, py: Python<'_>) -> PyResult<Table> {
        py.detach(|| {
            let rows: Vec<CouplerRow> = report::coupler_rows(&self.analysis).collect();
            Table::of_rows(&report::coupler_columns(&self.analysis), &rows)
        })
    }

    /// Every case, with its worst coupler.
    fn cases(&self) -> PyResult<Table> {
        cases(&self.analysis)
    }

    fn light_page(&self, py: Python<'_>) -> PyResult<String> {
        let (train, analysis) = (self.train.clone(), self.analysis.clone());
        work(py, &Stop::default(), move || report::light_page(&train, &analysis))
    }

    /// The report's files: names and contents.
    fn documents<'py>(&self, py: Python<'py>, formats: Vec<String>) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let (train, analysis, formats) = (self.train.clone(), self.analysis.clone(), chosen(&formats)?);
        let all = work(py, &Stop::default(), move || report::documents(&train, &analysis, &formats))?;
        let all = all.map_err(|e| errors::os(&e))?;
        Ok(all.into_iter().map(|(name, bytes)| (name, PyBytes::new(py, &bytes))).collect())
    }

    /// Writes the report into a folder; the files' paths.
    fn write(&self, py: Python<'_>, dir: PathBuf, formats: Vec<String>) -> PyResult<Vec<PathBuf>> {
        let (train, analysis, formats) = (self.train.clone(), self.analysis.clone(), chosen(&formats)?);
        let written = work(py, &Stop::default(), move || report::write(&train, &analysis, &dir, &formats))?;
        written.map_err(|e| errors::os(&e))
    }

    /// Utilisation with the force's sign by rows and instants: instants, values, couplers in a row. `None` where it would take long.
    fn field<'py>(
        &self,
        py: Python<'py>,
        scenario: usize,
        case: usize,
        rod: bool,
    ) -> PyResult<Option<FieldParts<'py>>> {
        let (train, analysis) = (self.train.clone(), self.analysis.clone());
        let of = if rod { Of::Rod } else { Of::Event };
        let field = work(py, &Stop::default(), move || {
            let found = &analysis.scenarios[scenario];
            let index = train.scenarios().iter().position(|s| s.name == found.name)?;
            findings::field(&train, index, &found.cases[case], of)
        })?;
        let parts = |field: findings::Field| {
            let times: Vec<u8> = field.times_s.iter().flat_map(|t| t.to_ne_bytes()).collect();
            let share: Vec<u8> = field.share.iter().flat_map(|s| s.to_ne_bytes()).collect();
            (PyBytes::new(py, &times), PyBytes::new(py, &share), field.couplers_per_row)
        };
        Ok(field.map(parts))
    }
}

type FieldParts<'py> = (Bound<'py, PyBytes>, Bound<'py, PyBytes>, usize);

/// Force in a coupler at given times, as doubles: N, s. The broken coupler and the coupler count from 1.
#[pyfunction]
pub fn history<'py>(
    py: Python<'py>,
    document: &Bound<'py, Document>,
    scenario: usize,
    broken: Option<usize>,
    coupler: isize,
    times_s: Vec<f64>,
) -> PyResult<Bound<'py, PyBytes>> {
    let train = document.get().train.clone();
    let couplers = train.couplers().len();
    let coupler = usize::try_from(coupler).unwrap_or(0);
    let known = |number: usize| (1..=couplers).contains(&number);
    if !known(coupler) || !broken.is_none_or(known) || scenario >= train.scenarios().len() {
        return Err(errors::refused(&format!("the train has couplers 1 to {couplers}")));
    }
    if times_s.iter().any(|t| !(*t >= 0.0 && t.is_finite())) || !times_s.is_sorted() {
        return Err(errors::refused(&"times are seconds after the event, zero or more, and rise"));
    }
    let forces = work(py, &Stop::default(), move || {
        findings::history(&train, scenario, broken.map(|b| b - 1), coupler - 1, &times_s)
    })?;
    let bytes: Vec<u8> = forces.iter().flat_map(|force| force.to_ne_bytes()).collect();
    Ok(PyBytes::new(py, &bytes))
}

fn chosen(formats: &[String]) -> PyResult<Vec<Format>> {
    let known = |name: &String| {
        let unknown = || errors::refused(&format!("no form of the report is named {name:?}; there are md and html"));
        Format::ALL.into_iter().find(|format| format.name() == name).ok_or_else(unknown)
    };
    formats.iter().map(known).collect()
}

fn cases(analysis: &Analysis) -> PyResult<Table> {
    type Case<'a> = (&'a ScenarioFindings, &'a CaseFindings);
    let all: Vec<Case> = analysis.scenarios.iter().flat_map(|s| s.cases.iter().map(move |c| (s, c))).collect();
    let text = |of: fn(&Case) -> Option<String>| -> ArrayRef { Arc::new(all.iter().map(of).collect::<StringArray>()) };
    let number = |of: fn(&Case) -> Option<f64>| -> ArrayRef { Arc::new(all.iter().map(of).collect::<Float64Array>()) };
    let count = |of: fn(&Case) -> Option<usize>| -> ArrayRef { Arc::new(whole(all.iter().map(of))) };
    let columns = [
        ("scenario", text(|(s, _)| Some(s.name.clone()))),
        ("kind", text(|(s, _)| Some(s.kind.to_owned()))),
        ("broken_coupler", count(|(_, c)| c.broken_coupler)),
        ("worst_coupler", count(|(_, c)| Some(c.worst.as_ref()?.coupler))),
        ("utilisation", number(|(_, c)| Some(c.worst.as_ref()?.utilisation))),
        ("peak_force_n", number(|(_, c)| Some(c.worst.as_ref()?.peak_force_n))),
        ("peak_time_s", number(|(_, c)| Some(c.worst.as_ref()?.peak_time_s))),
        ("exceeding", count(|(_, c)| Some(c.exceeding))),
        ("undecided", count(|(_, c)| Some(c.undecided))),
        ("first_passage_s", number(|(_, c)| Some(c.first_passage_s))),
        ("exceeding_first_passage", count(|(_, c)| Some(c.exceeding_first_passage))),
        ("safe_load_factor", number(|(_, c)| c.safe_load_factor)),
        ("error_bound_n", number(|(_, c)| Some(c.error_bound_n))),
        ("horizon_s", number(|(_, c)| Some(c.horizon_s))),
        ("method", text(|(_, c)| Some(c.method.to_owned()))),
        ("rod_exceeding", count(|(_, c)| Some(c.rod.as_ref()?.exceeding))),
        ("run_time_s", number(|(_, c)| Some(c.run_time_s))),
    ];
    Table::new(columns.into_iter().map(|(name, array)| (name.to_owned(), array)).collect())
}
