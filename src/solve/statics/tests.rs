use super::*;

/// Three masses 1, 2, 3, force on the middle one: alone it accelerates at 1/6, pushing 1 and dragging 3.
#[test]
fn free_chain_shares_by_mass_and_held_chain_by_compliance() {
    let mut chain = Chain { mass: vec![1.0, 2.0, 3.0], stiffness: vec![1.0, 3.0], held_head: false, held_tail: false };
    assert_eq!(unit_force(&chain, 1), [-1.0 / 6.0, 0.5]);
    chain.held_head = true;
    assert_eq!(unit_force(&chain, 1), [-1.0, 0.0]);
    chain.held_tail = true;
    assert_eq!(unit_force(&chain, 1), [-0.25, 0.75]);
}
