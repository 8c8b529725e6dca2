//! What does each method cost on an equal chain with a held head?

mod scenes;

use criterion::Criterion;
use trainsafe::solve::Method;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let methods = [Method::Fronts, Method::Modal, Method::Propagator];
    for springs in [100, 300, 1000] {
        let scene = scenes::broken(vec![1.0; springs + 1], vec![1.0; springs]);
        scenes::every_method(&mut criterion, "equal chain", &methods, &scene);
    }
    criterion.final_summary();
}
