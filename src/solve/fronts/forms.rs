//! A front's shape to a few digits, at any distance behind the source, in a time that does not grow with the distance.
//!
//! The front that has gone d springs brings, in units of the force and with x = 2t, nu = 2d,
//!
//! ```text
//! P(nu, x) = E_d + E_{d+1} = nu ∫_0^x J_nu(s) / s ds,     dP/dt = 2 nu J_nu(x) / x
//! ```
//!
//! | where | form |
//! | --- | --- |
//! | x < 64 | a table of exact values, cubic between them |
//! | x < nu - 6.5 nu^(1/3) | zero |
//! | up to nu + 9 nu^(1/3) | uniform: `∫_xi^∞ Ai + nu^(-2/3) a_0 Ai'(xi) + nu^(-4/3) b_0 Ai(xi)`, xi = nu^(2/3) zeta(x / nu) |
//! | behind | Debye's form, two corrections |
//!
//! zeta and phi are those of the Bessel functions' uniform expansion (F. W. J. Olver, *Phil. Trans. R. Soc. A* 247 (1954)
//! 328-368; DLMF 10.20); a_0 and b_0 follow by putting the form and its derivative into that expansion:
//! `a_0 = (1 - phi^3 / 2) / zeta`, `b_0 = -(phi^3 / 2) B_0 - d a_0 / d zeta`. All are polynomials in y = (x - nu) / (x + nu) here,
//! fitted on |y| <= 0.3; the arctangent in Debye's form is one in y (`tests/reference/front_forms.py`).
//!
//! These forms locate extremes; no force that is reported comes from them. Their assumed errors
//! ([`Sums::error_estimate`]) are not proved: they are twice the largest found or more (the test below measures them
//! again).

use std::sync::OnceLock;

use super::rows;

/// Assumed largest error of the table.
const TABLE_ERROR: f64 = 1e-5;
/// The same of the uniform form: this over nu^2; of Debye's form: this over psi^3; and of fits and sines.
const UNIFORM_ERROR: f64 = 0.02;
const DEBYE_ERROR: f64 = 0.4;
const LEAST_ERROR: f64 = 5e-7;
/// A front counts as zero while x is this many nu^(1/3) or more under nu; it is under [`UNSEEN`] of the force there.
pub const AHEAD: f64 = 6.5;
pub const UNSEEN: f64 = 2e-8;
/// The uniform form is used up to this many nu^(1/3) behind nu, and to this y.
const BEHIND: f64 = 9.0;
const LARGEST_Y: f64 = 0.3;
/// The early table reaches to this x.
const EARLY: f64 = 64.0;
/// Rows of the early table in a unit of time.
const EARLY_ROWS: f64 = 16.0;
/// Instants side by side.
pub const LANES: usize = 8;

/// `zeta / y`
const ZETA: [f64; 12] = [
    -2.519_842_099_546_073_7,
    -1.007_936_838_521_823,
    -1.339_116_280_724_640_6,
    -0.858_826_613_640_187_2,
    -1.050_532_540_341_944_8,
    -0.772_256_290_486_256,
    -0.907_879_513_385_395_6,
    -0.714_573_899_724_184_3,
    -0.792_364_629_867_264_5,
    -0.643_644_145_912_362_3,
    -0.978_512_914_925_943_8,
    -0.847_534_023_731_523_4,
];
/// `phi nu / x`
const PHI: [f64; 9] = [
    1.259_921_105_647_368_3,
    -3.023_799_738_205_284_4,
    3.455_752_792_448_531_6,
    -3.492_556_032_504_049,
    3.576_552_508_287_348,
    -3.542_544_477_715_820_6,
    3.564_247_873_823_18,
    -4.537_625_002_786_505_5,
    4.677_760_430_516_123,
];
/// `a_0`
const A0: [f64; 7] = [
    -0.476_220_317_769_679_05,
    0.312_945_273_552_790_17,
    0.055_635_395_327_608_33,
    0.024_770_692_245_849_116,
    0.013_029_280_405_996_395,
    0.010_911_109_170_662_858,
    0.006_865_817_135_113_728,
];
/// `b_0`
const B0: [f64; 5] = [
    0.106_193_282_909_578_59,
    -0.011_225_221_250_299_89,
    -0.158_081_114_966_286_6,
    0.049_650_341_789_651_775,
    -0.001_143_045_109_768_411_5,
];
/// Olver's B_0.
const J1: [f64; 5] = [
    0.017_998_867_670_791_08,
    -0.022_400_301_166_207_587,
    0.001_363_912_770_644_076_2,
    0.002_257_761_222_212_101,
    -0.000_220_520_618_664_339,
];
/// `arctan u / u`, as powers of u^2, for 0 <= u <= 1: to 4e-14.
const ARCTAN: [f64; 16] = [
    0.999_999_999_999_959_7,
    -0.333_333_333_312_175_8,
    0.199_999_998_148_974_54,
    -0.142_857_078_526_261_4,
    0.111_109_929_758_248_77,
    -0.090_895_867_830_801_24,
    0.076_824_893_465_226_72,
    -0.066_155_666_414_885_74,
    0.056_886_643_218_922_74,
    -0.047_130_745_595_821_213,
    0.035_636_520_771_333_38,
    -0.022_994_749_256_908_153,
    0.011_746_429_010_568_394,
    -0.004_344_643_015_423_943,
    0.001_018_269_736_065_282_5,
    -0.000_112_436_759_602_791_07,
];

