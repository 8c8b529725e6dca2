use super::*;

#[test]
fn neighbours_are_one_region() {
    let share = [[0.0, 1.2, 0.0, 0.0, 0.0], [0.0, 0.0, -1.5, 0.0, f32::NAN], [0.0, 0.0, 0.0, 0.0, 1.1]];
    let field = Field {
        couplers_per_row: 1,
        instants_per_column: 1,
        times_s: (0..5).map(f64::from).collect(),
        share: share.concat(),
        slack: vec![],
    };
    assert_eq!(over_rating(&field), [(1, 2), (2, 4)]);
    assert_eq!(rows_over(&field), [0, 1, 2]);
}
