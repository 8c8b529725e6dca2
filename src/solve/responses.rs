//! Responses to a unit force, each found once and shared by all scenes that differ from its own in loads, ratings and force alone.
//!
//! Whether a scene is solved from a response depends on the scene and on what is shared, never on what is remembered: a result is
//! the same to the last bit in whatever order and on however many threads.
//!
//! An equal chain is brought to mass 1 and stiffness 1, times in units of `sqrt(mass / stiffness)`. Its mirror image is the same chain
//! counted from the other end: forward becomes backward there, and tension stays tension. Of the two, the one whose source is nearer to
//! the tail is solved, and the other's forces follow from it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::closed_form::equal;
use super::response::{Mapping, UnitResponse};
use super::{Ask, Method, Solution, SolveError, plan, propagator, solve_all};
use crate::chain::{Chain, Scene};

/// Springs of the longest equal chain whose response is kept: a longer one's takes longer than some scenes.
const LONGEST: usize = 256;
/// Forces along a march, bytes, over which a response is not kept.
const MOST_BYTES: f64 = (64 << 20) as f64;

/// A response may take this many times as long as a scene by the fastest method.
const MAX_TIME_RATIO: f64 = 10.0;

/// Which scenes are solved from responses.
#[derive(Clone, Copy, Debug)]
pub enum Shared<'a> {
    /// None.
    Nothing,
    /// Those of equal chains, which trains of any masses and stiffnesses share.
    EqualChains(&'a Responses),
    /// Those of all chains: for many loads and ratings of the same train.
    EveryChain(&'a Responses),
}

impl Shared<'_> {
    /// [`solve_all`], from responses where a scene is of the shared ones and its bound is within the tolerance.
    pub fn solve_all(&self, scenes: &[(&Scene, Ask)]) -> Vec<Result<Solution, SolveError>> {
        let known: Vec<Option<Solution>> = scenes.iter().map(|(scene, ask)| self.shared_solution(scene, ask)).collect();
        let all = scenes.iter().zip(&known);
        let left: Vec<(&Scene, Ask)> = all.filter(|(_, known)| known.is_none()).map(|(scene, _)| *scene).collect();
        let mut solved = solve_all(&left).into_iter();
        known.into_iter().filter_map(|known| known.map(Ok).or_else(|| solved.next())).collect()
    }

    /// The solution from a response.
    fn shared_solution(&self, scene: &Scene, ask: &Ask) -> Option<Solution> {
        let (responses, is_shared) = match *self {
            Shared::Nothing => return None,
            Shared::EqualChains(responses) => (responses, equal(&scene.chain).is_some()),
            Shared::EveryChain(responses) => (responses, true),
        };
        let by_march =
            matches!(ask.method, None | Some(Method::Propagator)) && !ask.verdict_only && !ask.all_time_bound;
        if is_shared && by_march && scene.force != 0.0 {
            let (key, mapping) = ResponseKey::of(scene);
            let (entry, is_new) = responses.entry(&key);
            let solution = entry.response().and_then(|response| response.solution(scene, ask, mapping));
            responses.count(!is_new && solution.is_some());
            return solution;
        }
        responses.count(false);
        None
    }
}

/// Responses by their keys, of bounded size; shared by threads.
#[derive(Debug)]
pub struct Responses {
    /// Bytes that they may have.
    most: usize,
    kept: Mutex<KeptEntries>,
    hits: AtomicU64,
    solved: AtomicU64,
}

/// Entries by the hashes of their keys. Where there is no room for a new one, others leave at random: a fleet asks for the parts of one
/// train after another, and where these do not fit together, the oldest of them are those that are needed next.
#[derive(Debug, Default)]
struct KeptEntries {
    entries: HashMap<u64, Arc<Entry>>,
    /// Those whose size is known, and their bytes.
    hashes: Vec<u64>,
    bytes: usize,
    /// The last random number.
    random: u64,
}

/// A key, and the response once it is found; `None` where a march takes too long.
#[derive(Debug)]
struct Entry {
    key: ResponseKey<'static>,
    response: OnceLock<Option<UnitResponse>>,
}

/// All that a response depends on. Times are in its own unit, as are mass and stiffness.
#[derive(Clone, Debug, PartialEq)]
struct ResponseKey<'a> {
    chain: Cow<'a, Chain>,
    source: usize,
    duration: f64,
    horizon: f64,
}

impl Responses {
    /// Responses of at most about this many bytes; with 0 none is kept, and every result is the same.
    pub fn new(bytes: usize) -> Responses {
        let (hits, solved) = (AtomicU64::new(0), AtomicU64::new(0));
        Responses { most: bytes, kept: Mutex::default(), hits, solved }
    }

    /// Scenes whose response was known, and responses and scenes that were marched or solved.
    pub fn counts(&self) -> (u64, u64) {
        (self.hits.load(Ordering::Relaxed), self.solved.load(Ordering::Relaxed))
    }

    fn count(&self, is_hit: bool) {
        if is_hit { &self.hits } else { &self.solved }.fetch_add(1, Ordering::Relaxed);
    }

    /// The entry of a key with its response, and whether that was found just now.
    fn entry(&self, key: &ResponseKey) -> (Arc<Entry>, bool) {
        let hash = key.hash();
        let (entry, is_kept) = self.find_or_insert(hash, key);
        let mut is_new = false;
        // Other threads that ask the same wait for the first.
        entry.response.get_or_init(|| {
            is_new = true;
            entry.key.response()
        });
        if is_new && is_kept {
            self.count_size(hash, &entry);
        }
        (entry, is_new)
    }

