//! The steady state of a hauled train, and what a break makes of forces that taper toward the tail.

use std::path::Path;

use trainsafe::consist;
use trainsafe::train::Train;
use trainsafe::{Options, analyze};

fn parse(text: &str) -> Train {
    consist::parse(text, Path::new("a.toml")).unwrap_or_else(|e| panic!("{e}"))
}

const COUPLER: &str = "[coupler]\nstiffness = \"20 MN/m\"\nrated_load = \"2 MN\"\n";

/// Forces agree to the rounding of a few products and sums in the expected value.
fn close(found: &[f64], expected: &[f64]) {
    let size = expected.iter().fold(0.0f64, |a, f| a.max(f.abs()));
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= 1e-14 * size, "{f:e} is not {e:e}");
    }
    assert_eq!(found.len(), expected.len());
}

/// Resistance in proportion to mass slows all vehicles alike, so that a coupler passes on the share of the traction that
/// the mass behind it has; so does a grade.
#[test]
fn traction_is_shared_by_the_mass_behind_whatever_resistance_and_grade() {
    let train = |load: &str| {
        parse(&format!(
            "{COUPLER}[[vehicle]]\nmass = \"200 t\"\ntractive_effort = \"400 kN\"\n
             [[vehicle]]\nmass = \"100 t\"\ncount = 8\n{load}"
        ))
    };
    let expected: Vec<f64> = (1..=8).map(|i| 400e3 * f64::from(9 - i) * 100.0 / 1000.0).collect();
    let level = train("");
    close(level.initial_force_n(), &expected);
    close(train("[load]\nrolling_resistance = \"15 N/t\"\ngrade = \"1.2 %\"").initial_force_n(), &expected);
    let steady = level.extras().steady.clone().expect("a steady state");
    assert!((steady.acceleration_m_per_s2 - 0.4).abs() < 1e-15, "400 kN on 1000 t");
}

/// Behind a held head each coupler carries what the vehicles behind it need.
#[test]
fn a_held_head_pulls_what_is_behind() {
    let text = format!(
        "{COUPLER}[[vehicle]]\nmass = \"200 t\"\nheld = true\n[[vehicle]]\nmass = \"80 t\"\ncount = 3\n
         [[vehicle]]\nmass = \"20 t\"\ncount = 2\ngrade = \"-1 %\"\nrolling_resistance = \"30 N/t\"\n
         [load]\nrolling_resistance = \"15 N/t\"\ngrade = \"2 %\""
    );
    let slope = |s: f64| 9806.65 * s / (1.0 + s * s).sqrt();
    let (heavy, light) = (80.0 * (15.0 + slope(0.02)), 20.0 * (30.0 - slope(0.01)));
    let expected = [3.0 * heavy + 2.0 * light, 2.0 * heavy + 2.0 * light, heavy + 2.0 * light, 2.0 * light, light];
    let train = parse(&text);
    close(train.initial_force_n(), &expected);
    assert_eq!(train.extras().steady.as_ref().map(|s| s.acceleration_m_per_s2), Some(0.0));
}

/// A locomotive that brakes alone is pushed by the cars.
#[test]
fn brakes_at_the_head_put_the_train_in_buff() {
    let text = format!(
        "{COUPLER}[[vehicle]]\nmass = \"100 t\"\nbrake_force = \"200 kN\"\n[[vehicle]]\nmass = \"50 t\"\ncount = 2"
    );
    close(parse(&text).initial_force_n(), &[-100e3, -50e3]);
    let dynamic = text.replace("brake_force = \"200 kN\"", "tractive_effort = \"-200 kN\"");
    close(parse(&dynamic).initial_force_n(), &[-100e3, -50e3]);
}

/// Between two held ends a force on one vehicle is shared as the springs before and behind it allow: 1 : 1/2 in compliance.
#[test]
fn two_held_ends_share_by_compliance() {
    let text = format!(
        "{COUPLER}[[vehicle]]\nmass = \"1 t\"\nheld = true\n[[vehicle]]\nmass = \"1 t\"\ntractive_effort = \"90 kN\"\n
         [[vehicle]]\nmass = \"1 t\"\n[[vehicle]]\nmass = \"1 t\"\nheld = true\n"
    );
    // One spring of 1/k before, two in series behind: 2/3 of the force in buff before, 1/3 in draft behind.
    close(parse(&text).initial_force_n(), &[-60e3, 30e3, 30e3]);
}

/// Largest draft and buff over the broken coupler's force in N equal free vehicles behind the break, forces falling
/// linearly to the free tail, within 4.4 N time units. Sampled values of another program, good to 1e-3 (they are samples,
/// so that ours are not below them by more than their last digit).
#[test]
fn a_tapered_rear_part() {
    let sampled = [(5, 0.800, 0.818), (20, 1.060, 1.075), (50, 1.144, 1.157), (100, 1.197, 1.200), (200, 1.218, 1.226)];
    for (n, draft, buff) in sampled {
        let text = format!(
            "[coupler]\nstiffness = \"1 N/m\"\nrated_load = \"1 kN\"\n[[vehicle]]\nmass = \"1 kg\"\nheld = true\n
             [[vehicle]]\nmass = \"1 kg\"\ncount = {n}\n[load]\nrolling_resistance = \"{} N/t\"\n
             [[scenario]]\nkind = \"break\"\ncoupler = 1\nhorizon = \"{} s\"",
            1000.0 / f64::from(n),
            4.4 * f64::from(n)
        );
        let train = parse(&text);
        assert!((train.initial_force_n()[0] - 1.0).abs() < 1e-14);
        let analysis = analyze(&train, &Options::default()).expect("sound");
        let couplers = &analysis.scenarios[0].cases[0].couplers;
        let most = |f: &dyn Fn(&trainsafe::findings::CouplerFindings) -> Option<f64>| {
            couplers.iter().filter_map(f).fold(0.0f64, |a, x| a.max(x.abs()))
        };
        let (found_draft, found_buff) = (most(&|c| c.peak_draft_n), most(&|c| c.peak_buff_n));
        for (found, sampled) in [(found_draft, draft), (found_buff, buff)] {
            assert!((found - sampled).abs() < 1e-3, "N = {n}: {found}, sampled {sampled}");
        }
    }
}
