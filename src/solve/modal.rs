//! The general modal path: any masses, any stiffnesses, free or held ends.
//!
//! ```text
//! a_ij = sqrt(k_i) u_ij v_sj / (sqrt(m_s) omega_j)        s: the mass on which the force acts
//! ```
//!
//! with u_j and v_j the left and right singular vectors of the bidiagonal B ([`Path`]). All of it is in double-double
//! until the a_ij are rounded once, so that what limits the result is the sum over modes, not the eigenproblem.
//!
//! The error of the computed modes is measured, not assumed: the residual of each in the equations of motion, and the
//! part of the force that all together miss. The energy norm of the error grows no faster than the norm of both times
//! the time.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::dd::Dd;
use super::path::{Mode, Path};
use super::sums::Modes;
use crate::chain::{Chain, Scene};

/// Frequencies relatively closer than this have vectors that are made orthogonal to each other.
const CLUSTER: f64 = 1e-12;

/// All modes of a scene's chain, with their shares of a unit force on its source.
pub fn modes(scene: &Scene) -> Modes {
    let chain = &scene.chain;
    let path = Path::new(chain);
    let omega = path.frequencies();
    let vectors = vectors(&path, &omega);
    let (springs, source) = (chain.stiffness.len(), path.mass_node(scene.source));
    let root_mass = Dd::from(chain.mass[scene.source]).sqrt();
    let drive: Vec<Dd> = vectors.iter().map(|m| m.node[source] / root_mass).collect();
    let columns: Vec<Vec<f64>> = (0..omega.len())
        .into_par_iter()
        .map(|j| {
            let push = drive[j] / omega[j];
            let share = |i: usize| {
                let force = Dd::from(chain.stiffness[i]).sqrt() * vectors[j].node[path.spring_node(i)] * push;
                sign(i, scene.source) * force.to_f64()
            };
            (0..springs).map(share).collect()
        })
        .collect();
    let share = DMatrix::from_fn(springs, omega.len(), |i, j| columns[j][i]);
    let rate = defect(chain, scene.source, &path, &vectors, &drive);
    let defect = chain.stiffness.iter().map(|k| k.sqrt() * rate).collect();
    Modes { omega, share, defect }
}

/// The path takes all weights as positive; B has a minus before the mass behind each spring.
fn sign(spring: usize, mass: usize) -> f64 {
    if (spring + mass).is_multiple_of(2) { 1.0 } else { -1.0 }
}

fn vectors(path: &Path, omega: &[Dd]) -> Vec<Mode> {
    let first_of_cluster = |j: usize| {
        let mut first = j;
        while first > 0 && (omega[first] - omega[first - 1]).hi <= CLUSTER * omega[first].hi {
            first -= 1;
        }
        first
    };
    let cluster: Vec<usize> = (0..omega.len()).map(first_of_cluster).collect();
    let mut modes: Vec<Mode> = (0..omega.len()).into_par_iter().map(|j| path.mode(omega[j], 0)).collect();
    for j in 0..modes.len() {
        let (done, rest) = modes.split_at_mut(j);
        let others = &done[cluster[j]..];
        // Modes of one frequency belong to separate places of the train; each try begins at another place, until a
        // mode is found that is no mix of those before it.
        let tries = (0..=4 * others.len()).map(|place| match place {
            0 => orthogonalized(rest[0].clone(), others),
            _ => orthogonalized(path.mode(omega[j], place), others),
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

/// A mode made orthogonal to others, in two rounds, and the share of it that was left.
fn orthogonalized(mut mode: Mode, others: &[Mode]) -> (Mode, f64) {
    let left: f64 = others.iter().map(|other| remove(&other.node, &mut mode.node)).product();
    others.iter().for_each(|other| {
        remove(&other.node, &mut mode.node);
    });
    mode.residual /= left.sqrt();
    (mode, left)
}

/// Takes out of `node` its part along `other`, and restores its norm sqrt 2; the share of it that is left, 0 for none.
fn remove(other: &[Dd], node: &mut [Dd]) -> f64 {
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
    let missed = |v: usize| {
        let root = Dd::from(chain.mass[v]).sqrt();
        let node = path.mass_node(v);
        let mut sum = modes.iter().zip(drive).fold(Dd::ZERO, |sum, (m, &d)| sum + m.node[node] * d);
        if rigid {
            // The path's own sign convention: masses alternate.
            sum = sum + Dd::from(sign(v, source)) * root / total;
        }
        if v == source { sum - Dd::ONE / root } else { sum }
    };
    let missing: f64 = (0..chain.mass.len())
        .filter(live)
        .collect::<Vec<_>>()
        .par_iter()
        .map(|&v| missed(v).hi.powi(2))
        .collect::<Vec<_>>()
        .iter()
        .sum();
    let residual: f64 = modes.iter().zip(drive).map(|(m, d)| m.residual * (d.hi / m.omega.hi).abs()).sum();
    missing.sqrt() + residual
}