/// A front on its way.
#[derive(Clone, Copy, Debug)]
pub struct Front {
    /// nu, nu^(1/3), and nu^(-2/3).
    pub order: f64,
    pub root: f64,
    inverse: f64,
    /// Where the bound on its fourth derivative is largest.
    steepest: f64,
    /// The x up to which the front counts as zero, and from which Debye's form is used.
    ahead: f64,
    behind: f64,
}

impl Front {
    /// The front of order nu, with nu^(1/3).
    pub fn new(order: f64, root: f64) -> Front {
        let behind = (order + BEHIND * root).min(order * ((1.0 + LARGEST_Y) / (1.0 - LARGEST_Y)));
        let steepest = (order * (order - 4.0 * root).max(0.0) * (1.0 / 0.375)).sqrt();
        Front { order, root, inverse: 1.0 / (root * root), steepest, ahead: (order - AHEAD * root).max(0.0), behind }
    }
}

/// Sums of fronts at some instants.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    /// Of P.
    pub value: Lanes,
    /// Of dP/dt.
    pub slope: Lanes,
    /// Bound on the fourth derivative in time from the first instant to a unit of time after the last ([`fourth_derivative`]).
    pub fourth: f64,
    /// Assumed largest error of values and slopes.
    pub error_estimate: f64,
}

impl Sums {
    /// Adds a front, `size` times, at ascending x. Returns whether it has arrived at any of the instants.
    #[inline(always)]
    pub fn add(&mut self, front: &Front, size: f64, x: &Lanes) -> bool {
        let &Front { order, root, inverse, steepest, ahead, behind } = front;
        let [first, last] = [x[0], x[LANES - 1]];
        if last <= ahead {
            return false;
        }
        let (mut value, mut slope) = ([0.0; LANES], [0.0; LANES]);
        let mut error_estimate = 0.0f64;
        if first < behind && last >= EARLY {
            [value, slope] = uniform(front, &lanes(|l| x[l].min(behind).max(ahead)));
            error_estimate = LEAST_ERROR + UNIFORM_ERROR * inverse * inverse * inverse;
        }
        if last >= behind && last >= EARLY {
            let ([far, far_slope], error) = debye(order, &lanes(|l| x[l].max(behind)));
            value = lanes(|l| if x[l] < behind { value[l] } else { far[l] });
            slope = lanes(|l| if x[l] < behind { slope[l] } else { far_slope[l] });
            error_estimate = error_estimate.max(error);
        }
        if first < EARLY {
            for l in 0..LANES {
                if x[l] < EARLY {
                    [value[l], slope[l]] = early(order, x[l]);
                }
            }
            error_estimate = error_estimate.max(TABLE_ERROR);
        }
        for l in 0..LANES {
            let arrived = if x[l] > ahead { size } else { 0.0 };
            self.value[l] += arrived * value[l];
            self.slope[l] += arrived * slope[l];
        }
        self.fourth += size.abs() * fourth_derivative(order, root, steepest.max(first).min(last));
        self.error_estimate += size.abs() * error_estimate;
        true
    }
}

/// Bound on a front's fourth derivative in time from x to x + 2: sqrt(2 / pi) 16 nu w^(5/2) / x^4, w^2 = x^2 - nu^2, is its size far
/// behind the front. With 4 nu^(4/3) more in w^2, x at least nu, and 5 % more, it is over all values found
/// (`tests/reference/front_forms.py`): not proved.
#[inline(always)]
pub fn fourth_derivative(order: f64, root: f64, x: f64) -> f64 {
    let x = x.max(order);
    let square = (x - order) * (x + order) + 4.0 * order * root;
    13.4 * order * square * square.sqrt().sqrt() / (x * x * x * x)
}

/// Numbers that are worked on side by side.
pub type Lanes = [f64; LANES];

