//! Figures as files: XML, in themselves and beside each other in a page.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rayon::prelude::*;
use trainsafe::accuracy::{Accuracy, Effort, MethodRow, RowOrigin};
use trainsafe::solve::Method;
use trainsafe::{Options, analyze, consist, report};

/// All figures of a train file, with its maps where it can have them.
fn figures(file: &Path) -> Vec<(String, String)> {
    let train = consist::read(file).unwrap_or_else(|e| panic!("{e}"));
    let options = Options { map: true, ..Options::default() };
    let analysis = analyze(&train, &options).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let files = report::documents(&train, &analysis, &report::Format::ALL).expect("written");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    files.into_iter().filter(|(name, _)| name.ends_with(".svg")).map(|(name, bytes)| (name, text(bytes))).collect()
}

/// A train file and its figures, by name.
type OfTrain = (PathBuf, Vec<(String, String)>);

/// All figures of every sample train, made once for all tests.
static OF_SAMPLE_TRAINS: LazyLock<Vec<OfTrain>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("trains");
    let files = fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path());
    let trains = files.filter(|path| path.extension().is_some_and(|e| e == "toml"));
    trains.par_bridge().map(|path| (path.clone(), figures(&path))).collect()
});

/// Attributes of a tag: `key="value"` only, each key once.
fn attributes(tag: &str) -> Vec<(&str, &str)> {
    let mut rest = tag.trim_end_matches('/').split_once(' ').map_or("", |(_, rest)| rest).trim();
    let mut all: Vec<(&str, &str)> = Vec::new();
    while !rest.is_empty() {
        let (key, after) = rest.split_once("=\"").unwrap_or_else(|| panic!("no value in <{tag}>"));
        let (value, after) = after.split_once('"').unwrap_or_else(|| panic!("no end in <{tag}>"));
        assert!(key.chars().all(|c| c.is_ascii_alphabetic() || c == '-'), "<{tag}>");
        assert!(all.iter().all(|(k, _)| *k != key), "{key} twice in <{tag}>");
        assert!(!value.contains(['<', '>']), "<{tag}>");
        all.push((key, value));
        rest = after.trim_start();
    }
    all
}

/// Checks that a text is one element of XML with nothing left open; returns all tags and texts.
fn parse(name: &str, svg: &str) -> (Vec<String>, Vec<String>) {
    let (mut open, mut tags, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    let mut rest = svg.trim();
    while !rest.is_empty() {
        let (text, after) = rest.split_once('<').unwrap_or((rest, ""));
        assert!(text.is_empty() || !open.is_empty(), "{name}: text outside of the root: {text}");
        let entity = |e: &str| ["amp;", "lt;", "gt;", "quot;", "#39;"].iter().any(|k| e.starts_with(k));
        assert!(text.split('&').skip(1).all(entity) && !text.contains('>'), "{name}: {text}");
        assert!(!text.chars().any(char::is_control), "{name}: {text:?}");
        texts.push(text.to_owned());
        if after.is_empty() {
            break;
        }
        let (tag, after) = after.split_once('>').unwrap_or_else(|| panic!("{name}: a tag has no end"));
        rest = after;
        let kind = tag.trim_end_matches('/').split(' ').next().unwrap_or_default().to_owned();
        match tag.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop().as_deref(), Some(closed), "{name}"),
            None => {
                assert!(!open.is_empty() || tags.is_empty(), "{name}: a second root");
                if !tag.ends_with('/') {
                    open.push(kind);
                }
                tags.push(tag.to_owned());
            }
        }
    }
    assert!(open.is_empty() && tags[0].starts_with("svg "), "{name}: {open:?}");
    (tags, texts)
}

