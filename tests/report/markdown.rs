//! The report: what it says, that its files are whole, and that its numbers read back.

use std::fs;

use crate::common::{breaks, built, figure_4, figure_5, ore_train, uniform};
use trainsafe::findings::{CaseFindings, RodFindings};
use trainsafe::train::{Event, Pulse, Rule, Scenario, TrainSpec};
use trainsafe::{Analysis, Options, analyze, consist, report};

/// An analysis whose times and methods do not change from run to run: they are not the report's to get right.
fn analysis_of(train: &TrainSpec) -> Analysis {
    let mut analysis = analyze(&built(train), &Options::default()).expect("the train is sound");
    analysis.date = "2026-12-01".to_owned();
    for case in cases(&mut analysis) {
        case.run_time_s = 0.0123;
        case.error_bound_n = 1e-3 * case.tolerance_n;
        case.method = "fronts";
        case.method_reason = "all vehicles are equal".to_owned();
        case.rod = None;
    }
    analysis
}

fn cases(analysis: &mut Analysis) -> impl Iterator<Item = &mut CaseFindings> {
    analysis.scenarios.iter_mut().flat_map(|s| &mut s.cases)
}

/// The report's text, written to a folder of its own.
fn markdown(train: &TrainSpec, analysis: &Analysis) -> String {
    let dir = tempfile::tempdir().expect("a folder");
    report::write(&built(train), analysis, dir.path(), &report::Format::ALL).expect("written");
    fs::read_to_string(dir.path().join("report.md")).expect("a report")
}

fn one_break() -> TrainSpec {
    ore_train(vec![breaks("knuckle breaks between cars 53 and 54", vec![52], None)])
}

#[test]
fn the_paper_s_break_is_told_with_the_rod_beside_it() {
    let train = figure_4();
    let mut analysis = analysis_of(&train);
    for case in cases(&mut analysis) {
        case.rod = Some(RodFindings { exceeding: 0, utilisation: 1.0 });
    }
    insta::assert_snapshot!(markdown(&train, &analysis));
}

#[test]
fn the_paper_s_pulse_is_told() {
    let train = figure_5();
    insta::assert_snapshot!(markdown(&train, &analysis_of(&train)));
}

#[test]
fn one_break_of_a_real_train_is_told() {
    let train = one_break();
    insta::assert_snapshot!(markdown(&train, &analysis_of(&train)));
}

#[test]
fn each_break_and_a_shock_have_a_section_each() {
    let hit = Event::Pulse(Pulse::rectangle(11, 2.4e6, 0.06));
    let mut train = uniform("Yard <cut> | 12 *cars*", 12, 90e3, 11e6, 1.0e6, 0.55e6);
    // Held at one end: in a symmetric train two couplers would share the first place, and rounding would choose.
    train.vehicles[0].held = true;
    train.vehicles[0].label = Some("tank_car | [1]".to_owned());
    train.scenarios = vec![
        breaks("each", (0..11).collect(), None),
        Scenario {
            name: "the rear is hit".to_owned(),
            event: hit,
            horizon_s: Some(2.0),
            cascade: Rule::Keep,
            left_out_in_buff: vec![],
            response: trainsafe::train::Response::default(),
        },
    ];
    insta::assert_snapshot!(markdown(&train, &analysis_of(&train)));
}

#[test]
fn a_safe_break_has_no_table_and_says_by_what_margin() {
    let mut train = one_break();
    for c in &mut train.couplers {
        (c.rated_draft_n, c.rated_buff_n) = (2.5e6, 2.5e6);
    }
    insta::assert_snapshot!(markdown(&train, &analysis_of(&train)));
}

