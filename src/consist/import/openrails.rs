//! Consists of Open Rails: a `.con` names its vehicles, and a `.wag` or `.eng` file describes each.
//!
//! ```text
//! Wagon ( HOPPER Mass ( 90t ) Size ( 3.1m 4.2m 12.5m )
//!     Coupling ( Spring ( Stiffness ( 1e6N/m 5e6N/m ) Damping ( 1e6N/m/s 1e6N/m/s ) Break ( 5.1e6N 5.1e6N ) r0 ( 20cm 30cm ) ) ) )
//! ```
//!
//! The first `Coupling` is the front one, the second the rear one; a vehicle that is flipped has them the other way round. Of two
//! stiffnesses the larger counts (the other is that of the slack), of two strengths the second, as in the game. Between two
//! vehicles both couplings act one behind the other: 1 / k = 1 / k1 + 1 / k2, and the weaker strength is the rating.

mod tree;
mod units;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::write::toml_string;
use super::{Draft, Files, Given, Group};
use crate::error::{InputError, quoted};
use crate::train::Doubt;
use tree::Block;
use units::{Of, Read};

/// No real coupling is stronger than this, N.
const STRONGEST_N: f64 = 10e6;
/// Includes are followed to this depth.
const DEEPEST: usize = 8;

/// A vehicle of the consist.
struct Member {
    folder: String,
    file: String,
    extension: &'static str,
    flipped: bool,
}

/// What a vehicle's file says.
#[derive(Clone, Default)]
struct Vehicle {
    keys: Vec<Given>,
    missing: Vec<[String; 2]>,
    /// Stiffness, N/m, and strength, N, of the front and the rear coupling.
    couplings: [[Option<f64>; 2]; 2],
    /// Keys of its couplings that are not read.
    unread: Vec<String>,
}

/// Reads a consist's text.
///
/// # Errors
/// A text that is no consist, or a consist without vehicles.
pub(super) fn draft(text: &str, path: &Path, trainsets: &[PathBuf], files: &Files) -> Result<Draft, InputError> {
    let (root, unclosed) = Block::parse(text);
    let consist = root.find("TrainCfg");
    let members: Vec<Member> = consist.iter().flat_map(|consist| consist.blocks()).filter_map(member).collect();
    if members.len() < 2 {
        let title = format!("the consist has {}", crate::train::count(members.len(), "vehicle"));
        return Err(InputError::of_file(path, title, "give the path of a consist of Open Rails with two or more"));
    }
    let folders = folders(path, trainsets);
    let mut known: HashMap<String, Vehicle> = HashMap::new();
    let mut vehicles = vec![];
    for member in &members {
        let name = format!("{}/{}.{}", member.folder, member.file, member.extension);
        let vehicle = known.entry(name.clone()).or_insert_with(|| vehicle(member, &name, &folders, files)).clone();
        vehicles.push((name, vehicle, member.flipped));
    }
    let mut draft = Draft {
        source: path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        name: consist.and_then(|c| c.find("Name")).and_then(Block::word).unwrap_or("consist").to_owned(),
        groups: groups(&vehicles),
        remarks: remarks(&vehicles),
        doubts: vec![],
    };
    draft.doubts.extend(unclosed.then(|| {
        let text =
            "the consist ends within a block: the file may have been cut off, and vehicles be missing".to_owned();
        Doubt::of_train("consist-cut-off", text)
    }));
    draft.doubts.extend(members.iter().all(|member| find(member, &folders).is_none()).then(|| {
        let text = "no vehicle's file is found: they are looked for beside the consist, in TRAINSET and in ../TRAINSET; \
                    --trainset names another folder";
        Doubt::of_train("no-vehicle-files", text.to_owned())
    }));
    draft.doubts.extend(too_strong(&vehicles));
    Ok(draft)
}

/// A vehicle of the consist, if the block is one.
fn member(block: &Block) -> Option<Member> {
    let (data, extension) = match block.name.to_lowercase().as_str() {
        "engine" => (block.find("EngineData")?, "eng"),
        "wagon" => (block.find("WagonData")?, "wag"),
        _ => return None,
    };
    let [file, folder] = [data.words.first()?, data.words.get(1)?].map(String::clone);
    Some(Member { folder, file, extension, flipped: block.find("Flip").is_some() })
}

