//! Which vectors of the processor the inner loops use.

use std::sync::atomic::{AtomicBool, Ordering};

use pulp::Arch;

static SCALARS: AtomicBool = AtomicBool::new(false);

/// The widest vectors that the processor has and the build supports, or none after [`use_scalars`].
pub(super) fn widest() -> Arch {
    if SCALARS.load(Ordering::Relaxed) { Arch::Scalar } else { Arch::new() }
}

/// From now on every thread computes without vectors, or with them again. Results are the same to the last bit: this is for benches and
/// tests.
pub fn use_scalars(scalars: bool) {
    SCALARS.store(scalars, Ordering::Relaxed);
}

/// What the loops use now, with its lanes of double precision.
pub fn name() -> String {
    struct Lanes;
    impl pulp::WithSimd for Lanes {
        type Output = usize;

        fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
            S::F64_LANES
        }
    }
    match widest().dispatch(Lanes) {
        1 => "no vectors".to_owned(),
        lanes => format!("vectors of {lanes} numbers"),
    }
}
