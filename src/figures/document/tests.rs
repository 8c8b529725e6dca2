use super::*;

#[test]
fn a_legend_goes_on_in_the_next_line() {
    let mut figure = Figure::new("f");
    for label in ["a", "b"] {
        figure.explain(&label.repeat(45), Sample::Mark(Shape::Square, Color::Draft));
    }
    let svg = figure.svg();
    let heights: Vec<&str> = svg.split("<text").skip(1).filter_map(|t| t.split('"').nth(3)).collect();
    assert!(heights.len() == 2 && heights[0] != heights[1], "{svg}");
}
