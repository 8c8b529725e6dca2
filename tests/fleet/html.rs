//! `fleet.html`: every train in its place, names as text whatever they hold, and links that lead somewhere.

use std::fs;

use crate::fleets::{complaint, fleet, results, rows, write_fleet};

/// What stands between two marks, each time they occur.
fn between<'a>(text: &'a str, from: &str, to: &str) -> Vec<&'a str> {
    text.split(from).skip(1).map(|rest| rest.split(to).next().unwrap_or_default()).collect()
}

/// The rows of the table of trains.
fn table(page: &str) -> Vec<&str> {
    let body = between(page, "<tbody>\n", "</tbody>")[0];
    body.lines().filter(|line| line.starts_with("<tr")).collect()
}

#[test]
fn trains_are_listed_worst_first_and_led_to() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 12, 5);
    let output = fleet(folder.path(), &["trains", "--out", "out", "--format", "csv,html", "--reports", "2"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let out = folder.path().join("out");
    let page = fs::read_to_string(out.join("fleet.html")).expect("a page");
    let rows = rows(&out.join("fleet.csv"));
    let mut expected: Vec<(String, f64)> = vec![];
    for row in &rows {
        let utilisation: f64 = row["utilisation"].parse().expect("a number");
        match expected.last_mut().filter(|(name, _)| *name == row["train"]) {
            Some((_, most)) => *most = most.max(utilisation),
            None => expected.push((row["train"].clone(), utilisation)),
        }
    }
    expected.sort_by(|a, b| b.1.total_cmp(&a.1));
    let found: Vec<(String, f64)> = table(&page)
        .iter()
        .map(|row| {
            let name = between(row, "<a href=\"#train-", "</a>")[0].split('>').nth(1).expect("a name").to_owned();
            (name, between(row, "worst\" data-n=\"", "\"")[0].parse().expect("a number"))
        })
        .collect();
    assert_eq!(found, expected);
    for link in between(&page, "href=\"#", "\"") {
        assert!(page.contains(&format!("id=\"{link}\"")), "{link}");
    }
    let reports: Vec<String> =
        between(&page, "<a href=\"trains", "\"").iter().map(|l| l.replace("&#x2f;", "/")).collect();
    assert!(reports.len() == 4, "two trains, each in the table and below: {reports:?}");
    assert!(reports.iter().all(|link| out.join(format!("trains{link}")).is_file()), "{reports:?}");
    // Nothing comes from anywhere else.
    for outside in ["src=", "@import", "url(", "<link", "href=\"http"] {
        assert!(!page.replace("url(#", "").contains(outside), "{outside}");
    }
    // The rest is written anew to the same bytes, now without reports.
    let again = ["trains", "--out", "out", "--format", "html", "--resume"];
    assert!(fleet(folder.path(), &again).status.success());
    let first = results_but_trains(&out);
    assert!(fleet(folder.path(), &again).status.success());
    assert_eq!(first, results_but_trains(&out));
}

fn results_but_trains(out: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    fs::remove_dir_all(out.join("trains")).ok();
    results(out)
}

#[test]
fn names_are_text_whatever_they_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 1, 3);
    let text = fs::read_to_string(folder.path().join("trains/train-0000.toml")).expect("a train");
    let names = [
        "<script>alert(1)</script>",
        "\\\"><img src=x onerror=alert(1)>",
        "' onmouseover='alert(1)",
        "</details></table><h1>",
        "{{ 7 * 7 }}{% raw %}<!--",
        "&lt;b&gt;",
    ];
    for (i, name) in names.iter().enumerate() {
        let pulse = "kind = \"pulse\"\nat = \"tail\"\nforce = \"1 MN\"\nduration = \"9 ms\"\n";
        let named = text.replace("\"train 0\"", &format!("\"{name}\""));
        let train = format!("{named}[[scenario]]\nname = \"{name}\"\n{pulse}");
        fs::write(folder.path().join(format!("trains/<b>\"'&{i}.toml")), train).expect("a train");
    }
    fs::write(folder.path().join("trains/<i>.toml"), "<u>no</u>").expect("a bad train");
    let output = fleet(folder.path(), &["trains", "--out", "out", "--format", "html", "--reports", "7"]);
    assert_eq!(output.status.code(), Some(3), "{}", complaint(&output));
    let page = fs::read_to_string(folder.path().join("out/fleet.html")).expect("a page");
    assert_eq!(table(&page).len(), 7);
    let own = "a bdi body caption circle clippath defs details div figcaption figure g h1 h2 head html input label line main meta \
               output p path polyline rect script style summary svg table tbody td text th thead title tr tspan";
    for tag in between(&page, "<", ">") {
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default().to_lowercase();
        let is_own = own.split_whitespace().any(|o| o == name) || tag.starts_with('!');
        // A script may compare.
        assert!(is_own || tag.starts_with(' ') || tag.starts_with('='), "<{tag}>");
        assert!(!tag.contains("onerror") && !tag.contains("onmouseover"), "<{tag}>");
    }
    assert_eq!(page.matches("<script>").count(), 1);
    assert!(page.contains("{{ 7 * 7 }}") && page.contains("&amp;lt;b&amp;gt;"));
}

