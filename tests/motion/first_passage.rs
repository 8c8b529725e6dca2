//! The first passage apart from later reflections, against the paper's numbers and analyses with a shorter horizon.

use std::path::Path;

use crate::campaign::row::WorstRow;
use trainsafe::chain::Scene;
use trainsafe::findings::CaseFindings;
use trainsafe::solve::{Ask, Method, Solution, Wanted, solve};
use trainsafe::{Options, Train, analyze, consist, report};

fn read(file: &str) -> Train {
    consist::read(Path::new(file)).unwrap_or_else(|e| panic!("{e}"))
}

fn case(train: &Train) -> CaseFindings {
    analyze(train, &Options::default()).expect("sound").scenarios.remove(0).cases.remove(0)
}

/// Figure 4: the extremum of the first passage is -1.47279347663338 at t = 54.9374086688489, that of four transits 1.50835269566244.
#[test]
fn figure_4_has_its_first_extremum_apart() {
    let case = case(&read("trains/paper-figure-4.toml"));
    let coupler = &case.couplers[0];
    let first = coupler.first_passage.as_ref().expect("a first passage");
    assert!((first.peak_buff_n.expect("in buff") + 1.472_793_476_633_38).abs() < 1e-12);
    assert!((first.peak_buff_time_s.expect("in buff") - 54.937_408_668_848_9).abs() < 1e-6);
    assert!((coupler.peak_draft_n.expect("in draft") - 1.508_352_695_662_44).abs() < 1e-12);
    let worst = case.worst_first_passage.expect("a worst coupler");
    assert!(worst.coupler == 1 && (worst.peak_force_n + 1.472_793_476_633_38).abs() < 1e-12);
    assert!((case.first_passage_s - 100.0).abs() < 3.0, "two transits: {}", case.first_passage_s);
}

/// What is told of the first passage is what an analysis says whose horizon is its end.
#[test]
fn the_first_passage_is_an_analysis_of_its_own() {
    for file in
        ["trains/european-freight-train.toml", "trains/paper-figure-4-damped.toml", "trains/paper-figure-5.toml"]
    {
        let mut spec = read(file).into_spec();
        spec.scenarios.truncate(1);
        if let trainsafe::train::Event::Break { couplers } = &mut spec.scenarios[0].event {
            couplers.truncate(1);
        }
        let whole = case(&spec.clone().build().expect("a train"));
        spec.scenarios[0].horizon_s = Some(whole.first_passage_s);
        let short = case(&spec.build().expect("a train"));
        assert_eq!(short.first_passage_s, short.horizon_s);
        let room = whole.error_bound_n + short.error_bound_n;
        assert_eq!(whole.exceeding_first_passage, short.exceeding, "{file}");
        for (a, b) in whole.couplers.iter().zip(&short.couplers) {
            let first = a.first_passage.as_ref().expect("a first passage");
            let near = |x: Option<f64>, y: Option<f64>| (x.unwrap_or(0.0) - y.unwrap_or(0.0)).abs() <= room;
            assert!(
                near(first.peak_draft_n, b.peak_draft_n) && near(first.peak_buff_n, b.peak_buff_n),
                "{file} {a:?} {b:?}"
            );
            assert_eq!(b.first_passage.as_ref().map(|f| f.peak_draft_n), Some(b.peak_draft_n));
        }
    }
}

/// A side that a coupler's force never enters has no peak, not one of rounding, and the first passage has no larger one than the whole.
#[test]
fn rounding_is_no_peak() {
    for file in ["trains/european-freight-train.toml", "trains/mixed-manifest-train.toml", "trains/ore-train.toml"] {
        let train = read(file);
        for case in analyze(&train, &Options::default()).expect("sound").scenarios.iter().flat_map(|s| &s.cases) {
            for c in &case.couplers {
                let first = c.first_passage.as_ref().expect("a first passage");
                for (all, first) in [(c.peak_draft_n, first.peak_draft_n), (c.peak_buff_n, first.peak_buff_n)] {
                    assert!(all.is_none_or(|n| n.abs() > 1e-4), "{file}: coupler {}: {all:?}", c.coupler);
                    assert!(
                        first.is_none_or(|n| all.is_some_and(|all| n.abs() <= all.abs())),
                        "{file}: {first:?} {all:?}"
                    );
                }
            }
        }
    }
}

const TWO_CARS: &str = r#"
[coupler]
stiffness = "11.1 MN/m"
rated_load = "1.78 MN"
rated_buff = "3.1 MN"
[[vehicle]]
count = 2
mass = "119.3 t"
[[scenario]]
kind = "impact"
at = "tail"
vehicles = 1
speed = "6 mph"
"#;

