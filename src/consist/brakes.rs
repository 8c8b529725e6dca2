//! Brake applications, power that is cut, and throttle schedules of a train file's scenarios.
//!
//! Named applications are round figures for a kind of brake, not those of one valve:
//!
//! | name | wave | build-up | from |
//! | --- | --- | --- | --- |
//! | `"AAR"`, emergency | 290 m/s | 30 % in 1.5 s, all in 8 s | 900-950 ft/s of ABD, ABDX and DB-60 valves; full after 7-12 s (common knowledge) |
//! | `"AAR"`, service | 244 m/s | 83 % in 30 s | 800 ft/s and about 30 s: ALTRIOS, `friction_brakes.rs`; emergency 20 % over full service: TM 55-203 |
//! | `"UIC G"` | 250 m/s | all in 24 s | filling in 18-30 s: UIC 543, as quoted by railwaynews.net; at least 250 m/s: UIC 540 (common knowledge) |
//! | `"UIC P"` | 250 m/s | all in 4 s | filling in 3-5 s: the same |

use std::path::Path;

use super::Files;
use super::heading::{Content, Wanted};
use super::keys::{APPLICATION_TABLE, BUILD_UP, PRESETS};
use super::sheet::{Record, Sheet};
use super::tree::{Read, Table, Value};
use crate::error::{InputError, Problem, Problems, printable_path, quoted};
use crate::train::{Application, Doubt, Forcing, Vehicle, more};
use crate::units::{self, Amount, Dimension, UnitSystem, one_of, shown, shown_time};

/// The named application: an emergency or a service one.
fn preset(name: &'static str, emergency: bool) -> Application {
    let (wave_m_per_s, build_up) = match (name, emergency) {
        ("AAR", true) => (290.0, vec![[0.0, 0.0], [1.5, 0.3], [8.0, 1.0]]),
        ("AAR", false) => (244.0, vec![[0.0, 0.0], [30.0, 0.83]]),
        ("UIC G", _) => (250.0, vec![[0.0, 0.0], [24.0, 1.0]]),
        _ => (250.0, vec![[0.0, 0.0], [4.0, 1.0]]),
    };
    Application { name: Some(name), wave_m_per_s, build_up }
}

/// The table that a named application of `emergency` or `service` stands for; `None` for another word.
pub(crate) fn application_table(key: &str, name: &str) -> Option<toml::Table> {
    let Application { wave_m_per_s, build_up, .. } =
        preset(PRESETS.into_iter().find(|known| *known == name)?, key == "emergency");
    let row = |&[time_s, share]: &[f64; 2]| vec![format!("{time_s} s"), format!("{} %", 100.0 * share)];
    let rows: Vec<Vec<String>> = build_up.iter().map(row).collect();
    Some(
        [("wave".to_owned(), format!("{wave_m_per_s} m/s").into()), ("build_up".to_owned(), rows.into())]
            .into_iter()
            .collect(),
    )
}

/// Reads `emergency` or `service`.
pub(super) fn application(value: &Value, emergency: bool) -> Read<Application> {
    let Some(table) = value.table_if(&APPLICATION_TABLE) else {
        if value.as_text().is_none() {
            let right = "expected \"AAR\", \"UIC G\" or \"UIC P\", or { wave = \"290 m/s\", build_up = [[\"0 s\", \"0 %\"], [\"8 s\", \"100 %\"]] }";
            return Err(value.wrong_type(right));
        }
        return Ok(preset(value.word_of(&PRESETS)?, emergency));
    };
    let table = table?;
    let wave =
        table.require("wave", "add wave = \"290 m/s\", how fast it runs along the train").and_then(|v| v.quantity());
    let right = "add build_up = [[\"0 s\", \"0 %\"], [\"8 s\", \"100 %\"]], times and shares of emergency_brake";
    let build_up = table.require("build_up", right).and_then(|v| points(&v));
    let (wave_m_per_s, build_up) = (wave?, build_up?);
    Ok(Application { name: None, wave_m_per_s, build_up })
}

fn points(value: &Value) -> Read<Vec<[f64; 2]>> {
    let right = "expected rows of a time and a share: [[\"0 s\", \"0 %\"], [\"8 s\", \"100 %\"]]";
    let rows = value.rows(&BUILD_UP, 2, right)?;
    Ok(rows.iter().map(|row| [row[0], row[1]]).collect())
}

