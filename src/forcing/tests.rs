use super::*;

/// The values and measures of a trapezoid are those of its graph.
#[test]
fn measures_of_a_trapezoid() {
    let drive = Drive::Lines(vec![[1.0, 0.0], [2.0, 3.0], [4.0, 3.0], [4.0, 1.0], [5.0, 0.0]]);
    assert_eq!([0.5, 1.5, 3.0, 4.0, 4.5, 6.0].map(|t| drive.value(t)), [0.0, 1.5, 3.0, 1.0, 0.5, 0.0]);
    assert_eq!(drive.measures(), [3.0, 6.0]);
    assert_eq!(Drive::HalfSine { peak: -2.0, duration: 3.0 }.value(0.5), -2.0 * (std::f64::consts::PI / 6.0).sin());
    let change = |tail: &[[f64; 2]]| Drive::Lines([&[[0.0, 0.0], [1.0, 3.0]], tail].concat()).last_change();
    assert_eq!([change(&[]), change(&[[2.0, 0.0], [9.0, 0.0]]), change(&[[2.0, 3.0]])], [1.0, 2.0, 2.0]);
    assert_eq!(Drive::none().last_change(), 0.0);
    assert_eq!([drive.begins_at(), drive.peaks_at(), drive.last_force()], [1.0, 2.0, 0.0]);
    assert_eq!(Drive::none().begins_at(), f64::INFINITY);
}
