//! Bessel functions of all orders at one instant, and from them a spring's force as a polynomial in time.
//!
//! One backward recurrence `J_{n-1} = (2 n / x) J_n - J_{n+1}`, x = 2t, from an order at which `J_n` is under 1e-17 (J. C. P.
//! Miller; F. W. J. Olver, *Math. Comp.* 18 (1964) 65-74), normalised by `J_0 + 2 sum J_2k = 1`, gives every front's value
//! `J_2m + 2 sum_{k > m} J_2k` and, as `dJ_n(2t)/dt = J_{n-1} - J_{n+1}`, its derivatives by differences of the orders around.
//! Twelve instants are worked on side by side.

use crate::solve::local::{COEFFICIENTS, Local};

/// Instants side by side: as many as keep their state in the sixteen registers of AVX2.
const LANES: usize = 12;
/// Terms of a polynomial: over half a unit of time each way the rest is under (2 / 2)^20 / 20! = 4e-19 of a front.
const TERMS: usize = 20;
/// Orders on either side of a front's own that its derivatives need.
const SIDE: usize = TERMS - 1;
/// The same in pairs of orders: from `m - BELOW` to `m + ABOVE`.
const BELOW: usize = SIDE / 2;
const ABOVE: usize = SIDE / 2 + 1;
/// Before this time their values differ so much that the recurrence is rescaled as it goes.
const EARLY: f64 = 16.0;

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
    /// Which sums they are to be added to.
    pub sums: usize,
    /// The waves, as a range of a list.
    pub waves: [usize; 2],
}

/// A spring's force at an instant, and the same sums of the Bessel functions around the fronts' orders.
#[derive(Clone, Copy, Debug)]
pub struct Sums {
    value: f64,
    bessel: [f64; 2 * SIDE + 1],
}

impl Default for Sums {
    fn default() -> Sums {
        Sums { value: 0.0, bessel: [0.0; 2 * SIDE + 1] }
    }
}

impl Sums {
    /// The force over `center - radius <= t <= center + radius`, `initial` added.
    pub fn local(&self, center: f64, radius: f64, initial: f64) -> Local {
        let mut coefficient = [0.0; COEFFICIENTS];
        coefficient[0] = initial + self.value;
        let mut row = [0.0; 2 * SIDE - 1];
        for (j, r) in row.iter_mut().enumerate() {
            *r = self.bessel[j] + self.bessel[j + 2];
        }
        let mut factor = 1.0;
        for q in 1..TERMS {
            factor *= radius / q as f64;
            coefficient[q] = factor * row[SIDE - q];
            for j in 0..(2 * (SIDE - q)).saturating_sub(1) {
                row[j] -= row[j + 2];
            }
        }
        Local { coefficient, terms: TERMS, center, radius }
    }

    /// Adds a front: `at(j)` is the Bessel function j orders above its own, `behind` the sum of the even ones above it.
    #[inline(always)]
    fn add(&mut self, size: f64, behind: f64, at: impl Fn(isize) -> f64) {
        for (j, sum) in self.bessel.iter_mut().enumerate() {
            *sum += size * at(j as isize - SIDE as isize);
        }
        self.value += size * (at(0) + 2.0 * behind);
    }
}

/// Orders, in pairs, that matter at time t: beyond them a front's value is under 1e-17.
pub fn pairs(t: f64) -> usize {
    (t + 6.0 * (2.0 * t).cbrt() + 14.0) as usize
}

/// Adds what the tasks ask for to their sums. Fastest in the order of time.
pub fn collect(tasks: &[Task], waves: &[Wave], sums: &mut [Sums]) {
    let mut later = tasks;
    while let Some(task) = later.first().filter(|t| t.time < EARLY) {
        early(task, waves, &mut sums[task.sums]);
        later = &later[1..];
    }
    pulp::Arch::new().dispatch(Later { tasks: later, waves, sums });
}

/// All orders from 0 on at one instant, and the sums of the even ones from each pair on.
fn single(t: f64) -> (Vec<f64>, Vec<f64>) {
    let top = pairs(t);
    let (mut bessel, mut behind) = (vec![0.0; 2 * top + 1], vec![0.0; top + 1]);
    if t <= 0.0 {
        bessel[0] = 1.0;
        return (bessel, behind);
    }
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
    let scale = 1.0 / (here + 2.0 * sum);
    bessel.iter_mut().chain(&mut behind).for_each(|b| *b *= scale);
    (bessel, behind)
}

