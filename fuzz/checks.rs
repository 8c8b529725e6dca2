//! What must hold of any input, however it came about. The replay in `tests/` uses this file too.

use std::fs;
use std::path::Path;

use serde_json::Value;
use trainsafe::consist;
use trainsafe::doubts;
use trainsafe::error::InputError;
use trainsafe::findings::{self, CaseFindings, CouplerFindings, Options};
use trainsafe::fleet::base::Base;
use trainsafe::fleet::{study, variation};
use trainsafe::report;
use trainsafe::train::Train;

/// A train is analysed if that should take no longer than this, s.
const BRIEF_S: f64 = 0.02;
/// The largest train whose analysis is looked at when it comes as text.
const SMALL: usize = 60;

/// A train file that refers to a table and a record beside it.
const BESIDE: &str = "vehicles = \"table.csv\"\n\
    [coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1.5 MN\"\n\
    [[scenario]]\nkind = \"break\"\ncoupler = 1\n\
    [[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"record.csv\"\n";
const TABLE: &str = "label,count,mass [t],held\nlocomotive,1,195,yes\ncar,5,160,\n";
const RECORD: &str = "time_ms,force_kn\n0,0\n10,-800\n40,0\n";

/// A train file is read or refused with a message.
pub fn train_file(bytes: &[u8]) {
    // A train file names others: those that stand beside this one are right.
    with_files(TABLE.as_bytes(), RECORD.as_bytes(), |dir| {
        let file = dir.join("train.toml");
        match std::str::from_utf8(bytes) {
            Ok(text) => read(consist::parse(text, &file)),
            Err(_) => {
                fs::write(&file, bytes).expect("a temporary file");
                read(consist::read(&file));
            }
        }
    });
}

/// So is a table of vehicles.
pub fn csv_table(bytes: &[u8]) {
    with_files(bytes, RECORD.as_bytes(), |dir| read(consist::parse(BESIDE, &dir.join("train.toml"))));
}

/// So is a record of a pulse.
pub fn pulse_record(bytes: &[u8]) {
    with_files(TABLE.as_bytes(), bytes, |dir| read(consist::parse(BESIDE, &dir.join("train.toml"))));
}

/// So is a study, and its variations make trains or say why not.
pub fn study_file(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    study::is_study(text);
    match study::parse(text, Path::new("study.toml")) {
        Ok(study) => {
            let last = study.variations().saturating_sub(1);
            for number in [0, last / 2, last] {
                let base = Base::of_text(Path::new("train.toml"), consist::TEMPLATE);
                let varied = variation::vary(&study, number, &base, &variation::Reached::new());
                assert_eq!(varied.cells.len(), study.inputs.len());
                assert_eq!(variation::headings(&study).len(), study.inputs.len());
            }
        }
        Err(error) => said(&error),
    }
}

fn with_files(table: &[u8], record: &[u8], run: impl FnOnce(&Path)) {
    let dir = tempfile::tempdir().expect("a temporary folder");
    fs::write(dir.path().join("table.csv"), table).expect("a temporary file");
    fs::write(dir.path().join("record.csv"), record).expect("a temporary file");
    run(dir.path());
}

fn read(train: Result<Train, InputError>) {
    match train {
        Ok(train) => {
            plain(&consist::describe(&train));
            if train.vehicles().len() <= SMALL {
                analysis(&train, &Options::default(), BRIEF_S);
            }
        }
        Err(error) => said(&error),
    }
}

/// A message says something, and nothing that a terminal would obey.
fn said(error: &InputError) {
    assert!(error.render(true).len() > 20 && error.brief().len() > 10);
    plain(&error.to_string());
    plain(&error.brief());
}

fn plain(text: &str) {
    let obeyed = |c: char| {
        c != '\n'
            && (c.is_control() || ('\u{202a}'..='\u{202e}').contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c))
    };
    assert!(!text.contains(obeyed), "a terminal would obey: {text:?}");
}

