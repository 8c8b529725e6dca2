//! Equal chains as sums of travelling fronts: what an endless chain would feel, and its mirror images at the ends.
//!
//! A unit step of force on a mass of an endless chain puts, m springs away (m = 1 is the next one),
//!
//! ```text
//! E_m(t) = sum_{k >= m} J_2k(2t),    dE_m/dt = J_{2m-1}(2t)        (t in units of sqrt(mass / stiffness))
//! ```
//!
//! in tension behind it and in compression before it: masses move as J_2n(2t) under an impulse (E. Schrödinger, *Ann.
//! Phys.* 44 (1914) 916-934), and the rest follows from 2 J_n' = J_{n-1} - J_{n+1}. A free end mirrors the force, a held one
//! mirrors it and turns its sign; images of images go on for as long as their fronts can arrive. A force on a free end
//! coincides with its image, and the two together are the response to a prescribed end,
//! `E_m + E_{m+1} = J_2m + 2 sum_{k > m} J_2k`.
//!
//! All orders for one t come from one backward recurrence (J. C. P. Miller; F. W. J. Olver, *Math. Comp.* 18 (1964) 65-74),
//! normalised by `J_0 + 2 sum J_2k = 1`. Orders beyond 2t by a few times its cube root are zero to rounding: nothing before
//! the front is touched. The table depends on no train's data; its rows are made for 16 instants at once and used by every
//! spring, and nothing is kept.

use super::between::{PHASE, Search, Step};
use super::closed_form::equal;
use super::motion::{BLOCK, FAR, Motion, any_opens, local_norms, opening};
use super::watch::SpringPeaks;
use super::{Wanted, Work};
use crate::chain::Scene;

/// Instants computed side by side.
const LANES: usize = 16;
/// Instants of a block, and the one before it.
const INSTANTS: usize = LANES + 1;
/// Longest step, in units of sqrt(mass / stiffness), of which the fastest mode's frequency is 2.
const STEP: f64 = 0.5 * PHASE;

/// The scene as images of a unit force, times in units of sqrt(mass / stiffness).
struct Images {
    /// Position in masses from the first one, and sign.
    list: Vec<(i64, f64)>,
    /// A force on a free end and its coinciding image are taken together.
    paired: bool,
}

impl Images {
    /// All images whose fronts arrive within `reach` springs.
    fn new(scene: &Scene, reach: i64) -> Images {
        let n = scene.chain.mass.len() as i64;
        let s = scene.source as i64;
        let (head, tail) = (scene.chain.held_head, scene.chain.held_tail);
        // Mirrors stand at -1/2 or 0 and at n - 1/2 or n - 1: twice their places, and the sign that they give.
        let (first, first_sign) = if head { (0, -1.0) } else { (-1, 1.0) };
        let (last, last_sign) = if tail { (2 * n - 2, -1.0) } else { (2 * n - 1, 1.0) };
        let paired = (!head && s == 0) || (!tail && s == n - 1);
        let period = last - first;
        let rounds = (reach + n) / period + 2;
        let mut list = Vec::new();
        for k in -rounds..=rounds {
            // Two mirrorings make a shift by the period, with both signs.
            let sign = if k % 2 == 0 { 1.0 } else { first_sign * last_sign };
            list.push((s + k * period, sign));
            list.push((first - s + k * period, first_sign * sign));
        }
        if paired {
            // Of each coinciding pair (a, a + 1) the first stands for both.
            list.sort_by_key(|&(a, _)| a);
            list = list.windows(2).filter(|p| p[0].0 + 1 == p[1].0).map(|p| p[0]).collect();
        }
        list.retain(|&(a, _)| a >= -reach - 1 && a <= n + reach);
        Images { list, paired }
    }
}

/// Bound on the error of every force up to the horizon.
///
/// Rounding in the recurrence at order m reaches lower orders through solutions of the same recurrence, whose sums stay
/// near 1 / J's own size: 16 units times sum |J| < sqrt(2 x), x = 2t, for each of the images that overlap in a spring.
pub fn error_bound(scene: &Scene) -> f64 {
    let time = scaled(scene).horizon;
    let roundoff = f64::EPSILON / 2.0;
    let overlapping = 2.0 + 2.0 * time / scene.chain.mass.len() as f64;
    let pulses = if scene.duration < scene.horizon { 2.0 } else { 1.0 };
    let table = 16.0 * (4.0 + (4.0 * time).sqrt()) * overlapping + 2.0 * time;
    let initial = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs())) * 4.0;
    roundoff * (pulses * scene.force.abs() * table + initial) + 4e-14 * pulses * scene.force.abs()
}

