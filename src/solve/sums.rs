//! Spring forces as sums over modes, and their extremes in continuous time.
//!
//! ```text
//! step, t < D         F_i(t) = F0_i + P [ s_i - sum_j a_ij cos(omega_j t) ]
//! pulse over, t >= D  F_i(t) = F0_i + P sum_j a_ij 2 sin(omega_j D / 2) sin(omega_j (t - D / 2))
//! ```
//!
//! [P] eqs (19) and (29), with a_ij the static share of mode j and s_i their sum. The second line is (29)'s difference of
//! cosines as a product: a pulse far shorter than a period loses no digits.
//!
//! A grid of cells is laid over time and every force and its slope are found on it by matrix products. On a cell the cubic
//! through them is off by at most `h^4 / 384 sum_j |a_ij| omega_j^4`. Modes too fast for the grid are not summed there: they
//! count with their whole amplitude. Only cells whose bound passes the best value found anywhere, or the rating, are
//! looked at again, with as many modes as the cell's size can resolve, and split while unresolved modes matter.

use nalgebra::DMatrix;

use super::Work;
use super::dd::Dd;
use super::local::{COEFFICIENTS, Local, hermite_top};
use super::statics;
use super::watch::{SpringPeaks, Watch};
use crate::chain::Scene;

/// Unit roundoff of `f64`.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// A mode is resolved by a Taylor polynomial over a half width r while omega r is under this.
const RESOLVED: f64 = 2.0;
/// Columns of a block of the matrix products.
const BLOCK: usize = 128;
/// Looks into cells, times modes, after which a search gives up and widens its bound instead.
const MOST_LOOKS: u64 = 40_000_000;

/// Frequencies, ascending, and how each mode shares a unit force among the springs.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Frequencies, > 0.
    pub omega: Vec<Dd>,
    /// `a_ij`: springs x modes.
    pub share: DMatrix<f64>,
    /// Bound on each spring's force error, per unit force, from what the modes leave of the equations of motion, at time t:
    /// `defect[i] * t`.
    pub defect: Vec<f64>,
}

/// A stretch of time under constant force: amplitudes of cosine and sine in `tau = t - reference`.
struct Stretch {
    from: f64,
    to: f64,
    reference: f64,
    sine: bool,
    /// Amplitude of each mode.
    amplitude: Vec<f64>,
    /// Force about which each spring swings.
    mean: Vec<f64>,
}

/// A mode at an instant: what it has added to the forces since the event, and q and q' / omega of its swing.
type Coordinates = [f64; 3];

/// Where a spring's force might be largest, or over its rating: cell number and sign.
struct Candidate {
    cell: usize,
    spring: usize,
    negative: bool,
    bound: f64,
}

/// Takes out the modes that together cannot move any force by more than `share`; by how much they can.
pub fn leave_out(scene: &Scene, modes: &mut Modes, share: f64) -> f64 {
    let size = |j: usize| swing(scene, modes.omega[j]) * modes.share.column(j).amax();
    let mut by_size: Vec<(f64, usize)> = (0..modes.omega.len()).map(|j| (size(j), j)).collect();
    by_size.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut joint = 0.0;
    let within = |(size, _): &&(f64, usize)| {
        joint += size;
        joint <= share
    };
    let mut out: Vec<usize> = by_size.iter().take_while(within).map(|m| m.1).collect();
    out.sort_unstable();
    modes.share = std::mem::replace(&mut modes.share, DMatrix::zeros(0, 0)).remove_columns_at(&out);
    let mut j = 0;
    modes.omega.retain(|_| {
        j += 1;
        out.binary_search(&(j - 1)).is_err()
    });
    by_size[..out.len()].iter().map(|m| m.0).sum()
}

/// How far a mode of unit share can move a force: `|P| (1 - cos)` during the force and `2 |P| sin(omega D / 2)` after it.
fn swing(scene: &Scene, omega: Dd) -> f64 {
    scene.force.abs() * (omega.hi * scene.duration).min(2.0)
}