/// The whole analysis of a train, and the texts of its report, if it should take no longer than `most_s`.
pub fn analysis(train: &Train, options: &Options, most_s: f64) {
    doubts::doubts(train);
    match findings::estimate_s(train, options) {
        Ok(seconds) if seconds <= most_s => {}
        Ok(seconds) => return assert!(seconds.is_finite()),
        Err(refused) => return words(&refused.to_string()),
    }
    let analysis = match findings::analyze(train, options) {
        Ok(analysis) => analysis,
        Err(refused) => return words(&refused.to_string()),
    };
    assert_eq!(analysis.scenarios.len(), train.scenarios().len());
    for scenario in &analysis.scenarios {
        for case in &scenario.cases {
            of_case(train, case, options);
        }
        for point in scenario.map.iter().flat_map(|m| &m.points) {
            assert!(
                point.at.is_finite() && point.chain.is_none_or(f64::is_finite) && point.rod.is_none_or(f64::is_finite)
            );
        }
    }
    of_texts(train, &analysis);
}

/// A text without a number that is none.
fn words(text: &str) {
    let none = |word: &str| ["NaN", "inf", "-inf", "nan"].contains(&word);
    assert!(!text.split(|c: char| !c.is_alphanumeric() && c != '-').any(none), "{text}");
}

fn of_case(train: &Train, case: &CaseFindings, options: &Options) {
    let at = |what: &str| format!("{what}: {case:?}");
    // No time passes where no coupler is left.
    let followed =
        if case.couplers.len() + case.left_out == 0 { case.horizon_s.to_bits() == 0 } else { case.horizon_s > 0.0 };
    assert!(followed && case.horizon_s.is_finite(), "{}", at("horizon"));
    assert!(case.error_n() >= 0.0 && case.error_n().is_finite(), "{}", at("bound"));
    assert_eq!(case.error_bound_n.is_finite(), case.error_estimate_n.is_none(), "{}", at("a proof or an estimate"));
    assert!(case.tolerance_n > 0.0 && case.run_time_s >= 0.0, "{}", at("tolerance"));
    for c in &case.couplers {
        of_coupler(c, case);
    }
    let count = |verdict| case.couplers.iter().filter(|c| c.exceeds == verdict).count();
    assert_eq!(case.exceeding, count(Some(true)), "{}", at("exceeding"));
    assert_eq!(case.undecided, count(None), "{}", at("undecided"));
    let others = train.couplers().len() - usize::from(case.broken_coupler.is_some());
    assert_eq!(case.couplers.len() + case.left_out, others, "{}", at("couplers"));
    assert!(options.verdict_only || case.left_out == 0);
    let most = case.couplers.iter().map(|c| c.utilisation).fold(0.0, f64::max);
    let least_rating = |c: &CouplerFindings| c.rated_draft_n.min(c.rated_buff_n);
    assert_eq!(case.worst.is_some(), !case.couplers.is_empty());
    if let Some(worst) = &case.worst {
        assert!(worst.utilisation + case.error_n() / least_rating(worst) >= most, "{}", at("worst"));
    }
    if let Some(factor) = case.safe_load_factor {
        assert!(factor >= 0.0 && factor.is_finite(), "{}", at("safe load"));
        // The factor is a quotient of rounded numbers.
        assert!(case.exceeding == 0 || factor <= 1.0 + 1e-12, "{}", at("exceeds within the safe load"));
        let safe = case.exceeding + case.undecided == 0;
        assert!(!safe || factor >= 1.0 - 1e-12, "{}", at("safe beyond the safe load"));
    }
    if let Some(rod) = &case.rod {
        assert!(rod.utilisation.is_finite() && rod.utilisation >= 0.0, "{}", at("rod"));
    }
    of_cascade(train, case);
}

