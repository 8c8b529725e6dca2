//! Tables of results as Arrow, and tables of other libraries as text.

use std::fmt::Write as _;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{Float32Type, Float64Type, Int64Type, UInt64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::{ArrowError, DataType};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList};
use trainsafe::consist::{cell_of_number, cell_of_text};
use trainsafe::report::{Cells, Column, CouplerRow};

use crate::errors;

/// A table of results: columns of text, whole numbers, numbers and flags, with nulls.
#[pyclass(frozen, module = "trainsafe._native")]
pub struct Table {
    batch: RecordBatch,
}

fn bad(error: &ArrowError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

impl Table {
    /// From named columns of the same length.
    pub fn new(columns: Vec<(String, ArrayRef)>) -> PyResult<Table> {
        let nullable = columns.into_iter().map(|(name, array)| (name, array, true));
        let batch = RecordBatch::try_from_iter_with_nullable(nullable).map_err(|e| bad(&e))?;
        Ok(Table { batch })
    }

    /// The rows of the couplers of an analysis.
    pub fn of_rows(columns: &[&'static Column], rows: &[CouplerRow]) -> PyResult<Table> {
        let array = |column: &&Column| -> ArrayRef {
            match column.cells {
                Cells::Text(of) => Arc::new(rows.iter().map(of).collect::<StringArray>()),
                Cells::Whole(of) => Arc::new(whole(rows.iter().map(of))),
                Cells::Number(of) => Arc::new(rows.iter().map(of).collect::<Float64Array>()),
                Cells::Flag(of) => Arc::new(rows.iter().map(of).collect::<BooleanArray>()),
            }
        };
        Table::new(columns.iter().map(|column| (column.name.to_owned(), array(column))).collect())
    }
}

/// Counts and numbers of couplers.
pub fn whole(numbers: impl Iterator<Item = Option<usize>>) -> Int64Array {
    numbers.map(|number| number.and_then(|n| i64::try_from(n).ok())).collect()
}

#[pymethods]
impl Table {
    /// The table for whoever reads Arrow: pandas, polars, pyarrow, DuckDB.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // There is one schema; whoever asked for another casts.
        let _ = requested_schema;
        let schema = self.batch.schema();
        let stream = FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new([Ok(self.batch.clone())], schema)));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.batch.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// The columns as lists, each with its name and kind.
    fn lists<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, &'static str, Bound<'py, PyList>)>> {
        let schema = self.batch.schema();
        let columns = schema.fields().iter().zip(self.batch.columns());
        let list = |(field, array): (&Arc<arrow_schema::Field>, &ArrayRef)| {
            let (kind, list) = match array.data_type() {
                DataType::Utf8 => ("text", PyList::new(py, array.as_string::<i32>().iter())?),
                DataType::Int64 => ("whole", PyList::new(py, array.as_primitive::<Int64Type>().iter())?),
                DataType::Boolean => ("flag", PyList::new(py, array.as_boolean().iter())?),
                _ => ("number", PyList::new(py, array.as_primitive::<Float64Type>().iter())?),
            };
            Ok((field.name().clone(), kind, list))
        };
        columns.map(list).collect()
    }

    /// The table with these `lists`.
    #[staticmethod]
    fn of_lists(lists: Vec<(String, String, Bound<'_, PyAny>)>) -> PyResult<Table> {
        let array = |kind: &str, list: &Bound<'_, PyAny>| -> PyResult<ArrayRef> {
            Ok(match kind {
                "text" => Arc::new(list.extract::<Vec<Option<String>>>()?.into_iter().collect::<StringArray>()),
                "whole" => Arc::new(list.extract::<Vec<Option<i64>>>()?.into_iter().collect::<Int64Array>()),
                "flag" => Arc::new(list.extract::<Vec<Option<bool>>>()?.into_iter().collect::<BooleanArray>()),
                _ => Arc::new(list.extract::<Vec<Option<f64>>>()?.into_iter().collect::<Float64Array>()),
            })
        };
        let columns = lists.iter().map(|(name, kind, list)| Ok((name.clone(), array(kind, list)?)));
        Table::new(columns.collect::<PyResult<_>>()?)
    }
}

