//! What does each method cost on a chain whose masses and stiffnesses differ from place to place?

mod scenes;

use criterion::Criterion;
use trainsafe::solve::Method;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    for springs in [100u32, 1000] {
        let square = |i: u32| f64::from(i) * f64::from(i);
        let mass = (1..=springs + 1).map(|v| 1.0 + 0.6 * (1.7 * square(v)).sin()).collect();
        let stiffness = (1..=springs).map(|i| 1.0 + 0.4 * (2.3 * square(i)).cos()).collect();
        let scene = scenes::broken(mass, stiffness);
        scenes::every_method(&mut criterion, "unequal chain", &[Method::Modal, Method::Propagator], &scene);
    }
    criterion.final_summary();
}
