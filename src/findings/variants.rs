//! The worst case of a scenario on a train that differs in one thing: how much its verdict depends on the couplers,
//! brakes and earlier loads in the file.

use rayon::prelude::*;
use serde::Serialize;

use super::case::Case;
use super::solved::Solved;
use super::{CaseFindings, Options, estimate, worst_case};
use crate::law::{Curve, Law};
use crate::scenario::is_proportional;
use crate::solve::responses::Shared;
use crate::solve::{SolveError, Wanted};
use crate::train::{Event, Response, Scenario, Train};

/// Damping ratios of a dashpot, c / (2 √(k m)): the range that is published for draft gears, and a value between.
const RATIOS: [f64; 3] = [0.05, 0.14, 0.26];

/// The longest that one variant may take by its estimate, s.
const MOST_SECONDS: f64 = 5.0;

/// The pull from which a train is let down, as a multiple of its load.
pub(crate) const LET_DOWN: f64 = 1.5;

/// Stiffness in series with [`Curve::generic_friction_gears`], N/m, and the slack of the second of their variants, m.
const GENERIC_SOLID_N_PER_M: f64 = 2e8;
pub(crate) const GENERIC_SLACK_M: f64 = 0.025;
/// Masses of vehicles that have such gears, kg.
const GENERIC_MASSES_KG: std::ops::RangeInclusive<f64> = 5e3..=4e5;

/// What was found of the worst case on the changed train.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Changed {
    /// Couplers that exceed their rating.
    pub exceeding: usize,
    /// The coupler of the largest utilisation, counted from 1.
    pub coupler: usize,
    /// Its force of the largest utilisation, N, draft positive.
    pub peak_force_n: f64,
    /// When, s after the event.
    pub peak_time_s: f64,
    /// |peak_force_n| over the rating in that sense.
    pub utilisation: f64,
    /// No force is further than this from the exact one, N; `None` where nothing is proven.
    pub error_bound_n: Option<f64>,
    /// An estimate of that, N, where nothing is proven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate_n: Option<f64>,
}

/// The worst case of a scenario, with dashpots of one damping ratio in every coupler.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DampingFindings {
    /// c / (2 √(k m)) of every coupler, k its stiffness and m the lighter of its vehicles that is not held.
    pub damping_ratio: f64,
    /// What was found.
    #[serde(flatten)]
    pub found: Changed,
}

/// The worst case of a scenario on a train with other couplers, without brakes, or with another load before.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariantFindings {
    /// What differs.
    pub variant: Variant,
    /// What was found.
    #[serde(flatten)]
    pub found: Changed,
}

/// What differs in a variant of a train.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Linear couplers without slack in place of the train's own, of the secant stiffness of loading at its largest load.
    LinearCouplers,
    /// No brakes that a parting sets off, and tractive efforts that do not change.
    WithoutBrakes,
    /// Let down to its load from 1.5 times that.
    LetDown,
    /// Generic friction gears in place of linear couplers.
    GenericGears,
    /// The same with slack.
    GenericGearsAndSlack,
}

impl Variant {
    const ALL: [Variant; 5] = [
        Variant::LinearCouplers,
        Variant::WithoutBrakes,
        Variant::LetDown,
        Variant::GenericGears,
        Variant::GenericGearsAndSlack,
    ];

    /// The changed train and scenario; `None` where nothing would change, or it does not fit this train.
    fn of(self, train: &Train, scenario: &Scenario) -> Option<(Train, Scenario)> {
        let with = |train: Train| Some((train, scenario.clone()));
        let has_laws = !train.extras().laws.is_empty();
        match self {
            Variant::LinearCouplers if has_laws => with(train.with_laws(vec![]).with_pulled_to(vec![])),
            Variant::WithoutBrakes if scenario.response != Response::default() => {
                let event = matches!(scenario.event, Event::Break { .. });
                event.then(|| (train.clone(), Scenario { response: Response::default(), ..scenario.clone() }))
            }
            Variant::LetDown
                if train.extras().laws.iter().any(Law::has_friction) && train.extras().pulled_to_n.is_empty() =>
            {
                let pulled_to_n = train.initial_force_n().iter().map(|f| LET_DOWN * f).collect::<Vec<f64>>();
                let is_pulled = pulled_to_n.iter().all(|f| *f >= 0.0) && pulled_to_n.iter().any(|f| *f > 0.0);
                is_pulled.then(|| with(train.with_pulled_to(pulled_to_n)))?
            }
            Variant::GenericGears | Variant::GenericGearsAndSlack if !has_laws && is_of_common_size(train) => {
                let slack_m = if self == Variant::GenericGears { 0.0 } else { GENERIC_SLACK_M };
                let laws = vec![generic_gears(slack_m); train.couplers().len()];
                with(train.with_laws(laws).with_dashpots(vec![]))
            }
            _ => None,
        }
    }
}

