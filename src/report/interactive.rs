//! What the script of `report.html` draws from, as JSON: numbers in SI, as in `result.json`, and the units of the axes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::figures::reach::ForceAxis;
use super::figures::{over_rating, rows_over};
use super::numbers::{Unit, force_unit, time_unit};
use super::pictures::Shown;
use super::words;
use crate::findings::{CaseFindings, CouplerFindings, Field};
use crate::scenario::initial_force_n;

/// Values that a page holds, two bytes each, which are 0.8 MB in base64: in all, by place and time, and by break.
const VALUES: usize = 290_000;
const BY_PLACE_AND_TIME: usize = 220_000;
const BY_BREAK: usize = 130_000;
/// Couplers that a page holds, some 250 bytes each; scenarios beyond that have no interactive figures.
const COUPLERS: usize = 4000;
/// Places and instants over the rating that are marked, at most.
const MARKED: usize = 500;

#[derive(Serialize)]
struct Scene<'a> {
    /// What is drawn, where the scenario has several cases.
    when: String,
    since: &'static str,
    /// Whether the largest forces are those over several breaks.
    several: bool,
    broken_coupler: Option<usize>,
    force_unit: (&'static str, f64),
    time_unit: (&'static str, f64),
    worst: usize,
    /// Ends of the axis of the forces along the train, N.
    reach_n: (f64, f64),
    horizon_s: f64,
    /// Utilisation of the strongest colour, the same in all figures of a report.
    most: f64,
    initial_force_n: Option<Vec<f64>>,
    /// Of the case drawn.
    couplers: Vec<Peaks<'a>>,
    /// The coupler that breaks in the case drawn, where other breaks can be chosen.
    broken: Option<Peaks<'a>>,
    /// Largest draft and buff of each coupler over all cases, and after which break.
    largest: Vec<Largest>,
    /// Largest forces of each coupler by break, where a page can carry them.
    breaks: Option<Breaks>,
    wave: Option<Forces>,
    rod: Option<Forces>,
}

/// A coupler's largest forces, named as in `result.json`.
#[derive(Serialize)]
struct Peaks<'a> {
    coupler: usize,
    between: &'a [String; 2],
    rated_draft_n: f64,
    rated_buff_n: f64,
    peak_draft_n: Option<f64>,
    peak_draft_time_s: Option<f64>,
    peak_buff_n: Option<f64>,
    peak_buff_time_s: Option<f64>,
    exceeds: Option<bool>,
    /// Ends of the axis of its force over time, N.
    reach_n: (f64, f64),
}

#[derive(Serialize, Default, Clone)]
struct Largest {
    draft_n: f64,
    draft_break: Option<usize>,
    buff_n: f64,
    buff_break: Option<usize>,
    exceeds: bool,
}

/// Largest forces of each coupler after each break.
#[derive(Serialize)]
struct Breaks {
    /// The couplers that break, from 1.
    broken: Vec<usize>,
    /// Breaks that a page has no room for, none of them worse than those that it holds.
    left_out: usize,
    /// N per unit of the numbers.
    unit_n: f64,
    /// A row for each break, in it draft and then buff of every coupler from the head: numbers as in [`Forces`].
    forces: String,
}

/// Forces by place and time.
#[derive(Serialize)]
struct Forces {
    from_s: f64,
    step_s: f64,
    columns: usize,
    /// How many computed instants share a column; the largest utilisation is kept.
    instants_per_column: usize,
    /// Couplers over their ratings, and the instant, s, and coupler of the peak of each region over it, the largest first.
    over: Vec<usize>,
    over_at: Vec<(f64, usize)>,
    /// N per unit of the numbers.
    unit_n: f64,
    /// Of each row, whether a force of 0 is that of a coupler that passes its slack; empty where none does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    slack: Vec<bool>,
    /// Rows from the head, columns in time: 16-bit numbers, low byte first, in base64; the smallest stands for none.
    forces: String,
}

