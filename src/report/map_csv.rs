//! `map-N.csv`: a scenario's map.

use crate::findings::MapFindings;

/// The points of a map, with an empty cell where nothing bounds a value.
///
/// # Errors
/// Whatever the writer reports.
pub fn map_csv(map: &MapFindings) -> Result<Vec<u8>, csv::Error> {
    let mut rows = Vec::new();
    {
        let mut out = csv::Writer::from_writer(&mut rows);
        out.write_record([map.over, map.value, "rod"])?;
        let number = |x: Option<f64>| x.filter(|x| x.is_finite()).map(|x| format!("{x:?}")).unwrap_or_default();
        for p in &map.points {
            let at = if map.over == "broken_coupler" { format!("{}", p.at) } else { format!("{:?}", p.at) };
            out.write_record([at, number(p.chain), number(p.rod)])?;
        }
        out.flush()?;
    }
    Ok(rows)
}
