use super::{Curve, CurveProblem, GearRow, Law, LawProblem};

fn curve(rows: &[[f64; 3]]) -> Curve {
    let row = |r: &[f64; 3]| GearRow { travel_m: r[0] / 1e3, loading_n: r[1] * 1e3, unloading_n: r[2] * 1e3 };
    Curve::new(rows.iter().map(row).collect()).expect("a valid table")
}

fn gear_a(slack_m: f64) -> Law {
    let gear = curve(&[[0., 0., 0.], [7., 120., 120.], [38., 680., 172.], [114., 1350., 300.], [149., 2520., 360.]]);
    Law::Gear { solid_n_per_m: 2e8, slack_m, draft: gear.clone(), buff: gear }
}

#[test]
fn the_generic_gears_are_those_of_the_sample_file() {
    let file = include_str!("../../trains/gears/aar-friction-pair.csv");
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().ok()).collect::<Option<Vec<f64>>>();
    let rows = file.lines().filter(|line| !line.starts_with('#')).filter_map(numbers);
    let row = |r: Vec<f64>| GearRow { travel_m: r[0] / 1e3, loading_n: r[1] * 1e3, unloading_n: r[2] * 1e3 };
    assert_eq!(rows.map(row).collect::<Vec<_>>(), Curve::generic_friction_gears().rows());
}

/// Gear A reduced from 0.6 MN to 0.3 MN, locked, and to 0.15 MN, on its unloading curve: by arithmetic.
#[test]
fn let_down() {
    let law = gear_a(0.0);
    for (b, q) in [(6e5, 0.036571428571428571429), (3e5, 0.035071428571428571429), (1.5e5, 0.025634615384615384615)] {
        let got = law.elongation_m(&law.rest(&[6e5, b]));
        assert!((got - q).abs() < 1e-16, "{got} {q}");
    }
}

/// The same in buff, and with slack, half of which is added; at no force the gear is at the slack's end.
#[test]
fn mirror_and_slack() {
    let law = gear_a(0.025);
    for b in [6e5, 3e5, 1.5e5, 0.0] {
        let (draft, buff) = (law.rest(&[6e5, b]), law.rest(&[-6e5, -b]));
        assert_eq!((draft.force_n, draft.travel_m), (-buff.force_n, -buff.travel_m));
        assert!((draft.travel_m - 0.0125 - gear_a(0.0).rest(&[6e5, b]).travel_m).abs() < 1e-16);
    }
    assert_eq!(law.rest(&[6e5, 0.0]).travel_m, 0.0125);
    assert_eq!(law.rest(&[0.0]).travel_m, 0.0);
}

/// A preload is overcome at the end of the slack; past the last row the gear stands at its stop.
#[test]
fn preload_and_stop() {
    let gear = curve(&[[0., 60., 20.], [40., 700., 150.]]);
    let law = Law::Gear { solid_n_per_m: 2e8, slack_m: 0.01, draft: gear.clone(), buff: gear };
    assert_eq!(law.rest(&[5e4]).travel_m, 0.005);
    assert_eq!(law.rest(&[9e5]).travel_m, 0.045);
    assert_eq!(law.rest(&[9e5, 2e5]).travel_m, 0.045);
    assert_eq!(law.rest(&[9e5, 1e4]).travel_m, 0.005);
}

#[test]
fn problems() {
    let rows = |rows: &[[f64; 3]]| {
        Curve::new(rows.iter().map(|r| GearRow { travel_m: r[0], loading_n: r[1], unloading_n: r[2] }).collect())
    };
    assert_eq!(rows(&[[0., 0., 0.]]), Err(CurveProblem::TooFewRows(1)));
    assert_eq!(rows(&[[0., 0., 0.], [0., 1., 0.]]), Err(CurveProblem::TravelFalls(2)));
    assert_eq!(rows(&[[0., 3., 0.], [1., 2., 0.]]), Err(CurveProblem::LoadingFalls(2)));
    assert_eq!(rows(&[[0., 3., 1.], [1., 3., 0.]]), Err(CurveProblem::UnloadingFalls(2)));
    let slider = rows(&[[0., 1., -1.], [1., 2., 0.]]).expect("constant friction");
    let law = |slack_m| Law::Gear { solid_n_per_m: 10.0, slack_m, draft: slider.clone(), buff: slider.clone() };
    assert_eq!((law(0.0).check(), law(0.1).check()), (Ok(()), Err(LawProblem::NegativeBesideSlack(-1.0))));
}