#[test]
fn every_figure_of_every_sample_train_is_xml_within_its_frame() {
    for (file, figures) in &*OF_SAMPLE_TRAINS {
        let (mut all, mut ids) = (0, HashSet::new());
        for (figure, svg) in figures {
            let name = format!("{}, {figure}", file.display());
            let (tags, _) = parse(&name, svg);
            assert_eq!(svg.trim().lines().count(), 1, "{name}");
            let root = attributes(&tags[0]);
            let number = |of: &[(&str, &str)], key: &str| -> Option<f64> {
                of.iter().find(|a| a.0 == key).map(|a| a.1.parse().unwrap_or_else(|e| panic!("{name}: {key}: {e}")))
            };
            let size = (number(&root, "width").expect("a width"), number(&root, "height").expect("a height"));
            let own: Vec<&str> = tags.iter().flat_map(|t| attributes(t)).filter(|a| a.0 == "id").map(|a| a.1).collect();
            for id in own {
                assert!(ids.insert(id.to_owned()), "{name}: {id} is in two figures of a page");
                assert!(svg.contains(&format!("url(#{id})")), "{name}: nothing uses {id}");
            }
            for tag in tags.iter().filter(|t| t.starts_with("text ")) {
                let at = attributes(tag);
                let (x, y) = (number(&at, "x").expect("x"), number(&at, "y").expect("y"));
                assert!((0.0..=size.0).contains(&x) && (0.0..=size.1).contains(&y), "{name}: <{tag}>");
            }
            let paths = tags.iter().flat_map(|t| attributes(t)).filter(|a| a.0 == "d");
            for number in paths.flat_map(|a| a.1.split(['M', 'L', 'Z', ' '])).filter(|n| !n.is_empty()) {
                assert!(number.parse::<f64>().is_ok_and(|n| n.abs() < 1e4), "{name}: {number}");
            }
            all += 1;
        }
        assert!(all > 1, "{}", file.display());
    }
}

/// No text lies over another, on a wide screen nor on a telephone, where letters are of 20 pixels in place of 15. A letter is
/// taken to be half as wide as that.
#[test]
fn texts_do_not_overlap() {
    for (file, figures) in &*OF_SAMPLE_TRAINS {
        for (figure, svg) in figures {
            for size in [15.0, 20.0] {
                let boxes: Vec<_> = svg.split("<text ").skip(1).map(|t| text_box(t, size)).collect();
                for (i, a) in boxes.iter().enumerate() {
                    for b in &boxes[..i] {
                        let apart = a.1 <= b.0 || b.1 <= a.0 || (a.2 - b.2).abs() >= 0.8 * size;
                        assert!(apart, "{}, {figure}, {size}: \"{}\" and \"{}\"", file.display(), a.3, b.3);
                    }
                }
            }
        }
    }
}

/// Left end, right end, base line, and text of `x="…" y="…" text-anchor="…">…</text>`.
fn text_box(element: &str, size: f64) -> (f64, f64, f64, String) {
    let (tag, rest) = element.split_once('>').expect("a tag");
    let tag = format!("text {tag}");
    let at: Vec<&str> = attributes(&tag).into_iter().map(|a| a.1).collect();
    let text = rest.split('<').next().unwrap_or_default().to_owned();
    let width = 0.5 * size * text.chars().count() as f64;
    let x: f64 = at[0].parse().expect("a number");
    let left = match at[2] {
        "start" => x,
        "middle" => x - 0.5 * width,
        _ => x - width,
    };
    (left, left + width, at[1].parse().expect("a number"), text)
}

/// Every exceedance is marked, on a train of 241 couplers too, and no mark is smaller than 9 pixels.
#[test]
fn every_exceedance_of_a_long_train_has_its_mark() {
    let mut train = crate::common::uniform("long", 241, 1e5, 1e7, 1e6, 0.9e6);
    train.scenarios = vec![crate::common::breaks("at the tail", vec![239], Some(60.0))];
    let train = crate::common::built(&train);
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let case = &analysis.scenarios[0].cases[0];
    let sides = |c: &trainsafe::findings::CouplerFindings| {
        let draft = c.peak_draft_n.is_some_and(|f| f > c.rated_draft_n);
        let buff = c.peak_buff_n.is_some_and(|f| -f > c.rated_buff_n);
        usize::from(draft) + usize::from(buff)
    };
    let over = case.couplers.iter().filter(|c| c.exceeds == Some(true));
    let (couplers, marks) = (over.clone().count(), over.map(sides).sum::<usize>());
    assert!(couplers > 200, "{couplers}");
    let files = report::documents(&train, &analysis, &report::Format::ALL).expect("written");
    let svg = |kind: &str| {
        let (_, bytes) = files.iter().find(|(name, _)| name.ends_with(&format!("{kind}.svg"))).expect("a figure");
        String::from_utf8(bytes.clone()).expect("UTF-8")
    };
    let filled = |svg: &str| {
        parse("a figure", svg).0.into_iter().filter(|t| t.contains("class=\"f-over s-card\"")).collect::<Vec<_>>()
    };
    let in_envelope = filled(&svg("envelope"));
    assert_eq!(in_envelope.len(), marks + 1, "and one in the legend");
    for mark in in_envelope {
        let d = attributes(&mark).into_iter().find(|a| a.0 == "d").expect("a path").1.to_owned();
        let heights: Vec<f64> = d.split(['M', 'L', 'Z']).filter_map(|p| p.split_once(' ')?.1.parse().ok()).collect();
        let span = heights.iter().fold(f64::MIN, |a, &b| a.max(b)) - heights.iter().fold(f64::MAX, |a, &b| a.min(b));
        assert!(span > 8.9, "{mark}");
    }
    // In the picture of the wave a triangle at the right for every coupler, and one in the legend.
    assert_eq!(filled(&svg("wave")).len(), couplers + 1);
}