/// A study has one train; its worst variations are its worst cases, and the report is of the worst.
#[test]
fn a_study_s_worst_variation_has_its_report() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 1, 4);
    let study =
        "trains = [\"trains\"]\n[[vary]]\nkey = \"load.uniform\"\nfrom = \"100 kN\"\nto = \"500 kN\"\nsteps = 9\n";
    fs::write(folder.path().join("study.toml"), study).expect("a study");
    let output = fleet(folder.path(), &["study.toml", "--out", "out", "--format", "html", "--reports", "5"]);
    assert!(output.status.success(), "{}", complaint(&output));
    let page = fs::read_to_string(folder.path().join("out/fleet.html")).expect("a page");
    assert!(page.contains("breaks, variation 9"));
    let json =
        fs::read_to_string(folder.path().join("out/trains/train-0000-variation-9/result.json")).expect("a result");
    let result: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    // The load of the ninth of nine values, before the event.
    assert_eq!(result["scenarios"][0]["cases"][0]["worst"]["initial_force_n"], 500_000.0);
}

#[test]
fn the_worst_train_stands_open_and_forces_are_in_the_units_that_are_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    write_fleet(&folder.path().join("trains"), 2, 5);
    let common = ["trains", "--format", "csv,html", "--reports", "1"];
    let page = |out: &str, more: &[&str]| {
        let output = fleet(folder.path(), &[&common[..], &["--out", out][..], more].concat());
        assert!(output.status.success(), "{}", complaint(&output));
        fs::read_to_string(folder.path().join(out).join("fleet.html")).expect("a page")
    };
    let (si, us) = (page("si", &[]), page("us", &["--units", "us"]));
    assert_eq!(between(&si, "<details id=\"train-", ">"), ["1\" open", "2\""]);
    let first = |page: &str, head: &str| -> f64 {
        assert!(page.contains(&format!(">force, {head}<")), "{head}");
        let cells = between(between(page, "<details id=\"train-1\"", "</details>")[0], "<td class=\"number\">", "<");
        cells[1].parse().expect("a force")
    };
    let (kilonewtons, kips) = (first(&si, "kN"), first(&us, "kip"));
    // Four digits each.
    assert!((kilonewtons / kips / 4.448_221_6 - 1.0).abs() < 2e-3, "{kilonewtons} kN and {kips} kip");
    let report = between(&us, "href=\"trains/", "\"")[0];
    let report = fs::read_to_string(folder.path().join("us/trains").join(report)).expect("a report");
    assert!(report.contains(" kip in "), "the full report is in them too");
}