/// Extremes of every spring's force in a scene from values that are within `bound` of the truth, the work done, and how
/// much further than `bound` an extreme can be because the search for it was given up.
pub fn peaks(scene: &Scene, modes: &Modes, bound: f64) -> (Vec<SpringPeaks>, Work, f64) {
    let watch = Watch::new(scene, bound);
    let lowest = watch.peaks.iter().map(|p| [p.draft.best.value, p.buff.best.value]).collect();
    let mut scan =
        Scan { field: Field::new(scene, modes), watch, work: Work::default(), lowest, looks: 0, missed: 0.0 };
    for stretch in scan.field.stretches() {
        scan.stretch(&stretch);
    }
    for (spring, lowest) in scan.lowest.iter().enumerate() {
        for (negative, &lowest) in [false, true].into_iter().zip(lowest) {
            if scan.watch.at_rating(spring, negative) {
                scan.watch.settle(spring, negative, lowest);
            }
        }
    }
    (scan.watch.peaks, scan.work, scan.missed)
}

/// Bound on |F_i| over all time.
pub fn all_time_bounds(scene: &Scene, modes: &Modes) -> Vec<f64> {
    let mean = statics::unit_force(&scene.chain, scene.source);
    let bound = |i: usize| {
        let added = |j: usize| modes.share[(i, j)].abs() * swing(scene, modes.omega[j]);
        let pulse = scene.initial[i].abs() + (0..modes.omega.len()).map(added).sum::<f64>();
        let step = (scene.initial[i] + scene.force * mean[i]).abs()
            + scene.force.abs() * modes.share.row(i).iter().map(|a| a.abs()).sum::<f64>();
        if scene.duration.is_finite() { pulse } else { step.max(scene.initial[i].abs()) }
    };
    (0..scene.initial.len()).map(bound).collect()
}

/// Forces of one spring at given times (>= 0).
pub fn history(scene: &Scene, modes: &Modes, spring: usize, times: &[f64]) -> Vec<f64> {
    let field = Field::new(scene, modes);
    let stretches = field.stretches();
    let at = |&t: &f64| {
        let stretch = stretches.iter().rev().find(|s| t >= s.from).unwrap_or(&stretches[0]);
        field.value(stretch, spring, t)
    };
    times.iter().map(at).collect()
}

/// Bound on the error of every force that [`peaks`] reports, up to the scene's horizon.
pub fn error_bound(scene: &Scene, modes: &Modes) -> f64 {
    let m = modes.omega.len() as f64;
    let fastest = modes.omega.last().map_or(0.0, |&w| swing(scene, w));
    let acting = scene.force.abs() * scene.duration.min(scene.horizon);
    let spring = |i: usize| {
        let size: f64 =
            modes.omega.iter().zip(modes.share.row(i).iter()).map(|(&w, a)| a.abs() * swing(scene, w)).sum();
        // Rounding of a_ij (1), the amplitude (2), the reduced phase (2), its cosine (1), the product (1), and the sum.
        let swing = size * (7.0 + m / 8.0 + 3.0);
        // What the modes miss of the force drives an error while it acts, their residuals as long as they swing.
        let missed = modes.defect[i] * (acting + fastest * scene.horizon);
        (swing + scene.initial[i].abs()) * ROUNDOFF + missed
    };
    (0..scene.initial.len()).map(spring).fold(0.0, f64::max)
}

/// The forces as functions of time.
struct Field<'a> {
    scene: &'a Scene,
    modes: &'a Modes,
    omega: Vec<f64>,
    mean: Vec<f64>,
}

