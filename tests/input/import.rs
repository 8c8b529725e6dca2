//! `trainsafe import`: a train file from a table of vehicles, and from a consist of Open Rails; each number with its source.

use std::fs;
use std::path::Path;
use std::process::Command;

use trainsafe::consist;
use trainsafe::train::Train;
use trainsafe::{Options, analyze};

/// What `import` writes and says.
fn import(folder: &Path, args: &[&str]) -> (String, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
        .arg("import")
        .args(args)
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    assert_eq!(out.status.code(), Some(0), "{}", text(out.stderr));
    (text(out.stdout), text(out.stderr))
}

fn read(text: &str) -> Train {
    consist::parse(text, Path::new("imported.toml")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// 20 vehicles by a table that says everything: the train is that of the table, and is analysed.
#[test]
fn a_whole_table_becomes_the_same_train() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut table =
        "Label;Count;Mass (t);Length [m];Stiffness [MN/m];Rated load [MN];Rated buff;proof load [MN]\n".to_owned();
    table += "locomotive;2;130,5;20,1;40;1,5;2 MN;\n";
    for i in 0..9 {
        table += if i == 4 { "tank;1;82;17;25;0,9;;1,1\n" } else { "hopper;2;118;16;30;1,2;120 %;\n" };
    }
    table += "van;1;24;10;;;;\n";
    fs::write(folder.path().join("yard.csv"), &table).expect("written");
    let (text, said) = import(folder.path(), &["yard.csv"]);
    assert_eq!(said, "");
    let imported = read(&text);
    let direct = "vehicles = \"yard.csv\"\n[coupler]\nstiffness = \"30 MN/m\"\nrated_load = \"1.2 MN\"\n";
    fs::write(folder.path().join("direct.toml"), direct).expect("written");
    let direct = consist::read(&folder.path().join("direct.toml")).expect("a train");
    assert_eq!(imported.vehicles().len(), 20);
    assert_eq!((imported.vehicles(), imported.couplers()), (direct.vehicles(), direct.couplers()));
    assert_eq!(imported.extras().limits, direct.extras().limits);
    for line in ["count = 8", "mass = \"118 t\"", "# row 3, column Mass (t), and alike to row 6", "name = \"yard\""] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    assert!(text.contains("16 of 19 couplers; row 3, column Stiffness [MN/m]"), "{text}");
    let loaded = text + "\n[load]\nuniform = \"0.5 MN\"\n";
    let analysis = analyze(&read(&loaded), &Options::default()).expect("an analysis");
    assert_eq!(analysis.scenarios[0].cases.len(), 19);
}

/// What a table does not say is marked and told, and the file is refused until it is filled in.
#[test]
fn what_is_missing_is_marked_and_never_made_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = "label,mass [t],rated_load [MN],colour\na,90,1.2,red\nb,90,,blue\nc,80,,\n";
    fs::write(folder.path().join("t.csv"), table).expect("written");
    let (text, said) = import(folder.path(), &["t.csv"]);
    let expected = "missing: coupler.stiffness: given for no coupler\nmissing: coupler.rated_load: given for 1 of 2 couplers\n\
                    warning: the column \"colour\" of t.csv is not read\n";
    assert_eq!(said, expected);
    assert!(text.contains("# MISSING: coupler.stiffness: given for no coupler\n"), "{text}");
    assert!(text.contains("# Doubtful: the column \"colour\" of t.csv is not read\n"), "{text}");
    let refused = consist::parse(&text, Path::new("t.toml")).expect_err("incomplete");
    assert!(refused.to_string().contains("[coupler] has no stiffness"), "{refused}");
    let filled = text.replace("# stiffness", "stiffness").replace("# rated_load", "rated_load");
    let train = read(&filled);
    assert_eq!(train.couplers().iter().map(|c| c.rated_draft_n).collect::<Vec<_>>(), [1.2e6, 1.5e6]);
    let (quiet, nothing) = import(folder.path(), &["t.csv", "-q"]);
    assert_eq!((quiet, nothing.as_str()), (text, ""));
}

