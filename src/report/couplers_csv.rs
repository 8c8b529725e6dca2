//! `couplers.csv`: one row per scenario, broken coupler and coupler.

use std::io::Write;

use super::cells::{optional, text};
use crate::findings::{Analysis, CaseFindings, CouplerFindings};

/// A row: a coupler in a case.
pub struct CouplerRow<'a> {
    /// The scenario's name.
    pub scenario: &'a str,
    /// Its case.
    pub case: &'a CaseFindings,
    /// The coupler.
    pub coupler: &'a CouplerFindings,
}

/// A column: its name, with the unit as in `result.json`, and its cells.
pub struct Column {
    /// As the header has it.
    pub name: &'static str,
    /// What stands in it.
    pub cells: Cells,
}

/// The cell of a row; `None` where there is no value.
pub enum Cells {
    /// Words.
    Text(fn(&CouplerRow<'_>) -> Option<String>),
    /// Counts and numbers of couplers, from 1.
    Whole(fn(&CouplerRow<'_>) -> Option<usize>),
    /// Quantities in SI units.
    Number(fn(&CouplerRow<'_>) -> Option<f64>),
    /// True or false.
    Flag(fn(&CouplerRow<'_>) -> Option<bool>),
}

/// All of them.
pub static COLUMNS: [Column; 33] = [
    Column { name: "scenario", cells: Cells::Text(|r| Some(r.scenario.to_owned())) },
    Column { name: "broken_coupler", cells: Cells::Whole(|r| r.case.broken_coupler) },
    Column { name: "coupler", cells: Cells::Whole(|r| Some(r.coupler.coupler)) },
    Column { name: "between_front", cells: Cells::Text(|r| Some(r.coupler.between[0].clone())) },
    Column { name: "between_rear", cells: Cells::Text(|r| Some(r.coupler.between[1].clone())) },
    Column { name: "rated_draft_n", cells: Cells::Number(|r| Some(r.coupler.rated_draft_n)) },
    Column { name: "rated_buff_n", cells: Cells::Number(|r| Some(r.coupler.rated_buff_n)) },
    Column { name: "initial_force_n", cells: Cells::Number(|r| Some(r.coupler.initial_force_n)) },
    Column { name: "peak_force_n", cells: Cells::Number(|r| Some(r.coupler.peak_force_n)) },
    Column { name: "peak_time_s", cells: Cells::Number(|r| Some(r.coupler.peak_time_s)) },
    Column { name: "utilisation", cells: Cells::Number(|r| Some(r.coupler.utilisation)) },
    Column { name: "peak_draft_n", cells: Cells::Number(|r| r.coupler.peak_draft_n) },
    Column { name: "peak_draft_time_s", cells: Cells::Number(|r| r.coupler.peak_draft_time_s) },
    Column { name: "peak_buff_n", cells: Cells::Number(|r| r.coupler.peak_buff_n) },
    Column { name: "peak_buff_time_s", cells: Cells::Number(|r| r.coupler.peak_buff_time_s) },
    Column { name: "exceeds", cells: Cells::Flag(|r| r.coupler.exceeds) },
    Column { name: "first_exceeds_s", cells: Cells::Number(|r| r.coupler.first_exceeds_s) },
    Column { name: "first_exceeds_in", cells: Cells::Text(|r| r.coupler.first_exceeds_in.map(str::to_owned)) },
    Column {
        name: "first_passage_peak_draft_n",
        cells: Cells::Number(|r| r.coupler.first_passage.as_ref().and_then(|p| p.peak_draft_n)),
    },
    Column {
        name: "first_passage_peak_draft_time_s",
        cells: Cells::Number(|r| r.coupler.first_passage.as_ref().and_then(|p| p.peak_draft_time_s)),
    },
    Column {
        name: "first_passage_peak_buff_n",
        cells: Cells::Number(|r| r.coupler.first_passage.as_ref().and_then(|p| p.peak_buff_n)),
    },
    Column {
        name: "first_passage_peak_buff_time_s",
        cells: Cells::Number(|r| r.coupler.first_passage.as_ref().and_then(|p| p.peak_buff_time_s)),
    },
    Column {
        name: "first_passage_exceeds",
        cells: Cells::Flag(|r| r.coupler.first_passage.as_ref().and_then(|p| p.exceeds)),
    },
    Column { name: "cascade_peak_draft_n", cells: Cells::Number(|r| r.coupler.cascade.as_ref()?.peak_draft_n) },
    Column {
        name: "cascade_peak_draft_time_s",
        cells: Cells::Number(|r| r.coupler.cascade.as_ref()?.peak_draft_time_s),
    },
    Column { name: "cascade_peak_buff_n", cells: Cells::Number(|r| r.coupler.cascade.as_ref()?.peak_buff_n) },
    Column { name: "cascade_peak_buff_time_s", cells: Cells::Number(|r| r.coupler.cascade.as_ref()?.peak_buff_time_s) },
    Column { name: "cascade_exceeds", cells: Cells::Flag(|r| r.coupler.cascade.as_ref()?.exceeds) },
    Column { name: "cascade_error_estimate_n", cells: Cells::Number(|r| r.coupler.cascade.as_ref()?.error_estimate_n) },
    Column { name: "error_estimate_n", cells: Cells::Number(|r| r.coupler.error_estimate_n) },
    Column { name: "all_time_bound_n", cells: Cells::Number(|r| r.coupler.all_time_bound_n) },
    Column { name: "limits_passed", cells: Cells::Text(|r| r.coupler.limits.as_ref().map(|l| l.passed.join(" "))) },
    Column {
        name: "limits_undecided",
        cells: Cells::Text(|r| r.coupler.limits.as_ref().map(|l| l.undecided.join(" "))),
    },
];

impl Column {
    fn cell(&self, row: &CouplerRow) -> String {
        match self.cells {
            Cells::Text(of) => of(row).map_or_else(String::new, |cell| text(&cell).into_owned()),
            Cells::Whole(of) => of(row).map_or_else(String::new, |cell| cell.to_string()),
            Cells::Number(of) => optional(of(row)),
            Cells::Flag(of) => of(row).map_or_else(String::new, |cell| cell.to_string()),
        }
    }
}

/// The columns that the rows of an analysis have, in their order; the last ones only where they have something to say.
pub fn coupler_columns(analysis: &Analysis) -> Vec<&'static Column> {
    let estimates = coupler_rows(analysis).any(|row| row.case.error_estimate_n.is_some());
    let cascades = coupler_rows(analysis).any(|row| row.coupler.cascade.is_some());
    let bounds = coupler_rows(analysis).any(|row| row.coupler.all_time_bound_n.is_some());
    let limits = coupler_rows(analysis).any(|row| row.coupler.limits.is_some());
    let shown = |column: &&Column| match column.name {
        "error_estimate_n" => estimates,
        "cascade_error_estimate_n" => cascades && estimates,
        name if name.starts_with("cascade_") => cascades,
        "all_time_bound_n" => bounds,
        "limits_passed" | "limits_undecided" => limits,
        _ => true,
    };
    COLUMNS.iter().filter(shown).collect()
}

/// Every coupler of every case.
pub fn coupler_rows(analysis: &Analysis) -> impl Iterator<Item = CouplerRow<'_>> {
    let cases = analysis.scenarios.iter().flat_map(|s| s.cases.iter().map(move |c| (s.name.as_str(), c)));
    cases.flat_map(|(scenario, case)| case.couplers.iter().map(move |coupler| CouplerRow { scenario, case, coupler }))
}

/// Writes every coupler of every case, in the units and with the names of `result.json`.
///
/// A cell is empty where there is no value; numbers read back to the same bits. The last columns are there only where they
/// have something to say: those of the cascade if some scenario has one, `error_estimate_n` if some error is estimated, `all_time_bound_n` if the bounds were asked for, `limits_passed` and
/// `limits_undecided` if the train has limits. A text that a spreadsheet would take for a formula (it begins with `=`, `+`,
/// `-`, `@`, or a control character) gets an apostrophe before it, which spreadsheets show as plain text.
///
/// # Errors
/// Whatever the writer reports.
pub fn csv(analysis: &Analysis, writer: impl Write) -> Result<(), csv::Error> {
    let columns = coupler_columns(analysis);
    let mut out = csv::Writer::from_writer(writer);
    out.write_record(columns.iter().map(|column| column.name))?;
    for row in coupler_rows(analysis) {
        out.write_record(columns.iter().map(|column| column.cell(&row)))?;
    }
    out.flush()?;
    Ok(())
}