impl<'a> Field<'a> {
    fn new(scene: &'a Scene, modes: &'a Modes) -> Field<'a> {
        let mean = statics::unit_force(&scene.chain, scene.source);
        let omega = modes.omega.iter().map(|w| w.hi).collect();
        Field { scene, modes, omega, mean }
    }

    /// The one or two stretches of constant force within the horizon.
    fn stretches(&self) -> Vec<Stretch> {
        let Scene { force, duration, horizon, .. } = *self.scene;
        let modes = self.omega.len();
        let mean = self.mean.iter().zip(&self.scene.initial).map(|(s, f)| f + force * s).collect();
        let amplitude = vec![-force; modes];
        let step = Stretch { from: 0.0, to: horizon.min(duration), reference: 0.0, sine: false, amplitude, mean };
        if duration >= horizon {
            return vec![step];
        }
        let half = |w: &Dd| 2.0 * force * w.phase(0.5 * duration).sin();
        let after = Stretch {
            from: duration,
            to: horizon,
            reference: 0.5 * duration,
            sine: true,
            amplitude: self.modes.omega.iter().map(half).collect(),
            mean: self.scene.initial.clone(),
        };
        vec![step, after]
    }

    /// Every mode at an instant.
    ///
    /// During the force `1 - cos = 2 sin^2` of half the phase: a short and hard pulse loses no digits to its mean.
    fn coordinates(&self, stretch: &Stretch, t: f64) -> Vec<Coordinates> {
        let tau = Dd::from(t) - Dd::from(stretch.reference);
        let at = |(w, &a): (&Dd, &f64)| {
            let phase = w.phase_of(tau);
            let (sin, cos) = phase.sin_cos();
            if stretch.sine {
                [a * sin, a * sin, a * cos]
            } else {
                [-2.0 * a * (0.5 * phase).sin().powi(2), a * cos, -a * sin]
            }
        };
        self.modes.omega.iter().zip(&stretch.amplitude).map(at).collect()
    }

    /// One spring's force at an instant, all modes, to rounding.
    fn value(&self, stretch: &Stretch, spring: usize, t: f64) -> f64 {
        let coordinates = self.coordinates(stretch, t);
        let row = self.modes.share.row(spring);
        self.scene.initial[spring] + pairwise(&|j| row[j] * coordinates[j][0], 0, coordinates.len())
    }

    /// Taylor polynomial of a spring's force about a cell's centre, and the joint amplitude of the modes left out.
    fn local(
        &self,
        stretch: &Stretch,
        spring: usize,
        coordinates: &[Coordinates],
        resolved: usize,
        center: f64,
        radius: f64,
    ) -> (Local, f64) {
        let mut coefficient = [0.0; COEFFICIENTS];
        for (j, &[added, c, s]) in coordinates.iter().enumerate().take(resolved) {
            let x = self.omega[j] * radius;
            let mut power = self.modes.share[(spring, j)];
            coefficient[0] += power * added;
            // Derivatives of q in units of omega: q, q', -q, -q', ...
            let cycle = [c, s, -c, -s];
            for (q, sum) in coefficient.iter_mut().enumerate().skip(1) {
                power *= x;
                *sum += power * cycle[q % 4] * INVERSE_FACTORIAL[q];
            }
        }
        // Modes left out stand at what they have added on average.
        let fast = resolved..self.omega.len();
        let average = |j: usize| if stretch.sine { 0.0 } else { -stretch.amplitude[j] * self.modes.share[(spring, j)] };
        coefficient[0] += self.scene.initial[spring] + fast.clone().map(average).sum::<f64>();
        let slack = fast.map(|j| (self.modes.share[(spring, j)] * stretch.amplitude[j]).abs()).sum();
        (Local { coefficient, terms: COEFFICIENTS, center, radius }, slack)
    }
}

/// A search through time for what matters.
struct Scan<'a> {
    field: Field<'a>,
    watch: Watch,
    work: Work,
    /// The lowest that each side was seen at.
    lowest: Vec<[f64; 2]>,
    /// Looks times modes so far.
    looks: u64,
    /// How far an extreme may lie over what was found, because the search for it was given up.
    missed: f64,
}

