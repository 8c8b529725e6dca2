//! The first root of a polynomial over a step.

/// Value of a polynomial, lowest power first.
pub fn at(c: &[f64], s: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Value and slope.
fn with_slope(c: &[f64], s: f64) -> (f64, f64) {
    c.iter().rev().fold((0.0, 0.0), |(f, d), c| (f * s + c, d * s + f))
}

/// Steps from the left before the interval is halved.
const STEPS: usize = 24;
/// Halvings before the rest counts as one instant, the root.
const HALVINGS: usize = 60;

/// The first s in 0..=1 at which the polynomial, of at most 24 powers, is positive, to the last digits; 0 where it is so from the
/// start.
///
/// From the left: with `M >= max f''` the parabola `f + f' x + M x^2 / 2` lies over f, so that its first root is not beyond that
/// of f; its error is about squared in each step. Where that is slow (f is nearly zero over a stretch), the rest of
/// the interval is halved: this makes the high powers, and so M, much smaller.
pub fn first_positive(c: &[f64]) -> Option<f64> {
    halved(c, HALVINGS)
}

fn halved(c: &[f64], halvings: usize) -> Option<f64> {
    if c[0] > 0.0 {
        return Some(0.0);
    }
    if c.iter().skip(1).map(|c| c.max(0.0)).sum::<f64>() <= -c[0] {
        return None;
    }
    let start = if c[0] == 0.0 { after_root_at_start(c)? } else { 0.0 };
    if c[0] == 0.0 && start == 0.0 {
        return Some(0.0);
    }
    let s = match from_the_left(c, start) {
        Ok(found) => return found,
        Err(s) if halvings == 0 => return Some(s),
        Err(s) => s,
    };
    let middle = 0.5 * (s + 1.0);
    let part = |from: f64, to: f64| {
        let mut part = [0.0; 25];
        part[..c.len()].copy_from_slice(c);
        restrict_to(&mut part[..c.len()], from, to);
        // It was not positive before rounding.
        part[0] = part[0].min(-0.0);
        halved(&part[..c.len()], halvings - 1).map(|x| from + x * (to - from))
    };
    part(s, middle).or_else(|| part(middle, 1.0))
}

/// The root, or `None` if there is none up to 1; after [`STEPS`] steps without a result, `Err(s)`: no root before s.
fn from_the_left(c: &[f64], start: f64) -> Result<Option<f64>, f64> {
    let bend: f64 = c.iter().enumerate().skip(2).map(|(k, c)| (k * (k - 1)) as f64 * c.max(0.0)).sum();
    let mut s = start;
    for _ in 0..STEPS {
        let (f, d) = with_slope(c, s);
        if f > 0.0 {
            return Ok(Some(s));
        }
        // Root of f + d x + bend x^2 / 2 = 0 in the form that loses no digits.
        let root = (d * d - 2.0 * bend * f).max(0.0).sqrt();
        let step = if d > 0.0 {
            -2.0 * f / (d + root)
        } else if bend > 0.0 {
            (root - d) / bend
        } else {
            return Ok(None);
        };
        if s + step > 1.0 {
            return Ok((at(c, 1.0) > 0.0).then_some(1.0));
        }
        if step <= 0.5 * f64::EPSILON * s {
            return Ok(Some(s + step));
        }
        s += step;
    }
    Err(s)
}

/// Rewrites the polynomial over `from..to` as one over 0..1.
pub fn restrict_to(c: &mut [f64], from: f64, to: f64) {
    let n = c.len();
    for j in 0..n {
        for k in (j..n - 1).rev() {
            c[k] += from * c[k + 1];
        }
    }
    let mut power = 1.0;
    for c in c {
        *c *= power;
        power *= to - from;
    }
}

/// For a polynomial with a root at 0: 0 if it rises there, else an s up to which it is negative.
fn after_root_at_start(c: &[f64]) -> Option<f64> {
    let k = c.iter().position(|c| *c != 0.0)?;
    let later: f64 = c[k + 1..].iter().map(|c| c.max(0.0)).sum();
    Some(if c[k] > 0.0 { 0.0 } else { 0.5 * (-c[k] / later).min(1.0) })
}

#[cfg(test)]
mod tests;
