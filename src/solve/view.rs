//! What a march shows of a step, and quick bounds from it: which springs' forces may pass what matters.

use pulp::Simd;

use super::lanes::{Aligned, BLOCK, HALO, LANES, Layout, Number, Row, Rows, lanes};
use super::motion::{FAR, MARGIN, Motion, any_positive, excess, local_norms, norms_around};
use super::pieces::Step;

/// Equal steps under a constant force, with a width and a force for each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// The number of the first step, counted from 0 through the whole march.
    pub number: u64,
    pub from: [f64; LANES],
    pub width: [f64; LANES],
    pub force: [f64; LANES],
    pub count: [u64; LANES],
    /// No other stretch follows.
    pub is_last: bool,
}

/// What a march shows of a step. Rows are laid out by `layout`.
pub(super) struct View<'a, T: Number = f64> {
    pub stretch: &'a Stretch,
    /// Steps of the stretch before this one.
    pub done: u64,
    pub layout: Layout,
    /// G at both ends.
    pub force: [&'a [T]; 2],
    /// `q = -h^2 G''` at both ends, with halos.
    pub bend: [&'a [T]; 2],
    /// The two remainders of every spring, per unit of the norm of `h^2 G''` around it.
    pub remainders: &'a [Aligned<T>; 2],
    /// `1 / sqrt(k)`
    pub root: &'a [T],
    /// Sums of `q_i^2 / k_i` over the blocks of rows, lane by lane: the larger ones of both ends, with halos.
    pub energy: &'a [T],
}

impl<T: Number> View<'_, T> {
    /// The step of a lane.
    #[inline(always)]
    pub(super) fn step(&self, lane: usize) -> Step {
        let Stretch { number, from, width, force, .. } = self.stretch;
        let (width, force) = (width[lane], force[lane]);
        Step { number: number + self.done, from: from[lane] + self.done as f64 * width, width, force }
    }

    /// The lane's march ends with this step.
    #[inline(always)]
    pub(super) fn ends(&self, lane: usize) -> bool {
        self.stretch.is_last && self.is_last(lane)
    }

    /// The lane's step is its last of a stretch.
    #[inline(always)]
    pub(super) fn is_last(&self, lane: usize) -> bool {
        self.done + 1 == self.stretch.count[lane]
    }

    /// The lane's steps have ended before.
    #[inline(always)]
    pub(super) fn is_over(&self, lane: usize) -> bool {
        self.done >= self.stretch.count[lane]
    }
}

