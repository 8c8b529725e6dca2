//! Chains laid out in rows of `LANES` numbers, one in each lane.
//!
//! A chain alone is cut into `LANES` pieces of equal length, one in each lane; of several chains side by side each has a lane of its own.
//! Row r holds place r of every piece or chain: a spring's neighbours are in the same lane of the rows before and after. `HALO` more rows
//! lie before the first row and behind the last: copies of the ends of the neighbouring pieces, and zeros beyond the ends of a chain.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut, Range};

use pulp::Simd;

/// Numbers in a row.
pub(super) const LANES: usize = 8;
/// Rows before and behind the pieces.
pub(super) const HALO: usize = 2;
/// Rows of a block. The last block of a piece has what is left, under twice as many; a piece of fewer rows is one block.
pub(super) const BLOCK: usize = 8;

/// Where springs and masses are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Rows of a piece or chain.
    pub(super) rows: usize,
    /// There is one chain, cut into pieces.
    pub(super) is_cut: bool,
}

impl Layout {
    /// The layout of chains with so many springs, one entry per chain; each has one mass more.
    pub(super) fn new(springs: &[usize]) -> Layout {
        let most = springs.iter().fold(0, |most, &springs| most.max(springs)) + 1;
        let is_cut = springs.len() == 1;
        Layout { rows: if is_cut { most.div_ceil(LANES) } else { most.next_multiple_of(BLOCK) }, is_cut }
    }

    /// Blocks of a piece or chain.
    #[inline(always)]
    pub(super) fn blocks(self) -> usize {
        (self.rows / BLOCK).max(1)
    }

    /// The rows of a block; the last one has what is left.
    #[inline(always)]
    pub(super) fn block(self, number: usize) -> Range<usize> {
        let to = if number + 1 < self.blocks() { (number + 1) * BLOCK } else { self.rows };
        HALO + number * BLOCK..HALO + to
    }

    /// The block of a row.
    pub(super) fn block_of(self, row: usize) -> usize {
        ((row - HALO) / BLOCK).min(self.blocks() - 1)
    }

    /// Numbers that are stored, halos included.
    pub(super) fn len(self) -> usize {
        (self.rows + 2 * HALO) * LANES
    }

    /// The index of a chain's spring or mass `number` in the stored numbers.
    #[inline(always)]
    pub(super) fn place(self, chain: usize, number: usize) -> usize {
        if self.is_cut {
            (number % self.rows + HALO) * LANES + number / self.rows
        } else {
            (number + HALO) * LANES + chain
        }
    }

    /// The chain in a lane.
    #[inline(always)]
    pub(super) fn chain(self, lane: usize) -> usize {
        if self.is_cut { 0 } else { lane }
    }

    /// The spring or mass in a lane of a row.
    #[inline(always)]
    pub(super) fn number(self, row: usize, lane: usize) -> usize {
        (if self.is_cut { lane * self.rows } else { 0 }) + row - HALO
    }

    /// The values `offset` places behind those of a row, 0 outside the chains; halos of several chains are zero.
    #[inline(always)]
    pub(super) fn beside(self, of: &[f64], row: usize, offset: isize) -> [f64; LANES] {
        let there = row.wrapping_add_signed(offset);
        if !self.is_cut || (HALO..HALO + self.rows).contains(&there) {
            return of.as_chunks().0.get(there).copied().unwrap_or_default();
        }
        let mut out = [0.0; LANES];
        for (lane, out) in out.iter_mut().enumerate() {
            let number = self.number(row, lane).wrapping_add_signed(offset);
            if number < LANES * self.rows {
                *out = of[self.place(0, number)];
            }
        }
        out
    }

    /// Puts a chain's values to their places.
    pub(super) fn put<T: Number>(self, into: &mut [T], chain: usize, values: impl IntoIterator<Item = f64>) {
        let values = values.into_iter().enumerate();
        values.for_each(|(number, value)| into[self.place(chain, number)] = T::from_f64(value));
    }

    /// The first `count` values of a chain.
    pub(super) fn gather<T: Number>(self, of: &[T], chain: usize, count: usize) -> Vec<f64> {
        (0..count).map(|number| of[self.place(chain, number)].to_f64()).collect()
    }

    /// Fills the halos of a chain in pieces with the ends of the neighbouring pieces, zeros beyond the ends of the chain; halos of several
    /// chains stay zero.
    #[inline(always)]
    pub(super) fn fill_halos<S: Simd, const H: usize, T: Number>(self, v: Rows<S, H, T>, of: &mut [T]) {
        if !self.is_cut {
            return;
        }
        let of = v.of_mut(of);
        let rows = of.len() - 2 * HALO;
        for depth in 0..HALO {
            of[HALO - 1 - depth] = v.one_lane_up(of[HALO + rows - 1 - depth]);
            of[HALO + rows + depth] = v.one_lane_down(of[HALO + depth]);
        }
    }
}

