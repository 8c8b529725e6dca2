//! The steady state before the event: a uniform force, or the forces on the vehicles and what they leave in the couplers.
//!
//! ```text
//! p_v = traction - brake - r m_v - m_v g s / sqrt(1 + s^2)          s: grade, uphill positive; g: standard gravity
//! ```
//!
//! The train runs forward, so resistance and brakes pull backward. The couplers' forces follow: [`steady_forces`](crate::train::steady_forces).

use super::labels::Labels;
use super::tree::{Read, Table};
use crate::doubts::STEEP;
use crate::train::{Doubt, Load, PulledTo, VehicleSpec, more, of_held, without_noise};
use crate::units::{Amount, GRAVITY_M_PER_S2, digits, without_zeros};

/// What a vehicle's own table says of the forces on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OwnLoad {
    tractive_effort_n: f64,
    brake_force_n: f64,
    pub(super) emergency_brake_n: f64,
    resistance_n_per_kg: Option<f64>,
    grade: Option<f64>,
    /// Whether any key is given.
    given: bool,
}

/// Tractive effort of each vehicle, N, forward positive.
pub(super) fn tractions(own: &[OwnLoad]) -> Vec<f64> {
    own.iter().map(|o| o.tractive_effort_n).collect()
}

/// If no grade is steeper than this, 0.05 %, shares of 1 may have been meant.
const LARGEST_DOUBTFUL_GRADE: f64 = 5e-4;

const OWN_KEYS: [&str; 4] = ["tractive_effort", "rolling_resistance", "grade", "brake_force"];

/// Reads the loads of one `[[vehicle]]` table. A wrong value is noted and replaced by one that causes no further
/// problem.
pub(super) fn own(table: &Table, held: bool) -> OwnLoad {
    let quantity = |key| table.get(key).map(|v| v.quantity()).transpose();
    let traction = quantity("tractive_effort");
    let brake = quantity("brake_force");
    let resistance = quantity("rolling_resistance");
    let grade = quantity("grade");
    let emergency = quantity("emergency_brake");
    let first = OWN_KEYS.into_iter().find_map(|key| Some((key, table.key_span(key)?)));
    let braked = || Some(("emergency_brake", table.key_span("emergency_brake")?));
    if let Some((key, span)) = first.clone().or_else(braked).as_ref().filter(|_| held) {
        let wrong = of_held("vehicle", key);
        table.note_at(span.clone(), wrong.message, wrong.help);
        return OwnLoad::default();
    }
    let read = |force: Read<Option<f64>>| force.map_or(1.0, |n| n.unwrap_or(0.0));
    OwnLoad {
        tractive_effort_n: read(traction),
        brake_force_n: read(brake),
        emergency_brake_n: read(emergency),
        resistance_n_per_kg: resistance.unwrap_or(None),
        grade: grade.unwrap_or(None),
        given: first.is_some(),
    }
}

/// The load, and the largest pull before.
pub(super) fn read(
    root: &Table,
    vehicles: &[VehicleSpec],
    own: &[OwnLoad],
    labels: &Labels,
    weakest_n: f64,
) -> Read<(Load, PulledTo)> {
    let load = load(root, vehicles, own, labels, weakest_n)?;
    let pulled_to = root.get("load").map(|v| v.table()).transpose()?.and_then(|table| table.get("pulled_to"));
    let largest = |amount| PulledTo::Largest(in_newtons(amount, weakest_n));
    Ok((load, pulled_to.map_or(Ok(PulledTo::None), |value| value.amount().map(largest))?))
}

fn in_newtons(amount: Amount, weakest_n: f64) -> f64 {
    match amount {
        Amount::Si(value) => value,
        Amount::Share(share) => share * weakest_n,
    }
}

fn load(root: &Table, vehicles: &[VehicleSpec], own: &[OwnLoad], labels: &Labels, weakest_n: f64) -> Read<Load> {
    let table = root.get("load").map(|v| v.table()).transpose()?;
    let quantity = |key| table.as_ref().and_then(|t| t.get(key)).map(|v| v.quantity()).transpose();
    let resistance = quantity("rolling_resistance");
    let grade = quantity("grade");
    let (resistance, grade) = (resistance?, grade?);
    let by_vehicle = resistance.is_some() || grade.is_some() || own.iter().any(|o| o.given);
    let Some(table) = table.filter(|t| !by_vehicle || t.get("uniform").is_some()) else {
        if !by_vehicle {
            return Ok(Load::None);
        }
        let each = || vehicles.iter().flat_map(|v| std::iter::repeat_n(v, v.count)).zip(own);
        unlikely_grade(root, each(), labels, grade.unwrap_or(0.0));
        let outside =
            |(v, o): (&VehicleSpec, &OwnLoad)| outside_n(v, o, resistance.unwrap_or(0.0), grade.unwrap_or(0.0));
        return Ok(Load::OnVehicles(each().map(outside).collect()));
    };
    let right = "add uniform = \"0.6 MN\", the force in every coupler, draft positive, or rolling_resistance and grade";
    let uniform = table.require("uniform", right)?;
    if by_vehicle {
        let title =
            "uniform sets the forces in the couplers directly and cannot be combined with forces on the vehicles";
        let help = "keep uniform, or else tractive_effort, rolling_resistance, grade and brake_force";
        return Err(uniform.wrong(title, help));
    }
    Ok(Load::Uniform(in_newtons(uniform.amount()?, weakest_n)))
}

/// Notes a grade that no railway has, and grades that may have been meant as shares of 1.
fn unlikely_grade<'v>(
    root: &Table,
    vehicles: impl Iterator<Item = (&'v VehicleSpec, &'v OwnLoad)>,
    labels: &Labels,
    grade: f64,
) {
    let slopes = vehicles.enumerate().filter(|(_, (v, _))| !v.held).map(|(i, (_, o))| (i, o.grade.unwrap_or(grade)));
    let slopes: Vec<(usize, f64)> = slopes.collect();
    let largest = slopes.iter().fold(0.0f64, |a, (_, slope)| a.max(slope.abs()));
    if largest > 0.0 && largest < LARGEST_DOUBTFUL_GRADE {
        let [percent, share] = [100.0 * largest, 1e4 * largest].map(|x| without_zeros(&digits(x, 0.0, 3)));
        let text = format!("the steepest grade is {percent} %: was {share} % meant, given as a share of 1?");
        root.doubt(Doubt::of_train("flat-grade", text));
    }
    let mut steep = slopes.iter().filter(|(_, slope)| slope.abs() > STEEP);
    if let Some(&(first, slope)) = steep.next() {
        let (others, percent) = (more(steep.count(), "vehicle"), 100.0 * slope);
        let label = &labels.vehicles()[first].label;
        let text = format!("the grade of {label}{others} is {percent:.0} %, over 10 %; check the number and its unit");
        root.doubt(Doubt::of_train("grade", text));
    }
}

fn outside_n(vehicle: &VehicleSpec, own: &OwnLoad, resistance: f64, grade: f64) -> f64 {
    if vehicle.held {
        return 0.0;
    }
    let slope = own.grade.unwrap_or(grade);
    let downhill = GRAVITY_M_PER_S2 * slope / slope.hypot(1.0);
    let per_mass = own.resistance_n_per_kg.unwrap_or(resistance) + downhill;
    let force = own.tractive_effort_n - own.brake_force_n - per_mass * vehicle.mass_kg;
    let resistance = own.resistance_n_per_kg.unwrap_or(resistance) + downhill.abs();
    without_noise(force, own.tractive_effort_n.abs() + own.brake_force_n + resistance * vehicle.mass_kg)
}
