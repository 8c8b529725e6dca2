//! Extremes of sums over modes, in continuous time.
//!
//! A grid of cells is laid over time and every force and its slope are found on it by matrix products. On a cell the cubic
//! through them is off by at most `h^4 / 384 sum_j |a_ij| omega_j^4`. Modes too fast for the grid are not summed there: they
//! count with their whole amplitude. Only cells whose bound passes the best value found anywhere, or the rating, are
//! looked at again, with as many modes as the cell's size can resolve. Where faster modes matter, cells are split,
//! the one with the highest bound first: fast modes on slow ones reach their bound near a maximum of the slow ones,
//! which excludes the other cells.

mod interval;

use std::collections::BinaryHeap;

use nalgebra::DMatrix;

use super::Work;
use super::dd::Dd;
use super::local::{Local, hermite_top};
use super::sums::{Coordinates, Field, Modes, RESOLVED, ROUNDOFF, Stretch};
use super::watch::{SpringPeaks, Watch, bound_of_pieces};
use crate::chain::Scene;
use interval::Interval;

/// Columns of a block of the matrix products.
const BLOCK: usize = 128;
/// Cells times springs that are surveyed at once: where peaks recur, most of them are kept until they are looked into.
const MOST_CELLS: f64 = 200_000.0;
/// Looks into cells, times modes, after which differences under a share of the tolerance are ignored.
const MOST_FINE_LOOKS: u64 = 1_000_000;
/// That share.
const COARSE_SHARE: f64 = 0.1;
/// A look at fewer modes counts as one at this many: it takes as long, and its results need memory.
const FEWEST_MODES: usize = 16;
/// Looks into cells, times modes, after which a search gives up: those that are always affordable, and the most.
const LEAST_LOOKS: u64 = 100_000;
const MOST_LOOKS: u64 = 40_000_000;
/// Nanoseconds for one look, per mode.
const LOOK: f64 = 100.0;
/// Nanoseconds for one product in a sum over modes, value and slope together, as matrix products do it.
pub(crate) const MODE_SUM: f64 = 0.12;
/// Nanoseconds to bound a spring's force in a cell, in both senses.
const SURVEY: f64 = 6.0;
/// The longest that a grid which resolves all modes may take.
const MOST_NANOSECONDS: f64 = 60e9;

/// Where a spring's force might be largest, or over its rating: cell number and sign.
struct Candidate {
    cell: usize,
    spring: usize,
    negative: bool,
    bound: f64,
}

/// What a search found.
pub struct Found {
    /// Extremes of every spring's force, up to the horizon and up to a mark before it.
    pub peaks: [Vec<SpringPeaks>; 2],
    /// The work done.
    pub work: Work,
    /// How much further than its bound an extreme can be because of what the search does not examine: an eighth of the bound that
    /// the watch was given, and the difference between that bound and `bound`; a tenth of the tolerance more where the search was
    /// coarsened, and more where it was given up.
    pub missed: f64,
    /// The search for an extreme or for a first exceedance was given up: that time is then an upper limit.
    pub given_up: bool,
}

/// Extremes of every spring's force in a scene, up to the horizon and up to a mark before it, from values that are within `bound` of
/// the truth.
///
/// The watch is given a bound larger by a quarter (`bound_of_pieces`): cells omit modes, or round, by up to the
/// piece tolerance.
///
/// Modes beyond a wide gap are at first computed only in cells that are examined. Where so many cells have to be examined that a
/// grid which resolves all modes would need less work, that grid is used.
pub fn peaks(scene: &Scene, modes: &Modes, [bound, tolerance]: [f64; 2], mark: Option<f64>) -> Found {
    let field = Field::new(scene, modes);
    let (slow, all) = (resolved_modes(&field.omega), field.omega.len());
    let price = survey_price(all, scene.initial.len(), cells(scene.horizon, &field.omega));
    let affordable = ((price / LOOK) as u64).clamp(LEAST_LOOKS, MOST_LOOKS);
    let most_looks = if slow == all { MOST_LOOKS } else { affordable };
    let first = Scan::run(&field, slow, [bound, tolerance], mark, most_looks);
    if slow == all || !first.given_up || price > MOST_NANOSECONDS {
        return first;
    }
    let mut found = Scan::run(&field, all, [bound, tolerance], mark, MOST_LOOKS);
    found.work.mode_sums += first.work.mode_sums;
    found.work.refinements += first.work.refinements;
    found
}