/// Value and rate of change of the front at every distance, from 0 on.
pub fn values_and_slopes(t: f64) -> Vec<[f64; 2]> {
    let (bessel, behind) = single(t);
    let at = |n: usize| bessel.get(n).copied().unwrap_or(0.0);
    let front = |m: usize| [at(2 * m) + 2.0 * behind[m], at((2 * m).saturating_sub(1)) + at(2 * m + 1)];
    (0..behind.len()).map(front).collect()
}

fn early(task: &Task, waves: &[Wave], sums: &mut Sums) {
    let (bessel, behind) = single(task.time);
    for wave in &waves[task.waves[0]..task.waves[1]] {
        let order = 2 * wave.distance as isize;
        let at = |j: isize| {
            let n = order + j;
            let sign = if n < 0 && n % 2 != 0 { -1.0 } else { 1.0 };
            sign * bessel.get(n.unsigned_abs()).copied().unwrap_or(0.0)
        };
        sums.add(wave.size, behind.get(wave.distance).copied().unwrap_or(0.0), at);
    }
}

struct Later<'a> {
    tasks: &'a [Task],
    waves: &'a [Wave],
    sums: &'a mut [Sums],
}

impl pulp::WithSimd for Later<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let mut rows = Rows::default();
        for tasks in self.tasks.chunks(LANES) {
            rows.plan(tasks, self.waves);
            rows.fill(tasks);
            rows.add_to_sums(tasks, self.waves, self.sums);
        }
    }
}

type Lanes = [f64; LANES];

/// Pairs of orders of which rows are kept: `from..to`, and the place of the first.
#[derive(Clone, Copy)]
struct Kept {
    from: usize,
    to: usize,
    place: usize,
}

/// The recurrence at some instants, with the rows that are asked for.
#[derive(Default)]
struct Rows {
    kept: Vec<Kept>,
    /// `J_2m`, `J_{2m-1}` and the sum of the even orders above 2m, up to the lane's scale.
    rows: Vec<[Lanes; 3]>,
    zeroth: Lanes,
    scale: Lanes,
}

impl Rows {
    /// Which rows are needed.
    #[inline(always)]
    fn plan(&mut self, tasks: &[Task], waves: &[Wave]) {
        let mut centres: Vec<usize> =
            tasks.iter().flat_map(|t| &waves[t.waves[0]..t.waves[1]]).map(|w| w.distance).collect();
        centres.sort_unstable();
        centres.dedup();
        self.kept.clear();
        let mut place = 0;
        for centre in centres {
            let (from, to) = (centre.saturating_sub(BELOW).max(1), centre + ABOVE + 1);
            match self.kept.last_mut() {
                Some(last) if from <= last.to => {
                    place += to - last.to;
                    last.to = to;
                }
                _ => {
                    self.kept.push(Kept { from, to, place });
                    place += to - from;
                }
            }
        }
        if self.rows.len() < place {
            self.rows.resize(place, [[0.0; LANES]; 3]);
        }
    }

