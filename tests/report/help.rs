//! Help, completions and manual pages.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const COMMANDS: [&str; 10] =
    ["analyze", "fleet", "accuracy", "serve", "check", "new", "import", "schema", "completions", "man"];

fn trainsafe(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_trainsafe")).args(args).env("COLUMNS", "100").output().expect("it runs")
}

fn printed(args: &[&str]) -> String {
    let run = trainsafe(args);
    assert!(run.status.success() && run.stderr.is_empty(), "{args:?}: {}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).expect("UTF-8")
}

fn helps() -> impl Iterator<Item = (&'static str, String)> {
    let of = |command: &'static str| (command, printed(&[command, "--help"]));
    COMMANDS.into_iter().map(of).chain([("the program", printed(&["--help"]))])
}

/// A program that some machines lack; on those that have it, it must be content.
fn run(program: &str, args: &[&str]) -> Option<Output> {
    match Command::new(program).args(args).stdin(Stdio::null()).output() {
        Ok(output) => Some(output),
        Err(_) => {
            eprintln!("{program} is not there: what it would have checked is not checked");
            None
        }
    }
}

#[test]
fn the_list_of_commands_is_whole() {
    let help = printed(&["--help"]);
    let list = help.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("the commands");
    let names: Vec<&str> =
        list.lines().filter(|l| !l.starts_with("   ")).filter_map(|l| l.split_whitespace().next()).collect();
    assert_eq!(names, [&COMMANDS[..], &["help"]].concat());
}

#[test]
fn help_fits_one_screen() {
    for (command, help) in helps() {
        let widest = help.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(help.lines().count() <= 40 && widest <= 100, "{command}: {widest} columns\n{help}");
    }
}

/// The example that each help ends with, in a folder with the trains.
#[test]
fn examples_in_the_help_run() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir_all(folder.path().join("trains/gears")).expect("a folder");
    for beside in ["trains", "trains/gears"] {
        let files = fs::read_dir(beside).expect("the trains").map(|file| file.expect("an entry").path());
        for path in files.filter(|path| path.is_file()) {
            fs::copy(&path, folder.path().join(&path)).expect("a copy");
        }
    }
    let bin = Path::new(env!("CARGO_BIN_EXE_trainsafe")).parent().expect("a folder");
    let path = std::env::join_paths(
        [bin.to_owned()].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    );
    for (command, help) in helps() {
        let example =
            help.lines().last().and_then(|line| line.strip_prefix("Example: ")).expect("an example at the end");
        assert!(example.contains("trainsafe "), "{command}");
        if command == "serve" {
            // It runs until it is ended: its own tests do so.
            continue;
        }
        let Some(shell) = cfg!(unix).then_some("sh") else { return };
        let run = Command::new(shell)
            .args(["-c", example])
            .env("PATH", path.as_ref().expect("a path"))
            .current_dir(folder.path())
            .output()
            .expect("a shell");
        assert!(run.status.success(), "{command}: {example}\n{}", String::from_utf8_lossy(&run.stderr));
    }
    for written in [
        "study/rear/report.md",
        "reports/yard/fleet.md",
        "accuracy/figure-4/accuracy.md",
        "train.schema.json",
        "man1/trainsafe.1",
    ] {
        assert!(folder.path().join(written).is_file(), "{written}");
    }
}

#[cfg(not(feature = "serve"))]
#[test]
fn a_build_without_serve_says_how_to_get_it() {
    let run = trainsafe(&["serve", "trains/ore-train.toml"]);
    assert_eq!(run.status.code(), Some(2));
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(said.contains("cargo install --path . --features serve"), "{said}");
}

#[test]
fn bash_takes_its_completions_and_every_shell_gets_the_commands() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = printed(&["completions", shell]);
        for command in COMMANDS {
            assert!(script.contains(command), "{shell}: {command}");
        }
        assert!(script.contains("fail-on-exceed"), "{shell}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("trainsafe.bash");
    fs::write(&file, printed(&["completions", "bash"])).expect("written");
    if let Some(syntax) = run("bash", &["-n", &file.display().to_string()]) {
        assert!(syntax.status.success() && syntax.stderr.is_empty(), "{}", String::from_utf8_lossy(&syntax.stderr));
        // What bash itself offers after `trainsafe an`.
        let asked = format!(
            "source {}; COMP_WORDS=(trainsafe an); COMP_CWORD=1; _trainsafe trainsafe an trainsafe; echo \"${{COMPREPLY[*]}}\"",
            file.display()
        );
        let offered = run("bash", &["-c", &asked]).expect("bash, as above");
        assert_eq!(String::from_utf8_lossy(&offered.stdout).trim(), "analyze");
    }
}

fn pages() -> (TempDir, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("man1");
    assert_eq!(printed(&["man", "--out", &out.display().to_string()]), "");
    let names =
        fs::read_dir(&out).expect("the pages").map(|f| f.expect("an entry").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    (folder, names)
}

#[test]
fn there_is_a_page_for_every_command() {
    let (folder, names) = pages();
    let mut expected: Vec<String> = COMMANDS.iter().map(|command| format!("trainsafe-{command}.1")).collect();
    expected.push("trainsafe.1".to_owned());
    expected.sort();
    assert_eq!(names, expected);
    let text = |name: &str| fs::read_to_string(folder.path().join("man1").join(name)).expect("a page");
    assert_eq!(printed(&["man"]), text("trainsafe.1"));
    assert_eq!(printed(&["man", "fleet"]), text("trainsafe-fleet.1"));
    let wrong = trainsafe(&["man", "frobnicate"]);
    assert_eq!(wrong.status.code(), Some(2));
    for name in names {
        let page = text(&name);
        let heading =
            |h: &str| page.lines().any(|line| line.starts_with(&format!(".SH {h}")) || line == format!(".SH \"{h}\""));
        assert!(page.contains(&format!(".TH {}", name.trim_end_matches(".1"))), "{page}");
        assert!(heading("NOTES") && heading("NAME") && heading("SYNOPSIS") && heading("DESCRIPTION"), "{page}");
        assert!(page.contains("Example: "), "{page}");
    }
}

/// `groff` and `mandoc` render every page; what they warn of would show.
#[test]
fn pages_render_without_warnings() {
    let (folder, names) = pages();
    for name in names {
        let path = folder.path().join("man1").join(&name).display().to_string();
        for (program, args) in
            [("groff", &["-man", "-Tutf8", "-ww", "-z"][..]), ("mandoc", &["-T", "lint", "-W", "warning"])]
        {
            let Some(render) = run(program, &[args, &[path.as_str()]].concat()) else { continue };
            let said = [render.stdout, render.stderr].concat();
            assert!(render.status.success() && said.is_empty(), "{program} {name}: {}", String::from_utf8_lossy(&said));
        }
    }
}
