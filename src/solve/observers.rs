//! What is done with the steps of a march ([`super::propagator`]): the largest forces, a history, forces at given times.

use std::ops::Range;

use pulp::Simd;

use super::between::{Levels, Search};
use super::foresee;
use super::lanes::{Aligned, LANES, Layout, Rows, WithRows, dispatch};
use super::motion::Motion;
use super::pieces::windows;
use super::propagator::{KICK_TERMS, Marched, StepKind, StepObserver, error_bound_of_terms, march};
use super::view::View;
use super::watch::SpringPeaks;
use super::{Wanted, Work};
use crate::chain::{Chain, Scene};

/// Extremes of every spring's force, up to the horizon and up to a mark before it, and the work.
pub type Peaks = ([Vec<SpringPeaks>; 2], Work);

/// What to find along a march through a scene.
#[derive(Clone, Copy, Debug)]
pub struct MarchAsk<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// An upper bound on the largest frequency.
    pub omega: f64,
    /// A peak that is larger than another by less than this need not be found.
    pub min_rise: f64,
    /// Terms of the march's series; the same for all that are marched side by side.
    pub terms: usize,
    /// Which peaks are to be exact.
    pub wanted: Wanted,
    /// An instant before the horizon up to which peaks are wanted as well.
    pub mark: Option<f64>,
}