    #[inline(always)]
    fn fill(&mut self, tasks: &[Task]) {
        let (mut start, mut inverse) = ([0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            let time = tasks[l.min(tasks.len() - 1)].time;
            (start[l], inverse[l]) = (pairs(time), 1.0 / time);
        }
        let highest = start.iter().fold(0, |a, &s| a.max(s));
        let lowest = start.iter().fold(highest, |a, &s| a.min(s));
        let zero = [0.0; LANES];
        let mut recurrence = Recurrence { inverse, above: zero, here: zero, sum: zero };
        for kept in self.kept.iter().filter(|k| k.to > highest + 1) {
            let first = (highest + 1).max(kept.from) - kept.from + kept.place;
            self.rows[first..kept.place + kept.to - kept.from].fill([zero; 3]);
        }
        let mut kept = self.kept.iter().rev().peekable();
        let mut next = highest;
        while next > 0 {
            // Down to the next range of rows, through it, or one pair at a time while lanes begin.
            while kept.next_if(|k| k.from > next).is_some() {}
            let below = kept.peek().copied();
            let range = below.filter(|k| k.to > next);
            let stop = match range {
                _ if next >= lowest => next,
                Some(k) => k.from,
                None => below.map_or(1, |k| k.to),
            };
            for (here, _) in recurrence.here.iter_mut().zip(start).filter(|(_, s)| *s == next) {
                *here = 1e-100;
            }
            match range {
                Some(k) => {
                    for m in (stop..=next).rev() {
                        recurrence.step(m, Some(&mut self.rows[k.place + m - k.from]));
                    }
                }
                None => (stop..=next).rev().for_each(|m| recurrence.step(m, None)),
            }
            next = stop - 1;
        }
        self.zeroth = recurrence.here;
        for l in 0..LANES {
            self.scale[l] = 1.0 / (recurrence.here[l] + 2.0 * recurrence.sum[l]);
        }
    }

    #[inline(always)]
    fn add_to_sums(&self, tasks: &[Task], waves: &[Wave], sums: &mut [Sums]) {
        for (lane, task) in tasks.iter().enumerate() {
            let sums = &mut sums[task.sums];
            for wave in &waves[task.waves[0]..task.waves[1]] {
                let m = wave.distance;
                let in_range = self.kept.iter().find(|k| k.to > m);
                let Some(kept) = in_range else { continue };
                let rows = &self.rows[kept.place..kept.place + kept.to - kept.from];
                let at = |j: isize| {
                    let n = 2 * m as isize + j;
                    let (size, turned) = (n.unsigned_abs(), n < 0 && n % 2 != 0);
                    if size == 0 {
                        return self.zeroth[lane];
                    }
                    let value = rows[size.div_ceil(2) - kept.from][size % 2][lane];
                    if turned { -value } else { value }
                };
                sums.add(wave.size * self.scale[lane], rows[m - kept.from][2][lane], at);
            }
        }
    }
}

struct Recurrence {
    inverse: Lanes,
    above: Lanes,
    here: Lanes,
    sum: Lanes,
}

impl Recurrence {
    /// From `J_2m` to `J_{2m-2}`.
    #[inline(always)]
    fn step(&mut self, m: usize, row: Option<&mut [Lanes; 3]>) {
        let (even, odd) = ((2 * m) as f64, (2 * m - 1) as f64);
        let (tail, here, above, inverse) = (self.sum, self.here, self.above, self.inverse);
        let (mut below, mut next) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            self.sum[l] = tail[l] + here[l];
            below[l] = (even * inverse[l]).mul_add(here[l], -above[l]);
            next[l] = (odd * inverse[l]).mul_add(below[l], -here[l]);
        }
        if let Some(row) = row {
            *row = [here, below, tail];
        }
        (self.above, self.here) = (below, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial's value and slope at its ends are those of the rows there, before and after [`EARLY`], and
    /// with lanes that begin at different orders.
    #[test]
    fn polynomials_agree_with_rows() {
        let times = [0.6, 1.7, 9.3, 15.9, 16.1, 30.2, 31.0, 47.5, 400.9, 401.0, 777.7];
        let waves: Vec<Wave> = [1, 2, 5, 17, 30, 395, 405].map(|distance| Wave { distance, size: 0.7 }).into();
        let tasks: Vec<Task> =
            times.iter().enumerate().map(|(sums, &time)| Task { time, sums, waves: [0, waves.len()] }).collect();
        let mut sums = vec![Sums::default(); times.len()];
        collect(&tasks, &waves, &mut sums);
        for (t, sums) in times.iter().zip(&sums) {
            let local = sums.local(*t, 0.5, 0.25);
            for x in [-1.0, 0.0, 1.0] {
                let exact = values_and_slopes(t + 0.5 * x);
                let at =
                    |end: usize| waves.iter().map(|w| 0.7 * exact.get(w.distance).map_or(0.0, |e| e[end])).sum::<f64>();
                let (value, slope) = local.value_and_slope(x);
                assert!((value - 0.25 - at(0)).abs() < 1e-14, "t {t} x {x}: {value} {}", at(0));
                assert!((slope - 0.5 * at(1)).abs() < 1e-14, "t {t} x {x}: {slope} {}", at(1));
            }
        }
    }
}
