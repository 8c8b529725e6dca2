//! What holds for every law and every train: energy, mirror images, units, rows on a line, split groups.

use crate::gears::train;
use proptest::prelude::*;
use trainsafe::forcing::Drive;
use trainsafe::law::{Curve, GearRow, Law, Rest};
use trainsafe::march::{MarchOptions, MarchOutcome, Problem, solve};

/// A table of two to five rows; friction from none to all, sometimes none in a part, sometimes a preload.
fn table() -> impl Strategy<Value = Curve> {
    let row = (0.002..0.04f64, 0.0..6e5f64, 0.0..1.0f64);
    (prop::collection::vec(row, 1..5), 0.0..5e4f64, any::<bool>(), any::<bool>()).prop_map(
        |(steps, preload, loaded, elastic)| {
            let first = if loaded { preload } else { 0.0 };
            let mut rows = vec![GearRow { travel_m: 0.0, loading_n: first, unloading_n: 0.5 * first }];
            for (n, (travel, rise, share)) in steps.into_iter().enumerate() {
                let last = rows[n];
                let loading_n = last.loading_n + rise.max(1e4);
                let unloading_n = if elastic && n == 0 && !loaded {
                    loading_n
                } else {
                    last.unloading_n + share * (loading_n - last.unloading_n)
                };
                rows.push(GearRow { travel_m: last.travel_m + travel, loading_n, unloading_n });
            }
            Curve::new(rows).expect("a table")
        },
    )
}

fn law() -> impl Strategy<Value = Law> {
    let slack = prop_oneof![Just(0.0), 0.001..0.04f64];
    let gear = (60e6..260e6f64, slack.clone(), table(), table(), any::<bool>()).prop_map(
        |(solid_n_per_m, slack_m, draft, other, same)| {
            let buff = if same { draft.clone() } else { other };
            Law::Gear { solid_n_per_m, slack_m, draft, buff }
        },
    );
    let elastic = (5e6..40e6f64, 5e6..40e6f64, slack).prop_map(|(draft_n_per_m, buff_n_per_m, slack_m)| Law::Elastic {
        draft_n_per_m,
        buff_n_per_m,
        slack_m,
    });
    prop_oneof![3 => gear, 1 => elastic]
}

/// A train under steady forces that its couplers balance, some of them let down from more; speeds, a pulse, a parting, a
/// coupler that breaks.
fn problem() -> impl Strategy<Value = Problem> {
    let vehicle = (30e3..150e3f64, law(), -4e5..6e5f64, 0.5..2.0f64, prop_oneof![Just(0.0), -0.5..0.5f64]);
    let event = (any::<bool>(), any::<prop::sample::Index>(), -8e5..8e5f64, any::<bool>(), any::<bool>());
    (prop::collection::vec(vehicle, 3..14), event).prop_map(|(vehicles, (parts, at, pulse, held, breaks))| {
        let n = vehicles.len() + 1;
        let mass: Vec<f64> = vehicles.iter().map(|v| v.0).chain([80e3]).collect();
        let laws: Vec<Law> = vehicles.iter().map(|v| v.1.clone()).collect();
        let force = |i: usize| vehicles[i].2;
        let steady = |v: usize| if v + 1 < n { force(v) } else { 0.0 } - if v > 0 { force(v - 1) } else { 0.0 };
        let start: Vec<Rest> = vehicles.iter().map(|v| v.1.rest(&[v.2 * v.3.max(1.0), v.2])).collect();
        let mut speed_m_s: Vec<f64> = vehicles.iter().map(|v| v.4).chain([0.0]).collect();
        if held {
            speed_m_s[0] = 0.0;
        }
        let coupler = at.index(n - 1);
        Problem {
            start,
            steady_n: (0..n).map(steady).collect(),
            speed_m_s,
            held_head: held,
            gone: if parts { vec![coupler] } else { Vec::new() },
            forcing: vec![(coupler + 1, Drive::Lines(vec![[0.1, 0.0], [0.2, pulse], [0.4, pulse]]))],
            break_at_n: if breaks { vec![[1.2e6, 1.5e6]; n - 1] } else { Vec::new() },
            ..train(mass, laws, 3.0)
        }
    })
}

fn ask() -> MarchOptions {
    MarchOptions { audit: true, ..MarchOptions::default() }
}

/// The largest force, for tolerances.
fn largest(out: &MarchOutcome) -> f64 {
    out.extremes.iter().flat_map(|e| [e.draft.force_n.abs(), e.buff.force_n.abs()]).fold(0.0, f64::max)
}

