//! scratch
use trainsafe::chain::*;
use trainsafe::solve::*;
fn held(n: usize, free: bool) -> Scene {
    Scene {
        chain: Chain { mass: vec![1.0; n + 1], stiffness: vec![1.0; n], held_head: !free, held_tail: false },
        source: n,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![1.0; n],
        rated_draft: vec![1.0; n],
        rated_buff: vec![1.0; n],
        horizon: 4.0 * n as f64,
    }
}
fn mixed(n: usize) -> Scene {
    let m: Vec<f64> = (1..=n + 1).map(|v| 1.0 + 0.6 * (1.7 * (v * v) as f64).sin()).collect();
    let k: Vec<f64> = (1..=n).map(|v| 1.0 + 0.4 * (2.3 * (v * v) as f64).cos()).collect();
    let mut s = held(n, false);
    s.chain.mass = m;
    s.chain.stiffness = k;
    s.horizon = 4.0 * s.chain.transit();
    s.initial = vec![0.8; n];
    s.force = 0.8;
    s
}
#[test]
fn fig4() {
    let mut scenes = vec![];
    for n in [50, 100] {
        scenes.push(held(n, false));
        scenes.push(held(n, true));
        scenes.push(mixed(n));
        let mut s = mixed(n);
        s.duration = 10.3;
        s.source = n / 2;
        s.initial = vec![0.1; n];
        scenes.push(s);
        let mut s = mixed(n);
        s.duration = 10.3;
        s.source = n / 2;
        s.chain.held_tail = true;
        scenes.push(s);
        let mut s = mixed(n);
        s.duration = 1e-5;
        s.source = n;
        scenes.push(s);
    }
    for s in scenes {
        let n = s.initial.len();
        let t = std::time::Instant::now();
        let om = propagator::omega_max(&s);
        let (p, w) = propagator::peaks(&s, om);
        let tp = t.elapsed();
        let t = std::time::Instant::now();
        let m = modal::modes(&s);
        let (q, w2) = sums::peaks(&s, &m);
        let tm = t.elapsed();
        let mut e = 0.0f64;
        let mut et = 0.0f64;
        let mut ex = 0;
        let mut ec = 0.0f64;
        for (a, b) in p.iter().zip(&q) {
            for neg in [false, true] {
                let (a, b) = (a.side(neg), b.side(neg));
                e = e.max((a.best.value - b.best.value).abs());
                et = et.max((a.best.at - b.best.at).abs());
                ex += (a.exceeds() != b.exceeds()) as i32;
                if let (Some(x), Some(y)) = (a.first_over, b.first_over) {
                    ec = ec.max((x - y).abs());
                }
            }
        }
        println!(
            "n {n} prop {tp:?} {w:?} bound {:e} | modal {tm:?} {w2:?} {:e} | diff {e:e} {et:e} {ec:e} ex {ex}",
            propagator::error_bound(&s, om),
            sums::error_bound(&s, &m)
        );
        assert!(e < propagator::error_bound(&s, om));
    }
    for s in [held(999, false), mixed(999)] {
        for _ in 0..3 {
            let t = std::time::Instant::now();
            let om = propagator::omega_max(&s);
            let t1 = t.elapsed();
            let (_, w) = propagator::peaks(&s, om);
            println!(
                "n 999 prop {t1:?} {:?} {w:?} om {om} bound {:e} steps {}",
                t.elapsed(),
                propagator::error_bound(&s, om),
                propagator::steps(&s, om)
            );
        }
    }
}
#[test]
fn bare() {
    for s in [held(999, false), mixed(999)] {
        let t = std::time::Instant::now();
        let om = propagator::omega_max(&s);
        let f = propagator::history(&s, om, 5, &[]);
        println!("bare {:?} {}", t.elapsed(), f.len());
    }
}
#[test]
fn big() {
    let s = mixed(999);
    for _ in 0..5 {
        let t = std::time::Instant::now();
        let om = propagator::omega_max(&s);
        let (_, w) = propagator::peaks(&s, om);
        println!("big {:?} {w:?}", t.elapsed());
    }
}

