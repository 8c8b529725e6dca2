//! What the model leaves out or assumes, and on which side of the real forces that errs for this train and its events.

use crate::law::Law;
use crate::scenario::is_proportional;
use crate::train::{Event, Rule, Scenario, Train};

/// An assumption with its effect: what it is, the real draft and the real buff against those of the report, and why.
pub type Row = [&'static str; 4];

const LESS: &str = "smaller";
const MOSTLY_LESS: &str = "mostly smaller";
const MORE: &str = "larger";
const EITHER: &str = "smaller or larger";
const UNKNOWN: &str = "not known";

const NONE: &str = "no effect";

const REFLECTIONS: &str = "a real train loses force at every reflection; the table of losses shows how much";
const MODES: &str = "no device in a train does this; dashpots of the same ratio reduce the force less";
const CONTACT: &str = "at the instant of contact the force of a draft gear begins at 0";
const FRICTION: &str = "a friction gear absorbs up to 87 % of the work; but a train that was let down from a larger pull can reach more than this report says";
const CLOSING: &str = "a friction gear absorbs up to 87 % of the work; but one that closes in a collision is stiffer than a spring: the table of other couplers shows what generic gears do here";
const TABLES: &str = "friction gears of one type differ from test to test, and friction falls with speed; compute with two tables to see the range";
const SLACK: &str = "free play lets vehicles run together: in a computed train of 105 loaded cars with springs it raised the largest force from 1.53 to 1.88 times the pull; with friction gears it did not";
const BRAKES: &str = "the brake pipe vents where the train parts, and both parts brake from there: the largest force is then often in buff, behind the gap, seconds later";
const POWER: &str = "the driver or the open brake pipe ends the tractive effort within some seconds";
const GAP: &str = "a part that runs into another is not computed; the report says when a gap closes";
const STEADY: &str = "in a running train they vary; by how much depends on how it is driven";
const INERTIA: &str =
    "the force at the car body is larger than the coupler's, by the inertia of the parts between them";
const TRACK: &str = "curves and changes of grade alter the forces along the train";
const DERAILMENT: &str = "not computed; derailment is not assessed";

/// The assumptions that bear on these scenarios.
pub fn rows(train: &Train, scenarios: &[&Scenario]) -> Vec<Row> {
    let any = |test: fn(&Event) -> bool| scenarios.iter().any(|s| test(&s.event));
    let breaks = any(|e| matches!(e, Event::Break { .. })) || scenarios.iter().any(|s| s.cascade != Rule::Keep);
    let impact = any(|e| matches!(e, Event::Impact { .. }));
    let dashpots = !train.extras().dashpot_n_s_per_m.is_empty();
    let damped = dashpots || train.extras().damping_ratio > 0.0;
    let hauled = train.extras().steady.is_some();
    let springs = train.extras().laws.is_empty();
    let gears = train.extras().laws.iter().any(|law| matches!(law, Law::Gear { .. }));
    let slack = train.extras().laws.iter().any(|law| law.slack_m() > 0.0);
    let braked = scenarios.iter().all(|s| s.response.emergency.is_some() || !matches!(s.event, Event::Break { .. }));
    let some = scenarios.iter().any(|s| s.response.emergency.is_some());
    let emergency = if some {
        "no emergency brake after a parting, in the scenarios that give none"
    } else {
        "no emergency brake after a parting"
    };
    let powered = scenarios.iter().all(|s| s.response.efforts.is_empty());
    let marched = scenarios.iter().all(|s| !is_proportional(train, s));
    let when = |bears: bool, row: Row| bears.then_some(row);
    let rows = [
        when(!damped && !gears && !impact, ["no losses in the couplers", LESS, LESS, REFLECTIONS]),
        when(!damped && !gears && impact, ["no losses in the couplers", MOSTLY_LESS, MOSTLY_LESS, REFLECTIONS]),
        when(train.extras().damping_ratio > 0.0, ["the same damping ratio in every mode", EITHER, EITHER, MODES]),
        when(dashpots && impact, ["a dashpot's force follows the speed at once", UNKNOWN, LESS, CONTACT]),
        when(!gears && !impact, ["no friction in the draft gears", MOSTLY_LESS, MOSTLY_LESS, FRICTION]),
        when(!gears && impact, ["no friction in the draft gears", MOSTLY_LESS, EITHER, CLOSING]),
        when(!slack && springs, ["no slack", EITHER, MORE, SLACK]),
        when(gears, ["a gear's force follows its table at any speed", EITHER, EITHER, TABLES]),
        when(breaks && !braked, [emergency, MORE, MORE, BRAKES]),
        when(breaks && hauled && powered, ["locomotives keep pulling after the event", LESS, UNKNOWN, POWER]),
        when(breaks && !marched, ["parted pieces do not push each other", NONE, MORE, GAP]),
        when(true, ["the forces before the event are constant", EITHER, EITHER, STEADY]),
        when(true, ["couplers have no mass of their own", MORE, MORE, INERTIA]),
        when(true, ["a straight track, and a grade under each vehicle that does not change", UNKNOWN, UNKNOWN, TRACK]),
        when(true, ["no vertical and no lateral motion", UNKNOWN, UNKNOWN, DERAILMENT]),
    ];
    rows.into_iter().flatten().collect()
}
