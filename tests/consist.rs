//! Train files that are right: what they become.

use std::fs;
use std::path::Path;

use trainsafe::consist::{self, TEMPLATE, Train};

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn the_template_parses_with_and_without_its_optional_keys() {
    let plain = parse(TEMPLATE);
    assert_eq!(plain.vehicles.len(), 2);
    let full = parse(&TEMPLATE.replace("\n#: ", "\n"));
    assert_eq!(full.vehicles.len(), 105);
    assert_eq!(full.scenarios.len(), 2);
}

#[test]
fn every_train_in_the_folder_parses() {
    let files = fs::read_dir("trains").expect("the folder of trains");
    for file in files {
        let path = file.expect("an entry").path();
        consist::read(&path).unwrap_or_else(|e| panic!("{e}"));
    }
}
