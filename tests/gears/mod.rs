//! Trains with slack and gears for tests, and Verlet with a clamp: 20 lines that share nothing with the march.
#![allow(dead_code)]

use trainsafe::law::{Curve, Law, Rest, Row};
use trainsafe::march::Problem;

/// A table of travel mm, loading kN, unloading kN.
pub fn curve(rows: &[[f64; 3]]) -> Curve {
    let row = |r: &[f64; 3]| Row { travel_m: r[0] / 1e3, loading_n: r[1] * 1e3, unloading_n: r[2] * 1e3 };
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
    let row = |w: f64| Row { travel_m: w, loading_n: h * w, unloading_n: (1.0 - friction) * h * w };
    gear(kl, slack, Curve::new(vec![row(0.0), row(travel)]).expect("a wedge"))
}

/// A run of vehicles under no steady force, at rest.
pub fn train(mass_kg: Vec<f64>, laws: Vec<Law>, horizon_s: f64) -> Problem {
    let n = mass_kg.len();
    Problem {
        start: vec![Rest::default(); n - 1],
        mass_kg,
        laws,
        held_head: false,
        held_tail: false,
        dashpot_n_s_per_m: Vec::new(),
        speed_m_s: vec![0.0; n],
        common_speed_m_s: None,
        steady_n: vec![0.0; n],
        forcing: Vec::new(),
        gone: Vec::new(),
        break_at_n: Vec::new(),
        emergency: None,
        horizon_s,
        mark_s: horizon_s,
    }
}

/// A held head, `cars` of one mass behind it, all couplers pulled to each of the forces in turn, and the end let go.
pub fn let_go(cars: usize, mass_kg: f64, law: &Law, pulls: &[f64], horizon_s: f64) -> Problem {
    let mut problem = train(vec![mass_kg; cars + 1], vec![law.clone(); cars], horizon_s);
    problem.held_head = true;
    problem.start = vec![law.rest(pulls); cars];
    problem
}
