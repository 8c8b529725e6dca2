//! The steady state before the event: a uniform force, or the forces on the vehicles and what they leave in the couplers.
//!
//! ```text
//! p_v = traction - brake - r m_v - m_v g s / sqrt(1 + s^2)          s: grade, uphill positive; g: standard gravity
//! a   = sum p_v / sum m_v        where no vehicle is held, 0 where one is
//! F_v = F_{v-1} + p_v - m_v a
//! ```
//!
//! The train runs forward, so resistance and brakes pull backward. A held end takes whatever force it needs. With both ends
//! held the couplers share the forces as their compliances allow: the ends keep the distance at which the train without a
//! load is unstretched.
//!
//! Where large forces cancel, what their rounding leaves is no force: a sum that is smaller than [`NOISE`] times the sum of the
//! magnitudes in it is 0.

use super::extras::Steady;
use super::tree::{Read, Table, Value};
use super::{Coupler, Vehicle};
use crate::doubts::{Doubt, STEEP, more};
use crate::solve::dd::Dd;
use crate::units::{Amount, Dimension, shown};

/// Standard gravity, m/s2 (CGPM 1901).
const GRAVITY: f64 = 9.806_65;

/// Each term has a rounding error of a few `u = EPSILON / 2`; a sum of terms is off by no more than that share of their magnitudes.
const NOISE: f64 = 8.0 * f64::EPSILON;

/// What a vehicle's own table says of the forces on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OwnLoad {
    tractive_effort_n: f64,
    brake_force_n: f64,
    emergency_brake_n: f64,
    resistance_n_per_kg: Option<f64>,
    grade: Option<f64>,
    /// One of the keys is there.
    given: bool,
}

/// The steady state before the event.
pub(super) struct Loads {
    /// Force in each coupler, N, draft positive.
    pub(super) couplers_n: Vec<f64>,
    /// What they come from, unless they are given themselves.
    pub(super) steady: Option<Steady>,
    /// The largest pull in each coupler before, N; empty if none is given.
    pub(super) pulled_to_n: Vec<f64>,
}

/// Tractive effort of each vehicle, N, forward positive.
pub(super) fn tractions(own: &[OwnLoad]) -> Vec<f64> {
    own.iter().map(|o| o.tractive_effort_n).collect()
}

/// Full brake force of each vehicle in an emergency, N; empty if none has one.
pub(super) fn emergency_brakes(own: &[OwnLoad]) -> Vec<f64> {
    let all: Vec<f64> = own.iter().map(|o| o.emergency_brake_n).collect();
    if all.iter().any(|n| *n > 0.0) { all } else { vec![] }
}

const OWN_KEYS: [&str; 4] = ["tractive_effort", "rolling_resistance", "grade", "brake_force"];

/// Reads the loads of one `[[vehicle]]` table.
pub(super) fn own(table: &Table, held: bool) -> Read<OwnLoad> {
    let quantity = |key| table.get(key).map(|v| v.quantity()).transpose();
    let traction = quantity("tractive_effort");
    let brake = quantity("brake_force");
    let resistance = quantity("rolling_resistance");
    let grade = quantity("grade");
    let emergency = quantity("emergency_brake");
    let first = OWN_KEYS.into_iter().find_map(|key| Some((key, table.key_span(key)?)));
    let braked = || Some(("emergency_brake", table.key_span("emergency_brake")?));
    if let Some((key, span)) = first.clone().or_else(braked).as_ref().filter(|_| held) {
        let help = "a held vehicle takes whatever force it needs to keep its speed: leave the key out";
        return Err(table.note_at(span.clone(), format!("{key} of a held vehicle"), help));
    }
    Ok(OwnLoad {
        tractive_effort_n: traction?.unwrap_or(0.0),
        brake_force_n: brake?.unwrap_or(0.0),
        emergency_brake_n: emergency?.unwrap_or(0.0),
        resistance_n_per_kg: resistance?,
        grade: grade?,
        given: first.is_some(),
    })
}

