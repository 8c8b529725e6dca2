//! Nothing that is stated is lost: each key of a study and each option of the command line changes the answer, or what is said of it.
//! The lists are the schema's and the program's own: one without a sample fails.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use trainsafe::fleet::{Request, stream};
use trainsafe::schema;

const TRAIN: &str = r#"
name = "base"
[coupler]
stiffness = "11 MN/m"
rated_load = "0.8 MN"
[[vehicle]]
mass = "190 t"
held = true
[[vehicle]]
mass = "90 t"
count = 6
[load]
uniform = "0.6 MN"
"#;
const BREAK: &str = "[[scenario]]\nname = \"break\"\nkind = \"break\"\ncoupler = 5\n";
const PULSE: &str =
    "[[scenario]]\nname = \"pulse\"\nkind = \"pulse\"\nat = \"tail\"\nforce = \"-1 MN\"\nduration = \"200 ms\"\n";

/// What a study comes to: its rows, its verdict and what is said of it; or why it is refused.
fn study(folder: &Path, text: &str) -> String {
    fs::write(folder.join("study.toml"), text).expect("a study");
    let request = Request { paths: vec![folder.join("study.toml")], ..Request::default() };
    let mut rows = vec![];
    match stream(&request, &mut rows) {
        Ok(outcome) => {
            format!("{}{:?}", String::from_utf8_lossy(&rows), (outcome.verdict, outcome.notes, outcome.warnings))
        }
        Err(error) => format!("refused: {error}"),
    }
}

/// Key, a study with it, and the same with another value of it.
const STUDY: &[(&str, &str, &str, &str)] = &[
    ("trains", "VALUES", "\"a.toml\"", "\"b.toml\""),
    ("samples", "NORMAL", "samples = 4", "samples = 5"),
    ("seed", "NORMAL", "seed = 2", "seed = 3"),
    ("latin_hypercube", "NORMAL", "latin_hypercube = true", ""),
    ("vary.key", "VALUES", "load.uniform", "coupler.rated_load"),
    ("vary.values", "VALUES", "\"0.4 MN\"", "\"0.3 MN\""),
    ("vary.from", "RANGE", "from = \"0.4 MN\"", "from = \"0.5 MN\""),
    ("vary.to", "RANGE", "to = \"0.7 MN\"", "to = \"0.6 MN\""),
    ("vary.steps", "RANGE", "steps = 3", "steps = 4"),
    ("vary.distribution=uniform", "UNIFORM", "\"uniform\"", "\"uniform\"\nmode = \"0.5 MN\""),
    ("vary.distribution=triangular", "TRIANGULAR", "mode = \"0.45 MN\"\n", ""),
    ("vary.distribution=normal", "NORMAL", "\"normal\"", "\"lognormal\""),
    ("vary.distribution=lognormal", "NORMAL", "\"normal\"", "\"lognormal\""),
    ("vary.distribution=weibull", "WEIBULL", "\"weibull\"", "\"normal\""),
    ("vary.low", "UNIFORM", "low = \"0.4 MN\"", "low = \"0.5 MN\""),
    ("vary.high", "UNIFORM", "high = \"0.7 MN\"", "high = \"0.6 MN\""),
    ("vary.mean", "NORMAL", "mean = \"0.5 MN\"", "mean = \"0.6 MN\""),
    ("vary.sd", "NORMAL", "sd = \"0.05 MN\"", "sd = \"0.06 MN\""),
    ("vary.mode", "TRIANGULAR", "mode = \"0.45 MN\"", "mode = \"0.6 MN\""),
    ("vary.scale", "WEIBULL", "scale = \"0.5 MN\"", "scale = \"0.6 MN\""),
    ("vary.shape", "WEIBULL", "shape = 12", "shape = 10"),
    ("vary.location", "WEIBULL", "", "location = \"0.1 MN\"\n"),
    ("vary.per=train", "STRENGTH", "\"coupler\"", "\"train\""),
    ("vary.per=coupler", "STRENGTH", "\"coupler\"", "\"train\""),
    ("vary.per=vehicle", "MASS", "\"vehicle\"", "\"train\""),
];

