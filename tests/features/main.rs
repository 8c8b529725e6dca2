//! What optional features add: Parquet, workbooks, the served page.

#[path = "../helpers/fleets.rs"]
mod fleets;

mod parquet;
#[cfg(feature = "serve")]
mod serve;
#[cfg(feature = "serve")]
mod serve_files;
#[cfg(feature = "serve")]
mod served;
mod workbook;
