//! Every spring's peaks after a step of force, guessed in single precision: levels from which a search along a march
//! may start.
//!
//! The steps are those of [`super::propagator`], longer, without compensation, and only the largest values at their ends are kept.
//! A guess need not be proven: a search that ends below the expected levels is repeated without them.
//!
//! The chain is cut into `LANES` pieces, one in each lane of a vector: a neighbour is in the row before or after,
//! and for the first and the last row in the next lane.

use std::sync::OnceLock;

use pulp::{Simd, WithSimd};

use super::between::Levels;
use super::propagator::kick_series;
use crate::chain::Scene;

/// Pieces of the chain.
const LANES: usize = 16;
/// Phase of a step, and terms of its series.
const PHASE: f64 = 2.5;
const TERMS: usize = 5;
/// A guess is lower than the largest value by this share of the force, far more than what single precision loses.
pub(super) const MARGIN: f64 = 1e-4;
/// Adding and subtracting this sets to zero what is smaller than about 4e-8 of it, per unit force: denormal numbers are slow.
const TINY: f32 = 1e-20;

type Row = [f32; LANES];

/// What forces are expected to pass up to a mark and up to the horizon; minus infinity if the pulse or the
/// horizon is shorter than half a step.
pub fn levels(scene: &Scene, omega: f64, mark: f64) -> [Levels; 2] {
    let count = |time: f64| (time * omega / PHASE).ceil().max(1.0);
    let pulse = scene.duration < scene.horizon;
    let width = if pulse { scene.duration / count(scene.duration) } else { scene.horizon / count(scene.horizon) };
    let none = vec![[f64::NEG_INFINITY; 2]; scene.initial.len()];
    if width * omega < 0.5 * PHASE {
        return [none.clone(), none];
    }
    let ends = if pulse { (scene.duration / width).round() as u64 } else { u64::MAX };
    let mut guess = Guess::new(scene, width);
    let mut done = 0;
    [mark, scene.horizon].map(|until| {
        let to = (until / width) as u64;
        pulp::Arch::new().dispatch(Steps { guess: &mut guess, steps: done..to, ends });
        done = to;
        guess.levels(scene)
    })
}

/// Steps of a guess, compiled for the widest vector unit at hand.
struct Steps<'a> {
    guess: &'a mut Guess,
    steps: std::ops::Range<u64>,
    ends: u64,
}

impl WithSimd for Steps<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.guess.march(simd, self.steps, self.ends);
    }
}

/// The state for a unit force. Row 0 and the last hold copies of neighbours.
struct Guess {
    /// `h^2 k / m` ahead and behind, `h / m`, `h k`, and where the force acts.
    ahead: Vec<Row>,
    behind: Vec<Row>,
    kick: Vec<Row>,
    drift: Vec<Row>,
    push: Vec<Row>,
    force: Vec<Row>,
    velocity: Vec<Row>,
    bend: Vec<Row>,
    scratch: [Vec<Row>; 2],
    /// The largest and the smallest force so far.
    extremes: [Vec<Row>; 2],
}

impl Guess {
    fn new(scene: &Scene, width: f64) -> Guess {
        let chain = &scene.chain;
        let rows = chain.mass.len().div_ceil(LANES);
        let row = |of: &dyn Fn(usize) -> f64| {
            let mut out = vec![[0.0; LANES]; rows + 2];
            (0..chain.mass.len()).for_each(|s| out[s % rows + 1][s / rows] = of(s) as f32);
            out
        };
        let stiffness = |s: usize| chain.stiffness.get(s).copied().unwrap_or(0.0);
        let inverse = |v: usize| if v < chain.mass.len() && chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let zero = row(&|_| 0.0);
        Guess {
            ahead: row(&|s| width * width * stiffness(s) * inverse(s)),
            behind: row(&|s| width * width * stiffness(s) * inverse(s + 1)),
            kick: row(&|v| width * inverse(v)),
            drift: row(&|s| width * stiffness(s)),
            push: row(&|v| if v == scene.source { 1.0 } else { 0.0 }),
            force: zero.clone(),
            velocity: zero.clone(),
            bend: zero.clone(),
            scratch: [zero.clone(), zero.clone()],
            extremes: [zero.clone(), zero],
        }
    }

    /// What F and -F have passed, less the margin.
    fn levels(&self, scene: &Scene) -> Levels {
        let rows = self.force.len() - 2;
        let level = |s: usize, negative: bool| {
            let extreme = self.extremes[usize::from(negative != (scene.force < 0.0))][s % rows + 1][s / rows];
            let initial = if negative { -scene.initial[s] } else { scene.initial[s] };
            let level = initial + scene.force.abs() * (f64::from(extreme.abs()) - MARGIN);
            if level.is_finite() { level } else { f64::NEG_INFINITY }
        };
        (0..scene.initial.len()).map(|s| [level(s, false), level(s, true)]).collect()
    }

