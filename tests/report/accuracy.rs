//! The engineers' methods are what they are called, and the comparison measures what it says.

use trainsafe::accuracy::peers::Peer;
use trainsafe::accuracy::reference::Reference;
use trainsafe::accuracy::{self, AccuracyOptions, RowOrigin};
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::dd::Dd;
use trainsafe::train::{CouplerSpec, Event, Load, Rule, Scenario, Train, TrainSpec, VehicleSpec};

/// A held head and one vehicle whose coupler's force falls from 1 to a mean of 0.25: `F = 1 - 0.75 (1 - cos omega t)`.
fn one_live_vehicle() -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0, 2.5], stiffness: vec![0.7], held_head: true, held_tail: false },
        source: 1,
        force: 0.75,
        duration: f64::INFINITY,
        initial: vec![1.0],
        rated_draft: vec![1.0],
        rated_buff: vec![1.0],
        horizon: 40.0,
    }
}

fn exact(scene: &Scene, t: f64) -> f64 {
    let omega = (scene.chain.stiffness[0] / scene.chain.mass[1]).sqrt();
    let swing = |t: f64| if t > 0.0 { 1.0 - (omega * t).cos() } else { 0.0 };
    scene.initial[0] - scene.force * (swing(t) - swing(t - scene.duration))
}

fn times(scene: &Scene) -> Vec<f64> {
    (1..=37).map(|i| scene.horizon * f64::from(i) / 37.0).collect()
}

fn worst_error(scene: &Scene, peer: Peer) -> f64 {
    let times = times(scene);
    let marched = peer.march(scene, &times).expect("no method gives up on one vehicle");
    assert_eq!(marched.forces.len(), times.len());
    let errors = times.iter().zip(&marched.forces).map(|(&t, f)| (f[0] - exact(scene, t)).abs());
    errors.fold(0.0, f64::max)
}

/// Slope of a straight line through log error against log step (least squares).
fn observed_order(scene: &Scene, phases: &[f64], peer: fn(f64) -> Peer) -> f64 {
    let points: Vec<(f64, f64)> = phases.iter().map(|&p| (p.ln(), worst_error(scene, peer(p)).ln())).collect();
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Over 21 radians the phase error is small against a radian at these steps, so what is left of higher orders bends the
/// line by less than 0.05; an order that is wrong is wrong by 1 at least.
#[test]
fn orders_of_convergence() {
    let mut pulse = one_live_vehicle();
    pulse.duration = 7.3;
    for scene in [one_live_vehicle(), pulse] {
        let fine = [0.08, 0.04, 0.02, 0.01];
        let orders = [
            (2.0, observed_order(&scene, &fine, |phase| Peer::Newmark { phase })),
            (2.0, observed_order(&scene, &fine, |phase| Peer::Verlet { phase })),
            (4.0, observed_order(&scene, &fine, |phase| Peer::RungeKutta4 { phase })),
        ];
        for (expected, observed) in orders {
            assert!((observed - expected).abs() < 0.05, "{expected}: {orders:?}");
        }
    }
}

/// A mode runs slow by (h omega)^2 / 12 with average acceleration and fast by (h omega)^2 / 24 with leapfrog: after t the
/// force is off by that share of omega t, times the amplitude, to leading order. A tenth covers the next order, (h omega)^2.
#[test]
fn second_order_methods_have_their_known_phase_error() {
    let scene = one_live_vehicle();
    let (phase, omega) = (0.05f64, (0.7f64 / 2.5).sqrt());
    let largest = |share: f64| {
        let error = |t: &f64| (scene.force * share * omega * t * (omega * t).sin()).abs();
        times(&scene).iter().map(error).fold(0.0, f64::max)
    };
    for (peer, share) in
        [(Peer::Newmark { phase }, phase * phase / 12.0), (Peer::Verlet { phase }, phase * phase / 24.0)]
    {
        let ratio = worst_error(&scene, peer) / largest(share);
        assert!((ratio - 1.0).abs() < 0.1, "{peer:?}: {ratio}");
    }
}

/// Each step's estimated error is under the tolerance of displacements of up to 2, and there are a hundred steps at most.
#[test]
fn dormand_prince_keeps_its_tolerance() {
    let mut pulse = one_live_vehicle();
    pulse.duration = 27.3;
    for scene in [one_live_vehicle(), pulse] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let error = worst_error(&scene, Peer::DormandPrince8 { tolerance });
            assert!(error < 100.0 * tolerance, "{tolerance:e}: {error:e}");
        }
    }
}