impl View<'_> {
    /// G of a chain's spring at the step's beginning (0) or end (1).
    #[inline(always)]
    pub(super) fn force(&self, end: usize, chain: usize, spring: usize) -> f64 {
        self.force[end][self.layout.place(chain, spring)]
    }

    /// `G`, `h^2 G''` and `h^4 G''''` of a chain's spring at both ends.
    #[inline(always)]
    pub(super) fn even_derivatives(&self, motion: &Motion, [chain, spring]: [usize; 2]) -> [[f64; 3]; 2] {
        let (ahead, behind) = (motion.ahead[spring], motion.behind[spring]);
        let (place, width) = (self.layout.place(chain, spring), self.stretch.width[chain]);
        [0, 1].map(|end| {
            let q = self.bend[end];
            let pull = ahead * (q[place] - q[place - LANES]) + behind * (q[place] - q[place + LANES]);
            [self.force[end][place], -q[place], width * width * pull]
        })
    }

    /// The energy of all blocks of a lane's chain together.
    #[inline(always)]
    pub(super) fn whole_energy(&self) -> [f64; LANES] {
        let mut sums = [0.0; LANES];
        for block in 0..self.layout.blocks() {
            let energy = lanes(self.energy, HALO + block);
            (0..LANES).for_each(|l| sums[l] += energy[l]);
        }
        let [a, b, c, d, e, f, g, h] = sums;
        if self.layout.is_cut { [((a + b) + (c + d)) + ((e + f) + (g + h)); LANES] } else { sums }
    }

    /// The bounds of [`local_norms`] for a block of rows.
    #[inline(always)]
    pub(super) fn norms(&self, block: usize, whole: [f64; LANES]) -> [[f64; LANES]; 2] {
        if self.layout.rows < BLOCK {
            // Short blocks: all of them count as near.
            local_norms(|n| if n == FAR { whole } else { [0.0; LANES] }, whole)
        } else {
            local_norms(|n| lanes(self.energy, HALO + block + n - FAR), whole)
        }
    }

    /// Rows of a block in which the quick bound of some spring's G, or -G, over the step passes its level in `levels`.
    #[inline(always)]
    pub(super) fn open_rows<S: Simd, const H: usize>(
        &self,
        v: Rows<S, H>,
        levels: &[Aligned; 2],
        block: usize,
        whole: [f64; LANES],
    ) -> impl Iterator<Item = usize> + use<S, H> {
        let inner = self.layout.block(block);
        let (from, count) = (inner.start, inner.len());
        let norm = v.of(&self.norms(block, whole)[0])[0];
        let bounds = QuickBounds {
            force: [&v.of(self.force[0])[inner.clone()], &v.of(self.force[1])[inner.clone()]],
            bend: [&v.of(self.bend[0])[inner.clone()], &v.of(self.bend[1])[inner.clone()]],
            remainder: &v.of(&self.remainders[0])[inner.clone()],
            levels: [&v.of(&levels[0])[inner.clone()], &v.of(&levels[1])[inner]],
        };
        let mut most = v.splat(0.0);
        for n in 0..count {
            most = v.max(most, bounds.passed(v, n, norm));
        }
        let mut open = 0u16;
        if v.any_larger(most, v.splat(0.0)) {
            for n in 0..count {
                open |= u16::from(v.any_larger(bounds.passed(v, n, norm), v.splat(0.0))) << n;
            }
        }
        (0..count).filter(move |n| open >> n & 1 == 1).map(move |n| from + n)
    }

    /// By how much the bounds of a row's springs over the step pass their levels (positive where they do), and the second remainders of
    /// those springs; `None` if no bound does. `levels` are [levels, crossings], each per sign and spring: G, or -G, must pass its level,
    /// and its crossing if it rises through the whole step ([`excess`]).
    pub(super) fn open_springs(
        &self,
        levels: [&[Aligned; 2]; 2],
        row: usize,
        last: [bool; LANES],
    ) -> Option<([f64; LANES], [f64; LANES])> {
        pulp::Arch::new().dispatch(Closer { view: self, levels, row, last })
    }

    /// How far the quick bounds of a row's springs pass what matters, given bounds on the norms around them.
    #[inline(always)]
    fn passing(
        &self,
        [levels, crossings]: [&[Aligned; 2]; 2],
        row: usize,
        norms: [f64; LANES],
        last: [bool; LANES],
    ) -> [f64; LANES] {
        let (f0, f1) = (lanes(self.force[0], row), lanes(self.force[1], row));
        let (q0, q1) = (lanes(self.bend[0], row), lanes(self.bend[1], row));
        let remainder = lanes(&self.remainders[0], row);
        let (high, low) = (lanes(&levels[0], row), lanes(&levels[1], row));
        let (over, under) = (lanes(&crossings[0], row), lanes(&crossings[1], row));
        let mut open = [0.0; LANES];
        for l in 0..LANES {
            let (level, crossing) = ([high[l], low[l]], [over[l], under[l]]);
            open[l] = excess([f0[l], f1[l]], [q0[l], q1[l]], norms[l] * remainder[l], level, crossing, last[l]);
        }
        open
    }

    /// `|q| / sqrt(k)` at both ends in the springs `offset` places behind those of a row.
    #[inline(always)]
    fn sizes(&self, row: usize, offset: isize) -> [[f64; LANES]; 2] {
        let of = |of: &[f64]| self.layout.beside(of, row, offset);
        let root = of(self.root);
        let mut sizes = [of(self.bend[0]), of(self.bend[1])];
        for size in &mut sizes {
            (0..LANES).for_each(|l| size[l] = size[l].abs() * root[l]);
        }
        sizes
    }
}

/// The rows of a block that quick bounds are of.
struct QuickBounds<'a, S: Simd, const H: usize> {
    force: [&'a [Row<S, H>]; 2],
    bend: [&'a [Row<S, H>]; 2],
    remainder: &'a [Row<S, H>],
    levels: [&'a [Row<S, H>]; 2],
}

impl<S: Simd, const H: usize> QuickBounds<'_, S, H> {
    /// How far a quick bound of a row's springs over the step passes what matters, given a bound on the norms around them.
    #[inline(always)]
    fn passed(&self, v: Rows<S, H>, row: usize, norm: Row<S, H>) -> Row<S, H> {
        let (f, g) = (self.force[0][row], self.force[1][row]);
        let (q, p) = (self.bend[0][row], self.bend[1][row]);
        let (zero, eighth) = (v.splat(0.0), v.splat(0.125));
        let up = v.mul_add(eighth, v.max(v.max(q, p), zero), v.max(f, g));
        let down = v.mul_add(eighth, v.min(v.min(q, p), zero), v.min(f, g));
        let passed = v.max(v.sub(up, self.levels[0][row]), v.sub(v.sub(zero, down), self.levels[1][row]));
        v.mul_add(norm, self.remainder[row], passed)
    }
}

/// The test of [`View::open_springs`]; few rows need it, so it is compiled apart from the march.
struct Closer<'a> {
    view: &'a View<'a>,
    levels: [&'a [Aligned; 2]; 2],
    row: usize,
    last: [bool; LANES],
}

impl pulp::WithSimd for Closer<'_> {
    type Output = Option<([f64; LANES], [f64; LANES])>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Closer { view, levels, row, last } = self;
        let bounds = view.norms(view.layout.block_of(row), view.whole_energy());
        if !any_positive(view.passing(levels, row, bounds[0], last)) {
            return None;
        }
        let norms = norms_around(|place| view.sizes(row, place as isize - MARGIN as isize), bounds);
        let open = view.passing(levels, row, norms, last);
        let mut remainders = lanes(&view.remainders[1], row);
        (0..LANES).for_each(|l| remainders[l] *= norms[l]);
        any_positive(open).then_some((open, remainders))
    }
}