    /// The entry of a key, made if needed, and whether it is kept.
    fn find_or_insert(&self, hash: u64, key: &ResponseKey) -> (Arc<Entry>, bool) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept.entries.get(&hash);
        if let Some(entry) = known.filter(|entry| entry.key == *key) {
            return (entry.clone(), true);
        }
        // Two keys hardly ever have one hash: then the first stays.
        let is_kept = self.most > 0 && known.is_none();
        let entry = Arc::new(Entry { key: key.own(), response: OnceLock::new() });
        if is_kept {
            kept.entries.insert(hash, entry.clone());
        }
        (entry, is_kept)
    }

    /// Takes account of the size of an entry whose response was just found.
    fn count_size(&self, hash: u64, entry: &Entry) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = entry.bytes();
        if bytes > self.most {
            kept.entries.remove(&hash);
            return;
        }
        kept.make_room(self.most - bytes);
        kept.hashes.push(hash);
        kept.bytes += bytes;
    }
}

impl KeptEntries {
    /// Forgets entries until the others have at most so many bytes.
    fn make_room(&mut self, most: usize) {
        while self.bytes > most && !self.hashes.is_empty() {
            // D. E. Knuth's generator for MMIX.
            self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let hash = self.hashes.swap_remove((self.random >> 33) as usize % self.hashes.len());
            self.bytes -= self.entries.remove(&hash).map_or(0, |entry| entry.bytes());
        }
    }
}

impl Entry {
    fn response(&self) -> Option<&UnitResponse> {
        self.response.get().and_then(Option::as_ref)
    }

    fn bytes(&self) -> usize {
        200 + 16 * self.key.chain.mass.len() + self.response().map_or(0, UnitResponse::bytes)
    }
}

impl<'a> ResponseKey<'a> {
    /// A scene's key, and how its solution follows from the response.
    fn of(scene: &'a Scene) -> (ResponseKey<'a>, Mapping) {
        let Scene { chain, source, duration, horizon, .. } = scene;
        let own = ResponseKey { chain: Cow::Borrowed(chain), source: *source, duration: *duration, horizon: *horizon };
        let Some((mass, stiffness)) = equal(chain) else {
            return (own, Mapping { mirrored: false, time: None });
        };
        let time = (mass / stiffness).sqrt();
        let last = chain.stiffness.len();
        let from_tail = (last - source, chain.held_tail);
        let mirrored = (*source, chain.held_head) < from_tail;
        let mapping = Mapping { mirrored, time: Some(time) };
        let own_horizon = mapping.in_its_unit(*horizon);
        let [held_head, held_tail] =
            if mirrored { [chain.held_tail, chain.held_head] } else { [chain.held_head, chain.held_tail] };
        let chain = Chain { mass: vec![1.0; last + 1], stiffness: vec![1.0; last], held_head, held_tail };
        let key = ResponseKey {
            chain: Cow::Owned(chain),
            source: if mirrored { last - source } else { *source },
            duration: duration / time,
            horizon: if *duration < *horizon { own_horizon } else { shared_horizon(last as f64, own_horizon) },
        };
        (key, mapping)
    }

    fn own(&self) -> ResponseKey<'static> {
        ResponseKey { chain: Cow::Owned(self.chain.clone().into_owned()), ..*self }
    }

    /// The response, where a march is not much longer than other methods, and not too long for its forces to be kept.
    fn response(&self) -> Option<UnitResponse> {
        let springs = self.chain.stiffness.len();
        let none = vec![f64::INFINITY; springs];
        let scene = Scene {
            chain: self.chain.clone().into_owned(),
            source: self.source,
            force: 1.0,
            duration: self.duration,
            initial: vec![0.0; springs],
            rated_draft: none.clone(),
            rated_buff: none,
            horizon: self.horizon,
        };
        let is_equal = equal(&self.chain).is_some();
        let omega_max = propagator::omega_max(&scene);
        let forces = springs as f64 * propagator::steps(&scene, omega_max);
        if is_equal && springs > LONGEST || 8.0 * forces > MOST_BYTES {
            return None;
        }
        let seconds = |method: Option<Method>| {
            let ask = Ask { tolerance: f64::INFINITY, method, ..Ask::default() };
            plan::choose(&scene, &ask).ok().map(|plan| plan.seconds)
        };
        let is_fast = seconds(Some(Method::Propagator))? <= MAX_TIME_RATIO * seconds(None)?;
        is_fast.then(|| UnitResponse::new(&scene, omega_max))
    }

    /// A mix of all bits (G. L. Steele, D. Lea, C. H. Flood, *OOPSLA 2014*, 453-472, a round of SplitMix64 for each number).
    fn hash(&self) -> u64 {
        let chain = &self.chain;
        let flags = [chain.held_head, chain.held_tail].into_iter().fold(2, |all, flag| 2 * all + u64::from(flag));
        let times = [self.duration, self.horizon];
        let numbers = times.iter().chain(&chain.mass).chain(&chain.stiffness).map(|x| x.to_bits());
        [flags, self.source as u64].into_iter().chain(numbers).fold(0, |all, word| {
            let mixed = (all ^ word).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            (mixed ^ (mixed >> 29)).wrapping_add(0x9e37_79b9_7f4a_7c15)
        })
    }
}

/// The horizon of a response after a break: four transits, doubled until it covers another horizon. Trains break
/// into few long parts and many short ones, which then share their responses.
fn shared_horizon(springs: f64, horizon: f64) -> f64 {
    let doublings = (horizon / (4.0 * springs)).log2().ceil();
    let longer = 4.0 * springs * doublings.exp2();
    if longer >= horizon { longer } else { 2.0 * longer }
}

#[cfg(test)]
mod tests;
