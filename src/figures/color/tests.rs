use super::*;

#[test]
fn the_table_is_in_the_order_of_the_names() {
    assert!(ALL.iter().enumerate().all(|(i, entry)| entry.0 as usize == i));
}

#[test]
fn the_scale_has_buff_and_draft_at_its_ends() {
    assert_eq!([0.0, 0.5, 1.0].map(ramp), [RAMP[0], [255, 255, 255], RAMP[6]]);
    assert_eq!(on_dark([255, 255, 255]), [31, 31, 31]);
}

/// Contrast of 3 to 1 against the card, which WCAG asks of what carries meaning, light and dark.
#[test]
fn every_colour_is_seen_on_its_card() {
    let luminance = |hex: &str| {
        let channel = |i: usize| {
            let c = f64::from(u8::from_str_radix(&hex[i..i + 2], 16).expect("a colour")) / 255.0;
            if c <= 0.03928 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    };
    let contrast = |a: &str, b: &str| {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    };
    for (_, name, light, dark) in &ALL[1..] {
        assert!(contrast(light, ALL[0].2) > 3.0, "{name} on a light page");
        assert!(contrast(dark, ALL[0].3) > 3.0, "{name} on a dark page");
    }
}