/// Thirteen unequal vehicles with a pulse on one of them; the free chain, and held ends.
fn unequal_trains() -> Vec<Scene> {
    let mass = |v: i32| 1.0 + 0.6 * (1.7 * f64::from(v * v)).sin();
    let stiffness = |i: i32| 1.0 + 0.4 * (2.3 * f64::from(i * i)).cos();
    let chain = Chain {
        mass: (1..=13).map(mass).collect(),
        stiffness: (1..=12).map(stiffness).collect(),
        held_head: false,
        held_tail: false,
    };
    let scene = |held_head: bool, held_tail: bool, source: usize| Scene {
        chain: Chain { held_head, held_tail, ..chain.clone() },
        source,
        force: -0.8,
        duration: 5.3,
        initial: vec![0.3; 12],
        rated_draft: vec![1.0; 12],
        rated_buff: vec![1.0; 12],
        horizon: 40.0,
    };
    vec![scene(false, false, 0), scene(true, false, 12), scene(false, true, 4), scene(true, true, 7)]
}

/// Against the modal sums, good to 1e-13 here. Newmark and leapfrog at a phase of 0.02 are off by about a share of
/// (0.02)^2 / 12 of the fastest mode's 80 radians of phase; Runge-Kutta by (0.02)^4 / 120 of it; 1e-11 a step over some
/// hundred steps is left to the method that chooses them. Each figure is ten times that.
#[test]
fn every_march_follows_unequal_trains_with_any_ends() {
    for scene in unequal_trains() {
        let modes = trainsafe::solve::modal::modes(&scene);
        let peaks = trainsafe::solve::search::peaks(&scene, &modes, [0.0; 2], None).peaks[0].clone();
        let times = times(&scene);
        for (peer, margin) in [
            (Peer::Newmark { phase: 0.02 }, 2.7e-2),
            (Peer::Verlet { phase: 0.02 }, 2.7e-2),
            (Peer::RungeKutta4 { phase: 0.02 }, 1.1e-6),
            (Peer::DormandPrince8 { tolerance: 1e-11 }, 1e-8),
        ] {
            let marched = peer.march(&scene, &times).expect("nothing is stiff here");
            for (spring, peaks) in peaks.iter().enumerate() {
                let exact = trainsafe::solve::sums::history(&scene, &modes, spring, &times);
                for (n, f) in exact.iter().enumerate() {
                    let error = (marched.forces[n][spring] - f).abs();
                    assert!(error < margin, "{peer:?}, spring {spring}, {n}: {error:e}");
                }
                // Between steps h^2 / 8 max |F''| is missed: under 0.05 for the longest steps here.
                let best = [peaks.draft.best.value, peaks.buff.best.value];
                for (found, exact) in marched.extremes[spring].iter().zip(best) {
                    assert!((found - exact).abs() < margin + 0.05, "{peer:?}, spring {spring}: {found} for {exact}");
                }
            }
        }
    }
}

