//! Gaps where couplers broke: how far apart the two vehicles are, and when they meet.
//!
//! ```text
//! q = F / k at the break       q' = v_i - v_{i+1}       (q: distance of the vehicles beyond that of the unloaded coupler)
//! ```
//!
//! A gap is closed where q < 0. Then the vehicles would push each other, which is not in these equations: from then on
//! the motion is not the train's.
//!
//! After the break of one coupler that carries the draft F_b, and nothing more, its gap never closes, whatever the masses,
//! springs and dampers: against the steady motion the front part is driven by the constant force F_b on its last vehicle, at
//! displacement x, and by nothing else. That force has done the work F_b x(t), which the part has stored or lost,
//! so that F_b x(t) >= 0 at every instant; likewise for the rear part, whose first vehicle is driven by -F_b. Both vehicles are
//! therefore never nearer than at the break. So only couplers that break in buff, for which q < 0 from the start, and several
//! breaks, or breaks under other forces, can close a gap.

use super::DEGREE;
use super::series::{Series, centred, reach};

/// The gaps so far.
#[derive(Debug, Default)]
pub struct Gaps {
    /// Spring and opening.
    open: Vec<(usize, f64)>,
    /// The first that closed, and when.
    pub closes: Option<(usize, f64)>,
}

impl Gaps {
    /// A spring with this elongation breaks at a time; `error` bounds the elongation's error.
    pub fn add(&mut self, spring: usize, elongation: f64, time: f64, error: f64) {
        if elongation < -error {
            self.closes.get_or_insert((spring, time));
        }
        self.open.push((spring, elongation));
    }

    /// Follows every gap over a share of a step; `error` bounds that of the opening of a spring's gap.
    pub fn follow(&mut self, series: &Series, from: f64, width: f64, share: f64, error: impl Fn(usize) -> f64) {
        if self.closes.is_some() {
            return;
        }
        let mut first: Option<(usize, f64)> = None;
        for (spring, opening) in &mut self.open {
            let apart = series.apart(*spring);
            let closed: [f64; DEGREE + 1] = std::array::from_fn(|k| match k {
                0 => -*opening,
                _ => -apart[k - 1] * width / k as f64,
            });
            let error = error(*spring);
            if reach(&closed, 1.0) > error {
                let at = centred(&closed, from, width).first_over(-1.0, 2.0 * share - 1.0, error);
                let at = at.map(|x| (*spring, from + 0.5 * (x + 1.0) * width));
                first = first.into_iter().chain(at).reduce(|a, b| if b.1 < a.1 { b } else { a });
            }
            *opening = -closed.iter().rev().fold(0.0, |sum, c| sum * share + c);
        }
        self.closes = first;
    }
}
