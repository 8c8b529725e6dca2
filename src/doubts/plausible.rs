//! Numbers of a train that no railway has: probably a wrong unit or a slip.

use crate::law::Law;
use crate::train::{Application, Doubt, Train, Vehicle, more};
use crate::units::{Dimension, GRAVITY_M_PER_S2, rounded, shown};

/// Masses of vehicles, kg: 5 t and 400 t.
const LIGHT_KG: f64 = 5e3;
const HEAVY_KG: f64 = 400e3;
/// Lengths of vehicles over their couplers, m.
const SHORT_M: f64 = 2.0;
const LONG_M: f64 = 100.0;
/// Stiffness of a connection, and of parts in series with a gear, N/m.
const SOFT_N_PER_M: f64 = 1e6;
const STIFF_N_PER_M: f64 = 10e9;
/// The whole travel of a gear, m.
const TRAVEL_M: [f64; 2] = [5e-3, 0.5];
/// A share of 1 % or less, of which the hundredfold was probably meant.
pub(super) const FAINT_SHARE: f64 = 0.01 + 1e-9;
/// The least share of the weight that a brake force is.
const FAINT_BRAKE: f64 = 1e-3;
/// Speeds of the waves of brake applications, m/s.
const WAVE_M_PER_S: [f64; 2] = [50.0, 400.0];
/// Capacity of a coupler, N: 50 kN and 10 MN.
const WEAK_N: f64 = 50e3;
const STRONG_N: f64 = 10e6;
/// Forces of an event, N: 1 kN.
const FAINT_N: f64 = 1e3;
/// How far a connection is stretched or compressed by the load, and slack, m.
const STRETCH_M: f64 = 0.5;
/// Largest mass and stiffness of a model in units of its own.
const UNIT_KG: f64 = 10.0;
const UNIT_N_PER_M: f64 = 100.0;
/// Acceleration of a train, m/s2.
const ACCELERATION_M_PER_S2: f64 = 0.3;
/// Speeds of a train and of vehicles that run into others, m/s: 200 and 40 km/h.
const FAST_M_PER_S: f64 = 200.0 / 3.6;
const FAST_IMPACT_M_PER_S: f64 = 40.0 / 3.6;
/// Grade of a track, as a share.
pub(crate) const STEEP: f64 = 0.1;

/// Every doubt about the size of a train's numbers, one a kind.
pub(super) fn of_train(train: &Train) -> Vec<Doubt> {
    let couplers =
        || [soft(train), stiff(train), slack(train), travel(train), ratings(train), faint_load(train), stretch(train)];
    let vehicles = || [masses(train), vehicle_lengths(train), brake_forces(train)];
    let sizes = || vehicles().into_iter().chain(couplers()).collect();
    let sizes: Vec<_> = if in_own_units(train) { vec![] } else { sizes() };
    let others = [counted_in_label(train), acceleration(train), modal_damping(train), fast(train)];
    sizes.into_iter().chain(others).flatten().collect()
}

/// A speed, m/s, that no train with such couplers has.
fn fast(train: &Train) -> Option<Doubt> {
    let (speed, most) = over(train, train.extras().speed_m_per_s?, FAST_M_PER_S)?;
    let text = format!("the train runs at {speed}, over {most}; check the number and its unit");
    Some(Doubt::of_train("speed", text))
}

/// A speed of vehicles that run into others, m/s, at which none are coupled, as the words of a doubt.
pub(super) fn fast_impact(train: &Train, speed_m_per_s: f64) -> Option<(&'static str, String)> {
    let (speed, most) = over(train, speed_m_per_s, FAST_IMPACT_M_PER_S)?;
    let text = format!(
        "the vehicles arrive at {speed}, over {most}, faster than vehicles are coupled; check the number and its unit"
    );
    Some(("speed", text))
}

/// A speed and the one that it is above, m/s, in words.
fn over(train: &Train, speed_m_per_s: f64, most_m_per_s: f64) -> Option<(String, String)> {
    let units = train.origin().units;
    let words = || (shown(units, speed_m_per_s, Dimension::Speed), rounded(units, most_m_per_s, Dimension::Speed));
    (speed_m_per_s > most_m_per_s).then(words)
}