fn base(name: &str) -> String {
    let of = |key: &str, rest: &str| {
        format!(
            "trains = [\"a.toml\"]\nsamples = 4\nseed = 2\nlatin_hypercube = true\n[[vary]]\nkey = \"{key}\"\n{rest}"
        )
    };
    let load =
        |distribution: &str, rest: &str| of("load.uniform", &format!("distribution = \"{distribution}\"\n{rest}"));
    match name {
        "VALUES" => {
            "trains = [\"a.toml\"]\n[[vary]]\nkey = \"load.uniform\"\nvalues = [\"0.4 MN\", \"0.6 MN\"]\n".to_owned()
        }
        "RANGE" => {
            "trains = [\"a.toml\"]\n[[vary]]\nkey = \"load.uniform\"\nfrom = \"0.4 MN\"\nto = \"0.7 MN\"\nsteps = 3\n"
                .to_owned()
        }
        "UNIFORM" => load("uniform", "low = \"0.4 MN\"\nhigh = \"0.7 MN\"\n"),
        "NORMAL" => load("normal", "mean = \"0.5 MN\"\nsd = \"0.05 MN\"\n"),
        "TRIANGULAR" => load("triangular", "low = \"0.4 MN\"\nmode = \"0.45 MN\"\nhigh = \"0.7 MN\"\n"),
        "WEIBULL" => load("weibull", "scale = \"0.5 MN\"\nshape = 12\n"),
        "STRENGTH" => {
            of("coupler.rated_load", "per = \"coupler\"\ndistribution = \"weibull\"\nscale = \"0.8 MN\"\nshape = 12\n")
        }
        _ => of("vehicle[1].mass", "per = \"vehicle\"\ndistribution = \"normal\"\nmean = \"90 t\"\nsd = \"5 t\"\n"),
    }
}

fn keys(schema: &Value, within: &str, into: &mut BTreeSet<String>) {
    for (key, property) in schema["properties"].as_object().expect("properties") {
        let words = property["enum"].as_array();
        if property["items"]["properties"].is_object() {
            keys(&property["items"], &format!("{key}."), into);
        } else if let Some(words) = words {
            into.extend(words.iter().filter_map(Value::as_str).map(|word| format!("{within}{key}={word}")));
        } else {
            into.insert(format!("{within}{key}"));
        }
    }
}

#[test]
fn every_key_of_a_study_changes_what_comes_out() {
    let mut wanted = BTreeSet::new();
    keys(&schema::study(), "", &mut wanted);
    let samples: BTreeSet<String> = STUDY.iter().map(|(key, ..)| (*key).to_owned()).collect();
    assert_eq!(wanted, samples);
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [("a.toml", TRAIN.to_owned()), ("b.toml", TRAIN.replace("90 t", "95 t"))] {
        fs::write(folder.path().join(name), text + BREAK).expect("a train");
    }
    let mut silent = vec![];
    for (key, name, from, to) in STUDY {
        let text = base(name);
        let changed = if from.is_empty() { text.clone() + to } else { text.replacen(from, to, 1) };
        assert_ne!(text, changed, "{key}");
        let [plain, changed] = [text, changed].map(|text| study(folder.path(), &text));
        assert!(!plain.starts_with("refused"), "{key}: {plain}");
        if plain == changed {
            silent.push(*key);
        }
    }
    assert!(silent.is_empty(), "these change nothing: {silent:?}");
}

/// What a command writes on standard output and standard error, and its status; without times.
fn told(folder: &Path, arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .output()
        .expect("it runs");
    // A time differs from run to run; what only repeats an option is no answer.
    let echo = ["run_time_s", "\"tolerance", "\"method\": "];
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = text.lines().filter(|line| !echo.iter().any(|echo| line.contains(echo))).collect();
    format!("{}\n{:?}", lines.join("\n"), output.status.code())
}