impl<'a> MarchAsk<'a> {
    /// Every peak, as exact as the march can be.
    pub fn all(scene: &'a Scene, omega: f64) -> MarchAsk<'a> {
        MarchAsk { scene, omega, min_rise: 0.0, terms: KICK_TERMS, wanted: Wanted::Everything, mark: None }
    }
}

/// Extremes along a march through one scene, or through several side by side: at least one, at most 8. Of several none may have a pulse
/// that ends before its horizon, and all have the same `terms`.
pub fn peaks(of: &[MarchAsk]) -> Vec<Peaks> {
    let reached: Vec<Range<usize>> = of.iter().map(|of| reach(of.scene, of.omega)).collect();
    if of.iter().zip(&reached).all(|(of, reached)| *reached == (0..of.scene.initial.len())) {
        return peaks_of_reached(of);
    }
    let scenes: Vec<Scene> = of.iter().zip(&reached).map(|(of, reached)| part(of.scene, reached)).collect();
    let asks: Vec<MarchAsk> = of.iter().zip(&scenes).map(|(of, scene)| MarchAsk { scene, ..*of }).collect();
    let of_reached = peaks_of_reached(&asks).into_iter();
    of_reached.zip(of).zip(reached).map(|((found, of), reached)| of_whole(found, of, reached)).collect()
}

/// Springs that the force moves within the horizon by more than rounding.
///
/// Of the Chebyshev series of `cos(t sqrt A)`, whose terms are Bessel functions `2 J_2k(omega t)`, only those from n on reach across n
/// springs (as in [`super::motion`]); with x = omega t they are under 1e-22 from `2n = x + 15 x^(1/3) + 40` on.
fn reach(scene: &Scene, omega: f64) -> Range<usize> {
    let phase = omega * scene.horizon;
    let springs = (0.5 * (phase + 15.0 * phase.cbrt() + 40.0)).ceil() as usize;
    scene.source.saturating_sub(springs)..(scene.source.saturating_add(springs)).min(scene.initial.len())
}

/// Some springs of a scene and their masses, without the others.
fn part(scene: &Scene, springs: &Range<usize>) -> Scene {
    let Range { start, end } = *springs;
    let chain = Chain {
        mass: scene.chain.mass[start..=end].to_vec(),
        stiffness: scene.chain.stiffness[springs.clone()].to_vec(),
        held_head: scene.chain.held_head && start == 0,
        held_tail: scene.chain.held_tail && end == scene.initial.len(),
    };
    let of = |row: &[f64]| row[springs.clone()].to_vec();
    let (initial, rated_draft, rated_buff) = (of(&scene.initial), of(&scene.rated_draft), of(&scene.rated_buff));
    Scene { chain, source: scene.source - start, initial, rated_draft, rated_buff, ..*scene }
}

/// What was found of a part of a scene, completed by the scene's other springs, which keep their force.
fn of_whole((found, work): Peaks, of: &MarchAsk, part: Range<usize>) -> Peaks {
    let motion = Motion::new(of.scene);
    let bound = error_bound_of_terms(of.scene, of.omega, of.terms);
    let (at_rest, _) = Search::new(of.scene, &motion, [bound, of.min_rise]).finish();
    let whole = found.map(|of_part| {
        let mut all = at_rest.clone().unwrap_or_default();
        if of_part.is_empty() {
            return of_part;
        }
        all.splice(part.clone(), of_part);
        all
    });
    (whole, work)
}

fn peaks_of_reached(of: &[MarchAsk]) -> Vec<Peaks> {
    let motions: Vec<Motion> = of.iter().map(|of| Motion::new(of.scene)).collect();
    let scenes: Vec<Marched> =
        of.iter().zip(&motions).map(|(of, motion)| Marched { scene: of.scene, motion, omega: of.omega }).collect();
    let marks: Vec<f64> = of.iter().map(|of| of.mark.unwrap_or(of.scene.horizon)).collect();
    let expected = foresee::levels(&scenes, &marks).into_iter().map(Some).collect();
    let mut found = peaks_from(of, &scenes, expected);
    // Where forces stay below the guess: once more, without it.
    for n in (0..of.len()).filter(|&n| found[n].is_none()).collect::<Vec<_>>() {
        found[n] = peaks_from(&of[n..=n], &scenes[n..=n], vec![None]).swap_remove(0);
    }
    found.into_iter().map(Option::unwrap_or_default).collect()
}

/// The same, given what forces are expected to pass up to the mark and up to the horizon; `None` for a scene where some do not.
fn peaks_from(of: &[MarchAsk], scenes: &[Marched], expected: Vec<Option<[Levels; 2]>>) -> Vec<Option<Peaks>> {
    let case = |((of, marched), expected)| CaseSearch::new(of, marched, expected);
    let mut cases: Vec<CaseSearch> = of.iter().zip(scenes).zip(expected).map(case).collect();
    let springs: Vec<usize> = of.iter().map(|of| of.scene.initial.len()).collect();
    let mut levels = RowLevels::new(Layout::new(&springs));
    cases.iter_mut().enumerate().for_each(|(chain, case)| levels.update(chain, &mut case.search));
    let mut observer = PeaksObserver { cases, levels };
    march(scenes, StepKind::exact(of[0].terms), &mut observer);
    observer.cases.into_iter().map(CaseSearch::finish).collect()
}

/// Forces of one spring at given times, ascending.
pub fn history(scene: &Scene, omega: f64, spring: usize, times: &[f64]) -> Vec<f64> {
    let motion = Motion::new(scene);
    let search = Search::new(scene, &motion, [0.0; 2]);
    let values = vec![scene.initial[spring]; times.len()];
    let mut record = HistoryObserver { search, spring, times, values, next: 0 };
    march(&[Marched { scene, motion: &motion, omega }], StepKind::exact(KICK_TERMS), &mut record);
    record.values
}

/// Forces of every spring at given times, ascending: by the cubic through the forces and their second derivatives at both ends
/// of a step. Calls `see(index of the time, spring, force)` for each.
pub fn field(scene: &Scene, omega: f64, times: &[f64], see: &mut dyn FnMut(usize, usize, f64)) {
    let motion = Motion::new(scene);
    let mut observer = FieldObserver { scene, times, next: 0, see };
    march(&[Marched { scene, motion: &motion, omega }], StepKind::exact(KICK_TERMS), &mut observer);
}

/// The search along the march through one scene.
struct CaseSearch<'a> {
    search: Search<'a>,
    wanted: Wanted,
    /// The mark, until it is passed.
    mark: Option<f64>,
    /// Extremes up to the mark, empty until it is passed; `None` if forces did not pass what was expected.
    to_mark: Option<Vec<SpringPeaks>>,
    /// What forces are expected to pass up to the horizon; used after the mark.
    later: Option<Levels>,
}

