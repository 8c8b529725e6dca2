//! Where a sum of cosines can be largest: branch and bound in `f64`, for all springs at once.
//!
//! On a stretch of half width r a mode with `omega r < NEAR` is followed by its Taylor polynomial, and a faster one counts
//! with its whole amplitude. First a parabola with a third-derivative bound is tried; where it leaves a doubt the stretch
//! is halved until all modes that can be seen are slow, and there a polynomial of degree 18 takes over. A stretch is
//! dropped only when its bound is under a value that is certainly reached.

use crate::solve::dd::Dd;

/// Largest phase, omega r, of a mode followed by its polynomial.
const NEAR: f64 = 0.7;
/// Coefficients of the last polynomial: the next term is under 0.7^19 / 19! = 1e-20 of the amplitudes.
const TERMS: usize = 19;
/// Stretches looked at over all springs and signs.
const MOST_LOOKS: usize = 40_000_000;
/// Instants of a first look that gives the search a lower bound.
const FIRST_LOOK: usize = 2000;

/// `f_i(t) = mean_i + sum_j weight_ij cos(omega_j (t - reference))`, or sin.
pub struct Piece {
    pub from: f64,
    pub to: f64,
    pub reference: f64,
    pub sine: bool,
    pub mean: Vec<f64>,
    /// A row per spring.
    pub weight: Vec<Vec<f64>>,
}

/// One sign of one spring.
#[derive(Clone, Copy)]
pub struct Target {
    pub spring: usize,
    pub negative: bool,
}

impl Target {
    pub fn sign(&self) -> f64 {
        if self.negative { -1.0 } else { 1.0 }
    }
}

/// A place where the largest value may be, and its value to within rounding.
#[derive(Clone, Copy)]
pub struct Candidate {
    pub at: f64,
    pub value: f64,
    /// The force is certainly concave there: Newton's method finds the top.
    pub is_concave: bool,
}

/// All places at which the largest value can be.
pub struct Found {
    pub candidates: Vec<Candidate>,
    /// How far an `f64` value can be from the truth.
    pub rounding: f64,
    /// Joint amplitude of the modes that were too fast to follow.
    pub unseen: f64,
    /// A value reached.
    best: f64,
}

/// All candidates of every target, or after how many looks the search gave up. `start` is a value certainly reached.
pub fn find(pieces: &[Piece], omega: &[Dd], targets: &[Target], start: &[f64]) -> Result<Vec<Found>, usize> {
    let found = start.iter().map(|&best| Found { candidates: Vec::new(), rounding: 0.0, unseen: 0.0, best });
    let mut search = Search { omega, speed: omega.iter().map(|w| w.hi).collect(), found: found.collect(), looks: 0 };
    for piece in pieces.iter().filter(|p| p.to > p.from) {
        search.piece(piece, targets)?;
    }
    for found in &mut search.found {
        let floor = found.best - found.rounding;
        found.candidates.retain(|c| c.value >= floor);
    }
    Ok(search.found)
}

struct Search<'a> {
    omega: &'a [Dd],
    speed: Vec<f64>,
    found: Vec<Found>,
    looks: usize,
}

/// What is needed of a spring's weights to bound it.
struct Sizes {
    /// `tail[J]`: sum of |weight| from mode J on.
    tail: Vec<f64>,
    /// `third[J]`: sum of |weight| omega^3 before mode J.
    third: Vec<f64>,
    rounding: f64,
}

impl Sizes {
    fn new(mean: f64, weight: &[f64], speed: &[f64]) -> Sizes {
        let n = weight.len();
        let (mut tail, mut third) = (vec![0.0; n + 1], vec![0.0; n + 1]);
        for j in 0..n {
            tail[n - 1 - j] = tail[n - j] + weight[n - 1 - j].abs();
            third[j + 1] = third[j] + weight[j].abs() * speed[j].powi(3);
        }
        let rounding = f64::EPSILON * ((n + 16) as f64 * tail[0] + 4.0 * mean.abs());
        Sizes { tail, third, rounding }
    }
}

