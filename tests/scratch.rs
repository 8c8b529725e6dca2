//! scratch
use trainsafe::chain::*;
use trainsafe::solve::*;
fn held(n: usize, free: bool) -> Scene {
    Scene { chain: Chain { mass: vec![1.0; n+1], stiffness: vec![1.0; n], held_head: !free, held_tail: false }, source: n, force: 1.0, duration: f64::INFINITY,
      initial: vec![1.0; n], rated_draft: vec![1.0; n], rated_buff: vec![1.0; n], horizon: 200.0 }
}
#[test]
fn fig4() {
    let s = held(50, false);
    for (name, m) in [("cf", closed_form::modes(&s).unwrap()), ("modal", modal::modes(&s))] {
        let t = std::time::Instant::now();
        let (p, w) = sums::peaks(&s, &m);
        println!("{name} {:?} {:?} {:?} bound {:e} {:?} defect {:e}", p[0].buff, p[0].draft, w, sums::error_bound(&s, &m), t.elapsed(), m.defect[0]);
        println!("  {:?}", p[10]);
    }
    for n in [50, 100, 300, 1000] {
        let s = held(n, true);
        let t = std::time::Instant::now();
        let m = modal::modes(&s);
        println!("modal {n} {:?} defect {:e}", t.elapsed(), m.defect[0]);
        let c = closed_form::modes(&s).unwrap();
        println!("diff omega {:e}", (0..n).map(|j| ((m.omega[j]-c.omega[j])/c.omega[j]).abs().hi).fold(0.0, f64::max));
        println!("diff share {:e}", (&m.share - &c.share).abs().max());
    }
    for (hh,ht,src) in [(false,true,3),(true,true,4),(true,true,7),(true,false,3),(false,false,4)] {
        let mut s = held(9, true); s.chain.held_head=hh; s.chain.held_tail=ht; s.source=src;
        let m = modal::modes(&s); let c = closed_form::modes(&s).unwrap();
        println!("{hh}{ht}{src} diff {:e} {:e}", (&m.share - &c.share).abs().max(), m.defect[0]);
        let sums: Vec<f64> = (0..9).map(|i| c.share.row(i).sum()).collect();
        println!("{:?} {:?}", sums, statics::unit_force(&s.chain, src));
    }
}
