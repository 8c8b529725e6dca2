//! trainsafe
fn main() {}
