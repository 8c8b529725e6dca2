//! What is done with the steps of a march ([`super::propagator`]): the largest forces, a history, forces at given times.

use std::ops::Range;

use super::between::{Levels, Search, even_derivatives, windows};
use super::foresee;
use super::motion::{BLOCK, Motion, any_positive, excess, norms_around};
use super::propagator::{KICK_TERMS, StepObserver, View, block, error_bound_of_terms, march, terms};
use super::watch::SpringPeaks;
use super::{Wanted, Work};
use crate::chain::Scene;

/// Extremes of every spring's force in a scene, up to the horizon and up to a mark before it; one that is larger than another by less
/// than `min_rise` need not be found.
pub fn peaks(
    scene: &Scene,
    omega: f64,
    min_rise: f64,
    wanted: Wanted,
    mark: Option<f64>,
) -> ([Vec<SpringPeaks>; 2], Work) {
    let from = |expected| peaks_from(scene, [omega, min_rise], wanted, mark, expected);
    // A guess lies `MARGIN` under the peaks: where larger differences are ignored, it excludes few further steps.
    let pays = wanted == Wanted::Worst || min_rise < foresee::MARGIN * scene.force.abs();
    let expected = pays.then(|| foresee::levels(scene, omega, mark.unwrap_or(scene.horizon)));
    expected.and_then(|expected| from(Some(expected))).or_else(|| from(None)).unwrap_or_default()
}

/// The same, given what forces are expected to pass up to the mark and up to the horizon; `None` if some do not.
fn peaks_from(
    scene: &Scene,
    [omega, min_rise]: [f64; 2],
    wanted: Wanted,
    mark: Option<f64>,
    expected: Option<[Levels; 2]>,
) -> Option<([Vec<SpringPeaks>; 2], Work)> {
    let motion = Motion::new(scene);
    let terms = terms(scene, omega, min_rise);
    let mut search = Search::new(scene, &motion, [error_bound_of_terms(scene, omega, terms), min_rise]);
    let later = expected.map(|[first, later]| {
        search.expect(&first, wanted);
        later
    });
    let negligible = search.negligible();
    let mut observer = PeaksObserver { search, wanted, mark, later, to_mark: Some(Vec::new()), work: Work::default() };
    march(scene, &motion, [omega, negligible], terms, &mut observer);
    let PeaksObserver { search, mark, to_mark, mut work, .. } = observer;
    let (peaks, looked) = search.finish();
    work.refinements += looked;
    // The last step may round to end just before a mark.
    let to_mark = if mark.is_some() { peaks.clone() } else { to_mark };
    Some(([peaks?, to_mark?], work))
}

/// Forces of one spring at given times, ascending.
pub fn history(scene: &Scene, omega: f64, spring: usize, times: &[f64]) -> Vec<f64> {
    let motion = Motion::new(scene);
    let search = Search::new(scene, &motion, [0.0; 2]);
    let values = vec![scene.initial[spring]; times.len()];
    let mut record = HistoryObserver { search, spring, times, values, next: 0, horizon: scene.horizon };
    march(scene, &motion, [omega, 0.0], KICK_TERMS, &mut record);
    record.values
}

/// Forces of every spring at given times, ascending: by the cubic through the forces and their second derivatives at both ends
/// of a step. Calls `see(index of the time, spring, force)` for each.
pub fn field(scene: &Scene, omega: f64, times: &[f64], see: &mut dyn FnMut(usize, usize, f64)) {
    let motion = Motion::new(scene);
    march(scene, &motion, [omega, 0.0], KICK_TERMS, &mut FieldObserver { scene, times, next: 0, see });
}

/// Shows the search what may matter.
struct PeaksObserver<'a> {
    search: Search<'a>,
    wanted: Wanted,
    /// The mark, until it is passed.
    mark: Option<f64>,
    /// Extremes up to the mark, empty until it is passed; `None` if forces did not pass what was expected.
    to_mark: Option<Vec<SpringPeaks>>,
    /// What forces are expected to pass up to the horizon; used after the mark.
    later: Option<Levels>,
    work: Work,
}

impl StepObserver for PeaksObserver<'_> {
    #[inline(always)]
    fn see(&mut self, view: &View) {
        self.work.marched += view.range.len() as u64;
        if self.mark.is_some_and(|mark| mark <= view.step.from + view.step.width) {
            self.pass_mark(view);
        }
        view.show(&mut self.search);
    }
}

