//! Trains with slack, gears and brakes drawn at random, each from its own seed.

use super::super::draw::Random;
use trainsafe::forcing::Drive;
use trainsafe::law::{Curve, GearRow, Law, Rest};
use trainsafe::march::{Brakes, Problem};

/// What happens to a train.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GearKind {
    Break,
    LetDown,
    Impact,
    Pulse,
    Cascade,
    Emergency,
    Application,
}

impl GearKind {
    /// All of them, in the order of the table.
    pub const ALL: [GearKind; 7] = [
        GearKind::Break,
        GearKind::LetDown,
        GearKind::Impact,
        GearKind::Pulse,
        GearKind::Cascade,
        GearKind::Emergency,
        GearKind::Application,
    ];

    /// In the table.
    pub fn name(self) -> &'static str {
        match self {
            GearKind::Break => "break",
            GearKind::LetDown => "break after a let-down",
            GearKind::Impact => "impact",
            GearKind::Pulse => "pulse",
            GearKind::Cascade => "cascade",
            GearKind::Emergency => "parting and emergency",
            GearKind::Application => "brake application",
        }
    }
}

/// Loading stiffness of a coupler of average size, N/m, and its share of the solid stiffness.
const STIFFNESS: f64 = 17.9e6;

/// The train of a seed, and what happens.
pub fn draw(seed: u64) -> (GearKind, Problem) {
    let mut r = Random(seed ^ 0x6ea5);
    let kind = GearKind::ALL[(seed % GearKind::ALL.len() as u64) as usize];
    let n = 8 + (r.share() * r.share() * 40.0) as usize;
    let equal = r.chance(0.5);
    let mass_kg: Vec<f64> = (0..n).map(|_| if equal { 130e3 } else { r.between(30e3, 150e3) }).collect();
    let laws = laws(&mut r, n - 1);
    let mean = mass_kg.iter().sum::<f64>() / n as f64;
    let transit_s = n as f64 * (mean / STIFFNESS).sqrt();
    let horizon_s = transit_s * r.between(2.0, 4.0);
    let mut problem = Problem { held_head: r.chance(0.5), ..Problem::at_rest(mass_kg, laws, horizon_s) };
    match kind {
        GearKind::Break | GearKind::LetDown => {
            load(&mut r, &mut problem, kind == GearKind::LetDown);
            part(&mut r, &mut problem);
        }
        GearKind::Impact => impact(&mut r, &mut problem),
        GearKind::Pulse => pulse(&mut r, &mut problem),
        GearKind::Cascade => cascade(&mut r, &mut problem),
        GearKind::Emergency | GearKind::Application => brakes(&mut r, &mut problem, kind == GearKind::Emergency),
    }
    (kind, problem)
}

/// One law for all couplers, or each its own of one kind.
fn laws(r: &mut Random, couplers: usize) -> Vec<Law> {
    let slack_m = if r.chance(0.3) { 0.0 } else { r.between(0.0, 0.044) };
    let kind = r.one_of(6);
    let same = r.chance(0.6);
    let first = law(r, kind, slack_m);
    (0..couplers).map(|_| if same { first.clone() } else { law(r, kind, slack_m) }).collect()
}

fn law(r: &mut Random, kind: usize, slack_m: f64) -> Law {
    let k = STIFFNESS * 2f64.powf(r.between(-0.7, 0.7));
    if kind == 0 {
        let buff_n_per_m = if r.chance(0.5) { k } else { k * r.between(0.5, 2.0) };
        return Law::Elastic { draft_n_per_m: k, buff_n_per_m, slack_m };
    }
    let solid_n_per_m = r.between(60e6, 260e6);
    let draft = table(r, kind, k);
    let buff = if r.chance(0.7) { draft.clone() } else { table(r, kind, k) };
    Law::Gear { solid_n_per_m, slack_m, draft, buff }
}

/// A wedge; published pairs, stiffer or softer; rows at random; all with or without a preload.
fn table(r: &mut Random, kind: usize, k: f64) -> Curve {
    let preload_n = if r.chance(0.4) { r.between(0.0, 50e3) } else { 0.0 };
    let scale = 2f64.powf(r.between(-0.5, 0.5));
    let pair = |elastic: f64| {
        [[0., 0., 0.], [7., 120., elastic], [38., 680., 172.], [114., 1350., 300.], [149., 2520., 360.]]
            .map(|[w, up, down]| [w / 1e3, scale * up * 1e3, scale * down * 1e3])
            .to_vec()
    };
    let rows: Vec<[f64; 3]> = match kind {
        1 | 2 => {
            let (friction, stroke) = (r.between(0.0, 0.9), r.between(0.04, 0.12));
            vec![[0.0, 0.0, 0.0], [stroke, k * stroke, (1.0 - friction) * k * stroke]]
        }
        3 => pair(60.0),
        4 => pair(120.0),
        _ => at_random(r, k),
    };
    let row = |&[travel_m, loading, unloading]: &[f64; 3]| GearRow {
        travel_m,
        loading_n: loading + preload_n,
        unloading_n: unloading + 0.4 * preload_n,
    };
    Curve::new(rows.iter().map(row).collect()).expect("rows that rise")
}

