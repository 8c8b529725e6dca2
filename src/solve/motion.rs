//! Bounds on a spring's force between two instants of a march, from the equations of motion.
//!
//! The first terms of Lidstone's series (G. J. Lidstone, *Proc. Edinb. Math. Soc.* 2 (1929) 16-19) with their remainders
//! bound the force over a step from both sides:
//!
//! ```text
//! linear + G''            |remainder| <=  5 h^4 / 384   max |G''''|
//! linear + G'' + G''''    |remainder| <= 61 h^6 / 46080 max |G^(6)|
//! ```
//!
//! whose maxima follow from the equations of motion: `h^2 G''` at any instant of the step is the same mix of its values at both
//! ends as G is ([`super::pieces`]), so its norm over the springs around is at most `1 / cos(theta/2)` times the larger of
//! theirs, and `h^4 G'''' = -X h^2 G''`, `h^6 G^(6) = X^2 h^2 G''`.

use super::local::{Point, hermite_extremes};
use crate::chain::Scene;

/// Largest value of Lidstone's second polynomial `(3 x^5 - 10 x^3 + 7 x) / 360` on [0, 1].
const SECOND: f64 = 0.006_53;

/// The equations of motion of a scene's springs: `G_i'' = -a_i (G_i - G_{i-1}) - b_i (G_i - G_{i+1}) + drive_i`.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `k_i / m_i`; 0 for a held mass.
    pub ahead: Vec<f64>,
    /// `k_i / m_{i+1}`; 0 for a held mass.
    pub behind: Vec<f64>,
    /// `k_i (p_i / m_i - p_{i+1} / m_{i+1})` for a unit outside force p on the source.
    pub drive: Vec<f64>,
    /// Bounds on `(A G)_i` and `(A^2 G)_i` per unit of the norm of `G_i / sqrt(k_i)`.
    row: Vec<[f64; 2]>,
}

impl Motion {
    /// The motion of a scene.
    pub fn new(scene: &Scene) -> Motion {
        let chain = &scene.chain;
        let springs = chain.stiffness.len();
        let inverse = |v: usize| if chain.live(v) { 1.0 / chain.mass[v] } else { 0.0 };
        let ahead: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i)).collect();
        let behind: Vec<f64> = (0..springs).map(|i| chain.stiffness[i] * inverse(i + 1)).collect();
        let mut drive = vec![0.0; springs];
        if scene.source < springs {
            drive[scene.source] = ahead[scene.source];
        }
        if scene.source > 0 {
            drive[scene.source - 1] = -behind[scene.source - 1];
        }
        let first: Vec<f64> = (0..springs).map(|i| row_norm(&ahead, &behind, &chain.stiffness, i)).collect();
        let neighbour = |i: Option<usize>| i.and_then(|i| first.get(i)).copied().unwrap_or(0.0);
        let second = |i: usize| {
            let (before, after) = (neighbour(i.checked_sub(1)), neighbour(Some(i + 1)));
            (ahead[i] + behind[i]) * first[i] + ahead[i] * before + behind[i] * after
        };
        let row = (0..springs).map(|i| [first[i], second(i)]).collect();
        Motion { ahead, behind, drive, row }
    }

    /// The two remainders of every spring over steps of `width`, per unit of the local norm of `h^2 G''`.
    pub(crate) fn remainders(&self, width: f64) -> [Vec<f64>; 2] {
        let square = width * width;
        let factor = [5.0 / 384.0 * square, 61.0 / 46_080.0 * square * square];
        [0, 1].map(|d| self.row.iter().map(|r| factor[d] * r[d]).collect())
    }
}

/// `sqrt(k_i)` times the norm of row i of A in the coordinates `G_i / sqrt(k_i)`.
fn row_norm(ahead: &[f64], behind: &[f64], stiffness: &[f64], i: usize) -> f64 {
    let side = |c: f64, j: Option<usize>| j.and_then(|j| stiffness.get(j)).map_or(0.0, |k| c * k.sqrt());
    let middle = (ahead[i] + behind[i]) * stiffness[i].sqrt();
    middle.hypot(side(ahead[i], i.checked_sub(1))).hypot(side(behind[i], Some(i + 1)))
}

