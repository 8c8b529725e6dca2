//! The reference against closed forms computed with 40 digits apart from this code: each is given as a leading `f64` and the rest of its
//! digits.

#![allow(clippy::excessive_precision)]

use super::exact::{GearFound, GearReference, march};
use super::roots;
use crate::forcing::Drive;
use crate::law::{Curve, GearRow, Law, Rest};
use crate::march::Problem;
use crate::solve::dd::Dd;

const M: f64 = 130e3;
const K: f64 = 17.9e6;

fn curve(rows: &[[f64; 3]]) -> Curve {
    let row = |r: &[f64; 3]| GearRow { travel_m: r[0], loading_n: r[1], unloading_n: r[2] };
    Curve::new(rows.iter().map(row).collect()).expect("a table")
}

fn gear(solid_n_per_m: f64, slack_m: f64, curve: &Curve) -> Law {
    Law::Gear { solid_n_per_m, slack_m, draft: curve.clone(), buff: curve.clone() }
}

fn spring(k: f64, slack_m: f64) -> Law {
    Law::Elastic { draft_n_per_m: k, buff_n_per_m: k, slack_m }
}

fn found(problem: &Problem, times: &[f64]) -> GearFound {
    let reference = GearReference::new(problem, times).expect("few steps");
    let largest = reference.found.largest.iter().flatten().map(|f| f.abs().hi).fold(0.0, f64::max);
    assert!(reference.doubt_n <= 1e-26 * largest, "doubt {:e}", reference.doubt_n / largest);
    reference.found
}

#[track_caller]
fn near(got: Dd, want: [f64; 2], tolerance: f64) {
    let off = (got - Dd::from(want[0]) - Dd::from(want[1])).abs().hi;
    assert!(off <= tolerance, "{got:?} for {want:?}: off by {off:.1e}");
}

/// The digits that are given end at 1e-19 of the force.
#[test]
fn two_cars_close_a_gap() {
    let pair = Problem { speed_m_s: vec![0.0, 1.0], ..Problem::at_rest(vec![M; 2], vec![spring(K, 0.025)], 0.3) };
    near(found(&pair, &[]).largest[0][1], [1078656.0, 0.5718522276727], 1e-13);
}

/// Oracle of the wedge: 75 % friction; the constants of its law are whole numbers of newtons.
#[test]
fn wedge() {
    let table = curve(&[[0., 0., 0.], [1., 17.9e6, 4.475e6]]);
    let start = vec![Rest { force_n: 0.0, travel_m: -0.5 }];
    let pair =
        Problem { speed_m_s: vec![0.0, 1.0], start, ..Problem::at_rest(vec![M; 2], vec![gear(2e8, 1.0, &table)], 0.3) };
    near(found(&pair, &[]).largest[0][1], [1033402.0, 0.6633934044193], 1e-13);
}

#[test]
fn hard_contacts() {
    let contacts = |masses: [f64; 3], horizon: f64| Problem {
        speed_m_s: vec![0.0, 0.0, 1.0],
        ..Problem::at_rest(masses.to_vec(), vec![spring(1e10, 0.025); 2], horizon)
    };
    let equal = found(&contacts([M; 3], 0.07), &[]);
    for force in [equal.largest[0][1], equal.largest[1][1], equal.largest[0][0]] {
        near(force, [25495097.0, 0.56796392415], 1e-11);
    }
    let unequal = found(&contacts([130e3, 80e3, 200e3], 0.035), &[]);
    near(unequal.largest[1][1], [23904572.0, 0.186687872799], 1e-12);
    near(unequal.largest[0][1], [31791350.0, 0.872239245199], 1e-12);
}

