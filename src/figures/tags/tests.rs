use super::*;

#[test]
fn names_stay_text() {
    assert_eq!(escaped("<b a='1'>&\u{7}\u{202e}\""), "&lt;b a=&#39;1&#39;&gt;&amp;  &quot;");
}

#[test]
fn coordinates_are_short() {
    assert_eq!([-0.01, 12.0, 7.26].map(number), ["0", "12", "7.3"]);
}