/// Where folders of vehicles are looked for.
fn folders(consist: &Path, trainsets: &[PathBuf]) -> Vec<PathBuf> {
    let own = consist.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned();
    let beside = own.canonicalize().ok().and_then(|own| Some(own.parent()?.to_owned()));
    let with_trainset = |folder: PathBuf| entry(&folder, "TRAINSET").into_iter().chain([folder]);
    trainsets.iter().cloned().chain([own].into_iter().chain(beside).flat_map(with_trainset)).collect()
}

/// An entry of a folder by its name, in capital or small letters as on Windows.
fn entry(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if exact.exists() {
        return Some(exact);
    }
    let mut entries = fs::read_dir(folder).ok()?.flatten().map(|e| e.path());
    entries.find(|path| path.file_name().is_some_and(|n| n.to_string_lossy().eq_ignore_ascii_case(name)))
}

fn find(member: &Member, folders: &[PathBuf]) -> Option<PathBuf> {
    let plain = |name: &str| !name.contains(['/', '\\']) && name != "..";
    if !plain(&member.folder) || !plain(&member.file) {
        return None;
    }
    let name = format!("{}.{}", member.file, member.extension);
    let own = folders.iter().filter_map(|folder| entry(folder, &member.folder)).find_map(|folder| {
        // A file in the folder `openrails` replaces the original game's.
        let or = entry(&folder, "openrails").and_then(|or| entry(&or, &name));
        or.or_else(|| entry(&folder, &name))
    });
    own.or_else(|| folders.iter().find_map(|folder| entry(folder, &name)).filter(|path| path.is_file()))
}

/// The blocks of a vehicle's file and of those that it includes, which come first.
fn blocks(path: &Path, files: &Files, depth: usize) -> Result<Vec<Block>, String> {
    let text = files.beside(path, |_| true).map_err(|[title, _]| title)?;
    let (own, _) = Block::parse(&text);
    let mut all = vec![];
    for include in own.all("include").filter(|_| depth < DEEPEST) {
        let name = include.word().unwrap_or_default().replace('\\', "/");
        let mut folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let (above, file) = name.rsplit_once('/').map_or(("", name.as_str()), |(above, file)| (above, file));
        above.split('/').filter(|part| !part.is_empty()).for_each(|part| folder.push(part));
        let found =
            entry(&folder, file).ok_or_else(|| format!("the file {} that it includes is not there", quoted(&name)))?;
        all.extend(blocks(&found, files, depth + 1)?);
    }
    all.push(own);
    Ok(all)
}

fn vehicle(member: &Member, name: &str, folders: &[PathBuf], files: &Files) -> Vehicle {
    let label = Given { key: "label".into(), value: toml_string(&member.file), from: name.to_owned() };
    let mut vehicle = Vehicle { keys: vec![label], ..Vehicle::default() };
    let read = find(member, folders).ok_or_else(|| format!("{name} is not found"));
    let blocks = match read.and_then(|path| blocks(&path, files, 0).map_err(|why| format!("{name}: {why}"))) {
        Ok(blocks) => blocks,
        Err(why) => {
            vehicle.missing.push(["mass".into(), why]);
            return vehicle;
        }
    };
    let wagons: Vec<&Block> = blocks.iter().flat_map(|root| root.all("Wagon")).collect();
    // The last file that has a key counts.
    let last = |key: &str| wagons.iter().rev().find_map(|wagon| wagon.find(key));
    let mut quantity = |key: &str, block: &str, index: usize, of: Of| {
        let written = last(block).and_then(|b| b.words.get(index));
        match written.map(|text| (text, units::read(text, of))) {
            Some((text, Some(Read { value, unit, .. }))) if value > 0.0 => {
                let from = format!("{block} ( {text} ) of {name}");
                vehicle.keys.push(Given { key: key.into(), value: toml_string(&format!("{value} {unit}")), from });
            }
            Some((text, _)) => vehicle.missing.push([key.into(), format!("{block} ( {text} ) of {name} is not read")]),
            None if key == "mass" => vehicle.missing.push([key.into(), format!("{name} has no {block}")]),
            None => {}
        }
    };
    quantity("mass", "Mass", 0, Of::Mass);
    quantity("length", "Size", 2, Of::Length);
    let couplings = wagons.iter().rev().map(|w| w.all("Coupling").collect::<Vec<_>>()).find(|all| !all.is_empty());
    let couplings = couplings.unwrap_or_default();
    let ends = [couplings.first(), couplings.get(1).or(couplings.first())];
    for (end, coupling) in ends.into_iter().enumerate() {
        let Some(spring) = coupling.and_then(|c| c.find("Spring")) else { continue };
        vehicle.couplings[end] = [stiffness(spring), strength(spring)];
        vehicle
            .unread
            .extend(["Damping", "r0"].iter().filter(|key| spring.find(key).is_some()).map(|k| (*k).to_owned()));
    }
    vehicle
}

