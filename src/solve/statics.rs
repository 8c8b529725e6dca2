//! Mean spring forces under a constant force, about which the chain swings.

use crate::chain::Chain;

/// Spring forces under a steady unit forward force on mass `source`: the mean of the undamped motion it starts from rest.
///
/// A chain free at both ends accelerates as a whole, and each spring carries the inertia of what it drags or pushes; one
/// held end takes the whole force; two share it as their springs' compliances allow.
pub(crate) fn unit_force(chain: &Chain, source: usize) -> Vec<f64> {
    let springs = chain.stiffness.len();
    let (ahead, behind): (Vec<f64>, Vec<f64>) = match (chain.held_head, chain.held_tail) {
        (true, false) => (vec![1.0; springs], vec![0.0; springs]),
        (false, true) => (vec![0.0; springs], vec![1.0; springs]),
        (true, true) => {
            let compliance =
                |range: std::ops::Range<usize>| chain.stiffness[range].iter().map(|k| 1.0 / k).sum::<f64>();
            let (front, rear) = (compliance(0..source), compliance(source..springs));
            (vec![rear / (front + rear); springs], vec![front / (front + rear); springs])
        }
        (false, false) => {
            let total: f64 = chain.mass.iter().sum();
            let mut before = 0.0;
            let front = chain.mass.iter().take(springs).map(|m| {
                before += m;
                before / total
            });
            let front: Vec<f64> = front.collect();
            let mut after = 0.0;
            let mut rear: Vec<f64> = chain
                .mass
                .iter()
                .rev()
                .take(springs)
                .map(|m| {
                    after += m;
                    after / total
                })
                .collect();
            rear.reverse();
            (front, rear)
        }
    };
    (0..springs).map(|i| if i < source { -ahead[i] } else { behind[i] }).collect()
}

#[cfg(test)]
mod tests;
