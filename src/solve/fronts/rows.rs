//! Bessel functions of all orders at some instants, and from them a spring's force near any instant as a polynomial in time.
//!
//! One backward recurrence `J_{n-1} = (2 n / x) J_n - J_{n+1}`, x = 2t, from an order at which `J_n` is under 1e-17 (J. C. P.
//! Miller; F. W. J. Olver, *Math. Comp.* 18 (1964) 65-74), normalised by `J_0 + 2 sum J_2k = 1`, gives at one instant
//!
//! ```text
//! s_n = sum_{k >= 0} J_{n+2k},    P_n = s_n + s_{n+2},    dP_n/dt = P_{n-1} - P_{n+1}
//! ```
//!
//! for all orders n; `P_2m` is the front at distance m. By the addition theorem (G. N. Watson, *Theory of Bessel Functions*, 2.4)
//!
//! ```text
//! s_n(x + d) = sum_k J_k(d) s_{n-k}(x)
//! ```
//!
//! they are known at all instants within half a [`SPACING`], the time between two instants of the recurrence. Twelve instants are
//! worked on side by side.

use crate::solve::local::{COEFFICIENTS, Local};

/// Instants side by side: as many as keep their state in the sixteen registers of AVX2.
const LANES: usize = 12;
/// Time between instants of the recurrence.
const SPACING: f64 = 8.0;
/// The longest stretch of time of a polynomial, twice its radius, and its terms: the rest is under 0.6^16 / 16! = 1.4e-17 of a front.
pub const LOOK: f64 = 0.6;
const TERMS: usize = 16;
/// Orders on either side of a front's own that its derivatives need.
const SIDE: usize = TERMS - 1;
/// Sums s kept of a front: those of the orders from `-SIDE` to `SIDE + 2` around its own, and one more to make their number even.
const BAND: usize = 2 * SIDE + 4;
/// Orders on either side over which a shift of half a [`SPACING`] reaches: `J_34(8)` is 1e-18.
const REACH: usize = 33;
/// Orders at an instant of the recurrence from which a front's band is made.
const WIDTH: usize = BAND + 2 * REACH;
/// Orders in a block, which is kept whole or not at all; and how many negative orders there are.
const BLOCK: usize = 32;
const BEFORE: usize = 2 * BLOCK;

/// A front that a spring feels: its distance m, and its size.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    /// Springs from the source, 1 for the one beside it.
    pub distance: usize,
    /// Force of the step that sent it, with the sign of its images.
    pub size: f64,
}

/// An instant at which the forces of some waves are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// Time since the waves set out.
    pub time: f64,
    /// How many times they count.
    pub sign: f64,
    /// Which sums they are to be added to.
    pub sums: usize,
    /// The waves, as a range of a list.
    pub waves: [usize; 2],
}

/// Sums over a spring's fronts, at an instant, of the s around each front's order.
#[derive(Clone, Copy, Debug)]
pub struct Sums([f64; BAND]);

impl Default for Sums {
    fn default() -> Sums {
        Sums([0.0; BAND])
    }
}

impl Sums {
    /// The force over `center - radius <= t <= center + radius`, `initial` added; `radius` is at most half a [`LOOK`].
    pub fn local(&self, center: f64, radius: f64, initial: f64) -> Local {
        // The rest is under 1e-16 of a front.
        let mut rest = 1.0;
        let terms = (1..TERMS).find(|&q| {
            rest *= 2.0 * radius / q as f64;
            rest < 1e-16
        });
        let terms = terms.unwrap_or(TERMS);
        let mut row = [0.0; 2 * SIDE + 1];
        let row = &mut row[..2 * terms - 1];
        let first = SIDE + 1 - terms;
        for (j, r) in row.iter_mut().enumerate() {
            *r = self.0[first + j] + self.0[first + j + 2];
        }
        let mut coefficient = [0.0; COEFFICIENTS];
        coefficient[0] = initial + row[terms - 1];
        let mut factor = 1.0;
        for q in 1..terms {
            for j in 0..row.len() - 2 * q {
                row[j] -= row[j + 2];
            }
            factor *= radius / q as f64;
            coefficient[q] = factor * row[terms - 1 - q];
        }
        Local { coefficient, terms, center, radius }
    }
}

/// Orders, in pairs, that matter at time t: beyond them a front's value is under 1e-17.
pub fn pairs(t: f64) -> usize {
    (t + 6.0 * (2.0 * t).cbrt() + 14.0) as usize
}

/// Adds what the tasks, which are in the order of time, ask for to their sums.
pub fn collect(tasks: &[Task], waves: &[Wave], sums: &mut [Sums]) {
    crate::solve::vectors::widest().dispatch(Collection { tasks, waves, sums });
}

