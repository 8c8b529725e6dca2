use super::*;

fn chain(springs: usize, mass: impl Fn(usize) -> f64, stiffness: impl Fn(usize) -> f64) -> Chain {
    let (mass, stiffness) = ((0..=springs).map(mass).collect(), (0..springs).map(stiffness).collect());
    Chain { mass, stiffness, held_head: true, held_tail: false }
}

/// Equal chains with an odd vehicle, stiff couplers, and two that are linked so weakly that frequencies coincide.
fn chains() -> Vec<Chain> {
    let mut chains = vec![chain(60, |v| if v == 20 { 0.3 } else { 1.0 }, |_| 1.0), chain(1, |_| 1.0, |_| 1.0)];
    for stiff in [1e4, 1e8] {
        let square = |i: usize| (i * i) as f64;
        let stiffness = |i: usize| (1.0 + 0.4 * (2.3 * square(i)).cos()) * if i % 10 == 5 { stiff } else { 1.0 };
        chains.push(chain(37, |v| 1.0 + 0.6 * (1.7 * square(v)).sin(), stiffness));
        chains.push(chain(41, |_| 1.0, |i| if i == 20 { 1.0 / stiff } else { 1.0 }));
    }
    // Light vehicles between soft couplers, each with a frequency of its own that is the same for all.
    chains.push(chain(20, |v| if v % 4 == 2 { 1e-6 } else { 1.0 }, |_| 1.0));
    chains
}

/// Against bisection by counting, which needs neither a start nor a gap; every mode's equations hold to its residual.
#[test]
fn modes_are_those_of_the_chain() {
    for chain in chains() {
        let path = Path::new(&chain);
        let (modes, top) = (path.modes(), Dd::from(2.0 * path.omega_bound()));
        assert_eq!(modes.len(), path.nodes() / 2);
        for (j, mode) in modes.iter().enumerate() {
            let counted = path.bisect_in_dd(j, Dd::from(1e-9), top);
            assert!((mode.omega - counted).abs().hi < 1e-28 * counted.hi, "{j}: {:?} {counted:?}", mode.omega);
            assert!(mode.residual < 1e-27 * path.omega_bound(), "{j}: {:e}", mode.residual);
            let at = |l: Option<usize>| l.and_then(|l| mode.node.get(l)).copied().unwrap_or(Dd::ZERO);
            let pull = |l: usize| {
                let before = l.checked_sub(1).map_or(Dd::ZERO, |p| path.root[p] * at(Some(p)));
                let after = path.root.get(l).map_or(Dd::ZERO, |&g| g * at(Some(l + 1)));
                before + after - mode.omega * at(Some(l))
            };
            let residual = (0..path.nodes()).map(|l| pull(l).hi.powi(2)).sum::<f64>().sqrt();
            assert!(residual <= mode.residual, "{j}: {residual:e} {:e}", mode.residual);
            let norm = mode.node.iter().fold(Dd::ZERO, |sum, &z| sum + z * z);
            assert!((norm - Dd::from(2.0)).abs().hi < 1e-28);
        }
    }
}