/// Two cars: the collision is `v sqrt(k m / 2)` in buff, and the rebound is as large in draft; both are told.
#[test]
fn an_impact_tells_the_collision_and_the_rebound() {
    let train = consist::parse(TWO_CARS, Path::new("two.toml")).unwrap_or_else(|e| panic!("{e}"));
    let speed = 6.0 * 0.44704;
    let due = speed * f64::sqrt(11.1e6 * 119.3e3 / 2.0);
    let found = case(&train);
    assert!((-found.couplers[0].peak_buff_n.expect("in buff") - due).abs() < 1e-3);
    let text = report::terminal(&analyze(&train, &Options::default()).expect("sound"), &[]);
    assert!(text.contains("Largest share of a rating in buff: 70.4 % (2.18"), "{text}");
    assert!(
        text.contains("Largest share of a rating in draft: 123 %") && text.contains("rebound of the springs"),
        "{text}"
    );
    // With one rating for both senses the earlier of two equal extremes is the worst: the collision.
    let tie = TWO_CARS.replace("rated_buff = \"3.1 MN\"\n", "");
    let tie = case(&consist::parse(&tie, Path::new("tie.toml")).unwrap_or_else(|e| panic!("{e}")));
    assert!(tie.couplers[0].peak_force_n < 0.0 && tie.couplers[0].peak_time_s < 0.2, "{:?}", tie.couplers[0]);
}

/// A verdict that changes after the first passage says both.
#[test]
fn a_verdict_that_later_reflections_change_says_so() {
    let train = read("tests/first_passage/runaway-cut.toml");
    let found = case(&train);
    let first = found.worst_first_passage.as_ref().expect("a worst coupler");
    assert!(first.peak_time_s <= found.first_passage_s);
    let buff = found.couplers.iter().filter_map(|c| c.first_passage.as_ref()?.peak_buff_n).fold(0.0, f64::min);
    assert!((buff / -4.57e6 - 1.0).abs() < 2e-3, "{buff}");
}

/// Extremes up to a mark are those of a scene that ends there, by every method and whatever is wanted; those up to the horizon stay
/// what they are.
#[test]
fn a_mark_is_a_horizon_of_its_own() {
    let methods = [None, Some(Method::Fronts), Some(Method::Modal), Some(Method::Propagator)];
    let (mut compared, mut over) = (0, 0);
    for seed in 0..20u64 {
        let mut scene = crate::campaign::scene(seed);
        let largest = scene.initial.iter().fold(scene.force.abs(), |most, f| most.max(f.abs()));
        let rating = largest * (0.9 + 0.02 * (seed % 40) as f64);
        scene.rated_draft.fill(rating);
        scene.rated_buff.fill(0.9 * rating);
        let mark = scene.horizon * (0.05 + 0.9 * (seed as f64 * 0.618).fract());
        let short = Scene { horizon: mark, ..scene.clone() };
        for method in methods {
            let ask = Ask { tolerance: 1e-9 * largest, method, ..Ask::default() };
            let marked = Ask { mark: Some(mark), ..ask };
            let (Ok(both), Ok(alone), Ok(whole)) = (solve(&scene, &marked), solve(&short, &ask), solve(&scene, &ask))
            else {
                continue;
            };
            if method == Some(Method::Propagator) {
                assert_eq!(both.springs, whole.springs, "seed {seed}");
                let worst = solve(&scene, &Ask { wanted: Wanted::Worst, ..marked }).expect("a solution");
                let of = |springs| WorstRow::of(&short, &Solution { springs, ..both.clone() });
                assert!(of(worst.to_mark).agrees(&of(both.to_mark.clone()), &short), "seed {seed}");
            }
            let room = both.error_bound + alone.error_bound;
            for (a, b) in both.to_mark.iter().flatten().zip(alone.springs.iter().flatten()) {
                for (a, b) in [(&a.draft, &b.draft), (&a.buff, &b.buff)] {
                    assert!((a.best.value - b.best.value).abs() <= room, "seed {seed} {method:?}: {a:?} {b:?}");
                    assert!(a.best.at <= mark * (1.0 + 1e-15), "seed {seed} {method:?}: {a:?}");
                    let decided = a.exceeds().zip(b.exceeds());
                    assert!(decided.is_none_or(|(a, b)| a == b), "seed {seed} {method:?}: {a:?} {b:?}");
                    if let Some((a, b)) = a.first_over.zip(b.first_over) {
                        assert!((a - b).abs() <= 1e-6 * mark, "seed {seed} {method:?}: {a} {b}");
                        over += 1;
                    }
                    compared += 1;
                }
            }
            assert_eq!(both.to_mark.len(), alone.springs.len());
        }
    }
    assert!(compared > 500 && over > 50, "{compared} {over}");
}