#[test]
fn what_is_not_decided_is_said_with_its_interval() {
    let train = one_break();
    let mut analysis = analysis_of(&train);
    for case in cases(&mut analysis) {
        case.exceeding = 0;
        case.undecided = 1;
        case.error_bound_n = 90e3;
        for c in &mut case.couplers {
            c.exceeds = if c.coupler == 1 { None } else { Some(false) };
            c.first_exceeds_s = None;
            c.peak_force_n = if c.coupler == 1 { -884_750.0 } else { c.peak_force_n };
        }
    }
    let text = markdown(&train, &analysis);
    let verdict = "**Not decided after coupler 53 breaks for 1 coupler: coupler 1 (between locomotive and car 2) peaks between \
                   794 kN and 975 kN in buff, and its rating lies inside.**";
    assert!(text.contains(verdict), "{text}");
    assert!(text.contains("not met; asked for"), "{text}");
}

#[test]
fn a_train_without_load_or_without_another_coupler_is_no_trouble() {
    let mut idle = uniform("idle", 5, 1e5, 1e7, 1e6, 0.0);
    idle.scenarios = vec![breaks("b", vec![2], None)];
    let mut two = uniform("two", 2, 1e5, 1e7, 1e6, 1e5);
    two.scenarios = vec![breaks("b", vec![0], None)];
    let told = [&idle, &two].map(|train| {
        let analysis = analysis_of(train);
        let text = markdown(train, &analysis);
        let verdict = text.lines().find(|l| l.starts_with("**")).unwrap_or_default();
        format!("{verdict}\n{}", report::terminal(&analysis, &[]))
    });
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn a_load_that_is_too_much_by_itself_is_said_to_be() {
    let mut train = one_break();
    train.couplers[9].rated_draft_n = 0.5e6;
    let text = markdown(&train, &analysis_of(&train));
    let verdict = "the first is coupler 10 (between car 10 and car 11), in draft, before anything happens, under the load alone. ";
    assert!(text.contains(verdict), "{text}");
    // 0.5 MN over the largest force of coupler 10, which is a little more than the load of 0.6 MN.
    // The report rounds the share down to three digits.
    let share = 0.5e6 / analysis_of(&train).scenarios[0].cases[0].couplers[9].peak_force_n;
    assert!((0.6..0.84).contains(&share), "{share}");
    assert!(
        text.contains(&format!(
            "No coupler would be overloaded if the pull were {:.1} % of this",
            100.0 * share - 0.05
        )),
        "{text}"
    );
}

/// The load is over the rating in draft from the start, and the front's return in buff is what uses it most.
#[test]
fn the_first_exceedance_has_its_own_coupler_and_sense() {
    let mut train = figure_4();
    for coupler in &mut train.couplers {
        (coupler.rated_draft_n, coupler.rated_buff_n) = (0.999, 0.2);
    }
    let analysis = analysis_of(&train);
    let case = &analysis.scenarios[0].cases[0];
    let worst = case.worst.as_ref().expect("a worst coupler");
    assert_eq!((worst.first_exceeds_s, worst.first_exceeds_in), (Some(0.0), Some("draft")));
    assert!(worst.peak_force_n < 0.0 && worst.utilisation > 2.0);
    let said = report::terminal(&analysis, &[]);
    assert!(said.contains("in draft, before anything happens, under the load alone, and later in buff."), "{said}");
    // Without the load's own exceedance it is the coupler next to the break that is first, while another may be the worst.
    for coupler in &mut train.couplers {
        coupler.rated_draft_n = 2.0;
    }
    let analysis = analysis_of(&train);
    let case = &analysis.scenarios[0].cases[0];
    let time = |c: &trainsafe::findings::CouplerFindings| c.first_exceeds_s.unwrap_or(f64::INFINITY);
    let first = case.couplers.iter().min_by(|a, b| time(a).total_cmp(&time(b))).expect("a first");
    assert_eq!(first.first_exceeds_in, Some("buff"));
    assert_ne!(Some(first.coupler), case.worst.as_ref().map(|w| w.coupler));
    let said = report::terminal(&analysis, &[]);
    assert!(said.contains(&format!("{} in buff, ", first.coupler)), "{said}");
    let rows = csv_rows(&analysis);
    let column = rows[0].iter().position(|name| name == "first_exceeds_in").expect("a column");
    assert_eq!(rows[first.coupler][column], "buff");
}

#[test]
fn a_horizon_too_long_to_draw_is_drawn_in_part_and_said_so() {
    let mut train = figure_4();
    train.scenarios[0].horizon_s = Some(2_500.0);
    let text = markdown(&train, &analysis_of(&train));
    let caption = text.lines().find(|l| l.starts_with("*Force in the worst")).unwrap_or_default();
    assert!(caption.contains(" of 2500 s."), "{caption}");
}

#[test]
fn bounds_that_settle_the_verdict_are_named() {
    let mut train = one_break();
    for c in &mut train.couplers {
        (c.rated_draft_n, c.rated_buff_n) = (25e6, 25e6);
    }
    let mut analysis = analysis_of(&train);
    for case in cases(&mut analysis) {
        (case.worst, case.left_out, case.safe_load_factor) = (None, case.couplers.len(), None);
        case.couplers.clear();
    }
    let text = markdown(&train, &analysis);
    assert!(
        text.contains("**No coupler can exceed its rating: the all-time bounds of all 103 lie under theirs.**"),
        "{text}"
    );
    assert!(!text.contains(".svg"), "nothing is left to draw: {text}");
}

#[test]
fn the_terminal_shows_the_worst() {
    let mut train = one_break();
    train.scenarios.push(breaks("each", (0..104).step_by(8).collect(), Some(8.0)));
    train.scenarios.push(figure_5_like());
    let mut analysis = analysis_of(&train);
    // No train can have such a name; what is written does not rely on it.
    analysis.scenarios[2].name = "the rear is \u{1b}[31mpulled".to_owned();
    let text = report::terminal(&analysis, &["reports/ore/report.md".into()]);
    insta::assert_snapshot!(text);
}

fn figure_5_like() -> Scenario {
    let event = Event::Pulse(Pulse::rectangle(104, -1.2e6, 0.5));
    Scenario {
        name: "the rear is pulled".to_owned(),
        event,
        horizon_s: None,
        cascade: Rule::Keep,
        left_out_in_buff: vec![],
        response: trainsafe::train::Response::default(),
    }
}

#[test]
fn names_cannot_drive_the_terminal() {
    let mut analysis = analysis_of(&one_break());
    analysis.train = "a\u{1b}[2Jb\nc".to_owned();
    let text = report::terminal(&analysis, &[]);
    assert!(text.starts_with("a [2Jb c: 105 vehicles, 104 couplers\n"), "{text:?}");
}

#[test]
fn the_json_has_the_contract_s_fields_in_order() {
    let analysis = analysis_of(&one_break());
    let text = report::json(&analysis).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let case = &value["scenarios"][0]["cases"][0];
    let keys = |v: &serde_json::Value| v.as_object().expect("an object").keys().cloned().collect::<Vec<_>>().join(" ");
    assert_eq!(keys(&value), "schema_version program date inputs options doubts train vehicles couplers scenarios");
    assert_eq!(keys(&value["scenarios"][0]), "name kind cases left_out_in_buff");
    assert_eq!(
        keys(case),
        "broken_coupler method method_reason horizon_s error_bound_n error_estimate_n predictable_until_s stopped_vehicle \
         stopped_at_s tolerance_n run_time_s exceeding undecided \
         safe_load_factor first_passage_s exceeding_first_passage worst_first_passage worst couplers left_out"
    );
    assert_eq!(
        keys(&case["couplers"][0]),
        "coupler between rated_draft_n rated_buff_n initial_force_n peak_force_n peak_time_s utilisation peak_draft_n \
         peak_draft_time_s peak_buff_n peak_buff_time_s exceeds first_exceeds_s first_exceeds_in first_passage"
    );
    assert_eq!(case["couplers"].as_array().map(Vec::len), Some(103));
    let worst = &analysis.scenarios[0].cases[0].worst;
    assert_eq!(case["worst"]["peak_force_n"].as_f64(), worst.as_ref().map(|w| w.peak_force_n), "to the last bit");
}

#[test]
fn many_cases_leave_the_couplers_to_the_csv() {
    let mut train = one_break();
    train.scenarios.push(breaks("each", vec![3, 50], Some(8.0)));
    let text = report::json(&analysis_of(&train)).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(value["scenarios"][0]["cases"][0]["couplers"].is_array());
    for case in value["scenarios"][1]["cases"].as_array().expect("cases") {
        assert_eq!(case["couplers"], serde_json::json!([]), "an empty list");
        assert!(case["worst"]["coupler"].is_u64());
    }
}

#[test]
fn no_number_that_is_not_finite_is_written() {
    let mut analysis = analysis_of(&one_break());
    for case in cases(&mut analysis) {
        case.error_bound_n = f64::INFINITY;
        case.couplers[0].peak_force_n = f64::NAN;
        case.couplers[0].peak_buff_n = Some(f64::NEG_INFINITY);
    }
    let text = report::json(&analysis).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(value["scenarios"][0]["cases"][0]["error_bound_n"].is_null());
    let rows = csv_rows(&analysis);
    assert_eq!((&rows[1][8], &rows[1][13]), (&String::new(), &String::new()));
}

fn csv_rows(analysis: &Analysis) -> Vec<Vec<String>> {
    let mut bytes = Vec::new();
    report::csv(analysis, &mut bytes).expect("CSV");
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&bytes[..]);
    reader.records().map(|r| r.expect("a row").iter().map(str::to_owned).collect()).collect()
}

