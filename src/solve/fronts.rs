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
//! `E_m + E_{m+1} = J_2m + 2 sum_{k > m} J_2k`: such scenes are what this method is for.
//!
//! The work grows with the springs, not with springs times instants:
//!
//! 1. Every front lies between two step functions (`stairs`); their sums say in which few windows a spring's force can
//!    be largest or pass its rating first.
//! 2. There the fronts are sampled by forms that are right to a few digits (`forms`), at eight instants of a spring at once; cubics
//!    between samples, with a bound on their fourth derivative, leave one or two cells a side.
//! 3. In those the force is a polynomial made of Bessel functions of all orders (`rows`), whose recurrence at one instant serves all
//!    cells of all springs within four units of time. Every value and time that is reported comes from there, within [`error_bound`].
//!
//! What steps 1 and 2 exclude relies on numbers that are measured with a margin, not proved: the error of the forms (twice the
//! largest found or more), the bound on fourth derivatives (5 % over the largest found), what a front can be far ahead of its top
//! (`PRECURSOR` in `stairs`), and how far the flanks of fronts that share steps can lie beyond those of the nearest and the
//! furthest of them (`BETWEEN` there). The bounds behind the top are proved. Where the forms cannot tell which extreme of a side
//! is the largest, all of them are looked into.

mod forms;
mod rows;
mod stairs;
mod windows;

use super::Work;
use super::closed_form::equal;
use super::watch::{SpringPeaks, Watch};
use crate::chain::Scene;
use rows::{Sums, Task, Wave};
use windows::Windows;

/// The shortest pulse, in units of sqrt(mass / stiffness): the forms cannot tell the fronts of a shorter one apart.
const SHORTEST_PULSE: f64 = 0.1875;

/// The fronts of a scene: images of a unit force on a free end, times in units of sqrt(mass / stiffness).
struct Images {
    /// Of each pair of images that coincide, at a and a + 1 across a free end: a, and their sign.
    list: Vec<(i64, f64)>,
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
        let period = last - first;
        let rounds = (reach + n) / period + 2;
        let mut list = Vec::new();
        for k in -rounds..=rounds {
            // Two mirrorings make a shift by the period, with both signs.
            let sign = if k % 2 == 0 { 1.0 } else { first_sign * last_sign };
            list.push((s + k * period, sign));
            list.push((first - s + k * period, first_sign * sign));
        }
        // Of each coinciding pair (a, a + 1) the first stands for both.
        list.sort_by_key(|&(a, _)| a);
        list = list.windows(2).filter(|p| p[0].0 + 1 == p[1].0).map(|p| p[0]).collect();
        list.retain(|&(a, _)| a >= -reach - 1 && a <= n + reach);
        Images { list }
    }

    /// Adds the fronts that a spring feels to the end of `out`, the nearest first. `force` is that of the step.
    fn waves(&self, spring: usize, force: f64, out: &mut Vec<Wave>) {
        let first = out.len();
        // In tension behind the image, in compression before it.
        let wave = |&(a, sign): &(i64, f64)| match spring as i64 - a {
            m if m > 0 => Wave { distance: m as usize, size: force * sign },
            m => Wave { distance: m.unsigned_abs() as usize, size: -force * sign },
        };
        out.extend(self.list.iter().map(wave).filter(|w| w.distance > 0));
        out[first..].sort_unstable_by_key(|w| w.distance);
    }
}

