//! Tests that need the internals of a march.

use super::mode::{Coupler, Mode};
use super::run::RunSettings;
use super::step::March;
use super::{MarchOptions, Problem};
use crate::law::{Curve, GearRow, Law, Rest};
use proptest::prelude::*;

/// A spring h beside a slider of constant friction r, in series with kl.
fn slider(kl: f64, h: f64, r: f64) -> Law {
    let row = |w: f64| GearRow { travel_m: w, loading_n: h * w + r, unloading_n: h * w - r };
    let curve = Curve::new(vec![row(0.0), row(10.0)]).expect("a slider");
    Law::Gear { solid_n_per_m: kl, slack_m: 0.0, draft: curve.clone(), buff: curve }
}

fn train(laws: Vec<Law>, start: Vec<Rest>, speed_m_s: Vec<f64>) -> Problem {
    let n = speed_m_s.len();
    Problem {
        mass_kg: (0..n).map(|v| 40e3 + 30e3 * (v % 3) as f64).collect(),
        held_head: true,
        held_tail: false,
        laws,
        dashpot_n_s_per_m: Vec::new(),
        start,
        speed_m_s,
        common_speed_m_s: None,
        common_m_s2: 0.0,
        steady_n: vec![0.0; n],
        forcing: vec![(n - 1, crate::forcing::Drive::HalfSine { peak: 7e5, duration: 0.8 })],
        gone: Vec::new(),
        contact: true,
        break_at_n: Vec::new(),
        emergency: None,
        application: None,
        horizon_s: 9.0,
        mark_s: 9.0,
    }
}

/// `sum m dv^2 + sum (dF^2 / kl + h dw^2)`, or `k dq^2` of a spring.
fn distance(a: &March, b: &March) -> f64 {
    let mut sum = 0.0;
    for v in 0..a.run.state.v[0].len() {
        let dv = (a.run.state.v[0][v] - b.run.state.v[0][v]) + (a.run.state.v[1][v] - b.run.state.v[1][v]);
        sum += a.run.problem.mass_kg[v] * dv * dv;
    }
    for (i, (x, y)) in a.run.couplers.iter().zip(&b.run.couplers).enumerate() {
        let force = |c: &Coupler, m: &March| c.start[1] + c.force(m.run.state.elongation(i));
        let travel = |c: &Coupler, m: &March| c.travel(m.run.state.elongation(i));
        let (df, dw) = (force(x, a) - force(y, b), travel(x, a) - travel(y, b));
        let h = x.branches.intervals[0].up.slope;
        sum += df * df * x.branches.compliance + h * dw * dw;
    }
    sum
}

