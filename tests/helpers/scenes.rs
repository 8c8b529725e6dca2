//! Scenes with references to 30 digits and more, and how a solution is held against them.

// Each test file uses its own part of this one.
#![allow(dead_code)]

use serde::Deserialize;
use serde::de::{Deserializer, Error};
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::observers::{self, MarchAsk};
use trainsafe::solve::sums::Modes;
use trainsafe::solve::watch::SpringPeaks;
use trainsafe::solve::{Ask, Method, Wanted, closed_form, fronts, modal, propagator, solve, sums};

/// The share of the largest rating that a force may be off by.
pub const TOLERANCE: f64 = 1e-9;

/// Everything, in scenes in units of their own forces.
pub const EVERYTHING: Ask = Ask {
    tolerance: TOLERANCE,
    method: None,
    verdict_only: false,
    all_time_bound: false,
    wanted: Wanted::Everything,
    mark: None,
};

/// The nearest `f64` to a decimal of many digits.
#[derive(Clone, Copy, Debug)]
pub struct Digits(pub f64);

impl<'de> Deserialize<'de> for Digits {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Digits, D::Error> {
        String::deserialize(from)?.parse().map(Digits).map_err(D::Error::custom)
    }
}

/// One sign of one spring's force.
#[derive(Debug, Deserialize)]
pub struct SideReference {
    /// Largest value of F (draft) or -F (buff).
    pub peak: Digits,
    /// How much larger the peak may be: swings too fast and small to follow.
    pub uncertainty: Option<Digits>,
    /// When.
    pub time: Digits,
    /// First time over the rating.
    pub first_over: Option<Digits>,
    /// Slope of the force then.
    pub slope: Option<Digits>,
}

/// Both signs of one spring's force.
#[derive(Debug, Deserialize)]
pub struct SpringReference {
    /// Its index.
    pub spring: usize,
    /// F.
    pub draft: SideReference,
    /// -F.
    pub buff: SideReference,
}

/// Every spring's force at one time.
#[derive(Debug, Deserialize)]
pub struct Values {
    /// The time.
    pub time: f64,
    /// The forces.
    pub force: Vec<Digits>,
}

/// A scene and what it leads to.
#[derive(Debug, Deserialize)]
pub struct Reference {
    /// What it is.
    pub name: String,
    mass: Vec<f64>,
    stiffness: Vec<f64>,
    held_head: bool,
    held_tail: bool,
    source: usize,
    force: f64,
    duration: Option<f64>,
    initial: Vec<f64>,
    rated_draft: Vec<f64>,
    rated_buff: Vec<f64>,
    horizon: f64,
    /// Forces at a few times.
    pub values: Vec<Values>,
    /// Extremes.
    pub springs: Vec<SpringReference>,
}

impl Reference {
    /// The scene.
    pub fn scene(&self) -> Scene {
        Scene {
            chain: Chain {
                mass: self.mass.clone(),
                stiffness: self.stiffness.clone(),
                held_head: self.held_head,
                held_tail: self.held_tail,
            },
            source: self.source,
            force: self.force,
            duration: self.duration.unwrap_or(f64::INFINITY),
            initial: self.initial.clone(),
            rated_draft: self.rated_draft.clone(),
            rated_buff: self.rated_buff.clone(),
            horizon: self.horizon,
        }
    }
}

/// The references of one data file.
pub fn references(json: &str) -> Vec<Reference> {
    serde_json::from_str(json).expect("reference data")
}

/// What one method says of a scene.
pub struct Found {
    /// The method.
    pub method: Method,
    /// Its extremes.
    pub springs: Vec<SpringPeaks>,
    /// Its claim.
    pub bound: f64,
}

/// A step of the propagator costs a thousand operations per spring; a test affords this many springs x steps.
const AFFORDABLE: f64 = 2e5;

/// Every transit adds images to every sum over fronts: the method is for the first few.
const MANY_TRANSITS: f64 = 40.0;

/// The largest rating of a scene.
pub fn rating(scene: &Scene) -> f64 {
    scene.rated_draft.iter().chain(&scene.rated_buff).fold(0.0, |a, &r| a.max(r))
}

/// Extremes by one method; `None` if it is not for this scene.
pub fn by(method: Method, scene: &Scene) -> Option<Found> {
    let springs = scene.initial.len() as f64;
    let (springs, bound) = match method {
        Method::Fronts if fronts::fits(scene) && fronts::passing(scene) < MANY_TRANSITS => {
            (fronts::peaks(scene).0, fronts::error_bound(scene))
        }
        Method::Propagator => {
            let omega = propagator::omega_max(scene);
            if propagator::steps(scene, omega) * springs > AFFORDABLE {
                return None;
            }
            (observers::peaks(&[MarchAsk::all(scene, omega)])[0].0[0].clone(), propagator::error_bound(scene, omega))
        }
        Method::Modal => solved(scene, Method::Modal),
        _ => return None,
    };
    Some(Found { method, springs, bound })
}