/// One number of each lane.
#[inline(always)]
pub fn lanes(f: impl Fn(usize) -> f64) -> Lanes {
    let mut out = [0.0; LANES];
    for (l, o) in out.iter_mut().enumerate() {
        *o = f(l);
    }
    out
}

#[inline(always)]
fn polynomial<const N: usize>(coefficient: &[f64; N], y: &Lanes) -> Lanes {
    let mut sum = [coefficient[N - 1]; LANES];
    for &c in coefficient[..N - 1].iter().rev() {
        for l in 0..LANES {
            sum[l] = sum[l].mul_add(y[l], c);
        }
    }
    sum
}

/// Value and slope around the front.
#[inline(always)]
fn uniform(&Front { order, root, inverse, .. }: &Front, x: &Lanes) -> [Lanes; 2] {
    let airy = airy();
    let y = lanes(|l| (x[l] - order) / (x[l] + order));
    let zeta = polynomial(&ZETA, &y);
    let xi = lanes(|l| y[l] * zeta[l] * (root * root));
    // Adding this, a number is rounded, and its last bits are the place of its node.
    const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
    let rounded = lanes(|l| (xi[l] - FIRST).mul_add(NODES, ROUND));
    let node = lanes(|l| (rounded[l] - ROUND).mul_add(1.0 / NODES, FIRST));
    let (mut ai, mut slope, mut integral) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        [ai[l], slope[l], integral[l], _] = airy[rounded[l].to_bits() as usize % TABLE];
    }
    let (phi, a0, b0, j1) = (polynomial(&PHI, &y), polynomial(&A0, &y), polynomial(&B0, &y), polynomial(&J1, &y));
    let (mut value, mut rate) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let (z, d) = (node[l], xi[l] - node[l]);
        let (c0, c1) = (ai[l], slope[l]);
        let c2 = z * c0 * (1.0 / 2.0);
        let c3 = z.mul_add(c1, c0) * (1.0 / 6.0);
        let c4 = z.mul_add(c2, c1) * (1.0 / 12.0);
        let c5 = z.mul_add(c3, c2) * (1.0 / 20.0);
        let here = horner(d, [c0, c1, c2, c3, c4, c5]);
        let prime = horner(d, [c1, 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5]);
        let series = [c0, c1 * (1.0 / 2.0), c2 * (1.0 / 3.0), c3 * (1.0 / 4.0), c4 * (1.0 / 5.0), c5 * (1.0 / 6.0)];
        let behind = integral[l] - d * horner(d, series);
        value[l] = behind + inverse * (a0[l] * prime + inverse * b0[l] * here);
        rate[l] = 2.0 * phi[l] * (root * inverse) * (here + inverse * inverse * j1[l] * prime);
    }
    [value, rate]
}

/// A polynomial, lowest power first.
#[inline(always)]
fn horner<const N: usize>(x: f64, coefficient: [f64; N]) -> f64 {
    coefficient.iter().rev().fold(0.0, |sum: f64, c| sum.mul_add(x, *c))
}

/// Value and slope far behind the front, and their error; where it swings about 1: with w = sqrt(x^2 - nu^2), c = nu / w and
/// psi = w - nu acos(nu / x) - pi / 4
///
/// ```text
/// J = sqrt(2 / (pi w)) [cos psi (1 + e2) + sin psi e1]
/// e1 = (3 + 5 c^2) / (24 w),  e2 = -(81 + 462 c^2 + 385 c^4) / (1152 w^2)
/// P = 1 + sqrt(2 / (pi w)) c [sin psi (1 + q2) + cos psi q1]
/// ```
///
/// with q1 and q2 from dP/dx = nu J / x, order by order.
#[inline(always)]
fn debye(order: f64, x: &Lanes) -> ([Lanes; 2], f64) {
    let v = lanes(|l| (x[l] - order) / (x[l] + order));
    let u = lanes(|l| v[l].sqrt());
    let w = lanes(|l| u[l] * (x[l] + order));
    let angle = polynomial(&ARCTAN, &v);
    let psi = lanes(|l| w[l] - 2.0 * order * u[l] * angle[l] - std::f64::consts::FRAC_PI_4);
    let [sin, cos] = sine_and_cosine(&psi);
    let (mut value, mut rate) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let of_both = 1.0 / (w[l] * x[l]);
        let inverse = of_both * x[l];
        let c = order * inverse;
        let (cc, ii) = (c * c, inverse * inverse);
        let size = (std::f64::consts::FRAC_2_PI * inverse).sqrt();
        let e1 = cc.mul_add(5.0 / 24.0, 3.0 / 24.0) * inverse;
        let e2 = -cc.mul_add(cc.mul_add(385.0 / 1152.0, 462.0 / 1152.0), 81.0 / 1152.0) * ii;
        let square = x[l] * x[l] * ii;
        let q1 = -e1 - 1.5 * square * inverse;
        let q2 = e2 - square * ii * cc.mul_add(41.0 / 8.0, 39.0 / 24.0) + 1.5 * square * inverse * q1;
        value[l] = 1.0 + size * c * (sin[l] * (1.0 + q2) + cos[l] * q1);
        rate[l] = 2.0 * order * of_both * w[l] * size * (cos[l] * (1.0 + e2) + sin[l] * e1);
    }
    ([value, rate], LEAST_ERROR + DEBYE_ERROR / (psi[0] * psi[0] * psi[0]))
}