/// Stretches, of which the one that contains the mark is cut there.
fn cut(stretches: Vec<Stretch>, mark: Option<f64>) -> Vec<Stretch> {
    let parts = |s: Stretch| match mark.filter(|m| s.from < *m && *m < s.to) {
        Some(mark) => vec![s.part(s.from, mark), s.part(mark, s.to)],
        None => vec![s],
    };
    stretches.into_iter().flat_map(parts).collect()
}

/// How many cells resolve the last of these modes.
fn cells(span: f64, omega: &[f64]) -> f64 {
    (span * omega.last().unwrap_or(&1.0) / 1.5).ceil().max(1.0)
}

/// Nanoseconds to survey so many cells with so many modes summed on them.
fn survey_price(modes: usize, springs: usize, cells: f64) -> f64 {
    (MODE_SUM * modes as f64 + SURVEY) * springs as f64 * cells
}

/// Nanoseconds of a search in which every mode matters, from the largest frequency on the first grid and of all modes.
pub(crate) fn most_nanoseconds(scene: &Scene, [slow, all]: [f64; 2]) -> f64 {
    let springs = scene.initial.len();
    let [slow, fine] = [slow, all].map(|omega| survey_price(springs, springs, cells(scene.horizon, &[omega])));
    let looks = MOST_LOOKS as f64 * LOOK;
    if fine == slow { slow } else { slow + looks.min(fine) + if fine > MOST_NANOSECONDS { 0.0 } else { fine } }
}

/// A search through time for extremes and first exceedances.
struct Scan<'a> {
    field: &'a Field<'a>,
    /// How many modes are summed on the grid.
    resolved: usize,
    watch: Watch,
    work: Work,
    /// The lowest value seen of each side.
    lowest: Vec<[f64; 2]>,
    /// Looks times modes so far, and how many there may be.
    looks: u64,
    most_looks: u64,
    /// The least rise that counts once the search is coarsened.
    coarse_min_rise: f64,
    /// How far an extreme may lie over what was found, because the search for it was given up.
    missed: f64,
    given_up: bool,
}