/// With a margin far under the rounding of the motion the march widens it, goes on, and ends.
#[test]
fn a_guard_under_rounding_is_widened() {
    let rows =
        [[0.0, 0.0, 0.0], [0.07, 1e6, 2e5]].map(|r| GearRow { travel_m: r[0], loading_n: r[1], unloading_n: r[2] });
    let gear = Curve::new(rows.to_vec()).expect("a table");
    let law = Law::Gear { solid_n_per_m: 2e8, slack_m: 0.01, draft: gear.clone(), buff: gear };
    let mut problem = train(vec![law; 3], vec![Rest::default(); 3], vec![0.0; 4]);
    problem.forcing = vec![(3, crate::forcing::Drive::rectangle(-1e6, 9.0))];
    for margin in [1.0, 1e-6, 0.0] {
        let settings = RunSettings { phase: 1.0, noise: None, margin };
        let mut march = March::new(&problem, &MarchOptions::default(), settings);
        march.advance_to(9.0);
        assert_eq!(march.run.t, 9.0, "{margin}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Two motions of one train under the same forces, with springs and sliders of constant friction, never move
    /// apart.
    #[test]
    fn sliders_bring_motions_together(
        couplers in prop::collection::vec((60e6..250e6f64, 2e6..30e6f64, 0.0..3e5f64, any::<bool>()), 2..10),
        (first, second) in (prop::collection::vec((-4e5..4e5f64, -0.5..0.5f64), 10), prop::collection::vec((-4e5..4e5f64, -0.5..0.5f64), 10)),
    ) {
        let law = |&(kl, h, r, spring): &(f64, f64, f64, bool)| match spring {
            true => Law::Elastic { draft_n_per_m: h, buff_n_per_m: h, slack_m: 0.0 },
            false => slider(kl, h, r),
        };
        let laws: Vec<Law> = couplers.iter().map(law).collect();
        let problem = |s: &[(f64, f64)]| {
            let start = laws.iter().zip(s).map(|(l, s)| l.rest(&[s.0])).collect();
            let speeds = (0..=laws.len()).map(|v| if v == 0 { 0.0 } else { s[v - 1].1 }).collect();
            train(laws.clone(), start, speeds)
        };
        let (p, q) = (problem(&first), problem(&second));
        let settings = RunSettings { phase: 1.0, noise: None, margin: 1.0 };
        let (mut a, mut b) = (March::new(&p, &MarchOptions::default(), settings), March::new(&q, &MarchOptions::default(), settings));
        let mut last = distance(&a, &b);
        let start = last;
        for n in 1..=600 {
            let t = 0.015 * f64::from(n);
            a.advance_to(t);
            b.advance_to(t);
            let now = distance(&a, &b);
            prop_assert!(now <= last + 1e-13 * start, "at {t} s: {now} after {last}");
            last = now;
        }
    }

    /// A cycle inside the locked range does not change the force along the rest of the path.
    #[test]
    fn cycles_inside_the_lock(
        path in prop::collection::vec(-0.12..0.12f64, 1..12),
        (at, share) in (any::<prop::sample::Index>(), 0.0..1.0f64),
        (rows, preload_n) in (prop::collection::vec((0.002..0.05f64, 1e4..7e5f64, 0.0..1.0f64), 1..5), prop_oneof![Just(0.0), 0.0..5e4f64]),
        (solid_n_per_m, slack_m) in (60e6..260e6f64, prop_oneof![Just(0.0), 0.0..0.04f64]),
    ) {
        let mut table = vec![GearRow { travel_m: 0.0, loading_n: preload_n, unloading_n: 0.5 * preload_n }];
        for (n, &(travel, rise, share)) in rows.iter().enumerate() {
            let loading_n = table[n].loading_n + rise;
            let unloading_n = table[n].unloading_n + share * (loading_n - table[n].unloading_n);
            table.push(GearRow { travel_m: table[n].travel_m + travel, loading_n, unloading_n });
        }
        let gear = Curve::new(table).expect("a table");
        let law = Law::Gear { solid_n_per_m, slack_m, draft: gear.clone(), buff: gear };
        let at = at.index(path.len());
        let (mut plain, mut cycled) = (Coupler::new(&law, &Rest::default()), Coupler::new(&law, &Rest::default()));
        let mut last = 0.0;
        for (n, &q) in path.iter().enumerate() {
            let force = super::mode::tests::moved(&mut plain, last, q);
            prop_assert!((force - super::mode::tests::moved(&mut cycled, last, q)).abs() < 1e-7);
            if n == at {
                // To one end of the lock, or a share of the way, and back.
                let mut probe = cycled.clone();
                if probe.turn != 0.0 {
                    probe.switch(super::mode::End::Turn, q);
                }
                let other = match probe.mode {
                    Mode::Locked { .. } if probe.lower < q && probe.lower.is_finite() => q + share * (probe.lower - q),
                    Mode::Locked { .. } if probe.upper > q && probe.upper.is_finite() => q + share * (probe.upper - q),
                    _ => q,
                };
                super::mode::tests::moved(&mut cycled, q, other);
                let back = super::mode::tests::moved(&mut cycled, other, q);
                prop_assert!((back - force).abs() < 1e-7, "{back} {force}");
            }
            last = q;
        }
    }
}