    /// Makes steps. The force acts from step 0 to step `ends`, with half its size in these two.
    #[inline(always)]
    fn march<S: Simd>(&mut self, simd: S, steps: std::ops::Range<u64>, ends: u64) {
        static SERIES: OnceLock<Vec<f64>> = OnceLock::new();
        let series = SERIES.get_or_init(|| kick_series(TERMS, PHASE));
        let rows = self.force.len() - 2;
        for n in steps {
            let acts = if n > ends {
                0.0
            } else if n == 0 || n == ends {
                0.5
            } else {
                1.0
            };
            self.find_bend(simd, acts);
            let [r, spare] = &mut self.scratch;
            let (first, rest) = series.split_last().unwrap_or((&0.0, &[]));
            let first = [*first as f32; LANES];
            r.iter_mut().zip(&self.bend).for_each(|(r, q)| *r = map(*q, first, |q, factor| factor * q));
            for &factor in rest.iter().rev() {
                let factor = factor as f32;
                wrap(simd, r);
                for p in 1..=rows {
                    let to_before = map(self.ahead[p], map(r[p], r[p - 1], |a, b| a - b), |c, r| c * r);
                    let to_after = map(self.behind[p], map(r[p], r[p + 1], |a, b| a - b), |c, r| c * r);
                    let pull = map(to_before, to_after, |a, b| a + b);
                    spare[p] = map(self.bend[p], pull, |q, pull| factor.mul_add(q, pull));
                }
                std::mem::swap(r, spare);
            }
            r.iter_mut().zip(&self.force).for_each(|(r, g)| *r = map(*r, *g, |r, g| r + g));
            wrap(simd, r);
            for p in 1..=rows {
                let pull = map(self.push[p], map(r[p - 1], r[p], |a, b| a - b), |push, pull| acts.mul_add(push, pull));
                let change = map(self.kick[p], pull, |kick, pull| kick * pull);
                self.velocity[p] = map(self.velocity[p], change, |v, change| v + change);
            }
            wrap(simd, &mut self.velocity);
            let [largest, smallest] = &mut self.extremes;
            for p in 1..=rows {
                let apart = map(self.velocity[p], self.velocity[p + 1], |a, b| a - b);
                let change = map(self.drift[p], apart, |drift, apart| drift * apart);
                let g = map(self.force[p], change, |g, change| g + change);
                self.force[p] = g;
                largest[p] = map(largest[p], g, |a, g| if g > a { g } else { a });
                smallest[p] = map(smallest[p], g, |a, g| if g < a { g } else { a });
            }
        }
    }

    /// `q = -h^2 G''`
    #[inline(always)]
    fn find_bend<S: Simd>(&mut self, simd: S, acts: f32) {
        let rows = self.force.len() - 2;
        wrap(simd, &mut self.force);
        let pull = &mut self.scratch[0];
        for (p, out) in pull.iter_mut().enumerate().skip(1).take(rows) {
            let apart = map(self.force[p - 1], self.force[p], |a, b| a - b);
            let of = map(self.push[p], apart, |push, apart| acts.mul_add(push, apart));
            *out = map(self.kick[p], of, |kick, of| kick * of);
        }
        wrap(simd, pull);
        for p in 1..=rows {
            let apart = map(pull[p + 1], pull[p], |a, b| a - b);
            self.bend[p] = map(self.drift[p], apart, |drift, apart| (drift * apart + TINY) - TINY);
        }
    }
}

/// Two rows lane by lane.
#[inline(always)]
fn map(a: Row, b: Row, f: impl Fn(f32, f32) -> f32) -> Row {
    let mut out = [0.0; LANES];
    for l in 0..LANES {
        out[l] = f(a[l], b[l]);
    }
    out
}

/// Before the first row: the last, moved up by one lane. After the last row: the first, moved down by one.
#[inline(always)]
fn wrap<S: Simd>(simd: S, rows: &mut [Row]) {
    const NUMBERS: Row = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
    let numbers = S::as_simd_f32s(&NUMBERS).0[0];
    let end = rows.len() - 1;
    let (last, first) = (rows[end - 1], rows[1]);
    // If a row is several vectors, one number is carried to the next.
    let is_first = simd.less_than_f32s(numbers, simd.splat_f32s(0.5));
    let mut carried = simd.splat_f32s(0.0);
    for (out, x) in S::as_mut_simd_f32s(&mut rows[0]).0.iter_mut().zip(S::as_simd_f32s(&last).0) {
        let turned = simd.rotate_right_f32s(*x, 1);
        *out = simd.select_f32s(is_first, carried, turned);
        carried = turned;
    }
    let is_last = simd.less_than_f32s(simd.splat_f32s(S::F32_LANES as f32 - 1.5), numbers);
    let mut carried = simd.splat_f32s(0.0);
    for (out, x) in S::as_mut_simd_f32s(&mut rows[end]).0.iter_mut().zip(S::as_simd_f32s(&first).0).rev() {
        let turned = simd.rotate_left_f32s(*x, 1);
        *out = simd.select_f32s(is_last, carried, turned);
        carried = turned;
    }
}
