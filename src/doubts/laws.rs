//! Doubts about slack, gears, the earlier pull and brakes.

use super::plausible::FAINT_SHARE;
use crate::law::{Curve, Law};
use crate::train::{Doubt, Scenario, Train, more};
use crate::units::{Dimension, shown};

/// Every doubt about a train's laws, and keys that change nothing in it.
pub(super) fn of_train(train: &Train) -> Vec<Doubt> {
    let found = [
        closed(train),
        slack_without_friction(train),
        soft_solid(train),
        faint_friction(train),
        pulled_to_unused(train),
        pulled_over_rating(train),
    ];
    found.into_iter().flatten().chain(without_brakes(train)).collect()
}

/// A gear that the load, or the earlier pull, has closed.
fn closed(train: &Train) -> Option<Doubt> {
    let force_n = |i: usize| {
        train.history_n(i).into_iter().fold(train.initial_force_n()[i], |a, f| if f.abs() > a.abs() { f } else { a })
    };
    let over = |i: &usize| match &train.extras().laws[*i] {
        Law::Gear { draft, buff, .. } => {
            let f = force_n(*i);
            f.abs() > if f < 0.0 { buff } else { draft }.closes_at_n()
        }
        Law::Elastic { .. } => false,
    };
    let mut over = (0..train.extras().laws.len()).filter(over);
    let first = over.next()?;
    let what = if force_n(first) == train.initial_force_n()[first] { "load" } else { "earlier pull" };
    let text = format!(
        "the {what} closes the gear of coupler {}{}: {} is over the last row of its table",
        first + 1,
        more(over.count(), "coupler"),
        shown(train.origin().units, force_n(first).abs(), Dimension::Force)
    );
    Some(Doubt::of_train("gear-closed", text))
}

/// A gear that loses nothing at small forces, beside slack: vehicles rattle in it, and small differences grow.
fn slack_without_friction(train: &Train) -> Option<Doubt> {
    let begins_elastic = |curve: &Curve| {
        let rows = curve.rows();
        rows[1].loading_n > 0.0 && rows[..2].iter().all(|row| row.loading_n == row.unloading_n)
    };
    let is = |law: &Law| match law {
        Law::Gear { draft, buff, slack_m, .. } => *slack_m > 0.0 && (begins_elastic(draft) || begins_elastic(buff)),
        Law::Elastic { slack_m, .. } => *slack_m > 0.0,
    };
    let mut all = (0..train.extras().laws.len()).filter(|&i| is(&train.extras().laws[i]));
    let first = all.next()?;
    let text = format!(
        "coupler {}{} has slack and no friction at small forces: the vehicles collide again and again, small differences grow, and forces can be \
         reported for a shorter time only; give a gear with friction at all loads, if it has any",
        first + 1,
        more(all.count(), "coupler")
    );
    Some(Doubt::of_train("slack-without-friction", text))
}

/// Parts in series with a gear that give more than the gear itself: solid_stiffness is probably another stiffness.
fn soft_solid(train: &Train) -> Option<Doubt> {
    let soft = |law: &Law| match law {
        Law::Gear { solid_n_per_m, draft, buff, .. } => {
            let own_n_per_m = draft.mean_n_per_m().max(buff.mean_n_per_m());
            (*solid_n_per_m < own_n_per_m).then_some([*solid_n_per_m, own_n_per_m])
        }
        Law::Elastic { .. } => None,
    };
    let mut all = train.extras().laws.iter().enumerate().filter_map(|(i, law)| Some((i, soft(law)?)));
    let (first, stiffness) = all.next()?;
    let [solid, own] = stiffness.map(|k| shown(train.origin().units, k, Dimension::Stiffness));
    let text = format!(
        "the solid_stiffness of coupler {}{} is {solid}, softer than its gear, {own} over the whole stroke in loading; it is that of the \
         parts in series with the gear, when it is locked or closed: check the number and its unit",
        first + 1,
        more(all.count(), "coupler")
    );
    Some(Doubt::of_train("soft-solid-stiffness", text))
}

/// Gears that give back almost all: a friction of 0.75 % where 75 % was meant.
fn faint_friction(train: &Train) -> Option<Doubt> {
    let lost = |curve: &Curve| {
        let rows = curve.rows().iter().filter(|row| row.loading_n > 0.0);
        rows.map(|row| 1.0 - row.unloading_n / row.loading_n).fold(0.0, f64::max)
    };
    let faint = |law: &Law| match law {
        Law::Gear { draft, buff, .. } => {
            [draft, buff].into_iter().map(lost).find(|lost| (1e-6..FAINT_SHARE).contains(lost))
        }
        Law::Elastic { .. } => None,
    };
    let mut all = train.extras().laws.iter().enumerate().filter_map(|(i, law)| Some((i, faint(law)?)));
    let (first, lost) = all.next()?;
    let text = format!(
        "the gear of coupler {}{} has a friction of {:.2} % at most: was {:.0} % meant?",
        first + 1,
        more(all.count(), "coupler"),
        100.0 * lost,
        1e4 * lost
    );
    Some(Doubt::of_train("faint-friction", text))
}

/// An earlier pull over the rating in draft.
fn pulled_over_rating(train: &Train) -> Option<Doubt> {
    let pulled = train.extras().pulled_to_n.iter().zip(train.couplers()).enumerate();
    let mut over = pulled.filter(|(_, (pull, c))| **pull > c.rated_draft_n).map(|(i, (pull, _))| (i, *pull));
    let (first, pull_n) = over.next()?;
    let text = format!(
        "the earlier pull in coupler {}{}, {}, is over its rating: check pulled_to and its unit",
        first + 1,
        more(over.count(), "coupler"),
        shown(train.origin().units, pull_n, Dimension::Force)
    );
    Some(Doubt::of_train("pull-over-rating", text))
}

/// An earlier pull that changes no force.
fn pulled_to_unused(train: &Train) -> Option<Doubt> {
    let remembers = |(law, load_n): (&Law, &f64)| law.has_friction() && *load_n >= 0.0;
    let depends = train.extras().laws.iter().zip(train.initial_force_n()).any(remembers);
    let text =
        "pulled_to changes nothing: only the force in a gear with friction that is in draft depends on an earlier pull";
    (!train.extras().pulled_to_n.is_empty() && !depends).then(|| Doubt::of_train("pulled-to-unused", text))
}

/// Keys of brakes in a train none of whose scenarios applies any.
fn without_brakes(train: &Train) -> Vec<Doubt> {
    if train.scenarios().iter().any(Scenario::applies_brakes) {
        return vec![];
    }
    let told = |given: bool, code: &'static str, key: &str| {
        let text = format!(
            "{key} changes nothing: no scenario applies brakes; give a break an emergency, or add a scenario of kind \"brake\""
        );
        given.then(|| Doubt::of_train(code, text))
    };
    let speed = told(train.extras().speed_m_per_s.is_some(), "speed-unused", "speed");
    let brake = told(!train.extras().emergency_brake_n.is_empty(), "emergency-brake-unused", "emergency_brake");
    speed.into_iter().chain(brake).collect()
}
