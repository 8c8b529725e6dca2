use super::first_positive;

#[test]
fn first_of_several() {
    // (s - 0.2)(s - 0.5)(s - 0.9): positive from 0.2 on, and again from 0.9.
    let c = [-0.09, 0.73, -1.6, 1.0];
    assert!((first_positive(&c).expect("a root") - 0.2).abs() < 1e-15);
    assert_eq!(first_positive(&[0.0, 0.0, -1.0, 2.0]).map(|s| (s - 0.5).abs() < 1e-15), Some(true));
    let minus = c.map(|c| -c);
    assert_eq!(first_positive(&minus), Some(0.0));
}

/// Nearly zero over the first half, and falling then.
#[test]
fn flat() {
    let mut c = [0.0; 21];
    (c[0], c[8], c[9]) = (-3e-14, -1e-8, 0.9e-8);
    assert_eq!(first_positive(&c), None);
    c[20] = 2e-9;
    assert!(first_positive(&c).is_some_and(|s| s > 0.9 && s <= 1.0));
}

/// A parabola that stays just under zero, or just passes it.
#[test]
fn grazing() {
    let under = |by: f64| [-0.25 - by, 1.0, -1.0];
    assert_eq!(first_positive(&under(1e-12)), None);
    let at = first_positive(&under(-1e-12)).expect("it passes");
    assert!((at - (0.5 - 1e-6)).abs() < 1e-10);
}
