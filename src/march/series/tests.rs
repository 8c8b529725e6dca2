use super::two_product;

/// (1 + 2^-30)(1 + 2^-29) = 1 + 3 * 2^-30 + 2^-59, and its negative.
#[test]
fn products_are_exact() {
    let [a, b] = [30, 29].map(|n| 1.0 + f64::exp2(f64::from(-n)));
    let (product, rest) = (1.0 + 3.0 * f64::exp2(-30.0), f64::exp2(-59.0));
    assert_eq!(two_product(a, b), (product, rest));
    assert_eq!(two_product(-a, b), (-product, -rest));
}
