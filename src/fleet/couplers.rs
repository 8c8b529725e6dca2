//! `couplers/`: every coupler of every case as a dataset of Parquet, a file for each chunk, which can be read while the run goes on.

use std::path::Path;
use std::{fs, io};

use super::FleetError;
use super::parquet_file::{self, Column, plain};
use super::rows::{FRONT, Place};
use super::study::Study;
use super::variation;
use crate::findings::CaseFindings;
use crate::report::couplers_csv::{COLUMNS, CouplerRow};
use crate::report::files::{self, WriteError};
use crate::train::Train;

/// The couplers of a chunk's cases.
pub struct Couplers {
    headings: Vec<String>,
    columns: Vec<Column>,
}

impl Couplers {
    /// None yet. The columns are the same in every chunk: those that `fleet.csv` begins with, then those of
    /// `couplers.csv`, even if empty.
    pub fn new(study: Option<&Study>) -> Couplers {
        let front = FRONT.iter().map(|heading| ((*heading).to_owned(), Column::named(heading)));
        let inputs = study.iter().flat_map(|study| variation::headings(study).into_iter().zip(&study.inputs));
        let inputs = inputs.map(|(heading, input)| {
            let is_number = input.spread.unit(input.key.dimension()).is_some();
            (heading, Column::of_input(is_number))
        });
        let couplers = COLUMNS.iter().map(|column| (column.name.to_owned(), Column::of_couplers(column)));
        let (headings, columns) = front.chain(inputs).chain(couplers).unzip();
        Couplers { headings, columns }
    }

    /// Adds those of a case.
    pub fn add(&mut self, place: &Place, train: &Train, scenario: &str, case: &CaseFindings) {
        let before: Vec<_> = place.cells(train).collect();
        for coupler in &case.couplers {
            let row = CouplerRow { scenario, case, coupler };
            let (front, rest) = self.columns.split_at_mut(before.len());
            front.iter_mut().zip(&before).for_each(|(column, cell)| column.add(cell));
            rest.iter_mut().zip(&COLUMNS).for_each(|(column, of)| column.take(of, &row));
        }
    }

    /// Writes the file of a chunk into a folder, made if need be within one that is there.
    ///
    /// # Errors
    /// [`WriteError`] with the path.
    pub fn write(mut self, folder: &Path, chunk: usize) -> Result<(), FleetError> {
        let mut bytes = Vec::new();
        let written = parquet_file::writer(&mut bytes, &self.headings, &self.columns).and_then(|mut to| {
            parquet_file::group(&mut to, &mut self.columns)?;
            to.close()
        });
        let name = format!("{chunk:08}.parquet");
        written.map_err(|e| WriteError::new(&folder.join(&name), plain(e)))?;
        match fs::create_dir(folder) {
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => Err(WriteError::new(folder, e))?,
            _ => files::write_into(folder, &[(name, bytes)])?,
        };
        Ok(())
    }
}