/// Numbers that begin at the beginning of a cache line, so that no row lies across two.
#[derive(Debug)]
pub(super) struct Aligned<T = f64> {
    numbers: Vec<T>,
    first: usize,
    len: usize,
}

impl<T: Number> Aligned<T> {
    /// So many of the same number.
    pub(super) fn new(len: usize, number: T) -> Aligned<T> {
        const LINE: usize = LANES * size_of::<f64>();
        let most = LINE / size_of::<T>();
        let numbers = vec![number; len + most];
        let first = numbers.as_ptr().align_offset(LINE).min(most);
        Aligned { numbers, first, len }
    }
}

impl<T: Number> Clone for Aligned<T> {
    fn clone(&self) -> Aligned<T> {
        let mut out = Aligned::new(self.len, T::default());
        out.copy_from_slice(self);
        out
    }
}

impl<T> Deref for Aligned<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.numbers[self.first..self.first + self.len]
    }
}

impl<T> DerefMut for Aligned<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.numbers[self.first..self.first + self.len]
    }
}

/// A row.
#[inline(always)]
pub(super) fn lanes<T: Number>(of: &[T], row: usize) -> [T; LANES] {
    let mut out = [T::default(); LANES];
    out.copy_from_slice(&of[row * LANES..(row + 1) * LANES]);
    out
}

/// A floating-point number, and vectors of it.
pub(super) trait Number: Copy + Default + PartialEq + std::fmt::Debug + 'static {
    /// A march in these numbers adds up the rounding errors of its running sums (compensated summation).
    const COMPENSATED: bool;
    type Vector<S: Simd>: Copy;

    fn from_f64(value: f64) -> Self;
    fn to_f64(self) -> f64;
    fn vectors<S: Simd>(numbers: &[Self]) -> &[Self::Vector<S>];
    fn vectors_mut<S: Simd>(numbers: &mut [Self]) -> &mut [Self::Vector<S>];
    fn splat<S: Simd>(simd: S, a: Self) -> Self::Vector<S>;
    fn add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn sub<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn mul<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn max<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn min<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    fn mul_add<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>, c: Self::Vector<S>) -> Self::Vector<S>;
    /// The last number of a, then b's without its last.
    fn one_up<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
    /// a's numbers without its first, then the first of b.
    fn one_down<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>) -> Self::Vector<S>;
}

macro_rules! number {
    ($number:ty, $compensated:literal, $vector:ident, $as:ident, $as_mut:ident, $splat:ident, $fma:ident, $up:ident, $down:ident, $select:ident, $between:ident, $lanes:ident, $($op:ident $name:ident),*) => {
        impl Number for $number {
            const COMPENSATED: bool = $compensated;
            type Vector<S: Simd> = S::$vector;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $number
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn vectors<S: Simd>(numbers: &[Self]) -> &[S::$vector] {
                S::$as(numbers).0
            }

            #[inline(always)]
            fn vectors_mut<S: Simd>(numbers: &mut [Self]) -> &mut [S::$vector] {
                S::$as_mut(numbers).0
            }

            #[inline(always)]
            fn splat<S: Simd>(simd: S, a: Self) -> S::$vector {
                simd.$splat(a)
            }

            #[inline(always)]
            fn mul_add<S: Simd>(simd: S, a: S::$vector, b: S::$vector, c: S::$vector) -> S::$vector {
                simd.$fma(a, b, c)
            }

            #[inline(always)]
            fn one_up<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$select(simd.$between(0, 1).mask(), simd.$up(a, 1), simd.$up(b, 1))
            }

            #[inline(always)]
            fn one_down<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                let lanes = S::$lanes as _;
                simd.$select(simd.$between(lanes - 1, lanes).mask(), simd.$down(b, 1), simd.$down(a, 1))
            }

            $(#[inline(always)]
            fn $op<S: Simd>(simd: S, a: S::$vector, b: S::$vector) -> S::$vector {
                simd.$name(a, b)
            })*
        }
    };
}

number!(
    f64, true, f64s, as_simd_f64s, as_mut_simd_f64s, splat_f64s, mul_add_f64s,
    rotate_right_f64s, rotate_left_f64s, select_f64s, mask_between_m64s, F64_LANES,
    add add_f64s, sub sub_f64s, mul mul_f64s, max max_f64s, min min_f64s
);
number!(
    f32, false, f32s, as_simd_f32s, as_mut_simd_f32s, splat_f32s, mul_add_f32s,
    rotate_right_f32s, rotate_left_f32s, select_f32s, mask_between_m32s, F32_LANES,
    add add_f32s, sub sub_f32s, mul mul_f32s, max max_f32s, min min_f32s
);