/// At whole steps both methods of order 2 solve the equations exactly, but for their frequencies: `tan(theta / 2) =
/// h omega / 2` with average acceleration, `sin(theta / 2) = h omega / 2` with leapfrog, theta the phase of a step. The
/// modal sums with these frequencies agree to rounding, which a hundred steps of a few hundred roundings keep under 1e-12.
#[test]
fn second_order_methods_are_exact_but_for_their_frequencies() {
    for mut scene in unequal_trains() {
        scene.duration = f64::INFINITY;
        for peer in [Peer::Newmark { phase: 1.5 }, Peer::Verlet { phase: 1.5 }] {
            let steps = (scene.horizon * trainsafe::solve::propagator::omega_max(&scene) / 1.5).ceil();
            let width = scene.horizon / steps;
            let times: Vec<f64> = (1..=steps as i32).map(|n| f64::from(n) * width).collect();
            let mut modes = trainsafe::solve::modal::modes(&scene);
            for omega in &mut modes.omega {
                let half = 0.5 * width * omega.hi;
                let theta = 2.0 * if matches!(peer, Peer::Newmark { .. }) { half.atan() } else { half.asin() };
                *omega = Dd::quotient(theta, width);
            }
            let marched = peer.march(&scene, &times).expect("no method of fixed steps gives up");
            for spring in 0..scene.initial.len() {
                let exact = trainsafe::solve::sums::history(&scene, &modes, spring, &times);
                for (n, f) in exact.iter().enumerate() {
                    let error = (marched.forces[n][spring] - f).abs();
                    assert!(error < 1e-12, "{peer:?}, spring {spring}, {n}: {error:e}");
                }
            }
        }
    }
}

/// Equal cars behind a held locomotive; with twelve vehicles, the longer part is that ahead of the coupler near the rear.
fn train(vehicles: usize) -> Train {
    loaded(vehicles, 8e5)
}

/// The same with another load, N.
fn loaded(vehicles: usize, load_n: f64) -> Train {
    let car = |v: usize| VehicleSpec { label: Some(format!("car {v}")), held: v == 0, ..VehicleSpec::new(1e5) };
    let coupler = CouplerSpec { rated_buff_n: 1.5e6, ..CouplerSpec::linear(2e7, 1e6) };
    let scenario = |name: &str, couplers: Vec<usize>| Scenario {
        name: name.to_owned(),
        event: Event::Break { couplers },
        horizon_s: None,
        cascade: Rule::Keep,
        left_out_in_buff: Vec::new(),
        response: trainsafe::train::Response::default(),
    };
    TrainSpec {
        name: "eleven cars".to_owned(),
        vehicles: (0..vehicles).map(car).collect(),
        couplers: vec![coupler; vehicles - 1],
        load: Load::Uniform(load_n),
        scenarios: vec![
            scenario("near the rear", if vehicles > 5 { vec![4, vehicles - 3] } else { vec![0] }),
            scenario("the only one", vec![0]),
        ],
        ..TrainSpec::default()
    }
    .build()
    .unwrap_or_else(|wrong| panic!("{wrong}"))
}

fn quick() -> AccuracyOptions {
    AccuracyOptions { runs: 1, ..AccuracyOptions::default() }
}

#[test]
fn compares_the_longest_part_and_this_crates_bounds_hold() {
    let accuracy = accuracy::run(&train(12), None, &quick()).expect("a plain train");
    assert_eq!(accuracy.broken_coupler, Some(10));
    assert_eq!(accuracy.couplers, [1, 9]);
    assert_eq!(accuracy.rating_n, 1.5e6);
    let names = ["fronts", "modal", "propagator", "Newmark", "Störmer-Verlet", "Runge-Kutta 4"];
    for name in names.into_iter().chain(["Dormand-Prince 8(5,3)"]) {
        assert!(accuracy.rows.iter().any(|row| row.method == name), "{name}");
    }
    assert!(accuracy.left_out.is_empty());
    for row in &accuracy.rows {
        assert!(row.run_time_s > 0.0);
        match (row.origin, row.bound_n) {
            // None of these settings comes closer: smaller, and it was not the march that was measured.
            (RowOrigin::Peer, None) => assert!(row.force_error_n > 1e-12 * accuracy.rating_n, "{row:?}"),
            (RowOrigin::Ours(_) | RowOrigin::Planner(_), Some(bound)) => {
                // A bound of more than the tolerance that is never missed would prove nothing.
                let tolerance = row.tolerances.map_or(1e-9, |t| t[0].max(1e-9));
                assert!(bound < tolerance * accuracy.rating_n, "{row:?}");
                assert!(row.peak_error_n <= bound && row.force_error_n <= bound, "{row:?}");
            }
            _ => panic!("a bound from a method that has none, or none from one that has: {row:?}"),
        }
    }
}

