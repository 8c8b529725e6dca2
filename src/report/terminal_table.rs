//! The short table on the terminal.

use std::fmt::Write;
use std::path::PathBuf;

use comfy_table::{CellAlignment, LineStyle, Table, presets};

use super::numbers::{force, percent, time};
use super::{verdict, words};
use crate::error::{harmless, printable_path};
use crate::findings::{Analysis, CaseFindings, CouplerFindings, ScenarioFindings};
use crate::units::UnitSystem;

/// Rows shown of a scenario with many cases.
const ROWS: usize = 5;

/// The verdict on each scenario and its worst couplers, as plain text without colour; `reports` is where the report is.
pub fn terminal(analysis: &Analysis, reports: &[PathBuf]) -> String {
    let mut out = format!(
        "{}: {}, {}\n",
        harmless(&analysis.train),
        words::count(analysis.vehicles, "vehicle"),
        words::count(analysis.couplers, "coupler")
    );
    for scenario in &analysis.scenarios {
        let verdict = verdict::verdict_of(scenario, analysis.units);
        // Writing to a String cannot fail.
        let _ = write!(out, "\n{}\n{}\n", harmless(&scenario.name), harmless(&verdict));
        let passage = verdict::passage(scenario, analysis.units);
        if !passage.is_empty() {
            let _ = writeln!(out, "{passage}");
        }
        let next = super::cascade::sentence(scenario);
        if !next.is_empty() {
            let _ = writeln!(out, "What breaks next: {}", harmless(&next));
        }
        let limits = super::limits::sentences(scenario, analysis.units);
        if !limits.is_empty() {
            let _ = writeln!(out, "{limits}");
        }
        if let Some(table) = table(scenario, analysis.units) {
            let _ = writeln!(out, "{table}");
        }
    }
    if !reports.is_empty() {
        let paths: Vec<String> = reports.iter().map(|p| printable_path(p)).collect();
        let _ = writeln!(out, "\nReport: {}", paths.join(", "));
    }
    out
}

/// The worst coupler of a single case, or of the worst few of many.
fn table(scenario: &ScenarioFindings, units: UnitSystem) -> Option<Table> {
    let mut rows: Vec<(&CaseFindings, &CouplerFindings)> =
        scenario.cases.iter().filter_map(|case| Some((case, case.worst.as_ref()?))).collect();
    if rows.is_empty() {
        return None;
    }
    rows.sort_by(|a, b| b.1.utilisation.total_cmp(&a.1.utilisation));
    let broken = scenario.kind == "break";
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    let columns = ["breaks", "worst coupler", "utilisation", "force", "at", "exceeding", "first to exceed"];
    table.set_header(&columns[usize::from(!broken)..]);
    for (case, worst) in rows.iter().take(ROWS) {
        let first =
            words::first_to_exceed(case).and_then(|c| Some((c.coupler, c.first_exceeds_in?, c.first_exceeds_s?)));
        let cells = [
            case.broken_coupler.map(|b| b.to_string()).unwrap_or_default(),
            worst.coupler.to_string(),
            format!("{} %", percent(worst.utilisation)),
            format!("{} {}", force(units, worst.peak_force_n, case.error_n()), words::sense(worst.peak_force_n)),
            time(worst.peak_time_s),
            case.exceeding.to_string(),
            first.map_or("-".to_owned(), |(coupler, sense, at)| format!("{coupler} in {sense}, {}", time(at))),
        ];
        table.add_row(&cells[usize::from(!broken)..]);
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    Some(table)
}