/// The couplers' forces before the event, and what they come from unless they are given themselves.
pub(super) fn read(
    root: &Table,
    vehicles: &[Vehicle],
    couplers: &[Coupler],
    have_laws: bool,
    own: &[OwnLoad],
    weakest_n: f64,
) -> Read<Loads> {
    let (couplers_n, steady) = forces(root, vehicles, couplers, have_laws, own, weakest_n)?;
    let pulled_to = root.get("load").map(|v| v.table()).transpose()?.and_then(|table| table.get("pulled_to"));
    let pulled_to_n =
        pulled_to.map_or(Ok(vec![]), |value| pulled_to_n(&value, &couplers_n, steady.is_some(), weakest_n))?;
    Ok(Loads { couplers_n, steady, pulled_to_n })
}

/// The largest pull in each coupler before: given for all, or for the one that pulls most, with the others in proportion.
fn pulled_to_n(value: &Value, couplers_n: &[f64], in_proportion: bool, weakest_n: f64) -> Read<Vec<f64>> {
    let pulled_n = match value.amount()? {
        Amount::Si(value) => value,
        Amount::Share(share) => share * weakest_n,
    };
    let largest_n = couplers_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if pulled_n < largest_n {
        let title = format!("pulled_to is less than the load, {}", shown(largest_n, Dimension::Force));
        return Err(value.wrong(title, "it is the largest pull before, from which the train was let down to the load"));
    }
    if in_proportion && largest_n <= 0.0 {
        let help = "the couplers' pulls before are in proportion to those of the load, of which none is in draft";
        return Err(value.wrong("pulled_to of a train in which no coupler is pulled", help));
    }
    let factor = pulled_n / largest_n;
    Ok(couplers_n.iter().map(|f| if in_proportion { f.max(0.0) * factor } else { pulled_n }).collect())
}

/// The couplers' forces, and what they come from unless they are given themselves.
fn forces(
    root: &Table,
    vehicles: &[Vehicle],
    couplers: &[Coupler],
    have_laws: bool,
    own: &[OwnLoad],
    weakest_n: f64,
) -> Read<(Vec<f64>, Option<Steady>)> {
    let table = root.get("load").map(|v| v.table()).transpose()?;
    let quantity = |key| table.as_ref().and_then(|t| t.get(key)).map(|v| v.quantity()).transpose();
    let resistance = quantity("rolling_resistance");
    let grade = quantity("grade");
    let (resistance, grade) = (resistance?, grade?);
    let by_vehicle = resistance.is_some() || grade.is_some() || own.iter().any(|o| o.given);
    let Some(table) = table.filter(|t| !by_vehicle || t.get("uniform").is_some()) else {
        if !by_vehicle {
            return Ok((vec![0.0; couplers.len()], None));
        }
        steep(root, vehicles, own, grade.unwrap_or(0.0));
        if have_laws && vehicles[0].held && vehicles[vehicles.len() - 1].held {
            let help = "hold one end, or give the couplers' force with [load] uniform";
            let title = "forces on the vehicles between two held ends need linear couplers, which share them by their stiffness";
            return Err(root.wrong(title, help));
        }
        let outside = |(v, o): (&Vehicle, &OwnLoad)| outside_n(v, o, resistance.unwrap_or(0.0), grade.unwrap_or(0.0));
        let outside_n: Vec<f64> = vehicles.iter().zip(own).map(outside).collect();
        let (forces, acceleration_m_per_s2) = steady_forces(vehicles, couplers, &outside_n);
        return Ok((forces, Some(Steady { outside_n, acceleration_m_per_s2 })));
    };
    let right = "add uniform = \"0.6 MN\", the force in every coupler, draft positive, or rolling_resistance and grade";
    let uniform = table.require("uniform", right)?;
    if by_vehicle {
        let title = "uniform gives the couplers' forces, and other keys give the forces that they come from";
        let help = "keep uniform, or else tractive_effort, rolling_resistance, grade and brake_force";
        return Err(uniform.wrong(title, help));
    }
    let load_n = match uniform.amount()? {
        Amount::Si(value) => value,
        Amount::Share(share) => share * weakest_n,
    };
    Ok((vec![load_n; couplers.len()], None))
}

