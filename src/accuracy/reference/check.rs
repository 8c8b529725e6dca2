//! What a scene must be to have a reference.

use crate::chain::Scene;

/// Why there is no reference for a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReferenceError {
    /// A number that is not finite, a mass or stiffness that is not positive, no spring, or a source that is not live.
    #[error("the scene is not one that can be computed: {0}")]
    Scene(&'static str),
    /// The modes do not solve the equations of motion to 30 digits at any precision tried.
    #[error("the modes could not be verified: relative error bound {0:e}")]
    Unverified(f64),
    /// The search for extremes looked at too many stretches of time.
    #[error("the search for extremes gave up after {0} looks")]
    TooLong(usize),
}

/// Whether a scene can be computed at all.
pub fn check(scene: &Scene) -> Result<(), ReferenceError> {
    let Scene { chain, source, .. } = scene;
    let n = chain.mass.len();
    if n < 2 || chain.stiffness.len() + 1 != n || scene.initial.len() + 1 != n {
        return Err(ReferenceError::Scene(
            "it needs two masses, a spring between each two, and a force for each spring",
        ));
    }
    if *source >= n || !chain.live(*source) {
        return Err(ReferenceError::Scene("the force acts on no live mass"));
    }
    let positive = |x: &f64| x.is_finite() && *x > 0.0;
    let live_masses = (0..n).filter(|&v| chain.live(v)).map(|v| chain.mass[v]);
    if !live_masses.into_iter().all(|m| positive(&m)) || !chain.stiffness.iter().all(positive) {
        return Err(ReferenceError::Scene("masses and stiffnesses must be positive and finite"));
    }
    let times = scene.horizon.is_finite() && scene.horizon >= 0.0 && scene.duration > 0.0;
    if !times || !scene.force.is_finite() || !scene.initial.iter().all(|f| f.is_finite()) {
        return Err(ReferenceError::Scene("forces and times must be finite, the duration positive"));
    }
    Ok(())
}
