//! The first root of a polynomial over a step, by its Bernstein coefficients (Descartes' rule): as many changes of their sign as
//! roots, or more by an even number; one change is one root, none is none, and an interval with more is halved.

/// The most powers of a polynomial.
const MOST: usize = 32;
/// Halvings before an interval counts as a point.
const HALVINGS: usize = 50;

type Row = [f64; MOST];

/// An interval in 0..=1 with the first root at which the polynomial, lowest power first, turns positive, and with no other; `[0, 0]`
/// where it is positive from the start.
pub fn first_positive(c: &[f64]) -> Option<[f64; 2]> {
    if c[0] > 0.0 {
        return Some([0.0, 0.0]);
    }
    if c[0] + c[1..].iter().map(|c| c.max(0.0)).sum::<f64>() <= 0.0 {
        return None;
    }
    let mut b = bernstein(c);
    isolated(&mut b[..c.len()], [0.0, 1.0], HALVINGS)
}

/// `b_k = sum_j C(k, j) / C(n, j) c_j`.
fn bernstein(c: &[f64]) -> Row {
    let n = c.len() - 1;
    let mut b = [0.0; MOST];
    let mut of_all = 1.0;
    for (j, c) in c.iter().enumerate() {
        let mut of_first = 1.0;
        for (k, b) in b.iter_mut().enumerate().take(n + 1).skip(j) {
            *b += of_first / of_all * c;
            // C(k + 1, j) from C(k, j).
            of_first *= (k + 1) as f64 / (k + 1 - j) as f64;
        }
        of_all *= (n - j) as f64 / (j + 1) as f64;
    }
    b
}

fn isolated(b: &mut [f64], [from, to]: [f64; 2], halvings: usize) -> Option<[f64; 2]> {
    if b[0] > 0.0 {
        return Some([from, from]);
    }
    match changes(b) {
        0 => None,
        many if many == 1 || halvings == 0 => Some([from, to]),
        _ => {
            let (mut left, middle) = (split(b), 0.5 * (from + to));
            let left = isolated(&mut left[..b.len()], [from, middle], halvings - 1);
            left.or_else(|| isolated(b, [middle, to], halvings - 1))
        }
    }
}

/// Every place in 0..=1 at which the polynomial, lowest power first, changes its sign.
pub fn all(c: &[f64]) -> Vec<f64> {
    let mut found = Vec::new();
    collect(&mut bernstein(c)[..c.len()], [0.0, 1.0], HALVINGS, &mut |interval| {
        let sign = if at(c, interval[1]) > 0.0 { 1.0 } else { -1.0 };
        let turned: Vec<f64> = c.iter().map(|c| sign * c).collect();
        found.push(halved(&turned, interval));
    });
    found
}

fn collect(b: &mut [f64], [from, to]: [f64; 2], halvings: usize, take: &mut impl FnMut([f64; 2])) {
    match changes(b) {
        0 => {}
        many if many == 1 || halvings == 0 => take([from, to]),
        _ => {
            let (mut left, middle) = (split(b), 0.5 * (from + to));
            collect(&mut left[..b.len()], [from, middle], halvings - 1, take);
            collect(b, [middle, to], halvings - 1, take);
        }
    }
}

fn changes(b: &[f64]) -> usize {
    b.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count()
}

/// De Casteljau at the middle: gives the left half, and leaves the right one in place.
fn split(b: &mut [f64]) -> Row {
    let n = b.len();
    let mut left = [0.0; MOST];
    for (k, left) in left[..n].iter_mut().enumerate() {
        *left = b[0];
        for i in 0..n - 1 - k {
            b[i] = 0.5 * (b[i] + b[i + 1]);
        }
    }
    left
}

/// Value of a polynomial.
pub fn at(c: &[f64], s: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// The root in an interval, by halving.
pub fn halved(c: &[f64], [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..54 {
        let middle = 0.5 * (low + high);
        if at(c, middle) > 0.0 { high = middle } else { low = middle }
    }
    high
}
