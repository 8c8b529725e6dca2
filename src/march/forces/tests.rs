use super::*;

/// A rigid train, locomotives of 392 t and 30 cars of 130 t, whose pipe opens at the rear: its coupler forces
/// follow from the brake forces by arithmetic.
#[test]
fn brake_wave_on_a_rigid_train() {
    let build_up = vec![[0.0, 0.0], [1.5, 0.3], [8.0, 1.0]];
    let full_n = [0.0].into_iter().chain([45e3; 30]).collect();
    let emergency = Brakes { wave_m_s: 290.0, build_up, full_n, length_m: vec![16.2; 31] };
    let mass: Vec<f64> = [392e3].into_iter().chain([130e3; 30]).collect();
    let want = [
        (1.0, 7357.1333997493331619, 40609.045859176655847),
        (3.0, 45676.157925052098655, 55292.734270903117514),
        (6.0, 85616.059487640938295, 75982.11059500001236),
        (12.0, 123299.16123019571295, 65759.552656104380242),
    ];
    for (t, first, fifteenth) in want {
        let mut forces = Forces::new(&[], 31);
        // Behind the last vehicle.
        forces.apply_from_coupler(&emergency, 1.0, 30, 0.0);
        forces.pass(t);
        let mut force = [0.0; 31];
        forces.expand(t, 1.0, 20, |v, k, f| {
            if k == 0 {
                force[v] += f
            }
        });
        let acceleration = force.iter().sum::<f64>() / mass.iter().sum::<f64>();
        let coupler = |i: usize| force[..i].iter().sum::<f64>() - acceleration * mass[..i].iter().sum::<f64>();
        for (i, want) in [(1, first), (15, fifteenth)] {
            assert!((coupler(i) - want).abs() < 1e-9, "{t} s, coupler {i}: {} for {want}", coupler(i));
        }
    }
}

/// Each vehicle brakes from the first wave that comes, and once.
#[test]
fn two_partings() {
    let (build_up, length_m) = (vec![[0.0, 0.0], [1.0, 1.0]], vec![16.0; 31]);
    let emergency = Brakes { wave_m_s: 320.0, build_up, full_n: vec![1.0; 31], length_m };
    let mut forces = Forces::new(&[], 31);
    forces.apply_from_coupler(&emergency, 1.0, 3, 0.0);
    let first: Vec<f64> = (0..31).map(|v: i32| (f64::from(v) - 3.5).abs() / 20.0).collect();
    assert_eq!(forces.braked_from, first);
    forces.apply_from_coupler(&emergency, 1.0, 27, 0.5);
    let second: Vec<f64> = (0..31).map(|v: i32| 0.5 + (f64::from(v) - 27.5).abs() / 20.0).collect();
    let earliest: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a.min(*b)).collect();
    assert_eq!((&forces.braked_from, forces.sources.len()), (&earliest, 31));
    assert!(forces.braked_from[30] < first[30] && forces.braked_from[10] == first[10]);
}