/// A rating of a few couplers has its number, and one far beyond the forces is told at the axis' end.
#[test]
fn ratings_are_readable() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("trains/mixed-manifest-train.toml");
    let (_, all) = OF_SAMPLE_TRAINS.iter().find(|(of, _)| *of == file).expect("a sample train");
    let texts = |name: &str| {
        let svg = &all.iter().find(|(n, _)| n == name).expect("a figure").1;
        parse(name, svg).1
    };
    let envelope = texts("figure-1-envelope.svg");
    assert_eq!(envelope.iter().filter(|t| *t == "970 kN").count(), 2, "{envelope:?}");
    assert!(envelope.iter().any(|t| t == "rated 3.114 MN"), "{envelope:?}");
    assert!(texts("figure-1-force.svg").iter().any(|t| t == "rated 3.114 MN"));
    // Two breaks are two bars, with the couplers as names; a map has the load as it is in it.
    let bars = texts("figure-1-breaks.svg");
    assert!(["23", "105"].iter().all(|name| bars.iter().any(|t| t == name)), "{bars:?}");
    assert!(texts("figure-1-map.svg").iter().any(|t| t == "the load as it is"));
    assert!(texts("figure-3-map.svg").iter().any(|t| t == "force of this pulse, 1.8 MN"));
}

/// Names of files, of trains and of scenarios are in no figure as markup, whatever they hold.
#[test]
fn hostile_names_are_no_markup() {
    let mut train = crate::common::uniform("</svg><script>1</script>", 6, 1e5, 1e7, 1e6, 0.9e6);
    train.vehicles[2].label = Some("\"><img src=x>".to_owned());
    train.scenarios = vec![crate::common::breaks("<b>&", vec![2], None)];
    let train = crate::common::built(&train);
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let files = report::documents(&train, &analysis, &report::Format::ALL).expect("written");
    for (name, bytes) in files.iter().filter(|(name, _)| name.ends_with(".svg")) {
        let svg = String::from_utf8(bytes.clone()).expect("UTF-8");
        let (tags, _) = parse(name, &svg);
        assert!(tags.iter().all(|t| !t.starts_with("script") && !t.starts_with("img")), "{name}");
    }
}

/// The figures of a comparison and of a fleet are XML too.
#[test]
fn figures_of_methods_and_of_fleets_are_xml() {
    let row = |origin, method, run_time_s: f64, error_n: f64, bound_n| MethodRow {
        origin,
        method,
        setting: String::new(),
        tolerances: Some([1e-3, 1e-12]),
        run_time_s,
        runs: 1,
        work: Effort::Accelerations(1),
        peak_error_n: error_n,
        force_error_n: 2.0 * error_n,
        bound_n,
        estimate_n: None,
    };
    let comparison = Accuracy {
        train: "<train>".to_owned(),
        scenario: "<scenario>".to_owned(),
        is_march: false,
        broken_coupler: None,
        couplers: [1, 2],
        horizon_s: 1.0,
        rating_n: 1e6,
        doubt_n: 0.0,
        rows: vec![
            row(RowOrigin::Ours(Method::Modal), "modal", 1e-3, 0.0, Some(1e-6)),
            row(RowOrigin::Planner(Method::Modal), "modal", 1e-3, 0.0, Some(1e-6)),
            row(RowOrigin::Peer, "Newmark <1>", 1e-2, 1e3, None),
        ],
        left_out: vec![],
    };
    let (_, texts) = parse("accuracy", &trainsafe::accuracy::figure(&comparison));
    for label in ["chosen by default", "10⁻¹⁵", "Newmark &lt;1&gt;", "up to the claimed bound"] {
        assert!(texts.iter().any(|t| t == label), "{label}: {texts:?}");
    }

    let folder = tempfile::tempdir().expect("a folder");
    crate::fleets::write_fleet(&folder.path().join("trains"), 6, 3);
    assert!(crate::fleets::fleet(folder.path(), &["trains", "--out", "out"]).status.success());
    let svg = fs::read_to_string(folder.path().join("out/figure-safe-factors.svg")).expect("a figure");
    let (_, texts) = parse("safe factors", &svg);
    assert!(texts.iter().any(|t| t == "safe factor on the load"), "{texts:?}");
}

