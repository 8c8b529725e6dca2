//! What happens to the train, in sentences.

use super::numbers::given_force;
use super::words::{count, sense};
use crate::consist;
use crate::train::{Application, Event, Pulse, PulseShape, Scenario, Train};
use crate::units::{Dimension, shown, shown_time};

/// The event, in one sentence, and the brake applications and tractive efforts after it.
pub fn event(train: &Train, scenario: &Scenario) -> String {
    happens(train, scenario) + &consist::response(train, scenario)
}

fn happens(train: &Train, scenario: &Scenario) -> String {
    match &scenario.event {
        Event::Break { couplers } => match couplers[..] {
            [b] => {
                let load = train.initial_force_n()[b];
                let names = [b, b + 1].map(|v| train.vehicles()[v].label.as_str());
                let carried = match load {
                    0.0 => "which carries no force".to_owned(),
                    _ => format!("which carries {} in {}", given_force(train.origin().units, load), sense(load)),
                };
                format!("Coupler {}, between {} and {}, {carried}, breaks at t = 0.", b + 1, names[0], names[1])
            }
            _ if couplers.len() == train.couplers().len() => {
                "Each coupler in turn breaks at t = 0, always from the intact train.".to_owned()
            }
            _ => {
                let left_out = match scenario.left_out_in_buff.len() {
                    0 => String::new(),
                    n => format!("; {} that carry buff are left out, because nothing parts there", count(n, "coupler")),
                };
                format!("{} computed, each at t = 0 and from the intact train{left_out}.", are(couplers.len(), "break"))
            }
        },
        Event::Pulse(Pulse { vehicle, force_n, duration_s, shape }) => {
            let way = if *force_n < 0.0 { "backward" } else { "forward" };
            let label = &train.vehicles()[*vehicle].label;
            let (size, lasting) = (given_force(train.origin().units, *force_n), shown_time(*duration_s));
            let of = format!("vehicle {} ({label})", vehicle + 1);
            match shape {
                PulseShape::Rectangle => {
                    format!("A constant force of {size} acts {way} on {of} from t = 0 for {lasting}.")
                }
                shape => format!(
                    "A force pulls {of} {way} with up to {size} from t = 0 to {lasting}, its course over time: {}.",
                    shape.name()
                ),
            }
        }
        Event::Brake { from, emergency, application: a } => applied(train, from, *emergency, a),
        Event::Impact { vehicles, at_head, speed_m_per_s } => {
            let end = if *at_head { "head" } else { "tail" };
            let speed = shown(train.origin().units, *speed_m_per_s, Dimension::Speed);
            let before = match scenario.event.joint(train.vehicles().len()) {
                Some(joint) if train.initial_force_n().iter().any(|f| *f != 0.0) => {
                    format!(
                        "before the impact each part carries its own load, and coupler {}, which joins the parts, carries none",
                        joint + 1
                    )
                }
                _ => "no coupler carries a force before".to_owned(),
            };
            format!(
                "At t = 0 the {} at the {end} run into the others at {speed} and couple; the others stand, and {before}.",
                count(*vehicles, "vehicle")
            )
        }
    }
}

/// "1 break is", "2 breaks are".
fn are(n: usize, what: &str) -> String {
    format!("{} {}", count(n, what), if n == 1 { "is" } else { "are" })
}

fn applied(train: &Train, from: &[usize], emergency: bool, application: &Application) -> String {
    let what = if emergency { "Emergency" } else { "Service" };
    let (place, course) = (consist::place(train, from), consist::application(application, train.origin().units));
    format!("{what} brakes are applied from {place} at t = 0 ({course}).")
}