/// Value and rate of change of the front at every distance, from 0 on, by the recurrence at one instant.
pub fn values_and_slopes(t: f64) -> Vec<[f64; 2]> {
    let top = pairs(t);
    if t <= 0.0 {
        return vec![[0.0; 2]; top + 1];
    }
    let (mut bessel, mut behind) = (vec![0.0; 2 * top + 2], vec![0.0; top + 1]);
    let (mut above, mut here, mut sum) = (0.0, 1e-280, 0.0);
    for n in (1..=2 * top).rev() {
        bessel[n] = here;
        if n % 2 == 0 {
            behind[n / 2] = sum;
            sum += here;
        }
        (above, here) = (here, n as f64 / t * here - above);
        if here.abs() > 1e200 {
            bessel[n..].iter_mut().for_each(|b| *b *= 1e-200);
            behind[n.div_ceil(2)..].iter_mut().for_each(|b| *b *= 1e-200);
            (above, here, sum) = (above * 1e-200, here * 1e-200, sum * 1e-200);
        }
    }
    bessel[0] = here;
    behind[0] = sum;
    let scale = 1.0 / (here + 2.0 * sum);
    let front = |m: usize| {
        let slope = bessel[(2 * m).saturating_sub(1)] + bessel[2 * m + 1];
        [scale * (bessel[2 * m] + 2.0 * behind[m]), scale * slope]
    };
    (0..=top).map(front).collect()
}

struct Collection<'a> {
    tasks: &'a [Task],
    waves: &'a [Wave],
    sums: &'a mut [Sums],
}

impl pulp::WithSimd for Collection<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let mut rows = Rows::default();
        let mut rest = self.tasks;
        while !rest.is_empty() {
            let (mut instants, mut count, mut asked) = ([0; LANES], 0, 0);
            for task in rest {
                let instant = (task.time / SPACING) as usize;
                if count == 0 || instants[count - 1] != instant {
                    if count == LANES {
                        break;
                    }
                    instants[count] = instant;
                    count += 1;
                }
                asked += 1;
            }
            let (tasks, later) = rest.split_at(asked);
            let last = instants[count - 1];
            instants[count..].fill(last);
            rows.fill(instants.map(|k| (k as f64 + 0.5) * SPACING), tasks, self.waves);
            rows.add_to_sums(instants, tasks, self.waves, self.sums);
            rest = later;
        }
    }
}

type Lanes = [f64; LANES];

/// The recurrence at some instants, with the sums s of the orders that are asked for.
#[derive(Default)]
struct Rows {
    /// Of each block of orders its place among the kept ones, from 1; 0 if it is not kept.
    places: Vec<usize>,
    /// Of each lane its kept blocks, one after the other, in the order of orders.
    columns: Vec<f64>,
    /// How many numbers a column has.
    stride: usize,
    scale: Lanes,
}

impl Rows {
    /// Finds which blocks of orders are kept; there are blocks up to `most` at least.
    #[inline(always)]
    fn plan(&mut self, most: usize, tasks: &[Task], waves: &[Wave]) {
        let distances = || tasks.iter().flat_map(|t| &waves[t.waves[0]..t.waves[1]]).map(|w| w.distance);
        let blocks = distances().fold(most, |a, m| a.max((first_of(m) + WIDTH - 1) / BLOCK));
        self.places.clear();
        self.places.resize(blocks + 1, 0);
        for m in distances() {
            let (from, to) = (first_of(m) / BLOCK, (first_of(m) + WIDTH - 1) / BLOCK);
            self.places[from..=to].fill(1);
        }
        if self.places[..2].contains(&1) {
            // Negative orders are made of those up to BEFORE + 2.
            self.places[..=2 * BEFORE / BLOCK].fill(1);
        }
        let mut place = 0;
        for p in self.places.iter_mut().filter(|p| **p > 0) {
            place += 1;
            *p = place;
        }
        self.stride = place * BLOCK;
        if self.columns.len() < LANES * self.stride {
            self.columns.resize(LANES * self.stride, 0.0);
        }
    }

    #[inline(always)]
    fn fill(&mut self, times: Lanes, tasks: &[Task], waves: &[Wave]) {
        let start = times.map(|t| (2 * pairs(t) + BEFORE) / BLOCK);
        let most = start.iter().fold(2 * BEFORE / BLOCK, |a, &s| a.max(s));
        self.plan(most, tasks, waves);
        let zero = [0.0; LANES];
        let mut recurrence = Recurrence { inverse: times.map(|t| 1.0 / t), above: zero, here: zero, sums: [zero; 2] };
        let mut rows = [zero; BLOCK];
        for block in (BEFORE / BLOCK..self.places.len()).rev() {
            for (here, _) in recurrence.here.iter_mut().zip(start).filter(|(_, s)| *s == block) {
                *here = 1e-200;
            }
            recurrence.step(block * BLOCK - BEFORE, &mut rows);
            if let Some(place) = self.places[block].checked_sub(1) {
                for (lane, column) in self.columns.chunks_exact_mut(self.stride).take(LANES).enumerate() {
                    let kept = &mut column[place * BLOCK..][..BLOCK];
                    for (kept, row) in kept.iter_mut().zip(&rows) {
                        *kept = row[lane];
                    }
                }
            }
        }
        for (lane, scale) in self.scale.iter_mut().enumerate() {
            let total = rows[0][lane] + rows[2][lane];
            *scale = 1.0 / total;
            if self.places[0] > 0 {
                let column = &mut self.columns[lane * self.stride..][..2 * BEFORE + BLOCK];
                for n in 1..=BEFORE {
                    let mirrored = column[BEFORE + n + 2];
                    column[BEFORE - n] = if n % 2 == 0 { total - mirrored } else { mirrored };
                }
            }
        }
    }

