//! Tables of Parquet, and `fleet.parquet`: the rows of `fleet.csv` with types.
//!
//! That is made from the finished, ordered CSV, so that it holds the same whatever the run went through, a group of rows at a
//! time, so that a fleet of any size needs the memory of one group.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::parts::Run;
use super::rows::{FRONT, TEXTS, WHOLE};
use super::summary::Summary;
use super::{FleetError, rows};
use crate::report::cells::text;
use crate::report::couplers_csv::{self, Cells as Of};
use crate::report::files::Unnamed;

/// Rows of a group: some 20 MB while it is under way.
const GROUP: usize = 32_768;

/// The cells of a column in a group of rows, without nulls, and for each row whether it has one (1) or null (0).
pub struct Column {
    cells: Cells,
    there: Vec<i16>,
}

/// The cells that are there, by kind.
pub enum Cells {
    /// UTF-8.
    Text(Vec<ByteArray>),
    /// Counts and numbers of couplers.
    Whole(Vec<i64>),
    /// Quantities.
    Real(Vec<f64>),
    /// True or false.
    Flag(Vec<bool>),
}

/// Writes the rows of a complete run, whose CSV is at `csv`, to a path.
///
/// A study's input is a column of numbers if it is one in every variation, else of text.
///
/// # Errors
/// A CSV that cannot be read, a file that cannot be written.
pub fn write(csv: &Path, run: &Run, summary: &Summary, path: &Path) -> Result<(), FleetError> {
    let headings = rows::headings(&run.inputs);
    let is_number = |input: usize| summary.columns[input].iter().all(|x| x.is_finite());
    let mut columns: Vec<Column> = headings
        .iter()
        .enumerate()
        .map(|(i, heading)| match i.checked_sub(FRONT.len()).filter(|input| *input < run.inputs.len()) {
            Some(input) => Column::of_input(is_number(input)),
            None => Column::named(heading),
        })
        .collect();
    let unreadable = |e: csv::Error| FleetError::unreadable(csv, &e);
    let mut records = csv::Reader::from_path(csv).map_err(unreadable)?.into_records();
    let mut file = Unnamed::new(path.to_owned())?;
    let mut broken = None;
    file.with(|to| {
        let mut writer = writer(to, &headings, &columns).map_err(plain)?;
        loop {
            let mut rows = 0;
            for record in records.by_ref().take(GROUP) {
                match record {
                    Ok(record) => columns.iter_mut().zip(&record).for_each(|(column, cell)| column.add(cell)),
                    Err(e) => broken = Some(unreadable(e)),
                }
                rows += 1;
            }
            if rows == 0 || broken.is_some() {
                return writer.close().map(|_| ()).map_err(plain);
            }
            group(&mut writer, &mut columns).map_err(plain)?;
        }
    })?;
    match broken {
        Some(error) => Err(error),
        None => Ok(file.finish()?),
    }
}

/// Begins a table of these columns.
///
/// # Errors
/// Whatever the writer reports.
pub fn writer<W: Write + Send>(
    to: W,
    headings: &[String],
    columns: &[Column],
) -> Result<SerializedFileWriter<W>, ParquetError> {
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    SerializedFileWriter::new(to, Arc::new(schema(headings, columns)?), Arc::new(properties))
}

/// Writes the rows that the columns hold, and forgets them.
///
/// # Errors
/// Whatever the writer reports.
pub fn group<W: Write + Send>(to: &mut SerializedFileWriter<W>, columns: &mut [Column]) -> Result<(), ParquetError> {
    let mut group = to.next_row_group()?;
    for column in columns {
        if let Some(to) = group.next_column()? {
            column.write(to)?;
        }
    }
    group.close().map(|_| ())
}

