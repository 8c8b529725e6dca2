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
    /// `h / m` and `h k` of every mass and spring, with halos.
    pub kick: &'a [T],
    pub drift: &'a [T],
    /// The two remainders of every spring, per unit of the norm of `h^2 G''` around it.
    pub remainders: &'a [Aligned<T>; 2],
    /// The largest first remainder of each block of rows, lane by lane.
    pub block_remainder: &'a [T],
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

    /// A bound on the first norm of [`Self::norms`] for every block of rows.
    #[inline(always)]
    pub(super) fn most_norm(&self, whole: [f64; LANES]) -> [f64; LANES] {
        local_norms(|n| if n == FAR { whole } else { [0.0; LANES] }, whole)[0]
    }

    /// How far G, or -G, in a block of rows may pass its level in `levels` between the instants before and after the step's end, as far as
    /// that follows from the values at its end: the largest of `G + max(q, 0) / 6 - level`.
    ///
    /// Between two instants G is at most its linear interpolation and `s (1 - s) ((2 - s) q_0 + (1 + s) q_1) / 6`, 0 <= s <= 1, but for the
    /// remainder ([`super::motion`]): at most the larger of these sums at both ends.
    #[inline(always)]
    pub(super) fn excess<S: Simd, const H: usize>(
        &self,
        v: Rows<S, H>,
        levels: &[Aligned; 2],
        block: usize,
    ) -> Row<S, H> {
        let inner = self.layout.block(block);
        let (force, bend) = (&v.of(self.force[1])[inner.clone()], &v.of(self.bend[1])[inner.clone()]);
        let (high, low) = (&v.of(&levels[0])[inner.clone()], &v.of(&levels[1])[inner]);
        let (zero, sixth) = (v.splat(0.0), v.splat(1.0 / 6.0));
        let (mut most, mut least) = (v.splat(f64::NEG_INFINITY), v.splat(f64::INFINITY));
        for n in 0..force.len() {
            most = v.max(most, v.sub(v.mul_add(sixth, v.max(bend[n], zero), force[n]), high[n]));
            least = v.min(least, v.add(v.mul_add(sixth, v.min(bend[n], zero), force[n]), low[n]));
        }
        v.max(most, v.sub(zero, least))
    }

    /// Rows of a block in which the quick bound of some spring's G, or -G, over the step passes its level in `levels`; `norms` are the
    /// first of [`Self::norms`].
    #[inline(always)]
    pub(super) fn open_rows<S: Simd, const H: usize>(
        &self,
        v: Rows<S, H>,
        levels: &[Aligned; 2],
        block: usize,
        norms: [f64; LANES],
    ) -> impl Iterator<Item = usize> + use<S, H> {
        let inner = self.layout.block(block);
        let (from, count) = (inner.start, inner.len());
        let (force, bend) = (self.force.map(|f| &v.of(f)[inner.clone()]), self.bend.map(|q| &v.of(q)[inner.clone()]));
        let (high, low) = (&v.of(&levels[0])[inner.clone()], &v.of(&levels[1])[inner.clone()]);
        let remainder = &v.of(&self.remainders[0])[inner];
        let (norm, zero, eighth) = (v.of(&norms)[0], v.splat(0.0), v.splat(0.125));
        let mut open = 0u16;
        for n in 0..count {
            let ([f, g], [q, p]) = ([force[0][n], force[1][n]], [bend[0][n], bend[1][n]]);
            let up = v.mul_add(eighth, v.max(v.max(q, p), zero), v.max(f, g));
            let down = v.mul_add(eighth, v.min(v.min(q, p), zero), v.min(f, g));
            let passed = v.max(v.sub(up, high[n]), v.sub(v.sub(zero, down), low[n]));
            open |= u16::from(v.any_larger(v.mul_add(norm, remainder[n], passed), zero)) << n;
        }
        (0..count).filter(move |n| open >> n & 1 == 1).map(move |n| from + n)
    }

    /// By how much the bounds of a row's springs over the step pass their levels (positive where they do), and the second remainders of
    /// those springs; `None` if no bound does. `bounds` are the [`Self::norms`] of the row's block; `levels` are [levels, crossings], each per sign and spring: G, or -G, must pass its level,
    /// and its crossing if it rises through the whole step ([`excess`]).
    pub(super) fn open_springs(
        &self,
        levels: [&[Aligned; 2]; 2],
        row: usize,
        bounds: [[f64; LANES]; 2],
        last: [bool; LANES],
    ) -> Option<([f64; LANES], [f64; LANES])> {
        super::vectors::widest().dispatch(Closer { view: self, levels, row, bounds, last })
    }

    /// How far the bounds of a row's springs pass what matters, given their second remainders.
    #[inline(always)]
    fn passing(
        &self,
        [levels, crossings]: [&[Aligned; 2]; 2],
        row: usize,
        remainders: [f64; LANES],
        last: [bool; LANES],
    ) -> [f64; LANES] {
        let ends = |of: [&[f64]; 2]| of.map(|of| lanes(of, row));
        let (f, q) = (ends(self.force), ends(self.bend));
        let p = self.bend.map(|q| self.times_x(q, row));
        let (high, low) = (lanes(&levels[0], row), lanes(&levels[1], row));
        let (over, under) = (lanes(&crossings[0], row), lanes(&crossings[1], row));
        let mut open = [0.0; LANES];
        for l in 0..LANES {
            let (level, crossing) = ([high[l], low[l]], [over[l], under[l]]);
            let ends = [[f[0][l], f[1][l]], [q[0][l], q[1][l]], [p[0][l], p[1][l]]];
            open[l] = excess(ends, remainders[l], level, crossing, last[l]);
        }
        open
    }

    /// `X q` in the springs of a row.
    #[inline(always)]
    fn times_x(&self, q: &[f64], row: usize) -> [f64; LANES] {
        let [before, here, after] = [lanes(q, row - 1), lanes(q, row), lanes(q, row + 1)];
        let [kick, next_kick, drift] = [lanes(self.kick, row), lanes(self.kick, row + 1), lanes(self.drift, row)];
        let mut out = [0.0; LANES];
        for l in 0..LANES {
            out[l] = drift[l] * (next_kick[l] * (here[l] - after[l]) - kick[l] * (before[l] - here[l]));
        }
        out
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

/// The test of [`View::open_springs`]; few rows need it, so it is compiled apart from the march.
struct Closer<'a> {
    view: &'a View<'a>,
    levels: [&'a [Aligned; 2]; 2],
    row: usize,
    bounds: [[f64; LANES]; 2],
    last: [bool; LANES],
}

impl pulp::WithSimd for Closer<'_> {
    type Output = Option<([f64; LANES], [f64; LANES])>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Closer { view, levels, row, bounds, last } = self;
        let remainder = lanes(&view.remainders[1], row);
        let of_norms = |norms: [f64; LANES]| {
            let mut remainders = remainder;
            (0..LANES).for_each(|l| remainders[l] *= norms[l]);
            remainders
        };
        if !any_positive(view.passing(levels, row, of_norms(bounds[0]), last)) {
            return None;
        }
        let norms = norms_around(|place| view.sizes(row, place as isize - MARGIN as isize), bounds);
        let remainders = of_norms(norms);
        let open = view.passing(levels, row, remainders, last);
        any_positive(open).then_some((open, remainders))
    }
}
