//! Trains with slack and gears for tests, and Verlet with a clamp: 20 lines that share nothing with the march.
#![allow(dead_code)]

use trainsafe::law::{Curve, GearRow, Law};
use trainsafe::march::Problem;

/// A table of travel mm, loading kN, unloading kN.
pub fn curve(rows: &[[f64; 3]]) -> Curve {
    let row = |r: &[f64; 3]| GearRow { travel_m: r[0] / 1e3, loading_n: r[1] * 1e3, unloading_n: r[2] * 1e3 };
    Curve::new(rows.iter().map(row).collect()).expect("a right table")
}

/// The same gear in draft and buff.
pub fn gear(solid_n_per_m: f64, slack_m: f64, curve: Curve) -> Law {
    let law = Law::Gear { solid_n_per_m, slack_m, draft: curve.clone(), buff: curve };
    law.check().expect("a right law");
    law
}

/// A pair of friction gears, elastic under 120 kN.
pub fn gear_a() -> Curve {
    curve(&[[0., 0., 0.], [7., 120., 120.], [38., 680., 172.], [114., 1350., 300.], [149., 2520., 360.]])
}

/// The same with friction at all loads.
pub fn gear_a_dash() -> Curve {
    curve(&[[0., 0., 0.], [7., 120., 60.], [38., 680., 172.], [114., 1350., 300.], [149., 2520., 360.]])
}

/// Loading stiffness `k` in series with `kl` included, unloading under it by a share.
pub fn wedge(k: f64, kl: f64, friction: f64, slack: f64, travel: f64) -> Law {
    let h = k * kl / (kl - k);
    let row = |w: f64| GearRow { travel_m: w, loading_n: h * w, unloading_n: (1.0 - friction) * h * w };
    gear(kl, slack, Curve::new(vec![row(0.0), row(travel)]).expect("a wedge"))
}

/// A run of vehicles under no steady force, at rest.
pub fn train(mass_kg: Vec<f64>, laws: Vec<Law>, horizon_s: f64) -> Problem {
    Problem::at_rest(mass_kg, laws, horizon_s)
}

/// A held head, `cars` of one mass behind it, all couplers pulled to each of the forces in turn, and the end let go.
pub fn let_go(cars: usize, mass_kg: f64, law: &Law, pulls: &[f64], horizon_s: f64) -> Problem {
    let mut problem = train(vec![mass_kg; cars + 1], vec![law.clone(); cars], horizon_s);
    problem.held_head = true;
    problem.start = vec![law.rest(pulls); cars];
    problem
}

/// A law as two curves over the elongation, from the stop in buff to that in draft: `[elongation, force]`.
struct Curves {
    solid: f64,
    lower: Vec<[f64; 2]>,
    upper: Vec<[f64; 2]>,
}

impl Curves {
    fn new(law: &Law) -> Curves {
        let half = 0.5 * law.slack_m();
        match law {
            Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
                let line = vec![
                    [-half - 1e6, -1e6 * buff_n_per_m],
                    [-half, 0.0],
                    [half, 0.0],
                    [half + 1e6, 1e6 * draft_n_per_m],
                ];
                Curves { solid: f64::INFINITY, lower: line.clone(), upper: line }
            }
            Law::Gear { solid_n_per_m, draft, buff, .. } => {
                let over = |w: f64, f: f64| [w + f / solid_n_per_m, f];
                let side = |loading: bool, in_draft: bool| {
                    let c = if in_draft { draft } else { buff };
                    let of = |r: &GearRow| if loading { r.loading_n } else { r.unloading_n };
                    let points = c.rows().iter().map(move |r| (half + r.travel_m, of(r)));
                    if in_draft {
                        points.map(|(w, f)| over(w, f)).collect::<Vec<_>>()
                    } else {
                        points.map(|(w, f)| over(-w, -f)).rev().collect()
                    }
                };
                let slack = [[-half, 0.0], [half, 0.0]];
                let far = |end: [f64; 2], sign: f64| [end[0] + sign * 1e3, end[1] + sign * 1e3 * solid_n_per_m];
                let whole = |loading: bool| {
                    let mut all = side(!loading, false);
                    all.insert(0, far(all[0], -1.0));
                    all.extend(slack);
                    all.extend(side(loading, true));
                    all.push(far(all[all.len() - 1], 1.0));
                    all
                };
                Curves { solid: *solid_n_per_m, lower: whole(false), upper: whole(true) }
            }
        }
    }
}

fn between(points: &[[f64; 2]], q: f64) -> f64 {
    let n = points.partition_point(|p| p[0] <= q).clamp(1, points.len() - 1);
    let ([a, f], [b, g]) = (points[n - 1], points[n]);
    if b > a { f + (g - f) * (q - a) / (b - a) } else { g }
}

/// Velocity Verlet; a coupler's force follows the solid stiffness and is clamped between its two curves. The extremes of each
/// coupler's force, `[largest, smallest]`. Couplers that are gone carry nothing; no forces in time, no cascades.
pub fn verlet(problem: &Problem, steps: usize) -> Vec<[f64; 2]> {
    let (n, dt) = (problem.mass_kg.len(), problem.horizon_s / steps as f64);
    let live = |v: usize| !(v == 0 && problem.held_head || v + 1 == n && problem.held_tail);
    let curves: Vec<Curves> = problem.laws.iter().map(Curves::new).collect();
    let mut q: Vec<f64> = problem.laws.iter().zip(&problem.start).map(|(l, r)| l.elongation_m(r)).collect();
    let mut force: Vec<f64> = problem.start.iter().map(|r| r.force_n).collect();
    problem.gone.iter().for_each(|&i| force[i] = 0.0);
    let mut v = problem.speed_m_s.clone();
    let mut extremes: Vec<[f64; 2]> = force.iter().map(|f| [*f, *f]).collect();
    for _ in 0..steps {
        for half in [0, 1] {
            for j in (0..n).filter(|&j| live(j)) {
                let ahead = if j > 0 { force[j - 1] } else { 0.0 };
                let behind = if j + 1 < n { force[j] } else { 0.0 };
                v[j] += 0.5 * dt * (ahead - behind + problem.steady_n[j]) / problem.mass_kg[j];
            }
            for i in (0..n - 1).filter(|_| half == 0) {
                let change = dt * (v[i] - v[i + 1]);
                q[i] += change;
                let (low, high) = (between(&curves[i].lower, q[i]), between(&curves[i].upper, q[i]));
                let solid = if curves[i].solid.is_finite() { force[i] + curves[i].solid * change } else { low };
                force[i] = if problem.gone.contains(&i) { 0.0 } else { solid.max(low).min(high) };
                extremes[i] = [extremes[i][0].max(force[i]), extremes[i][1].min(force[i])];
            }
        }
    }
    extremes
}
