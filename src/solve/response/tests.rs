use proptest::prelude::*;

use super::super::solve;
use super::*;
use crate::chain::Chain;

/// A chain whose last mass is pulled.
fn pulled(mass: Vec<f64>, held_head: bool, horizon: f64) -> Scene {
    let springs = mass.len() - 1;
    let none = vec![f64::INFINITY; springs];
    Scene {
        chain: Chain { mass, stiffness: vec![1.0; springs], held_head, held_tail: false },
        source: springs,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![0.0; springs],
        rated_draft: none.clone(),
        rated_buff: none,
        horizon,
    }
}

fn response(scene: &Scene) -> UnitResponse {
    UnitResponse::new(scene, propagator::omega_max(scene))
}

/// All parts of the trains of a fleet of equal vehicles, held at the head or not, each as long as four transits.
#[test]
fn responses_of_a_fleet_of_equal_vehicles_fit_in_the_memory_for_them() {
    let bytes = |springs: usize| -> usize {
        let of = |held: bool| response(&pulled(vec![1.0; springs + 1], held, 4.0 * springs as f64)).bytes();
        of(false) + of(true)
    };
    let all: usize = (1..=120).map(bytes).sum();
    assert!(all < 27 << 20, "{all}");
}

/// Forces after every step of a march.
struct Ends(Vec<Vec<f64>>);

impl StepObserver for Ends {
    fn see<S: Simd, const H: usize>(&mut self, _: Rows<S, H>, view: &View) {
        let springs = 0..self.0[0].len();
        self.0.push(springs.map(|spring| view.force(1, 0, spring)).collect());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(30) })]

    /// What is kept is what the march had, and every record is larger than those before.
    #[test]
    fn kept_forces_are_those_of_the_march(
        mass in prop::collection::vec(0.3..2.0f64, 2..60), held: bool, duration in 1.0..200.0f64
    ) {
        let scene = Scene { duration, ..pulled(mass.clone(), held, 5.0 * mass.len() as f64) };
        let response = response(&scene);
        let mut ends = Ends(vec![vec![0.0; mass.len() - 1]]);
        let (motion, omega) = (&response.motion, propagator::omega_max(&scene));
        let marched = Marched { scene: &scene, motion, omega };
        march(&[marched], StepKind::exact(propagator::KICK_TERMS), &mut ends);
        let forces = |instant: usize, spring: usize| response.forces.at(instant, spring);
        for (spring, negative) in (0..mass.len() - 1).flat_map(|spring| [(spring, false), (spring, true)]) {
            let mut largest = 0.0;
            for run in &response.runs[spring][usize::from(negative)] {
                for kept in &response.steps[run.first as usize..=run.last as usize] {
                    for (end, s) in around(mass.len() - 1, spring).1.flat_map(|s| [(0, s), (1, s)]) {
                        let known = forces(kept.instant as usize + end, s);
                        prop_assert_eq!(known, ends.0[kept.step.number as usize + end][s]);
                    }
                    let is_last = kept.step.number == response.steps[run.last as usize].step.number;
                    let end = if negative { -1.0 } else { 1.0 } * ends.0[kept.step.number as usize + 1][spring];
                    let value = if is_last { run.top.value } else { end };
                    prop_assert!(value > largest && value >= end - 1e-14, "{spring} {run:?}");
                    largest = value;
                }
            }
        }
    }

    /// Levels that are passed within a run, and horizons and marks that cut one.
    #[test]
    fn runs_tell_what_a_solution_of_its_own_tells(
        masses in 8usize..50, held: bool, place in 0.0..1.0f64, parts in [0.02..0.98f64, 0.02..0.98, 0.02..0.98]
    ) {
        let bare = pulled(vec![1.0; masses], held, 4.0 * (masses - 1) as f64);
        let response = response(&bare);
        let of_side = |i: usize| response.runs[i / 2][i % 2].iter().map(move |run| (i / 2, i % 2 == 1, run));
        let long: Vec<_> = (0..2 * (masses - 1)).flat_map(of_side).filter(|of| of.2.last > of.2.first + 3).collect();
        let (spring, negative, run) = long[(place * long.len() as f64) as usize];
        // Steps of the run after its first, and instants within them.
        let [level, mark, horizon] = parts.map(|part| run.first + 1 + (part * f64::from(run.last - run.first)) as u32);
        let kept = |step: u32| &response.steps[step as usize];
        let at_end = |step: u32| response.forces.at_end(kept(step), spring, negative).value;
        let within = |step: u32, part: f64| kept(step).step.from + part * kept(step).step.width;
        let (mark, horizon) = (within(mark, parts[1]), within(horizon, parts[2]));
        let mut scene = Scene { horizon, force: 2.0, ..bare.clone() };
        let ratings = if negative { &mut scene.rated_buff } else { &mut scene.rated_draft };
        // A rating that is 0 but for rounding is one at which the spring stands.
        let rating = (0.5 * (at_end(level - 1) + at_end(level)) * scene.force).max(1e-6);
        ratings[spring] = rating;
        let ask = Ask { tolerance: 1e-9, mark: Some(mark.min(horizon)), ..Ask::default() };
        let own = solve(&scene, &ask).expect("a solution");
        let other = response.solution(&scene, &ask, Mapping { mirrored: false, time: None }).expect("a solution");
        let apart = own.error_bound + other.error_bound;
        for (own, other) in [(&own.springs, &other.springs), (&own.to_mark, &other.to_mark)] {
            prop_assert_eq!(own.len(), masses - 1);
            for (i, (a, b)) in own.iter().zip(other).enumerate() {
                let (a, b) = (a.expect("every spring was asked for"), b.expect("every spring was asked for"));
                for side in [false, true] {
                    let (a, b) = (a.side(side), b.side(side));
                    prop_assert!((a.best.value - b.best.value).abs() <= apart, "{a:?} {b:?}");
                    let is_rated = (i, side) == (spring, negative) && (a.best.value - rating).abs() > apart;
                    prop_assert!(!is_rated || a.first_over.is_some() == b.first_over.is_some(), "{a:?} {b:?}");
                    let apart = a.first_over.zip(b.first_over).map_or(0.0, |(a, b)| (a - b).abs());
                    prop_assert!(apart < 1e-7, "{a:?} {b:?}");
                }
            }
        }
    }
}