impl<'a> CaseSearch<'a> {
    fn new(of: &MarchAsk<'a>, marched: &Marched<'a>, expected: Option<[Levels; 2]>) -> CaseSearch<'a> {
        let bound = error_bound_of_terms(of.scene, of.omega, of.terms);
        let mut search = Search::new(of.scene, marched.motion, [bound, of.min_rise]);
        let later = expected.map(|[first, later]| {
            search.expect(&first, of.wanted);
            later
        });
        CaseSearch { search, wanted: of.wanted, mark: of.mark, later, to_mark: Some(Vec::new()) }
    }

    /// Extremes up to the mark, which lies within the step: looks into all that is open, and the step up to the mark.
    #[cold]
    fn pass_mark(&mut self, view: &View, chain: usize) {
        let Some(mark) = self.mark.take() else { return };
        self.search.look_into_all();
        let search = self.search.until(mark);
        (self.to_mark, self.search.work) = dispatch(LastStep { view, chain, search }).finish();
        if let Some(later) = &self.later {
            self.search.expect(later, self.wanted);
        }
    }

    /// What was found; `None` if forces did not pass what was expected.
    fn finish(self) -> Option<Peaks> {
        let CaseSearch { search, mark, to_mark, .. } = self;
        let (peaks, work) = search.finish();
        // The last step may round to end just before a mark.
        let to_mark = if mark.is_some() { peaks.clone() } else { to_mark };
        Some(([peaks?, to_mark?], work))
    }
}

/// The last step of a search through one chain of a march.
struct LastStep<'v, 's> {
    view: &'v View<'v>,
    chain: usize,
    search: Search<'s>,
}

impl<'s> WithRows<f64> for LastStep<'_, 's> {
    type Output = Search<'s>;

    #[inline(always)]
    fn run<S: Simd, const H: usize>(self, rows: Rows<S, H>) -> Search<'s> {
        let LastStep { view, chain, mut search } = self;
        search.set_levels();
        let mut levels = RowLevels::new(view.layout);
        levels.update(chain, &mut search);
        let last = [search.is_last(&view.step(chain)); LANES];
        view.show(rows, &mut levels, last, |_, spring, remainder, levels| {
            consider(&mut search, view, chain, spring, remainder);
            levels.update(chain, &mut search);
        });
        search.note_all_left_rating(&view.step(chain), |end, spring| view.force(end, chain, spring));
        search
    }
}

/// Examines a spring of a chain.
fn consider(search: &mut Search, view: &View, chain: usize, spring: usize, remainder: f64) {
    let (ends, springs) = (view.even_derivatives(search.motion, [chain, spring]), search.motion.ahead.len());
    let window = || windows(springs, spring, |end, s| view.force(end, chain, s));
    search.consider(&view.step(chain), spring, remainder, ends, window);
}

/// In rows, per sign and spring: what G, or -G, has to pass to matter, and for a first exceedance.
struct RowLevels {
    layout: Layout,
    levels: [Aligned; 2],
    crossings: [Aligned; 2],
    /// How far springs of each block of rows may pass their levels at the last instant seen, lane by lane ([`View::excess`]).
    excess: Aligned,
}

impl RowLevels {
    /// Nothing matters.
    fn new(layout: Layout) -> RowLevels {
        let none = Aligned::new(layout.len(), f64::INFINITY);
        let excess = Aligned::new(layout.blocks() * LANES, f64::INFINITY);
        RowLevels { layout, levels: [none.clone(), none.clone()], crossings: [none.clone(), none], excess }
    }

    /// Takes over the levels of a chain's springs that have changed.
    #[inline]
    fn update(&mut self, chain: usize, search: &mut Search) {
        for spring in search.changed.drain(..) {
            let place = self.layout.place(chain, spring);
            for sign in 0..2 {
                let level = &mut self.levels[sign][place];
                if search.levels[sign][spring] < *level {
                    let block = self.layout.block_of(place / LANES);
                    self.excess[block * LANES + place % LANES] = f64::INFINITY;
                }
                *level = search.levels[sign][spring];
                self.crossings[sign][place] = search.crossings[sign][spring];
            }
        }
    }
}

/// Passes to each scene's search the springs that may matter in a step.
struct PeaksObserver<'a> {
    cases: Vec<CaseSearch<'a>>,
    levels: RowLevels,
}

