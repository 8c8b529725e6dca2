use super::escape;

#[test]
fn names_are_text_whatever_they_hold() {
    assert_eq!(escape("<img src=x> | *a*_b_"), "&lt;img src=x&gt; \\| \\*a\\*\\_b\\_");
    assert_eq!(escape("[x](http://a)\nb"), "\\[x\\](http\\://a) b");
    assert_eq!(escape("Zürich – 木"), "Zürich – 木");
}
