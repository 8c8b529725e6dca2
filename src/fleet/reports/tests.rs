use super::*;

#[test]
fn folders_are_apart_and_stay_inside() {
    let mut taken = HashSet::new();
    let mut named = |file: &str| folder(Path::new(file), None, &mut taken);
    assert_eq!(named("a/train.toml"), "train");
    assert_eq!(named("b/Train.toml"), "Train-2");
    assert_eq!(named("....toml"), "___");
    assert_eq!(named("a/x y\"<#%?.toml"), "x_y_____");
    assert_eq!(folder(Path::new("s.toml"), Some(7), &mut HashSet::new()), "s-variation-7");
}
