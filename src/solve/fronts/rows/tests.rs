use super::*;

/// A polynomial's value and slope at its ends are those of the rows there, at all distances from an instant of the recurrence, and
/// with lanes that begin at different orders.
#[test]
fn polynomials_agree_with_rows() {
    let times = [0.6, 1.7, 9.3, 15.9, 16.1, 30.2, 31.0, 47.5, 400.9, 401.0, 777.7];
    let waves: Vec<Wave> = [1, 2, 5, 17, 30, 395, 405].map(|distance| Wave { distance, size: 0.7 }).into();
    let tasks: Vec<Task> =
        times.iter().enumerate().map(|(sums, &time)| Task { time, sign: 1.0, sums, waves: [0, waves.len()] }).collect();
    let mut sums = vec![Sums::default(); times.len()];
    collect(&tasks, &waves, &mut sums);
    for (t, sums) in times.iter().zip(&sums) {
        let local = sums.local(*t, 0.3, 0.25);
        for x in [-1.0, 0.0, 1.0] {
            let exact = values_and_slopes(t + 0.3 * x);
            let at =
                |end: usize| waves.iter().map(|w| 0.7 * exact.get(w.distance).map_or(0.0, |e| e[end])).sum::<f64>();
            let (value, slope) = local.value_and_slope(x);
            assert!((value - 0.25 - at(0)).abs() < 1e-14, "t {t} x {x}: {value} {}", at(0));
            assert!((slope - 0.3 * at(1)).abs() < 1e-14, "t {t} x {x}: {slope} {}", at(1));
        }
    }
}