fn apart(a: &MarchOutcome, b: &MarchOutcome, sign: f64, at: impl Fn(usize) -> usize) -> f64 {
    let mut most = 0.0f64;
    for (i, e) in a.extremes.iter().enumerate() {
        let other = &b.extremes[at(i)];
        let (draft, buff) = if sign > 0.0 { (other.draft, other.buff) } else { (other.buff, other.draft) };
        most =
            most.max((e.draft.force_n - sign * draft.force_n).abs()).max((e.buff.force_n - sign * buff.force_n).abs());
    }
    most
}

/// The train seen from its other end: speeds and outside forces turn, couplers' forces do not.
fn reversed(p: &Problem) -> Problem {
    let n = p.mass_kg.len();
    let mut q = p.clone();
    q.mass_kg.reverse();
    q.laws.reverse();
    q.start.reverse();
    q.break_at_n.reverse();
    q.speed_m_s = p.speed_m_s.iter().rev().map(|v| -v).collect();
    q.steady_n = p.steady_n.iter().rev().map(|f| -f).collect();
    (q.held_head, q.held_tail) = (p.held_tail, p.held_head);
    q.gone = p.gone.iter().map(|i| n - 2 - i).collect();
    q.forcing = p.forcing.iter().map(|(v, d)| (n - 1 - v, d.scaled(1.0, -1.0))).collect();
    q
}

/// Draft for buff; only for trains that never part, for what has parted pushes and does not pull.
fn turned(p: &Problem) -> Problem {
    let mut q = p.clone();
    for law in &mut q.laws {
        match law {
            Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => std::mem::swap(draft_n_per_m, buff_n_per_m),
            Law::Gear { draft, buff, .. } => std::mem::swap(draft, buff),
        }
    }
    q.start.iter_mut().for_each(|r| (r.force_n, r.travel_m) = (-r.force_n, -r.travel_m));
    q.speed_m_s.iter_mut().for_each(|v| *v = -*v);
    q.steady_n.iter_mut().for_each(|f| *f = -*f);
    q.forcing.iter_mut().for_each(|f| f.1 = f.1.scaled(1.0, -1.0));
    q
}

/// All lengths, times and masses times powers of two, which round nothing.
fn in_other_units(p: &Problem, length: f64, time: f64, mass: f64) -> Problem {
    let force = mass * length / time / time;
    let table = |c: &Curve| {
        let row = |r: &GearRow| GearRow {
            travel_m: r.travel_m * length,
            loading_n: r.loading_n * force,
            unloading_n: r.unloading_n * force,
        };
        Curve::new(c.rows().iter().map(row).collect()).expect("a table")
    };
    let law = |law: &Law| match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, slack_m } => Law::Elastic {
            draft_n_per_m: draft_n_per_m * force / length,
            buff_n_per_m: buff_n_per_m * force / length,
            slack_m: slack_m * length,
        },
        Law::Gear { solid_n_per_m, slack_m, draft, buff } => Law::Gear {
            solid_n_per_m: solid_n_per_m * force / length,
            slack_m: slack_m * length,
            draft: table(draft),
            buff: table(buff),
        },
    };
    Problem {
        mass_kg: p.mass_kg.iter().map(|m| m * mass).collect(),
        laws: p.laws.iter().map(law).collect(),
        start: p.start.iter().map(|r| Rest { force_n: r.force_n * force, travel_m: r.travel_m * length }).collect(),
        speed_m_s: p.speed_m_s.iter().map(|v| v * length / time).collect(),
        steady_n: p.steady_n.iter().map(|f| f * force).collect(),
        forcing: p.forcing.iter().map(|(v, d)| (*v, d.scaled(time, force))).collect(),
        break_at_n: p.break_at_n.iter().map(|b| b.map(|f| f * force)).collect(),
        horizon_s: p.horizon_s * time,
        mark_s: p.mark_s * time,
        ..p.clone()
    }
}

