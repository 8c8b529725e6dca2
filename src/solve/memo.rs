//! Scenes that are the same but for their units, or for the end from which they are counted, solved once.
//!
//! Every scene is turned into its canonical form, that form is solved, and the solution is turned back. So a result is the
//! same to the last bit whether it was remembered or computed, in whatever order and on however many threads.
//!
//! The canonical form of an equal chain has mass 1, stiffness 1 and force 1 or -1; times are then in units of
//! `sqrt(mass / stiffness)`. Of a scene and its mirror image (counted from the other end, where forward is backward and
//! the outside force turns its sign, while tension stays tension) the one that comes first in a fixed order stands for
//! both. A held mass plays no part and is 1.
//!
//! Peaks do not depend on ratings. Where an equal chain's ratings are well above its forces it is first solved without any,
//! as one scene with all others that differ in their ratings alone; if its peaks turn out to lie under the ratings, with
//! more than the error bound between, there is nothing more to find. Otherwise it is solved with them. Which of the two is
//! tried first depends on the scene alone.

use std::collections::HashMap;
use std::mem::size_of;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::closed_form::equal;
use super::local::Point;
use super::watch::SpringPeaks;
use super::{Ask, Solution, SolveError, Wanted, solve};
use crate::chain::Scene;

/// A rating that no force comes near, in units of the outside force.
const OUT_OF_REACH: f64 = 1e100;

/// Solutions by canonical scene, of bounded size; shared by threads.
#[derive(Debug)]
pub struct Memo {
    /// Bytes that the younger half may have.
    half: usize,
    shelves: Mutex<Shelves>,
    hits: AtomicU64,
    solved: AtomicU64,
}

/// Two generations: when the young one is full it becomes the old one, and the old one is forgotten.
#[derive(Debug, Default)]
struct Shelves {
    young: HashMap<Key, Arc<Solution>>,
    old: HashMap<Key, Arc<Solution>>,
    bytes: usize,
}

/// A canonical scene and what is asked of it, bit for bit, with repetitions counted.
type Key = Box<[u64]>;

impl Memo {
    /// A memo of at most about so many bytes; with none it remembers nothing, and every result is the same.
    pub fn new(bytes: usize) -> Memo {
        let (hits, solved) = (AtomicU64::new(0), AtomicU64::new(0));
        Memo { half: bytes / 2, shelves: Mutex::default(), hits, solved }
    }

    /// Scenes found already solved, and scenes solved.
    pub fn counts(&self) -> (u64, u64) {
        (self.hits.load(Ordering::Relaxed), self.solved.load(Ordering::Relaxed))
    }

    /// [`solve`] of the scene's canonical form, turned back.
    ///
    /// # Errors
    /// As for [`solve`].
    pub fn solve(&self, scene: &Scene, ask: &Ask) -> Result<Solution, SolveError> {
        if scene.force == 0.0 {
            return solve(scene, ask);
        }
        if let Some(form) = Form::without_ratings(scene, ask) {
            let own = form.back(&*self.known(&form)?, scene, ask.mark);
            if is_clear(&own, scene) {
                return Ok(own);
            }
        }
        let form = Form::of(scene, ask);
        Ok(form.back(&*self.known(&form)?, scene, ask.mark))
    }

    /// The solution of a canonical scene.
    fn known(&self, form: &Form) -> Result<Arc<Solution>, SolveError> {
        let key = key(&form.scene, &form.ask);
        if let Some(known) = self.recall(&key) {
            self.hits.fetch_add(1, Ordering::Relaxed);
            return Ok(known);
        }
        let solution = Arc::new(solve(&form.scene, &form.ask)?);
        self.solved.fetch_add(1, Ordering::Relaxed);
        self.put(&mut self.shelves(), key, solution.clone());
        Ok(solution)
    }

    fn recall(&self, key: &Key) -> Option<Arc<Solution>> {
        let mut shelves = self.shelves();
        if let Some(known) = shelves.young.get(key) {
            return Some(known.clone());
        }
        let (key, known) = shelves.old.remove_entry(key)?;
        self.put(&mut shelves, key, known.clone());
        Some(known)
    }

    fn put(&self, shelves: &mut Shelves, key: Key, solution: Arc<Solution>) {
        let bounds = solution.all_time_bounds.as_ref().map_or(0, Vec::len);
        let springs = solution.springs.len() + solution.to_mark.len();
        let bytes = 8 * (key.len() + bounds) + size_of::<Option<SpringPeaks>>() * springs + 400;
        if bytes > self.half {
            return;
        }
        if shelves.bytes + bytes > self.half {
            shelves.old = std::mem::take(&mut shelves.young);
            shelves.bytes = 0;
        }
        // Two threads may have solved the same scene at once; they found the same.
        if shelves.young.insert(key, solution).is_none() {
            shelves.bytes += bytes;
        }
    }