impl PeaksObserver<'_> {
    /// Extremes up to the mark, which lies within the step: looks into all that is open, and the step up to the mark.
    #[cold]
    fn pass_mark(&mut self, view: &View) {
        let Some(mark) = self.mark.take() else { return };
        self.search.look_into_all();
        let mut search = self.search.until(mark);
        view.show(&mut search);
        let (peaks, looked) = search.finish();
        self.work.refinements += looked - self.search.looked;
        self.to_mark = peaks;
        if let Some(later) = &self.later {
            self.search.expect(later, self.wanted);
        }
    }
}

impl View<'_> {
    /// Shows the search every spring that may matter in the step.
    #[inline(always)]
    fn show(&self, search: &mut Search) {
        let last = search.is_last(&self.step);
        let springs = search.motion.ahead.len();
        let at = |end: usize, s: usize| self.force[end][s + 1];
        let row = |end: usize, some: Range<usize>| &self.force[end][some.start + 1..some.end + 1];
        for block in self.range.start / BLOCK..self.range.end.div_ceil(BLOCK) {
            let Some((open, remainders)) = open_springs(self, [&search.levels, &search.crossings], block, last) else {
                continue;
            };
            for l in (0..BLOCK).filter(|&l| open[l] > 0.0) {
                let spring = block * BLOCK + l;
                let derivatives =
                    |end: usize| even_derivatives(search.motion, &self.step, spring, self.force[end], self.bend[end]);
                let ends = [derivatives(0), derivatives(1)];
                search.consider(&self.step, spring, remainders[l], ends, || windows(springs, spring, row));
            }
        }
        search.note_all_left_rating(&self.step, at);
    }
}

/// By how much the quick bounds of a block's springs over the step pass their levels, and their second remainders;
/// `None` if no bound does. Per sign and spring, G, or -G, must pass `levels`, and `crossings` if it rises through the
/// whole step.
#[inline(always)]
pub(super) fn open_springs(
    view: &View,
    levels: [&[Vec<f64>; 2]; 2],
    number: usize,
    last: bool,
) -> Option<([f64; BLOCK], [f64; BLOCK])> {
    let norms = view.norms.map(|row| row[number]);
    let open = passing(view, levels, number, [norms[0]; BLOCK], last);
    if any_positive(open) { pulp::Arch::new().dispatch(Closer { view, levels, number, norms, last }) } else { None }
}

/// How far the quick bounds of a block's springs pass what matters, given bounds on the norms around them.
#[inline(always)]
fn passing(
    view: &View,
    [levels, crossings]: [&[Vec<f64>; 2]; 2],
    number: usize,
    norms: [f64; BLOCK],
    last: bool,
) -> [f64; BLOCK] {
    let from = number * BLOCK;
    let (f0, f1) = (block(view.force[0], from + 1), block(view.force[1], from + 1));
    let (q0, q1) = (block(view.bend[0], from + 1), block(view.bend[1], from + 1));
    let remainder = block(&view.remainders[0], from);
    let (high, low) = (block(&levels[0], from), block(&levels[1], from));
    let (over, under) = (block(&crossings[0], from), block(&crossings[1], from));
    let mut open = [0.0; BLOCK];
    for l in 0..BLOCK {
        let (level, crossing) = ([high[l], low[l]], [over[l], under[l]]);
        open[l] = excess([f0[l], f1[l]], [q0[l], q1[l]], norms[l] * remainder[l], level, crossing, last);
    }
    open
}

/// The second test of [`open_springs`], with each spring's own norm; few blocks need it, so it is compiled apart from the march.
struct Closer<'a> {
    view: &'a View<'a>,
    levels: [&'a [Vec<f64>; 2]; 2],
    number: usize,
    norms: [f64; 2],
    last: bool,
}

impl pulp::WithSimd for Closer<'_> {
    type Output = Option<([f64; BLOCK], [f64; BLOCK])>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let from = self.number * BLOCK;
        let norms = norms_around(self.view.sizes, from, self.norms);
        let open = passing(self.view, self.levels, self.number, norms, self.last);
        let mut remainders = block(&self.view.remainders[1], from);
        (0..BLOCK).for_each(|l| remainders[l] *= norms[l]);
        any_positive(open).then_some((open, remainders))
    }
}