/// A label that TOML has to escape, a held head, a share of the rating.
#[test]
fn odd_cells_come_through() {
    let folder = tempfile::tempdir().expect("a folder");
    let table =
        "label,held,mass [t],rated_load,rated_buff\n\"a \"\"b\"\" \\ c\",yes,90,1 MN,110 %\nd,,90,60 %,\nd,,90,,\n";
    fs::write(folder.path().join("t.csv"), table).expect("written");
    let (text, said) = import(folder.path(), &["t.csv"]);
    // A share is one of [coupler]'s rating, so none of the table's ratings can stand there.
    assert!(said.contains("missing: coupler.rated_load: given for 2 of 2 couplers"), "{said}");
    let train = read(&text.replace("# stiffness", "stiffness").replace("# rated_load = \"1.5", "rated_load = \"2"));
    assert_eq!(train.vehicles()[0].label, "a \"b\" \\ c");
    assert!(train.vehicles()[0].held);
    assert_eq!(train.couplers()[0].rated_draft_n, 1e6);
    assert!((train.couplers()[0].rated_buff_n - 1.1e6).abs() < 1e-6);
    assert_eq!(train.couplers()[1].rated_draft_n, 0.6 * 2e6);
}

const CONSIST: &str = "SIMISA@@@@@@@@@@JINX0D0t______\n\n\
Train (\n\tTrainCfg ( \"test\"\n\t\tName ( \"Coal \" + \"empties\" )\n\t\tMaxVelocity ( 40.0 0.5 )\n\
\t\tEngine ( UiD ( 0 ) EngineData ( gp38 GP ) )\n\
\t\tWagon ( WagonData ( hopper HOP ) UiD ( 1 ) )\n\
\t\tWagon ( Flip ( ) WagonData ( hopper HOP ) UiD ( 2 ) )\n\
\t\tWagon ( WagonData ( ghost HOP ) UiD ( 3 ) )\n\t\tcomment ( Wagon ( WagonData ( not HOP ) ) )\n\t)\n)\n";

const ENGINE: &str = "SIMISA@@@@@@@@@@JINX0D0t______\n\nWagon ( gp38\n\tcomment ( Mass ( 1t ) )\n\tMass ( 120t-us )\n\tSize ( 3m 4m 59ft )\n\
\tCoupling ( Type ( Automatic ) Spring ( Stiffness ( 2e1N/m 6e6N/m ) Damping ( 1e6N/m/s 1e6N/m/s ) Break ( 2e6N 1.8e6N ) r0 ( 20cm 30cm ) ) )\n)\n\
Engine ( gp38 MaxForce ( 200kN ) )\n";

const HOPPER: &str = "SIMISA@@@@@@@@@@JINX0D0t______\n\nWagon ( hopper\n\tMass ( 28.5t )\n\tSize ( 3m 4m 14.5 )\n\
\tCoupling ( Spring ( Stiffness ( 3e6N/m ) Break ( 400000lb 400000lb ) ) )\n\
\tCoupling ( Spring ( Stiffness ( 4e6N/m ) Break ( 5e7N 5e7N ) ) )\n)\n";