/// Changes of tractive efforts after the event, as forces on vehicles over time.
pub(super) fn efforts(
    table: &Table,
    vehicles: &[Vehicle],
    traction_n: &[f64],
    path: &Path,
    files: &Files,
) -> Read<Vec<Forcing>> {
    let (cut, throttle) = (table.get("cut_power"), table.get("throttle"));
    if let (Some(cut), Some(throttle)) = (&cut, &throttle) {
        let help = "keep one of them: a schedule whose last force is 0 cuts the power too";
        return Err(cut.wrong_because("cut_power beside a throttle schedule", help, throttle.span(), "the schedule"));
    }
    let Some(value) = cut.as_ref().or(throttle.as_ref()) else { return Ok(vec![]) };
    let pulls: Vec<usize> = (0..traction_n.len()).filter(|&v| traction_n[v] > 0.0).collect();
    if pulls.is_empty() && (cut.is_some() || traction_n.iter().all(|f| *f == 0.0)) {
        let help = "give the locomotives a tractive_effort in the place of [load] uniform";
        return Err(value.wrong(format!("{} of a train without tractive effort", value.name_of_key()), help));
    }
    if cut.is_some() {
        let [after_s, over_s] = cut_power(&value.table()?)?;
        let course =
            |v: usize| Forcing { vehicle: v, points: vec![[after_s, 0.0], [after_s + over_s, -traction_n[v]]] };
        return Ok(pulls.into_iter().map(course).collect());
    }
    let (file, text) = value.text_beside(path, files, |text| Sheet::open(text, &wanted(), &[0]).is_ok())?;
    let (courses, doubts) = schedule(&text, &file, vehicles, traction_n).map_err(|bad| value.refer(&bad))?;
    doubts.into_iter().for_each(|doubt| value.doubt(doubt));
    Ok(courses)
}

fn cut_power(table: &Table) -> Read<[f64; 2]> {
    let after =
        table.require("after", "add after = \"3 s\", when tractive efforts begin to fall").and_then(|v| v.quantity());
    let over = table.get("over").map(|v| v.quantity()).transpose();
    let (after, over) = (after?, over?);
    Ok([after, over.unwrap_or(0.0)])
}

/// A schedule that starts later than this after the event, s, is probably on another clock.
const LATE_S: f64 = 60.0;

/// If no share is larger, the schedule was probably written in shares of 1.
const LARGEST_DOUBTFUL_SHARE: f64 = 0.01 + 1e-9;

/// A tractive effort of less, N, is none.
const FAINT_N: f64 = 1e3;

/// A schedule that starts with a change of more than this share of the largest effort jumps.
const JUMP: f64 = 0.01;

/// The columns of a throttle schedule.
const COLUMNS: [&str; 4] = ["time", "share", "force", "vehicle"];

fn wanted() -> Vec<Wanted> {
    let contents = [
        Content::Quantity { of: Dimension::Time, share: false },
        Content::Quantity { of: Dimension::Share, share: false },
        Content::Quantity { of: Dimension::Force, share: false },
        Content::Text,
    ];
    let synonyms: [&[&str]; 4] = [&["t"], &["throttle"], &["tractive_effort", "effort"], &["locomotive", "label"]];
    let one = |((name, content), others): ((&str, Content), &[&str])| Wanted {
        names: std::iter::once(name).chain(others.iter().copied()).map(str::to_owned).collect(),
        content,
        by_unit: false,
    };
    COLUMNS.into_iter().zip(contents).zip(synonyms).map(one).collect()
}

/// Reads a throttle schedule: for each vehicle the change of its tractive effort over time.
fn schedule(
    text: &str,
    path: &Path,
    vehicles: &[Vehicle],
    traction_n: &[f64],
) -> Result<(Vec<Forcing>, Vec<Doubt>), InputError> {
    let help = "a row above the numbers names the columns: time [s],share [%], or time [s],force [kN], and vehicle where not all are meant";
    let sheet = match Sheet::open(text, &wanted(), &[0]) {
        Ok(sheet) if sheet.columns[0].is_some() && (sheet.columns[1].is_some() != sheet.columns[2].is_some()) => sheet,
        Err(Some(problems)) => return Err(InputError::new(path, text, problems)),
        _ => {
            let title = "the schedule has no column of time beside one of share or force";
            return Err(InputError::of_file(path, title, help));
        }
    };
    let mut courses: Vec<Forcing> = vec![];
    for record in sheet.rows() {
        if let Err(problem) = row(&sheet, &record, vehicles, traction_n, &mut courses) {
            let mut problems = Problems::default();
            problems.note(problem);
            return Err(InputError::new(path, text, problems));
        }
    }
    if courses.is_empty() {
        return Err(InputError::of_file(path, "the schedule has no rows", help));
    }
    let name = path.file_name().map_or_else(|| printable_path(path), |name| printable_path(Path::new(name)));
    let mut doubts = sheet.doubts(&name);
    let start_s = courses.iter().filter_map(|c| Some(c.points.first()?[0])).fold(f64::INFINITY, f64::min);
    if start_s > LATE_S {
        let start = shown_time(start_s);
        let text = format!(
            "the schedule {name} starts at {start}, and tractive efforts stay as they are until then: its times count from the \
             event, not from a logger's clock"
        );
        doubts.push(Doubt::of_train("throttle-starts-late", text));
    }
    let jumps = |course: &&Forcing| {
        let effort_n = |change_n: f64| (traction_n[course.vehicle] + change_n).abs();
        let largest_n = course.points.iter().map(|p| effort_n(p[1])).fold(effort_n(0.0), f64::max);
        course.points[0][1].abs() > JUMP * largest_n
    };
    let mut jumping = courses.iter().filter(jumps);
    if let Some(first) = jumping.next() {
        let text = format!(
            "the schedule {name} starts with another tractive effort than that before the event: that of {}{} jumps at {}; begin it \
             with a row of the effort before the event",
            vehicles[first.vehicle].label,
            more(jumping.count(), "vehicle"),
            shown_time(first.points[0][0])
        );
        doubts.push(Doubt::of_train("throttle-jumps", text));
    }
    let left = courses.iter().flat_map(|c| c.points.iter().map(|p| 1.0 + p[1] / traction_n[c.vehicle]));
    let most = left.fold(0.0, f64::max);
    if sheet.columns[1].is_some() && most > 0.0 && most <= LARGEST_DOUBTFUL_SHARE {
        let text =
            format!("no share of the schedule {name} is over 1 %: were shares of 1 meant, such as 0.5 for 50 %?");
        doubts.push(Doubt::of_train("faint-throttle", text));
    }
    let largest_n = courses.iter().flat_map(|c| c.points.iter().map(|p| (traction_n[c.vehicle] + p[1]).abs()));
    let largest_n = largest_n.fold(0.0, f64::max);
    if sheet.columns[2].is_some() && largest_n > 0.0 && largest_n < FAINT_N {
        let force = shown(UnitSystem::Si, largest_n, Dimension::Force);
        let text = format!("the largest force of the schedule {name} is {force}; check the unit in its heading");
        doubts.push(Doubt::of_train("faint-throttle", text));
    }
    Ok((courses, doubts))
}