/// The values of a block, in SI units, where all of them can be read.
fn values(spring: &Block, key: &str, of: Of) -> Vec<f64> {
    let words = spring.find(key).map_or(&[][..], |block| &block.words);
    let read: Option<Vec<f64>> = words.iter().map(|text| Some(units::read(text, of)?.si)).collect();
    read.unwrap_or_default()
}

fn stiffness(spring: &Block) -> Option<f64> {
    values(spring, "Stiffness", Of::Stiffness).into_iter().filter(|k| *k > 0.0).reduce(f64::max)
}

fn strength(spring: &Block) -> Option<f64> {
    let values = values(spring, "Break", Of::Force);
    values.get(1).filter(|n| **n > 1.0).or(values.first()).copied().filter(|n| *n > 0.0)
}

type Placed = (String, Vehicle, bool);

/// The coupling at an end of a vehicle as it stands in the train: 0 ahead, 1 behind.
fn coupling((_, vehicle, flipped): &Placed, end: usize) -> [Option<f64>; 2] {
    vehicle.couplings[if *flipped { 1 - end } else { end }]
}

fn groups(vehicles: &[Placed]) -> Vec<Group> {
    let of = |i: usize| {
        let coupler = vehicles.get(i + 1).map_or_else(Vec::new, |next| between(&vehicles[i], next));
        let (_, Vehicle { keys, missing, .. }, _) = &vehicles[i];
        Group { count: 1, vehicle: keys.clone(), coupler, missing: missing.clone() }
    };
    (0..vehicles.len()).map(of).collect()
}

/// What joins two vehicles.
fn between(ahead: &Placed, behind: &Placed) -> Vec<Given> {
    let ([k1, s1], [k2, s2]) = (coupling(ahead, 1), coupling(behind, 0));
    let of = |what: &str, a: f64, b: f64, unit: &str| {
        let both = format!("{what}: {} {unit} of {}, {} {unit} of {}", a / 1e6, ahead.0, b / 1e6, behind.0);
        if ahead.0 == behind.0 && a == b { format!("{what}: {} {unit} of {}", a / 1e6, ahead.0) } else { both }
    };
    let given = |key: &str, si: f64, unit: &str, from: String| Given {
        key: key.into(),
        value: toml_string(&format!("{} {unit}", si / 1e6)),
        from,
    };
    let stiffness = k1.zip(k2).map(|(a, b)| {
        given("stiffness", 1.0 / (1.0 / a + 1.0 / b), "MN/m", of("two couplings in series", a, b, "MN/m"))
    });
    let rating = s1.zip(s2).map(|(a, b)| given("rated_load", a.min(b), "MN", of("the weaker Break", a, b, "MN")));
    stiffness.into_iter().chain(rating).collect()
}

fn remarks(vehicles: &[Placed]) -> Vec<String> {
    let mut unread: Vec<&str> = vehicles.iter().flat_map(|(_, v, _)| v.unread.iter().map(String::as_str)).collect();
    unread.sort_unstable();
    unread.dedup();
    let mut remarks = vec![
        "Stiffness: the larger of the two values of each coupling, both couplings in series; rated_load: the weaker Break.".to_owned(),
    ];
    if !unread.is_empty() {
        remarks.push(format!("Not taken over from the couplings: {}.", unread.join(", ")));
    }
    remarks
}

/// A doubt about unreal strengths.
fn too_strong(vehicles: &[Placed]) -> Option<Doubt> {
    let strong =
        |(_, v, _): &&Placed| v.couplings.iter().any(|[_, strength]| strength.is_some_and(|n| n > STRONGEST_N));
    let found: Vec<&Placed> = vehicles.iter().filter(strong).collect();
    let (name, ..) = found.first()?;
    let more = if found.len() > 1 { format!(" and of {} more vehicles", found.len() - 1) } else { String::new() };
    let text = format!(
        "the coupling of {name}{more} breaks at more than {} MN: that is a value to keep a game's trains together, and no \
         coupler's; put the real rating in its place",
        STRONGEST_N / 1e6
    );
    Some(Doubt::of_train("strength-of-game", text))
}
