use super::super::rows;
use super::*;

/// Every front lies between its steps at all times.
#[test]
fn fronts_are_between_their_steps() {
    let all = all();
    let times = (1..160).map(|k| 0.3 * k as f64).chain((1..160).map(|k| 18.7 * k as f64));
    for t in times {
        let exact = rows::values_and_slopes(t);
        for distance in 1..1200 {
            let value = exact.get(distance).map_or(0.0, |e| e[0]);
            let (stairs, order) = (&all[place(distance)], 2.0 * distance as f64);
            let root = order.cbrt();
            let step = BEGINS.partition_point(|c| top(order, root) + c * UNIT * root <= t);
            let (low, high) = (stairs.low[step], stairs.high[step]);
            // Rows are right to rounding.
            assert!(low - 1e-13 <= value && value <= high + 1e-13, "t {t} distance {distance}: {value} {low} {high}");
        }
    }
}