/// Blocks of 8 springs on either side that count in full: others are 7 springs or more from a block and two springs beside it.
const NEAR: usize = 1;
/// Blocks on either side beyond which, 15 springs or more, a step brings at most this much of a motion.
pub(crate) const FAR: usize = 2;
const FROM_AFAR: f64 = 4.41e-18;
/// Entry n: what a step at the largest phase brings of a motion from n springs away or more.
///
/// Motion between two instants is a mix f(X) of that at both, and polynomials in X of degrees under n bring nothing across n springs.
/// So what comes from there is at most what such a polynomial leaves of f over `0 <= x <= theta^2`: the rest of f's Chebyshev series from
/// n on. Power series of `cos(z theta/2) / cos(theta/2)` and of `sin(s theta) / sin(theta)` in x have no negative terms, and so
/// no Chebyshev series of them has; both ends' together are at most those of `1 / cos(theta/2)`, whose rests these are (S. N. Bernstein's
/// argument for functions of banded matrices: M. Benzi, G. H. Golub, *BIT* 39 (1999) 417-438).
const FROM_SPRINGS: [f64; SHELLS + 2] =
    [1.367, 0.196, 1.29e-2, 8.35e-4, 5.4e-5, 3.49e-6, 2.26e-7, 1.46e-8, 9.39e-10, 6.07e-11, 3.92e-12, 2.54e-13];
/// Springs beyond the next two whose motion is taken one by one.
const SHELLS: usize = 10;
/// Springs on either side of one that are taken one by one.
pub(super) const MARGIN: usize = SHELLS + 2;

/// Two bounds on norms of `h^2 G''` during a step, for `L` blocks side by side: over a block and two springs beside it on either side; and
/// over any of its springs and the next two, as far as it comes from more than [`SHELLS`] springs beyond these.
///
/// They follow from squared norms, each the larger one of the step's two ends: `around(n)` of the blocks from `FAR` before, n = 0, to
/// `FAR` behind, and `whole` of all blocks together.
#[inline(always)]
pub(super) fn local_norms<const L: usize>(around: impl Fn(usize) -> [f64; L], whole: [f64; L]) -> [[f64; L]; 2] {
    let (mut near, mut far) = ([0.0; L], [0.0; L]);
    for n in 0..=2 * FAR {
        let block = around(n);
        for l in 0..L {
            far[l] += block[l];
            near[l] += if n.abs_diff(FAR) <= NEAR { block[l] } else { 0.0 };
        }
    }
    let mut norms = [[0.0; L]; 2];
    for l in 0..L {
        let (near, far) = (near[l].sqrt(), far[l].sqrt());
        let afar = FROM_AFAR * (2.0 * whole[l]).sqrt();
        norms[0][l] = FROM_SPRINGS[0] * near + FROM_SPRINGS[7] * far + afar;
        norms[1][l] = FROM_SPRINGS[SHELLS + 1] * far + afar;
    }
    norms
}

/// Bounds on the norm of `h^2 G''` during a step over a spring and the next two on either side, `L` side by side: from its
/// `size(n) = |h^2 G''| / sqrt(k)` at both ends in the springs from `MARGIN` before, n = 0, to `MARGIN` behind, and the two bounds of
/// [`local_norms`].
#[inline(always)]
pub(super) fn norms_around<const L: usize>(
    size: impl Fn(usize) -> [[f64; L]; 2],
    [norm, mut beyond]: [[f64; L]; 2],
) -> [f64; L] {
    let more = |a: f64, b: f64| if a > b { a } else { b };
    let mut near = [[0.0; L]; 2];
    for place in 0..=2 * MARGIN {
        let size = size(place);
        let apart = place.abs_diff(MARGIN);
        for l in 0..L {
            if apart <= 2 {
                (0..2).for_each(|end| near[end][l] += size[end][l] * size[end][l]);
            } else {
                beyond[l] += FROM_SPRINGS[apart - 2] * more(size[0][l], size[1][l]);
            }
        }
    }
    let mut norms = norm;
    for l in 0..L {
        let narrow = FROM_SPRINGS[0] * more(near[0][l], near[1][l]).sqrt() + beyond[l];
        norms[l] = if narrow < norm[l] { narrow } else { norm[l] };
    }
    norms
}