/// Every row of a table split in two that lie on its line.
fn with_more_rows(p: &Problem) -> Problem {
    let middle = |a: &GearRow, b: &GearRow| GearRow {
        travel_m: 0.5 * (a.travel_m + b.travel_m),
        loading_n: 0.5 * (a.loading_n + b.loading_n),
        unloading_n: 0.5 * (a.unloading_n + b.unloading_n),
    };
    let table = |c: &Curve| {
        let mut rows = vec![c.rows()[0]];
        c.rows().windows(2).for_each(|r| rows.extend([middle(&r[0], &r[1]), r[1]]));
        Curve::new(rows).expect("a table")
    };
    let law = |law: &Law| match law {
        Law::Gear { solid_n_per_m, slack_m, draft, buff } => {
            Law::Gear { solid_n_per_m: *solid_n_per_m, slack_m: *slack_m, draft: table(draft), buff: table(buff) }
        }
        elastic => elastic.clone(),
    };
    Problem { laws: p.laws.iter().map(law).collect(), ..p.clone() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    /// No step creates energy beyond rounding: some units in the last place of all there is, and kl times 1e-15 m times the speeds.
    #[test]
    fn energy_is_never_created(problem in problem()) {
        let out = solve(&problem, &ask());
        let energy = out.energy.expect("asked for");
        let all = energy.start_j.abs() + energy.work_j.abs() + largest(&out) * 0.1;
        prop_assert!(energy.created_j <= 1e-13 * all, "{energy:?}");
        prop_assert!(energy.end_j <= energy.start_j + energy.work_j - energy.released_j + 1e-12 * all, "{energy:?}");
    }

    /// From the other end it is the same train. Rounding differs, and grows in a motion that is chaotic.
    #[test]
    fn head_and_tail(problem in problem()) {
        let (a, b) = (solve(&problem, &ask()), solve(&reversed(&problem), &ask()));
        let n = problem.laws.len();
        let off = apart(&a, &b, 1.0, |i| n - 1 - i);
        prop_assert!(off <= 1e-7 * largest(&a), "{off} of {}", largest(&a));
    }

    #[test]
    fn draft_and_buff(problem in problem()) {
        let whole = Problem { gone: Vec::new(), break_at_n: Vec::new(), ..problem };
        let (a, b) = (solve(&whole, &ask()), solve(&turned(&whole), &ask()));
        let off = apart(&a, &b, -1.0, |i| i);
        prop_assert!(off <= 1e-7 * largest(&a), "{off} of {}", largest(&a));
    }

    /// In other units the same bits.
    #[test]
    fn units(problem in problem(), length in -12..12i32, time in -6..6i32, mass in -12..12i32) {
        let scale = |n: i32| 2f64.powi(n);
        let force = scale(mass + length - 2 * time);
        let (a, b) = (solve(&problem, &ask()), solve(&in_other_units(&problem, scale(length), scale(time), scale(mass)), &ask()));
        prop_assert_eq!(a.events, b.events);
        for (x, y) in a.extremes.iter().zip(&b.extremes) {
            prop_assert_eq!((x.draft.force_n * force, x.draft.time_s * scale(time)), (y.draft.force_n, y.draft.time_s));
            prop_assert_eq!((x.buff.force_n * force, x.buff.time_s * scale(time)), (y.buff.force_n, y.buff.time_s));
        }
    }

    #[test]
    fn rows_on_a_line(problem in problem()) {
        let (a, b) = (solve(&problem, &ask()), solve(&with_more_rows(&problem), &ask()));
        let off = apart(&a, &b, 1.0, |i| i);
        prop_assert!(off <= 1e-7 * largest(&a), "{off} of {}", largest(&a));
    }

    /// Groups that are split are the same train, to the last bit of every force of its analysis.
    #[test]
    fn groups_may_be_split(
        draft in table(), (slack, solid, load, mass) in (0.0..0.03f64, 60e6..260e6f64, 1e5..6e5f64, 30e3..150e3f64),
        (first, count, at) in (1..11usize, 12..16usize, 1..15usize),
    ) {
        let rows: Vec<String> = draft.rows().iter().map(|r| format!("[\"{} m\", \"{} N\", \"{} N\"]", r.travel_m, r.loading_n, r.unloading_n)).collect();
        let group = |count: usize| format!("[[vehicle]]\nlabel = \"car\"\nmass = \"{mass} kg\"\ncount = {count}\n");
        let couplers = |groups: String| {
            let text = format!(
                "[coupler]\ngear = [{}]\nsolid_stiffness = \"{solid} N/m\"\nslack = \"{slack} m\"\nrated_load = \"1 MN\"\n\
                 [[vehicle]]\nlabel = \"locomotive\"\nmass = \"195 t\"\nheld = true\n{groups}[load]\nuniform = \"{load} N\"\n\
                 [[scenario]]\nkind = \"break\"\ncoupler = {}\nhorizon = \"3 s\"\n",
                rows.join(", "),
                at.min(count)
            );
            let train = trainsafe::consist::parse(&text, std::path::Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
            let analysis = trainsafe::analyze(&train, &trainsafe::Options::default()).expect("sound");
            analysis.scenarios[0].cases[0].couplers.clone()
        };
        let (whole, split) = (couplers(group(count)), couplers(group(first) + &group(1) + &group(count - first - 1)));
        prop_assert_eq!(whole.len(), count - 1);
        prop_assert_eq!(whole, split);
    }
}
