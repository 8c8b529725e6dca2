use super::*;

const FRAME: Frame = Frame { left: 0.0, top: 0.0, width: 400.0, height: 300.0 };

#[test]
fn labels_keep_clear_of_lines_and_within_the_frame() {
    let mut drawn = Obstacles::new(FRAME);
    drawn.add(&[(0.0, 150.0), (400.0, 150.0)]);
    for place in [
        with_arrow(60.0, (200.0, 150.0), &drawn),
        beside_line(60.0, 390.0, &drawn),
        beside_point(60.0, (390.0, 150.0), &drawn),
    ] {
        assert_eq!(drawn.covered(place, 60.0), 0.0, "{place:?}");
    }
}