#[test]
fn the_csv_reads_back_to_the_same_bits() {
    let mut analysis = analysis_of(&one_break());
    let awkward = [0.1 + 0.2, -1.0 / 3.0, 1e300, 5e-324, f64::MAX, -0.0, 1e16, 123_456_789.123_456_79];
    for (c, x) in analysis.scenarios[0].cases[0].couplers.iter_mut().zip(awkward) {
        c.peak_force_n = x;
    }
    let rows = csv_rows(&analysis);
    assert_eq!(
        rows[0].join(","),
        "scenario,broken_coupler,coupler,between_front,between_rear,rated_draft_n,rated_buff_n,initial_force_n,\
         peak_force_n,peak_time_s,utilisation,peak_draft_n,peak_draft_time_s,peak_buff_n,peak_buff_time_s,exceeds,\
         first_exceeds_s,first_exceeds_in,first_passage_peak_draft_n,first_passage_peak_draft_time_s,\
         first_passage_peak_buff_n,first_passage_peak_buff_time_s,first_passage_exceeds"
    );
    let case = &analysis.scenarios[0].cases[0];
    assert_eq!(rows.len(), 1 + case.couplers.len());
    for (row, c) in rows[1..].iter().zip(&case.couplers) {
        let number = |i: usize| row[i].parse::<f64>().ok().map(f64::to_bits);
        let bits = |x: f64| Some(x.to_bits());
        assert_eq!(row[1..3], [53.to_string(), c.coupler.to_string()]);
        assert_eq!(number(8), bits(c.peak_force_n), "{row:?}");
        assert_eq!(number(9), bits(c.peak_time_s));
        assert_eq!(number(13), c.peak_buff_n.map(f64::to_bits), "empty, not 0: {row:?}");
        assert_eq!(number(16), c.first_exceeds_s.map(f64::to_bits));
    }
}

