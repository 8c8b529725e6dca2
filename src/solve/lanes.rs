//! A chain laid out for vectors: cut into `LANES` pieces of equal length, one in each lane.
//!
//! Row r holds place r of every piece, so that a spring's neighbours are in the rows before and after, and vectors need no shuffling.
//! Beyond a piece's ends lie `HALO` rows with copies of its neighbours' ends, zeros at the ends of the chain.

use pulp::Simd;

/// Pieces of a chain.
pub(super) const LANES: usize = 8;
/// Rows before and behind the pieces.
pub(super) const HALO: usize = 2;
/// Blocks of a piece have this many rows or more; a shorter piece is one block.
pub(super) const BLOCK: usize = 8;

/// Where springs and masses of a chain are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Rows of a piece.
    pub(super) rows: usize,
}

impl Layout {
    /// That of a chain of so many springs, with one mass more.
    pub(super) fn new(springs: usize) -> Layout {
        Layout { rows: (springs + 1).div_ceil(LANES) }
    }

    /// Blocks of a piece.
    #[inline(always)]
    pub(super) fn blocks(self) -> usize {
        (self.rows / BLOCK).max(1)
    }

    /// The rows of a block.
    #[inline(always)]
    pub(super) fn block(self, number: usize) -> std::ops::Range<usize> {
        let first = |number: usize| HALO + number * self.rows / self.blocks();
        first(number)..first(number + 1)
    }

    /// The block of a row.
    pub(super) fn block_of(self, row: usize) -> usize {
        ((row - HALO + 1) * self.blocks() - 1) / self.rows
    }

    /// Numbers that are stored for each spring or mass.
    pub(super) fn len(self) -> usize {
        (self.rows + 2 * HALO) * LANES
    }

    /// The place of spring or mass `number`.
    #[inline(always)]
    pub(super) fn place(self, number: usize) -> usize {
        (number % self.rows + HALO) * LANES + number / self.rows
    }

    /// The spring or mass in a lane of a row.
    #[inline(always)]
    pub(super) fn number(self, row: usize, lane: usize) -> usize {
        lane * self.rows + row - HALO
    }

    /// The number at `ahead` places behind that of a row and lane, 0 outside the chain.
    #[inline(always)]
    pub(super) fn beside(self, of: &[f64], number: usize, offset: isize) -> f64 {
        let number = number.wrapping_add_signed(offset);
        if number < LANES * self.rows { of[self.place(number)] } else { 0.0 }
    }

    /// Values in the order of springs or masses to their places, `other` elsewhere.
    pub(super) fn spread(self, values: impl IntoIterator<Item = f64>, other: f64) -> Vec<f64> {
        let mut out = vec![other; self.len()];
        values.into_iter().enumerate().for_each(|(number, value)| out[self.place(number)] = value);
        out
    }

    /// The first `count` values in the order of springs or masses.
    pub(super) fn gather(self, values: &[f64], count: usize) -> Vec<f64> {
        (0..count).map(|number| values[self.place(number)]).collect()
    }

}

/// Copies the ends of pieces into the `HALO` rows of their neighbours, zeros beyond the ends of the chain.
#[inline(always)]
pub(super) fn wrap(of: &mut [f64]) {
    let rows = of.len() / LANES - 2 * HALO;
    for depth in 0..HALO {
        let (before, last) = ((HALO - 1 - depth) * LANES, (HALO + rows - 1 - depth) * LANES);
        of.copy_within(last..last + LANES - 1, before + 1);
        of[before] = 0.0;
        let (behind, first) = ((HALO + rows + depth) * LANES, (HALO + depth) * LANES);
        of.copy_within(first + 1..first + LANES, behind);
        of[behind + LANES - 1] = 0.0;
    }
}

/// Numbers that begin at the beginning of a cache line, so that no vector lies across two.
#[derive(Debug)]
pub(super) struct Aligned {
    numbers: Vec<f64>,
    first: usize,
    len: usize,
}

impl From<Vec<f64>> for Aligned {
    fn from(values: Vec<f64>) -> Aligned {
        let len = values.len();
        let mut numbers = vec![0.0; len + LANES];
        let first = numbers.as_ptr().align_offset(LANES * size_of::<f64>()).min(LANES);
        numbers[first..first + len].copy_from_slice(&values);
        Aligned { numbers, first, len }
    }
}

impl Clone for Aligned {
    fn clone(&self) -> Aligned {
        Aligned::from(self.to_vec())
    }
}

impl std::ops::Deref for Aligned {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.numbers[self.first..self.first + self.len]
    }
}