/// Three and a third times shorter steps: errors smaller by the square of that, or by its fourth power. Half of the
/// exponent's distance to the next whole number is left for higher orders.
#[test]
fn measured_errors_fall_with_the_step_as_the_order_says() {
    let accuracy = accuracy::run(&train(12), None, &quick()).expect("a plain train");
    for (name, order) in [("Newmark", 2.0), ("Störmer-Verlet", 2.0), ("Runge-Kutta 4", 4.0)] {
        let error = |setting: &str| {
            let row = accuracy.rows.iter().find(|r| r.method == name && r.setting == setting);
            row.map(|r| r.force_error_n).expect("a row for every setting")
        };
        let observed = (error("h ω_max = 0.1") / error("h ω_max = 0.03")).ln() / (0.1f64 / 0.03).ln();
        assert!((observed - order).abs() < 0.5, "{name}: {observed}");
    }
}

#[test]
fn unknown_scenarios_and_empty_parts_are_errors_in_words() {
    let error = |train: &Train, name| accuracy::run(train, name, &quick()).map(|_| ()).expect_err("nothing to run");
    assert_eq!(
        error(&train(12), Some("no such")).to_string(),
        r#"no scenario is named "no such"; the train has "near the rear", "the only one""#
    );
    let error = error(&train(2), Some("the only one"));
    assert_eq!(error.to_string(), "the only one: no coupler is left to watch");
}

#[test]
fn writes_three_files_and_nothing_else() {
    let accuracy = accuracy::run(&train(12), None, &quick()).expect("a plain train");
    let folder = tempfile::tempdir().expect("a folder for the files");
    let inside = folder.path().join("made on the way");
    accuracy::write(&accuracy, &inside).expect("the folder can be written");
    let mut names: Vec<String> = std::fs::read_dir(&inside)
        .expect("the folder is there")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["accuracy.csv", "accuracy.md", "error-against-time.svg"]);
    let read = |name: &str| std::fs::read_to_string(inside.join(name)).expect("just written");
    let mut table = csv::Reader::from_reader(read("accuracy.csv").leak().as_bytes());
    let records: Vec<_> = table.records().collect::<Result<_, _>>().expect("as many fields in every record");
    assert_eq!(records.len(), accuracy.rows.len());
    for (record, row) in records.iter().zip(&accuracy.rows) {
        assert_eq!(record[8].parse(), Ok(row.peak_error_n));
        assert_eq!(record[12].is_empty(), row.bound_n.is_none());
    }
    assert_eq!(read("accuracy.md").matches("\n| ").count(), accuracy.rows.len() + 2);
    assert!(read("error-against-time.svg").contains("fronts"));
}

#[test]
fn an_unwritable_folder_is_named() {
    let accuracy = accuracy::run(&train(12), None, &quick()).expect("a plain train");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a file");
    std::fs::write(&file, "in the way").expect("a file");
    let error = accuracy::write(&accuracy, &file).expect_err("a file is no folder").to_string();
    assert!(error.starts_with("cannot write ") && error.contains("a file"), "{error}");
}

/// A double-double holds 106 bits of the reference's force: what is left is under 1e-31 of forces of up to 2.
#[test]
fn forces_at_many_instants_are_the_references_own() {
    for scene in unequal_trains() {
        let reference = Reference::new(&scene).expect("a plain scene");
        let (springs, times) = ([0, 5, 11], [0.0, 3.1, 5.3, 17.7]);
        let forces = reference.forces(&springs, &times);
        for (row, &t) in forces.iter().zip(&times) {
            for (force, &spring) in row.iter().zip(&springs) {
                let rest = reference.error_of(spring, t, force.hi);
                assert!((rest - force.lo.abs()).abs() < 1e-30, "spring {spring}, t = {t}: {rest:e}");
            }
        }
    }
}

#[test]
fn a_coupler_without_load_breaks_without_effect() {
    let train = loaded(12, 0.0);
    let error = accuracy::run(&train, None, &quick()).map(|_| ()).expect_err("nothing to compare");
    assert_eq!(error.to_string(), "near the rear: the coupler that breaks carries no force, so nothing happens");
}