/// Any table that is an Arrow stream, as the text of a CSV file.
#[pyfunction]
pub fn csv_text(capsule: &Bound<'_, PyCapsule>) -> PyResult<String> {
    let mut text = String::new();
    for (i, batch) in stream(capsule)?.enumerate() {
        let batch = batch.map_err(|e| bad(&e))?;
        let schema = batch.schema();
        let names: Vec<String> = schema.fields().iter().map(|field| cell_of_text(field.name())).collect();
        if i == 0 {
            let _ = writeln!(text, "{}", names.join(","));
        }
        let columns = schema.fields().iter().zip(batch.columns());
        let columns: Vec<Vec<String>> =
            columns.map(|(field, array)| cells(field.name(), array)).collect::<PyResult<_>>()?;
        for row in 0..batch.num_rows() {
            let cells: Vec<&str> = columns.iter().map(|column| column[row].as_str()).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
    }
    Ok(text)
}

/// Takes over a stream from its capsule.
#[allow(unsafe_code)]
fn stream(capsule: &Bound<'_, PyCapsule>) -> PyResult<RecordBatchStreamReader> {
    let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?.cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of this name holds such a stream, by the Arrow PyCapsule interface; it is moved out, which leaves a
    // released one behind, so that the capsule's own destructor frees nothing.
    let reader = unsafe { RecordBatchStreamReader::from_raw(pointer.as_ptr()) };
    reader.map_err(|e| bad(&e))
}

/// A column's cells; an absent value is empty.
fn cells(name: &str, array: &ArrayRef) -> PyResult<Vec<String>> {
    use DataType::{Boolean, Decimal128, Dictionary, Float32, Float64, LargeUtf8, Null, Utf8, Utf8View};
    fn texts<'a>(of: impl Iterator<Item = Option<&'a str>>) -> Vec<String> {
        of.map(|cell| cell.map_or_else(String::new, cell_of_text)).collect()
    }
    fn numbers<N: ToString>(of: impl Iterator<Item = Option<N>>) -> Vec<String> {
        of.map(|cell| cell.map_or_else(String::new, |n| cell_of_number(n.to_string()))).collect()
    }
    // Libraries write an absent number as NaN.
    let float = |x: f64| if x.is_nan() { None } else { Some(x) };
    Ok(match array.data_type() {
        Utf8 => texts(array.as_string::<i32>().iter()),
        LargeUtf8 => texts(array.as_string::<i64>().iter()),
        Utf8View => texts(array.as_string_view().iter()),
        Boolean => numbers(array.as_boolean().iter()),
        Float64 => numbers(array.as_primitive::<Float64Type>().iter().map(|x| x.and_then(float))),
        Float32 => numbers(array.as_primitive::<Float32Type>().iter().map(|x| x.filter(|x| !x.is_nan()))),
        Decimal128(..) => {
            let decimals = array.as_primitive::<arrow_array::types::Decimal128Type>();
            numbers((0..decimals.len()).map(|i| decimals.is_valid(i).then(|| decimals.value_as_string(i))))
        }
        kind if kind.is_integer() => integers(array),
        Null => vec![String::new(); array.len()],
        Dictionary(..) => {
            let dictionary = array.as_any_dictionary();
            let words = cells(name, dictionary.values())?;
            let keys = dictionary.normalized_keys();
            let one =
                |(i, key): (usize, &usize)| if dictionary.is_valid(i) { words[*key].clone() } else { String::new() };
            if words.is_empty() { vec![String::new(); array.len()] } else { keys.iter().enumerate().map(one).collect() }
        }
        // A date is no number, so that nothing is computed from it.
        kind if kind.is_temporal() => {
            let one = |i: usize| if array.is_valid(i) { "a date or time".to_owned() } else { String::new() };
            (0..array.len()).map(one).collect()
        }
        kind => {
            return Err(errors::refused(&format!("the column {name:?} holds {kind}, neither text nor numbers")));
        }
    })
}

fn integers(array: &ArrayRef) -> Vec<String> {
    use arrow_array::types::{Int8Type, Int16Type, Int32Type, UInt8Type, UInt16Type, UInt32Type};
    macro_rules! of {
        ($kind:ty) => {
            array.as_primitive::<$kind>().iter().map(|n| n.map_or_else(String::new, |n| n.to_string())).collect()
        };
    }
    match array.data_type() {
        DataType::Int8 => of!(Int8Type),
        DataType::Int16 => of!(Int16Type),
        DataType::Int32 => of!(Int32Type),
        DataType::Int64 => of!(Int64Type),
        DataType::UInt8 => of!(UInt8Type),
        DataType::UInt16 => of!(UInt16Type),
        DataType::UInt32 => of!(UInt32Type),
        _ => of!(UInt64Type),
    }
}