impl Scan<'_> {
    fn run(field: &Field, resolved: usize, [bound, tolerance]: [f64; 2], mark: Option<f64>, most_looks: u64) -> Found {
        let watch = Watch::new(field.scene, bound_of_pieces(bound));
        let lowest = watch.peaks.iter().map(|p| [p.draft.best.value, p.buff.best.value]).collect();
        let (work, coarse_min_rise) = (Work::default(), COARSE_SHARE * tolerance);
        let mut scan = Scan {
            field,
            resolved,
            watch,
            work,
            lowest,
            looks: 0,
            most_looks,
            coarse_min_rise,
            missed: 0.0,
            given_up: false,
        };
        let mut to_mark = Vec::new();
        for stretch in cut(field.stretches(), mark) {
            if mark == Some(stretch.from) {
                to_mark = scan.decided().peaks;
            }
            let cells = cells(stretch.to - stretch.from, &field.omega[..resolved]);
            let parts = (cells * field.scene.initial.len() as f64 / MOST_CELLS) as usize + 1;
            let at = |part: usize| stretch.from + (stretch.to - stretch.from) * part as f64 / parts as f64;
            for part in 0..parts {
                let to = if part + 1 == parts { stretch.to } else { at(part + 1) };
                scan.stretch(&stretch.part(at(part), to));
            }
        }
        let missed = scan.watch.bound() - bound + scan.missed.max(scan.watch.min_rise());
        Found { peaks: [scan.decided().peaks, to_mark], work: scan.work, missed, given_up: scan.given_up }
    }

    /// The watch, with sides decided that still stand at their rating.
    fn decided(&self) -> Watch {
        let mut watch = self.watch.clone();
        for (spring, negative) in self.watch.sides() {
            if watch.at_rating(spring, negative) {
                watch.decide_at_rating(spring, negative, self.lowest[spring][usize::from(negative)]);
            }
        }
        watch
    }

    fn stretch(&mut self, stretch: &Stretch) {
        if stretch.to <= stretch.from {
            return;
        }
        for (spring, negative) in self.watch.sides() {
            self.note_left_rating(spring, negative);
        }
        let sides = self.open_sides(stretch);
        if sides.is_empty() {
            return;
        }
        let grid = Grid::new(self.field, self.resolved, stretch);
        let (mut candidates, certain) = self.survey(stretch, &grid, &sides);
        candidates.sort_by_key(|c| (c.cell, c.spring));
        let low_in = |c: &Candidate| certain[c.spring][usize::from(c.negative)].low_in;
        let mut centre = (usize::MAX, Vec::new());
        let mut with_fast_modes: Vec<Candidate> = Vec::new();
        for c in candidates {
            if grid.unresolved[c.spring] > self.watch.piece_tolerance() {
                with_fast_modes.push(c);
                continue;
            }
            let (a, b) = grid.cell(c.cell);
            if low_in(&c) < c.cell {
                self.note_left_rating(c.spring, c.negative);
            }
            if c.bound <= self.watch.level(c.spring, c.negative) {
                continue;
            }
            if centre.0 != c.cell {
                centre = (c.cell, self.field.coordinates(stretch, Dd::from(0.5 * (a + b))));
            }
            let (local, _) = self.look(stretch, c.spring, &centre.1, a, b);
            let exact = |t: Dd| self.field.value(stretch, c.spring, t);
            self.watch.note(c.spring, c.negative, &local, 1.0, exact);
        }
        with_fast_modes.sort_by_key(|c| (c.spring, c.negative, c.cell));
        for side in with_fast_modes.chunk_by(|a, b| (a.spring, a.negative) == (b.spring, b.negative)) {
            // Before a force has left its rating, another level applies.
            let early = side.partition_point(|c| c.cell <= low_in(c));
            for (part, departed) in [(&side[..early], false), (&side[early..], true)] {
                if let Some(c) = part.first() {
                    if departed {
                        self.note_left_rating(c.spring, c.negative);
                    }
                    let cells: Vec<Interval> = part.iter().map(|c| Interval::new(c.bound, grid.cell(c.cell))).collect();
                    self.best_first(stretch, (c.spring, c.negative), cells.clone());
                    self.first_crossing(stretch, (c.spring, c.negative), cells);
                }
            }
        }
    }

    /// Takes note of a side that was seen well under its rating.
    fn note_left_rating(&mut self, spring: usize, negative: bool) {
        self.watch.note_left_rating(spring, negative, self.lowest[spring][usize::from(negative)]);
    }

    /// The sides that may still change the result: where all modes together, whatever their phases, pass what matters.
    fn open_sides(&self, stretch: &Stretch) -> Vec<(usize, bool)> {
        let modes = self.field.omega.len();
        let is_open = |&(spring, negative): &(usize, bool)| {
            let swing: f64 =
                (0..modes).map(|j| (self.field.modes.share[(spring, j)] * stretch.amplitude[j]).abs()).sum();
            let mean = if negative { -stretch.mean[spring] } else { stretch.mean[spring] };
            self.watch.at_rating(spring, negative) || mean + swing > self.watch.level(spring, negative)
        };
        self.watch.sides().filter(is_open).collect()
    }

    /// Forces and slopes of all springs on the grid, block by block; cells of the given sides that might matter, and what is
    /// certain.
    fn survey(
        &mut self,
        stretch: &Stretch,
        grid: &Grid,
        sides: &[(usize, bool)],
    ) -> (Vec<Candidate>, Vec<[Certain; 2]>) {
        let springs = self.watch.peaks.len();
        let share = self.field.modes.share.columns(0, grid.resolved).into_owned();
        let mut certain = vec![[Certain::default(); 2]; springs];
        let mut candidates: Vec<Candidate> = Vec::new();
        let (mut start, mut kept) = (0, 0);
        while start < grid.cells {
            let columns = (grid.cells - start).min(BLOCK) + 1;
            let (q, dq) = grid.coordinates(self.field, stretch, start, columns);
            let (force, slope) = (&share * q, &share * dq);
            self.work.mode_sums += (2 * springs * columns * grid.resolved) as u64;
            for n in 0..columns - 1 {
                for &(spring, negative) in sides {
                    let certain = &mut certain[spring][usize::from(negative)];
                    let end = |n: usize| [force[(spring, n)] + stretch.mean[spring], slope[(spring, n)]];
                    let mut c = Candidate { cell: start + n, spring, negative, bound: 0.0 };
                    c.bound = grid.bound(&self.watch, &c, [end(n), end(n + 1)], certain);
                    if certain.leaves_open(&self.watch, &c) {
                        candidates.push(c);
                    }
                }
            }
            start += columns - 1;
            // Checking all of them at every block would take quadratic time where most stay, as with recurring peaks.
            if start >= grid.cells || candidates.len() > 2 * kept + BLOCK {
                candidates.retain(|c| certain[c.spring][usize::from(c.negative)].leaves_open(&self.watch, c));
                kept = candidates.len();
            }
        }
        for (lowest, certain) in self.lowest.iter_mut().zip(&certain) {
            lowest.iter_mut().zip(certain).for_each(|(l, c)| *l = l.min(c.lowest));
        }
        (candidates, certain)
    }

    /// A side's polynomial on [a, b] from the modes that its width resolves, and how far the others can move it.
    fn look(&mut self, stretch: &Stretch, spring: usize, at: &[Coordinates], a: f64, b: f64) -> (Local, f64) {
        // The centre is rounded: the polynomial reaches to the end that is further away.
        let center = 0.5 * (a + b);
        let radius = (b - center).max(center - a);
        let resolved = self.field.omega.partition_point(|w| w * radius <= RESOLVED);
        self.work.refinements += 1;
        self.looks += self.field.omega.len().max(FEWEST_MODES) as u64;
        if self.looks > MOST_FINE_LOOKS {
            self.watch.coarsen(self.coarse_min_rise);
        }
        self.field.local(stretch, spring, at, resolved, center, radius)
    }

    /// Looks into an interval: splits it in four, each with its bound, or takes note of it when all modes are resolved.
    fn split(&mut self, stretch: &Stretch, (spring, negative): (usize, bool), of: &Interval) -> Vec<Interval> {
        let (a, b) = (of.from, of.to);
        let at = self.field.coordinates(stretch, Dd::from(0.5 * (a + b)));
        let (local, margin) = self.look(stretch, spring, &at, a, b);
        if margin <= self.watch.piece_tolerance() {
            let exact = |t: Dd| self.field.value(stretch, spring, t);
            self.watch.note_peak(spring, negative, &local, 1.0, exact);
            return Vec::new();
        }
        of.quarters(&if negative { local.negated() } else { local }, margin)
    }

    /// The largest value of a side over intervals, the most promising first.
    fn best_first(&mut self, stretch: &Stretch, side: (usize, bool), cells: Vec<Interval>) {
        let mut heap: BinaryHeap<Interval> = cells.into();
        while let Some(interval) = heap.pop() {
            let best = self.watch.peaks[side.0].side(side.1).best.value;
            let over = self.watch.certainly_over(side.0, side.1, best);
            let goal = if over { best + self.watch.min_rise() } else { self.watch.level(side.0, side.1) };
            if interval.upper <= goal {
                return;
            }
            if self.looks > self.most_looks || interval.is_too_small() {
                self.give_up(stretch, side, &interval);
                return;
            }
            heap.extend(self.split(stretch, side, &interval).into_iter().filter(|part| part.upper > goal));
        }
    }

    /// When a side that certainly passes its rating first does so; intervals are in the order of time.
    fn first_crossing(&mut self, stretch: &Stretch, (spring, negative): (usize, bool), cells: Vec<Interval>) {
        let peaks = *self.watch.peaks[spring].side(negative);
        if peaks.first_over.is_some() || !self.watch.certainly_over(spring, negative, peaks.best.value) {
            return;
        }
        let mut open: Vec<Interval> = cells.into_iter().rev().collect();
        while let Some(interval) = open.pop() {
            if interval.upper <= self.watch.rating(spring, negative) || interval.from > peaks.best.at {
                continue;
            }
            if self.looks > self.most_looks || interval.is_too_small() {
                break;
            }
            let (a, b) = (interval.from, interval.to);
            let at = self.field.coordinates(stretch, Dd::from(0.5 * (a + b)));
            let (local, margin) = self.look(stretch, spring, &at, a, b);
            if margin > self.watch.piece_tolerance() {
                let turned = if negative { local.negated() } else { local };
                open.extend(interval.quarters(&turned, margin).into_iter().rev());
            } else if self.watch.note_crossing(spring, negative, &local) {
                return;
            }
        }
        // Given up: the latest that it can be.
        self.given_up = true;
        self.watch.note_value(spring, negative, peaks.best.at, peaks.best.value);
    }

    /// For an interval that is not examined: notes the force at one instant, and how much larger it may be.
    fn give_up(&mut self, stretch: &Stretch, (spring, negative): (usize, bool), interval: &Interval) {
        self.given_up = true;
        let t = 0.5 * (interval.from + interval.to);
        let value = self.field.value(stretch, spring, Dd::from(t));
        self.watch.note_value(spring, negative, t, if negative { -value } else { value });
        self.watch.note_upper_bound(spring, negative, interval.upper);
        let best = self.watch.peaks[spring].side(negative).best.value;
        self.missed = self.missed.max(interval.upper - best);
    }
}