/// Twelve cars with friction gears and slack behind a held head; the last coupler breaks.
fn geared(law: &str) -> Train {
    let text = format!(
        "[coupler]\n{law}\nrated_load = \"1.5 MN\"\n[[vehicle]]\nmass = \"130 t\"\nheld = true\n[[vehicle]]\ncount = 13\n\
         mass = \"130 t\"\n[load]\nuniform = \"0.6 MN\"\n[[scenario]]\nname = \"s\"\nkind = \"break\"\ncoupler = 13\nhorizon = \"3 s\""
    );
    trainsafe::consist::parse(&text, std::path::Path::new("geared.toml")).expect("a right train")
}

/// The march is right to its estimate; clamped methods come nearer with smaller steps; those that follow another train do not.
#[test]
fn methods_on_a_train_with_gears() {
    let gear = "gear = [[\"0 mm\", \"0 kN\", \"0 kN\"], [\"7 mm\", \"120 kN\", \"60 kN\"], [\"60 mm\", \"900 kN\", \"220 kN\"]]\n\
                solid_stiffness = \"200 MN/m\"\nslack = \"25 mm\"";
    let accuracy = accuracy::run(&geared(gear), None, &quick()).expect("a train with gears");
    assert!(
        accuracy.is_march && accuracy.couplers == [1, 13] && accuracy.left_out.is_empty(),
        "{:?}",
        accuracy.left_out
    );
    assert!(accuracy.doubt_n < 1e-15);
    let error = |method: &str, setting: &str| {
        let row = accuracy.rows.iter().find(|r| r.method == method && r.setting == setting);
        row.unwrap_or_else(|| panic!("a row for {method}, {setting}")).peak_error_n / accuracy.rating_n
    };
    for row in accuracy.rows.iter().filter(|r| r.origin == RowOrigin::March) {
        assert!(row.peak_error_n < 1e-14 * accuracy.rating_n, "{row:?}");
        assert!(row.estimate_n.is_none_or(|n| row.peak_error_n <= n && n < 1e-9 * accuracy.rating_n), "{row:?}");
    }
    for method in ["Verlet with a clamp", "Runge-Kutta 4 with a clamp"] {
        assert!(error(method, "h ω_max = 0.01") < 0.01 * error(method, "h ω_max = 1"), "{method}");
        assert!(error(method, "h ω_max = 0.003") < 1e-5, "{method}");
    }
    // Without events it has no order left at the kinks: it comes nearer, and not by its tolerance.
    let adaptive = |setting| error("Dormand-Prince 5(4) with a clamp", setting);
    assert!(adaptive("tolerance 1e-9") < 0.1 * adaptive("tolerance 1e-3"));
    for (method, setting) in
        [("friction smoothed by speed", "below 0.001 m/s"), ("softened lock", "solid stiffness / 2")]
    {
        assert!(error(method, setting) > 1e-3, "{method}");
    }
    let (page, csv) = (accuracy::markdown(&accuracy), accuracy::csv(&accuracy).expect("in memory"));
    assert!(page.contains("estimate ") && page.contains("Couplers 1 to 13 over 3.000000 s"), "{page}");
    assert!(csv.lines().next().is_some_and(|head| head.ends_with("error_estimate_n,error_estimate_of_rating")));
}

/// A gap without friction: no method that differs by friction alone has a row.
#[test]
fn methods_on_a_train_with_slack_alone() {
    let accuracy = accuracy::run(&geared("stiffness = \"20 MN/m\"\nslack = \"20 mm\""), None, &quick()).expect("slack");
    assert!(accuracy.left_out.len() == 6 && accuracy.left_out.iter().all(|l| l.ends_with(": no coupler has friction")));
    let ours = accuracy.rows.iter().find(|r| r.origin == RowOrigin::March).expect("a row");
    assert!(ours.estimate_n.is_some_and(|n| ours.peak_error_n <= n), "{ours:?}");
}
