//! What a row of a fleet needs of a solution: the same whether all couplers were asked for or the worst alone.

use trainsafe::chain::Scene;
use trainsafe::solve::local::Point;
use trainsafe::solve::{Method, Solution};

/// Part of a solution that a row depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstRow {
    /// How it was found.
    pub method: Method,
    /// The error bound.
    pub error_bound: f64,
    /// The spring of the largest utilisation, of alike ones the first: whether in compression, and its largest force there.
    pub worst: Option<(usize, bool, Point)>,
    /// The largest utilisation.
    pub utilisation: f64,
    /// Over its rating in either sense, spring by spring; `None`: not decided.
    pub exceeds: Vec<Option<bool>>,
    /// The earliest first exceedance, and the spring; of several the first.
    pub first: Option<(f64, usize)>,
}

impl WorstRow {
    /// Whether this says the same as another of the scene: to the bit, unless its ratings are so small that the error bound is
    /// a millionth of them. Then peaks of one coupler may lie within an eighth of the bound of each other, which is as good as
    /// one, and which of them is told depends on what was looked into before.
    pub fn agrees(&self, other: &WorstRow, scene: &Scene) -> bool {
        let ratings = scene.rated_draft.iter().chain(&scene.rated_buff);
        let least = ratings.fold(f64::INFINITY, |least, r| least.min(*r));
        let is_hazy = other.error_bound > 1e-6 * least;
        let apart = (self.utilisation - other.utilisation).abs();
        let near = WorstRow { worst: other.worst, utilisation: other.utilisation, ..self.clone() };
        self == other || is_hazy && near == *other && apart <= other.error_bound / least
    }

    /// What a row says of a solution. Springs that were left out of it are under their ratings, and not the worst.
    pub fn of(scene: &Scene, solution: &Solution) -> WorstRow {
        let springs = solution.springs.iter().enumerate();
        let sides = springs.filter_map(|(i, peaks)| Some((i, peaks.as_ref()?))).flat_map(|(i, peaks)| {
            [(i, false, scene.rated_draft[i], peaks.draft), (i, true, scene.rated_buff[i], peaks.buff)]
        });
        let utilisation = sides.clone().map(|(_, _, rating, side)| side.best.value / rating).fold(0.0, f64::max);
        let alike = |rating: f64, force: f64| (force + solution.error_bound) / rating >= utilisation;
        let worst = sides.clone().find(|(_, _, rating, side)| side.best.value > 0.0 && alike(*rating, side.best.value));
        let under = [Some(false); 2];
        let exceeds =
            solution.springs.iter().map(|peaks| peaks.map_or(under, |p| [p.draft.exceeds(), p.buff.exceeds()]));
        let exceeds = exceeds.map(|senses| match senses {
            [Some(true), _] | [_, Some(true)] => Some(true),
            [Some(false), Some(false)] => Some(false),
            _ => None,
        });
        let firsts = sides.clone().filter_map(|(i, _, _, side)| Some((side.first_over?, i)));
        WorstRow {
            method: solution.method,
            error_bound: solution.error_bound,
            worst: worst.map(|(i, negative, _, side)| (i, negative, side.best)),
            utilisation,
            exceeds: exceeds.collect(),
            first: firsts.min_by(|a, b| a.0.total_cmp(&b.0)),
        }
    }
}
