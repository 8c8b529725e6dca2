//! Train files in which one key after the other is changed, and the files beside them.

/// The head of each: eight vehicles under a load, with couplers near enough to their ratings for each key to matter.
const FRONT: &str = r#"
name = "base"
[coupler]
stiffness = "11 MN/m"
rated_load = "0.8 MN"
[[vehicle]]
label = "engine"
mass = "190 t"
held = true
[[vehicle]]
label = "car"
count = 6
mass = "90 t"
[[vehicle]]
label = "caboose"
mass = "60 t"
"#;

const UNIFORM: &str = "[load]\nuniform = \"0.6 MN\"\n";
const BREAK: &str = "[[scenario]]\nkind = \"break\"\ncoupler = 6\n";
const PULSE: &str = "[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nforce = \"-1 MN\"\nduration = \"200 ms\"\n";

/// The texts of the base files by their names.
pub fn all() -> Vec<(&'static str, String)> {
    let file = |parts: &[&str]| parts.concat();
    let free = FRONT.replace("held = true\n", "");
    let hauled = free.replace("label = \"engine\"", "label = \"engine\"\ntractive_effort = \"400 kN\"");
    let hauled = hauled.replace("label = \"car\"", "label = \"car\"\nbrake_force = \"1 kN\"");
    let pushed = FRONT.replace("label = \"caboose\"", "label = \"caboose\"\ntractive_effort = \"200 kN\"");
    let of_table = FRONT.split("[[vehicle]]").next().unwrap_or_default();
    let of_table = of_table.replace("name =", "vehicles = \"consist.csv\"\nname =");
    let overridden = "[[coupler_override]]\nat = 2\nrated_load = \"0.7 MN\"\n";
    let limits = "[[coupler_override]]\nat = 2\nlimits.proof = \"0.75 MN\"\n";
    let dashpots = FRONT.replace("0.8 MN", "0.8 MN\"\ndamping = \"300 kN*s/m");
    let modal = FRONT.replace("\"base\"", "\"base\"\ndamping_ratio = 0.2");
    let buff = "[load]\nuniform = \"-0.6 MN\"\n";
    let slopes = "[load]\ngrade = \"0.2 %\"\nrolling_resistance = \"20 N/t\"\n";
    let impact = "[[scenario]]\nkind = \"impact\"\nat = \"tail\"\nvehicles = 2\nspeed = \"4 mph\"\n";
    let each = "[[scenario]]\nkind = \"break\"\ncoupler = \"each\"\n";
    let record = "[[scenario]]\nkind = \"pulse\"\nat = \"tail\"\nrecord = \"pulse.csv\"\n";
    let at_head = |text: &str| text.replace("tail", "head");
    let (cascade, trapezoid) = ("cascade = true\n", "shape = \"trapezoid\"\nrise = \"20 ms\"\n");
    let slack = FRONT.replace("\"11 MN/m\"", "\"11 MN/m\"\nslack = \"10 mm\"");
    let gear = FRONT.replace(
        "stiffness = \"11 MN/m\"",
        "gear = \"gear of all.csv\"\nsolid_stiffness = \"200 MN/m\"\nslack = \"10 mm\"",
    );
    let wedge = gear.replace("gear of all.csv\"", "wedge.csv\"\nfriction = \"50 %\"");
    let braked = |front: &str| {
        let long = front.replace("mass = ", "length = \"15 m\"\nmass = ");
        let long = long.replace("label = \"car\"", "label = \"car\"\nemergency_brake = \"50 kN\"");
        long.replace("\"base\"", "\"base\"\nspeed = \"50 km/h\"")
    };
    let course = "emergency.wave = \"250 m/s\"\nemergency.build_up = [[\"0 s\", \"0 %\"], [\"1 s\", \"100 %\"]]\n";
    let brake = "[[scenario]]\nkind = \"brake\"\nat = \"both ends\"\nhorizon = \"6 s\"\n";
    vec![
        ("break", file(&[FRONT, UNIFORM, BREAK])),
        ("override", file(&[FRONT, overridden, UNIFORM, BREAK])),
        ("override of limits", file(&[FRONT, limits, UNIFORM, BREAK])),
        ("each", file(&[FRONT, UNIFORM, each])),
        ("each, some in buff", file(&[&pushed, "[load]\ngrade = \"8 %\"\n", each])),
        ("break, cascade", file(&[FRONT, UNIFORM, BREAK, cascade])),
        ("hauled", file(&[&hauled, slopes, BREAK])),
        ("dashpots", file(&[&dashpots, UNIFORM, BREAK])),
        ("modal damping", file(&[&modal, UNIFORM, BREAK])),
        ("pulse", file(&[&free, UNIFORM, PULSE])),
        ("pulse, cascade", file(&[&free, UNIFORM, PULSE, cascade])),
        (
            "half-sine at the head",
            file(&[&free, UNIFORM, &at_head(PULSE).replace("-1 MN", "-3 MN"), "shape = \"half-sine\"\n"]),
        ),
        ("trapezoid", file(&[&free, UNIFORM, PULSE, trapezoid])),
        ("record", file(&[&free, UNIFORM, record])),
        ("impact", file(&[&free, buff, impact])),
        ("impact at the head, cascade", file(&[&free, buff, &at_head(impact), cascade])),
        ("hauled impact", file(&[&hauled, "[load]\ngrade = \"0.2 %\"\n", impact])),
        ("table", file(&[&of_table, UNIFORM, BREAK])),
        ("slack", file(&[&slack, UNIFORM, BREAK])),
        ("gear", file(&[&gear, UNIFORM, BREAK])),
        ("gear, override", file(&[&gear, overridden, UNIFORM, BREAK])),
        ("gear without unloading", file(&[&wedge, overridden, UNIFORM, BREAK])),
        ("gear, emergency", file(&[&braked(&gear), UNIFORM, BREAK, course])),
        (
            "emergency of a hauled train",
            file(&[&braked(&hauled), slopes, BREAK, "emergency = \"AAR\"\ncut_power.after = \"1 s\"\n"]),
        ),
        ("throttle", file(&[&hauled, slopes, BREAK, "throttle = \"throttle of all.csv\"\n"])),
        ("emergency brakes", file(&[&braked(&hauled), slopes, brake, course, "cascade = true\n"])),
        (
            "emergency brakes, throttle",
            file(&[&braked(&hauled), slopes, brake, course, "throttle = \"throttle of all.csv\"\n"]),
        ),
        (
            "emergency brakes, power cut",
            file(&[&braked(&hauled), slopes, brake, course, "cut_power.after = \"1 s\"\n"]),
        ),
        ("service brakes", file(&[&braked(&gear), UNIFORM, brake, &course.replace("emergency", "service")])),
    ]
}