    fn shelves(&self) -> MutexGuard<'_, Shelves> {
        // A panic elsewhere leaves whole entries only.
        self.shelves.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A scene's canonical form, and how to come back from it.
struct Form {
    scene: Scene,
    ask: Ask,
    mirrored: bool,
    /// Units of time and force of the canonical form; `None` where the scene kept its own.
    units: Option<(f64, f64)>,
}

impl Form {
    fn of(scene: &Scene, ask: &Ask) -> Form {
        let mut form = Form { scene: scene.clone(), ask: *ask, mirrored: false, units: None };
        let last = scene.chain.mass.len() - 1;
        for v in [0, last].into_iter().filter(|&v| !scene.chain.live(v)) {
            form.scene.chain.mass[v] = 1.0;
        }
        if let Some((scaled, time)) = scaled(&form.scene) {
            form.scene = scaled;
            form.ask.tolerance /= scene.force.abs();
            form.ask.mark = ask.mark.map(|mark| whole(mark / time));
            form.units = Some((time, scene.force.abs()));
        }
        let mirror = mirror(&form.scene);
        if key(&mirror, ask) < key(&form.scene, ask) {
            form.scene = mirror;
            form.mirrored = true;
        }
        form
    }

    /// The form of an equal chain with no ratings, if there is hope that they do not matter.
    fn without_ratings(scene: &Scene, ask: &Ask) -> Option<Form> {
        equal(&scene.chain)?;
        let largest = |of: &[f64]| of.iter().fold(scene.force.abs(), |most, f| most.max(f.abs()));
        let lists = [&scene.rated_draft, &scene.rated_buff];
        let smallest = lists.into_iter().flatten().fold(f64::INFINITY, |least, f| least.min(*f));
        // A wave that meets a held end can bring half as much again as the load, and hardly more than the load elsewhere.
        let held = scene.chain.held_head || scene.chain.held_tail;
        let hope = if held { 1.6 } else { 1.05 } * largest(&scene.initial);
        if ask.verdict_only || smallest < hope {
            return None;
        }
        let mut open = scene.clone();
        open.rated_draft.fill(f64::INFINITY);
        open.rated_buff.fill(f64::INFINITY);
        let mut form = Form::of(&open, ask);
        match (ask.wanted, alike(&scene.rated_draft), alike(&scene.rated_buff)) {
            // Which spring is the worst depends on how ratings compare with each other.
            (Wanted::Worst, Some(draft), Some(buff)) => {
                form.scene.rated_draft.fill(OUT_OF_REACH);
                form.scene.rated_buff.fill(OUT_OF_REACH * (buff / draft));
            }
            _ => form.ask.wanted = Wanted::Everything,
        }
        // The tolerance only decides on the method: one that is a little stricter serves all that are near it.
        form.ask.tolerance = f64::exp2(4.0 * (0.25 * form.ask.tolerance.log2()).floor());
        Some(form)
    }

