//! The structure of the crate: no cycle of dependencies between its modules or files, no dependency against the order of layers in
//! `lib.rs`, and no two public types of one name. Read from the sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Files of the program, which is a crate of its own.
const PROGRAM: [&str; 7] =
    ["main.rs", "cli.rs", "manual.rs", "signals.rs", "run_check.rs", "run_fleet.rs", "run_serve.rs"];

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// A file of the library: its module's path, and its text without comments.
struct Source {
    module: Vec<String>,
    text: String,
}

fn sources(folder: &Path, within: &[String], into: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name().into_string().expect("UTF-8"));
        if path.is_dir() {
            sources(&path, &[within, &[name]].concat(), into);
        } else if let Some(stem) =
            name.strip_suffix(".rs").filter(|_| !(within.is_empty() && PROGRAM.contains(&&*name)))
        {
            let own = if ["mod", "lib"].contains(&stem) { vec![] } else { vec![stem.to_owned()] };
            let text = fs::read_to_string(&path).expect("a source");
            let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
            into.push(Source { module: [within, &own].concat(), text: code.collect::<Vec<_>>().join("\n") });
        }
    }
}

fn library() -> Vec<Source> {
    let mut all = vec![];
    sources(&src(), &[], &mut all);
    assert!(all.len() > 100, "{} files", all.len());
    all
}

/// The identifier at the start of a text.
fn word(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

/// The first steps of the paths that follow `crate::`, as in `crate::units::shown` and `crate::{units, error::quoted}`.
fn first_steps(text: &str) -> BTreeSet<String> {
    let mut steps = BTreeSet::new();
    for rest in text.split("crate::").skip(1) {
        let Some(list) = rest.strip_prefix('{') else {
            steps.insert(word(rest).to_owned());
            continue;
        };
        let (mut depth, mut start) = (0, true);
        for (i, c) in list.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => start = true,
                c if start && !c.is_whitespace() => {
                    steps.insert(word(&list[i..]).to_owned());
                    start = false;
                }
                _ => {}
            }
        }
    }
    steps
}

/// Which top-level module refers to which, with a file that does.
fn arrows(all: &[Source]) -> BTreeMap<(String, String), String> {
    let tops: BTreeSet<&String> = all.iter().filter_map(|s| s.module.first()).collect();
    let mut arrows = BTreeMap::new();
    for source in all {
        let Some(top) = source.module.first() else { continue };
        let at = source.module.join("/");
        for step in first_steps(&source.text).into_iter().filter(|step| step != top) {
            assert!(tops.contains(&step), "{at} names crate::{step}: name it in its module");
            arrows.insert((top.clone(), step), at.clone());
        }
        // From a file of depth n, n steps up lead to the root of the crate.
        let to_root = format!("{}super::", "super::".repeat(source.module.len() - 1));
        for rest in source.text.split(&to_root).skip(1).map(word).filter(|step| step != top) {
            if tops.contains(&rest.to_owned()) {
                arrows.insert((top.clone(), rest.to_owned()), at.clone());
            }
        }
    }
    arrows
}

/// The modules in the order of the crate's front page, from the ground up.
fn order() -> Vec<String> {
    let page = fs::read_to_string(src().join("lib.rs")).expect("the front page");
    let block = page.split("//! # Layers").nth(1).and_then(|rest| rest.split("```").nth(1)).expect("a list of layers");
    let lines = block.lines().skip(1).filter_map(|line| line.strip_prefix("//! "));
    lines.map(|line| word(line).to_owned()).filter(|name| !name.is_empty()).collect()
}

#[test]
fn arrows_point_down() {
    let all = library();
    let order = order();
    let declared: BTreeSet<&String> = order.iter().collect();
    let modules: BTreeSet<&String> = all.iter().filter_map(|s| s.module.first()).collect();
    assert_eq!(declared, modules, "the front page lists every module");
    assert_eq!(declared.len(), order.len(), "and each once");
    let place = |name: &String| order.iter().position(|known| known == name);
    let up: Vec<String> = arrows(&all)
        .into_iter()
        .filter(|((from, to), _)| place(to) >= place(from))
        .map(|((from, to), at)| format!("{from} -> {to}, in {at}"))
        .collect();
    assert!(up.is_empty(), "arrows against the order of the front page: {up:#?}");
}

#[test]
fn no_modules_form_a_circle() {
    let arrows = arrows(&library());
    let mut left: BTreeSet<&(String, String)> = arrows.keys().collect();
    // A dependency on a module without dependencies, or of a module on which none depends, is no part of a cycle: these are removed.
    loop {
        let from: BTreeSet<&String> = left.iter().map(|(from, _)| from).collect();
        let to: BTreeSet<&String> = left.iter().map(|(_, to)| to).collect();
        let next = left.iter().copied().filter(|(a, b)| to.contains(a) && from.contains(b)).collect::<BTreeSet<_>>();
        if next.len() == left.len() {
            break;
        }
        left = next;
    }
    assert!(left.is_empty(), "circles among {left:#?}");
}

