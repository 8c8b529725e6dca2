//! The page: the report's own, with an editor and controls beside it.

use super::State;
use super::save::OnDisk;
use crate::error::printable_path;
use crate::figures::escaped;
use crate::report::html::{Frame, in_script};

const STYLE: &str = include_str!("live.css");
const SCRIPT: &str = include_str!("live.js");
const BODY: &str = include_str!("live.html");

/// The page with the train file that is on the disk; the report comes with the first answer.
pub(super) fn page(state: &State, on_disk: &OnDisk) -> String {
    let name = printable_path(&state.path);
    let file = serde_json::to_string(on_disk).unwrap_or_default();
    // The file comes last, so that nothing in it is taken for a placeholder.
    let body = BODY.replace("{name}", &escaped(&name)).replace("{file}", &in_script(&file));
    Frame { title: &name, style: STYLE, body: &body, data: "[]", script: Some(SCRIPT) }.page()
}