/// A load under 1 kN: newtons or millinewtons where kilonewtons or meganewtons were probably meant.
fn faint_load(train: &Train) -> Option<Doubt> {
    let largest_n = train.initial_force_n().iter().fold(0.0f64, |a, f| a.max(f.abs()));
    faint(train, "load", largest_n).filter(|_| largest_n > 0.0).map(|text| Doubt::of_train("faint-load", text))
}

/// The words of a doubt about a force of almost nothing, N, of the load or of a pulse.
fn faint(train: &Train, what: &str, force_n: f64) -> Option<String> {
    let units = train.origin().units;
    let [force, least] = [shown(units, force_n, Dimension::Force), rounded(units, FAINT_N, Dimension::Force)];
    (force_n < FAINT_N).then(|| {
        format!("the largest force of the {what} is {force}, under {least}; check the number and its unit (mN is millinewton)")
    })
}

/// A pulse whose largest force, N, is under 1 kN, as the words of a doubt.
pub(super) fn faint_pulse(train: &Train, force_n: f64) -> Option<(&'static str, String)> {
    let text = faint(train, "pulse", force_n.abs()).filter(|_| !in_own_units(train));
    text.map(|text| ("faint-pulse", text))
}

/// Whether it is a model in units of its own, such as the paper's with masses and stiffnesses of 1, whose sizes mean nothing. No
/// slip of a unit in a railway's numbers makes both so small.
fn in_own_units(train: &Train) -> bool {
    let small = |v: &Vehicle| v.held || v.mass_kg <= UNIT_KG;
    train.vehicles().iter().all(small) && train.couplers().iter().all(|c| c.stiffness_n_per_m <= UNIT_N_PER_M)
}

fn masses(train: &Train) -> Option<Doubt> {
    let all = train.vehicles().iter().enumerate().filter(|(_, v)| !v.held).map(|(i, v)| (i, v.mass_kg));
    outside(train, ["mass", "mass", "vehicle"], all, [LIGHT_KG, HEAVY_KG], Dimension::Mass)
}

fn vehicle_lengths(train: &Train) -> Option<Doubt> {
    let all = train.vehicles().iter().enumerate().filter_map(|(i, v)| Some((i, v.length_m?)));
    outside(train, ["length", "length", "vehicle"], all, [SHORT_M, LONG_M], Dimension::Length)
}

/// Full brake forces beside the weight.
fn brake_forces(train: &Train) -> Option<Doubt> {
    let braked = train.vehicles().iter().zip(&train.extras().emergency_brake_n).filter(|(_, n)| **n > 0.0);
    let share = |(v, n): &(&Vehicle, &f64)| **n / (v.mass_kg * GRAVITY_M_PER_S2);
    let mut odd = braked.filter(|of| !(FAINT_BRAKE..=1.0).contains(&share(of)));
    let (first, n) = odd.next()?;
    let text = format!(
        "the emergency_brake of {}{} is {}, {} of its weight; check the number and its unit",
        first.label,
        more(odd.count(), "vehicle"),
        shown(train.origin().units, *n, Dimension::Force),
        if share(&(first, n)) > 1.0 { "more than all" } else { "less than a thousandth" }
    );
    Some(Doubt::of_train("brake-force", text))
}

/// Slack of couplers, with or without a gear.
fn slack(train: &Train) -> Option<Doubt> {
    let all = train.extras().laws.iter().map(Law::slack_m).enumerate();
    outside(train, ["slack", "slack", "coupler"], all, [0.0, STRETCH_M], Dimension::Length)
}