/// Every mode at one instant: its value, and its rate and bend with the frequency's powers in them.
struct Instant {
    value: Vec<f64>,
    /// `q' / omega`
    quarter: Vec<f64>,
    rate: Vec<f64>,
    bend: Vec<f64>,
}

impl Search<'_> {
    fn instant(&self, piece: &Piece, t: f64) -> Instant {
        let tau = Dd::from(t) - Dd::from(piece.reference);
        let (mut value, mut quarter) = (Vec::with_capacity(self.speed.len()), Vec::with_capacity(self.speed.len()));
        for w in self.omega {
            let (sin, cos) = w.phase_of(tau).sin_cos();
            let (v, q) = if piece.sine { (sin, cos) } else { (cos, -sin) };
            value.push(v);
            quarter.push(q);
        }
        let rate = quarter.iter().zip(&self.speed).map(|(q, w)| q * w).collect();
        let bend = value.iter().zip(&self.speed).map(|(v, w)| -v * w * w).collect();
        Instant { value, quarter, rate, bend }
    }

    fn piece(&mut self, piece: &Piece, targets: &[Target]) -> Result<(), usize> {
        let sizes: Vec<Sizes> =
            targets.iter().map(|t| Sizes::new(piece.mean[t.spring], &piece.weight[t.spring], &self.speed)).collect();
        for (found, size) in self.found.iter_mut().zip(&sizes) {
            found.rounding = found.rounding.max(size.rounding);
        }
        self.first_look(piece, targets, &sizes);
        let all: Vec<usize> = (0..targets.len()).collect();
        let mut open = vec![(piece.from, piece.to, all)];
        while let Some((a, b, active)) = open.pop() {
            self.looks += active.len();
            if self.looks > MOST_LOOKS {
                return Err(self.looks);
            }
            let left = self.look(piece, targets, &sizes, [a, b], active);
            if !left.is_empty() {
                let middle = 0.5 * (a + b);
                open.push((middle, b, left.clone()));
                open.push((a, middle, left));
            }
        }
        Ok(())
    }

    fn first_look(&mut self, piece: &Piece, targets: &[Target], sizes: &[Sizes]) {
        let fastest = self.speed.last().copied().unwrap_or(0.0);
        let span = piece.to - piece.from;
        let count = (span * fastest).ceil().clamp(2.0, FIRST_LOOK as f64) as usize;
        for n in 0..=count {
            let now = self.instant(piece, piece.from + span * n as f64 / count as f64);
            for ((target, size), found) in targets.iter().zip(sizes).zip(&mut self.found) {
                let value = piece.mean[target.spring] + dot(&piece.weight[target.spring], &now.value);
                found.best = found.best.max(target.sign() * value - size.rounding);
            }
        }
    }

    /// Looks at a stretch; the targets for which it must be halved.
    fn look(
        &mut self,
        piece: &Piece,
        targets: &[Target],
        sizes: &[Sizes],
        [a, b]: [f64; 2],
        mut active: Vec<usize>,
    ) -> Vec<usize> {
        let (center, r) = (0.5 * (a + b), 0.5 * (b - a));
        let slow = self.speed.partition_point(|w| w * r < NEAR);
        let now = self.instant(piece, center);
        let indivisible = r < 4.0 * f64::EPSILON * center;
        active.retain(|&k| {
            let (target, size) = (targets[k], &sizes[k]);
            let (weight, sign) = (&piece.weight[target.spring], target.sign());
            let seen = piece.mean[target.spring] + dot(&weight[..slow], &now.value);
            let rate = sign * dot(&weight[..slow], &now.rate);
            let bend = sign * dot(&weight[..slow], &now.bend);
            let fast = dot(&weight[slow..], &now.value[slow..]);
            let found = &mut self.found[k];
            found.best = found.best.max(sign * (seen + fast) - size.rounding);
            let top = sign * seen + highest([rate, bend], r).1;
            let bound = top + r.powi(3) / 6.0 * size.third[slow] + size.tail[slow] + size.rounding;
            if bound <= found.best {
                return false;
            }
            if size.tail[slow] > 0.125 * size.rounding && !indivisible {
                return true;
            }
            found.unseen = found.unseen.max(size.tail[slow]);
            let poly = Poly::new(sign, piece.mean[target.spring], &weight[..slow], &now, &self.speed, r);
            // The ends exactly: where a force is largest at one, its slope is not 0.
            let time = |x: f64| {
                if x >= 1.0 {
                    b
                } else if x <= -1.0 {
                    a
                } else {
                    center + r * x
                }
            };
            poly.collect(found, size.rounding + size.tail[slow], time);
            false
        });
        active
    }
}

