//! The comparison as text: Markdown, CSV, a table for the terminal, and the files.

use std::io;
use std::path::Path;

use comfy_table::{CellAlignment, Table, presets};

use super::{Accuracy, AccuracyError, Effort, INSTANTS, MethodRow, WATCHED, figure};
use crate::report::files::WriteError;
use crate::report::folder;
use crate::report::markdown::escape;

/// The comparison as a Markdown page that shows `error-against-time.svg` beside it.
pub fn markdown(accuracy: &Accuracy) -> String {
    let Accuracy { couplers: [first, last], horizon_s, rating_n, .. } = accuracy;
    let [train, scenario] = [&accuracy.train, &accuracy.scenario].map(|name| escape(name));
    let event = accuracy.broken_coupler.map_or(String::new(), |b| format!(" Coupler {b} breaks."));
    let of = if accuracy.is_march { "" } else { ", the longest part that is left," };
    let mut page = format!(
        "# Error against run time: {train}\n\n\
         Scenario: {scenario}.{event} Couplers {first} to {last}{of} over {horizon_s:.6} s.\n\n\
         ![Error against run time](error-against-time.svg)\n\n\
         Errors are shares of the largest rating, {rating_n:.6e} N, and newtons in brackets.\n\n"
    );
    page += "| method | setting | run time | work | peak error | force error | claimed bound |\n";
    page += "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
    for row in &accuracy.rows {
        let cell = |n: f64| format!("{:.1e} ({n:.1e} N)", n / rating_n);
        page += &format!(
            "| {} | {} | {} | {} | {} | {} | {} |\n",
            name(row),
            row.setting,
            seconds(row.run_time_s),
            effort(row.work),
            cell(row.peak_error_n),
            cell(row.force_error_n),
            claim(row, "none", cell),
        );
    }
    if !accuracy.left_out.is_empty() {
        page += "\nLeft out:\n\n";
        accuracy.left_out.iter().for_each(|line| page += &format!("- {line}\n"));
    }
    page + &notes(accuracy)
}

/// What a method says of its own error: a bound, or else an estimate, said to be one.
fn claim(row: &MethodRow, none: &str, number: impl Fn(f64) -> String) -> String {
    let estimate = || row.estimate_n.map(|n| format!("estimate {}", number(n)));
    row.bound_n.map(&number).or_else(estimate).unwrap_or_else(|| none.to_owned())
}

/// How the columns were measured.
fn notes(accuracy: &Accuracy) -> String {
    if accuracy.is_march {
        return notes_on_a_march(accuracy);
    }
    let doubt = match accuracy.doubt_n {
        0.0 => String::new(),
        n => format!(
            " Where a force stays at its largest value, as ahead of the wave, that value itself is known to {n:.0e} N."
        ),
    };
    format!(
        "\n- The reference carries 30 digits and more.{doubt}\n\
         - Run time: median of several runs, from the scene to the extremes of all couplers.\n\
         - Peak error: the largest error in any coupler's largest tension or compression over the horizon. A marching \
         method's peak is the best of its steps, as simulators report it.\n\
         - Force error: the largest error in a coupler's force, for a marching method at {INSTANTS} instants spread over \
         the horizon, for this crate's methods at the instants of the extremes that they report; of all couplers, or of \
         {WATCHED} spread over a longer part.\n\
         - Claimed bound: what the method itself says its peaks are off by at most. Marching methods say nothing.\n\
         - h ω_max: the step against the train's fastest oscillation. Störmer-Verlet is stable up to 2, Runge-Kutta 4 up \
         to 2.83, Newmark always.\n"
    )
}

fn notes_on_a_march(accuracy: &Accuracy) -> String {
    format!(
        "\n- The reference is a march from event to event in numbers of 31 digits, in equations of its own. Two of them with other steps \
         differ by {:.0e} N at most.\n\
         - Run time: median of several runs, from the train to the extremes of all couplers.\n\
         - Peak error: the largest error in any coupler's largest draft or buff over the horizon. A peer's peak is the best of its \
         steps, as simulators report it.\n\
         - Force error: the largest error in a coupler's force at {INSTANTS} instants spread over the horizon; of all couplers, or of \
         {WATCHED} spread over a longer train.\n\
         - Claimed bound: what the method itself says its peaks are off by at most; the march gives an estimate by three runs where \
         nothing is proven. The peers say nothing.\n\
         - Clamp: a coupler's force follows the stiffness in series with the gear from that of the last step and is kept between the \
         loading and the unloading curve. Friction smoothed by speed: the mean of both curves, and a share of half their distance that \
         grows with the speed of the elongation up to the limit; Runge-Kutta 4 in steps of h ω_max = 0.5, drag included. Softened \
         lock: Verlet with a clamp, h ω_max = 0.03, and the stiffness in series divided. The last two follow another train: smaller \
         steps do not make them right.\n\
         - h ω_max: the step against the fastest oscillation of the train with every coupler at its stiffest.\n",
        accuracy.doubt_n
    )
}

