//! The first root of a polynomial over a step.

/// Value of a polynomial, lowest power first.
pub fn at(c: &[f64], s: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Value and slope.
fn with_slope(c: &[f64], s: f64) -> (f64, f64) {
    c.iter().rev().fold((0.0, 0.0), |(f, d), c| (f * s + c, d * s + f))
}

/// The first s in 0..=1 at which the polynomial is positive, to the last digits; 0 where it is so from the start.
///
/// From the left: with `M >= max f''` the parabola `f + f' x + M x^2 / 2` lies over f, so that its first root is not beyond that
/// of f; the distance to the root is squared from one to the next.
pub fn first_positive(c: &[f64]) -> Option<f64> {
    if c[0] > 0.0 {
        return Some(0.0);
    }
    let bend: f64 = c.iter().enumerate().skip(2).map(|(k, c)| (k * (k - 1)) as f64 * c.max(0.0)).sum();
    let rise = c.get(1).map_or(0.0, |c| c.max(0.0));
    if c[0] + rise + 0.5 * bend <= 0.0 {
        return None;
    }
    let mut s = if c[0] == 0.0 { leave(c)? } else { 0.0 };
    if s == 0.0 && c[0] == 0.0 {
        return Some(0.0);
    }
    for _ in 0..400 {
        let (f, d) = with_slope(c, s);
        if f > 0.0 {
            return Some(s);
        }
        // Root of f + d x + bend x^2 / 2 = 0 in the form that loses no digits.
        let root = (d * d - 2.0 * bend * f).max(0.0).sqrt();
        let step = if d > 0.0 {
            -2.0 * f / (d + root)
        } else if bend > 0.0 {
            (root - d) / bend
        } else {
            return None;
        };
        let next = s + step.max(f64::EPSILON * 0.5 * s);
        if next > 1.0 {
            return (at(c, 1.0) > 0.0).then_some(1.0);
        }
        if next == s || step <= f64::EPSILON * 0.25 * s {
            return Some(next);
        }
        s = next;
    }
    Some(s)
}

/// For a polynomial that begins with a root: 0 if it rises from it, or an s up to which it is negative.
fn leave(c: &[f64]) -> Option<f64> {
    let k = c.iter().position(|c| *c != 0.0)?;
    let later: f64 = c[k + 1..].iter().map(|c| c.max(0.0)).sum();
    Some(if c[k] > 0.0 { 0.0 } else { 0.5 * (-c[k] / later).min(1.0) })
}

#[cfg(test)]
mod tests {
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

    /// A parabola that stays under zero by little, touches, or passes it by little.
    #[test]
    fn grazing() {
        let under = |by: f64| [-0.25 - by, 1.0, -1.0];
        assert_eq!(first_positive(&under(1e-12)), None);
        let at = first_positive(&under(-1e-12)).expect("it passes");
        assert!((at - (0.5 - 1e-6)).abs() < 1e-10);
    }
}
