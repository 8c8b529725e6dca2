//! `trainsafe check`.

use std::path::Path;

use serde_json::{Value, json};
use trainsafe::consist;
use trainsafe::doubts::doubts;
use trainsafe::error::{InputError, printable_path};
use trainsafe::findings::require_case;
use trainsafe::train::Train;

use super::{Failure, cli, print, quiet, read_train, say};

pub fn run(args: &cli::Check) -> Result<(), Failure> {
    if args.json {
        return as_json(args);
    }
    let mut wrong = false;
    let mut described = Vec::new();
    for path in &args.trains {
        match read_runnable(path) {
            Ok(train) => {
                let heading = if args.trains.len() > 1 { format!("{}:\n", shown(path)) } else { String::new() };
                described.push(heading + &consist::describe(&args.units.of(train)));
            }
            Err(problems) => {
                wrong = true;
                say(&problems.render(true));
            }
        }
    }
    if !quiet() {
        print(&described.join("\n"))?;
    }
    if wrong { Err(Failure::Input) } else { Ok(()) }
}

fn as_json(args: &cli::Check) -> Result<(), Failure> {
    let files: Vec<Value> = args.trains.iter().map(|path| file(path)).collect();
    let wrong = files.iter().any(|file| file["ok"] == false);
    print(&format!("{:#}\n", json!({ "schema_version": 1, "files": files })))?;
    if wrong { Err(Failure::Input) } else { Ok(()) }
}

fn file(path: &Path) -> Value {
    let path_shown = shown(path);
    match read_runnable(path) {
        Ok(train) => {
            let scenarios: Vec<&str> = train.scenarios().iter().map(|s| s.name.as_str()).collect();
            json!({
                "path": path_shown, "ok": true, "problems": [], "more_problems": 0, "doubts": doubts(&train),
                "train": train.name(), "vehicles": train.vehicles().len(), "couplers": train.couplers().len(),
                "scenarios": scenarios,
            })
        }
        Err(error) => {
            let (problems, more) = error.problems();
            json!({ "path": path_shown, "ok": false, "problems": problems, "more_problems": more, "doubts": [] })
        }
    }
}

/// A train with a case to run.
fn read_runnable(path: &Path) -> Result<Train, InputError> {
    let train = read_train(path)?;
    let help = "check the sign of the load: draft is positive";
    require_case(train.scenarios()).map_err(|error| InputError::of_file(path, error.to_string(), help))?;
    Ok(train)
}

fn shown(path: &Path) -> String {
    printable_path(if path.as_os_str() == "-" { consist::STDIN.as_ref() } else { path })
}