/// A scene of an equal chain with unit mass and stiffness; times are scaled, forces are not.
fn scaled(scene: &Scene) -> Scene {
    let (mass, stiffness) = equal(&scene.chain).unwrap_or((1.0, 1.0));
    let unit = (mass / stiffness).sqrt();
    let mut scene = scene.clone();
    scene.chain.mass.fill(1.0);
    scene.chain.stiffness.fill(1.0);
    scene.duration /= unit;
    scene.horizon /= unit;
    scene
}

/// Instants in the horizon: the work is their number times the springs that fronts have reached.
pub fn instants(scene: &Scene) -> f64 {
    let scene = scaled(scene);
    scene.horizon / step_of(&scene)
}

/// Whether the grid can be laid so that a pulse ends on it.
pub fn fits(scene: &Scene) -> bool {
    equal(&scene.chain).is_some() && (scene.duration >= scene.horizon || scaled(scene).duration >= 0.25 * STEP)
}

fn step_of(scene: &Scene) -> f64 {
    let until = scene.duration.min(scene.horizon);
    until / (until / STEP).ceil().max(1.0)
}

/// Extremes of every spring's force in a scene of an equal chain.
pub fn peaks(scene: &Scene, wanted: Wanted) -> (Vec<SpringPeaks>, Work) {
    let unit = equal(&scene.chain).map_or(1.0, |(m, k)| (m / k).sqrt());
    let bound = error_bound(scene);
    let scene = scaled(scene);
    let motion = Motion::new(&scene);
    let mut search = Search::new(&scene, &motion, bound, wanted);
    let mut fronts = Fronts::new(&scene, &motion);
    pulp::Arch::new().dispatch(March { fronts: &mut fronts, search: &mut search });
    let mut work = fronts.work;
    let (watch, looked) = search.finish();
    work.refinements = looked;
    let mut peaks = watch.peaks;
    peaks.iter_mut().for_each(|spring| spring.scale_time(unit));
    (peaks, work)
}

struct March<'s, 'a> {
    fronts: &'s mut Fronts<'a>,
    search: &'s mut Search<'a>,
}

impl pulp::WithSimd for March<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.fronts.march(self.search);
    }
}

struct Fronts<'a> {
    scene: &'a Scene,
    motion: &'a Motion,
    images: Images,
    work: Work,
    width: f64,
    /// Steps until the pulse is over.
    pulse: usize,
    remainders: [Vec<f64>; 2],
    table: Table,
    /// G of each spring at the instant before a block and at the block's.
    force: Vec<[f64; INSTANTS]>,
    /// Per block of springs and step of a block of instants: a bound on the norm of `h^2 G''` around it.
    norms: Vec<[f64; LANES]>,
    /// Whether no step like that follows.
    last: [bool; LANES],
}