/// Sine and cosine, to 1e-7.
#[inline(always)]
fn sine_and_cosine(psi: &Lanes) -> [Lanes; 2] {
    let (mut sin, mut cos) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let turns = (psi[l] * std::f64::consts::FRAC_1_PI).round_ties_even();
        let r = psi[l] - turns * std::f64::consts::PI;
        let half = 0.5 * turns;
        let sign = 1.0 - 4.0 * (half - half.floor());
        let v = -r * r;
        let s = r * horner(v, [1.0, 1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0, 1.0 / 362_880.0, 1.0 / 39_916_800.0]);
        let cosine = [1.0, 1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40_320.0, 1.0 / 3_628_800.0, 1.0 / 479_001_600.0];
        let c = horner(v, cosine);
        (sin[l], cos[l]) = (sign * s, sign * c);
    }
    [sin, cos]
}

/// First node of the table of Airy functions, nodes in a unit, the last that is not zero, and how many there are.
const FIRST: f64 = -14.0;
const NODES: f64 = 8.0;
const LAST: f64 = 10.0;
const TABLE: usize = 256;

/// Ai, Ai' and the integral of Ai from there on, at the nodes.
#[inline(always)]
fn airy() -> &'static [[f64; 4]; TABLE] {
    static AIRY: OnceLock<[[f64; 4]; TABLE]> = OnceLock::new();
    AIRY.get_or_init(|| {
        let mut table = [[0.0; 4]; TABLE];
        let zero = (-FIRST * NODES) as usize;
        // Ai(0), Ai'(0), and a third: DLMF 9.2.3, 9.2.4, 9.10.11.
        table[zero] = [0.355_028_053_887_817_2, -0.258_819_403_792_806_8, 1.0 / 3.0, 0.0];
        for k in (0..zero).rev() {
            table[k] = airy_step(FIRST + (k + 1) as f64 / NODES, table[k + 1], -1.0 / NODES);
        }
        for k in zero + 1..=((LAST - FIRST) * NODES) as usize {
            table[k] = airy_step(FIRST + (k - 1) as f64 / NODES, table[k - 1], 1.0 / NODES);
        }
        table
    })
}

/// From one node to another by the Taylor series of Ai'' = z Ai.
fn airy_step(z: f64, [ai, slope, integral, _]: [f64; 4], d: f64) -> [f64; 4] {
    let mut c = [0.0; 24];
    (c[0], c[1], c[2]) = (ai, slope, 0.5 * z * ai);
    for k in 3..24 {
        c[k] = (z * c[k - 2] + c[k - 3]) / (k * (k - 1)) as f64;
    }
    let sum = |term: &dyn Fn(usize) -> f64| (0..24).rev().fold(0.0, |s, k| s * d + term(k));
    let rate = (1..24).rev().fold(0.0, |s, k| s * d + k as f64 * c[k]);
    [sum(&|k| c[k]), rate, integral - d * sum(&|k| c[k] / (k + 1) as f64), 0.0]
}

/// Value and slope while x < 64.
fn early(order: f64, x: f64) -> [f64; 2] {
    static TABLE: OnceLock<Vec<Vec<[f64; 2]>>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let rows = (0.5 * EARLY * EARLY_ROWS) as usize + 2;
        (0..rows).map(|k| rows::values_and_slopes(k as f64 / EARLY_ROWS)).collect()
    });
    if x <= 0.0 {
        return [0.0; 2];
    }
    let (distance, place) = ((0.5 * order) as usize, 0.5 * x * EARLY_ROWS);
    let row = place as usize;
    let [[a, da], [b, db]] = [row, row + 1].map(|k| table[k].get(distance).copied().unwrap_or_default());
    let (s, h) = (place - row as f64, 1.0 / EARLY_ROWS);
    let (rise, p, q) = (b - a, h * da, h * db);
    let (c2, c3) = (3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise);
    [a + s * (p + s * (c2 + s * c3)), (p + s * (2.0 * c2 + s * 3.0 * c3)) / h]
}

#[cfg(test)]
mod tests;