impl std::ops::DerefMut for Aligned {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.first..self.first + self.len]
    }
}

/// A row.
#[inline(always)]
pub(super) fn lanes(of: &[f64], row: usize) -> [f64; LANES] {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&of[row * LANES..(row + 1) * LANES]);
    out
}

/// A row of `LANES` numbers in `H` vectors, and arithmetic on them.
pub(super) type Row<S, const H: usize> = [<S as Simd>::f64s; H];

/// Arithmetic on rows, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Rows<S, const H: usize>(pub(super) S);

impl<S: Simd, const H: usize> Rows<S, H> {
    /// Numbers as rows.
    #[inline(always)]
    pub(super) fn of(self, numbers: &[f64]) -> &[Row<S, H>] {
        S::as_simd_f64s(numbers).0.as_chunks().0
    }

    /// The same, to be written.
    #[inline(always)]
    pub(super) fn of_mut(self, numbers: &mut [f64]) -> &mut [Row<S, H>] {
        S::as_mut_simd_f64s(numbers).0.as_chunks_mut().0
    }

    #[inline(always)]
    pub(super) fn splat(self, a: f64) -> Row<S, H> {
        [self.0.splat_f64s(a); H]
    }

    #[inline(always)]
    fn of_two(self, a: Row<S, H>, b: Row<S, H>, f: impl Fn(S::f64s, S::f64s) -> S::f64s) -> Row<S, H> {
        std::array::from_fn(|h| f(a[h], b[h]))
    }

    #[inline(always)]
    pub(super) fn add(self, a: Row<S, H>, b: Row<S, H>) -> Row<S, H> {
        self.of_two(a, b, |a, b| self.0.add_f64s(a, b))
    }

    #[inline(always)]
    pub(super) fn sub(self, a: Row<S, H>, b: Row<S, H>) -> Row<S, H> {
        self.of_two(a, b, |a, b| self.0.sub_f64s(a, b))
    }

    #[inline(always)]
    pub(super) fn mul(self, a: Row<S, H>, b: Row<S, H>) -> Row<S, H> {
        self.of_two(a, b, |a, b| self.0.mul_f64s(a, b))
    }

    #[inline(always)]
    pub(super) fn max(self, a: Row<S, H>, b: Row<S, H>) -> Row<S, H> {
        self.of_two(a, b, |a, b| self.0.max_f64s(a, b))
    }

    #[inline(always)]
    pub(super) fn min(self, a: Row<S, H>, b: Row<S, H>) -> Row<S, H> {
        self.of_two(a, b, |a, b| self.0.min_f64s(a, b))
    }

    /// `a b + c`, rounded once.
    #[inline(always)]
    pub(super) fn mul_add(self, a: Row<S, H>, b: Row<S, H>, c: Row<S, H>) -> Row<S, H> {
        std::array::from_fn(|h| self.0.mul_add_f64s(a[h], b[h], c[h]))
    }

    /// `a + b`, and its rounding error.
    #[inline(always)]
    pub(super) fn two_sum(self, a: Row<S, H>, b: Row<S, H>) -> [Row<S, H>; 2] {
        let s = self.add(a, b);
        let t = self.sub(s, a);
        [s, self.add(self.sub(a, self.sub(s, t)), self.sub(b, t))]
    }

    /// Whether any number of `a` is larger than that of `b`.
    #[inline(always)]
    pub(super) fn any_larger(self, a: Row<S, H>, b: Row<S, H>) -> bool {
        let mut any = self.0.less_than_f64s(b[0], a[0]);
        for h in 1..H {
            any = self.0.or_m64s(any, self.0.less_than_f64s(b[h], a[h]));
        }
        self.0.first_true_m64s(any) < S::F64_LANES
    }
}

/// Something to do with rows, compiled for the widest vectors at hand.
pub(super) trait WithRows {
    type Output;
    fn run<S: Simd, const H: usize>(self, rows: Rows<S, H>) -> Self::Output;
}

/// Does it.
pub(super) fn dispatch<T: WithRows>(task: T) -> T::Output {
    pulp::Arch::new().dispatch(Task(task))
}

struct Task<T>(T);

impl<T: WithRows> pulp::WithSimd for Task<T> {
    type Output = T::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> T::Output {
        match S::F64_LANES {
            1 => self.0.run(Rows::<S, 8>(simd)),
            2 => self.0.run(Rows::<S, 4>(simd)),
            4 => self.0.run(Rows::<S, 2>(simd)),
            _ => self.0.run(Rows::<S, 1>(simd)),
        }
    }
}