const GEAR: &str = "travel [mm],loading [kN],unloading [kN]\n0,0,0\n7,120,60\n100,1100,300\n";

/// Files beside them.
pub const BESIDE: [(&str, &str); 10] = [
    ("gear of all.csv", GEAR),
    ("gear.csv", "travel [mm],loading [kN],unloading [kN]\n0,0,0\n9,120,60\n80,1000,250\n"),
    ("stiffer.csv", "travel [mm],loading [kN],unloading [kN]\n0,0,0\n5,220,90\n60,1300,250\n"),
    ("wedge.csv", "travel [mm],loading [kN]\n0,0\n100,1500\n"),
    ("throttle of all.csv", "time [s],share [%]\n0,100\n2,20\n"),
    ("throttle.csv", "time [s];force [kN];vehicle\n0;400;engine\n1;50,5;engine\n"),
    ("consist.csv", "label,mass [t],count,held\nengine,190,1,yes\ncar,90,6,\ncaboose,60,1,\n"),
    ("other.csv", "label,mass [t],count,held\nengine,190,1,yes\ncar,90,5,\ncaboose,30,1,\n"),
    ("pulse.csv", "time_ms,force_kn\n0,0\n50,900\n200,0\n"),
    ("longer.csv", "time_ms,force_kn\n0,0\n50,900\n400,0\n"),
];