/// A row of `LANES` numbers in `H` vectors.
pub(super) type Row<S, const H: usize, T = f64> = [<T as Number>::Vector<S>; H];

/// Arithmetic on rows, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Rows<S, const H: usize, T = f64>(S, PhantomData<T>);

impl<S: Simd, const H: usize, T: Number> Rows<S, H, T> {
    /// Numbers as rows.
    #[inline(always)]
    pub(super) fn of(self, numbers: &[T]) -> &[Row<S, H, T>] {
        T::vectors(numbers).as_chunks().0
    }

    /// The same, to be written.
    #[inline(always)]
    pub(super) fn of_mut(self, numbers: &mut [T]) -> &mut [Row<S, H, T>] {
        T::vectors_mut(numbers).as_chunks_mut().0
    }

    #[inline(always)]
    pub(super) fn splat(self, a: f64) -> Row<S, H, T> {
        [T::splat(self.0, T::from_f64(a)); H]
    }

    #[inline(always)]
    pub(super) fn add(self, a: Row<S, H, T>, b: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::add(self.0, a[h], b[h]);
        }
        out
    }

    #[inline(always)]
    pub(super) fn sub(self, a: Row<S, H, T>, b: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::sub(self.0, a[h], b[h]);
        }
        out
    }

    #[inline(always)]
    pub(super) fn mul(self, a: Row<S, H, T>, b: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::mul(self.0, a[h], b[h]);
        }
        out
    }

    #[inline(always)]
    pub(super) fn max(self, a: Row<S, H, T>, b: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::max(self.0, a[h], b[h]);
        }
        out
    }

    #[inline(always)]
    pub(super) fn min(self, a: Row<S, H, T>, b: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::min(self.0, a[h], b[h]);
        }
        out
    }

    /// `a b + c`, rounded once.
    #[inline(always)]
    pub(super) fn mul_add(self, a: Row<S, H, T>, b: Row<S, H, T>, c: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = a;
        for h in 0..H {
            out[h] = T::mul_add(self.0, a[h], b[h], c[h]);
        }
        out
    }

    /// The numbers of a row one lane further up, with 0 in the first.
    #[inline(always)]
    fn one_lane_up(self, a: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = self.splat(0.0);
        for h in 0..H {
            out[h] = T::one_up(self.0, if h == 0 { out[0] } else { a[h - 1] }, a[h]);
        }
        out
    }

    /// The numbers of a row one lane further down, with 0 in the last.
    #[inline(always)]
    fn one_lane_down(self, a: Row<S, H, T>) -> Row<S, H, T> {
        let mut out = self.splat(0.0);
        for h in 0..H {
            out[h] = T::one_down(self.0, a[h], if h + 1 == H { out[h] } else { a[h + 1] });
        }
        out
    }

    /// `a + b`, and its rounding error: exact where |a| >= |b|, else to a rounding of b.
    #[inline(always)]
    pub(super) fn two_sum(self, a: Row<S, H, T>, b: Row<S, H, T>) -> [Row<S, H, T>; 2] {
        let s = self.add(a, b);
        [s, self.sub(b, self.sub(s, a))]
    }
}

impl<S: Simd, const H: usize> Rows<S, H> {
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

/// A task on rows of numbers T, compiled for the widest vectors of the processor.
pub(super) trait WithRows<T> {
    type Output;
    fn run<S: Simd, const H: usize>(self, rows: Rows<S, H, T>) -> Self::Output;
}

/// Runs a task with the widest vectors of the processor.
pub(super) fn dispatch<T: Number, W: WithRows<T>>(task: W) -> W::Output {
    super::vectors::widest().dispatch(Task(task, PhantomData))
}

struct Task<T, W>(W, PhantomData<T>);

impl<T: Number, W: WithRows<T>> pulp::WithSimd for Task<T, W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> W::Output {
        match size_of::<T::Vector<S>>() / size_of::<T>() {
            1 => self.0.run(Rows::<S, 8, T>(simd, PhantomData)),
            2 => self.0.run(Rows::<S, 4, T>(simd, PhantomData)),
            4 => self.0.run(Rows::<S, 2, T>(simd, PhantomData)),
            8 => self.0.run(Rows::<S, 1, T>(simd, PhantomData)),
            // A vector is longer than a row: of AVX-512, where another crate of the build asks for it.
            _ => self.0.run(Rows::<pulp::Scalar, LANES, T>(pulp::Scalar, PhantomData)),
        }
    }
}

#[cfg(test)]
mod tests;