impl<'a> Fronts<'a> {
    fn new(scene: &'a Scene, motion: &'a Motion) -> Fronts<'a> {
        let width = step_of(scene);
        let reach = orders(scene.horizon + LANES as f64 * width) as i64;
        let pulse = if scene.duration < scene.horizon { (scene.duration / width).round() as usize } else { usize::MAX };
        Fronts {
            scene,
            motion,
            images: Images::new(scene, reach),
            work: Work::default(),
            width,
            pulse,
            remainders: motion.remainders(width),
            table: Table::default(),
            force: vec![[0.0; INSTANTS]; scene.initial.len()],
            norms: vec![[0.0; LANES]; scene.initial.len().div_ceil(BLOCK)],
            last: [false; LANES],
        }
    }

    #[inline(always)]
    fn march(&mut self, search: &mut Search) {
        let count = (self.scene.horizon / self.width * (1.0 - 4.0 * f64::EPSILON)).ceil().max(1.0) as usize;
        let mut first = 1;
        while first <= count {
            for force in &mut self.force {
                *force = std::array::from_fn(|l| if l == 0 { force[LANES] } else { 0.0 });
            }
            self.add(first, self.scene.force);
            if first + LANES > self.pulse {
                self.add_after_pulse(first);
            }
            self.scan(first, count, search);
            first += LANES;
        }
    }

    /// Adds `factor` times the step response at the block's instants.
    #[inline(always)]
    fn add(&mut self, first: usize, factor: f64) {
        let times = std::array::from_fn(|l| (first + l) as f64 * self.width);
        self.table.fill(&times, self.images.paired);
        self.fold(factor);
    }

    /// Takes away the step response of the pulse's end: the same table, begun `pulse` steps later.
    #[inline(always)]
    fn add_after_pulse(&mut self, first: usize) {
        let times = std::array::from_fn(|l| (first + l).saturating_sub(self.pulse) as f64 * self.width);
        self.table.fill(&times, self.images.paired);
        self.fold(-self.scene.force);
    }

    /// Sums the images of the table's fronts into the springs.
    #[inline(always)]
    fn fold(&mut self, factor: f64) {
        let springs = self.force.len() as i64;
        let orders = self.table.orders as i64;
        for k in 0..self.images.list.len() {
            let (a, sign) = self.images.list[k];
            // A pair (a, a + 1) sits astride a free end: springs see the nearer of the two first.
            let far = a + i64::from(self.images.paired);
            let scale: [f64; LANES] = std::array::from_fn(|l| factor * sign * self.table.scale[l]);
            let behind = a.max(0)..(a + orders).min(springs);
            let behind = if self.images.paired { far.max(0)..(far + orders).min(springs) } else { behind };
            for i in behind {
                let m = if self.images.paired { i - far + 1 } else { i - a + 1 };
                self.deposit(i as usize, m as usize, &scale);
            }
            let minus = scale.map(|s| -s);
            for i in (a - orders).max(0)..a.min(springs) {
                self.deposit(i as usize, (a - i) as usize, &minus);
            }
        }
    }

    #[inline(always)]
    fn deposit(&mut self, spring: usize, m: usize, scale: &[f64; LANES]) {
        // Copies, so that the compiler sees that nothing overlaps.
        let (value, scale, mut force) = (self.table.value[m], *scale, self.force[spring]);
        for l in 0..LANES {
            force[l + 1] += scale[l] * value[l];
        }
        self.force[spring] = force;
    }

    /// The step that ends at instant `n`.
    fn step(&self, n: usize) -> Step {
        let from = (n - 1) as f64 * self.width;
        Step { number: n as u64, from, width: self.width, force: self.outside(n) }
    }

    /// Outside force on the source during the step that ends at instant `n`.
    fn outside(&self, n: usize) -> f64 {
        if n <= self.pulse { self.scene.force } else { 0.0 }
    }

    #[inline(always)]
    fn scan(&mut self, first: usize, count: usize, search: &mut Search) {
        let last_lane = LANES.min(count + 1 - first);
        let source = self.scene.source as f64;
        let latest = (first + LANES) as f64 * self.width;
        self.work.marched += (self.force.len() * last_lane) as u64;
        self.find_norms(first);
        self.last = std::array::from_fn(|l| search.is_last(&self.step(first + l)));
        for spring in 0..self.force.len() {
            let distance = (spring as f64 + 0.5 - source).abs() + 0.5;
            // Before this the front has not come: its Bessel functions are under 1e-16.
            if latest + 8.0 * latest.cbrt() + 8.0 < distance {
                continue;
            }
            let open = self.open(spring, first, search);
            if !any_opens(open) {
                continue;
            }
            for (l, _) in open.iter().enumerate().take(last_lane).filter(|(_, o)| **o > 0.0) {
                let n = first + l;
                let step = self.step(n);
                let at = |end: usize, s: usize| self.force[s][l + end];
                search.departures_of(spring, &self.force[spring][..=l]);
                search.consider(&step, spring, self.remainders[1][spring], self.norms[spring / BLOCK][l], at);
            }
        }
        for l in 0..last_lane {
            search.departures(|s| self.force[s][l + 1]);
        }
        search.keep_up();
    }

    /// `q = -h^2 G''` of a spring at both ends of each of the block's steps.
    #[inline(always)]
    fn bend(&self, spring: usize, first: usize) -> [[f64; LANES]; 2] {
        let square = self.width * self.width;
        let zero = [0.0; INSTANTS];
        let row = |s: Option<usize>| s.and_then(|s| self.force.get(s)).unwrap_or(&zero);
        let (before, here, after) = (row(spring.checked_sub(1)), row(Some(spring)), row(Some(spring + 1)));
        let (ahead, behind) = (square * self.motion.ahead[spring], square * self.motion.behind[spring]);
        let mut ends = [[0.0; LANES]; 2];
        let drive = square * self.motion.drive[spring];
        for l in 0..LANES {
            ends[0][l] = ahead * (here[l] - before[l]) + behind * (here[l] - after[l]);
            ends[1][l] = ahead * (here[l + 1] - before[l + 1]) + behind * (here[l + 1] - after[l + 1]);
        }
        if drive != 0.0 {
            for l in 0..LANES {
                let push = drive * self.outside(first + l);
                ends.iter_mut().for_each(|end| end[l] -= push);
            }
        }
        ends
    }

    #[inline(always)]
    fn find_norms(&mut self, first: usize) {
        let springs = self.force.len();
        let blocks = springs.div_ceil(BLOCK);
        // As many blocks of zeros on either side.
        let mut energy = [vec![[0.0; LANES]; blocks + 2 * FAR], vec![[0.0; LANES]; blocks + 2 * FAR]];
        let mut all = [[0.0; LANES]; 2];
        for spring in 0..springs {
            let bend = self.bend(spring, first);
            for end in 0..2 {
                let (mut sum, mut every) = (energy[end][FAR + spring / BLOCK], all[end]);
                for l in 0..LANES {
                    let square = bend[end][l] * bend[end][l];
                    sum[l] += square;
                    every[l] += square;
                }
                energy[end][FAR + spring / BLOCK] = sum;
                all[end] = every;
            }
        }
        for (number, norms) in self.norms.iter_mut().enumerate() {
            let mut around = [[[0.0; LANES]; 2 * FAR + 1]; 2];
            for (around, row) in around.iter_mut().zip(&energy) {
                around.copy_from_slice(&row[number..=number + 2 * FAR]);
            }
            *norms = local_norms(around, all);
        }
    }

    /// How far the spring's quick bound over each of the block's steps passes the level that matters, in either sign.
    #[inline(always)]
    fn open(&self, spring: usize, first: usize, search: &Search) -> [f64; LANES] {
        let here = &self.force[spring];
        let [q0, q1] = self.bend(spring, first);
        let remainder = self.remainders[0][spring];
        let side = |of: &[Vec<f64>; 2]| [of[0][spring], of[1][spring]];
        let (level, crossing) = (side(&search.levels), side(&search.crossings));
        let norms = &self.norms[spring / BLOCK];
        let mut open = [0.0; LANES];
        for l in 0..LANES {
            let remainder = remainder * norms[l];
            open[l] = opening([here[l], here[l + 1]], [q0[l], q1[l]], remainder, level, crossing, self.last[l]);
        }
        open
    }
}