#[test]
fn the_csv_has_no_formula_and_no_broken_coupler_for_a_pulse() {
    let mut train = figure_5();
    train.scenarios[0].name = "=HYPERLINK(\"x\"), \"quoted\"".to_owned();
    train.vehicles[1].label = Some("+1".to_owned());
    let mut analysis = analysis_of(&train);
    analysis.scenarios[0].cases[0].couplers[1].between[0] = "\tcar".to_owned();
    analysis.scenarios[0].cases[0].couplers[0].exceeds = None;
    let row = &csv_rows(&analysis)[1];
    assert_eq!(row[..5], ["'=HYPERLINK(\"x\"), \"quoted\"", "", "1", "car 1", "'+1"]);
    assert_eq!(row[15], "");
    assert_eq!(csv_rows(&analysis)[2][3], "'\tcar");
}

#[test]
fn the_all_time_bound_is_a_column_where_it_was_asked_for() {
    let options = Options { all_time_bound: true, ..Options::default() };
    let rows = csv_rows(&analyze(&built(&one_break()), &options).expect("sound"));
    assert_eq!(rows[0].last().map(String::as_str), Some("all_time_bound_n"));
    assert!(rows[1].last().is_some_and(|b| b.parse::<f64>().is_ok_and(|b| b > 0.0)));
}