impl Scan<'_> {
    fn stretch(&mut self, stretch: &Stretch) {
        if stretch.to <= stretch.from {
            return;
        }
        let grid = Grid::new(&self.field, stretch);
        let (mut candidates, certain) = self.survey(stretch, &grid);
        candidates.sort_by_key(|c| (c.cell, c.spring));
        let mut centre = (usize::MAX, Vec::new());
        for c in candidates {
            let (a, b) = grid.cell(c.cell);
            let side = usize::from(c.negative);
            if certain[c.spring][side].low_in < c.cell {
                self.watch.departs(c.spring, c.negative, self.lowest[c.spring][side]);
            }
            if c.bound <= self.watch.level(c.spring, c.negative) {
                continue;
            }
            if centre.0 != c.cell {
                centre = (c.cell, self.field.coordinates(stretch, 0.5 * (a + b)));
            }
            self.refine(stretch, &c, a, b, Some(&centre.1));
        }
    }

    /// Forces and slopes of all springs on the grid, block by block; cells that might matter, and what is certain.
    fn survey(&mut self, stretch: &Stretch, grid: &Grid) -> (Vec<Candidate>, Vec<[Certain; 2]>) {
        let springs = self.watch.peaks.len();
        let share = self.field.modes.share.columns(0, grid.resolved).into_owned();
        let mut certain = vec![[Certain::default(); 2]; springs];
        let mut candidates = Vec::new();
        let mut start = 0;
        while start < grid.cells {
            let columns = (grid.cells - start).min(BLOCK) + 1;
            let (q, dq) = grid.coordinates(&self.field, stretch, start, columns);
            let (force, slope) = (&share * q, &share * dq);
            self.work.mode_sums += (2 * springs * columns * grid.resolved) as u64;
            for n in 0..columns - 1 {
                for (spring, certain) in certain.iter_mut().enumerate() {
                    let end = |n: usize| [force[(spring, n)] + stretch.mean[spring], slope[(spring, n)]];
                    for (negative, certain) in [false, true].into_iter().zip(certain) {
                        let mut c = Candidate { cell: start + n, spring, negative, bound: 0.0 };
                        c.bound = grid.bound(&self.watch, &c, [end(n), end(n + 1)], certain);
                        if certain.leaves_open(&self.watch, &c) {
                            candidates.push(c);
                        }
                    }
                }
            }
            start += columns - 1;
            candidates.retain(|c| certain[c.spring][usize::from(c.negative)].leaves_open(&self.watch, c));
        }
        for (lowest, certain) in self.lowest.iter_mut().zip(&certain) {
            lowest.iter_mut().zip(certain).for_each(|(l, c)| *l = l.min(c.lowest));
        }
        (candidates, certain)
    }

    /// Looks into [a, b] with the modes that its width resolves, splitting while the others matter.
    fn refine(&mut self, stretch: &Stretch, c: &Candidate, a: f64, b: f64, known: Option<&Vec<Coordinates>>) {
        let (center, radius) = (0.5 * (a + b), 0.5 * (b - a));
        let resolved = self.field.omega.partition_point(|w| w * radius <= RESOLVED);
        let coordinates = match known {
            Some(q) => q,
            None => &self.field.coordinates(stretch, center),
        };
        let (local, slack) = self.field.local(stretch, c.spring, coordinates, resolved, center, radius);
        self.work.refinements += 1;
        self.looks += self.field.omega.len() as u64;
        if slack <= self.watch.grain() {
            let exact = |t: f64| self.field.value(stretch, c.spring, t);
            self.watch.note(c.spring, c.negative, &local, 1.0, exact);
            return;
        }
        let level = self.watch.level(c.spring, c.negative) - slack;
        let turned = if c.negative { local.negated() } else { local };
        let Some(top) = turned.largest(-1.0, 1.0, level) else { return };
        if self.looks > MOST_LOOKS || radius <= 1e-13 * center {
            self.give_up(stretch, c, turned.center + turned.radius * top.at, top.value + slack);
            return;
        }
        let at = |k: u8| a + (b - a) * f64::from(k) / 4.0;
        for k in 0..4 {
            self.refine(stretch, c, at(k), at(k + 1), None);
        }
    }

    /// Takes what the force is at one instant, and how much larger it may be, for a place that is not looked into.
    fn give_up(&mut self, stretch: &Stretch, c: &Candidate, t: f64, upper: f64) {
        let value = self.field.value(stretch, c.spring, t);
        self.watch.take(c.spring, c.negative, t, if c.negative { -value } else { value });
        self.watch.leave_open(c.spring, c.negative, upper);
        let best = self.watch.peaks[c.spring].side(c.negative).best.value;
        self.missed = self.missed.max(upper - best);
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

/// 1 / q!
const INVERSE_FACTORIAL: [f64; COEFFICIENTS] = {
    let mut table = [1.0; COEFFICIENTS];
    let mut factorial = 1.0;
    let mut q = 1;
    while q < COEFFICIENTS {
        factorial *= q as f64;
        table[q] = 1.0 / factorial;
        q += 1;
    }
    table
};

/// Sum of `term(j)` over [from, to) by halves: its rounding grows as the logarithm of the number of terms.
fn pairwise(term: &dyn Fn(usize) -> f64, from: usize, to: usize) -> f64 {
    if to - from <= 16 {
        return (from..to).map(term).sum();
    }
    let middle = from + (to - from) / 2;
    pairwise(term, from, middle) + pairwise(term, middle, to)
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
    slack: Vec<[f64; 2]>,
}

impl Grid {
    fn new(field: &Field, stretch: &Stretch) -> Grid {
        let springs = field.scene.initial.len();
        let amplitude = |i: usize, j: usize| (field.modes.share[(i, j)] * stretch.amplitude[j]).abs();
        let resolved = resolved_modes(&field.omega);
        let top = if resolved == 0 { 1.0 } else { field.omega[resolved - 1] };
        let span = stretch.to - stretch.from;
        let cells = (span * top / 1.5).ceil().max(1.0) as usize;
        let width = span / cells as f64;
        let slack = |i: usize| {
            let cubic: f64 = (0..resolved).map(|j| amplitude(i, j) * (field.omega[j] * width).powi(4)).sum();
            let fast: f64 = (resolved..field.omega.len()).map(|j| amplitude(i, j)).sum();
            let swinging: f64 = (0..resolved).map(|j| amplitude(i, j)).sum();
            let rounding = 1e-12 * swinging + 8.0 * ROUNDOFF * stretch.mean[i].abs();
            [cubic / 384.0 + fast + rounding, fast + rounding]
        };
        Grid { from: stretch.from, to: stretch.to, cells, width, resolved, slack: (0..springs).map(slack).collect() }
    }

    fn cell(&self, n: usize) -> (f64, f64) {
        let at = |n: usize| if n == self.cells { self.to } else { self.from + n as f64 * self.width };
        (at(n), at(n + 1))
    }

    /// Coordinates and their rates of the resolved modes at grid points `start..start + columns`, modes x columns.
    ///
    /// The first is exact; the others follow by rotation, which loses a few units of rounding over a block.
    fn coordinates(
        &self,
        field: &Field,
        stretch: &Stretch,
        start: usize,
        columns: usize,
    ) -> (DMatrix<f64>, DMatrix<f64>) {
        let first = field.coordinates(stretch, self.cell(start).0);
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
        let [over, off] = self.slack[c.spring];
        let sign = if c.negative { -1.0 } else { 1.0 };
        let [left, right] = ends.map(|[f, d]| [sign * f, sign * d]);
        let reached = left[0].max(right[0]);
        certain.value = certain.value.max(reached - off);
        certain.lowest = certain.lowest.min(left[0] + off);
        if certain.low_in == usize::MAX && watch.is_low(c.spring, c.negative, left[0] + off) {
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
fn resolved_modes(omega: &[f64]) -> usize {
    let half = omega.len().div_ceil(2).max(1);
    let gap = (half..omega.len()).find(|&j| omega[j] > 4.0 * omega[j - 1]);
    gap.unwrap_or(omega.len())
}