/// Adds a row of the schedule to the courses of its vehicles.
fn row(
    sheet: &Sheet,
    record: &Record,
    vehicles: &[Vehicle],
    traction_n: &[f64],
    courses: &mut Vec<Forcing>,
) -> Result<(), Problem> {
    let wrong = |w: usize, found: String, right: &str| {
        let title = format!("row {}: {} {found}", record.row, COLUMNS[w]);
        Problem::at(sheet.place(record, w), title, Some(right.to_owned()))
    };
    let quantity = |w: usize, of: Dimension| {
        let Some((text, _)) = sheet.cell(record, w) else {
            return Err(wrong(w, "is empty".into(), "expected a number with the unit of its column"));
        };
        let (text, has_unit) = sheet.quantity(w, &text).map_err(|[found, right]| wrong(w, found, &right))?;
        if !has_unit {
            let right = format!("head the column {} [{}], or with another of {}", COLUMNS[w], of.si(), of.choices());
            return Err(Problem::at(
                sheet.heading_span(w),
                format!("the column of {} has no unit", COLUMNS[w]),
                Some(right),
            ));
        }
        match units::parse(&text, of, false) {
            Ok(Amount::Si(value) | Amount::Share(value)) => Ok(value),
            Err(bad) => Err(wrong(w, bad.found, &bad.right)),
        }
    };
    let time_s = quantity(0, Dimension::Time)?;
    let pulling: Vec<usize> = match sheet.cell(record, 3) {
        None => (0..traction_n.len()).filter(|&v| traction_n[v] != 0.0).collect(),
        Some((text, _)) => {
            let number = text.parse().ok().filter(|n: &usize| (1..=vehicles.len()).contains(n)).map(|n| n - 1);
            let vehicle = vehicles.iter().position(|v| v.label == *text).or(number);
            let known = one_of(
                (0..traction_n.len()).filter(|&v| traction_n[v] != 0.0).take(6).map(|v| quoted(&vehicles[v].label)),
            );
            let free = vehicle.filter(|&v| !vehicles[v].held);
            let right = format!("expected a vehicle that is not held, such as {known}");
            let free = free.ok_or_else(|| wrong(3, format!("is {}", quoted(&text)), &right))?;
            if sheet.columns[1].is_some() && traction_n[free] == 0.0 {
                let found = format!("is {}, which has no tractive effort to take a share of", quoted(&text));
                return Err(wrong(
                    3,
                    found,
                    &format!("expected one that has, such as {known}, or a column force [kN]"),
                ));
            }
            vec![free]
        }
    };
    let force_n = sheet.columns[2].as_ref().map(|_| quantity(2, Dimension::Force)).transpose()?;
    let share = sheet.columns[1].as_ref().map(|_| quantity(1, Dimension::Share)).transpose()?;
    for v in pulling {
        let to_n = force_n.unwrap_or(share.unwrap_or(1.0) * traction_n[v]);
        let point = [time_s, to_n - traction_n[v]];
        match courses.iter_mut().find(|course| course.vehicle == v) {
            Some(course) if course.points.last().is_some_and(|last| time_s < last[0]) => {
                return Err(wrong(
                    0,
                    "goes back in time".into(),
                    "the time of a row is at least that of the row before of the same vehicle",
                ));
            }
            Some(course) => course.points.push(point),
            None if time_s < 0.0 => return Err(wrong(0, "is before the event".into(), "times count from the event")),
            None => courses.push(Forcing { vehicle: v, points: vec![point] }),
        }
    }
    Ok(())
}