impl StepObserver for PeaksObserver<'_> {
    #[inline(always)]
    fn see<S: Simd, const H: usize>(&mut self, rows: Rows<S, H>, view: &View) {
        let PeaksObserver { cases, levels } = self;
        let mut last = [false; LANES];
        for (chain, case) in cases.iter_mut().enumerate().filter(|(chain, _)| !view.is_over(*chain)) {
            let step = view.step(chain);
            if case.mark.is_some_and(|mark| mark <= step.end()) {
                case.pass_mark(view, chain);
                levels.update(chain, &mut case.search);
            }
            last[chain] = case.search.is_last(&step);
        }
        if view.layout.is_cut {
            last = [last[0]; LANES];
        }
        view.show(rows, levels, last, |chain, spring, remainder, levels| {
            let search = &mut cases[chain].search;
            consider(search, view, chain, spring, remainder);
            levels.update(chain, search);
        });
        for (chain, case) in cases.iter_mut().enumerate().filter(|(chain, _)| !view.is_over(*chain)) {
            let springs = case.search.levels[0].len();
            case.search.work.marched += springs as u64;
            case.search.note_all_left_rating(&view.step(chain), |end, spring| view.force(end, chain, spring));
            levels.update(chain, &mut case.search);
            if view.is_last(chain) && !view.layout.is_cut {
                // What follows is behind the chain's horizon.
                let none = || std::iter::repeat_n(f64::INFINITY, springs);
                levels.levels.iter_mut().for_each(|row| view.layout.put(row, chain, none()));
            }
        }
    }
}

impl View<'_> {
    /// Passes every spring that may matter in the step, with its chain and second remainder.
    #[inline(always)]
    fn show<S: Simd, const H: usize>(
        &self,
        rows: Rows<S, H>,
        levels: &mut RowLevels,
        last: [bool; LANES],
        mut see: impl FnMut(usize, usize, f64, &mut RowLevels),
    ) {
        let whole = self.whole_energy();
        let (most_norm, zero) = (rows.of(&self.most_norm(whole))[0], rows.splat(0.0));
        for block in 0..self.layout.blocks() {
            let excess = self.excess(rows, &levels.levels, block);
            let mut before = std::mem::replace(&mut rows.of_mut(&mut levels.excess)[block], excess);
            if self.done == 0 {
                // Steps of a stretch have a width and a force of their own.
                before = rows.splat(f64::INFINITY);
            }
            let remainder = rows.of(self.block_remainder)[block];
            if !rows.any_larger(rows.mul_add(most_norm, remainder, rows.max(before, excess)), zero) {
                continue;
            }
            let bounds = self.norms(block, whole);
            for row in self.open_rows(rows, &levels.levels, block, bounds[0]) {
                let of = [&levels.levels, &levels.crossings];
                let Some((open, remainders)) = self.open_springs(of, row, bounds, last) else { continue };
                for lane in (0..LANES).filter(|&lane| open[lane] > 0.0) {
                    see(self.layout.chain(lane), self.layout.number(row, lane), remainders[lane], levels);
                }
            }
        }
    }
}

/// Keeps one spring's force at given times.
struct HistoryObserver<'a> {
    search: Search<'a>,
    spring: usize,
    times: &'a [f64],
    values: Vec<f64>,
    next: usize,
}

impl StepObserver for HistoryObserver<'_> {
    fn see<S: Simd, const H: usize>(&mut self, _: Rows<S, H>, view: &View) {
        let from = self.next;
        let step = view.step(0);
        let until = step.end();
        let last = view.ends(0);
        self.next += self.times[from..].iter().take_while(|t| last || **t <= until).count();
        if self.next > from {
            let at = |end: usize, s: usize| view.force(end, 0, s);
            let values = self.search.values(&view.step(0), self.spring, &self.times[from..self.next], at);
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
    fn see<S: Simd, const H: usize>(&mut self, _: Rows<S, H>, view: &View) {
        let step = view.step(0);
        let until = step.end();
        let last = view.ends(0);
        while let Some(t) = self.times.get(self.next).filter(|t| last || **t <= until) {
            let x = ((t - step.from) / step.width).min(1.0);
            let end = |share: f64, end: usize, s: usize| {
                let place = view.layout.place(0, s);
                share * (view.force[end][place] + (1.0 - share * share) / 6.0 * view.bend[end][place])
            };
            for (s, steady) in self.scene.initial.iter().enumerate() {
                (self.see)(self.next, s, steady + (end(1.0 - x, 0, s) + end(x, 1, s)));
            }
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests;