    /// The solution of the canonical form in the scene's own units and order.
    ///
    /// Rounding to the canonical units and back moves a force by no more than is added to the bound: one unit roundoff
    /// of its own size each way, and its change during the shift of the horizon (six roundoffs of it, for each of the two steps of a
    /// pulse) and of the duration. A force changes by at most the outside force per unit of time: a unit impulse gives a unit mass
    /// the energy 1/2, and a spring of stiffness 1 never stores more.
    fn back(&self, solution: &Solution, scene: &Scene, mark: Option<f64>) -> Solution {
        let mut own = solution.clone();
        if let Some((time, force)) = self.units {
            let largest = own.springs.iter().flatten().map(|s| s.draft.best.value.max(s.buff.best.value));
            let largest = largest.fold(0.0, f64::max);
            own.error_bound += f64::EPSILON * (2.0 * largest + 12.0 * self.scene.horizon);
            own.error_bound *= force;
            let to_mark = own.to_mark.iter_mut().map(|spring| (spring, mark.unwrap_or(scene.horizon)));
            for (spring, until) in own.springs.iter_mut().map(|spring| (spring, scene.horizon)).chain(to_mark) {
                let Some(peaks) = spring else { continue };
                peaks.scale_time(time);
                for side in [&mut peaks.draft, &mut peaks.buff] {
                    side.best.value *= force;
                    side.best.at = side.best.at.min(until);
                    side.first_over = side.first_over.map(|t| t.min(until));
                }
            }
            for bound in own.all_time_bounds.iter_mut().flatten() {
                // Rounded up: the units of force and time and the numbers in them round a few times.
                *bound *= force * (1.0 + 8.0 * f64::EPSILON);
            }
        }
        if self.mirrored {
            own.springs.reverse();
            own.to_mark.reverse();
            own.all_time_bounds.iter_mut().for_each(|bounds| bounds.reverse());
        }
        let to_mark = own.to_mark.iter_mut().zip(&scene.initial);
        for (peaks, &initial) in own.springs.iter_mut().zip(&scene.initial).chain(to_mark) {
            let Some(peaks) = peaks else { continue };
            for (side, value) in [(&mut peaks.draft, initial), (&mut peaks.buff, -initial)] {
                // The force before the event is known exactly, and there and back it went through other units.
                if side.best.at == 0.0 || side.best.value < value {
                    side.best = Point { at: 0.0, value };
                }
            }
        }
        own
    }
}

/// Whether every force stays under its rating with room to spare for the error bound, so that ratings change nothing.
fn is_clear(solution: &Solution, scene: &Scene) -> bool {
    let ratings = || scene.rated_draft.iter().zip(&scene.rated_buff);
    let least = ratings().fold(f64::INFINITY, |least, (draft, buff)| least.min(*draft).min(*buff));
    // A share of every rating, so that the largest utilisation decides.
    let room = 1.0 - 2.0 * solution.error_bound / least;
    solution.springs.iter().zip(ratings()).all(|(spring, (draft, buff))| {
        spring.is_some_and(|s| s.draft.best.value < room * draft && s.buff.best.value < room * buff)
    })
}

/// The value of all, if they have one.
fn alike(values: &[f64]) -> Option<f64> {
    values.first().copied().filter(|first| values.iter().all(|v| v == first))
}

/// An equal chain with mass, stiffness and force of 1, and the unit of its time; `None` for other chains, and where
/// rounding would bring an initial force to its rating, or from it.
fn scaled(scene: &Scene) -> Option<(Scene, f64)> {
    let (mass, stiffness) = equal(&scene.chain)?;
    let time = (mass / stiffness).sqrt();
    let force = scene.force.abs();
    let mut unit = scene.clone();
    unit.chain.mass.fill(1.0);
    unit.chain.stiffness.fill(1.0);
    unit.force /= force;
    unit.duration /= time;
    unit.horizon = whole(unit.horizon / time);
    for of in [&mut unit.initial, &mut unit.rated_draft, &mut unit.rated_buff] {
        of.iter_mut().for_each(|f| *f /= force);
    }
    let order =
        |s: &Scene, i: usize| (s.initial[i].total_cmp(&s.rated_draft[i]), (-s.initial[i]).total_cmp(&s.rated_buff[i]));
    (0..scene.initial.len()).all(|i| order(scene, i) == order(&unit, i)).then_some((unit, time))
}

/// Whole transits are whole numbers but for roundoff; trains that share them share their scenes.
fn whole(time: f64) -> f64 {
    let whole = time.round();
    if (time - whole).abs() <= 4.0 * f64::EPSILON * whole { whole } else { time }
}

/// The scene counted from the other end.
fn mirror(scene: &Scene) -> Scene {
    let mut mirror = scene.clone();
    mirror.chain.mass.reverse();
    mirror.chain.stiffness.reverse();
    mirror.chain.held_head = scene.chain.held_tail;
    mirror.chain.held_tail = scene.chain.held_head;
    mirror.source = scene.chain.mass.len() - 1 - scene.source;
    mirror.force = -scene.force;
    for of in [&mut mirror.initial, &mut mirror.rated_draft, &mut mirror.rated_buff] {
        of.reverse();
    }
    mirror
}

fn key(scene: &Scene, ask: &Ask) -> Key {
    let method = ask.method.map_or(0, |m| 1 + m as u64);
    let worst = ask.wanted == Wanted::Worst;
    let flags = [ask.verdict_only, ask.all_time_bound, worst, scene.chain.held_head, scene.chain.held_tail];
    let flags = flags.into_iter().fold(method, |all, flag| 2 * all + u64::from(flag));
    let mut words = vec![flags, scene.source as u64];
    let mark = ask.mark.unwrap_or(f64::INFINITY);
    words.extend([ask.tolerance, mark, scene.force, scene.duration, scene.horizon].map(f64::to_bits));
    let chain = &scene.chain;
    for list in [&chain.mass, &chain.stiffness, &scene.initial, &scene.rated_draft, &scene.rated_buff] {
        let runs = list.chunk_by(|a, b| a.to_bits() == b.to_bits());
        words.extend(runs.flat_map(|run| [run.len() as u64, run[0].to_bits()]));
    }
    words.into()
}