fn at_random(r: &mut Random, k: f64) -> Vec<[f64; 3]> {
    let mut last = [0.0; 3];
    let mut rows = vec![last];
    for _ in 0..2 + r.one_of(5) {
        let step = r.between(4e-3, 40e-3);
        let rise = k * step * r.between(0.1, 2.0);
        let back = rise * r.between(0.0, 1.0) * f64::from(u8::from(r.chance(0.8)));
        last = [last[0] + step, last[1] + rise, last[2] + back];
        rows.push(last);
    }
    rows
}

/// A pull, seldom a push, the same all along or falling to the tail, with the steady forces that keep it.
fn load(r: &mut Random, problem: &mut Problem, let_down: bool) {
    let couplers = problem.laws.len();
    let level = r.between(1e5, 1e6) * if r.chance(0.15) { -1.0 } else { 1.0 };
    let even = r.chance(0.6);
    let before = if let_down { r.between(1.1, 2.0) } else { 1.0 };
    let share = |i: usize| if even { 1.0 } else { (couplers - i) as f64 / couplers as f64 };
    let force_n = |i: usize| level * share(i);
    problem.start = (0..couplers).map(|i| problem.laws[i].rest(&[before * force_n(i), force_n(i)])).collect();
    let at = |i: Option<usize>| i.filter(|i| *i < couplers).map_or(0.0, force_n);
    problem.steady_n = (0..=couplers).map(|v| at(Some(v)) - at(v.checked_sub(1))).collect();
}

/// The last coupler parts, or any other.
fn part(r: &mut Random, problem: &mut Problem) {
    let last = problem.laws.len() - 1;
    problem.gone = vec![if r.chance(0.5) { last } else { r.one_of(last + 1) }];
}

/// Vehicles at the tail arrive; at each joint slack is anywhere.
fn impact(r: &mut Random, problem: &mut Problem) {
    let n = problem.mass_kg.len();
    let (from, speed) = (1 + r.one_of(n - 1), r.between(0.3, 4.0));
    problem.held_head = false;
    problem.speed_m_s = (0..n).map(|v| if v >= from { speed } else { 0.0 }).collect();
    let places = |law: &Law| 0.5 * law.slack_m() * r.between(-1.0, 1.0);
    problem.start = problem.laws.iter().map(places).map(|travel_m| Rest { force_n: 0.0, travel_m }).collect();
    problem.start[from - 1].travel_m = -0.5 * problem.laws[from - 1].slack_m();
}

fn pulse(r: &mut Random, problem: &mut Problem) {
    if r.chance(0.6) {
        load(r, problem, false);
    }
    let at = 1 + r.one_of(problem.mass_kg.len() - 1);
    let (peak, duration) = (r.sign() * r.between(2e5, 2e6), r.between(0.05, 2.0));
    let drive = match r.one_of(3) {
        0 => Drive::rectangle(peak, duration),
        1 => Drive::HalfSine { peak, duration },
        _ => Drive::Lines(vec![[0.0, 0.0], [duration * r.between(0.2, 0.8), peak], [duration, 0.0]]),
    };
    problem.forcing = vec![(at, drive)];
}

/// Couplers that part one after the other, in draft and sometimes in buff, after a break or under a pulse.
fn cascade(r: &mut Random, problem: &mut Problem) {
    let let_down = r.chance(0.3);
    load(r, problem, let_down);
    let largest = problem.start.iter().map(|s| s.force_n.abs()).fold(0.0, f64::max);
    let buff_too = r.chance(0.4);
    let limit = |r: &mut Random| largest * r.between(1.02, 1.8);
    problem.break_at_n =
        (0..problem.laws.len()).map(|_| [limit(r), if buff_too { limit(r) } else { f64::INFINITY }]).collect();
    if r.chance(0.5) {
        part(r, problem);
    } else {
        let at = 1 + r.one_of(problem.mass_kg.len() - 1);
        let peak = r.sign() * largest * r.between(0.8, 2.0);
        problem.forcing = vec![(at, Drive::rectangle(peak, r.between(0.2, 3.0)))];
    }
}

/// A free train under a pull: it parts and the emergency brakes go on both ways, or brakes are applied from the head.
fn brakes(r: &mut Random, problem: &mut Problem, emergency: bool) {
    let n = problem.mass_kg.len();
    problem.held_head = false;
    load(r, problem, false);
    problem.common_speed_m_s = Some(60.0);
    let length_m: Vec<f64> = (0..n).map(|_| r.between(12.0, 25.0)).collect();
    let full_n: Vec<f64> = problem.mass_kg.iter().map(|m| m * 0.35 * r.between(0.5, 1.0)).collect();
    let wave_m_s = r.between(120.0, 300.0);
    let full_s = r.between(3.0, 18.0);
    let build_up = vec![[0.0, 0.0], [0.2 * full_s, 0.3], [full_s, 1.0]];
    problem.horizon_s += n as f64 * 18.0 / wave_m_s;
    problem.mark_s = problem.horizon_s;
    let brakes = Brakes { wave_m_s, build_up, full_n, length_m };
    if emergency {
        part(r, problem);
        problem.emergency = Some(brakes);
    } else {
        problem.application = Some((brakes, vec![0.0]));
    }
}
