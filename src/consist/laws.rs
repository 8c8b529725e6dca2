//! What tables say of a coupler's force over its elongation: a stiffness, or a gear with what is in series; slack beside either.

use std::path::Path;
use std::sync::Arc;

use super::Files;
use super::gears::{self, Gear};
use super::tree::{Read, Table};
use crate::law::Law;

/// The keys of a law, in `[coupler]` or an override.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LawKeys {
    pub(super) stiffness_n_per_m: Option<f64>,
    stiffness_in_buff_n_per_m: Option<f64>,
    slack_m: Option<f64>,
    gear: Option<Arc<Gear>>,
    gear_in_buff: Option<Arc<Gear>>,
    friction: Option<f64>,
    solid_n_per_m: Option<f64>,
}

/// What is wrong with a law: the key that shows it, what it is and what would be right.
type Wrong = (&'static str, String, String);

/// Keys that need a gear.
const OF_GEARS: [&str; 3] = ["gear_in_buff", "friction", "solid_stiffness"];

impl LawKeys {
    /// A coupler that is one linear spring.
    pub(super) const fn linear(stiffness_n_per_m: f64) -> LawKeys {
        LawKeys {
            stiffness_n_per_m: Some(stiffness_n_per_m),
            stiffness_in_buff_n_per_m: None,
            slack_m: None,
            gear: None,
            gear_in_buff: None,
            friction: None,
            solid_n_per_m: None,
        }
    }

    /// Reads the keys of a table; files that it names stand beside the train file `path`.
    pub(super) fn read(table: &Table, path: &Path, files: &Files) -> Read<LawKeys> {
        let quantity = |key| table.get(key).map(|v| v.quantity()).transpose();
        let gear = |key| table.get(key).map(|v| gears::read(&v, path, files)).transpose();
        let [stiffness, in_buff] = ["stiffness", "stiffness_in_buff"].map(quantity);
        let [slack, friction, solid] = ["slack", "friction", "solid_stiffness"].map(quantity);
        let [draft, buff] = ["gear", "gear_in_buff"].map(gear);
        if let (Some(stiffness), Some(gear)) = (table.key_span("stiffness"), table.key_span("gear")) {
            let help = "keep one of them: a gear's stiffness follows from its table, and that of what is in series is solid_stiffness";
            return Err(table.note_because(stiffness, "stiffness beside a gear", help, gear, "the gear"));
        }
        let keys = LawKeys {
            stiffness_n_per_m: stiffness?,
            stiffness_in_buff_n_per_m: in_buff?,
            slack_m: slack?,
            gear: draft?,
            gear_in_buff: buff?,
            friction: friction?,
            solid_n_per_m: solid?,
        };
        if keys.friction.is_some_and(|share| share > 1.0)
            && let Some(value) = table.get("friction")
        {
            return Err(value.wrong("friction is over 100 %", "expected a share from 0 to 100 %"));
        }
        Ok(keys)
    }

    /// Whether it has a stiffness or a gear, one of which every coupler needs.
    pub(super) fn gives_force(&self) -> bool {
        self.stiffness_n_per_m.is_some() || self.gear.is_some()
    }

    /// Whether it says anything.
    pub(super) fn gives_anything(&self) -> bool {
        *self != LawKeys::default()
    }

    /// These keys, and those of `base` that are not among them. A stiffness replaces the base's gear with all that
    /// belongs to it, a gear the base's stiffness, and a table with unloading the base's friction.
    pub(super) fn or(&self, base: &LawKeys) -> LawKeys {
        let spring = self.stiffness_n_per_m.is_some();
        let gear = self.gear.is_some();
        let unloads = self.gear.as_ref().is_some_and(|gear| gear.has_unloading());
        let (of_gear, of_spring) = (if spring { None } else { Some(base) }, if gear { None } else { Some(base) });
        LawKeys {
            stiffness_n_per_m: self.stiffness_n_per_m.or(of_spring.and_then(|b| b.stiffness_n_per_m)),
            stiffness_in_buff_n_per_m: self
                .stiffness_in_buff_n_per_m
                .or(of_spring.and_then(|b| b.stiffness_in_buff_n_per_m)),
            slack_m: self.slack_m.or(base.slack_m),
            gear: self.gear.clone().or(of_gear.and_then(|b| b.gear.clone())),
            gear_in_buff: self.gear_in_buff.clone().or(of_gear.and_then(|b| b.gear_in_buff.clone())),
            friction: self.friction.or(of_gear.filter(|_| !unloads).and_then(|b| b.friction)),
            solid_n_per_m: self.solid_n_per_m.or(of_gear.and_then(|b| b.solid_n_per_m)),
        }
    }

    /// The law.
    ///
    /// # Errors
    /// Keys that do not go together.
    pub(super) fn law(&self) -> Result<Law, Wrong> {
        let slack_m = self.slack_m.unwrap_or(0.0);
        let Some(gear) = &self.gear else {
            let given = [self.gear_in_buff.is_some(), self.friction.is_some(), self.solid_n_per_m.is_some()];
            if let Some((key, _)) = OF_GEARS.into_iter().zip(given).find(|(_, given)| *given) {
                let help = "add gear = \"gear.csv\" in the place of stiffness, or leave it out";
                return Err((key, format!("{key} without a gear"), help.to_owned()));
            }
            let draft = self.stiffness_n_per_m.unwrap_or(1.0);
            let buff_n_per_m = self.stiffness_in_buff_n_per_m.unwrap_or(draft);
            return Ok(Law::Elastic { draft_n_per_m: draft, buff_n_per_m, slack_m });
        };
        if self.stiffness_in_buff_n_per_m.is_some() {
            let help = "give the table of buff with gear_in_buff = \"buffers.csv\"";
            return Err(("stiffness_in_buff", "stiffness_in_buff beside a gear".to_owned(), help.to_owned()));
        }
        let Some(solid_n_per_m) = self.solid_n_per_m else {
            let help = "add solid_stiffness = \"200 MN/m\", the stiffness of the parts in series with the gear (when it is locked or closed)";
            return Err(("gear", "a gear without solid_stiffness".to_owned(), help.to_owned()));
        };
        self.friction_is_used(gear)?;
        let curve = |key, gear: &Gear| gear.curve(self.friction).map_err(|[title, help]| (key, title, help));
        let draft = curve("gear", gear)?;
        let buff = self.gear_in_buff.as_ref().map_or(Ok(draft.clone()), |gear| curve("gear_in_buff", gear))?;
        Ok(Law::Gear { solid_n_per_m, slack_m, draft, buff })
    }

    fn friction_is_used(&self, gear: &Gear) -> Result<(), Wrong> {
        let all_unload = gear.has_unloading() && self.gear_in_buff.as_ref().is_none_or(|gear| gear.has_unloading());
        if self.friction.is_none() || !all_unload {
            return Ok(());
        }
        let title = "friction beside a gear that has forces of unloading".to_owned();
        Err(("friction", title, "keep one of them: friction stands for the column unloading".to_owned()))
    }
}