/// Travel of gears up to the last row of their tables.
fn travel(train: &Train) -> Option<Doubt> {
    let of_law = |(i, law): (usize, &Law)| match law {
        Law::Gear { draft, buff, .. } => [draft, buff].map(|curve| Some((i, curve.rows().last()?.travel_m))),
        Law::Elastic { .. } => [None; 2],
    };
    let all = train.extras().laws.iter().enumerate().flat_map(of_law).flatten();
    outside(train, ["gear-travel", "whole travel of the gear", "coupler"], all, TRAVEL_M, Dimension::Length)
}

/// Stiffnesses of couplers, and of the parts in series with gears.
fn stiff(train: &Train) -> Option<Doubt> {
    let usual = [0.0, STIFF_N_PER_M];
    let own = train.couplers().iter().map(|c| c.stiffness_n_per_m).enumerate();
    let solid = train.extras().laws.iter().enumerate().filter_map(|(i, law)| match law {
        Law::Gear { solid_n_per_m, .. } => Some((i, *solid_n_per_m)),
        Law::Elastic { .. } => None,
    });
    let solid = outside(train, ["stiff-coupler", "solid_stiffness", "coupler"], solid, usual, Dimension::Stiffness);
    solid.or_else(|| outside(train, ["stiff-coupler", "stiffness", "coupler"], own, usual, Dimension::Stiffness))
}

/// The speed of a brake application's wave, as the words of a doubt.
pub(super) fn brake_wave(train: &Train, application: &Application) -> Option<(&'static str, String)> {
    let units = train.origin().units;
    let [slow, fast] = WAVE_M_PER_S.map(|speed| rounded(units, speed, Dimension::Speed));
    let text = format!(
        "the wave of the brake application runs at {}, outside the usual {slow} to {fast}; check the number and its unit",
        shown(units, application.wave_m_per_s, Dimension::Speed)
    );
    let [slow, fast] = WAVE_M_PER_S;
    (!(slow..=fast).contains(&application.wave_m_per_s)).then_some(("brake-wave", text))
}

/// The largest share of a brake application's build-up, as the words of a doubt.
pub(super) fn faint_build_up(application: &Application) -> Option<(&'static str, String)> {
    let most = application.build_up.iter().map(|row| row[1]).fold(0.0, f64::max);
    let text = "no share of build_up is over 1 %: were shares of 1 meant, such as 0.5 for 50 %?";
    (most <= FAINT_SHARE).then(|| ("faint-build-up", text.to_owned()))
}

