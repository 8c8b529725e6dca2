//! What an analysis says of a case, number by number, against the reference march.

use super::kinds::{Quantity, Tallies, kept, wanted, with_factor};
use super::trains::{Drawn, DrawnEvent, Kind, Rated, courses};
use trainsafe::accuracy::reference::Real;
use trainsafe::accuracy::reference::march::{March, System, long, march};
use trainsafe::findings::{CaseFindings, CouplerFindings, MapPoint};
use trainsafe::solve::Wanted;
use trainsafe::train::SENSES;

/// One scene's comparisons.
pub struct Judge<'a> {
    pub seed: u64,
    drawn: &'a Drawn,
    rated: &'a Rated,
    truth: &'a March,
    /// The largest force of each coupler in each sense.
    peaks: Vec<[Real; 2]>,
    /// Rounding of a load that is computed from forces on vehicles, N.
    load: f64,
    pub tallies: Tallies,
}

fn near(x: &Real) -> f64 {
    x.to_f64().value()
}

impl<'a> Judge<'a> {
    pub fn new(seed: u64, drawn: &'a Drawn, rated: &'a Rated, truth: &'a March) -> Judge<'a> {
        let couplers = 0..drawn.system.stiffness.len();
        let peaks = couplers.map(|i| [0, 1].map(|side| truth.largest(i, side, drawn.system.horizon).1)).collect();
        let load = 8.0 * f64::EPSILON * drawn.magnitude_n();
        Judge { seed, drawn, rated, truth, peaks, load, tallies: Tallies::new() }
    }

    /// Notes a comparison: an error that may be as large as its bound.
    fn compare(&mut self, quantity: Quantity, error: f64, bound: f64, what: impl Fn() -> String) {
        let tally = self.tallies.entry((self.drawn.kind, quantity)).or_default();
        tally.compared += 1;
        let share = if error <= 0.0 { 0.0 } else { error / bound };
        if share > tally.worst.0 {
            tally.worst = (share, self.seed);
        }
        if share.is_nan() || share > 1.0 {
            tally.wrong.push((self.seed, format!("{}: {}, error {error:e}, bound {bound:e}", quantity.name(), what())));
        }
    }

    /// Notes something that has no size.
    pub fn fail(&mut self, quantity: Quantity, what: String) {
        self.compare(quantity, 1.0, 0.0, || what.clone());
    }

    /// Notes a verdict on a force that is `over` a level by some way of so much.
    fn decide(
        &mut self,
        quantity: Quantity,
        claimed: Option<bool>,
        peak: &Real,
        level: f64,
        what: impl Fn() -> String,
    ) {
        let over = peak - long(level);
        let is_over = over > long(0.0);
        let blurred = near(&over).abs() <= self.load;
        let wrong = claimed.is_some_and(|claimed| claimed != is_over) && !blurred;
        self.compare(quantity, f64::from(u8::from(wrong)), 0.5, || {
            format!("{} claimed {claimed:?}, over by {:e}", what(), near(&over))
        });
        if claimed.is_none() {
            self.tallies.entry((self.drawn.kind, quantity)).or_default().undecided += 1;
        }
    }

    /// The forces before the event.
    pub fn loads(&mut self, initial_n: &[f64]) {
        if matches!(self.drawn.event, DrawnEvent::Impact(..)) || self.drawn.system.held != [false; 2] && self.load > 0.0
        {
            return;
        }
        for (i, claimed) in initial_n.iter().enumerate() {
            let error = near(&(long(*claimed) - &self.drawn.system.initial[i])).abs();
            self.compare(Quantity::Load, error, self.load, || format!("coupler {}: {claimed}", i + 1));
        }
    }

    /// All of a case but its cascade.
    pub fn case(&mut self, case: &CaseFindings) {
        for c in &case.couplers {
            self.peaks_of(c, case);
            self.verdicts(c, case);
        }
        self.safe_factor(case);
    }

    fn peaks_of(&mut self, c: &CouplerFindings, case: &CaseFindings) {
        let (i, bound, until) = (c.coupler - 1, case.error_bound_n + self.load, case.first_passage_s);
        let claims = [(c.peak_draft_n, c.peak_draft_time_s), (c.peak_buff_n.map(|f| -f), c.peak_buff_time_s)];
        let passage = c.first_passage.as_ref();
        let within = [passage.and_then(|p| p.peak_draft_n), passage.and_then(|p| p.peak_buff_n).map(|f| -f)];
        for (side, (claim, time)) in claims.into_iter().enumerate() {
            let due = self.peaks[i][side].clone();
            self.peak(Quantity::Peak, claim, &due, bound, [c.coupler, side]);
            let due = self.truth.largest(i, side, until).1;
            self.peak(Quantity::FirstPassage, within[side], &due, bound, [c.coupler, side]);
            if let (Some(claim), Some(t)) = (claim, time) {
                self.at(Quantity::Time, [i, side], t, claim, bound);
            }
        }
        if let Some(all_time) = c.all_time_bound_n {
            let largest = near(&self.peaks[i][0]).max(near(&self.peaks[i][1])) - self.load;
            let short = f64::from(u8::from(all_time < largest * (1.0 - f64::EPSILON)));
            self.compare(Quantity::AllTimeBound, short, 0.5, || {
                format!("coupler {}: {all_time} under {largest}", i + 1)
            });
        }
    }

    /// A largest force in one sense; none is one that is not over 0.
    fn peak(&mut self, quantity: Quantity, claim: Option<f64>, due: &Real, bound: f64, [coupler, side]: [usize; 2]) {
        let zero = long(0.0);
        let due = if *due > zero { due.clone() } else { zero };
        let error = near(&(long(claim.unwrap_or(0.0)) - &due)).abs();
        self.compare(quantity, error, bound, || {
            format!("coupler {coupler} {}: {claim:?} for {}", SENSES[side], near(&due))
        });
    }

    /// The force of a coupler in one sense at a time, which is itself rounded.
    fn at(&mut self, quantity: Quantity, [i, side]: [usize; 2], t: f64, claim: f64, bound: f64) {
        let Some((force, slope)) = self.truth.force(i, t) else {
            return self.fail(quantity, format!("no force at {t}"));
        };
        let sign = [1.0, -1.0][side];
        let error = near(&(long(sign * claim) - &force)).abs();
        let bound = bound + 4.0 * f64::EPSILON * t * slope.abs();
        self.compare(quantity, error, bound, || format!("coupler {} {}: {claim} at {t}", i + 1, SENSES[side]));
    }

    fn verdicts(&mut self, c: &CouplerFindings, case: &CaseFindings) {
        let i = c.coupler - 1;
        for side in [0, 1] {
            let due = self.peaks[i][side].clone();
            let what = || format!("coupler {} {}", c.coupler, SENSES[side]);
            self.decide(Quantity::Verdict, c.exceeds_in[side], &due, self.rated.rating[i][side], what);
        }
        for limit in c.limits.iter().flat_map(|l| &l.by_sense) {
            let due = self.peaks[i][usize::from(limit.sense != SENSES[0])].clone();
            let what = || format!("coupler {} {} {}", c.coupler, limit.limit, limit.sense);
            self.decide(Quantity::Limit, limit.passed, &due, limit.limit_n, what);
        }
        let claimed = c.first_exceeds_s;
        let late = claimed.unwrap_or(f64::INFINITY) * (1.0 - 8.0 * f64::EPSILON);
        for side in [0, 1] {
            let level = self.rated.rating[i][side] + 2.0 * (case.error_bound_n + self.load);
            // Where the couplers are not decided, nothing is said of the first time.
            let asked = self.peaks[i][side] > long(level) && c.exceeds_in[side].is_some();
            let first = if asked { self.truth.first_over(i, side, &long(level)) } else { None };
            let earlier = f64::from(u8::from(first.is_some_and(|t| t < late)));
            self.compare(Quantity::FirstExceedance, earlier, 0.5, || {
                format!("coupler {}: {claimed:?}, true {first:?}", c.coupler)
            });
        }
        if let (Some(t), Some(sense)) = (claimed.filter(|t| *t > 0.0), c.first_exceeds_in) {
            let side = usize::from(sense != SENSES[0]);
            let level = self.rated.rating[i][side];
            self.at(Quantity::FirstExceedance, [i, side], t, level, 2.0 * (case.error_bound_n + self.load));
        }
    }

    fn safe_factor(&mut self, case: &CaseFindings) {
        let found = case.safe_load_factor;
        if self.drawn.is_unbalanced() {
            let Some(factor) = found else { return self.fail(Quantity::SafeFactor, "none".to_owned()) };
            // Just below it none exceeds, and just above one does; a rating may be the load to its rounding.
            let least = self.rated.rating.iter().flatten().fold(f64::INFINITY, |least, r| least.min(*r));
            let room = (self.load + case.error_bound_n) / least;
            for (factor, due) in [(factor * (1.0 - 1e-7), false), (factor * (1.0 + 1e-7), true)] {
                let excess = self.excess(&kept(&with_factor(&self.drawn.system, factor)));
                let wrong = if due || factor == 0.0 { excess < -room } else { excess > room };
                self.compare(Quantity::SafeFactor, f64::from(u8::from(wrong)), 0.5, || format!("{factor}"));
            }
            return;
        }
        self.factor(Quantity::SafeFactor, found, &self.peaks.clone(), case.error_bound_n);
    }

    /// The largest share of a rating, less 1.
    fn excess(&self, motion: &March) -> f64 {
        let sides = (0..self.rated.rating.len()).flat_map(|i| [(i, 0), (i, 1)]);
        let over = sides.map(|(i, side)| {
            near(&(motion.largest(i, side, self.drawn.system.horizon).1 / long(self.rated.rating[i][side]))) - 1.0
        });
        over.fold(f64::NEG_INFINITY, f64::max)
    }

    /// A factor on a load or a force lies between those of peaks that are the bound higher and lower.
    fn factor(&mut self, quantity: Quantity, found: Option<f64>, peaks: &[[Real; 2]], bound: f64) {
        let [least, most] = self.factors(peaks, bound);
        let value = found.unwrap_or(f64::INFINITY);
        let wrong = value < least * (1.0 - 1e-13) || value > most * (1.0 + 1e-13);
        self.compare(quantity, f64::from(u8::from(wrong)), 0.5, || format!("{found:?}, not from {least} to {most}"));
    }

    /// The largest factors at which nothing exceeds, of peaks that are the bound higher and lower.
    fn factors(&self, peaks: &[[Real; 2]], bound: f64) -> [f64; 2] {
        let bound = bound + 2.0 * self.load;
        let (mut least, mut most) = (f64::INFINITY, f64::INFINITY);
        for (i, sides) in peaks.iter().enumerate() {
            for (side, peak) in sides.iter().enumerate() {
                let rest =
                    if self.is_load() { long(0.0) } else { &self.drawn.system.initial[i] * long([1.0, -1.0][side]) };
                let room = near(&(long(self.rated.rating[i][side]) - &rest));
                let growth = near(&(peak - &rest));
                if room < 0.0 {
                    (least, most) = (0.0, 0.0);
                } else if growth > -bound {
                    least = least.min(room / (growth + bound).max(0.0));
                    most = most.min(if growth > bound { room / (growth - bound) } else { f64::INFINITY });
                }
                // A load that is the rating but for its rounding may be taken to be over it.
                if !self.is_load() && self.load > 0.0 && room.abs() <= self.load {
                    least = 0.0;
                }
            }
        }
        [least, most]
    }

    /// The verdict alone: what is left out certainly does not exceed, and the rest is as in the full answer.
    pub fn verdict_only(&mut self, quick: &CaseFindings, full: &CaseFindings) {
        let quantity = Quantity::VerdictOnly;
        for c in &full.couplers {
            let i = c.coupler - 1;
            let over = |side: usize| near(&(&self.peaks[i][side] - long(self.rated.rating[i][side])));
            let side = usize::from(over(1) > over(0));
            let (due, level) = (self.peaks[i][side].clone(), self.rated.rating[i][side]);
            let left = quick.couplers.iter().find(|q| q.coupler == c.coupler);
            // A coupler that is left out is claimed not to exceed.
            let claimed = left.map_or(Some(false), |q| q.exceeds);
            self.decide(quantity, claimed, &due, level, || format!("coupler {}", c.coupler));
        }
        let open = full.undecided + quick.undecided > 0;
        let same = |a: usize, b: usize| open || a == b;
        // Where only the worst is asked for, others are not told of.
        let whole = wanted(self.seed) == Wanted::Everything;
        let counts = same(quick.exceeding, full.exceeding)
            && same(quick.exceeding_first_passage, full.exceeding_first_passage)
            && (!whole || quick.couplers.len() + quick.left_out == full.couplers.len());
        self.compare(quantity, f64::from(u8::from(!counts)), 0.5, || "counts of couplers".to_owned());
        if let Some(worst) = full.worst.as_ref().filter(|w| w.exceeds == Some(true)) {
            let told = quick.worst.as_ref().map_or(0.0, |w| w.utilisation);
            let rating = worst.rated_draft_n.min(worst.rated_buff_n);
            let error = (told - worst.utilisation).abs() * rating;
            self.compare(quantity, error, full.error_bound_n + quick.error_bound_n, || format!("worst {told}"));
        }
        let value = quick.safe_load_factor.unwrap_or(f64::INFINITY);
        let most = if self.drawn.is_unbalanced() {
            full.safe_load_factor.unwrap_or(f64::INFINITY)
        } else {
            self.factors(&self.peaks, full.error_bound_n + quick.error_bound_n)[1]
        };
        let wrong = value > most * (1.0 + 1e-13);
        self.compare(quantity, f64::from(u8::from(wrong)), 0.5, || format!("factor {value}, over {most}"));
    }

    fn is_load(&self) -> bool {
        matches!(self.drawn.event, DrawnEvent::Break(_))
    }

    /// A point of the map: the same event with another duration, or another coupler.
    pub fn map_point(&mut self, case: &CaseFindings, point: &MapPoint) {
        let mut system: System = self.drawn.system.clone();
        let mut unit = 1.0;
        match &self.drawn.event {
            DrawnEvent::Break(_) => system.broken = Some(point.at as usize - 1),
            DrawnEvent::Pulse(shape, _, force, ..) => {
                unit = *force;
                system.drive = courses(shape, *force, point.at, [0.0; 2]);
            }
            _ => return,
        }
        let motion = kept(&system);
        let sides = |i: usize| [0, 1].map(|side| motion.largest(i, side, system.horizon).1);
        let peaks: Vec<[Real; 2]> = (0..system.stiffness.len()).map(sides).collect();
        let bound = case.error_bound_n.max(case.tolerance_n);
        self.factor(Quantity::Map, point.chain.map(|n| n / unit), &peaks, bound);
    }

    /// What breaks, when and in which order.
    pub fn cascade(&mut self, case: &CaseFindings) {
        let Some(cascade) = &case.cascade else { return self.fail(Quantity::Break, "no cascade".to_owned()) };
        let both = self.drawn.kind == Kind::CascadeInBuff;
        let loads = |i: usize| [0, 1].map(|s| self.rated.limits[i].map_or(self.rated.rating[i][s], |l| l[s][2]));
        let never = |[draft, buff]: [f64; 2]| [draft, if both { buff } else { f64::INFINITY }];
        let breaks_at: Vec<[f64; 2]> = (0..self.rated.rating.len()).map(|i| never(loads(i))).collect();
        let truth = march(&self.drawn.system, &breaks_at);
        let certain = cascade.undecided_from_s.unwrap_or(f64::INFINITY);
        let mut left = truth.broke.clone();
        for b in cascade.breaks.iter().filter(|b| b.time_s + b.time_uncertainty_s < certain) {
            let Some(place) = left.iter().position(|t| t.coupler + 1 == b.coupler) else {
                self.fail(Quantity::Break, format!("coupler {} at {} never breaks", b.coupler, b.time_s));
                continue;
            };
            let due = left.remove(place);
            // Those that are told before it have broken before it, but for what cannot be told apart.
            let first = left.iter().map(|t| t.at).fold(f64::INFINITY, f64::min);
            let order = (due.at - first).max(0.0);
            let apart = 2.0 * b.time_uncertainty_s + 8.0 * f64::EPSILON * due.at;
            self.compare(Quantity::Break, order, apart, || {
                format!("coupler {} at {}, others at {first}", b.coupler, due.at)
            });
            let (error, apart) = ((b.time_s - due.at).abs(), b.time_uncertainty_s + 2.0 * f64::EPSILON * due.at);
            self.compare(Quantity::BreakTime, error, apart, || {
                format!("coupler {} at {} for {}", b.coupler, b.time_s, due.at)
            });
        }
        let missed: Vec<_> = left.iter().filter(|t| t.at < certain * (1.0 - 1e-12)).collect();
        let untold = f64::from(u8::from(
            !missed.is_empty() && !cascade.breaks.iter().any(|b| b.time_s + b.time_uncertainty_s >= certain),
        ));
        self.compare(Quantity::Break, untold, 0.5, || format!("not told: {missed:?}"));
        for i in 0..breaks_at.len() {
            let first = truth.first_over(i, 1, &long(loads(i)[1])).filter(|t| *t < certain);
            let claimed = cascade.kept_in_buff.contains(&(i + 1));
            let wrong = claimed && first.is_none();
            self.compare(Quantity::Break, f64::from(u8::from(wrong)), 0.5, || {
                format!("coupler {} kept in buff", i + 1)
            });
        }
        let open = usize::from(cascade.undecided_from_s.is_some());
        self.tallies.entry((self.drawn.kind, Quantity::Break)).or_default().undecided += open;
    }
}
