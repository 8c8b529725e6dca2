//! Quantities as people write them ("30 MN/m") into SI.
