//! Where a field is over the rating: connected regions of it.

use crate::findings::Field;

/// Row and column of the largest utilisation of each connected region that is over the rating, the largest first.
pub fn over_rating(field: &Field) -> Vec<(usize, usize)> {
    let (rows, columns) = (field.rows(), field.times_s.len());
    let mut left: Vec<bool> = field.share.iter().map(|s| s.abs() > 1.0).collect();
    let mut peaks = Vec::new();
    for first in 0..left.len() {
        if !std::mem::take(&mut left[first]) {
            continue;
        }
        let (mut next, mut peak) = (vec![first], first);
        while let Some(cell) = next.pop() {
            if field.share[cell].abs() > field.share[peak].abs() {
                peak = cell;
            }
            let (row, column) = (cell / columns, cell % columns);
            for r in row.saturating_sub(1)..(row + 2).min(rows) {
                for c in column.saturating_sub(1)..(column + 2).min(columns) {
                    if std::mem::take(&mut left[r * columns + c]) {
                        next.push(r * columns + c);
                    }
                }
            }
        }
        peaks.push(peak);
    }
    peaks.sort_by(|a, b| field.share[*b].abs().total_cmp(&field.share[*a].abs()));
    peaks.into_iter().map(|peak| (peak / columns, peak % columns)).collect()
}

/// Rows with anything over the rating.
pub fn rows_over(field: &Field) -> Vec<usize> {
    (0..field.rows()).filter(|&r| field.row(r).iter().any(|s| s.abs() > 1.0)).collect()
}

#[cfg(test)]
mod tests;