/// Where `rate x + bend x^2 / 2` is largest over |x| <= r, and how large.
fn highest([rate, bend]: [f64; 2], r: f64) -> (f64, f64) {
    let value = |x: f64| x * (rate + 0.5 * bend * x);
    let end = if rate >= 0.0 { r } else { -r };
    let vertex = -rate / bend;
    if bend < 0.0 && vertex.abs() < r { (vertex, value(vertex)) } else { (end, value(end)) }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b[..a.len()].chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for l in 0..4 {
            sum[l] += x[l] * y[l];
        }
    }
    (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest
}

/// A force over a stretch as a polynomial in x, |x| <= 1.
struct Poly {
    coefficient: [f64; TERMS],
    /// Bound on the third derivative.
    third: f64,
}

impl Poly {
    fn new(sign: f64, mean: f64, weight: &[f64], now: &Instant, speed: &[f64], r: f64) -> Poly {
        let mut coefficient = [0.0; TERMS];
        for (j, w) in weight.iter().enumerate() {
            let x = speed[j] * r;
            let cycle = [now.value[j], now.quarter[j], -now.value[j], -now.quarter[j]];
            let mut power = sign * w;
            for (q, c) in coefficient.iter_mut().enumerate() {
                *c += power * cycle[q % 4];
                power *= x / (q + 1) as f64;
            }
        }
        coefficient[0] += sign * mean;
        let falling = |q: usize| (q * (q - 1) * (q - 2)) as f64;
        let third = (3..TERMS).map(|q| falling(q) * coefficient[q].abs()).sum();
        Poly { coefficient, third }
    }

    /// Value, slope and second derivative.
    fn at(&self, x: f64) -> [f64; 3] {
        self.coefficient.iter().rev().fold([0.0; 3], |[f, d, s], c| [f * x + c, d * x + f, s * x + 2.0 * d])
    }

    /// Adds the places where the polynomial may be largest to the candidates.
    fn collect(&self, found: &mut Found, rounding: f64, time: impl Fn(f64) -> f64) {
        let mut open = vec![(0.0f64, 1.0f64)];
        while let Some((x, h)) = open.pop() {
            let [value, slope, bend] = self.at(x);
            let (step, gain) = highest([slope, bend], h);
            let slack = h.powi(3) / 6.0 * self.third;
            found.best = found.best.max(value - rounding);
            if value + gain + slack + rounding <= found.best {
                continue;
            }
            let concave = bend + h * self.third < 0.0;
            if concave || slack <= 0.25 * rounding || h < 1e-9 {
                let top = if concave { self.newton(x + step, x - h, x + h) } else { x + step };
                let value = self.at(top)[0];
                found.best = found.best.max(value - rounding);
                found.candidates.push(Candidate { at: time(top), value, is_concave: concave });
            } else {
                open.push((x - 0.5 * h, 0.5 * h));
                open.push((x + 0.5 * h, 0.5 * h));
            }
        }
    }

    /// The zero of the slope in [a, b], where the second derivative is negative throughout, or the end next to it.
    fn newton(&self, mut x: f64, a: f64, b: f64) -> f64 {
        for _ in 0..30 {
            let [_, slope, bend] = self.at(x);
            let next = (x - slope / bend).clamp(a, b);
            if (next - x).abs() <= 1e-16 {
                return next;
            }
            x = next;
        }
        x
    }
}