fn generic_gears(slack_m: f64) -> Law {
    let curve = Curve::generic_friction_gears();
    Law::Gear { solid_n_per_m: GENERIC_SOLID_N_PER_M, slack_m, draft: curve.clone(), buff: curve }
}

/// Whether generic gears fit: vehicles of the masses that have them, a load under their last row, no damping of the modes.
fn is_of_common_size(train: &Train) -> bool {
    let last_n = Curve::generic_friction_gears().closes_at_n();
    let masses = train.vehicles().iter().filter(|v| !v.held).all(|v| GENERIC_MASSES_KG.contains(&v.mass_kg));
    masses && train.initial_force_n().iter().all(|f| f.abs() < last_n) && train.extras().damping_ratio == 0.0
}

/// The variants that fit the train; none without a coupler to watch, and none that takes too long.
///
/// # Errors
/// As for a case.
pub(super) fn variants(
    train: &Train,
    scenario: &Scenario,
    cases: &[CaseFindings],
    options: &Options,
) -> Result<Vec<VariantFindings>, SolveError> {
    let Some((worst, _)) = worst_case(cases) else { return Ok(Vec::new()) };
    let one = |&variant: &Variant| {
        let (changed, scenario) = variant.of(train, scenario)?;
        let found = solved(&changed, &scenario, worst, options).transpose()?;
        Some(found.map(|found| VariantFindings { variant, found }))
    };
    Variant::ALL.par_iter().filter_map(one).collect()
}

/// The sweep over the damping ratios; empty for a train that has losses of its own, without a coupler to watch, or where it takes too
/// long.
///
/// # Errors
/// As for a case.
pub(super) fn damping(
    train: &Train,
    scenario: &Scenario,
    cases: &[CaseFindings],
    options: &Options,
) -> Result<Vec<DampingFindings>, SolveError> {
    let has_losses = train.extras().damping_ratio > 0.0 || !train.extras().dashpot_n_s_per_m.is_empty();
    let worst = worst_case(cases).filter(|_| !has_losses && is_proportional(train, scenario));
    let Some((worst, _)) = worst else { return Ok(Vec::new()) };
    let one = |&damping_ratio: &f64| {
        let critical = (0..train.couplers().len()).map(|i| critical_n_s_per_m(train, i));
        let dashpot_n_s_per_m = critical.map(|c| damping_ratio * c).collect();
        let damped = train.with_dashpots(dashpot_n_s_per_m);
        let found = solved(&damped, scenario, worst, options).transpose()?;
        Some(found.map(|found| DampingFindings { damping_ratio, found }))
    };
    RATIOS.par_iter().filter_map(one).collect()
}

/// The case on a changed train; `None` where that would take too long, or where no coupler is left to watch.
fn solved(
    train: &Train,
    scenario: &Scenario,
    worst: &CaseFindings,
    options: &Options,
) -> Result<Option<Changed>, SolveError> {
    let broken = worst.broken_coupler.map(|b| b - 1);
    let options = Options { method: None, wanted: Wanted::Everything, ..options.clone() };
    let case = Case::new(train, scenario, broken, &options, Shared::Nothing);
    if estimate::solved_s(train, scenario, broken, [case.horizon_s; 2], &options)? > MOST_SECONDS {
        return Ok(None);
    }
    let Solved { couplers, worst, error_bound_n, error_estimate_n, .. } = case.solve()?;
    let exceeding = couplers.iter().filter(|c| c.exceeds == Some(true)).count();
    Ok(worst.map(|i| &couplers[i]).map(|c| Changed {
        exceeding,
        coupler: c.coupler,
        peak_force_n: c.peak_force_n,
        peak_time_s: c.peak_time_s,
        utilisation: c.utilisation,
        error_bound_n: Some(error_bound_n).filter(|n| n.is_finite()),
        error_estimate_n,
    }))
}

/// Critical damping of a coupler between its lighter vehicle and a wall, 2 √(k m), N s/m; 0 between two held vehicles.
pub(crate) fn critical_n_s_per_m(train: &Train, coupler: usize) -> f64 {
    let live = [coupler, coupler + 1].into_iter().map(|v| &train.vehicles()[v]).filter(|v| !v.held);
    let mass = live.map(|v| v.mass_kg).fold(f64::INFINITY, f64::min);
    if mass.is_finite() { 2.0 * (train.couplers()[coupler].stiffness_n_per_m * mass).sqrt() } else { 0.0 }
}
