use super::*;

/// Against the arithmetic library's own sine and cosine. Phases lose their own size: 2^-250 + |x| 2^-254.
#[test]
fn sine_and_cosine_agree_with_the_librarys() {
    let circle = Circle::new(256);
    for x in [0.0, 1e-30, 0.3, -2.0, 3.2, 1e3 + 0.1, 6.02e12] {
        let x = real(x, 256);
        let (sine, versine) = circle.sine_and_versine(&x);
        let (sin, cos) = x.sin_cos();
        let close = 0.5f64.powi(250) + rounded(&x).abs() * 0.5f64.powi(254);
        assert!(rounded(&(sine - sin)).abs() < close);
        assert!(rounded(&(real(1.0, 256) - versine - cos)).abs() < close);
    }
}
