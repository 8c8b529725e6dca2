//! `couplers.csv`: one row per scenario, broken coupler and coupler.

use std::io::Write;

use super::cells::{number, optional, text};
use crate::findings::{Analysis, CaseFindings, CouplerFindings, ScenarioFindings};

const COLUMNS: [&str; 27] = [
    "scenario",
    "broken_coupler",
    "coupler",
    "between_front",
    "between_rear",
    "rated_draft_n",
    "rated_buff_n",
    "initial_force_n",
    "peak_force_n",
    "peak_time_s",
    "utilisation",
    "peak_draft_n",
    "peak_draft_time_s",
    "peak_buff_n",
    "peak_buff_time_s",
    "exceeds",
    "first_exceeds_s",
    "first_exceeds_in",
    "first_passage_peak_draft_n",
    "first_passage_peak_draft_time_s",
    "first_passage_peak_buff_n",
    "first_passage_peak_buff_time_s",
    "first_passage_exceeds",
    "error_estimate_n",
    "all_time_bound_n",
    "limits_passed",
    "limits_undecided",
];

/// Writes every coupler of every case, in the units and with the names of `result.json`.
///
/// A cell is empty where there is no value; numbers read back to the same bits. The last columns are there only where they
/// have something to say: `error_estimate_n` if some error is estimated, `all_time_bound_n` if the bounds were asked for, `limits_passed` and
/// `limits_undecided` if the train has limits. A text that a spreadsheet would take for a formula (it begins with `=`, `+`,
/// `-`, `@`, or a control character) gets an apostrophe before it, which spreadsheets show as plain text.
///
/// # Errors
/// Whatever the writer reports.
pub fn csv(analysis: &Analysis, writer: impl Write) -> Result<(), csv::Error> {
    let cases = || analysis.scenarios.iter().flat_map(|s| s.cases.iter().map(move |c| (s, c)));
    let bounds = cases().any(|(_, case)| case.couplers.iter().any(|c| c.all_time_bound_n.is_some()));
    let estimates = cases().any(|(_, case)| case.error_estimate_n.is_some());
    let limits = cases().any(|(_, case)| case.couplers.iter().any(|c| c.limits.is_some()));
    let shown = |column: usize| match COLUMNS[column] {
        "error_estimate_n" => estimates,
        "all_time_bound_n" => bounds,
        "limits_passed" | "limits_undecided" => limits,
        _ => true,
    };
    let columns: Vec<usize> = (0..COLUMNS.len()).filter(|&c| shown(c)).collect();
    let mut out = csv::Writer::from_writer(writer);
    out.write_record(columns.iter().map(|&c| COLUMNS[c]))?;
    for (scenario, case) in cases() {
        for coupler in &case.couplers {
            let row = row(scenario, case, coupler);
            out.write_record(columns.iter().map(|&c| &row[c]))?;
        }
    }
    out.flush()?;
    Ok(())
}

fn row(scenario: &ScenarioFindings, case: &CaseFindings, c: &CouplerFindings) -> [String; COLUMNS.len()] {
    let passage = c.first_passage.as_ref();
    [
        text(&scenario.name),
        case.broken_coupler.map(|b| b.to_string()).unwrap_or_default(),
        c.coupler.to_string(),
        text(&c.between[0]),
        text(&c.between[1]),
        number(c.rated_draft_n),
        number(c.rated_buff_n),
        number(c.initial_force_n),
        number(c.peak_force_n),
        number(c.peak_time_s),
        number(c.utilisation),
        optional(c.peak_draft_n),
        optional(c.peak_draft_time_s),
        optional(c.peak_buff_n),
        optional(c.peak_buff_time_s),
        c.exceeds.map(|e| e.to_string()).unwrap_or_default(),
        optional(c.first_exceeds_s),
        c.first_exceeds_in.unwrap_or_default().to_owned(),
        optional(passage.and_then(|p| p.peak_draft_n)),
        optional(passage.and_then(|p| p.peak_draft_time_s)),
        optional(passage.and_then(|p| p.peak_buff_n)),
        optional(passage.and_then(|p| p.peak_buff_time_s)),
        passage.and_then(|p| p.exceeds).map(|e| e.to_string()).unwrap_or_default(),
        optional(c.error_estimate_n),
        optional(c.all_time_bound_n),
        c.limits.as_ref().map(|l| l.passed.join(" ")).unwrap_or_default(),
        c.limits.as_ref().map(|l| l.undecided.join(" ")).unwrap_or_default(),
    ]
}