/// What samples on the grid have certainly reached, in one sign of one spring.
#[derive(Clone, Copy)]
struct Certain {
    value: f64,
    /// The cell in which the rating was certainly passed.
    over_in: usize,
    /// The lowest sample, and the first cell that begins with one well under the rating.
    lowest: f64,
    low_in: usize,
}

impl Default for Certain {
    fn default() -> Certain {
        Certain { value: f64::NEG_INFINITY, over_in: usize::MAX, lowest: f64::INFINITY, low_in: usize::MAX }
    }
}

impl Certain {
    /// Whether a cell can still hold the largest force, or the first one over the rating.
    fn leaves_open(&self, watch: &Watch, c: &Candidate) -> bool {
        let best = self.value.max(watch.peaks[c.spring].side(c.negative).best.value);
        let may_cross = c.cell <= self.over_in && c.bound > watch.cautious_rating(c.spring, c.negative);
        c.bound > best || may_cross && watch.peaks[c.spring].side(c.negative).first_over.is_none()
    }
}

/// Cells of equal width over a stretch, and what each spring's force can do within one.
struct Grid {
    from: f64,
    to: f64,
    cells: usize,
    width: f64,
    /// Modes slow enough to be summed on the grid.
    resolved: usize,
    /// Per spring: how far the force can pass the cubic, and how far a grid value can be from the truth.
    margin: Vec<[f64; 2]>,
    /// Per spring: the joint amplitude of the modes that a cell does not resolve.
    unresolved: Vec<f64>,
}