fn utf16(text: &str) -> Vec<u8> {
    [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
}

/// In the folders and in the encoding in which the game has them; names in another case.
#[test]
fn a_consist_of_open_rails() {
    let folder = tempfile::tempdir().expect("a folder");
    let trains = folder.path().join("TRAINS");
    for dir in ["CONSISTS", "TRAINSET/Gp", "TRAINSET/hop"] {
        fs::create_dir_all(trains.join(dir)).expect("a folder");
    }
    fs::write(trains.join("CONSISTS/coal.con"), utf16(CONSIST)).expect("written");
    fs::write(trains.join("TRAINSET/Gp/GP38.eng"), utf16(ENGINE)).expect("written");
    fs::write(trains.join("TRAINSET/hop/Hopper.wag"), HOPPER).expect("written");
    let (text, said) = import(&trains.join("CONSISTS"), &["coal.con"]);
    let expected = "missing: coupler.stiffness: given for 2 of 3 couplers\nmissing: coupler.rated_load: given for 2 of 3 couplers\n\
                    missing: mass of a vehicle: HOP/ghost.wag is not found\n\
                    warning: the coupling of HOP/hopper.wag and of 1 more vehicles breaks at more than 10 MN: that is a value to \
                    keep a game's trains together, and no coupler's; put the real rating in its place\n";
    assert_eq!(said, expected);
    assert!(text.contains("# Not taken over from the couplings: Damping, r0.\n"), "{text}");
    let filled = text
        .replace("# mass = \"...\"", "mass = \"30 t\"")
        .replace("# stiffness", "stiffness")
        .replace("# rated_load", "rated_load");
    let train = read(&filled);
    assert_eq!(train.name(), "Coal empties");
    let masses: Vec<f64> = train.vehicles().iter().map(|v| v.mass_kg).collect();
    let us_ton = 2000.0 * 0.453_592_37;
    assert!((masses[0] - 120.0 * us_ton).abs() < 1e-6 && masses[1..] == [28_500.0, 28_500.0, 30_000.0], "{masses:?}");
    let lengths: Vec<Option<f64>> = train.vehicles().iter().map(|v| v.length_m).collect();
    assert!((lengths[0].expect("a length") - 59.0 * 0.3048).abs() < 1e-9);
    assert_eq!(lengths[1..], [Some(14.5), Some(14.5), None]);
    // Behind the engine its rear coupling, the only one it has, and the hopper's front one; then two rear ones, for the second is flipped.
    let pound_n = 4.448_221_615_260_5;
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b;
    assert!(near(train.couplers()[0].stiffness_n_per_m, 1.0 / (1.0 / 6e6 + 1.0 / 3e6)), "{:?}", train.couplers()[0]);
    assert!(near(train.couplers()[0].rated_draft_n, 400_000.0 * pound_n), "{:?}", train.couplers()[0]);
    assert!(near(train.couplers()[1].stiffness_n_per_m, 2e6));
    assert!(near(train.couplers()[1].rated_draft_n, 5e7));
    assert_eq!(train.couplers()[2].stiffness_n_per_m, 30e6);
}

/// A file that Open Rails has of its own includes the game's and goes before it; `--trainset` names other folders.
#[test]
fn included_files_and_other_folders() {
    let folder = tempfile::tempdir().expect("a folder");
    let consist = CONSIST.replace("( ghost HOP )", "( hopper HOP )");
    fs::write(folder.path().join("coal.con"), consist).expect("written");
    let [gp, own] = ["more/GP", "more/HOP/OpenRails"].map(|dir| folder.path().join(dir));
    fs::create_dir_all(&gp).and_then(|()| fs::create_dir_all(&own)).expect("a folder");
    fs::write(gp.join("gp38.eng"), ENGINE).expect("written");
    fs::write(own.parent().expect("a folder").join("hopper.wag"), HOPPER).expect("written");
    fs::write(own.join("hopper.wag"), "include ( ../hopper.wag )\nWagon ( hopper Mass ( 31.2t ) )\n").expect("written");
    let (text, said) = import(folder.path(), &["coal.con", "--trainset", "more"]);
    assert!(!said.contains("missing"), "{said}");
    let train = read(&text);
    assert_eq!(train.vehicles().iter().map(|v| v.mass_kg).collect::<Vec<_>>()[1..], [31_200.0; 3]);
    assert_eq!(train.couplers().len(), 3);
    let (text, said) = import(folder.path(), &["coal.con"]);
    assert!(
        !text.contains("31.2") && said.contains("warning: no vehicle's file is found: they are looked for"),
        "{said}"
    );
    // A copy on another system may have another case.
    fs::rename(folder.path().join("more"), folder.path().join("Trainset")).expect("renamed");
    assert!(import(folder.path(), &["coal.con"]).0.contains("31.2"));
}

#[test]
fn a_consist_that_is_cut_off_is_doubted() {
    let folder = tempfile::tempdir().expect("a folder");
    let cut = &CONSIST[..CONSIST.rfind("Wagon").expect("wagons")];
    for (text, is_doubted) in [(CONSIST, false), (cut, true)] {
        fs::write(folder.path().join("coal.con"), text).expect("written");
        assert_eq!(import(folder.path(), &["coal.con"]).1.contains("the consist ends within a block"), is_doubted);
    }
}

#[test]
fn what_is_no_table_and_no_consist_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("written");
        consist::import(&folder.path().join(name), &[]).expect_err("refused").to_string()
    };
    assert!(said("a.csv", "x,y\n1,2\n").contains("this is no table of vehicles"));
    assert!(said("b.csv", "mass [t]\n90\nx\n").contains("row 3, column mass [t]"));
    assert!(said("c.con", "Train ( TrainCfg ( \"x\" ) )").contains("the consist has 0 vehicles"));
    // Neither depth nor unmatched parentheses nor open quotation marks do harm.
    for odd in ["(".repeat(200_000), ")".repeat(1000), "\"".to_owned(), "Train ( TrainCfg ( \"".to_owned()] {
        assert!(said("d.con", &odd).contains("the consist has 0 vehicles"));
    }
}
