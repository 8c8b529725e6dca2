//! Train files that are wrong: the exact message for each.
//!
//! `tests/bad_trains/NAME.toml` is refused with what stands in `NAME.txt`, to the letter.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use trainsafe::consist;

fn message(path: &Path) -> String {
    match consist::read(path) {
        Ok(train) => panic!("{} was taken: {train:?}", path.display()),
        Err(error) => {
            let coloured = error.render(true);
            let plain = anstream::adapter::strip_str(&coloured).to_string();
            assert_eq!(plain, error.to_string(), "colour changes the text of {}", path.display());
            plain
        }
    }
}

fn files(extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir("tests/bad_trains").expect("the folder of bad trains");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == extension));
    paths.sort();
    paths
}

#[test]
fn every_bad_train_has_its_message() {
    let trains = files("toml");
    let of_messages: Vec<PathBuf> = files("txt").iter().map(|path| path.with_extension("toml")).collect();
    assert_eq!(trains, of_messages, "each .toml has a .txt");
    assert!(trains.len() > 60, "{} bad trains", trains.len());
    let mut wrong = String::new();
    for path in trains {
        let expected = fs::read_to_string(path.with_extension("txt")).expect("the message's file");
        let found = message(&path) + "\n";
        if found != expected {
            wrong += &format!("--- {}, expected\n{expected}--- found\n{found}\n", path.display());
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn a_missing_file() {
    let expected = "error: there is no such file
--> tests/bad_trains/no-such-file.toml
 = help: give the path of a train file; `trainsafe new` prints one to start from";
    assert_eq!(message(Path::new("tests/bad_trains/no-such-file.toml")), expected);
}

#[test]
fn a_folder() {
    let expected = "error: this is a folder
--> tests/bad_trains
 = help: give the path of a train file in it";
    assert_eq!(message(Path::new("tests/bad_trains")), expected);
}

#[test]
fn a_path_through_a_file_cannot_be_read() {
    let found = message(Path::new("tests/bad_trains/empty.toml/inside.toml"));
    assert!(found.starts_with("error: the file cannot be read: "), "{found}");
}

#[test]
fn a_file_of_100_mb_is_refused_by_its_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.toml");
    File::create(&path).and_then(|file| file.set_len(100_000_000)).expect("a large file");
    let expected = format!(
        "error: the file has 100 MB, and at most 8 MiB are read
--> {}
 = help: shorten it: in a train file or table, `count` groups vehicles that are alike",
        path.display()
    );
    assert_eq!(message(&path), expected);
}

#[cfg(unix)]
#[test]
fn an_endless_file_is_refused_after_the_limit() {
    assert!(
        message(Path::new("/dev/zero")).starts_with("error: the file has no end in sight, and at most 8 MiB are read")
    );
}