impl Grid {
    fn new(field: &Field, resolved: usize, stretch: &Stretch) -> Grid {
        let springs = field.scene.initial.len();
        let amplitude = |i: usize, j: usize| (field.modes.share[(i, j)] * stretch.amplitude[j]).abs();
        let span = stretch.to - stretch.from;
        let cells = cells(span, &field.omega[..resolved]) as usize;
        let width = span / cells as f64;
        let margin = |i: usize| {
            let cubic: f64 = (0..resolved).map(|j| amplitude(i, j) * (field.omega[j] * width).powi(4)).sum();
            let fast: f64 = (resolved..field.omega.len()).map(|j| amplitude(i, j)).sum();
            let swinging: f64 = (0..resolved).map(|j| amplitude(i, j)).sum();
            let rate: f64 = (0..resolved).map(|j| amplitude(i, j) * field.omega[j]).sum();
            // Rotation loses a few units over a block; and a sample is up to four units of the time's last place from
            // the cell's end: the force changes in between.
            let beside = 4.0 * f64::EPSILON * stretch.to * rate;
            let rounding = 1e-12 * swinging + beside + 8.0 * ROUNDOFF * stretch.mean[i].abs();
            [cubic / 384.0 + fast + rounding, fast + rounding]
        };
        let slow = field.omega.partition_point(|w| 0.5 * w * width <= RESOLVED);
        let unresolved = (0..springs).map(|i| (slow..field.omega.len()).map(|j| amplitude(i, j)).sum()).collect();
        let margin = (0..springs).map(margin).collect();
        Grid { from: stretch.from, to: stretch.to, cells, width, resolved, margin, unresolved }
    }