fn of_coupler(c: &CouplerFindings, case: &CaseFindings) {
    let at = |what: &str| format!("{what}: {c:?}, bound {:e}", case.error_n());
    let within = |t: f64| (0.0..=case.horizon_s).contains(&t);
    assert!(c.initial_force_n.is_finite() && c.utilisation.is_finite(), "{}", at("no number"));
    assert!(c.peak_draft_n.is_none_or(|f| f > 0.0 && f.is_finite()), "{}", at("draft"));
    assert!(c.peak_buff_n.is_none_or(|f| f < 0.0 && f.is_finite()), "{}", at("buff"));
    assert_eq!(c.peak_draft_n.is_some(), c.peak_draft_time_s.is_some(), "{}", at("time of draft"));
    assert_eq!(c.peak_buff_n.is_some(), c.peak_buff_time_s.is_some(), "{}", at("time of buff"));
    let times = [Some(c.peak_time_s), c.peak_draft_time_s, c.peak_buff_time_s, c.first_exceeds_s];
    assert!(times.into_iter().flatten().all(within), "{}", at("time"));
    let (draft, buff) = (c.peak_draft_n.unwrap_or(0.0), -c.peak_buff_n.unwrap_or(0.0));
    assert!(draft >= c.initial_force_n && buff >= -c.initial_force_n, "{}", at("less than before the event"));
    let (in_draft, in_buff) = (draft / c.rated_draft_n, buff / c.rated_buff_n);
    assert_eq!(c.utilisation, in_draft.max(in_buff), "{}", at("utilisation"));
    assert_eq!(c.peak_force_n, if in_buff > in_draft { -buff } else { draft }, "{}", at("peak"));
    let over = [draft - c.rated_draft_n, buff - c.rated_buff_n];
    assert_eq!(c.exceeds == Some(true), c.first_exceeds_s.is_some(), "{}", at("first exceedance"));
    assert_eq!(c.first_exceeds_s.is_some(), c.first_exceeds_in.is_some(), "{}", at("sense of the first exceedance"));
    match c.exceeds {
        Some(exceeds) => assert_eq!(exceeds, over.iter().any(|&o| o > 0.0), "{}", at("verdict")),
        // The bound, and the rounding of the difference.
        None => {
            let near = |(o, rating): (f64, f64)| o.abs() <= case.margin_n() * (1.0 + 1e-12) + 1e-15 * rating;
            assert!(near((over[0], c.rated_draft_n)) || near((over[1], c.rated_buff_n)), "{}", at("decided after all"));
        }
    }
    let largest = draft.max(buff);
    if let Some(bound) = c.all_time_bound_n {
        assert!(bound >= largest - case.error_n() && bound.is_finite(), "{}", at("bound over all time"));
    }
    if let Some(limits) = &c.limits {
        assert_eq!(limits.largest_n, largest, "{}", at("limits"));
    }
}

fn of_cascade(train: &Train, case: &CaseFindings) {
    let Some(cascade) = &case.cascade else { return };
    let at = |what: &str| format!("{what}: {cascade:?}");
    let mut gone: Vec<usize> = case.broken_coupler.into_iter().collect();
    let mut before = 0.0;
    for b in &cascade.breaks {
        assert!(b.time_s >= before && b.time_s <= case.horizon_s, "{}", at("time"));
        // A march tells neither how well an instant is known nor what a gear sets free.
        let marched = case.method == "march";
        let known = |x: f64| x >= 0.0 && x.is_finite();
        assert!(known(b.time_uncertainty_s) || marched, "{}", at("uncertainty"));
        assert!((known(b.energy_j) || marched) && b.force_n.is_finite(), "{}", at("energy"));
        assert!(!gone.contains(&b.coupler), "{}", at("twice"));
        gone.push(b.coupler);
        before = b.time_s;
    }
    assert_eq!(cascade.pieces.len(), gone.len() + 1, "{}", at("pieces"));
    let mut next = 1;
    for &[first, last] in &cascade.pieces {
        assert!(first == next && last >= first, "{}", at("piece"));
        next = last + 1;
    }
    assert_eq!(next, train.vehicles().len() + 1, "{}", at("pieces"));
    assert!(cascade.undecided_from_s.is_none_or(|t| t >= 0.0 && t <= case.horizon_s), "{}", at("undecided"));
    assert!(cascade.undecided_from_s.is_some() || cascade.undecided_coupler.is_none());
    assert!(cascade.error_n() >= 0.0 && cascade.error_n().is_finite(), "{}", at("bound"));
}

/// Fields of `result.json` that may be null.
const MAY_BE_NULL: [&str; 20] = [
    "broken_coupler",
    "error_bound_n",
    "error_estimate_n",
    "predictable_until_s",
    "stopped_vehicle",
    "stopped_at_s",
    "time_uncertainty_s",
    "energy_j",
    "safe_load_factor",
    "worst",
    "peak_draft_n",
    "peak_draft_time_s",
    "peak_buff_n",
    "peak_buff_time_s",
    "exceeds",
    "first_exceeds_s",
    "first_exceeds_in",
    "undecided_from_s",
    "undecided_coupler",
    "chain",
];

