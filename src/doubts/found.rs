//! Doubts that only an analysis can find.

use super::{Doubt, more};
use crate::findings::CaseFindings;
use crate::scenario::Scenario;
use crate::units::{Dimension, shown};

/// A gap at a broken coupler that closes in one of these cases of a scenario: what comes later is not computed.
pub fn closing_gap(scenario: &Scenario, cases: &[CaseFindings]) -> Option<Doubt> {
    let closes = |c: &CaseFindings| Some((c.cascade.as_ref()?.gap_closes_s?, c.cascade.as_ref()?.gap_coupler?));
    let mut closing = cases.iter().filter_map(|c| Some((closes(c)?, c.broken_coupler)));
    let ((time_s, coupler), broken) = closing.next()?;
    let after = match broken.filter(|_| cases.len() > 1) {
        Some(broken) => format!(" after the break of coupler {broken}{}", more(closing.count(), "case")),
        None => String::new(),
    };
    let text = format!(
        "the gap at coupler {coupler} closes at {}{after}: its vehicles would push each other from then on, which is not \
         computed, so that nothing later holds",
        shown(time_s, Dimension::Time)
    );
    Some(Doubt::of_scenario("gap-closes", scenario, text))
}