#[test]
fn front() {
    let mut scenes = vec![];
    for n in [1usize, 2, 5, 50, 100] {
        for (h, t) in [(false, false), (true, false), (false, true), (true, true)] {
            for src in [0, 1, n / 2, n - 1, n] {
                if (h && src == 0) || (t && src == n) {
                    continue;
                }
                let mut s = held(n, true);
                s.chain.held_head = h;
                s.chain.held_tail = t;
                s.source = src;
                s.horizon = 4.3 * n as f64;
                scenes.push(s.clone());
                s.duration = 7.7;
                s.initial = vec![0.1; n];
                s.force = -0.9;
                scenes.push(s);
            }
        }
    }
    let mut worst = 0.0f64;
    let mut wt = 0.0f64;
    for mut s in scenes {
        s.chain.mass.fill(4.0);
        s.duration *= 2.0;
        s.horizon *= 2.0;
        let m = closed_form::modes(&s).unwrap();
        let (q, _) = sums::peaks(&s, &m);
        let (p, _) = fronts::peaks(&s);
        let b = fronts::error_bound(&s) + sums::error_bound(&s, &m);
        for (i, (x, y)) in p.iter().zip(&q).enumerate() {
            for neg in [false, true] {
                let (x, y) = (x.side(neg), y.side(neg));
                let e = (x.best.value - y.best.value).abs();
                worst = worst.max(e / b);
                if (x.best.at - y.best.at).abs() > 1e-6 {
                    println!("time {} {} {:?} {:?}", x.best.at, y.best.at, x.best.value, y.best.value);
                }
                if e > b || x.exceeds() != y.exceeds() {
                    println!(
                        "n {} h{}t{} src {} dur {} spring {i} {neg} {x:?} {y:?} bound {b:e}",
                        s.initial.len(),
                        s.chain.held_head,
                        s.chain.held_tail,
                        s.source,
                        s.duration
                    );
                }
                if let (Some(a), Some(c)) = (x.first_over, y.first_over) {
                    wt = wt.max((a - c).abs());
                }
            }
        }
    }
    println!("front worst e/b {worst} cross {wt:e}");
    let s = held(999, false);
    for _ in 0..4 {
        let t = std::time::Instant::now();
        let (_, w) = fronts::peaks(&s);
        println!("front 999 {:?} {w:?} bound {:e}", t.elapsed(), fronts::error_bound(&s));
    }
}
#[test]
fn cross() {
    for n in [1usize,2,5,50] { for (h,t) in [(false,false),(true,false),(false,true),(true,true)] { for src in [0, 1, n/2, n-1, n] {
        if (h && src==0) || (t && src==n) { continue; }
        for pulse in [false,true] {
        let mut s = held(n, true); s.chain.held_head=h; s.chain.held_tail=t; s.source=src; s.horizon=4.3*n as f64;
        if pulse { s.duration=7.7; s.initial=vec![0.1;n]; s.force=-0.9; }
        let m = closed_form::modes(&s).unwrap();
        let (q, _) = sums::peaks(&s, &m);
        let (p, _) = fronts::peaks(&s);
        let om = propagator::omega_max(&s);
        let (r, _) = propagator::peaks(&s, om);
        for i in 0..n { for neg in [false,true] { let (a,b,c)=(p[i].side(neg),q[i].side(neg),r[i].side(neg));
            if [a.first_over.unwrap_or(-1.0)-b.first_over.unwrap_or(-1.0), c.first_over.unwrap_or(-1.0)-b.first_over.unwrap_or(-1.0)].iter().any(|d|d.abs()>1e-9) {
                println!("n {n} {h}{t} src {src} pulse {pulse} spring {i} {neg}\n  front {a:?} {:?}\n  closed {b:?} {:?}\n  prop {c:?} {:?}", a.exceeds(), b.exceeds(), c.exceeds());
                let ff = b.first_over.unwrap_or(a.first_over.unwrap_or(0.0));
                println!("   around closed {:?}", sums::history(&s,&m,i,&[ff-1e-3,ff,ff+1e-3,ff+1e-2]));
            } } } } } } }
}
