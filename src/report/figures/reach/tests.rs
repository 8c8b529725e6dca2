use super::*;

#[test]
fn a_rating_far_off_is_told_and_presses_nothing_flat() {
    let reach = ForceAxis::new([-1.7e6, 1.9e6].into_iter(), &[1.779e6, 0.97e6], &[3.114e6]);
    assert!(reach.shows(1.779e6) && !reach.shows(-3.114e6));
    assert_eq!((reach.draft, reach.buff), (None, Some((3.114e6, 3.114e6))));
    assert!(3.6e6 > 0.8 * (reach.range.1 - reach.range.0));
}

#[test]
fn a_rating_that_is_nearly_reached_is_shown() {
    let reach = ForceAxis::new([-0.1, 0.5].into_iter(), &[1.0], &[1.0]);
    assert!(reach.shows(1.0) && !reach.shows(-1.0));
    assert!(ForceAxis::new([-1.4, 1.5].into_iter(), &[1.0], &[1.0]).shows(-1.0));
}

#[test]
fn without_forces_there_is_an_axis_too() {
    let reach = ForceAxis::new([0.0].into_iter(), &[1e6], &[2e6]);
    assert!(reach.shows(1e6) && reach.shows(-2e6));
    assert_eq!(ForceAxis::new([0.0].into_iter(), &[f64::INFINITY], &[1.0]).range, (-1.0, 1.0));
}
