use super::*;

/// Every part's spellings, with whether it is taken in any case.
fn spellings(part: &Part) -> Vec<&'static str> {
    std::iter::once(&part.symbol).chain(part.symbols).chain(part.words).copied().collect()
}

/// The texts of a form, with a few of the signs for a product.
fn texts(form: &[Piece]) -> Vec<String> {
    let mut texts = vec![String::new()];
    for piece in form {
        let next: Vec<&str> = match piece {
            Piece::Of(kinds) => parts(kinds).flat_map(spellings).collect(),
            Times => vec!["*", " ", ".", "\u{b7}"],
            Over => vec!["/", " per "],
            Open => vec!["("],
            Close => vec![")"],
        };
        texts = texts.iter().flat_map(|t| next.iter().map(move |n| format!("{t}{n}"))).collect();
    }
    texts
}

/// Whatever text a dimension takes, it takes as one size only.
#[test]
fn no_text_has_two_sizes() {
    for dimension in Dimension::ALL {
        for text in forms(dimension).iter().flat_map(|form| texts(form)) {
            let found = all(dimension, &text, false);
            assert!(!found.is_empty(), "{dimension}: {text} is not found");
            assert!(found.iter().all(|f| f.scale == found[0].scale), "{dimension}: {text} has two sizes");
        }
    }
}

/// No text that one dimension takes is meant as another: only pounds are in two, a mass and a force, and the per cent, a grade and
/// a share.
#[test]
fn only_pounds_are_in_two_dimensions() {
    for dimension in Dimension::ALL {
        for other in Dimension::ALL.into_iter().filter(|d| *d != dimension) {
            let mut both = forms(dimension).iter().flat_map(|form| texts(form));
            let pounds = [Dimension::Mass, Dimension::Force];
            if dimension.is_in_per_cent() && other.is_in_per_cent() {
                continue;
            }
            let twice = both.find(|text| find(other, text).is_some());
            assert!(twice.is_none() || pounds.contains(&dimension) && pounds.contains(&other), "{twice:?}");
        }
    }
}
