//! Forces by place and time, as pictures show them, against the forces of single couplers.

use std::path::Path;

use trainsafe::findings::{self, Field, Of};
use trainsafe::{Options, Train, analyze, consist};

fn train(name: &str) -> Train {
    consist::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("trains").join(format!("{name}.toml"))).expect("a train")
}

/// The field of a scenario's first case, the train, and the case's broken coupler.
fn first(name: &str, scenario: usize, of: Of) -> (Train, Field, Option<usize>) {
    let mut spec = train(name).into_spec();
    spec.scenarios.truncate(scenario + 1);
    if let trainsafe::train::Event::Break { couplers } = &mut spec.scenarios[scenario].event {
        couplers.truncate(1);
    }
    let train = spec.build().expect("a train");
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let case = &analysis.scenarios[scenario].cases[0];
    let field = findings::field(&train, scenario, case, of).expect("affordable");
    (train, field, case.broken_coupler.map(|b| b - 1))
}

/// Every coupler's row is its history, but for the exact peaks that were put in: no more than two a row.
///
/// Tolerance: the cubic between steps is right to 8e-4 of what the fastest mode swings, which is less than the largest force.
#[test]
fn rows_are_histories() {
    let trains = [
        ("paper-figure-4", 0),
        ("paper-figure-5", 0),
        ("paper-figure-4-damped", 0),
        ("mixed-manifest-train", 2),
        ("hauled-train-on-a-grade", 1),
    ];
    for (name, scenario) in trains {
        let (train, field, broken) = first(name, scenario, Of::Event);
        assert_eq!((field.couplers_per_row, field.instants_per_column), (1, 1), "{name}");
        assert_eq!(field.rows(), train.couplers().len());
        for row in (0..field.rows()).step_by(7).filter(|r| Some(*r) != broken) {
            let exact = findings::history(&train, scenario, broken, row, &field.times_s);
            let c = &train.couplers()[row];
            let share = |f: f64| f / if f < 0.0 { c.rated_buff_n } else { c.rated_draft_n };
            let largest = f64::from(field.largest());
            let off = |(s, f): (&f32, &f64)| (f64::from(*s) - share(*f)).abs() > 1e-3 * largest;
            let wrong = field.row(row).iter().zip(&exact).filter(|p| off(*p)).count();
            assert!(wrong <= 2, "{name}, coupler {}: {wrong} of {}", row + 1, exact.len());
        }
    }
}

/// No peak is hidden: the field's largest utilisation is the case's, however coarse it is.
#[test]
fn the_largest_utilisation_is_there() {
    for (name, scenario) in [("paper-figure-4", 0), ("mixed-manifest-train", 2), ("ore-train", 1)] {
        let train = train(name);
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let case = &analysis.scenarios[scenario].cases[0];
        let worst = case.worst.as_ref().expect("a worst coupler");
        let field = findings::field(&train, scenario, case, Of::Event).expect("affordable");
        for by in [1, 2, 7, 50] {
            let folded = field.folded(by);
            let largest = folded.row(worst.coupler - 1).iter().fold(0.0f32, |m, s| m.max(s.abs()));
            assert!((f64::from(largest) - worst.utilisation).abs() < 1e-6, "{name} by {by}: single precision");
            assert_eq!(folded.instants_per_column, by);
        }
    }
}

/// Many couplers share rows, and still show the worst of them.
#[test]
fn a_long_train_has_fewer_rows_and_the_same_peak() {
    let mut spec = train("paper-figure-4").into_spec();
    spec.vehicles = vec![spec.vehicles[1].clone(); 5001];
    spec.couplers = vec![spec.couplers[0].clone(); 5000];
    spec.load = trainsafe::train::Load::Uniform(1.0);
    spec.scenarios[0].event = trainsafe::train::Event::Break { couplers: vec![4999] };
    spec.scenarios[0].horizon_s = Some(300.0);
    let train = spec.build().expect("a train");
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let case = &analysis.scenarios[0].cases[0];
    let field = findings::field(&train, 0, case, Of::Event).expect("affordable");
    assert_eq!(field.couplers_per_row, 3);
    assert!(field.share.len() <= 400_000);
    let worst = case.worst.as_ref().expect("a worst coupler").utilisation;
    assert!((f64::from(field.largest()) - worst).abs() < 1e-6, "single precision");
}

/// A coupler that breaks on the way carries a force before and none after; the rod's levels are whole halves of the load.
#[test]
fn cascades_and_rods() {
    let (_, field, _) = first("hauled-train-on-a-grade", 1, Of::Cascade);
    let gone: Vec<usize> = (0..field.rows()).filter(|r| field.row(*r).last().is_some_and(|s| s.is_nan())).collect();
    assert_eq!(gone, [10, 45]);
    for row in gone {
        let until = field.row(row).iter().position(|s| s.is_nan()).expect("breaks");
        assert!(until > 0 && field.row(row)[until..].iter().all(|s| s.is_nan()));
    }
    let (_, rod, broken) = first("paper-figure-4", 0, Of::Rod);
    assert!(rod.row(broken.expect("a break")).iter().all(|s| s.is_nan()));
    assert!(rod.row(3).iter().all(|s| (2.0 * s).fract() == 0.0 && s.abs() <= 1.0));
}