/// Options with an effect on answers, and commands that they change; the train files are in the test.
const OPTIONS: &[(&str, &str, &[&str])] = &[
    ("analyze", "--scenario pulse", &["analyze both.toml --json"]),
    ("analyze", "--fail-on-exceed", &["analyze both.toml --json"]),
    ("analyze", "--units us", &["analyze both.toml"]),
    (
        "analyze",
        "--verdict-only",
        &["analyze strong.toml --json", "analyze dashpots.toml --json", "analyze impact.toml --json"],
    ),
    (
        "analyze",
        "--all-time-bound",
        &["analyze both.toml --json", "analyze dashpots.toml --json", "analyze impact.toml --json"],
    ),
    ("analyze", "--map", &["analyze both.toml --json", "analyze dashpots.toml --json", "analyze impact.toml --json"]),
    (
        "analyze",
        "--tolerance 1e-15",
        &["analyze both.toml --json", "analyze dashpots.toml --json", "analyze impact.toml --json"],
    ),
    (
        "analyze",
        "--method modal",
        &["analyze both.toml --json", "analyze dashpots.toml --json", "analyze impact.toml --json"],
    ),
    ("fleet", "--fail-on-exceed", &["fleet both.toml --json"]),
    (
        "fleet",
        "--tolerance 1e-15",
        &["fleet both.toml --json", "fleet dashpots.toml --json", "fleet impact.toml --json"],
    ),
    ("fleet", "--method modal", &["fleet both.toml --json", "fleet dashpots.toml --json", "fleet impact.toml --json"]),
    ("accuracy", "--scenario pulse", &["accuracy both.toml --out out"]),
];

/// Options that choose what is written and where, how a run is gone on with, or another command altogether.
// Of a fleet --units is for its files.
const OTHERS: [&str; 17] = [
    "--units",
    "--color",
    "--threads",
    "--quiet",
    "--out",
    "--format",
    "--json",
    "--help",
    "--reports",
    "--resume",
    "--work",
    "--couplers",
    "--merge",
    "--dry-run",
    "--stress",
    "--version",
    "--study",
];

/// The options that the help of a command lists.
fn options_of(folder: &Path, command: &str) -> Vec<String> {
    let help = told(folder, &format!("{command} --help"));
    let listed =
        help.lines().filter_map(|line| line.trim_start().split([' ', ',']).find(|word| word.starts_with("--")));
    listed
        .filter(|option| help.contains(&format!("    {option}")) || help.contains(&format!(", {option}")))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_option_changes_what_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let damped = TRAIN.replace("0.8 MN\"", "0.8 MN\"\ndamping = \"100 kN*s/m\"");
    let impact = "[[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 2\nspeed = \"4 mph\"\n";
    let files = [
        ("both.toml", TRAIN.to_owned() + BREAK + PULSE),
        ("strong.toml", TRAIN.replace("0.8 MN", "8 MN") + BREAK),
        ("dashpots.toml", damped + BREAK),
        ("impact.toml", TRAIN.to_owned() + impact),
    ];
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).expect("a train"));
    let mut silent = vec![];
    for command in ["analyze", "fleet", "accuracy"] {
        let known = |option: &&String| {
            OTHERS.contains(&option.as_str())
                || OPTIONS.iter().any(|(of, with, _)| *of == command && with.split(' ').next() == Some(option))
        };
        let options = options_of(folder.path(), command);
        assert!(options.len() > 2, "{command}: {options:?}");
        let missing: Vec<_> = options.iter().filter(|option| !known(option)).collect();
        assert!(missing.is_empty(), "add samples of {command}: {missing:?}");
    }
    for (_, option, commands) in OPTIONS {
        for command in *commands {
            if told(folder.path(), command) == told(folder.path(), &format!("{command} {option}")) {
                silent.push(format!("{command} {option}"));
            }
        }
    }
    assert!(silent.is_empty(), "these change nothing: {silent:?}");
}