fn schema(headings: &[String], columns: &[Column]) -> Result<Type, ParquetError> {
    let field = |(heading, column): (&String, &Column)| {
        let (physical, logical) = match column.cells {
            Cells::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Cells::Whole(_) => (Physical::INT64, None),
            Cells::Real(_) => (Physical::DOUBLE, None),
            Cells::Flag(_) => (Physical::BOOLEAN, None),
        };
        let field = Type::primitive_type_builder(heading, physical).with_logical_type(logical);
        field.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let fields = headings.iter().zip(columns).map(field).collect::<Result<Vec<_>, _>>()?;
    Type::group_type_builder("fleet").with_fields(fields).build()
}

impl Column {
    /// A column without cells.
    pub fn new(cells: Cells) -> Column {
        Column { cells, there: vec![] }
    }

    /// The column of `fleet.csv` of this name, a study's inputs aside.
    pub fn named(heading: &str) -> Column {
        Column::new(match (TEXTS.contains(&heading), WHOLE.contains(&heading)) {
            (true, _) => Cells::Text(vec![]),
            (_, true) => Cells::Whole(vec![]),
            _ => Cells::Real(vec![]),
        })
    }

    /// A study's input.
    pub fn of_input(is_number: bool) -> Column {
        Column::new(if is_number { Cells::Real(vec![]) } else { Cells::Text(vec![]) })
    }

    /// A cell that is empty is null.
    pub fn add(&mut self, cell: &str) {
        let there = !cell.is_empty() && self.cells.add(cell);
        self.there.push(i16::from(there));
    }

    /// The column of `couplers.csv` with types.
    pub fn of_couplers(column: &couplers_csv::Column) -> Column {
        Column::new(match column.cells {
            Of::Text(_) => Cells::Text(vec![]),
            Of::Whole(_) => Cells::Whole(vec![]),
            Of::Number(_) => Cells::Real(vec![]),
            Of::Flag(_) => Cells::Flag(vec![]),
        })
    }

    /// Adds the cell of a row in the column of `couplers.csv` that this one is made after.
    pub fn take(&mut self, column: &couplers_csv::Column, row: &couplers_csv::CouplerRow) {
        let there = match (&mut self.cells, &column.cells) {
            (Cells::Text(to), Of::Text(of)) => {
                push(to, of(row).map(|cell| text(&cell).into_owned().into_bytes().into()))
            }
            (Cells::Whole(to), Of::Whole(of)) => push(to, of(row).and_then(|cell| i64::try_from(cell).ok())),
            (Cells::Real(to), Of::Number(of)) => push(to, of(row).filter(|cell| cell.is_finite())),
            (Cells::Flag(to), Of::Flag(of)) => push(to, of(row)),
            _ => false,
        };
        self.there.push(i16::from(there));
    }

    /// Writes the group's cells and forgets them.
    fn write(&mut self, mut to: SerializedColumnWriter) -> Result<(), ParquetError> {
        let there = Some(self.there.as_slice());
        match &mut self.cells {
            Cells::Text(cells) => to.typed::<ByteArrayType>().write_batch(cells, there, None).map(|_| cells.clear()),
            Cells::Whole(cells) => to.typed::<Int64Type>().write_batch(cells, there, None).map(|_| cells.clear()),
            Cells::Real(cells) => to.typed::<DoubleType>().write_batch(cells, there, None).map(|_| cells.clear()),
            Cells::Flag(cells) => to.typed::<BoolType>().write_batch(cells, there, None).map(|_| cells.clear()),
        }?;
        self.there.clear();
        to.close()
    }
}

impl Cells {
    /// Adds a cell; whether it could be parsed, as all that this program has written can.
    fn add(&mut self, cell: &str) -> bool {
        match self {
            Cells::Text(cells) => push(cells, Some(cell.as_bytes().to_vec().into())),
            Cells::Whole(cells) => push(cells, cell.parse().ok()),
            Cells::Real(cells) => push(cells, cell.parse().ok()),
            Cells::Flag(cells) => push(cells, cell.parse().ok()),
        }
    }
}

/// Appends a value; whether there is one.
fn push<T>(to: &mut Vec<T>, value: Option<T>) -> bool {
    let there = value.is_some();
    to.extend(value);
    there
}

/// The system's error, where one is the cause, such as a full disk.
pub fn plain(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => inner.downcast::<io::Error>().map_or_else(io::Error::other, |e| *e),
        other => io::Error::other(other),
    }
}