/// The paths that follow a prefix such as `super::`: one, or those of a list in braces, each up to its own list.
fn paths_after(rest: &str) -> Vec<Vec<String>> {
    let steps = |text: &str| text.split("::").map(|step| word(step.trim()).to_owned()).collect::<Vec<_>>();
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').unwrap_or(rest.len());
    let path = steps(rest[..end].trim_end_matches(':'));
    let Some(list) = rest[end..].strip_prefix('{') else { return vec![path] };
    let path: Vec<String> = path.into_iter().filter(|step| !step.is_empty()).collect();
    let (mut depth, mut start, mut all) = (0, 0, vec![]);
    for (i, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                let item = list[start..i].split('{').next().unwrap_or_default().trim_end_matches(':');
                all.push([&path[..], &steps(item)].concat());
                start = i + 1;
            }
            _ => {}
        }
        if c == '}' && depth == 0 && start == i + 1 {
            break;
        }
    }
    all
}

/// Which files a file names by `crate::`, `super::` or `super::super::` paths. A parent's paths to its children without these prefixes
/// are left out: it declares them.
fn named_files(source: &Source, files: &BTreeSet<&[String]>) -> BTreeSet<Vec<String>> {
    let code = source.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut named = BTreeSet::new();
    for (prefix, up) in [("crate::", source.module.len()), ("super::", 1), ("super::super::", 2)] {
        let base = &source.module[..source.module.len().saturating_sub(up)];
        let base = if prefix == "crate::" { &[][..] } else { base };
        for (before, rest) in code.match_indices(prefix).map(|(at, _)| (&code[..at], &code[at + prefix.len()..])) {
            if before.ends_with("super::") || rest.starts_with("super::") {
                continue;
            }
            for path in paths_after(rest) {
                let path = [base, &path].concat();
                let file = (1..=path.len()).rev().map(|n| &path[..n]).find(|known| files.contains(known));
                named.extend(file.filter(|file| *file != source.module).map(<[String]>::to_vec));
            }
        }
    }
    named
}

#[test]
fn no_files_form_a_circle() {
    let all = library();
    let files: BTreeSet<&[String]> = all.iter().map(|s| &s.module[..]).collect();
    let arrows = all.iter().flat_map(|s| named_files(s, &files).into_iter().map(|to| (s.module.clone(), to)));
    let mut left: BTreeSet<(Vec<String>, Vec<String>)> = arrows.collect();
    assert!(left.len() > 500, "{} arrows between files", left.len());
    loop {
        let from: BTreeSet<_> = left.iter().map(|(from, _)| from.clone()).collect();
        let to: BTreeSet<_> = left.iter().map(|(_, to)| to.clone()).collect();
        let before = left.len();
        left.retain(|(a, b)| to.contains(a) && from.contains(b));
        if left.len() == before {
            break;
        }
    }
    let left: Vec<String> = left.iter().map(|(a, b)| format!("{} -> {}", a.join("/"), b.join("/"))).collect();
    assert!(left.is_empty(), "circles among files: {left:#?}");
}

/// Whether a module can be named from outside the crate.
fn is_public(module: &[String], all: &BTreeMap<Vec<String>, &str>) -> bool {
    (1..=module.len()).all(|n| {
        let parent = all.get(&module[..n - 1]).copied().unwrap_or_default();
        parent.contains(&format!("pub mod {};", module[n - 1]))
    })
}

/// Whether a public module above re-exports the name.
fn is_exported(module: &[String], name: &str, all: &BTreeMap<Vec<String>, &str>) -> bool {
    (1..=module.len()).any(|n| {
        let above = &module[..n - 1];
        let text = all.get(above).copied().unwrap_or_default();
        let exports = text.split("pub use ").skip(1).filter_map(|rest| rest.split(';').next());
        let named = |list: &str| {
            list.starts_with(&format!("{}::", module[n - 1]))
                && list.split(|c: char| !c.is_alphanumeric() && c != '_').any(|w| w == name)
        };
        is_public(above, all) && exports.into_iter().any(named)
    })
}

#[test]
fn no_two_public_types_have_one_name() {
    let sources = library();
    let all: BTreeMap<Vec<String>, &str> = sources.iter().map(|s| (s.module.clone(), s.text.as_str())).collect();
    let mut found: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for Source { module, text } in &sources {
        let types = ["struct", "enum", "trait", "type"];
        let declared = text.lines().filter_map(|line| {
            let (kind, rest) = line.strip_prefix("pub ")?.split_once(' ')?;
            types.contains(&kind).then(|| word(rest))
        });
        for name in declared.filter(|name| is_public(module, &all) || is_exported(module, name, &all)) {
            found.entry(name).or_default().push(module.join("::"));
        }
    }
    assert!(found.len() > 100, "{} public types", found.len());
    let twice: Vec<_> = found.iter().filter(|(_, places)| places.len() > 1).collect();
    assert!(twice.is_empty(), "public types of one name: {twice:#?}");
}

/// The reading of paths itself.
#[test]
fn paths_are_read() {
    let text = "use crate::{units::{self, Amount}, error};\nlet x = crate::law::Law::linear(1.0);";
    assert_eq!(first_steps(text).into_iter().collect::<Vec<_>>(), ["error", "law", "units"]);
}
