//! Every coupler's largest forces in a scene, with a bound on their error: one method a file, and the planner.

/// A way to compute coupler forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The paper's sums for equal masses and stiffnesses.
    ClosedForm,
    /// Sums of travelling Bessel fronts for equal masses and stiffnesses.
    Fronts,
    /// A sum over vibration modes, any chain.
    Modal,
    /// Time steps that are exact in time, any chain.
    Propagator,
}
