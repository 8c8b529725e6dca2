use super::*;

fn labels(of: Vec<(f64, String)>) -> Vec<String> {
    of.into_iter().map(|t| t.1).collect()
}

#[test]
fn ticks_are_round_and_share_their_digits() {
    assert_eq!(labels(ticks((-1.7, 2.1), 7, false)), ["−1", "0", "1", "2"]);
    assert_eq!(labels(ticks((-1.0, 1.0), 4, false)), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
    assert_eq!(labels(ticks((0.0, 0.31), 3, false)), ["0", "0.2"]);
    assert_eq!(labels(ticks((0.0, 1e5), 5, false)), ["0", "20000", "40000", "60000", "80000", "100000"]);
    assert_eq!(labels(ticks((0.0, 4e300), 2, false)), ["0", "2e300", "4e300"]);
    assert_eq!(labels(ticks((0.0, 3.1e-9), 3, false)), ["0", "2e−9"]);
}

#[test]
fn counted_things_have_no_ticks_between_them() {
    assert_eq!(labels(ticks((0.5, 3.5), 7, true)), ["1", "2", "3"]);
    assert_eq!(labels(ticks((139.5, 0.5), 5, true)), ["50", "100"]);
}

#[test]
fn ranges_without_width_or_end_have_no_ticks() {
    for range in [(1.0, 1.0), (0.0, f64::INFINITY), (f64::NAN, 1.0), (1e16, 1e16 + 2.0), (0.0, 1e-320)] {
        assert!(ticks(range, 7, false).len() < 30, "{range:?}");
    }
    assert!(ticks((-f64::MAX, f64::MAX), 7, false).len() > 2);
    assert!(log_ticks((0.0, 1.0), 5).is_empty() && log_ticks((1.0, 1.0), 5).is_empty());
}

#[test]
fn logarithmic_axes_have_powers_of_ten() {
    assert_eq!(labels(log_ticks((1e-18, 10.0), 7)), ["10⁻¹⁸", "10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "1"]);
    assert_eq!(labels(log_ticks((0.3, 30.0), 7)), ["0.5", "1", "2", "5", "10", "20"]);
}

#[test]
fn a_scale_runs_either_way_and_ends_somewhere() {
    let scale = Scale::new((0.0, 10.0), (300.0, 100.0), false);
    assert_eq!([scale.at(0.0), scale.at(5.0), scale.at(10.0)], [300.0, 200.0, 100.0]);
    assert_eq!(scale.at(f64::INFINITY), -300.0);
    assert_eq!(Scale::new((1.0, 100.0), (0.0, 50.0), true).at(10.0), 25.0);
    assert_eq!(Scale::new((-f64::MAX, f64::MAX), (0.0, 2.0), false).at(0.0), 1.0);
}
