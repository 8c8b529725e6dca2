//! What the fuzz targets share: what must hold of any input, and random trains.

pub mod checks;
pub mod trains;
