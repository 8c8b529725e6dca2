//! The general modal path: any masses, any stiffnesses, free or held ends.
//!
//! ```text
//! a_ij = sqrt(k_i) u_ij v_sj / (sqrt(m_s) omega_j)        s: the mass on which the force acts
//! ```
//!
//! with u_j and v_j the left and right singular vectors of the bidiagonal B ([`Path`]). They and the omega_j are found in double-double
//! and the a_ij are products of five rounded numbers, so that what limits the result is the sum over modes, not the eigenproblem.
//!
//! The error of the computed modes is measured, not assumed: the residual of each in the equations of motion, and the
//! part of the unit force that the sum of all modes misses. The energy norm of the error is at most the sum of these norms,
//! times the time.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::dd::{Dd, LANES, Lanes};
use super::path::{Mode, Path};
use super::sums::Modes;
use crate::chain::{Chain, Scene};

/// Nanoseconds to find one entry of one mode.
pub(super) const MODE_ENTRY: f64 = 250.0;
/// Frequencies relatively closer than this have vectors that are made orthogonal to each other.
const CLUSTER: f64 = 1e-12;

/// All modes of a scene's chain, with their shares of a unit force on its source.
pub fn modes(scene: &Scene) -> Modes {
    let chain = &scene.chain;
    let path = Path::new(chain);
    let modes = orthogonalize_clusters(&path, path.modes());
    let (springs, source) = (chain.stiffness.len(), path.mass_node(scene.source));
    let root_mass = Dd::from(chain.mass[scene.source]).sqrt();
    let drive: Vec<Dd> = modes.iter().map(|m| m.node[source] / root_mass).collect();
    let push: Vec<f64> = modes.iter().zip(&drive).map(|(m, d)| (*d / m.omega).to_f64()).collect();
    let root: Vec<f64> = (0..springs).map(|i| sign(i, scene.source) * chain.stiffness[i].sqrt()).collect();
    let share = |i: usize, j: usize| root[i] * modes[j].node[path.spring_node(i)].to_f64() * push[j];
    let share = DMatrix::from_fn(springs, modes.len(), share);
    let rate = defect(chain, scene.source, &path, &modes, &drive);
    let defect = chain.stiffness.iter().map(|k| k.sqrt() * rate).collect();
    Modes { omega: modes.iter().map(|m| m.omega).collect(), share, defect }
}

/// The path takes all weights as positive; B has a minus before the mass behind each spring.
fn sign(spring: usize, mass: usize) -> f64 {
    if (spring + mass).is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Makes modes of nearly one frequency orthogonal to each other.
fn orthogonalize_clusters(path: &Path, mut modes: Vec<Mode>) -> Vec<Mode> {
    let mut first = 0;
    for j in 1..modes.len() {
        let (omega, before) = (modes[j].omega, modes[j - 1].omega);
        if (omega - before).hi > CLUSTER * omega.hi {
            first = j;
            continue;
        }
        let (done, rest) = modes.split_at_mut(j);
        let others = &done[first..];
        // Modes of one frequency belong to separate places of the train; each try begins at another place, until a
        // mode is found that is no mix of those before it.
        let tries = (0..=4 * others.len()).filter_map(|place| match place {
            0 => Some(orthogonalized(rest[0].clone(), others)),
            _ => Some(orthogonalized(path.mode(omega, place)?, others)),
        });
        let (mut best, mut most) = (None, 0.0);
        for (mode, left) in tries {
            if left > most {
                (best, most) = (Some(mode), left);
            }
            if most > 0.01 {
                break;
            }
        }
        if let Some(mode) = best {
            rest[0] = mode;
        }
    }
    modes
}

/// A mode made orthogonal to others, in two rounds, and the share of its squared norm that the first round left.
fn orthogonalized(mut mode: Mode, others: &[Mode]) -> (Mode, f64) {
    let left: f64 = others.iter().map(|other| remove_part_along(&other.node, &mut mode.node)).product();
    others.iter().for_each(|other| {
        remove_part_along(&other.node, &mut mode.node);
    });
    mode.residual /= left.sqrt();
    (mode, left)
}

/// Removes from `node` its part along `other`, and restores its norm sqrt 2. Returns the share of the squared norm that was left; if 0,
/// `node` is unchanged.
fn remove_part_along(other: &[Dd], node: &mut [Dd]) -> f64 {
    let dot = |a: &[Dd], b: &[Dd]| a.iter().zip(b).fold(Dd::ZERO, |sum, (&x, &y)| sum + x * y);
    let along = dot(other, node) * Dd::from(0.5);
    if along.abs().hi < 1e-30 {
        return 1.0;
    }
    let left = Dd::ONE - along * along;
    if left.hi < 1e-20 {
        return 0.0;
    }
    for (x, &y) in node.iter_mut().zip(other) {
        *x = *x - along * y;
    }
    let scale = Dd::from(2.0).sqrt() / dot(node, node).sqrt();
    for x in node.iter_mut() {
        *x = *x * scale;
    }
    left.hi
}

/// Growth per unit time of the energy norm of the error under a unit force: what the modes miss of that force, and their
/// residuals.
fn defect(chain: &Chain, source: usize, path: &Path, modes: &[Mode], drive: &[Dd]) -> f64 {
    let live = |v: &usize| !(*v == 0 && chain.held_head || *v + 1 == chain.mass.len() && chain.held_tail);
    let total: Dd = chain.mass.iter().fold(Dd::ZERO, |sum, &m| sum + Dd::from(m));
    let rigid = !chain.held_head && !chain.held_tail;
    let masses: Vec<usize> = (0..chain.mass.len()).filter(live).collect();
    let squares = |masses: &[usize]| {
        let nodes = masses.iter().map(|&v| path.mass_node(v)).collect::<Vec<_>>();
        let sum = super::vectors::widest().dispatch(Sum { nodes: &nodes, modes, drive });
        let missed = |(lane, &v): (usize, &usize)| {
            let root = Dd::from(chain.mass[v]).sqrt();
            // The path's own sign convention: masses alternate.
            let moved = if rigid { Dd::from(sign(v, source)) * root / total } else { Dd::ZERO };
            let asked = if v == source { Dd::ONE / root } else { Dd::ZERO };
            (sum.get(lane) + moved - asked).hi.powi(2)
        };
        masses.iter().enumerate().map(missed).sum::<f64>()
    };
    let missing: f64 = masses.par_chunks(LANES).map(squares).collect::<Vec<_>>().iter().sum();
    let residual: f64 = modes.iter().zip(drive).map(|(m, d)| m.residual * (d.hi / m.omega.hi).abs()).sum();
    missing.sqrt() + residual
}

/// What all modes do at some nodes under a unit force, one node in each lane; compiled for the widest vector unit at hand.
struct Sum<'a> {
    nodes: &'a [usize],
    modes: &'a [Mode],
    drive: &'a [Dd],
}

impl pulp::WithSimd for Sum<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Lanes {
        let mut sum = Lanes::ZERO;
        for (mode, drive) in self.modes.iter().zip(self.drive) {
            let mut at = Lanes::ZERO;
            self.nodes.iter().enumerate().for_each(|(lane, &node)| at.set(lane, mode.node[node]));
            sum = sum + at * Lanes::splat(*drive);
        }
        sum
    }
}