#[test]
fn figures_are_the_same_bytes_every_time() {
    let mut train = one_break();
    train.scenarios.push(breaks("each", vec![3, 50], Some(8.0)));
    let analysis = analysis_of(&train);
    let figures = || {
        let dir = tempfile::tempdir().expect("a folder");
        let paths = report::write(&built(&train), &analysis, dir.path(), &report::Format::ALL).expect("written");
        let svg = |p: &std::path::PathBuf| {
            let name = p.file_name()?.to_str()?.to_owned();
            name.ends_with(".svg").then(|| (name, fs::read_to_string(p).expect("a figure")))
        };
        paths.iter().filter_map(svg).collect::<Vec<_>>()
    };
    let (first, second) = (figures(), figures());
    let names: Vec<&str> = first.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "figure-1-envelope.svg",
            "figure-1-wave.svg",
            "figure-1-force.svg",
            "figure-2-breaks.svg",
            "figure-2-envelope.svg",
            "figure-2-wave.svg",
            "figure-2-force.svg"
        ]
    );
    assert!(first == second, "the bytes differ");
    for (name, svg) in &first {
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
        let clips: Vec<&str> = svg.match_indices("clip-").map(|(i, _)| &svg[i..]).collect();
        let own = format!("clip-{}", name.trim_end_matches(".svg"));
        assert!(clips.iter().all(|c| c.starts_with("clip-path") || c.starts_with(&own)), "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    }
}

#[test]
fn forces_of_nothing_but_zero_are_drawn() {
    let mut idle = uniform("idle", 5, 1e5, 1e7, 1e6, 0.0);
    idle.scenarios = vec![breaks("b", vec![2], None)];
    let dir = tempfile::tempdir().expect("a folder");
    report::write(&built(&idle), &analysis_of(&idle), dir.path(), &report::Format::ALL).expect("written");
    let svg = fs::read_to_string(dir.path().join("figure-1-force.svg")).expect("a figure");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert!(svg.contains(">0.5</text>"), "the axis has a scale");
}

#[test]
fn figures_say_what_they_show() {
    let train = figure_4();
    let dir = tempfile::tempdir().expect("a folder");
    let analysis = analysis_of(&train);
    report::write(&built(&train), &analysis, dir.path(), &report::Format::ALL).expect("written");
    let svg = |name: &str| fs::read_to_string(dir.path().join(name)).expect("a figure");
    let (envelope, force) = (svg("figure-1-envelope.svg"), svg("figure-1-force.svg"));
    for text in ["coupler 51 breaks", "largest draft", "largest buff", "rated", "over its rating", "force, N"] {
        assert!(envelope.contains(text), "{text}");
    }
    for text in ["first over its rating at 53.15 s", "time after the break, s", "force in coupler 1, N"] {
        assert!(force.contains(text), "{text}");
    }
    // One marker per sense in which a coupler exceeds, and one in the legend.
    let over = |c: &trainsafe::findings::CouplerFindings| {
        let draft = c.peak_draft_n.is_some_and(|f| f > c.rated_draft_n);
        let buff = c.peak_buff_n.is_some_and(|f| -f > c.rated_buff_n);
        usize::from(draft) + usize::from(buff)
    };
    let exceeding = analysis.scenarios[0].cases[0].couplers.iter().filter(|c| c.exceeds == Some(true));
    assert_eq!(envelope.matches("class=\"f-over s-card\"").count(), 1 + exceeding.map(over).sum::<usize>());
}

#[test]
fn a_failure_leaves_an_earlier_report_and_no_fragments() {
    let train = one_break();
    let analysis = analysis_of(&train);
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("report.md"), "earlier").expect("written");
    fs::create_dir_all(dir.path().join("result.json/in the way")).expect("made");
    let error =
        report::write(&built(&train), &analysis, dir.path(), &report::Format::ALL).expect_err("a folder is in the way");
    assert_eq!(error.path, dir.path().join("result.json"));
    assert!(error.to_string().contains("a folder stands where the file must go"), "{error}");
    assert_eq!(fs::read_to_string(dir.path().join("report.md")).expect("there"), "earlier");
    let hidden = fs::read_dir(dir.path()).expect("a folder").flatten();
    let hidden = hidden.filter(|e| e.file_name().to_string_lossy().starts_with('.')).count();
    assert_eq!(hidden, 0, "temporary files stay behind");
}