/// The comparison as CSV: one row per method and setting; a value that does not exist is empty.
///
/// # Errors
/// None in memory but those of the CSV writer.
pub fn csv(accuracy: &Accuracy) -> Result<String, io::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "method",
        "setting",
        "run_time_s",
        "runs",
        "mode_sums",
        "marched",
        "refinements",
        "accelerations",
        "peak_error_n",
        "peak_error_of_rating",
        "force_error_n",
        "force_error_of_rating",
        "error_bound_n",
        "error_bound_of_rating",
        "steps",
        "events",
        "error_estimate_n",
        "error_estimate_of_rating",
    ])?;
    for row in &accuracy.rows {
        let share = |n: f64| format!("{:e}", n / accuracy.rating_n);
        let counts = match row.work {
            Effort::Counted(w) => [Some(w.mode_sums), Some(w.marched), Some(w.refinements), None],
            Effort::Accelerations(a) => [None, None, None, Some(a)],
            Effort::Steps { .. } => [None; 4],
        };
        let steps = match row.work {
            Effort::Steps { steps, events } => [steps, events].map(|n| n.to_string()),
            _ => [String::new(), String::new()],
        };
        let pair = |n: Option<f64>| n.map_or([String::new(), String::new()], |n| [format!("{n:e}"), share(n)]);
        let mut record = vec![name(row), row.setting.clone(), format!("{:e}", row.run_time_s), row.runs.to_string()];
        record.extend(counts.map(|count| count.map_or(String::new(), |c| c.to_string())));
        for error in [Some(row.peak_error_n), Some(row.force_error_n), row.bound_n] {
            record.extend(pair(error));
        }
        record.extend(steps);
        record.extend(pair(row.estimate_n));
        writer.write_record(&record)?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// The comparison as a table of `width` columns for the terminal; errors as shares of the largest rating.
pub fn terminal(accuracy: &Accuracy, width: Option<u16>) -> String {
    let mut table = Table::new();
    let mut style = presets::UTF8_HORIZONTAL_ONLY;
    style.row_separator = presets::NOTHING.row_separator;
    table.load_style(style);
    if let Some(width) = width {
        table.set_width(width);
    }
    table.set_header(["method", "setting", "run time", "peak error", "force error", "claimed bound"]);
    for row in &accuracy.rows {
        let share = |n: f64| format!("{:.1e}", n / accuracy.rating_n);
        table.add_row([
            name(row),
            row.setting.clone(),
            seconds(row.run_time_s),
            share(row.peak_error_n),
            share(row.force_error_n),
            claim(row, "-", share),
        ]);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}

/// Writes `accuracy.md`, `accuracy.csv` and `error-against-time.svg` into a folder, which is made if it is not there.
///
/// They replace those of an earlier run together, as those of [`crate::report`] do.
///
/// # Errors
/// [`AccuracyError::Write`] with the path that could not be written.
pub fn write(accuracy: &Accuracy, dir: &Path) -> Result<(), AccuracyError> {
    let rows = csv(accuracy).map_err(|e| WriteError::new(&dir.join("accuracy.csv"), e))?;
    let texts = [
        ("accuracy.csv".to_owned(), rows.into_bytes()),
        ("error-against-time.svg".to_owned(), figure(accuracy).into_bytes()),
        ("accuracy.md".to_owned(), markdown(accuracy).into_bytes()),
    ];
    folder::replace(dir, &texts, |_| false)?;
    Ok(())
}

fn name(row: &MethodRow) -> String {
    match row.origin {
        super::RowOrigin::Planner(_) => format!("planner: {}", row.method),
        _ => row.method.to_owned(),
    }
}

fn effort(work: Effort) -> String {
    match work {
        Effort::Accelerations(n) => format!("{:.1e} accelerations", n as f64),
        Effort::Steps { steps, events } => format!("{:.1e} steps, {:.1e} events", steps as f64, events as f64),
        Effort::Counted(w) => {
            let parts = [(w.mode_sums, "mode products"), (w.marched, "forces"), (w.refinements, "closer looks")];
            let said = parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{:.1e} {what}", *n as f64));
            said.collect::<Vec<_>>().join(", ")
        }
    }
}

fn seconds(s: f64) -> String {
    if s < 1e-3 {
        format!("{:.1} µs", s * 1e6)
    } else if s < 1.0 {
        format!("{:.2} ms", s * 1e3)
    } else {
        format!("{s:.2} s")
    }
}