/// The data of a page, one entry per scenario; null where nothing is drawn.
pub fn data(shown: &[Option<Shown>]) -> Result<String, serde_json::Error> {
    let fields = shown.iter().flatten().map(|s| [&s.evidence.wave, &s.evidence.rod].into_iter().flatten().count());
    let fields = fields.sum::<usize>().max(1);
    let mut by_break = BY_BREAK;
    let breaks: Vec<_> = shown.iter().map(|shown| breaks(shown.as_ref()?, &mut by_break)).collect();
    let values = (VALUES - (BY_BREAK - by_break)).min(BY_PLACE_AND_TIME) / fields;
    let mut room = COUPLERS;
    let mut scenes = Vec::new();
    for (shown, breaks) in shown.iter().zip(breaks) {
        let fits = |s: &&Shown| s.train.couplers().len() <= room && !s.case.couplers.is_empty();
        let shown = shown.as_ref().filter(fits);
        room -= shown.map_or(0, |s| s.train.couplers().len());
        scenes.push(shown.map(|s| scene(s, breaks, values)));
    }
    serde_json::to_string(&scenes)
}

fn scene<'a>(shown: &'a Shown, breaks: Option<Breaks>, values: usize) -> Scene<'a> {
    let pair = |u: Unit| (u.name, u.size);
    let several = shown.findings.cases.len() > 1;
    let broken = shown.case.broken_coupler;
    let before = initial_force_n(shown.train, &shown.scenario.event);
    let reach_n = reach(shown, &before);
    Scene {
        when: shown.when(),
        since: words::time_axis(shown.case),
        several,
        broken_coupler: broken,
        force_unit: pair(force_unit(shown.train.origin().units, reach_n.1.max(-reach_n.0))),
        time_unit: pair(time_unit(shown.case.horizon_s)),
        worst: shown.worst.coupler,
        reach_n,
        horizon_s: shown.case.horizon_s,
        most: shown.most,
        initial_force_n: Some(before.clone())
            .filter(|f| shown.findings.kind != "impact" || f.iter().any(|n| *n != 0.0)),
        couplers: shown.case.couplers.iter().map(|c| peaks(c, before[c.coupler - 1])).collect(),
        broken: shown
            .findings
            .cases
            .iter()
            .flat_map(|c| &c.couplers)
            .find(|c| broken == Some(c.coupler))
            .map(|c| peaks(c, before[c.coupler - 1])),
        largest: if several { largest(shown) } else { Vec::new() },
        breaks,
        wave: shown.evidence.wave.as_ref().and_then(|f| forces(shown, f, values)),
        rod: shown.evidence.rod.as_ref().and_then(|f| forces(shown, f, values)),
    }
}

fn peaks(c: &CouplerFindings, before_n: f64) -> Peaks<'_> {
    let forces = [before_n, c.peak_draft_n.unwrap_or(0.0), c.peak_buff_n.unwrap_or(0.0)].into_iter();
    Peaks {
        coupler: c.coupler,
        between: &c.between,
        rated_draft_n: c.rated_draft_n,
        rated_buff_n: c.rated_buff_n,
        peak_draft_n: c.peak_draft_n,
        peak_draft_time_s: c.peak_draft_time_s,
        peak_buff_n: c.peak_buff_n,
        peak_buff_time_s: c.peak_buff_time_s,
        exceeds: c.exceeds,
        reach_n: rounded(ForceAxis::new(forces, &[c.rated_draft_n], &[c.rated_buff_n]).range),
    }
}

/// The ends of an axis to four digits.
fn rounded((low, high): (f64, f64)) -> (f64, f64) {
    let four = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
    (four(low), four(high))
}

/// The axis of the forces of all cases and before the event, and of ratings that leave them visible.
fn reach(shown: &Shown, before_n: &[f64]) -> (f64, f64) {
    let all = shown.findings.cases.iter().flat_map(|case| &case.couplers);
    let peaks = all.flat_map(|c| [c.peak_draft_n, c.peak_buff_n]).flatten();
    let couplers = shown.train.couplers();
    let draft: Vec<f64> = couplers.iter().map(|c| c.rated_draft_n).collect();
    let buff: Vec<f64> = couplers.iter().map(|c| c.rated_buff_n).collect();
    rounded(ForceAxis::new(peaks.chain(before_n.iter().copied()), &draft, &buff).range)
}