/// Keeps one spring's force at given times.
struct HistoryObserver<'a> {
    search: Search<'a>,
    spring: usize,
    times: &'a [f64],
    values: Vec<f64>,
    next: usize,
    horizon: f64,
}

impl StepObserver for HistoryObserver<'_> {
    fn see(&mut self, view: &View) {
        let from = self.next;
        let until = view.step.from + view.step.width;
        let last = until + 0.5 * view.step.width > self.horizon;
        self.next += self.times[from..].iter().take_while(|t| last || **t <= until).count();
        if self.next > from && view.range.contains(&self.spring) {
            let at = |end: usize, s: usize| view.force[end][s + 1];
            let values = self.search.values(&view.step, self.spring, &self.times[from..self.next], at);
            self.values[from..self.next].iter_mut().zip(values).for_each(|(f, g)| *f += g);
        }
    }
}

/// Shows every spring at given times.
struct FieldObserver<'a> {
    scene: &'a Scene,
    times: &'a [f64],
    next: usize,
    see: &'a mut dyn FnMut(usize, usize, f64),
}

impl StepObserver for FieldObserver<'_> {
    fn see(&mut self, view: &View) {
        let until = view.step.from + view.step.width;
        let last = until + 0.5 * view.step.width > self.scene.horizon;
        while let Some(t) = self.times.get(self.next).filter(|t| last || **t <= until) {
            let x = ((t - view.step.from) / view.step.width).min(1.0);
            let end = |share: f64, end: usize, s: usize| {
                share * (view.force[end][s + 1] + (1.0 - share * share) / 6.0 * view.bend[end][s + 1])
            };
            for (s, steady) in self.scene.initial.iter().enumerate() {
                let change = if view.range.contains(&s) { end(1.0 - x, 0, s) + end(x, 1, s) } else { 0.0 };
                (self.see)(self.next, s, steady + change);
            }
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::propagator::{error_bound, omega_max};
    use super::*;

    /// An unequal chain with a held head, pulled at its tail, by a step or a pulse.
    fn unequal(duration: f64) -> Scene {
        let mass: Vec<f64> = (0..40).map(|v| 1.0 + 0.6 * f64::from(v * v).sin()).collect();
        let stiffness: Vec<f64> = (0..39).map(|i| 1.0 + 0.4 * f64::from(i * i).cos()).collect();
        let chain = crate::chain::Chain { mass, stiffness, held_head: true, held_tail: false };
        let (initial, rated) = (vec![0.5; 39], vec![1.2; 39]);
        let (rated_draft, rated_buff) = (rated.clone(), rated);
        Scene { chain, source: 39, force: -0.5, duration, initial, rated_draft, rated_buff, horizon: 150.0 }
    }

    /// Foreseen levels are just under the peaks of a search without them, and do not change these; a search that
    /// expects more than the peaks gives `None`.
    #[test]
    fn foreseen_levels_change_nothing() {
        for duration in [f64::INFINITY, 20.0] {
            let scene = unequal(duration);
            let omega = omega_max(&scene);
            let find = |expected| peaks_from(&scene, [omega, 0.0], Wanted::Everything, Some(60.0), expected);
            let levels = foresee::levels(&scene, omega, 60.0);
            let ([plain, to_mark], _) = find(None).expect("nothing was expected");
            for (found, levels) in [(&to_mark, &levels[0]), (&plain, &levels[1])] {
                for (peaks, level) in found.iter().zip(levels) {
                    for negative in [false, true] {
                        let below = peaks.side(negative).best.value - level[usize::from(negative)];
                        assert!((0.0..0.2).contains(&below), "{below}");
                    }
                }
            }
            let ([with, _], _) = find(Some(levels.clone())).expect("no more than there is was expected");
            let bound = error_bound(&scene, omega);
            for (a, b) in with.iter().zip(&plain) {
                assert!((a.draft.best.value - b.draft.best.value).abs() <= bound);
                assert_eq!((a.draft.exceeds(), a.buff.exceeds()), (b.draft.exceeds(), b.buff.exceeds()));
            }
            let mut more = levels;
            more[1][7][0] = plain[7].draft.best.value + 1e-6;
            assert!(find(Some(more)).is_none());
        }
    }
}