#[test]
fn a_file_in_the_place_of_the_folder_is_an_error_that_says_so() {
    let train = one_break();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("taken");
    fs::write(&path, "").expect("written");
    let error = report::write(&built(&train), &analysis_of(&train), &path, &report::Format::ALL)
        .expect_err("a file is in the way");
    assert_eq!(error.path, path);
    assert!(error.to_string().contains("choose another folder with --out DIR"), "{error}");
}

#[test]
fn figures_of_an_earlier_report_go_and_other_files_stay() {
    let train = one_break();
    let dir = tempfile::tempdir().expect("a folder");
    let ours = ["figure-7-force.svg", "figure-1-breaks.svg"];
    let others = ["figure-7-mine.svg", "figure-x-force.svg", "figure-7-force.svg.bak", "notes.md"];
    for name in ours.iter().chain(&others) {
        fs::write(dir.path().join(name), "").expect("written");
    }
    let written =
        report::write(&built(&train), &analysis_of(&train), dir.path(), &report::Format::ALL).expect("written");
    assert!(ours.iter().all(|n| !dir.path().join(n).exists()));
    assert!(others.iter().all(|n| dir.path().join(n).exists()));
    assert_eq!(written.last(), Some(&dir.path().join("report.md")));
    assert!(written.iter().all(|p| p.exists()));
}

#[test]
fn huge_and_tiny_units_are_written_too() {
    for size in [1e-280, 1e280] {
        let mut train = uniform("extreme", 8, size, size, size, 0.9 * size);
        train.scenarios = vec![breaks("each", (0..7).collect(), None)];
        let analysis = analysis_of(&train);
        let text = markdown(&train, &analysis);
        assert!(!text.contains("NaN") && !text.contains("inf") && !text.contains("not finite"), "{text}");
    }
}

/// Reports are in the units that the file asks for, or in which most of it is written; what programs read is in SI.
#[test]
fn reports_are_in_the_reader_s_units() {
    let text = |units: &str, rating: &str, mass: &str| {
        format!(
            "{units}\n[coupler]\nstiffness = \"16.9 MN/m\"\nrated_load = \"{rating}\"\n[[vehicle]]\nmass = \"{mass}\"\ncount = 9\n\
             [load]\nuniform = \"60 %\"\n[[scenario]]\nkind = \"break\"\ncoupler = 4\n"
        )
    };
    let report = |units, rating, mass| {
        let train = consist::parse(&text(units, rating, mass), "t.toml".as_ref()).expect("a train").into_spec();
        let analysis = analysis_of(&train);
        assert_eq!(analysis.scenarios[0].cases[0].couplers[0].rated_draft_n.round(), 1_779_289.0);
        markdown(&train, &analysis)
    };
    let (kip, meganewtons) = (("400 kip", "143 ton_us"), ("1.779288646104 MN", "130 t"));
    assert!(report("", kip.0, kip.1).contains("| rated in draft | 400 kip |"));
    assert!(report("", meganewtons.0, meganewtons.1).contains("| rated in draft | 1.779 MN |"));
    assert!(report("units = \"si\"", kip.0, kip.1).contains("| mass of a vehicle | 129.7 t |"));
    assert!(report("units = \"us\"", meganewtons.0, meganewtons.1).contains("| rated in draft | 400 kip |"));
}