    fn cell(&self, n: usize) -> (f64, f64) {
        let at = |n: usize| if n == self.cells { self.to } else { self.from + n as f64 * self.width };
        (at(n), at(n + 1))
    }

    /// Coordinates and their rates of the resolved modes at grid points `start..start + columns`, modes x columns.
    ///
    /// The first is exact; the others follow by rotation: they are whole widths from the first, and those are not quite the cells'
    /// ends, which are rounded. [`Grid::bound`] allows for both.
    fn coordinates(
        &self,
        field: &Field,
        stretch: &Stretch,
        start: usize,
        columns: usize,
    ) -> (DMatrix<f64>, DMatrix<f64>) {
        let first = field.coordinates(stretch, Dd::from(self.cell(start).0));
        let (mut q, mut dq) = (DMatrix::zeros(self.resolved, columns), DMatrix::zeros(self.resolved, columns));
        for j in 0..self.resolved {
            let (sin, cos) = (field.omega[j] * self.width).sin_cos();
            let [_, mut c, mut s] = first[j];
            for n in 0..columns {
                q[(j, n)] = c;
                dq[(j, n)] = s * field.omega[j];
                (c, s) = (c * cos + s * sin, s * cos - c * sin);
            }
        }
        (q, dq)
    }

    /// Bound on a force within a cell; raises what is certainly reached.
    #[inline]
    fn bound(&self, watch: &Watch, c: &Candidate, ends: [[f64; 2]; 2], certain: &mut Certain) -> f64 {
        let [over, off] = self.margin[c.spring];
        let sign = if c.negative { -1.0 } else { 1.0 };
        let [left, right] = ends.map(|[f, d]| [sign * f, sign * d]);
        let reached = left[0].max(right[0]);
        certain.value = certain.value.max(reached - off);
        certain.lowest = certain.lowest.min(left[0] + off);
        if certain.low_in == usize::MAX && watch.is_well_below_rating(c.spring, c.negative, left[0] + off) {
            certain.low_in = c.cell;
        }
        if certain.over_in == usize::MAX && watch.certainly_over(c.spring, c.negative, certain.value) {
            certain.over_in = c.cell;
        }
        // The cubic's two slope terms are at most 4/27 of the slopes.
        let quick = reached + self.width * (4.0 / 27.0) * (left[1].max(0.0) + (-right[1]).max(0.0)) + over;
        if quick <= certain.value.min(watch.cautious_rating(c.spring, c.negative)) {
            return quick;
        }
        hermite_top(self.width, left, right).value + over
    }
}

/// How many modes to sum on the grid: all, unless the frequencies have a gap of 4 or more above at least half of them.
///
/// Above such a gap modes are of stiff connections or light vehicles, and carry little force except near the event.
pub(crate) fn resolved_modes(omega: &[f64]) -> usize {
    let half = omega.len().div_ceil(2).max(1);
    let gap = (half..omega.len()).find(|&j| omega[j] > 4.0 * omega[j - 1]);
    gap.unwrap_or(omega.len())
}