/// A doubt about the first of some numbers of vehicles or couplers that are outside a usual range, and how many more are.
fn outside(
    train: &Train,
    [code, what, of]: [&'static str; 3],
    all: impl Iterator<Item = (usize, f64)>,
    [least, most]: [f64; 2],
    dimension: Dimension,
) -> Option<Doubt> {
    let mut odd = all.filter(|(_, value)| !(least..=most).contains(value));
    let ((first, value), units) = (odd.next()?, train.origin().units);
    let name = if of == "vehicle" { train.vehicles()[first].label.clone() } else { format!("coupler {}", first + 1) };
    let [low, high] = [least, most].map(|limit| rounded(units, limit, dimension));
    let usual = if least == 0.0 { format!("over {high}") } else { format!("outside the usual {low} to {high}") };
    let (others, value) = (more(odd.count(), of), shown(units, value, dimension));
    let text = format!("the {what} of {name}{others} is {value}, {usual}; check the number and its unit");
    Some(Doubt::of_train(code, text))
}

fn soft(train: &Train) -> Option<Doubt> {
    let mut soft = (0..train.couplers().len()).filter(|&i| train.couplers()[i].stiffness_n_per_m < SOFT_N_PER_M);
    let (first, units) = (soft.next()?, train.origin().units);
    let text = format!(
        "the stiffness of coupler {}{} is {}, under {}; check the number and its unit (was kN/mm meant?)",
        first + 1,
        more(soft.count(), "coupler"),
        shown(units, train.couplers()[first].stiffness_n_per_m, Dimension::Stiffness),
        rounded(units, SOFT_N_PER_M, Dimension::Stiffness)
    );
    Some(Doubt::of_train("soft-coupler", text))
}

fn ratings(train: &Train) -> Option<Doubt> {
    let both = |i: usize| [train.couplers()[i].rated_draft_n, train.couplers()[i].rated_buff_n];
    let odd = |i: usize| both(i).into_iter().find(|n| !(WEAK_N..=STRONG_N).contains(n));
    let mut all = (0..train.couplers().len()).filter_map(|i| Some((i, odd(i)?)));
    let ((first, rating_n), units) = (all.next()?, train.origin().units);
    let text = format!(
        "coupler {}{} is rated {}, outside the usual {} to {}; check the number and its unit",
        first + 1,
        more(all.count(), "coupler"),
        shown(units, rating_n, Dimension::Force),
        rounded(units, WEAK_N, Dimension::Force),
        rounded(units, STRONG_N, Dimension::Force)
    );
    Some(Doubt::of_train("rating", text))
}

fn stretch(train: &Train) -> Option<Doubt> {
    let stretch_m = |i: usize| train.initial_force_n()[i].abs() / train.couplers()[i].stiffness_n_per_m;
    let lengths = |i: usize| [i, i + 1].into_iter().filter_map(|v| train.vehicles()[v].length_m);
    let mut long = (0..train.couplers().len()).filter(|&i| stretch_m(i) > lengths(i).fold(STRETCH_M, f64::min));
    let (first, units) = (long.next()?, train.origin().units);
    let text = format!(
        "the load changes the length of coupler {}{} by {}, more than {} or a vehicle's length; check the load, the stiffness \
         and their units",
        first + 1,
        more(long.count(), "coupler"),
        shown(units, stretch_m(first), Dimension::Length),
        rounded(units, STRETCH_M, Dimension::Length)
    );
    Some(Doubt::of_train("stretch", text))
}

/// A label such as `3 x car` of fewer vehicles than it says.
fn counted_in_label(train: &Train) -> Option<Doubt> {
    let number = |label: &str| {
        let (number, rest) = label.split_at(label.find(|c: char| !c.is_ascii_digit())?);
        let rest = rest.trim_start().strip_prefix(['x', '×'])?;
        if rest.starts_with(char::is_whitespace) { number.parse::<usize>().ok().filter(|n| *n > 1) } else { None }
    };
    let labels = || train.vehicles().iter().map(|v| v.label.as_str());
    let said = |label: &&str| number(label).is_some_and(|n| labels().filter(|l| number(l) == Some(n)).count() < n);
    let first = labels().find(said)?;
    let text =
        format!("{first:?} is the label of one vehicle; if it stands for several alike, say how many with count");
    Some(Doubt::of_train("count-in-label", text))
}

fn acceleration(train: &Train) -> Option<Doubt> {
    let (a, units) = (train.extras().steady.as_ref()?.acceleration_m_per_s2, train.origin().units);
    let text = format!(
        "the train accelerates at {} before the event, over {}; check the forces on the vehicles, or hold an end to \
         keep its speed",
        units.acceleration(a),
        units.acceleration(ACCELERATION_M_PER_S2)
    );
    (a.abs() > ACCELERATION_M_PER_S2).then(|| Doubt::of_train("acceleration", text))
}

/// A damping ratio of every mode is easily taken for that of a dashpot.
fn modal_damping(train: &Train) -> Option<Doubt> {
    let ratio = train.extras().damping_ratio;
    let mass = train.vehicles().iter().filter(|v| !v.held).map(|v| v.mass_kg).fold(f64::INFINITY, f64::min);
    let dashpot = 2.0 * ratio * (train.couplers().first()?.stiffness_n_per_m * mass).sqrt();
    let text = format!(
        "damping_ratio = {ratio} damps every mode of vibration by that share, and no device does that: it reduces forces more than dashpots \
         of that ratio. The published ratios of draft gears, 0.14 to 0.26, are those of dashpots, c / 2 sqrt(k m). For such a dashpot give \
         [coupler] damping = {:?}",
        shown(train.origin().units, dashpot, Dimension::Damping)
    );
    (ratio > 0.0).then(|| Doubt::of_train("modal-damping", text))
}
