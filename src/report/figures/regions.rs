//! Where a field is over the rating: connected regions of it.

use crate::findings::Field;

/// A connected region of cells over the rating.
#[derive(Debug, PartialEq)]
pub struct Region {
    /// Rows and columns that it spans.
    pub size: (usize, usize),
    /// Row and column of its largest utilisation.
    pub peak: (usize, usize),
}

/// The regions of a field that are over the rating, by row and column of their first cells.
pub fn over_rating(field: &Field) -> Vec<Region> {
    let (rows, columns) = (field.rows(), field.times_s.len());
    let mut left: Vec<bool> = field.share.iter().map(|s| s.abs() > 1.0).collect();
    let mut regions = Vec::new();
    for first in 0..left.len() {
        if !std::mem::take(&mut left[first]) {
            continue;
        }
        let (mut next, mut cells) = (vec![first], Vec::new());
        while let Some(cell) = next.pop() {
            cells.push(cell);
            let (row, column) = (cell / columns, cell % columns);
            for r in row.saturating_sub(1)..(row + 2).min(rows) {
                for c in column.saturating_sub(1)..(column + 2).min(columns) {
                    if std::mem::take(&mut left[r * columns + c]) {
                        next.push(r * columns + c);
                    }
                }
            }
        }
        let span = |of: fn(usize, usize) -> usize| {
            let all = || cells.iter().map(|&cell| of(cell, columns));
            all().max().unwrap_or(0) - all().min().unwrap_or(0) + 1
        };
        let larger = |a: usize, b: usize| if field.share[b].abs() > field.share[a].abs() { b } else { a };
        let peak = cells.iter().copied().reduce(larger).unwrap_or(first);
        let size = (span(|cell, columns| cell / columns), span(|cell, columns| cell % columns));
        regions.push(Region { size, peak: (peak / columns, peak % columns) });
    }
    regions
}

/// Rows with anything over the rating.
pub fn rows_over(field: &Field) -> Vec<usize> {
    (0..field.rows()).filter(|&r| field.row(r).iter().any(|s| s.abs() > 1.0)).collect()
}

#[cfg(test)]
mod tests {
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
        let regions = over_rating(&field);
        assert_eq!(regions, [Region { size: (2, 2), peak: (1, 2) }, Region { size: (1, 1), peak: (2, 4) }]);
        assert_eq!(rows_over(&field), [0, 1, 2]);
    }
}