/// 15 events up to t = 12 by matrix exponentials, 48 up to t = 40 by a march of 113 bits. Stiffnesses over travel are those of
/// `1 / (1 - 1 / 18)` in double precision, which moves forces by some 1e-16.
#[test]
fn sequence_of_events() {
    let h = 18.0 / 17.0;
    let law = gear(18.0, 0.5, &curve(&[[0., 0., 0.], [17.0, 17.0 * h, 8.5 * h]]));
    let problem = Problem {
        held_head: true,
        start: vec![law.rest(&[1.0]); 3],
        ..Problem::at_rest(vec![1.0; 4], vec![law; 3], 40.0)
    };
    let forces = found(&problem, &[12.0, 40.0]).forces;
    let at_12 = [-0.32120696395859405864, -0.24544023974424768514, -0.1110785466292290856];
    let at_40 = [0.20237234374275118232, 0.15605554949119171759, 0.0];
    for i in 0..3 {
        near(forces[0][i], [at_12[i], 0.0], 3e-16);
        near(forces[1][i], [at_40[i], 0.0], 2e-15);
    }
}

#[test]
fn brake_ramp() {
    let ramp = Drive::Lines(vec![[0.0, 0.0], [1.5, -13500.0], [9.0, -13500.0]]);
    let problem = Problem { forcing: vec![(1, ramp)], ..Problem::at_rest(vec![M; 2], vec![spring(K, 0.0)], 2.0) };
    let forces = found(&problem, &[1.0, 1.5]).forces;
    near(forces[0][0], [4710.0, 0.1637847407681903], 1e-15);
    near(forces[1][0], [6814.0, 0.6335138964503327], 1e-15);
}

/// A half sine on one of two: `F = -P/2 ...`, the forced oscillation in closed form, in double precision.
#[test]
fn half_sine_on_one_of_two() {
    let (peak, duration) = (1e6, 0.3);
    let drive = Drive::HalfSine { peak, duration };
    let problem = Problem { forcing: vec![(1, drive)], ..Problem::at_rest(vec![M; 2], vec![spring(K, 0.0)], 0.5) };
    let (omega, drive) = ((2.0 * K / M).sqrt(), std::f64::consts::PI / duration);
    let swing = |t: f64| {
        let share = omega * omega / (omega * omega - drive * drive);
        -0.5 * peak * share * ((drive * t).sin() - drive / omega * (omega * t).sin())
    };
    // The end of the half sine is another one's start.
    let force = |t: f64| swing(t) + if t > duration { swing(t - duration) } else { 0.0 };
    let times = [0.1, 0.25, 0.41];
    for (row, t) in found(&problem, &times).forces.iter().zip(times) {
        near(row[0], [force(t), 0.0], 1e-8);
    }
}

/// A stop hit at 2 to 8 mph; a friction gear parted in draft whose gap closes again, against a march in steps (Verlet with a clamp).
#[test]
fn bottoming() {
    let table =
        curve(&[[0., 0., 0.], [7e-3, 12e4, 12e4], [38e-3, 68e4, 172e3], [114e-3, 135e4, 3e5], [149e-3, 252e4, 36e4]]);
    let wants = [815543.374211429561, 1536597.2509891355461, 5518455.2574792159857, 10158584.628342670848];
    for (mph, want) in [2.0, 4.0, 6.0, 8.0].into_iter().zip(wants) {
        let start = vec![Rest { force_n: 0.0, travel_m: -0.05 }];
        let speed_m_s = vec![0.0, mph * 0.44704];
        let pair = Problem { speed_m_s, start, ..Problem::at_rest(vec![M; 2], vec![gear(2e8, 0.1, &table)], 0.5) };
        near(found(&pair, &[]).largest[0][1], [want, 0.0], 3e-15 * want);
    }
}

#[test]
fn first_of_several_roots() {
    let c = [-0.09, 0.73, -1.6, 1.0];
    let first = roots::first_positive(&c).expect("one");
    assert!((roots::halved(&c, first) - 0.2).abs() < 1e-15);
    let all = roots::all(&c);
    let want = [0.2, 0.5, 0.9];
    assert!(all.len() == 3 && all.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-14), "{all:?}");
    assert_eq!(roots::first_positive(&[-0.25, 1.0, -1.0 - 1e-9]), None);
    assert!(roots::first_positive(&[-0.25, 1.0, -1.0 + 1e-9]).is_some());
    assert!(march(&Problem::at_rest(vec![1.0], vec![], 1.0), &[], 0.8).is_ok());
}
