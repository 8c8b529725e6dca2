use super::*;

/// With room for two thirds of what is asked for again and again, a part of it is known.
#[test]
fn a_store_that_is_too_small_keeps_a_part() {
    let scene = |springs: usize| Scene {
        chain: Chain { mass: vec![1.0; springs + 1], stiffness: vec![1.0; springs], held_head: true, held_tail: false },
        source: springs,
        force: 1.0,
        duration: f64::INFINITY,
        initial: vec![0.0; springs],
        rated_draft: vec![3.0; springs],
        rated_buff: vec![3.0; springs],
        horizon: 4.0 * springs as f64,
    };
    let scenes: Vec<Scene> = (20..60).map(scene).collect();
    let ask_all = |responses: &Responses| {
        let shared = Shared::EqualChains(responses);
        scenes.iter().for_each(|scene| {
            shared.solve_all(&[(scene, Ask { tolerance: 1e-9, ..Ask::default() })]);
        });
        responses.kept.lock().expect("no thread panics").bytes
    };
    let all = ask_all(&Responses::new(1 << 30));
    let responses = Responses::new(all * 2 / 3);
    assert!((0..10).all(|_| ask_all(&responses) <= all * 2 / 3));
    let (known, found) = responses.counts();
    assert!(known > 80 && known + found == 400, "{known} {found}");
}
