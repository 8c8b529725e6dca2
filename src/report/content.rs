//! The report on an analysis, as blocks: its sections, then what they rest on.

use super::block::Side::{Left, Right};
use super::block::{Block, Span, lines};
use super::groups::{self, Groups};
use super::pictures::Shown;
use super::section::{overview, section};
use super::train_facts::train_facts;
use super::{assumptions, words};
use crate::findings::Analysis;
use crate::scenario::is_proportional;
use crate::train::Train;

/// The whole report; `shown` is what is drawn of each scenario.
pub fn content(train: &Train, analysis: &Analysis, shown: &[Option<Shown>]) -> Vec<Block> {
    let scenarios = &analysis.scenarios;
    let several = scenarios.len() > 1;
    let mut all = vec![Block::Title(train.name().to_owned())];
    all.extend(analysis.doubts.iter().map(|doubt| Block::Note(doubt.to_string())));
    all.extend(several.then(|| overview(train, scenarios)));
    for (i, (scenario, shown)) in scenarios.iter().zip(shown).enumerate() {
        all.extend(several.then(|| Block::Heading(scenario.name.clone(), Some(i))));
        all.extend(section(train, scenario, i, several, shown.as_ref()));
    }
    all.push(heading("The train"));
    let facts = train_facts(train).into_iter().map(Vec::from).collect();
    all.push(Block::table("", &[], facts));
    all.extend([groups::vehicles(train), groups::couplers(train)].into_iter().flat_map(group));
    all.extend(meaning());
    all.extend(model(train, analysis));
    all.extend(origin(analysis));
    all
}

fn heading(text: &str) -> Block {
    Block::Heading(text.to_owned(), None)
}

fn group(groups: Groups) -> impl Iterator<Item = Block> {
    let Groups { of, head, rows, more } = groups;
    let head: Vec<_> = head.into_iter().map(|name| (name, Right)).collect();
    let left_out = format!("{more} more groups are not shown; the train file has all.");
    std::iter::once(Block::table(of, &head, rows)).chain((more > 0).then(|| Block::plain(left_out)))
}

fn meaning() -> [Block; 2] {
    let mut files = vec![Span::Link("couplers.csv")];
    files.extend(lines(" lists every coupler, except a broken one and those that --verdict-only leaves out. "));
    files.push(Span::Link("result.json"));
    files
        .extend(lines(" is for programs; for a\nscenario with several cases it holds the worst coupler of each case."));
    let points = vec![
        lines(
            "Demand is the force, in draft (tension) or buff (compression), that uses the largest share of the coupler's rating in that sense.\n\
             Utilisation is that share.",
        ),
        lines(
            "Capacity is the rated load that the train file gives for each coupler in draft and in buff; where it gives none for buff, the rating in\n\
             draft is used for both. Compare it with the knuckle and coupler-body\n\
             loads of AAR M-211 or the categories of EN 15566, whichever governs the equipment. Compliance with a standard is neither checked nor claimed.",
        ),
        files,
    ];
    [heading("What the numbers mean"), Block::List(points)]
}

const MODES: &str = "\
Couplers are linear springs. Every mode of vibration has the same damping ratio, which no device in a train has: a coupler's force is its
spring's. There is no slack and no draft-gear hysteresis; vehicles are rigid masses on a straight line.";
const DASHPOTS: &str = "\
Couplers are linear springs with linear dashpots beside them, whose force counts as the coupler's. There is no slack and no draft-gear
hysteresis; vehicles are rigid masses on a straight line. The force of a dashpot follows the speed without delay: in an impact it jumps.";
const LAWS: &str = "\
A coupler's force follows from its elongation, the table of its gear and the gear's travel, which it remembers: it rises along the
loading curve and falls along the unloading curve; between them the gear is locked, and only the parts in series with it deform. The
force does not depend on the speed. Vehicles are rigid masses on a straight line.";
const SPRINGS: &str = "Couplers are linear springs. There is no slack, no damping and no draft-gear hysteresis; vehicles are rigid masses on a straight line.";
const CASCADE: &str = "\
Where what breaks next is followed, a coupler breaks at the instant at which its force passes its ultimate load, or its rating where
no ultimate load was given; couplers whose instants of breaking cannot be told apart break together. ";
const MEETING: &str = "Parted pieces push\neach other when they meet again.";
const NO_MEETING: &str =
    "Parted\npieces do not push each other when they meet again; the report says when that happens.";
const NO_CASCADE: &str =
    "A coupler that exceeds its rating is reported and does not break: the calculation goes on with it.";

/// What the model leaves out.
fn model(train: &Train, analysis: &Analysis) -> [Block; 3] {
    let ran: Vec<_> = analysis.scenarios.iter().filter_map(|s| words::source(train, s)).map(|(_, s)| s).collect();
    let couplers = match train.extras() {
        extras if !extras.dashpot_n_s_per_m.is_empty() => DASHPOTS,
        extras if extras.damping_ratio > 0.0 => MODES,
        extras if !extras.laws.is_empty() => LAWS,
        _ => SPRINGS,
    };
    let cascades = analysis.scenarios.iter().flat_map(|s| &s.cases).any(|c| c.cascade.is_some());
    let marched = ran.iter().any(|s| !is_proportional(train, s));
    let breaks = match (cascades, marched) {
        (true, true) => CASCADE.to_owned() + MEETING,
        (true, false) => CASCADE.to_owned() + NO_MEETING,
        (false, _) => NO_CASCADE.to_owned(),
    };
    let head = [("left out or assumed", Left), ("real draft", Left), ("real buff", Left), ("why", Left)];
    let rows = assumptions::rows(train, &ran).into_iter().map(|row| row.map(str::to_owned).to_vec()).collect();
    [
        heading("What the model leaves out, and on which side that errs"),
        Block::List(vec![lines(couplers), lines(&breaks)]),
        Block::table("The real forces against those of this report", &head, rows),
    ]
}

/// The program, the options that decide the numbers, and every file that was read.
fn origin(analysis: &Analysis) -> [Block; 3] {
    let method = analysis.options.method.map_or("chosen by the program".to_owned(), |m| format!("{m}, as asked for"));
    let made = format!(
        "Made by {} {} on {}; tolerance {:e} of the largest rating, method {method}, results of schema {}.",
        analysis.program.name,
        analysis.program.version,
        analysis.date,
        analysis.options.tolerance,
        analysis.schema_version
    );
    let rows = analysis.inputs.iter().map(|f| vec![f.path.clone(), f.sha256.clone()]).collect();
    [
        heading("What this report was made from"),
        Block::plain(made),
        Block::table("", &[("file", Left), ("SHA-256", Left)], rows),
    ]
}