fn solved(scene: &Scene, method: Method) -> (Vec<SpringPeaks>, f64) {
    let ask = Ask { tolerance: TOLERANCE * rating(scene), method: Some(method), ..Ask::default() };
    let solution = solve(scene, &ask).expect("a method that fits");
    (solution.springs.into_iter().map(|s| s.expect("no spring left out")).collect(), solution.error_bound)
}

/// Extremes by every method that is for this scene.
pub fn by_all(scene: &Scene) -> Vec<Found> {
    [Method::Fronts, Method::Modal, Method::Propagator].into_iter().filter_map(|m| by(m, scene)).collect()
}

/// Forces of every spring at one time, by every method that gives histories, with the method's claim.
pub fn forces_at(scene: &Scene, time: f64) -> Vec<(Method, Vec<f64>, f64)> {
    forces_by_closed_form(scene, time)
        .into_iter()
        .chain([forces_by(Method::Modal, scene, &modal::modes(scene), time)])
        .collect()
}

/// The same by the paper's sums, where they apply.
pub fn forces_by_closed_form(scene: &Scene, time: f64) -> Option<(Method, Vec<f64>, f64)> {
    closed_form::modes(scene).map(|modes| forces_by(Method::Modal, scene, &modes, time))
}

fn forces_by(method: Method, scene: &Scene, modes: &Modes, time: f64) -> (Method, Vec<f64>, f64) {
    let forces = (0..scene.initial.len()).map(|i| sums::history(scene, modes, i, &[time])[0]).collect();
    (method, forces, sums::error_bound(scene, modes))
}

/// Everything in which a solution departs from its reference, in words; empty when all is well.
pub fn departures(reference: &Reference, scene: &Scene, found: &Found) -> Vec<String> {
    let largest = rating(scene);
    let label = format!("{} [{}]", reference.name, found.method.name());
    let mut out = Vec::new();
    for spring in &reference.springs {
        for (negative, side) in [(false, &spring.draft), (true, &spring.buff)] {
            let got = found.springs[spring.spring].side(negative);
            let sign = if negative { "buff" } else { "draft" };
            let at = format!("{label} spring {} {sign}", spring.spring);
            let off = (got.best.value - side.peak.0).abs();
            let unknown = side.uncertainty.map_or(0.0, |u| u.0);
            if off.is_nan() || off > found.bound + unknown {
                out.push(format!(
                    "{at}: peak {} at {}, reference {} at {}: off by {off:e}, bound {:e}",
                    got.best.value, got.best.at, side.peak.0, side.time.0, found.bound
                ));
            }
            let ratings = if negative { &scene.rated_buff } else { &scene.rated_draft };
            let margin = side.peak.0 - ratings[spring.spring];
            let due = if side.time.0 == 0.0 || margin < -2.0 * found.bound - unknown {
                Some(margin > 0.0)
            } else if margin > 2.0 * found.bound + unknown {
                Some(true)
            } else {
                continue;
            };
            if got.exceeds() != due {
                out.push(format!("{at}: exceeds {:?}, due {due:?}, margin {margin:e}", got.exceeds()));
            }
            if let (Some(t), Some(due), Some(slope)) = (got.first_over, &side.first_over, &side.slope) {
                // The force at the reported instant is off the rating by the slope times the time's error; a method that
                // does not reach the tolerance is held to its own bound.
                let off = (t - due.0).abs() * slope.0.abs();
                if off.is_nan()
                    || off > (TOLERANCE * largest).max(2.0 * found.bound) + unknown
                    || (due.0 == 0.0) != (t == 0.0)
                {
                    out.push(format!("{at}: first over at {t}, reference {}, slope {:e}", due.0, slope.0));
                }
            }
        }
    }
    out
}

/// Departures of every method's extremes and histories from a reference.
pub fn all_departures(reference: &Reference) -> Vec<String> {
    let scene = reference.scene();
    let found = by_all(&scene);
    let mut out: Vec<String> = found.iter().flat_map(|f| departures(reference, &scene, f)).collect();
    let best = found.iter().map(|f| f.bound).fold(f64::INFINITY, f64::min);
    if best > TOLERANCE * rating(&scene) {
        out.push(format!(
            "{}: no method's bound is under {:e}, the best is {best:e}",
            reference.name,
            TOLERANCE * rating(&scene)
        ));
    }
    for values in &reference.values {
        for (method, forces, bound) in forces_at(&scene, values.time) {
            for (i, (force, due)) in forces.iter().zip(&values.force).enumerate() {
                let off = (force - due.0).abs();
                if off.is_nan() || off > bound {
                    let (name, by) = (&reference.name, method.name());
                    out.push(format!("{name} [{by}] spring {i} at {}: off by {off:e}, bound {bound:e}", values.time));
                }
            }
        }
    }
    out
}
