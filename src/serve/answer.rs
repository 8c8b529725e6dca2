//! What the page asks for: a text analysed, with what the controls change in it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::State;
use super::controls::{Control, controls};
use super::edit::{self, Change};
use crate::consist::{self, Files};
use crate::error::{Diagnostic, InputError, printable_path};
use crate::findings::{self, Options};
use crate::report;
use crate::train::Train;

/// Analyses that take longer by their estimate are refused: a page waits for them.
const MOST_SECONDS: f64 = 10.0;

/// A text with changes, and what is to happen to the train.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Request {
    text: String,
    #[serde(default)]
    changes: Vec<Change>,
    /// Which scenario, from 0; the last where there are fewer.
    #[serde(default)]
    scenario: usize,
    /// The coupler, from 1, that breaks in place of what that scenario says.
    #[serde(rename = "break")]
    broken: Option<usize>,
    /// With the table of losses, which takes longer.
    #[serde(default)]
    losses: bool,
}

/// The answer; what could not be found is empty.
#[derive(Default, Serialize)]
pub(super) struct Reply {
    /// The text with the changes in it.
    text: String,
    /// What the reader says against it.
    problems: Vec<Marked>,
    /// How many more problems there are.
    more: usize,
    /// Why something was not done.
    messages: Vec<String>,
    controls: Vec<Control>,
    /// The scenarios' names.
    scenarios: Vec<String>,
    scenario: usize,
    couplers: usize,
    /// The report as HTML, and what its figures are drawn from as JSON.
    body: String,
    data: String,
    /// What the analysis took, and all of it with the report, ms.
    analysis_ms: f64,
    total_ms: f64,
}

/// A problem, with its places in the text as the page counts characters: in units of UTF-16.
#[derive(Serialize)]
struct Marked {
    #[serde(flatten)]
    problem: Diagnostic,
    /// Its own place and the others, where they are in the text itself and in no file that it names.
    marks: Vec<[usize; 2]>,
}

/// Answers a request; `None` where nobody waits for the answer any more.
pub(super) fn answer(state: &State, request: Request, cancelled: &AtomicBool) -> Option<Reply> {
    // One analysis at a time has all processors.
    let _turn = state.turn();
    if cancelled.load(Ordering::Relaxed) {
        return None;
    }
    let start = Instant::now();
    let mut reply = Reply { text: request.text.clone(), scenario: request.scenario, ..Reply::default() };
    for change in &request.changes {
        match edit::put(&reply.text, change) {
            Ok(text) => reply.text = text,
            Err(message) => reply.messages.push(message),
        }
    }
    if let Err(message) = analyse(state, &request, &mut reply) {
        reply.messages.push(message);
    }
    reply.total_ms = 1e3 * start.elapsed().as_secs_f64();
    Some(reply)
}

/// Reads the text, and analyses the train if it is one.
fn analyse(state: &State, request: &Request, reply: &mut Reply) -> Result<(), String> {
    let files = state.files().map_err(|e| format!("the train's folder cannot be read: {e}"))?;
    files.given(&state.path, &state.as_in_file(&reply.text));
    let tree: Option<Table> = reply.text.parse().ok();
    let train = match consist::parse_with(&reply.text, &state.path, &files) {
        Ok(train) => train,
        Err(error) => {
            // Controls stay on the page, so that they can correct a wrong value.
            reply.controls = tree.map_or_else(Vec::new, |tree| controls(&tree, Some(reply.scenario)));
            mark(state, &error, reply);
            return Ok(());
        }
    };
    reply.couplers = train.couplers().len();
    reply.scenarios = train.scenarios().iter().map(|s| s.name.clone()).collect();
    reply.scenario = request.scenario.min(train.scenarios().len() - 1);
    let Some(tree) = tree else { return Err("the text is not TOML".to_owned()) };
    reply.controls = controls(&tree, Some(reply.scenario).filter(|_| request.broken.is_none()));
    let train = match request.broken {
        None => train.with_only(reply.scenario),
        Some(coupler) => broken(state, tree, reply.scenario, coupler, &files)?,
    };
    let options = Options { damping: request.losses, ..Options::default() };
    let seconds = findings::estimate_s(&train, &options).map_err(|e| e.to_string())?;
    if seconds > MOST_SECONDS {
        return Err(format!(
            "this would take about {seconds:.0} s, and at most {MOST_SECONDS:.0} s are spent on a page that waits: break one \
             coupler, name fewer, shorten the horizon, or type trainsafe analyze"
        ));
    }
    let start = Instant::now();
    let analysis = findings::analyze(&train, &options).map_err(|e| e.to_string())?;
    reply.analysis_ms = 1e3 * start.elapsed().as_secs_f64();
    (reply.body, reply.data) = report::shown_live(&train, &analysis).map_err(|e| e.to_string())?;
    Ok(())
}

/// The train with the break of one coupler for its scenario, which has all else that the scenario at `index` has if that is a break.
fn broken(state: &State, mut tree: Table, index: usize, coupler: usize, files: &Files) -> Result<Train, String> {
    let kind = ("kind".to_owned(), Value::from("break"));
    let given = tree.get("scenario").and_then(|all| all.as_array()?.get(index)?.as_table());
    let alike = given.filter(|s| s.get("kind").and_then(Value::as_str) == Some("break"));
    let mut scenario = alike.cloned().unwrap_or_else(|| Table::from_iter([kind]));
    scenario.remove("name");
    scenario.insert("coupler".to_owned(), Value::Integer(i64::try_from(coupler).unwrap_or(i64::MAX)));
    tree.insert("scenario".to_owned(), Value::Array(vec![Value::Table(scenario)]));
    let text = toml::to_string(&tree).map_err(|e| e.to_string())?;
    // The places are not those of the text on the page, so they are left out.
    consist::parse_with(&text, &state.path, files).map_err(|e| e.titles())
}

/// Puts the reader's problems into the reply.
fn mark(state: &State, error: &InputError, reply: &mut Reply) {
    let text = &reply.text;
    let units = |byte: usize| {
        let byte = (0..=byte.min(text.len())).rev().find(|&b| text.is_char_boundary(b)).unwrap_or(0);
        text[..byte].encode_utf16().count()
    };
    let here = printable_path(&state.path);
    let (problems, more) = error.problems();
    let marked = |problem: Diagnostic| {
        let places = problem.place.iter().chain(problem.related.iter().map(|r| &r.place));
        let marks = places.filter(|_| problem.path == here).map(|p| p.span.map(units)).collect();
        Marked { problem, marks }
    };
    reply.problems = problems.into_iter().map(marked).collect();
    reply.more = more;
}