    #[inline(always)]
    fn add_to_sums(&self, instants: [usize; LANES], tasks: &[Task], waves: &[Wave], sums: &mut [Sums]) {
        let mut lane = 0;
        for task in tasks {
            let instant = (task.time / SPACING) as usize;
            while instants[lane] != instant {
                lane += 1;
            }
            let column = &self.columns[lane * self.stride..][..self.stride];
            let mut around = [0.0; WIDTH];
            for wave in &waves[task.waves[0]..task.waves[1]] {
                let first = first_of(wave.distance);
                let place = (self.places[first / BLOCK] - 1) * BLOCK + first % BLOCK;
                let size = task.sign * wave.size * self.scale[lane];
                for (sum, s) in around.iter_mut().zip(&column[place..place + WIDTH]) {
                    *sum = s.mul_add(size, *sum);
                }
            }
            let (reach, weights) = shift(2.0 * (task.time - (instant as f64 + 0.5) * SPACING));
            let mut band = sums[task.sums].0;
            for k in REACH - reach..=REACH + reach {
                let part: &[f64; BAND] = around[k..k + BAND].try_into().unwrap_or(&[0.0; BAND]);
                for l in 0..BAND {
                    band[l] = part[l].mul_add(weights[k], band[l]);
                }
            }
            sums[task.sums].0 = band;
        }
    }
}

/// Place of the first order of a front's band, counted from `-BEFORE`.
#[inline(always)]
fn first_of(distance: usize) -> usize {
    BEFORE + 2 * distance - SIDE - REACH
}

/// The weights of a shift by d in x: how many orders each way matter, and `J_{REACH-k}(d)` at place k; zero at the others.
#[inline(always)]
fn shift(d: f64) -> (usize, [f64; 2 * REACH + 1]) {
    let mut weights = [0.0; 2 * REACH + 1];
    if d.abs() < 1e-6 {
        let [first, second] = [0.5 * d, 0.125 * d * d];
        weights[REACH - 2..=REACH + 2].copy_from_slice(&[second, first, 1.0 - 2.0 * second, -first, second]);
        return (2, weights);
    }
    // `J_{reach+1}(d)` is under 2.6e-17, and all that is left out under 6e-17.
    let reach = REACH.min(14 + (2.5 * d.abs()) as usize);
    let inverse = 2.0 / d;
    let (mut above, mut here, mut even) = (0.0, 1e-280, 0.0);
    for k in (0..=reach).rev() {
        weights[REACH - k] = here;
        even += if k % 2 == 0 { here } else { 0.0 };
        (above, here) = (here, (k as f64 * inverse).mul_add(here, -above));
    }
    let scale = 1.0 / (2.0 * even - weights[REACH]);
    for k in 0..=reach {
        weights[REACH - k] *= scale;
        weights[REACH + k] = if k % 2 == 0 { weights[REACH - k] } else { -weights[REACH - k] };
    }
    (reach, weights)
}

struct Recurrence {
    inverse: Lanes,
    above: Lanes,
    here: Lanes,
    /// The last two sums s: of the odd and of the even orders, from the lowest one reached.
    sums: [Lanes; 2],
}

impl Recurrence {
    /// Down through the orders from `first + BLOCK - 1` to `first`; `rows[k]` becomes the s of order `first + k`.
    #[inline(always)]
    fn step(&mut self, first: usize, rows: &mut [Lanes; BLOCK]) {
        let inverse = self.inverse;
        let (mut above, mut here, [mut odd, mut even]) = (self.above, self.here, self.sums);
        for k in (0..BLOCK / 2).rev() {
            let order = (first + 2 * k) as f64;
            let [row, row_above] = &mut rows[2 * k..2 * k + 2] else { continue };
            for l in 0..LANES {
                odd[l] += here[l];
                above[l] = ((order + 1.0) * inverse[l]).mul_add(here[l], -above[l]);
                even[l] += above[l];
                here[l] = (order * inverse[l]).mul_add(above[l], -here[l]);
            }
            (*row, *row_above) = (even, odd);
        }
        (self.above, self.here, self.sums) = (above, here, [odd, even]);
    }
}

#[cfg(test)]
mod tests;