/// The slope of Lidstone's second polynomial lies between minus this and 7 / 360.
const SLOPE_OF_SECOND: f64 = 8.0 / 360.0;
/// The second remainder's second derivative is that of the shorter series for `h^2 G''`, `5 / 384` of the same maximum, and the remainder
/// vanishes at both ends: its slope is at most half of that.
const SLOPE_OF_REMAINDER: f64 = 0.5 * (5.0 / 384.0) / (61.0 / 46_080.0);
/// A slope over a step under this share of the forces at its ends may be rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// How far a quick bound of a spring's force over a step passes what matters in either sign; negative if it does not.
///
/// `f` is G, `q` is `-h^2 G''` and `p` is `h^4 G''''` at both ends, `remainder` the second one. A force that certainly rises (or falls)
/// through the step has its largest value in the next (or previous) one, unless it may pass its rating ([`slopes`]).
#[inline(always)]
pub(crate) fn excess([f, q, p]: [[f64; 2]; 3], remainder: f64, level: [f64; 2], crossing: [f64; 2], last: bool) -> f64 {
    let more = |a: f64, b: f64| if a > b { a } else { b };
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let most = 0.125 * more(more(q[0], q[1]), 0.0) + SECOND * (more(p[0], 0.0) + more(p[1], 0.0)) + remainder;
    let least = 0.125 * less(less(q[0], q[1]), 0.0) + SECOND * (less(p[0], 0.0) + less(p[1], 0.0)) - remainder;
    let up = more(f[0], f[1]) + most - level[0];
    let down = -less(f[0], f[1]) - least - level[1];
    let rise = f[1] - f[0];
    let rounding = ROUNDING * more(f[0].abs(), f[1].abs());
    let slack = SLOPE_OF_SECOND * (p[0].abs() + p[1].abs()) + SLOPE_OF_REMAINDER * remainder + rounding;
    let steep = rise.abs() - 0.5 * more(q[0].abs(), q[1].abs()) > slack;
    let (rises, falls) = (steep & (rise > 0.0), steep & (rise < 0.0));
    let no_up = falls | (rises & !last & (f[1] <= crossing[0]));
    let no_down = rises | (falls & !last & (-f[1] <= crossing[1]));
    more(if no_up { -1.0 } else { up }, if no_down { -1.0 } else { down })
}

/// Whether any of these is positive.
#[inline(always)]
pub(crate) fn any_positive<const L: usize>(open: [f64; L]) -> bool {
    let mut any = false;
    for passed in open {
        any |= passed > 0.0;
    }
    any
}

/// Lower and upper bound of the largest value over a step, from `G`, `h^2 G''`, `h^4 G''''` at both ends and the remainder;
/// and where in the step the force reaches the lower one, from 0 to 1.
#[inline(always)]
pub(crate) fn bracket(ends: [[f64; 3]; 2], remainder: f64) -> [f64; 3] {
    brackets(ends, remainder)[0]
}

/// The same of G and of -G.
#[inline(always)]
pub(crate) fn brackets(ends: [[f64; 3]; 2], remainder: f64) -> [[f64; 3]; 2] {
    let [left, right] = ends;
    let rise = right[0] - left[0];
    // Slopes of the cubic that has these values and second derivatives.
    let slopes = [rise - left[1] / 3.0 - right[1] / 6.0, rise + left[1] / 6.0 + right[1] / 3.0];
    let [top, bottom] = hermite_extremes(1.0, [left[0], slopes[0]], [right[0], slopes[1]]);
    let second = |x: f64| x * (7.0 + x * x * (3.0 * x * x - 10.0)) / 360.0;
    let more = |a: f64, b: f64| if a > b { a } else { b };
    let of = |sign: f64, top: Point| {
        let [left, right] = ends.map(|end| end.map(|x| sign * x));
        let value = sign * top.value;
        let there = value + second(1.0 - top.at) * left[2] + second(top.at) * right[2] - remainder;
        let lower = more(more(there, left[0]), right[0]);
        let at = if there >= lower { top.at } else { f64::from(u8::from(right[0] >= lower)) };
        [lower, value + SECOND * (more(left[2], 0.0) + more(right[2], 0.0)) + remainder, at]
    };
    [of(1.0, top), of(-1.0, bottom)]
}

/// Bounds on the slope over a step, rounding included.
#[inline(always)]
pub(crate) fn slopes([left, right]: [[f64; 3]; 2], remainder: f64) -> [f64; 2] {
    let first = right[0] - left[0] - left[1] / 3.0 - right[1] / 6.0;
    let last = first + 0.5 * (left[1] + right[1]);
    let turns = (left[1] < 0.0) != (right[1] < 0.0);
    let between = first - 0.5 * left[1] * left[1] / (right[1] - left[1]);
    let between = if turns { between } else { first };
    let more = |a: f64, b: f64| if a > b { a } else { b };
    let less = |a: f64, b: f64| if a < b { a } else { b };
    let slack = SLOPE_OF_SECOND * (left[2].abs() + right[2].abs()) + SLOPE_OF_REMAINDER * remainder;
    let slack = slack + ROUNDING * more(left[0].abs(), right[0].abs());
    [less(less(first, last), between) - slack, more(more(first, last), between) + slack]
}

#[cfg(test)]
mod tests;