/// One run of a march gives what all figures of a scenario show: the same as the runs for one coupler and for all, and once only.
#[test]
fn the_evidence_of_a_march_is_one() {
    for (name, scenario) in [("shunting-european-rake", 0), ("unit-train-emergency", 1)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("trains").join(format!("{name}.toml"));
        let train = consist::read(&path).expect("a train");
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let found = &analysis.scenarios[scenario];
        let evidence = found.evidence(&train).expect("couplers to watch");
        assert!(std::ptr::eq(evidence, found.evidence(&train).expect("the same")), "found twice");
        let case = &found.cases[0];
        let worst = case.worst.as_ref().expect("a worst coupler");
        let (broken, largest_n) = (case.broken_coupler.map(|b| b - 1), worst.peak_force_n.abs());
        // Other steps: the error of both is the case's.
        let near = 1e-9 * largest_n + 2.0 * case.error_n();
        let alone = trainsafe::findings::history(&train, scenario, broken, worst.coupler - 1, &evidence.times_s);
        assert!(alone.iter().zip(&evidence.force_n).all(|(a, b)| (a - b).abs() < near), "{name}");
        let on_way = evidence.way.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
        assert!((on_way - largest_n).abs() < near, "{name}: the way shows the peak");
        let law = &train.extras().laws[worst.coupler - 1];
        let free = |p: &&[f64; 2]| p[0].abs() < 0.5 * law.slack_m();
        assert!(evidence.way.iter().filter(free).all(|p| p[1] == 0.0), "{name}: no force in the slack");
        let field =
            trainsafe::findings::field(&train, scenario, case, trainsafe::findings::Of::Event).expect("affordable");
        let wave = evidence.wave.as_ref().expect("a wave");
        let alike = |(a, b): (&f32, &f32)| a == b || a.is_nan() && b.is_nan() || (a - b).abs() < 1e-6;
        assert!(wave.share.iter().zip(&field.share).all(alike), "{name}");
    }
}

/// The picture of the wave marks couplers that pass their slack, and says so where there are any: of a rake at rest all ahead of the
/// wave, and none under load.
#[test]
fn open_couplers_are_marked() {
    let shown = |slack: &str, coupler: &str| {
        let text = format!(
            "[coupler]\n{coupler}\nslack = \"{slack}\"\nrated_load = \"2 MN\"\n[[vehicle]]\ncount = 6\nmass = \"80 t\"\n[[scenario]]\n\
             kind = \"impact\"\nat = \"tail\"\nvehicles = 1\nspeed = \"5 km/h\"\nhorizon = \"1 s\"\n"
        );
        let train = consist::parse(&text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"));
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let files = report::documents(&train, &analysis, &report::Format::ALL).expect("written");
        let file = |name: &str| {
            let (_, bytes) = files.iter().find(|(file, _)| file == name).unwrap_or_else(|| panic!("no {name}"));
            String::from_utf8(bytes.clone()).expect("UTF-8")
        };
        let svg = file("figure-1-wave.svg");
        let image =
            svg.split_once("data:image/png;base64,").and_then(|(_, rest)| rest.split_once('"')).expect("a picture").0;
        let image = STANDARD.decode(image).expect("base64");
        let mut reader = png::Decoder::new(std::io::Cursor::new(image)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("its size")];
        reader.next_frame(&mut pixels).expect("pixels");
        let palette = reader.info().palette.as_ref().expect("colours").to_vec();
        let grey = (palette.len() / 3 - 1) as u8;
        assert_eq!(palette[palette.len() - 3..], [0x8c; 3]);
        let (first, count) = (pixels[0], pixels.iter().filter(|p| **p == grey).count());
        let told = [
            svg.contains("open: passing its slack, without force"),
            file("report.md").contains("buff orange, grey where it is open, outlined"),
            file("report.html").contains("\"slack\":[true,true,true,true,true],"),
        ];
        (first == grey, count as f64 / pixels.len() as f64, told)
    };
    let spring = "stiffness = \"20 MN/m\"";
    let (at_rest, share, told) = shown("40 mm", spring);
    assert!(at_rest && (0.05..0.9).contains(&share) && told == [true; 3], "{at_rest} {share} {told:?}");
    // Laws with events and no slack.
    let (at_rest, share, told) = shown("0 mm", "stiffness = \"20 MN/m\"\nstiffness_in_buff = \"30 MN/m\"");
    assert!(!at_rest && share == 0.0 && told == [false; 3], "{share} {told:?}");
}
