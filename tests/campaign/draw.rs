//! Scenes drawn at random, each from its own seed.

use trainsafe::accuracy::reference::Extreme;
use trainsafe::chain::{Chain, Scene};
use trainsafe::solve::path::Path;

/// Largest phase of the fastest mode over the horizon, for 30 springs: what a method that resolves every mode can follow in
/// a second. Longer horizons are cut to it, but for trains whose fast modes are few and far above the others.
const PHASES: f64 = 3e4;

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, *OOPSLA* 2014): the same numbers on every machine.
#[derive(Clone, Debug)]
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(super) fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 0.5f64.powi(53)
    }

    pub(super) fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.share()
    }

    /// One of 0..n.
    pub(super) fn one_of(&mut self, n: usize) -> usize {
        (self.share() * n as f64) as usize
    }

    pub(super) fn chance(&mut self, p: f64) -> bool {
        self.share() < p
    }

    pub(super) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }
}

/// How the vehicles and couplers of a train differ.
enum Kind {
    Equal,
    /// Within a ratio of 4.
    Alike,
    /// Log-uniform over so many decades, up to 8.
    Spread(f64),
    /// Alike, but one in ten is off by so many decades.
    Outliers(f64),
    /// Two kinds in turn, so many decades apart.
    Groups(f64),
}

/// The scene of a seed, its ratings not yet set.
pub fn scene(seed: u64) -> Scene {
    let mut r = Random(seed);
    let springs = 1 + r.one_of(59);
    let decades = r.between(0.0, 8.0);
    let kind = match r.one_of(20) {
        0..5 => Kind::Equal,
        5..9 => Kind::Alike,
        9..14 => Kind::Spread(decades),
        14..18 => Kind::Outliers(decades),
        _ => Kind::Groups(decades),
    };
    let mass = values(&mut r, &kind, springs + 1);
    let stiffness = values(&mut r, &kind, springs);
    let (held_head, held_tail) = match r.one_of(20) {
        0..7 => (true, false),
        7..14 => (false, false),
        14..17 => (false, true),
        _ => (springs > 1, springs > 1),
    };
    let chain = Chain { mass, stiffness, held_head, held_tail };
    let horizon = horizon(&mut r, &chain, &kind);
    let mut scene = Scene {
        source: 0,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![0.0; springs],
        rated_draft: vec![1.0; springs],
        rated_buff: vec![1.0; springs],
        horizon,
        chain,
    };
    load(&mut r, &mut scene);
    if r.chance(0.5) && !(held_head && held_tail) {
        break_at_an_end(&mut r, &mut scene);
    } else {
        pulse(&mut r, &mut scene);
    }
    scene
}

fn values(r: &mut Random, kind: &Kind, count: usize) -> Vec<f64> {
    let unit = 10f64.powf(r.between(-1.0, 1.0));
    let run = 1 + r.one_of(4);
    let value = |i: usize| {
        let alike = 4f64.powf(r.between(-0.5, 0.5));
        let factor = match *kind {
            Kind::Equal => 1.0,
            Kind::Alike => alike,
            Kind::Spread(d) => 10f64.powf(d * r.between(-0.5, 0.5)),
            Kind::Outliers(d) => alike * if r.chance(0.1) { 10f64.powf(d * r.sign()) } else { 1.0 },
            Kind::Groups(d) => 10f64.powf(if (i / run).is_multiple_of(2) { 0.0 } else { d }),
        };
        unit * factor
    };
    (0..count).map(value).collect()
}

fn horizon(r: &mut Random, chain: &Chain, kind: &Kind) -> f64 {
    let wanted = chain.transit() * r.between(1.0, 4.0);
    let springs = chain.stiffness.len() as f64;
    let most = PHASES * (30.0 / springs).min(4.0) / Path::new(chain).omega_max();
    // With a few stiff couplers or light vehicles the fast modes carry little force, and methods can leave them out.
    let longer = if matches!(kind, Kind::Outliers(_)) { 30.0 } else { 1.0 };
    wanted.min(longer * most)
}

fn load(r: &mut Random, scene: &mut Scene) {
    let level = r.between(-1.0, 1.0);
    match r.one_of(4) {
        0 => {}
        1 | 2 => scene.initial.fill(level),
        _ => scene.initial.iter_mut().for_each(|f| *f = r.between(-1.0, 1.0)),
    }
}

/// The coupler before the head, or behind the tail, breaks and takes its force away.
fn break_at_an_end(r: &mut Random, scene: &mut Scene) {
    let at_head = if scene.chain.held_head || scene.chain.held_tail { scene.chain.held_tail } else { r.chance(0.5) };
    let lost = if scene.initial[0] == 0.0 { r.between(0.1, 1.0) } else { scene.initial[0] };
    (scene.source, scene.force) = if at_head { (0, -lost) } else { (scene.initial.len(), lost) };
}

/// Some live vehicle is struck, for a time from far below the shortest period to beyond the horizon.
fn pulse(r: &mut Random, scene: &mut Scene) {
    let live: Vec<usize> = (0..scene.chain.mass.len()).filter(|&v| scene.chain.live(v)).collect();
    scene.source = live[r.one_of(live.len())];
    scene.force = r.sign() * r.between(0.1, 2.0);
    let shortest = 1e-6 / Path::new(&scene.chain).omega_max();
    let decades = (3.0 * scene.horizon / shortest).log10();
    scene.duration = match r.one_of(4) {
        0 => shortest * 10f64.powf(r.between(0.0, decades)),
        1 => scene.horizon,
        _ => scene.horizon * 10f64.powf(r.between(-3.0, 0.5)),
    };
}

/// The scene with ratings on both sides of the peaks: far, near, and as near as makes the verdict a hard one.
pub fn with_ratings(mut scene: Scene, extremes: &[[Extreme; 2]], seed: u64) -> Scene {
    let mut r = Random(!seed);
    for (spring, sides) in extremes.iter().enumerate() {
        let [draft, buff] = [0, 1].map(|side| {
            let peak = sides[side].value.to_f64().value();
            let initial = if side == 0 { scene.initial[spring] } else { -scene.initial[spring] };
            let rating = match r.one_of(8) {
                0 => peak * (1.0 + r.sign() * 1e-9),
                1 => peak * (1.0 + r.sign() * 10f64.powf(r.between(-15.0, -11.0))),
                2 => peak,
                3 => initial,
                _ => peak * r.between(0.3, 1.3),
            };
            if rating > 0.0 { rating } else { r.between(0.1, 2.0) }
        });
        (scene.rated_draft[spring], scene.rated_buff[spring]) = (draft, buff);
    }
    scene
}
