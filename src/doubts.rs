//! What in a train or scenario is probably not meant, or does not hold. A doubt stops no command. Every command
//! reports the same ones, from this list; only an analysis can find more.

mod events;
mod laws;
mod plausible;

use crate::train::{Coupler, Doubt, Limits, SENSES, Train, count, more};

pub(crate) use plausible::STEEP;

/// Every doubt about a train and its scenarios: those of its reader first.
pub fn doubts(train: &Train) -> Vec<Doubt> {
    let mut found = train.origin().doubts.clone();
    if train.scenarios().iter().any(|s| s.event.kind() != "impact") {
        let text = overloaded(train, train.initial_force_n());
        found.extend(text.map(|text| Doubt::of_train("load-over-rating", text)));
    }
    found.extend(limit_order(train));
    found.extend(lengths(train));
    found.extend(plausible::of_train(train));
    found.extend(laws::of_train(train));
    for scenario in train.scenarios() {
        found.extend(events::of_scenario(train, scenario));
    }
    found
}

/// How many couplers the load overloads by itself.
fn overloaded(train: &Train, load_n: &[f64]) -> Option<String> {
    let over = |(force, c): &(&f64, &Coupler)| **force > c.rated_draft_n || -**force > c.rated_buff_n;
    let over = load_n.iter().zip(train.couplers()).filter(over).count();
    let couplers = count(train.couplers().len(), "coupler");
    (over > 0).then(|| format!("the load is over the rating of {over} of {couplers} before anything happens"))
}

/// Couplers that are rated above the load that breaks them.
fn limit_order(train: &Train) -> Option<Doubt> {
    let rated = |c: &Coupler| [c.rated_draft_n, c.rated_buff_n];
    let above = |(limits, c): (&Limits, &Coupler)| -> Vec<usize> {
        let over = |side: &usize| limits.ultimate_n()[*side].is_some_and(|ultimate| rated(c)[*side] > ultimate);
        (0..2).filter(over).collect()
    };
    let sides = train.extras().limits.iter().zip(train.couplers()).map(above);
    let found: Vec<(usize, Vec<usize>)> = sides.enumerate().filter(|(_, sides)| !sides.is_empty()).collect();
    let (first, senses) = found.first()?;
    let sense = SENSES[senses[0]];
    let others = if found.len() > 1 { format!(", and of {} more", found.len() - 1) } else { String::new() };
    let text = format!(
        "the rating of coupler {} in {sense} is above its ultimate load in {sense}{others}: a coupler would break before it \
         reaches its rating; check both, or give limits.draft and limits.buff apart",
        first + 1
    );
    Some(Doubt::of_train("limit-order", text))
}

fn lengths(train: &Train) -> Option<Doubt> {
    let (with, without) = train.vehicles().iter().partition::<Vec<_>, _>(|v| v.length_m.is_some());
    let without: Vec<_> = without.into_iter().filter(|v| !v.held).collect();
    let text = format!(
        "no length is given for {}{}, so the train's length and the wave's speed over the ground are left out",
        without.first()?.label,
        more(without.len() - 1, "vehicle")
    );
    (!with.is_empty()).then(|| Doubt::of_train("some-lengths", text))
}