fn of_texts(train: &Train, analysis: &findings::Analysis) {
    let named = train
        .vehicles()
        .iter()
        .map(|v| v.label.as_str())
        .chain(train.scenarios().iter().map(|s| s.name.as_str()))
        .chain([train.name()]);
    let odd_names = named.into_iter().any(|n| ["nan", "inf"].iter().any(|w| n.to_lowercase().contains(w)));
    let terminal = report::terminal(analysis, &[]);
    plain(&terminal);
    let documents =
        report::documents(train, analysis, &[report::Format::Markdown, report::Format::Html]).expect("a report");
    for (name, content) in &documents {
        let mut text = std::str::from_utf8(content).expect("UTF-8");
        if name == "report.html" {
            text = of_page(text);
        }
        assert!(name.bytes().all(|b| b.is_ascii_alphanumeric() || b"-.".contains(&b)), "{name}");
        // Only numbers of the program's own are meant.
        if !odd_names {
            words(text);
        }
    }
    if !odd_names {
        words(&terminal);
    }
    let of = |name: &str| &documents.iter().find(|(n, _)| n == name).expect(name).1[..];
    let json: Value = serde_json::from_slice(of("result.json")).expect("JSON");
    nulls("", &json);
    agree(&json, of("couplers.csv"));
}

/// No name becomes an element or an address of the page, and its data can be read; the page without its scripts.
fn of_page(page: &str) -> &str {
    let (shown, scripts) = page.split_once("<script type=\"application/json\" id=\"data\">").expect("data");
    let (data, scripts) = scripts.split_once("</script>").expect("an end of the data");
    assert!(scripts.trim_start().starts_with("<script type=\"text/plain\" id=\"library\">"), "what follows the data");
    serde_json::from_str::<Value>(data).expect("JSON in the page");
    let lower = shown.to_lowercase();
    let elements = ["<script", "<iframe", "<object", "<embed", "<link", "<base", "<form", "javascript:"];
    assert!(!elements.iter().any(|e| lower.contains(e)), "a name became an element: {shown}");
    shown
}

fn nulls(key: &str, value: &Value) {
    match value {
        Value::Null => assert!(
            MAY_BE_NULL.contains(&key)
                || ["rod", "scenario", "method", "first_passage", "worst_first_passage"].contains(&key),
            "{key} is null"
        ),
        Value::Array(items) => items.iter().for_each(|item| nulls(key, item)),
        Value::Object(fields) => fields.iter().for_each(|(key, value)| nulls(key, value)),
        _ => {}
    }
}

/// Every coupler of the JSON stands in the CSV with the same numbers.
fn agree(json: &Value, rows: &[u8]) {
    let mut reader = csv::Reader::from_reader(rows);
    let header = reader.headers().expect("a header").clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    let mut from = 0;
    for scenario in json["scenarios"].as_array().expect("scenarios") {
        let cases = scenario["cases"].as_array().expect("cases");
        for case in cases {
            let all = case["couplers"].as_array().expect("couplers of a case");
            assert!(cases.len() == 1 || all.is_empty(), "couplers of several cases");
            let all = Some(all).filter(|_| cases.len() == 1);
            let here = rows[from..]
                .iter()
                .take_while(|row| row[1] == cell(&case["broken_coupler"]) && same_scenario(row, &scenario["name"]));
            let here = here.take(all.map_or(usize::MAX, Vec::len)).count();
            let counted =
                rows[from..from + here].iter().filter(|row| column(&header, row, "exceeds") == "true").count();
            assert_eq!(case["exceeding"], counted, "rows that exceed");
            for (coupler, row) in all.into_iter().flatten().zip(&rows[from..from + here]) {
                for key in header.iter().filter(|k| coupler.get(*k).is_some()) {
                    assert_eq!(cell(&coupler[key]), column(&header, row, key), "{key}");
                }
            }
            from += here;
        }
    }
    assert_eq!(from, rows.len(), "rows of no case");
}

fn same_scenario(row: &csv::StringRecord, name: &Value) -> bool {
    let name = name.as_str().expect("a name");
    row[0] == *name || row[0].strip_prefix('\'') == Some(name)
}

fn column<'r>(header: &csv::StringRecord, row: &'r csv::StringRecord, key: &str) -> &'r str {
    &row[header.iter().position(|k| k == key).expect("a column")]
}

/// A value as the CSV writes it.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::Number(n) if n.is_f64() => format!("{:?}", n.as_f64().expect("a number")),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
