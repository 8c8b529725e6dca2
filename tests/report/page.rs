//! What `report.html` carries besides the report.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};
use trainsafe::{Options, analyze, report};

fn page() -> String {
    let train = crate::common::built(&crate::common::figure_5());
    let analysis = analyze(&train, &Options::default()).expect("sound");
    let files = report::documents(&train, &analysis, &[report::Format::Html]).expect("written");
    let (_, bytes) = files.into_iter().find(|(name, _)| name == "report.html").expect("a page");
    String::from_utf8(bytes).expect("UTF-8")
}

fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    text.split_once(from).and_then(|(_, rest)| rest.split_once(to)).unwrap_or_else(|| panic!("no {from}")).0
}

/// The page's policy lets just the library run that it carries, which says whose it is and under which licence.
#[test]
fn the_policy_names_the_library_that_is_carried() {
    let page = page();
    let packed = STANDARD.decode(between(&page, "id=\"library\">", "</script>")).expect("base64");
    let mut library = String::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_string(&mut library).expect("gzip");
    assert!(library.starts_with("/** plotly.js 4."), "{}", &library[..100]);
    assert!(library[..200].contains("MIT licence"));
    let digest = STANDARD.encode(Sha256::digest(library.as_bytes()));
    assert!(between(&page, "script-src ", ";").contains(&format!("'sha256-{digest}'")), "{digest}");
}

/// Figures and script take their colours from one list, and no style says another colour for the same meaning.
#[test]
fn one_meaning_has_one_colour() {
    let page = page();
    for meaning in ["draft", "buff", "over", "rod", "slack", "ramp"] {
        assert_eq!(page.matches(&format!(" --{meaning}: ")).count(), 2, "{meaning}: once light, once dark");
        assert!(page.contains(&format!("color(\"{meaning}\")")), "{meaning} is used by the script");
    }
    for meaning in ["draft", "buff"] {
        let color = between(&page, &format!(" --{meaning}: "), ";");
        assert!(
            page.contains(&format!("stroke=\"{color}\" class=\"s-{meaning}\"")),
            "{meaning} is {color} in the figures"
        );
    }
}
