//! What an analysis found: utilisations, exceedances, safe load factors, in SI units, named as in `result.json`.

use serde::Serialize;

use crate::consist::Train;
use crate::solve::Method;

/// How an analysis is to be done.
#[derive(Clone, Debug)]
pub struct Options {
    /// The error each reported force may have, as a share of the train's largest rating. Default 1e-9.
    pub tolerance: f64,
    /// A method to use whatever it costs; `None` lets the planner choose.
    pub method: Option<Method>,
    /// Only this scenario, by its name; `None` runs all.
    pub scenario: Option<String>,
    /// Leave out couplers whose all-time bound lies under their rating.
    pub verdict_only: bool,
    /// Report the all-time bound of every coupler's force.
    pub all_time_bound: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options { tolerance: 1e-9, method: None, scenario: None, verdict_only: false, all_time_bound: false }
    }
}

/// All scenarios of one train.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// The train's name.
    pub train: String,
    /// Number of vehicles.
    pub vehicles: usize,
    /// Number of couplers.
    pub couplers: usize,
    /// One entry per scenario that was run, in the file's order.
    pub scenarios: Vec<ScenarioFindings>,
}

/// One scenario: a single event, or each coupler of a list in turn.
#[derive(Clone, Debug, Serialize)]
pub struct ScenarioFindings {
    /// The scenario's name.
    pub name: String,
    /// `"break"` or `"pulse"`.
    pub kind: &'static str,
    /// One per broken coupler, or one for a pulse.
    pub cases: Vec<CaseFindings>,
}

/// What one event does to every coupler.
#[derive(Clone, Debug, Serialize)]
pub struct CaseFindings {
    /// The coupler that breaks, counted from 1; `None` for a pulse.
    pub broken_coupler: Option<usize>,
    /// The method that found the largest part's forces.
    pub method: &'static str,
    /// Why this method, in one sentence.
    pub method_reason: String,
    /// How long forces were followed, s.
    pub horizon_s: f64,
    /// No reported force is further than this from the exact solution of the model, N.
    pub error_bound_n: f64,
    /// The error that was asked for, N.
    pub tolerance_n: f64,
    /// Time spent computing this case, s.
    pub run_time_s: f64,
    /// Couplers that exceed their rating; the broken one is not counted.
    pub exceeding: usize,
    /// Couplers whose rating lies within the error bound of their peak.
    pub undecided: usize,
    /// Largest factor on the load (break) or on the pulse's force at which no coupler exceeds; `None` where none bounds it.
    pub safe_load_factor: Option<f64>,
    /// The coupler with the largest utilisation; `None` where no coupler is left.
    pub worst: Option<CouplerFindings>,
    /// Every coupler but the broken one, from the head.
    pub couplers: Vec<CouplerFindings>,
    /// Couplers left out because their all-time bound is under their rating (only with `verdict_only`).
    pub left_out: usize,
    /// What an elastic rod would have said; equal-mass trains only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rod: Option<RodFindings>,
}

/// One coupler's largest forces over 0 <= t <= horizon, t = 0 included.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CouplerFindings {
    /// Counted from 1 at the head.
    pub coupler: usize,
    /// Labels of the vehicles it joins.
    pub between: [String; 2],
    /// Capacity in tension, N.
    pub rated_draft_n: f64,
    /// Capacity in compression, N, positive.
    pub rated_buff_n: f64,
    /// Force before the event, N.
    pub initial_force_n: f64,
    /// The force of the largest utilisation, N, draft positive.
    pub peak_force_n: f64,
    /// When, s after the event.
    pub peak_time_s: f64,
    /// |peak_force_n| over the rating in that sign.
    pub utilisation: f64,
    /// Largest tension, N; `None` if it is never in tension.
    pub peak_draft_n: Option<f64>,
    /// When, s.
    pub peak_draft_time_s: Option<f64>,
    /// Largest compression, N, negative; `None` if it is never in compression.
    pub peak_buff_n: Option<f64>,
    /// When, s.
    pub peak_buff_time_s: Option<f64>,
    /// Over its rating in either sign; `None`: not decided, the rating lies within the error bound of the peak.
    pub exceeds: Option<bool>,
    /// The first time it is over its rating, s.
    pub first_exceeds_s: Option<f64>,
    /// Bound on |force| over all time, N, where asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub all_time_bound_n: Option<f64>,
}

/// What the continuum model says of the same case.
#[derive(Clone, Debug, Serialize)]
pub struct RodFindings {
    /// Couplers over their rating in the elastic rod.
    pub exceeding: usize,
    /// The rod's largest utilisation.
    pub utilisation: f64,
}