fn largest(shown: &Shown) -> Vec<Largest> {
    let mut all = vec![Largest::default(); shown.train.couplers().len()];
    for case in &shown.findings.cases {
        for c in &case.couplers {
            let l = &mut all[c.coupler - 1];
            l.exceeds |= c.exceeds == Some(true);
            if let Some(f) = c.peak_draft_n.filter(|f| *f > l.draft_n) {
                (l.draft_n, l.draft_break) = (f, case.broken_coupler);
            }
            if let Some(f) = c.peak_buff_n.filter(|f| *f < l.buff_n) {
                (l.buff_n, l.buff_break) = (f, case.broken_coupler);
            }
        }
    }
    all
}

/// Of several breaks all, or the worst that there is room for.
fn breaks(shown: &Shown, room: &mut usize) -> Option<Breaks> {
    let couplers = shown.train.couplers().len();
    let use_of = |case: &CaseFindings| case.worst.as_ref().map_or(0.0, |c| c.utilisation);
    let mut cases: Vec<&CaseFindings> = shown.findings.cases.iter().collect();
    cases.sort_by(|a, b| use_of(b).total_cmp(&use_of(a)));
    cases.truncate(*room / (2 * couplers));
    if shown.findings.cases.len() < 2 || cases.is_empty() {
        return None;
    }
    let left_out = shown.findings.cases.len() - cases.len();
    cases.sort_by_key(|case| case.broken_coupler);
    *room -= 2 * cases.len() * couplers;
    let mut force = Vec::with_capacity(2 * cases.len() * couplers);
    for case in &cases {
        let row = force.len();
        force.resize(row + 2 * couplers, f64::NAN);
        for c in &case.couplers {
            force[row + c.coupler - 1] = c.peak_draft_n.unwrap_or(0.0);
            force[row + couplers + c.coupler - 1] = c.peak_buff_n.unwrap_or(0.0);
        }
    }
    let (unit_n, forces) = packed(&force);
    Some(Breaks { broken: cases.iter().filter_map(|c| c.broken_coupler).collect(), left_out, unit_n, forces })
}

/// Forces as 16-bit numbers, low byte first, in base64, and N per unit of them; the smallest number stands for none, and 0 for 0 alone.
fn packed(force: &[f64]) -> (f64, String) {
    let most = force.iter().filter(|f| !f.is_nan()).fold(0.0, |m: f64, f| m.max(f.abs()));
    let unit_n = most / f64::from(i16::MAX);
    let number = |f: &f64| match (f / unit_n).round() as i16 {
        _ if f.is_nan() => i16::MIN,
        0 if *f != 0.0 => f.signum() as i16,
        number => number,
    };
    (unit_n, STANDARD.encode(force.iter().flat_map(|f| number(f).to_le_bytes()).collect::<Vec<u8>>()))
}

fn forces(shown: &Shown, field: &Field, values: usize) -> Option<Forces> {
    if field.couplers_per_row > 1 {
        return None;
    }
    let over = rows_over(field).into_iter().map(|row| row + 1).collect();
    let at = |(row, column): (usize, usize)| (field.times_s[column], row + 1);
    let over_at = over_rating(field).into_iter().take(MARKED).map(at).collect();
    let columns_most = (values / field.rows()).max(2);
    let field = field.folded(field.times_s.len().div_ceil(columns_most));
    let rated = |row: usize, share: f32| {
        let c = &shown.train.couplers()[row];
        f64::from(share) * if share < 0.0 { c.rated_buff_n } else { c.rated_draft_n }
    };
    let force: Vec<f64> =
        (0..field.rows()).flat_map(|r| field.row(r).iter().map(move |s| rated(r, *s)).collect::<Vec<_>>()).collect();
    let (unit_n, forces) = packed(&force);
    let [from_s, next] = [field.times_s.first()?, field.times_s.get(1)?];
    Some(Forces {
        from_s: *from_s,
        step_s: next - from_s,
        columns: field.times_s.len(),
        instants_per_column: field.instants_per_column,
        over,
        over_at,
        unit_n,
        forces,
        slack: if field.opens() { field.slack } else { vec![] },
    })
}