/// Notes a grade that no railway has.
fn steep(root: &Table, vehicles: &[Vehicle], own: &[OwnLoad], grade: f64) {
    let slopes = vehicles.iter().zip(own).filter(|(v, _)| !v.held).map(|(v, o)| (v, o.grade.unwrap_or(grade)));
    let mut steep = slopes.filter(|(_, slope)| slope.abs() > STEEP);
    if let Some((first, slope)) = steep.next() {
        let (others, percent) = (more(steep.count(), "vehicle"), 100.0 * slope);
        let text =
            format!("the grade of {}{others} is {percent:.0} %, over 10 %; check the number and its unit", first.label);
        root.doubt(Doubt::of_train("grade", text));
    }
}

fn outside_n(vehicle: &Vehicle, own: &OwnLoad, resistance: f64, grade: f64) -> f64 {
    if vehicle.held {
        return 0.0;
    }
    let slope = own.grade.unwrap_or(grade);
    let downhill = GRAVITY * slope / slope.hypot(1.0);
    let per_mass = own.resistance_n_per_kg.unwrap_or(resistance) + downhill;
    let force = own.tractive_effort_n - own.brake_force_n - per_mass * vehicle.mass_kg;
    let resistance = own.resistance_n_per_kg.unwrap_or(resistance) + downhill.abs();
    without_noise(force, own.tractive_effort_n.abs() + own.brake_force_n + resistance * vehicle.mass_kg)
}

/// A sum of terms with these magnitudes in all; 0 if it is no more than their rounding.
fn without_noise(sum: f64, magnitudes: f64) -> f64 {
    if sum.abs() <= NOISE * magnitudes { 0.0 } else { sum }
}

/// The couplers' forces under steady forces from outside, N, draft positive, and the train's acceleration, m/s2.
///
/// `outside_n` holds a force for each vehicle, N, forward positive; that of a held vehicle plays no part. Sums are in
/// double-double and rounded once; what is only the rounding of the given forces is 0.
pub fn steady_forces(vehicles: &[Vehicle], couplers: &[Coupler], outside_n: &[f64]) -> (Vec<f64>, f64) {
    let last = vehicles.len() - 1;
    let free = !vehicles[0].held && !vehicles[last].held;
    let sum = |terms: &mut dyn Iterator<Item = f64>| terms.fold(Dd::ZERO, |s, x| s + Dd::from(x));
    let live = || (0..=last).filter(|&v| !vehicles[v].held);
    let magnitudes: f64 = live().map(|v| outside_n[v].abs()).sum();
    let total = sum(&mut live().map(|v| outside_n[v]));
    let acceleration = if free && without_noise(total.to_f64(), magnitudes) != 0.0 {
        total / sum(&mut vehicles.iter().map(|v| v.mass_kg))
    } else {
        Dd::ZERO
    };
    let push = |v: usize| Dd::from(outside_n[v]) - Dd::from(vehicles[v].mass_kg) * acceleration;
    let mut force = Dd::ZERO;
    // Up to a constant: the force on a held head, which is not known yet, is left out.
    let mut forces: Vec<Dd> = Vec::with_capacity(couplers.len());
    for (v, vehicle) in vehicles[..last].iter().enumerate() {
        if !vehicle.held {
            force = force + push(v);
        }
        forces.push(force);
    }
    let offset = match (vehicles[0].held, vehicles[last].held) {
        (false, _) => Dd::ZERO,
        // The last vehicle's own balance: F_last = -p_last.
        (true, false) => -(force + push(last)),
        (true, true) => {
            let compliance = |c: &Coupler| Dd::quotient(1.0, c.stiffness_n_per_m);
            let stretch = forces.iter().zip(couplers).fold(Dd::ZERO, |s, (&f, c)| s + f * compliance(c));
            -(stretch / couplers.iter().fold(Dd::ZERO, |s, c| s + compliance(c)))
        }
    };
    let force = |f: Dd| without_noise((f + offset).to_f64(), magnitudes);
    (forces.into_iter().map(force).collect(), acceleration.to_f64())
}