/// Bound on the error of every force up to the horizon.
///
/// In units of roundoff (2^-53) of the force. The factor 16 is an estimate with a margin, not proved.
///
/// - The recurrence: a rounding at order m reaches lower orders through solutions of the same recurrence, whose sums stay near
///   1 / J's own size. 16 units times `sum |J_n| < 1.03 sqrt(x / 2)` over n > 0, x = 2 (t + 4) at most, are counted for each of the
///   images that overlap in a spring. A shift in time carries such solutions along. A polynomial's q-th derivative is off by at
///   most `2^q` times a single value, which over 0.3 units of time each way makes this `e^0.6` times larger: under 15 S units, with
///   S = 4 + sqrt(4 t).
/// - The shift: each sum s combines up to 67 orders, and its partial sums are at most `sum |J_k(8)| < 4.3` times the largest s. A
///   front is made of two of them: 670 units with the factor of derivatives, once for all images. 33 S units for each image and the 1e-13
///   below are more.
/// - The sums over orders, of about t terms each. Images share these roundings, and the signs of the nearest images up to any
///   distance add up to 2 at most, so that the number of images does not count: 2 t units.
///
/// 1e-13 of the force is added for orders, terms and fronts that are left out and for the shift at early times, and 4 units of the
/// largest initial force for adding it.
pub fn error_bound(scene: &Scene) -> f64 {
    let time = scaled(scene).horizon;
    let roundoff = f64::EPSILON / 2.0;
    let overlapping = 2.0 + 2.0 * time / scene.chain.mass.len() as f64;
    let pulses = if scene.duration < scene.horizon { 2.0 } else { 1.0 };
    let table = 48.0 * (4.0 + (4.0 * time).sqrt()) * overlapping + 2.0 * time;
    let initial = scene.initial.iter().fold(0.0f64, |a, f| a.max(f.abs())) * 4.0;
    roundoff * (pulses * scene.force.abs() * table + initial) + 1e-13 * pulses * scene.force.abs()
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

/// Fronts that pass a spring within the horizon, on average.
pub fn passing(scene: &Scene) -> f64 {
    1.0 + scaled(scene).horizon / scene.initial.len() as f64
}

/// Whether the method is for this scene: an equal chain with the force on a free end, for long enough.
pub fn fits(scene: &Scene) -> bool {
    let long = || scene.duration >= scene.horizon || scaled(scene).duration >= SHORTEST_PULSE;
    equal(&scene.chain).is_some() && at_free_end(scene) && long()
}

/// Whether the force acts on a free end.
pub(crate) fn at_free_end(scene: &Scene) -> bool {
    let chain = &scene.chain;
    let last = chain.mass.len() - 1;
    scene.source == 0 && !chain.held_head || scene.source == last && !chain.held_tail
}

/// Extremes of every spring's force in a scene that [`fits`].
pub fn peaks(scene: &Scene) -> (Vec<SpringPeaks>, Work) {
    let unit = equal(&scene.chain).map_or(1.0, |(m, k)| (m / k).sqrt());
    let bound = error_bound(scene);
    let scene = scaled(scene);
    let springs = scene.initial.len();
    let mut watch = Watch::new(&scene, bound);
    let reach = rows::pairs(scene.horizon);
    let images = Images::new(&scene, reach as i64);
    let roots: Vec<f64> = (0..=reach + springs + 2).map(|m| (2.0 * m as f64).cbrt()).collect();
    let steps = [[0.0, 1.0], [scene.duration, -1.0]];
    let steps = &steps[..if scene.duration < scene.horizon { 2 } else { 1 }];
    let mut windows = Windows::new(&scene, &images, steps, &roots);
    windows.find(&watch);
    let work = Work { marched: windows.samples, refinements: windows.looks.len() as u64, ..Work::default() };
    look(&scene, &mut watch, windows);
    let mut peaks = watch.peaks;
    peaks.iter_mut().for_each(|spring| spring.scale_time(unit));
    (peaks, work)
}

/// Looks into the cells in the order of time: makes each one's polynomial and passes it to the watch.
fn look(scene: &Scene, watch: &mut Watch, windows: Windows) {
    let Windows { mut looks, left, reached, waves, firsts, steps, roots, .. } = windows;
    looks.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut tasks = Vec::with_capacity(looks.len() * steps.len());
    for (sums, look) in looks.iter().enumerate() {
        let centre = 0.5 * (look.from + look.to);
        for &[delay, sign] in steps.iter().filter(|[delay, _]| *delay < centre) {
            let (time, first) = (centre - delay, firsts[look.spring]);
            let most = (time + 6.0 * roots[time.ceil() as usize] + 14.0) as usize;
            let count = waves[first..firsts[look.spring + 1]].iter().take_while(|w| w.distance <= most).count();
            tasks.push(Task { time, sign, sums, waves: [first, first + count] });
        }
    }
    tasks.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut sums = vec![Sums::default(); looks.len()];
    rows::collect(&tasks, &waves, &mut sums);
    let mut lowest: Vec<[f64; 2]> = scene.initial.iter().map(|f| [*f, -f]).collect();
    for (look, sums) in looks.iter().zip(&sums) {
        let (centre, radius) = (0.5 * (look.from + look.to), 0.5 * (look.to - look.from));
        let local = sums.local(centre, radius, scene.initial[look.spring]);
        let end = ((scene.horizon - centre) / radius).min(1.0);
        for negative in [false, true] {
            let side = usize::from(negative);
            if look.from >= left[look.spring][side] {
                leave(watch, look.spring, negative);
            }
            if watch.at_rating(look.spring, negative) {
                let value = local.value_and_slope(end).0 * if negative { -1.0 } else { 1.0 };
                lowest[look.spring][side] = lowest[look.spring][side].min(value);
            } else if end == 1.0
                && look.upper[side] <= reached[look.spring][side]
                && watch.peaks[look.spring].side(negative).first_over.is_none()
                && watch.note_crossing(look.spring, negative, &local)
            {
                // Only a first exceedance was to be found here.
                continue;
            }
            if look.upper[side] > watch.level(look.spring, negative) {
                watch.note(look.spring, negative, &local, end, |t| local.value_at(t));
            }
        }
    }
    for (spring, negative) in watch.sides() {
        if left[spring][usize::from(negative)] <= scene.horizon {
            leave(watch, spring, negative);
        }
        if watch.at_rating(spring, negative) {
            watch.decide_at_rating(spring, negative, lowest[spring][usize::from(negative)]);
        }
    }
}

/// Takes note that a side that stood at its rating has certainly left it.
fn leave(watch: &mut Watch, spring: usize, negative: bool) {
    let low = f64::NEG_INFINITY;
    watch.note_left_rating(spring, negative, low);
}