/// Orders that matter at time t: beyond them E_m(t) is under 1e-17.
fn orders(t: f64) -> usize {
    (t + 6.0 * (2.0 * t).cbrt() + 14.0) as usize
}

/// `E_m` (or `E_m + E_{m+1}`) at 16 instants, up to a factor per instant, for m = 1..=orders.
#[derive(Default)]
struct Table {
    value: Vec<[f64; LANES]>,
    scale: [f64; LANES],
    orders: usize,
}

impl Table {
    #[inline(always)]
    fn fill(&mut self, times: &[f64; LANES], paired: bool) {
        let latest = times.iter().fold(0.0f64, |a, &t| a.max(t));
        self.orders = orders(latest);
        let zero = [0.0; LANES];
        self.value.resize(self.orders + 2, zero);
        if times[0] < 16.0 {
            for (l, &t) in times.iter().enumerate() {
                self.fill_lane(l, t, paired);
            }
        } else {
            self.fill_lanes(times, paired);
        }
    }

    /// The backward recurrence `J_{n-1} = (2n / x) J_n - J_{n+1}`, x = 2t, in all lanes at once.
    #[inline(always)]
    fn fill_lanes(&mut self, times: &[f64; LANES], paired: bool) {
        let inverse = times.map(|t| 1.0 / t);
        let mut above = [0.0; LANES];
        let mut here = [1e-100; LANES];
        let mut sum = [0.0; LANES];
        for m in (1..self.orders + 2).rev() {
            let (even, odd) = ((2 * m) as f64, (2 * m - 1) as f64);
            let value = &mut self.value[m];
            for l in 0..LANES {
                // here = J_2m, above = J_{2m+1}
                let tail = sum[l];
                sum[l] += here[l];
                value[l] = if paired { sum[l] + tail } else { sum[l] };
                let below = (even * inverse[l]).mul_add(here[l], -above[l]);
                let next = (odd * inverse[l]).mul_add(below, -here[l]);
                (above[l], here[l]) = (below, next);
            }
        }
        for l in 0..LANES {
            self.scale[l] = 1.0 / (here[l] + 2.0 * sum[l]);
        }
    }

    /// The same for one early instant, where orders differ so much in size that the recurrence is rescaled as it goes.
    fn fill_lane(&mut self, lane: usize, t: f64, paired: bool) {
        for m in 1..self.orders + 2 {
            self.value[m][lane] = 0.0;
        }
        self.scale[lane] = 1.0;
        if t <= 0.0 {
            return;
        }
        let top = orders(t).min(self.orders + 1);
        let (mut above, mut here, mut sum) = (0.0, 1e-280, 0.0);
        for m in (1..=top).rev() {
            let tail = sum;
            sum += here;
            self.value[m][lane] = if paired { sum + tail } else { sum };
            let below = (2 * m) as f64 / t * here - above;
            (above, here) = (below, (2 * m - 1) as f64 / t * below - here);
            if here.abs() > 1e200 {
                for n in m..=top {
                    self.value[n][lane] *= 1e-200;
                }
                (above, here, sum) = (above * 1e-200, here * 1e-200, sum * 1e-200);
            }
        }
        self.scale[lane] = 1.0 / (here + 2.0 * sum);
    }
}
